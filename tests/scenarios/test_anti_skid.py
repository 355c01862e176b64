"""Wheel-slide protection on the bogie: what is asked of it on a low rail, and what happens to controllers that fail."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from brake_controller.slide_protection import common_protection
from products.protection.braked_machine import BrakedMachine, Machine, bogie, coach
from products.protection.protected_stop import Settings, protected_stop
from products.protection.rails import ABOVE, BAND, LOCK_ABOVE, LONGEST_LOCK, OVER_IDEAL, RAILS, SHARE
from products.protection.slide_protection import SlideProtection
from rbd_model.contact.friction import FallingFriction, constant_friction
from rbd_model.track.friction import RailCondition, low
from scenarios.bench.own_controller import FixedSlip
from scenarios.bench.peak_adhesion import PeakAdhesion
from scenarios.bench.rail_programme import for_choosing, for_reporting, programme, scores
from scenarios.brakes import anti_skid
from tests.rbd_model.test_adhesion import adhesion

DRY, _, LOW, _ = (rail.values() for rail in RAILS)
#: Braking force and largest creep force: the brake fills to 1e-3, slip ratios are tried 20 % apart.
USED_BAND = 3e-3


@pytest.fixture(scope="module")
def machine() -> Iterator[BrakedMachine]:
    with BrakedMachine() as made:
        yield made


@pytest.fixture(scope="module")
def ideal() -> float:
    return PeakAdhesion(bogie(), LOW).stopping_distance(25.0)


@pytest.mark.parametrize(("period", "host_step"), [(2e-3, 1e-3), (5e-3, 5e-3), (2e-2, 1e-2)])
def test_protection_neither_locks_nor_wastes_adhesion(
    machine: BrakedMachine, ideal: float, period: float, host_step: float
) -> None:
    stop = protected_stop(machine, LOW, SlideProtection(), Settings(period=period, host_step=host_step))
    assert stop.longest_lock(LOCK_ABOVE) <= LONGEST_LOCK
    assert stop.share_in_band(BAND, ABOVE) >= SHARE
    assert stop.distance is not None
    assert ideal < stop.distance < OVER_IDEAL * ideal


def test_without_protection_the_wheels_lock_and_the_stop_is_longer(machine: BrakedMachine, ideal: float) -> None:
    stop = protected_stop(machine, LOW, None)
    assert stop.longest_lock(LOCK_ABOVE) > 10.0
    assert stop.share_in_band(BAND, ABOVE) < SHARE
    assert stop.distance is not None
    assert stop.distance > 1.5 * ideal


def test_what_a_stop_uses_of_a_rail_is_told_apart_from_its_distance(machine: BrakedMachine) -> None:
    """On the wet rail the brake alone decides the distance, which is the ideal one; at its end 0.6 of the largest creep
    force are used, by Polach (2005), and in the mean 0.5 of friction without sliding, by momentum.
    """
    rail, own = RAILS[1], bogie()
    stop, best = protected_stop(machine, rail.values(), None), PeakAdhesion(own, rail.values())
    braked = np.flatnonzero(stop.braked(ABOVE))
    (begin, speed), (start, end) = (stop.series[name][braked[[0, -1]]] for name in ("speed", "time"))
    asked = own.deceleration(own.full_torque) / own.parameters.gravity
    largest = max(adhesion(rail.condition, slip * speed, speed) for slip in np.geomspace(1e-3, 0.5, 2000))
    assert stop.over(best.stopping_distance(25.0)) == pytest.approx(1.0, abs=1e-3)
    assert best.used(stop)[-1] == pytest.approx(asked / largest, rel=USED_BAND)
    [row] = anti_skid.without_sliding("wet", rail, stop)
    slowed = (begin - speed) / (end - start) / own.parameters.gravity
    assert row.simulated == pytest.approx(slowed / rail.condition.friction, rel=USED_BAND)


#: Teeth, and errors of their places as a share of the pitch.
SENSORS = [(80, 0.0), (100, 0.1), (200, 0.0), (2000, 0.3), (10000, 0.0)]


@pytest.mark.parametrize(("teeth", "jitter"), SENSORS)
def test_every_sensor_is_enough_on_a_low_rail(machine: BrakedMachine, ideal: float, teeth: int, jitter: float) -> None:
    stop = protected_stop(machine, LOW, SlideProtection(), Settings(pulses=teeth, jitter=jitter))
    assert stop.distance is not None
    assert stop.longest_lock(LOCK_ABOVE) <= LONGEST_LOCK
    assert ideal < stop.distance < OVER_IDEAL * ideal


#: The same on dry rail.
DRY_SENSORS = [(80, 0.0), (100, 0.1), (100, 0.2), (2000, 0.3)]


@pytest.mark.parametrize(("teeth", "jitter"), DRY_SENSORS)
@pytest.mark.parametrize("strength", [1.0, 1.5])
def test_no_valve_leaves_apply_where_wheels_roll(
    machine: BrakedMachine, teeth: int, jitter: float, strength: float
) -> None:
    """On dry rail the bogie's wheels roll up to 1.6 of the full service brake; counted are commands, not metres."""
    settings = Settings(strength=strength, pulses=teeth, jitter=jitter)
    assert protected_stop(machine, DRY, SlideProtection(), settings).count_of_commands() == 0


