"""Kdry_rst against closed forms and independent convolutions; the causes that decide it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr, ndtri
from scipy.stats import binom, norm

from products.supervision import convolution
from products.supervision.causes import BrakedVehicles, build_up_of, causes_of, factors_of, one_failure
from products.supervision.safety import WEAKER, BrakeUnits, dry_factors, rounded_down
from products.supervision.tolerances import ENTRIES, Tolerances

#: Required accuracy of K, and that of a point of its grid.
OF_K, OF_GRID = 1e-3, 1e-4
#: Standard normal nodes and weights; a step of 0.7 integrates normal densities to 1e-17.
NODES = np.arange(-8.4, 8.5, 0.7)
WEIGHTS = norm.pdf(NODES) / norm.pdf(NODES).sum()
TRAIN = [BrakedVehicles(6, 20.0, 30.0, discs=False), BrakedVehicles(2, 70.0, 90.0), BrakedVehicles(1, 0.0, 50.0)]
NOMINAL, TRAIN_MASS = 260.0, 410.0
EVERY = Tolerances(
    friction=0.05,
    friction_common=0.05,
    cylinder_force=0.04,
    wheel_diameter=0.03,
    mass=0.05,
    mass_common=0.02,
    isolated=2e-3,
    noticed=0.5,
    lost=1e-3,
    units=2,
)


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


@pytest.mark.parametrize("common", [0.0, 0.05])
def test_one_spread_and_one_failure_agree_with_the_closed_form(common: float) -> None:
    for one in (BrakeUnits(9, 55.0, 1e-3, 0.05), BrakeUnits(40, 1.0, 1e-3), BrakeUnits(16, 3.0, 0.0, 0.08)):
        given = Tolerances(lost=one.failure, spread=one.spread, common=common)
        found = factors_of([BrakedVehicles(one.count, one.force)], given)
        assert found == pytest.approx(dry_factors([one], common), abs=OF_GRID)


@pytest.mark.parametrize("given", [{}, {"isolated": 2e-3, "noticed": 1.0}, {"delay": 1e-3}])
def test_causes_that_do_not_weaken_the_brake_leave_exactly_one(given: dict[str, float]) -> None:
    assert factors_of(TRAIN, Tolerances(**given)).tolist() == [1.0] * 10


def test_failures_alone_have_the_binomial_quantile_and_symmetric_spreads_the_median_one() -> None:
    """10 vehicles: each failure takes 0.1, which rounding down must not make 0.15."""
    vehicles = [BrakedVehicles(6, 5.0), BrakedVehicles(4, 5.0, discs=False), BrakedVehicles(3, 0.0)]
    failed = [min(k for k in range(11) if binom.sf(k, 10, 2e-3) <= weaker) for weaker in WEAKER]
    found = factors_of(vehicles, Tolerances(isolated=2e-3))
    assert found == pytest.approx(1.0 - 0.1 * np.array(failed), abs=1e-12)
    assert rounded_down(found) == pytest.approx(found)
    halves = factors_of([BrakedVehicles(5, 1.0)], Tolerances(lost=2e-3, units=2))
    assert halves == pytest.approx(1.0 - 0.1 * np.array(failed), abs=1e-12)
    assert factors_of([BrakedVehicles(1, 5.0)], Tolerances(lost=1e-3))[2:4].tolist() == [1.0, 1.0]
    assert factors_of(TRAIN, Tolerances(friction_common=0.05))[0] == 1.0


def test_many_different_vehicles_lose_by_the_grid_what_they_lose_exactly(monkeypatch: pytest.MonkeyPatch) -> None:
    vehicles = [BrakedVehicles(2, 10.0 + 3.7 * n) for n in range(4)]
    exact = factors_of(vehicles, Tolerances(lost=3e-3))
    monkeypatch.setattr(convolution, "MOST_SUMS", 10)
    assert factors_of(vehicles, Tolerances(lost=3e-3)) == pytest.approx(exact, abs=OF_GRID)


def _of_nodes(*spreads: float) -> tuple[np.ndarray, np.ndarray]:
    """Return products of normal factors at nodes, with their weights."""
    values, weights = np.ones(1), np.ones(1)
    for spread in spreads:
        values = np.outer(values, 1.0 + spread * NODES).ravel()
        weights = np.outer(weights, WEIGHTS).ravel()
    return values[weights > 1e-16], weights[weights > 1e-16]


def _of_vehicle(edges: np.ndarray, one: BrakedVehicles) -> np.ndarray:
    """Return masses of a vehicle's force: friction in closed form, other factors by nodes, failures one by one."""
    others, weights = _of_nodes(EVERY.cylinder_force)
    if one.discs:
        under, more = _of_nodes(EVERY.wheel_diameter)
        others, weights = np.outer(others, 1.0 / under).ravel(), np.outer(weights, more).ravel()
    acts, lost = 1.0 - EVERY.isolated * (1.0 - EVERY.noticed), EVERY.lost
    found = np.zeros(edges.size - 1)
    for share, likely in ((1.0, (1.0 - lost) ** 2), (0.5, 2.0 * lost * (1.0 - lost))):
        z = (edges[:, None] / (share * one.force * others) - 1.0) / EVERY.friction
        found += acts * likely * np.diff(ndtr(z) @ weights)
    found[0] += 1.0 - acts * (1.0 - lost**2)
    return found


