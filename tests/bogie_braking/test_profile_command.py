"""The command `profile`: findings, notes, picture and contact table; one message for each bad input."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib import pyplot as plt

from bogie_braking.__main__ import main
from bogie_braking.commands import profile
from bogie_braking.profiles.pair_running import Running
from fmu_src.cosimulation.recording import Recording
from rbd_model.contact.pair_file import read_pairs
from scenarios.thesis import contact_geometry

REFERENCE = Path(__file__).parents[1] / "data" / "contact"
WHEEL, HOLLOW, RAIL = (str(REFERENCE / f"en15302_{name}.csv") for name in ("RUIC519B", "RUIC519A", "SUIC519A"))


@pytest.fixture(autouse=True)
def few_shifts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shorten the series that are drawn."""
    monkeypatch.setattr(profile, "FILE_SHIFTS", np.linspace(-8e-3, 8e-3, 17))
    monkeypatch.setattr(profile, "FILE_AMPLITUDES", np.array([1e-3, 3e-3]))


@pytest.mark.study
def test_profile_writes_table_and_picture_and_prints_what_it_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "pair.csv"
    given = [WHEEL, RAIL, "--out", str(out), "--diameter", "918", "920", "--gauge", "1437"]
    plt.close("all")
    assert main(["profile", *given, "--json"]) == 0
    assert plt.get_fignums() == []
    found = json.loads(capsys.readouterr().out)
    assert found["gauge [mm]"] == pytest.approx(1437.0, abs=1e-3)
    assert found["patches, left and right"] == [2, 2]
    assert "left radius at the tape circle: 459 mm, given; right 460 mm, given" in found["notes"]
    for name in ("pair.png", "pair-smoothing.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    read_pairs(out)
    assert main(["profile", *given]) == 0
    shown = capsys.readouterr().out.splitlines()
    assert f"equivalent conicity at 3 mm [1]       {found['equivalent conicity at 3 mm [1]']:g}" in shown
    assert f"Contact table: {out}" in shown
    assert any("Flange back: 1360 mm, assumed" in row for row in shown)


@pytest.mark.study
def test_profile_and_scenario_have_one_conicity_and_one_gauge(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Flanges 1367 mm apart leave 3 mm, so that the conicity at 3 mm is that of the flange, with a note."""
    monkeypatch.setattr(contact_geometry, "FILE_SHIFTS", np.linspace(-8e-3, 8e-3, 17))
    monkeypatch.setattr(contact_geometry, "FILE_AMPLITUDES", np.array([1e-3, 3e-3]))
    for more, touches in ([], False), (["--flange-back", "1367"], True):
        assert main(["profile", WHEEL, RAIL, "--out", str(tmp_path / "pair.csv"), "--json", *more]) == 0
        found = json.loads(capsys.readouterr().out)
        given = ["--wheel", WHEEL, "--rail", RAIL, "--out", str(tmp_path), *more]
        assert main(["run", "contact-geometry", *given, "--quiet"]) == 0
        about = json.loads((tmp_path / "contact-geometry" / "summary.json").read_text())
        [row] = [row for row in about["rows"] if row["quantity"] == "equivalent conicity at 3 mm"]
        assert found["equivalent conicity at 3 mm [1]"] == pytest.approx(row["simulated"], abs=1e-5)
        assert f"{found['gauge [mm]']:.2f} mm" in about["parameters"]["gauge, 14 mm below the tops"]
        note = "with contact of the left flange, which begins at an amplitude of 2.99 mm"
        assert (f"equivalent conicity at 3 mm: {note}" in found["notes"]) == touches
        assert (note in json.dumps(row)) == touches
        capsys.readouterr()


@pytest.mark.study
def test_outlier_is_refused_or_dropped(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    points = np.loadtxt(WHEEL, delimiter=",", skiprows=1)
    points[500, 1] += 0.5
    path = tmp_path / "dented.csv"
    np.savetxt(path, points, delimiter=",")
    given = ["profile", str(path), RAIL, "--out", str(tmp_path / "pair.csv"), "--json"]
    assert main(given) == 2
    assert "row 501: points must lie on the contour of their neighbours; y = " in capsys.readouterr().err
    assert main([*given, "--drop-outliers"]) == 0
    notes = " ".join(json.loads(capsys.readouterr().out)["notes"])
    assert "outliers were dropped, up to 0.5 mm off at y = " in notes
    assert notes.count("rows 501") == 1


@pytest.mark.study
def test_rails_that_wheels_leave_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A flat rail that is inclined by 0.2: without a head the wheels find no balance."""
    flat = tmp_path / "flat.csv"
    np.savetxt(flat, np.column_stack([y := np.arange(-50.0, 51.0), 0.2 * y]), delimiter=",")
    assert main(["profile", WHEEL, str(flat), "--gauge-side", "y-", "--out", str(tmp_path / "pair.csv")]) == 2
    shown = capsys.readouterr().err
    assert "must" in shown
    assert shown.count("\n") == 1


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        (["--gauge", "1.435"], "--gauge must be from 500 to 2000 mm; got 1.435 mm."),
        (["--tape-circle", "200"], "the tape circle must lie on the contour, from -70 to 65 mm; got 200 mm"),
        (["--gauge", "1400"], "the left wheel stands on its flange"),
        (["--diameter", "1", "2", "3"], "--diameter must be given once for both sides or twice"),
        (["--right-wheel", "nowhere.whl"], "The file nowhere.whl does not exist"),
        (["--inclination", "0.025"], "--inclination must be from 5 to 1000"),
        (["--out", RAIL], "--out must be another file than FILE"),
        (["--out", "pair.png"], "--out must not end in .png, as the picture beside it does; got pair.png"),
    ],
)
def test_bad_options_get_one_sentence(
    more: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["profile", WHEEL, RAIL, "--out", str(tmp_path / "pair.csv"), *more]) == 2
    shown = capsys.readouterr().err
    assert sentence in shown
    assert shown.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("conicity", "words"), [(-0.01, "drive the wheelset outwards"), (0.0, "do not guide the")])
def test_conicity_that_does_not_guide_has_a_note(conicity: float, words: str) -> None:
    table = Recording({"amplitude": "m", "equivalent_conicity": "1"}, [[1e-3, 0.1], [3e-3, conicity]])
    pair = Running(None, 0.0, None, (6e-3, 6e-3), None, table)  # type: ignore[arg-type]
    [note] = pair.notes_at(3e-3)
    assert words in note
    assert pair.notes_at(1e-3) == []
