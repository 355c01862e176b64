"""Locomotives of ALTRIOS (YAML): mass, motors, and the rolling resistance that they have in a train with cars."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from readers.formats import Row
from readers.formats.altrios_car import Car, check_units
from readers.formats.notes import Notes
from readers.formats.vehicle_rows import GRAVITY, MOST, checked, named_number, rounded
from readers.text import FileError, shown

#: Spellings of a locomotive's numbers.
UNITS = {"mass": ("mass_kilograms", "mass", "mass_kg"), "force_max": ("force_max_newtons", "force_max")}


def locomotives_of(read: Mapping[str, Any], source: str, notes: Notes) -> list[Row]:
    """Return the rows of the locomotives in loco_con or loco_vec, none if the file has none. Raises FileError."""
    consist = read.get("loco_con", read)
    stated = consist.get("loco_vec") if isinstance(consist, dict) else None
    if stated is None:
        return []
    if not isinstance(stated, list) or len(stated) > MOST:
        raise FileError(f"{source}: loco_vec must be a list of at most {MOST} locomotives; got another. Correct it.")
    rows: list[Row] = []
    notes.begin("locomotives")
    for number, one in enumerate(stated):
        place = f"{source}, locomotive {number + 1}"
        if not isinstance(one, dict):
            raise FileError(f"{place} must be a locomotive; got {shown(one)}. Correct it.")
        row: Row = {"kind": "locomotive", "name": f"locomotive {number + 1}"}
        check_units(one, UNITS, place)
        given = next((one[name] for name in UNITS["mass"] if one.get(name) is not None), None)
        if given is None:
            notes.assumed("Mass of a locomotive: missing; that of the kind.")
        else:
            row["mass"] = rounded(checked(1e-3 * named_number(given, "mass", place), "mass", (1.0, 300.0), "t", place))
            notes.taken("loco_vec mass -> mass [t]")
        rows.append(row | _motors(one, place, notes))
    notes.assumed(
        "Length, rotating mass and brake of a locomotive, and without cars its running resistance: those of the kind; "
        "ALTRIOS does not have them."
    )
    notes.left("Powertrain of a locomotive: efficiencies, limits of engine and battery, and dynamic brakes.")
    return rows


def _motors(one: Mapping[str, Any], place: str, notes: Notes) -> Row:
    """Return the largest force of a locomotive and the power of its electric drivetrain, if it states both."""
    drive = next((inner for inner in _within(one) if "edrv" in inner), {}).get("edrv", {})
    given = [
        next((read[name] for name in names if isinstance(read, dict) and read.get(name) is not None), None)
        for read, names in ((one, UNITS["force_max"]), (drive, ("pwr_out_max_watts", "pwr_out_max")))
    ]
    if None in given:
        notes.left("Motors of a locomotive: they need force_max and pwr_out_max of edrv.")
        return {}
    force, power = (named_number(value, name, place) for value, name in zip(given, ("force_max", "edrv"), strict=True))
    checked(1e-3 * force, "force_max", (0.1, 2000.0), "kN", place)
    checked(1e-3 * power, "pwr_out_max of edrv", (1.0, 30e3), "kW", place)
    notes.taken("force_max -> traction_force [kN], pwr_out_max of edrv -> traction_power [kW]")
    return {"traction_force": rounded(1e-3 * force), "traction_power": rounded(1e-3 * power)}


def _within(read: Any, depth: int = 4) -> Iterator[Mapping[str, Any]]:
    """Yield a mapping and those inside it."""
    if isinstance(read, dict):
        yield read
        for inner in read.values() if depth else ():
            yield from _within(inner, depth - 1)


def hauled(locomotives: list[Row], cars: list[tuple[Car, int]], notes: Notes) -> list[Row]:
    """Return locomotives with the mean rolling_ratio and davis_b of the cars, as ALTRIOS takes them for all weight."""
    total = sum(car.numbers["mass"] * count for car, count in cars)
    if not locomotives or not total:
        return locomotives
    ratio, slope = (
        sum(car.numbers[name] * car.numbers["mass"] * count for car, count in cars) / total
        for name in ("rolling", "davis_b")
    )
    notes.vehicle = "locomotives"
    notes.converted(
        "rolling_ratio, davis_b: their means over the mass of the cars x weight -> resistance_a, _b of a locomotive "
        "with mass; ALTRIOS has no drag of a locomotive -> resistance_c = 0"
    )
    notes.vehicle = ""
    return [_with_resistance(row, ratio, slope) for row in locomotives]


def _with_resistance(row: Row, ratio: float, slope: float) -> Row:
    """Return a locomotive with its resistance over weight [1] and its rise with speed [s/m], if it has a mass."""
    if "mass" not in row:
        return row
    weight = 1e3 * row["mass"] * GRAVITY
    return row | {
        "resistance_a": rounded(ratio * weight),
        "resistance_b": rounded(slope * weight),
        "resistance_c": 0.0,
    }
