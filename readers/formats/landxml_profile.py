"""The profile of a LandXML alignment: points of vertical intersection with parabolas and circles."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from itertools import pairwise

from readers.account import Account
from readers.alignment import Piece
from readers.formats.line_tracks import listed
from readers.formats.xml_numbers import name_of, required, value_of
from readers.text import FileError, shown
from readers.xml_files import inside

LONGEST = 1e7
POINTS = ("PVI", "ParaCurve", "CircCurve", "UnsymParaCurve")
#: Shortest piece [m].
SHORTEST = 0.01


@dataclass(frozen=True)
class Point:
    """A point of vertical intersection: station and height [m], lengths of its curve before and after it [m]."""

    station: float
    height: float
    before: float = 0.0
    after: float = 0.0


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
    points = _with_circles(profiles[0], points, unit, source)
    slopes = []
    for before, after in pairwise(points):
        if not after.station - before.station >= SHORTEST:
            raise FileError(
                f"{source}: stations of {name_of(profiles[0])} must grow; got {after.station:.10g} m after "
                f"{before.station:.10g} m. Sort them."
            )
        slopes.append((after.height - before.height) / (after.station - before.station))
    if not slopes:
        raise FileError(f"{source}: {name_of(profiles[0])} must have at least 2 points; got {len(points)}. Add points.")
    account.converted.append(f"profile of {len(points)} points: gradients between them, linear over vertical curves")
    pieces = _pieces(points, slopes, source)
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
    half = unit * required(one, "length", source, LONGEST) / 2.0 if one.tag == "ParaCurve" else 0.0
    return Point(station, height, half, half)


def _with_circles(profile: ET.Element, points: list[Point], unit: float, source: str) -> list[Point]:
    """Return the points, circles among them with R |change of gradient| / 2 before and after, as parabolas."""
    found = list(points)
    elements = [one for one in profile if one.tag in POINTS]
    for number in range(1, len(points) - 1):
        if elements[number].tag == "CircCurve":
            before, own, after = points[number - 1 : number + 2]
            ways = own.station - before.station, after.station - own.station
            if min(ways) < SHORTEST:
                continue  # refused with the stations
            change = (after.height - own.height) / ways[1] - (own.height - before.height) / ways[0]
            half = abs(unit * required(elements[number], "radius", source, LONGEST) * change) / 2.0
            found[number] = Point(own.station, own.height, half, half)
    return found


def _pieces(points: list[Point], slopes: list[float], source: str) -> list[Piece]:
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
        if last < first - SHORTEST:
            raise FileError(
                f"{source}: vertical curves must not overlap; got {first - last:.3f} m of overlap before "
                f"{after.station:.10g} m. Correct their lengths."
            )
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
