"""Test wheel-slide protection on wheels with known motion, its sensors, and controllers that fail."""

from __future__ import annotations

import copy
import hashlib
import json
import math
import pickle
import random
import threading
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any

import pytest

from brake_controller.slide_protection import common_protection
from brake_controller.wheel_slide import APPLY, HOLD, VENT, ControllerError, NotJudgedError, Supervised
from products.protection.slide_protection import SlideProtection
from tests.encoder import Encoder

PERIOD = 5e-3
#: Deceleration of a wheelset at full brake without a rail: 20 kN.m over its inertia, times the radius [m/s2].
LOCKING = 100.0


def played(
    speeds: Callable[[float], Sequence[float]], seconds: float, protection: SlideProtection | None = None
) -> list[tuple[float, list[int]]]:
    """Return times and commands of a protection that receives these speeds."""
    protection = protection or SlideProtection()
    found = []
    for number in range(round(seconds / PERIOD)):
        time = number * PERIOD
        found.append((time, protection.step(time, speeds(time))))
    return found


def test_wheels_that_roll_with_the_bogie_stay_braked() -> None:
    commands = played(lambda time: [25.0 - 1.2 * time] * 2, 10.0)
    assert all(command == [APPLY, APPLY] for _, command in commands)


def test_a_wheel_that_slides_away_is_vented_and_the_other_is_not() -> None:
    def speeds(time: float) -> Sequence[float]:
        rolling = 25.0 - 0.8 * time
        return [rolling, rolling - max(0.0, 8.0 * (time - 2.0))]

    commands = played(speeds, 3.0)
    vented = [time for time, (_, trailing) in commands if trailing == VENT]
    # At a slip of 12 %: the protection acts after it has evidence, 8 % seen through a filter.
    assert 2.0 < vented[0] < 2.4
    assert all(leading == APPLY for _, (leading, _) in commands)


def test_slip_within_the_band_is_held() -> None:
    middle = (common_protection().lower_slip + common_protection().upper_slip) / 2

    def speeds(time: float) -> Sequence[float]:
        rolling = 20.0 - 0.5 * time
        slip = 2.5 if 2.0 < time < 3.0 else middle if time > 2.0 else 0.0  # first large enough to be evidence [m/s]
        return [rolling, rolling - slip]

    # These wheels do not respond to their valves: later they are taken for wheels that roll.
    commands = [command for time, (_, command) in played(speeds, 6.0) if 3.2 < time < 5.0]
    assert commands.count(HOLD) > 0.85 * len(commands)
    assert VENT not in commands


def creep_force(slip: float) -> float:
    """Return the force of a wheelset [N] at a slip speed [m/s]: linear to 0.3 m/s, then falling by 40 % in the end."""
    return 4700.0 * min(slip / 0.3, 1.0) * (1.0 - 0.4 * (1.0 - math.exp(-0.2 * slip)))


def test_reference_follows_the_true_speed_though_all_wheels_slide() -> None:
    """Two wheelsets of 6 t each, 560 kg of them rotating, brakes of 8 kN that fill in 2 s and empty within 0.4 s.

    All wheels slide together, as their brakes are equal. The creep force is that of a friction of 0.08.
    """
    protection, true, speeds, brakes = SlideProtection(), 25.0, [25.0, 25.0], [0.0, 0.0]
    slid, vented, worst = 0, 0, 0.0
    for number in range(round(25.0 / PERIOD)):
        commands = protection.step(number * PERIOD, speeds)
        forces = [creep_force(true - speed) for speed in speeds]
        for wheel, command in enumerate(commands):
            rate = {APPLY: 4000.0 if number * PERIOD > 1.0 else 0.0, HOLD: 0.0, VENT: -brakes[wheel] / 0.4}[command]
            brakes[wheel] = min(max(brakes[wheel] + PERIOD * rate, 0.0), 8000.0)
            speeds[wheel] += PERIOD * (forces[wheel] - brakes[wheel]) / 560.0
        true -= PERIOD * sum(forces) / 12e3
        slid += true - max(speeds) > 0.3
        vented += VENT in commands
        if number * PERIOD > 6.0:  # at first all slide, and nothing shows the true speed
            worst = max(worst, abs(protection.reference - true) / true)
        assert true - min(speeds) < 0.2 * true
    assert vented > 0
    assert slid > 100
    assert worst < 0.05
    # The largest force of both would give 0.78 m/s2.
    assert 25.0 - true > 0.9 * 0.78 * 23.0


