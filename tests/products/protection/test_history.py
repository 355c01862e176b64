"""The recorded course of a stop on the test rig: inputs and commands of a controller; recording changes no run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
import pytest

from evidence.measuring.protected_throughput import LetAllGo, LetGo, in_c
from products import controller_kinds as module
from products.controller_kinds import Arrays
from products.machine import Machine, bogie, coach
from products.protection.history import EVERY, StopHistory
from products.protection.rails import RAILS
from products.protection.rig import Rig
from products.protection.runs import Fault, Run
from products.protection.settings import Settings

RUNS = [Run(rail.values()) for rail in RAILS[:3]]


class Notes(LetGo):
    """Record inputs and commands."""

    said: ClassVar[list[list[float]]] = []

    def step(self, time: float, speeds: Sequence[float]) -> list[int]:
        answer = super().step(time, speeds)
        self.said.append([time, *speeds, *answer])
        return answer


@pytest.mark.study
def test_a_run_that_is_written_down_is_the_same_in_every_form(monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs are bit-identical, also in rows that take over the next run, and all forms record the same."""
    forms = (LetGo, Arrays(LetAllGo()), in_c())
    monkeypatch.setattr(module, "AT_ONCE", 2)
    written = []
    for form in forms:
        rig = Rig(bogie(), form, Settings(), by_flow=True)
        found = rig.runs(RUNS, every=EVERY)
        assert found == rig.runs(RUNS)
        written.append([stop.history for stop in found])
    for one in written[1:]:
        for history, same in zip(one, written[0], strict=True):
            assert history is not same
            assert all(np.array_equal(value, vars(same)[name]) for name, value in vars(history).items())
    assert not np.array_equal(written[0][2].speed[:100], written[0][0].speed[:100])


def test_what_is_written_down_is_what_the_controller_saw_and_said() -> None:
    Notes.said.clear()
    [stop] = Rig(bogie(), Notes, Settings()).runs([RUNS[2]], every=EVERY)
    history = stop.history
    assert isinstance(history, StopHistory)
    said = np.array(Notes.said)
    samples = np.rint(history.time[:-1] / 5e-3).astype(int)
    assert np.array_equal(said[samples, 0], history.time[:-1])
    assert np.array_equal(said[samples, 1:3], history.sensor_speed[:-1])
    assert np.array_equal(said[samples[1:] - 1, 3:], history.valve[1:-1])
    assert not np.array_equal(said[samples[1:], 3:], history.valve[1:-1])
    assert {0, 2} == set(np.unique(history.valve))


@pytest.mark.study
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_the_course_of_a_stop_ends_where_the_stop_does(machine: Machine) -> None:
    """Its distance is the integral of its speed; wheels roll at first, and locked wheels stand still."""
    count = len(machine.numbers)
    run = Run(RAILS[2].values(count), faults=(Fault(1, sensor="zero", sensor_from=3.0),))
    [stop] = Rig(machine, None, Settings()).runs([run], every=EVERY)
    history = stop.history
    assert isinstance(history, StopHistory)
    assert (history.time[-1], history.distance[-1], history.speed[-1]) == (stop.time, stop.distance, stop.end_speed)
    assert np.diff(history.time[:-1]) == pytest.approx(0.1)
    way = np.trapezoid(history.speed, history.time)
    assert history.distance[-1] == pytest.approx(way, rel=1e-3)
    assert np.trapezoid(history.speed[::2], history.time[::2]) != pytest.approx(way, rel=1e-6)
    radius = machine.parameters.wheel_radius
    assert radius * history.angular_velocity[5] == pytest.approx(np.full(count, 25.0), rel=1e-3)
    locked = history.angular_velocity[history.time.searchsorted(10.0)]
    assert np.any(locked == 0.0)
    assert np.all(history.sensor_speed[history.time >= 3.0, 0] == 0.0)
    assert history.effort.max() == pytest.approx(machine.full_pressure, rel=1e-2)


def test_looks_farther_apart_are_some_of_the_others() -> None:
    rig = Rig(bogie(), None, Settings())
    fine, coarse = (rig.runs([RUNS[0]], every=every)[0].history for every in (0.1, 0.5))
    assert fine
    assert coarse
    assert np.array_equal(coarse.speed[:-1], fine.speed[:-1:5][: len(coarse.speed) - 1])
    assert coarse.speed[-1] == fine.speed[-1]
