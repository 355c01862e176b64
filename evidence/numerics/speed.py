"""Speed, measured when it runs: right-hand side, Jacobian, doStep, a stop, by level and kind; the start of Python."""

import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, plt, titled
from bogie_braking.reporting.report import Report, Row, measured
from bogie_braking.reporting.scenario import Options, Scenario
from bogie_braking.reporting.timing import LEVELS, REPEATS, least
from evidence.measuring import fmi_overhead, throughput, train_pace
from evidence.measuring.protected_throughput import environment_rows, protected_rows
from evidence.measuring.supervision_throughput import supervision_rows
from evidence.measuring.train_pace import train_rows
from fmu_src.compile import compiler
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.kernel import Kernel, Library
from products.building import kernel_of, up_to_date
from products.coach import AS_PUBLISHED, brakes
from products.sources import PREBUILT
from scenarios.bench.asymmetric_shoes import CASES, run_all

KINDS = ("native", "python")
#: The stop: 25 m/s, 20 kN.m on both wheelsets, 22.9 s of simulated time (at rest from 16.9 s on).
STOP_SECONDS, TORQUE = 22.9, 20e3
BOGIE_TORQUES = {"brake_torque_1": TORQUE, "brake_torque_2": TORQUE}
#: Brake torque on each wheelset of the complete vehicle, which gives the deceleration of the bogie [N.m].
VEHICLE_TORQUE = 8e3
HOST_STEP = 1e-3
#: Commands whose starting time is measured, and its target [s].
BEGINNINGS = {
    "import bogie_braking": (["-c", "import bogie_braking"], 0.3),
    "bogie-braking --help": (["-m", "bogie_braking", "--help"], 0.5),
}
#: Targets of the project; printed next to the measurement, never tested by the clock.
TARGETS = {"point": 400e3, "planar": 28e3, "spatial": 3600.0}
PYTHON_OVERHEAD_TARGET = 10.0


@dataclass(frozen=True)
class Extent:
    """Numbers of calls, of communication steps, and of runs of which the least time counts."""

    calls: int = 20000
    host_steps: int = 5000
    repeats: int = REPEATS


QUICK = Extent(1000, 500, 1)


@dataclass(frozen=True)
class CallTiming:
    """Times of one call [us], the least of several runs."""

    what: str
    level: str
    kind: str
    microseconds: float


def start_of(level: int) -> dict[str, float]:
    return {"level": level, "initial_speed": 25.0}


def kernel_timings(
    library: Library, level: int, extent: Extent, torques: Mapping[str, float] = BOGIE_TORQUES
) -> list[CallTiming]:
    name, calls = LEVELS[level], extent.calls
    kernel = Kernel(library, **start_of(level), **torques)
    kernel.advance(1.0)
    moving = kernel.save()

    def steps() -> None:
        kernel.restore(moving)
        kernel.repeat_step(HOST_STEP, extent.host_steps)

    right_hand_side = least(lambda: kernel.repeat_right_hand_side(calls), extent.repeats) / calls
    jacobian = least(lambda: kernel.repeat_jacobian(calls), extent.repeats) / calls
    return [
        CallTiming("right-hand side", name, "C", 1e6 * right_hand_side),
        CallTiming("Jacobian", name, "C", 1e6 * jacobian),
        CallTiming("doStep of 1 ms", name, "C", 1e6 * least(steps, extent.repeats) / extent.host_steps),
    ]


def vehicle_rows(extent: Extent) -> list[Row]:
    """Return the rows of the complete vehicle, in addition to the bogie: calls from C, and the stop in one call.

    As published, its body swings along the track undamped for the whole stop, which takes 1.6 times as many steps as
    with traction rods: both are shown.
    """
    library, rows = Library(kernel_of("vehicle")), []
    torques = brakes(VEHICLE_TORQUE)
    for level in (2, 3):
        for t in kernel_timings(library, level, extent, torques):
            what = f"complete vehicle: {t.what}, {t.level}, from C"
            rows.append(measured(what, "us", t.microseconds, "measured now, least of several runs"))
        for words, published in (("as published", AS_PUBLISHED), ("with traction rods", {})):
            values = start_of(level) | torques | published
            seconds = min(stop_time(library, values) for _ in range(extent.repeats))
            what = f"complete vehicle {words}: 22.9 s stop in one call, {LEVELS[level]}"
            rows.append(measured(what, "ms", 1e3 * seconds, "measured now, least of several runs"))
    return rows


def beginning_rows(repeats: int) -> list[Row]:
    """Return the time from the start of a new Python to the end of an import, or of the help."""
    rows = []
    for what, (arguments, most) in BEGINNINGS.items():
        command = [sys.executable, *arguments]
        seconds = least(partial(subprocess.run, command, check=True, stdout=subprocess.DEVNULL), repeats)
        source = f"measured now; to stay below {most}"
        rows.append(measured(f"{what}, with the start of Python", "s", seconds, source))
    return rows


def stop_time(library: Library, values: Mapping[str, float]) -> float:
    kernel = Kernel(library, **values)
    kernel.initialise()
    begin = time.perf_counter()
    kernel.advance(STOP_SECONDS)
    return time.perf_counter() - begin


