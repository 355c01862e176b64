"""Wheel-slide protection: from the speeds of the wheels to commands for the valves of the brake cylinders.

A controller is any object with `step(time, wheel_speeds) -> valve commands`. The one that comes with the brake is C
(rig/slide_protection.c). `Supervised` stands between any controller and the valves and keeps the brake applied when it
fails.
"""

import math
import os
import signal
import threading
import time as clock
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Protocol

#: What a valve does, as the input `valve` of the brake cylinder. This file needs nothing but Python, so that it can
#: travel inside an FMU.
APPLY, HOLD, VENT = 0, 1, 2
COMMANDS = (APPLY, HOLD, VENT)


class WheelSlideController(Protocol):
    """What a controller of one's own must have."""

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        """Valve commands of all wheelsets (0 apply, 1 hold, 2 vent) from their circumferential speeds [m/s].

        Called at a fixed period with the time [s] since the start of the run.
        """
        ...


class ControllerError(Exception):
    """A controller failed; the text says how, and that the brake stays applied."""


class NotJudgedError(ControllerError):
    """A controller used little processor time and gave no answer for long; the text says that it is not judged."""


class LateError(BaseException):
    """Raised inside a controller that uses too much processor time; no `except Exception` of its own stops it."""


class SilentError(BaseException):
    """Raised inside a controller that gives no answer for long, whatever it or the machine waits for."""


#: Processor time [s] that one answer may use, and wall time [s] after which a controller without one is not judged.
PATIENCE, GUARD = 1.0, 60.0
#: Processor time ahead of a call that its watch may count too [s]; shortest time between two readings of clocks [s].
SHARED, LEAST_WAIT = 0.01, 0.01


class Watch:
    """Limits of a call: `limit` [s] of processor time of its thread, `guard` [s] of wall time.

    Processor time is the controller's own. Wall time is that of the machine too: a busy one must fail no controller.
    begun: when its clocks were last started, on `time.monotonic` [s].
    """

    def __init__(self, limit: float, guard: float = GUARD) -> None:
        self.limit, self.guard = limit, guard
        self.begin()

    def begin(self) -> None:
        """Start the clocks of a call in the present thread."""
        self.begun, self._used = clock.monotonic(), clock.thread_time()

    def next(self) -> None:
        """Start the clocks anew for the next of many short calls, if they are old: reading them costs a system call."""
        if clock.monotonic() - self.begun > SHARED:
            self.begin()

    def end(self) -> None:
        """Judge a call that has answered, in its thread. Raises LateError."""
        if clock.monotonic() - self.begun >= self.limit and clock.thread_time() - self._used >= self.limit:
            raise LateError

    def check(self, used: float) -> float:
        """Return the wall time to the next check [s], from the processor time of the thread [s].

        Raises LateError, SilentError.
        """
        left, wall = self.limit - (used - self._used), self.guard - (clock.monotonic() - self.begun)
        if left <= 0.0:
            raise LateError
        if wall <= 0.0:
            raise SilentError
        return max(min(left, wall), LEAST_WAIT)


def within(watch: Watch, call: Callable[[], object]) -> object:
    """Return the result of a call. Raises LateError, SilentError beyond the limits of `watch`, or what it raises.

    Outside the main thread and on Windows no alarm can ring: there the call runs in a thread of its own, which is left
    alone when it is late.
    """
    if hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
        return _under_an_alarm(watch, call)
    return _in_a_thread(watch, call)


