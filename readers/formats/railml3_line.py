"""Infrastructure of railML 3: horizontal curves, gradient curves and superelevation curves along net elements.

Signs and units are those of wiki3.railml.org (IS:horizontalCurve, IS:gradientCurve): a negative radius is a curve to
the left, 0 is straight; azimuths grow clockwise, in degrees; gradients are in per mille; superelevations in mm. A curve
lies on a net element by posBegin and posEnd of its associatedNetElement, by linear coordinates, or by intrinsic ones.
Where keepsOrientation is false, the location runs against its net element, and the signs of its curve are turned
(RTM:associatedNetElement).
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from readers.alignment import BLOSS, LINEAR, Alignment, Piece
from readers.formats.line_tracks import Track, joined, route_of
from readers.import_account import Account
from readers.text import FileError, shown
from readers.xml_files import attribute, inside, name_of, required

LONGEST, SHORTEST = 1e7, 0.01
#: Curves whose curvature is constant, and those between the curvatures of their neighbours.
CONSTANT, CHANGING = (
    ("arc", "straight"),
    {"clothoide": LINEAR, "clothoid": LINEAR, "cubicParabola": LINEAR, "curveBloss": BLOSS},
)


@dataclass(frozen=True)
class GeometryElement:
    """An element of geometry and its place on a net element [m]; `sign` is -1 if it runs against the net element."""

    element: ET.Element
    begin: float
    end: float
    sign: float = 1.0


def read_railml3(infrastructure: ET.Element, asked: Sequence[str], source: str) -> Alignment:
    """Return the line over net elements; see `railml_line`. Raises FileError."""
    lengths = {
        one.get("id", ""): attribute(one, "length", source, LONGEST) or 0.0
        for one in inside(infrastructure, "netElement")
    }
    account = Account()
    groups = {
        tag: _located(list(inside(infrastructure, tag)), lengths, source, account)
        for tag in ("horizontalCurve", "gradientCurve", "superelevationCurve")
    }
    reached: dict[str, float] = {}
    for group in groups.values():
        for name, curves in group.items():
            reached[name] = max(reached.get(name, 0.0), lengths.get(name) or max(curve.end for curve in curves))
    route = route_of(reached, asked, source)
    tracks = []
    for name, back in route:
        bends, slopes, heights = (group.get(name, []) for group in groups.values())
        curvature = _curvature(bends, source)
        track = Track(name, reached[name], curvature, _cant(heights, curvature, source), _gradient(slopes, source))
        tracks.append(track.backwards() if back else track)
        account.taken.append(
            f"net element {track.name}: {len(bends)} horizontal, {len(slopes)} gradient, {len(heights)} superelevation "
            "curves"
        )
    account.converted += [
        "radius in m to curvature, negative to the left",
        "gradient: per mille to 1, linear over arcs",
        "superelevation: mm to m",
    ]
    account.assumed.append("places without curves are straight, level and without cant")
    return joined(tracks, source, account)


def _located(
    elements: Sequence[ET.Element], lengths: dict[str, float], source: str, account: Account
) -> dict[str, list[GeometryElement]]:
    """Return curves by net element, in the order of their places. Raises FileError."""
    found: dict[str, list[GeometryElement]] = {}
    for element in elements:
        _check_direction(element, source)
        for place in inside(element, "associatedNetElement"):
            name = place.get("netElementRef", "")
            sign = _sign(place, source)
            begin, end = (_measure(place, side, lengths.get(name, 0.0), source) for side in ("Begin", "End"))
            begin, end = (end, begin) if sign < 0.0 and end < begin else (begin, end)
            if abs(end - begin) < SHORTEST:
                account.left.append(f"{name_of(element)}: it is shorter than {SHORTEST:g} m")
                continue
            if not end > begin:
                raise FileError(
                    f"{source}: {name_of(element)} must end after its begin; got {begin:g} to {end:g} m. Correct it."
                )
            found.setdefault(name, []).append(GeometryElement(element, begin, end, sign))
    return {name: sorted(curves, key=lambda curve: curve.begin) for name, curves in found.items()}


def _check_direction(element: ET.Element, source: str) -> None:
    """Raise FileError if a location applies against its net element alone, which turns no sign by the schema."""
    for one in inside(element, "linearLocation", "spotLocation"):
        if one.get("applicationDirection", "both") not in ("both", "normal", "unknown"):
            raise FileError(
                f"{source}: applicationDirection of {name_of(element)} must be both or normal; got "
                f"{shown(one.get('applicationDirection'))}. State the curve in the direction of its net element."
            )


def _sign(place: ET.Element, source: str) -> float:
    """Return 1 for a location in the direction of its net element, -1 against it. Raises FileError."""
    signs = {"true": 1.0, "1": 1.0, "false": -1.0, "0": -1.0}
    given = place.get("keepsOrientation", "true").strip().lower()
    if given not in signs:
        raise FileError(f"{source}: keepsOrientation must be true or false; got {shown(given)}. Correct it.")
    return signs[given]


def _measure(place: ET.Element, side: str, length: float, source: str) -> float:
    value = attribute(place, f"pos{side}", source, LONGEST)
    if value is not None:
        return value
    linear = next(inside(place, f"linearCoordinate{side}"), None)
    if linear is not None:
        return required(linear, "measure", source, LONGEST)
    share = attribute(place, f"intrinsicCoord{side}", source, 1.0)
    if share is None or not length > 0.0:
        raise FileError(
            f"{source}: associatedNetElement {shown(place.get('netElementRef'))} must have pos{side}, a "
            f"linearCoordinate{side}, or an intrinsicCoord{side} and a length of the net element. Add one."
        )
    return share * length


def _curvature(curves: Sequence[GeometryElement], source: str) -> list[Piece]:
    """Return the curvature of horizontal curves; transitions lie between their neighbours. Raises FileError."""
    values: list[float | None] = []
    for curve in curves:
        kind = curve.element.get("curveType", "")
        if kind not in CONSTANT and kind not in CHANGING:
            raise FileError(
                f"{source}: curveType of {name_of(curve.element)} must be one of {', '.join([*CONSTANT, *CHANGING])}; "
                f"got {shown(kind)}. Replace it."
            )
        values.append(_bend(curve, source) if kind in CONSTANT else None)
    return _pieces(curves, values, lambda element: CHANGING.get(element.get("curveType", ""), LINEAR))


def _bend(curve: GeometryElement, source: str) -> float:
    if curve.element.get("curveType") == "straight":
        return 0.0
    radius = attribute(curve.element, "radius", source, 1e9)
    if radius:
        return -curve.sign / radius
    turn = required(curve.element, "deltaAzimuth", source, 720.0)
    return -curve.sign * math.radians(turn) / (curve.end - curve.begin)


def _pieces(
    curves: Sequence[GeometryElement], values: Sequence[float | None], form: Callable[[ET.Element], str]
) -> list[Piece]:
    """Return pieces of constant values, and between them pieces that change from one to the next."""
    found = []
    for number, curve in enumerate(curves):
        own = values[number]
        near = [
            values[other] or 0.0
            if 0 <= other < len(curves) and _meet(curves[min(number, other)], curves[max(number, other)])
            else 0.0
            for other in (number - 1, number + 1)
        ]
        first, last = (near[0], near[1]) if own is None else (own, own)
        found.append(Piece(curve.begin, curve.end, first, last, form(curve.element) if own is None else LINEAR))
    return found


def _meet(before: GeometryElement, after: GeometryElement) -> bool:
    return abs(after.begin - before.end) < 1.0


def _gradient(curves: Sequence[GeometryElement], source: str) -> list[Piece]:
    values: list[float | None] = []
    for one in curves:
        slope = attribute(one.element, "gradient", source, 500.0)
        changes = one.element.get("curveType") == "arc" or slope is None
        values.append(None if changes else one.sign * (slope or 0.0) / 1000.0)
    pieces = _pieces(curves, values, lambda _: LINEAR)
    for number, one in enumerate(curves):
        change = attribute(one.element, "deltaGradient", source, 1000.0)
        if values[number] is None and change is not None and number and _meet(curves[number - 1], one):
            first = pieces[number - 1].last
            pieces[number] = replace(pieces[number], first=first, last=first + change / 1000.0)
    return pieces


def _cant(curves: Sequence[GeometryElement], curvature: Sequence[Piece], source: str) -> list[Piece]:
    """Return the cant of superelevation curves, to the side of the horizontal curve."""
    values: list[float | None] = []
    for curve in curves:
        height = attribute(curve.element, "superelevation", source, 300.0)
        changes = height is None or curve.element.get("curveType") not in (None, "constant", "straight", "arc")
        middle = (curve.begin + curve.end) / 2.0
        side = next((math.copysign(1.0, p.first + p.last) for p in curvature if p.begin <= middle <= p.end), 1.0)
        values.append(None if changes else side * (height or 0.0) / 1000.0)
    return _pieces(curves, values, lambda _: LINEAR)
