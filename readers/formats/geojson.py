"""Lines of GeoJSON (RFC 7946): positions are longitude, latitude [degrees] and height [m] on WGS 84."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from readers.documents import is_number, list_in, member
from readers.formats.osm_tags import rails
from readers.formats.way_net import course_of
from readers.formats.ways import Course, unique, way_of
from readers.import_account import Account
from readers.text import FileError, shown

#: Types of a document, and the end of names of reference systems that are WGS 84 with longitude first.
TYPES = {"FeatureCollection", "Feature", "LineString", "MultiLineString", "GeometryCollection"}
WGS84 = ("CRS84", "4326")


def is_geojson(read: Any) -> bool:
    """Return whether a document is of GeoJSON."""
    return isinstance(read, dict) and isinstance(read.get("type"), str) and read["type"] in TYPES


def geojson_course(read: Any, asked: Sequence[str], source: str) -> Course:
    """Return the points of the lines, joined end to end."""
    _check_system(read, source)
    account = Account(["longitude, latitude and height of positions"])
    features = list_in(read, "features", source) if read["type"] == "FeatureCollection" else [read]
    lines, others = [], 0
    for number, feature in enumerate(features, 1):
        if not isinstance(feature, dict):
            raise FileError(f"{source}: feature {number} must be an object; got {shown(feature)}. Correct it.")
        inner = feature.get("geometry") if feature.get("type") == "Feature" else feature
        tags = _tags(feature)
        name = str(feature.get("id") or tags.get("@id") or tags.get("name") or number)
        found = list(_lines(inner, source))
        others += not found
        lines += [(name.removeprefix("way/"), tags, line) for line in found]
    if not lines:
        raise FileError(f"{source} must have a LineString or MultiLineString; got none. Give another file.")
    if others:
        account.left.append(f"features without a line: {others}")
    names = unique(name for name, *_ in lines)
    ways = [
        way_of(name, [_point(one, source) for one in line], source, tags.get("name", ""), tags)
        for name, (_, tags, line) in zip(names, lines, strict=True)
    ]
    return course_of(rails([way for way in ways if way], asked, account), asked, source, account)


def _check_system(read: Any, source: str) -> None:
    """Refuse another reference system, which GeoJSON of 2008 could name."""
    crs = read.get("crs")
    properties = crs.get("properties") if isinstance(crs, dict) else None
    name = properties.get("name") if isinstance(properties, dict) else crs
    if crs is not None and not (isinstance(name, str) and name.endswith(WGS84)):
        raise FileError(
            f"{source}: crs must be WGS 84 with longitude first (CRS84), as RFC 7946 has it; got {shown(name)}. "
            "Convert the file, or give eastings and northings as a table."
        )


def _tags(feature: dict[str, Any]) -> dict[str, str]:
    """Return the properties of a feature that are strings or numbers."""
    given = feature.get("properties")
    items = given.items() if isinstance(given, dict) else ()
    return {name: str(value) for name, value in items if isinstance(value, str) or is_number(value)}


def _lines(geometry: Any, source: str) -> Iterator[list[Any]]:
    """Yield the positions of each line of a geometry."""
    if geometry is None:
        return
    kind = member(geometry, "type", source)
    if kind == "GeometryCollection":
        for one in list_in(geometry, "geometries", source):
            yield from _lines(one, source)
    elif kind == "LineString":
        yield list_in(geometry, "coordinates", source)
    elif kind == "MultiLineString":
        yield from (list_in({kind: one}, kind, source) for one in list_in(geometry, "coordinates", source))


def _point(given: Any, source: str) -> tuple[float, float, float]:
    if not (isinstance(given, list) and len(given) >= 2 and all(is_number(one) for one in given[:3])):
        raise FileError(f"{source}: a position must be longitude, latitude and height; got {shown(given)}. Correct it.")
    return float(given[1]), float(given[0]), float(given[2]) if len(given) > 2 else math.nan
