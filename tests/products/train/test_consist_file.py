"""Consists from CSV and TOML files, and one error message for each invalid file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import bogie_braking as bb
import build_fmu
from products.train.consist import braked_by, coach, locomotive, wagon
from products.train.consist_file import read_consist
from rbd_model.track.line import read_line
from rbd_model.train.coupler import COUPLERS

CSV = """\
# A freight train.
kind, count, load, position, coupler, lambda, mass, length, at, leak, valve, delay

locomotive, 1, , G, draft-gear, , 84, , , , head,
wagon, 3, 40, P, , 65, , 12.5, 0.25, 2,,
   # an engine that helps
wagon,,,,,,,,,,,
locomotive, , , , rigid, , , , , , second, 1.5
"""
TOML = """\
# A freight train.
[[vehicle]]
kind = "locomotive"
position = "G"
coupler = "draft-gear"
mass = 84.0
valve = "head"

[[vehicle]]
kind = "wagon"
count = 3
load = 40
position = "P"
lambda = 65
length = 12.5
at = 0.25
leak = 2

[[vehicle]]
kind = "wagon"

[[vehicle]]
kind = "locomotive"
coupler = "rigid"
valve = "second"
delay = 1.5
"""


def written(folder: Path, name: str, text: str | bytes) -> Path:
    """Write a file with this content; return its path."""
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_csv_and_toml_of_the_same_train_are_equal(tmp_path: Path) -> None:
    found = read_consist(written(tmp_path, "a.csv", CSV))
    assert found == read_consist(written(tmp_path, "a.toml", TOML))
    head, *wagons, last, second = found.vehicles
    assert [one.kind for one in found.vehicles] == ["locomotive", *["wagon"] * 4, "locomotive"]
    assert (head.mass, head.coupler) == (84e3, COUPLERS["draft-gear"]())
    assert head.distributor == locomotive(0.0, "G").distributor
    for one in wagons:
        assert (one.mass, one.length, one.distributor_at, one.brake) == (
            60e3,
            12.5,
            0.25,
            braked_by(65, 60e3, one.resistance),
        )
        assert one.leak > 0.0
    assert last == wagon()
    assert second.valve is not None
    assert second.valve_delay == 1.5


@pytest.mark.parametrize("start", ["", "\ufeff"])
@pytest.mark.parametrize("end", ["\n", "\r\n", ""])
def test_comments_empty_lines_and_marks_of_other_systems_are_nothing(start: str, end: str, tmp_path: Path) -> None:
    lines = ["# one", "", "kind,count", "# two", "locomotive,", "   ", "coach,2", "# three"]
    path = written(tmp_path, "a.csv", start + (end or "\n").join(lines) + end)
    assert [one.kind for one in read_consist(path).vehicles] == ["locomotive", "coach", "coach"]


def test_the_first_locomotive_is_the_head_unless_another_is_called_so(tmp_path: Path) -> None:
    path = written(tmp_path, "a.csv", "kind\nwagon\nlocomotive\nlocomotive\n")
    assert [one.valve is not None for one in read_consist(path).vehicles] == [False, True, False]
    path = written(tmp_path, "b.csv", "kind,valve\nlocomotive,\nwagon,\ncoach,head\n")
    found = read_consist(path).vehicles
    assert [one.valve is not None for one in found] == [False, False, True]
    assert found[2].mass == coach().mass
    path = written(tmp_path, "c.csv", "kind,valve\nlocomotive,none\nlocomotive,\n")
    assert [one.valve is not None for one in read_consist(path).vehicles] == [False, True]


#: Invalid consists and their messages. tests/readers covers the errors of all tables.
BAD: dict[str, tuple[str, str | bytes, str]] = {
    "nothing": ("a.csv", "", "must have a row of names and rows of values; it is empty."),
    "only names": ("a.csv", "kind,count\n", "a.csv must have vehicles; it has none."),
    "empty TOML": ("a.toml", "", "a.toml must have vehicles; it has none."),
    "unknown kind": (
        "a.csv",
        "kind\nlocomotive\ntram\n",
        "row 3, column kind: the value must be one of wagon, locomotive, coach; got 'tram'. Choose one.",
    ),
    "a fall without its decay": (
        "a.csv",
        "kind,friction_ratio\nlocomotive,0.4\n",
        "friction_ratio and friction_decay must come together: one alone has no effect. Give both.",
    ),
    "no kind": (
        "a.csv",
        "kind,load\nlocomotive,\n,60\n",
        "row 3, column kind: the value must be one of wagon, locomot",
    ),
    "a near miss": ("a.csv", "kind,lenght\nlocomotive,20\n", "the column 'lenght' is unknown. Did you mean length?"),
    "no name": (
        "a.csv",
        "kind,\nlocomotive,5\n",
        "row 2: a row must have at most 1 values; got 2: '5' has no name",
    ),
    "negative load": (
        "a.csv",
        "kind,load\n\nlocomotive,\nwagon,-5\n",
        "row 4, column load: the value must be from 0 to 200 t; got '-5' t. Check value and unit.",
    ),
    "a length in mm": (
        "a.csv",
        "kind,length\nlocomotive,18980\n",
        "row 2, column length: the value must be from 3 to 31 m; got '18980' m. Did you mean 18980 mm = 18.98 m?",
    ),
    "a load in kg": (
        "a.csv",
        "kind;load [kg]\nlocomotive;0\nwagon;300000,5\n",
        "row 3, column load: the value must be from 0 to 200 t; got '300000,5', in the file's unit, 1 of which is",
    ),
    "too many in all": (
        "a.csv",
        "kind,count\nlocomotive,\nwagon,1500\nwagon,1500\n",
        "row 4: a train must have at most 2000 vehicles; with this one it has 3001. Take fewer.",
    ),
    "two heads": (
        "a.csv",
        "kind,valve\nlocomotive,head\nwagon,\nlocomotive,head\n",
        "row 4: one vehicle must have valve = head; row 2 has it already. Take one away.",
    ),
    "too long": (
        "a.csv",
        "kind,length\nlocomotive,40\n",
        "row 2, column length: the value must be from 3 to 31 m; got '40' m",
    ),
    "no brake weight": (
        "a.csv",
        "kind,lambda\nlocomotive,0\n",
        "row 2, column lambda: the value must be from 5 to 250 %;",
    ),
    "a delay of the head": (
        "a.csv",
        "kind,valve,delay\nlocomotive,head,1\n",
        "row 2: delay must be of a valve that follows by radio.",
    ),
    "two with the head's valve": (
        "a.csv",
        "kind,count,valve\nlocomotive,2,head\n",
        "row 2: count must be 1 with a head valve; got 2. Give that vehicle a row of its own.",
    ),
    "text in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = 'locomotive'\nload = 'much'\n",
        "vehicle 1: load must be a number from 0 to 200 t; got much. Correct it.",
    ),
    "kilograms in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = 'locomotive'\nmass = 84000\n",
        "vehicle 1: mass must be a number from 1 to 300 t; got 84000. Did you mean 84000 kg = 84 t?",
    ),
    "another quantity in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = 'locomotive'\nmass = '84 bar'\n",
        "vehicle 1: mass must be a number from 1 to 300 t; got 84 bar. Correct it.",
    ),
    "a truth in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = 'locomotive'\ncount = true\n",
        "vehicle 1: count must be an integer from 1 to 2000; got true. Correct it.",
    ),
    "a name that is none in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = 'locomotive'\nlenght = 20\n",
        "vehicle 1: the name 'lenght' is unknown. Did you mean length?",
    ),
    "a list in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = ['wagon']\n",
        "vehicle 1: kind must be one of wagon, locomotive, coach",
    ),
    "more values than names": ("a.csv", "kind\nlocomotive\nwagon,5\n", "row 3: a row must have at most 1 values"),
    "no UTF-8": ("a.csv", b"kind\nlocomotive\n\xff\n", "row 3, column kind: the value must be one of wagon"),
    "broken TOML": ("a.toml", "[[vehicle\n", "a.toml must be TOML; got a fault: "),
    "another table": (
        "a.toml",
        "[[wagon]]\nkind = 'wagon'\n",
        "a.toml: the table 'wagon' is unknown. Call each [[vehicle]] or [[coupler]].",
    ),
    "one table": ("a.toml", "[vehicle]\nkind = 'locomotive'\n", "a.toml: vehicle must be a list of tables."),
    "a list of numbers": ("a.toml", "vehicle = [5]\n", "vehicle 1: a vehicle must be names with values; got 5."),
    "no driver's valve": ("a.csv", "kind\nwagon\ncoach\n", "a.csv must have a driver's valve; add a locomotive"),
    "only a second valve": (
        "a.csv",
        "kind,valve\nlocomotive,second\n",
        "a.csv must have a driver's valve; add a locomotive",
    ),
    "too many valves": (
        "a.csv",
        "kind,valve\nlocomotive,head\n" + 20 * "locomotive,second\n",
        "a.csv must have at most 16 driver's valves; it has 21. Take fewer.",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_no_consist_is_told_in_one_sentence_with_file_and_row(
    case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name, text, words = BAD[case]
    path = written(tmp_path, name, text)
    assert build_fmu.main(["train", "--consist", str(path), "--out", str(tmp_path / "build")]) == 2
    said = capsys.readouterr()
    [sentence] = said.err.splitlines()
    assert words in sentence
    assert sentence.startswith(str(path))
    assert sentence.count(str(path)) == 1
    assert sentence.endswith((".", "?"))
    assert not (tmp_path / "build").exists()


def test_a_missing_file_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "missing.csv"
    assert build_fmu.main(["train", "--consist", str(path), "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"The file {path} does not exist. Check the path.\n"


def test_a_folder_is_no_consist(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert build_fmu.main(["train", "--consist", str(tmp_path), "--out", str(tmp_path / "build")]) == 2
    assert capsys.readouterr().err.startswith(f"{tmp_path} must be a file; it is a folder")


@pytest.mark.study
def test_a_consist_is_built_with_its_file(tmp_path: Path) -> None:
    path = written(tmp_path, "a.csv", CSV)
    assert build_fmu.main(["train", "--consist", str(path), "--out", str(tmp_path), "--kind", "fmi3"]) == 0
    assert (tmp_path / "fmi3" / "TrainDynamics.fmu").exists()


# ---- lines -------------------------------------------------------------------------------------------------------


def test_what_is_no_line_is_told_in_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One error of the line reader; tests/readers/test_twin.py covers all."""
    path = written(tmp_path, "line.csv", "distance,curvature,cant,gradient\n0,0,0,0\n9,0,0,5\n")
    assert build_fmu.main(["train", "--line", str(path), "--out", str(tmp_path / "build")]) == 2
    [sentence] = capsys.readouterr().err.splitlines()
    assert sentence.startswith(str(path))
    assert "row 3, column gradient: the value must be from -0.5 to 0.5; got '5'." in sentence


