"""Vehicles from data sheets: units, assumed values, brakes against closed forms, refusals, FMUs."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import bogie_braking as bb
from bogie_braking.__main__ import main
from bogie_braking.machines import unfolded
from bogie_braking.vehicle_files.check import RAILS, SPEEDS, VehicleCheck, axle_loads
from bogie_braking.vehicle_files.page import write_page
from fmu_src.archive import contents_of
from fmu_src.idle_parameters import without_effect
from products.registry import FMUS
from products.vehicle_entries import LIKE
from products.vehicle_file import sheet_of
from products.vehicle_sheet import WITH_EFFECT
from products.vehicle_toml import EXAMPLES, built_in_sheet, names_of_examples, write_vehicle
from rbd_model.contact.geometry import thesis_pair
from rbd_model.contact.pair_file import read_pairs, write_pair
from readers.text import FileError

SHEET = {"name": "Own", "tare": "38 t", "load": "6 t", "wheel_diameter": "900 mm", "length": "24.5 m"}
#: Entries of a brake on treads.
BRAKE = {"deceleration": "1.1 m/s2", "application_time": "1.5 s"}
#: Tables of forces: a bump stop, and a yaw damper that saturates.
TABLES = {
    "bump_stop": {"travel": ["25 mm", "35 mm"], "force": [0, "5 kN"], "height": "0.65 m"},
    "yaw_damper": {"rate": [0, 0.02, "40 mm/s"], "force": ["0 kN", "12 kN", 12000.0], "half_spacing": "1.2 m"},
}
#: Relative error of a stopping distance: creep of braked wheels on dry rails shortens nothing and lengthens by less.
CREEP = 3e-4


@pytest.mark.parametrize(("older", "name", "law"), [("cast-iron", "cast-iron-p6", 2)])
def test_older_names_of_friction_laws_are_read(older: str, name: str, law: int) -> None:
    own = [sheet_of(SHEET | {"brake": BRAKE | {"friction_law": one}}).brake for one in (older, name)]
    assert [one.values["friction_law"] for one in own if one] == [law, law]


@pytest.mark.parametrize("name", LIKE)
def test_a_built_in_vehicle_survives_the_way_through_a_file(name: str, tmp_path: Path) -> None:
    sheet = built_in_sheet(name)
    again = bb.read_vehicle(write_vehicle(sheet, tmp_path / "vehicle.toml"))
    assert again.parameters == sheet.parameters
    assert not again.assumed


def test_tables_of_forces_survive_the_way_through_a_file(tmp_path: Path) -> None:
    sheet = sheet_of(SHEET | TABLES)
    again = bb.read_vehicle(write_vehicle(sheet, tmp_path / "vehicle.toml"))
    assert again.parts.connections == sheet.parts.connections
    assert again.vehicle == sheet.vehicle
    assert again.parts.connections[1].law["rate"] == (0.0, 0.02, 0.04)
    assert bb.read_vehicle(write_vehicle(again, tmp_path / "again.toml")).vehicle == sheet.vehicle


def test_tables_of_forces_are_connections_of_body_and_frames() -> None:
    """They replace the bump stops of the coach, and are compiled."""
    sheet = sheet_of(SHEET | TABLES)
    assert sheet.fmu is None
    parts = {one.name: one for one in sheet.vehicle.connections}
    stops = [one for one in parts.values() if isinstance(one, bb.parts.BumpStop)]
    assert [one.name for one in stops] == ["front_bump_stop", "rear_bump_stop"]
    assert {one.force for one in stops} == {(0.0, 5e3)}
    heights = [sheet.vehicle.number(parts[one].place[2]) for one in ("rear_bump_stop", "rear_yaw_damper")]
    assert heights == pytest.approx([0.65 - 0.45, sheet.parameters.values()["secondary_height"]])
    damper = parts["front_yaw_damper"]
    assert isinstance(damper, bb.parts.TableDamper)
    assert [sheet.vehicle.number(size) for size in damper.place[:2]] == [
        sheet.vehicle.number("pivot_distance") / 2,
        1.2,
    ]
    assert (damper.both_sides, damper.direction) == (True, "longitudinal")


@pytest.mark.study
def test_a_yaw_damper_of_a_file_acts_in_a_run_and_in_its_fmu(tmp_path: Path) -> None:
    """It joins body and frames along the track too, so that a braked body moves less over its bogies."""
    soft = SHEET | {"parameters": {"traction_rod_stiffness": 0.0, "traction_rod_damping": 0.0}}
    resistance = {"resistance": {"constant": "20 kN"}}
    names = ["body_pitch", "speed"]
    runs = []
    for more in ({}, {"yaw_damper": TABLES["yaw_damper"]}):
        sheet = sheet_of(soft | more | resistance)
        runs.append(
            bb.run(sheet, 3.0, None, names, 0.01, level=2, initial_speed=20.0, brake_torque_1=9e3)
            if more
            else bb.run(
                sheet.vehicle,
                3.0,
                None,
                names,
                0.01,
                level=2,
                initial_speed=20.0,
                brake_torque_1=9e3,
                **sheet.resistance,
            )
        )
    swing = [np.ptp(one["body_pitch"][-100:]) for one in runs]
    assert swing[1] < 0.5 * swing[0]
    with bb.FmuInstance(
        bb.write_fmu(sheet, tmp_path / "own.fmu", level=2), initial_speed=20.0, brake_torque_1=9e3
    ) as fmu:
        fmu.start()
        fmu.step(0.0, 3.0)
        assert fmu["speed"] == pytest.approx(runs[1]["speed"][-1], rel=1e-6)


@pytest.mark.study
@pytest.mark.parametrize("name", names_of_examples())
def test_a_written_vehicle_keeps_brake_profiles_and_resistance(name: str, tmp_path: Path) -> None:
    write_pair(thesis_pair(), tmp_path / "pair.csv")
    sheet = replace(bb.read_vehicle(EXAMPLES / f"{name}.toml"), name='Bär "1"', profile_files=(tmp_path / "pair.csv",))
    again = bb.read_vehicle(write_vehicle(sheet, tmp_path / "vehicle.toml"))
    assert replace(again, assumed={}) == replace(sheet, assumed={})


@pytest.mark.parametrize("tare", ["38 t", "38000 kg", 38000, "38000", "38e3kg"])
def test_a_number_has_one_meaning_in_all_spellings(tare: object) -> None:
    assert sheet_of(SHEET | {"tare": tare}).parameters == sheet_of(SHEET).parameters


def test_the_mass_on_the_rails_is_tare_and_load_and_inertias_follow() -> None:
    sheet, coach = sheet_of(SHEET), built_in_sheet("coach").parameters.values()
    own = sheet.parameters.values()
    assert sheet.mass == pytest.approx(44e3, rel=1e-15)
    assert own["body_mass"] == 44e3 - 2 * coach["frame_mass"] - 4 * coach["wheelset_mass"]
    heavier = own["body_mass"] / coach["body_mass"]
    assert own["body_roll_inertia"] == pytest.approx(coach["body_roll_inertia"] * heavier, rel=1e-14)
    assert own["body_yaw_inertia"] == pytest.approx(coach["body_yaw_inertia"] * heavier * (24.5 / 20) ** 2, rel=1e-14)
    assert "length" not in sheet.assumed
    assert sheet.assumed["frame_mass"] == "as the coach"


def test_rotating_mass_and_heights_are_those_of_the_file() -> None:
    sheet = sheet_of(SHEET | {"rotating_mass": "2.2 t", "body_height": "1.7 m"})
    own = sheet.parameters.values()
    assert 4 * own["wheelset_pitch_inertia"] / own["wheel_radius"] ** 2 == pytest.approx(2200.0, rel=1e-14)
    assert own["body_height"] + own["wheel_radius"] == pytest.approx(1.7, rel=1e-14)


@pytest.mark.parametrize("name", names_of_examples())
def test_each_number_of_a_public_vehicle_has_its_source(name: str) -> None:
    path = EXAMPLES / f"{name}.toml"
    sheet = bb.read_vehicle(path)
    assert sheet.brake is not None
    for line in path.read_text(encoding="utf-8").splitlines():
        if "=" in line and not line.startswith(("name", "like")):
            assert re.search(r"# (assumed|Wikipedia|startbilder)", line), line


def stopping_distance(speed: float, deceleration: float, lasts: float) -> float:
    """Return the closed form for a deceleration that builds up by 1 - 20^(-t / lasts) [m]."""
    rate = math.log(20.0) / lasts

    def left(t: float) -> float:
        return speed - deceleration * (t - (1 - math.exp(-rate * t)) / rate)

    end = float(brentq(left, 0.0, 10 * speed / deceleration))
    built = (end - (1 - math.exp(-rate * end)) / rate) / rate
    return speed * end - deceleration * (end**2 / 2 - built)


def stop_of(brake: dict[str, object], speed: float = 30.0, **values: float) -> float:
    sheet = sheet_of(SHEET | {"brake": brake})
    assert sheet.brake is not None
    demands = {f"pressure_demand_{number}": sheet.brake.full_pressure for number in range(1, 5)}
    dry = {f"friction_{number}": 0.5 for number in range(1, 5)}
    stop = bb.run(sheet, 120.0, None, ["distance"], 1.0, level=1, initial_speed=speed, **demands, **dry, **values)
    return float(stop["distance"][-1])


def test_a_vehicle_stops_with_the_deceleration_of_its_file() -> None:
    assert stop_of(BRAKE) == pytest.approx(stopping_distance(30.0, 1.1, 1.5), rel=CREEP)


def test_a_force_and_its_deceleration_are_the_same_brake() -> None:
    turning = 44e3 + 4 * built_in_sheet("coach").parameters.wheelset_pitch_inertia / 0.45**2
    assert stop_of({"force": f"{1.1 * turning!r} N", "application_time": 1.5}) == pytest.approx(
        stop_of(BRAKE), rel=1e-9
    )


def test_lambda_is_the_percentage_and_is_given_once() -> None:
    same = [sheet_of(SHEET | {"brake": {name: 105.0}}).brake for name in ("lambda", "percentage")]
    assert same[0] == same[1]
    with pytest.raises(ValueError, match="percentage must be given once; got percentage beside it"):
        sheet_of(SHEET | {"brake": {"lambda": 105.0, "percentage": 105.0}})


def test_a_percentage_is_that_of_the_assessment() -> None:
    """lambda = C / S - D from 100 km/h with a build-up of 2 s (UIC 544-1, EN 14531-1)."""
    speed = 100 / 3.6
    distance = 52840.0 / (105.0 + 10.0)
    mean = speed**2 / (2 * (distance - 2.0 * speed))
    assert stop_of({"percentage": "105 %", "application_time": 1.5}) == pytest.approx(
        stopping_distance(30.0, mean, 1.5), rel=CREEP
    )


def test_cylinders_and_rigging_give_the_force_of_the_shoes() -> None:
    """F = n (p A - F_spring) i eta, eqs (2.4) to (2.6); T = mu F r, eq. (2.7)."""
    brake = {
        **{"cylinder_diameter": "305 mm", "cylinders": 2, "rigging_ratio": 8.0, "rigging_efficiency": 0.9},
        **{"return_force": "1.5 kN", "friction": 0.2, "full_pressure": "3.6 bar"},
    }
    sheet = sheet_of(SHEET | {"brake": brake})
    force = 2 * (3.6e5 * math.pi / 4 * 0.305**2 - 1500.0) * 8.0 * 0.9
    assert sheet.brake is not None
    assert sheet.brake.full_torque == pytest.approx(force / 4 * 0.2 * 0.45, rel=1e-12)
    filled = bb.run(sheet, 20.0, None, ["brake_torque_1"], 20.0, level=1, initial_speed=60.0, pressure_demand_1=3.6e5)
    assert filled["brake_torque_1"][-1] == pytest.approx(sheet.brake.full_torque, rel=1e-9)


def test_pads_have_the_torque_of_the_file_at_its_mean_friction() -> None:
    """T = mu F r: the torque over that of the file is the pads' friction over the stated mean."""
    sheet = sheet_of(SHEET | {"brake": BRAKE | {"acts_on": "discs", "friction": 0.4, "friction_radius": "0.3 m"}})
    assert sheet.brake is not None
    begin = bb.run(
        sheet, 8.0, None, ["brake_torque_1", "pad_friction_1"], 8.0, initial_speed=60.0, pressure_demand_1=3.8e5
    )
    share = begin["pad_friction_1"][-1] / 0.4
    assert begin["brake_torque_1"][-1] == pytest.approx(share * sheet.brake.full_torque, rel=2e-3)


