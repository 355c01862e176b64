"""Test the recovery of adhesion by sliding energy: closed forms, and a locked bogie that cleans its rail."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fmu_src.kernel import Kernel, Library
from products.building import kernel_of
from products.kernel_runs import prepare
from rbd_model.track.recovery import SCATTER, SLOWEST, assumed_recovery, easy_recovery, hard_recovery, no_recovery

P = assumed_recovery()
GAIN = P.recovered_friction - P.degraded_friction
#: Errors of the friction left by one wheelset to the other: where it begins, and from half a metre later on
#: (`MOMENTS`).
DELAY_ERROR, LATER_ERROR = 0.02, 2e-3


@pytest.fixture(scope="module")
def rail() -> Library:
    return Library(kernel_of("rail"))


def slid(rail: Library, seconds: float, **inputs: float) -> Kernel:
    kernel = Kernel(rail, speed=20.0, **inputs)
    kernel.advance(seconds)
    return kernel


def test_friction_follows_the_sliding_energy_along_the_rail(rail: Library) -> None:
    """e = |F w| / V; the cleaned share approaches 1 - exp(-e / e_0) with exp(-x / L)."""
    force, slip, seconds = 4e3, 6.0, 0.07
    kernel = slid(rail, seconds, creep_force_1=-force, slip_1=slip)
    energy = force * slip / math.hypot(20.0, SLOWEST)
    end = 1.0 - math.exp(-energy / P.recovery_energy)
    share = end * (1.0 - math.exp(-20.0 * seconds / P.recovery_length))
    assert kernel["friction_1"] == pytest.approx(P.degraded_friction + GAIN * share, rel=1e-5)


def test_scatter_of_published_energies_decides_how_much_is_cleaned(rail: Library) -> None:
    """1 - exp(-e / e_0) over the scatter around the assumed energy; a rail without recovery keeps its friction."""
    sliding = {"creep_force_1": -4e3, "slip_1": 6.0}
    gains = []
    for parameters in (easy_recovery(), P, hard_recovery()):
        share = 1.0 - math.exp(-4e3 * 6.0 / math.hypot(20.0, SLOWEST) / parameters.recovery_energy)
        gains.append(slid(rail, 4.0, **sliding, **parameters.values())["friction_1"] - P.degraded_friction)
        assert gains[-1] == pytest.approx(GAIN * share, rel=1e-5)
    assert easy_recovery().recovery_energy * SCATTER == pytest.approx(hard_recovery().recovery_energy)
    assert gains[0] > 2 * gains[1] > 4 * gains[2]
    assert slid(rail, 4.0, **sliding, **no_recovery().values())["friction_1"] == P.degraded_friction


def test_trailing_wheelset_finds_the_cleaned_rail_a_wheel_base_later(rail: Library) -> None:
    """The share left behind, 1 - exp(-(x - l) / L) of it from x = l on; an error of half of l would be detected."""
    force, slip, speed = 4e3, 6.0, 20.0
    kernel = Kernel(rail, speed=speed, creep_force_1=-force, slip_1=slip)
    table = kernel.record(0.4, 1e-3, ["friction_1", "friction_2"])
    distance = speed * np.array(table["time"])
    energy = force * slip / math.hypot(speed, SLOWEST)
    share = 1.0 - math.exp(-energy / P.recovery_energy)

    def left(wheel_base: float) -> np.ndarray:
        return share * P.left_behind * (1.0 - np.exp(-np.maximum(distance - wheel_base, 0.0) / P.recovery_length))

    found = (np.array(table["friction_2"]) - P.degraded_friction) / GAIN
    assert np.abs(found - left(P.wheel_base)).max() < DELAY_ERROR * share * P.left_behind
    later = distance > P.wheel_base + 0.5
    assert np.abs(found - left(P.wheel_base))[later].max() < LATER_ERROR * share * P.left_behind
    assert found.min() >= 0.0
    assert np.abs(found - left(1.5 * P.wheel_base)).max() > 5 * DELAY_ERROR * share * P.left_behind


def test_running_backwards_is_running_forwards_with_the_ends_exchanged(rail: Library) -> None:
    for seconds in (0.05, 0.2, 1.0):
        ahead = slid(rail, seconds, creep_force_1=-4e3, slip_1=6.0, creep_force_2=-2e3, slip_2=5.0)
        back = Kernel(rail, speed=-20.0, creep_force_2=4e3, slip_2=-6.0, creep_force_1=2e3, slip_1=-5.0)
        back.advance(seconds)
        assert back["friction_1"] == pytest.approx(ahead["friction_2"], rel=1e-6)
        assert back["friction_2"] == pytest.approx(ahead["friction_1"], rel=1e-6)


def test_bogie_that_turns_back_finds_the_rail_that_its_leading_wheelset_has_cleaned(rail: Library) -> None:
    """Wheelset 1 stops within a rail that it has cleaned; backwards it runs over it, and after a wheel base beyond."""
    kernel = slid(rail, 1.0, creep_force_1=-4e3, slip_1=6.0)
    cleaned = kernel["friction_1"]
    kernel.set(speed=0.0, creep_force_1=0.0)
    kernel.advance(1.0)
    assert kernel["friction_1"] == pytest.approx(cleaned, rel=1e-9)
    kernel.set(speed=-20.0)
    kernel.advance(0.25 * P.wheel_base / 20.0)
    over_it = kernel["friction_1"]
    assert over_it > cleaned
    kernel.advance(1.0)  # wheelset 2 leads now, and rolls
    assert kernel["friction_1"] == pytest.approx(P.degraded_friction, abs=DELAY_ERROR * GAIN)


def test_cleaned_rail_is_not_dirtier_than_a_dirty_one(rail: Library) -> None:
    """The polynomials fall below 0 before the cleaning arrives; a bogie would refuse negative friction."""
    kernel = Kernel(rail, speed=20.0, creep_force_1=-4e4, slip_1=6.0, degraded_friction=0.0)
    assert min(kernel.record(0.3, 1e-3, ["friction_2"])["friction_2"]) >= 0.0


def test_rolling_wheels_clean_nothing_and_standing_ones_stay_as_they_are(rail: Library) -> None:
    rolling = slid(rail, 5.0, creep_force_1=-4e3, slip_1=0.0)
    assert rolling["friction_1"] == P.degraded_friction
    kernel = slid(rail, 0.2, creep_force_1=-4e3, slip_1=6.0)
    before = kernel["friction_1"]
    kernel.set(speed=0.0, slip_1=0.0)
    kernel.advance(10.0)
    assert kernel["friction_1"] == pytest.approx(before, rel=1e-12)


def test_a_locked_bogie_that_cleans_its_rail_stops_shorter(rail: Library) -> None:
    distances = []
    for recovers in (False, True):
        bogie = prepare("bogie", level=2, initial_speed=20.0, brake_torque_1=60e3, brake_torque_2=60e3)
        kernel = Kernel(rail)
        friction = {"friction_1": P.degraded_friction, "friction_2": P.degraded_friction}
        bogie.set(**friction)
        bogie.initialise()
        kernel.initialise()
        while bogie["speed"] > 0.05:
            if recovers:
                kernel.set(speed=bogie["speed"])
                for wheelset in (1, 2):
                    names = (f"creep_force_{wheelset}", f"slip_{wheelset}")
                    kernel.set(**{name: bogie[name] for name in names})
                kernel.advance(1e-2)
                bogie.set(friction_1=kernel["friction_1"], friction_2=kernel["friction_2"])
            bogie.advance(1e-2)
        distances.append(bogie["distance"])
    assert distances[1] < 0.7 * distances[0]
    assert distances[1] > distances[0] * P.degraded_friction / P.recovered_friction  # no better than a clean rail
