"""Wheel-slide protection: from the speeds of the wheels to commands for the valves of the brake cylinders.

A controller is any object with `step(time, wheel_speeds) -> valve commands`. `SlideProtection` is the one that comes
with the brake; `Supervised` stands between any controller and the valves and keeps the brake applied when it fails.
"""

import math
import os
import signal
import threading
import time as clock
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields
from typing import Any, Protocol

#: What a valve does, as the input `valve` of the brake cylinder. This file needs nothing but Python, so that it can
#: travel inside an FMU.
APPLY, HOLD, VENT = 0, 1, 2
COMMANDS = (APPLY, HOLD, VENT)
#: Acceleration below which a wheel let go has caught up with the bogie, and above which it speeds up [m/s2].
ROLLING, SPEEDING = 0.3, 0.6
#: Gain of speed that only a wheel shows which had slid, as a share of its speed.
GAIN = 0.02
#: Share of the speed by which all wheels fall behind what any rail allows when they slide together.
TOGETHER = 0.02
#: Times of venting after which a wheel is believed to roll, where it was seen to speed up and where not [s].
SHORTEST_RELEASE, LONGEST_RELEASE = 0.25, 0.8
#: Time of braking without a command after which the wheels may show that the bogie slows faster than it did [s].
FREELY_BRAKED = 0.3
#: Time between two true speeds that gives a deceleration [s], and the least that is believed [m/s2].
SHORTEST_BETWEEN, LEAST_DECELERATION = 0.5, 0.1
#: Time for which a sensor is only listened to, between speeds that are kept while nothing slides, and from the first
#: true speed of a slide to the second [s].
SETTLING, KEEPING, SECOND_LOOK = 0.5, 1.0, 1.5
#: A sensor that shows what no wheel does is not believed. Change of the largest of so many readings from one look to
#: the next [m/s], and more of it for each second between [m/s2]: the strongest brake stops a wheel at some 100 m/s2,
#: and a tooth that comes late is seen as slowness at few looks on end.
RECENT, JUMP, JUMPING = 5, 4.0, 150.0
#: Time for which a reading stays the same to the last digit [s], while others change by so much [m/s].
STAYING, STAYS = 0.3, 0.5
#: Time for which others have turned [s], and faster than this [m/s], while a sensor has shown nothing.
BLIND, BLIND_ABOVE = 1.0, 3.0
#: Share of the speed, and time [s], for which a sensor must agree with the others to be believed again.
AGREES, AGREEING = 0.05, 2.0


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


@dataclass(frozen=True)
class SlideProtectionParameters:
    """Thresholds of `SlideProtection`; all finite and not below 0."""

    #: Slip below which the brake is applied further, and above which it is vented; in between it is held [1].
    lower_slip: float
    upper_slip: float
    #: The upper slip in m/s at low speed, below which wheels are not told apart.
    least_slip: float
    #: Slip that is evidence of sliding [1], and the same in m/s at low speed.
    evident_slip: float
    least_evident_slip: float
    #: Time by which a change of slip is anticipated, and time constants of the filters on speeds and slopes [s].
    lead_time: float
    filter_time: float
    slope_time: float
    #: Time constant of the calmer speeds that evidence, the reference and its gains are taken from [s].
    calm_time: float
    #: Deceleration that wheels which roll exceed on no rail [m/s2].
    largest_deceleration: float
    #: Longest time of sliding without a look at the true speed, and longest time of venting at a stretch [s].
    synchronising_period: float
    watchdog: float
    #: Reference speed below which no wheel is protected: all brakes apply [m/s].
    slowest: float

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"Set {item.name} to a finite value of at least 0: it was {value}.")
        if not self.upper_slip > self.lower_slip:
            raise ValueError(f"Set upper_slip above lower_slip, {self.lower_slip}: it was {self.upper_slip}.")


