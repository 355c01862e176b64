"""Wheel-slide protection on the bogie: requirements on a low rail, and no action on a dry rail."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from brake_controller.slide_protection import common_protection
from brake_controller.wheel_slide import WheelSlideController
from products.machine import Machine, bogie, coach
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.rails import ABOVE, LONGEST_LOCK, OVER_IDEAL, RAILS, SHARE
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from rbd_model.contact.friction import constant_friction
from rbd_model.track.friction import RailCondition, low
from scenarios.bench.own_controller import FixedSlip
from scenarios.brakes import anti_skid
from tests.products.protection.rail_programme import for_choosing, for_reporting, programme, scores
from tests.rbd_model.test_adhesion import adhesion

DRY, _, LOW, _ = (rail.values() for rail in RAILS)
#: Braking force over the largest creep force: the brake fills to 1e-3, and slip ratios are tried 20 % apart.
USED_BAND = 3e-3
#: Median and worst distance over the ideal on rails for reporting. docs/fitted.md: at most 1.067 and 1.155.
MEDIAN, WORST = 1.08, 1.17


def stopped(
    make: Callable[[], WheelSlideController] | None,
    rail: dict[str, float],
    settings: Settings | None = None,
    every: float = 0.0,
    by_flow: bool = True,
) -> Stop:
    """Run one stop of the bogie."""
    [stop] = Rig(bogie(), make, settings or Settings(), by_flow=by_flow).runs([Run(rail)], every=every)
    return stop


@lru_cache
def ideal_of(by_flow: bool) -> float:
    """Return the ideal distance with the filling that the rig simulates."""
    full = Settings().application_time
    filling = None if by_flow else lambda since: 1.0 - 20.0 ** (-max(since, 0.0) / full)
    return PeakAdhesion(bogie(), LOW, filling).stopping_distance(25.0)


@pytest.fixture(scope="module")
def ideal() -> float:
    return ideal_of(by_flow=True)


@pytest.fixture(scope="module")
def locked() -> Stop:
    return stopped(None, LOW, every=5e-3)


@pytest.mark.study
@pytest.mark.parametrize("period", [2e-3, 5e-3, 2e-2])
def test_protection_neither_locks_nor_wastes_adhesion(ideal: float, period: float) -> None:
    stop = stopped(SlideProtection, LOW, Settings(period=period))
    assert stop.longest_lock <= LONGEST_LOCK
    assert stop.share_in_band >= SHARE
    assert stop.distance is not None
    assert ideal < stop.distance < OVER_IDEAL * ideal


@pytest.mark.study
def test_without_protection_the_wheels_lock_and_the_stop_is_longer(locked: Stop, ideal: float) -> None:
    """On the dry rail the same brake locks no wheel, so nothing is compared."""
    assert locked.longest_lock > 10.0
    assert locked.course.locks(0.3)
    assert locked.share_in_band < SHARE
    assert locked.distance is not None
    assert locked.distance > 1.5 * ideal
    assert not stopped(None, DRY, every=5e-3).course.locks(0.3)


def test_what_a_stop_uses_of_a_rail_is_told_apart_from_its_distance() -> None:
    """On the wet rail the brake alone limits the distance, which is the ideal one.

    At the end of the stop the wheels use 0.6 of the largest creep force, by Polach (2005). On average they use 0.5 of
    the friction, derived from the loss of momentum.
    """
    rail, own = RAILS[1], bogie()
    stop, best = stopped(None, rail.values(), every=5e-3), PeakAdhesion(own, rail.values())
    course = stop.course
    first, last = np.flatnonzero(course.braked(ABOVE))[[0, -1]]
    slowed = (course.speed[first] - course.speed[last]) / (course.time[last] - course.time[first])
    asked = own.deceleration(own.full_torque) / own.parameters.gravity
    speed = course.speed[last]
    largest = max(adhesion(rail.condition, slip * speed, speed) for slip in np.geomspace(1e-3, 0.5, 2000))
    assert stop.over(best.stopping_distance(25.0)) == pytest.approx(1.0, abs=1e-3)
    assert best.used(stop)[-1] == pytest.approx(asked / largest, rel=USED_BAND)
    [row] = anti_skid.without_sliding("wet", rail, stop)
    assert row.simulated == pytest.approx(slowed / own.parameters.gravity / rail.condition.friction, rel=USED_BAND)


#: Numbers of teeth, and errors of their places as shares of the pitch.
SENSORS = [(80, 0.0), (100, 0.1), (200, 0.0), (2000, 0.3), (10000, 0.0)]


@pytest.mark.study
@pytest.mark.parametrize(("teeth", "jitter"), SENSORS)
@pytest.mark.parametrize("by_flow", [False, True], ids=["timed", "by flow"])
def test_every_sensor_is_enough_on_a_low_rail(teeth: int, jitter: float, by_flow: bool) -> None:
    ideal = ideal_of(by_flow)
    stop = stopped(SlideProtection, LOW, Settings(pulses=teeth, jitter=jitter), by_flow=by_flow)
    assert stop.distance is not None
    assert stop.longest_lock <= LONGEST_LOCK
    assert ideal < stop.distance < OVER_IDEAL * ideal


#: The same on dry rail, with the vehicle and the largest brake ratio at which its wheels roll there.
DRY_SENSORS = [
    *((bogie(), 1.5, teeth, jitter) for teeth, jitter in ((80, 0.0), (100, 0.1), (100, 0.2), (2000, 0.3))),
    (coach(), 2.5, 100, 0.1),
]


@pytest.mark.study
@pytest.mark.parametrize(("machine", "ratio", "teeth", "jitter"), DRY_SENSORS)
def test_no_valve_leaves_apply_where_wheels_roll(machine: Machine, ratio: float, teeth: int, jitter: float) -> None:
    """The test counts valve commands, not metres."""
    runs = [Run(RAILS[0].values(len(machine.numbers)), brake_ratio=one) for one in (1.0, ratio)]
    settings = Settings(pulses=teeth, jitter=jitter)
    alone, protected = (Rig(machine, make, settings, by_flow=True).runs(runs) for make in (None, SlideProtection))
    assert [stop.longest_skid for stop in alone] == [0.0, 0.0]
    assert [stop.commands for stop in protected] == [0, 0]


def test_a_brake_a_little_above_the_limit_of_adhesion_locks_no_wheel_for_long() -> None:
    """The full brake uses an adhesion of 0.15: all wheels slide slowly, at rates that differ with their loads."""
    laws, frictions = (constant_friction(), low().law), (0.135, 0.15)
    rails = [RailCondition(friction, law, verified=False).values() for law in laws for friction in frictions]
    alone, protected = (Rig(bogie(), make, Settings(), by_flow=True).stops(rails) for make in (None, SlideProtection))
    assert min(stop.longest_lock for stop in alone) > 10.0
    assert max(stop.longest_lock for stop in protected) <= LONGEST_LOCK


def test_a_sweep_says_that_a_run_never_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("products.protection.rig.LONGEST", 5.0)
    point = anti_skid.one_point()
    assert point["stop_distance"] is None
    assert point["stop_time"] is None
    assert point["end_speed"] > 20.0  # type: ignore[operator]


def test_an_ideal_that_never_stops_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("products.protection.peak_adhesion.LONGEST", 5.0)
    with pytest.raises(ValueError, match="The rail must be one that stops the vehicle from 25 m/s within 5 s"):
        PeakAdhesion(bogie(), LOW).stopping_distance(25.0)


@pytest.mark.study
def test_some_rails_on_which_thresholds_were_not_chosen() -> None:
    found = scores(bogie(), for_reporting()[::3], common_protection(), Settings())
    assert max(score.over_ideal or math.inf for score in found) < WORST
    assert max(score.longest_lock for score in found) <= LONGEST_LOCK


@pytest.mark.long
@pytest.mark.parametrize("make", [bogie, coach])
@pytest.mark.parametrize("by_flow", [False, True], ids=["timed", "by flow"])
def test_thresholds_hold_on_rails_on_which_they_were_not_chosen(make: Callable[[], Machine], by_flow: bool) -> None:
    found = scores(make(), for_reporting(), common_protection(), Settings(), by_flow)
    ratios = [score.over_ideal or math.inf for score in found]
    assert np.median(ratios) < MEDIAN
    assert max(ratios) < WORST
    assert max(score.longest_lock for score in found) <= LONGEST_LOCK


@pytest.mark.study
def test_a_wheel_below_its_best_slip_postpones_a_release_not_for_ever() -> None:
    """On these rails a wheel that slides slowly is taken for one that rolls; otherwise they lock for 1 to 6 s."""
    slow = {("0.1", 25.0), ("0.1", 40.0), ("0.12 falling", 25.0)}
    trials = [trial for trial in programme() if (trial.rail.name, trial.speed) in slow]
    assert len(trials) == len(slow)
    found = scores(coach(), trials, common_protection(), Settings(), by_flow=True)
    assert max(score.longest_lock for score in found) <= LONGEST_LOCK


def test_rails_for_choosing_and_reporting_share_none() -> None:
    choosing, reporting = set(for_choosing()), set(for_reporting())
    assert not choosing & reporting
    assert len(choosing) + len(reporting) == len(programme())


def test_a_band_far_from_the_best_slip_costs_distance(ideal: float) -> None:
    """The slip range matters: at 6 m/s friction of the low rail has fallen by 42 %."""
    wide = replace(common_protection(), lower_slip=5.5, upper_slip=6.5)
    ratio = stopped(lambda: SlideProtection(wide), LOW).over(ideal)
    assert ratio is not None
    assert ratio > OVER_IDEAL


def test_ideal_uses_the_best_slip_at_every_speed() -> None:
    peak = PeakAdhesion(bogie(), LOW)
    best, slip = peak.best(0.0, 20.0)
    assert 0.005 < slip < 0.1
    for other in (0.3 * slip, 3.0 * slip):
        assert peak.at(0.0, 20.0, other) < best


def test_prototype_is_below_forty_lines_and_never_locks_for_long(locked: Stop) -> None:
    assert len(inspect.getsource(FixedSlip).splitlines()) < 40
    assert stopped(FixedSlip, LOW).longest_lock < locked.longest_lock
