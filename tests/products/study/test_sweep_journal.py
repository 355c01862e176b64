"""The event log of a sweep after killed writers or edited lines, and two writers of one folder."""

from __future__ import annotations

import errno
import json
import math
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from products.study.journal import LOCK, Journal, only_writer
from products.study.points import Outcome
from readers.storage import PARTIAL
from tests.products.study import cheap_points as points
from tests.products.study.swept import GRID, JOURNAL, files, rows, start, token, whole

__all__ = ["start", "token", "whole"]  # fixtures

#: A small sweep: six points.
SMALL = ["--vary", "x=1,2,3", "--vary", "y=0,4"]
POSIX = pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither the signal nor the limit")


def lines_of(path: Path) -> list[bytes]:
    """Return the complete lines of an event log, including the head."""
    return path.read_bytes().split(b"\n")[:-1] if path.exists() else []


def small(out: Path) -> int:
    """Run the small sweep here."""
    return int(points.run_here(["sweep", "cheap", *SMALL, "--out", str(out)]))


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    """Return the lines of the small sweep's event log."""
    out = tmp_path_factory.mktemp("small")
    assert small(out) == 0
    return lines_of(out / "sweep-cheap" / JOURNAL)


def written(out: Path, lines: list[bytes]) -> Path:
    """Write an event log of these lines in a folder for results."""
    path = out / "sweep-cheap" / JOURNAL
    path.parent.mkdir()
    path.write_bytes(b"\n".join([*lines, b""]))
    return path


def test_infinite_results_are_kept_as_they_are(tmp_path: Path) -> None:
    """JSON has no numbers for them; before, they ended a sweep."""
    found = Outcome({"product": math.inf, "ratio": -math.inf}, point={"x": 1.0})
    before: dict[int, Outcome]
    for before in ({}, {0: found}):
        journal = Journal(tmp_path / JOURNAL, {}, [{"x": 1.0}], ["product", "ratio"])
        assert journal.outcomes == before
        with journal:
            journal.add({0: found})


# ---- killed, and continued -----------------------------------------------------------------------------------------


