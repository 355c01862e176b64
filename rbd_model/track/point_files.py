"""Points of a track's centre from a table, a map, a receiver or an array: checked, in metres, without repetitions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbd_model.track.projection import unrolled
from readers.column_names import TEXT
from readers.columns import Column
from readers.formats.maps import read_map
from readers.formats.osm_tags import gradient_in, speed_in, unread
from readers.formats.ways import LATITUDE, LONGITUDE, Course
from readers.import_account import Account
from readers.tables import read_table
from readers.text import BadInputError, FileError, shown

Numbers = NDArray[np.float64]
#: Fewest and most points, largest coordinate [m].
FEWEST, MOST, FARTHEST = 8, 200_000, 1e8
#: Points closer than this are one point [m]. Limits of the usual distance of points [m], and of those in degrees.
SAME, CLOSEST, WIDEST, WIDEST_IN_DEGREES = 1e-3, 0.01, 100.0, 1000.0
#: Receivers that stand: so many points within a radius of their mean [m] are one.
SEVERAL, RADIUS = 4, 20.0
#: Distance of neighbours that are averaged where a receiver turns back [m], share of points that may be jumps.
NEIGHBOURS, MOST_JUMPS = 40.0, 0.01
#: Largest gap between points [m]. Gap that is told: metres, and times the median distance.
LARGEST_GAP, GAP, GAP_TIMES = 10_000.0, 300.0, 10.0
#: Names of both coordinates in plan, and of the height, each with others that people use.
EAST, NORTH, HEIGHT = ("x", "easting"), ("y", "northing"), ("z", "height", "ele", "elevation", "alt", "altitude")
LATITUDES = ("latitude", "lat", "breite", "breitengrad")
LONGITUDES = ("longitude", "lon", "lng", "long", "laenge", "l\u00e4nge", "laengengrad", "l\u00e4ngengrad")
COLUMNS = (
    *(Column(name, "m", -FARTHEST, FARTHEST) for name in (*EAST, *NORTH, *HEIGHT)),
    *(Column(name, "deg", -LATITUDE, LATITUDE) for name in LATITUDES),
    *(Column(name, "deg", -LONGITUDE, LONGITUDE) for name in LONGITUDES),
)
KNOWN = {column.name for column in COLUMNS}
#: Names that make a table one of points.
NAMES = KNOWN - set(HEIGHT)


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
    account : Account
        Use of the input.
    rough : bool
        Whether the points are of a map or a receiver, with noise of metres and correlated heights.
    recorded : bool
        Whether points that lie far beside the line are left out.
    stretches : list
        First and last place, rise per metre and limit of speed [m/s] that a map states, None if it does not.
    """

    source: str
    plan: Numbers
    height: Numbers | None
    places: NDArray[np.int64]
    account: Account
    rough: bool = False
    recorded: bool = False
    stretches: Sequence[tuple[int, int, float | None, float | None]] = ()

    @property
    def word(self) -> str:
        """Word for the place of a point in its file."""
        return "point" if self.rough else "row"

    def kept(self, keep: NDArray[np.bool_]) -> Points:
        """Return some of the points."""
        height = None if self.height is None else self.height[keep]
        return replace(self, plan=self.plan[keep], height=height, places=self.places[keep])


def points_of(given: str | Path | ArrayLike, tracks: Sequence[str] = ()) -> Points:
    """Return points from a file or an array; tracks: those of a map or receiver."""
    if isinstance(given, str | Path):
        course = read_map(Path(given), tracks)
        return points_of_course(course) if course else _from_file(given)
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
    account = Account(left=left)
    if found[0][0] in EAST:
        points = Points(str(path), np.column_stack([first, second]), height, table.places, account)
        return _checked(points, FileError)
    return _in_degrees(str(path), first, second, height, table.places, account, True, ())


def points_of_course(course: Course) -> Points:
    """Return the points of a course in degrees."""
    stretches = []
    for first, last, tags, back in course.stretches:
        course.account.left += [one for one in unread(tags, back) if one not in course.account.left]
        stretches.append((first + 1, last + 1, gradient_in(tags, back), speed_in(tags, back)))
    latitude, longitude, height = course.places.T
    heights = _filled(height, course.account)
    places = np.arange(1, latitude.size + 1)
    return _in_degrees(course.source, latitude, longitude, heights, places, course.account, course.recorded, stretches)


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


def _in_degrees(
    source: str,
    latitude: Numbers,
    longitude: Numbers,
    height: Numbers | None,
    places: NDArray[np.int64],
    account: Account,
    recorded: bool,
    stretches: Sequence[tuple[int, int, float | None, float | None]],
) -> Points:
    plan = unrolled(latitude, longitude, 0.0 if height is None else height)
    ends = " to ".join(f"{latitude[at]:.5f}, {longitude[at]:.5f}" for at in (0, -1))
    account.converted.append(f"latitude and longitude, from {ends}: unrolled from WGS 84 along the course")
    if height is None:
        account.assumed.append("lengths are those at sea level, 0.16 m/km too short at a height of 1000 m")
    points = Points(source, plan, height, places, account, True, recorded, stretches)
    return _checked(points, FileError)


