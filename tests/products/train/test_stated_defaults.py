"""A default of docs/train.md and docs/train-brakes.md that a row states changes no number of the train."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from products.train.consist_file import consist_of
from products.train.numbers import Settings, numbers_of

WAGON = {"kind": "wagon", "valve": "head"}
BY_WIRE = {"kind": "coach", "valve": "head", "brake": "ep-direct", "dynamic_force": 50.0}
PADS = {"kind": "coach", "valve": "head", "friction": "pads"}
HEAT = {"wheel_mass": 300.0, "block_mass": 20.0}
#: Rows, and defaults of the pages that they may state.
DEFAULTS: tuple[tuple[dict[str, Any], dict[str, Any]], ...] = (
    (
        WAGON,
        {"friction": "composite", "shoes": 16, "pipe_diameter": 31.75, "at": 0.5, "distributor": "uic", "position": "P"}
        | {"full_pressure": 3.8, "auxiliary": 100.0, "cylinder": 10.3, "adhesion": "input", "coupler": "screw"}
        | {"service_rate": 0.5, "exhaust": 10.0},
    ),
    (WAGON | {"position": "G"}, {"full_pressure": 3.8, "auxiliary": 100.0, "cylinder": 10.3}),
    (
        WAGON | {"cylinder_diameter": 406.0, "rigging_ratio": 5.65},
        {"cylinders": 1, "rigging_efficiency": 0.83, "return_force": 1500.0},
    ),
    (PADS | {"shoe_force": 100.0}, {"friction_radius": 0.6, "shoes": 8}),
    (
        BY_WIRE,
        {"full_pressure": 3.8, "fill_time": 1.5, "release_time": 2.0, "dead_time": 0.0, "blending": "fills"}
        | {"dynamic_fade": 8.0, "dynamic_rise": 1.0},
    ),
    (
        WAGON | {"traction_force": 100.0, "traction_power": 2000.0},
        {"traction_rise": 1.0, "traction_cut_out": 2.5},
    ),
    (
        WAGON | HEAT,
        {"wheels": 8, "heat_share": 0.9, "cooling": 20.0, "cooling_speed": 2.0}
        | {"block_heat": 1000.0, "block_cooling": 2.0, "block_cooling_speed": 0.3},
    ),
    (WAGON | HEAT | {"friction": "cast-iron-p10"}, {"heat_share": 0.75, "block_heat": 510.0}),
    (WAGON | HEAT | {"thickness": 50.0}, {"rubbed_area": 0.231}),
    (PADS | {"disc_mass": 72.0}, {"discs": 8, "heat_share": 0.95, "cooling": 10.0, "cooling_speed": 2.4}),
    (PADS | {"disc_mass": 72.0, "thickness": 22.0}, {"rubbed_area": 0.451}),
    (
        WAGON | {"magnetic_attraction": 60.0},
        {"magnetic_friction": 0.25, "magnetic_fast": 0.05, "magnetic_speed": 50.0, "magnetic_lift": 20.0}
        | {"magnetic_from": 50.0, "magnetic_rise": 1.0, "track_brake_pressure": 3.0},
    ),
    (WAGON | {"eddy_force": 20.0}, {"eddy_speed": 100.0, "eddy_rise": 1.0}),
    (WAGON | {"parking_force": 20.0}, {"parking_time": 2.0, "parking_compounding": "adds"}),
    (WAGON | {"distributor": "aar"}, {"retainer": "direct", "accelerated_release": "yes"}),
)
CASES = [(row, name, value) for row, stated in DEFAULTS for name, value in stated.items()]


@pytest.mark.parametrize(("row", "name", "value"), CASES)
def test_a_default_that_is_stated_changes_nothing(row: dict[str, Any], name: str, value: Any) -> None:
    plain, same = (numbers_of(consist_of([one]), Settings(), None) for one in (row, row | {name: value}))
    assert same == pytest.approx(plain, rel=1e-5, abs=1e-9)


def test_another_value_changes_numbers() -> None:
    for row, stated in DEFAULTS:
        for name, value in stated.items():
            if isinstance(value, float) and value > 0.0:
                plain, other = (
                    numbers_of(consist_of([one]), Settings(), None) for one in (row, row | {name: 0.99 * value})
                )
                assert not np.allclose(plain, other, rtol=1e-4, atol=1e-12), name