def test_without_room_for_a_line_and_resumed_gives_the_same_bytes(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments, folder = ["sweep", "cheap", *GRID, "--out", str(tmp_path)], tmp_path / "sweep-cheap"
    for room in (0, 1, 7, 30):
        calls = iter(range(room + 1))

        def synced(file: int, calls: Iterator[int] = calls) -> None:
            if next(calls, None) is None:
                raise OSError(errno.ENOSPC, "No space left on device")

        monkeypatch.setattr("products.study.journal.os.fsync", synced)
        assert points.run_here(arguments) == 3
        assert f"{folder} must have room for the results; got 'No space left on device'." in capsys.readouterr().err
        assert not files(folder)
    monkeypatch.undo()
    assert points.run_here(arguments) == 0
    assert files(folder) == files(whole)


@pytest.mark.study
@POSIX
def test_killed_with_its_workers_and_resumed_gives_the_same_bytes(
    start: Callable[..., Any], whole: Path, tmp_path: Path
) -> None:
    arguments = ["sweep", "cheap", *GRID, "--jobs", "2", "--out", str(tmp_path)]
    folder = tmp_path / "sweep-cheap"
    process = start(points.run, arguments)
    while len(lines_of(folder / JOURNAL)) < 5:
        assert process.is_alive()
        time.sleep(0.001)
    process.kill()
    process.join()
    assert len(lines_of(folder / JOURNAL)) >= 5
    assert points.run_here(arguments) == 0
    assert files(folder) == files(whole)


@pytest.mark.study
@POSIX
def test_workers_leave_with_a_killed_parent(start: Callable[..., Any], tmp_path: Path, token: int) -> None:
    arguments, file = ["sweep", "ticks", "--vary", f"token={token}", "--out", str(tmp_path)], points.scratch(token)
    process = start(points.run, arguments)
    while not file.exists():
        time.sleep(0.002)
    process.kill()
    process.join()
    process.close()
    sizes = [-1, file.stat().st_size]
    while sizes[-1] != sizes[-2]:
        time.sleep(0.5)
        sizes.append(file.stat().st_size)
    assert sizes[-1] < 1000  # only permanent output of a worker


def test_a_line_that_was_cut_off_is_dropped_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert small(tmp_path) == 0
    folder = tmp_path / "sweep-cheap"
    journal, table = (folder / JOURNAL).read_bytes(), files(folder)
    capsys.readouterr()
    for cut in (1, 5, len(journal.split(b"\n")[-2]), len(journal) - 20):
        (folder / JOURNAL).write_bytes(journal[:-cut])
        left = folder / f".0123456789abcdef{PARTIAL}"  # of a table whose writer was killed
        left.write_text("x,y")
        assert small(tmp_path) == 0
        assert not left.exists()
        assert capsys.readouterr().err == (
            f"The last line of {folder / JOURNAL} was cut off; what it held is computed again.\n"
        )
        assert sorted((folder / JOURNAL).read_bytes().split(b"\n")) == sorted(journal.split(b"\n"))
        assert files(folder) == table


def test_a_table_without_room_is_left_out_and_comes_later(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert small(tmp_path) == 0
    folder = tmp_path / "sweep-cheap"
    table = files(folder)

    def full(*given: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("products.study.table.write_columns", full)
    assert small(tmp_path) == 3
    assert f"{folder} must have room for the results; got 'No space left on device'." in capsys.readouterr().err
    assert not files(folder)
    monkeypatch.undo()
    assert small(tmp_path) == 0
    assert files(folder) == table
    assert {path.name for path in folder.iterdir()} == {*table, JOURNAL, LOCK}


def test_interruption_says_how_to_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    add = Journal.add

    def interrupted(journal: Journal, *arguments: Any) -> None:
        add(journal, *arguments)
        if len(journal.outcomes) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(Journal, "add", interrupted)
    assert small(tmp_path) == 130
    assert capsys.readouterr().err == (
        "sweep-cheap was interrupted with 2 of 6 points done; the same command goes on from there.\n"
    )
    assert not files(tmp_path / "sweep-cheap")
    monkeypatch.undo()
    assert small(tmp_path) == 0
    assert "2 of 6 points are done already" in capsys.readouterr().out


# ---- of another sweep, or damaged ----------------------------------------------------------------------------------


def test_journal_of_another_sweep_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["sweep", "cheap", "--out", str(tmp_path)]
    assert points.run_here([*command, "--vary", "x=1,2", "--vary", "y=1"]) == 0
    path = tmp_path / "sweep-cheap" / JOURNAL
    journal, table = path.read_bytes(), files(tmp_path / "sweep-cheap")
    capsys.readouterr()
    for vary, difference in (
        (["x=1,3", "y=1"], "different: vary x (1.0, 2.0, now 1.0, 3.0). Give another --out and both stay"),
        (["x=1,2"], "different: vary y (1.0, now absent); held y (absent, now 2.0)."),
        (["y=1", "x=1,2"], "different: the order of vary (x, y, now y, x)."),
    ):
        assert points.run_here([*command, *(part for text in vary for part in ("--vary", text))]) == 2
        assert difference in capsys.readouterr().err
    with monkeypatch.context() as patch:
        patch.setattr("products.study.study.sources", lambda: "other")
        assert points.run_here([*command, "--vary", "x=1,2", "--vary", "y=1"]) == 2
        assert "different: versions sources (" in capsys.readouterr().err
    assert path.read_bytes() == journal
    assert files(tmp_path / "sweep-cheap") == table
    assert points.run_here([*command, "--restart", "--vary", "x=1,3", "--vary", "y=1"]) == 0
    assert [row[0] for row in rows(tmp_path / "sweep-cheap")[1:]] == ["1.0", "3.0"]


def edited(line: bytes, **values: object) -> bytes:
    """Return a line of an event log with other values."""
    return json.dumps(json.loads(line) | values).encode()


def test_a_file_that_is_no_journal_is_refused_and_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "sweep-cheap" / JOURNAL
    path.parent.mkdir()
    for text in ("notes of mine", "notes of mine\n"):
        path.write_text(text)
        assert small(tmp_path) == 2
        assert f"{path}, line 1 must be as it was written; got a damaged one." in capsys.readouterr().err
        assert path.read_text() == text


@pytest.mark.parametrize(
    "edit",
    [
        lambda line: b"nonsense",
        lambda line: b"",
        lambda line: b"[3]",
        lambda line: b"[" * 100_000,
        lambda line: edited(line, point=3),
        lambda line: edited(line, point=6),
        lambda line: edited(line, point=-1),
        lambda line: edited(line, parameters={"x": 1.0, "y": 4.5}),
        lambda line: edited(line, results={"product": 1.0}),
        lambda line: edited(line, results=None),
    ],
)
def test_a_damaged_line_or_one_of_another_point_is_refused_by_its_number(
    edit: Callable[[bytes], bytes], good: list[bytes], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, [*good[:2], edit(good[2]), *good[3:]])
    assert small(tmp_path) == 2
    assert capsys.readouterr().err == (
        f"{path}, line 3 must be as it was written; got a damaged one. Delete this line, and the points are computed "
        "again. Give another --out and both stay; --restart begins anew in its place.\n"
    )
    path.write_bytes(b"\n".join([*good[:2], *good[3:], b""]))
    assert small(tmp_path) == 0


# ---- two writers ---------------------------------------------------------------------------------------------------


OTHER = ["--vary", "x=1,2,3", "--vary", "y=0,5"]


@POSIX
@pytest.mark.parametrize("second", [SMALL, [*SMALL, "--restart"], OTHER, [*OTHER, "--restart"]], ids=" ".join)
def test_a_second_writer_is_refused_and_goes_on_or_begins_anew_when_the_first_is_killed(
    second: list[str], start: Callable[..., Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, command = tmp_path / "sweep-cheap", ["sweep", "cheap", "--out", str(tmp_path)]
    first = start(points.run_and_stay, [*command, *SMALL], 3, points.made_by())
    while len(lines_of(folder / JOURNAL)) < 4:
        assert first.is_alive()
        time.sleep(0.001)
    journal = (folder / JOURNAL).read_bytes()
    assert points.run_here([*command, *second]) == 2
    said = capsys.readouterr().err
    assert f"{folder} must have one sweep at a time; got a second one while process {first.pid} on " in said
    assert "has held it since 20" in said
    assert said.count("\n") == 1
    assert (folder / JOURNAL).read_bytes() == journal
    first.kill()
    first.join()
    refused = second == OTHER
    assert points.run_here([*command, *second]) == (2 if refused else 0)
    assert len(lines_of(folder / JOURNAL)) == (4 if refused else 7)
    if refused:
        assert "belongs to another sweep; different: vary y (0.0, 4.0, now 0.0, 5.0)" in capsys.readouterr().err
        return
    ways = [(x, y) for x in (1.0, 2.0, 3.0) for y in (0.0, 5.0 if second[:4] == OTHER else 4.0)]
    expected = [[repr(x), repr(y), repr(x * y * 0.1), repr(x / y) if y else "", ""] for x, y in ways]
    assert rows(folder)[1:] == expected


def test_a_folder_has_one_writer_also_within_a_process(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "sweep-cheap"
    with only_writer(folder):
        assert small(tmp_path) == 2
        (folder / LOCK).write_text("")
        assert small(tmp_path) == 2
    assert "a second one while another process holds it. Wait for its end" in capsys.readouterr().err
    assert small(tmp_path) == 0


def test_a_journal_that_is_moved_while_it_is_written_ends_the_sweep(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "sweep-cheap" / JOURNAL

    def moves(jobs: int, evaluate: Callable[[Any], Any], some: Mapping[int, Any]) -> Iterator[dict[int, Any]]:
        for number, point in some.items():
            if number == 2:
                path.rename(tmp_path / "moved")
            yield {number: evaluate(point)}

    assert points.run(["sweep", "cheap", *SMALL, "--out", str(tmp_path)], moves) == 3
    assert f"{path} must stay while the sweep runs; it was moved or deleted." in capsys.readouterr().err
    assert not path.exists()


def test_a_worker_that_returns_another_points_results_ends_the_sweep(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def mixed(jobs: int, evaluate: Callable[[Any], Any], some: Mapping[int, Any]) -> Iterator[dict[int, Any]]:
        given = list(some.values())
        for number in some:
            yield {number: evaluate(given[{3: 4, 4: 3}.get(number, number)])}

    assert points.run(["sweep", "cheap", *SMALL, "--out", str(tmp_path)], mixed) == 3
    said = capsys.readouterr().err
    assert 'must return the results of {"x": 2.0, "y": 4.0}; got those of {"x": 3.0, "y": 0.0}.' in said
    assert len(lines_of(tmp_path / "sweep-cheap" / JOURNAL)) == 4
    assert small(tmp_path) == 0


def test_a_disk_that_is_full_for_a_worker_is_no_failure_of_its_point(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["sweep", "moody", "--vary", "mood=0,11", "--out", str(tmp_path)]
    assert points.run_here(command) == 3
    assert "must have room for the results; got 'No space left on device'" in capsys.readouterr().err
    assert len(lines_of(tmp_path / "sweep-moody" / JOURNAL)) == 2
