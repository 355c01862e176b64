"""Test that a wheelset is locked if it does not turn while its axle moves, and that a vehicle at rest stands."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, Variable, model_of
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.vehicle.description import Springs, Vehicle, Wheelset
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie
from tests.fmu_src.quick_library import quick_library

LEVELS = {"point": point_vehicle, "planar": planar_vehicle}
#: Brake torque far below the adhesion limit, by the number of axles [N.m].
CLEAN = {2: 8e3, 4: 8e3, 12: 3e3}


def long_bogie(axles: int) -> Vehicle:
    """Return the frame of chapter 5 on this number of axles, 1.2 m apart."""
    law = True, (9e6, 6e6, 3e6), (8e4, 4e4, 5e4)
    places = {number: 1.2 * ((axles + 1) / 2 - number) for number in range(1, axles + 1)}
    springs = [Springs(f"springs_{n}", "frame", f"wheelset_{n}", (x, 0.9, 0.0), *law) for n, x in places.items()]
    wheelsets = [Wheelset(x, reacts_on="frame") for x in places.values()]
    return replace(two_axle_bogie(), name="Long", wheelsets=tuple(wheelsets), connections=tuple(springs))


@lru_cache
def library(level: str, axles: int) -> Library:
    vehicle = {2: two_axle_bogie, 4: passenger_coach}.get(axles, lambda: long_bogie(axles))()
    return quick_library(model_of(LEVELS[level](vehicle), 1e-6))


def run(level: str, axles: int, seconds: float, torque: float, **values: float) -> tuple[Kernel, dict[str, np.ndarray]]:
    """Brake all wheelsets with one torque; return speed, locks and angular velocities every 2 ms."""
    brakes = {f"brake_torque_{number}": torque for number in range(1, axles + 1)}
    kernel = Kernel(library(level, axles), **(brakes | values))
    each = [f"{name}_{n}" for n in range(1, axles + 1) for name in ("locked", "angular_velocity")]
    table = kernel.record(seconds, 2e-3, ["speed", *each])
    return kernel, {name: np.array(column) for name, column in table.items()}


@pytest.mark.study
@pytest.mark.parametrize(
    ("level", "axles"), [("point", 2), ("point", 12), ("planar", 2), ("planar", 4), ("planar", 12)]
)
@pytest.mark.parametrize("gradient", [0.0, 0.02, -0.005])
def test_a_clean_stop_says_once_that_the_vehicle_stands_and_locks_nothing(
    level: str, axles: int, gradient: float
) -> None:
    """Uphill the vehicle swings back on its springs and rolls for some millimetres, without a second message."""
    kernel, table = run(level, axles, 25.0, CLEAN[axles], gradient=gradient, initial_speed=6.0)
    assert len(kernel.messages) == 1
    assert re.fullmatch(r"The vehicle stands at \S+ s\.", kernel.messages[0])
    for number in range(1, axles + 1):
        assert not table[f"locked_{number}"].any()
        assert table[f"angular_velocity_{number}"][-1] == 0.0
    assert abs(table["speed"][-1]) < 1e-12


@pytest.mark.parametrize("level", LEVELS)
def test_running_resistance_is_told_to_hold_a_vehicle_where_no_brake_does(level: str) -> None:
    for torque, words in ((8e3, "The vehicle stands"), (0.0, "Running resistance holds the vehicle")):
        kernel, table = run(level, 2, 40.0, torque, initial_speed=2.0, davis_constant=4e3)
        assert {sentence.split(" at ")[0] for sentence in kernel.messages} >= {words}
        assert all(sentence.startswith(("The vehicle", "Running")[torque == 0.0]) for sentence in kernel.messages)
        assert abs(table["speed"][-1]) < 1e-3


@pytest.mark.study
@pytest.mark.parametrize("axles", [2, 12])
def test_a_wheelset_that_locks_is_locked_until_its_axle_rests(axles: int) -> None:
    """At level 1, where all axles have the speed of the vehicle."""
    kernel, table = run("point", axles, 12.0, 40e3, initial_speed=20.0)
    *locked, stands = kernel.messages
    assert sorted(re.findall(r"Wheelset (\d+) locked", " ".join(locked))) == sorted(map(str, range(1, axles + 1)))
    assert len(locked) == axles
    assert stands.startswith("The vehicle stands at")
    slides = table["speed"] > kernel["creepage_speed"]
    for number in range(1, axles + 1):
        assert (table[f"locked_{number}"] == (slides & (table[f"angular_velocity_{number}"] == 0.0))).all()
        assert table[f"locked_{number}"].sum() > 100


@pytest.mark.parametrize("level", LEVELS)
def test_a_wheelset_that_is_dragged_off_from_rest_is_locked(level: str) -> None:
    """No event occurs there, because the brake held the wheelset while the vehicle stood."""
    values = {"drawbar_force": 60e3, "friction_2": 0.1, "initial_speed": 0.0}
    kernel, table = run(level, 2, 1.0, 0.0, brake_torque_2=60e3, **values)
    told = [sentence.split(" at ")[0] for sentence in kernel.messages]
    assert [sentence for sentence in told if sentence.startswith("Wheelset")] == ["Wheelset 2 locked"]
    assert table["locked_2"][-1] == 1.0
    assert not table["angular_velocity_2"].any()
    assert table["speed"][-1] > 0.1


@pytest.mark.parametrize("level", LEVELS)
def test_a_vehicle_that_starts_again_says_so_once_and_its_next_lock_is_told(level: str) -> None:
    kernel = Kernel(library(level, 2), initial_speed=2.0, brake_torque_1=8e3, brake_torque_2=8e3)
    kernel.advance(12.0)
    kernel.set(brake_torque_1=0.0, brake_torque_2=0.0, drawbar_force=30e3)
    kernel.advance(8.0)
    kernel.set(brake_torque_1=60e3, drawbar_force=0.0, friction_1=0.1)
    kernel.advance(20.0)
    told = [sentence.split(" at ")[0] for sentence in kernel.messages]
    assert told == ["The vehicle stands", "The vehicle moves again", "Wheelset 1 locked", "The vehicle stands"]


@pytest.mark.study
@pytest.mark.parametrize("level", LEVELS)
def test_locks_and_releases_without_end_are_told_ever_less_often(level: str) -> None:
    """Repeated locks as with wheel-slide protection; the first one of each wheelset is reported."""
    kernel, cycles = Kernel(library(level, 12), initial_speed=40.0), 20
    seen = np.zeros(12)
    for _ in range(cycles):
        kernel.set(**{f"brake_torque_{n}": 60e3 for n in range(1, 13)})
        kernel.advance(0.3)
        seen += [kernel[f"locked_{n}"] for n in range(1, 13)]
        kernel.set(**{f"brake_torque_{n}": 0.0 for n in range(1, 13)})
        kernel.advance(0.3)
    assert (seen == cycles).all()
    text = "\n".join(kernel.messages)
    for number in range(1, 13):
        told = re.findall(rf"^Wheelset {number} locked at \S+ s(?:; (\d+) times so far)?\.$", text, re.MULTILINE)
        assert told == ["", "2", "4", "8", "16"]
        assert text.count(f"Wheelset {number} turns again") == len(told)
    assert len(kernel.messages) == 12 * 2 * 5


def brick() -> System:
    """Return the model of a brick of 1 kg, pushed on a table with a friction of 1 N."""
    system = System("Brick", "A brick on a table")
    push = system.input(Variable("push", "input", "N", "Force forward"))
    v, direction = system.state("speed", "m/s", 0.0, 1.0), system.direction("direction")
    system.derivative(v, direction**2 * (push - direction))
    system.dry_friction("The brick", direction, [v], push, 1.0, ("stuck", "slides"))
    system.output(Variable("shown", "output", "m/s", "Speed"), v)
    return system


def test_a_saved_run_goes_on_counting_where_it_was() -> None:
    """A model with dry friction: the restored run gives the same messages as the original one."""
    one, other = (Kernel(quick_library(model_of(brick(), 1e-6))) for _ in range(2))

    def push(kernel: Kernel, times: int) -> list[str]:
        before = len(kernel.messages)
        for _ in range(times):
            for force in (2.0, 0.0):
                kernel.set(push=force)
                kernel.advance(0.1 if force else 0.3)
        return kernel.messages[before:]

    one.initialise()
    assert [line.split(" at ")[0] for line in push(one, 2)] == [
        "The brick slides",
        "The brick stuck",
        "The brick slides",
    ]
    other.restore(one.save())
    assert push(one, 6) == push(other, 6) != []
    assert "8 times so far" in " ".join(one.messages)