@pytest.mark.parametrize(
    ("given", "more", "sentence"),
    [
        (2.5, {}, r"A consist must be .* or a number of wagons; got 2\.5\."),
        (None, {}, r"A consist must be .*; got None\."),
        (True, {}, r"A consist must be .*; got True\."),
        ({"kind": "wagon"}, {}, r"A consist must be .* a list of its rows .*; got \{'kind': 'wagon'\}\."),
        (["wagon"], {}, r"the consist, row 1: a vehicle must be names with values; got wagon\."),
        ([wagon()], {}, "A consist must have a vehicle with a driver's valve; got 1 vehicles without one"),
        (b"train.toml", {}, r"A consist must be .*; got b'train.toml'\."),
        (1, {"force_error": "5 %"}, r"The error of the force must be a share from 0 to 0.5; got '5 %'\."),
        (1, {"distance_error": None}, r"The error of the distance must be a share from 0 to 0.5; got None\."),
        (1, {"releases": "no"}, r"releases must be True or False; got 'no'\."),
        (
            1,
            {"line": "line.csv"},
            r"The line must be what line_of.* got 'line\.csv'\. Read a file with line_from_file\('line\.csv'\)\.",
        ),
    ],
)
def test_what_makes_no_train_is_told_in_a_sentence(given: Any, more: dict[str, Any], sentence: str) -> None:
    with pytest.raises((TypeError, ValueError), match=sentence):
        bb.train(given, **more)