def test_venting_ends_with_the_watchdog() -> None:
    """A wheel that remains at rest must not keep its brake released."""
    p = common_protection()
    commands = played(
        lambda time: [20.0 - 0.1 * time, max(20.0 - LOCKING * max(time - 1.0, 0.0), 0.0)], 1.5 + 2.2 * p.watchdog
    )
    vented = [time for time, (_, trailing) in commands if trailing == VENT]
    stretch = vented[0]
    for before, after in pairwise(vented):
        if after - before > 1.5 * PERIOD:
            stretch = after
        assert after - stretch <= p.watchdog + PERIOD


FAILURES = {
    "zero": lambda time, true: 0.0 if time > 3.0 else true,
    "doubled": lambda time, true: 2.0 * true if time > 3.0 else true,
    "stuck": lambda time, true: 17.0 if time > 3.0 else true,
    "dead": lambda time, true: 0.0,
}


@pytest.mark.parametrize("failure", FAILURES)
def test_a_sensor_that_shows_what_no_wheel_does_moves_no_valve(failure: str) -> None:
    """All wheels roll at 1 m/s2; the other sensors show that."""
    commands = played(lambda time: [20.0 - time, FAILURES[failure](time, 20.0 - time)], 12.0)
    assert all(command == [APPLY, APPLY] for time, command in commands if time > 5.0)
    assert sum(command != [APPLY, APPLY] for _, command in commands) * PERIOD < 1.0


def test_a_sensor_that_agrees_again_is_believed_again() -> None:
    def speeds(time: float) -> list[float]:
        true = 20.0 - time
        slides = max(true - LOCKING * max(time - 8.0, 0.0), 0.0)
        return [true, 0.0 if 3.0 < time < 4.0 else slides]

    commands = played(speeds, 9.0)
    assert any(command[1] == VENT for time, command in commands if time > 8.0)
    assert all(command == [APPLY, APPLY] for time, command in commands if 5.0 < time < 8.0)


def test_a_wheel_that_locks_as_fast_as_one_can_is_believed() -> None:
    commands = played(lambda time: [20.0, max(20.0 - LOCKING * max(time - 2.0, 0.0), 0.0)], 3.0)
    assert sum(command[1] == VENT for _, command in commands) * PERIOD > 0.5


def test_standing_wheels_stay_braked() -> None:
    assert all(command == [APPLY, APPLY] for _, command in played(lambda time: [0.0, 0.0], 1.0))


@pytest.mark.parametrize(
    ("name", "value"), [("lower_slip", -0.1), ("upper_slip", math.nan), ("lead_time", -1.0), ("watchdog", math.inf)]
)
def test_unphysical_thresholds_are_refused_with_name_value_and_limit(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} must be finite and at least 0; got {value}"):
        replace(common_protection(), **{name: value})


def test_thresholds_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(ValueError, match=r"upper_slip must be above lower_slip, 0\.2; got 0\.1"):
        replace(common_protection(), lower_slip=0.2, upper_slip=0.1)


#: Teeth of the sensors; the last number is that of the encoders of the experiment.
TEETH = (80, 100, 128, 10000)


# ---- readings of rolling and sliding wheels --------------------------------------------------------------------------


