"""Tables of a few points in a cell of a consist, such as 0:0.30 40:0.22 120:0.15."""

from __future__ import annotations

from itertools import pairwise

from brake_controller.point_table import MOST_POINTS
from readers.columns import number_of

Limits = tuple[float, float]
#: Least distance of two places over the range of places: slopes stay finite, and their sum keeps ten digits.
CLOSEST = 1e-6


def pairs_of(
    text: str, places: Limits, values: Limits, most: int = MOST_POINTS
) -> tuple[list[float], list[float]] | None:
    """Return places, which rise, and the values there; None unless they are 2 to `most` points within both limits.

    Places rise by CLOSEST of their range at least.
    """
    pairs = [one.split(":") for one in text.split()]
    if not 2 <= len(pairs) <= most or any(len(one) != 2 for one in pairs):
        return None
    numbers = [(number_of(place), number_of(value)) for place, value in pairs]
    within = all(places[0] <= x <= places[1] and values[0] <= y <= values[1] for x, y in numbers)
    closest = CLOSEST * (places[1] - places[0])
    if not within or any(b[0] - a[0] < closest for a, b in pairwise(numbers)):
        return None
    return [x for x, _ in numbers], [y for _, y in numbers]


def text_of(places: list[float], values: list[float]) -> str:
    """Return the text of a table, with twelve digits."""
    return " ".join(f"{x:.12g}:{y:.12g}" for x, y in zip(places, values, strict=True))
