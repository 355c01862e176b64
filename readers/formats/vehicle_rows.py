"""Rows of vehicles as importers make them: equal neighbours counted, long vehicles divided, a driver's valve."""

from __future__ import annotations

import math
from typing import Any

from readers.import_account import Notes, Row
from readers.text import FileError, shown

#: Shortest and longest vehicle of a consist [m]; heaviest and lightest [t]; most vehicles. Those of consist files.
SHORTEST, LONGEST = 3.0, 31.0
LIGHTEST, HEAVIEST = 1.0, 300.0
MOST = 2000
#: Acceleration of gravity [m/s2] (CGPM 1901) and density of air at 15 degC and sea level [kg/m3] (ISO 2533).
GRAVITY, AIR = 9.80665, 1.225
#: Columns whose value is that of the whole vehicle, so that its parts share it.
SHARED = (
    "mass",
    "length",
    "resistance_a",
    "resistance_b",
    "resistance_c",
    "brake_force",
    "shoe_force",
    "dynamic_force",
    "dynamic_power",
    "traction_force",
    "traction_power",
    "parking_force",
    "auxiliary",
    "cylinder",
    "branch",
)


#: Columns of tables "km/h:kN" whose forces are those of the whole vehicle.
SHARED_TABLES = ("dynamic_table", "traction_table")


def checked(number: float, name: str, limits: tuple[float, float], unit: str, source: str) -> float:
    """Return a number within limits. Raises FileError, whose message begins with `source`."""
    low, high = limits
    if not low <= number <= high:
        raise FileError(f"{source}: {name} must be from {low:g} to {high:g} {unit}; got {number:g} {unit}. Correct it.")
    return number


def rounded(number: float) -> float:
    """Return a number with 10 significant digits, so that files have no rounding errors of conversions."""
    return float(f"{number:.10g}")


def divided(row: Row, parts: int) -> list[Row]:
    """Return the equal parts of a vehicle, coupled rigidly; the last one has its coupler."""
    part = {name: rounded(value / parts) if name in SHARED else value for name, value in row.items()}
    part |= {name: _shared_table(row[name], parts) for name in SHARED_TABLES if name in row}
    ahead = {name: value for name, value in part.items() if not name.startswith("coupler_")} | {"coupler": "rigid"}
    behind = {name: value for name, value in part.items() if name != "valve"}
    first = [ahead] if parts > 1 else [part]
    return [*first, *({name: value for name, value in ahead.items() if name != "valve"} for _ in range(parts - 2))] + (
        [behind] if parts > 1 else []
    )


def _shared_table(text: str, parts: int) -> str:
    """Return a table of forces for one of several equal parts of a vehicle."""
    pairs = [pair.split(":") for pair in text.split()]
    return " ".join(f"{speed}:{rounded(float(force) / parts):.10g}" for speed, force in pairs)


def fitting(row: Row, notes: Notes, source: str) -> list[Row]:
    """Return a vehicle, divided where it is longer or heavier than a vehicle of a consist may be."""
    length, mass = float(row["length"]), float(row["mass"])
    parts = max(math.ceil(length / LONGEST), math.ceil(mass / HEAVIEST), 1)
    if parts > 1:
        checked(float(parts), "the number of parts of a long vehicle", (1, MOST), "parts", source)
        notes.converted(
            f"A vehicle of {length:.4g} m and {mass:.4g} t becomes {parts} equal vehicles with rigid couplers,"
            f" because a vehicle of a consist has at most {LONGEST:g} m and {HEAVIEST:g} t."
        )
    checked(length / parts, "length", (SHORTEST, LONGEST), "m", source)
    checked(mass / parts, "mass", (LIGHTEST, HEAVIEST), "t", source)
    return divided(row, parts)


def counted(rows: list[Row]) -> list[Row]:
    """Return rows with equal neighbours as one row with their count."""
    found: list[Row] = []
    for row in rows:
        bare = {name: value for name, value in row.items() if name != "count"}
        count = int(row.get("count", 1))
        last = {name: value for name, value in found[-1].items() if name != "count"} if found else None
        if bare == last and bare.get("valve") not in ("head", "second"):
            found[-1]["count"] += count
        else:
            found.append({**bare, "count": count})
    return [{name: value for name, value in row.items() if (name, value) != ("count", 1)} for row in found]


def with_head(rows: list[Row], notes: Notes) -> list[Row]:
    """Return rows in which a vehicle has the driver's valve: a locomotive, otherwise the first vehicle."""
    if not rows or any(row["kind"] == "locomotive" or row.get("valve") == "head" for row in rows):
        return rows
    notes.vehicle = ""
    notes.assumed("No vehicle is a locomotive; the first one has the driver's valve (valve = head).")
    first, count = dict(rows[0]), int(rows[0].get("count", 1))
    first.pop("count", None)
    rest = [{**first, "count": count - 1}] if count > 1 else []
    return [{**first, "valve": "head"}, *rest, *rows[1:]]


def whole_train(rows: list[Row], notes: Notes, source: str) -> list[Row]:
    """Return the rows of a train: counted, with a driver's valve. Raises FileError for none or too many vehicles."""
    vehicles = sum(int(row.get("count", 1)) for row in rows)
    if not 1 <= vehicles <= MOST:
        raise FileError(f"{source} must have 1 to {MOST} vehicles; got {vehicles}. Correct the file.")
    return with_head(counted(rows), notes)


def named_number(value: Any, name: str, source: str) -> float:
    """Return the finite number of a field. Raises FileError, whose message begins with `source`."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise FileError(f"{source}: {name} must be a number; got {shown(value)}. Correct it.")
    return float(value)
