"""The test rig: sensors against closed forms, controllers in all their forms, runs that fail, many runs at once."""

from __future__ import annotations

import math
import re
import time as clock
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.signal import lsim

from bogie_braking.controllers.scoring import ideal_distance
from brake_controller.protection_fmu import MOST_WHEELSETS
from brake_controller.slide_protection import RIG, slide_sources
from brake_controller.wheel_spin import SpinProtection
from evidence.measuring.protected_throughput import SHARE, SOURCE, LetAllGo, LetGo
from fmu_src.compile import FLAGS, compiler
from products import controller_kinds as forms_module
from products.bogie import FULL_PRESSURE, brake_values
from products.controller_kinds import Arrays, Form, compiled
from products.machine import APPLICATION_TIME, RELEASE_TIME, Machine, bogie, coach
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.programme import OWN, Case, read_programme
from products.protection.rails import ABOVE, JERK_TIME, RAILS
from products.protection.rig import Rig
from products.protection.rig_in_c import slide_protection
from products.protection.runs import Fault, Run, Stop
from products.protection.settings import BRAKE_START, STANDING, Settings
from products.protection.slide_protection import SlideProtection
from rbd_model.track.line import line_of, straight
from scenarios.bench.coupled_machine import CoupledMachine
from tests.encoder import Encoder
from tests.fmu_src.fmi.sanitized import SANITIZERS, run

#: Largest error of a reading without jitter, at 100 teeth above 3 m/s.
READING = 1e-3
#: Difference between FMUs coupled by FMPy, where torques lag by a step, and the composed system; measured 6e-4.
COUPLED = 2e-3
#: Difference between a stop with the timed brake and its closed form, which neglects creep; measured 3e-5.
CLOSED_FORM = 1e-4
#: Difference between the ideal stop (filling from a table of 200 points) and our integration; measured 3.5e-5.
IDEAL = 1e-4
#: Difference between a largest jerk and that of another discretisation.
JERK = 0.02
LOW, RADIUS = RAILS[2], 0.425


def in_c(tmp_path: Path, text: str = SOURCE, share: float = SHARE) -> Form:
    source = tmp_path / f"let_go_{share:g}.c"
    source.write_text(f"#define SHARE {share}\n{text}")
    return compiled(source)


# ---- controllers -----------------------------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize("by_flow", [False, True], ids=["timed", "by flow"])
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_all_forms_of_a_controller_make_the_same_stop(machine: Machine, by_flow: bool, tmp_path: Path) -> None:
    rails = [rail.values(len(machine.numbers)) for rail in (RAILS if len(machine.numbers) == 2 else RAILS[2:])]
    forms = (LetGo, Arrays(LetAllGo()), in_c(tmp_path))
    found = [Rig(machine, form, Settings(), by_flow=by_flow).stops(rails) for form in forms]
    assert found[0] == found[1] == found[2]
    assert all(stop.distance and bool(stop.lowest_reservoir) == by_flow for stop in found[0])
    other = Rig(machine, in_c(tmp_path, share=0.81), Settings(), by_flow=by_flow).stops(rails)
    assert other[-2].distance != found[0][-2].distance


def coupled_stop(rail: dict[str, float]) -> tuple[float, float]:
    """Simulate LetGo's stop by FMUs that a master couples: the distance [m] and the longest lock [s]."""
    brake = brake_values() | {"application_time": APPLICATION_TIME, "release_time": RELEASE_TIME, "tolerance": 1e-6}
    names = ("speed", "distance", "rotation_1", "rotation_2", "angular_velocity_1", "angular_velocity_2")
    sensors, controller, locked, longest = [Encoder(), Encoder()], LetGo(), [0.0, 0.0], 0.0
    with CoupledMachine("bogie", (1, 2)) as machine:
        machine.start({"level": 2.0, "initial_speed": 25.0} | rail, [brake] * 2)

        def drive(time: float) -> None:
            turned = machine.vehicle.get(names[2:4])
            shown = [RADIUS * one.angular_velocity(time, angle) for one, angle in zip(sensors, turned, strict=True)]
            for cylinder, valve in zip(machine.brakes, controller.step(time, shown), strict=True):
                cylinder.set(pressure_demand=FULL_PRESSURE if time >= BRAKE_START else 0.0, valve=valve)

        for _ in machine.coupling().run(300.0, 5e-3, drive):
            speed, distance, *_, first, second = machine.vehicle.get(names)
            if speed < STANDING:
                break
            locked = [
                one + 5e-3 if not turns and speed > 0.3 else 0.0
                for one, turns in zip(locked, (first, second), strict=True)
            ]
            longest = max(longest, *locked)
    return distance, longest


@pytest.mark.study
def test_a_stop_is_that_of_coupled_fmus() -> None:
    distance, lock = coupled_stop(LOW.values())
    [stop] = Rig(bogie(), LetGo, Settings()).stops([LOW.values()])
    assert stop.distance == pytest.approx(distance, rel=COUPLED)
    assert stop.longest_lock == pytest.approx(lock, abs=0.02)


