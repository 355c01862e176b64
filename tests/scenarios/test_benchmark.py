"""The benchmark: its cases are read as meant or refused, programs are scored, a dash is never a zero."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from bogie_braking.exit_status import BAD_INPUT, HOLDS
from readers.text import BadInputError, FileError
from scenarios.benchmark.band import bands
from scenarios.benchmark.case_file import CASES, cases_in, read_case
from scenarios.benchmark.fmu_program import program_of_fmu
from scenarios.benchmark.programs import of_file, own_program, programs
from scenarios.benchmark.score import score
from scenarios.benchmark.words import worst

#: Scores on the page.
SHOWN = Path(__file__).parents[2] / "docs" / "data" / "benchmark.json"
CASE = """
title = "A mass with a constant force stops"
question = "constant-force"
description = "Stopping distance."
source = "Newton's second law"
licence = "none needed"
sureness = "exact"
[inputs]
mass = "1 t"
force = "2 kN"
speed = "36 km/h"
rail = "dry"
[answers.distance]
what = "stopping distance"
unit = "m"
judged = true
within_percent = 0.1
[answers.work]
what = "work of the force"
unit = "kJ"
judged = false
within = "1 kJ"
[unknown.force]
uniform = ["1 kN", "3000 N"]
source = "made up"
[[points]]
distance = 25.0
[[points]]
speed = "72 km/h"
rail = "wet"
distance = "0.1 km"
work = 200
"""
PROGRAM = """
VERSION = "1.2"
def answer(question, inputs):
    if question == "constant-force":
        return {"distance": inputs["speed"] ** 2 * inputs["mass"] / (2 * inputs["force"])}
