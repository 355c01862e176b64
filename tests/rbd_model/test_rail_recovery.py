"""Recovery of adhesion by sliding energy: closed forms, and a locked bogie that cleans its rail."""

from __future__ import annotations

import math

import pytest

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from rbd_model.rail_recovery import SLOWEST, assumed_recovery
from scenarios.bench.drive import prepare
from scenarios.fmus.registry import model_of

P = assumed_recovery()


@pytest.fixture(scope="module")
def rail() -> Library:
    return Library(build_library(model_of("rail")))


def slid(rail: Library, seconds: float, **inputs: float) -> Kernel:
    kernel = Kernel(rail, speed=20.0, **inputs)
    kernel.advance(seconds)
    return kernel


def test_friction_follows_the_sliding_energy_along_the_rail(rail: Library) -> None:
    """e = |F w| / V; the share cleaned approaches 1 - exp(-e / e_0) with exp(-x / L)."""
    force, slip, seconds = 4e3, 6.0, 0.07
    kernel = slid(rail, seconds, creep_force_1=-force, slip_1=slip)
    energy = force * slip / math.hypot(20.0, SLOWEST)
    end = 1.0 - math.exp(-energy / P.recovery_energy)
    share = end * (1.0 - math.exp(-20.0 * seconds / P.recovery_length))
    gain = P.recovered_friction - P.degraded_friction
    assert kernel["friction_1"] == pytest.approx(P.degraded_friction + gain * share, rel=1e-5)
    assert kernel["friction_2"] == pytest.approx(P.degraded_friction + gain * P.left_behind * share, rel=1e-5)


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