@pytest.mark.study
def test_runs_that_wait_are_those_that_run_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows that finish take over the next run, and so do controllers and sensors."""
    rails = [{**LOW.values(), "friction_1": f, "friction_2": f} for f in np.linspace(0.07, 0.2, 11)]
    form, settings = in_c(tmp_path), Settings(jitter=0.1)
    alone = [Rig(bogie(), form, settings).stops([rail])[0] for rail in rails]
    monkeypatch.setattr(forms_module, "AT_ONCE", 4)
    assert Rig(bogie(), form, settings).stops(rails) == alone
    assert Rig(bogie(), LetGo, settings, threads=1).stops(rails) == alone


# ---- brakes by flow of air -------------------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_a_stop_without_protection_takes_one_filling_of_air(machine: Machine) -> None:
    """n cylinders take n V p / (1.2 R T) (`EXPONENT`), and the reservoir loses it at constant temperature."""
    count = len(machine.numbers)
    [stop] = Rig(machine, None, Settings(), by_flow=True).runs([Run(RAILS[0].values(count) | {"feed_orifice": 0.0})])
    taken = count * 10.3e-3 * machine.full_pressure / (1.2 * 287.05287 * 293.15)
    assert stop.air == pytest.approx(taken, rel=1e-3)
    lost = taken * 287.05287 * 293.15 / (0.05 * count)
    assert stop.lowest_reservoir == pytest.approx(500e3 - lost, rel=1e-4)


def test_an_empty_reservoir_brakes_as_little_as_its_air(tmp_path: Path) -> None:
    """Two cylinders of 10.3 l and 100 l of air reach one pressure; the brake has the same share of its full force.

    The filling time adds a distance proportional to the speed, which cancels in d(25 m/s) - 2.5 d(10 m/s).
    """
    dry = RAILS[0].values() | {"feed_orifice": 0.0}
    pressure = 60e3 / (1.0 + 2 * 10.3e-3 / 1.2 / 0.1)
    share = pressure / bogie().full_pressure

    def ways(brake_ratio: float, filled: float) -> list[Stop]:
        runs = [Run(dry | {"initial_reservoir_pressure": filled}, speed, brake_ratio) for speed in (25.0, 10.0)]
        return Rig(bogie(), None, Settings(), by_flow=True).runs(runs)

    weak, same = ways(1.0, 60e3), ways(share, 500e3)
    assert weak[0].lowest_reservoir == pytest.approx(pressure, rel=1e-3)
    without_filling = [(one.distance or 0.0) - 2.5 * (other.distance or 0.0) for one, other in (weak, same)]
    assert without_filling[0] == pytest.approx(without_filling[1], rel=1e-3)
    [none] = Rig(bogie(), None, Settings(speed=10.0), by_flow=True).stops([dry | {"initial_reservoir_pressure": 0.0}])
    assert none.distance is None
    assert "It did not stop" in none.message


def test_slow_valves_stop_later(tmp_path: Path) -> None:
    """At a tenth of the valve times the period and the sensor limit the controller, at ten times the valves do."""
    times = [{"valve_opening_time": t, "valve_closing_time": t} for t in (3e-3, 0.03, 0.3)]
    fast, common, slow = Rig(bogie(), in_c(tmp_path), Settings(), by_flow=True).stops(
        [LOW.values() | one for one in times]
    )
    assert fast.distance == pytest.approx(common.distance, rel=0.02)
    assert slow.distance > 1.05 * (common.distance or 0.0)
    assert fast.longest_lock < common.longest_lock < slow.longest_lock


@pytest.mark.long
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_stops_in_space_are_those_in_the_plane(machine: Machine, tmp_path: Path) -> None:
    """On straight, smooth track: measured 0.8 % under a rough controller, 0.12 % where wheels roll or lock."""
    rails, form = [rail.values(len(machine.numbers)) for rail in RAILS], in_c(tmp_path)
    for given, band in ((form, 0.01), (None, 0.0015)):
        plane, space = (Rig(machine, given, Settings(), by_flow=True, level=level).stops(rails) for level in (2, 3))
        for one, other in zip(plane, space, strict=True):
            assert other.distance == pytest.approx(one.distance, rel=band)


# ---- scores ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_locked_wheels_turn_the_energy_of_motion_into_sliding(machine: Machine) -> None:
    """Sliding dissipates m v^2 / 2 minus the brakes' work before locking, which fifty times the brake makes small."""
    [stop] = Rig(machine, None, Settings(brake_ratio=50.0)).stops([LOW.values(len(machine.numbers))])
    motion = machine.mass * 25.0**2 / 2
    assert 0.985 * motion < sum(stop.sliding) < motion
    assert stop.distance is not None
    assert stop.longest_skid < stop.distance
    [dry] = Rig(machine, None, Settings()).stops([RAILS[0].values(len(machine.numbers))])
    assert sum(dry.sliding) < 0.01 * motion
    assert dry.longest_skid == 0.0


# ---- what a machine has ----------------------------------------------------------------------------------------------


#: Tolerances of the rig against the ideal of a separate integration, where all wheels roll. A cylinder refills through
#: its regulator while a dynamic brake fades; in the ideal it refills at once.
ROLLS, REFILLS = 1e-3, 2e-2


@pytest.mark.study
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
@pytest.mark.parametrize(
    "equipment", [("discs",), ("dynamic brake",), ("sanders",), ("traction",)], ids=lambda one: one[0]
)
def test_where_all_wheels_roll_a_run_is_the_ideal_one(equipment: tuple[str, ...], machine: Machine) -> None:
    rail = RAILS[0].values(len(machine.numbers)) | ({"sand_rate_1": 0.05} if "sanders" in equipment else {})
    band = REFILLS if "dynamic brake" in equipment else ROLLS
    for speed, brake_ratio in ((25.0, 1.0), (12.0, 0.6)):
        run = Run(rail, speed, brake_ratio, equipment=equipment)
        [found] = Rig(machine, None, Settings(), by_flow=True).runs([run])
        ideal = ideal_distance(machine, run, Settings())
        assert ideal is not None
        assert found.distance == pytest.approx(ideal, rel=band)
        assert found.distance is not None
        assert found.distance > (1 - ROLLS) * ideal


