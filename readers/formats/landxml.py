"""Alignments of LandXML 1.0 to 2.0: elements in plan, cant stations and a profile.

Names and meanings are those of the schema LandXML-1.2. `rot` cw is a curve to the right, `radiusStart` INF is straight.
Stations and lengths are those of the plan. A ParaCurve is a parabola of a given length about its point of intersection.
Cant is stated in mm, or in inches if units are imperial, as writers of railway alignments do; the schema has no unit.
In LandXML 1.2 `length` of Line and Curve, and `radius` of Curve, are optional; Start, End and Center are not. Their
points are then read: northing and easting, and perhaps a height (LandXML-1.2.xsd, PointType).

A circle of radius R touches both tangents R tan(a / 2) before and after the point, measured along them; a is the angle
between them. In stations these lengths are multiplied by the cosine of each tangent's slope.
"""

from __future__ import annotations

import cmath
import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from readers.alignment import BLOSS, LINEAR, SHORTEST, Alignment, Piece, may_touch
from readers.formats.line_tracks import listed, tell_jumps
from readers.import_account import Account
from readers.text import FileError, shown
from readers.xml_files import attribute, inside, name_of, required, value_of

VERTICALS = ("PVI", "ParaCurve", "CircCurve", "UnsymParaCurve")


@dataclass(frozen=True)
class VerticalPoint:
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
    profiles = [one for one in inside(element, "ProfAlign") if any(point.tag in VERTICALS for point in one)]
    if not profiles:
        account.assumed.append("the gradient is 0: the alignment has no ProfAlign")
        return []
    if len(profiles) > 1:
        names = listed(one.get("name", "") for one in profiles[1:])
        account.left.append(f"profiles {names}: the first, {shown(profiles[0].get('name'))}, is read")
    points = [_vertical_point(profile, unit, source) for profile in profiles[0] if profile.tag in VERTICALS]
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
    return [cut for piece in pieces if (cut := _cut(piece, begin, end)) is not None]


def _vertical_point(one: ET.Element, unit: float, source: str) -> VerticalPoint:
    numbers = (one.text or "").split()
    what = f"{source}: {name_of(one)}"
    if len(numbers) != 2:
        raise FileError(f"{what} must hold station and height; got {shown(one.text or '')}. Correct it.")
    station, height = (unit * value_of(text, what, LONGEST) for text in numbers)
    if one.tag == "UnsymParaCurve":
        lengths = [unit * required(one, name, source, LONGEST) for name in ("lengthIn", "lengthOut")]
        return VerticalPoint(station, height, *lengths)
    if one.tag == "CircCurve":
        return VerticalPoint(station, height, radius=abs(unit * required(one, "radius", source, LARGEST_RADIUS)))
    half = unit * required(one, "length", source, LONGEST) / 2.0 if one.tag == "ParaCurve" else 0.0
    return VerticalPoint(station, height, half, half)


def _apart(points: list[VerticalPoint], what: str, account: Account) -> list[VerticalPoint]:
    """Return the points with different places, those at both ends without curves. Raises FileError."""
    found: list[VerticalPoint] = []
    for point in points:
        way = point.station - found[-1].station if found else math.inf
        if way <= -SHORTEST or (way < SHORTEST and abs(point.height - found[-1].height) > SHORTEST):
            raise FileError(
                f"{what}: stations must grow, and points closer than {SHORTEST:g} m must have one height; got "
                f"{point.station:.10g} m, {point.height:.10g} m after {found[-1].station:.10g} m, "
                f"{found[-1].height:.10g} m. Sort or remove them."
            )
        if way >= SHORTEST:
            found.append(point)
        elif _is_curve(point):
            if _is_curve(found[-1]):
                raise FileError(f"{what}: a point must have one vertical curve; got 2 at {point.station:.10g} m.")
            found[-1] = point
    if len(found) < len(points):
        account.left.append(f"{len(points) - len(found)} points of the profile within {SHORTEST:g} m of another one")
    ends = [number for number in {0, len(found) - 1} if _is_curve(found[number])]
    for number in ends:
        found[number] = VerticalPoint(found[number].station, found[number].height)
        account.left.append(f"the vertical curve at {found[number].station:.3f} m: one of its tangents is missing")
    return found


