"""Sweeps: grid, table, failures of points, worker processes that terminate, a cluster, bad input."""

from __future__ import annotations

import inspect
import json
import pickle
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bogie_braking.__main__ import main
from bogie_braking.reporting.scenario import Options
from evidence.numerics.levels import one_stop as stop_of_levels
from fmu_src.cosimulation.recording import Recording
from products.sources import sources as sources_of_points
from products.study.grid import evenly_spaced
from products.study.table import FILES
from rbd_model.vehicle.parameters import AS_PRINTED
from scenarios.catalogue import SCENARIOS
from scenarios.thesis.heavy_braking import CASES, brake, lock_time
from scenarios.thesis.heavy_braking import one_stop as heavy_stop
from tests.products.study import cheap_points as points
from tests.products.study.swept import GRID, JOURNAL, files, rows, token, whole

__all__ = ["token", "whole"]  # fixtures


def test_spacing_is_decimal() -> None:
    assert [f"{one!r}" for one in evenly_spaced(0.03, 0.15, 13)] == [f"{number / 100:g}" for number in range(3, 16)]
    assert evenly_spaced(6.0, 1.0, 6) == [6.0, 5.0, 4.0, 3.0, 2.0, 1.0]
    assert evenly_spaced(0.3, 0.9, 1) == [0.3]
    assert evenly_spaced(-1e308, 1e308, 3) == [-1e308, 0.0, 1e308]


def test_table_has_the_order_of_the_grid_units_and_all_digits(whole: Path) -> None:
    head, *table = rows(whole)
    assert head == ["x [m]", "y [s]", "z [1]", "product [m.s]", "ratio [m/s]", "failure"]
    asked = [(x, y, z) for x in evenly_spaced(0.03, 0.15, 13) for y in (0.0, 1.5, -2.0) for z in (1e-3, 7.0)]
    expected = [[x, y, z, x * y * z, x / y if y else "", ""] for x, y, z in asked]
    assert table == [[cell if cell == "" else repr(cell) for cell in row] for row in expected]
    summary = json.loads((whole / "summary.json").read_text())
    assert summary["points"] == 78
    assert summary["failed"] == 0
    assert summary["vary"]["y"] == [0.0, 1.5, -2.0]
    assert {"bogie-braking", "python", "sources"} <= set(summary["versions"])