@pytest.mark.study
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_motors_that_spin_turn_their_work_into_motion_and_sliding(machine: Machine) -> None:
    """With almost no friction, m v^2 / 2 + J w^2 / 2 + sliding equals the work at constant power, once fast."""
    count = len(machine.numbers)
    low = {f"friction_{number}": 0.02 for number in machine.numbers}
    run = Run(LOW.values(count) | low, 4.0, 3.0, equipment=("traction",))
    [found] = Rig(machine, None, Settings(), by_flow=True).runs([run], every=0.05)
    course = found.history
    assert course is not None
    work = np.trapezoid((course.effort * course.angular_velocity).sum(axis=1), course.time)
    p = machine.parameters
    turning = p.wheelset_pitch_inertia * (course.angular_velocity[-1] ** 2).sum() / 2
    moving = machine.mass * (course.speed[-1] ** 2 - course.speed[0] ** 2) / 2
    assert found.longest_lock > 10.0
    assert work == pytest.approx(moving + turning + sum(found.sliding), rel=1e-2)


@pytest.mark.study
def test_a_protection_against_spin_gains_speed_sooner_than_motors_that_spin() -> None:
    """Friction and brake_ratio are drawn at random; on a dry rail no motor receives a command."""
    draw = np.random.default_rng(32)
    for machine in (bogie(), coach()):
        count = len(machine.numbers)
        runs = []
        for _ in range(6):
            friction = {f"friction_{number}": draw.uniform(0.03, 0.1) for number in machine.numbers}
            runs.append(Run(LOW.values(count) | friction, 15.0, draw.uniform(1.0, 2.0), equipment=("traction",)))
        protected = Rig(machine, SpinProtection, Settings(jitter=0.05)).runs(runs)
        alone = Rig(machine, None, Settings()).runs(runs)
        for stop, other in zip(protected, alone, strict=True):
            assert (stop.distance or math.inf) <= (other.distance or 0.0)
            assert stop.longest_lock < 0.4
        [dry] = Rig(machine, SpinProtection, Settings()).runs(
            [Run(RAILS[0].values(count), 15.0, 1.7, equipment=("traction",))]
        )
        assert dry.commands == 0


@pytest.mark.study
def test_sand_stops_a_machine_sooner_the_further_ahead_it_falls() -> None:
    def stop(equipment: tuple[str, ...], **sand: float) -> float:
        run = Run(LOW.values(4) | {f"friction_{n}": 0.03 for n in range(1, 5)} | sand, 15.0, equipment=equipment)
        [found] = Rig(coach(), None, Settings(), by_flow=True).runs([run])
        return found.distance or math.inf

    none, last, first = stop(()), stop(("sanders",), sand_rate_4=0.03), stop(("sanders",), sand_rate_1=0.03)
    assert stop(("sanders",)) == pytest.approx(none, rel=1e-6)
    assert first < 0.7 * last < 0.7 * none


@pytest.mark.study
def test_a_dynamic_brake_lets_go_when_its_valve_vents(tmp_path: Path) -> None:
    """Only the motors brake here, as the cylinders have no air. Wheels slide until the brakes fade."""
    rail = LOW.values() | {"initial_reservoir_pressure": 0.0, "feed_orifice": 0.0, "motor_torque": 15e3}
    run = Run(rail, 15.0, equipment=("dynamic brake",))
    [alone], [protected] = (
        Rig(bogie(), one, Settings(), by_flow=True).runs([run]) for one in (None, slide_protection())
    )
    assert max(protected.sliding) < 0.1 * max(alone.sliding)
    assert protected.share_in_band > 0.9 > 0.5 > alone.share_in_band


@pytest.mark.study
def test_runs_of_machines_with_other_equipment_keep_their_places(tmp_path: Path) -> None:
    rail = LOW.values()
    kinds = [(), ("discs",), ("traction",), (), ("discs", "sanders")]
    runs = [Run(rail, 8.0, equipment=kind) for kind in kinds]
    for form in (in_c(tmp_path), Arrays(LetAllGo()), LetGo):
        together = Rig(bogie(), form, Settings(), by_flow=True).runs(runs)
        assert together == [Rig(bogie(), form, Settings(), by_flow=True).runs([run])[0] for run in runs]


def ran(run: Run, level: int = 2) -> None:
    Rig(bogie(), None, Settings(), level=level).runs([run])


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: ran(Run({}), 1), "level must be 2 (planar) or 3 (3D) on the test rig;"),
        (lambda: ran(Run({"friction_11": 0.1})), "This machine has no friction_11; did you mean friction_1?"),
        (lambda: ran(Run({}, equipment=("discs",))), "A vehicle with discs must have cylinders filled by flow of air"),
        (
            lambda: Run({}, equipment=("disc",)),
            "Equipment must be one of discs, dynamic brake, sanders, traction; got 'disc'.",
        ),
        (
            lambda: Run({}, equipment=("discs", "traction")),
            "A vehicle with traction must have no discs and no dynamic brake: its run does not brake.",
        ),
        (lambda: Fault(1, sensor="blind"), "sensor must be one of stuck, zero, doubled; got 'blind'."),
        (lambda: Fault(1, radius=3.0), "radius must be 0.5 to 2 times the true one; got 3.0."),
        (lambda: Fault(0, sensor="zero"), "wheelset must be an integer of at least 1; got 0."),
        (lambda: Fault(1, sensor_from=3.0), "This fault has no effect; give it a sensor,"),
        (
            lambda: ran(Run(LOW.values(), faults=(Fault(3, radius=1.1),))),
            "The wheelset of a fault must be from 1 to 2; got 3.",
        ),
    ],
)
def test_runs_that_cannot_be_are_refused_in_a_sentence(call: Callable[[], object], sentence: str) -> None:
    with pytest.raises(ValueError, match=re.escape(sentence)):
        call()


