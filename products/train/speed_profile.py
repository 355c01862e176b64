"""The speed profile of least energy between two stops, for a due time: by linear programs.

Its regimes are those of the maximum principle: full power, a held speed, coasting, partial and full braking (Howlett
and Pudney 1995; Khmelnitsky 2000; reviewed by Scheepmaker, Goverde and Kroon 2017; none was read). Nothing here assumes
them. Over place, with K = v^2 / 2, force and braking are linear in K, and the time of a cell, 2 h / (v_1 + v_2), is
convex: it is the highest of its tangents. Only resistance and largest forces over K are not linear; a few programs,
each linearised at the profile before, give them (the convex-concave procedure: Lipp and Boyd 2016). SciPy's HiGHS
solves each in tenths of a second, so that a driver can plan again on the way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.sparse import bmat, coo_matrix, csr_matrix, diags, hstack, identity, vstack

#: Programs after which a profile is final; least speed on the way [m/s], and ratio of the speeds of two tangents.
ROUNDS, SLOWEST, RATIO = 3, 0.5, 1.06
METHOD = "highs"
#: Cells are divided where the force changes by this share of the largest one, into a number of parts.
JUMP, PARTS = 0.04, 6
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Leg:
    """The way to a stop, and the train on it. Forces are per kg of its mass with rotating parts [m/s2].

    place: ends of the cells [m], shape (n + 1,). allowed: largest speed there [m/s].
    slope: gravity and curves on a cell, against the motion, shape (n,).
    resistance: a, b, c of a + b v + c v^2.
    speeds, motors, electric: largest forces of motors and electric brakes over speeds [m/s].
    deceleration: largest one [m/s2].
    recovery: share of the electric brake's energy that comes back [1].
    """

    place: Array
    allowed: Array
    slope: Array
    resistance: tuple[float, float, float]
    speeds: Array
    motors: Array
    electric: Array
    deceleration: float
    recovery: float = 0.0

    @property
    def cell(self) -> Array:
        """Lengths of the cells [m]."""
        return np.diff(self.place)

    def refined(self, force: Array) -> Leg:
        """Return the leg with cells divided where a profile's force changes: a switching place lies within."""
        jumps = np.abs(np.diff(force)) > JUMP * np.max(self.motors)
        parts = np.where(np.append(jumps, False) | np.append(False, jumps), PARTS, 1)
        share = np.concatenate([np.arange(count) / count for count in parts])
        cell = np.repeat(np.arange(len(parts)), parts)
        place = np.append(self.place[cell] + share * self.cell[cell], self.place[-1])
        inside = np.maximum(self.allowed[:-1], self.allowed[1:])[cell]
        allowed = np.append(np.where(share > 0.0, inside, self.allowed[cell]), self.allowed[-1])
        return replace(self, place=place, allowed=allowed, slope=self.slope[cell])

    def over(self, force: Array, speed: Array) -> tuple[Array, Array]:
        """Return a force at speeds, and its derivative to K = v^2 / 2, which is dF/dv / v."""
        step = 0.05
        up, down = (np.interp(speed + shift, self.speeds, force) for shift in (step, -step))
        return np.interp(speed, self.speeds, force), (up - down) / (2 * step) / np.maximum(speed, SLOWEST)

    def resisting(self, speed: Array) -> tuple[Array, Array]:
        """Return the running resistance at speeds, and its derivative to K."""
        a, b, c = self.resistance
        return a + b * speed + c * speed**2, (b + 2 * c * speed) / np.maximum(speed, SLOWEST)


@dataclass(frozen=True)
class SpeedProfile:
    """A profile: places [m], speeds there [m/s], times from its begin [s], and the tractive force of each cell [m/s2].

    energy: of motors less the recovered part [J/kg]. price: energy that a second more would save [J/(kg.s)].
    """

    place: Array
    speed: Array
    time: Array
    force: Array
    energy: float
    price: float = math.inf


@dataclass(frozen=True)
class Due:
    """A time of arrival [s], counted from the begin; a train may be late by a time [s] for a price [J/(kg.s)]."""

    time: float
    late: float = 0.0
    price: float = 0.0


def times_of(place: Array, speed: Array) -> Array:
    """Return the times at places [s], with a constant acceleration within each cell."""
    return np.concatenate([[0.0], np.cumsum(2 * np.diff(place) / np.maximum(speed[1:] + speed[:-1], 1e-6))])


def profile_of(leg: Leg, speed: Array, price: float = math.inf) -> SpeedProfile:
    """Return a profile with its forces and energy, from its speeds."""
    middle = np.sqrt((speed[1:] ** 2 + speed[:-1] ** 2) / 2)
    force = np.diff(speed**2) / 2 / leg.cell + leg.resisting(middle)[0] + leg.slope
    back = np.minimum(np.maximum(-force, 0.0), leg.over(leg.electric, middle)[0])
    energy = float(np.sum(leg.cell * (np.maximum(force, 0.0) - leg.recovery * back)))
    return SpeedProfile(leg.place, speed, times_of(leg.place, speed), force, energy, price)


def fastest(leg: Leg, begin: float) -> SpeedProfile:
    """Return the profile of least time from a speed [m/s]: full power, limits and full braking.

    Its speed is SLOWEST where the motors do not suffice.
    """
    square = leg.allowed**2
    for i in range(len(leg.cell) - 1, -1, -1):
        square[i] = min(square[i], square[i + 1] + 2 * leg.deceleration * leg.cell[i])
    square[0] = min(square[0], begin**2)
    for i, cell in enumerate(leg.cell):
        v = np.sqrt(square[i])
        for _ in range(3):
            gain = float(np.interp(v, leg.speeds, leg.motors) - leg.resisting(np.array(v))[0] - leg.slope[i])
            v = np.sqrt(max((square[i] + max(square[i] + 2 * gain * cell, SLOWEST**2)) / 2, 0.0))
        square[i + 1] = min(square[i + 1], max(square[i] + 2 * gain * cell, SLOWEST**2))
    return profile_of(leg, np.sqrt(square))


