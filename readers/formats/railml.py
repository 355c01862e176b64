"""Rolling stock of railML 2.x and 3 (XML): a formation of vehicles, or the vehicles themselves.

Names of elements and attributes were read in programs that use railML, not in its schema. Masses are in t, lengths in
m, speeds in km/h, forces in N, and rolling resistance in N/kN.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np

from readers.formats.vehicle_rows import (
    AIR,
    CLOSEST,
    GRAVITY,
    MOST,
    STRONGEST,
    checked,
    drive_table,
    fewer,
    fitting,
    is_table,
    rounded,
    tell_deviation,
    whole_train,
    with_motors,
)
from readers.import_account import Imported, Notes, Row
from readers.text import FileError, quoted, shown
from readers.units import SPELLINGS, different_units
from readers.xml_files import attribute, inside, xml_of

#: Largest size of a number.
LARGEST = 1e12
#: Factors of the units of tables, in small letters, to km/h, N and m/s2; without a unit a table is in these.
UNITS: dict[str, dict[str, float]] = {
    quantity: {unit.lower(): factor * up / down for unit, (up, down) in SPELLINGS[quantity].items()} | {"": 1.0}
    for quantity, factor in (("speed", 3.6), ("force", 1.0), ("acceleration", 1.0))
}
UNITS["acceleration"]["m/s/s"] = 1.0
DEFAULT = {"force": "N", "acceleration": "m/s2"}
#: Most rows of a table.
MOST_ROWS = 10_000


def number_of(element: ET.Element, name: str, limits: tuple[float, float], source: str) -> float | None:
    """Return the number of an attribute, None if it is missing. Raises FileError."""
    value = attribute(element, name, source, LARGEST)
    return None if value is None else checked(value, f"{name} of {element.tag}", limits, "", source)


def table_of(element: ET.Element, quantity: str, source: str, notes: Notes) -> list[tuple[float, float]]:
    """Return the rows of a valueTable inside an element: speed [km/h] and value [SI], sorted by speed."""
    table = next(inside(element, "valueTable"), None)
    if table is None:
        return []
    units = (table.get("xValueUnit", "").strip().lower(), table.get("yValueUnit", "").strip().lower())
    if units[0] not in UNITS["speed"] or units[1] not in UNITS[quantity]:
        own = " or ".join(different_units(DEFAULT[quantity])[:3])
        raise FileError(
            f"{source}: the table of {element.tag} must be over km/h or m/s, in {own}; got "
            f"{shown(' and '.join(units))}. Correct its units."
        )
    if "" in units:
        notes.assumed(f"{element.tag}: a unit of its table is missing; km/h and {DEFAULT[quantity]}.")
    found = []
    for line in inside(table, "valueLine"):
        speed = number_of(line, "xValue", (0.0, 1000.0), source)
        value = next((number_of(one, "yValue", (-1e9, 1e9), source) for one in inside(line, "value")), None)
        if speed is not None and value is not None:
            found.append((speed * UNITS["speed"][units[0]], value * UNITS[quantity][units[1]]))
    found.sort()
    if len(found) > MOST_ROWS or any(a[0] == b[0] for a, b in pairwise(found)):
        raise FileError(f"{source}: the table of {element.tag} must have each speed once; got another. Correct it.")
    return found


def mean_deceleration(table: list[tuple[float, float]]) -> float | None:
    """Return the mean over the distance of a stop from the highest speed, v^2 / 2 over int v / a dv, or None."""
    if len(table) < 2 or any(value <= 0.0 for _, value in table):
        return None
    speeds = np.linspace(0.0, table[-1][0], 2001) / 3.6
    values = np.interp(3.6 * speeds, [one for one, _ in table], [one for _, one in table])
    return float(speeds[-1] ** 2 / 2 / np.trapezoid(speeds / values, speeds))


def fitted(table: list[tuple[float, float]]) -> tuple[tuple[float, float, float], float] | None:
    """Return a, b, c >= 0 of a + b v + c v^2 in SI fitted to forces over speed, and the largest error [N], or None."""
    if len(table) < 3 or any(value < 0.0 for _, value in table):
        return None
    speeds = np.array([one for one, _ in table]) / 3.6
    forces = np.array([one for _, one in table])
    for powers in ((0, 1, 2), (0, 2), (0,)):
        matrix = np.stack([speeds**power for power in powers], axis=1)
        found = np.linalg.lstsq(matrix, forces, rcond=None)[0]
        if np.all(found >= 0.0):
            whole = dict(zip(powers, found, strict=True))
            error = float(np.max(np.abs(matrix @ found - forces)))
            a, b, c = (float(whole.get(power, 0.0)) for power in (0, 1, 2))
            return (a, b, c), error
    return None


#: Kinds by the beginning of a category, in small letters.
KINDS = {
    "loco": "locomotive",
    "motor": "coach",
    "passenger": "coach",
    "cab": "coach",
    "freight": "wagon",
    "booster": "coach",
}
#: Positions of an air brake, the first of them that a vehicle has is read.
POSITIONS = ("P", "R", "G", "")
#: Additional brakes, and the columns that have them.
AUXILIARY = {
    "E": "dynamic_force",
    "ep": "distributor = ep_uic",
    "H": "dynamic_force",
    "Mg": "magnetic_attraction",
    "Wb": "eddy_force",
}
#: Largest friction of a table that stands for forces, and its number of points; least force over the largest one.
FRICTION, FRICTION_POINTS, LEAST = 0.3, 6, 0.01
#: Limits of a weight [t] and of the coefficients of Davis' formula.
WEIGHT = (0.0, 5000.0)


def vehicle_of(vehicle: ET.Element, source: str, notes: Notes) -> Row:
    """Return a vehicle as a row."""
    place = f"{source}, vehicle {shown(vehicle.get('id', '?'))}"
    mass = _mass(vehicle, place, notes)
    length = number_of(vehicle, "length", (0.5, 5000.0), place)
    if length is None:
        raise FileError(f"{place}: a vehicle must have length [m]; got none. Add it.")
    notes.taken("length -> length [m]")
    name = vehicle.get("name") or vehicle.get("id") or "vehicle"
    row: Row = {"kind": _kind(vehicle, notes), "name": "".join(c if c.isprintable() else " " for c in name)[:60]}
    row |= {"mass": rounded(mass), "length": rounded(length)}
    factor = number_of(vehicle, "rotatingMassFactor", (1.0, 2.0), place)
    if factor is not None:
        notes.converted("rotatingMassFactor k: 100 (k - 1) -> rotating [%]")
        row["rotating"] = rounded(100 * (factor - 1))
    for one in ("numberOfDrivenAxles", "adhesionWeight", "maximumAxleLoad"):
        if vehicle.get(one) is not None:
            notes.left(f"{one}: a vehicle of a train has no axles of its own.")
    row = with_motors(row, _motors(vehicle, place, notes), notes)
    return row | _resistance(vehicle, mass, place, notes) | _brake(vehicle, place, notes)


def _motors(vehicle: ET.Element, place: str, notes: Notes) -> Row:
    """Return the table of the first tractiveEffort of a vehicle."""
    efforts = list(inside(vehicle, "tractiveEffort"))
    if not efforts:
        if next(inside(vehicle, "engine", "traction"), None) is not None:
            notes.left("engine: without a tractiveEffort with a valueTable it states no force over speed.")
        return {}
    if len(efforts) > 1:
        notes.left(f"tractiveEffort: {len(efforts)} tables; the first one is read.")
    return drive_table("traction_table", table_of(efforts[0], "force", place, notes), "tractiveEffort", notes)


def _kind(vehicle: ET.Element, notes: Notes) -> str:
    parts = [vehicle, *inside(vehicle, "vehiclePart", "classification")]
    words = [part.get("category") or part.get("vehicleCategory") or "" for part in parts]
    for word in words:
        for begin, kind in KINDS.items():
            if word.lower().startswith(begin):
                notes.taken("category -> kind")
                return kind
    kind = "locomotive" if next(inside(vehicle, "engine"), None) is not None else "wagon"
    notes.assumed(f"category: missing or unknown; taken as {kind}.")
    return kind


def _mass(vehicle: ET.Element, place: str, notes: Notes) -> float:
    """Return the mass [t]. Raises FileError if the vehicle has none."""
    gross, tare, net = (number_of(vehicle, f"{one}Weight", WEIGHT, place) for one in ("brutto", "tare", "netto"))
    if gross:
        notes.taken("bruttoWeight, loaded -> mass [t]")
        if tare and tare < gross:
            notes.left(f"tareWeight: {tare:g} t; the vehicle is loaded. Set mass yourself for an empty one.")
        return gross
    if not tare:
        raise FileError(f"{place}: a vehicle must have bruttoWeight or tareWeight [t]; got neither. Add one.")
    notes.converted("tareWeight + nettoWeight -> mass [t]" if net else "tareWeight, empty -> mass [t]")
    return tare + (net or 0.0)


def _resistance(vehicle: ET.Element, mass: float, place: str, notes: Notes) -> Row:
    """Return the running resistance, or nothing if the vehicle has none."""
    whole = next(inside(vehicle, "drivingResistance"), None)
    if whole is None:
        notes.assumed("Running resistance: missing; that of the vehicle's kind applies, if the formation has none.")
        return {}
    if whole.get("tunnelFactor") is not None:
        notes.left("tunnelFactor: tunnels have no column.")
    found = davis_of_train(whole, 1e3 * mass * GRAVITY, place, notes)
    return {} if found is None else {f"resistance_{name}": rounded(one) for name, one in zip("abc", found, strict=True)}


def davis_of_train(element: ET.Element, weight: float, place: str, notes: Notes) -> tuple[float, float, float] | None:
    """Return a, b, c in SI of an element with a weight [N]: Davis' formula, coefficients, or a table, else None."""
    davies = next(inside(element, "daviesFormulaFactors", "davisFormulaFactors"), None)
    if davies is not None:
        return _davies(davies, place, notes)
    for one in (element, *inside(element, "info", "drivingResistance", "trainResistance")):
        drag = number_of(one, "airDragCoefficient", (0.0, 100.0), place)
        area = number_of(one, "crossSectionArea", (0.0, 100.0), place)
        rolling = number_of(one, "rollingResistance", (0.0, 100.0), place)
        if rolling is not None or (drag is not None and area is not None):
            notes.converted("rollingResistance [N/kN] x weight -> resistance_a [N]")
            notes.converted(f"0.5 x {AIR:g} kg/m3 x airDragCoefficient x crossSectionArea -> resistance_c")
            names = {"rollingResistance": rolling, "airDragCoefficient": drag, "crossSectionArea": area}
            if missing := [name for name, value in names.items() if value is None]:
                notes.assumed(f"{', '.join(missing)}: missing; 0.")
            return 1e-3 * (rolling or 0.0) * weight, 0.0, 0.5 * AIR * (drag or 0.0) * (area or 0.0)
    if element.tag in ("drivingResistance", "trainResistance"):
        found = fitted(table_of(element, "force", place, notes))
        if found is not None:
            notes.converted(f"Table of resistance: fitted by a + b v + c v^2, largest error {found[1]:.3g} N")
            return found[0]
        notes.left(f"{element.tag}: no coefficients or table that can be read.")
    return None


