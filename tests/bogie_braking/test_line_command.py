"""The command `line`: numbers of a line against closed forms, imports, pictures, messages."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt

import bogie_braking as bb
from bogie_braking.__main__ import main
from bogie_braking.reporting.line_picture import with_places_between
from rbd_model.track.line import Line, read_line
from rbd_model.track.line_check import GRAVITY, check_line
from rbd_model.track.line_table import GAUGE
from readers.text import BadInputError

ELEMENTS = (
    "type,length,radius,cant [mm]\nstraight,100,,\nclothoid,80,,\narc,200,-400,120\nclothoid,80,,\nstraight,50,,\n"
)
PROFILE = "chainage,height\n0,10\n510,12.55\n"


def elements(folder: Path) -> Path:
    path = folder / "elements.csv"
    path.write_text(ELEMENTS, encoding="utf-8")
    return path


def test_check_has_the_closed_forms_of_a_curve(tmp_path: Path) -> None:
    """Deficiency v^2 G / (g R) less the cant, twist of the ramp 120 mm / 80 m, height of the tangents."""
    (tmp_path / "profile.csv").write_text(PROFILE, encoding="utf-8")
    line, speed = bb.line_from_elements(elements(tmp_path), tmp_path / "profile.csv"), 80 / 3.6
    check = check_line(line, speed)
    slope = 2.55 / 510.0
    assert check.tightest.value == pytest.approx(-1 / 400 / (1 + slope**2) ** 0.5)
    assert check.cant.value == pytest.approx(-0.12)
    assert check.deficiency.value == pytest.approx(GAUGE * speed**2 / GRAVITY * abs(check.tightest.value) - 0.12)
    assert abs(check.twist.value) == pytest.approx(0.12 / 80.0, rel=1e-4)
    assert check.height == pytest.approx(2.55, abs=1e-6)
    assert check.jumps == {"curvature": [], "cant": [], "gradient": []}
    slow = check_line(line, 5.0)
    assert slow.excess.value == pytest.approx(GAUGE * 25.0 / GRAVITY * abs(check.tightest.value) - 0.12)


def test_jumps_are_found_at_their_places() -> None:
    at = np.array([0.0, 99.0, 101.0, 200.0, 299.5, 300.5, 400.0])
    curvature = np.array([0.0, 0.0, 0.002, 0.002, 0.002, -0.001, -0.001])
    check = check_line(Line({"distance": at, "curvature": curvature, "cant": 0 * at, "gradient": 0 * at}), 20.0)
    first, second = check.jumps["curvature"]
    assert (first.place, first.value) == pytest.approx((100.0, 0.002))
    assert second.place == pytest.approx(300.0, abs=0.5)
    assert second.value == pytest.approx(-0.003)


@pytest.mark.study
def test_a_map_of_friction_is_checked_by_its_mean_over_the_line_and_its_slippery_stretches(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Factor 1, from 60 to 160 m 1/2 and 1/4 on the two rails, back to 1 at 260 m: mean 3/8; 0.15 is 3/4 at 220 m.

    The integral over 1000 m is 1000 - 100 x 5/8 - 100 x 5/16, less the ramp of 10 mm at the jump.
    """
    monkeypatch.chdir(tmp_path)
    line = bb.line_of([bb.straight(1000)], start=-30.0)
    line.write(Path("plain.csv"))
    line.with_friction([60, 60, 160, 260], [1, 0.5, 0.5, 1], [1, 0.25, 0.25, 1]).write(Path("leaves.csv"))
    assert main(["line", "check", "leaves.csv", "--friction", "0.2", "--out", "out", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["adhesion"]
    assert found["mean"] == pytest.approx(0.2 * (1.0 - 0.1 * 5 / 8 - 0.1 * 5 / 16), abs=1e-6)
    assert (found["lowest"]["value"], found["highest"]["value"]) == pytest.approx((0.075, 0.2))
    assert found["sides"]["value"] == pytest.approx(0.05)
    assert found["stretches"] == [pytest.approx([60.0, 220.0], abs=0.01)]
    assert main(["line", "check", "leaves.csv", "--friction", "0.2", "--out", "out"]) == 0
    assert "friction below 0.15:      160.0 m: 60.0 to 220.0 m\n" in capsys.readouterr().out
    assert main(["line", "check", "leaves.csv", "--out", "out"]) == 0
    said = capsys.readouterr().out
    assert "factor on friction:       0.375 at 60.0 m to 1.000 at -30.0 m, mean 0.906; the rails differ" in said
    assert "below" not in said
    assert main(["line", "check", "plain.csv", "--out", "out"]) == 0
    assert "friction" not in capsys.readouterr().out
    assert main(["line", "check", "plain.csv", "--friction", "0.2", "--out", "out"]) == 2
    assert "plain.csv has neither left_friction nor right_friction. Leave it out" in capsys.readouterr().err


@pytest.mark.study
def test_check_and_import_write_line_picture_and_numbers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = elements(tmp_path)
    assert main(["line", "import", str(path), "--out", "made.csv"]) == 0
    said = capsys.readouterr().out
    assert "taken     5 elements" in said
    assert "made.csv" in said
    line = read_line(tmp_path / "made.csv")
    assert line == bb.line_from_elements(path)
    assert main(["line", "check", "made.csv", "--speed", "80km/h", "--out", "out", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["tightest"]["value"] == pytest.approx(-1 / 400)
    assert found["speed"] == pytest.approx(80 / 3.6)
    for picture in (Path("made.png"), Path(found["picture"])):
        assert picture.read_bytes().startswith(b"\x89PNG")
    assert main(["line", "check", str(path), "--out", "out"]) == 0
    said = capsys.readouterr().out
    assert "smallest radius:          400.0 m to the right" in said
    assert "jumps of curvature:       none" in said


def test_figures_are_closed_once_they_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Matplotlib keeps every figure of pyplot until it is closed, and warns at the 21st."""
    monkeypatch.chdir(tmp_path)
    plt.close("all")
    path = str(elements(tmp_path))
    assert main(["line", "import", path, "--out", "made.csv"]) == 0
    assert main(["line", "check", path, "--out", "out"]) == 0
    assert plt.get_fignums() == []


def test_mirror_exchanges_the_sides(tmp_path: Path) -> None:
    path = elements(tmp_path)
    line, other = bb.line_from_file(path), bb.line_from_file(path, mirror=True)
    for name, sign in (("curvature", -1.0), ("cant", -1.0), ("gradient", 1.0)):
        assert other.rows[name] == pytest.approx(sign * line.rows[name])
    with pytest.raises(
        BadInputError,
        match=r"noise must be given for points or a course in degrees alone; .* is elements. Leave it out",
    ):
        bb.line_from_file(path, noise=0.001)


REFUSED = {
    "no file": (["check", "nothing.csv"], "nothing.csv does not exist"),
    "a table of something": (["check", "other.csv"], "other.csv, row 1: the column 'mass' is unknown"),
    "the file itself": (["import", "other.csv", "--out", "other.csv"], "--out must be another file than FILE"),
    "the picture beside it": (["import", "other.csv", "--out", "line.png"], "--out must not end in .png"),
    "an option of other files": (
        ["import", "elements.csv", "--tracks", "A"],
        "tracks must be given for a file of another",
    ),
    "a speed": (["check", "elements.csv", "--speed", "0"], "--speed must be from 0.1 to 200 m/s; got 0"),
    "a noise": (["check", "elements.csv", "--noise", "0"], "--noise must be above 0 and at most 20 m; got 0"),
    "an action": (["draw", "elements.csv"], "must be one of check, import; got draw"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_one_sentence_and_exit_status_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, case: str
) -> None:
    monkeypatch.chdir(tmp_path)
    elements(tmp_path)
    (tmp_path / "other.csv").write_text("mass,speed\n1,2\n", encoding="utf-8")
    arguments, message = REFUSED[case]
    assert main(["line", *arguments]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1


def test_a_line_whose_rows_lie_next_to_drawn_places_is_drawn() -> None:
    """Places between rows may lie closer to a row than rows of a file may."""
    at = np.array([0.0, 50.0 + 1e-4, 100.0])
    line = Line({"distance": at, "curvature": 0 * at, "cant": 0 * at, "gradient": 0 * at})
    assert with_places_between(line).rows["distance"].size == 22
