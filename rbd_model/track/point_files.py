"""Points of a track's centre from a table, a map, a receiver or an array: checked, in metres, without repetitions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbd_model.track.points import FEWEST, SAME, Points, forwards, ways_of
from rbd_model.track.projection import unrolled
from readers.column_names import TEXT
from readers.columns import Column
from readers.formats.lines import read_foreign_line
from readers.formats.osm_tags import gradient_in, speed_in, unread
from readers.formats.ways import LATITUDE, LONGITUDE, Course
from readers.import_account import Account
from readers.tables import read_table
from readers.text import BadInputError, FileError, shown

Numbers = NDArray[np.float64]
#: Most points, largest coordinate [m].
MOST, FARTHEST = 200_000, 1e8
#: Limits of the usual distance of points [m], and of those in degrees.
CLOSEST, WIDEST, WIDEST_IN_DEGREES = 0.01, 100.0, 1000.0
#: Largest gap between points [m]. Gap that is reported: metres, and times the median distance.
LARGEST_GAP, GAP, GAP_TIMES = 10_000.0, 300.0, 10.0
#: Names of both coordinates in plan, and of the height, each with others that people use.
EAST, NORTH, HEIGHT = ("x", "easting"), ("y", "northing"), ("z", "height", "ele", "elevation", "alt", "altitude")
LATITUDES = ("latitude", "lat")
LONGITUDES = ("longitude", "lon", "lng", "long")
COLUMNS = (
    *(Column(name, "m", -FARTHEST, FARTHEST) for name in (*EAST, *NORTH, *HEIGHT)),
    *(Column(name, "deg", -LATITUDE, LATITUDE) for name in LATITUDES),
    *(Column(name, "deg", -LONGITUDE, LONGITUDE) for name in LONGITUDES),
)
KNOWN = {column.name for column in COLUMNS}
#: Names that make a table one of points.
NAMES = KNOWN - set(HEIGHT)


def points_of(given: str | Path | ArrayLike, tracks: Sequence[str] = ()) -> Points:
    """Return points from a file or an array; tracks: those of a map or receiver."""
    if isinstance(given, str | Path):
        found = read_foreign_line(Path(given), tracks)
        if isinstance(found, Course):
            return points_of_course(found)
        if found is not None:
            raise FileError(f"{given} must have points; it has the line of another program. Use line_from_file.")
    if tracks:
        raise BadInputError("tracks must be given for files of maps and receivers alone. Leave them out.")
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
    places = np.arange(1, array.shape[0] + 1)
    return _checked(Points("points", numbers[:, :2], height, places, Account()), BadInputError)


def _from_file(path: str | Path) -> Points:
    table = read_table(path, COLUMNS, others=TEXT, most_rows=MOST)
    columns = table.numbers
    pairs = [*zip(EAST, NORTH, strict=True), *((one, other) for one in LATITUDES for other in LONGITUDES)]
    found = [pair for pair in pairs if set(pair) <= set(columns)]
    if len(found) != 1 or len(NAMES & set(columns)) > 2:
        raise FileError(
            f"{path} must have the columns x and y, easting and northing, or latitude and longitude; got "
            f"{', '.join([*columns, *table.words])}. Name both coordinates."
        )
    heights = [name for name in HEIGHT if name in columns]
    if len(heights) > 1:
        raise FileError(f"{path} must have one height; got {' and '.join(heights)}. Remove one of them.")
    first, second = (columns[name] for name in found[0])
    height = columns[heights[0]] if heights else None
    left = [f"columns {', '.join(shown(name) for name in table.words)}: they are not used"] if table.words else []
    account = Account(converted=list(table.meant), left=left)
    if found[0][0] in EAST:
        points = Points(str(path), np.column_stack([first, second]), height, table.places, account)
        return _checked(points, FileError)
    points = Points(str(path), np.column_stack([first, second]), height, table.places, account, True, True)
    return _in_metres(points)


def points_of_course(course: Course) -> Points:
    """Return the points of a course in degrees."""
    stretches = []
    for first, last, tags, back in course.stretches:
        course.account.left += [one for one in unread(tags, back) if one not in course.account.left]
        stretches.append((first + 1, last + 1, gradient_in(tags, back), speed_in(tags, back)))
    latitude, longitude, height = course.places.T
    heights, places = _filled(height, course.account), np.arange(1, latitude.size + 1)
    plan = np.column_stack([latitude, longitude])
    account, recorded = course.account, course.recorded
    return _in_metres(Points(course.source, plan, heights, places, account, True, recorded, stretches, "point"))


def _filled(height: Numbers, account: Account) -> Numbers | None:
    """Return heights without gaps, None if most are unknown."""
    known = np.isfinite(height)
    count, missing = np.arange(height.size), int(np.count_nonzero(~known))
    if 2 * missing > height.size:
        if missing < height.size:
            account.left.append(f"heights: {missing} of {height.size} points have none")
        return None
    if missing:
        account.assumed.append(f"missing heights, {missing} of {height.size}, lie between their neighbours")
    return np.asarray(np.interp(count, count[known], height[known]))


def _in_metres(points: Points) -> Points:
    """Return points whose plan has latitude and longitude [degrees]."""
    latitude, longitude = points.plan.T
    ends = " to ".join(f"{latitude[at]:.5f}, {longitude[at]:.5f}" for at in (0, -1) if latitude.size)
    points.account.converted.append(f"latitude and longitude, from {ends}: unrolled from WGS 84 along the course")
    if points.height is None:
        points.account.assumed.append("lengths are those at sea level, 0.16 m/km too short at a height of 1000 m")
    height = 0.0 if points.height is None else points.height
    return _checked(replace(points, plan=unrolled(latitude, longitude, height)), FileError)


def _checked(points: Points, error: type[ValueError]) -> Points:
    """Return points without repetitions. Raises `error` if they are not a line."""
    source, account = points.source, points.account
    ways = ways_of(points)
    keep = np.append(True, ways >= SAME)[: points.places.size]
    if dropped := int(np.count_nonzero(~keep)):
        row = int(points.places[np.flatnonzero(~keep)[0]])
        account.assumed.append(
            f"{dropped} points within 1 mm of the one before are left out, the first in {points.word} {row}"
        )
        points = points.kept(keep)
    count = points.places.size
    if not FEWEST <= count <= MOST and not (dropped and count + dropped >= FEWEST and ways.max() < CLOSEST):
        raise error(f"{source} must have {FEWEST} to {MOST} different points; got {count}. Check the file.")
    usual = float(np.median(ways[keep[1:]])) if count > 1 else 0.0
    widest = WIDEST_IN_DEGREES if points.rough else WIDEST
    if not CLOSEST <= usual <= widest:
        hint = "Name degrees latitude and longitude" if usual < CLOSEST else "Give a unit, as in x [km], or more points"
        raise error(
            f"{source}: points must be {CLOSEST:g} to {widest:g} m apart; got {usual:.4g} m as the median. {hint}."
        )
    if ways.max() > LARGEST_GAP:
        place = f"{points.word} {points.places[np.argmax(ways_of(points))]}"
        raise error(
            f"{source}: points must be at most {LARGEST_GAP / 1e3:g} km apart; got {ways.max() / 1e3:.4g} km behind "
            f"{place}. Check the points there, or split the file."
        )
    points = forwards(points, error)
    ways = ways_of(points)
    usual = float(np.median(ways))
    account.taken.append(
        f"{points.places.size} points of {source}, {usual:.3g} m apart (median), {ways.max():.4g} m at most"
    )
    if points.recorded and ways.max() > max(GAP, GAP_TIMES * usual):
        place = f"{points.word} {points.places[np.argmax(ways)]}"
        account.assumed.append(f"the line is a smooth curve over the gap of {ways.max():.4g} m behind {place}")
    if np.hypot(*(points.plan[-1] - points.plan[0])) <= 2.0 * usual and points.places.size > 20:
        account.assumed.append("the line begins and ends at the same place: a loop, cut there")
    return replace(points, plan=points.plan - points.plan[0])