def test_tolerances_and_failures_together_are_a_convolution() -> None:
    """Forces are convolved vehicle by vehicle on a grid of newtons; common factors by nodes."""
    step = 0.05
    edges = (np.arange(2**14 + 1) - 0.5) * step
    total = np.ones(1)
    for one in TRAIN[:2]:
        masses = _of_vehicle(edges, one)
        for _ in range(one.count):
            total = np.fft.irfft(np.fft.rfft(total, 2**14) * np.fft.rfft(masses, 2**14), 2**14)
    below = np.append(0.0, np.cumsum(total))
    of_train = EVERY.mass * np.sqrt(6 * 30.0**2 + 2 * 90.0**2 + 50.0**2) / TRAIN_MASS
    friction, weights = _of_nodes(EVERY.friction_common)
    masses, more = _of_nodes(of_train, EVERY.mass_common)
    common, weights = np.outer(friction, 1.0 / masses).ravel(), np.outer(weights, more).ravel()

    def weaker(share: float) -> float:
        return float(weights @ np.interp(share * NOMINAL / common, edges, below))

    for level, found in enumerate(factors_of(TRAIN, EVERY)):
        assert weaker(found - OF_K) < WEAKER[level] < weaker(found + OF_K)


def test_failures_decide_short_trains_and_shared_friction_long_ones() -> None:
    short, long = causes_of(TRAIN, EVERY, 9), causes_of([BrakedVehicles(60, 20.0)], EVERY, 9)
    assert (short[0].name, long[0].name) == ("isolated", "friction_common")
    assert {one.name for one in short} == set(EVERY.causes)
    assert short[0].gain > 10.0 * short[1].gain
    alone = causes_of(TRAIN, Tolerances(friction_common=0.05), 4)
    assert alone[0].without == pytest.approx(1.0, abs=OF_GRID)
    assert alone[0].gain == pytest.approx(0.05 * -ndtri(1e-4), abs=OF_GRID)


def test_one_failure_costs_the_share_of_the_vehicle_if_nothing_else_varies() -> None:
    large, small = one_failure(TRAIN, Tolerances(), 9)
    assert (small.share, large.share) == pytest.approx((20.0 / NOMINAL, 70.0 / NOMINAL))
    assert (small.factor, large.factor) == pytest.approx((1.0 - small.share, 1.0 - large.share), abs=OF_GRID)
    assert one_failure([BrakedVehicles(1, 5.0)], EVERY)[0].factor == 0.0


def test_a_delay_lengthens_the_build_up_by_its_quantile() -> None:
    found = build_up_of([BrakedVehicles(9, 5.0)], Tolerances(delay=0.3, delay_common=0.1), 2.0)
    assert found == pytest.approx(2.0 - ndtri(np.array(WEAKER)) * np.hypot(0.1, 0.1))


def test_a_train_of_the_largest_size_has_factors_that_fall() -> None:
    """All causes at once, at their limits and small."""
    limits = {name: one.most for name, one in ENTRIES.items()} | {"units": 16}
    for given in (Tolerances(**limits), Tolerances(**{**dict.fromkeys(limits, 1e-6), "units": 16})):
        found = factors_of([BrakedVehicles(2_000, 1e-3, 1e12), BrakedVehicles(1, 1e12, 1.0)], given)
        assert np.all(np.diff(found) <= 0.0)
        assert np.all((found >= 0.0) & (found < 1.5))
