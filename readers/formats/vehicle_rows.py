"""Rows of vehicles as importers make them: equal neighbours counted, long vehicles divided, a driver's valve.

Forces of motors over speed become the tables of a consist, which have at most eight points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from readers.import_account import Notes, Row
from readers.text import FileError, shown

#: Largest number of points, speed [km/h] and force [kN]; those of consist files.
POINTS, FASTEST, STRONGEST = 8, 1000.0, 2000.0
#: Least distance of two speeds of such a table [km/h].
CLOSEST = 0.001
#: Deviation from the forces of a file, over the largest one, that is not reported.
SMALL = 1e-3


def drive_table(column: str, points: Sequence[tuple[float, float]], field: str, notes: Notes) -> Row:
    """Return a row with a table of a drive, or an empty one if the points are not such a table.

    Takes points [km/h].
    """
    if not is_table(points):
        notes.left(
            f"{field}: it is not two points or more with speeds that rise by {CLOSEST:g} km/h, to {FASTEST:g} km/h at "
            f"most, and forces from 0 to {STRONGEST:g} kN."
        )
        return {}
    speeds, forces = (np.array(column) for column in zip(*points, strict=True))
    chosen, deviation = fewer(speeds, forces, POINTS)
    text = " ".join(f"{rounded(speeds[n]):.10g}:{rounded(1e-3 * forces[n]):.10g}" for n in chosen)
    notes.converted(f"{field} -> {column} [km/h:kN]; at constant power above its last speed")
    tell_deviation(field, len(chosen), len(points), deviation / forces.max(), notes)
    return {column: text}


def tell_deviation(field: str, chosen: int, points: int, deviation: float, notes: Notes) -> None:
    """Report the deviation of a table of fewer points from the forces of a file, over the largest one."""
    if deviation > SMALL:
        notes.converted(
            f"{field}: {chosen} of {points} points; the force deviates by up to {100 * deviation:.1f} % of the largest "
            "one."
        )


def is_table(points: Sequence[tuple[float, float]]) -> bool:
    """Return whether points are such a table: speeds [km/h] that rise, and forces [N], within their limits."""
    right = len(points) >= 2 and all(0.0 <= v <= FASTEST and 0.0 <= f <= 1e3 * STRONGEST for v, f in points)
    return right and all(b[0] - a[0] >= CLOSEST for a, b in pairwise(points)) and max(f for _, f in points) > 0.0


def fewer(speeds: np.ndarray, forces: np.ndarray, most: int) -> tuple[list[int], float]:
    """Return the numbers of at most `most` points, and the largest deviation of the lines between them.

    The point that deviates most is added until all are there or `most` are (Douglas and Peucker 1973).
    """
    chosen = [0, len(speeds) - 1]
    while True:
        off = np.abs(np.interp(speeds, speeds[chosen], forces[chosen]) - forces)
        if len(chosen) == min(most, len(speeds)) or not off.any():
            return chosen, float(off.max())
        chosen = sorted([*chosen, int(off.argmax())])


def with_motors(row: Row, motors: Row, notes: Notes) -> Row:
    """Return a row with motors, unless the file states wheels without rotating mass, which motors would spin up."""
    if motors and row.get("rotating") == 0.0:
        notes.left("Motors: the file states no rotating mass. State rotating and the motors yourself.")
        return row
    return row | motors


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
    "brake_weight",
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


def printable(name: Any, default: str) -> str:
    """Return a name as a consist may have it, or the default if nothing is left of it."""
    return "".join(one if one.isprintable() else " " for one in str(name))[:60].strip() or default
