"""How many stops, and control steps, a machine makes in a second, and how exact each is: one instance, and batches."""

from __future__ import annotations

import os
import time as clock
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from brake_controller.cylinder import timed_brake
from brake_controller.parameters import qr30
from fmu_src.batch import BatchLibrary, Instances, library_of_batch, run_batch
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import Model, model_of
from products.bogie import BOGIE
from products.braked_vehicle import with_brakes
from products.registry import model_of as model_of_fmu
from rbd_model.levels.models import levels
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.methods import sundials
from scenarios.methods.integrators import own, scipy
from scenarios.methods.scenes import SMOOTH, Scene
from scenarios.methods.work_precision import difference, reference_of, repeated
from scenarios.reporting.plots import BOGIE as BLUE
from scenarios.reporting.plots import LEADING, TRAILING, plt, titled
from scenarios.reporting.report import Row

#: Stops by level: systems, runs that are measured, and how many shall take so many seconds on two processors.
STOPS = {"point": ("point", 1, 8000, 10**6, 12.0), "planar": ("planar", 2, 1600, 10**5, 15.0)}
STOPS |= {"spatial": ("spatial_patches", 3, 128, 10**4, 15.0)}
#: The stop of `speed`: speeds [m/s] and torques [N.m] are spread, so that no two runs make the same steps.
SPEEDS, TORQUES, STOP = (20.0, 30.0), (18e3, 22e3), 22.9
#: Planar bogies with two cylinders under a controller that vents a wheel above the first slip and applies it below the
#: second: control step [s], instances, steps; and how many control steps a second are wanted on two processors.
CONTROL_STEP, MANY, CONTROL_STEPS, WANTED = 5e-3, 1024, 200, 2.5e6
VENT_ABOVE, APPLY_BELOW, APPLY, VENT, PRESSURE = 0.08, 0.03, 0.0, 2.0, 380e3
TOLERANCES, FIXED = (1e-3, 1e-4, 1e-6, 1e-8), (1e-2, 2e-3)


def stops_of(count: int) -> dict[str, np.ndarray]:
    """Values of so many stops."""
    torque = np.linspace(*TORQUES, count)
    return {"initial_speed": np.linspace(*SPEEDS, count), "brake_torque_1": torque, "brake_torque_2": torque}


def batch_rows() -> list[Row]:
    """Stops in batches, extended from those that were measured to the number that is judged."""
    rows = []
    for level, (system, number, measured, asked, most) in STOPS.items():
        library = library_of_batch(model_of_fmu("bogie"), system)
        values = {"level": number} | stops_of(measured)
        seconds = min(_seconds_of(library, values, STOP) for _ in range(3)) / measured
        source = f"measured now on {measured} runs, {library.lanes} lanes, {os.cpu_count()} threads; at most {most:g}"
        rows.append(Row(f"{asked:.0e} stops, {level}, in a batch", "s", None, seconds * asked, None, source))
    return rows


def _seconds_of(library: BatchLibrary, values: Mapping[str, ArrayLike], stop: float) -> float:
    begin = clock.perf_counter()
    run_batch(library, values, stop, ["speed"])
    return clock.perf_counter() - begin


def braked_bogie() -> Model:
    """The planar bogie with a cylinder on each wheelset, one composed model."""
    planar = next(one for one in levels(two_axle_bogie(BOGIE)) if one.name == "planar")
    return model_of(with_brakes(planar, two_axle_bogie(BOGIE), lambda: timed_brake(qr30())), 1e-6)


def controlled(model: Model, count: int, steps: int, values: Mapping[str, float]) -> tuple[float, np.ndarray]:
    """Wall time [s] of so many control steps of so many instances, and the distances that they went [m]."""
    inputs = [f"{name}_{number}" for name in ("pressure_demand", "valve") for number in (1, 2)]
    outputs = ["speed", "distance", "wheel_speed_1", "wheel_speed_2"]
    given = dict.fromkeys(inputs[:2], PRESSURE) | {name: np.full(count, APPLY) for name in inputs[2:]}
    library = library_of_batch(model, model.systems[0].name)
    speeds = np.linspace(*SPEEDS, count)
    start: dict[str, Any] = {"initial_speed": speeds, **values}
    with Instances(library, count, inputs, outputs, **start) as instances:
        begin = clock.perf_counter()
        for _ in range(steps):
            found = instances.step(CONTROL_STEP, given)
            for number in (1, 2):
                slip = 1 - found[f"wheel_speed_{number}"] / np.maximum(found["speed"], 1.0)
                valve = given[f"valve_{number}"]
                given[f"valve_{number}"] = np.where(slip > VENT_ABOVE, VENT, np.where(slip < APPLY_BELOW, APPLY, valve))
        return clock.perf_counter() - begin, found["distance"].copy()


def control_rows() -> list[Row]:
    """Control steps a second, and how far the stops are then from those of the default."""
    model, rows = braked_bogie(), []
    exact = controlled(model, 32, CONTROL_STEPS, {})[1]
    for substeps in (1, 2):
        fixed = {"integration_method": 2, "integration_step": CONTROL_STEP / substeps}
        rate = MANY * CONTROL_STEPS / min(controlled(model, MANY, CONTROL_STEPS, fixed)[0] for _ in range(3))
        off = np.abs(controlled(model, 32, CONTROL_STEPS, fixed)[1] - exact).max()
        words = f"two cylinders, planar bogie, controller of arrays, {1e3 * CONTROL_STEP / substeps:g} ms steps"
        source = "measured now" + (f"; to reach {WANTED:g}" if substeps == 1 else "")
        rows.append(Row(f"control steps of 5 ms a second: {words}", "1/s", None, rate, None, source))
        rows.append(Row("the same: distance after 1 s, off the default's", "m", None, float(off), None, "measured now"))
    return rows


