"""Wheel-slide protection on wheels whose motion is known, its sensors, and controllers that fail."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import pytest

from brake_controller.sensors import Encoder
from brake_controller.wheel_slide import (
    APPLY,
    HOLD,
    VENT,
    ControllerError,
    SlideProtection,
    Supervised,
    common_protection,
)

PERIOD = 5e-3


def played(
    speeds: Callable[[float], Sequence[float]], seconds: float, protection: SlideProtection | None = None
) -> list[tuple[float, list[int]]]:
    """Times and commands of a protection that sees these speeds."""
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
    assert 2.0 < vented[0] < 2.25
    assert all(leading == APPLY for _, (leading, _) in commands)


def test_slip_within_the_band_is_held() -> None:
    middle = (common_protection().lower_slip + common_protection().upper_slip) / 2

    def speeds(time: float) -> Sequence[float]:
        rolling = 20.0 - 0.5 * time
        share = 1.0 - middle * min(1.0, max(0.0, (time - 4.0) / 2.0))
        return [rolling, rolling * share]

    commands = [command for time, (_, command) in played(speeds, 8.0) if time > 6.5]
    assert commands.count(HOLD) > 0.9 * len(commands)


def test_reference_follows_the_true_speed_though_all_wheels_slide() -> None:
    """Wheels that slide further while braked, and roll again while vented: a wheelset let go shows the true speed."""
    protection, slips, looks, errors = SlideProtection(), [0.0, 0.0], 0, []
    for number in range(round(15.0 / PERIOD)):
        true = 20.0 - 0.6 * number * PERIOD
        commands = protection.step(number * PERIOD, [true * (1.0 - slip) for slip in slips])
        for wheel, command in enumerate(commands):
            rate = {APPLY: 0.25, HOLD: 0.0, VENT: -slips[wheel] / 0.2}[command]
            slips[wheel] = max(0.0, slips[wheel] + PERIOD * rate)
        looks += protection.released is not None
        errors.append(abs(protection.reference - true) / true)
        assert max(slips) < 0.2
    assert looks > 0
    assert max(errors) < 0.10


def test_venting_ends_with_the_watchdog() -> None:
    """A sensor that says 0 for ever must not keep the brake released."""
    p = common_protection()
    commands = played(lambda time: [20.0 - 0.1 * time, 20.0 if time < 1.0 else 0.0], 1.5 + 2.2 * p.watchdog)
    vented = [time for time, (_, trailing) in commands if trailing == VENT]
    stretch = vented[0]
    for before, after in pairwise(vented):
        if after - before > 1.5 * PERIOD:
            stretch = after
        assert after - stretch <= p.watchdog + PERIOD


def test_standing_wheels_stay_braked() -> None:
    assert all(command == [APPLY, APPLY] for _, command in played(lambda time: [0.0, 0.0], 1.0))


@pytest.mark.parametrize(
    ("name", "value"), [("lower_slip", -0.1), ("upper_slip", math.nan), ("lead_time", -1.0), ("watchdog", math.inf)]
)
def test_unphysical_thresholds_are_refused_with_name_value_and_limit(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"Set {name} to"):
        replace(common_protection(), **{name: value})


def test_thresholds_in_the_wrong_order_are_refused() -> None:
    with pytest.raises(ValueError, match="Set upper_slip above lower_slip"):
        replace(common_protection(), lower_slip=0.2, upper_slip=0.1)


# ---- sensors ---------------------------------------------------------------------------------------------------------


def test_encoder_is_right_to_a_pulse() -> None:
    encoder, omega = Encoder(pulses=100), 7.3
    errors = []
    for number in range(1, 400):
        time = number * PERIOD
        found = encoder.angular_velocity(time, omega * time)
        if number > 1:
            errors.append(abs(found - omega))
    pulse = math.tau / 100 / PERIOD
    assert max(errors) <= pulse
    assert max(errors) > 0.2 * pulse  # a hundred pulses are few: it shows


def test_encoder_counts_backwards_and_forgets_nothing() -> None:
    encoder, total = Encoder(pulses=1000), 0.0
    for number in range(1, 200):
        total += PERIOD * encoder.angular_velocity(number * PERIOD, -0.01 * number)
    assert total == pytest.approx(-0.01 * 198, abs=math.tau / 1000)


def test_jitter_is_the_same_for_the_same_seed() -> None:
    def noisy(seed: int) -> list[float]:
        encoder = Encoder(pulses=200, jitter=0.5, seed=seed)
        return [encoder.angular_velocity(number * PERIOD, 0.1 * number) for number in range(50)]

    assert noisy(1) == noisy(1)
    assert noisy(1) != noisy(2)


def test_encoder_without_pulses_is_refused() -> None:
    with pytest.raises(ValueError, match="Set pulses to at least 1: it was 0"):
        Encoder(pulses=0)


# ---- controllers that fail -------------------------------------------------------------------------------------------


class Raises:
    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        raise ZeroDivisionError("division by zero")


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
    sentence = r"The controller Raises failed at 0.5 s \(ZeroDivisionError: division by zero\); the brake stays applied"
    with pytest.raises(ControllerError, match=sentence):
        Supervised(Raises(), 2).step(0.5, [10.0, 10.0])


@pytest.mark.parametrize("answer", [None, 3, [], [0], [0, 0, 0], [0, 3], [0, 1.5], ["apply", "vent"], [0, math.nan]])
def test_controller_that_returns_nonsense_is_refused(answer: object) -> None:
    with pytest.raises(ControllerError, match=r"The controller Nonsense .* the brake stays applied"):
        Supervised(Nonsense(answer), 2).step(0.5, [10.0, 10.0])


def test_controller_that_stalls_is_stopped() -> None:
    supervised = Supervised(Stalls(), 2, patience=0.2)
    with pytest.raises(ControllerError, match=r"The controller Stalls gave no answer within 0.2 s at 0.5 s"):
        supervised.step(0.5, [10.0, 10.0])


def test_a_good_controller_passes_unchanged() -> None:
    assert Supervised(Nonsense((0, 2)), 2).step(0.0, [1.0, 1.0]) == [APPLY, VENT]