# ---- what fails in the machine ---------------------------------------------------------------------------------------


class Notes:
    """Apply all brakes and record the inputs."""

    seen: ClassVar[list[list[float]]] = []

    def step(self, time: float, speeds: list[float]) -> list[int]:
        self.seen.append([time, *speeds])
        return [0] * len(speeds)


def noted(*faults: Fault) -> NDArray[np.float64]:
    """Return the times and speeds that a controller receives in a stop on the dry rail."""
    Notes.seen.clear()
    Rig(bogie(), Notes, Settings()).runs([Run(RAILS[0].values(), faults=faults)])
    return np.array(Notes.seen)


@pytest.mark.study
def test_a_sensor_that_fails_shows_what_it_is_told_to_show() -> None:
    whole = noted()
    late = whole[:, 0] >= 3.0
    for kind, expected in {"zero": 0.0 * whole[:, 2], "doubled": 2.0 * whole[:, 2]}.items():
        found = noted(Fault(2, sensor=kind, sensor_from=3.0))
        assert np.array_equal(found[:, :2], whole[:, :2])
        assert np.array_equal(found[:, 2], np.where(late, expected, whole[:, 2]))
    stuck = noted(Fault(1, sensor="stuck", sensor_from=3.0))
    assert np.all(stuck[late, 1] == whole[~late, 1][-1])
    wrong = noted(Fault(1, radius=1.03))
    assert wrong[:, 1] == pytest.approx(1.03 * whole[:, 1], rel=1e-12)
    assert np.array_equal(wrong[:, 2], whole[:, 2])


class VentsLater(LetGo):
    def step(self, time: float, speeds: list[float]) -> list[int]:
        return [2 if time > 3.0 else 0] * len(speeds)


@pytest.mark.study
def test_a_valve_that_sticks_stays_where_it_stands() -> None:
    rail = RAILS[0].values()
    both = tuple(Fault(number, valve_from=2.0) for number in (1, 2))
    [none] = Rig(bogie(), None, Settings()).stops([rail])
    one, stuck, later = Rig(bogie(), VentsLater, Settings()).runs(
        [Run(rail, faults=both[:1]), Run(rail, faults=both), Run(rail, faults=(Fault(1, valve_from=4.0),))]
    )
    assert (stuck.distance, stuck.commands) == (none.distance, 0)
    assert one.distance is not None
    assert one.distance > 1.5 * (none.distance or 0.0)
    # The valve stuck after the command to vent: nothing brakes.
    assert later.distance is None


