"""Forces of motors over speed as the tables of a consist, which have at most eight points."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from readers.formats.vehicle_rows import rounded
from readers.import_account import Notes, Row

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