def common_protection() -> SlideProtectionParameters:
    """Assumed throughout, and chosen on half of the rails of scenarios/bench/rail_programme.py; docs/fitted.md has how.

    The slip is that of (2.10), with the reference speed as that of the car.
    """
    return SlideProtectionParameters(
        lower_slip=0.05,
        upper_slip=0.10,
        least_slip=0.3,
        evident_slip=0.08,
        least_evident_slip=0.6,
        lead_time=0.1,
        filter_time=0.02,
        slope_time=0.03,
        calm_time=0.08,
        largest_deceleration=4.4,
        synchronising_period=4.0,
        watchdog=5.0,
        slowest=0.3,
    )


@dataclass
class _Wheel:
    """What the protection knows of a wheelset: speeds [m/s] and slopes [m/s2], filtered; times [s] of what happened."""

    reading: float = 0.0
    speed: float = 0.0
    acceleration: float = 0.0
    calm_speed: float = 0.0
    calm_acceleration: float = 0.0
    lowest: float = 0.0
    turns_since: float | None = None
    vents_since: float | None = None
    speeds_up: bool = False
    blocked_until: float = -math.inf
    believed: bool = True
    #: The last readings; when the reading last changed, and the fastest other wheel then; since when a sensor that is
    #: not believed agrees with the others.
    recent: tuple[float, ...] = ()
    changed_at: float = -math.inf
    others: float = 0.0
    agrees_since: float | None = None