def test_a_report_shows_a_sweep_as_long_as_it_is_whole(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert points.run_here(["sweep", "moody", "--vary", "mood=0,1", "--out", str(tmp_path)]) == 1
    folder = tmp_path / "sweep-moody"
    capsys.readouterr()
    assert main(["report", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr() == (f"Index: {tmp_path / 'index.html'}\n", "")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    [shown] = re.findall(r'<table id="sweeps">.*?</table>', page, re.DOTALL)
    assert 'href="sweep-moody/table.csv"' in shown
    assert re.findall(r">([^<>\n]+)</td>", shown) == ["mood 0, 1", "2", "1"]
    # An interrupted sweep leaves only its event log.
    for name in FILES:
        (folder / name).unlink(missing_ok=True)
    assert main(["report", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert f"{folder} is not shown: its sweep has not come to its end" in said
    assert (folder / JOURNAL).exists()


def test_parquet_is_the_csv_with_units_in_its_fields(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    assert points.run_here(["sweep", "cheap", "--vary", "y=0:1:3", "--out", str(tmp_path)]) == 0
    table = parquet.read_table(tmp_path / "sweep-cheap" / "table.parquet")
    assert {f.name: (f.metadata or {}).get(b"unit") for f in table.schema} == {
        **{"y": b"s", "product": b"m.s", "ratio": b"m/s"},
        "failure": None,
    }
    both = [Recording.read(tmp_path / "sweep-cheap" / name) for name in FILES[:2]]
    for read in both:
        assert read.units == {"y": "s", "product": "m.s", "ratio": "m/s"}
        assert "left out 'failure'" in read.messages[0]
        np.testing.assert_array_equal(read["ratio"], both[0]["ratio"])
    columns = [[("" if v is None else repr(v)) for v in column] for column in table.to_pydict().values()]
    assert [list(row) for row in zip(*columns, strict=True)] == rows(tmp_path / "sweep-cheap")[1:]


def test_failed_points_stay_in_the_table_with_their_reason(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["sweep", "moody", "--vary", "mood=0,1,2,3,4,5,6,7,8,9,10", "--jobs", "2", "--out", str(tmp_path)]
    assert points.run(arguments) == 1
    assert "11 points, 9 failed.\nThe first that failed, at mood = 1.0: ValueError: The" in capsys.readouterr().out
    _, *table = rows(tmp_path / "sweep-moody")
    assert [(row[0], row[1]) for row in table if row[1]] == [("0.0", "0.0"), ("9.0", "9.0")]
    reasons = {float(row[0]): row[2] for row in table if row[2]}
    assert reasons == {
        1.0: "ValueError: The spring is broken.",
        2.0: "The point returned answer = nan, which is not a finite number.",
        3.0: "The point returned answer = '1.0', which is not a finite number.",
        4.0: "The point returned other; promised were answer.",
        5.0: "The worker process died, and once more when it had nothing but this point.",
        6.0: "SystemExit: 7",
        7.0: "The point returned answer = True, which is not a finite number.",
        8.0: "The point returned a float; results by name were promised.",
        10.0: f"ValueError: \\udcff{400 * 'long '}"[:2000] + "...",
    }
    before = files(tmp_path / "sweep-moody")
    assert points.run(arguments) == 1  # no point runs again, and the status stays
    assert "11 of 11 points are done already" in capsys.readouterr().out
    assert files(tmp_path / "sweep-moody") == before


def test_death_of_a_worker_costs_no_point(tmp_path: Path, token: int) -> None:
    vary = ["--vary", f"token={token}", "--vary", "x=0:5:6"]
    assert points.run(["sweep", "dies-once", *vary, "--jobs", "2", "--out", str(tmp_path)]) == 0
    assert [row[2] for row in rows(tmp_path / "sweep-dies-once")[1:]] == ["0.0", "1.0", "4.0", "9.0", "16.0", "25.0"]


def test_point_function_that_workers_cannot_load_ends_the_sweep(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert points.run(["sweep", "hidden", "--vary", "x=1,2,3", "--jobs", "1", "--out", str(tmp_path)]) == 3
    assert "it must stand at the top level of a file that workers can import." in capsys.readouterr().err


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """Yield a scheduler and two workers on this computer, connected by TCP."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=False,
        protocol="tcp",
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",  # any free port: another cluster may run on this machine
    ) as made:
        yield made


def test_dask_cluster_gives_the_same_bytes(whole: Path, tmp_path: Path, cluster: Any) -> None:
    address = ["--scheduler", cluster.scheduler_address]
    assert points.run(["sweep", "cheap", *GRID, *address, "--out", str(tmp_path)]) == 0
    assert files(tmp_path / "sweep-cheap") == files(whole)


def test_failed_points_on_a_cluster(tmp_path: Path, cluster: Any) -> None:
    command = ["sweep", "moody", "--vary", "mood=0,1,4", "--out", str(tmp_path)]
    assert points.run([*command, "--scheduler", cluster.scheduler_address]) == 1
    assert [row[2] for row in rows(tmp_path / "sweep-moody")[1:]] == [
        "",
        "ValueError: The spring is broken.",
        "The point returned other; promised were answer.",
    ]


@pytest.mark.parametrize(
    ("address", "sentence"),
    [
        ("tcp://127.0.0.1:9", "No Dask scheduler answers at tcp://127.0.0.1:9 within 0.5 s; start one with"),
        ("here", "here is not an address of a Dask scheduler; write it as tcp://"),
        ("abc://here:1", "abc://here:1 is not an address of a Dask scheduler; write it as tcp://"),
    ],
)
def test_cluster_out_of_reach_gets_one_sentence(
    address: str, sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("products.study.cluster.PATIENCE", 0.5)
    assert main(["sweep", "levels", "--vary", "level=1", "--scheduler", address, "--out", str(tmp_path / "out")]) == 2
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_without_the_extra_there_is_the_csv_and_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("pyarrow", "pyarrow.parquet", "distributed"):
        monkeypatch.setitem(sys.modules, name, None)
    command = ["sweep", "cheap", "--vary", "x=1", "--out", str(tmp_path)]
    assert points.run([*command, "--scheduler", "tcp://127.0.0.1:9"]) == 2
    assert "--scheduler needs Dask: pip install 'bogie-braking[sweep]'" in capsys.readouterr().err
    assert points.run_here(command) == 0
    assert "No table.parquet: pip install 'bogie-braking[sweep]'" in capsys.readouterr().out
    assert set(files(tmp_path / "sweep-cheap")) == {"table.csv", "summary.json"}


HEAVY = "bogie-heavy-braking"
#: Scenarios that can be swept, in the order of the list.
SWEPT = f"{HEAVY}, anti-skid, braking-distance, train-braking, levels"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["levles", "--vary", "level=1"], "There is no scenario levles; did you mean levels?"),
        (["speed", "--vary", "level=1"], f"speed takes no part in sweeps; these do: {SWEPT}."),
        (
            [HEAVY],
            "--vary must be given; got none: write name=first:last:count or name=a,b,c; bogie-heavy-braking has fric",
        ),
        ([HEAVY, "--vary", "frictoin=1"], f"{HEAVY} has no parameter frictoin to vary; did you mean friction?"),
        ([HEAVY, "--vary", "zzz=1"], f"{HEAVY} has no parameter zzz to vary; it has friction, brake_torque_1"),
        ([HEAVY, "--vary", "friction"], "--vary friction cannot be read; write name="),
        ([HEAVY, "--vary", "=1"], "--vary =1 cannot be read; write name="),
        ([HEAVY, "--vary", "friction="], "--vary friction= cannot be read: '' is not a number"),
        ([HEAVY, "--vary", "friction=0.1,b"], "'b' is not a number"),
        ([HEAVY, "--vary", "friction=0.1:0.2"], "--vary friction=0.1:0.2 cannot be read; write name="),
        ([HEAVY, "--vary", "friction=0.1:0.2:3:4"], "cannot be read; write name="),
        ([HEAVY, "--vary", "friction=0.1:0.2:2.5"], "must have an integer as its count; got '2.5'."),
        ([HEAVY, "--vary", "friction=0.1:0.2:0"], "must have a count from 1 to 1000000; got 0."),
        ([HEAVY, "--vary", "friction=0.1:0.2:9999999999"], "must have a count from 1 to 1000000; got 9999999999."),
        ([HEAVY, "--vary", "friction=0.1:nan:3"], "needs finite numbers: nan is not."),
        ([HEAVY, "--vary", "friction=1,1e999"], "needs finite numbers: 1e999 is not."),
        (
            [HEAVY, "--vary", "friction=1,1.0"],
            "given once; got --vary friction=1,1.0, which repeats one.",
        ),
        (
            [HEAVY, "--vary", "friction=1:1:2"],
            "Each value must be given once; got --vary friction=1:1:2, which begins where it ends.",
        ),
        (
            [HEAVY, "--vary", "friction=1", "--vary", "friction=2"],
            "friction must be varied once; got --vary friction=2 as the second",
        ),
        (
            [HEAVY, "--vary", "friction=0:1:2000", "--vary", "frame_height=0:1:2000"],
            "The grid must have at most 1000000 points; got 4000000.",
        ),
        ([HEAVY, "--vary", "friction=1", "--jobs", "0"], "--jobs must be an integer of at least 1; got 0."),
        ([HEAVY, "--vary", "friction=1", "--jobs", "-3"], "--jobs must be an integer of at least 1; got -3."),
    ],
)
def test_bad_input_gets_one_sentence(
    arguments: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["sweep", *arguments, "--out", str(out)]) == 2
    shown = capsys.readouterr().err
    assert sentence in shown
    assert shown.count("\n") == 1
    assert not out.exists()


def test_help_opens_with_examples_and_names_what_can_be_varied(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        main(["sweep", "--help"])
    shown = capsys.readouterr().out
    assert shown.index("bogie-braking sweep anti-skid --vary") < shown.index("options:")
    assert all(f"{name} [{unit}]" in shown for s in SCENARIOS if s.sweep for name, unit in s.sweep.parameters.items())


def test_code_parts_sweeps_and_how_pages_look_does_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("products.sources.ROOT", tmp_path)
    folder = tmp_path / "scenarios"
    folder.mkdir()
    before = sources_of_points()
    (folder / "page.css").write_text("p { }")
    assert sources_of_points() == before
    (folder / "physics.c").write_text("int x;")
    assert sources_of_points() != before


def test_file_in_place_of_the_folder_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "sweep-levels").write_text("")
    assert main(["sweep", "levels", "--vary", "level=1", "--out", str(tmp_path)]) == 2
    assert "sweep-levels is a file. Choose another folder with --out." in capsys.readouterr().err


@pytest.mark.parametrize("scenario", [s for s in SCENARIOS if s.sweep], ids=lambda s: s.name)
def test_point_functions_keep_what_is_asked_of_them(scenario: Any) -> None:
    sweep = scenario.sweep
    assert pickle.loads(pickle.dumps(sweep.run)) is sweep.run
    parameters = inspect.signature(sweep.run).parameters
    assert set(parameters) == set(sweep.parameters)
    assert all(isinstance(p.default, (int, float)) for p in parameters.values())
    assert not set(sweep.parameters) & set(sweep.results)
    assert "failure" not in {*sweep.parameters, *sweep.results}
    assert set(sweep.run()) == set(sweep.results)


def test_a_point_of_heavy_braking_is_its_scenario() -> None:
    series, _, _ = brake(Options(step=1e-2), 2, CASES["both"])
    point = heavy_stop(torque_reaction=AS_PRINTED["torque_reaction"])
    for number in (1, 2):
        assert point[f"lock_time_{number}"] == pytest.approx(lock_time(series, number), abs=0.0101)
    assert heavy_stop(brake_torque_2=0.0)["lock_time_2"] is None
    with pytest.raises(ValueError, match="The bogie still moves at 25 m/s after 250 s"):
        heavy_stop(brake_torque_1=0.0, brake_torque_2=0.0)


def test_a_point_of_levels_says_what_it_cannot_do() -> None:
    with pytest.raises(ValueError, match="There is no level 4; take 1"):
        stop_of_levels(level=4.0)
    with pytest.raises(ValueError, match="above 0; got -1"):
        stop_of_levels(utilisation=-1.0)
