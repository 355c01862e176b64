"""Runs of the test rig in a separate process, which a controller in C or in an FMU may end or block."""

from __future__ import annotations

import math
import os
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from multiprocessing import get_context
from multiprocessing.connection import Connection
from tempfile import TemporaryDirectory
from typing import Any, TypeVar, cast

from brake_controller.wheel_slide import GUARD, NOT_JUDGED
from fmu_src.kernel import ERROR, SimulationError
from products.controller_kinds import Form
from products.machine import Machine
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings

#: Limits of a process without a sign of life: processor time [s], and wall time until its first sign [s].
PATIENCE, BEGINNING = 10.0, 300.0
#: Limits of a call with one answer: processor time and wall time [s].
LONGEST_CALL, LONGEST_WAIT = 120.0, 600.0
#: Interval at which a process checks its processor time [s].
TICK = 0.2
#: Number of attempts to restart a process for the remaining runs.
TIMES = 3
#: First item of a message: an intermediate result follows, the process is done, the controller is invalid, another
#: error occurred, or the process used too much processor time.
GIVEN, DONE, REFUSED, FAILED, LATE = range(5)
Tell = Callable[[object], None]
Result = TypeVar("Result")


class NoControllerError(Exception):
    """The controller is invalid; the text states the reason."""


class ProcessEndedError(Exception):
    """The process ended or took too long; the text states how, as "ended its process (SIGSEGV)"."""


class SilentProcessError(ProcessEndedError):
    """The process used little processor time and gave no answer for long: the controller is not evaluated."""


@dataclass(frozen=True)
class Limits:
    """Limits without a sign of life: processor time [s], wall time, and wall time until the first sign [s]."""

    used: float = PATIENCE
    guard: float = GUARD
    beginning: float = BEGINNING


@dataclass(frozen=True)
class Apart:
    """A controller to be made in a separate process; make: takes the number of wheelsets and the period [s]."""

    make: Callable[[int, float], Form]

    def made(self, wheelsets: int, period: float) -> Form:
        """Return the controller. Raises NoControllerError."""
        try:
            return self.make(wheelsets, period)
        except Exception as error:  # a library and an FMU fail in many ways
            raise NoControllerError(str(error) or type(error).__name__) from error


@dataclass(frozen=True)
class Order:
    """Arguments of a rig; every: recording interval [s], 0: no recording."""

    machine: Machine
    controller: Form | Apart
    settings: Settings
    by_flow: bool = True
    level: int = 2
    every: float = 0.0

    def rig(self) -> Rig:
        """Return the rig with its controller. Raises NoControllerError."""
        form = self.controller
        if isinstance(form, Apart):
            form = form.made(len(self.machine.numbers), self.settings.period)
        return Rig(self.machine, form, self.settings, by_flow=self.by_flow, level=self.level)


def runs_apart(order: Order, runs: Sequence[Run], limits: Limits | None = None) -> list[Stop]:
    """Run the stops in a separate process and return them in their order, as `Rig.runs` does.

    At first all run together. If the process ends or takes too long, they are repeated one by one. Runs in which it
    fails again have no distance, and a message with the reason; their other results are those of brakes that stay
    applied. They are not evaluated if the process used little processor time.
    """
    limits = limits or Limits()
    together, died = _made(order, runs, limits, alone=False)
    if not died:
        return together
    stops: list[Stop] = []
    for _ in range(TIMES):
        found, died = _made(order, runs[len(stops) :], limits, alone=True)
        stops += found
        if not died:
            return stops
        stops.append(_applied(order, runs[len(stops)], died))
        if len(stops) == len(runs):
            return stops
    return stops + [_applied(order, run, died, asked=False) for run in runs[len(stops) :]]


def _applied(order: Order, run: Run, died: ProcessEndedError, asked: bool = True) -> Stop:
    """Return a stop with brakes that stay applied; it is not a stop of the controller."""
    [stop] = Rig(order.machine, None, order.settings, by_flow=order.by_flow, level=order.level).runs(
        [run], every=order.every
    )
    judged = not isinstance(died, SilentProcessError)
    if asked:
        words = f"{died}; the brake stays applied." if judged else f"{died} {NOT_JUDGED}"
    else:
        words = f"{died} in {TIMES} runs before; it was not asked again{'' if judged else ' and is not judged'}."
    return replace(stop, distance=None, message=f"The controller {words}", judged=judged)