"""


def write(folder: Path, text: str = CASE, name: str = "constant-force.toml") -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / name
    path.write_text(text)
    return path


def test_a_case_is_read_in_si_units(tmp_path: Path) -> None:
    case = read_case(write(tmp_path))
    first, second = case.points
    assert first.inputs == {"mass": 1000.0, "force": 2000.0, "speed": pytest.approx(10.0), "rail": "dry"}
    assert second.inputs["speed"] == pytest.approx(20.0)
    assert second.inputs["rail"] == "wet"
    assert second.own == ("speed", "rail")
    assert (dict(first.published), dict(second.published)) == ({"distance": 25.0}, {"distance": 100.0, "work": 2e5})
    assert case.unknown["force"].numbers == (1000.0, 3000.0)
    assert (case.answers["work"].bound, case.answers["work"].relative) == (1000.0, False)


def test_points_may_be_rows_of_a_table(tmp_path: Path) -> None:
    text = CASE[: CASE.index("[[points]]")].replace("[inputs]", 'points = "rows.csv"\n[inputs]')
    (tmp_path / "rows.csv").write_text("speed [km/h];rail;distance [km];work\n36;dry;0,025;\n72;wet;0,1;200\n")
    points = read_case(write(tmp_path, text)).points
    assert [dict(one.published) for one in points] == [{"distance": 25.0}, {"distance": 100.0, "work": 2e5}]
    assert [one.inputs["rail"] for one in points] == ["dry", "wet"]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('licence = "none needed"', "", "licence must be a text of one line; got nothing"),
        ('force = "2 kN"', "force = true", "inputs.force: a value must be a number"),
        ('force = "2 kN"', 'force = "2 kX"', "inputs.force: a unit must be one that is known"),
        ('force = "2 kN"', 'force = "2"', "a number in quotes must have its unit"),
        ('speed = "72 km/h"', 'sped = "72 km/h"', "point 2: the entry sped is unknown; did you mean speed?"),
        ('speed = "72 km/h"', 'speed = "72 kg"', "point 2: speed must have the unit of inputs.speed"),
        ('distance = "0.1 km"', 'distance = "0.1 kg"', "point 2, distance must have a unit that converts to m"),
        ("distance = 25.0", "distance = 0", "point 1: distance must not be 0"),
        ("distance = 25.0", "", "point 1 must have a published answer"),
        ("within_percent = 0.1", "", "must have within or within_percent where it is judged"),
        ("within_percent = 0.1", "within_percent = -1", "within_percent must be a number above 0"),
        ('unit = "kJ"', 'unit = "kK"', "answers.work: a unit must be one that is known"),
        ("[unknown.force]", "[unknown.rail]", "unknown.rail must be the name of an input that is a number"),
        ('uniform = ["1 kN", "3000 N"]', 'uniform = ["3 kN", "1 kN"]', "uniform must have its lower value first"),
        ("[answers.work]", "[answers.mass]", "mass must not be the name of an input too"),
        ("judged = true", "", "judged must be true or false"),
        ("title", "titel", "the entry titel is unknown; did you mean title?"),
    ],
)
def test_a_bad_case_is_refused_in_one_sentence_with_its_place(old: str, new: str, said: str, tmp_path: Path) -> None:
    assert CASE.count(old) >= 1
    path = write(tmp_path, CASE.replace(old, new, 1))
    with pytest.raises(FileError, match=re.escape(said)) as told:
        read_case(path)
    assert str(path) in str(told.value)
    assert "\n" not in str(told.value)


def test_a_question_that_no_program_knows_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path / "cases")
    given = ["--cases", str(tmp_path / "cases"), "--out", str(tmp_path / "out")]
    assert main(["benchmark", "constant-force", *given]) == BAD_INPUT
    assert "question must be one that a program answers; got constant-force" in capsys.readouterr().err


def test_a_stranger_adds_a_case_and_programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The program answers distance alone; the file gives one wrong distance and the work; ours has dashes."""
    write(tmp_path / "cases")
    write(tmp_path, PROGRAM, "mine.py")
    rows = "case,point,answer,value,unit\nconstant-force,1,distance,2600,cm\nconstant-force,2,work,199.5,kJ\n"
    write(tmp_path, rows, "table.csv")
    given = ["--cases", str(tmp_path / "cases"), "--program", str(tmp_path / "mine.py")]
    given += ["--answers", str(tmp_path / "table.csv"), "--out", str(tmp_path / "out"), "--json"]
    assert main(["benchmark", "constant-force", *given]) == HOLDS
    read = json.loads(capsys.readouterr().out)
    assert read["programs"]["mine"] == "1.2"
    found = {(one["program"], one["answer"]): one for one in read["scores"]}
    assert found["mine", "distance"]["worst"] == pytest.approx(0.0, abs=1e-12)
    assert found["mine", "distance"]["holds"] is True
    assert found["table", "distance"]["worst"] == pytest.approx(0.04)
    assert found["table", "distance"]["answered"] == 1
    assert found["table", "distance"]["holds"] is False
    assert found["table", "work"]["worst"] == pytest.approx(-500.0)
    for dash in (found["mine", "work"], found["bogie-braking", "distance"]):
        assert (dash["worst"], dash["holds"], dash["cost"]) == (None, None, None)
    page = (tmp_path / "out" / "benchmark.html").read_text()
    assert "<td>-</td>" in page
    assert "+4 % (1 of 2) !" in page
    assert (tmp_path / "out" / "benchmark.csv").read_text().splitlines()[
        1
    ] == "constant-force,1,distance,m,bogie-braking,25.0,"


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("constant,1,distance,1,m", "case must be the name of a case; got constant; did you mean constant-force?"),
        ("constant-force,3,distance,1,m", "point must be from 1 to 2"),
        ("constant-force,1,way,1,m", "answer must be one of distance, work"),
        ("constant-force,1,distance,1,s", "unit must convert to m"),
        ("constant-force,1,distance,1,m\nconstant-force,1,distance,2,m", "must be there once"),
    ],
)
def test_answers_without_a_place_are_refused(
    rows: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(tmp_path / "cases")
    table = write(tmp_path, f"case,point,answer,value,unit\n{rows}\n", "table.csv")
    given = ["--cases", str(tmp_path / "cases"), "--answers", str(table), "--out", str(tmp_path / "out")]
    assert main(["benchmark", "constant-force", *given]) == BAD_INPUT
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("return {'distance': float('nan')}", "distance must be a finite number; got nan."),
        ("return {'way': 1.0}", "the answers must have one of distance, work"),
        ("return 25.0", "answer must return a dictionary or None"),
        ("raise OSError('no licence')", "OSError: no licence"),
    ],
)
def test_a_program_that_fails_has_a_dash_and_a_reason(
    body: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(tmp_path / "cases")
    mine = write(tmp_path, f"def answer(question, inputs):\n    {body}\n", "mine.py")
    given = ["--cases", str(tmp_path / "cases"), "--program", str(mine), "--out", str(tmp_path / "out")]
    assert main(["benchmark", "constant-force", *given]) == HOLDS
    assert f"mine failed on constant-force, point 1: {said}" in capsys.readouterr().out


@pytest.mark.study
def test_twelve_axles_of_en_14531_1(tmp_path: Path) -> None:
    """The exact integral within 0.01 %, the mean-value method as published, and its error over the integral."""
    scored = score(read_case(CASES / "en-14531-1-twelve-axles.toml"), programs()[0])
    found = {(one.program, one.answer.name): one for one in scored.scores}
    own, mean = own_program().name, "mean values (EN 14531-1)"
    assert all(one.holds is not False for one in scored.scores if one.program == own)
    assert found[own, "distance"].holds is True
    assert worst(found[own, "mean_value_distance"]) == "-"
    assert found[mean, "mean_value_distance"].values[0] == pytest.approx(1245.86, abs=0.005)
    assert found[mean, "distance"].errors == pytest.approx([0.0024, 0.0024, 0.0027], abs=2e-4)


@pytest.mark.study
@pytest.mark.parametrize(
    "name", ["coasting", "two-vehicle-impact", "rsgeo-contact", "rsgeo-kalker", "manchester-contact"]
)
def test_this_project_answers_within_the_bounds_as_the_page_shows(name: str) -> None:
    """An error that moves by a tenth of its bound makes the page outdated: docs/generate/benchmark.py."""
    shown = {
        (one["case"], one["answer"]): one["worst"]
        for one in json.loads(SHOWN.read_text(encoding="utf-8"))["scores"]
        if one["program"] == own_program().name
    }
    for one in score(read_case(CASES / f"{name}.toml"), [own_program()]).scores:
        assert one.holds is (True if one.answer.judged else None), (one.answer.name, one.worst)
        assert len(one.errors) == one.points
        scale = one.answer.bound or 0.05
        assert one.worst == pytest.approx(shown[name, one.answer.name], abs=0.1 * scale)


def test_all_cases_of_the_package_are_read() -> None:
    for path in cases_in([CASES]).values():
        assert read_case(path).source


def test_a_case_is_listed_and_a_wrong_name_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["benchmark", "--list"]) == HOLDS
    assert "en-14531-1-twelve-axles  Twelve axles" in capsys.readouterr().out
    assert main(["benchmark", "en-14531-1-twelve-axle"]) == BAD_INPUT
    assert "did you mean en-14531-1-twelve-axles?" in capsys.readouterr().err


