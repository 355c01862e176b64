"""Points of a track's centre from a table or an array: checked, in metres, without repetitions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbd_model.track.projection import transverse_mercator
from readers.columns import Column
from readers.tables import read_table
from readers.text import BadInputError, FileError, shown

Numbers = NDArray[np.float64]
#: Fewest and most points, largest coordinate [m].
FEWEST, MOST, FARTHEST = 8, 200_000, 1e8
#: Points closer than this are one point [m]. Limits of the usual distance of points [m].
SAME, CLOSEST, WIDEST = 1e-3, 0.01, 100.0
COLUMNS = (
    *(Column(name, "m", -FARTHEST, FARTHEST) for name in ("x", "y", "z", "easting", "northing", "height")),
    Column("latitude", "deg", -84.0, 84.0),
    Column("longitude", "deg", -180.0, 180.0),
)
KNOWN = {column.name for column in COLUMNS}
#: Names of both coordinates in plan, and of the height.
PLANS, HEIGHTS = (("x", "y"), ("easting", "northing"), ("latitude", "longitude")), ("z", "height")


@dataclass(frozen=True, eq=False)
class Points:
    """Points in their order along the track.

    Attributes
    ----------
    source : str
        Where they are from, for messages.
    plan : array, shape (n, 2)
        East and north [m], from the first point.
    height : array, shape (n,), optional
        Height [m].
    places : array of int, shape (n,)
        Row of each point in its file, or its number from 1.
    taken, converted, assumed, left : tuple of str
        Use of the input.
    """

    source: str
    plan: Numbers
    height: Numbers | None
    places: NDArray[np.int64]
    taken: tuple[str, ...]
    converted: tuple[str, ...]
    assumed: tuple[str, ...]
    left: tuple[str, ...] = ()


def points_of(given: str | Path | ArrayLike) -> Points:
    """Return points from a file or an array."""
    if isinstance(given, str | Path):
        return _from_file(given)
    try:
        array = np.asarray(given)
    except ValueError:
        array = np.empty(0, object)
    if array.ndim != 2 or array.shape[1] not in (2, 3) or array.dtype.kind not in "iuf" or np.ma.is_masked(given):
        raise BadInputError(
            "points must be a path or numbers of shape (points, 2) or (points, 3); got an array of "
            f"{array.dtype} and shape {array.shape}. Give x, y and z in columns."
        )
    numbers = array.astype(float)
    if not np.all(np.abs(numbers) <= FARTHEST):
        row = int(np.flatnonzero(~np.all(np.abs(numbers) <= FARTHEST, axis=1))[0])
        raise BadInputError(f"points must be finite numbers up to 1e8 m; got {numbers[row].tolist()} in row {row + 1}.")
    height = numbers[:, 2] if array.shape[1] == 3 else None
    return _checked("points", numbers[:, :2], height, np.arange(1, array.shape[0] + 1), (), BadInputError)


def _from_file(path: str | Path) -> Points:
    table = read_table(path, COLUMNS, others=True, most_rows=MOST)
    columns = table.numbers
    found = [pair for pair in PLANS if pair[0] in columns or pair[1] in columns]
    if len(found) != 1 or not all(name in columns for name in found[0]):
        raise FileError(
            f"{path} must have the columns x and y, easting and northing, or latitude and longitude; got "
            f"{', '.join(columns)}. Name both coordinates."
        )
    heights = [name for name in HEIGHTS if name in columns]
    if len(heights) > 1:
        raise FileError(f"{path} must have one height; got z and height. Remove one of them.")
    plan = np.column_stack([columns[name] for name in found[0]])
    converted: tuple[str, ...] = ()
    if found[0] == PLANS[2]:
        plan, told = transverse_mercator(*plan.T)
        converted = (told,)
    height = columns[heights[0]] if heights else None
    points = _checked(str(path), plan, height, table.places, converted, FileError)
    left = [shown(name) for name in columns if name not in KNOWN]
    return replace(points, left=(f"columns {', '.join(left)}: they are not used",)) if left else points


def _checked(
    source: str, plan: Numbers, height: Numbers | None, places: Any, converted: tuple[str, ...], error: type[ValueError]
) -> Points:
    """Return points without repetitions. Raises `error` if they are not a line."""
    ways = np.hypot(*np.diff(plan, axis=0).T)
    keep = np.append(True, ways >= SAME)
    assumed: tuple[str, ...] = ()
    if dropped := int(np.count_nonzero(~keep)):
        row = int(places[np.flatnonzero(~keep)[0]])
        assumed = (f"{dropped} points within 1 mm of the one before are left out, the first in row {row}",)
        plan, places, height = plan[keep], places[keep], None if height is None else height[keep]
    count = places.size
    if not FEWEST <= count <= MOST and not (dropped and count + dropped >= FEWEST and ways.max() < CLOSEST):
        raise error(f"{source} must have {FEWEST} to {MOST} different points; got {count}. Check the file.")
    usual = float(np.median(ways[keep[1:]])) if count > 1 else 0.0
    if not CLOSEST <= usual <= WIDEST:
        hint = "Name degrees latitude and longitude" if usual < CLOSEST else "Give a unit, as in x [km], or more points"
        raise error(
            f"{source}: points must be {CLOSEST:g} to {WIDEST:g} m apart; got {usual:.4g} m as the median. {hint}."
        )
    ways = np.hypot(*np.diff(plan, axis=0).T)
    _check_order(source, plan, ways, places, error)
    origin = plan[0]
    taken = f"{count} points of {source}, {usual:.3g} m apart (median), {ways.max():.4g} m at most"
    if np.hypot(*(plan[-1] - origin)) <= 2.0 * usual and count > 20:
        assumed += ("the line begins and ends at the same place: a loop, cut there",)
    return Points(source, plan - origin, height, places, (taken,), converted, assumed)


def _check_order(source: str, plan: Numbers, ways: Numbers, places: Any, error: type[ValueError]) -> None:
    steps = np.diff(plan, axis=0)
    cosine = np.sum(steps[1:] * steps[:-1], axis=1) / (ways[1:] * ways[:-1])
    back = np.flatnonzero(cosine < 0.0)
    if back.size:
        row = int(back[0]) + 1
        angle = np.degrees(np.arccos(np.clip(cosine[row - 1], -1.0, 1.0)))
        raise error(
            f"{source}, row {places[row]}: points must follow the line; got a turn by {angle:.0f} degrees between "
            f"{ways[row - 1]:.4g} m before and {ways[row]:.4g} m after. Sort the points, or leave out some that are "
            "closer than their noise."
        )
