"""Compare rails that rise or turn aside with level or straight rails in the same relative position.

A rotation of wheel and rail together (by a gradient or a heading) changes no force between them. Track axes do not
include slopes of the rails by irregularities or cant ramps.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from fmu_src.kernel import Kernel, Library
from rbd_model.track.line import Line
from rbd_model.vehicle.ready import two_axle_bogie
from tests.evidence.maximal.machine import Machine

#: Slope of the rails [1], speed [m/s], and position of the leading wheelset on the line [m].
SLOPE, SPEED, PLACE = 1e-3, 20.0, 50.0
#: The left wheel on its flange with some 60 kN, the right one on its tread: lateral position, rise [m] and roll [rad].
STANDS = {"lateral_1": 9.5e-3, "rise_1": 1.486e-3, "roll_1": 3.385e-3}
#: Tolerance, of a static wheel load of 60 kN: second order in the slope, 1e-6, times a sensitivity to creepage of up to
#: 100. Measured 4.3e-5 at models 2 and 3. With creepage in track axes it would be 4e-3 to 5e-2.
LOAD, BAND = 60e3, 1e-4


@cache
def library(depth: int) -> tuple[Library, list[str]]:
    machine = Machine(two_axle_bogie(), True, depth)
    return machine.library, machine.names


def forces(depth: int, folder: Path, rows: dict[str, float], **state: float) -> dict[str, float]:
    """Return rail forces of the leading wheelset over LOAD; rows: slopes of columns of the line, or its gradient."""
    distance = np.arange(0.0, 101.0)
    level = dict.fromkeys(("curvature", "cant", "gradient"), 0 * distance)
    columns = {name: slope * (distance - PLACE) for name, slope in rows.items()}
    if "gradient" in rows:
        columns["gradient"] = 0 * distance + rows["gradient"]
    own, names = library(depth)
    kernel = Kernel(own, line_file=str(Line({"distance": distance, **level, **columns}).write(folder / "line.csv")))
    kernel.initialise()
    vehicle = two_axle_bogie()
    along, radius = (vehicle.number(size) for size in (vehicle.wheelsets[0].along, vehicle.wheelsets[0].mean_radius))
    value = dict.fromkeys(names, 0.0) | STANDS | state
    value |= {"frame_distance": PLACE - along, "frame_speed": SPEED, "angular_velocity_1": SPEED / radius}
    kernel.arrive(0.0, [value[name] for name in names])
    outputs = [f"{name}_1_{side}" for name in ("wheel_load", "lateral_force") for side in ("left", "right")]
    return {name: kernel[name] / LOAD for name in (*outputs, "creep_force_1")}


@pytest.mark.study
@pytest.mark.parametrize("depth", [2, 3])
def test_rails_that_rise_carry_a_wheelset_as_a_gradient_does(depth: int, tmp_path: Path) -> None:
    """In level axes it climbs and yaws by slope times roll, and the creep force has a vertical part."""
    there = forces(depth, tmp_path, {"gradient": SLOPE})
    climbing = {"rise_speed_1": SLOPE * SPEED, "yaw_1": SLOPE * STANDS["roll_1"]}
    here = forces(depth, tmp_path, {"left_vertical": SLOPE, "right_vertical": SLOPE}, **climbing)
    for name in ("lateral_force_1_left", "lateral_force_1_right", "creep_force_1"):
        assert here[name] == pytest.approx(there[name], abs=BAND)
    loads = [one["wheel_load_1_left"] + one["wheel_load_1_right"] for one in (here, there)]
    assert loads[0] == pytest.approx(loads[1] + SLOPE * there["creep_force_1"], abs=BAND)


@pytest.mark.parametrize("depth", [2, 3])
def test_rails_that_turn_aside_carry_a_wheelset_as_straight_ones_a_yawed_one(depth: int, tmp_path: Path) -> None:
    """Rails and wheelset turn by half of the slope to either side, so that the wheels have the same penetration."""
    there = forces(depth, tmp_path, {}, yaw_1=-SLOPE / 2)
    moving = {"yaw_1": SLOPE / 2, "lateral_speed_1": SLOPE * SPEED}
    here = forces(depth, tmp_path, {"left_lateral": SLOPE, "right_lateral": SLOPE}, **moving)
    for name in ("wheel_load_1_left", "wheel_load_1_right", "creep_force_1"):
        assert here[name] == pytest.approx(there[name], abs=BAND)
