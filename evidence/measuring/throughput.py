"""Stops and control steps a second in batches, for the rows of `speed`."""

from __future__ import annotations

import os
import time as clock
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bogie_braking.reporting.report import Row, measured
from fmu_src.batch import BatchLibrary, Instances, library_of_batch, run_batch
from fmu_src.system import Model, model_of
from products.machine import FULL_PRESSURE, bogie, composed
from products.registry import model_of as model_of_fmu
from rbd_model.levels.models import DEFAULT_TOLERANCE, places_of, system_at

#: Stops by level: system, level, number of measured runs, target number of stops, and their time limit on two
#: processors [s].
STOPS = {"point": ("point", 1, 20000, 10**6, 12.0), "planar": ("planar", 2, 4000, 10**5, 15.0)}
STOPS |= {"spatial": ("spatial_patches", 3, 256, 10**4, 15.0)}
#: The stop of `speed`, with different speeds [m/s] and torques [N.m], so that no two runs make the same steps.
SPEEDS, TORQUES, STOP = (20.0, 30.0), (18e3, 22e3), 22.9
#: Planar bogies with two cylinders under a controller. It vents a wheel above the first slip and applies it below the
#: second. Control step [s], instances, steps; and target of control steps a second on two processors.
CONTROL_STEP, MANY, CONTROL_STEPS, WANTED = 5e-3, 1024, 1000, 2.5e6
VENT_ABOVE, APPLY_BELOW, APPLY, VENT = 0.08, 0.03, 0.0, 2.0
#: Frictions and simulated times to rest [s]: at the first all wheels roll, at the second the controller vents and
#: applies again; those of a quick run. Number of compared stops.
RAILS, QUICK_RAILS, COMPARED = {0.3: 35.0, 0.08: 60.0}, {0.3: 2.0}, 16
#: Stops, and instances under a controller, of a quick run.
QUICK = 64


def stops_of(count: int) -> dict[str, np.ndarray]:
    """Return the values of `count` stops."""
    torque = np.linspace(*TORQUES, count)
    return {"initial_speed": np.linspace(*SPEEDS, count), "brake_torque_1": torque, "brake_torque_2": torque}


def batch_rows(quick: bool = False) -> list[Row]:
    """Return the time of stops in batches, extrapolated from the measured number to the target number."""
    rows = []
    for level, (system, number, many, asked, most) in STOPS.items():
        count = QUICK if quick else many
        library = library_of_batch(model_of_fmu("bogie"), system)
        values = {"level": number} | stops_of(count)
        seconds = min(_seconds_of(library, values, STOP) for _ in range(3)) / count
        source = f"measured now on {count} runs, {library.lanes} lanes, {os.cpu_count()} threads; at most {most:g}"
        rows.append(measured(f"{asked:.0e} stops, {level}, in a batch", "s", seconds * asked, source))
    return rows


def _seconds_of(library: BatchLibrary, values: Mapping[str, ArrayLike], stop: float) -> float:
    begin = clock.perf_counter()
    run_batch(library, values, stop, ["speed"])
    return clock.perf_counter() - begin


def braked_bogie() -> Model:
    """Return the planar bogie with a cylinder on each wheelset, one composed model."""
    [planar] = places_of(level=2, on_line=False)
    return model_of(composed(bogie(), system_at(bogie().vehicle, planar)), DEFAULT_TOLERANCE)


def valves_of(found: Mapping[str, np.ndarray], number: int, held: np.ndarray) -> np.ndarray:
    """Return the valves of a wheelset of all bogies by its slip; held: those of the period before, for slips in
    between.
    """
    slip = 1 - found[f"wheel_speed_{number}"] / np.maximum(found["speed"], 1.0)
    return np.where(slip > VENT_ABOVE, VENT, np.where(slip < APPLY_BELOW, APPLY, held))


def controlled(
    model: Model, count: int, steps: int, friction: float, values: Mapping[str, float]
) -> tuple[float, np.ndarray]:
    """Run many bogies under the controller.

    Returns [s].
    """
    inputs = [f"{name}_{number}" for name in ("pressure_demand", "valve") for number in (1, 2)]
    outputs = ["speed", "distance", "wheel_speed_1", "wheel_speed_2"]
    given: dict[str, Any] = dict.fromkeys(inputs[:2], FULL_PRESSURE) | {
        name: np.full(count, APPLY) for name in inputs[2:]
    }
    library = library_of_batch(model, model.systems[0].name)
    start: dict[str, Any] = {"initial_speed": np.linspace(*SPEEDS, count), **values}
    start |= {"friction_1": friction, "friction_2": friction}
    with Instances(library, count, inputs, outputs, **start) as instances:
        begin = clock.perf_counter()
        for _ in range(steps):
            found = instances.step(CONTROL_STEP, given)
            for number in (1, 2):
                given[f"valve_{number}"] = valves_of(found, number, given[f"valve_{number}"])
        return clock.perf_counter() - begin, found["distance"].copy()


def control_rows(quick: bool = False) -> list[Row]:
    """Return control steps a second, and the error of the final distances against the default, at both frictions."""
    model, rows, many = braked_bogie(), [], QUICK if quick else MANY
    for friction, seconds in (QUICK_RAILS if quick else RAILS).items():
        periods = round(seconds / CONTROL_STEP)
        exact = controlled(model, COMPARED, periods, friction, {})[1]
        for substeps in (1, 2):
            fixed = {"integration_method": 2, "integration_step": CONTROL_STEP / substeps}
            least = min(controlled(model, many, CONTROL_STEPS, friction, fixed)[0] for _ in range(3))
            off = np.abs(controlled(model, COMPARED, periods, friction, fixed)[1] - exact).max()
            words = f"planar bogie, two cylinders, friction {friction:g}, {1e3 * CONTROL_STEP / substeps:g} ms steps"
            aim = "measured now" + (f"; to reach {WANTED:g}" if substeps == 1 else "")
            rate = many * CONTROL_STEPS / least
            rows.append(measured(f"control steps of 5 ms a second: {words}", "1/s", rate, aim))
            what = f"distance of the stop off the default's: {words}"
            source = f"the largest of {COMPARED} stops of {exact.min():.0f} to {exact.max():.0f} m"
            rows.append(measured(what, "m", float(off), source))
    return rows
