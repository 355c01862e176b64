"""Probabilities of rare events by multilevel splitting with twenty small, independent populations.

A population is a sample of standard normal points. At each level the points with the lowest outputs, half of them, are
removed. Copies of the other points replace them, and Markov moves that stay above the level separate copies from their
parents: the subset simulation of Au and Beck (2001), doi:10.1016/S0266-8920(01)00019-4. All points at or below a level
are removed, ties included, and counted. The product of the remaining shares is therefore an unbiased estimate for any
chains: Brehier, Gazeau, Goudenege, Lelievre and Rousset (2016), doi:10.1214/16-AAP1185.

Populations are independent. The scatter of their estimates is therefore a measure of the error of their mean. It
includes the effects of chains that are too short and of too few particles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest
from scipy.stats import t as student

from fmu_src.progress import counting

Numbers = NDArray[np.float64]
#: Outputs, shape (points,), of standard normal points, shape (points, inputs); -inf if a point has none.
Evaluate = Callable[[Numbers], Numbers]
#: Number of populations: twenty determine their own scatter within a sixth.
POPULATIONS = 20
#: The climb ends at this probability, 7 standard deviations out: the distribution of an input is unknown there.
LEAST = 1e-12
#: Target share of accepted moves: Papaioannou, Betz, Zwirglmaier and Straub (2015),
#: doi:10.1016/j.probengmech.2015.06.006.
ACCEPTED = 0.44
#: Size of the first moves, and the smallest: the random part that a move gives to a point of length 1.
FIRST_STEP, LEAST_STEP = 0.8, 1e-3
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Generation:
    """A population between two levels: outputs, shape (particles,), all above a level.

    probability: estimate of the population for exceeding the level.
    """

    probability: float
    level: float
    outputs: Numbers


@dataclass
class Population:
    """Points that climb together, shape (particles, inputs), and their outputs, shape (particles,).

    probability: estimate for exceeding the level; at the end of the climb, for exceeding the limit. step: size of its
    moves. least: probability at which the climb ends. accepted: share of accepted moves at each level.
    """

    random: np.random.Generator
    points: Numbers
    outputs: Numbers
    level: float = -np.inf
    probability: float = 1.0
    climbs: bool = True
    step: float = FIRST_STEP
    least: float = LEAST
    accepted: list[float] = field(default_factory=list)
    generations: list[Generation] = field(default_factory=list)

    def split(self, limit: float) -> NDArray[np.intp]:
        """Go up to the next level and return the rows whose points are copies now.

        No rows are returned at the end of the climb: at the limit, if no point remains, or at the least probability.
        """
        self.generations.append(Generation(self.probability, self.level, self.outputs.copy()))
        level = float(np.sort(self.outputs)[self.outputs.size // 2 - 1])
        dead = self.outputs <= level
        lives = 1.0 - np.count_nonzero(dead) / dead.size
        if level >= limit or lives == 0.0 or self.probability * lives < self.least:
            self.climbs = False
            self.probability *= float(np.mean(self.outputs > limit))
            return np.zeros(0, np.intp)
        self.level, self.probability = level, self.probability * lives
        parents = self.random.choice(np.flatnonzero(~dead), int(dead.sum()))
        self.points[dead], self.outputs[dead] = self.points[parents], self.outputs[parents]
        return np.flatnonzero(dead)

    def proposed(self, rows: NDArray[np.intp]) -> Numbers:
        """Return proposed points for these rows: preconditioned Crank-Nicolson keeps the normal distribution unchanged.

        Cotter, Roberts, Stuart and White (2013), doi:10.1214/13-STS421.
        """
        fresh = self.random.standard_normal((rows.size, self.points.shape[1]))
        return np.sqrt(1.0 - self.step**2) * self.points[rows] + self.step * fresh

    def move(self, rows: NDArray[np.intp], points: Numbers, outputs: Numbers) -> float:
        """Move to the points whose outputs stay above the level; return their share."""
        above = outputs > self.level
        there = rows[above]
        self.points[there], self.outputs[there] = points[above], outputs[above]
        return there.size / rows.size

    def adapt(self, accepted: float) -> None:
        """Set the move size of the next level from this one: adaptation within a level would bias the chain."""
        self.accepted.append(accepted)
        self.step = float(np.clip(self.step * np.exp(accepted - ACCEPTED), LEAST_STEP, 1.0))

    def above(self, limit: float) -> float:
        """Return the probability of exceeding a limit, estimated from the levels on the way."""
        last = next(generation for generation in reversed(self.generations) if generation.level <= limit)
        return last.probability * float(np.mean(last.outputs > limit))

    def variance_if_independent(self) -> float:
        """Return the relative variance of the estimate for independent points (Au and Beck, 2001)."""
        told = [generation.probability for generation in self.generations] + [self.probability]
        shares = [after / before for before, after in pairwise(told) if after > 0.0]
        return sum((1.0 - share) / (share * self.outputs.size) for share in shares)


def climb(
    evaluate: Evaluate, inputs: int, limit: float, particles: int, moves: int, seed: int, least: float = LEAST
) -> tuple[list[Population], int]:
    """Return populations that have climbed to the limit, and the number of evaluated points.

    particles: of each population. moves: of each copy at each level. least: probability at which the climb ends. The
    seed determines all random numbers.
    """
    streams = [np.random.default_rng(one) for one in np.random.SeedSequence(seed).spawn(POPULATIONS)]
    points = [stream.standard_normal((particles, inputs)) for stream in streams]
    outputs = np.split(evaluate(np.concatenate(points)), POPULATIONS)
    everyone = [Population(*one, least=least) for one in zip(streams, points, outputs, strict=True)]
    count = particles * POPULATIONS
    with counting(text="levels", unit="level") as bar:
        while copies := [(one, rows) for one in everyone if one.climbs and (rows := one.split(limit)).size]:
            count += moves * sum(rows.size for _, rows in copies)
            move_together(evaluate, copies, moves)
            bar.set_postfix_str(f"probability {np.mean([one.probability for one in everyone]):.1g}", refresh=False)
            bar.update()
    return everyone, count


def move_together(evaluate: Evaluate, copies: Sequence[tuple[Population, NDArray[np.intp]]], moves: int) -> None:
    """Move all copies of all populations, evaluated together."""
    ends = np.cumsum([rows.size for _, rows in copies])[:-1]
    accepted = np.zeros((moves, len(copies)))
    for number in range(moves):
        points = [one.proposed(rows) for one, rows in copies]
        outputs = np.split(evaluate(np.concatenate(points)), ends)
        accepted[number] = [one.move(rows, *to) for (one, rows), *to in zip(copies, points, outputs, strict=True)]
    for (one, _), share in zip(copies, accepted.mean(axis=0).tolist(), strict=True):
        one.adapt(share)


def interval_of(estimates: Numbers) -> tuple[float, float, float]:
    """Return the mean of independent estimates of a probability, and its 95 % confidence interval.

    The interval is Student's for the logarithm of the mean to first order, as estimates are skewed; from 0 to 1 if all
    are 0.
    """
    mean = float(np.mean(estimates))
    if mean == 0.0:
        return 0.0, 0.0, 1.0
    error = float(np.std(estimates, ddof=1)) / np.sqrt(estimates.size) / mean
    factor = float(np.exp(student.ppf(0.5 + CONFIDENCE / 2, estimates.size - 1) * error))
    return mean, mean / factor, min(1.0, mean * factor)


def confidence_of(populations: Sequence[Population], limit: float) -> tuple[float, float, float]:
    """Return the probability of exceeding the limit, and its 95 % confidence interval.

    If no population was split, the points are independent: Clopper and Pearson's interval. If no point is above the
    limit, the interval ends at the upper bound for the last levels, as the limit is above these.
    """
    told = interval_of(np.array([one.probability for one in populations]))
    if all(len(population.generations) == 1 for population in populations):
        above = np.concatenate([one.outputs for one in populations]) > limit
        exact = binomtest(int(np.sum(above)), above.size).proportion_ci(CONFIDENCE)
        return told[0], float(exact.low), float(exact.high)
    if told[0] == 0.0:
        return 0.0, 0.0, interval_of(np.array([one.generations[-1].probability for one in populations]))[2]
    return told
