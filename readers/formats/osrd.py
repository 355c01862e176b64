"""Rolling stock of OSRD (JSON): a whole train or unit, divided into equal vehicles.

Fields as OSRD's schema of rolling stock has them, in SI units. The resistance A + B v + C v^2 is that of the whole
train in files before June 2026. Since then, and for towed stock since 2024, it is that of a kilogram
(editoast/schemas/src/rolling_stock/rolling_resistance.rs: RollingResistanceRaw, RollingResistancePerWeight). No field
states which of them a file has. A train has 0.3 to 50 N/t at rest, which only one reading meets.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from readers.documents import LARGEST, document
from readers.formats.vehicle_rows import (
    HEAVIEST,
    LIGHTEST,
    LONGEST,
    MOST,
    SHORTEST,
    checked,
    divided,
    drive_table,
    named_number,
    printable,
    rounded,
    whole_train,
    with_motors,
)
from readers.import_account import Imported, Notes, Row
from readers.text import FileError, shown, text_of

#: Length to which a train is divided [m]: that of a coach (UIC 567). Assumed.
PART = 26.4
#: Running resistance at rest below which, and at a speed [m/s] above which, a unit is doubtful [N/t]. Assumed.
LITTLE, MUCH, FAST = 3.0, 500.0, 30.0
#: Limits of a resistance that is read, at rest or, without A, at that speed, and its largest one there, the weight
#: [N/t]. Assumed: a train in kN instead of N has 1000 times less, and as N/kg more than these.
READ = {"at rest": (0.3, 50.0), f"at {3.6 * FAST:g} km/h": (0.3, MUCH)}
MOST_FAST = 9806.65
#: Fields without a column, each with the reason.
LEFT = {
    "max_speed": "it does not affect braking",
    "startup_time": "a rule of running times",
    "startup_acceleration": "a rule of running times",
    "comfort_acceleration": "a rule of running times",
    "electrical_power_startup_time": "a rule of running times",
    "raise_pantograph_time": "a rule of running times",
    "etcs_brake_params": "decelerations that ETCS supervises, for comparison; they are not those of the brakes",
    "energy_sources": "motors have no limit of energy",
    "power_restrictions": "the unrestricted curve of forces is read",
    "loading_gauge": "it does not affect braking",
    "base_power_class": "it does not affect braking",
    "supported_signaling_systems": "it does not affect braking",
}


def read_osrd(path: Path) -> Imported:
    """Return the train of a rolling-stock file."""
    read = document(text_of(path, LARGEST).encode(), str(path))
    if not isinstance(read, dict) or not {"length", "mass"} <= read.keys():
        raise FileError(f"{path} must be a rolling stock with length and mass; got {shown(read)}. Give another file.")
    notes, source = Notes(), str(path)
    notes.begin(str(read.get("name", path.stem)))
    length = checked(named_number(read["length"], "length", source), "length", (SHORTEST, 20e3), "m", source)
    mass = 1e-3 * named_number(read["mass"], "mass", source)
    parts = _parts(length, mass, source)
    notes.taken("length -> length [m], mass -> mass [t]")
    if parts > 1:
        notes.assumed(
            f"An OSRD rolling stock is a whole train: {length:g} m and {mass:g} t become {parts} equal vehicles of "
            f"{length / parts:.4g} m and {mass / parts:.4g} t. A locomotive in it is not told apart."
        )
    row: Row = {
        "kind": _kind(read, notes),
        "name": printable(read.get("name", path.stem), "unit"),
        "mass": rounded(mass),
        "length": rounded(length),
    }
    row |= _rotating(read, source, notes) | _resistance(read, mass, source, notes) | _deceleration(read, source, notes)
    row = with_motors(row, _traction(read, source, notes), notes)
    notes.left_of(LEFT, read)
    rows = [{name: one for name, one in part.items() if name != "coupler"} for part in divided(row, parts)]
    if parts > 1:
        notes.assumed("Couplers between the vehicles: screw couplers, because the file has none.")
    return notes.imported(whole_train(rows, notes, source))


def _parts(length: float, mass: float, source: str) -> int:
    """Return the number of vehicles of a train. Raises FileError if no number fits."""
    parts = max(round(length / PART), math.ceil(length / LONGEST), math.ceil(mass / HEAVIEST), 1)
    parts = min(parts, int(length // SHORTEST), MOST)
    checked(mass / parts, f"mass of each of {parts} vehicles", (LIGHTEST, HEAVIEST), "t", source)
    return parts


def _kind(read: dict[str, Any], notes: Notes) -> str:
    category = str(read.get("primary_category", ""))
    freight = "FREIGHT" in category.upper()
    kind = "wagon" if freight else "coach"
    if category:
        notes.taken("primary_category -> kind, wagon for freight, else coach")
    else:
        notes.assumed("Kind: coaches, because the file has no primary_category.")
    return kind


def _rotating(read: dict[str, Any], source: str, notes: Notes) -> Row:
    """Return the share of rotating mass [%] of inertia_coefficient k, 100 (k - 1)."""
    if read.get("inertia_coefficient") is None:
        notes.assumed("Rotating mass: the file has no inertia_coefficient; that of the vehicle's kind applies.")
        return {}
    factor = checked(
        named_number(read["inertia_coefficient"], "inertia_coefficient", source),
        "inertia_coefficient",
        (1, 2),
        "",
        source,
    )
    notes.converted("inertia_coefficient k: 100 (k - 1) -> rotating [%]")
    return {"rotating": rounded(100 * (factor - 1))}


def _resistance(read: dict[str, Any], mass: float, source: str, notes: Notes) -> Row:
    """Return A + B v + C v^2 of the whole train of a mass [t], also if the file states them per mass."""
    given = read.get("rolling_resistance")
    if not isinstance(given, dict):
        notes.assumed("Running resistance: the file has no rolling_resistance; that of the vehicle's kind applies.")
        return {}
    if (kind := str(given.get("type", "davis")).lower()) != "davis":
        notes.left(f"rolling_resistance: the type {shown(kind)} has no column; give A, B and C of Davis.")
        return {}
    found = {name: named_number(given.get(name), f"rolling_resistance.{name}", source) for name in "ABC"}
    for name, value in found.items():
        checked(value, f"rolling_resistance.{name}", (0.0, 1e9), "", source)
    factor = _unit_of_resistance(found, mass, source)
    where = "-> resistance_a, _b, _c [N, N/(m/s), N/(m/s)^2], shared by the vehicles"
    if factor == 1.0:
        notes.taken(f"rolling_resistance A, B, C, of the whole train {where}")
    else:
        notes.converted(f"rolling_resistance A, B, C, per kg, as OSRD has them since June 2026: x mass {where}")
    found = {name: factor * value for name, value in found.items()}
    _tell_doubtful(found, mass, notes)
    return {f"resistance_{name.lower()}": rounded(value) for name, value in found.items()}


def _unit_of_resistance(found: dict[str, float], mass: float, source: str) -> float:
    """Return 1 for a resistance of the whole train of a mass [t], or the mass [kg] for one per kilogram."""
    fast = found["A"] + found["B"] * FAST + found["C"] * FAST**2
    if fast == 0.0:
        return 1.0
    name, value = ("at rest", found["A"]) if found["A"] else (f"at {3.6 * FAST:g} km/h", fast)
    readings = {1.0: value / mass, 1e3 * mass: 1e3 * value}
    least, most = READ[name]
    fitting = [factor for factor, one in readings.items() if least <= one <= most]
    if len(fitting) != 1 or fast * fitting[0] > MOST_FAST * mass:
        whole, own = readings.values()
        raise FileError(
            f"{source}: rolling_resistance must be {least:g} to {most:g} N/t {name} and below the weight at "
            f"{3.6 * FAST:g} km/h, of the whole train in N or of a kilogram in N/kg; got A = {found['A']:g}, B = "
            f"{found['B']:g}, C = {found['C']:g}: {whole:.3g} N/t or {own:.3g} N/t {name}. Convert all to N, m/s."
        )
    return fitting[0]


def _tell_doubtful(found: dict[str, float], mass: float, notes: Notes) -> None:
    """Report a resistance that few trains have."""
    if found["A"] < LITTLE * mass:
        notes.assumed(
            f"rolling_resistance A is {found['A'] / mass:.3g} N/t; trains have {LITTLE:g} N/t and more. It is read as "
            "it stands. Check its unit."
        )
    fast = found["A"] + found["B"] * FAST + found["C"] * FAST**2
    if fast > MUCH * mass:
        notes.assumed(
            f"rolling_resistance at {3.6 * FAST:g} km/h is {fast / mass:.3g} N/t; trains have less than {MUCH:g} N/t. "
            "It is read as it stands. Check its units."
        )


def _traction(read: dict[str, Any], source: str, notes: Notes) -> Row:
    """Return the default curve of the default mode of effort_curves, shared by all vehicles."""
    curves = read.get("effort_curves")
    modes = curves.get("modes") if isinstance(curves, dict) else None
    if not isinstance(curves, dict) or not isinstance(modes, dict) or not modes:
        if curves is not None:
            notes.left("effort_curves: it has no mode.")
        return {}
    name = curves.get("default_mode", next(iter(modes)) if len(modes) == 1 else None)
    mode = modes.get(name) if isinstance(name, str) else None
    curve = mode.get("default_curve") if isinstance(mode, dict) else None
    if not isinstance(curve, dict):
        notes.left("effort_curves: several modes without a default_mode, or a mode without a default_curve.")
        return {}
    speeds, forces = curve.get("speeds"), curve.get("max_efforts")
    if not isinstance(speeds, list) or not isinstance(forces, list) or len(speeds) != len(forces):
        raise FileError(f"{source}: effort_curves must have as many speeds as max_efforts. Correct the file.")
    numbers = [
        [named_number(one, f"effort_curves.{what}", source) for one in given]
        for what, given in (("speeds", speeds), ("max_efforts", forces))
    ]
    row = drive_table(
        "traction_table", [(3.6 * v, f) for v, f in zip(*numbers, strict=True)], f"effort_curves, {shown(name)}", notes
    )
    if len(modes) > 1:
        notes.left(f"effort_curves: {len(modes)} modes; the default one is read, and its default_curve.")
    if row:
        notes.assumed("Motors: the force is shared by all vehicles, all of whose wheels are driven.")
    return row


def _deceleration(read: dict[str, Any], source: str, notes: Notes) -> Row:
    """Return the deceleration [m/s2] of const_gamma, in older files of gamma."""
    name, gamma = "const_gamma", read.get("const_gamma")
    if gamma is None and isinstance(read.get("gamma"), dict):
        name, gamma = "gamma", read["gamma"].get("value")
    if gamma is None:
        notes.assumed("Brake: the file has no const_gamma; the brake of the vehicle's kind applies.")
        return {}
    value = abs(named_number(gamma, name, source))
    notes.taken(f"{name} -> deceleration [m/s2]")
    notes.assumed(
        f"{name} is a deceleration of operation, with its margin; no physical brake. It is taken as that of fully "
        "applied brakes, in position P."
    )
    return {"deceleration": rounded(checked(value, name, (0.01, 3.0), "m/s2", source))}
