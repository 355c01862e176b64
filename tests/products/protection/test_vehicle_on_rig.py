"""Vehicles from data sheets on the test rig: what a file states is what the rig measures."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import bogie_braking as bb
from products.machine import bogie, coach
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.programme import Case
from products.protection.rig import Rig
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from products.protection.vehicle_of_file import vehicle_of_file, with_own_brake

#: Tolerance of a deceleration: creep adds to the rotation of the wheels, and the axle boxes' friction of the coach.
STATED = 0.005
#: Tolerance of the ideal where the brake limits it, which does not model creep.
IDEAL = 0.003
FILE = """
name = "Regio"
tare = "38 t"
load = "6 t"
wheel_diameter = "800 mm"

[resistance]
constant = "4.4 kN"
quadratic = "22 N/(m/s)^2"

[brake]
deceleration = "0.9 m/s2"
full_pressure = "300 kPa"
application_time = "1.0 s"
"""


def file(folder: Path, text: str = FILE) -> Path:
    path = folder / "regio.toml"
    path.write_text(text)
    return path


@pytest.mark.study
def test_a_dry_stop_has_the_stated_deceleration_and_resistance(tmp_path: Path) -> None:
    """Between 15 and 5 m/s: 0.9 m/s2 and (4400 N + 22 N s2/m2 v^2) over 44 t with rotating wheelsets."""
    machine, brake = vehicle_of_file(file(tmp_path))
    settings = Settings(application_time=brake.application_time)
    run = Case("dry", "dry").run(machine)
    [stop] = Rig(machine, None, settings, by_flow=True).runs([run], every=0.02)
    course = stop.course
    part = (course.speed < 15.0) & (course.speed > 5.0)
    found = -np.polyfit(course.time[part], course.speed[part], 2)
    slopes = 2 * found[0] * course.time[part] + found[1]
    rotating = 4 * machine.parameters.wheelset_pitch_inertia / 0.4**2
    wanted = 0.9 + (4400.0 + 22.0 * course.speed[part] ** 2) / (44e3 + rotating)
    assert machine.mass == pytest.approx(44e3)
    assert slopes.mean() == pytest.approx(wanted.mean(), rel=STATED)
    assert course.effort.max() == pytest.approx(300e3, rel=0.01)
    rolling = course.speed[part] / course.angular_velocity[part, 0]
    assert rolling.mean() == pytest.approx(0.4, rel=0.002)
    assert stop.distance is not None
    ideal = PeakAdhesion(machine, run.values).stopping_distance(25.0)
    other = Settings()
    [slower] = Rig(machine, None, other, by_flow=True).runs([run])
    assert slower.distance == pytest.approx(ideal, rel=IDEAL)  # both with the application time of the rig
    assert stop.distance < slower.distance - 5.0


def test_the_numbers_of_the_coach_in_a_file_are_the_coach(tmp_path: Path) -> None:
    machine, _ = vehicle_of_file(file(tmp_path, "[brake]\ndeceleration = 1.0\n"))
    assert machine.parameters.values() == coach().parameters.values() | {"gravity": 9.80665}
    assert machine.built_in == coach()
    small, _ = vehicle_of_file(file(tmp_path, "like = 'bogie'\n[brake]\nforce = 20e3\n"))
    assert (len(small.numbers), small.built_in) == (2, bogie())
    assert small.full_torque * 2 / small.parameters.wheel_radius == pytest.approx(20e3)


def test_a_vehicle_with_discs_has_them_in_every_stop(tmp_path: Path) -> None:
    _, brake = vehicle_of_file(file(tmp_path, FILE.replace("[brake]", "[brake]\nacts_on = 'discs'")))
    cases = [Case("a", "dry"), Case("b", "dry", equipment=("discs",)), Case("c", "dry", equipment=("traction",))]
    assert [case.equipment for case in with_own_brake(cases, brake)] == [("discs",), ("discs",), ("traction",)]


@pytest.mark.study
@pytest.mark.parametrize("acts_on", ["treads", "discs"])
def test_python_and_command_brake_a_vehicle_alike(tmp_path: Path, acts_on: str) -> None:
    path = file(tmp_path, FILE.replace("[brake]", f"[brake]\nacts_on = '{acts_on}'"))
    machine, brake = vehicle_of_file(path)
    [case] = with_own_brake([Case("low", "low")], brake)
    settings = Settings(application_time=brake.application_time)
    rig = Rig(machine, SlideProtection, settings, by_flow=True)
    stop, on_treads = rig.runs([case.run(machine), Case("low", "low").run(machine)])
    assert (stop.distance == on_treads.distance) == (acts_on == "treads")
    assert bb.protected_stops("protection", bb.read_vehicle(path), ["low"])["distance"] == [stop.distance]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (('name = "Regio"', "axles = 6"), "axles must be 2 or 4 on the test rig; got 6."),
        ((FILE[FILE.index("[brake]") :], ""), "must have a [brake] on the test rig; got none."),
        (
            ("[brake]", "[brake]\nfriction_law = 'cast-iron'"),
            "friction_law must be constant on the test rig; got",
        ),
        (
            ("300 kPa", "510 kPa"),
            "full_pressure must be at most 500 kPa, the pressure of the rig's reservoir; got 510",
        ),
        (("1.0 s", "61 s"), "application_time must be at most 60 s on the test rig; got 61 s."),
        (
            ("[brake]", "[bump_stop]\ntravel = [0.02, 0.04]\nforce = [0, 1e4]\n[brake]"),
            "[bump_stop] must be left out on the test rig, whose connections are built in; got one.",
        ),
        (("38 t", "38"), "tare must be"),
    ],
)
def test_what_the_rig_does_not_model_is_refused(change: tuple[str, str], sentence: str, tmp_path: Path) -> None:
    path = file(tmp_path, FILE.replace(*change))
    with pytest.raises(ValueError, match=re.escape(sentence)) as refused:
        vehicle_of_file(path)
    assert str(path) in str(refused.value)