class Venting:
    """Vents the first wheelset for 3 s and for 2 s, the other one for 2 s, then holds it and vents it for 2.5 s."""

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return 2, vent, at these times."""
        first = 2 if 1.0 <= time < 4.0 or 6.0 <= time < 8.0 else 0
        return [first, 1 if 3.0 <= time < 3.1 else 2 if 1.0 <= time < 5.6 else 0]


def test_the_longest_vent_is_that_of_one_valve_without_a_pause() -> None:
    [stop] = Rig(bogie(), Venting, Settings()).stops([LOW.values()])
    assert stop.longest_vent == pytest.approx(3.0)


def test_the_jerk_is_that_of_the_filtered_deceleration() -> None:
    """The derivative of the acceleration behind two lags, s / (JERK_TIME s + 1)^2, simulated by SciPy."""
    period = Settings().period
    [stop] = Rig(coach(), LetGo, Settings(), by_flow=True).runs([Run(LOW.values(4), speed=15.0)], every=period)
    course = stop.course
    slope = np.gradient(course.speed, course.time)
    _, jerk, _ = lsim(([1.0, 0.0], [JERK_TIME**2, 2.0 * JERK_TIME, 1.0]), slope, course.time)
    assert stop.jerk == pytest.approx(np.abs(jerk[course.speed > ABOVE]).max(), rel=JERK)
    assert stop.jerk > 0.4


# ---- programmes ------------------------------------------------------------------------------------------------------


def test_the_programme_that_comes_along_reads_as_it_is_written() -> None:
    cases = {case.name: case for case in read_programme(OWN)}
    assert len(cases) == 40
    assert all(case.group and case.source for case in cases.values())
    assert cases["low, 200 km/h"].speed == pytest.approx(200 / 3.6)
    assert cases["low, valve 1 sticks at 6 s"].faults == (Fault(1, valve_from=6.0),)
    assert cases["dry"].run(coach()).values["friction_4"] == 0.55
    assert cases["low, laden"].run(coach()).values["body_mass"] == pytest.approx(
        1.5 * coach().parameters.values()["body_mass"]
    )
    third = Case("third", "dry", faults=(Fault(3, radius=1.1),))
    with pytest.raises(ValueError, match=re.escape("The case third has a fault of wheelset 3; there are 2 here.")):
        third.run(bogie())


#: A case that can be run.
CASE = '[[case]]\nname = "a"\nrail = "dry"\n'


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "has no [[case]]; give it one for each stop."),
        ("[[case]\n", "must be TOML; got a fault"),
        (CASE + "[[cases]]", "there is no [cases]; call each stop [[case]]."),
        ('[[case]]\nrail = "dry"', "give a name, as in name = "),
        (CASE + 'equipment = ["sanders"]', "sanders without sand have no effect; set"),
        (
            '[[case]]\nname = "a"',
            "case 1 (a): rail must be one of dry, wet, low, slippery, extremely_low, very_low; got nothing.",
        ),
        (CASE + "speeed = 3", "case 1 (a): there is no speeed; did you mean speed?"),
        (CASE + 'speed = "3mph"', "as 25m/s or 160km/h; got 3mph."),
        (CASE + "brake_ratio = 0", "brake_ratio must be above 0 and at most 5; got 0."),
        (
            CASE + "load = 9",
            "load must be 0.2 to 5 times the mass of the body;",
        ),
        (CASE + "friction = 2", "friction must be above 0 and at most 1; got 2."),
        (CASE + "fault = [{}]", "a fault needs the number of its wheelset."),
        (CASE + "fault = [{ wheel = 1 }]", "a fault has no wheel; give some of"),
        (CASE + "values = [1]", "give values names, as in values = { gradient"),
        (
            CASE + 'values = { gradient = "up" }',
            "gradient must be a number; got 'up'.",
        ),
        (CASE + 'friction = "low"', "friction must be a number; got 'low'."),
        (CASE + "brake_ratio = true", "brake_ratio must be a number; got true."),
        (
            CASE + "fault = [{ wheelset = 1.5, radius = 1.1 }]",
            "wheelset must be an integer of at least 1; got 1.5.",
        ),
        (
            CASE + 'fault = [{ wheelset = 1, sensor = "zero", sensor_from = "6s" }]',
            "sensor_from must be a number; got '6s'.",
        ),
        (
            CASE + "fault = [{ wheelset = 1, valve_from = nan }]",
            "must have finite numbers; got nan.",
        ),
        (CASE + "fault = [3]", "give fault a list, [{ wheelset = 1, sensor = ... }]."),
        (2 * CASE, "2 of [[case]] are called a; give each its own name."),
    ],
)
def test_programmes_that_cannot_be_are_refused_in_a_sentence(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(sentence)) as refused:
        read_programme(path)
    assert str(path) in str(refused.value)


# ---- controllers that fail -------------------------------------------------------------------------------------------


class Raises(LetGo):
    def step(self, time: float, speeds: list[float]) -> list[int]:
        if time > 3.0:
            raise RuntimeError("broken")
        return super().step(time, speeds)


class Writes(LetAllGo):
    def step(self, time: NDArray[np.float64], speeds: NDArray[np.float64]) -> NDArray[np.integer]:
        speeds[:] = 0.0
        return super().step(time, speeds)


def gives(answer: object, base: type = LetGo) -> Any:
    """Return a class of controllers that always give this answer."""
    return type("Gives", (base,), {"step": lambda self, time, speeds: answer})


NONSENSE = SOURCE.replace("? WHEEL_SLIDE_VENT", "? 7")
#: Condition of writes beyond the controller's memory and beyond its valves: after the third second.
LATE = "if (time > 3.0)"
BEYOND_MEMORY = SOURCE.replace("double fastest = 0.0;", f"double fastest = 0.0;\n    {LATE} ((char *)memory)[200] = 1;")
BEYOND_VALVES = SOURCE.replace("double fastest = 0.0;", f"double fastest = 0.0;\n    {LATE} valve[9] = 0;")


TOO_FEW = gives([0])


def failing(tmp_path: Path) -> Iterator[tuple[str, Form]]:
    yield "RuntimeError: broken", Raises
    yield r"gave \[0\] at", TOO_FEW
    yield "read-only", Arrays(Writes())
    yield r"gave \[nan, nan\] at", Arrays(gives(np.full((1, 2), math.nan), LetAllGo)())
    yield r"must have the shape \(1, 2\)", Arrays(gives(np.zeros(1, int), LetAllGo)())
    yield "gave 7 for valve", in_c(tmp_path, NONSENSE, 0.9)
    yield r"gave \[True, True\] at", gives([True, True])
    yield r"gave \[\] at", gives(None)
    yield r"gave \[True, True\] at", Arrays(gives(np.ones((1, 2), bool), LetAllGo)())
    yield "wrote behind its memory", in_c(tmp_path, BEYOND_MEMORY, 0.91)
    yield "or behind its 2 valves at 3.005 s", in_c(tmp_path, BEYOND_VALVES, 0.92)


@pytest.mark.study
def test_a_controller_that_fails_leaves_the_brake_applied(tmp_path: Path) -> None:
    """A message and no distance. If it fails before its first command, the vehicle stops as without a controller."""
    [unprotected] = Rig(bogie(), None, Settings()).stops([LOW.values()])
    for words, form in failing(tmp_path):
        [stop] = Rig(bogie(), form, Settings()).stops([LOW.values()])
        assert stop.distance is None
        assert stop.message
        assert re.search(words, stop.message), stop.message
        assert stop.message.endswith("the brake stays applied.")
        assert stop.end_speed < 0.02
        if form is TOO_FEW:
            assert (stop.time, stop.longest_lock) == (unprotected.time, unprotected.longest_lock)


class Waits(LetGo):
    """Wait longer than the limit, from the third second on."""

    def step(self, time: float, speeds: Sequence[float]) -> list[int]:
        clock.sleep(5.0 * (time > 3.0))
        return super().step(time, speeds)


class WaitsForAll(LetAllGo):
    """The same for many vehicles."""

    def step(self, time: NDArray[np.float64], speeds: NDArray[np.float64]) -> NDArray[np.integer]:
        clock.sleep(5.0 * bool(time.max() > 3.0))
        return super().step(time, speeds)


@pytest.mark.study
@pytest.mark.parametrize("form", [Waits, Arrays(WaitsForAll())], ids=["class", "arrays"])
def test_runs_of_a_controller_that_gives_no_answer_are_not_judged(form: Form, monkeypatch: pytest.MonkeyPatch) -> None:
    """Later runs, for which it is not called again, are excluded too; a run that ended before is kept."""
    monkeypatch.setattr("products.protection.rig.GUARD", 1.0)
    monkeypatch.setattr("products.protection.rig.SILENCES", 1)
    soon, *others = Rig(bogie(), form, Settings()).runs([Run(RAILS[0].values(), speed=1.0), *[Run(LOW.values())] * 2])
    assert soon == Rig(bogie(), LetGo, Settings()).runs([Run(RAILS[0].values(), speed=1.0)])[0]
    assert soon.judged
    assert [(one.judged, one.distance) for one in others] == [(False, None)] * 2
    assert any("gave no answer within 1 s of wall time at 3.005 s and is not judged" in one.message for one in others)


@pytest.mark.study
def test_a_look_that_takes_long_on_a_busy_machine_changes_no_stop(monkeypatch: pytest.MonkeyPatch) -> None:
    """One call waits for longer than the limit of processor time; many runs share an alarm."""
    monkeypatch.setattr("products.protection.rig.PATIENCE", 0.1)

    class Late(LetGo):
        def step(self, time: float, speeds: Sequence[float]) -> list[int]:
            clock.sleep(0.12 * (time == 2.0))
            return super().step(time, speeds)

    rails = [RAILS[0].values(), LOW.values()]
    assert Rig(bogie(), Late, Settings()).stops(rails) == Rig(bogie(), LetGo, Settings()).stops(rails)


@pytest.mark.study
def test_a_machine_that_goes_no_further_says_why(tmp_path: Path) -> None:
    """A very high frame tips over its leading wheelset; the other runs continue."""
    rail = RAILS[0].values()
    runs = [Run(rail | {"frame_height": 3.0}), Run(rail, brake_ratio=1.0)]
    for form in (LetGo, Arrays(LetAllGo()), in_c(tmp_path)):
        lost, stop = Rig(bogie(), form, Settings(brake_ratio=4.0)).runs(runs)
        assert lost.distance is None
        assert lost.message.startswith("The machine went no further: Wheelset 2 lifted off the rail at ")
        assert stop == Rig(bogie(), form, Settings()).stops([rail])[0]


#: Difference between the filling from the ideal's table of 200 points and the rig's cylinders; measured 8e-4.
FILLING = 1e-3


@pytest.mark.study
@pytest.mark.parametrize(
    ("values", "held"),
    [
        ({}, 0.0),
        ({"gradient": -0.02}, -0.02 / math.hypot(1.0, 0.02)),
        ({"curvature": 1 / 300, "curve_resistance": 1.0}, 0.65 / (300.0 - 55.0)),
        ({"frame_mass": 1.5 * 60e3}, 0.0),
    ],
    ids=["straight", "gradient", "curve", "laden"],
)
def test_the_ideal_knows_what_else_holds_a_machine_back(values: dict[str, float], held: float) -> None:
    """Full brake with rolling wheels: between stops from two speeds, g times the resistance adds to the brake.

    Curve: von Roeckl, 0.65 m / (R - 55 m). The filling cancels in d(25 m/s) - 2.5 d(10 m/s) to second order.
    """
    machine, rail = bogie(), RAILS[0].values() | values
    added = values.get("frame_mass", machine.parameters.frame_mass) - machine.parameters.frame_mass
    a = machine.deceleration(machine.full_torque, added) + 9.81 * held
    ideal = PeakAdhesion(machine, rail)
    runs = [Run(rail, speed) for speed in (25.0, 10.0)]
    stops = [stop.distance or 0.0 for stop in Rig(machine, None, Settings(), by_flow=True).runs(runs)]
    for stop, speed in zip(stops, (25.0, 10.0), strict=True):
        assert stop == pytest.approx(ideal.stopping_distance(speed), rel=4 * FILLING)
    assert stops[0] - 2.5 * stops[1] == pytest.approx((25.0**2 - 250.0) / (2 * a), rel=2e-2)


@pytest.mark.study
def test_runs_on_lines_with_maps_of_friction_and_without_are_each_their_own() -> None:
    """Half of twice the friction is the same rail; down a gradient g i adds up; leaves lengthen stop and ideal."""
    machine, flat = bogie(), line_of([straight(1020.0)], -20.0)
    slope, places = line_of([straight(1020.0, -0.01)], -20.0), [60.0, 60.0, 160.0, 160.0]
    leaves = flat.with_friction(places, [1.0, 0.25, 0.25, 1.0])
    twice = LOW.values() | {f"friction_{n}": 0.16 for n in machine.numbers}
    runs = [
        *(Run(twice, line=flat.with_friction([0.0], [0.5])), Run(LOW.values()), Run(LOW.values(), line=leaves)),
        *(Run(LOW.values(), line=slope), Run(LOW.values() | {"gradient": -0.01})),
    ]
    settings, form = Settings(), slide_protection()
    stops = [stop.distance or 0.0 for stop in Rig(machine, form, settings, by_flow=True).runs(runs)]
    ideals = [ideal_distance(machine, one, settings) or 0.0 for one in runs]
    for found, band in ((stops, 5e-3), (ideals, 1e-3)):
        assert found[0] == pytest.approx(found[1], rel=band)
        assert found[3] == pytest.approx(found[4], rel=band)
        assert found[2] > 1.1 * found[1]
    assert all(stop >= 0.98 * ideal for stop, ideal in zip(stops, ideals, strict=True))


def test_a_case_names_its_line_beside_its_programme(tmp_path: Path) -> None:
    leaves = line_of([straight(1000.0)]).with_friction([60.0, 90.0], [1.0, 0.25])
    leaves.write(tmp_path / "leaves.csv")
    text = '[[case]]\nname = "leaves"\nrail = "wet"\nline = {}\n'
    (tmp_path / "my.toml").write_text(text.format('"leaves.csv"'))
    [case] = read_programme(tmp_path / "my.toml")
    assert case.run(bogie()).line == leaves
    for line, words in (
        ('"missing.csv"', "case 1 .leaves.: .*missing.csv"),
        ("3", "line must be the path of a line file"),
    ):
        (tmp_path / "my.toml").write_text(text.format(line))
        with pytest.raises(ValueError, match=words):
            read_programme(tmp_path / "my.toml")


@pytest.mark.study
@pytest.mark.parametrize("brake_ratio", [0.5, 1.0, 1.5])
def test_where_all_wheels_roll_the_stop_is_the_ideal_one(brake_ratio: float) -> None:
    """While the brake fills, the deceleration is 1 - 20^(-t/T) of its full value; closed-form integrals, no creep."""
    machine, settings = bogie(), Settings(brake_ratio=brake_ratio)
    [stop] = Rig(machine, None, settings).stops([RAILS[0].values()])
    a, tau = machine.deceleration(brake_ratio * machine.full_torque), settings.application_time / math.log(20.0)
    speed = settings.speed
    lasts = brentq(lambda t: speed - a * (t - tau * (1 - math.exp(-t / tau))), 0.0, 1e3)
    way = speed * lasts - a * (lasts**2 / 2 - tau * lasts + tau**2 * (1 - math.exp(-lasts / tau)))
    assert stop.distance == pytest.approx(speed * BRAKE_START + way, rel=CLOSED_FORM)
    timed = PeakAdhesion(machine, RAILS[0].values(), lambda since: 1.0 - math.exp(-max(0.0, since) / tau))
    assert timed.stopping_distance(speed, brake_ratio) == pytest.approx(speed * BRAKE_START + way, rel=2 * CLOSED_FORM)


def filled_by_flow(full: float, lasts: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times [s] and shares of the full gauge pressure [Pa] for the filling of a constant volume from empty.

    The flow is isentropic and takes `lasts` [s] to 95 %: dp/dt is proportional to the flow function (ISO 6358-1).
    """
    k, air, share = 1.4, 101325.0, 0.999 * (1.0 - np.linspace(1.0, 0.0, 20_000) ** 2)
    ratio = np.maximum((share * full + air) / (full + air), (2 / (k + 1)) ** (k / (k - 1)))
    slope = np.sqrt(ratio ** (2 / k) - ratio ** ((k + 1) / k))
    time = np.concatenate([[0.0], np.cumsum(np.diff(share) * (1 / slope[1:] + 1 / slope[:-1]) / 2)])
    return time * lasts / np.interp(0.95, share, time), share


