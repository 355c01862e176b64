"""Train data from runs, against closed forms, and the command that supervises a consist."""

from __future__ import annotations

import argparse
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomllib
from plotly.offline import get_plotlyjs

from bogie_braking.__main__ import main
from bogie_braking.braking_curves.compute import CurveResults, compute
from bogie_braking.braking_curves.options import add_all
from bogie_braking.braking_curves.words import document, text
from bogie_braking.supervised import OwnStop, own_stops, supervised_train
from products.braking_curves.gradients_of_line import gradients_of
from products.etcs_files.train_file import write_train
from products.supervision import (
    FixedValues,
    NationalValues,
    Steps,
    SupervisedTrain,
    release_speed,
    rounded_train,
    supervise,
)
from products.supervision.of_run import brake_of_run
from products.train.consist_file import consist_of
from products.train.driver_forces import moved_mass
from products.train.summary import brake_force
from rbd_model.track.line import Line
from rbd_model.track.line_files import line_from_file
from readers.command_line import CommandLine
from readers.text import BadInputError

#: Step of the rows of a run [s]. A row is a mean over it, so a deceleration lags by half of it.
STEP = 0.02
COACHES = '[[vehicle]]\nkind = "locomotive"\n[[vehicle]]\nkind = "coach"\ncount = 4\n'