def _tangents(leg: Leg, speed: Array, begin: float) -> tuple[csr_matrix, Array]:
    """Return tangents of the time of each cell at speeds of its ends, (n + 1,): slopes to K (n, n + 1), constants.

    The first and the last speed are given: the time is not a function of them.
    """
    ends = np.concatenate([[begin], speed[1:-1], [0.0]])
    time = 2 * leg.cell / (ends[:-1] + ends[1:])
    with np.errstate(divide="ignore", invalid="ignore"):
        first, last = (-time / (ends[:-1] + ends[1:]) / end for end in (ends[:-1], ends[1:]))
    first[0], last[-1] = 0.0, 0.0
    constant = time - first * ends[:-1] ** 2 / 2 - last * ends[1:] ** 2 / 2
    return _two_bands(first, last), constant


def _two_bands(first: Array, last: Array) -> csr_matrix:
    """Return a matrix (n, n + 1) whose row i has first[i] and last[i] in columns i and i + 1."""
    n = len(first)
    return csr_matrix(diags([first, last], [0, 1], shape=(n, n + 1)))


def _forces(leg: Leg, before: SpeedProfile) -> list[tuple[csr_matrix, csr_matrix | None, Array]]:
    """Return rows of K and of the energy over length, and their upper limits, linearised at a profile."""
    n, h = len(leg.cell), leg.cell
    mean = (before.speed[1:] ** 2 + before.speed[:-1] ** 2) / 4
    half, change, less = _two_bands(np.full(n, 0.5), np.full(n, 0.5)), _two_bands(-1 / h, 1 / h), -identity(n)

    def line(values: tuple[Array, Array]) -> tuple[csr_matrix, Array]:
        return csr_matrix(diags(values[1]) @ half), values[0] - values[1] * mean

    middle = np.sqrt(2 * mean)
    resisting, resisted = line(leg.resisting(middle))
    motors, pulled = line(leg.over(leg.motors, middle))
    electric, braked = line(leg.over(leg.electric, middle))
    force, load, share = change + resisting, resisted + leg.slope, leg.recovery
    rows = [
        (force, less, -load),
        (force - motors, None, pulled - load),
        (-change, None, np.full(n, leg.deceleration)),
    ]
    recovered = [(share * force, less, -share * load), (-share * electric, less, share * braked)]
    return rows + recovered if share else rows


def _programme(
    leg: Leg, before: SpeedProfile, tangents: list[tuple[csr_matrix, Array]], due: Due
) -> tuple[Array, float] | None:
    """Return the K of least energy for a due time, and the price of time [J/(kg.s)]; None if it has no solution."""
    n, h = len(leg.cell), leg.cell
    rows = [(of_square, of_energy, None, limit) for of_square, of_energy, limit in _forces(leg, before)]
    rows += [(slopes, None, -identity(n), -constant) for slopes, constant in tangents]
    blocks = bmat([[*row[:3]] for row in rows])
    total = np.concatenate([np.zeros(2 * n + 1), np.ones(n)])
    late = coo_matrix(([-1.0], ([blocks.shape[0]], [0])), shape=(blocks.shape[0] + 1, 1))
    matrix = hstack([vstack([blocks, csr_matrix(total[None, :])]), late], format="csr")
    limits = np.concatenate([*(row[3] for row in rows), [due.time]])
    most, first = leg.allowed**2 / 2, before.speed[0] ** 2 / 2
    least = np.minimum(SLOWEST**2 / 2, most)
    least[0], least[-1], most[0], most[-1] = first, 0.0, first, 0.0
    low = np.concatenate([least, np.full(n, -np.inf if leg.recovery else 0.0), np.zeros(n + 1)])
    high = np.concatenate([most, np.full(2 * n, np.inf), [due.late]])
    cost = np.concatenate([np.zeros(n + 1), h, np.zeros(n), [due.price]])
    answer = linprog(cost, matrix, limits, bounds=np.column_stack([low, high]), method="highs-ipm")
    return (answer.x[: n + 1], -float(answer.ineqlin.marginals[-1])) if answer.success else None


def least_energy(leg: Leg, begin: float, due: Due) -> SpeedProfile:
    """Return the profile of least energy from a speed [m/s] that arrives in time, or that of least time."""
    best = fastest(leg, begin)
    if best.time[-1] >= due.time + due.late:
        return best
    best = _improved(leg, best, due, ROUNDS)
    fine = leg.refined(best.force)
    square = np.interp(fine.place, leg.place, best.speed**2)
    return _improved(fine, profile_of(fine, np.sqrt(square), best.price), due, ROUNDS - 1)


def _improved(leg: Leg, best: SpeedProfile, due: Due, rounds: int) -> SpeedProfile:
    """Return the profile after a number of programs, each linearised at the one before."""
    count = int(np.log(2 * leg.allowed.max() / SLOWEST) / np.log(RATIO))
    grid = SLOWEST * RATIO ** np.arange(count)
    tangents = [_tangents(leg, np.full(len(leg.place), speed), best.speed[0]) for speed in grid]
    for _ in range(rounds):
        tangents.append(_tangents(leg, best.speed, best.speed[0]))
        answer = _programme(leg, best, tangents, due)
        if answer is None:
            return best
        best = profile_of(leg, np.sqrt(2 * np.maximum(answer[0], 0.0)), answer[1])
    return best
