"""Infrastructure of OSRD (JSON, "RailJSON"): slopes and curves of track sections, joined to a route.

Gradients are in per mille, radii and lengths in m, as its models of data have them. Its simulation uses the absolute
value of a radius alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from readers.alignment import Alignment, Piece
from readers.documents import list_in, number_in, text_in
from readers.formats.line_tracks import Track, joined, listed, route_of
from readers.import_account import Account
from readers.text import FileError, shown

#: Longest track section [m].
LONGEST = 1e6
#: Fields of a track section without a use, each with the reason.
LEFT = {
    "geo": "its points are positions on a map",
    "sch": "its points are those of a diagram",
    "loading_gauge_limits": "they do not affect braking",
}
#: Least end of a piece, so that rounding beyond a track's end is not an error [m].
ROUNDING = 1e-3


def osrd_line(read: Any, asked: Sequence[str], source: str) -> Alignment:
    """Return the line over track sections."""
    if not isinstance(read, dict) or "track_sections" not in read:
        names = shown(", ".join(read) if isinstance(read, dict) else read)
        forms = "OSRD (track_sections), Overpass (elements) or GeoJSON (type)"
        raise FileError(f"{source} must be JSON of {forms}; got {names}. Give another file.")
    sections = {text_in(one, "id", f"{source}, track section"): one for one in list_in(read, "track_sections", source)}
    lengths = {name: number_in(one, "length", f"{source}, {name}", 0.01, LONGEST) for name, one in sections.items()}
    route = route_of(lengths, asked, source)
    account = Account()
    tracks = []
    for name, back in route:
        track = _track(sections[name], name, lengths[name], source)
        tracks.append(track.backwards() if back else track)
    names = listed(track.name for track in tracks)
    account.taken.append(f"track sections {names}: length, slopes, curves")
    account.converted += ["slopes: per mille to 1", "curves: radius in m to curvature 1 / radius; radius 0: straight"]
    account.left += [
        f"{field}: {reason}" for field, reason in LEFT.items() if any(sections[name].get(field) for name, _ in route)
    ]
    account.assumed += [
        "a positive radius is a curve to the left: OSRD does not use the side; --mirror exchanges the sides",
        "the cant is 0: OSRD has none",
    ]
    for field, words in (("slopes", "level"), ("curves", "straight")):
        if bare := [name for name, _ in route if sections[name].get(field) is None]:
            account.assumed.append(f"track sections {listed(bare)} are {words}: they have no {field}")
    _check_links(read, route, account)
    return joined(tracks, source, account)


def _track(read: Any, name: str, length: float, source: str) -> Track:
    what = f"{source}, track section {name}"
    slopes = [
        (begin, end, number_in(one, "gradient", what, -500.0, 500.0) / 1000.0)
        for one, begin, end in _ranges(read, "slopes", length, what)
    ]
    curves = [
        (begin, end, number_in(one, "radius", what, -1e9, 1e9))
        for one, begin, end in _ranges(read, "curves", length, what)
    ]
    return Track(
        name,
        length,
        [Piece(begin, end, _bend(radius), _bend(radius)) for begin, end, radius in curves],
        (),
        [Piece(begin, end, slope, slope) for begin, end, slope in slopes],
    )


def _bend(radius: float) -> float:
    return 1.0 / radius if radius else 0.0


def _ranges(read: Any, name: str, length: float, what: str) -> list[tuple[Any, float, float]]:
    """Return the entries of a list with begin and end on a track [m], without empty ones. Raises FileError."""
    found = []
    for one in list_in(read, name, what) if read.get(name) is not None else []:
        begin, end = (number_in(one, key, f"{what}, {name}", 0.0, length + ROUNDING) for key in ("begin", "end"))
        if end < begin:
            raise FileError(f"{what}: {name} must end after their begin; got {begin:g} to {end:g} m. Correct them.")
        if not math.isclose(begin, end, abs_tol=0.01):
            found.append((one, begin, min(end, length)))
    return sorted(found, key=lambda one: one[1])


def _check_links(read: Any, route: Sequence[tuple[str, bool]], account: Account) -> None:
    """Tell which consecutive sections the file does not link."""
    groups = [[item.get("src"), item.get("dst")] for item in _items(read.get("track_section_links"))]
    groups += [
        list(one["ports"].values()) for one in _items(read.get("switches")) if isinstance(one.get("ports"), dict)
    ]
    linked = [{_end(one) for one in group} for group in groups]
    for (name, back), (other, turned) in pairwise(route):
        ends = {(name, "BEGIN" if back else "END"), (other, "END" if turned else "BEGIN")}
        if not any(ends <= group for group in linked):
            account.assumed.append(f"{name} and {other} follow each other, although the file does not link these ends")


def _items(given: Any) -> list[dict[str, Any]]:
    return [one for one in given if isinstance(one, dict)] if isinstance(given, list) else []


def _end(given: Any) -> tuple[str, str]:
    """Return track and end of a reference, in the forms of its versions."""
    if not isinstance(given, dict):
        return "", ""
    track = given.get("track")
    return str(track.get("id", "") if isinstance(track, dict) else track), str(given.get("endpoint", "")).upper()
