"""Control steps a second of learning environments, for the rows of `speed`."""

from __future__ import annotations

import time as clock

import numpy as np

from bogie_braking.reporting.report import Row
from products.machine import bogie
from products.protection.draws import drawn_run
from products.protection.environment import Environment
from products.protection.settings import Settings

#: Rows, measured turns, those of a quick run, and the target of steps a second. Single environments of electric motors
#: make 1100 to 3100 steps a second (gym-electric-motor, published).
MEASURED = {"one row": (1, 4000, 100, 2e4), "1024 rows": (1024, 500, 100, 1e6)}
REPEATS = 5
#: Share of the fastest wheelset's speed below which the controller vents.
SHARE = 0.8


def steps_a_second(rows: int, turns: int, repeats: int) -> float:
    """Return the largest of several rates [1/s], with observations, rewards and an array controller in NumPy."""
    own = Environment(bogie(), Settings(), rows, drawn_run)
    own.begin(range(rows), [np.random.default_rng(row) for row in range(rows)])
    best = np.inf
    for _ in range(repeats):
        begin = clock.perf_counter()
        for _ in range(turns):
            speeds = own.observation[:, :2]
            own.turn(np.where(speeds < SHARE * speeds.max(axis=1, keepdims=True), 2, 0))
        best = min(best, clock.perf_counter() - begin)
    own.close()
    return rows * turns / best


def environment_rows(quick: bool = False) -> list[Row]:
    """Return the rows of a single environment and a vector of them, without Gymnasium's own part, some microseconds a
    step.
    """
    rows = []
    for name, (count, many, few, wanted) in MEASURED.items():
        what = f"environment for learning, planar bogie, steps of 5 ms a second: {name}"
        rate = steps_a_second(count, few, 1) if quick else steps_a_second(count, many, REPEATS)
        rows.append(Row(what, "1/s", None, rate, None, f"measured now; to reach {wanted:g}"))
    return rows