@dataclass
class SlideProtection:
    """Holds the slip of each wheelset in a band around that of the best adhesion, once there is evidence of sliding.

    Without evidence the reference speed is that of the fastest wheel, at any deceleration that wheels which roll reach
    on any rail, and no valve leaves "apply". Evidence is a wheel that falls behind the reference: it disagrees with
    another wheel, or all slow faster than any rail allows. From then on the reference falls as fast as the bogie last
    did, and a wheelset is released until it rolls and shows the true speed: at once the slowest, later, from time to
    time, the fastest. Where no wheel has gained speed since the last such release, as braked wheels that roll never do,
    the evidence ends.

    A wheel whose sensor has not yet shown a speed for a while is braked, and so are all below the slowest reference.
    One whose sensor shows what no wheel does gets the commands of the others, until it agrees with them again.
    """

    parameters: SlideProtectionParameters = field(default_factory=common_protection)
    time: float | None = None
    wheels: list[_Wheel] = field(default_factory=list)
    reference: float = 0.0
    deceleration: float = 0.0
    evident: bool = False
    evident_at: float = -math.inf
    gained: bool = False
    looks: int = 0
    synchronised_at: float = 0.0
    synchronised_speed: float = 0.0
    kept_at: float = 0.0
    kept_speed: float = 0.0
    released: int | None = None
    acted_at: float = -math.inf

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Valve commands, as `WheelSlideController` has them."""
        if self.time is None:
            self.wheels = [_Wheel() for _ in wheel_speeds]
        size = 0.0 if self.time is None else time - self.time
        self.time = time
        for wheel, speed in zip(self.wheels, wheel_speeds, strict=True):
            self._believe(wheel, speed, size)
            self._filter(wheel, speed, size)
        fastest = max(self._seen, key=lambda wheel: wheel.calm_speed)
        if self.evident:
            self._slide(size, fastest)
        else:
            self._roll(size, fastest)
        commands = {number: self._command(time, number) for number, wheel in enumerate(self.wheels) if wheel.believed}
        most = max(commands.values(), default=APPLY)
        return [commands.get(number, most) for number in range(len(self.wheels))]

    @property
    def _seen(self) -> list[_Wheel]:
        """The wheels whose sensors are believed; all, where none is."""
        return [wheel for wheel in self.wheels if wheel.believed] or self.wheels

    def _believe(self, wheel: _Wheel, speed: float, size: float) -> None:
        """Looks whether a sensor shows what no wheel does: a jump, the same while others change, nothing at all."""
        others = max((one.calm_speed for one in self.wheels if one.believed and one is not wheel), default=None)
        if size == 0.0 or others is None:
            return
        assert self.time is not None
        if wheel.turns_since is None:
            running = [one.turns_since for one in self.wheels if one.turns_since is not None]
            wheel.believed = not (running and self.time - min(running) > BLIND and others > BLIND_ABOVE)
            return
        if not wheel.believed:
            self._agree(wheel, speed, others)
            return
        if speed != wheel.reading or speed == 0.0 or not wheel.recent:
            wheel.changed_at, wheel.others = self.time, others
        before, wheel.recent = wheel.recent, (*wheel.recent, speed)[-RECENT:]
        jumps = len(before) == RECENT and abs(max(wheel.recent) - max(before)) > JUMP + JUMPING * size
        stays = self.time - wheel.changed_at > STAYING and abs(others - wheel.others) > STAYS
        if jumps or stays:
            wheel.believed, wheel.agrees_since, self.released = False, None, None
            # Evidence that came while the sensor failed was its own.
            self.evident = self.evident and self.time - self.evident_at > (RECENT + 0.5) * size

    def _agree(self, wheel: _Wheel, speed: float, others: float) -> None:
        """A sensor that agrees with the others for a while, and changes, is believed again."""
        assert self.time is not None
        if speed == wheel.reading or abs(wheel.calm_speed - others) > AGREES * others:
            wheel.agrees_since = None
        elif wheel.agrees_since is None:
            wheel.agrees_since = self.time
        elif self.time - wheel.agrees_since > AGREEING:
            wheel.believed, wheel.recent = True, ()

    def _filter(self, wheel: _Wheel, speed: float, size: float) -> None:
        """Takes a reading; a wheel whose sensor has shown nothing yet starts with the first that it shows."""
        p = self.parameters
        if wheel.turns_since is None:
            wheel.turns_since = self.time if speed > 0.0 else None
            wheel.speed = wheel.calm_speed = wheel.lowest = speed
        elif size > 0.0:
            change = (speed - wheel.speed) * size / (size + p.filter_time)
            wheel.speed += change
            wheel.acceleration += (change / size - wheel.acceleration) * size / (size + p.slope_time)
            share = size / (size + p.calm_time)
            # A tooth that comes late is seen as slowness at one look; a wheel that slows is slow at the next one too.
            change = (max(speed, wheel.reading) - wheel.calm_speed) * share
            wheel.calm_speed += change
            wheel.calm_acceleration += (change / size - wheel.calm_acceleration) * share
        wheel.reading = speed

    def _roll(self, size: float, fastest: _Wheel) -> None:
        """No wheel has slid: the reference is the fastest one's speed, and falls no faster than any rail allows."""
        assert self.time is not None
        p, before = self.parameters, self.reference
        self.reference = max(fastest.calm_speed, before - p.largest_deceleration * size)
        self._keep(self.reference)
        apart = max(p.evident_slip * self.reference, p.least_evident_slip)
        together = max(TOGETHER * self.reference, p.least_evident_slip)
        behind = [self.reference - wheel.calm_speed for wheel in self._seen if self._is_judged(wheel)]
        if behind and (max(behind) > apart or min(behind) > together):
            self.evident = self.gained = True
            self.evident_at = self.time
            self.looks = 0
            self._measure(self.reference)

    def _keep(self, speed: float) -> None:
        """Keeps a speed every now and then; the one before the last was true though a slide may have begun since."""
        assert self.time is not None
        if self.kept_speed > 0.0 and self.time - self.kept_at < KEEPING:
            return
        known = self.kept_speed > 0.0
        self.synchronised_at = self.kept_at if known else self.time
        self.synchronised_speed = self.kept_speed if known else speed
        self.kept_at, self.kept_speed = self.time, speed

    def _slide(self, size: float, fastest: _Wheel) -> None:
        """Wheels slide: the reference falls as fast as the bogie last did, until a wheel that is let go rolls."""
        falls = self._known_deceleration(fastest)
        self.reference = max(fastest.calm_speed, self.reference - falls * size)
        for wheel in self._seen:
            self._look_for_gain(wheel)
        caught_up = [wheel.calm_speed for wheel in self._seen if self._has_caught_up(wheel)]
        if caught_up:
            self._synchronise(max(caught_up))
        if self.reference < self.parameters.slowest:
            self.evident, self.released = False, None

    def _is_judged(self, wheel: _Wheel) -> bool:
        """Whether its sensor has shown something for a while."""
        return wheel.turns_since is not None and self.time is not None and self.time - wheel.turns_since > SETTLING

    def _known_deceleration(self, fastest: _Wheel) -> float:
        """As the bogie last slowed, or as the fastest wheel does while all are braked freely [m/s2]."""
        assert self.time is not None
        if self.time - self.acted_at < FREELY_BRAKED:
            return self.deceleration
        return max(self.deceleration, self._believed(-fastest.calm_acceleration))

    def _believed(self, deceleration: float) -> float:
        """A deceleration within what can be [m/s2]."""
        return min(max(deceleration, LEAST_DECELERATION), self.parameters.largest_deceleration)

    def _look_for_gain(self, wheel: _Wheel) -> None:
        """Remembers that a wheel has gained speed since the last true speed, or since it was let go."""
        p = self.parameters
        wheel.lowest = min(wheel.lowest, wheel.calm_speed)
        gain = GAIN * max(wheel.calm_speed, p.least_slip / p.upper_slip)
        if wheel.calm_acceleration > SPEEDING and wheel.calm_speed - wheel.lowest > gain:
            self.gained = wheel.speeds_up = True

    def _has_caught_up(self, wheel: _Wheel) -> bool:
        """A wheel that is vented speeds up until it rolls; one that never slid is believed after a while."""
        assert self.time is not None
        if wheel.vents_since is None:
            return False
        longest = SHORTEST_RELEASE if wheel.speeds_up else LONGEST_RELEASE
        return wheel.calm_acceleration < ROLLING and self.time - wheel.vents_since > longest

    def _synchronise(self, speed: float) -> None:
        """Takes the true speed, and from two of them the deceleration of the bogie."""
        assert self.time is not None
        if self.looks == 0 or self.time - self.synchronised_at > SHORTEST_BETWEEN:
            self._measure(speed)
            self.synchronised_at, self.synchronised_speed = self.kept_at, self.kept_speed = self.time, speed
            self.looks += 1
            p = self.parameters
            # The first two follow too soon for wheels to slide in between; slowly run wheels lock before new evidence.
            if self.looks > 2 and speed > p.least_slip / p.upper_slip:
                self.evident, self.gained = self.gained, False
            for wheel in self.wheels:
                wheel.lowest = wheel.calm_speed
        self.reference, self.released = speed, None

    def _measure(self, speed: float) -> None:
        """The mean deceleration since the last true speed."""
        assert self.time is not None
        elapsed = max(self.time - self.synchronised_at, SHORTEST_BETWEEN)
        self.deceleration = self._believed((self.synchronised_speed - speed) / elapsed)

    def _command(self, time: float, number: int) -> int:
        p, wheel = self.parameters, self.wheels[number]
        if not (self.evident and self._is_judged(wheel)) or self.reference < p.slowest or time < wheel.blocked_until:
            wheel.vents_since = None
            return APPLY
        command = VENT if self._is_released(time, number) else self._by_slip(wheel)
        if command != APPLY:
            self.acted_at = time
        if command != VENT:
            wheel.vents_since = None
        elif wheel.vents_since is None:
            wheel.vents_since, wheel.speeds_up, wheel.lowest = time, False, wheel.calm_speed
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
        """Whether this wheelset is the one that is let go so that it shows the true speed: first one that slides."""
        period = self.parameters.synchronising_period
        due = 0.0 if self.looks == 0 else SECOND_LOOK if self.looks == 1 else period
        if self.released is None and time - self.synchronised_at > due:
            choose = max if self.looks else min
            seen = [number for number, wheel in enumerate(self.wheels) if wheel.believed] or range(len(self.wheels))
            self.released = choose(seen, key=lambda one: self.wheels[one].calm_speed)
        return self.released == number


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
