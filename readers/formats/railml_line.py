"""Infrastructure of railML: tracks of version 2 by changes of radius and gradient; version 3 is in railml3_line.py.

Version 2 (wiki2.railml.org, IS:radiusChange, IS:gradientChange): a radius in m holds from its position to the next
change, or, if the change describes a transition curve, at its position alone; superelevation is in mm, slope in per
mille. The wiki does not state the side of a positive radius in version 2; version 3 states the right one. A change with
`dir` down describes the other direction of travel. Beside one in the direction of the track at the same place, or at
an end of such a track, it adds nothing. Alone, its sign and its range are not stated, and it is refused.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from readers.alignment import BLOSS, LINEAR, OVERLAP, Alignment, Piece
from readers.formats.line_tracks import Track, joined, listed, route_of
from readers.formats.railml3_line import read_railml3
from readers.import_account import Account
from readers.text import FileError, shown
from readers.xml_files import attribute, inside, required

LONGEST, SHORTEST = 1e7, 0.01
#: Letters by which descriptions of transition curves are found, and their form.
TRANSITIONS = {"clothoid": LINEAR, "parabola": LINEAR, "transition": LINEAR, "bloss": BLOSS}
#: Directions of a change: along the track, and against it.
ALONG, AGAINST = ("", "up", "both", "none", "unknown"), "down"
LEFT = {
    "speedChanges": "speed limits do not belong to the line",
    "electrificationChanges": "power does not affect braking",
    "gaugeChanges": "the gauge is that of the model",
    "axleWeightChanges": "they do not belong to the line",
}


@dataclass(frozen=True)
class Change:
    """A change at a place [m]: curvature [1/m] with cant [m] and the form of a transition, or slope with its curve.

    `curve` is the length of a vertical curve, or its radius if `by_radius` [m].
    """

    place: float
    value: float
    cant: float = 0.0
    form: str | None = None
    curve: float = 0.0
    by_radius: bool = False


def railml_line(root: ET.Element, asked: Sequence[str], source: str) -> Alignment:
    """Return the line over tracks."""
    found = next(inside(root, "infrastructure"), root)
    if next(inside(found, "horizontalCurves", "gradientCurves"), None) is not None:
        return read_railml3(found, asked, source)
    elements = {one.get("id") or one.get("name") or f"{n}": one for n, one in enumerate(inside(found, "track"), 1)}
    ends = {name: _ends(one, source) for name, one in elements.items()}
    route = route_of({name: end - begin for name, (begin, end) in ends.items()}, asked, source)
    account = Account()
    tracks = []
    for name, back in route:
        track = _track(elements[name], name, *ends[name], source, account)
        tracks.append(track.backwards() if back else track)
    names = listed(track.name for track in tracks)
    account.taken.append(f"tracks {names}: positions of begin, end and changes")
    account.converted += ["radius in m to curvature; 0 is straight", "slope: per mille to 1", "superelevation: mm to m"]
    account.assumed += [
        "a positive radius is a curve to the right, as in version 3; --mirror exchanges the sides",
        "superelevation raises the outer rail",
    ]
    for tag, reason in LEFT.items():
        if any(next(inside(elements[name], tag), None) is not None for name, _ in route):
            account.left.append(f"{tag}: {reason}")
    return joined(tracks, source, account)


def _ends(track: ET.Element, source: str) -> tuple[float, float]:
    places = []
    for name in ("trackBegin", "trackEnd"):
        one = next(inside(track, name), None)
        if one is None:
            raise FileError(f"{source}: track {shown(track.get('id'))} must have a {name}; it is missing. Add it.")
        places.append(required(one, "pos", source, LONGEST))
    if not places[1] - places[0] >= SHORTEST:
        raise FileError(
            f"{source}: track {shown(track.get('id'))} must end after its begin; got {places[0]:g} to {places[1]:g} m. "
            "Correct the positions."
        )
    return places[0], places[1]


def _track(element: ET.Element, name: str, begin: float, end: float, source: str, account: Account) -> Track:
    bends, slopes = [], []
    what = f"{source}, track {shown(name)}"
    for one in _along(element, "radiusChange", (begin, end), what, account):
        radius = required(one, "radius", source, 1e9)
        height = attribute(one, "superelevation", source, 300.0) or 0.0
        bend = -1.0 / radius if radius else 0.0
        described = (one.get("geometryElementDescription") or "").lower()
        form = next((form for word, form in TRANSITIONS.items() if word in described), None)
        bends.append(Change(_place(one, begin, end, source), bend, math.copysign(height / 1000.0, bend), form))
    for one in _along(element, "gradientChange", (begin, end), what, account):
        slope = required(one, "slope", source, 500.0) / 1000.0
        length = attribute(one, "transitionLength", source, LONGEST)
        radius = attribute(one, "transitionRadius", source, 1e9) or 0.0
        curve = radius if length is None else length
        place = _place(one, begin, end, source)
        slopes.append(Change(place, slope, curve=abs(curve), by_radius=length is None))
    for changes, tag, words in ((bends, "radiusChange", "straight"), (slopes, "gradientChange", "level")):
        first = min((change.place for change in changes), default=0.0)
        if first >= SHORTEST:
            account.assumed.append(f"track {name} is {words} before its first {tag}, at {begin + first:g} m")
    if not bends:
        account.assumed.append(f"track {name} is straight: it has no radiusChange")
    if not slopes:
        account.assumed.append(f"track {name} is level: it has no gradientChange")
    curvature, cant = _between(sorted(bends, key=lambda one: one.place), end - begin)
    gradient = _slopes(sorted(slopes, key=lambda one: one.place), end - begin, account)
    return Track(name, end - begin, curvature, cant, gradient)


def _along(track: ET.Element, tag: str, ends: Sequence[float], what: str, account: Account) -> list[ET.Element]:
    """Return the changes in the direction of a track with these ends. Raises FileError for others that stand alone."""
    found: dict[str, list[ET.Element]] = {"along": [], AGAINST: []}
    for one in inside(track, tag):
        direction = one.get("dir", "").strip().lower()
        if direction not in (*ALONG, AGAINST):
            raise FileError(f"{what}: dir of {tag} must be up or down; got {shown(one.get('dir'))}. Correct it.")
        found[AGAINST if direction == AGAINST else "along"].append(one)
    places = [required(one, "pos", what, LONGEST) for one in found["along"]]
    places += ends if places else []
    for one in found[AGAINST]:
        place = required(one, "pos", what, LONGEST)
        if not any(abs(place - other) < SHORTEST for other in places):
            raise FileError(
                f"{what}: {tag} with dir down must stand beside one with dir up; got it alone at {place:g} m. State "
                "the change in the direction of the track."
            )
    if found[AGAINST]:
        account.left.append(f"{tag} with dir down, {len(found[AGAINST])} in number: those with dir up are read")
    return found["along"]


def _place(one: ET.Element, begin: float, end: float, source: str) -> float:
    place = required(one, "pos", source, LONGEST)
    if not begin - SHORTEST <= place <= end + SHORTEST:
        raise FileError(
            f"{source}: pos of {one.tag} must be on its track, {begin:g} to {end:g} m; got {place:g} m. Correct it."
        )
    return min(max(place, begin), end) - begin


def _between(changes: Sequence[Change], end: float) -> tuple[list[Piece], list[Piece]]:
    """Return curvature and cant from change to change."""
    curvature, cant = [], []
    for one, after in pairwise([*changes, Change(end, changes[-1].value, changes[-1].cant)] if changes else []):
        if after.place - one.place >= SHORTEST:
            last = after if one.form else one
            form = one.form or LINEAR
            curvature.append(Piece(one.place, after.place, one.value, last.value, form))
            cant.append(Piece(one.place, after.place, one.cant, last.cant, form))
    return curvature, cant


def _slopes(changes: Sequence[Change], end: float, account: Account) -> list[Piece]:
    """Return gradients from change to change; vertical curves lie half before and half behind their change."""
    pieces: list[Piece] = []
    place, steep = 0.0, 0.0
    for number, change in enumerate(changes):
        following = changes[number + 1].place if number + 1 < len(changes) else end
        length = change.curve * abs(change.value - steep) if change.by_radius else change.curve
        half = min(length / 2.0, change.place - place, following - change.place) if number else 0.0
        if number and length - 2.0 * half > OVERLAP:
            made = f"from {length:.1f} to {2.0 * half:.1f} m, the room that its neighbours leave"
            account.assumed.append(f"the vertical curve at {change.place:.1f} m is shortened {made}")
        if change.place - half - place >= SHORTEST:
            pieces.append(Piece(place, change.place - half, steep, steep))
        if half >= SHORTEST:
            pieces.append(Piece(change.place - half, change.place + half, steep, change.value))
        place, steep = change.place + half, change.value
    if end - place >= SHORTEST:
        pieces.append(Piece(place, end, steep, steep))
    return pieces
