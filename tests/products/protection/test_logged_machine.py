"""Fit the rail's friction to the log of a protected stop, and detect a wrong friction law."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.logs import logged_machine
from brake_controller.slide_protection import SlideProtectionParameters, common_protection
from products.bogie import TORQUE_PER_PRESSURE
from products.protection.slide_protection import SlideProtection
from rbd_model.track.friction import low

#: Errors of the friction with its law known (measured 1.0 %) and unknown (2.7 %). Sensors have errors of the teeth of 2
#: % of the pitch; pulls of 5 to 80 1/s give no larger errors. Error of the law's slope at rest: measured 10 %.
KNOWN, FITTED, SLOPE = 0.03, 0.07, 0.3
#: Error of the speed in the half that was not fitted [m/s]; measured 0.009 and 0.012, and 0.2 with constant friction.
HELD_OUT = 0.05
LAW = {name: value for name, value in low().law.values().items() if name != "friction_decay"}
DECAY = low().law.values()["friction_decay"]
BEGIN = {"friction_1": 0.15, "friction_2": 0.15}
UNTIL = 20.0


def logged(thresholds: SlideProtectionParameters) -> bb.Recording:
    """Return the log of an on-board recorder every 20 ms: speed, pressures, sensor readings."""
    seen: list[list[float]] = []

    class Heard(SlideProtection):
        def __init__(self) -> None:
            super().__init__(thresholds)

        def step(self, time: float, speeds: Sequence[float]) -> list[int]:
            seen.append(list(speeds))
            return list(super().step(time, speeds))

    stop = bb.protected_stop(Heard, "low", jitter=0.02)
    for place in range(2):
        stop[f"wheel_speed_{place + 1}"][:] = [row[place] for row in seen]
    units = {name: stop.units[name] for name in stop.names if re.match("time|speed|wheel_speed|pressure", name)}
    moves = stop["speed"] > 1.0
    return bb.Recording(units, np.column_stack([stop[name][moves] for name in units])[::4])


@pytest.fixture(scope="module")
def log() -> bb.Recording:
    return logged(common_protection())


@pytest.fixture(scope="module")
def far_log() -> bb.Recording:
    """Return a log of wheels that slide far, at 1.5 to 2.5 m/s: there friction has fallen by 16 to 24 %."""
    return logged(replace(common_protection(), lower_slip=1.5, upper_slip=2.5))


def fitted(log: bb.Recording, begin: dict[str, float], **held: float) -> bb.Fit:
    return bb.fit(logged_machine("bogie"), log, begin, until=UNTIL, initial_speed=25.0, **held)


@pytest.mark.study
def test_friction_is_found_again_from_above_and_from_below(log: bb.Recording) -> None:
    law = LAW | {"friction_decay": DECAY}
    above, below = fitted(log, BEGIN, **law), fitted(log, dict.fromkeys(BEGIN, 0.05), **law)
    for name in BEGIN:
        assert above.values[name] == pytest.approx(low().friction, rel=KNOWN)
        assert below.values[name] == pytest.approx(above.values[name], rel=1e-3)
    assert above.held_out["speed"] < HELD_OUT
    assert "In the rows that were not fitted speed is off by" in above.status


@pytest.mark.study
def test_friction_that_does_not_fall_shows_in_the_half_that_was_not_fitted(far_log: bb.Recording) -> None:
    flat = fitted(far_log, BEGIN)
    assert flat.held_out["speed"] > 2 * HELD_OUT
    assert abs(flat.values["friction_1"] / low().friction - 1) > FITTED


@pytest.mark.study
def test_its_fall_is_found_too(log: bb.Recording) -> None:
    found = fitted(log, BEGIN | {"friction_decay": 0.1}, **LAW)
    for name in BEGIN:
        assert found.values[name] == pytest.approx(low().friction, rel=FITTED)
    assert found.held_out["speed"] < HELD_OUT


@pytest.mark.long
def test_ratio_and_decay_are_told_by_their_slope_at_rest(far_log: bb.Recording) -> None:
    rest = {name: value for name, value in LAW.items() if name != "friction_ratio"}
    both = fitted(far_log, BEGIN | {"friction_decay": 0.1, "friction_ratio": 0.6}, **rest)
    slope = (1 - both.values["friction_ratio"]) * both.values["friction_decay"]
    assert slope == pytest.approx((1 - LAW["friction_ratio"]) * DECAY, rel=SLOPE)


@pytest.mark.study
def test_without_its_pull_it_is_the_bogie_with_these_torques(log: bb.Recording) -> None:
    times, values = log["time"], {"initial_speed": 25.0, "friction_1": 0.2, "friction_2": 0.2}
    driven = {name: (times, log[name]) for name in log.names[2:]}
    torques = {f"brake_torque_{n}": (times, TORQUE_PER_PRESSURE * log[f"pressure_{n}"]) for n in (1, 2)}
    ends = [
        bb.run(what, 15.0, None, ["speed"], 1.0, **values, **more)["speed"]
        for what, more in (
            (logged_machine("bogie"), driven | {"tracking_rate": 0.0}),
            ("bogie", torques | {"level": 2}),
            (logged_machine("bogie"), driven | {"tracking_rate": 0.0, "full_torque": 19e3}),
        )
    ]
    assert ends[0] == pytest.approx(ends[1], abs=1e-5)
    assert abs(ends[2][-1] - ends[1][-1]) > 1e-2


def test_what_cannot_be_fitted_is_refused(log: bb.Recording) -> None:
    with pytest.raises(ValueError, match="LoggedMachine has no real parameter or free input pressure_1"):
        fitted(log, {"pressure_1": 1e5})
    with pytest.raises(ValueError, match=re.escape("until must be at least 0.02 s, the time of the second row")):
        bb.fit(logged_machine("bogie"), log, BEGIN, until=0.0)
    with pytest.raises(KeyError, match="There is no machine bogey with a log; did you mean bogie"):
        logged_machine("bogey")


@pytest.mark.study
def test_a_coach_is_driven_by_a_log_too() -> None:
    times = np.array([0.0, 10.0])
    driven = {f"pressure_{n}": (times, np.full(2, 380e3)) for n in range(1, 5)}
    driven |= {f"wheel_speed_{n}": (times, np.zeros(2)) for n in range(1, 5)}  # lost sensors exert no pull
    stop = bb.run(logged_machine("vehicle"), 10.0, None, ["speed"], 1.0, initial_speed=25.0, friction_1=0.5, **driven)
    assert stop["speed"][0] - stop["speed"][-1] == pytest.approx(12.0, rel=0.03)  # full brake, designed for 1.2 m/s2
