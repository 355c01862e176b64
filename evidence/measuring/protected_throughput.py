"""Protected stops a minute by the form of the controller, and control steps a second of learning environments."""

from __future__ import annotations

import tempfile
import time as clock
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bogie_braking.reporting.report import Row, measured
from bogie_braking.reporting.timing import least
from products.controller_kinds import Arrays, Form, compiled
from products.machine import bogie
from products.protection.draws import drawn_run
from products.protection.environment import Environment
from products.protection.rig import Rig
from products.protection.settings import Settings
from products.study.points import process_pool
from rbd_model.track.friction import low

#: Share of the fastest wheel's speed below which every form vents: a trivial controller.
SHARE = 0.8
#: Number of measured stops by form, that of a quick run, and target of stops a minute.
QUICK, COUNTED = 4, {"C": (512, 1e4), "arrays": (1024, 1e4), "class, two processes": (32, 1500.0)}
#: Rows, measured turns, those of a quick run, and the target of steps a second. Single environments of electric motors
#: make 1100 to 3100 steps a second (gym-electric-motor, published).
MEASURED = {"one row": (1, 4000, 100, 2e4), "1024 rows": (1024, 500, 100, 1e6)}
#: Range of the frictions, so that no two stops are the same.
SPREAD = 0.01
#: Length of a fixed step [s], that of a period.
STEP = Settings().period

SOURCE = """#include "wheel_slide.h"
size_t wheel_slide_size(int wheelsets) { (void)wheelsets; return sizeof(int); }
void wheel_slide_start(void *memory, int wheelsets, double period) { *(int *)memory = wheelsets; (void)period; }
void wheel_slide_step(void *memory, double time, const double *speed, int *valve)
{
    double fastest = 0.0;
    (void)time;
    for (int i = 0; i < *(int *)memory; ++i) fastest = speed[i] > fastest ? speed[i] : fastest;
    for (int i = 0; i < *(int *)memory; ++i)
        valve[i] = speed[i] < SHARE * fastest ? WHEEL_SLIDE_VENT : WHEEL_SLIDE_APPLY;
}
"""


class LetGo:
    """The controller as a class."""

    def step(self, time: float, speeds: Sequence[float]) -> list[int]:
        """Return the valves of all wheelsets."""
        return [2 if speed < SHARE * max(speeds) else 0 for speed in speeds]


class LetAllGo:
    """The controller as a function of arrays."""

    def start(self, rows: NDArray[np.intp], count: int, wheelsets: int, period: float) -> None:
        """Start without a state."""

    def step(self, time: NDArray[np.float64], speeds: NDArray[np.float64]) -> NDArray[np.integer]:
        """Return the valves of all vehicles."""
        return np.where(speeds < SHARE * speeds.max(axis=1, keepdims=True), 2, 0)


def in_c() -> Form:
    """Return the controller in C."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "let_go.c"
        path.write_text(f"#define SHARE {SHARE}\n{SOURCE}")
        return compiled(path)


def protected(form: Form, count: int, step: float) -> list[float]:
    """Return the distances of `count` stops on low rails [m]."""
    rails = [
        low().values() | {"friction_1": mu, "friction_2": mu}
        for mu in np.linspace(low().friction, low().friction + SPREAD, count).tolist()
    ]
    found = Rig(bogie(), form, Settings(), step=step).stops(rails)
    return [one.distance or np.nan for one in found]


def _by_class(count: int) -> list[float]:
    return protected(LetGo, count, STEP)


def seconds_of(name: str, count: int) -> tuple[float, list[float]]:
    """Return the wall time of `count` stops [s], and their distances [m]."""
    if name.startswith("class"):
        with process_pool(2) as pool:
            list(pool.map(_by_class, [1, 1]))
            begin = clock.perf_counter()
            found = list(pool.map(_by_class, [count // 2] * 2))
            return clock.perf_counter() - begin, found[0]
    form = in_c() if name == "C" else Arrays(LetAllGo())
    protected(form, 1, STEP)
    begin = clock.perf_counter()
    distances = protected(form, count, STEP)
    return clock.perf_counter() - begin, distances


def protected_rows(quick: bool = False) -> list[Row]:
    """Return stops a minute by form, and the difference between fixed steps and error control."""
    rows, exact = [], np.array(protected(in_c(), 16, 0.0))
    off = np.abs(np.array(protected(in_c(), 16, STEP)) - exact).max()
    for name, (many, wanted) in COUNTED.items():
        count = QUICK if quick else many
        seconds, _ = seconds_of(name, count)
        what = f"protected stops a minute, planar bogie, low rail, steps of 5 ms: {name}"
        rows.append(measured(what, "1", 60.0 * count / seconds, f"measured now; to reach {wanted:g}"))
    source = f"largest of 16 stops of {exact.min():.0f} to {exact.max():.0f} m"
    return [
        *rows,
        measured("protected stops with steps of 5 ms: off those by the error", "m", float(off), source),
    ]


def steps_a_second(rows: int, turns: int, repeats: int) -> float:
    """Return the largest of several rates [1/s], with observations, rewards and an array controller in NumPy."""
    environment = Environment(bogie(), Settings(), rows, drawn_run)
    environment.begin(range(rows), [np.random.default_rng(row) for row in range(rows)])

    def turns_of_all() -> None:
        for _ in range(turns):
            speeds = environment.observation[:, :2]
            environment.turn(np.where(speeds < SHARE * speeds.max(axis=1, keepdims=True), 2, 0))

    seconds = least(turns_of_all, repeats)
    environment.close()
    return rows * turns / seconds


def environment_rows(quick: bool = False) -> list[Row]:
    """Return the rows of a single environment and a vector of them, without Gymnasium's own part, some microseconds a
    step.
    """
    rows = []
    for name, (count, many, few, wanted) in MEASURED.items():
        what = f"environment for learning, planar bogie, steps of 5 ms a second: {name}"
        rate = steps_a_second(count, few, 1) if quick else steps_a_second(count, many, 5)
        rows.append(measured(what, "1/s", rate, f"measured now; to reach {wanted:g}"))
    return rows
