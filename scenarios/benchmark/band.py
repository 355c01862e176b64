"""Range of an answer: the program at random values of inputs that are not known, by the distributions of the case."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from scenarios.benchmark.case import AnswerQuantity, BenchmarkCase, CasePoint
from scenarios.benchmark.programs import Answers, CannotAnswerError, Program

#: Number of draws by default, and seed of all.
DRAWS, SEED = 100, 1
#: Largest number of points of a case for which a range is computed.
MOST_POINTS = 12
#: Percentiles of the range.
PERCENTILES = 5.0, 50.0, 95.0
#: Answers that differ by less, over their median, do not depend on what is drawn.
SAME = 1e-6


@dataclass(frozen=True)
class Band:
    """Range of one answer at one point, SI units.

    number: of the point, from 1. value: the answer at the inputs of the case, None without one. lower, median, upper:
    percentiles of the answers; None if less than half of the draws have one. draws, answered: number of draws, and of
    those with an answer.
    """

    case: BenchmarkCase
    answer: AnswerQuantity
    number: int
    published: float
    value: float | None
    lower: float | None
    median: float | None
    upper: float | None
    draws: int
    answered: int

    @property
    def holds(self) -> bool | None:
        """Return whether the published answer is in the range; None without a range."""
        return None if self.lower is None or self.upper is None else self.lower <= self.published <= self.upper


def bands(case: BenchmarkCase, program: Program, draws: int = DRAWS, seed: int = SEED) -> list[Band]:
    """Return the ranges of a case, at MOST_POINTS random points if it has more; none if it has no unknown input.

    Answers that do not depend on the unknown inputs are left out.
    """
    if not case.unknown:
        return []
    generator = np.random.default_rng(seed)
    drawn = {name: one.draw(generator, draws) for name, one in case.unknown.items()}
    count = len(case.points)
    numbers = sorted(generator.choice(count, min(count, MOST_POINTS), replace=False).tolist())
    found = []
    for number in numbers:
        point = case.points[number]
        own = _answers(case, program, point)
        others = [
            _answers(case, program, _with(point, {name: values[draw] for name, values in drawn.items()}))
            for draw in range(draws)
        ]
        found += [_band(case, number, name, own, others) for name in point.published if _varies(name, others)]
    return found


def _varies(name: str, others: list[Answers]) -> bool:
    values = [other[name] for other in others if name in other]
    return bool(values) and max(values) - min(values) > SAME * abs(float(np.median(values)))


def _with(point: CasePoint, values: Mapping[str, float]) -> CasePoint:
    return replace(point, inputs={**point.inputs, **values})


def _answers(case: BenchmarkCase, program: Program, point: CasePoint) -> Answers:
    """Return the answers of a program at a point; none if it fails there, as some draws have no stop."""
    try:
        return program.ask(replace(case, points=(point,)), 0)
    except CannotAnswerError:
        return {}


def _band(case: BenchmarkCase, number: int, name: str, own: Answers, others: list[Answers]) -> Band:
    values = [other[name] for other in others if name in other]
    enough = 2 * len(values) >= len(others)
    lower, median, upper = np.percentile(values, PERCENTILES).tolist() if enough else (None, None, None)
    published = case.points[number].published[name]
    answer, draws = case.answers[name], len(others)
    return Band(case, answer, number + 1, published, own.get(name), lower, median, upper, draws, len(values))