def _under_an_alarm(watch: Watch, call: Callable[[], object]) -> object:
    """Call in this thread; an alarm looks at its processor time, as often as that may be used up."""

    def ring(*_: object) -> None:
        signal.setitimer(signal.ITIMER_REAL, watch.check(clock.thread_time()))

    before = signal.signal(signal.SIGALRM, ring)
    watch.next()
    signal.setitimer(signal.ITIMER_REAL, min(watch.limit, watch.guard))
    try:
        answer = call()
        watch.end()
        return answer
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _in_a_thread(watch: Watch, call: Callable[[], object]) -> object:
    """Call in a new thread; its processor time is read from here, or where no system call does so, when it answers."""
    answers: list[tuple[bool, object]] = []
    clocks: list[int] = []

    def work() -> None:
        watch.begin()
        if hasattr(clock, "pthread_getcpuclockid"):
            clocks.append(clock.pthread_getcpuclockid(threading.get_ident()))
        try:
            answer = call()
            watch.end()
            answers.append((True, answer))
        except BaseException as error:
            answers.append((False, error))

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    wait = min(watch.limit, watch.guard)
    while not answers:
        thread.join(wait)
        if answers:
            break
        with suppress(OSError):  # it has ended in the meantime
            wait = watch.check(clock.clock_gettime(clocks[0]) if clocks else -math.inf)
    good, answer = answers[0]
    if not good:
        raise answer  # type: ignore[misc]
    return answer


def failure(error: BaseException, controller: Any) -> str:
    """What was raised, and on which line of the file that has the controller's `step`, the last that was reached."""
    own = getattr(getattr(getattr(type(controller), "step", None), "__code__", None), "co_filename", None)
    reached = traceback.extract_tb(error.__traceback__)
    lines = [f", {os.path.basename(one.filename)}, line {one.lineno}" for one in reached if one.filename == own]
    return f"{type(error).__name__}: {error}{lines[-1] if lines else ''}"


@dataclass
class Supervised:
    """A controller whose failures do not reach the valves. Raises ControllerError with a sentence.

    patience [s]: processor time that one answer may use; guard [s]: wall time after which it is not judged.
    """

    controller: WheelSlideController
    wheelsets: int
    patience: float = PATIENCE
    guard: float = GUARD
    _commands: frozenset[int] = frozenset(COMMANDS)

    @property
    def name(self) -> str:
        """What sentences call the controller."""
        return str(getattr(self.controller, "__name__", type(self.controller).__name__))

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return the controller's valve commands. Raises ControllerError if it fails, is late or gives others.

        Raises NotJudgedError if it gives none within `guard`.
        """
        try:
            answer = within(Watch(self.patience, self.guard), lambda: self.unhurried(time, wheel_speeds))
        except LateError:
            raise self.late(time) from None
        except SilentError:
            raise self.silent(time) from None
        assert isinstance(answer, list)
        return answer

    def unhurried(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """The same, however long it takes. Raises ControllerError."""
        try:
            given: object = self.controller.step(time, wheel_speeds)
            answer: list[Any] = [] if given is None else list(given)  # type: ignore[call-overload]
            fits = len(answer) == self.wheelsets and self._commands.issuperset(answer)
            fits = fits and not any(isinstance(one, bool) or type(one).__name__ == "bool_" for one in answer)
        except (Exception, SystemExit) as error:
            raise ControllerError(
                f"The controller {self.name} failed at {time:.6g} s ({failure(error, self.controller)}); the brake "
                "stays applied."
            ) from error
        if not fits:
            raise ControllerError(
                f"The controller {self.name} gave {answer!r} at {time:.6g} s where {self.wheelsets} commands of 0 "
                "(apply), 1 (hold) or 2 (vent) were due; the brake stays applied."
            )
        return [int(command) for command in answer]

    def late(self, time: float) -> ControllerError:
        """Return the error of a controller that used too much processor time."""
        return ControllerError(
            f"The controller {self.name} used more than {self.patience:g} s of processor time for its answer at "
            f"{time:.6g} s; the brake stays applied."
        )

    def silent(self, time: float) -> NotJudgedError:
        """Return the error of a controller that gave no answer and used little processor time."""
        return NotJudgedError(silence(f"The controller {self.name}", self.guard, f" at {time:.6g} s"))


#: What is said of a controller that gave no answer for long.
NOT_JUDGED = "and is not judged. Remove what it waits for, or run it on a machine with less load."


def silence(who: str, guard: float, at: str = "") -> str:
    """Say that a controller is not judged which gave no answer within a wall time [s]."""
    return f"{who} gave no answer within {guard:g} s of wall time{at} {NOT_JUDGED}"
