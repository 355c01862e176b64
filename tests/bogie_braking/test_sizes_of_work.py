"""Sizes of a run (times, steps, records, speeds, lengths) have limits, and messages use the user's terms."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import pytest

import bogie_braking as bb
from bogie_braking.__main__ import main
from fmu_src.compile import build_library
from fmu_src.cosimulation.master import Coupling
from fmu_src.cosimulation.slave import CosimulationError
from fmu_src.kernel import Kernel, Library, SimulationError
from products.protection.runs import Run
from products.protection.settings import Settings
from products.train.consist import block_train
from products.train.train import Train
from rbd_model.vehicle.description import relations_of
from rbd_model.vehicle.parameters import coach_with_traction_rods, tables_5_1_and_5_2
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie
from tests.fmu_src.fmi.sled import sled

DAY = 86400.0
#: Hints to the user: 160 km/h instead of 160 m/s, and 460 mm instead of 460 m.
IN_KILOMETRES_AN_HOUR = r"Did you mean 160 km/h = 44\.44 m/s\?"
IN_MILLIMETRES = r"Did you mean 460 mm = 0\.46 m\?"


@lru_cache
def on_a_track() -> Library:
    return Library(build_library(sled()))


def train() -> Train:
    return Train(block_train(1), speed=5.0)


def a_step_of_instances() -> None:
    with bb.instances(sled(), 1, ["push"], ["speed"]) as some:
        some.step(1e6)


Call = Callable[[], Any]
REFUSED: dict[str, tuple[Call, type[Exception], str]] = {
    "a step of a kernel": (
        lambda: Kernel(on_a_track()).advance(1e300),
        SimulationError,
        "at most 86400 s, a day; got 1e",
    ),
    "just above a day": (lambda: Kernel(on_a_track()).advance(DAY + 1.0), SimulationError, "at most 86400 s, a day"),
    "a record": (
        lambda: Kernel(on_a_track()).record(1.0, 1e-12, ["speed"]),
        SimulationError,
        "at most 1e.08 numbers; got 1e-12 s",
    ),
    "no interval": (lambda: Kernel(on_a_track()).record(1.0, 0.0, ["speed"]), SimulationError, "must be above 0 s"),
    "a run": (
        lambda: bb.run(sled(), 1e300, interval=1e299),
        ValueError,
        r"The duration must be at most 86400 s, a day; got 1e\+300",
    ),
    "an interval": (
        lambda: bb.run(sled(), 1.0, interval=1e9),
        ValueError,
        r"The interval must be at most 86400 s, a day; got 1e\+09",
    ),
    "a sweep": (
        lambda: bb.sweep(sled(), 1e9, ["speed"], {"push": [1.0]}),
        ValueError,
        "The duration must be at most 86400 s",
    ),
    "a batch": (lambda: bb.batch(sled(), 1e9, ["speed"]), ValueError, "The duration must be at most 86400 s"),
    "instances": (a_step_of_instances, SimulationError, "at most 86400 s, a day"),
    "many instances": (
        lambda: bb.instances(sled(), 10**9, ["push"], ["speed"]),
        ValueError,
        "The number of instances must be at most 1000000; got 1000000000.",
    ),
    "many threads": (
        lambda: bb.batch(sled(), 1.0, ["speed"], threads=10**9),
        ValueError,
        "The number of threads must be at most 1024; got 1000000000.",
    ),
    "a train goes": (lambda: train().advance(1e6), ValueError, "from 0 to 86400 s; got 1000000"),
    "a train records": (lambda: train().record(1e6), ValueError, "the time at most 86400 s"),
    "each moment of a train": (
        lambda: train().record(60.0, 1e-9),
        ValueError,
        "The interval must be longer; got 1e-09 s",
    ),
    "a train's speed": (
        lambda: bb.train(1, speed=160.0),
        ValueError,
        f"from -150 to 150 m/s; got 160.0. {IN_KILOMETRES_AN_HOUR}",
    ),
    "macro steps": (
        lambda: list(Coupling([], []).run(10.0, 1e-12)),
        CosimulationError,
        "at most 1e.08 macro steps; got 10 s",
    ),
    "a protected stop": (
        lambda: Settings(speed=160.0),
        ValueError,
        f"speed must be at most 100 m/s; got 160 m/s. {IN_KILOMETRES_AN_HOUR}",
    ),
    "a run on the rig": (
        lambda: Run({}, speed=160.0),
        ValueError,
        f"at most 100 m/s; got 160 m/s. {IN_KILOMETRES_AN_HOUR}",
    ),
    "a period": (lambda: Settings(period=1e-12), ValueError, "period must be at least 1e-05 s; got 1e-12 s"),
    "an application time": (
        lambda: Settings(application_time=1e9),
        ValueError,
        "application_time must be at most 60 s",
    ),
    "teeth": (lambda: Settings(pulses=10**9), ValueError, "pulses must be at most 10000"),
    "a brake_ratio": (lambda: Settings(brake_ratio=1e9), ValueError, "brake_ratio must be at most 100; got 1e"),
    "a radius": (lambda: replace(tables_5_1_and_5_2(), wheel_radius=460.0), ValueError, IN_MILLIMETRES),
    "a base": (
        lambda: replace(tables_5_1_and_5_2(), wheel_base=1675.0),
        ValueError,
        r"Did you mean 1675 mm = 1\.675 m\?",
    ),
    "pivots": (lambda: coach(pivot_distance=2.0), ValueError, "or change pivot_distance, wheel_base and wheel_radius"),
    "wheels that overlap": (
        lambda: coach(pivot_distance=3.0),
        ValueError,
        r"must not overlap; they do by 0\.48 m; set pivot_dist",
    ),
    "a short bogie": (
        lambda: bogie(wheel_base=0.8),
        ValueError,
        r"wheelset_1 and wheelset_2 must not overlap; they do by 0\.05 m",
    ),
    "the radius of one wheel": (
        lambda: one_wheel(460.0),
        ValueError,
        f"must have a radius from 0.01 to 1.5 m; got 460 m. {IN_MILLIMETRES}",
    ),
}


def coach(**changes: float) -> bb.Vehicle:
    return passenger_coach(replace(coach_with_traction_rods(), **changes))


def bogie(**changes: float) -> bb.Vehicle:
    return two_axle_bogie(replace(tables_5_1_and_5_2(), **changes))


def one_wheel(radius: float) -> bb.Vehicle:
    whole = two_axle_bogie()
    return replace(whole, wheelsets=(replace(whole.wheelsets[0], radius=(radius, radius)), whole.wheelsets[1]))


@pytest.mark.parametrize("what", REFUSED)
def test_too_much_is_refused_with_its_limit(what: str) -> None:
    call, kind, words = REFUSED[what]
    with pytest.raises(kind, match=words):
        call()


def test_a_day_is_not_too_much() -> None:
    """A brake holds the sled for a day."""
    kernel = Kernel(on_a_track(), initial_speed=0.0, brake=1.0)
    kernel.advance(DAY)
    assert kernel.time == DAY
    assert bb.run(sled(), DAY, interval=DAY, initial_speed=0.0, brake=1.0)["time"][-1] == DAY


# ---- vehicles: what each of their faces says ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def at_a_point() -> bb.Vehicle:
    return replace(two_axle_bogie(), name="AtAPoint")


@pytest.mark.study
@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"initial_speed": 160.0}, f"initial_speed must be at most 150 m/s; got 160 m/s.* {IN_KILOMETRES_AN_HOUR}$"),
        (
            {"initial_speed": -160.0},
            r"initial_speed must be at least -150 m/s; got .* Did you mean -160 km/h = -44\.44 m/s\?$",
        ),
        ({"initial_speed": 1e9}, r"initial_speed must be at most 150 m/s; got 1e\+09 m/s\.$"),
        ({"wheel_radius": 460.0}, f"wheel_radius must be at most 1.5 m; got 460 m.* {IN_MILLIMETRES}$"),
        (
            {"wheel_base": 0.8},
            r"the wheels of wheelset_1 and wheelset_2 must not overlap; they do by 0\.05 m; set wheel_base and",
        ),
    ],
)
def test_a_vehicle_refuses_what_no_vehicle_has(values: dict[str, float], words: str, at_a_point: bb.Vehicle) -> None:
    with pytest.raises(SimulationError, match=words):
        bb.run(at_a_point, 0.01, level=1, **values)


@pytest.mark.study
def test_a_row_of_a_sweep_and_of_a_batch_says_the_same(at_a_point: bb.Vehicle) -> None:
    found = bb.sweep(at_a_point, 0.01, ["speed"], {"initial_speed": [20.0, 160.0, -1e9]}, level=1)
    assert [math.isnan(one) for one in found["speed"]] == [False, True, True]
    assert "160 km/h = 44.44 m/s?" in found.messages[1]
    ends = bb.batch(at_a_point, 0.01, ["speed"], initial_speed=[20.0, 160.0], wheel_base=[1.675, 1.675], level=1)
    assert "160 km/h = 44.44 m/s?" in ends.failures[1]
    ends = bb.batch(at_a_point, 0.01, ["speed"], wheel_base=[1.675, 0.8], level=1)
    assert "must not overlap" in ends.failures[1]


def test_what_parameters_must_keep_together_follows_from_the_description() -> None:
    """A coach: two bogies of two wheelsets each, and the inner wheelsets of both bogies."""
    coach_ = passenger_coach()
    relations = relations_of(coach_, {"pivot_distance", "wheel_base", "wheel_radius"})
    assert [dict(one.terms) for one in relations] == [
        {"wheel_base": 1.0, "wheel_radius": -2.0},
        {"pivot_distance": 1.0, "wheel_base": -1.0, "wheel_radius": -2.0},
        {"wheel_base": 1.0, "wheel_radius": -2.0},
    ]
    [_, middle, _] = relations_of(coach_, {"pivot_distance", "wheel_base"})
    assert middle.constant == pytest.approx(-0.92)
    assert relations_of(coach_, {"gravity"}) == ()


# ---- the command line -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["run", "qr30-180kpa", "--step", "1e-12"],
            "--step must be from 1e-05 to 0.1 s; got 1e-12.",
        ),
        (["run", "qr30-180kpa", "--step", "nan"], "--step must be from 1e-05 to 0.1 s; got nan."),
        (
            ["run", "qr30-180kpa", "--coupling-tolerance", "1e-300"],
            "--coupling-tolerance must be from 1e-09 to 0.01; got 1e-300.",
        ),
        (["pace", "point", "--step", "1e-12"], "--step must be from 2e-05 to 1 s; got 1e-12."),
        (["pace", "point", "--seconds", "1e300"], "--seconds must be from 0 to 86400 s; got 1e300."),
        (
            ["controllers", "compare", "none", "--speed", "160"],
            "--speed must be above 0 and at most 100 m/s; got 160. Did you mean 160 km/h = 44.44 m/s?",
        ),
        (["controllers", "compare", "none", "--period", "1e-12"], "--period must be from 1e-05 to 1 s; got 1e-12."),
        (
            ["controllers", "compare", "none", "--pulses", "1000000000"],
            "--pulses must be an integer from 1 to 10000; got 1000000000.",
        ),
    ],
)
def test_options_have_limits(arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(arguments) == 2
    assert words in capsys.readouterr().err
