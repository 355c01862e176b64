"""Kdry_rst against quantiles of the binomial and normal distributions, and a convolution on a grid."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binom, norm

from products.supervision.safety import WEAKER, BrakeUnits, dry_factors, rounded_down


@pytest.mark.parametrize(("count", "failure"), [(8, 1e-2), (40, 1e-3), (3, 0.1)])
def test_units_that_fail_alone_have_the_binomial_quantile(count: int, failure: float) -> None:
    """The most units that brake with at least the confidence of the level."""
    found = dry_factors([BrakeUnits(count, 12.5, failure)])
    braking = [max(k for k in range(count + 1) if binom.cdf(k - 1, count, 1 - failure) <= weaker) for weaker in WEAKER]
    assert found == pytest.approx(np.array(braking) / count, abs=1e-9)


def test_spreads_alone_have_the_normal_quantile() -> None:
    """1 + z sigma, with sigma over the root of the number for the units' own and not for the common one."""
    z = norm.ppf(WEAKER)
    assert dry_factors([BrakeUnits(16, 3.0, spread=0.08)]) == pytest.approx(1.0 + z * 0.08 / 4.0, abs=1e-9)
    assert dry_factors([BrakeUnits(16, 3.0)], common=0.03) == pytest.approx(1.0 + z * 0.03, abs=1e-9)


def test_failures_and_spreads_together_are_a_convolution() -> None:
    """Two kinds of vehicles; densities are convolved unit by unit on a grid, and then over a common factor."""
    groups = [BrakeUnits(6, 20.0, 2e-3, 0.06), BrakeUnits(2, 70.0, 1e-3, 0.04)]
    common, nominal, step = 0.05, 260.0, 0.02
    grid = np.arange(0.0, 400.0, step)
    edges = np.append(grid, grid[-1] + step) - step / 2.0
    density = np.zeros(grid.size)
    density[0] = 1.0
    for one in groups:
        unit = (1.0 - one.failure) * np.diff(norm.cdf(edges, one.force, one.force * one.spread))
        unit[0] += one.failure
        for _ in range(one.count):
            density = np.maximum(np.fft.irfft(np.fft.rfft(density, 65536) * np.fft.rfft(unit, 65536), 65536), 0.0)
            density = density[: grid.size]
    factors = np.linspace(1.0 - 8.0 * common, 1.0 + 8.0 * common, 2001)
    weights = norm.pdf(factors, 1.0, common)
    cumulated = np.append(0.0, np.cumsum(density))

    def weaker(share: float) -> float:
        return float(weights @ np.interp(share * nominal / factors, edges, cumulated) / weights.sum())

    for level, found in enumerate(dry_factors(groups, common)):
        assert weaker(found - 1e-3) < WEAKER[level] < weaker(found + 1e-3)


def test_factors_fall_with_confidence_and_are_rounded_to_the_safe_side() -> None:
    found = dry_factors([BrakeUnits(10, 1.0, 5e-3, 0.05)], 0.02)
    assert np.all(np.diff(found) < 0.0)
    assert np.all(rounded_down(found) <= found)
    assert rounded_down([0.85, 0.8999]) == pytest.approx([0.85, 0.85])
