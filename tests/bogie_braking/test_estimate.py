"""Intervals of mean distances and of differences between controllers, from synthetic and from simulated draws."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bogie_braking.controllers.estimate import Sample, less, sample_of
from bogie_braking.controllers.scoring import LOOKS, DrawsPlan
from bogie_braking.controllers.verdict import differs, level_of
from products.machine import bogie
from products.protection.programme import Case
from products.protection.rig import Rig
from products.protection.rig_in_c import slide_protection
from products.protection.settings import Settings
from products.protection.spread import Spread, draws_of

SEEDS, BOUNDS = 200, (180, 198)
#: Mean of many stops from 30 km/h on the low rail with the built-in protection and the assumed spread, in steps of 5 ms
#: [m]. Their standard deviation is 1.03 m, that of the mean 0.004 m.
MEASURED = 65.14
#: Standard deviation of these distances without the effect of friction and load, relative [1].
SCATTER = 0.01


def drawn(seed: int, count: int, factor: float = 1.0, own: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return distances [m] and factors: friction acts nonlinearly, the sensors skew, and half of it is common."""
    random, alone = np.random.default_rng([seed, 7]), np.random.default_rng([seed, own])
    factors = random.uniform(-1.0, 1.0, (count, 2)) * (0.03, 0.02)
    scatter = (random.exponential(size=count) + alone.exponential(size=count) - 2.0) * SCATTER / np.sqrt(2.0)
    return factor * 73.7 * (1.0 + factors[:, 0]) ** -0.9 * (1.0 + 0.1 * factors[:, 1]) * (1.0 + scatter), factors


@pytest.mark.parametrize("count", [4, 8, 16, 64])
def test_intervals_hold_the_mean_of_many_stops(count: int) -> None:
    """95 % intervals hold the mean of a skewed distribution in 180 to 198 of 200 seeds."""
    mean = drawn(10**6, 10**6)[0].mean()
    found = [sample_of(*drawn(seed, count)).estimate() for seed in range(SEEDS)]
    assert BOUNDS[0] <= sum(abs(one.mean - mean) <= one.half for one in found) <= BOUNDS[1]


def test_an_effect_of_a_factor_that_is_left_in_widens_the_interval() -> None:
    values, factors = drawn(1, 64)
    assert Sample(values).estimate().half > 1.5 * sample_of(values, factors).estimate().half


def apart(seed: int, factor: float, counts: tuple[int, ...] = (8, 16, 32, 64)) -> bool:
    """Return whether two controllers are told apart at any look; factor: of the second one's distances."""
    for count in counts:
        first, second = (sample_of(*drawn(seed, count, by, own)).over(73.7) for by, own in ((1.0, 1), (factor, 2)))
        if differs(first, second, level_of(2)):
            return True
    return False


def test_two_controllers_are_told_apart_if_and_only_if_they_differ() -> None:
    """A difference of 1 % is found; equal controllers with scatter of their own are told apart in at most 5 %."""
    assert sum(apart(seed, 1.01) for seed in range(SEEDS)) >= 0.95 * SEEDS
    assert sum(apart(seed, 1.0) for seed in range(SEEDS)) <= 0.05 * SEEDS


def test_the_best_of_many_equal_controllers_is_told_apart_in_at_most_5_percent() -> None:
    """The draws decide which of twelve controllers seems best, so all pairs count."""
    told = 0
    for seed in range(SEEDS):
        ratios = 1.0 + 0.03 * np.random.default_rng(seed).standard_normal((12, LOOKS[-1]))
        for count in LOOKS:
            least, *others = sorted((Sample(own[:count]) for own in ratios), key=lambda one: float(one.values.mean()))
            if any(differs(one, least, level_of(12)) for one in others):
                told += 1
                break
    assert told <= 0.05 * SEEDS


def test_a_comparison_may_end_at_most_as_often_as_its_intervals_allow() -> None:
    looks = {most: DrawsPlan(most=most).looks for most in (1, 8, 16, 64, 65, 1000, 10_000)}
    assert [looks[most] for most in (1, 8, 16, 64, 1000)] == [(1,), (8,), (8, 16), LOOKS, (8, 40, 200, 1000)]
    assert all(len(one) <= len(LOOKS) and one[-1] == most for most, one in looks.items())


def test_draws_are_the_same_for_all_controllers_and_in_longer_ranges() -> None:
    few, many = (draws_of("low", range(count), 2, Spread(), 1) for count in (2, 5))
    assert many[:2] == few
    assert draws_of("wet", range(2), 2, Spread(), 1) != few != draws_of("low", range(2), 2, Spread(), 2)


def test_an_interval_of_the_rig_holds_the_mean_of_many_stops() -> None:
    """One seed; docs/controller.md has 200."""
    machine, case, spread = bogie(), Case("low, 30 km/h", "low", speed=8.333), Spread()
    draws = draws_of(case.name, range(8), 2, spread, 0)
    rig = Rig(machine, slide_protection(), replace(Settings(), jitter=spread.jitter), by_flow=True, step=5e-3)
    stops = rig.runs([draw.applied(case.run(machine), machine) for draw in draws])
    sample = sample_of([one.distance for one in stops], [(one.friction - 1.0, one.load - 1.0) for one in draws])
    found = sample.estimate()
    assert found.mean - found.half < MEASURED < found.mean + found.half
    assert len({one.distance for one in stops}) == 8
    assert not less(sample, sample).estimate().half