def _davies(davies: ET.Element, place: str, notes: Notes) -> tuple[float, float, float] | None:
    names = ("constantFactorA", "speedDependentFactorB", "squareSpeedDependentFactorC")
    found = [number_of(davies, one, (0.0, 1e7), place) for one in names]
    if missing := [name for name, one in zip(names, found, strict=True) if one is None]:
        notes.assumed(f"daviesFormulaFactors, {', '.join(missing)}: missing; 0.")
    a, b, c = (one or 0.0 for one in found)
    if davies.get("massDependent", "false").lower() in ("true", "1"):
        notes.left("daviesFormulaFactors with massDependent: their unit of mass is not known here.")
        return None
    notes.converted("daviesFormulaFactors A, 3.6 B, 12.96 C (from km/h to m/s) -> resistance_a, _b, _c")
    return a, 3.6 * b, 12.96 * c


def _brake(vehicle: ET.Element, place: str, notes: Notes) -> Row:
    """Return the brake of the first set of a vehicle's brakes by position: P, R, G."""
    sets = [one for one in inside(vehicle, "vehicleBrakes", "vehicleBrake") if one.attrib]
    for one in inside(vehicle, "auxiliaryBrakes"):
        for name, remedy in AUXILIARY.items():
            if (one.get(name) or "false").lower() in ("true", "1"):
                notes.left(f"auxiliaryBrakes {name}: the file does not state its force. Set {remedy}.")
    if not sets:
        return _by_table(vehicle, place, notes) or _without_brake(notes)
    position = "airBrakeApplicationPosition"
    chosen = next(one for key in POSITIONS for one in [*sets, sets[0]] if one.get(position, "") == key or key == "")
    if len(sets) > 1:
        notes.left(f"vehicleBrakes: {len(sets)} sets; that of position {shown(chosen.get(position, '-'))} is read.")
    kind = chosen.get("brakeType", "").lower()
    if kind and "air" not in kind and "vacuum" not in kind:
        notes.converted(f"brakeType {shown(kind)}: not applied by the train -> brake = none")
        return {"brake": "none"}
    if "vacuum" in kind:
        notes.assumed("brakeType vacuum: simulated as a compressed-air brake of equal brake weight.")
    if chosen.get("loadSwitch") is not None:
        notes.left("loadSwitch: the brake weight is that of the stated load.")
    stated = _statement(chosen, place, notes) or _by_table(vehicle, place, notes)
    row: Row = {}
    if chosen.get(position) in ("G", "P") or (chosen.get(position) == "R" and stated):
        row["position"] = chosen.get(position)
        notes.taken(f"{position} -> position")
    elif chosen.get(position) == "R":
        notes.left(f"{position} R: it fills as P, and the file has no brake weight of it.")
    return row | (stated or _without_brake(notes))


