"""Runs of the test rig in a process of its own, which a controller in C or in an FMU may end or never leave."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection

from fmu_src.cosimulation.slave import CosimulationError
from products.protection.braked_machine import Machine
from products.protection.forms import Form
from products.protection.protected_stop import Settings
from products.protection.rig import Rig
from products.protection.runs import Run, Stop

#: Time without a sign of life after which the process is ended [s]; and for it to begin, on a busy machine.
PATIENCE, BEGINNING = 10.0, 120.0
#: So often a process that ends is begun again for the runs that are left.
TIMES = 3


class NoControllerError(Exception):
    """What was given is no controller; the text says why."""


@dataclass(frozen=True)
class Apart:
    """A controller that is made in a process of its own; make: from the number of wheelsets and the period [s]."""

    make: Callable[[int, float], Form]


@dataclass(frozen=True)
class Order:
    """What a rig is made for; every: time between two looks that are written down [s], 0: none."""

    machine: Machine
    controller: Form | Apart
    settings: Settings
    by_flow: bool = True
    level: int = 2
    every: float = 0.0

    def rig(self) -> Rig:
        """With the controller. Raises OSError, AttributeError, ValueError for what is none."""
        form = self.controller
        if isinstance(form, Apart):
            form = form.make(len(self.machine.numbers), self.settings.period)
        return Rig(self.machine, form, self.settings, by_flow=self.by_flow, level=self.level)


def runs_apart(order: Order, runs: Sequence[Run], patience: float = PATIENCE) -> list[Stop]:
    """A stop of each run, in their order, as `Rig.runs` has them.

    All go on together at first. If the process ends or hangs, they are made one by one, and the runs in which it does
    so again have no distance and say why; their other numbers are those of brakes that stay applied. Raises
    NoControllerError.
    """
    together, died = _made(order, runs, patience, alone=False)
    if not died:
        return together
    stops: list[Stop] = []
    for _ in range(TIMES):
        found, died = _made(order, runs[len(stops) :], patience, alone=True)
        stops += found
        if not died:
            return stops
        stops.append(_applied(order, runs[len(stops)], f"The controller {died}; the brake stays applied."))
        if len(stops) == len(runs):
            return stops
    words = f"The controller {died} in {TIMES} runs before; it was not asked again."
    return stops + [_applied(order, run, words) for run in runs[len(stops) :]]


def _applied(order: Order, run: Run, words: str) -> Stop:
    """What comes of brakes that stay applied, which is no stop of the controller."""
    [stop] = Rig(order.machine, None, order.settings, by_flow=order.by_flow, level=order.level).runs(
        [run], every=order.every
    )
    return replace(stop, distance=None, said=words)


def _made(order: Order, runs: Sequence[Run], patience: float, alone: bool) -> tuple[list[Stop], str]:
    """The stops that a process made, and how it ended before the last; empty: it did not."""
    context = get_context("spawn")
    here, there = context.Pipe(duplex=False)
    child = context.Process(target=_make, args=(there, order, list(runs), alone), daemon=True)
    child.start()
    there.close()
    stops: list[Stop] = []
    waits = BEGINNING
    while len(stops) < len(runs):
        if not here.poll(waits):
            child.kill()
            child.join()
            return stops, f"gave no answer within {waits:g} s"
        waits = patience
        try:
            heard = here.recv()
        except EOFError:
            child.join()
            return stops, f"ended its process ({_end_of(child.exitcode)})"
        if isinstance(heard, str):
            child.join()
            raise NoControllerError(heard)
        stops += heard
    child.join()
    return stops, ""


def _end_of(code: int | None) -> str:
    """In words, how a process ended."""
    if code is not None and code < 0:
        return signal.Signals(-code).name
    return f"exit status {code}"


def _make(pipe: Connection, order: Order, runs: Sequence[Run], alone: bool) -> None:
    """In the process: stops in lists, empty ones as a sign of life, or the sentence of what is no controller."""
    try:
        os.dup2(2, 1)  # what a controller prints
        rig = order.rig()
        for some in [[run] for run in runs] if alone else [runs]:
            pipe.send(rig.runs(some, lambda: pipe.send([]), order.every))
    except (OSError, AttributeError, ValueError, CosimulationError) as error:
        pipe.send(str(error))
