"""Connections and bodies of vehicle files: a whole vehicle in TOML is that in Python, refusals, levels, FMU."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from products.vehicle_file import DataSheet, sheet_of
from products.vehicle_toml import write_vehicle
from rbd_model.contact.geometry import synthetic_pair
from rbd_model.vehicle.parameters import coach_with_traction_rods

GZ18 = Path(__file__).parents[1] / "data" / "gz18.toml"
#: Relative difference of two descriptions of one vehicle, of their largest value.
SAME = 1e-9
#: Radius, cant, transition and circle of the curve of the source, and its speed [m], [m/s].
RADIUS, CANT, RAMP, SPEED = 300.0, 0.120, 100.0, 60 / 3.6


def gz18() -> bb.parts.Vehicle:
    """Return GZ18 in Python, from the same source; z is above the wheelset axes."""
    parts, radius, pivot = bb.parts, 0.42, 7.85
    inertia = (60845.0, 1315247.0, 1344928.0)
    bodies = [parts.RigidBody("body", "car body", 30551.0, inertia, 0.0, 1.346 - radius)]
    wheelsets, connections = [], []
    for bogie, middle in (("front", pivot), ("rear", -pivot)):
        frame = f"{bogie}_frame"
        own = (1650.0, 3419.0, 4994.0)
        bodies.append(parts.RigidBody(frame, f"{bogie} frame", 8900.0, own, middle, 0.557 - radius))
        ends, low = ("body", frame), 0.557 - radius
        connections += [
            parts.Springs(
                *(f"{bogie}_air_springs", *ends, (middle, 0.95, 0.638 - radius), True),
                *((185e3, 185e3, 230e3), (0.0, 0.0, 20e3)),
            ),
            parts.Torsion(f"{bogie}_anti_roll_bar", *ends, (middle, 0.0, low), False, "roll", 3.5e6),
            parts.SeriesDamper(f"{bogie}_lateral_damper", *ends, (middle, 0.0, low), False, "lateral", 1e9, 60e3),
            parts.TableDamper(
                *(f"{bogie}_yaw_dampers", *ends, (middle, 1.2, low), True, "longitudinal"),
                *((0.0, 0.02, 0.04), (0.0, 12e3, 12e3)),
            ),
        ]
        for place, along in (("leading", 1.25), ("trailing", -1.25)):
            wheelsets.append(
                parts.Wheelset(
                    middle + along, frame, 1836.0, (1063.0, 1650.0, 1078.0), (radius, radius), synthetic_pair()
                )
            )
            ends, arm = (frame, f"wheelset_{len(wheelsets)}"), np.sign(along) * 0.77
            connections += [
                parts.Springs(
                    *(f"{bogie}_{place}_primary", *ends, (middle + along, 1.0, 0.0), True),
                    *((0.0, 0.0, 1.4e6), (0.0, 0.0, 10e3)),
                ),
                parts.Springs(
                    f"{bogie}_{place}_bushes", *ends, (middle + arm, 1.055, 0.0), True, (17e6, 9e6, 0.0)
                ),
            ]
    pulls = bb.vehicle("coach").pulls
    numbers = replace(coach_with_traction_rods(), gravity=9.80665, coupler_distance=19.0, coupler_height=0.3)
    return bb.parts.Vehicle("GZ18", numbers, tuple(bodies), tuple(wheelsets), tuple(connections), pulls)


def curve() -> bb.Line:
    """Return a right-hand curve with 120 mm of cant."""
    ahead, bend = bb.straight(20.0), bb.arc(500.0, -RADIUS, -CANT)
    return bb.line_of([ahead, bb.clothoid(RAMP, ahead, bend), bend])


def pair_of_runs(level: int, duration: float, names: list[str], line: bb.Line | None = None, **values: Any) -> list[Any]:
    return [bb.run(one, duration, line, names, 0.05, level=level, **values) for one in (bb.read_vehicle(GZ18), gz18())]


@pytest.mark.parametrize("level", [1, 2])
def test_a_vehicle_of_a_file_is_the_same_in_python(level: int) -> None:
    names = ["speed", "axle_load_1", "axle_load_2", "axle_load_3", "axle_load_4"] + ["body_pitch"] * (level > 1)
    runs = pair_of_runs(level, 2.0, names, initial_speed=20.0, brake_torque_1=6e3, traction_torque_4=2e3)
    for name in names:
        assert np.max(np.abs(runs[0][name] - runs[1][name])) < SAME * np.max(np.abs(runs[0][name])), name


@pytest.mark.study
def test_it_runs_through_a_curve_as_that_in_python() -> None:
    names = [f"{name}_{n}" for name in ("lateral", "yaw", "axle_load", "flange_force") for n in (1, 2, 3, 4)]
    runs = pair_of_runs(3, 10.0, names, curve(), initial_speed=SPEED)
    for name in names:
        assert np.max(np.abs(runs[0][name] - runs[1][name])) < SAME * np.max(np.abs(runs[0][name])), name
    assert runs[0]["lateral_1"][-1] > 5e-3
