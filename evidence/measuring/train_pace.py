"""Speed of trains, measured now on one core: emergencies of 150 vehicles, communication steps, the start of a train."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial

from bogie_braking.reporting.report import Row, measured
from bogie_braking.reporting.timing import REPEATS, least
from products.train.brake_model import BRAKE_MODELS_BY_COST
from products.train.consist import block_train
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import draft_gear

#: Speed at which an emergency begins [m/s]; communication steps [s].
SPEED, HOST_STEP, HOST_STEPS = 27.8, 1e-3, 500
#: Targets of the project, printed with the measurement; published: fluid 0.15, fitted 7.4 times real time.
TARGETS = {"whole, two cells": ">= 300, published 0.15", "empirical, half a cell": ">= 3000, published 7.4"}


@dataclass(frozen=True)
class TrainExtent:
    """Numbers of vehicles for pace, communication step and growth with length; time of an emergency [s]."""

    vehicles: int = 150
    hosted: int = 100
    few: int = 100
    many: int = 400
    watched: float = 20.0
    repeats: int = REPEATS


QUICK = TrainExtent(20, 10, 10, 40, 5.0, 1)


def braking(vehicles: int, settings: Settings) -> Train:
    """Return loaded wagons with draft gears behind a locomotive, in an emergency."""
    train = Train(block_train(vehicles - 1, coupler=draft_gear()), speed=SPEED, settings=settings)
    train.drive("emergency")
    return train


def _emergency(vehicles: int, watched: float, settings: Settings) -> float:
    """Return the wall time of an emergency without its start [s]."""

    def once() -> float:
        train = braking(vehicles, settings)
        begin = time.perf_counter()
        train.advance(watched)
        return time.perf_counter() - begin

    return min(once() for _ in range(5))


def _host_step(extent: TrainExtent) -> float:
    train = braking(extent.hosted, Settings())
    train.advance(1.0)
    kept = train.state

    def steps() -> None:
        train.state = kept
        for _ in range(HOST_STEPS):
            train.advance(HOST_STEP)

    return least(steps, extent.repeats) / HOST_STEPS


def train_rows(extent: TrainExtent) -> list[Row]:
    """Return rows of the scenario `speed`."""
    rows, source = [], "measured now, one core, least of several runs"
    few, many, watched = extent.few, extent.many, extent.watched
    for name, target in TARGETS.items():
        pace = watched / _emergency(extent.vehicles, watched, BRAKE_MODELS_BY_COST[name].settings)
        rows.append(measured(f"train of {extent.vehicles}, {name}: times real time", "1", pace, source, None, target))
    rows.append(
        measured(f"train of {extent.hosted}: doStep of 1 ms", "us", 1e6 * _host_step(extent), source, None, "<= 25")
    )
    growth = few / many * _emergency(many, watched, Settings()) / _emergency(few, watched, Settings())
    rows.append(measured(f"time a vehicle of {many} over that of {few}", "1", growth, source, None, "<= 1.3"))
    consist = block_train(many - 1)
    start = least(partial(Train, consist), extent.repeats)
    rows.append(measured(f"start of a train of {many}", "s", start, source, None, "<= 0.1"))
    return rows