def stop(begin: float, faster: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a run: 1 s of reaction, 2 s of linear rise; the deceleration is 0.8 m/s2 and 1.2 m/s2 below `faster`."""
    time = np.arange(0.0, 120.0, STEP)
    share = np.clip((time - 1.0) / 2.0, 0.0, 1.0)
    speed = np.empty(time.size)
    now = begin
    for n in range(time.size):
        speed[n] = now
        now = max(now - STEP * share[n] * (0.8 if now > faster else 1.2), 0.0)
    return time, speed, share


def test_deceleration_and_build_up_of_a_run_are_its_own() -> None:
    """The rise ends at 95 %, 1.9 s after its beginning: 1 s and half of 1.9 s."""
    found = brake_of_run(*stop(45.0, 20.0), largest=40.0)
    # The brake begins at 1 % of the share, 0.02 s after its first motion.
    assert found.build_up == pytest.approx(1.0 + 0.02 + (1.9 - 0.02) / 2.0, abs=1e-6)
    assert found.deceleration.at([5.0, 19.0, 21.0, 39.0]) == pytest.approx([1.2, 1.2, 0.8, 0.8])
    assert found.loss == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("most", [1, 2, 4, 7])
def test_steps_are_nowhere_above_the_run_and_lose_less_the_more_there_are(most: int) -> None:
    time = np.arange(0.0, 60.0, STEP)
    speed = np.maximum(50.0 * np.exp(-0.02 * time) - 0.4 * time, 0.0)  # dv/dt rises with v
    share = np.ones(time.size)
    found = brake_of_run(time, speed, share, 45.0, most)
    assert found.deceleration.values.size <= most
    rates = -np.diff(speed) / STEP
    moves = (speed[1:] > 0.0) & (speed[:-1] <= 45.0)
    assert np.all(found.deceleration.at(speed[:-1][moves]) <= rates[moves] + 1e-9)
    fewer = brake_of_run(time, speed, share, 45.0, most - 1) if most > 1 else None
    assert fewer is None or found.loss < fewer.loss
    assert found.loss > 0.0


@pytest.mark.parametrize(
    ("run", "largest", "says"),
    [
        (stop(40.5, 20.0), 40.0, "must be developed to 95 % before the train is slower than 40.00 m/s"),
        ((np.arange(3.0), np.full(3, 50.0), np.array([0.0, 0.5, 0.6])), 40.0, "must develop to 95 %; got 60 %"),
        ((np.arange(3.0), np.full(3, 50.0), np.array([0.0, 0.5, 1.0])), 40.0, "must end below 2.00 m/s"),
    ],
)
def test_a_run_that_is_no_stop_is_refused(run: tuple[np.ndarray, ...], largest: float, says: str) -> None:
    with pytest.raises(BadInputError, match=says):
        brake_of_run(*run, largest)


def test_gradients_between_rows_are_the_lower_ones() -> None:
    rows = {"distance": [0.0, 100.0, 200.0, 300.0], "curvature": [0.0] * 4, "cant": [0.0] * 4}
    found = gradients_of(
        Line({name: np.array(one) for name, one in rows.items()} | {"gradient": np.array([0.01, 0.01, -0.02, 0.005])})
    )
    assert found.starts.tolist() == [0.0, 100.0, 300.0]
    assert found.permille == pytest.approx([10.0, -20.0, 5.0])


def test_the_hill_of_the_page_falls_where_it_says(tmp_path: Path) -> None:
    """Limits and own stops have one hill: level up to 490 m and from 1510 m on, 10 permille down in between."""
    block = (Path(__file__).parents[3] / "docs" / "etcs.md").read_text("utf-8").split("```csv\n")[1].split("```")[0]
    (tmp_path / "hill.csv").write_text(block)
    line = line_from_file(tmp_path / "hill.csv")
    places, gradient = line.rows["distance"], line.rows["gradient"]
    assert np.interp([250.0, 500.0, 1000.0, 1600.0], places, gradient).tolist() == [0.0, -0.005, -0.01, 0.0]
    found = gradients_of(line)
    assert found.starts.tolist() == [0.0, 490.0, 1510.0]
    assert found.permille == pytest.approx([0.0, -10.0, 0.0])


def test_own_stops_from_the_limit_end_before_the_target(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    consist = tmp_path / "train.toml"
    consist.write_text(COACHES)
    brake = tmp_path / "brake.toml"
    brake.write_text('[tolerances]\nfriction_common = "4 %"\nlost = "0.1 %"\ndelay = "0.2 s"\nunits = 2\n')
    words = ["etcs", str(consist), "--target", "2km", "--speed", "140", "--out", str(tmp_path / "out")]
    assert main([*words, "--tolerances", str(brake), "--level", "5", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {one["name"] for one in found["safety"]["causes"]} == {"friction_common", "lost"}
    assert found["train"]["Kdry_rst"][5] <= found["safety"]["Kdry_rst"][5] < 1.0
    assert found["train"]["T_brake_emergency_s"] == found["safety"]["T_brake_emergency_s"][5]
    assert Path(found["causes"]).is_file()
    assert all(place < 2000.0 for place in found["own_stops_m"])
    assert Path(found["picture"]).is_file()
    assert Path(found["table"]).read_text().count("\n") == 161
    page = tmp_path / "new" / "page.html"
    read = ["etcs", found["train_data"], *words[2:]]
    assert main([*read, "--quiet"]) == 2
    assert "Kdry_rst of confidence level 5 alone; got M_NVEBCL 9" in capsys.readouterr().err
    assert main([*read, "--level", "5", "--json", "--page", str(page)]) == 0
    assert (tmp_path / "out" / "etcs-train-again.csv").is_file()
    again = json.loads(capsys.readouterr().out)
    assert again["limits_m"] == found["limits_m"]
    assert again["own_stops_m"] == []
    own = page.read_text(encoding="utf-8").replace(get_plotlyjs(), "")
    assert "src=" not in own
    assert "http" not in own.split("</head>")[1]
    for part in ("Distance before the target", "A_brake_emergency", "Kdry_rst in use", "M_NVEBCL", '"name":"EBD"'):
        assert part in own


def computed(*words: str) -> CurveResults:
    """Return what the command computes."""
    chosen = parsed(*words)
    return compute(chosen)


def parsed(*words: str) -> argparse.Namespace:
    parser = CommandLine()
    add_all(parser)
    return parser.parse_args(list(words))


def test_the_text_states_what_the_numbers_leave_out(tmp_path: Path) -> None:
    """Factors in use, values without effect, a line that begins too late, and own stops that fail or are left out."""
    path, country, line = tmp_path / "train.json", tmp_path / "country.toml", tmp_path / "line.csv"
    levels = [Steps.constant(1.0 - 0.05 * n) for n in range(10)]
    one = Steps.constant(1.0)
    write_train(path, SupervisedTrain(203.4, one, one, 2.4, 2.4, Kwet_rst=Steps.constant(0.9)), levels)
    country.write_text("M_NVEBCL = 6\nM_NVAVADH = 0.2\nM_NVKTINT = 1.2\nQ_NVGUIPERM = true\n")
    line.write_text("distance,curvature,cant,gradient\n1500,0,0,0\n8000,0,0,0\n")
    words = (str(path), "--target", "2000", "--national", str(country), "--line", str(line), "--target-speed", "40")
    chosen = parsed(*words)
    found = compute(chosen)
    lines = text(found)
    assert any(re.search("Kdry_rst of levels 0 to 9: 1.00 .* 0.55; in use: level 6", one) for one in lines)
    assert "Kwet_rst in use: 0.900" in lines
    silent = "M_NVKTINT (it corrects brake percentages), Q_NVGUIPERM (no A_brake_normal_service)"
    assert f"Without effect on this train: {silent}." in lines
    assert any(one.startswith("The line has rows from 1500 to 8000 m; the limits need it from ") for one in lines)
    assert any("limit of authority of 40 km/h (LOA); own stops need an end of authority" in one for one in lines)
    assert document(found)["train"]["Kdry_rst_in_use"]["values"] == [0.7]
    line.write_text("distance,curvature,cant,gradient\n0,0,0,0\n8000,0,0,0\n")
    assert not any(one.startswith(("The line has rows", "Friction of the line")) for one in text(compute(chosen)))
    line.write_text("distance,curvature,cant,gradient,left_friction\n0,0,0,0,1\n5,0,0,0,0.2\n8000,0,0,0,1\n")
    assert any(one.startswith("Friction of the line, down to a factor of 0.2, acts") for one in text(compute(chosen)))
    line.write_text("distance,gradient\n0,0\n8000,0\n")
    with pytest.raises(BadInputError, match="the columns curvature, cant are missing"):
        compute(chosen)
    seven = Steps([100.4], [1.0, 0.9])  # 361 km/h, if 100.4 km/h was meant
    write_train(path, SupervisedTrain(203.4, seven, one, 2.4, 2.4, Kwet_rst=Steps([30.0], [1.0, 0.9])))
    told = text(computed(str(path), "--target", "2000"))
    assert "Steps begin above all speeds here, 120 km/h: A_brake_emergency from 361 km/h." in told
    late = replace(found, stops=[OwnStop(np.array([1500.0, 2039.0]), np.array([30.0, 0.0]))] * 8)
    assert "8 of 8 own stops pass the target, 39.0 m at most." in text(late)


def test_each_option_has_its_effect(tmp_path: Path) -> None:
    """At more than its default: against the functions, with the same numbers."""
    levels = [Steps.constant(1.0 - 0.04 * n) for n in range(10)]
    fast, one = np.arange(1, 9) * 15.0 / 3.6, Steps.constant(1.0)
    data = {"service_command": True, "A_brake_normal_service": Steps.constant(0.5)}
    train = SupervisedTrain(203.4, one, Steps.constant(0.8), 2.41, 2.43, **data)  # type: ignore[arg-type]
    path, country = tmp_path / "train.json", tmp_path / "country.toml"
    write_train(path, train, levels)
    country.write_text("M_NVEBCL = 2\nA_NVMAXREDADH2 = 0.55\nQ_NVGUIPERM = true\nQ_NVINHSMICPERM = true\n")
    land = NationalValues(M_NVEBCL=2, reduced_adhesion=(1.0, 0.55, 0.7), guidance=True, exact_speed=True)
    four = FixedValues(T_indication_more=4.0)
    at = {n: replace(train, Kdry_rst=levels[n]) for n in (2, 6, 9)}
    slower = 10.0 + (120.0 / 3.6 - 10.0) * np.arange(1, 9) / 8.0
    moving = {"target_speed": 10.0}
    for words, expected in (
        ((), supervise(at[9], 2000.0, fast)),
        (("--level", "6"), supervise(at[6], 2000.0, fast)),
        (("--national", str(country)), supervise(at[2], 2000.0, fast, national=land)),
        (("--national", str(country), "--level", "6"), supervise(at[6], 2000.0, fast, national=land)),
        (("--baseline", "4.0.0"), supervise(at[9], 2000.0, fast, fixed=four)),
        (("--slippery",), supervise(at[9], 2000.0, fast, slippery=True)),
        (("--slippery", "--national", str(country)), supervise(at[2], 2000.0, fast, national=land, slippery=True)),
        (("--kind", "MRSP"), supervise(at[9], 2000.0, fast, kind="MRSP")),
        (("--kind", "MRSP", "--target-speed", "36"), supervise(at[9], 2000.0, slower, kind="MRSP", **moving)),  # type: ignore[arg-type]
        (("--target-speed", "36"), supervise(at[9], 2000.0, slower, kind="LOA", **moving)),  # type: ignore[arg-type]
        (("--rounded",), supervise(rounded_train(at[9]).train, 2000.0, fast)),
    ):
        found = computed(str(path), "--target", "2000", *words).few
        for name in ("EBD", "EBI", "SBD", "SBI1", "SBI2", "W", "P", "I", "GUI"):
            assert getattr(found, name) == pytest.approx(getattr(expected, name), abs=1e-6), (words, name)
    chosen = ("--beyond", "150", "--slippery", "--national", str(country))
    released = computed(str(path), "--target", "2000", *chosen).release_speed
    assert released == release_speed(at[2], 150.0, place=2000.0, national=land, slippery=True)
    assert released != release_speed(at[2], 150.0, place=2000.0, national=land)
    assert computed(str(path), "--target", "2000").release_speed is None


def test_the_side_to_which_rounding_moves_limits_is_told(tmp_path: Path) -> None:
    """1.009 m/s2 becomes 1 m/s2: below the foot, V + 7.5 km/h, EBD lies behind a moving target and moves further."""
    path, most = tmp_path / "train.json", 120.0 / 3.6
    write_train(path, SupervisedTrain(200.0, Steps.constant(1.009), Steps.constant(0.8), 2.4, 2.4))
    words = (str(path), "--target", "2000", "--rounded")
    assert "None lies nearer to it." in " ".join(text(computed(*words)))
    moving = (*words, "--target-speed", "36")
    found = computed(*moving)
    [of] = [one for one in found.shifts if one.name == "EBD"]
    foot, slowest = 10.0 + 7.5 / 3.6, 10.0 + (most - 10.0) / 160.0
    assert of.nearer == pytest.approx((foot**2 - slowest**2) / 2.0 * (1.0 - 1.0 / 1.009), rel=1e-9)
    assert of.further == pytest.approx((most**2 - foot**2) / 2.0 * (1.0 - 1.0 / 1.009), rel=1e-9)
    assert slowest < of.below < foot
    assert "On the unsafe side, nearer to it: " in " ".join(text(found))
    assert document(found)["rounded_limits_m"]["EBD"]["nearer_to_target"] == of.nearer


def test_the_numbers_of_a_train_lose_less_than_a_second_of_its_build_up() -> None:
    """A train whose build-up is stated 1 s too short passes the target."""
    consist = consist_of([{"kind": "locomotive"}, {"kind": "coach", "count": 4}])
    speed, train = np.array([40.0]), supervised_train(consist, 40.0).train
    short = replace(train, T_brake_emergency=train.T_brake_emergency - 1.0)
    for one, before in ((train, True), (short, False)):
        begins = supervise(one, 2000.0, speed, V_ura=0.0).EBI
        [own] = own_stops(consist, speed, begins, None)
        assert (own.ends <= 2000.0) == before


@pytest.mark.parametrize("brake", [{"lambda": 80.0}, {"lambda": 80.0, "distributor": "vacuum"}], ids=["air", "vacuum"])
def test_an_unbraked_locomotive_adds_its_mass_and_resistance(brake: dict[str, Any]) -> None:
    """The lowest deceleration is (F + a) / M with rotating masses, although the stopped train swings back."""
    rows = [{"kind": "locomotive", "mass": 80.0, "brake": "none"}, {"kind": "coach", "count": 8, "mass": 35.0, **brake}]
    consist = consist_of(rows)
    force = sum(brake_force(one, 1.0) + one.resistance[0] for one in consist.vehicles)
    found = supervised_train(consist, 30.0).train
    for brakes in (found.A_brake_emergency, found.A_brake_service):
        assert brakes.values.min() == pytest.approx(force / moved_mass(consist), rel=5e-3)


@pytest.mark.parametrize("blending", ["fills", "adds", "closes"])
def test_a_blended_electric_brake_leaves_the_data_to_the_air(blending: str) -> None:
    """The air alone has the stated 1.2 m/s2 and its own times: the data are those without the electric brake."""
    car = {"kind": "coach", "brake": "ep-direct", "deceleration": 1.2, "dead_time": 0.3, "valve": "head"}
    electric = {"dynamic_force": 80.0, "dynamic_power": 1400.0, "blending": blending}
    electric |= {"blending_speed": 3.0} if blending == "closes" else {}
    blended, plain = (supervised_train(consist_of([car | more]), 22.0).train for more in (electric, {}))
    assert blended.T_brake_emergency == plain.T_brake_emergency < 3.0
    assert np.array_equal(blended.A_brake_emergency.values, plain.A_brake_emergency.values)
    assert plain.A_brake_emergency.values.min() == pytest.approx(1.2, rel=0.03)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--target-speed", "150"], "--target-speed must be below --speed"),
        (["--target-speed", "50", "--beyond", "10"], "leave it out with --target-speed"),
        (["--position", "passenger P", "--dry", "0.8"], "Leave them out with --position"),
        (["--failure", "0.1%", "--dry", "0.8"], "Leave one out"),
        (["--failure", "0.001"], "must have its unit, %; got 0.001"),
        (["--failure", "30%", "--level", "9"], "no brake force is left"),
        (["--dry", "8"], "--dry must be"),
        (["--level", "3"], "--level chooses among factors"),
        (["--failure", "0%", "--level", "3"], "--common above 0 %"),
        (["--position", "passenger P", "--speed", "300"], "at most 200 km/h for the conversion model"),
        (["--kind", "EOA", "--target-speed", "50"], "--target-speed must be 0 with --kind EOA"),
        (["--kind", "LAO"], "--kind must be one of EOA, LOA, MRSP; got LAO. Did you mean LOA?"),
        (["--national", "nowhere.toml"], "nowhere.toml does not exist"),
        (["--page", "page.txt"], "--page must end in .html"),
        (["--osrd", "train.toml"], "--osrd must end in .json"),
        (["--tolerances", "none.toml", "--spread", "5%"], "Leave these out"),
        (["--tolerances", "none.toml", "--position", "passenger P"], "Leave them out with --position"),
        (["--tolerances", "none.toml"], "The file none.toml does not exist"),
    ],
)
def test_contradictions_are_refused(
    words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    consist = tmp_path / "train.toml"
    consist.write_text(COACHES)
    assert main(["etcs", str(consist), "--target", "2000", "--out", str(tmp_path), *words]) == 2
    assert says in capsys.readouterr().err


def test_a_percentage_above_the_largest_of_train_data_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    consist = tmp_path / "strong.toml"
    coaches = '[[vehicle]]\nkind = "coach"\ncount = 8\nmass = 20\nbrake_force = 90\n'
    consist.write_text('[[vehicle]]\nkind = "locomotive"\n\n' + coaches)
    command = ["etcs", str(consist), "--target", "2000", "--out", str(tmp_path), "--position", "passenger P"]
    assert main(command) == 0
    found = re.search(r"brake percentage (\d+) %; train data have at most 250 %", capsys.readouterr().out)
    assert found is not None
    assert int(found[1]) > 250
    assert main([*command, "--json"]) == 0
    train = json.loads(capsys.readouterr().out)["train"]
    assert train["M_BRAKE_PERCENTAGE"] == 250.0 < train["brake_percentage"]


def test_the_public_train_of_the_page_stops_in_its_published_distances() -> None:
    """Exact integrals of the forces in the worked example of EN 14531-1: 508.57 m and 1214.88 m."""
    page = (Path(__file__).parents[3] / "docs/etcs.md").read_text(encoding="utf-8")
    [text] = [part.split("```")[0] for part in page.split("```toml\n")[1:] if part.startswith("# twelve-axles.toml")]
    consist = consist_of(tomllib.loads(text)["vehicle"])
    stops = own_stops(consist, np.array([100.0, 160.0]) / 3.6, np.zeros(2), None)
    assert [one.ends for one in stops] == pytest.approx([508.57, 1214.88], abs=0.1)
