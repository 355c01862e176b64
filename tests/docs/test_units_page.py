"""The sign conventions of docs/units.md, each checked in a run."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.model_description import DISPLAY_UNITS
from readers.usual import likely_unit

PAGE = (Path(__file__).parents[2] / "docs" / "units.md").read_text(encoding="utf-8")
SPATIAL = {"level": 3, "initial_speed": 15.0}


def ends(*names: str, line: bb.Line | None = None, duration: float = 3.0, **values: float) -> dict[str, float]:
    """Return the final values of a run of the bogie."""
    table = bb.run("bogie", duration, line, list(names), duration, **values)
    return {name: float(table[name][-1]) for name in names}


def test_units_that_are_shown_are_those_of_the_fmus() -> None:
    rows = dict(re.findall(r"^\| [\w, ]+ \| ([\w./]+)[^|]* \| ([\w/]+) \|$", PAGE, re.MULTILINE))
    assert rows == {of: shown for shown, (of, _) in DISPLAY_UNITS.items()}


def test_a_brake_slows_pitches_the_nose_down_and_is_a_capacity() -> None:
    braked = ("acceleration", "slip_1", "creep_force_1", "pitch", "angular_velocity_1")
    found = ends(*braked, level=2, initial_speed=25.0, brake_torque_1=15e3, brake_torque_2=15e3)
    assert found["acceleration"] < 0.0 < found["angular_velocity_1"]
    assert found["slip_1"] > 0.0 > found["creep_force_1"]
    assert found["pitch"] > 0.0
    assert ends("acceleration", initial_speed=-25.0, brake_torque_1=15e3)["acceleration"] > 0.0
    with pytest.raises(bb.SimulationError, match="brake_torque_1"):
        ends("speed", brake_torque_1=-1.0)


def test_what_pulls_and_drives_forward_is_positive_and_a_gradient_rises() -> None:
    for name in ("drawbar_force", "traction_torque_1"):
        assert ends("acceleration", initial_speed=15.0, **{name: 5e3})["acceleration"] > 0.0
    assert ends("acceleration", initial_speed=15.0, gradient=0.01)["acceleration"] == pytest.approx(-0.097, abs=2e-3)


def test_a_curve_to_the_left_needs_force_to_the_left_and_cant_leans_to_the_left() -> None:
    names = ("lateral_1", "guiding_force_1", "wheel_load_1_left", "wheel_load_1_right")
    flat = ends(*names, line=bb.line_of([bb.arc(300.0, 300.0)], -20.0), duration=8.0, **SPATIAL)
    assert flat["lateral_1"] < 0.0 < flat["guiding_force_1"]
    assert flat["wheel_load_1_left"] < flat["wheel_load_1_right"]
    canted = ends(*names, line=bb.line_of([bb.arc(300.0, 300.0, cant=0.15)], -20.0), duration=8.0, **SPATIAL)
    assert canted["wheel_load_1_left"] > canted["wheel_load_1_right"]


def test_yaw_is_positive_to_the_left_and_displaced_rails_to_the_left_and_up() -> None:
    assert ends("yaw_1", yaw_torque_1=2e3, **SPATIAL)["yaw_1"] > 0.0
    straight = bb.line_of([bb.straight(100.0)], -20.0)
    grown = 5e-3 * np.interp(straight.rows["distance"], [5.0, 25.0], [0.0, 1.0])

    def on(name: str) -> bb.Line:
        return replace(straight, rows=straight.rows | {name: grown})

    at_left_flange = [
        ends("lateral_1", line=one, yaw_torque_1=45e3, **SPATIAL) for one in (straight, on("left_lateral"))
    ]
    assert at_left_flange[1]["lateral_1"] - at_left_flange[0]["lateral_1"] == pytest.approx(2.5e-3, abs=2e-4)
    assert ends("frame_roll", line=on("left_vertical"), **SPATIAL)["frame_roll"] > 1e-3
    assert ends("frame_roll", cross_level=5e-3, cross_level_centre=45.0, **SPATIAL)["frame_roll"] > 1e-3


def test_y_is_outwards_on_both_sides_and_a_flange_pushes_back() -> None:
    for side, to_the_left in (("left", 1.0), ("right", -1.0)):
        name = f"derailment_quotient_1_{side}"
        found = ends(name, "flange_force_1", yaw_torque_1=to_the_left * 45e3, **SPATIAL)
        assert found[name] > 0.2
        assert found["flange_force_1"] * to_the_left < 0.0


def test_a_number_just_above_its_limit_is_not_taken_for_another_unit() -> None:
    assert likely_unit(4.9, "bar", 0.0, 4.8) == ""
    assert likely_unit(380.0, "bar", 0.0, 8.0) == " Did you mean 380 kPa = 3.8 bar?"
    assert likely_unit(200.0, "m/s", 0.0, 150.0) == " Did you mean 200 km/h = 55.56 m/s?"
