"""Speed of trains, measured now on one core: emergencies of 150 vehicles, communication steps, the start of a train."""

from __future__ import annotations

import time
from functools import partial

from bogie_braking.reporting.report import Row
from bogie_braking.reporting.timing import least
from products.train.brake_model import BRAKE_MODELS_BY_COST
from products.train.consist import block_train
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import draft_gear

#: Vehicles, and simulated time of an emergency from SPEED in one step [s].
VEHICLES, SPEED, WATCHED = 150, 27.8, 20.0
HOST_STEP, HOST_STEPS, HOSTED = 1e-3, 500, 100
FEW, MANY = 100, 400
#: Targets of the project, printed with the measurement; published: fluid 0.15, fitted 7.4 times real time.
TARGETS = {"whole, two cells": ">= 300, published 0.15", "empirical, half a cell": ">= 3000, published 7.4"}


def braking(vehicles: int, settings: Settings) -> Train:
    """Return loaded wagons with draft gears behind a locomotive, in an emergency."""
    train = Train(block_train(vehicles - 1, coupler=draft_gear()), speed=SPEED, settings=settings)
    train.drive("emergency")
    return train


def _emergency(vehicles: int, settings: Settings) -> float:
    """Return the wall time of an emergency without its start [s]."""

    def once() -> float:
        train = braking(vehicles, settings)
        begin = time.perf_counter()
        train.advance(WATCHED)
        return time.perf_counter() - begin

    return min(once() for _ in range(5))


def _host_step() -> float:
    train = braking(HOSTED, Settings())
    train.advance(1.0)
    kept = train.state

    def steps() -> None:
        train.state = kept
        for _ in range(HOST_STEPS):
            train.advance(HOST_STEP)

    return least(steps) / HOST_STEPS


def train_rows() -> list[Row]:
    """Return rows of the scenario `speed`."""
    rows, source = [], "measured now, one core, least of several runs"
    for name, target in TARGETS.items():
        pace = WATCHED / _emergency(VEHICLES, BRAKE_MODELS_BY_COST[name].settings)
        rows.append(Row(f"train of {VEHICLES}, {name}: times real time", "1", None, pace, None, source, target))
    rows.append(Row(f"train of {HOSTED}: doStep of 1 ms", "us", None, 1e6 * _host_step(), None, source, "<= 25"))
    growth = FEW / MANY * _emergency(MANY, Settings()) / _emergency(FEW, Settings())
    rows.append(Row(f"time a vehicle of {MANY} over that of {FEW}", "1", None, growth, None, source, "<= 1.3"))
    consist = block_train(MANY - 1)
    start = least(partial(Train, consist))
    rows.append(Row(f"start of a train of {MANY}", "s", None, start, None, source, "<= 0.1"))
    return rows
