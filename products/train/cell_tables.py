"""Tables of a few points in a cell of a consist, such as 0:0.30 40:0.22 120:0.15."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from brake_controller.drive import MOST_DRIVE_POINTS
from brake_controller.point_table import MOST_POINTS
from readers.decimal_numbers import number_of

Limits = tuple[float, float]
#: Least distance of two places over the range of places: slopes stay finite, and their sum keeps ten digits.
CLOSEST = 1e-6
_SPEED = "a speed that rises by 0.001 km/h or more, up to 1000 km/h"


@dataclass(frozen=True)
class CellTable:
    """Limits of the places and values of a table, its largest number of points, and its description for messages.

    above_0: whether one value must be above 0.
    """

    places: Limits
    values: Limits
    text: str
    example: str
    most: int = MOST_POINTS
    above_0: bool = False

    def points(self, text: str) -> tuple[list[float], list[float]] | None:
        """Return places, which rise by CLOSEST of their range at least, and values; None if it is no such table."""
        pairs = [one.split(":") for one in text.split()]
        if not 2 <= len(pairs) <= self.most or any(len(pair) != 2 for pair in pairs):
            return None
        places, values = ([number_of(number) for number in numbers] for numbers in zip(*pairs, strict=True))
        for numbers, (least, most) in ((places, self.places), (values, self.values)):
            if not all(least <= one <= most for one in numbers):
                return None
        closest = CLOSEST * (self.places[1] - self.places[0])
        if any(b - a < closest for a, b in pairwise(places)) or (self.above_0 and max(values) <= 0.0):
            return None
        return places, values


_DRIVE = CellTable(
    (0.0, 1000.0),
    (0.0, 2000.0),
    f"{_SPEED}, and a force from 0 to 2000 kN, not all of them 0",
    "0:300 50:290 100:150",
    MOST_DRIVE_POINTS,
    above_0=True,
)
#: Tables by their columns: friction and forces [kN] over speeds [km/h], shares of friction over temperatures [degC].
CELL_TABLES = {
    "friction_table": CellTable(
        (0.0, 1000.0), (0.001, 1.0), f"{_SPEED}, and a friction from 0.001 to 1", "0:0.30 40:0.22 120:0.15"
    ),
    "dynamic_table": _DRIVE,
    "traction_table": _DRIVE,
    "fade_table": CellTable(
        (0.0, 1500.0),
        (0.0, 2.0),
        "a temperature that rises, from 0 to 1500 degC, and a share of friction from 0 to 2",
        "250:1 450:0.3",
    ),
}


def points_in(name: str, text: str) -> tuple[list[float], list[float]]:
    """Return places and values of the table in a column. Raises ValueError."""
    table = CELL_TABLES[name]
    found = table.points(text)
    if found is None:
        raise ValueError(
            f"{name} must be 2 to {table.most} pairs of {table.text}; got {text!r}. Write it as {table.example}."
        )
    return found


def text_of(places: Iterable[float], values: Iterable[float]) -> str:
    """Return the text of a table, with twelve digits of its largest value: sums of slopes miss 0 by their rounding."""
    pairs = list(zip(places, values, strict=True))
    tiny = 1e-12 * max(abs(y) for _, y in pairs)
    return " ".join(f"{x:.12g}:{y if abs(y) > tiny else 0.0:.12g}" for x, y in pairs)
