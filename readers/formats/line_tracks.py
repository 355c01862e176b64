"""Tracks of networks of other programs, and the route over them that becomes a line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from readers.alignment import Alignment, Piece
from readers.import_account import Account
from readers.text import FileError, shown

#: Sign behind a track's name that is run from its end to its begin. Names that a message lists.
BACKWARDS, LISTED = "-", 8
#: Sizes of jumps that are told: curvature [1/m], cant [m], gradient.
TOLD = {"curvature": 1e-6, "cant": 1e-4, "gradient": 1e-5}
UNITS = {"curvature": " 1/m", "cant": " m", "gradient": ""}


@dataclass(frozen=True)
class Track:
    """A track from its begin at 0 m to its length; pieces as in `Alignment`."""

    name: str
    length: float
    curvature: Sequence[Piece] = ()
    cant: Sequence[Piece] = ()
    gradient: Sequence[Piece] = ()

    def backwards(self) -> Track:
        """Return the track from its end to its begin."""
        turned = (self._turned(getattr(self, name)) for name in TOLD)
        return Track(self.name + BACKWARDS, self.length, *turned)

    def _turned(self, pieces: Sequence[Piece]) -> list[Piece]:
        return [
            Piece(self.length - piece.end, self.length - piece.begin, -piece.last, -piece.first, piece.form)
            for piece in reversed(pieces)
        ]


def listed(names: Iterable[str]) -> str:
    """Return names for a message, the first ones of many."""
    known = list(names)
    more = f" and {len(known) - LISTED} more" if len(known) > LISTED else ""
    return ", ".join(shown(one) for one in known[:LISTED]) + more


def route_of(tracks: Mapping[str, float], asked: Sequence[str], source: str) -> list[tuple[str, bool]]:
    """Return the names of a route's tracks, each with whether it is run backwards.

    Takes tracks [m].
    """
    if not tracks:
        raise FileError(f"{source} must have tracks with a length; got none. Give another file.")
    if not asked:
        if len(tracks) > 1:
            raise FileError(
                f"{source}: the tracks of the route must be named, as --tracks {next(iter(tracks))}; the file has "
                f"{listed(tracks)}. Name them in their order."
            )
        return [(next(iter(tracks)), False)]
    found = []
    for name in asked:
        back = name not in tracks and name.endswith(BACKWARDS)
        own = name.removesuffix(BACKWARDS) if back else name
        if own not in tracks:
            raise FileError(f"{source} must have the track {shown(own)}; it has {listed(tracks)}. Name one of these.")
        found.append((own, back))
    return found


def joined(tracks: Sequence[Track], source: str, account: Account, start: float = 0.0) -> Alignment:
    """Return consecutive tracks as one line from `start` [m]. Raises FileError."""
    pieces: dict[str, list[Piece]] = {name: [] for name in TOLD}
    place = start
    for track in tracks:
        for name, found in pieces.items():
            found += [replace(one, begin=one.begin + place, end=one.end + place) for one in getattr(track, name)]
        place += track.length
    curvature, cant, gradient = pieces.values()
    alignment = Alignment(source, start, place, curvature, cant, gradient, account=account)
    tell_jumps(alignment)
    return alignment


def tell_jumps(alignment: Alignment) -> None:
    """Add the jumps of an alignment to its account."""
    for name, least in TOLD.items():
        jumps = alignment.jumps(name, least)
        if jumps:
            place, size = max(jumps, key=lambda one: abs(one[1]))
            many = f"{len(jumps)} places" if len(jumps) > 1 else "1 place"
            most = f"{abs(size):.4g}{UNITS[name]} at {place:.1f} m"
            alignment.account.assumed.append(
                f"{name} jumps at {many}, by up to {most}; each jump is spread over 1 m to both sides"
            )
