"""Wheel-slide protection: from the speeds of the wheels to commands for the valves of the brake cylinders.

A controller is any object with `step(time, wheel_speeds) -> valve commands`. The built-in one is C code
(rig/slide_protection.c). `Supervised` calls any controller and keeps the brake applied if it fails.
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

#: Commands of a valve, the input `valve` of the brake cylinder. This file needs only Python, so that it can be included
#: in an FMU.
APPLY, HOLD, VENT = 0, 1, 2
COMMANDS = (APPLY, HOLD, VENT)


class WheelSlideController(Protocol):
    """Interface of a user's controller."""

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        """Return valve commands of all wheelsets (0 apply, 1 hold, 2 vent) from their circumferential speeds [m/s].

        Called at a fixed period with the time [s] since the start of the run.
        """
        ...


class ControllerError(Exception):
    """A controller failed; the message gives the cause, and that the brake stays applied."""


class NotJudgedError(ControllerError):
    """A controller used little processor time and gave no answer within the wall time; it is not evaluated."""


class LateError(BaseException):
    """Raised inside a controller that uses too much processor time; no `except Exception` of its own stops it."""


class SilentError(BaseException):
    """Raised inside a controller that gives no answer within the wall time, for any reason."""


#: Processor time [s] for one answer, and wall time [s] after which a controller without an answer is not evaluated.
PATIENCE, GUARD = 1.0, 60.0
#: Processor time before a call that its watch may include [s]; shortest time between two readings of clocks [s].
SHARED, LEAST_WAIT = 0.01, 0.01


class Watch:
    """Limits of a call: `limit` [s] of processor time of its thread, `guard` [s] of wall time.

    Processor time is the controller's own. Wall time includes other programs: a busy computer must not fail a
    controller. begun: last start of its clocks, on `time.monotonic` [s].
    """

    def __init__(self, limit: float, guard: float = GUARD) -> None:
        self.limit, self.guard = limit, guard
        self.begin()

    def begin(self) -> None:
        """Start the clocks of a call in the present thread."""
        self.begun, self._used = clock.monotonic(), clock.thread_time()

    def next(self) -> None:
        """Restart the clocks for the next of many short calls, if they are old: reading them costs a system call."""
        if clock.monotonic() - self.begun > SHARED:
            self.begin()

    def end(self) -> None:
        """Check the processor time of a completed call, in its thread. Raises LateError."""
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
    """Return the result of a call. Raises LateError, SilentError beyond the limits of `watch`, or the call's exception.

    Alarms are not available outside the main thread and on Windows. The call then runs in a thread of its own, which is
    abandoned if it is late.
    """
    if hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
        return _under_an_alarm(watch, call)
    return _in_a_thread(watch, call)


def _under_an_alarm(watch: Watch, call: Callable[[], object]) -> object:
    """Call in this thread; an alarm checks its processor time, at intervals in which the limit may be reached."""

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
    """Call in a new thread; its processor time is read from here, or after its answer if no system call reads it."""
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
    """Return the exception with the last line reached in the file of the controller's `step`."""
    own = getattr(getattr(getattr(type(controller), "step", None), "__code__", None), "co_filename", None)
    reached = traceback.extract_tb(error.__traceback__)
    lines = [f", {os.path.basename(one.filename)}, line {one.lineno}" for one in reached if one.filename == own]
    return f"{type(error).__name__}: {error}{lines[-1] if lines else ''}"


@dataclass
class Supervised:
    """A controller whose failures do not reach the valves. Raises ControllerError with a message.

    patience [s]: processor time for one answer; guard [s]: wall time after which it is not evaluated.
    """

    controller: WheelSlideController
    wheelsets: int
    patience: float = PATIENCE
    guard: float = GUARD
    _commands: frozenset[int] = frozenset(COMMANDS)

    @property
    def name(self) -> str:
        """Name of the controller in messages."""
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
        """Return the same, without a limit of time. Raises ControllerError."""
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


#: End of the message on a controller that gave no answer.
NOT_JUDGED = "and is not judged. Remove what it waits for, or run it on a machine with less load."


def silence(who: str, guard: float, at: str = "") -> str:
    """Return the message on a controller that gave no answer within a wall time [s]."""
    return f"{who} gave no answer within {guard:g} s of wall time{at} {NOT_JUDGED}"
