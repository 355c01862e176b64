"""Networks of ALTRIOS (YAML): elevations and headings of links, joined to a route.

Elevations and headings are linear between their offsets along a link, so that gradient and curvature are constant
there. Fields as its public networks have them; names with and without the unit (`offset`, `offset_meters`) are read.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from readers.alignment import SHORTEST, Alignment, Piece
from readers.documents import integer_in, is_number
from readers.formats.line_tracks import Track, joined, listed, route_of
from readers.import_account import Account
from readers.text import FileError, shown
from readers.yaml_files import yaml_of

#: Largest file [bytes], longest link [m]. Difference of values that are one at one place [m, rad].
LARGEST, LONGEST, SAME = 32_000_000, 1e6, 2e-4
LEFT = {
    "speed_set": "speed limits do not belong to the line",
    "speed_sets": "speed limits do not belong to the line",
    "cat_power_limits": "power of the overhead line does not affect braking",
}
NEXT = ("idx_next", "idx_next_alt")


def read_altrios_line(path: Path, asked: Sequence[str] = ()) -> Alignment:
    """Return the line over links."""
    source = str(path)
    read = yaml_of(path, LARGEST)
    links = _links(read, source)
    lengths = {name: _number(one, "length", f"{source}, link {name}") for name, one in links.items()}
    lengths = {name: length for name, length in lengths.items() if length > 0.0}
    route = route_of(lengths, asked, source)
    tracks = []
    for name, back in route:
        track = _track(links[name], name, lengths[name], f"{source}, link {name}")
        tracks.append(track.backwards() if back else track)
    account = Account(taken=[f"links {listed(track.name for track in tracks)}: length, elevations, headings"])
    account.converted += [
        "elevations: gradient = change of elevation over change of offset",
        "headings: curvature = change of heading over change of offset, the shorter way round",
    ]
    account.left += [
        f"{field}: {reason}" for field, reason in LEFT.items() if any(links[n].get(field) for n, _ in route)
    ]
    account.assumed += [
        "headings grow clockwise, as those of a compass: a falling one is a curve to the left; --mirror exchanges them",
        "the cant is 0: ALTRIOS has none",
    ]
    for field, words in (("elevs", "level"), ("headings", "straight")):
        if bare := [name for name, _ in route if not links[name].get(field)]:
            account.assumed.append(f"links {listed(bare)} are {words}: they have no {field}")
    for (name, back), (other, turned) in pairwise(route):
        follow = {str(links[other if back else name].get(key)) for key in NEXT}
        if back != turned or (name if back else other) not in follow:
            account.assumed.append(f"links {name} and {other} follow each other, although the file does not say so")
    account.left += _steps(links, route, source)
    return joined(tracks, source, account)


def _steps(links: dict[str, dict[str, Any]], route: Sequence[tuple[str, bool]], source: str) -> list[str]:
    """Return sentences about joints at which headings or elevations of links do not meet."""
    found = []
    for field, value, least, unit in (("headings", "heading", 1e-3, "rad"), ("elevs", "elev", 0.01, "m")):
        steps = []
        for (name, back), (other, turned) in pairwise(route):
            before, after = (_values(links[one], field, value, f"{source}, link {one}") for one in (name, other))
            if before and after:
                steps.append(after[-1 if turned else 0] - before[0 if back else -1])
                if field == "headings":
                    steps[-1] = math.remainder(steps[-1] + math.pi * (turned - back), 2.0 * math.pi)
        large = [abs(step) for step in steps if abs(step) > least]
        if large:
            found.append(f"steps of {field} at {len(large)} joints, up to {max(large):.3g} {unit}: the track has none")
    return found


def _values(read: dict[str, Any], field: str, value: str, what: str) -> list[float]:
    return [one for _, one in _course(read, field, value, math.inf, what)]


def _links(read: Any, source: str) -> dict[str, dict[str, Any]]:
    """Return the links of a network by index. Raises FileError."""
    found = read
    if isinstance(read, list):  # tolerances and links, or links alone
        found = next((one for one in read if isinstance(one, list)), read)
    elif isinstance(read, dict):
        found = read.get("links")
    if not isinstance(found, list) or not all(isinstance(one, dict) for one in found):
        raise FileError(f"{source} must have a list of links; got {shown(type(found).__name__)}. Give a network.")
    return {str(integer_in(one, "idx_curr", f"{source}, link {number}", 0)): one for number, one in enumerate(found)}


def _number(read: dict[str, Any], name: str, what: str) -> float:
    units = {"length": "length_meters", "offset": "offset_meters", "elev": "elev_meters", "heading": "heading_radians"}
    key = units[name] if units[name] in read else name
    value: Any = read.get(key)
    if not is_number(value) or not abs(value) <= LONGEST:
        raise FileError(f"{what}: {units[name]} must be a number up to {LONGEST:g}; got {shown(value)}. Correct it.")
    return float(value)


def _course(read: dict[str, Any], field: str, value: str, length: float, what: str) -> list[tuple[float, float]]:
    """Return offsets and values of a field, within the link. Raises FileError."""
    given = read.get(field) or []
    if not isinstance(given, list) or not all(isinstance(one, dict) for one in given):
        raise FileError(f"{what}: {field} must be a list of offsets and values; got {shown(given)}. Correct it.")
    found = [(_number(one, "offset", f"{what}, {field}"), _number(one, value, f"{what}, {field}")) for one in given]
    found = found[:1] + [after for before, after in pairwise(found) if not _is_same(before, after)]
    for before, after in pairwise(found):
        if not after[0] > before[0]:
            raise FileError(
                f"{what}: offsets of {field} must grow; got {after[0]:g} m after {before[0]:g} m. Sort them."
            )
    if found and not (found[0][0] >= -0.01 and found[-1][0] <= length + 0.01):
        raise FileError(
            f"{what}: offsets of {field} must be from 0 to {length:g} m; got {found[0][0]:g} to {found[-1][0]:g} m. "
            "Correct them."
        )
    return found


def _is_same(before: tuple[float, float], after: tuple[float, float]) -> bool:
    """Return whether two points are one: at one place, with one value."""
    return abs(after[0] - before[0]) < SHORTEST and abs(after[1] - before[1]) <= SAME


def _track(read: dict[str, Any], name: str, length: float, what: str) -> Track:
    heights = _course(read, "elevs", "elev", length, what)
    headings = _course(read, "headings", "heading", length, what)
    gradient = [Piece(a, b, (y - x) / (b - a), (y - x) / (b - a)) for (a, x), (b, y) in pairwise(heights)]
    bends = [(a, b, -math.remainder(y - x, 2.0 * math.pi) / (b - a)) for (a, x), (b, y) in pairwise(headings)]
    return Track(name, length, [Piece(a, b, bend, bend) for a, b, bend in bends], (), gradient)
