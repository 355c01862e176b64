"""Distributions of sums and products of independent positive numbers, by convolution on grids.

A product is a sum of logarithms: its parts are convolved on a grid of logarithms. What vehicles lack of their nominal
forces is convolved on a grid of shares. Rounding of the transforms is 1e-15 of a probability, a millionth of the rarest
level.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
#: Grid of logarithms: number of points and distance between them; parts below e^-3 or above e^3 are moved there, so
#: that five parts do not reach its ends.
POINTS, LOGARITHM, FARTHEST = 2**17, 2.0**-12, 3.0
#: Grid of what a train lacks of its nominal force, from -2 to 2: number of points and distance between them. Vehicles
#: count with at most three times their nominal force.
SHARES, STEP, STRONGEST = 2**17, 2.0**-15, 3.0
#: Masses below this are rounding errors of the transforms.
NOISE = 1e-16
#: Bisections of a share from 0 to 2; the last one is 1e-7 wide. Smallest share that counts.
BISECTIONS, LEAST = 24, 1e-3


@dataclass(frozen=True)
class Law:
    """Values of a positive number and their probabilities, shape (values,)."""

    values: Numbers
    masses: Numbers


def product_of(over: Sequence[float], under: Sequence[float] = ()) -> Law:
    """Return the law of a product of independent normal factors of mean 1, divided by others.

    Parameters
    ----------
    over, under : sequence of float
        Standard deviations of the factors and of the divisors; 0 leaves one out.

    Returns
    -------
    Law
        Values with a probability above rounding errors.
    """
    parts = [(one, 1.0) for one in over if one] + [(one, -1.0) for one in under if one]
    if not parts:
        return Law(np.ones(1), np.ones(1))
    masses = reduce(np.multiply, (np.fft.rfft(_logarithm(*one)) for one in parts))
    found = np.fft.irfft(masses, POINTS)
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


def losses_of(law: Law, share: float, braking: float = 1.0) -> Numbers:
    """Return the masses of the share that a vehicle lacks, on the grid of losses.

    A vehicle with its nominal force lacks nothing and is a point of the grid, so that many of them add no error.

    Parameters
    ----------
    law : Law
        Force of the vehicle over its nominal one; values beyond STRONGEST are moved there.
    share : float
        Nominal force of the vehicle over that of the train.
    braking : float
        Share of the vehicle that brakes.

    Returns
    -------
    ndarray
        Masses with the same mean and variance, in the order of the transform, shape (SHARES,). Those beside a single
        value may be below 0 by up to an eighth of it.
    """
    place = share * (1.0 - braking * np.minimum(law.values, STRONGEST)) / STEP
    nearest = np.rint(place).astype(int)
    off = place - nearest
    found = np.zeros(SHARES)
    for move, part in ((-1, off * (off - 1.0) / 2.0), (0, 1.0 - off**2), (1, off * (off + 1.0) / 2.0)):
        found += np.bincount((nearest + move) % SHARES, law.masses * part, SHARES)
    return found


def sum_of(groups: Sequence[tuple[int, Numbers]]) -> Numbers:
    """Return the masses of what a train lacks.

    Parameters
    ----------
    groups : sequence of (int, ndarray)
        Count of equal vehicles, and the masses of each, shape (SHARES,).

    Returns
    -------
    ndarray
        Masses, shape (SHARES,).
    """
    total = reduce(np.multiply, (np.fft.rfft(masses) ** count for count, masses in groups))
    return np.fft.irfft(total, SHARES)


def quantiles_of(losses: Numbers, common: Law, weaker: Numbers) -> Numbers:
    """Return the shares of the nominal force that are not reached with given probabilities.

    Parameters
    ----------
    losses : ndarray
        Masses of what the train lacks, shape (SHARES,). Each is spread evenly over its step.
    common : Law
        Factor on the rest.
    weaker : ndarray
        Probabilities, shape (levels,).

    Returns
    -------
    ndarray
        Shares, shape (levels,); 0 if no force is more likely than that.
    """
    rising = np.fft.fftshift(losses)[::-1]
    below = np.append(0.0, np.cumsum(rising))
    edges = 1.0 + (np.arange(SHARES + 1) + 0.5 - SHARES / 2) * STEP

    def probability(share: float) -> float:
        return float(common.masses @ np.interp(share / common.values, edges, below))

    found = []
    for one in weaker.tolist():
        low, high = 0.0, 2.0
        for _ in range(BISECTIONS):
            middle = (low + high) / 2.0
            low, high = (middle, high) if probability(middle) <= one else (low, middle)
        found.append(low if low > LEAST else 0.0)
    return np.array(found)