def test_a_stop_with_discs_has_the_distance_of_the_stated_deceleration() -> None:
    """The stop is from 120 km/h. Cylinders that fill in 0.5 s add v t_95 / ln 20 before the brake is on, to a tenth."""
    brake = {"acts_on": "discs", "deceleration": "1.1 m/s2", "application_time": "0.5 s"}
    sheet, speed = sheet_of(SHEET | {"brake": brake}), 120 / 3.6
    assert sheet.brake is not None
    demands = {f"pressure_demand_{number}": sheet.brake.full_pressure for number in range(1, 5)}
    stop = bb.run(sheet, 60.0, None, ["distance"], 60.0, initial_speed=speed, **demands)
    assert stop["distance"][-1] == pytest.approx(speed**2 / 2.2 + speed * 0.5 / math.log(20.0), rel=2e-3)


@pytest.mark.study
def test_values_without_effect_at_a_level_are_those_of_its_equations() -> None:
    for name in ("bogie", "vehicle"):
        model = FMUS[name].model(places=(0, 1))
        for level, system in enumerate(model.systems, 1):
            used = set(system.parameter_symbols) - set(without_effect(model, system))
            own = LIKE["coach" if name == "vehicle" else name][1]().values()
            assert used & own.keys() == WITH_EFFECT[level] & own.keys()


