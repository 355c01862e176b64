"""Rolling stock of railML 2.x and 3 (XML): a formation of vehicles, or the vehicles themselves.

Names of elements and attributes were read in programs that use railML, not in its schema. Masses are in t, lengths in
m, speeds in km/h, forces in N, and rolling resistance in N/kN.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

from readers.formats.railml_numbers import number_of
from readers.formats.railml_vehicle import davis_of_train, vehicle_of
from readers.formats.vehicle_rows import GRAVITY, MOST, fitting, rounded, whole_train
from readers.import_account import Imported, Notes, Row
from readers.text import FileError, quoted, shown
from readers.xml_files import inside, xml_of

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
    if brakes is None or any({"lambda", "deceleration", "brake_force"} & row.keys() for row in rows):
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