def commands_of_a_rolling_stop(
    speed: float, slows: float, teeth: int = 100, jitter: float = 0.0, period: float = PERIOD, error: float = 0.0
) -> int:
    """Count the commands other than APPLY to two wheels that roll to rest; error: relative, of the radius of the second
    one.
    """
    encoders = [Encoder(teeth, jitter, seed) for seed in (1, 2)]
    protection, stands, radius = SlideProtection(), speed / slows, 0.46
    count = 0
    for number in range(round((stands + 1.0) / period)):
        time = number * period
        run = min(time, stands)
        way = speed * run - slows * run**2 / 2.0
        angles = [way / radius, 0.3 + way / (radius * (1.0 - error))]
        seen = [radius * one.angular_velocity(time, angle) for one, angle in zip(encoders, angles, strict=True)]
        count += sum(command != APPLY for command in protection.step(time, seen))
    return count


@pytest.mark.parametrize(
    "given",
    [
        *({"slows": slows} for slows in (0.5, 1.2, 2.2, 3.0, 4.0)),
        *({"teeth": teeth, "jitter": 0.1, "period": period} for teeth in TEETH for period in (5e-3, 2e-2)),
        *({"speed": v, "slows": 3.0, "period": period} for v, period in ((10.0, 2e-3), (40.0, 2e-2), (60.0, 1e-2))),
        *({"speed": 40.0, "jitter": 0.1, "error": error} for error in (-0.01, 0.01)),
    ],
    ids=str,
)
def test_wheels_that_roll_are_left_alone(given: dict[str, Any]) -> None:
    """At any deceleration, by any sensor, from any speed at any period, with wheels of different radii."""
    assert commands_of_a_rolling_stop(**{"speed": 25.0, "slows": 2.2, **given}) == 0


@pytest.mark.long
@pytest.mark.parametrize("slows", [0.5, 1.0, 2.2, 4.0])
@pytest.mark.parametrize("speed", [10.0, 25.0, 60.0])
@pytest.mark.parametrize("jitter", [0.0, 0.1, 0.2])
def test_wheels_that_roll_are_left_alone_at_length(slows: float, speed: float, jitter: float) -> None:
    """Tooth errors of 0.2 of the pitch are too large for a sampling interval of 20 ms only (docs/limits.md)."""
    for teeth in TEETH:
        for period in (2e-3, 5e-3) if jitter > 0.1 else (2e-3, 5e-3, 2e-2):
            assert commands_of_a_rolling_stop(speed, slows, teeth, jitter, period, error=0.01) == 0


@dataclass
class EqualWheels:
    """Two wheels with the same load and rail under a mass: a bogie whose wheels can only slide together.

    Per mass on a wheel: friction falls with the sliding speed w by (1 - ratio) exp(-decay w) + ratio, and is reached at
    1 % of slip. The brake, torque over radius and mass, exceeds it by the share `excess`. The rotary inertia of a wheel
    is 1/40 of its load.
    """

    excess: float
    ratio: float
    friction: float = 0.08
    decay: float = 0.2

    def stop(self, controller: SlideProtection | None, speed: float = 25.0) -> tuple[float, float]:
        """Return the distance to 0.05 m/s [m], and the longest lock above 0.5 m/s [s]."""
        size, radius, light, best = 5e-4, 0.46, 40.0, 9.81 * self.friction
        rims, angles, shares, encoders = [speed] * 2, [0.0] * 2, [0.0] * 2, [Encoder(), Encoder()]
        commands, locked, longest, way = [APPLY] * 2, [0.0] * 2, 0.0, 0.0
        for number in range(round(150.0 / size)):
            if controller and number % round(PERIOD / size) == 0:
                time = number * size
                seen = [radius * e.angular_velocity(time, a) for e, a in zip(encoders, angles, strict=True)]
                commands = controller.step(time, seen)
            pull = 0.0
            for one in range(2):
                rate = {APPLY: (1.0 - shares[one]) / 0.67, HOLD: 0.0, VENT: -shares[one] / 0.2}[commands[one]]
                shares[one] += size * rate
                sliding = speed - rims[one]
                fall = (1.0 - self.ratio) * math.exp(-self.decay * abs(sliding)) + self.ratio
                force = best * fall * max(-1.0, min(1.0, sliding / (0.01 * max(speed, 1.0))))
                rims[one] = max(0.0, rims[one] + size * light * (force - (1.0 + self.excess) * best * shares[one]))
                angles[one] += size * rims[one] / radius
                locked[one] = locked[one] + size if rims[one] == 0.0 and speed > 0.5 else 0.0
                longest, pull = max(longest, locked[one]), pull + force / 2.0
            speed, way = speed - size * pull, way + size * speed
            if speed < 0.05:
                break
        return way, longest


