"""Consists from files: CSV and TOML alike, and one sentence about each that is none."""

from __future__ import annotations

from pathlib import Path

import pytest

import build_fmu
from products.train.consist import braked_by, coach, locomotive, wagon
from products.train.consist_file import read_consist
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
    """A file with this content."""
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


BAD: dict[str, tuple[str, str | bytes, str]] = {
    "nothing": ("a.csv", "", "a.csv has no vehicle"),
    "only names": ("a.csv", "kind,count\n", "a.csv has no vehicle"),
    "only comments": ("a.csv", "# nothing\n\n", "a.csv has no vehicle"),
    "empty TOML": ("a.toml", "", "a.toml has no vehicle"),
    "unknown kind": (
        "a.csv",
        "kind\nlocomotive\ntram\n",
        "row 2: set kind to one of wagon, locomotive, coach: it was tram.",
    ),
    "no kind": ("a.csv", "kind,load\nlocomotive,\n,60\n", "row 2: give a kind, one of wagon, locomotive, coach."),
    "unknown column": ("a.csv", "kind,colour\nlocomotive,red\n", "row 1: there is no colour; give some of kind,"),
    "no name": ("a.csv", "kind,\nlocomotive,5\n", "row 1: there is a value without a name; name each column."),
    "a name twice": ("a.csv", "kind,load,load\nlocomotive,5,6\n", "a.csv: it names load twice; name each column once."),
    "negative load": (
        "a.csv",
        "kind,load\nlocomotive,\nwagon,-5\n",
        "row 2: set load to a number from 0 to 200 t: it was -5 t.",
    ),
    "too many": (
        "a.csv",
        "kind,count\nlocomotive,\nwagon,100000\n",
        "row 2: set count to a whole number from 1 to 2000",
    ),
    "too many in all": (
        "a.csv",
        "kind,count\nlocomotive,\nwagon,1500\nwagon,1500\n",
        "row 3: a train has at most 2000 vehicles: with this row it had 3001; take fewer.",
    ),
    "two heads": (
        "a.csv",
        "kind,valve\nlocomotive,head\nwagon,\nlocomotive,head\n",
        "row 3: row 1 is the head already; give one vehicle valve = head.",
    ),
    "too long": ("a.csv", "kind,length\nlocomotive,40\n", "row 1: set length to a number from 3 to 31 m: it was 40 m."),
    "no brake weight": (
        "a.csv",
        "kind,lambda\nlocomotive,0\n",
        "row 1: set lambda to a number from 1 to 250 %: it was 0 %.",
    ),
    "a delay of none": (
        "a.csv",
        "kind,delay\nlocomotive,1\n",
        "row 1: a delay is of a valve that follows by radio; set valve to second.",
    ),
    "a delay of the head": (
        "a.csv",
        "kind,valve,delay\nlocomotive,head,1\n",
        "row 1: a delay is of a valve that follows by radio; set valve to second.",
    ),
    "two with the head's valve": (
        "a.csv",
        "kind,count,valve\nlocomotive,2,head\n",
        "row 1: one vehicle has a head valve: count was 2; give it a row of its own.",
    ),
    "half a vehicle": (
        "a.csv",
        "kind,count\nlocomotive,1.5\n",
        "row 1: set count to a whole number from 1 to 2000: it was 1.5.",
    ),
    "NaN": ("a.csv", "kind,load\nlocomotive,nan\n", "row 1: set load to a number from 0 to 200 t: it was nan t."),
    "text": ("a.csv", "kind,load\nlocomotive,much\n", "row 1: set load to a number from 0 to 200 t: it was much t."),
    "text in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = 'locomotive'\nload = 'much'\n",
        "row 1: set load to a number from 0 to 200 t: it was much t.",
    ),
    "a truth in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = 'locomotive'\ncount = true\n",
        "row 1: set count to a whole number",
    ),
    "a list in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = ['wagon']\n",
        "row 1: set kind to one of wagon, locomotive, coach",
    ),
    "a table in TOML": (
        "a.toml",
        "[[vehicle]]\nkind = {a = 1}\n",
        "row 1: set kind to one of wagon, locomotive, coach",
    ),
    "more values than names": ("a.csv", "kind\nlocomotive\nwagon,5\n", "row 2: it has more values than names"),
    "a null byte": ("a.csv", "kind\nloco\x00motive\n", "row 1: set kind to one of wagon, locomotive, coach"),
    "no UTF-8": ("a.csv", b"kind\nlocomotive\n\xff\n", "a.csv is no consist ('utf-8' codec can't decode byte 0xff"),
    "no UTF-8 in TOML": ("a.toml", b"# \xff\n", "a.toml is no consist ('utf-8' codec can't decode byte 0xff"),
    "broken TOML": ("a.toml", "[[vehicle\n", "a.toml is no consist ("),
    "another table": ("a.toml", "[[wagon]]\nkind = 'wagon'\n", "a.toml: there is no wagon; call each [[vehicle]]."),
    "one table": (
        "a.toml",
        "[vehicle]\nkind = 'locomotive'\n",
        "a.toml: give each vehicle as [[vehicle]], with two brackets.",
    ),
    "a number for vehicles": (
        "a.toml",
        "vehicle = 5\n",
        "a.toml: give each vehicle as [[vehicle]], with two brackets.",
    ),
    "a list of numbers": ("a.toml", "vehicle = [5]\n", "row 1: give names and values, as in kind = 'wagon'."),
    "no driver's valve": (
        "a.csv",
        "kind\nwagon\ncoach\n",
        "a.csv has no driver's valve; give it a locomotive, or one vehicle",
    ),
    "only a second valve": (
        "a.csv",
        "kind,valve\nlocomotive,second\n",
        "a.csv has no driver's valve; give it a locomotive",
    ),
    "too many valves": (
        "a.csv",
        "kind,valve\nlocomotive,head\n" + 20 * "locomotive,second\n",
        "a.csv has 21 driver's valves; give it at most 16.",
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
    assert sentence.endswith(".")
    assert not (tmp_path / "build").exists()


def test_a_missing_file_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "missing.csv"
    assert build_fmu.main(["train", "--consist", str(path), "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"There is no file {path}; give the path of a consist or a line.\n"


def test_a_folder_is_no_consist(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert build_fmu.main(["train", "--consist", str(tmp_path), "--out", str(tmp_path / "build")]) == 2
    assert capsys.readouterr().err == f"{tmp_path} is a folder; give the path of a consist or a line.\n"


def test_a_consist_is_built_with_its_file(tmp_path: Path) -> None:
    path = written(tmp_path, "a.csv", CSV)
    assert build_fmu.main(["train", "--consist", str(path), "--out", str(tmp_path), "--kind", "fmi3"]) == 0
    assert (tmp_path / "fmi3" / "TrainDynamics.fmu").exists()


# ---- lines -------------------------------------------------------------------------------------------------------

BAD_LINES = {
    "nothing": ("", "has no rows below a name distance; give it one for each point of the line."),
    "no rows": ("distance,gradient\n", "is no line (no row has a value for each name); mend it."),
    "no distance": ("gradient\n0\n0.1\n", "has no rows below a name distance; give it one for each point of the line."),
    "text": (
        "distance,gradient\n0,much\n",
        "is no line (could not convert string 'much' to float64 at row 0, column 2);",
    ),
    "more values than names": ("distance,gradient\n0,0,0\n", "is no line (no row has a value for each name); mend it."),
    "per mille": ("distance,gradient\n0,0\n9,5\n", ", row 2: set gradient to a number from -0.3 to 0.3: it was 5."),
    "NaN": ("distance,gradient\n0,nan\n", ", row 1: set gradient to a number from -0.3 to 0.3: it was nan."),
    "too tight": ("distance,curvature\n0,0.1\n", ", row 1: set curvature to a number from -0.05 to 0.05: it was 0.1."),
    "backwards": ("distance\n5\n0\n", ", row 2: let distances grow from row to row: 0 follows 5."),
    "twice": ("distance\n0\n5\n5\n", ", row 3: let distances grow from row to row: 5 follows 5."),
}


@pytest.mark.filterwarnings("ignore:loadtxt")
@pytest.mark.parametrize("case", BAD_LINES)
def test_what_is_no_line_is_told_in_one_sentence(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, words = BAD_LINES[case]
    path = written(tmp_path, "line.csv", text)
    assert build_fmu.main(["train", "--line", str(path), "--out", str(tmp_path / "build")]) == 2
    [sentence] = capsys.readouterr().err.splitlines()
    assert sentence.startswith(f"{path}{words}" if words.startswith(",") else f"{path} {words}")
    assert sentence.endswith(".")


@pytest.mark.parametrize("cells", ["0", "-1", "nan", "1e300"])
def test_cells_that_cannot_be_are_told(cells: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        build_fmu.main(["train", f"--cells={cells}"])
    assert "Set --cells to 0.1 to 32: it was" in capsys.readouterr().err
