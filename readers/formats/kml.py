"""Lines of Google Earth, KML (OGC 12-007r2) and KMZ, its archive: `LineString`, and `gx:Track` of receivers."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from readers.formats.way_net import course_of
from readers.formats.ways import Course, Way, recorded, unique, way_of
from readers.import_account import Account
from readers.text import FileError, shown
from readers.xml_files import LARGEST, child_text, inside, value_of, xml_in

#: Lines of a placemark: drawn and recorded.
DRAWN, RECORDED = "LineString", "Track"


def kml_course(root: ET.Element, asked: Sequence[str], source: str) -> Course:
    """Return the points of the lines: those of receivers in the order asked for, or drawn ones joined end to end."""
    lines = [(one, line) for one in inside(root, "Placemark") for line in inside(one, DRAWN, RECORDED)]
    if not lines:
        raise FileError(f"{source} must have a LineString or a gx:Track; got none. Give another file.")
    tag = RECORDED if any(line.tag == RECORDED for _, line in lines) else DRAWN
    lines = [(one, line) for one, line in lines if line.tag == tag]
    names = unique(child_text(one, "name") or str(number) for number, (one, _) in enumerate(lines, 1))
    ways: list[Way] = []
    relative = 0
    for name, (_, line) in zip(names, lines, strict=True):
        mode = child_text(line, "altitudeMode")
        relative += mode == "relativeToGround"
        way = way_of(name, list(_points(line, source, mode != "relativeToGround")), source)
        ways += [way] if way else []
    account = Account(["longitude, latitude and height of coordinates"])
    if relative:
        account.left.append(
            f"heights over the ground (altitudeMode relativeToGround): {relative} of {len(lines)} lines"
        )
    if tag == RECORDED:
        return recorded(ways, asked, source, account)
    return course_of(ways, asked, source, account)


def _points(line: ET.Element, source: str, absolute: bool) -> Iterator[tuple[float, float, float]]:
    """Yield latitude, longitude and height of a line; a height of 0 everywhere is unknown."""
    texts = (
        [one.text or "" for one in inside(line, "coord")]
        if line.tag == RECORDED
        else child_text(line, "coordinates").split()
    )
    rows = [text.split(None if line.tag == RECORDED else ",") for text in texts]
    for row in rows:
        if len(row) not in (2, 3):
            raise FileError(
                f"{source}: coordinates must be longitude,latitude,height with decimal points; got "
                f"{shown(','.join(row))}. Correct them."
            )
    numbers = [[value_of(cell, f"{source}: a coordinate", 10_000.0) for cell in row] for row in rows]
    known = absolute and any(len(row) == 3 and row[2] for row in numbers)
    return ((row[1], row[0], row[2] if known and len(row) == 3 else math.nan) for row in numbers)


def kmz_root(path: Path) -> ET.Element:
    """Return the root of the first KML file in an archive."""
    try:
        with zipfile.ZipFile(path) as archive:
            name = next((one for one in archive.namelist() if one.lower().endswith(".kml")), None)
            if name is None:
                raise FileError(f"{path} must contain a .kml file; it has none. Give another file.")
            with archive.open(name) as file:
                data = file.read(LARGEST + 1)
    except (OSError, zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError) as error:
        raise FileError(f"{path} must be a KMZ archive; it cannot be read ({shown(error)}). Check it.") from None
    if len(data) > LARGEST:
        raise FileError(f"{path}: its KML must have at most {LARGEST} bytes; got more. Split it.")
    try:
        return xml_in(data.decode("utf-8-sig"), path)
    except UnicodeDecodeError:
        raise FileError(f"{path}: its KML must be text in UTF-8. Save it so.") from None