def _is_curve(point: VerticalPoint) -> bool:
    return point.before + point.after + point.radius > 0.0


def _round(point: VerticalPoint, before: float, after: float) -> VerticalPoint:
    """Return a point with the lengths of its circle between two slopes."""
    if not point.radius:
        return point
    angles = math.atan(before), math.atan(after)
    along = point.radius * math.tan(abs(angles[1] - angles[0]) / 2.0)
    return replace(point, before=along * math.cos(angles[0]), after=along * math.cos(angles[1]))


def _fitted(points: list[VerticalPoint], source: str, account: Account) -> list[VerticalPoint]:
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


def _pieces(points: list[VerticalPoint], slopes: list[float]) -> list[Piece]:
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
    return [piece for piece in pieces if piece.end - piece.begin >= SHORTEST]


def _cut(piece: Piece, begin: float, end: float) -> Piece | None:
    """Return the part of a piece between two places, None if it has none."""
    first, last = max(piece.begin, begin), min(piece.end, end)
    if last - first < SHORTEST:
        return None
    steep = (piece.last - piece.first) / (piece.end - piece.begin)
    return Piece(first, last, piece.first + steep * (first - piece.begin), piece.first + steep * (last - piece.begin))


#: Largest length, radius and coordinate [units of the file].
LONGEST, LARGEST_RADIUS, FARTHEST = 1e7, 1e12, 1e9


def length_of(one: ET.Element, unit: float, what: str) -> float:
    """Return the length of an element [m]. Raises FileError."""
    length = attribute(one, "length", what, LONGEST)
    if length is None and one.tag in ("Line", "Curve"):
        start, end = _point(one, "Start", "length", what), _point(one, "End", "length", what)
        length = abs(end - start)
        if one.tag == "Curve" and length:
            centre = _point(one, "Center", "length", what)
            turn = cmath.phase((end - centre) / (start - centre)) * (1.0 if one.get("rot") == "ccw" else -1.0)
            length = radius_of(one, 1.0, what) * (turn % math.tau)
    if length is None or length < 0.0:
        got = "it is missing" if length is None else f"got {length:g}"
        raise FileError(f"{what}: {one.tag} must have a length of 0 or more; {got}. Correct it.")
    return unit * length


def radius_of(one: ET.Element, unit: float, what: str) -> float:
    """Return the radius of a curve [m], infinite for INF. Raises FileError."""
    if one.get("radius", "").strip().upper() in ("INF", "INFINITY"):
        return math.inf
    radius = attribute(one, "radius", what, LARGEST_RADIUS)
    if radius is None:
        radius = abs(_point(one, "Start", "radius", what) - _point(one, "Center", "radius", what))
    if not radius > 0.0:
        raise FileError(f"{what}: radius must be above 0 or INF; got {radius:g}. Correct it.")
    return unit * radius


def _point(one: ET.Element, name: str, missing: str, what: str) -> complex:
    """Return a point of an element, east and north, in the file's unit. Raises FileError."""
    found = one.find(name)
    numbers = [] if found is None else (found.text or "").split()
    if len(numbers) not in (2, 3):
        got = "none" if found is None else shown(found.text or found.get("pntRef") or "")
        raise FileError(
            f"{what}: {one.tag} must have {missing}, or coordinates of its points; got {got} as {name}. Add {missing}."
        )
    north, east = (value_of(number, f"{what}: {name} of {one.tag}", FARTHEST) for number in numbers[:2])
    return complex(east, north)


#: Metres in a linear unit of the file.
UNITS = {
    "meter": 1.0,
    "kilometer": 1000.0,
    "millimeter": 0.001,
    "centimeter": 0.01,
    "foot": 0.3048,
    "ussurveyfoot": 1200.0 / 3937.0,
    "inch": 0.0254,
    "mile": 1609.344,
}