def _made(
    order: Order, runs: Sequence[Run], limits: Limits, alone: bool
) -> tuple[list[Stop], ProcessEndedError | None]:
    """Return the stops that a process made, and how it ended before the last."""
    stops: list[Stop] = []
    try:
        for some in _heard(_make, (order, list(runs), alone), limits):
            stops += some
    except ProcessEndedError as ended:
        return stops, ended
    return stops, None


def called_apart(function: Callable[..., Result], *arguments: object) -> Result:
    """Call a function in a separate process and return its result."""
    limits = Limits(LONGEST_CALL, LONGEST_WAIT, LONGEST_WAIT)
    *_, found = _heard(_call, (function, arguments), limits)
    return cast(Result, found)


def _heard(target: Callable[..., None], arguments: tuple[object, ...], limits: Limits) -> Iterator[Any]:
    """Yield the messages of a target in a separate process. Raises EndedError, NoControllerError, SimulationError."""
    context, ends = get_context("spawn"), False
    here, there = context.Pipe(duplex=False)
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:  # files of a process that was killed
        child = context.Process(target=_tell, args=(there, folder, target, arguments, limits.used), daemon=True)
        child.start()
        there.close()
        try:
            waits = limits.beginning
            while here.poll(waits):
                waits = limits.guard
                kind, heard = here.recv()
                if kind == GIVEN:
                    yield heard
                    continue
                if kind == LATE:
                    raise ProcessEndedError(f"used more than {limits.used:g} s of processor time without an answer")
                ends = True
                if kind == REFUSED:
                    raise NoControllerError(heard)
                if kind == FAILED:
                    raise SimulationError(heard, ERROR)
                return
            raise SilentProcessError(f"gave no answer within {waits:g} s of wall time")
        except EOFError:
            ends = True
            child.join()
            raise ProcessEndedError(f"ended its process ({_end_of(child.exitcode)})") from None
        finally:
            if not ends:
                child.kill()
            child.join()


def _end_of(code: int | None) -> str:
    """Return in words how a process ended."""
    if code is not None and code < 0:
        return signal.Signals(-code).name
    return f"exit status {code}"


class _Pipe:
    """A pipe to the waiting process; each message is a sign of life."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe, self._lock = pipe, threading.Lock()
        self._used = math.inf  # until the first sign: imports and compilers do not count

    def send(self, kind: int, what: object = None) -> None:
        """Send a message, and restart the count of processor time."""
        with self._lock:
            self._pipe.send((kind, what))
            self._used = time.process_time()

    def watch(self, limit: float) -> None:
        """Send LATE, once, if the process uses more than this processor time [s] without a sign of life."""
        while time.process_time() - self._used <= limit:
            time.sleep(TICK)
        with suppress(OSError):  # the reader has ended
            self.send(LATE)


def _tell(
    pipe: Connection, folder: str, target: Callable[..., None], arguments: tuple[object, ...], limit: float
) -> None:
    """Run in the process: send the results of the target and its end, or an error message."""
    own = _Pipe(pipe)
    threading.Thread(target=own.watch, args=(limit,), daemon=True).start()
    try:
        os.dup2(2, 1)  # output of a controller
        tempfile.tempdir = folder
        target(lambda one: own.send(GIVEN, one), *arguments)
        own.send(DONE)
    except NoControllerError as error:
        own.send(REFUSED, str(error))
    except Exception as error:
        own.send(FAILED, f"{error} ({type(error).__name__})")


def _make(tell: Tell, order: Order, runs: Sequence[Run], alone: bool) -> None:
    """Send stops in lists, empty ones as a sign of life."""
    rig = order.rig()
    rig.prepare(runs)
    tell([])
    for some in [[run] for run in runs] if alone else [runs]:
        tell(rig.runs(some, lambda: tell([]), order.every))


def _call(tell: Tell, function: Callable[..., object], arguments: tuple[object, ...]) -> None:
    """Send a sign of the start, then the result of the function."""
    tell(None)
    tell(function(*arguments))