def _without_brake(notes: Notes) -> Row:
    notes.assumed("Brake: missing; that of the vehicle's kind applies, if the formation has none.")
    return {}


def _statement(chosen: ET.Element, place: str, notes: Notes) -> Row:
    """Return the statement of a set of brakes: percentage, brake weight, or mean deceleration."""
    for begin in ("regular", "emergency"):
        percentage = number_of(chosen, f"{begin}BrakePercentage", (0.0, 400.0), place)
        weight = number_of(chosen, f"{begin}BrakeMass", (0.0, 5000.0), place)
        if not percentage and not weight:
            continue
        if begin == "regular" and (chosen.get("emergencyBrakePercentage") or chosen.get("emergencyBrakeMass")):
            notes.left("emergencyBrakePercentage, emergencyBrakeMass: a second brake weight has no column.")
        if percentage:
            notes.taken(f"{begin}BrakePercentage -> lambda [%]")
            return {"lambda": rounded(percentage)}
        notes.taken(f"{begin}BrakeMass -> brake_weight [t]")
        return {"brake_weight": rounded(weight or 0.0)}
    mean = number_of(chosen, "meanDeceleration", (0.0, 5.0), place)
    if mean:
        notes.taken("meanDeceleration -> deceleration [m/s2]")
        return {"deceleration": rounded(mean)}
    return {}


