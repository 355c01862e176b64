"""Tables of a few points in parameters of C: straight lines between the points, constant outside them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from fmu_src.symbols import ca

#: Largest number of points, where a table has no other.
MOST_POINTS = 6


def with_default(unit: str, description: str, default: float, minimum: float = -math.inf) -> Any:
    """Return a field like `quantity`, by keyword, with a value for parameter sets without the table or law."""
    limits = {"minimum": minimum, "maximum": math.inf}
    more = {"unit": unit, "description": description, "kind": "real"} | limits
    return field(default=default, kw_only=True, metadata=more)


def _steps(values: Sequence[float]) -> list[float]:
    return [after - before for before, after in pairwise(values)]


@dataclass(frozen=True)
class PointTable:
    """Names of a table's parameters, as a sum of hinges.

    first: value up to the first place. place, change: each point's place and its change of slope, with _1 to _6 behind.
    Points that are not used have a place of 0. most: largest number of points.
    """

    first: str
    place: str
    change: str
    most: int = MOST_POINTS

    def numbers(self, places: Sequence[float], values: Sequence[float]) -> dict[str, float]:
        """Return the parameters of a table by two to `most` places that rise, and the values there."""
        slopes = [0.0, *(b / a for a, b in zip(_steps(places), _steps(values), strict=True)), 0.0]
        found = {self.first: values[0]}
        for number in range(1, self.most + 1):
            given = number <= len(places)
            found[f"{self.place}_{number}"] = places[number - 1] if given else 0.0
            found[f"{self.change}_{number}"] = slopes[number] - slopes[number - 1] if given else 0.0
        return found

    def points(self, p: Mapping[str, float]) -> tuple[list[float], list[float]]:
        """Return the places and values of parameters by `numbers`."""
        numbers = [n for n in range(1, self.most + 1) if n == 1 or p[f"{self.place}_{n}"] > 0.0]
        places = [p[f"{self.place}_{n}"] for n in numbers]
        values, slope = [p[self.first]], 0.0
        for number, step in zip(numbers, _steps(places), strict=False):
            slope += p[f"{self.change}_{number}"]
            values.append(values[-1] + slope * step)
        return places, values

    def at(self, p: Mapping[str, ca.SX], place: ca.SX) -> ca.SX:
        """Return the value at a place."""
        value = p[self.first]
        for number in range(1, self.most + 1):
            value += p[f"{self.change}_{number}"] * ca.fmax(place - p[f"{self.place}_{number}"], 0)
        return value
