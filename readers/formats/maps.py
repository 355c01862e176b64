"""Lines in degrees, of maps and receivers, by the end of a file's name and its content."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from readers.documents import document
from readers.formats.geojson import geojson_course, is_geojson
from readers.formats.gpx import gpx_course
from readers.formats.kml import kml_course, kmz_root
from readers.formats.osm import is_overpass, osm_course, overpass_course
from readers.formats.ways import Course
from readers.text import FileError, shown, text_of
from readers.xml_files import LARGEST, xml_of

#: Readers by the root of XML. Ends of names of files that are maps; those of XML and JSON may be.
ROOTS: dict[str, Callable[[Any, Sequence[str], str], Course]] = {
    "gpx": gpx_course,
    "kml": kml_course,
    "osm": osm_course,
}
XML, JSON, KMZ = (".gpx", ".kml", ".osm"), (".geojson",), ".kmz"


def read_map(path: Path, tracks: Sequence[str] = ()) -> Course | None:
    """Return the course in a file of a map or receiver; None if a file .json or .xml holds something else."""
    suffix, source = path.suffix.lower(), str(path)
    if suffix in (*JSON, ".json"):
        read = document(text_of(path, LARGEST).encode(), source)
        if is_overpass(read):
            return overpass_course(read, tracks, source)
        if is_geojson(read):
            return geojson_course(read, tracks, source)
        if suffix == ".json":
            return None
        raise FileError(f"{path} must be GeoJSON with a LineString, or JSON of Overpass; got neither. Check the file.")
    if suffix not in (*XML, ".xml", KMZ):
        return None
    root = kmz_root(path) if suffix == KMZ else xml_of(path)
    if root.tag in ROOTS:
        return ROOTS[root.tag](root, tracks, source)
    if suffix == ".xml":
        return None
    raise FileError(f"{path} must be GPX, KML or OSM; got the root {shown(root.tag)}. Check the file.")