@pytest.mark.study
@pytest.mark.parametrize("level", [1, 3])
def test_discs_brake_alike_at_every_level(level: int) -> None:
    """On a dry rail the distance depends on the torque alone; no value of the file is without effect."""
    sheet = sheet_of(SHEET | {"brake": BRAKE | {"acts_on": "discs"}})
    assert sheet.brake is not None
    demands = {f"pressure_demand_{number}": sheet.brake.full_pressure for number in range(1, 5)}
    names = ["distance", "disc_temperature_1"]
    stops = [
        bb.run(sheet, 60.0, None, names, 60.0, level=one, initial_speed=120 / 3.6, **demands) for one in (level, 2)
    ]
    assert stops[0]["distance"][-1] == pytest.approx(stops[1]["distance"][-1], rel=1e-5)
    assert stops[0]["disc_temperature_1"][-1] == pytest.approx(stops[1]["disc_temperature_1"][-1], abs=0.01)
    assert not any("has no effect" in one for one in stops[0].messages)


@pytest.mark.study
def test_six_axles_lie_in_threes_and_carry_the_weight() -> None:
    sheet = sheet_of({"tare": "120 t", "axles": 6, "wheel_base": "1.8 m", "pivot_distance": "11 m", "length": "20 m"})
    assert sheet.fmu is None
    places = [sheet.vehicle.number(one.along) for one in sheet.vehicle.wheelsets]
    assert places == pytest.approx([7.3, 5.5, 3.7, -3.7, -5.5, -7.3])
    loads = axle_loads(sheet)
    assert sum(loads) == pytest.approx(120e3 * 9.80665, rel=1e-9)
    assert loads[1] == pytest.approx(120e3 * 9.80665 / 6, rel=1e-3)


