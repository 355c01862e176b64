"""Limits of the inputs and parameters of all FMUs."""

from __future__ import annotations

import math
import time
from typing import Any

import pytest

import bogie_braking as bb
from fmu_src.system import Variable
from products.registry import DIFFERENT, FMUS, model_of


def numbers(name: str) -> list[Variable]:
    """Return the real inputs and parameters of an FMU."""
    return [one for one in model_of(name).variables if one.causality in ("input", "parameter") and one.kind == "real"]


@pytest.mark.study
@pytest.mark.parametrize("name", FMUS)
def test_every_real_input_and_parameter_has_finite_limits(name: str) -> None:
    assert [one.name for one in numbers(name) if not (math.isfinite(one.minimum) and math.isfinite(one.maximum))] == []


@pytest.mark.study
@pytest.mark.parametrize("name", DIFFERENT)
def test_1e99_is_refused_everywhere(name: str) -> None:
    one = bb.Simulation(name)
    for variable in numbers(name):
        for value in (1e99, -1e99):
            with pytest.raises(bb.SimulationError, match=rf"^{variable.name} must be"):
                one.set(**{variable.name: value})


def test_a_step_at_the_largest_resistance_is_quick() -> None:
    one = bb.Simulation("driven-wheelset", resistance=1e8)
    one.advance(1e-3)
    begin = time.process_time()
    one.advance(0.01, interval=1e-3)
    assert time.process_time() - begin < 1.0  # 0.1 s for each of 10 steps


def test_a_variable_that_states_wider_limits_keeps_them() -> None:
    assert Variable("pull", "input", "N", "Pull", 0.0, -1e12, 1e12).maximum == 1e12
    assert Variable("pull", "output", "N", "Pull").maximum == math.inf


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"pressure_demand_1": 380.0}, "Did you mean 380 kPa"),
        ({"pressure_demand_1": 3800.0}, "Did you mean 3800 mbar"),
        ({"supply_pressure": 380.0}, "Did you mean 380 kPa"),
        ({"supply_pressure": 3800.0}, "Did you mean 3800 mbar"),
        ({"application_time": 800.0}, "Did you mean 800 ms"),
        ({"pressure_demand_1": ([0.0, 1.0], [0.0, 3800.0])}, "Did you mean 3800 mbar"),
    ],
)
def test_a_number_in_another_unit_is_refused_with_that_unit(values: dict[str, Any], said: str) -> None:
    with pytest.raises(bb.SimulationError, match=said):
        bb.Simulation("braked-vehicle", **values)


@pytest.mark.study
def test_possible_and_rare_numbers_are_noted_in_the_result() -> None:
    found = bb.run("braked-vehicle", 1e-3, initial_speed=120.0, pressure_demand_1=38e3, interval=1e-3)
    assert "initial_speed is 120 m/s = 432 km/h. Did you mean 120 km/h = 33.33 m/s?" in found.messages
    said = "pressure_demand_1 is 38000 Pa = 0.38 bar at the start; brakes usually have 0.5 bar or more."
    assert said in found.messages
    with pytest.raises(bb.SimulationError, match="Did you mean 380 kPa"):
        bb.batch("braked-vehicle", 1e-3, ["speed"], pressure_demand_1=[380.0, 380e3])
