"""Test a blended dynamic brake and traction against closed forms: lags, limits and commands."""

from __future__ import annotations

import math

import pytest

from brake_controller.motors import dynamic_brake, motor_of, traction_motor
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, Variable, model_of

TIGHT = 1e-10
PRESSURE, TORQUE, RADIUS = 380e3, 6.4e3, 0.46
MOTOR = motor_of(TORQUE, RADIUS)
APPLY, HOLD, VENT = 0, 1, 2
SLOW, FAST = 20.0, 100.0


@pytest.fixture(scope="module")
def blended() -> Library:
    system = System("blended", "Dynamic brake alone")
    demand = system.input(Variable("pressure_demand", "input", "Pa", "Demand", 0.0))
    valve = system.input(Variable("valve", "input", "1", "Valve", 0.0, 0.0, 2.0, "integer"))
    omega = system.input(Variable("angular_velocity", "input", "rad/s", "Of the wheelset", 0.0))
    left, _ = dynamic_brake(MOTOR, PRESSURE, TORQUE)(system, demand, valve, omega)
    system.output(Variable("friction_demand", "output", "Pa", "Left"), left)
    return Library(build_library(model_of(system, TIGHT)))


@pytest.fixture(scope="module")
def driven() -> Library:
    return Library(build_library(model_of(traction_motor(MOTOR), TIGHT)))


def braking(blended: Library, seconds: float = 10.0, **values: float) -> Kernel:
    kernel = Kernel(blended, **{"pressure_demand": PRESSURE, "angular_velocity": SLOW} | values)
    kernel.initialise()
    kernel.advance(seconds)
    return kernel


@pytest.mark.parametrize("share", [0.1, 0.4, 1.0])
@pytest.mark.parametrize("omega", [0.0, 2.0, SLOW, FAST])
def test_both_brakes_together_are_what_is_demanded(blended: Library, share: float, omega: float) -> None:
    """The motor provides what torque and power allow, reduced below 5 rad/s; the cylinder provides the rest."""
    kernel = braking(blended, pressure_demand=share * PRESSURE, angular_velocity=omega)
    most = min(MOTOR.motor_torque, MOTOR.motor_power / max(omega, 1e-9)) * min(omega / 5.0, 1.0)
    assert kernel["dynamic_torque"] == pytest.approx(min(share * TORQUE, most), rel=1e-3, abs=20.0)
    assert kernel["friction_demand"] / PRESSURE * TORQUE + kernel["dynamic_torque"] == pytest.approx(share * TORQUE)


@pytest.mark.parametrize("time", [0.03, 0.3, 3.0])
def test_a_motor_comes_and_goes_in_its_times(blended: Library, time: float) -> None:
    """1 - 20^(-t/T): 95 % after T; during release 20^(-t/T)."""
    times = {"motor_rise_time": time, "motor_release_time": time / 2}
    half = braking(blended, 0.5 * time, **times)
    assert half["dynamic_torque"] == pytest.approx(MOTOR.motor_torque * (1 - 20**-0.5), rel=1e-6)
    full = braking(blended, 20 * time, **times)
    full.set(valve=VENT)
    full.advance(time / 2)
    assert full["dynamic_torque"] == pytest.approx(MOTOR.motor_torque / 20, rel=1e-6)
    assert full["friction_demand"] == pytest.approx(PRESSURE * (1 - MOTOR.motor_torque / 20 / TORQUE), rel=1e-6)


def test_a_motor_that_holds_gives_no_more_and_as_it_gets_faster_less(blended: Library) -> None:
    kernel = braking(blended, 0.1)
    kernel.set(valve=HOLD)
    before = kernel["dynamic_torque"]
    kernel.advance(2.0)
    assert kernel["dynamic_torque"] == pytest.approx(before)
    kernel.set(angular_velocity=10 * FAST)
    kernel.advance(2.0)
    assert kernel["dynamic_torque"] == pytest.approx(MOTOR.motor_power / (10 * FAST), rel=1e-6)


@pytest.mark.parametrize("omega", [SLOW, FAST])
def test_traction_has_a_largest_torque_and_a_largest_power(driven: Library, omega: float) -> None:
    kernel = Kernel(driven, traction_demand=1.0, angular_velocity=omega)
    kernel.initialise()
    kernel.advance(10.0)
    assert kernel["traction_torque"] == pytest.approx(min(MOTOR.motor_torque, MOTOR.motor_power / omega), rel=1e-6)
    kernel.set(valve=VENT)
    kernel.advance(MOTOR.motor_release_time)
    assert kernel["traction_torque"] == pytest.approx(min(MOTOR.motor_torque, MOTOR.motor_power / omega) / 20, rel=1e-6)


def test_a_lost_demand_is_a_full_brake_and_no_traction(driven: Library) -> None:
    kernel = Kernel(driven, traction_demand=1.0, angular_velocity=SLOW)
    kernel.initialise()
    kernel.set(traction_demand=math.nan)
    kernel.advance(5.0)
    assert kernel["traction_torque"] == 0.0