@pytest.mark.study
def test_two_axles_are_an_fmu_with_own_start_values(tmp_path: Path) -> None:
    sheet = sheet_of({"tare": "12 t", "axles": 2, "wheel_base": "9 m", "wheel_diameter": "840 mm"})
    assert sheet.fmu == "bogie"
    with bb.FmuInstance(bb.write_fmu(sheet, tmp_path / "wagon.fmu")) as fmu:
        fmu.start()
        weights = [fmu[f"axle_load_{number}"] for number in (1, 2)]
    assert sum(weights) == pytest.approx(12e3 * 9.80665, rel=1e-9)


@pytest.mark.study
def test_profiles_of_a_file_reach_runs_at_level_3_and_the_fmu(tmp_path: Path) -> None:
    write_pair(thesis_pair(), tmp_path / "pair.csv")
    (tmp_path / "wagon.toml").write_text('tare = "30 t"\naxles = 2\nprofile_file = "pair.csv"\n')
    sheet = bb.read_vehicle(tmp_path / "wagon.toml")
    assert unfolded(sheet, {"level": 3})[1]["profile_file"] == str(tmp_path / "pair.csv")
    assert unfolded(sheet, {"level": 3, "profile_file": ""})[1]["profile_file"] == str(tmp_path / "pair.csv")
    assert "profile_file" not in unfolded(sheet, {})[1]
    assert main(["vehicle", "parameters", str(tmp_path / "wagon.toml")]) == 0
    assert f'<ssv:String value="{tmp_path / "pair.csv"}"' in (tmp_path / "wagon.ssv").read_text(encoding="utf-8")
    contents = contents_of(bb.write_fmu(sheet, tmp_path / "wagon.fmu"))
    assert contents["resources/pair.csv"] == (tmp_path / "pair.csv").read_bytes()
    messages = []
    for more in ({}, {"frame_roll_inertia": sheet.values["frame_roll_inertia"]}, {"frame_roll_inertia": 5e4}):
        with bb.FmuInstance(tmp_path / "wagon.fmu", **more) as fmu:
            fmu.start()
            messages.append(fmu.messages)
    assert messages[:2] == [[], []]
    assert messages[2][0].startswith('Nothing in the system "planar" depends on frame_roll_inertia, so that setting')
    (tmp_path / "other.csv").write_bytes((tmp_path / "pair.csv").read_bytes())
    for files in ('["pair.csv", "other.csv"]', '"pair.csv;other.csv"'):
        (tmp_path / "wagon.toml").write_text(f'tare = "30 t"\naxles = 2\nprofile_file = {files}\n')
        sheet = bb.read_vehicle(tmp_path / "wagon.toml")
        both = unfolded(sheet, {"level": 3})[1]["profile_file"]
        assert both == f"{tmp_path / 'pair.csv'};{tmp_path / 'other.csv'}"
    contents = contents_of(bb.write_fmu(sheet, tmp_path / "wagon.fmu"))
    (tmp_path / "both.csv").write_bytes(contents["resources/pair.csv"])
    assert len(read_pairs(tmp_path / "both.csv")) == 2
    (tmp_path / "wagon.toml").write_text('tare = "30 t"\naxles = 4\nprofile_file = "both.csv"\n')
    with pytest.raises(FileError, match="one contact table for all wheelsets or one for each, 4; got 2"):
        bb.read_vehicle(tmp_path / "wagon.toml")
    (tmp_path / "wagon.toml").write_text('tare = "30 t"\naxles = 2\nprofile_file = "pair.csv"\n')
    (tmp_path / "pair.csv").write_text("y,z\n0,0\n")
    with pytest.raises(FileError, match="profile_file must be a contact table"):
        bb.read_vehicle(tmp_path / "wagon.toml")