# ---- error against throughput ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rate:
    """A way at a setting: relative error, and stops a second of the whole machine."""

    level: str
    way: str
    setting: float
    error: float
    stops: float


def scenes() -> dict[str, tuple[Scene, dict[str, float], str, bool]]:
    """By level: the smooth stop, what chooses the level, its system, and whether states are those of the axles."""
    return {
        "planar": (SMOOTH, {"level": 2}, "planar", True),
        "spatial": (replace(SMOOTH, values={"contact_depth": 2}), {"contact_depth": 2}, "spatial_patches", False),
    }


def rates(short: bool = False) -> Iterator[Rate]:
    """Of one instance and of batches; of others in space one run times the processors, as if a process cost nothing."""
    processors = os.cpu_count() or 1
    for level, (scene, chosen, system, at_axles) in scenes().items():
        if at_axles:
            exact = scene.measure(own(scene, True, **chosen, tolerance=1e-10, integration_method=2).samples)
        else:
            exact = scene.measure(reference_of(scene)[0].samples)
        settings = [("tolerance", value, {"tolerance": value}) for value in TOLERANCES[2:3] if short] or [
            *(("tolerance", value, {"tolerance": value}) for value in TOLERANCES),
            *(("fixed step", value, {"integration_method": 2, "integration_step": value}) for value in FIXED),
        ]
        for way, setting, values in settings:
            run = own(scene, at_axles, **chosen, **values)
            if run.failure:
                continue
            error = difference(scene.measure(run.samples), exact)
            yield Rate(level, f"one instance, {way}", setting, error, 1 / _alone(scene, chosen | values))
            yield Rate(level, f"batch, {way}", setting, error, _together(scene, system, chosen | values, short))
        for name in () if at_axles or short else ("CVODE", "Radau (SciPy)"):
            for tolerance in (1e-3, 1e-6) if name != "CVODE" or sundials.is_installed() else ():
                run = repeated(
                    partial(sundials.sundials, scene, name, tolerance)
                    if name == "CVODE"
                    else partial(scipy, scene, "Radau", tolerance)
                )
                if not run.failure:
                    error = difference(scene.measure(run.samples), exact)
                    yield Rate(level, name, tolerance, error, processors / run.seconds)


def _alone(scene: Scene, values: dict[str, float]) -> float:
    """Seconds of one run without samples, the least of three."""
    library, best = Library(build_library(model_of_fmu(scene.fmu))), np.inf
    for _ in range(3):
        kernel = Kernel(library, **(scene.parameters | values), **{n: h[0][1] for n, h in scene.inputs.items()})
        kernel.initialise()
        begin = clock.perf_counter()
        kernel.step(0.0, scene.duration)
        best = min(best, clock.perf_counter() - begin)
    return float(best)


def _together(scene: Scene, system: str, values: dict[str, float], short: bool) -> float:
    """Runs a second of a batch that is spread a little, the most of two."""
    library = library_of_batch(model_of_fmu(scene.fmu), system)
    count = library.lanes * (os.cpu_count() or 1) * (1 if short else 16 if system == "planar" else 4)
    torque = scene.inputs["brake_torque_1"][0][1] * np.linspace(0.99, 1.01, count)
    given: dict[str, ArrayLike] = {**scene.parameters, **values, "brake_torque_1": torque, "brake_torque_2": torque}
    return count / min(_seconds_of(library, given, scene.duration) for _ in range(1 if short else 2))


STYLE = {
    "one instance, tolerance": (BLUE, "o", "-"),
    "batch, tolerance": (LEADING, "s", "-"),
    "one instance, fixed step": (BLUE, "o", ":"),
    "batch, fixed step": (LEADING, "s", ":"),
    "CVODE": (TRAILING, "^", "--"),
    "Radau (SciPy)": ("#777777", "v", "--"),
}


def draw(found: Sequence[Rate]) -> Figure:
    """Error against stops a second; a panel for each level."""
    every = list(dict.fromkeys(one.level for one in found))
    figure, grid = plt.subplots(1, len(every), figsize=(11.0, 4.8), sharey=True, squeeze=False)
    for axis, level in zip(grid.ravel(), every, strict=True):
        for way, (colour, marker, line) in STYLE.items():
            points = sorted((one for one in found if (one.level, one.way) == (level, way)), key=lambda one: one.setting)
            if points:
                x, y = [one.stops for one in points], [max(one.error, 1e-11) for one in points]
                axis.plot(x, y, line, marker=marker, color=colour, label=way)
        axis.set(xscale="log", yscale="log", xlabel="stops a second", title=f"bogie, {level}")
    grid[0, 0].set_ylabel("relative error of distance and time")
    handles, names = grid[0, -1].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3, fontsize=9)
    return titled(
        figure, "A batch makes many times the stops of one instance with the same error; lower right is better"
    )
