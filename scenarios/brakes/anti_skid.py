"""Wheel-slide protection on dry, wet, low and changing rail: without, with locked wheels, protected, and the ideal."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from multiprocessing import get_context

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from tqdm import tqdm

from brake_controller.wheel_slide import SlideProtection, WheelSlideController
from rbd_model.adhesion import low
from rbd_model.parameters import tables_5_1_and_5_2
from scenarios.bench.braked_machine import APPLICATION_TIME, BrakedMachine, bogie
from scenarios.bench.peak_adhesion import PeakAdhesion
from scenarios.bench.protected_stop import ProtectedStop, Settings, protected_stop
from scenarios.bench.rails import (
    ABOVE,
    BAND,
    LOCK_ABOVE,
    LONGEST_LOCK,
    LOW_FRICTION,
    OVER_IDEAL,
    RAILS,
    SHARE,
    RailCase,
    low_rail,
)
from scenarios.reporting.plots import BOGIE, LEADING, THESIS, TRAILING, plt, titled
from scenarios.reporting.progress import PATIENCE
from scenarios.reporting.report import Result, Row, at_least, at_most, between
from scenarios.scenario import Options, Scenario, Sweepable

#: Controller periods and host steps on which the low rail is tried again [s].
PERIODS, HOST_STEPS = (2e-3, 5e-3, 1e-2, 2e-2), (1e-3, 5e-3, 1e-2)
#: Runs of the measurement of speed.
COUNTED = 24


#: What stands between wheels and valves; "locked" brakes with full force at once.
MODES: dict[str, Callable[[], WheelSlideController] | None] = {
    "unprotected": None,
    "locked": None,
    "protected": SlideProtection,
}


@dataclass(frozen=True)
class Findings:
    """Stops by rail and mode, ideal distances by rail [m], and low-rail stops by (period, host step)."""

    stops: dict[tuple[str, str], ProtectedStop]
    ideal: dict[str, float]
    low: dict[tuple[float, float], ProtectedStop]
    stops_per_minute: float


def measure() -> Findings:
    stops: dict[tuple[str, str], ProtectedStop] = {}
    low_stops: dict[tuple[float, float], ProtectedStop] = {}
    work = [(rail, mode) for rail in RAILS for mode in MODES]
    tries = [(period, step) for period in PERIODS for step in HOST_STEPS if step <= period]
    with (
        BrakedMachine() as machine,
        tqdm(total=len(work) + len(tries), delay=PATIENCE, leave=False, unit="stop") as bar,
    ):
        for rail, mode in work:
            stops[rail.name, mode] = one_stop(machine, rail, mode, Settings())
            bar.update()
        for period, step in tries:
            low_stops[period, step] = one_stop(machine, RAILS[2], "protected", Settings(period=period, host_step=step))
            bar.update()
    ideal = {rail.name: PeakAdhesion(bogie(), rail.values()).stopping_distance(Settings().speed) for rail in RAILS}
    return Findings(stops, ideal, low_stops, stops_per_minute())


def one_stop(machine: BrakedMachine, rail: RailCase, mode: str, settings: Settings) -> ProtectedStop:
    """A stop in one of the MODES; locked wheels are those of a brake three times as strong that applies at once."""
    make = MODES[mode]
    if mode == "locked":
        settings = replace(settings, application_time=0.1, strength=3.0)
    return protected_stop(machine, rail.values(), make() if make else None, settings)


def stops_per_minute(workers: int = 2) -> float:
    """Protected stops on the low rail that two processes finish in a minute through fmpy, their start not counted."""
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        list(pool.map(count_stops, [1] * workers))  # the processes start, and the FMUs are unpacked once
        begin = clock.perf_counter()
        list(pool.map(count_stops, [COUNTED // workers] * workers))
        return 60.0 * COUNTED / (clock.perf_counter() - begin)


def count_stops(count: int) -> int:
    """Protected stops on the low rail, in a process of their own."""
    with BrakedMachine() as machine:
        for _ in range(count):
            one_stop(machine, RAILS[2], "protected", Settings())
    return count


# ---- the table -------------------------------------------------------------------------------------------------------


def rows_of(found: Findings) -> list[Row]:
    rows = []
    source = "planar bogie, 25 m/s, full service"
    for rail in RAILS:
        verified = "" if rail.condition.verified else "friction falls as in an unverified set"
        rows.append(
            Row(f"{rail.name}: ideal stopping distance", "m", None, found.ideal[rail.name], None, source, verified)
        )
        for mode in MODES:
            stop = found.stops[rail.name, mode]
            name = f"{rail.name}, {mode}"
            rows += [
                Row(f"{name}: stopping distance", "m", None, stop.distance, None, source),
                Row(f"{name}: longest lock", "s", None, stop.longest_lock(LOCK_ABOVE), None, f"above {LOCK_ABOVE} m/s"),
                Row(f"{name}: share in the slip band", "1", None, stop.share_in_band(BAND, ABOVE), None, "up to 0.3"),
                Row(f"{name}: adhesion used", "1", None, found.ideal[rail.name] / stop.distance, None, "ideal over it"),
                Row(f"{name}: air", "g", None, 1e3 * stop.air(), None, "both cylinders"),
            ]
    return rows + low_rows(found)


def low_rows(found: Findings) -> list[Row]:
    """What is asked of the protection on the low rail, at all periods and host steps."""
    stops, ideal = list(found.low.values()), found.ideal["low"]
    locked = found.stops["low", "locked"].distance
    lock = max(stop.longest_lock(LOCK_ABOVE) for stop in stops)
    share = min(stop.share_in_band(BAND, ABOVE) for stop in stops)
    distance = max(stop.distance for stop in stops)
    words = "worst of controller periods 2-20 ms and host steps 1-10 ms"
    return [
        Row("low: longest lock of all", "s", None, lock, at_most(LONGEST_LOCK), words),
        Row("low: least share in the slip band", "1", None, share, at_least(SHARE), words),
        Row("low: longest distance over the ideal", "1", None, distance / ideal, between(1.0, OVER_IDEAL), words),
        Row("low: longest distance over that of locked wheels", "1", None, distance / locked, at_most(1.0), words),
        Row(
            "protected stops in a minute, two processes",
            "1",
            None,
            found.stops_per_minute,
            None,
            "measured now; to reach 200, 5 ms controller period",
        ),
    ]


def run(options: Options) -> Result:
    found = measure()
    rows = rows_of(found)
    failures = [f"{rail}, {mode}: {stop.failure}" for (rail, mode), stop in found.stops.items() if stop.failure]
    remarks = [
        "Measures in the manner of EN 15595 (stopping distance, slip, lock, air), without any claim of conformity. "
        "Ideal: the best slip at every instant, as the brake fills. Sets for low adhesion are unverified. Locked "
        "wheels are those of a brake three times as strong, which is why they stop shorter on a dry rail.",
        *failures,
    ]
    series = found.stops["low", "protected"].series
    seconds = sum(stop.time for stop in (*found.stops.values(), *found.low.values()))
    parameters = tables_5_1_and_5_2().values() | {"rails": {rail.name: rail.values() for rail in RAILS}}
    return Result(rows, series, lambda: draw(found), parameters, seconds, remarks)


# ---- the picture -----------------------------------------------------------------------------------------------------


def draw(found: Findings) -> Figure:
    figure, grid = plt.subplots(3, 2, figsize=(11.0, 10.0))
    for axis, rail in zip((grid[0, 0], grid[0, 1]), ("low", "changing"), strict=True):
        series = found.stops[rail, "protected"].series
        axis.plot(series["time"], series["speed"], color=BOGIE, label="bogie")
        axis.plot(series["time"], series["wheel_speed_1"], color=LEADING, linewidth=0.9, label="leading wheels")
        axis.plot(series["time"], series["wheel_speed_2"], color=TRAILING, linewidth=0.9, label="trailing wheels")
        axis.set_title(f"{rail} rail, protected: speeds [m/s] over time [s]")
    grid[0, 0].legend(fontsize=8)
    series = found.stops["low", "protected"].series
    for number, colour in ((1, LEADING), (2, TRAILING)):
        grid[1, 0].plot(series["time"], 1e-3 * series[f"pressure_{number}"], color=colour, linewidth=0.9)
        slip = found.stops["low", "protected"].slip(number)
        grid[1, 1].plot(series["time"], 100.0 * slip, color=colour, linewidth=0.9)
    grid[1, 0].set_title("low rail, protected: cylinder pressures [kPa] over time [s]")
    grid[1, 1].set_title("low rail, protected: slip [%] over time [s]")
    grid[1, 1].set_ylim(-1.0, 30.0)
    draw_distances(found, grid[2, 0])
    draw_periods(found, grid[2, 1])
    return titled(figure, "Wheel-slide protection: full service from 25 m/s")


def draw_distances(found: Findings, axis: Axes) -> None:
    colours = dict(zip(MODES, (TRAILING, "#999999", LEADING), strict=True))
    places = np.arange(len(RAILS))
    for offset, (mode, colour) in enumerate(colours.items()):
        values = [found.stops[rail.name, mode].distance for rail in RAILS]
        axis.bar(places + 0.2 * (offset - 1.5), values, 0.19, color=colour, label=mode)
    axis.bar(places + 0.3, [found.ideal[rail.name] for rail in RAILS], 0.19, color=THESIS, label="ideal")
    axis.set_xticks(places, [rail.name for rail in RAILS])
    axis.set_title("stopping distance [m]")
    axis.legend(fontsize=8)


def draw_periods(found: Findings, axis: Axes) -> None:
    for step, marker in zip(HOST_STEPS, "os^", strict=False):
        chosen = [(1e3 * period, stop.distance) for (period, size), stop in found.low.items() if size == step]
        axis.plot(*np.reshape(chosen, (-1, 2)).T, marker, color=LEADING, label=f"host step {1e3 * step:g} ms")
    axis.axhline(found.ideal["low"], color=THESIS, label="ideal")
    axis.axhline(OVER_IDEAL * found.ideal["low"], color=THESIS, linestyle=":", label="15 % beyond it")
    axis.set_ylim(bottom=0.95 * found.ideal["low"])
    axis.set_xlabel("controller period [ms]")
    axis.set_title("low rail: stopping distance [m] over the controller's period")
    axis.legend(fontsize=8)


# ---- sweeps ---------------------------------------------------------------------------------------------------------


@lru_cache
def own_machine() -> BrakedMachine:
    """The FMUs of this process, kept between the points of a sweep."""
    return BrakedMachine()


def one_point(
    friction: float = LOW_FRICTION,
    application_time: float = APPLICATION_TIME,
    initial_speed: float = 25.0,
    protected: float = 1.0,
    period: float = 5e-3,
    friction_ratio: float = low().law.friction_ratio,
    friction_decay: float = low().law.friction_decay,
) -> dict[str, float | None]:
    """One stop on a rail with the fall of the low set unless given; `protected` 0: without a controller."""
    condition = low_rail()
    law = replace(condition.law, friction_ratio=friction_ratio, friction_decay=friction_decay)
    rail = replace(condition, friction=friction, law=law).values()
    settings = Settings(
        speed=initial_speed, application_time=application_time, period=period, host_step=min(period, 5e-3)
    )
    stop = protected_stop(own_machine(), rail, SlideProtection() if protected else None, settings)
    return {
        "stop_distance": stop.distance,
        "stop_time": stop.time,
        "longest_lock": stop.longest_lock(LOCK_ABOVE),
        "share_in_band": stop.share_in_band(BAND, ABOVE),
        "air": stop.air(),
    }


SWEEP = Sweepable(
    {
        "friction": "1",
        "application_time": "s",
        "initial_speed": "m/s",
        "protected": "1",
        "period": "s",
        "friction_ratio": "1",
        "friction_decay": "s/m",
    },
    {"stop_distance": "m", "stop_time": "s", "longest_lock": "s", "share_in_band": "1", "air": "kg"},
    one_point,
)
SCENARIO = Scenario(
    "anti-skid", "Wheel-slide protection on four rails, against locked wheels and the ideal", run, frozenset(), SWEEP
)