def _checked(points: Points, error: type[ValueError]) -> Points:
    """Return points without repetitions. Raises `error` if they are not a line."""
    source, account = points.source, points.account
    ways = _ways(points)
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
        place = f"{points.word} {points.places[np.argmax(_ways(points))]}"
        raise error(
            f"{source}: points must be at most {LARGEST_GAP / 1e3:g} km apart; got {ways.max() / 1e3:.4g} km behind "
            f"{place}. Check the points there, or split the file."
        )
    points = _forwards(points, error)
    ways = _ways(points)
    usual = float(np.median(ways))
    account.taken.append(
        f"{points.places.size} points of {source}, {usual:.3g} m apart (median), {ways.max():.4g} m at most"
    )
    if points.recorded and ways.max() > max(GAP, GAP_TIMES * usual):
        row = int(points.places[np.argmax(ways)])
        account.assumed.append(f"the line is a smooth curve over the gap of {ways.max():.4g} m behind point {row}")
    if np.hypot(*(points.plan[-1] - points.plan[0])) <= 2.0 * usual and points.places.size > 20:
        account.assumed.append("the line begins and ends at the same place: a loop, cut there")
    return replace(points, plan=points.plan - points.plan[0])


def _ways(points: Points) -> Numbers:
    return np.asarray(np.hypot(*np.diff(points.plan, axis=0).T))


def _forwards(points: Points, error: type[ValueError]) -> Points:
    """Return points that do not turn back. Those of receivers do so where it stands, and are joined there."""
    count, jumps, back = points.places.size, 0, _turns_back(points)
    group = np.column_stack([np.ones(count), np.zeros(count)])
    if back.size and points.recorded:
        points, group = _at_rest(points)
        back = _turns_back(points)
    before = 0
    while back.size and points.recorded and points.places.size != before and jumps <= MOST_JUMPS * count:
        before = points.places.size
        points, group, left = _joined(points, group, back)
        back, jumps = _turns_back(points), jumps + left
    if back.size:
        raise _refusal(points, back, error)
    if jumps:
        points.account.assumed.append(f"points that jump by more than {NEIGHBOURS:g} m and back are left out: {jumps}")
    if joined := count - jumps - points.places.size:
        points.account.converted.append(f"{joined} of {count} points turn back and are averaged with those beside them")
    if points.places.size < FEWEST:
        limit = f"{FEWEST} points along a line"
        raise error(f"{points.source} must have {limit}; got {points.places.size}. Check the file.")
    return points


def _at_rest(points: Points) -> tuple[Points, Numbers]:
    """Return points of which SEVERAL and more within RADIUS of their mean are one, with weight and spread of each."""
    rows = _rows(points)
    found, first, group, begin = [], [], [], 0
    total = rows[0].copy()
    for at in range(1, len(rows) + 1):
        count = at - begin
        if at < len(rows) and np.hypot(*(rows[at] - total / count)[:2]) < RADIUS:
            total += rows[at]
            continue
        alone = count < SEVERAL
        found += list(rows[begin:at]) if alone else [total / count]
        first += list(range(begin, at)) if alone else [begin]
        group += [(1.0, 0.0)] * count if alone else [(float(count), 0.0)]
        if at < len(rows):
            begin, total = at, rows[at].copy()
    return _moved(points, np.array(found), np.array(first)), np.array(group)


def _joined(points: Points, group: Numbers, back: NDArray[np.int64]) -> tuple[Points, Numbers, int]:
    """Return points of which those that turn back are averaged with their nearer neighbour, and the number of jumps.

    A jump is farther than NEIGHBOURS from both neighbours, which follow each other without it. It is left out. Points
    that are spread by more than twice that are not joined: there the vehicle turns back, not the noise.
    """
    rows, group, ways = _rows(points), group.copy(), _ways(points)
    keep, last, jumps = np.ones(len(rows), bool), -1, 0
    for at in back.tolist():
        near = at - 1 if ways[at - 1] <= ways[at] else at + 1
        if min(at, near) <= last:
            continue
        last = max(at, near)
        way, spread = min(ways[at - 1], ways[at]), group[at, 1] + group[near, 1]
        before, over = rows[at - 1] - rows[max(at - 2, 0)], rows[at + 1] - rows[at - 1]
        if way < NEIGHBOURS and way + spread < 2.0 * NEIGHBOURS:
            keep[at] = False
            rows[near] += (rows[at] - rows[near]) * group[at, 0] / (group[at, 0] + group[near, 0])
            group[near] = group[at, 0] + group[near, 0], way + spread
        elif way >= NEIGHBOURS and before[:2] @ over[:2] >= 0.0:
            keep[at] = False
            jumps += 1
    return _moved(points, rows[keep], np.flatnonzero(keep)), group[keep], jumps


def _rows(points: Points) -> Numbers:
    """Return plan and, if known, height in columns."""
    return np.column_stack([points.plan] if points.height is None else [points.plan, points.height])


def _moved(points: Points, rows: Numbers, first: NDArray[np.int64]) -> Points:
    """Return points at other places; first: number of each among those before."""
    height = None if points.height is None else rows[:, 2]
    return replace(points, plan=rows[:, :2], height=height, places=points.places[first])


def _turns_back(points: Points) -> NDArray[np.int64]:
    """Return the points at which the course turns by 90 degrees and more, or rests."""
    steps = np.diff(points.plan, axis=0)
    return np.flatnonzero(np.sum(steps[1:] * steps[:-1], axis=1) <= 0.0) + 1


def _refusal(points: Points, back: NDArray[np.int64], error: type[ValueError]) -> ValueError:
    """Return the error for points that turn back."""
    row, steps = int(back[0]), np.diff(points.plan, axis=0)
    before, after = np.hypot(*steps[row - 1]), np.hypot(*steps[row])
    cosine = steps[row - 1] @ steps[row] / (before * after) if before * after > SAME**2 else -1.0
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    place = f"{points.source}, {points.word} {points.places[row]}"
    return error(
        f"{place}: points must follow the line; got a turn by {angle:.0f} degrees between {before:.4g} m before and "
        f"{after:.4g} m after. Sort the points, or leave out some that are closer than their noise."
    )