@pytest.mark.study
@pytest.mark.parametrize(("brake_ratio", "application_time"), [(0.5, 2.0), (1.0, 2.0), (1.5, 5.0)])
def test_where_all_wheels_roll_a_stop_by_flow_of_air_is_the_ideal_one(
    brake_ratio: float, application_time: float
) -> None:
    """While the brake fills, the deceleration follows the pressure; integrated here without creep."""
    machine, settings = bogie(), Settings(brake_ratio=brake_ratio, application_time=application_time)
    [stop] = Rig(machine, None, settings, by_flow=True).stops([RAILS[0].values()])
    time = np.linspace(0.0, 60.0, 600_001)
    share = np.interp(time, *filled_by_flow(machine.full_pressure, settings.application_time))
    a, step = machine.deceleration(brake_ratio * machine.full_torque), time[1]
    speed = settings.speed - a * step * (np.cumsum(share) - share / 2 - share[0] / 2)
    way = settings.speed * BRAKE_START + step * speed[speed > 0.0].sum()
    assert stop.distance == pytest.approx(way, rel=FILLING)
    ideal = ideal_distance(machine, Run(RAILS[0].values()), settings)
    assert ideal == pytest.approx(way, rel=IDEAL)


@pytest.mark.study
@pytest.mark.parametrize("kind", ["zero", "stuck", "doubled"])
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_the_protection_does_without_a_sensor_that_fails(kind: str, machine: Machine) -> None:
    """At every time tested, the distance is at most four fifths of that of locked wheels."""
    rail, times = LOW.values(len(machine.numbers)), (3.0, 6.0, 12.0, 20.0, 30.0)
    runs = [Run(rail, faults=(Fault(1, sensor=kind, sensor_from=time),)) for time in times]
    stops = Rig(machine, slide_protection(), Settings(), by_flow=True).runs(runs)
    [locked] = Rig(machine, None, Settings(), by_flow=True).stops([rail])
    assert max(stop.distance or math.inf for stop in stops) < 0.8 * (locked.distance or 0.0)


