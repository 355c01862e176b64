"""Lines of other programs, maps and receivers, by the end of a file's name and its content."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from pathlib import Path

from readers.alignment import Alignment
from readers.documents import document
from readers.formats.geojson import geojson_course, is_geojson
from readers.formats.gpx import gpx_course
from readers.formats.kml import kml_course, kmz_root
from readers.formats.landxml import landxml_line
from readers.formats.osm import is_overpass, osm_course, overpass_course
from readers.formats.osrd_line import osrd_line
from readers.formats.railml_line import railml_line
from readers.formats.ways import Course
from readers.text import FileError, shown, text_of
from readers.xml_files import LARGEST, xml_of

#: Ends of names of files that are lines.
YAML, JSON, XML, KMZ = (".yaml", ".yml"), (".json", ".geojson"), (".xml", ".railml", ".gpx", ".kml", ".osm"), ".kmz"
#: Readers by the root of XML.
ROOTS: dict[str, Callable[[ET.Element, Sequence[str], str], Alignment | Course]] = {
    "LandXML": landxml_line,
    **dict.fromkeys(("railml", "railML", "infrastructure"), railml_line),
    "gpx": gpx_course,
    "kml": kml_course,
    "osm": osm_course,
}


def read_foreign_line(path: Path, tracks: Sequence[str] = ()) -> Alignment | Course | None:
    """Return the line in a file, in degrees that of a map or receiver; None: files of such a name are none."""
    suffix, source = path.suffix.lower(), str(path)
    if suffix in YAML:
        from readers.formats.altrios_line import read_altrios_line  # needs PyYAML

        return read_altrios_line(path, tracks)
    if suffix in JSON:
        read = document(text_of(path, LARGEST).encode(), source)
        if is_overpass(read):
            return overpass_course(read, tracks, source)
        return (geojson_course if is_geojson(read) else osrd_line)(read, tracks, source)
    if suffix not in (*XML, KMZ):
        return None
    root = kmz_root(path) if suffix == KMZ else xml_of(path)
    if root.tag not in ROOTS:
        raise FileError(f"{path} must be railML, LandXML, GPX, KML or OSM; got {shown(root.tag)}. Give another file.")
    return ROOTS[root.tag](root, tracks, source)
