"""Tracks and routes of receivers, GPX (topografix.com/GPX/1/1): latitude, longitude [degrees], height `ele` [m]."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence

from readers.formats.ways import Course, recorded, unique, way_of
from readers.import_account import Account
from readers.text import FileError
from readers.xml_files import child_text, inside, required, value_of

#: Highest and lowest height that is read [m].
HIGHEST = 10_000.0
#: Lines of a file and their points.
POINTS = {"trk": "trkpt", "rte": "rtept"}


def gpx_course(root: ET.Element, asked: Sequence[str], source: str) -> Course:
    """Return the points of a track or route, or of those named."""
    lines = [one for one in root if one.tag in POINTS and next(inside(one, POINTS[one.tag]), None) is not None]
    if not lines:
        raise FileError(f"{source} must have a track (trk) or route (rte) with points; got none. Give another file.")
    names = unique(child_text(one, "name") or str(number) for number, one in enumerate(lines, 1))
    ways = [
        way
        for name, line in zip(names, lines, strict=True)
        if (way := way_of(name, [_point(one, source) for one in inside(line, POINTS[line.tag])], source))
    ]
    account = Account(["lat, lon and ele of points"], left=["time, and all else that points have: not used"])
    if next(inside(root, "wpt"), None) is not None:
        account.left.append("wpt: points beside the track")
    return recorded(ways, asked, source, account)


def _point(element: ET.Element, source: str) -> tuple[float, float, float]:
    height = child_text(element, "ele")
    return (
        required(element, "lat", source, 180.0),
        required(element, "lon", source, 360.0),
        value_of(height, f"{source}: ele of {element.tag}", HIGHEST) if height else math.nan,
    )
