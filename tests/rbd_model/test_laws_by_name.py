"""Test that a vehicle's creep law is chosen by name, at every level, and that a law of the user is one more line."""

from __future__ import annotations

from dataclasses import replace

import pytest

from bogie_braking.machines import model_from, vehicle
from fmu_src.kernel import Kernel, SimulationError
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins
from rbd_model.levels.models import STRIPS, places_of
from tests.quick_library import quick_library

#: Torques of a wheelset [N.m]: one at which every law with Kalker's slope is linear, and a third of that which locks
#: it.
SMALL, LARGE = 10.0, 6e3
#: Tolerance between the fits of the ellipse and of Kalker's table, used by other laws, and exact values: 1.03e-3.
FITS = 2e-3


def slip_ratio(law: str, torque: float, level: int) -> float:
    bogie = replace(vehicle("bogie"), creep_law=law)
    kernel = Kernel(quick_library(model_from(bogie, places_of(level, 2, on_line=False))))
    kernel.set(brake_torque_1=torque, brake_torque_2=torque, initial_speed=20.0)
    kernel.advance(1.0)
    return kernel["slip_ratio_1"]


@pytest.mark.parametrize("level", [1, 2])
def test_a_wheelset_creeps_by_the_law_that_its_vehicle_names(level: int) -> None:
    small, large = (slip_ratio("kalker-linear", torque, level) for torque in (SMALL, LARGE))
    assert large / small == pytest.approx(LARGE / SMALL, rel=2e-2)  # linear except for the load transfer
    saturates = slip_ratio("shen-hedrick-elkins", LARGE, level)
    assert saturates > 1.05 * large
    assert slip_ratio(DEFAULT_LAW, SMALL, level) == pytest.approx(small, rel=FITS)


@pytest.mark.parametrize("law", [DEFAULT_LAW, "kalker-linear"])
def test_no_law_answers_where_the_ellipse_is_longer_than_its_tables(law: str) -> None:
    """A rail head of 50 m radius under a wheel of 0.46 m has an ellipse beyond 1:10."""
    bogie = replace(vehicle("bogie"), creep_law=law)
    kernel = Kernel(quick_library(model_from(bogie, places_of(1, 2, on_line=False))))
    kernel.set(brake_torque_1=LARGE, initial_speed=20.0, rail_head_radius=50.0)
    with pytest.raises(SimulationError, match="The output acceleration is not a finite number at the start"):
        kernel.advance(0.1)


def test_strips_are_left_out_where_a_law_would_not_act_on_them() -> None:
    bogie = replace(vehicle("bogie"), creep_law="fastrip")
    assert [one.name for one in model_from(bogie, (0, STRIPS)).systems] == ["point"]
    with pytest.raises(ValueError, match="Contact model 3 does not use a creep_law"):
        model_from(bogie, (STRIPS,))


def test_a_law_of_a_script_is_one_line_and_a_wrong_name_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match="creep_law must be one of polach"):
        replace(vehicle("bogie"), creep_law="mine")
    monkeypatch.setitem(LAWS, "mine", shen_hedrick_elkins)
    assert slip_ratio("mine", LARGE, 1) == slip_ratio("shen-hedrick-elkins", LARGE, 1)
