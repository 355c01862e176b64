"""The profile of a LandXML alignment: points of vertical intersection with parabolas and circles.

A circle of radius R touches both tangents R tan(a / 2) before and after the point, measured along them; a is the angle
between them. In stations these lengths are multiplied by the cosine of each tangent's slope.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from itertools import pairwise

from readers.alignment import SHORTEST, Piece, may_touch
from readers.formats.line_tracks import listed
from readers.import_account import Account
from readers.text import FileError, shown
from readers.xml_files import inside, name_of, required, value_of

LONGEST, LARGEST_RADIUS = 1e7, 1e12
POINTS = ("PVI", "ParaCurve", "CircCurve", "UnsymParaCurve")


@dataclass(frozen=True)
class Point:
    """A point of vertical intersection: station and height, lengths of its curve before and after it, radius [m]."""

    station: float
    height: float
    before: float = 0.0
    after: float = 0.0
    radius: float = 0.0


def gradients_of(
    element: ET.Element, source: str, unit: float, begin: float, end: float, account: Account
) -> list[Piece]:
    """Return the gradients along the plan from `begin` to `end` [m]. Raises FileError."""
    profiles = [one for one in inside(element, "ProfAlign") if any(point.tag in POINTS for point in one)]
    if not profiles:
        account.assumed.append("the gradient is 0: the alignment has no ProfAlign")
        return []
    if len(profiles) > 1:
        names = listed(one.get("name", "") for one in profiles[1:])
        account.left.append(f"profiles {names}: the first, {shown(profiles[0].get('name'))}, is read")
    points = [_point(one, unit, source) for one in profiles[0] if one.tag in POINTS]
    points = _apart(points, f"{source}: {name_of(profiles[0])}", account)
    if len(points) < 2:
        raise FileError(f"{source}: {name_of(profiles[0])} must have at least 2 points; got {len(points)}. Add points.")
    slopes = [(after.height - before.height) / (after.station - before.station) for before, after in pairwise(points)]
    points = [points[0], *map(_round, points[1:-1], slopes, slopes[1:]), points[-1]]
    points = _fitted(points, source, account)
    account.converted.append(f"profile of {len(points)} points: gradients between them, linear over vertical curves")
    pieces = _pieces(points, slopes)
    if begin < pieces[0].begin - SHORTEST or end > pieces[-1].end + SHORTEST:
        account.assumed.append(
            f"the profile reaches from {pieces[0].begin:.3f} to {pieces[-1].end:.3f} m, the elements from {begin:.3f} "
            f"to {end:.3f} m: the gradient is 0 beyond it"
        )
    return [cut for one in pieces if (cut := _cut(one, begin, end)) is not None]


def _point(one: ET.Element, unit: float, source: str) -> Point:
    numbers = (one.text or "").split()
    what = f"{source}: {name_of(one)}"
    if len(numbers) != 2:
        raise FileError(f"{what} must hold station and height; got {shown(one.text or '')}. Correct it.")
    station, height = (unit * value_of(text, what, LONGEST) for text in numbers)
    if one.tag == "UnsymParaCurve":
        lengths = [unit * required(one, name, source, LONGEST) for name in ("lengthIn", "lengthOut")]
        return Point(station, height, *lengths)
    if one.tag == "CircCurve":
        return Point(station, height, radius=abs(unit * required(one, "radius", source, LARGEST_RADIUS)))
    half = unit * required(one, "length", source, LONGEST) / 2.0 if one.tag == "ParaCurve" else 0.0
    return Point(station, height, half, half)


def _apart(points: list[Point], what: str, account: Account) -> list[Point]:
    """Return the points with different places, those at both ends without curves. Raises FileError."""
    found: list[Point] = []
    for one in points:
        way = one.station - found[-1].station if found else math.inf
        if way <= -SHORTEST or (way < SHORTEST and abs(one.height - found[-1].height) > SHORTEST):
            raise FileError(
                f"{what}: stations must grow, and points closer than {SHORTEST:g} m must have one height; got "
                f"{one.station:.10g} m, {one.height:.10g} m after {found[-1].station:.10g} m, "
                f"{found[-1].height:.10g} m. Sort or remove them."
            )
        if way >= SHORTEST:
            found.append(one)
        elif _is_curve(one):
            if _is_curve(found[-1]):
                raise FileError(f"{what}: a point must have one vertical curve; got 2 at {one.station:.10g} m.")
            found[-1] = one
    if len(found) < len(points):
        account.left.append(f"{len(points) - len(found)} points of the profile within {SHORTEST:g} m of another one")
    ends = [number for number in {0, len(found) - 1} if _is_curve(found[number])]
    for number in ends:
        found[number] = Point(found[number].station, found[number].height)
        account.left.append(f"the vertical curve at {found[number].station:.3f} m: one of its tangents is missing")
    return found


def _is_curve(point: Point) -> bool:
    return point.before + point.after + point.radius > 0.0


def _round(point: Point, before: float, after: float) -> Point:
    """Return a point with the lengths of its circle between two slopes."""
    if not point.radius:
        return point
    angles = math.atan(before), math.atan(after)
    along = point.radius * math.tan(abs(angles[1] - angles[0]) / 2.0)
    return replace(point, before=along * math.cos(angles[0]), after=along * math.cos(angles[1]))


def _fitted(points: list[Point], source: str, account: Account) -> list[Point]:
    """Return the points with touching curves shortened where they overlap by rounding. Raises FileError."""
    found, most = list(points), 0.0
    for number, (before, after) in enumerate(pairwise(points)):
        way, taken = after.station - before.station, before.after + after.before
        if not may_touch(taken, way):
            raise FileError(
                f"{source}: vertical curves must not overlap; got {taken - way:.3f} m of overlap before "
                f"{after.station:.10g} m. Correct their lengths."
            )
        if taken > way:
            most, share = max(most, taken - way), way / taken
            found[number] = replace(found[number], after=share * before.after)
            found[number + 1] = replace(after, before=share * after.before)
    if most > SHORTEST:
        account.assumed.append(f"vertical curves overlap by up to {most:.3f} m, as rounded numbers do: they touch")
    return found


def _pieces(points: list[Point], slopes: list[float]) -> list[Piece]:
    pieces: list[Piece] = []
    for number, slope in enumerate(slopes):
        before, after = points[number], points[number + 1]
        first, last = before.station + before.after, after.station - after.before
        if number and before.before + before.after >= SHORTEST:
            # two parabolas with a common gradient where they meet; it is the same one if both are equally long
            whole, change = before.before + before.after, slope - slopes[number - 1]
            middle = slopes[number - 1] + change * before.after / whole
            pieces.append(Piece(before.station - before.before, before.station, slopes[number - 1], middle))
            pieces.append(Piece(before.station, first, middle, slope))
        if last - first >= SHORTEST:
            pieces.append(Piece(first, last, slope, slope))
    return [one for one in pieces if one.end - one.begin >= SHORTEST]


def _cut(one: Piece, begin: float, end: float) -> Piece | None:
    """Return the part of a piece between two places, None if it has none."""
    first, last = max(one.begin, begin), min(one.end, end)
    if last - first < SHORTEST:
        return None
    steep = (one.last - one.first) / (one.end - one.begin)
    return Piece(first, last, one.first + steep * (first - one.begin), one.first + steep * (last - one.begin))
