"""Test wheel-slip protection on synthetic wheels: rolling, spinning, and with a lost sensor."""

from __future__ import annotations

from dataclasses import replace

import pytest

from brake_controller.wheel_spin import DEMANDED, HOLD, LET_GO, SpinProtection, common_spin_protection

PERIOD = 5e-3


@pytest.mark.parametrize("acceleration", [0.1, 0.6, 1.4])
def test_wheels_that_roll_keep_their_motors(acceleration: float) -> None:
    """Sensors read zero at first, and then jump to the speed."""
    protection = SpinProtection()
    for number in range(4000):
        time = number * PERIOD
        speed = 1.0 + acceleration * time if time > 0.1 else 0.0
        assert protection.step(time, [speed, speed]) == [DEMANDED, DEMANDED]


def spun(growth: float, seconds: float = 30.0, rate: float = 1.0) -> tuple[float, float]:
    """Return the largest slip after 3 s, and the share of the time in which motors gave the demand or held their
    torque.

    Slips of two wheelsets grow while driven, from 1 s on. They stay constant while held and decay while released. The
    vehicle accelerates by `growth` [m/s2].
    """
    protection, slips, largest, given = SpinProtection(), [0.0, 0.0], 0.0, 0
    steps = round(seconds / PERIOD)
    for number in range(steps):
        time, vehicle = number * PERIOD, 5.0 + growth * number * PERIOD
        commands = protection.step(time, [vehicle * (1.0 + slip) for slip in slips])
        for wheel, command in enumerate(commands):
            driven = rate * (1.0 + wheel / 4) if time > 1.0 else 0.0
            change = {DEMANDED: driven, HOLD: 0.0, LET_GO: -slips[wheel] / 0.2}[command]
            slips[wheel] = max(slips[wheel] + PERIOD * change, 0.0)
        largest = max(largest, *slips) if time > 3.0 else largest
        given += sum(command != LET_GO for command in commands)
    return largest, given / (2 * steps)


@pytest.mark.parametrize("growth", [0.05, 0.3, 0.7])
def test_wheels_that_all_spin_are_held_in_the_band(growth: float) -> None:
    largest, given = spun(growth)
    assert largest < 0.3
    assert given > 0.5


def test_without_looks_at_the_true_speed_they_would_run_away(monkeypatch: pytest.MonkeyPatch) -> None:
    """This shows that the test above can fail."""
    monkeypatch.setattr(SpinProtection, "_look", lambda *_: None)
    monkeypatch.setattr("brake_controller.wheel_spin.MARGIN", 1.0)
    assert spun(0.05)[0] > 0.5


def test_a_lost_sensor_lets_its_motor_go_only_while_the_others_spin() -> None:
    protection = SpinProtection()
    for number in range(2000):
        time = number * PERIOD
        speed = 5.0 + 0.3 * time
        second = 0.0 if time > 2.0 else speed
        first = speed + (9.0 * (time - 5.0) if 5.0 < time < 5.3 else 0.0)
        commands = protection.step(time, [first, second])
        if time < 5.0:
            assert commands == [DEMANDED, DEMANDED]
        if 5.28 < time < 5.3:
            assert commands == [LET_GO, LET_GO]


def test_thresholds_that_cannot_be_are_refused() -> None:
    with pytest.raises(ValueError, match=r"lower_slip must be below upper_slip, 0\.1; got 0\.2"):
        replace(common_spin_protection(), lower_slip=0.2)
    with pytest.raises(ValueError, match="slowest must be finite and above 0; got 0"):
        replace(common_spin_protection(), slowest=0)
