"""A line from the tables of a survey: elements in plan with cant, and points of vertical intersection.

Lengths and chainages are those of the plan. A transition between two elements has their curvatures and cants at its
ends. A vertical curve is a parabola: its gradient is linear in the chainage.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rbd_model.track.line_pieces import SourcedLine, line_of_alignment, sums
from readers.alignment import BLOSS, LINEAR, SHORTEST, Alignment, Piece, may_touch
from readers.columns import Column
from readers.import_account import Account
from readers.tables import Table, read_table

STRAIGHT, ARC, CLOTHOID, BLOSS_CURVE = "straight", "arc", "clothoid", "bloss"
#: Words of the column `type`, and what they mean.
KINDS = {
    **dict.fromkeys(("straight", "line", "tangent"), STRAIGHT),
    **dict.fromkeys(("arc", "curve", "circle"), ARC),
    **dict.fromkeys(("transition", "clothoid", "spiral"), CLOTHOID),
    "bloss": BLOSS_CURVE,
}
SIDES = {"left": 1.0, "l": 1.0, "right": -1.0, "r": -1.0}
ELEMENTS = (
    Column("type", words=tuple(KINDS), required=True),
    Column("length", "m", 0.01, 1e6, required=True),
    Column("radius", "m", -1e12, 1e12, filled=False),
    Column("side", words=tuple(SIDES), filled=False),
    Column("cant", "m", -0.3, 0.3, filled=False),
)
PROFILE = (
    Column("chainage", "m", -1e7, 1e7, required=True),
    Column("height", "m", -1e4, 1e4, required=True),
    Column("radius", "m", 0.0, 1e12, filled=False),
)
#: Distance between chainage and end of the profile up to which both are one place [m]. Least radius of an arc [m].
SAME, LEAST_RADIUS = 1e-3, 50.0


def line_from_elements(path: str | Path, profile: str | Path | None = None, start: float | None = None) -> SourcedLine:
    """Return a line from a table of elements, and if given a table of points of vertical intersection.

    Parameters
    ----------
    path : str or Path
        Table with the columns type (straight, arc, transition or clothoid, bloss), length [m], radius [m], cant [m],
        and side (left, right) if the radius has no sign. A positive radius is a curve to the left. A positive cant
        suits the curve; on straight track it raises the right rail.
    profile : str or Path, optional
        Table with the columns chainage [m], height [m], and radius [m] of the vertical curve. Without it the line is
        level.
    start : float, optional
        Chainage of the first element [m]; by default the first one of the profile, otherwise 0.

    Returns
    -------
    SourcedLine
        The line. Its `account` has the sums: length, turn, end in the plan, difference of height.

    Raises
    ------
    FileError
        If a table cannot be read, elements do not fit, or a value is outside the limits of a line.
    """
    table = read_table(path, ELEMENTS)
    table.check_rows(1)
    points = None if profile is None else _profile(profile)
    begin = start if start is not None else (0.0 if points is None else float(points.numbers["chainage"][0]))
    curvature, cant = _in_plan(table, begin)
    end = curvature[-1].end
    account = Account([f"{len(curvature)} elements of {table.source}, {end - begin:.3f} m in plan"], [*table.meant])
    account.converted += [] if points is None else points.meant
    gradient = [] if points is None else _gradients(points, begin, end, account)
    account.assumed += _adverse(table)
    if points is None:
        account.assumed.append("the line is level: no profile was given")
    alignment = Alignment(str(path), begin, end, curvature, cant, gradient, True, account)
    for name, least, unit in (("curvature", 1e-6, "1/m"), ("cant", 1e-4, "m"), ("gradient", 1e-5, "")):
        account.assumed += [
            f"{name} jumps by {size:.4g} {unit}".rstrip() + f" at {place:.1f} m: spread over 1 m to both sides"
            for place, size in alignment.jumps(name, least)
        ]
    line = line_of_alignment(alignment)
    account.converted += sums(line)
    return line


def _in_plan(table: Table, begin: float) -> tuple[list[Piece], list[Piece]]:
    """Return curvature and cant of the elements. Raises TableError."""
    kinds = [KINDS[word] for word in table.words["type"]]
    own = [_curvature(table, row, kind) for row, kind in enumerate(kinds)]
    cants = [_cant(table, row, kind, bend) for row, (kind, bend) in enumerate(zip(kinds, own, strict=True))]
    curvature, cant, place = [], [], begin
    for row, kind in enumerate(kinds):
        length = float(table.numbers["length"][row])
        ends = [(own[row], own[row])] if kind in (STRAIGHT, ARC) else _between(table, row, kinds, own)
        level = [(cants[row], cants[row])] if kind in (STRAIGHT, ARC) else _between(table, row, kinds, cants)
        form = BLOSS if kind == BLOSS_CURVE else LINEAR
        curvature.append(Piece(place, place + length, *ends[0], form))
        cant.append(Piece(place, place + length, *level[0], form))
        place += length
    return curvature, cant


def _between(table: Table, row: int, kinds: list[str], values: list[float]) -> list[tuple[float, float]]:
    """Return the values at both ends of a transition: those of its neighbours, 0 at the ends of the table."""
    for other in (row - 1, row + 1):
        if 0 <= other < len(kinds) and kinds[other] not in (STRAIGHT, ARC):
            raise table.refusal(
                max(row, other),
                "type",
                "a transition must lie between straights and arcs; got two transitions in a row. Put an element "
                "between them, of 1 m or more.",
            )
    before = values[row - 1] if row else 0.0
    return [(before, values[row + 1] if row + 1 < len(kinds) else 0.0)]


def _optional(table: Table, name: str, row: int) -> float | None:
    values = table.numbers.get(name)
    return None if values is None or math.isnan(values[row]) else float(values[row])


def _curvature(table: Table, row: int, kind: str) -> float:
    radius = _optional(table, "radius", row) or 0.0
    side = (table.words.get("side") or [""] * (row + 1))[row]
    if kind != ARC:
        if radius and kind == STRAIGHT:
            raise table.refusal(row, "radius", f"a straight must have no radius; got {radius:g} m. Make it an arc.")
        return 0.0
    if not abs(radius) >= LEAST_RADIUS:
        given = "none" if not radius else f"{radius:g} m"
        raise table.refusal(
            row, "radius", f"an arc must have a radius of {LEAST_RADIUS:g} m or more; got {given}. Check it."
        )
    if side and radius < 0.0:
        raise table.refusal(
            row, "radius", f"a radius with a side must be above 0; got {radius:g} m and {side}. Give one of the two."
        )
    return SIDES.get(side, 1.0) / radius


def _cant(table: Table, row: int, kind: str, curvature: float) -> float:
    cant = _optional(table, "cant", row) or 0.0
    return math.copysign(1.0, curvature) * cant if kind == ARC else cant if kind == STRAIGHT else 0.0


def _adverse(table: Table) -> list[str]:
    """Return a message on arcs whose cant does not suit them, if there are any."""
    arcs = [KINDS[word] == ARC for word in table.words["type"]]
    rows = [row for row, is_arc in enumerate(arcs) if is_arc and (_optional(table, "cant", row) or 0.0) < 0.0]
    if not rows:
        return []
    return [f"cant of {len(rows)} arcs, the first in row {table.places[rows[0]]}, is negative: adverse in its curve"]


def _profile(path: str | Path) -> Table:
    points = read_table(path, PROFILE)
    points.check_rows()
    apart = np.diff(points.numbers["chainage"])
    level = np.abs(np.diff(points.numbers["height"])) <= SHORTEST
    keep = np.append(True, ~((np.abs(apart) < SHORTEST) & level))
    if not np.any(points.numbers.get("radius", np.zeros(keep.size))[~keep] > 0.0):
        numbers = {name: values[keep] for name, values in points.numbers.items()}
        points = replace(points, numbers=numbers, places=points.places[keep])
    points.check_growth("chainage", SHORTEST)
    return points


def _gradients(points: Table, begin: float, end: float, account: Account) -> list[Piece]:
    """Return the gradients of a profile from `begin` to `end` [m], tangents of the slope. Raises TableError."""
    at, height = points.numbers["chainage"], points.numbers["height"]
    slopes = np.diff(height) / np.diff(at)
    radii = np.nan_to_num(points.numbers.get("radius", np.zeros(at.size)), nan=0.0)
    for row in (0, at.size - 1):
        if radii[row]:
            raise points.refusal(
                row, "radius", f"the first and the last point have no vertical curve; got {radii[row]:g} m. Remove it."
            )
    halves = _fitted(points, radii * np.abs(np.diff(slopes, prepend=slopes[0], append=slopes[-1])) / 2.0, account)
    pieces: list[Piece] = []
    for row, slope in enumerate(slopes.tolist()):
        first, last = float(at[row] + halves[row]), float(at[row + 1] - halves[row + 1])
        if row and halves[row] >= SAME:
            pieces.append(Piece(float(at[row] - halves[row]), first, float(slopes[row - 1]), slope))
        if last - first >= SHORTEST:
            pieces.append(Piece(first, last, slope, slope))
    account.taken.append(f"{at.size} points of the profile {points.source}, {np.count_nonzero(radii)} vertical curves")
    return _over(pieces, begin, end, account)


def _fitted(points: Table, halves: NDArray[np.float64], account: Account) -> NDArray[np.float64]:
    """Return half lengths of parabolas; circles that touch are a little shorter (landxml_profile.py). TableError."""
    ways, taken = np.diff(points.numbers["chainage"]), halves[1:] + halves[:-1]
    for row, (one, way) in enumerate(zip(taken.tolist(), ways.tolist(), strict=True)):
        if not may_touch(one, way):
            over = f"vertical curves must not overlap; got {one - way:.3f} m of overlap"
            raise points.refusal(row + 1, "radius", f"{over}. Give smaller radii.")
    if np.max(taken - ways) > SAME:
        account.assumed.append(f"vertical curves overlap by up to {np.max(taken - ways):.3f} m: they touch")
    shares = np.pad(np.minimum(ways / np.maximum(taken, 1e-300), 1.0), 1, constant_values=1.0)
    return halves * np.minimum(shares[1:], shares[:-1])


def _over(pieces: list[Piece], begin: float, end: float, account: Account) -> list[Piece]:
    """Return pieces cut to the line, or continued with their last gradient to its ends."""
    if begin < pieces[0].begin - SAME or end > pieces[-1].end + SAME:
        account.assumed.append(
            f"the profile reaches from {pieces[0].begin:.3f} to {pieces[-1].end:.3f} m, the elements from {begin:.3f} "
            f"to {end:.3f} m: the first and the last gradient go on"
        )
        pieces = [
            Piece(min(begin, pieces[0].begin) - 1.0, pieces[0].begin, pieces[0].first, pieces[0].first),
            *pieces,
            Piece(pieces[-1].end, max(end, pieces[-1].end) + 1.0, pieces[-1].last, pieces[-1].last),
        ]
    found = []
    for piece in pieces:
        first, last = max(piece.begin, begin), min(piece.end, end)
        if last - first >= SHORTEST:
            ends = np.interp([first, last], [piece.begin, piece.end], [piece.first, piece.last]).tolist()
            found.append(Piece(first, last, *ends))
    return found