def _by_table(vehicle: ET.Element, place: str, notes: Notes) -> Row:
    """Return the mean deceleration of a decelerationTable, or the forces of a brakeEffort over speed."""
    element = next(inside(vehicle, "decelerationTable"), None)
    mean = mean_deceleration(table_of(element, "acceleration", place, notes)) if element is not None else None
    if mean is not None:
        notes.converted(
            "decelerationTable: mean over the distance of a stop from its highest speed -> deceleration [m/s2]"
        )
        return {"deceleration": rounded(mean)}
    element = next(inside(vehicle, "brakeEffort"), None)
    return _effort(table_of(element, "force", place, notes), notes) if element is not None else {}


def _effort(table: list[tuple[float, float]], notes: Notes) -> Row:
    """Return a force at standstill [N] with a friction over speed [km/h] that is proportional to a table of forces."""
    forces = np.array([force for _, force in table])
    if not is_table(table) or forces.min() < LEAST * forces.max():
        notes.left(
            f"brakeEffort: it is not two rows or more with speeds that rise by {CLOSEST:g} km/h, and forces up to "
            f"{STRONGEST:g} kN and from {100 * LEAST:g} % of the largest one on."
        )
        return {}
    speeds = np.array([speed for speed, _ in table])
    chosen, deviation = fewer(speeds, forces, FRICTION_POINTS)
    tell_deviation("brakeEffort", len(chosen), len(table), deviation / float(forces.max()), notes)
    notes.converted("brakeEffort -> brake_force [kN] at its lowest speed, friction_table in proportion to its forces")
    values = (f"{speeds[n]:.10g}:{rounded(FRICTION * float(forces[n] / forces.max())):.10g}" for n in chosen)
    return {"brake_force": rounded(1e-3 * float(forces[0])), "friction": "table", "friction_table": " ".join(values)}


#: Names that a sentence lists.
LISTED = 5