@pytest.mark.parametrize(
    "head",
    ["distance,curvature,cant,gradient [1]", "DISTANCE,Curvature,cant,Gradient", "distance,curvature,cant,gradient"],
)
def test_a_train_climbs_however_its_gradient_is_named(head: str, tmp_path: Path) -> None:
    """Uphill it loses g sin / 1.04 (rotating masses) more speed each second than on level track."""
    path = written(tmp_path, "line.csv", f"{head}\n-2000,0,0,0.02\n5000,0,0,0.02\n")
    speeds = []
    for line in (None, read_line(path)):
        train = bb.train(2, speed=20.0, line=line)
        train.drive("running")
        train.advance(5.0)
        speeds.append(train.speed[0])
    assert speeds[0] - speeds[1] == pytest.approx(0.02 * 9.81 * 5.0 / 1.04, rel=0.03)


def test_a_spreadsheet_of_another_country_is_the_same_consist(tmp_path: Path) -> None:
    text = "Kind;Load [kg];length;Position;;\r\nlocomotive;;18,5;;;\r\nwagon;40500;12,5;P;;\r\n;;;;;\r\n"
    own = read_consist(written(tmp_path, "b.csv", "kind,load,length,position\nlocomotive,,18.5,\nwagon,40.5,12.5,P\n"))
    for encoding in ("utf-8-sig", "utf-16", "cp1252"):
        assert read_consist(written(tmp_path, "a.csv", text.encode(encoding))) == own


@pytest.mark.parametrize("cells", ["0", "-1", "nan", "1e300"])
def test_cells_that_cannot_be_are_told(cells: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert build_fmu.main(["train", f"--cells={cells}"]) == 2
    assert f"--cells must be from 0.1 to 32; got {cells}." in capsys.readouterr().err


def test_a_number_in_toml_may_carry_its_unit(tmp_path: Path) -> None:
    rows = "[[vehicle]]\nkind = 'locomotive'\n[[vehicle]]\nkind = 'wagon'\n"
    plain = read_consist(written(tmp_path, "a.toml", f"{rows}load = 45.5\nlength = 13.5\nfull_pressure = 3.6\n"))
    units = f"{rows}load = '45500 kg'\nlength = '13500 mm'\nfull_pressure = '360 kPa'\n"
    assert read_consist(written(tmp_path, "b.toml", units)) == plain
