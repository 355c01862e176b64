"""A line from pieces of curvature, cant and gradient, whose joints may differ from quantity to quantity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rbd_model.track.line import MOST_ROWS, Line
from rbd_model.track.line_table import LINE, ROUNDING
from readers.alignment import BLOSS, Alignment, Piece
from readers.import_account import Account
from readers.text import FileError

Numbers = NDArray[np.float64]
#: Share of a short piece over which a jump at its end is spread; otherwise it is spread over ROUNDING.
SPREAD = 0.45
#: Parts of a piece with Bloss's curve: chords deviate by up to 6 / 8 / PARTS^2 = 0.02 % of the change.
PARTS = 60
#: Largest turn from row to row [rad]. Places closer than this are one row [m].
ROW_TURN, MERGED = 0.05, 2e-3
#: Error of the height along a vertical curve [m], and limits of the distance of its rows [m].
HEIGHT_ERROR, NEAREST, FARTHEST = 1e-7, 1.0, 50.0
#: Nodes and weights of Gauss's rule with three points, over 0 to 1.
NODES, WEIGHTS = np.array([0.5 - 0.15**0.5, 0.5, 0.5 + 0.15**0.5]), np.array([5.0, 8.0, 5.0]) / 18.0


@dataclass(frozen=True, eq=False)
class SourcedLine(Line):
    """A line that was made of other data.

    Attributes
    ----------
    account : Account
        What was taken, converted, left and assumed. `print(line.account)` shows it.
    """

    account: Account = field(default_factory=Account, repr=False)


def course(pieces: Sequence[Piece], begin: float, end: float) -> tuple[Numbers, Numbers]:
    """Return places and values of a quantity that is linear between them; jumps become short ramps."""
    if not pieces:
        return np.array([begin, end]), np.zeros(2)
    lengths = [piece.end - piece.begin for piece in pieces]
    reach = [0.0]
    for before, after in zip(range(len(pieces) - 1), range(1, len(pieces)), strict=True):
        jumps = abs(pieces[after].first - pieces[before].last) > 1e-12
        reach.append(min(ROUNDING, SPREAD * lengths[before], SPREAD * lengths[after]) if jumps else 0.0)
    reach.append(0.0)
    places, values = [], []
    for number, piece in enumerate(pieces):
        parts = PARTS if piece.form == BLOSS else 1
        share = np.linspace(reach[number] / lengths[number], 1.0 - reach[number + 1] / lengths[number], parts + 1)
        grown = share**2 * (3.0 - 2.0 * share) if piece.form == BLOSS else share
        skip = int(number > 0 and reach[number] == 0.0)  # the place is the last one of the piece before
        places.append((piece.begin + share * lengths[number])[skip:])
        values.append((piece.first + grown * (piece.last - piece.first))[skip:])
    return np.concatenate(places), np.concatenate(values)


def line_of_alignment(alignment: Alignment) -> SourcedLine:
    """Return the line of an alignment: a row at each joint, more where curves need them.

    In an alignment whose lengths are those of the plan, distance, curvature and gradient are converted to those along
    the line.
    """
    courses = [course(quantity, alignment.begin, alignment.end) for quantity in _quantities(alignment)]
    for name, (at, values) in zip(("curvature", "cant", "gradient"), courses, strict=True):
        sized = values / np.hypot(1.0, values) if alignment.in_plan and name == "gradient" else values
        _check({"distance": at, name: sized}, alignment.source)
    places = _places(courses, alignment)
    curvature, cant, gradient = (np.interp(places, *one) for one in courses)
    distance = places
    if alignment.in_plan:
        ways = np.diff(places)
        between = gradient[:-1, None] + NODES * np.diff(gradient)[:, None]
        distance = places[0] + np.concatenate([[0.0], np.cumsum(ways * (np.sqrt(1.0 + between**2) @ WEIGHTS))])
        length = np.sqrt(1.0 + gradient**2)
        curvature, gradient = curvature / length, gradient / length
    rows = {"distance": distance, "curvature": curvature, "cant": cant, "gradient": gradient}
    _check(rows, alignment.source)
    return SourcedLine(rows, alignment.account)


def _quantities(alignment: Alignment) -> tuple[Sequence[Piece], ...]:
    return alignment.curvature, alignment.cant, alignment.gradient


def _places(courses: Sequence[tuple[Numbers, Numbers]], alignment: Alignment) -> Numbers:
    """Return the places of rows [m]. Raises FileError if there are too many."""
    places = np.unique(np.concatenate([one[0] for one in courses]))
    places = places[np.append(True, np.diff(places) > MERGED)]
    places[-1] = alignment.end
    curvature, gradient = (np.interp(places, *courses[number]) for number in (0, 2))
    ways = np.diff(places)
    turn = np.maximum(np.abs(curvature[1:]), np.abs(curvature[:-1])) * ways
    counts = np.ceil(turn / ROW_TURN)
    if alignment.in_plan:
        slope = np.abs(np.diff(gradient)) / ways
        bend = 1.5 * np.maximum(np.abs(gradient[1:]), np.abs(gradient[:-1])) ** 2 * slope
        apart = np.clip(np.sqrt(12 * HEIGHT_ERROR / np.maximum(bend, 1e-300)), NEAREST, FARTHEST)
        counts = np.maximum(counts, np.where(slope > 0.0, np.ceil(ways / apart), 1.0))
    counts = np.maximum(counts, 1.0)
    if not counts.sum() < MOST_ROWS:
        raise FileError(
            f"{alignment.source} must make at most {MOST_ROWS} rows; its {alignment.end - alignment.begin:g} m make "
            f"{counts.sum():.3g}. Check lengths and radii, or split the line."
        )
    parts = [np.linspace(a, b, int(n), endpoint=False) for a, b, n in zip(places, places[1:], counts, strict=False)]
    return np.concatenate([*parts, places[-1:]])


def _check(rows: dict[str, Numbers], source: str) -> None:
    for column in LINE.columns:
        values = rows.get(column.name)
        if values is None:
            continue
        if not np.all((values >= column.minimum) & (values <= column.maximum)):
            row = int(np.argmax(np.abs(values - (column.minimum + column.maximum) / 2.0)))
            unit = "" if column.unit == "1" else f" {column.unit}"
            tells = f" (a radius of {1 / values[row]:.4g} m)" if column.name == "curvature" else ""
            raise FileError(
                f"{source}: {column.name} must be from {column.minimum:g} to {column.maximum:g}{unit}; got "
                f"{values[row]:.6g}{unit}{tells} at {rows['distance'][row]:.1f} m. Check value and unit."
            )


def end_of(rows: dict[str, Numbers]) -> dict[str, float]:
    """Return length, turn, place in the plan and height of the last row, with columns linear between rows.

    The plan begins at 0, 0 along the first axis. Places are integrals by Gauss's rule between the rows.
    """
    ways, curvature, gradient = np.diff(rows["distance"]), rows["curvature"], rows["gradient"]
    bends = curvature[:-1], np.diff(curvature)
    heading = np.concatenate([[0.0], np.cumsum(ways * (bends[0] + bends[1] / 2.0))])
    over = heading[:-1, None] + ways[:, None] * (bends[0][:, None] * NODES + bends[1][:, None] * NODES**2 / 2.0)
    slope = gradient[:-1, None] + np.diff(gradient)[:, None] * NODES
    level = ways[:, None] * np.sqrt(1.0 - slope**2)
    return {
        "length": float(rows["distance"][-1] - rows["distance"][0]),
        "plan": float(np.sum(level @ WEIGHTS)),
        "turn": float(heading[-1]),
        "ahead": float(np.sum((level * np.cos(over)) @ WEIGHTS)),
        "aside": float(np.sum((level * np.sin(over)) @ WEIGHTS)),
        "height": float(np.sum(ways * (slope @ WEIGHTS))),
    }


def sums(line: Line) -> list[str]:
    """Return the sums of a line as sentences."""
    end = end_of(line.rows)
    return [
        f"lengths and gradients along the line: {end['length']:.3f} m, {end['plan']:.3f} m in plan",
        f"end of the line: {end['ahead']:.3f} m ahead and {end['aside']:.3f} m to the left of its start, turned by "
        f"{np.degrees(end['turn']):.4f} degrees, {end['height']:+.3f} m in height",
    ]
