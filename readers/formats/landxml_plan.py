"""Length and radius of a LandXML element in plan: its attributes, or its points if these are missing.

In LandXML 1.2 `length` of Line and Curve, and `radius` of Curve, are optional; Start, End and Center are not. A point
is northing and easting, and may have a height (LandXML-1.2.xsd, PointType).
"""

from __future__ import annotations

import cmath
import math
import xml.etree.ElementTree as ET

from readers.formats.xml_numbers import attribute, value_of
from readers.text import FileError, shown

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
