"""Wheel-slide protection: from the speeds of the wheels to commands for the valves of the brake cylinders.

A controller is any object with `step(time, wheel_speeds) -> valve commands`. `SlideProtection` is the one that comes
with the brake; `Supervised` stands between any controller and the valves and keeps the brake applied when it fails.
"""

from __future__ import annotations

import math
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from typing import Protocol

#: What a valve does, as the input `valve` of the brake cylinder. This file needs nothing but Python, so that it can
#: travel inside an FMU.
APPLY, HOLD, VENT = 0, 1, 2
COMMANDS = (APPLY, HOLD, VENT)
#: Acceleration below which a wheel let go has caught up with the bogie [m/s2].
ROLLING = 0.3
#: Times of venting after which a wheel is believed to roll, where it was seen to speed up and where not [s].
SHORTEST_RELEASE, LONGEST_RELEASE = 0.25, 0.8
#: Time of braking without a command after which the wheels may show that the bogie slows faster than it did [s].
FREELY_BRAKED = 0.3
#: Time between two true speeds that gives a deceleration [s], and the least that is believed [m/s2].
SHORTEST_BETWEEN, LEAST_DECELERATION = 0.5, 0.1


class WheelSlideController(Protocol):
    """What a controller of one's own must have."""

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        """Valve commands of all wheelsets (0 apply, 1 hold, 2 vent) from their circumferential speeds [m/s].

        Called at a fixed period with the time [s] since the start of the run.
        """
        ...


class ControllerError(Exception):
    """A controller failed; the text says how, and that the brake stays applied."""


@dataclass(frozen=True)
class SlideProtectionParameters:
    """Thresholds of `SlideProtection`; all finite and not below 0."""

    #: Slip below which the brake is applied further, and above which it is vented; in between it is held [1].
    lower_slip: float
    upper_slip: float
    #: The upper slip in m/s at low speed, below which wheels are not told apart.
    least_slip: float
    #: Time by which a change of slip is anticipated, and time constant of the filter on wheel speeds [s].
    lead_time: float
    filter_time: float
    #: Deceleration of the reference speed until one is measured, and the largest one believed [m/s2].
    first_deceleration: float
    largest_deceleration: float
    #: Longest time of sliding without a look at the true speed, and longest time of venting at a stretch [s].
    synchronising_period: float
    watchdog: float
    #: Reference speed below which no wheel is protected [m/s].
    slowest: float

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"Set {item.name} to a finite value of at least 0: it was {value}.")
        if not self.upper_slip > self.lower_slip:
            raise ValueError(f"Set upper_slip above lower_slip, {self.lower_slip}: it was {self.upper_slip}.")


def common_protection() -> SlideProtectionParameters:
    """Assumed throughout: thresholds as they are common in descriptions of such devices, tuned on the planar bogie.

    The slip is that of (2.10), with the reference speed as that of the car.
    """
    return SlideProtectionParameters(
        lower_slip=0.05,
        upper_slip=0.10,
        least_slip=0.3,
        lead_time=0.2,
        filter_time=0.02,
        first_deceleration=1.0,
        largest_deceleration=1.5,
        synchronising_period=4.0,
        watchdog=5.0,
        slowest=0.25,
    )


@dataclass
class _Wheel:
    """What the protection knows of a wheelset: filtered speed [m/s] and acceleration [m/s2], since when it vents."""

    speed: float
    acceleration: float = 0.0
    vents_since: float | None = None
    speeds_up: bool = False
    blocked_until: float = -math.inf