def fmu_timings(kind: str, level: int, extent: Extent) -> list[CallTiming]:
    torques = {"brake_torque_1": TORQUE, "brake_torque_2": TORQUE}
    with FmuInstance(up_to_date("bogie", kind), **start_of(level)) as bogie:
        bogie.start(**torques)
        step = bogie.fmu.doStep

        def measure(size: float, count: int) -> float:
            best = np.inf
            for _ in range(extent.repeats + 1):
                bogie.restart(start_of(level), **torques)
                begin = time.perf_counter()
                for number in range(count):
                    step(number * size, size)
                best = min(best, time.perf_counter() - begin)
            return float(best)

        host = 1e6 * measure(HOST_STEP, extent.host_steps) / extent.host_steps
        stop = 1e6 * measure(STOP_SECONDS, 1)
    name = LEVELS[level]
    return [CallTiming("doStep of 1 ms", name, kind, host), CallTiming("22.9 s stop in one doStep", name, kind, stop)]


def rows_of_steps(timings: list[CallTiming]) -> list[Row]:
    """Return the times of steps, the speed of stops against real time, and the cost of Python."""
    rows = []
    for t in timings:
        what = f"{t.what}, {t.level}, {'from C' if t.kind == 'C' else t.kind + ' FMU through fmpy'}"
        rows.append(measured(what, "us", t.microseconds, "measured now, least of several runs"))
    found = {(t.what, t.level, t.kind): t.microseconds for t in timings}
    for name in LEVELS.values():
        for kind in KINDS:
            times = STOP_SECONDS * 1e6 / found["22.9 s stop in one doStep", name, kind]
            what = f"times real time, 22.9 s stop, {name}, {kind} FMU"
            aim = f"measured now; to reach {TARGETS[name]:.0f}" if kind == "native" else "measured now"
            rows.append(measured(what, "1", times, aim))
        extra = found["doStep of 1 ms", name, "python"] - found["doStep of 1 ms", name, "native"]
        what = f"doStep of 1 ms, {name}: pythonfmu beyond native"
        aim = f"measured now; to stay below {PYTHON_OVERHEAD_TARGET:.0f}"
        rows.append(measured(what, "us", extra, aim))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    kernel = kernel_of("bogie")
    library = Library(kernel)
    extent = QUICK if quick else Extent()
    timings = [timing for level in LEVELS for timing in kernel_timings(library, level, extent)]
    timings += [timing for level in LEVELS for kind in KINDS for timing in fmu_timings(kind, level, extent)]
    rows = rows_of_steps(timings)
    rows += vehicle_rows(extent)
    rows += throughput.batch_rows(quick) + throughput.control_rows(quick)
    rows += protected_rows(quick) + environment_rows(quick)
    rows += train_rows(train_pace.QUICK if quick else train_pace.TrainExtent()) + supervision_rows(quick)
    rows += beginning_rows(extent.repeats)
    rows += fmi_overhead.rows(library)
    begin = time.perf_counter()
    cases = len(run_all(CASES[:1] if quick else CASES))
    seconds = time.perf_counter() - begin
    rows.append(measured(f"chapter 9, {cases} cases with recording", "s", seconds, "measured now, once"))
    stops = {level: stop_of(library, level) for level in LEVELS}
    series = Recording({"time": "s"}, [[t] for t in stops[1]["time"]])
    for level, name in LEVELS.items():
        series.add(f"speed_{name}", "m/s", np.array(stops[level]["speed"]))
    compiled_by = "a release's, zig" if kernel.is_relative_to(PREBUILT) else " ".join(compiler()[-3:])
    remark = f"Compiler: {compiled_by}. Machines are noisy: compare within one run only."
    parameters: dict[str, object] = {
        "brake_torque": TORQUE,
        "initial_speed": 25.0,
        "host_step": HOST_STEP,
        "runs": extent.repeats,
    }
    return Report(rows, series, lambda: draw(timings), parameters, 0.0, [remark])


def stop_of(library: Library, level: int) -> dict[str, list[float]]:
    kernel = Kernel(library, **start_of(level), brake_torque_1=TORQUE, brake_torque_2=TORQUE)
    return kernel.record(STOP_SECONDS, 0.1, ["speed"])


def draw(timings: list[CallTiming]) -> Figure:
    figure, axis = plt.subplots(figsize=(8.0, 4.6))
    labels = [f"{t.what}, {t.kind if t.kind == 'C' else t.kind + ' FMU'}, {t.level}" for t in timings]
    colours = [dict(zip(LEVELS.values(), (LEADING, TRAILING, BOGIE), strict=True))[t.level] for t in timings]
    values = [t.microseconds for t in timings]
    places = np.arange(len(values))[::-1]
    axis.barh(places, values, color=colours)
    axis.set_yticks(places, labels, fontsize=8)
    axis.set_xscale("log")
    axis.set_xlim(right=4 * max(values))
    axis.set_xlabel("time of one call [us]")
    axis.grid(axis="y", visible=False)
    for place, value in zip(places, values, strict=True):
        axis.annotate(f"{value:.4g}", (value, place), xytext=(3, -3), textcoords="offset points", fontsize=8)
    [step] = [t.microseconds for t in timings if (t.what, t.level, t.kind) == ("doStep of 1 ms", "spatial", "native")]
    return titled(figure, f"A native spatial FMU computes 1 ms in {step:.0f} us")


SCENARIO = Scenario(
    "speed",
    "Microseconds per call and times real time, for each level and FMU kind",
    run,
)
