"""Test discs against closed forms: friction by speed and temperature, and the heat of an evenly turning wheelset."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from brake_controller.discs import MEAN_PAD_FRICTION, axle_discs, discs
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, Variable, model_of

TIGHT, CLOSED_FORM = 1e-11, 1e-6
FORCE, OMEGA = 40e3, 60.0
#: Relative error due to the smoothed corner of |w| at rest: at most 0.01 m/s of 15 m/s.
CORNER = 1e-3
DISCS = axle_discs()


@pytest.fixture(scope="module")
def library() -> Library:
    system = System("discs", "Discs alone")
    force = system.input(Variable("force", "input", "N", "Of the pads", 0.0))
    omega = system.input(Variable("angular_velocity", "input", "rad/s", "Of the wheelset", 0.0))
    torque = discs().torque(system, {}, force, omega)
    system.output(Variable("brake_torque", "output", "N.m", "Torque"), torque)
    return Library(build_library(model_of(system, TIGHT)))


def turned(library: Library, duration: float, **values: float) -> Kernel:
    kernel = Kernel(library, force=FORCE, angular_velocity=OMEGA, **values)
    kernel.initialise()
    if duration:
        kernel.advance(duration)
    return kernel


def warmer(duration: float, mass: float, cooling: float, fall: float) -> float:
    """Return the solution of d' = A (mu - b d) - K d, d(0) = 0: A = share F v / (m c), K = cooling / (m c)."""
    speed = OMEGA * DISCS.friction_radius
    heat = DISCS.disc_heat_share * FORCE * speed / (mass * DISCS.disc_heat_capacity)
    rate = heat * fall + cooling / (mass * DISCS.disc_heat_capacity)
    friction = DISCS.pad_friction_at_rest - DISCS.pad_friction_over_speed * speed
    return heat * friction / rate * (1.0 - math.exp(-rate * duration)) if rate else heat * friction * duration


@pytest.mark.parametrize("mass", [20.0, 200.0, 2000.0])
@pytest.mark.parametrize("cooling", [2.0, 20.0, 200.0])
def test_discs_warm_as_the_closed_form_does(library: Library, mass: float, cooling: float) -> None:
    values = {"disc_mass": mass, "disc_cooling_at_rest": cooling, "disc_cooling_over_speed": 0.0}
    kernel = turned(library, 20.0, **values, least_pad_friction=0.0)
    due = warmer(20.0, mass, cooling, DISCS.pad_friction_over_temperature)
    assert kernel["disc_temperature"] - 293.15 == pytest.approx(due, rel=CORNER)


def test_without_cooling_discs_take_all_heat(library: Library) -> None:
    """m c dT = share of the work of the torque, which is constant for constant friction."""
    values = {"disc_cooling_at_rest": 0.0, "disc_cooling_over_speed": 0.0, "pad_friction_over_temperature": 0.0}
    kernel = turned(library, 12.0, **values)
    work = kernel["brake_torque"] * OMEGA * 12.0
    taken = DISCS.disc_mass * DISCS.disc_heat_capacity * (kernel["disc_temperature"] - 293.15)
    assert taken == pytest.approx(DISCS.disc_heat_share * work, rel=CORNER)


def test_torque_is_friction_times_force_times_radius(library: Library) -> None:
    for warmth in (293.15, 500.0, 5000.0):
        kernel = turned(library, 0.0, initial_disc_temperature=warmth)
        fallen = 0.38 - 1e-3 * (OMEGA * 0.247) - 1e-4 * (warmth - 293.15)
        friction = max(fallen, 0.2)
        assert kernel["pad_friction"] == pytest.approx(friction, rel=1e-4)
        assert kernel["brake_torque"] == pytest.approx(friction * FORCE * 0.247, rel=1e-4)


def test_the_mean_of_a_stop_from_200_km_h_is_what_the_brake_is_laid_out_for() -> None:
    """Mean over distance, as in UIC 541-3: speed varies as the root of the remaining distance. 5 t per disc."""
    speed, fall = 200 / 3.6 * 0.247 / 0.46, DISCS.pad_friction_over_temperature
    motion = 0.95 * 10e3 * (200 / 3.6) ** 2 / 2 / (DISCS.disc_mass * DISCS.disc_heat_capacity)
    mean = DISCS.pad_friction_at_rest - 1e-3 * speed * 2 / 3 - fall * motion / 2
    assert mean == pytest.approx(MEAN_PAD_FRICTION, abs=0.01)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(ValueError, match=r"disc_mass must be from 1 to 1e.06 kg; got 0 kg"):
        replace(DISCS, disc_mass=0.0)
