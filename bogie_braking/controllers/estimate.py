"""Means with their intervals from independent draws of a case, and differences of two controllers on the same draws.

The factors of a draw on friction and load have known means, so their linear effect is removed from its distance
(control variates: S. S. Lavenberg, P. D. Welch (1981), A perspective on the use of control variables to increase the
efficiency of Monte Carlo simulations, Management Science 27, 322-335). The remaining values are independent;
their interval is that of Student's t.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.stats import t

Numbers = NDArray[np.float64]
#: Probability of an interval [1].
LEVEL = 0.95
#: Fewest draws from which effects of known factors are removed: each costs a degree of freedom.
FEWEST = 8


@dataclass(frozen=True)
class Estimate:
    """A mean over draws, half the width of its interval (infinite with one draw), and the number of draws."""

    mean: float
    half: float
    count: int

    def over(self, other: float) -> Estimate:
        """Return the estimate divided by a number above 0."""
        return Estimate(self.mean / other, self.half / other, self.count)

    @property
    def differs(self) -> bool:
        """Return whether 0 is outside of the interval."""
        return abs(self.mean) > self.half


@dataclass(frozen=True, eq=False)
class Sample:
    """Independent draws of a quantity, without the effect of known factors.

    values: shape (draws,). fitted: number of effects that were removed. widened: factor on the variance of the mean,
    because the removed effects were fitted to the same draws [1].
    """

    values: Numbers
    fitted: int = 0
    widened: float = 1.0

    def over(self, other: float) -> Sample:
        """Return the sample divided by a number above 0."""
        return Sample(self.values / other, self.fitted, self.widened)

    def estimate(self, level: float = LEVEL) -> Estimate:
        """Return the mean with its interval of this probability."""
        count, mean = self.values.size, float(self.values.mean())
        free = count - 1 - self.fitted
        if free < 1:
            return Estimate(mean, math.inf, count)
        variance = float(np.sum((self.values - mean) ** 2)) / free
        return Estimate(mean, quantile(level, free) * math.sqrt(self.widened * variance / count), count)


@lru_cache(1000)
def quantile(level: float, free: int) -> float:
    """Return the two-sided quantile of Student's t with this number of degrees of freedom."""
    return float(t.ppf(0.5 + level / 2, free))


def sample_of(values: ArrayLike, factors: ArrayLike) -> Sample:
    """Return the draws of a quantity without the linear effect of their factors.

    Takes factors (draws, factors).
    """
    own = np.asarray(values, float)
    known = np.asarray(factors, float).reshape(own.size, -1)
    known = known[:, np.ptp(known, axis=0) > 0.0]
    fitted = known.shape[1]
    if own.size < FEWEST or not fitted:
        return Sample(own)
    middle = known.mean(axis=0)
    effects = np.linalg.lstsq(known - middle, own - own.mean(), rcond=None)[0]
    away = np.linalg.lstsq((known - middle).T @ (known - middle), middle, rcond=None)[0]
    return Sample(own - known @ effects, fitted, 1.0 + own.size * float(middle @ away))


def across(samples: Sequence[Sample], of: Callable[[Numbers], Numbers]) -> Sample:
    """Return a function of all cases, such as the median, in each draw.

    Takes of (cases, draws).
    """
    values = of(np.stack([sample.values for sample in samples]))
    return Sample(values, max(one.fitted for one in samples), max(one.widened for one in samples))


def less(sample: Sample, other: Sample) -> Sample:
    """Return the difference of two samples draw by draw."""
    return Sample(sample.values - other.values, max(sample.fitted, other.fitted), max(sample.widened, other.widened))
