"""Kdry_rst: the share of the nominal emergency brake that a train reaches with a given confidence, SUBSET-026, 7.5.

Units of a train fail or brake, each with a spread of its own, and all of them share one spread, such as that of the
friction material. The number of units that brake in each group is binomial, and their force then is normal. So the
distribution is an exact sum of normal ones, down to any confidence.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr
from scipy.stats import binom

from products.supervision.arguments import all_of_type, check_sizes, finite, numbers
from products.supervision.convolution import largest_share
from readers.text import BadInputError, shown

#: Confidence levels (M_NVEBCL): the probability that the brake is weaker than stated, SUBSET-026, 7.5. Level 0 is a
#: median.
WEAKER = (0.5, *(10.0**-level for level in range(1, 10)))
#: Resolution of factors in train data [1], SUBSET-027; largest number of combinations of failures.
RESOLUTION, MOST_COMBINATIONS = 0.05, 5_000
#: Combinations less likely than this are left out: all of them together less than 1e-3 of the rarest level.
NEGLIGIBLE = 1e-18
#: Standard normal values of the common factor and their weights, by the trapezoidal rule.
NODES = np.linspace(-8.5, 8.5, 851)
DENSITY = np.exp(-(NODES**2) / 2.0) / np.exp(-(NODES**2) / 2.0).sum()
#: Deviations below this share of the common one are too sharp for the rule; both are then added as independent ones.
SHARP = 0.1
#: Share below which no brake force counts; halvings of a range of shares, the last one is 2e-12 wide.
LEAST, HALVINGS = 1e-6, 40


@dataclass(frozen=True)
class BrakeUnits:
    """Equal units of a train's brake that fail independently, such as vehicles with a distributor each.

    Parameters
    ----------
    count : int
        Number of units.
    force : float
        Nominal brake force of a unit, in any unit that all groups share.
    failure : float
        Probability that a unit does not brake when it is needed.
    spread : float
        Standard deviation of a unit's force over its nominal force, independent of other units.

    Raises
    ------
    BadInputError
        If a number is outside its limits.
    """

    count: int
    force: float
    failure: float = 0.0
    spread: float = 0.0

    def __post_init__(self) -> None:
        limits = {"count": (1, 10_000), "force": (1e-12, 1e12), "failure": (0.0, 0.5), "spread": (0.0, 0.5)}
        check_sizes("brake units", self, limits)


@dataclass(frozen=True)
class _Force:
    """The brake force over the nominal one: a common factor times a mixture of normal distributions."""

    weights: np.ndarray
    means: np.ndarray
    deviations: np.ndarray
    common: float

    def weaker_than(self, share: float) -> float:
        """Return the probability that the force is below a share of the nominal one."""
        none = self.means == 0.0
        found = np.where(none, float(share > 0.0), 0.0)
        joined = ~none & (self.deviations < SHARP * self.common * self.means)
        apart = ~none & ~joined
        if joined.any():
            deviations = np.hypot(self.deviations * np.hypot(1.0, self.common), self.common * self.means)[joined]
            found[joined] = ndtr((share - self.means[joined]) / deviations)
        if apart.any():
            found[apart] = self._over_common(share, self.means[apart], self.deviations[apart])
        return float(self.weights @ found)

    def _over_common(self, share: float, means: np.ndarray, deviations: np.ndarray) -> np.ndarray:
        """Return the probabilities for normal distributions, integrated over the common factor."""
        if not self.common:
            sharp = deviations == 0.0
            return np.where(sharp, means < share, ndtr((share - means) / np.where(sharp, 1.0, deviations)))
        factors = np.maximum(1.0 + self.common * NODES, 1e-6)
        return ndtr((share / factors - means[:, None]) / deviations[:, None]) @ DENSITY

    def share_at(self, weaker: float) -> float:
        """Return the largest share below which the force is at most with this probability."""
        if self.weaker_than(LEAST) > weaker:
            return 0.0
        return largest_share(self.weaker_than, weaker, HALVINGS)


def dry_factors(units: Sequence[BrakeUnits], common: float = 0.0) -> np.ndarray:
    """Return Kdry_rst for the confidence levels 0 to 9.

    Returns (10).

    The integral over the common factor is exact to 1e-10. Where the units' own spread is below a tenth of the common
    one, their product is taken as normal, which changes K by less than 1e-3 at spreads of 5 %.
    """
    units = all_of_type("units", units, BrakeUnits, "Give BrakeUnits(count=9, force=55.0).")
    if not units:
        raise BadInputError("A train must have brake units for its factors; got none.")
    common = finite("common", common)
    if not 0.0 <= common <= 0.5:
        raise BadInputError(f"The common spread must be 0 to 0.5; got {common:g}. Give 0.05 for 5 %.")
    found = _force_of(units, common)
    return np.array([found.share_at(weaker) for weaker in WEAKER])


def rounded_down(factors: ArrayLike) -> np.ndarray:
    """Return factors in the resolution of train data, on the safe side."""
    array = numbers("factors", factors)
    if not np.all(np.isnan(array) | ((array >= 0.0) & np.isfinite(array))):
        raise BadInputError(f"factors must be finite and at least 0; got {shown(array.tolist())}. Correct them.")
    return np.asarray(np.floor(array / RESOLUTION + 1e-9) * RESOLUTION)


def _force_of(units: Sequence[BrakeUnits], common: float) -> _Force:
    likely = []
    for one in units:
        braking = np.arange(one.count + 1)
        weights = binom.pmf(braking, one.count, 1.0 - one.failure)
        kept = weights > NEGLIGIBLE
        likely.append((braking[kept], weights[kept]))
    number = prod(braking.size for braking, _ in likely)
    if number > MOST_COMBINATIONS:
        raise BadInputError(
            f"Combinations of failures must be at most {MOST_COMBINATIONS}; got {number}. "
            "Join units with similar forces."
        )
    counts = np.array(list(product(*(braking for braking, _ in likely))), dtype=float)
    weights = np.array([prod(one) for one in product(*(weights for _, weights in likely))])
    forces = np.array([unit.force for unit in units])
    spreads = np.array([one.force * one.spread for one in units])
    nominal = float(sum(one.count * one.force for one in units))
    means, own = counts @ forces / nominal, counts @ spreads**2 / nominal**2
    return _Force(weights, means, np.sqrt(own), common)