#: Limit of the longest lock [s], and of the distance over that at the best friction with an immediately full brake
#: (rails.py).
LONGEST_LOCK, OVER_IDEAL = 0.4, 1.25


@pytest.mark.study
@pytest.mark.parametrize("excess", [0.005, 0.05])
def test_a_slow_slide_of_all_wheels_together_is_caught_where_friction_falls(excess: float) -> None:
    """No wheel differs from another. Detection relies on falling friction: wheels slow faster than any rail allows."""
    wheels = EqualWheels(excess, ratio=0.4)
    ideal = 25.0**2 / 2.0 / (9.81 * wheels.friction) + 25.0 * 0.67
    way, lock = wheels.stop(SlideProtection())
    assert lock <= LONGEST_LOCK
    assert way < OVER_IDEAL * ideal
    assert wheels.stop(None)[1] > 10.0


def test_a_slow_slide_of_equal_wheels_where_friction_does_not_fall_is_not_seen_and_costs_no_distance() -> None:
    """A limit stated in docs/limits.md: the readings are those of a harder brake."""
    wheels = EqualWheels(0.05, ratio=1.0)
    protection = SlideProtection()
    way, lock = wheels.stop(protection)
    assert lock > LONGEST_LOCK
    assert way <= wheels.stop(None)[0] * (1.0 + 1e-9)
    assert way < 25.0**2 / 2.0 / (9.81 * wheels.friction) + 25.0 * 0.67


def test_below_the_slowest_speed_the_brake_applies_whatever_the_wheels_do() -> None:
    slowest = common_protection().slowest

    def speeds(time: float) -> Sequence[float]:
        bogie = max(0.5 * slowest, 5.0 - 0.6 * time)
        return [bogie, 0.5 * bogie if time > 1.0 else bogie]

    found = played(speeds, 12.0)
    assert any(VENT in commands for _, commands in found)
    assert all(commands == [APPLY, APPLY] for time, commands in found if time > 9.0)


def test_a_sensor_that_never_showed_a_speed_leaves_its_wheel_braked() -> None:
    """Its brake fills a little later than that of its neighbour, and completely."""
    commands = played(lambda time: [max(0.0, 20.0 - 0.8 * time), 0.0], 20.0)
    assert all(first == APPLY and second != VENT for _, (first, second) in commands)
    assert all(command == [APPLY, APPLY] for time, command in commands if time > 4.0)
    assert 0.1 < sum(second == HOLD for _, (_, second) in commands) * PERIOD < 1.5


# ---- all commands ----------------------------------------------------------------------------------------------------


#: Recorded hash of the commands on random histories. It detects a change of any command, but not a wrong one. An
#: implementation of the protection in Python gave the same commands on ten thousand such histories.
COMMANDS = "5704f589a0fd589e"
#: Readings of failed sensors as functions of the true speed.
SHOWN: dict[str, Callable[[float], float]] = {
    "zero": lambda speed: 0.0,
    "stuck": lambda speed: 7.0,
    "doubled": lambda speed: 2.0 * speed,
    "halved": lambda speed: 0.5 * speed,
}


