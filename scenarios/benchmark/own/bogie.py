"""A bogie braked by shoes on its trailing wheelset: the brake cylinder, and its torque on the bogie of the thesis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from brake_controller.parameters import qr30
from products.building import units_of
from products.kernel_runs import AT_REST, play, prepare
from rbd_model.levels.models import recommend_level
from rbd_model.vehicle.parameters import tables_8_1_and_8_2

#: Time at which the brake is applied, and length of a run [s]; recording interval [s].
BEGIN, DURATION, INTERVAL = 1.0, 8.0, 0.005
OF_BRAKE, OF_BOGIE = ("cylinder_pressure", "shoe_force", "brake_torque"), ("speed", "locked_2")


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return share of pressure [1], shoe force [N], deceleration [m/s2], and the speed at lock [m/s] if it locks."""
    brake = replace(
        qr30(),
        application_time=inputs["application_time"],
        force_per_pressure=inputs["shoe_force_area"],
        shoes=inputs["braked_shoes"],
        wheelset_share=inputs["braked_shoes"] / inputs["shoes"],
        rigging_efficiency=inputs["rigging_efficiency"],
        constant_shoe_friction=inputs["shoe_friction"] * inputs["shoe_friction_factor"],
    ).values()
    demand = {
        "pressure_demand": [(0.0, 0.0), (BEGIN, 0.0), (BEGIN, inputs["pressure"]), (DURATION, inputs["pressure"])]
    }
    series = play("brake", prepare("brake", **brake), DURATION, INTERVAL, OF_BRAKE, demand)
    time = series["time"]
    reached = float(np.interp(BEGIN + inputs["application_time"], time, series["cylinder_pressure"]))
    found = {
        "pressure_share": reached / inputs["pressure"],
        "shoe_force": float(series["shoe_force"][-1]) / inputs["braked_shoes"],
    }
    return found | run_of(inputs, list(zip(time.tolist(), series["brake_torque"].tolist(), strict=True)))


def run_of(inputs: Mapping[str, Any], torque: list[tuple[float, float]]) -> dict[str, float]:
    """Return deceleration [m/s2] and speed at lock [m/s] of the bogie under a torque over time [N.m]."""
    own = tables_8_1_and_8_2().values() | {"rolling_resistance_torque": inputs["rolling_resistance_torque"]}
    names = units_of("bogie")
    values = {name: value for name, value in own.items() if name in names} | {
        "level": recommend_level(("brake_torque_2",), OF_BOGIE).level,
        "initial_speed": inputs["speed"],
        "friction_1": inputs["rail_friction"],
        "friction_2": inputs["rail_friction"],
    }
    series = play(
        "bogie", prepare("bogie", **values), DURATION, INTERVAL, OF_BOGIE, {"brake_torque_2": thinned(torque)}
    )
    time, speed = series["time"], series["speed"]
    locked = series.first_time((series["locked_2"] > 0.5) & (speed > AT_REST))
    end = locked if locked is not None else series.first_time(speed < AT_REST) or float(time[-1])
    window = (time > BEGIN + 2 * inputs["application_time"]) & (time < end)
    found = {} if locked is None else {"lock_speed": float(np.interp(locked, time, speed))}
    if window.sum() > 2:
        found["deceleration"] = -float(np.polyfit(time[window], speed[window], 1)[0])
    return found


def thinned(torque: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the corners of a history, twenty in a second."""
    return [*torque[:: round(0.05 / INTERVAL)], torque[-1]]
