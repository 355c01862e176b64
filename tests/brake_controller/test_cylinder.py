"""Test the brake cylinder: timing, valve, fail-safe, rigging and shoe friction, against chapters 2, 6 and 7."""

from __future__ import annotations

import math

import pytest

from brake_controller.experiment import EXPERIMENT
from brake_controller.parameters import qr30
from brake_controller.rigging import force_per_pressure
from brake_controller.shoe_friction import MEASURED_AGAINST_FORCE
from fmu_src.kernel import Kernel, Library, SimulationError

#: Error of a pressure at the tolerance of 1e-6 of 1e5 Pa per step.
PRESSURE_ERROR = 1.0


@pytest.mark.parametrize("time", [0.8, 4.0, 24.0])
def test_application_time_is_from_0_to_95_percent(brake: Library, time: float) -> None:
    kernel = Kernel(brake, application_time=time, pressure_demand=300e3)
    kernel.advance(time)
    assert kernel["cylinder_pressure"] == pytest.approx(0.95 * 300e3, abs=PRESSURE_ERROR)


def test_release_time_is_from_100_to_5_percent_by_demand_and_by_vent(brake: Library) -> None:
    for command in ({"pressure_demand": 0.0}, {"valve": 2}):
        kernel = Kernel(brake, application_time=0.1, release_time=3.0, pressure_demand=300e3)
        kernel.advance(2.0)
        kernel.set(**command)
        kernel.advance(3.0)
        assert kernel["cylinder_pressure"] == pytest.approx(0.05 * 300e3, abs=PRESSURE_ERROR)


def test_hold_keeps_the_pressure(brake: Library) -> None:
    kernel = Kernel(brake, pressure_demand=200e3)
    kernel.advance(0.3)
    kernel.set(valve=1)
    before = kernel["cylinder_pressure"]
    kernel.advance(60.0)
    assert kernel["cylinder_pressure"] == before > 1e5


def test_regulator_passes_no_more_than_the_supply(brake: Library) -> None:
    kernel = Kernel(brake, pressure_demand=900e3, supply_pressure=350e3)
    kernel.advance(20.0)
    assert kernel["cylinder_pressure"] == pytest.approx(350e3, abs=PRESSURE_ERROR)


def test_lost_demand_applies_the_brake_and_says_so(brake: Library) -> None:
    kernel = Kernel(brake, pressure_demand=0.0)
    kernel.advance(5.0)
    assert kernel["brake_torque"] == 0.0
    kernel.set(pressure_demand=math.nan)
    kernel.advance(5.0)
    assert kernel["cylinder_pressure"] == pytest.approx(350e3, rel=1e-4)
    assert "pressure_demand is lost" in kernel.messages[-1]


def test_demand_that_was_never_given_applies_the_brake(brake: Library) -> None:
    kernel = Kernel(brake)
    kernel.advance(5.0)
    assert kernel["cylinder_pressure"] == pytest.approx(350e3, rel=1e-4)


@pytest.mark.parametrize(("pressure", "specified", "lost"), [(130, 5.33, 18), (150, 6.15, 19), (180, 7.38, 15)])
def test_rod_force_is_the_printed_share_under_the_specification(
    brake: Library, pressure: int, specified: float, lost: float
) -> None:
    """Sections 7.2.1, 7.3.1, 7.4.1; the thesis reports the percentages without decimals."""
    kernel = Kernel(brake, **qr30(pressure).values(), pressure_demand=1e3 * pressure)
    kernel.advance(20.0)
    assert 100 * (1 - kernel["shoe_force"] / 2e3 / specified) == pytest.approx(lost, abs=0.5)


def test_torque_is_friction_times_force_times_radius(brake: Library) -> None:
    """Eq. (2.7)."""
    kernel = Kernel(brake, pressure_demand=180e3)
    kernel.advance(20.0)
    assert kernel["brake_torque"] == pytest.approx(kernel["shoe_friction"] * kernel["shoe_force"] * 0.398, rel=1e-12)
    # 0.25 x 180 kPa x 0.082 kN/kPa x 0.85 x 0.398 m
    assert kernel["brake_torque"] == pytest.approx(1248.3, rel=1e-3)


@pytest.mark.parametrize("pressure", [130, 150, 180])
def test_measured_law_gives_the_printed_average_at_each_pressure(brake: Library, pressure: int) -> None:
    values = qr30(pressure).values() | {"friction_law": MEASURED_AGAINST_FORCE}
    kernel = Kernel(brake, **values, pressure_demand=1e3 * pressure)
    kernel.advance(20.0)
    case = EXPERIMENT[pressure]
    assert kernel["shoe_friction"] == pytest.approx(case.shoe_friction, abs=1e-6)
    assert case.lowest_shoe_friction <= kernel["shoe_friction"] <= case.highest_shoe_friction


def test_measured_friction_falls_with_force_and_is_held_outside_the_measurements(brake: Library) -> None:
    found = []
    for pressure in (20e3, 130e3, 150e3, 180e3, 350e3):
        kernel = Kernel(brake, friction_law=1, rigging_efficiency=0.82, pressure_demand=pressure)
        kernel.advance(20.0)
        found.append(kernel["shoe_friction"])
    assert found == sorted(found, reverse=True)
    assert (found[0], found[-1]) == pytest.approx((0.30, 0.25))


def test_slack_adjuster_counter_force_reduces_the_shoe_force_and_never_pulls(brake: Library) -> None:
    """Eqs (2.4), (2.6)."""
    forces = []
    for counter in (0.0, 1000.0, 1e6):
        kernel = Kernel(brake, slack_adjuster_force=counter, pressure_demand=180e3)
        kernel.advance(20.0)
        forces.append(kernel["shoe_force"])
    assert forces[0] - forces[1] == pytest.approx(1000.0 * 0.85, rel=1e-9)
    assert forces[2] == 0.0


def test_piston_and_rigging_ratio_give_the_force_per_pressure() -> None:
    """Eq. (2.5): a piston of 200 mm and a ratio of 5.22 make the QR30's 0.164 N/Pa."""
    assert force_per_pressure(0.2, 5.22) == pytest.approx(0.164, rel=1e-3)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"pressure_demand": -1.0}, "pressure_demand must be at least 0 Pa"),
        ({"valve": 3}, "valve must be at most 2"),
        ({"valve": 0.5}, "valve must be an integer"),
        ({"application_time": 0.0}, "application_time must be at least 0.001 s"),
        ({"rigging_efficiency": 1.2}, "rigging_efficiency must be at most 1"),
    ],
)
def test_bad_value_gets_a_sentence(brake: Library, values: dict[str, float], sentence: str) -> None:
    with pytest.raises(SimulationError, match=sentence):
        Kernel(brake).set(**values)


def test_unknown_pressure_of_the_experiment_is_refused() -> None:
    with pytest.raises(ValueError, match="pressure_kpa must be one of 130, 150, 180; got 140"):
        qr30(140)