def read_railml(path: Path) -> Imported:
    """Return the train of a railML file: its first formation, otherwise each of its vehicles once."""
    root = xml_of(path)
    stock = root if root.tag == "rollingstock" else next(inside(root, "rollingstock"), None)
    vehicles = list(inside(stock, "vehicle")) if stock is not None else []
    if not vehicles:
        raise FileError(
            f"{path} must have rollingstock with vehicles; got {shown(root.tag)} without. Give another file."
        )
    by_name = {one.get("id", ""): one for one in vehicles}
    notes, source = Notes(), str(path)
    formations = list(inside(stock, "formation")) if stock is not None else []
    order = _order(formations, by_name, source, notes) if formations else [(one, 1) for one in vehicles]
    if not formations:
        notes.assumed("Order: the file has no formation; each vehicle once, in the order of the file.")
    read: dict[int, Row] = {}
    rows: list[Row] = []
    for vehicle, count in (one for one in order if one[1] > 0):
        if id(vehicle) not in read:
            notes.begin(vehicle.get("name") or vehicle.get("id") or "vehicle")
            read[id(vehicle)] = vehicle_of(vehicle, source, notes)
        parts = fitting(read[id(vehicle)], notes, source)
        rows += [{**parts[0], "count": count}] if len(parts) == 1 else parts * count
        if len(rows) > MOST:
            raise FileError(f"{source} must have at most {MOST} vehicles; got more. Shorten the formation.")
    notes.vehicle = ""
    if formations and rows:
        rows = _of_formation(formations[0], rows, source, notes)
    notes.assumed("Couplers: screw couplers, because the file has none.")
    return notes.imported(whole_train(rows, notes, source))


def _order(
    formations: list[ET.Element], vehicles: dict[str, ET.Element], source: str, notes: Notes
) -> list[tuple[ET.Element, int]]:
    """Return the vehicles of the first formation from its head, each with its count. Raises FileError."""
    formation = formations[0]
    name = formation.get("id", "")
    if len(formations) > 1:
        others = [one.get("id", "") for one in formations[1:]]
        more = f" and {len(others) - LISTED} more" if len(others) > LISTED else ""
        notes.left(
            f"Formations {', '.join(others[:LISTED])}{more}: the first, {shown(name)}, is read. Put another first."
        )
    found: list[tuple[float, ET.Element, int]] = []
    for place, one in enumerate(inside(formation, "trainOrder")):
        reference = one.get("vehicleRef") or one.get("ref") or ""
        if reference not in vehicles:
            raise FileError(
                f"{source}: the formation {shown(name)} must name vehicles of the file; got {quoted(reference)}. Add"
                " it."
            )
        count = number_of(one, "vehicleCount", (0, MOST), source)
        number = number_of(one, "orderNumber", (-1e6, 1e6), source)
        found.append((place if number is None else number, vehicles[reference], 1 if count is None else int(count)))
        if one.get("orientation") in ("reverse", "backwards"):
            notes.left("orientation: vehicles are symmetric here.")
    if not found:
        raise FileError(f"{source}: the formation {shown(name)} must have trainOrder; got none. Add it.")
    notes.taken("formation, trainOrder: vehicles in the order of orderNumber")
    return [(vehicle, count) for _, vehicle, count in sorted(found, key=lambda one: one[0])]


def _of_formation(formation: ET.Element, rows: list[Row], source: str, notes: Notes) -> list[Row]:
    """Return rows with what a formation states for the whole train, where the vehicles do not state it themselves."""
    total = sum(row["mass"] * row.get("count", 1) for row in rows)
    brakes = next((one for one in inside(formation, "trainBrakes") if one.attrib), None)
    whole = next(inside(formation, "trainResistance", "drivingResistance"), None)
    davis = None if whole is None else davis_of_train(whole, 1e3 * total * GRAVITY, source, notes)
    if davis is not None and not any("resistance_a" in row for row in rows):
        notes.converted("trainResistance: shared by the vehicles in proportion to their masses")
        shared = {f"resistance_{letter}": value for letter, value in zip("abc", davis, strict=True)}
        rows = [row | {name: rounded(value * row["mass"] / total) for name, value in shared.items()} for row in rows]
    elif davis is not None:
        notes.left("trainResistance: the vehicles have their own.")
    if brakes is None or any({"lambda", "brake_weight", "deceleration", "brake_force"} & row.keys() for row in rows):
        if brakes is not None:
            notes.left("trainBrakes: the vehicles have their own.")
        return rows
    percentage = number_of(brakes, "regularBrakePercentage", (1.0, 250.0), source)
    mean = number_of(brakes, "meanDeceleration", (0.01, 3.0), source)
    if percentage is not None:
        notes.taken("trainBrakes regularBrakePercentage -> lambda [%] of each vehicle")
        return [row | {"lambda": rounded(percentage)} for row in rows]
    if mean is not None:
        notes.taken("trainBrakes meanDeceleration -> deceleration [m/s2] of each vehicle")
        return [row | {"deceleration": rounded(mean)} for row in rows]
    notes.left("trainBrakes: neither regularBrakePercentage nor meanDeceleration.")
    return rows
