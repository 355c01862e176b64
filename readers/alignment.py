"""The course of a track as other programs state it: pieces of curvature, cant and gradient."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from readers.import_account import Account
from readers.text import FileError

#: Most pieces of one quantity, and shortest piece [m].
MOST_PIECES, SHORTEST = 200_000, 0.01
#: Forms of a piece: constant slope, or the curve of Bloss, 3 t^2 - 2 t^3.
LINEAR, BLOSS = "linear", "bloss"
#: Gap or overlap of consecutive pieces that is rounding of the file's numbers [m].
ROUNDING = 2e-3
#: Largest overlap of vertical curves that touch [m], and its part that grows with the distance of their points: heights
#: are rounded, and parabolas are longer than circles. It is also limited as a share of that distance.
OVERLAP, OVERLAP_SHARE, MOST_SHARE = 0.1, 0.005, 0.05


def may_touch(taken: float, way: float) -> bool:
    """Return whether two halves of vertical curves [m] between points a way apart [m] overlap by rounding at most."""
    return taken - way <= min(OVERLAP + OVERLAP_SHARE * way, MOST_SHARE * way)


@dataclass(frozen=True)
class Piece:
    """A stretch on which one quantity changes from a first to a last value.

    Attributes
    ----------
    begin, end : float
        Places [m].
    first, last : float
        Values at both.
    form : str
        LINEAR or BLOSS.
    """

    begin: float
    end: float
    first: float
    last: float
    form: str = LINEAR


@dataclass(frozen=True)
class Alignment:
    """Curvature, cant and gradient of a track, each by pieces. Between pieces the value is 0.

    Attributes
    ----------
    source : str
        The file, for messages.
    begin, end : float
        First and last place [m].
    curvature : sequence of Piece
        Curvature [1/m], positive to the left.
    cant : sequence of Piece
        Height of the right rail over the left one [m].
    gradient : sequence of Piece
        Rise per metre.
    in_plan : bool
        Whether lengths are those of the plan: then a gradient is a rise per metre of the plan, a tangent.
    account : Account
        What the reader took, converted, left and assumed.
    """

    source: str
    begin: float
    end: float
    curvature: Sequence[Piece] = ()
    cant: Sequence[Piece] = ()
    gradient: Sequence[Piece] = ()
    in_plan: bool = False
    account: Account = field(default_factory=Account)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.begin) and math.isfinite(self.end) and self.end - self.begin > SHORTEST):
            raise FileError(
                f"{self.source}: a line must be longer than {SHORTEST:g} m; got {self.end - self.begin:g} m. Check it."
            )
        for name in ("curvature", "cant", "gradient"):
            object.__setattr__(self, name, self._in_order(name, getattr(self, name)))

    def _in_order(self, name: str, pieces: Sequence[Piece]) -> tuple[Piece, ...]:
        """Return pieces of one quantity without gaps, in their order. Raises FileError."""
        if len(pieces) > MOST_PIECES:
            raise FileError(
                f"{self.source} must have at most {MOST_PIECES} pieces of {name}; it has {len(pieces)}. Split the line."
            )
        for piece in pieces:
            numbers = (piece.begin, piece.end, piece.first, piece.last)
            if not all(math.isfinite(number) for number in numbers) or not piece.end - piece.begin >= SHORTEST:
                raise FileError(
                    f"{self.source}: a piece of {name} must have finite numbers and {SHORTEST:g} m of length; got "
                    f"{piece.begin:.10g} to {piece.end:.10g} m. Correct or remove it."
                )
        return tuple(self._filled(name, sorted(pieces, key=lambda piece: piece.begin)))

    def _filled(self, name: str, pieces: Sequence[Piece]) -> Iterable[Piece]:
        place = self.begin
        for piece in [*pieces, Piece(self.end, math.inf, 0.0, 0.0)]:
            if piece.begin < place - ROUNDING:
                raise FileError(
                    f"{self.source}: pieces of {name} must not overlap; got one that begins at {piece.begin:.10g} m, "
                    f"before {place:.10g} m. Correct its place or length."
                )
            if piece.begin - place > max(ROUNDING, SHORTEST):
                yield Piece(place, piece.begin, 0.0, 0.0)
                place = piece.begin
            if math.isfinite(piece.end):
                if piece.end > self.end + ROUNDING:
                    raise FileError(
                        f"{self.source}: pieces of {name} must lie on the line, which ends at {self.end:.10g} m; got "
                        f"one to {piece.end:.10g} m. Correct its place or length."
                    )
                yield Piece(place, piece.end, piece.first, piece.last, piece.form)
                place = piece.end

    def jumps(self, name: str, least: float) -> list[tuple[float, float]]:
        """Return place and size of each jump of a quantity that is above `least`."""
        pieces: Sequence[Piece] = getattr(self, name)
        steps = ((after.begin, after.first - before.last) for before, after in pairwise(pieces))
        return [(place, size) for place, size in steps if abs(size) > least]
