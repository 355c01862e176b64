"""Thousands of random commands: every result is finite or has a status, and a locked wheelset is exactly at rest."""

from __future__ import annotations

import math
import random

import pytest

from fmu_src.kernel import DISCARD, Kernel, Library, SimulationError

RUNS, STEPS = 60, 50
WATCHED = ("speed", "acceleration", "slip_1", "creep_force_1", "creep_force_2", "axle_load_1", "pitch")


def drive(one: Kernel, chance: random.Random) -> None:
    """Make one step of random length, from 10 us to 10 s, with random torques, friction and pull."""
    one.set(
        brake_torque_1=chance.choice([0.0, 10 ** chance.uniform(0, 5)]),
        brake_torque_2=chance.choice([0.0, 10 ** chance.uniform(0, 5)]),
        traction_torque_1=chance.choice([0.0, chance.uniform(-3e4, 3e4)]),
        drawbar_force=chance.choice([0.0, chance.uniform(-1e5, 1e5)]),
        friction_1=chance.choice([0.0, 0.05, 0.3, 0.5]),
        friction_2=chance.choice([0.1, 0.3]),
    )
    one.advance(10 ** chance.uniform(-5, 1))


def refused(one: Kernel, chance: random.Random) -> SimulationError | None:
    try:
        drive(one, chance)
    except SimulationError as error:
        return error
    return None


@pytest.mark.parametrize("seed", range(RUNS))
def test_random_driving_stays_finite_and_locks_exactly(bogie: Library, seed: int) -> None:
    chance = random.Random(seed)
    one = Kernel(
        bogie,
        level=chance.choice([1, 2]),
        initial_speed=chance.choice([0.0, 0.01, 1.0, 25.0, -5.0, 60.0]),
        torque_reaction=chance.choice([0.0, 1.0]),
        rolling_resistance_torque=chance.choice([0.0, 65.0]),
    )
    one.initialise(chance.choice([0.0, 1e3, 1e6]))
    for _ in range(STEPS):
        refusal = refused(one, chance)
        if refusal:  # only wheel lift may end the run
            assert refusal.status == DISCARD
            assert "lifted off" in str(refusal)
            return
        assert all(math.isfinite(one[name]) for name in WATCHED)
        for number in (1, 2):
            assert one[f"angular_velocity_{number}"] == 0.0 or not one[f"locked_{number}"]
