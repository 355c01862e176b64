"""Runs of the test rig in a process of its own, which a controller in C or in an FMU may end or never leave."""

from __future__ import annotations

import os
import signal
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from tempfile import TemporaryDirectory
from typing import Any, TypeVar, cast

from fmu_src.kernel import ERROR, KernelError
from products.protection.braked_machine import Machine
from products.protection.forms import Form
from products.protection.protected_stop import Settings
from products.protection.rig import Rig
from products.protection.runs import Run, Stop

#: Time without a sign of life after which the process is ended [s]; and for it to begin, on a busy machine.
PATIENCE, BEGINNING = 10.0, 120.0
#: So often a process that ends is begun again for the runs that are left.
TIMES = 3
#: What a process sends first: what follows was made, it is done, it was given no controller, or something else failed.
GIVEN, DONE, REFUSED, FAILED = range(4)
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

    def made(self, wheelsets: int, period: float) -> Form:
        """The controller. Raises NoControllerError."""
        try:
            return self.make(wheelsets, period)
        except Exception as error:  # a library and an FMU fail in many ways
            raise NoControllerError(str(error) or type(error).__name__) from error


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
        """With the controller. Raises NoControllerError."""
        form = self.controller
        if isinstance(form, Apart):
            form = form.made(len(self.machine.numbers), self.settings.period)
        return Rig(self.machine, form, self.settings, by_flow=self.by_flow, level=self.level)


def runs_apart(order: Order, runs: Sequence[Run], patience: float = PATIENCE) -> list[Stop]:
    """A stop of each run, in their order, as `Rig.runs` has them.

    All go on together at first. If the process ends or hangs, they are made one by one, and the runs in which it does
    so again have no distance and say why; their other numbers are those of brakes that stay applied. Raises
    NoControllerError, and KernelError where the simulation fails.
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
    """What a function gives that is called in a process of its own.

    Raises EndedError, NoControllerError, and KernelError where anything else fails.
    """
    [found] = _heard(_call, (function, arguments), patience)
    return cast(Result, found)


def _heard(target: Callable[..., None], arguments: tuple[object, ...], patience: float) -> Iterator[Any]:
    """What a target tells in a process of its own. Raises EndedError, NoControllerError, KernelError."""
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:  # what a process that is ended leaves behind
        yield from _told(target, arguments, patience, folder)


def _told(target: Callable[..., None], arguments: tuple[object, ...], patience: float, folder: str) -> Iterator[Any]:
    """The same; folder: of the process's temporary files."""
    context = get_context("spawn")
    here, there = context.Pipe(duplex=False)
    child = context.Process(target=_tell, args=(there, folder, target, arguments), daemon=True)
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
        if kind == FAILED:
            raise KernelError(heard, ERROR)
        return


def _end_of(code: int | None) -> str:
    """In words, how a process ended."""
    if code is not None and code < 0:
        return signal.Signals(-code).name
    return f"exit status {code}"


def _tell(pipe: Connection, folder: str, target: Callable[..., None], arguments: tuple[object, ...]) -> None:
    """In the process: sends what the target tells, that it is done, or the sentence of what went wrong."""
    try:
        os.dup2(2, 1)  # what a controller prints
        tempfile.tempdir = folder
        target(lambda one: pipe.send((GIVEN, one)), *arguments)
        pipe.send((DONE, None))
    except NoControllerError as error:
        pipe.send((REFUSED, str(error)))
    except Exception as error:
        pipe.send((FAILED, f"{error} ({type(error).__name__})"))


def _make(tell: Tell, order: Order, runs: Sequence[Run], alone: bool) -> None:
    """Tells stops in lists, empty ones as a sign of life."""
    rig = order.rig()
    for some in [[run] for run in runs] if alone else [runs]:
        tell(rig.runs(some, lambda: tell([]), order.every))


def _call(tell: Tell, function: Callable[..., object], arguments: tuple[object, ...]) -> None:
    tell(function(*arguments))
