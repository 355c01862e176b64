"""Distributions of sums and products of independent positive numbers, by convolution on grids.

A product is a sum of logarithms: its parts are convolved on a grid of logarithms. Forces that vehicles miss are
convolved on a grid of shares. Rounding of the transforms is 1e-15 of a probability, a millionth of the rarest level.
Failures alone are summed without a grid, so that a force that is reached for certain stays exact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft

Numbers = NDArray[np.float64]
#: Grid of logarithms: number of points and distance between them; parts below e^-3 or above e^3 are moved there, so
#: that five parts do not reach its ends.
POINTS, LOGARITHM, FARTHEST = 2**17, 2.0**-12, 3.0
#: Grid of missing shares of a train's nominal force, from -2 to 2: number of points and distance between them.
#: Vehicles count with at most three times their nominal force.
SHARES, STEP, STRONGEST = 2**17, 2.0**-15, 3.0
#: Masses below this are rounding errors of the transforms.
NOISE = 1e-16
#: Bisections of a share from 0 to 2; the last one is 1e-7 wide. Smallest share that counts.
BISECTIONS, LEAST = 24, 1e-3
#: Relative error of probabilities on grids and of their sums; a level is reached within it.
ROUNDING = 1e-6
#: Largest number of sums of losses without a grid; sums less likely than NEGLIGIBLE are treated as no force at all.
MOST_SUMS, NEGLIGIBLE = 100_000, 1e-18


@dataclass(frozen=True)
class Law:
    """Values of a positive number and their probabilities, shape (values,)."""

    values: Numbers
    masses: Numbers


def product_of(over: Sequence[float], under: Sequence[float] = ()) -> Law:
    """Return the law of a product of independent normal factors of mean 1, divided by others."""
    parts = [(one, 1.0) for one in over if one] + [(one, -1.0) for one in under if one]
    if not parts:
        return Law(np.ones(1), np.ones(1))
    masses = reduce(np.multiply, (rfft(_logarithm(*part)) for part in parts))
    found = irfft(masses, POINTS)
    seen = found > NOISE
    place = np.fft.fftfreq(POINTS, 1.0 / POINTS)[seen]
    order = np.argsort(place)
    return Law(np.exp(LOGARITHM * place[order]), found[seen][order] / found[seen].sum())


def _logarithm(spread: float, sign: float) -> Numbers:
    """Return masses of sign log(1 + spread x) with x standard normal, in the order of the transform."""
    own = sign * LOGARITHM * np.fft.fftfreq(POINTS, 1.0 / POINTS)
    inside = np.clip(own, -FARTHEST, FARTHEST)
    density = np.exp(-0.5 * ((np.exp(inside) - 1.0) / spread) ** 2 + inside)
    density[np.abs(own) > FARTHEST] = 0.0
    found: Numbers = density / density.sum()
    return found


def add_losses(masses: Numbers, law: Law, share: float, braking: float, weight: float) -> None:
    """Add the masses of the share that a vehicle misses to the grid of missing shares.

    A vehicle with its nominal force misses nothing and is a point of the grid, so that many of them add no error.

    Takes masses (SHARES,).
    """
    place = share * (1.0 - braking * np.minimum(law.values, STRONGEST)) / STEP
    nearest = np.rint(place).astype(int)
    off, first = place - nearest, int(nearest.min()) - 1
    size = int(nearest.max()) - first + 2
    found = np.zeros(size)
    for move, part in ((-1, off * (off - 1.0) / 2.0), (0, 1.0 - off**2), (1, off * (off + 1.0) / 2.0)):
        found += np.bincount(nearest - first + move, law.masses * part, size)
    masses[np.arange(first, first + size) % SHARES] += weight * found


def sum_of(groups: Sequence[tuple[int, Numbers]]) -> Numbers:
    """Return the masses of the share that a train misses.

    Takes groups (SHARES,); returns (SHARES,).
    """
    total = reduce(np.multiply, (rfft(masses) ** count if count > 1 else rfft(masses) for count, masses in groups))
    return irfft(total, SHARES)


def failures_of(groups: Sequence[tuple[int, Law]]) -> Law | None:
    """Return the law of the share that a train misses by failures alone, without a grid."""
    total: Law | None = Law(np.zeros(1), np.ones(1))
    for count, one in groups:
        while count and total is not None:
            total = _both(total, one) if count % 2 else total
            count //= 2
            doubled = _both(one, one) if count else one
            if doubled is None:
                return None
            one = doubled
    return total


def _both(law: Law, other: Law) -> Law | None:
    """Return the law of a sum of two shares; None if it has too many values."""
    if law.values.size * other.values.size > MOST_SUMS:
        return None
    sums: Numbers = np.add.outer(law.values, other.values).ravel().round(12)
    values, places = np.unique(sums, return_inverse=True)
    masses: Numbers = np.bincount(places.ravel(), np.outer(law.masses, other.masses).ravel()).astype(np.float64)
    likely = masses > NEGLIGIBLE
    return Law(values[likely], masses[likely])


def quantiles_of_failures(losses: Law, weaker: Numbers) -> Numbers:
    """Return the shares of the nominal force that are not reached with given probabilities, by failures alone.

    Takes weaker (levels,); returns (levels,).
    """
    rest = max(1.0 - float(losses.masses.sum()), 0.0)
    reached = rest + np.cumsum(losses.masses[::-1])  # probability of this loss or a larger one
    number = np.searchsorted(reached, weaker * (1.0 + ROUNDING), side="right")
    shares = np.append(1.0 - losses.values[::-1], 1.0)[number]
    return np.where(shares > LEAST, shares, 0.0)


def quantiles_of(losses: Numbers, common: Law, weaker: Numbers) -> Numbers:
    """Return the shares of the nominal force that are not reached with given probabilities.

    Takes losses (SHARES,), weaker (levels,); returns (levels,).
    """
    rising = np.fft.fftshift(losses)[::-1]
    below = np.append(0.0, np.cumsum(rising))
    edges = 1.0 + (np.arange(SHARES + 1) + 0.5 - SHARES / 2) * STEP

    def probability(share: float) -> float:
        return float(common.masses @ np.interp(share / common.values, edges, below))

    shares = np.array([largest_share(probability, level, BISECTIONS) for level in weaker * (1.0 + ROUNDING)])
    return np.where(shares > LEAST, shares, 0.0)


def largest_share(probability: Callable[[float], float], most: float, halvings: int) -> float:
    """Return the largest share, from 0 to 2, whose probability is at most a level; it rises with the share."""
    low, high = 0.0, 2.0
    for _ in range(halvings):
        middle = (low + high) / 2.0
        low, high = (middle, high) if probability(middle) <= most else (low, middle)
    return low