REFUSED = [
    ({"tare": "44"}, "tare must be from 100 to 1e+06 kg; got 44. Did you mean 44 t"),
    ({"tare": "3 t"}, "tare and load must be above"),
    ({"tare": "44 m"}, "tare must be from 100 to 1e+06 kg; got 44 m"),
    ({"tare": 5e3}, "Give wheelset_mass and bogie_frame_mass too"),
    ({"tarre": "44 t"}, "'tarre' is not a known entry. Did you mean tare?"),
    ({"like": "tram"}, "like must be one of coach, coal-wagon, bogie; got tram"),
    ({"axles": 5}, "axles must be 2, 4 or 6; got 5"),
    ({"axles": 2, "like": "coach"}, "like must be bogie for 2 axles"),
    ({"wheel_diameter": 920}, "wheel_diameter must be from 0.02 to 3 m; got 920. Did you mean 920 mm = 0.92 m?"),
    ({"brake": {}, "resistance": {"constant": -1}}, "[resistance] constant must be from 0"),
    ({"brake": {"acts_on": "discs"}}, "[brake] must be stated once"),
    ({"brake": BRAKE | {"force": "50 kN"}}, "got deceleration and force"),
    ({"brake": BRAKE | {"rigging_efficiency": 0.9}}, "[brake] rigging_efficiency has no effect here"),
    ({"brake": BRAKE | {"friction_radius": 0.3}}, "[brake] friction_radius has no effect here"),
    ({"brake": {"cylinder_diameter": "305 mm", "cylinders": 2}}, "[brake] rigging_ratio must be given"),
    (
        {"brake": BRAKE | {"friction_law": "iron"}},
        "[brake] friction_law must be one of constant, cast-iron-p6, cast-iron-p10, composite, composite-k",
    ),
    ({"brake": BRAKE | {"friction_law": "composite", "friction": 0.2}}, "[brake] friction must be left out"),
    ({"brake": 7}, "brake must be a table; got 7"),
    ({"parameters": {"body_mass": "30 t"}}, "[parameters] body_mass must be left out beside tare"),
    ({"parameters": {"wheel_base": "3 m"}, "wheel_base": "2 m"}, "[parameters] wheel_base must be stated once"),
    ({"parameters": {"body_mas": 1}}, "[parameters] 'body_mas' is not a known entry. Did you mean body_mass?"),
    ({"tare": 38, "load": 6}, "got 38. Did you mean 38 t"),
    ({"wheel_diameter": "0,92 m"}, "Write a decimal point instead of the comma"),
    ({"length": "18 m", "pivot_distance": "19 m"}, "length must be at least the pivot_distance of 19 m; got 18 m"),
    ({"profile_file": 7}, "profile_file must be the path of a contact table, or a list of paths; got 7"),
    ({"name": 7}, "name must be a printable text of at most 60 characters; got 7"),
    ({"name": "a\nb"}, "name must be a printable text"),
    ({"like": ["coach"]}, "like must be one of coach, coal-wagon, bogie; got"),
    ({"tare": True}, "tare must be from 100 to 1e+06 kg; got true"),
    ({"brake": BRAKE | {"friction_law": {}}}, "[brake] friction_law must be one of"),
    ({"brake": BRAKE | {"shoes": 2.5}}, "[brake] shoes must be an integer from 1 to 16; got 2.5. Round it."),
    ({"yaw_damper": {"rate": [0, 0.02]}}, "[yaw_damper] force must be given; got none. Add it."),
    ({"yaw_damper": {"rate": [0, 1], "force": [0, 1]}}, "[yaw_damper] half_spacing must be given; got none. Add it."),
    ({"yaw_damper": TABLES["yaw_damper"] | {"rate": 0.02}}, "[yaw_damper] rate must be a list of numbers; got 0.02."),
    (
        {"yaw_damper": TABLES["yaw_damper"] | {"rate": [0, 20, 40]}},
        "[yaw_damper] rate must be from 0 to 10 m/s; got 20.",
    ),
    (
        {"yaw_damper": TABLES["yaw_damper"] | {"force": [0, "12 kN", "6 kN"]}},
        "[yaw_damper] force must not fall at the ends, whose slopes continue; got",
    ),
    ({"yaw_damper": TABLES["yaw_damper"] | {"forces": []}}, "[yaw_damper] 'forces' is not a known entry. Did you mean"),
    (
        {"bump_stop": {"travel": [0.0, 0.01], "force": [0, 1e4]}},
        "[bump_stop] travel must begin with the clearance, above 0; got 0 m.",
    ),
    (
        {"bump_stop": {"travel": ["20 mm", "10 mm"], "force": [0, 1e4]}},
        "[bump_stop] travel must rise from point to point; got 0.01 after 0.02.",
    ),
    (
        {"bump_stop": {"travel": ["20 m", "30 m"], "force": [0, 1]}},
        "[bump_stop] travel must be from 0 to 1 m; got 20 m",
    ),
    (
        {"axles": 2, "length": "9 m"} | TABLES,
        "[bump_stop] must be left out with 2 axles, which have no bogies; got one. Remove it.",
    ),
    ({"parameters": {"flange_at_rail": 0.5}}, "[parameters] flange_at_rail must be an integer from 0 to 1; got 0.5"),
]


