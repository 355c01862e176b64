"""Saved results of scenarios and sweeps are shown unchanged, or refused with the reason."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from bogie_braking.controllers.table import write_document
from bogie_braking.repeating import repeat
from bogie_braking.reporting.plots import single
from bogie_braking.reporting.report import Report, Row, at_most, exchange, save
from bogie_braking.reporting.saved import SavedRun, Sweep, read
from fmu_src.cosimulation.recording import Recording
from products.sources import sources

MUTATIONS = 2000
Summary = dict[str, Any]


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a scenario's results: a row within its tolerance, one outside, and one without a verdict."""
    rows = [
        Row("mass", "kg", 1.1, 1.0, 0.2, "chapter 5"),
        Row("speed", "m/s", None, 2.0, at_most(1.0), ""),
        Row("load", "N", 3.0, None, None, ""),
    ]
    series = Recording({"time": "s"}, [[0.0], [1.0]])
    report = Report(rows, series, lambda: single("title", "x [m]", "y [m]")[0], {}, 1.0)
    return save(report, "levels", tmp_path_factory.mktemp("results"), 2.5)


@pytest.fixture
def summary(run_folder: Path) -> Summary:
    return dict(json.loads((run_folder / "summary.json").read_text(encoding="utf-8")))


SWEPT: Summary = {
    "sweep": "levels",
    "vary": {"level": [1.0, 2.0], "utilisation": [0.5, 0.7, 0.9]},
    "units": {"level": "1", "utilisation": "1", "stop_distance": "m"},
    "points": 6,
    "failed": 1,
}


def read_back(folder: Path, summary: Summary) -> SavedRun | Sweep:
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    return read(folder)


def row(number: int, **values: Any) -> Callable[[Summary], Summary]:
    """Return a change of values in one row."""
    return lambda summary: (
        summary | {"rows": [one | values if n == number else one for n, one in enumerate(summary["rows"], 1)]}
    )


def test_what_was_saved_is_read_back(summary: Summary, tmp_path: Path) -> None:
    found = read_back(tmp_path, summary)
    assert isinstance(found, SavedRun)
    assert (found.name, found.wall_seconds, found.holds) == ("levels", 2.5, False)
    assert [one["holds"] for one in found.rows] == [True, False, None]
    assert found.rows[0]["deviation"] == 1.0 - 1.1
    swept = read_back(tmp_path, SWEPT)
    assert isinstance(swept, Sweep)
    assert (swept.varied, swept.points, swept.failed) == ("level 1, 2, utilisation 0.5, 0.7, 0.9", 6, 1)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (row(1, simulated=True), "row 1: simulated must be a number; got true."),
        (row(1, simulated=1.05), "row 1: deviation must be simulated less thesis, -0.05"),
        (row(2, simulated=0.5), "row 2: holds must be true by its limits; got false."),
        (row(2, holds=True), "row 2: holds must be false by its limits; got true."),
        (row(2, holds=0), "row 2: holds must be false by its limits; got 0."),
        (row(3, holds=True), "row 3: holds must be null by its limits; got true."),
        (row(3, deviation=0.1), "row 3: deviation must be simulated less thesis, None; got 0.1."),
        (row(1, limits=[0.9]), "row 1: limits must be two numbers"),
        (row(1, limits=[0.9, True]), "row 1: limits must be two numbers"),
        (row(1, unit=None), "row 1: unit must be a text; got null."),
        (lambda all_of: all_of | {"rows": {}}, "rows must be a list; got {}."),
        (lambda all_of: all_of | {"scenario": 4}, "scenario must be a text; got 4."),
        (lambda all_of: all_of | {"wall_seconds": -1.0}, "wall_seconds must be a number from 0 to 2.6784e+06; got -1."),
        (lambda all_of: SWEPT | {"points": 5}, "points must be those of its grid, 6; got 5."),
        (lambda all_of: SWEPT | {"points": True}, "points must be an integer from 1 to 1000000; got true."),
        (lambda all_of: SWEPT | {"points": 6.0}, "points must be an integer from 1 to 1000000; got 6.0."),
        (lambda all_of: SWEPT | {"failed": 7}, "failed must be an integer from 0 to 6; got 7."),
        (lambda all_of: SWEPT | {"units": {}}, "summary.json must have level; got nothing."),
        (lambda all_of: SWEPT | {"vary": {"level": [1.0, "2"]}}, "vary level must be a list of numbers"),
        (lambda all_of: SWEPT | {"sweep": None}, "sweep must be a text; got null."),
    ],
)
def test_results_that_are_not_as_they_were_saved_are_refused(
    change: Callable[[Summary], Summary], sentence: str, summary: Summary, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=r"^summary\.json") as refused:
        read_back(tmp_path, change(summary))
    assert sentence in str(refused.value)


def test_two_thousand_mutated_summaries_are_shown_or_refused_with_a_sentence(summary: Summary, tmp_path: Path) -> None:
    texts = [json.dumps(one, indent=2).encode() for one in (summary, SWEPT)]
    chance, shown = random.Random(2000), 0
    pieces = [
        9999 * b"9",
        b"1e999",
        b"NaN",
        2000 * b"[",
        b"true",
        b"null",
        b'"\\ud800"',
        b"\xff",
        b'"',
        b",",
        b"{}",
        b"",
    ]
    for _ in range(MUTATIONS):
        text = chance.choice(texts)
        at = chance.randrange(len(text))
        (tmp_path / "summary.json").unlink(missing_ok=True)  # some file systems flush a file that is overwritten
        (tmp_path / "summary.json").write_bytes(text[:at] + chance.choice(pieces) + text[at + chance.randrange(12) :])
        try:
            found = read(tmp_path)
        except ValueError as error:
            assert str(error).startswith("summary.json")  # noqa: PT017
            continue
        shown += 1
        assert isinstance(found, Sweep) or all(one["holds"] in (True, False, None) for one in found.rows)
    assert 0 < shown < MUTATIONS / 2


def test_results_take_the_place_of_earlier_ones_or_leave_them(
    run_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, target = tmp_path / ".made", tmp_path / "levels"
    for folder, text in ((made, "new"), (target, "old")):
        folder.mkdir()
        (folder / "summary.json").write_text(text)
    replace = Path.replace

    def refused(path: Path, place: Path) -> Path:
        if path == made:
            raise OSError("full")
        return replace(path, place)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", refused)
        with pytest.raises(OSError, match="full"):
            exchange(made, target)
    assert (target / "summary.json").read_text() == "old"
    exchange(made, target)
    assert [path.name for path in tmp_path.iterdir()] == ["levels"]
    assert (target / "summary.json").read_text() == "new"


def test_documents_for_programs_have_null_where_a_number_is_not_finite(tmp_path: Path) -> None:
    path = tmp_path / "controllers" / "compare.json"
    about = {"runs": [{"distance": math.nan, "sliding": (1.0, math.inf)}], "vehicle": "bogie"}
    text = write_document(path, about)
    found = json.loads(text)
    provenance = found.pop("provenance")
    assert found == {"runs": [{"distance": None, "sliding": [1.0, None]}], "vehicle": "bogie"}
    assert (provenance["function"], provenance["sources"]) == ("controllers compare", sources())
    with pytest.raises(ValueError, match="bogie-braking controllers compare, with the settings in the file"):
        repeat(path)
    assert path.read_text(encoding="utf-8") == text
