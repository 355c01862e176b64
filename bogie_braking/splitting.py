"""Probabilities of rare events by multilevel splitting: twenty small populations that climb side by side.

A population is a sample of standard normal points. At each level the half with the lowest outputs dies, copies of
points that live take the places, and Markov moves that stay above the level part copies from their parents: the subset
simulation of Au and Beck (2001), doi:10.1016/S0266-8920(01)00019-4. All that stand at or below a level die, ties among
them, and as many as die are counted. That makes the product of the shares that live an unbiased estimate, whatever the
chains are like: Brehier, Gazeau, Goudenege, Lelievre and Rousset (2016), doi:10.1214/16-AAP1185.

Populations share nothing, so that the scatter of their estimates tells how sure their mean is, with all that chains
which are too short and particles which are too few do to it.
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
#: Outputs, shape (points,), of standard normal points, shape (points, inputs); -inf where there is none.
Evaluate = Callable[[Numbers], Numbers]
#: How many populations climb: twenty know their own scatter to a sixth.
POPULATIONS = 20
#: The climb ends at this probability: behind it, 7 standard deviations out, nobody knows the distribution of an input.
LEAST = 1e-12
#: Share of moves that are to be accepted: Papaioannou, Betz, Zwirglmaier and Straub (2015),
#: doi:10.1016/j.probengmech.2015.06.006.
ACCEPTED = 0.44
#: Size of the first moves, and the smallest: the length that a move draws anew of a point of length 1.
FIRST_STEP, LEAST_STEP = 0.8, 1e-3
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Generation:
    """What a population is made of between two levels: outputs, shape (particles,), all above a level.

    probability: that of standing above the level, as the population tells it.
    """

    probability: float
    level: float
    outputs: Numbers


@dataclass
class Population:
    """Points that climb together, shape (particles, inputs), and their outputs, shape (particles,).

    probability: that of standing above the level, as the population tells it; at the end of the climb, that of standing
    above the limit. step: size of its moves. accepted: share of the moves that were, at each level.
    """

    random: np.random.Generator
    points: Numbers
    outputs: Numbers
    level: float = -np.inf
    probability: float = 1.0
    climbs: bool = True
    step: float = FIRST_STEP
    accepted: list[float] = field(default_factory=list)
    generations: list[Generation] = field(default_factory=list)

    def split(self, limit: float) -> NDArray[np.intp]:
        """Goes up to the next level and gives the rows whose points are copies now.

        There are none where the climb is over: at the limit, where nobody lives, at the least probability.
        """
        self.generations.append(Generation(self.probability, self.level, self.outputs.copy()))
        level = float(np.sort(self.outputs)[self.outputs.size // 2 - 1])
        dead = self.outputs <= level
        lives = 1.0 - np.count_nonzero(dead) / dead.size
        if level >= limit or lives == 0.0 or self.probability * lives < LEAST:
            self.climbs = False
            self.probability *= float(np.mean(self.outputs > limit))
            return np.zeros(0, np.intp)
        self.level, self.probability = level, self.probability * lives
        parents = self.random.choice(np.flatnonzero(~dead), int(dead.sum()))
        self.points[dead], self.outputs[dead] = self.points[parents], self.outputs[parents]
        return np.flatnonzero(dead)

    def proposed(self, rows: NDArray[np.intp]) -> Numbers:
        """Where points of these rows might go: preconditioned Crank-Nicolson keeps the normal distribution as it is.

        Cotter, Roberts, Stuart and White (2013), doi:10.1214/13-STS421.
        """
        fresh = self.random.standard_normal((rows.size, self.points.shape[1]))
        return np.sqrt(1.0 - self.step**2) * self.points[rows] + self.step * fresh

    def move(self, rows: NDArray[np.intp], points: Numbers, outputs: Numbers) -> float:
        """Goes to the points whose outputs stay above the level; the share that went."""
        above = outputs > self.level
        there = rows[above]
        self.points[there], self.outputs[there] = points[above], outputs[above]
        return there.size / rows.size

    def adapt(self, accepted: float) -> None:
        """The size of the next level's moves, from this one's: within a level, moves that follow moves have a bias."""
        self.accepted.append(accepted)
        self.step = float(np.clip(self.step * np.exp(accepted - ACCEPTED), LEAST_STEP, 1.0))

    def above(self, limit: float) -> float:
        """The probability of standing above a limit, as the population tells it on its way."""
        last = next(one for one in reversed(self.generations) if one.level <= limit)
        return last.probability * float(np.mean(last.outputs > limit))

    def variance_if_independent(self) -> float:
        """Relative variance of the estimate were all points of all levels independent, after Au and Beck (2001)."""
        told = [one.probability for one in self.generations] + [self.probability]
        shares = [after / before for before, after in pairwise(told) if after > 0.0]
        return sum((1.0 - share) / (share * self.outputs.size) for share in shares)


def climb(
    evaluate: Evaluate, inputs: int, limit: float, particles: int, moves: int, seed: int
) -> tuple[list[Population], int]:
    """Populations of so many particles that have climbed to the limit, and how many points were evaluated.

    moves: of each copy at each level. A seed decides all that is random.
    """
    streams = [np.random.default_rng(one) for one in np.random.SeedSequence(seed).spawn(POPULATIONS)]
    points = [stream.standard_normal((particles, inputs)) for stream in streams]
    outputs = np.split(evaluate(np.concatenate(points)), POPULATIONS)
    everyone = [Population(*one) for one in zip(streams, points, outputs, strict=True)]
    count = particles * POPULATIONS
    with counting(text="levels", unit="level") as bar:
        while copies := [(one, rows) for one in everyone if one.climbs and (rows := one.split(limit)).size]:
            count += moves * sum(rows.size for _, rows in copies)
            move_together(evaluate, copies, moves)
            bar.set_postfix_str(f"probability {np.mean([one.probability for one in everyone]):.1g}", refresh=False)
            bar.update()
    return everyone, count


def move_together(evaluate: Evaluate, copies: Sequence[tuple[Population, NDArray[np.intp]]], moves: int) -> None:
    """Moves of all copies of all populations, evaluated together."""
    ends = np.cumsum([rows.size for _, rows in copies])[:-1]
    accepted = np.zeros((moves, len(copies)))
    for number in range(moves):
        points = [one.proposed(rows) for one, rows in copies]
        outputs = np.split(evaluate(np.concatenate(points)), ends)
        accepted[number] = [one.move(rows, *to) for (one, rows), *to in zip(copies, points, outputs, strict=True)]
    for (one, _), share in zip(copies, accepted.mean(axis=0).tolist(), strict=True):
        one.adapt(share)


def interval_of(estimates: Numbers) -> tuple[float, float, float]:
    """Mean of independent estimates of a probability, and its 95 % confidence interval.

    Student's, of the logarithm of the mean to first order, for estimates are skewed; from 0 to 1 where all are 0.
    """
    mean = float(np.mean(estimates))
    if mean == 0.0:
        return 0.0, 0.0, 1.0
    error = float(np.std(estimates, ddof=1)) / np.sqrt(estimates.size) / mean
    factor = float(np.exp(student.ppf(0.5 + CONFIDENCE / 2, estimates.size - 1) * error))
    return mean, mean / factor, min(1.0, mean * factor)


def confidence_of(populations: Sequence[Population], limit: float) -> tuple[float, float, float]:
    """The probability of standing above the limit, and its 95 % confidence interval.

    Where no population was split, that of independent points: Clopper and Pearson's. Where none came above the limit,
    from 0 to what is surely above the probability of the last levels, for the limit is above these.
    """
    told = interval_of(np.array([one.probability for one in populations]))
    if all(len(one.generations) == 1 for one in populations):
        above = np.concatenate([one.outputs for one in populations]) > limit
        exact = binomtest(int(np.sum(above)), above.size).proportion_ci(CONFIDENCE)
        return told[0], float(exact.low), float(exact.high)
    if told[0] == 0.0:
        return 0.0, 0.0, interval_of(np.array([one.generations[-1].probability for one in populations]))[2]
    return told
