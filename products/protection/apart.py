"""Runs of the test rig in a process of its own, which a controller in C or in an FMU may end or never leave."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any, TypeVar, cast

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


#: What a process sends first: what follows was made, it is done, or it was given no controller.
GIVEN, DONE, REFUSED = range(3)
Tell = Callable[[object], None]
Result = TypeVar("Result")


class NoControllerError(Exception):
    """What was given is no controller; the text says why."""


class EndedError(Exception):
    """The process ended or hung; the text says how, as "ended its process (SIGSEGV)"."""


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
    stops: list[Stop] = []
    try:
        for some in _heard(_make, (order, list(runs), alone), patience):
            stops += some
    except EndedError as ended:
        return stops, str(ended)
    return stops, ""


def called_apart(function: Callable[..., Result], *arguments: object, patience: float = BEGINNING) -> Result:
    """What a function gives that is called in a process of its own. Raises EndedError, NoControllerError."""
    [found] = _heard(_call, (function, arguments), patience)
    return cast(Result, found)


def _heard(target: Callable[..., None], arguments: tuple[object, ...], patience: float) -> Iterator[Any]:
    """What a target tells in a process of its own. Raises EndedError, NoControllerError."""
    context = get_context("spawn")
    here, there = context.Pipe(duplex=False)
    child = context.Process(target=_tell, args=(there, target, arguments), daemon=True)
    child.start()
    there.close()
    waits = BEGINNING
    while True:
        if not here.poll(waits):
            child.kill()
            child.join()
            raise EndedError(f"gave no answer within {waits:g} s")
        waits = patience
        try:
            kind, heard = here.recv()
        except EOFError:
            child.join()
            raise EndedError(f"ended its process ({_end_of(child.exitcode)})") from None
        if kind == GIVEN:
            yield heard
            continue
        child.join()
        if kind == REFUSED:
            raise NoControllerError(heard)
        return


def _end_of(code: int | None) -> str:
    """In words, how a process ended."""
    if code is not None and code < 0:
        return signal.Signals(-code).name
    return f"exit status {code}"


def _tell(pipe: Connection, target: Callable[..., None], arguments: tuple[object, ...]) -> None:
    """In the process: sends what the target tells, that it is done, or the sentence of what is no controller."""
    try:
        os.dup2(2, 1)  # what a controller prints
        target(lambda one: pipe.send((GIVEN, one)), *arguments)
        pipe.send((DONE, None))
    except (OSError, AttributeError, ValueError, CosimulationError) as error:
        pipe.send((REFUSED, str(error)))


def _make(tell: Tell, order: Order, runs: Sequence[Run], alone: bool) -> None:
    """Tells stops in lists, empty ones as a sign of life."""
    rig = order.rig()
    for some in [[run] for run in runs] if alone else [runs]:
        tell(rig.runs(some, lambda: tell([]), order.every))


def _call(tell: Tell, function: Callable[..., object], arguments: tuple[object, ...]) -> None:
    tell(function(*arguments))
