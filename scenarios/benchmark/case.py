"""Cases of a benchmark in memory: inputs, published answers and their bounds, all in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from scenarios.benchmark.entries import Input, scale_of


@dataclass(frozen=True)
class AnswerQuantity:
    """A quantity that a program computes: description, unit of tables, and the bound of its error.

    bound: absolute [SI], or relative to the published value [1]; None without a bound. judged: whether an error above
    the bound is a failure; otherwise it is only shown.
    """

    name: str
    what: str
    unit: str
    judged: bool
    bound: float | None
    relative: bool

    @property
    def scale(self) -> float:
        """Return the SI value of one `unit`."""
        return scale_of(self.unit)


@dataclass(frozen=True)
class CasePoint:
    """Inputs of a point in SI units, and its published answers by name in SI units."""

    inputs: Mapping[str, Input]
    published: Mapping[str, float]
    own: tuple[str, ...] = ()


@dataclass(frozen=True)
class Unknown:
    """Distribution of an input: `uniform` between two, `normal` by mean and deviation, `list` of equal shares [SI]."""

    kind: str
    numbers: tuple[float, ...]
    source: str

    def draw(self, generator: np.random.Generator, count: int) -> list[float]:
        """Return `count` random values."""
        if self.kind == "list":
            found = generator.choice(np.array(self.numbers), count)
        else:
            found = getattr(generator, self.kind)(*self.numbers, count)
        return [float(one) for one in found]


@dataclass(frozen=True)
class BenchmarkCase:
    """A case: descriptions, units of its inputs, answers, points, and distributions of inputs that are not known."""

    name: str
    path: Path = field(repr=False)
    title: str
    question: str
    description: str
    source: str
    licence: str
    sureness: str
    note: str
    units: Mapping[str, str]
    answers: Mapping[str, AnswerQuantity]
    points: tuple[CasePoint, ...]
    unknown: Mapping[str, Unknown]