@pytest.mark.study
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_wheels_are_protected_beside_one_that_its_valve_locks(machine: Machine) -> None:
    """A locked wheel that is vented in vain has no acceleration, and does not show the speed of the vehicle."""
    rail = LOW.values(len(machine.numbers))
    runs = [Run(rail, faults=(Fault(1, valve_from=time),)) for time in (5.0, 5.5, 6.0, 6.5, 7.0)]
    stops = Rig(machine, slide_protection(), Settings(), by_flow=True).runs(runs)
    [locked] = Rig(machine, None, Settings(), by_flow=True).stops([rail])
    locks = [stop.distance or math.inf for stop in stops if stop.longest_lock > 10.0]
    assert locks
    assert max(locks) < 0.8 * (locked.distance or 0.0)


@pytest.mark.study
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_a_wheel_without_sensor_slides_after_its_neighbour(machine: Machine) -> None:
    """It gets less pressure until its neighbour is seen to roll at full pressure; measured at most 0.1 s of lock."""
    runs = []
    for number in machine.numbers:
        for friction in (0.06, 0.08):
            rail = LOW.values(len(machine.numbers)) | {f"friction_{one}": friction for one in machine.numbers}
            runs.append(Run(rail, faults=(Fault(number, sensor="zero"),)))
    stops = Rig(machine, slide_protection(), Settings(), by_flow=True).runs(runs)
    assert max(stop.longest_lock for stop in stops) < 1.0
    # On a dry rail the pressure is complete a little later; without effect of the sensor, at the same instant.
    dry = RAILS[0].values(len(machine.numbers))
    whole, late = Rig(machine, slide_protection(), Settings(), by_flow=True).runs(
        [Run(dry), Run(dry, faults=(Fault(1, sensor="zero"),))]
    )
    assert 1.0 < (late.distance or math.inf) / (whole.distance or math.inf) < 1.02


