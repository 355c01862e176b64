"""Test that the parameter sets are the thesis's tables, and that unphysical values are refused with value and limit."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rbd_model.vehicle.parameters import tables_5_1_and_5_2, tables_8_1_and_8_2


def test_chapter_5_bogie_is_that_of_tables_5_1_and_5_2() -> None:
    p = tables_5_1_and_5_2()
    assert (p.frame_mass, p.frame_roll_inertia, p.frame_pitch_inertia, p.frame_yaw_inertia) == (6e4, 8e4, 6e4, 2e4)
    wheelset = (p.wheelset_mass, p.wheelset_roll_inertia, p.wheelset_pitch_inertia, p.wheelset_yaw_inertia)
    assert wheelset == (1200, 720, 112, 720)
    assert (p.longitudinal_stiffness, p.lateral_stiffness, p.vertical_stiffness) == (9.5e6, 6e6, 3.5e6)
    assert (p.longitudinal_damping, p.lateral_damping, p.vertical_damping) == (8e4, 4e4, 2.5e4)
    assert (p.wheel_base, p.wheel_radius) == (1.675, 0.425)


def test_chapter_5_axle_load_is_about_300_kn() -> None:
    p = tables_5_1_and_5_2()
    assert (p.wheelset_mass + p.frame_mass / 2) * p.gravity == pytest.approx(300e3, rel=0.03)


def test_experiment_bogie_is_that_of_tables_8_1_and_8_2() -> None:
    p = tables_8_1_and_8_2()
    assert (p.frame_mass, p.frame_roll_inertia, p.frame_pitch_inertia, p.frame_yaw_inertia) == (1480, 2000, 1500, 2500)
    wheelset = (p.wheelset_mass, p.wheelset_roll_inertia, p.wheelset_pitch_inertia, p.wheelset_yaw_inertia)
    assert wheelset == (1050, 450, 90, 450)
    assert (p.wheel_base, p.wheel_radius, p.rolling_resistance_torque) == (1.675, 0.398, 65.0)


def test_measured_wheel_load_of_the_experiment_is_the_static_one() -> None:
    """Section 7.4.2 reports about 8.85 kN for each wheel of the braked wheelset."""
    p = tables_8_1_and_8_2()
    assert (p.wheelset_mass + p.frame_mass / 2) * p.gravity / 2 == pytest.approx(8850.0, rel=0.01)


@pytest.mark.parametrize("mass", [0.0, 1.2, -1.0, float("nan")])
def test_a_mass_in_tonnes_or_below_zero_is_refused(mass: float) -> None:
    with pytest.raises(ValueError, match=r"wheelset_mass must be from 5 .* kg; got"):
        replace(tables_5_1_and_5_2(), wheelset_mass=mass)
