"""Ways of OpenStreetMap: JSON of the Overpass API, and XML (.osm). Points stand in ways, or in nodes that ways name."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from readers.documents import is_number, list_in
from readers.formats.osm_tags import rails
from readers.formats.way_net import course_of
from readers.formats.ways import Course, Way, way_of
from readers.import_account import Account
from readers.text import FileError, shown
from readers.xml_files import inside, required

#: Begins of roles of a relation's members that are not its track.
BESIDE = ("platform", "stop", "station", "inactive")
#: Remedy for a query without points.
QUERY = "Ask for the points with: out geom;"


def is_overpass(read: Any) -> bool:
    """Return whether a document is of the Overpass API."""
    return isinstance(read, dict) and isinstance(read.get("elements"), list)


def overpass_course(read: Any, asked: Sequence[str], source: str) -> Course:
    """Return the points of Overpass JSON, its ways joined end to end."""
    if read.get("remark"):
        raise FileError(f"{source} must be whole; the query ended with {shown(read['remark'], 80)}. Repeat it.")
    elements = [one for one in list_in(read, "elements", source) if isinstance(one, dict)]
    return _course(elements, asked, source)


def osm_course(root: ET.Element, asked: Sequence[str], source: str) -> Course:
    """Return the points of an XML file, its ways joined end to end."""
    return _course(list(_elements(root, source)), asked, source)


def _elements(root: ET.Element, source: str) -> Iterator[dict[str, Any]]:
    """Yield the elements of XML as those of JSON."""
    for one in inside(root, "node", "way", "relation"):
        found: dict[str, Any] = {"type": one.tag, "id": one.get("id", "")}
        if one.tag == "node" and "lat" in one.attrib:
            found |= {key: required(one, key, source, 360.0) for key in ("lat", "lon")}
        found["nodes"] = [nd.get("ref") for nd in inside(one, "nd")]
        found["members"] = [dict(member.attrib) for member in inside(one, "member")]
        found["tags"] = {tag.get("k", ""): tag.get("v", "") for tag in inside(one, "tag")}
        yield found


def _course(elements: Sequence[dict[str, Any]], asked: Sequence[str], source: str) -> Course:
    nodes = {str(one.get("id")): one for one in elements if one.get("type") == "node" and "lat" in one}
    routes = [members for one in elements if one.get("type") == "relation" and (members := list(_members(one)))]
    found: dict[str, dict[str, Any]] = {}
    for one in [one for one in elements if one.get("type") == "way"] + [one for members in routes for one in members]:
        known = found.setdefault(str(one.get("id", one.get("ref"))), {})
        known.update({key: one[key] for key in ("geometry", "nodes", "tags") if one.get(key)})
    account = Account()
    if len(routes) == 1:  # the order of a relation is that of its route
        found = {str(one.get("ref")): found[str(one.get("ref"))] for one in routes[0]}
        account.taken.append("ways of the relation, without platforms and stops")
    ways = [_way(name, one, nodes, source) for name, one in found.items()]
    return course_of(rails([way for way in ways if way], asked, account), asked, source, account)


def _members(relation: dict[str, Any]) -> Iterator[dict[str, Any]]:
    members = relation.get("members")
    for one in members if isinstance(members, list) else ():
        if isinstance(one, dict) and one.get("type") == "way" and not str(one.get("role", "")).startswith(BESIDE):
            yield one


def _way(name: str, read: dict[str, Any], nodes: dict[str, dict[str, Any]], source: str) -> Way | None:
    given = read.get("tags")
    tags = {key: str(value) for key, value in given.items()} if isinstance(given, dict) else {}
    geometry, refs = read.get("geometry"), read.get("nodes")
    if isinstance(geometry, list):
        points: Iterable[Any] = geometry
    elif isinstance(refs, list):
        points = [nodes.get(str(ref)) for ref in refs]
    else:
        points = [None]
    points = _whole(list(points), name, source)
    return way_of(name, [_point(one, name, source) for one in points], source, tags.get("name", ""), tags)


def _whole(points: list[Any], name: str, source: str) -> list[Any]:
    """Return points without missing ones before and behind them, where a map is cut. Raises FileError for others."""
    known = [at for at, one in enumerate(points) if one is not None]
    if not known or None in points[known[0] : known[-1] + 1]:
        missing = len(points) - len(known)
        raise FileError(f"{source}: way {shown(name)} must have its points; {missing} are missing. {QUERY}")
    return points[known[0] : known[-1] + 1]


def _point(given: Any, name: str, source: str) -> tuple[float, float, float]:
    place = (given.get("lat"), given.get("lon")) if isinstance(given, dict) else (None, None)
    if not all(is_number(one) for one in place):
        raise FileError(f"{source}: a point of way {shown(name)} must have lat and lon; got {shown(given)}. {QUERY}")
    return float(place[0]), float(place[1]), math.nan  # type: ignore[arg-type]
