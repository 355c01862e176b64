"""Scores: errors of each program over the published answers, and the processor time that they took."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from scenarios.benchmark import elsewhere
from scenarios.benchmark.case import AnswerQuantity, BenchmarkCase
from scenarios.benchmark.programs import Answers, CannotAnswerError, Program


@dataclass(frozen=True)
class Score:
    """Answers of a program to one question of a case.

    values: one for each point in SI units, None where the program gave none. published: likewise, None without a
    published value. cost: processor time of a point [s], None if the program answered nothing.
    """

    case: BenchmarkCase
    answer: AnswerQuantity
    program: str
    values: tuple[float | None, ...]
    published: tuple[float | None, ...]
    cost: float | None

    @property
    def errors(self) -> list[float]:
        """Return the errors over the published values, relative or in SI units, of points that have both."""
        pairs = zip(self.values, self.published, strict=True)
        both = [(value, told) for value, told in pairs if value is not None and told is not None]
        return [(value - told) / told if self.answer.relative else value - told for value, told in both]

    @property
    def worst(self) -> float | None:
        """Return the error of largest size, with its sign; None without an answer."""
        return max(self.errors, key=abs) if self.errors else None

    @property
    def rms(self) -> float | None:
        """Return the root mean square of the errors; None without an answer."""
        return float(np.sqrt(np.mean(np.square(self.errors)))) if self.errors else None

    @property
    def points(self) -> int:
        """Return the number of points with a published answer."""
        return sum(one is not None for one in self.published)

    @property
    def holds(self) -> bool | None:
        """Return whether all points are answered within the bound; None if it is not judged, or not answered."""
        if not self.answer.judged or self.answer.bound is None or self.worst is None:
            return None
        return len(self.errors) == self.points and abs(self.worst) <= self.answer.bound


@dataclass(frozen=True)
class Scored:
    """Scores of one case: a row for each answer and program, and why a program failed."""

    case: BenchmarkCase
    scores: tuple[Score, ...]
    failures: dict[str, str]


def score(case: BenchmarkCase, programs: Sequence[Program]) -> Scored:
    """Return the scores of all programs on a case."""
    scores: list[Score] = []
    failures: dict[str, str] = {}
    asked: dict[str, tuple[list[Answers], float | None]] = {}
    for program in programs:
        answers, cost, failure = _asked(program, case)
        asked[program.name] = answers, cost
        if failure:
            failures[program.name] = failure
    for name, answer in case.answers.items():
        told = tuple(point.published.get(name) for point in case.points)
        for own, (answers, cost) in asked.items():
            values = tuple(one.get(name) for one in answers)
            given = any(value is not None for value in values)
            scores.append(Score(case, answer, own, values, told, cost if given else None))
    return Scored(case, tuple(scores), failures)


def _asked(program: Program, case: BenchmarkCase) -> tuple[list[Answers], float | None, str]:
    """Return the answers for each point, the processor time of one [s], and why points have none.

    The first point is computed twice: what is compiled or imported then does not count.
    """
    found: list[Answers] = []
    failure = ""
    begin = 0.0
    for point in (0, *range(len(case.points))):
        if len(found) == 1:
            begin = processor_time()
        try:
            answers = program.ask(case, point)
        except CannotAnswerError as error:
            answers, failure = {}, failure or f"point {point + 1}: {error}"
        found.append(answers)
    cost = (processor_time() - begin) / len(case.points)
    return found[1:], cost if any(found) and program.computes else None, failure


def processor_time() -> float:
    """Return the processor time of this process, of processes that it has ended, and of answers elsewhere [s]."""
    ended = os.times()
    return time.process_time() + ended.children_user + ended.children_system + elsewhere.seconds()


def rows_of(scored: Sequence[Scored]) -> Iterator[dict[str, object]]:
    """Yield one row for each point, answer and program, for files: values and errors in the unit of the answer."""
    for one in scored:
        for each in one.scores:
            scale = each.answer.scale
            for number, (value, told) in enumerate(zip(each.values, each.published, strict=True), 1):
                if told is None and value is None:
                    continue
                yield {
                    "case": one.case.name,
                    "point": number,
                    "answer": each.answer.name,
                    "unit": each.answer.unit,
                    "program": each.program,
                    "published": None if told is None else told / scale,
                    "value": None if value is None else value / scale,
                }