#: Largest difference of the stated length from that of the elements without a message [m].
STATED = 0.1
#: Spirals that are read, and the form of their curvature.
SPIRALS = {"clothoid": LINEAR, "bloss": BLOSS}
#: Largest cant that is read as metres: below it millimetres would be no cant.
IN_METRES = 0.3
LEFT = {
    "Superelevation": "it is that of roads",
    "StaEquation": "jumps of stations do not change the track; distances are continuous",
    "CrossSects": "cross-sections are not read",
    "AlignPIs": "they repeat the elements",
}


def landxml_line(root: ET.Element, asked: Sequence[str], source: str) -> Alignment:
    """Return the line of one alignment."""
    found = {one.get("name") or f"{number}": one for number, one in enumerate(inside(root, "Alignment"), 1)}
    if not found:
        raise FileError(f"{source} must be LandXML with an Alignment; got none. Give another file.")
    if len(asked) > 1 or (not asked and len(found) > 1) or (asked and asked[0] not in found):
        raise FileError(
            f"{source}: one alignment must be named with --tracks; the file has {listed(found)}. Name one of these."
        )
    name = asked[0] if asked else next(iter(found))
    if (many := sum(one.get("name") == name for one in inside(root, "Alignment"))) > 1:
        raise FileError(f"{source}: the alignment {shown(name)} must be there once; got {many}. Rename the others.")
    account = Account(taken=[f"alignment {shown(name)}: elements in plan, stations, rotations"])
    unit, unit_name, imperial = _unit(root, source, account)
    if unit != 1.0:
        account.converted.append(f"lengths: {unit_name} to m, times {unit:.10g}")
    return _alignment(found[name], source, unit, imperial, account)


def _unit(root: ET.Element, source: str, account: Account) -> tuple[float, str, bool]:
    units = next(inside(root, "Metric", "Imperial"), None)
    if units is None:
        account.assumed.append("lengths are in m: the file has no Units")
    name = "meter" if units is None else units.get("linearUnit", "")
    if name.lower() not in UNITS:
        raise FileError(f"{source}: linearUnit must be one of {', '.join(UNITS)}; got {shown(name)}. Correct it.")
    return UNITS[name.lower()], name, units is not None and units.tag == "Imperial"


def _alignment(element: ET.Element, source: str, unit: float, imperial: bool, account: Account) -> Alignment:
    start = unit * (attribute(element, "staStart", source, LONGEST) or 0.0)
    geometry = next(inside(element, "CoordGeom"), None)
    elements = [] if geometry is None else [one for one in geometry if one.tag not in ("Feature", "FeatureRef")]
    if not elements:
        raise FileError(f"{source}: {name_of(element)} must have a CoordGeom with elements; got none. Export it again.")
    curvature = _in_plan(elements, source, unit, start, account)
    place = curvature[-1].end
    stated = attribute(element, "length", source, LONGEST)
    if stated is not None and abs(unit * stated - (place - start)) > STATED:
        account.assumed.append(
            f"the length is that of the elements, {place - start:.3f} m; {unit * stated:.3f} m is stated"
        )
    account.converted.append(f"{len(elements)} elements: radius and rotation to curvature, cw to the right")
    cant = _cant(element, source, unit, imperial, curvature, account)
    gradient = gradients_of(element, source, unit, start, place, account)
    account.left += [f"{tag}: {reason}" for tag, reason in LEFT.items() if next(inside(element, tag), None) is not None]
    alignment = Alignment(source, start, place, curvature, cant, gradient, True, account)
    tell_jumps(alignment)
    return alignment


def _in_plan(elements: Sequence[ET.Element], source: str, unit: float, start: float, account: Account) -> list[Piece]:
    """Return the curvature of the elements; the next one reaches over an element of no length. Raises FileError."""
    pieces: list[Piece] = []
    begin = place = start
    short: list[float] = []
    for number, element in enumerate(elements, 1):
        what = f"{source}, element {number}"
        first, last, form = _ends(element, unit, what)
        length = length_of(element, unit, what)
        place += length
        if length < SHORTEST:
            short.append(length)
            continue
        pieces.append(Piece(begin, place, first, last, form))
        begin = place
    if short:
        account.left.append(f"{len(short)} elements shorter than {SHORTEST:g} m, together {sum(short):.4g} m")
    if not pieces:
        raise FileError(f"{source}: an alignment must have an element of {SHORTEST:g} m or more; got none. Check it.")
    return [*pieces[:-1], replace(pieces[-1], end=place)]