@pytest.mark.parametrize("strength", [1.0, 2.5])
def test_no_valve_of_the_coach_leaves_apply_where_wheels_roll(strength: float) -> None:
    with BrakedMachine(coach()) as four:
        rail = RAILS[0].values(4)
        settings = Settings(strength=strength, jitter=0.1)
        assert max(protected_stop(four, rail, None, settings).slip(number).max() for number in (1, 2, 3, 4)) < 1.0
        assert protected_stop(four, rail, SlideProtection(), settings).count_of_commands() == 0


@pytest.mark.parametrize("friction", [0.135, 0.15])
@pytest.mark.parametrize("law", [constant_friction(), low().law])
def test_a_brake_a_little_above_the_limit_of_adhesion_locks_no_wheel_for_long(
    machine: BrakedMachine, friction: float, law: FallingFriction
) -> None:
    """The full brake uses an adhesion of 0.15: all wheels slide slowly, at different rates as their loads differ."""
    rail = RailCondition(friction, law, verified=False).values()
    stop = protected_stop(machine, rail, SlideProtection())
    free = protected_stop(machine, rail, None)
    assert free.longest_lock(LOCK_ABOVE) > 10.0
    assert stop.longest_lock(LOCK_ABOVE) <= LONGEST_LOCK


class NeverBrakes:
    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        return [2] * len(wheel_speeds)