@dataclass
class SlideProtection:
    """Holds the slip of each wheelset in a band around that of the best adhesion.

    Reference speed: the fastest wheel, or where all slide the last true speed, falling as fast as the bogie last did.
    From time to time a wheelset is released until it rolls, and shows the true speed.
    """

    parameters: SlideProtectionParameters = field(default_factory=common_protection)
    time: float | None = None
    wheels: list[_Wheel] = field(default_factory=list)
    reference: float = 0.0
    deceleration: float = 0.0
    synchronised_at: float = 0.0
    synchronised_speed: float = 0.0
    released: int | None = None
    acted_at: float = -math.inf

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Valve commands, as `WheelSlideController` has them."""
        if self.time is None:
            self._start(time, wheel_speeds)
        size = time - (self.time or 0.0)
        self.time = time
        if size > 0.0:
            self._observe(size, wheel_speeds)
        return [self._command(time, number) for number in range(len(self.wheels))]

    def _start(self, time: float, wheel_speeds: Sequence[float]) -> None:
        self.time = self.synchronised_at = time
        self.wheels = [_Wheel(speed) for speed in wheel_speeds]
        self.reference = self.synchronised_speed = max(wheel_speeds)
        self.deceleration = self.parameters.first_deceleration

    def _observe(self, size: float, wheel_speeds: Sequence[float]) -> None:
        """Filters the speeds and moves the reference: while nothing slides the fastest wheel, then by what is known."""
        share = size / (size + self.parameters.filter_time)
        for wheel, speed in zip(self.wheels, wheel_speeds, strict=True):
            change = share * (speed - wheel.speed)
            wheel.speed += change
            wheel.acceleration += share * (change / size - wheel.acceleration)
        fastest = max(wheel.speed for wheel in self.wheels)
        falls = self._believed_deceleration()
        self.reference = max(fastest, self.reference - falls * size, 0.0)
        caught_up = [wheel.speed for wheel in self.wheels if self._has_caught_up(wheel)]
        if caught_up:
            self._synchronise(max(caught_up))
        elif self._is_quiet() and self.reference == fastest:
            self._synchronise(fastest)

    def _believed_deceleration(self) -> float:
        """How fast the reference falls: as the bogie last did, or as the fastest wheel while all are braked freely."""
        assert self.time is not None
        if self._is_quiet():
            return self.parameters.largest_deceleration
        if self.time - self.acted_at < FREELY_BRAKED:
            return self.deceleration
        fastest = max(self.wheels, key=lambda wheel: wheel.speed)
        return max(self.deceleration, min(-fastest.acceleration, self.parameters.largest_deceleration))

    def _is_quiet(self) -> bool:
        """Whether the protection has had nothing to do for a while, so that the fastest wheel is believed to roll."""
        assert self.time is not None
        return self.time - self.acted_at > self.parameters.synchronising_period

    def _has_caught_up(self, wheel: _Wheel) -> bool:
        """A wheel that is vented speeds up until it rolls; one that never slid is believed after a while."""
        assert self.time is not None
        if wheel.vents_since is None:
            return False
        vented = self.time - wheel.vents_since
        wheel.speeds_up = wheel.speeds_up or wheel.acceleration > 2 * ROLLING
        return wheel.acceleration < ROLLING and vented > (SHORTEST_RELEASE if wheel.speeds_up else LONGEST_RELEASE)

    def _synchronise(self, speed: float) -> None:
        """Takes the true speed, and from two of them the deceleration of the bogie."""
        assert self.time is not None
        elapsed = self.time - self.synchronised_at
        if elapsed > SHORTEST_BETWEEN:
            measured = (self.synchronised_speed - speed) / elapsed
            self.deceleration = min(max(measured, LEAST_DECELERATION), self.parameters.largest_deceleration)
            self.synchronised_at, self.synchronised_speed = self.time, speed
        self.reference, self.released = speed, None

    def _command(self, time: float, number: int) -> int:
        p, wheel = self.parameters, self.wheels[number]
        if self.reference < p.slowest or time < wheel.blocked_until:
            wheel.vents_since = None
            return APPLY
        command = VENT if self._is_released(time, number) else self._by_slip(wheel)
        if command != APPLY:
            self.acted_at = time
        if command != VENT:
            wheel.vents_since = None
        elif wheel.vents_since is None:
            wheel.vents_since, wheel.speeds_up = time, False
        elif time - wheel.vents_since > p.watchdog:
            wheel.blocked_until = time + p.watchdog
            return APPLY
        return command

    def _by_slip(self, wheel: _Wheel) -> int:
        """Compares the slip to come, from the present one and its rate, with the band."""
        p = self.parameters
        scale = max(self.reference, p.least_slip / p.upper_slip)
        slip = (self.reference - wheel.speed) / scale
        slip += p.lead_time * (-self.deceleration - wheel.acceleration) / scale
        return VENT if slip > p.upper_slip else APPLY if slip < p.lower_slip else HOLD

    def _is_released(self, time: float, number: int) -> bool:
        """Whether this wheelset is the one that is let go so that it shows the true speed."""
        late = time - self.synchronised_at > self.parameters.synchronising_period
        if self.released is None and late and not self._is_quiet():
            self.released = max(range(len(self.wheels)), key=lambda one: self.wheels[one].speed)
        return self.released == number


class _LateError(BaseException):
    """Raised inside a controller that takes too long; no `except Exception` of its own stops it."""


@contextmanager
def _alarm(patience: float) -> Iterator[None]:
    """Raises _LateError in the main thread after some seconds, even out of a call that waits."""

    def ring(*_: object) -> None:
        raise _LateError

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, patience)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def within(patience: float, call: Callable[[], object]) -> object:
    """Result of a call that must come within `patience` seconds of wall time. Raises _LateError, or what it raises.

    Where no alarm can ring, outside the main thread and on Windows, the call runs in a thread of its own, which is left
    alone when it is late.
    """
    if hasattr(signal, "setitimer") and threading.current_thread() is threading.main_thread():
        with _alarm(patience):
            return call()
    answers: list[tuple[bool, object]] = []

    def work() -> None:
        try:
            answers.append((True, call()))
        except Exception as error:
            answers.append((False, error))

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    thread.join(patience)
    if not answers:
        raise _LateError
    good, answer = answers[0]
    if not good:
        raise answer  # type: ignore[misc]
    return answer


@dataclass
class Supervised:
    """A controller whose failures do not reach the valves. Raises ControllerError with a sentence.

    patience [s]: wall time that one answer may take.
    """

    controller: WheelSlideController
    wheelsets: int
    patience: float = 1.0

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Valve commands of the controller. Raises ControllerError where it fails, is late or gives others."""
        name = type(self.controller).__name__
        try:
            answer = within(self.patience, lambda: list(self.controller.step(time, wheel_speeds)))
        except _LateError:
            raise ControllerError(
                f"The controller {name} gave no answer within {self.patience:g} s at {time:.6g} s; the brake stays "
                "applied."
            ) from None
        except Exception as error:
            raise ControllerError(
                f"The controller {name} failed at {time:.6g} s ({type(error).__name__}: {error}); the brake stays "
                "applied."
            ) from error
        assert isinstance(answer, list)
        if len(answer) != self.wheelsets or any(command not in COMMANDS for command in answer):
            raise ControllerError(
                f"The controller {name} gave {answer!r} at {time:.6g} s where {self.wheelsets} commands of 0 (apply), "
                "1 (hold) or 2 (vent) were due; the brake stays applied."
            )
        return [int(command) for command in answer]