BRAKE_MAP = """
question = "block-braked-bogie"
ignore = ["shoes", "shoe_friction_factor", "rail_friction", "speed", "rolling_resistance_torque"]
[run]
duration = "5 s"
step = "10 ms"
[inputs]
pressure = "pressure_demand"
application_time = "application_time"
shoe_force_area = "force_per_pressure"
braked_shoes = "shoes"
rigging_efficiency = "rigging_efficiency"
shoe_friction = "constant_shoe_friction"
[values]
wheelset_share = 0.5
touch_pressure = 0.0
slack_adjuster_force = 0.0
[answers]
shoe_force = { variable = "shoe_force", factor = 0.5 }
"""


@pytest.mark.study
def test_an_fmu_answers_by_a_map(fmus: dict[tuple[str, str], Path], tmp_path: Path) -> None:
    """The shoe force of the cylinder over its pressure is that of the brake's parameters; another map is refused."""
    fmu, case = fmus["brake", "native"], read_case(CASES / "qr30-bogie.toml")
    found = score(case, [program_of_fmu(fmu, write(tmp_path, BRAKE_MAP, "map.toml"))])
    errors = {one.answer.name: one.worst for one in found.scores}
    assert errors.pop("shoe_force") == pytest.approx(0.0, abs=1e-6)
    assert set(errors.values()) == {None}
    unmapped = write(tmp_path, BRAKE_MAP.replace('"speed", ', ""), "map.toml")
    said = score(case, [program_of_fmu(fmu, unmapped)]).failures["BrakeCylinder"]
    assert said == "point 1: the map must have a variable for speed, or ignore it."
    with pytest.raises(BadInputError, match=r"run.step must have a unit that converts to s; got 10 m."):
        program_of_fmu(fmu, write(tmp_path, BRAKE_MAP.replace('"10 ms"', '"10 m"'), "map.toml"))


def test_a_range_has_the_percentiles_of_its_distribution(tmp_path: Path) -> None:
    """A force of 1 to 3 kN: the 5th percentile of the distance is that of 2.9 kN, and work does not depend on it."""
    case = read_case(write(tmp_path, CASE))
    program = of_file(write(tmp_path, PROGRAM, "mine.py"))
    first, second = bands(case, program, draws=4000)
    ends = [1000.0 * 10.0**2 / (2 * force) for force in (2900.0, 2000.0, 1100.0)]
    assert [first.lower, first.median, first.upper] == pytest.approx(ends, rel=0.02)
    assert (first.value, first.draws, first.answered, first.holds) == (pytest.approx(25.0), 4000, 4000, True)
    assert second.median == pytest.approx(4 * (first.median or 0.0))