@pytest.mark.parametrize(("more", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_is_not_clear_is_refused_in_one_message(more: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)) as refused:
        sheet_of(SHEET | more)
    assert "\n" not in str(refused.value)


def test_a_message_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("tare = 44 t\n")
    with pytest.raises(FileError, match=r"mine\.toml must be TOML"):
        bb.read_vehicle(path)
    path.write_text("tarre = '44 t'\n")
    with pytest.raises(FileError, match=r"mine\.toml: 'tarre' is not a known entry"):
        bb.read_vehicle(path)


def test_a_file_that_is_not_toml_ends_the_command_with_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("bogie coach\n", encoding="utf-8")
    assert main(["vehicle", "check", str(path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"{path} must be TOML; got")
    assert "Traceback" not in error


def test_parameters_are_not_written_over_the_vehicle(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a missing folder" / "mine.toml"
    assert main(["vehicle", "export", "coach", "--out", str(path)]) == 0
    before = path.read_bytes()
    assert main(["vehicle", "parameters", str(path), "--out", str(path)]) == 2
    assert f"--out must be another file than FILE; got {path} twice" in capsys.readouterr().err
    assert path.read_bytes() == before


def test_a_vehicle_with_tables_of_forces_has_no_parameter_set(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_vehicle(sheet_of(SHEET | TABLES), tmp_path / "mine.toml")
    assert main(["vehicle", "parameters", str(path)]) == 2
    assert "[bump_stop] must be left out for a parameter set; got one." in capsys.readouterr().err


def test_the_page_opens_with_a_distance_and_the_number_of_assumed_values(tmp_path: Path) -> None:
    sheet, path = sheet_of(SHEET), tmp_path / "vehicle.html"
    distances = 100.0 + np.arange(16.0).reshape(len(SPEEDS), len(RAILS))
    write_page(VehicleCheck(sheet, axle_loads(sheet), None, None, distances), path, [b""])
    shown = path.read_text(encoding="utf-8")
    lead = shown[: shown.index("<img")]
    assert "<p>For the author of the vehicle file, before its FMU is used or handed on. Simulated" in lead
    assert "44.0 t on 4 axles" in lead
    assert "it stops in 108 m from 120 km/h on dry rails" in lead
    assert f"{len(sheet.assumed)} values are assumed" in lead


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"load": 30.0}, r"load must be 0 or from 50 to 1e\+06 kg; got 30\.0\. Did you mean 30 t = 3e\+04 kg\?"),
        ({"parameters": {"lateral_stiffness": 3.9}}, r"must be from 100 .*Did you mean 3\.9 kN/mm = 3\.9e\+06 N/m\?"),
    ],
)
def test_a_number_in_another_unit_is_refused_with_that_unit(more: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        sheet_of(SHEET | more)