def history(number: int) -> Iterator[tuple[float, list[float]]]:
    """Yield times and speeds of up to 16 wheels that slide at random; sensors of some fail for a while."""
    draw = random.Random(number)
    speed, slows, slips = draw.uniform(5.0, 60.0), draw.uniform(0.0, 3.0), [0.0] * draw.randint(1, 16)
    rates = [0.0] * len(slips)
    fails = [(draw.choice([*SHOWN, *[""] * 4]), draw.uniform(0.0, 8.0)) for _ in slips]
    for look in range(1600):
        time, seen = look * PERIOD, list[float]()
        for wheel, (kind, begins) in enumerate(fails):
            rates[wheel] = draw.uniform(-2.0, 2.0) if draw.random() < 0.01 else rates[wheel]
            slips[wheel] = min(max(slips[wheel] + PERIOD * rates[wheel], 0.0), 1.0)
            true = max(speed - slows * time, 0.0) * (1.0 - slips[wheel])
            seen.append(SHOWN[kind](true) if kind and 0.0 < time - begins < 3.0 else true)
        yield time, seen


@pytest.mark.parametrize("shown", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("lost", [0, 1])
def test_a_sensor_that_shows_no_number_takes_no_protection_from_the_others(lost: int, shown: float) -> None:
    """The third wheel slides after the sensor of another is lost. It is vented; the reference speed remains correct."""

    def speeds(time: float) -> list[float]:
        true = 30.0 - 1.0 * time
        slides = true * (1.0 - min(max(time - 6.0, 0.0), 0.5))
        found = [true, true, slides, true]
        return [shown if number == lost and time > 3.0 else one for number, one in enumerate(found)]

    protection = SlideProtection()
    found = [(n * PERIOD, protection.step(n * PERIOD, speeds(n * PERIOD))) for n in range(1600)]
    assert all(set(commands) == {APPLY} for time, commands in found if time < 6.0)
    assert any(commands[2] == VENT for time, commands in found if 6.0 < time < 7.0)
    assert all(commands[n] == APPLY for _, commands in found for n in (1 - lost, 3))
    assert protection.believed == [number != lost for number in range(4)]
    assert 0.9 < protection.reference / 22.0 < 1.1


def test_commands_on_drawn_histories_are_those_that_were_recorded() -> None:
    """Every third history uses thresholds of a tenth to ten times the common ones."""
    found = hashlib.sha256()
    for number in range(24):
        draw, common = random.Random(-number - 1), common_protection()
        given = {one.name: getattr(common, one.name) * (0.1 + 9.9 * draw.random()) for one in fields(common)}
        given["upper_slip"] += given["lower_slip"]
        protection = SlideProtection(replace(common, **given) if number % 3 == 0 else None)
        for time, speeds in history(number):
            found.update(bytes(protection.step(time, speeds)))
    assert found.hexdigest()[:16] == COMMANDS


def test_a_copy_goes_on_where_the_protection_stands() -> None:
    looks = list(history(3))
    protection = SlideProtection()
    for time, speeds in looks[:800]:
        protection.step(time, speeds)
    copies = [pickle.loads(pickle.dumps(protection)), copy.deepcopy(protection)]
    for time, speeds in looks[800:]:
        found = protection.step(time, speeds)
        assert [one.step(time, speeds) for one in copies] == [found, found]


def test_another_number_of_wheels_is_refused() -> None:
    protection = SlideProtection()
    with pytest.raises(ValueError, match="wheel_speeds must be at least 1 number; got 0"):
        protection.step(0.0, [])
    protection.step(0.0, [1.0, 1.0])
    with pytest.raises(ValueError, match="wheel_speeds must be 2 numbers; got 1"):
        protection.step(PERIOD, [1.0])


# ---- controllers that fail -------------------------------------------------------------------------------------------


class Raises:
    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        raise ZeroDivisionError("division by zero")


class CallsWhatRaises:
    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        return list(json.loads("no list"))


class Nonsense:
    def __init__(self, answer: object) -> None:
        self.answer = answer

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        return self.answer  # type: ignore[return-value]


class Stalls:
    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        while True:
            pass


def test_controller_that_raises_is_named_with_its_error() -> None:
    """The message also has the last line of the controller's own file, even if the exception comes from a callee
    elsewhere.
    """
    line = Raises.step.__code__.co_firstlineno + 1
    where = rf"test_wheel_slide.py, line {line}\); the brake stays applied"
    with pytest.raises(ControllerError, match=rf"The controller Raises failed at 0.5 s .*division by zero, {where}"):
        Supervised(Raises(), 2).step(0.5, [10.0, 10.0])
    line = CallsWhatRaises.step.__code__.co_firstlineno + 1
    with pytest.raises(ControllerError, match=rf"JSONDecodeError: .*, test_wheel_slide.py, line {line}\)"):
        Supervised(CallsWhatRaises(), 2).step(0.5, [10.0, 10.0])


@pytest.mark.parametrize("answer", [None, 3, [], [0], [0, 0, 0], [0, 3], [0, 1.5], ["apply", "vent"], [0, math.nan]])
def test_controller_that_returns_nonsense_is_refused(answer: object) -> None:
    with pytest.raises(ControllerError, match=r"The controller Nonsense .* the brake stays applied"):
        Supervised(Nonsense(answer), 2).step(0.5, [10.0, 10.0])


class Waits:
    """Use little processor time and answer after a wall time [s], as on a loaded computer."""

    def __init__(self, wait: float) -> None:
        self.wait = wait

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        clock.sleep(self.wait)
        return [APPLY, VENT]


class Computes:
    """Use this much processor time [s]."""

    def __init__(self, used: float) -> None:
        self.used = used

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        begin = clock.thread_time()
        while clock.thread_time() - begin < self.used:
            pass
        return [APPLY, VENT]


def here(call: Callable[[], object]) -> object:
    """Call in the main thread, which receives signals."""
    return call()


def elsewhere(call: Callable[[], object]) -> object:
    """Call in another thread, as a program with a user interface does."""
    found: list[object] = []

    def work() -> None:
        try:
            found.append(call())
        except ControllerError as error:
            found.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    if isinstance(found[0], ControllerError):
        raise found[0]
    return found[0]


THREADS = pytest.mark.parametrize("where", [here, elsewhere])


@THREADS
def test_a_controller_that_waits_is_judged_by_its_answer(where: Callable[..., object]) -> None:
    """It takes three times the limit of wall time, as it may while other processes use the processor."""
    supervised = Supervised(Waits(0.3), 2, patience=0.1)
    assert where(lambda: supervised.step(0.5, [10.0, 10.0])) == [APPLY, VENT]


@pytest.mark.study
@THREADS
@pytest.mark.parametrize("controller", [Stalls(), Computes(0.3)], ids=["for ever", "and answers"])
def test_a_controller_that_uses_too_much_processor_time_fails(controller: object, where: Callable[..., object]) -> None:
    supervised = Supervised(controller, 2, patience=0.1)  # type: ignore[arg-type]
    words = r"used more than 0.1 s of processor time for its answer at 0.5 s; the brake stays applied"
    with pytest.raises(ControllerError, match=words) as raised:
        where(lambda: supervised.step(0.5, [10.0, 10.0]))
    assert not isinstance(raised.value, NotJudgedError)
    if where is here:
        assert Supervised(Computes(0.05), 2, patience=0.1).step(0.5, [10.0, 10.0]) == [APPLY, VENT]


@THREADS
def test_a_controller_that_waits_for_ever_is_not_judged(where: Callable[..., object]) -> None:
    supervised = Supervised(Waits(3.0), 2, patience=0.1, guard=0.3)
    words = r"The controller Waits gave no answer within 0.3 s of wall time at 0.5 s and is not judged. Remove what"
    with pytest.raises(NotJudgedError, match=words):
        where(lambda: supervised.step(0.5, [10.0, 10.0]))


def test_a_good_controller_passes_unchanged() -> None:
    assert Supervised(Nonsense((0, 2)), 2).step(0.0, [1.0, 1.0]) == [APPLY, VENT]