@pytest.mark.study
@pytest.mark.parametrize("by_flow", [False, True], ids=["timed", "by flow"])
@pytest.mark.parametrize("machine", [bogie(), coach()], ids=["bogie", "coach"])
def test_no_failure_of_a_sensor_makes_a_stop_longer_than_locked_wheels(machine: Machine, by_flow: bool) -> None:
    """Kind, wheelset, time and low rail are drawn at random, with errors of the teeth; measured at most 0.80."""
    draw, runs, whole = np.random.default_rng(2026), [], []
    for _ in range(4):
        friction = draw.uniform(0.05, 0.1)
        rail = LOW.values(len(machine.numbers)) | {f"friction_{number}": friction for number in machine.numbers}
        kind, wheelset = str(draw.choice(["stuck", "zero", "doubled"])), int(draw.choice(machine.numbers))
        runs.append(Run(rail, faults=(Fault(wheelset, sensor=kind, sensor_from=draw.uniform(2.0, 30.0)),)))
        whole.append(Run(rail))
    stops = Rig(machine, slide_protection(), Settings(jitter=0.1), by_flow=by_flow).runs(runs)
    locked = Rig(machine, None, Settings(), by_flow=by_flow).runs(whole)
    for stop, other in zip(stops, locked, strict=True):
        assert (stop.distance or math.inf) < (other.distance or 0.0)


@pytest.mark.study
@pytest.mark.parametrize(("pulses", "jitter"), [(60, 0.0), (80, 0.1), (100, 0.1), (300, 0.1), (2000, 0.3)])
def test_the_protection_believes_teeth_that_err(pulses: int, jitter: float) -> None:
    """No reading is rejected."""
    doubted: list[list[bool]] = []

    class Watched(SlideProtection):
        def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
            found = super().step(time, wheel_speeds)
            doubted.extend([self.believed] * (not all(self.believed)))
            return found

    settings = Settings(pulses=pulses, jitter=jitter)
    for machine in (bogie(), coach()):
        Rig(machine, Watched, settings, by_flow=True).stops([LOW.values(len(machine.numbers))])
    assert doubted == []


@pytest.mark.study
def test_a_machine_that_does_not_stop_says_so() -> None:
    [stop] = Rig(bogie(), None, Settings(brake_ratio=1e-3)).stops([RAILS[0].values()])
    assert stop.distance is None
    ramp = Settings().application_time / math.log(20.0)
    slowing = bogie().deceleration(1e-3 * bogie().full_torque)
    assert stop.end_speed == pytest.approx(25.0 - slowing * (300.0 - BRAKE_START - ramp), rel=1e-5)
    assert stop.message == f"It did not stop: {stop.end_speed:.1f} m/s after 300 s."
    assert (stop.words, stop.note("a source")) == (stop.message[:-1], f"{stop.message[:-1]}; a source")
    assert stop.over(100.0) is None


@pytest.mark.study
def test_a_run_that_never_stops_keeps_its_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("products.protection.rig.LONGEST", 20.0)
    for by_flow in (False, True):
        [stop] = Rig(bogie(), gives([2, 2]), Settings(), by_flow=by_flow).stops([LOW.values()])
        assert stop.distance is None
        assert stop.end_speed == pytest.approx(25.0, abs=1e-9)
        assert stop.words == f"It did not stop: {stop.end_speed:.1f} m/s after 20 s"


# ---- the rig in C ----------------------------------------------------------------------------------------------------


def test_the_most_wheelsets_are_told_once_in_c_and_once_in_python() -> None:
    [most] = re.findall(r"#define RIG_MOST (\d+)", (RIG / "guarded.h").read_text())
    assert int(most) == MOST_WHEELSETS


@pytest.mark.study
def test_the_rig_in_c_reads_and_writes_nothing_but_its_own(tmp_path: Path) -> None:
    """Under sanitizers: 16 wheelsets with failing sensors and valves, lost runs, failing controllers, and our own."""
    files = [RIG / name for name in ("rig.c", "encoder.c", "guarded.c", "slide_protection.c")]
    flags = [flag for flag in FLAGS if flag != "-fvisibility=hidden"]
    (tmp_path / "slide_thresholds.h").write_text(slide_sources()["slide_thresholds.h"])
    own = [
        f"-I{RIG}",
        f"-I{tmp_path}",
        *files,
        Path(__file__).with_name("rig_host.c"),
        "-o",
        tmp_path / "host",
        "-lm",
    ]
    assert run([*compiler(), *flags, *SANITIZERS, *own], tmp_path).returncode == 0
    done = run([tmp_path / "host"], tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
