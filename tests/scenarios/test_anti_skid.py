"""Wheel-slide protection on the bogie: what is asked of it on a low rail, and what happens to controllers that fail."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from brake_controller.wheel_slide import SlideProtection, common_protection
from scenarios.bench.braked_machine import BrakedMachine, bogie
from scenarios.bench.own_controller import FixedSlip
from scenarios.bench.peak_adhesion import PeakAdhesion
from scenarios.bench.protected_stop import Settings, protected_stop
from scenarios.bench.rails import ABOVE, BAND, LOCK_ABOVE, LONGEST_LOCK, OVER_IDEAL, RAILS, SHARE

LOW = next(rail for rail in RAILS if rail.name == "low").values()


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
    assert ideal < stop.distance < OVER_IDEAL * ideal


def test_without_protection_the_wheels_lock_and_the_stop_is_longer(machine: BrakedMachine, ideal: float) -> None:
    stop = protected_stop(machine, LOW, None)
    assert stop.longest_lock(LOCK_ABOVE) > 10.0
    assert stop.share_in_band(BAND, ABOVE) < SHARE
    assert stop.distance > 1.5 * ideal


def test_encoder_with_fewer_pulses_and_jitter_is_enough(machine: BrakedMachine, ideal: float) -> None:
    stop = protected_stop(machine, LOW, SlideProtection(), Settings(pulses=2000, jitter=0.3))
    assert stop.longest_lock(LOCK_ABOVE) <= LONGEST_LOCK
    assert stop.distance < OVER_IDEAL * ideal


def test_a_band_far_from_the_best_slip_costs_distance(machine: BrakedMachine, ideal: float) -> None:
    """What the band decides: at half the speed the friction of the low rail has fallen by a third."""
    wide = SlideProtection(replace(common_protection(), lower_slip=0.45, upper_slip=0.55))
    assert protected_stop(machine, LOW, wide).distance > OVER_IDEAL * ideal


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