def test_a_run_that_never_stops_has_no_stopping_distance(
    machine: BrakedMachine, ideal: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("products.protection.protected_stop.LONGEST", 20.0)
    stop = protected_stop(machine, LOW, NeverBrakes())
    assert stop.distance is None
    assert stop.over(ideal) is None
    assert stop.end_speed == pytest.approx(25.0, rel=0.02)
    assert stop.words == f"did not stop: {stop.end_speed:.1f} m/s after 20 s"
    assert stop.note("a source") == f"{stop.words}; a source"
    assert anti_skid.longest([stop], ideal) is None


def test_a_sweep_says_that_a_run_never_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("products.protection.protected_stop.LONGEST", 5.0)
    point = anti_skid.one_point()
    assert point["stop_distance"] is None
    assert point["stop_time"] is None
    assert point["end_speed"] > 20.0  # type: ignore[operator]


def test_an_ideal_that_never_stops_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.bench.peak_adhesion.LONGEST", 5.0)
    with pytest.raises(ValueError, match="Give a rail that stops the vehicle from 25 m/s within 5 s"):
        PeakAdhesion(bogie(), LOW).stopping_distance(25.0)


def test_locked_wheels_are_those_of_the_same_brake(machine: BrakedMachine) -> None:
    """On dry rail it locks none, and there is nothing to compare; on the low one it locks all, and takes longer."""
    assert not protected_stop(machine, DRY, None).locks(LOCK_ABOVE)
    locked, protected = protected_stop(machine, LOW, None), protected_stop(machine, LOW, SlideProtection())
    assert locked.locks(LOCK_ABOVE)
    ratio = protected.over(locked.distance)
    assert ratio is not None
    assert ratio < 1.0


@pytest.mark.long
@pytest.mark.parametrize("make", [bogie, coach])
def test_thresholds_hold_on_rails_on_which_they_were_not_chosen(make: Callable[[], Machine]) -> None:
    with BrakedMachine(make()) as chosen:
        found = scores(chosen, for_reporting(), common_protection(), Settings())
    assert all(score.over_ideal is not None and score.over_ideal <= OVER_IDEAL for score in found)
    assert max(score.longest_lock for score in found) <= LONGEST_LOCK


def test_rails_for_choosing_and_reporting_share_none() -> None:
    choosing, reporting = set(for_choosing()), set(for_reporting())
    assert not choosing & reporting
    assert len(choosing) + len(reporting) == len(programme())


def test_a_band_far_from_the_best_slip_costs_distance(machine: BrakedMachine, ideal: float) -> None:
    """What the band decides: at half the speed the friction of the low rail has fallen by a third."""
    wide = SlideProtection(replace(common_protection(), lower_slip=0.45, upper_slip=0.55))
    ratio = protected_stop(machine, LOW, wide).over(ideal)
    assert ratio is not None
    assert ratio > OVER_IDEAL


def test_ideal_uses_the_best_slip_at_every_speed() -> None:
    peak = PeakAdhesion(bogie(), LOW)
    best, slip = peak.best(0.0, 20.0)
    assert 0.005 < slip < 0.1
    for other in (0.3 * slip, 3.0 * slip):
        assert peak.at(0.0, 20.0, other) < best


class Raises:
    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        if time > 3.0:
            raise RuntimeError("lost its mind")
        return [2, 2]


class Nonsense:
    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        return [7, 0] if time > 3.0 else [0, 0]


@pytest.mark.parametrize(("controller", "words"), [(Raises(), "lost its mind"), (Nonsense(), "[7, 0]")])
def test_brake_stays_applied_when_a_controller_fails(machine: BrakedMachine, controller: object, words: str) -> None:
    rail = {"friction_1": 0.3, "friction_2": 0.3}
    stop = protected_stop(machine, rail, controller)  # type: ignore[arg-type]
    assert "the brake stays applied" in stop.failure
    assert words in stop.failure
    after = stop.series["time"] > 6.0
    assert np.all(stop.series["valve_1"][after] == 0.0)
    assert np.all(stop.series["pressure_1"][after] > 150e3)
    assert stop.time < 40.0  # it stopped


def test_prototype_is_below_forty_lines_and_never_locks_for_long(machine: BrakedMachine) -> None:
    import inspect

    assert len(inspect.getsource(FixedSlip).splitlines()) < 40
    stop = protected_stop(machine, LOW, FixedSlip())
    assert stop.longest_lock(LOCK_ABOVE) < protected_stop(machine, LOW, None).longest_lock(LOCK_ABOVE)


class Failing:
    """A controller with a mistake in it."""

    def step(self, time: float, wheel_speeds: Sequence[float]) -> Sequence[int]:
        raise ValueError("my mistake")


def test_a_controller_that_fails_is_told_wherever_its_stop_is(machine: BrakedMachine) -> None:
    """The brake alone brings the bogie to rest; the words of that stop do not look like those of a controller."""
    stop = protected_stop(machine, RAILS[0].values(), Failing())
    assert stop.distance is not None
    assert stop.words.startswith(f"{stop.distance:.0f} m, no stop of this controller: The controller Failing failed at")
    assert "my mistake" in stop.words