def _ends(one: ET.Element, unit: float, what: str) -> tuple[float, float, str]:
    """Return the curvature at both ends of an element and its form. Raises FileError."""
    if one.tag == "Line":
        return 0.0, 0.0, LINEAR
    if one.tag not in ("Curve", "Spiral"):
        raise FileError(f"{what} must be a Line, Curve or Spiral; got {shown(one.tag)}. Replace it.")
    side = {"cw": -1.0, "ccw": 1.0}.get(one.get("rot", ""))
    if side is None:
        raise FileError(f"{what}: rot of {one.tag} must be cw or ccw; got {shown(one.get('rot'))}. Correct it.")
    if one.tag == "Curve":
        if one.get("crvType", "arc") != "arc":
            raise FileError(f"{what}: crvType must be arc; got {shown(one.get('crvType'))}. Replace the curve.")
        bend = side / radius_of(one, unit, what)
        return bend, bend, LINEAR
    kind = one.get("spiType", "clothoid")
    if kind not in SPIRALS:
        raise FileError(f"{what}: spiType must be one of {', '.join(SPIRALS)}; got {shown(kind)}. Replace the spiral.")
    return side * _bend(one, "radiusStart", unit, what), side * _bend(one, "radiusEnd", unit, what), SPIRALS[kind]


def _bend(one: ET.Element, name: str, unit: float, what: str) -> float:
    if one.get(name, "").strip().upper() in ("INF", "INFINITY"):
        return 0.0
    radius = unit * required(one, name, what, LARGEST_RADIUS)
    if not radius > 0.0:
        raise FileError(f"{what}: {name} must be above 0 or INF; got {radius:g} m. Correct it.")
    return 1.0 / radius


def _cant(
    element: ET.Element, source: str, unit: float, imperial: bool, curvature: Sequence[Piece], account: Account
) -> list[Piece]:
    """Return the cant between stations, linear, to the side of the station or of the curve."""
    stations = []
    for one in inside(element, "CantStation"):
        place = unit * required(one, "station", source, LONGEST)
        size = attribute(one, "appliedCant", source, 1e4) or 0.0
        side = {"cw": -1.0, "ccw": 1.0}.get(one.get("curvature", ""), 0.0) or _side(place, curvature)
        stations.append((place, side * size * (-1.0 if one.get("adverse") == "true" else 1.0)))
    if not stations:
        account.assumed.append("the cant is 0: the alignment has no cant stations")
        return []
    largest = max(abs(size) for _, size in stations)
    scale, told = (0.0254, "inches") if imperial else (0.001, "mm")
    if 0.0 < largest <= IN_METRES and not imperial:
        scale, told = 1.0, "m"
    account.assumed.append(f"appliedCant is in {told} (the schema has no unit): up to {1e3 * scale * largest:.4g} mm")
    account.converted.append(f"{len(stations)} cant stations: linear between them, the outer rail is the higher one")
    ends = (curvature[0].begin, curvature[-1].end)
    course = [(place, scale * size) for place, size in sorted(stations) if ends[0] - 0.01 <= place <= ends[1] + 0.01]
    if len(course) < len(stations):
        account.left.append(f"{len(stations) - len(course)} cant stations: they lie beyond the elements")
    course = [(max(min(place, ends[1]), ends[0]), size) for place, size in course]
    pieces = [Piece(a, b, x, y) for (a, x), (b, y) in pairwise(course) if b - a >= 0.01]
    if course and ends[1] - course[-1][0] >= 0.01:
        pieces.append(Piece(course[-1][0], ends[1], course[-1][1], course[-1][1]))
    return pieces


def _side(place: float, curvature: Sequence[Piece]) -> float:
    """Return the side of the curve at a place, or of the curve next to it."""
    bends = [
        math.copysign(1.0, one.first + one.last)
        for one in curvature
        if one.begin - 1.0 <= place <= one.end + 1.0 and one.first + one.last != 0.0
    ]
    return bends[0] if bends else 1.0
