"""Every scenario runs, writes all its files, and refuses bad input with one message."""

from __future__ import annotations

import base64
import csv
import importlib
import json
import math
import re
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from bogie_braking.__main__ import main
from bogie_braking.reporting import report
from bogie_braking.reporting.report import Row
from evidence.comparisons import speed_accuracy, train_methods
from evidence.contact import contact_model, creep_laws
from evidence.measuring import (
    creep_cost,
    environment_throughput,
    protected_throughput,
    supervision_throughput,
    throughput,
    timing,
    train_pace,
)
from evidence.measuring import scenes as six_scenes
from evidence.numerics import oracle, speed, stability_atlas, thesis_step
from evidence.peers import ensembles
from evidence.trains import train_brake_evidence
from scenarios.bench.asymmetric_shoes import CASES, run_all
from scenarios.bench.torque_history import read_torque_history
from scenarios.brakes import anti_skid, etcs_low_adhesion
from scenarios.catalogue import SCENARIOS
from scenarios.contact import flange_climb
from scenarios.coupling import coupling_step
from scenarios.lines import flexible_track
from scenarios.thesis import qr30
from scenarios.thesis.creep_forces import EXACT
from scenarios.trains import (
    braking_distance,
    train_brake_models,
    train_braking,
    train_descent,
    train_one_vehicle_in_detail,
    train_standing,
    train_track_brakes,
)
from scenarios.vehicles import vehicle_anti_skid, vehicle_composed, vehicle_hunting

sys.path.append(str(Path(__file__).parents[2] / "docs" / "generate"))
numbers_of_pages = importlib.import_module("numbers_of_pages")
PUBLISHED = Path(__file__).parents[1] / "data" / "creep" / "exact.csv"
ROW_FIELDS = {
    "quantity",
    "unit",
    "thesis",
    "vampire",
    "simulated",
    "deviation",
    "asked",
    "limits",
    "source",
    "assumption",
    "holds",
}


def summary(out: Path, name: str) -> dict:
    return json.loads((out / name / "summary.json").read_text())


@pytest.fixture
def short_oracle(monkeypatch: pytest.MonkeyPatch) -> None:
    """The oracle takes a minute; a tenth of each case shows that it runs."""
    short = [replace(scene, duration=0.1 * scene.duration) for scene in oracle.SCENES]
    monkeypatch.setattr(oracle, "SCENES", short)


@pytest.fixture
def short_coupling(monkeypatch: pytest.MonkeyPatch) -> None:
    """Macro steps below 1 ms take most of the time and give no further information."""
    monkeypatch.setattr(coupling_step, "STEPS", (1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 2.5e-2, 5e-2, 6e-2, 7.5e-2, 1e-1))


@pytest.fixture
def short_study(monkeypatch: pytest.MonkeyPatch) -> None:
    """One setting of each method on one case; the whole study takes minutes, see `make charts`."""
    chosen = (six_scenes.LOCK_UP,)
    monkeypatch.setattr(speed_accuracy, "all_studies", partial(speed_accuracy.all_studies, True, chosen))
    monkeypatch.setattr(speed_accuracy, "HOST_STEPS", (1e-2,))
    monkeypatch.setattr(speed_accuracy, "TOLERANCES", (1e-6,))
    monkeypatch.setattr(speed_accuracy, "RUNS", 1)


@pytest.fixture
def short_ensembles(monkeypatch: pytest.MonkeyPatch) -> None:
    """One setting of each method, few stops."""
    shorter = {"TOLERANCES": (1e-6,), "COARSE": (1e-5,), "FIXED_STEPS": (1e-2,), "ROUNDS": 1, "JUDGED": 2}
    shorter |= {"IN_A_BATCH": {"planar": 32, "spatial": 16}, "OF_A_THREAD": 1, "OF_A_PROCESS": 1}
    for name, value in shorter.items():
        monkeypatch.setattr(ensembles, name, value)


@pytest.fixture
def short_anti_skid(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer periods and a shorter count; tests/scenarios/test_anti_skid.py covers the others."""
    monkeypatch.setattr(anti_skid, "PERIODS", (5e-3,))
    monkeypatch.setattr(anti_skid, "TEETH", (80, 10000))
    monkeypatch.setattr(anti_skid, "BRAKE_RATIOS", anti_skid.BRAKE_RATIOS[:2])


@pytest.fixture
def short_measurements(monkeypatch: pytest.MonkeyPatch) -> None:
    """Speed and throughput are measured once and briefly, stability at fewer speeds, frictions and loads."""
    monkeypatch.setattr(timing.least, "__defaults__", (1,))
    monkeypatch.setattr(speed, "REPEATS", 1)
    monkeypatch.setattr(speed, "run_all", lambda: run_all(CASES[:1]))
    for name, value in {"REPEATS": 1, "CALLS": 1000}.items():
        monkeypatch.setattr(creep_cost, name, value)
    monkeypatch.setattr(speed, "HOST_STEPS", 500)
    monkeypatch.setattr(speed, "CALLS", 1000)
    monkeypatch.setattr(environment_throughput, "REPEATS", 1)
    few_turns = {name: (rows, 100, wanted) for name, (rows, _, wanted) in environment_throughput.MEASURED.items()}
    monkeypatch.setattr(environment_throughput, "MEASURED", few_turns)
    monkeypatch.setattr(supervision_throughput, "REPEATS", 1)
    monkeypatch.setattr(supervision_throughput, "TRAINS", 500)
    few_stops = {name: (4, wanted) for name, (_, wanted) in protected_throughput.COUNTED.items()}
    monkeypatch.setattr(protected_throughput, "COUNTED", few_stops)
    few = {level: (system, number, 64, *wanted) for level, (system, number, _, *wanted) in throughput.STOPS.items()}
    monkeypatch.setattr(throughput, "STOPS", few)
    monkeypatch.setattr(throughput, "MANY", 64)
    monkeypatch.setattr(throughput, "RAILS", {0.3: 2.0})
    monkeypatch.setattr(contact_model, "ROUNDS", 1)
    monkeypatch.setattr(contact_model, "TORQUES", contact_model.TORQUES[::8])
    monkeypatch.setattr(contact_model, "NEIGHBOURS", contact_model.NEIGHBOURS[::3])
    monkeypatch.setattr(stability_atlas, "TRIED", (0.01, 25.0, 60.0))
    monkeypatch.setattr(stability_atlas, "SPEEDS", tuple(np.geomspace(0.01, 60.0, 11).tolist()))
    monkeypatch.setattr(stability_atlas, "FRICTIONS", tuple(np.linspace(0.05, 0.6, 3).tolist()))
    monkeypatch.setattr(stability_atlas, "LOADS", tuple(np.linspace(0.25, 1.5, 3).tolist()))


@pytest.fixture
def short_vehicles(monkeypatch: pytest.MonkeyPatch) -> None:
    """Longer macro steps, whose orders are the same, and only the cleaned rail."""
    monkeypatch.setattr(vehicle_composed, "STEPS", tuple(1e-3 * n for n in (2, 2.5, 4, 5, 8, 10, 12.5, 16, 20, 25)))
    monkeypatch.setattr(vehicle_composed, "SHOWN", 2e-3)
    monkeypatch.setattr(vehicle_hunting, "SPEEDS", np.arange(10.0, 111.0, 10.0))
    monkeypatch.setattr(vehicle_anti_skid, "RAILS", vehicle_anti_skid.RAILS[1:])


@pytest.fixture
def short_track(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only cases that do not vibrate on rigid rails; tests/rbd_model/test_yielding_track.py covers the others."""
    calm = [scene for scene in flexible_track.scenes() if scene.name in ("curve 800 m", "straight, braked")]
    monkeypatch.setattr(flexible_track, "scenes", lambda: calm)
    monkeypatch.setattr(flexible_track, "SHOWN", "curve 800 m")
    monkeypatch.setattr(flexible_track, "REPEATS", 1)


@pytest.fixture
def short_thesis_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two steps, and only the stops; all of it takes a minute and a half."""
    monkeypatch.setattr(thesis_step, "RUNS", tuple(thesis_step.SHOES.values()))
    monkeypatch.setattr(thesis_step, "STEPS", (8e-4, thesis_step.CLOSER))


@pytest.fixture
def short_etcs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stops from 60 km/h; those from 140 km/h take twice the time."""
    monkeypatch.setattr(etcs_low_adhesion, "SPEED", 60.0 / 3.6)


@pytest.fixture
def short_laws(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only laws that compile in a second; tests/rbd_model/test_creep_laws.py tests the others in the same way."""
    chosen = ("Kalker, linear", "Shen, Hedrick, Elkins", "Kalker to Coulomb", "FASTSIM 5 x 5")
    monkeypatch.setattr(creep_laws, "LAWS", {name: creep_laws.LAWS[name] for name in chosen})


@pytest.fixture
def short_flange(monkeypatch: pytest.MonkeyPatch) -> None:
    """Use only the flange of the curves; test_every_flange_is_climbed_at_nadals_limit has the other two."""
    monkeypatch.setattr(flange_climb, "ANGLES", (flange_climb.CURVE_ANGLE,))


@pytest.fixture
def short_trains(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer settings of methods, shorter trains, few macro steps; tests/train covers the others."""
    few = {name: (work, settings[-1:], text) for name, (work, settings, text) in train_methods.METHODS.items()}
    explicit, implicit = train_methods.EXPLICIT, train_methods.MIDPOINT
    few[explicit] = (few[explicit][0], (train_methods.SHARE, train_methods.LYING), few[explicit][2])
    few[implicit] = (few[implicit][0], (4e-3,), few[implicit][2])
    tolerant = {name: (few[name][0], (1e-4,), few[name][2]) for name in ("CVODE", "LSODA")}
    split = {train_methods.SPLIT: (few[train_methods.SPLIT][0], (5,), few[train_methods.SPLIT][2])}
    monkeypatch.setattr(train_methods, "METHODS", few | tolerant | split)
    monkeypatch.setattr(train_methods, "FEW", (10,))
    monkeypatch.setattr(train_brake_models, "FITTED", (300.0,))
    monkeypatch.setattr(train_brake_models, "HELD", (250.0,))
    monkeypatch.setattr(train_brake_models, "SHOWN", 250.0)
    monkeypatch.setattr(train_one_vehicle_in_detail, "STEPS", (1e-3, 1e-2))
    monkeypatch.setattr(train_one_vehicle_in_detail, "LONG", 6.0)
    monkeypatch.setattr(train_one_vehicle_in_detail, "FINE", 5e-4)
    stiffest = dict(list(train_one_vehicle_in_detail.STIFFNESS.items())[-1:])
    monkeypatch.setattr(train_one_vehicle_in_detail, "STIFFNESS", stiffest)
    monkeypatch.setattr(train_brake_evidence, "DRAWS", 2)
    few_switches = {name: train_brake_evidence.SWITCHES[name] for name in list(train_brake_evidence.SWITCHES)[::5]}
    monkeypatch.setattr(train_brake_evidence, "SWITCHES", few_switches)
    last = dict(list(train_brake_evidence.MODELS.items())[-1:])
    monkeypatch.setattr(train_brake_evidence, "MODELS", last)
    monkeypatch.setattr(train_braking, "LENGTHS", (400.0, 750.0))
    monkeypatch.setattr(train_descent, "GRADIENTS", (0.021, 0.039))
    monkeypatch.setattr(train_standing, "LEAKS", train_standing.LEAKS[1:])
    monkeypatch.setattr(train_track_brakes, "FRICTIONS", (0.05,))
    monkeypatch.setattr(braking_distance, "MANY", 20_000)
    for number, count in {"VEHICLES": 20, "HOSTED": 10, "FEW": 10, "MANY": 40, "WATCHED": 5.0}.items():
        monkeypatch.setattr(train_pace, number, count)


#: Known misses by scenario; docs/checking.md states the reasons. A miss that disappears fails the test as a new one
#: does.
MISSES = {
    "asymmetric-braking": {
        *(f"rotating axis, leading, {error} %, 1 s: time to stop" for error in (25, 50)),
        *(f"rotating axis, trailing, {error} %, 1 s: time to stop" for error in (25, 50)),
        *(f"rotating axis, trailing, 75 %, {application} s: time to stop" for application in (1, 5, 10)),
    },
    "bogie-crosslevel": {"15 m/s: largest roll", "25 m/s: largest wheel load, leading wheelset"},
    "bogie-lateral": {"25 m/s: spectral peak of the hunting"},
    "bogie-lateral-under-torque": {"traction in 1 s: 20 m/s reached at"},
    "bogie-traction-braking": {"distance after 40 s"},
    "bogie-vertical": {
        "15 m/s: natural frequency in the spectrum",
        "15 m/s: forced peak",
        "25 m/s: natural frequency in the spectrum",
    },
    "contact-model": {"model 3: largest error of one state, median about the default over the tolerance"},
    "contact-manchester": {
        f"{depth}: largest miss of {quantity}"
        for depth in ("model 1, one ellipse", "model 2, ellipses that part")
        for quantity in ("the place on the rail", "the force ahead", "the force sideways")
    }
    - {
        f"model 2, ellipses that part: largest miss of {quantity}"
        for quantity in ("the place on the rail", "the force ahead")
    },
    "creep-forces": {"largest distance from exact theory, with spin"},
    # The 99 % at random states of FASTSIM and FaStrip is missed too, but short_laws leaves it out.
    "creep-laws": {"Kalker to Coulomb: spin-dominated, largest distance"},
    "vehicle-composed": {"coupled, held: error of distance at 2 ms"},  # with the steps of short_vehicles
    "wheelset-skid": {"friction 0.3: time from brake to lock"},
    "wheelset-torque": {"distance slipped while braking"},
}

#: Tolerance of the lock to which the torque was fitted [m/s, s]: 2.7 s depends on the assumed start of the brake.
FITTED_BAND = 0.1
#: Data of the 3D view of a report.
MOTION = re.compile(r'<script id="data" type="application/json">(.*?)</script>')


@pytest.mark.usefixtures("short_oracle", "short_coupling", "short_study", "short_ensembles")
@pytest.mark.usefixtures(
    "short_anti_skid",
    "short_measurements",
    "short_vehicles",
    "short_thesis_step",
    "short_etcs",
    "short_laws",
    "short_flange",
    "short_track",
    "short_trains",
)
@pytest.mark.parametrize("name", [scenario.name for scenario in SCENARIOS])
def test_scenario_holds_but_for_its_known_misses_and_leaves_table_data_and_picture(name: str, tmp_path: Path) -> None:
    status = main(["run", name, "--html", "--out", str(tmp_path)])
    files, others = {p.name for p in (tmp_path / name).iterdir()}, {"summary.json", "timeseries.csv", "report.html"}
    assert {"figure.png", *others} <= files
    assert all(name.endswith(".png") for name in files - others)
    found = summary(tmp_path, name)
    assert {"rows", "parameters", "versions", "wall_seconds", "times_real_time"} <= set(found)
    assert numbers_of_pages.moved(name, found["rows"]) == []
    missed = {row["quantity"] for row in found["rows"] if row["holds"] is False}
    assert missed == MISSES.get(name, set())
    assert status == (1 if missed else 0)
    assert found["times_real_time"] is None or found["times_real_time"] > 0
    for row in found["rows"]:
        assert set(row) == ROW_FIELDS
        if row["limits"] is None:
            assert (row["holds"], row["asked"]) == (None, "-")
        else:
            least, most = row["limits"]
            low, high = -math.inf if least is None else least, math.inf if most is None else most
            within = row["simulated"] is not None and low <= row["simulated"] <= high
            assert row["holds"] == within
    with (tmp_path / name / "timeseries.csv").open() as file:
        rows = list(csv.reader(file))
    assert all("[" in head for head in rows[0])
    assert len(rows) > 10
    assert len({len(row) for row in rows}) == 1
    assert (tmp_path / name / "figure.png").read_bytes()[:4] == b"\x89PNG"
    for data in MOTION.findall((tmp_path / name / "report.html").read_text(encoding="utf-8")):
        assert len(base64.b64decode(json.loads(data)["time"])) > 4 * 10
    assert [p.name for p in tmp_path.iterdir()] == [name]  # no partial folders


@pytest.mark.long
def test_every_flange_is_climbed_at_nadals_limit(tmp_path: Path) -> None:
    """Run the scenario without short_flange."""
    test_scenario_holds_but_for_its_known_misses_and_leaves_table_data_and_picture("flange-climb", tmp_path)


def test_known_deviations_are_on_the_page_of_checks() -> None:
    page = (Path(__file__).parents[2] / "docs" / "checking.md").read_text(encoding="utf-8")
    [table] = re.findall(r"^## Known deviations\n(.*?)^## ", page, re.MULTILINE | re.DOTALL)
    assert set(re.findall(r"^\| `([\w-]+)` \|", table, re.MULTILINE)) == set(MISSES)


def test_pythonfmu_gives_the_same_table(tmp_path: Path) -> None:
    tables = []
    for kind in ("native", "python"):
        assert main(["run", "qr30-180kpa", "--kind", kind, "--out", str(tmp_path / kind), "--step", "0.01"]) == 0
        tables.append(summary(tmp_path / kind, "qr30-180kpa")["rows"])
    assert tables[0] == tables[1]


def test_row_that_does_not_hold_gives_exit_status_1(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(qr30, "APPLICATION_TIME", 0.4)
    assert main(["run", "qr30-180kpa", "--out", str(tmp_path), "--step", "0.01"]) == 1
    rows = {row["quantity"]: row["holds"] for row in summary(tmp_path, "qr30-180kpa")["rows"]}
    assert rows["pressure 0.8 s after application"] is False


def test_fitted_torque_locks_where_it_was_fitted_to(tmp_path: Path) -> None:
    """This is a fit and not a finding, so the scenario has no verdict for it (section 8.3.3)."""
    assert main(["run", "qr30-180kpa", "--out", str(tmp_path), "--step", "0.01"]) == 0
    rows = {row["quantity"]: row for row in summary(tmp_path, "qr30-180kpa")["rows"]}
    for quantity, printed in (("fitted torque: speed at lock", 1.8), ("fitted torque: time of lock", 2.7)):
        assert rows[quantity]["holds"] is None
        assert rows[quantity]["simulated"] == pytest.approx(printed, abs=FITTED_BAND)


def test_measured_torque_history_replaces_the_cylinder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    history = tmp_path / "measured.csv"
    history.write_text("time [s],torque [N.m]\n10.0,0\n10.8,1800\n16.0,1800\n")
    arguments = ["run", "qr30-180kpa", "--torque-csv", str(history), "--out", str(tmp_path)]
    assert main(arguments) == 0
    # The brake reacts on the frame here; on the wheelset alone, as in the thesis, this torque locks at 1.8 m/s.
    assert "the trailing wheelset locked at 1.93 m/s" in capsys.readouterr().out


def test_history_too_short_to_tell_a_deceleration_says_so(tmp_path: Path) -> None:
    history = tmp_path / "short.csv"
    history.write_text("0,0\n0.001,1800\n")
    assert main(["run", "qr30-130kpa", "--torque-csv", str(history), "--out", str(tmp_path)]) == 0
    assert summary(tmp_path, "qr30-130kpa")["rows"][0]["simulated"] is None


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "it is empty. Give a table."),
        ("time,torque\n0,1\n", "must have at least 2 rows of values; it has 1."),
        ("0,1\n1,two\n", "row 2, column torque: the value must be a number; got 'two'."),
        ("0,1\n1,2,3\n", "row 2: a row must have at most 2 values"),
        ("0,1\n1,-2\n", "row 2, column torque: the value must be at least 0 N.m; got -2 N.m."),
        ("0,1\n1,nan\n", "torque must have at least 2 values; it has 1."),
        ("0,1\n0,2\n", "row 2, column time: values must grow from row to row"),
        ("\x00\xff", "the character 0 is not text."),
    ],
)
def test_bad_history_is_refused_with_its_line(
    text: str, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    history, out = tmp_path / "bad.csv", tmp_path / "out"
    history.write_text(text)
    assert main(["run", "qr30-180kpa", "--torque-csv", str(history), "--out", str(out)]) == 2
    assert sentence in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["qr30-170kpa"], "There is no scenario qr30-170kpa; did you mean qr30-1"),
        (["zzz"], "There is no scenario zzz; 'python -m bogie_braking list'"),
        (["qr30-180kpa", "--step", "0"], "--step must be from 1e-05 to 0.1 s; got "),
        (["qr30-180kpa", "--step", "-0.01"], "--step must be from 1e-05 to 0.1 s; got "),
        (["qr30-180kpa", "--step", "nan"], "--step must be from 1e-05 to 0.1 s; got "),
        (["qr30-180kpa", "--torque-csv", "missing.csv"], "The file missing.csv does not exist. Check the path."),
        (["speed", "--kind", "python"], "--kind has no effect on speed; it belongs to qr30-130kpa"),
        (["speed", "--torque-csv", "missing.csv"], "--torque-csv has no effect on speed; it belongs to qr30-130kpa"),
    ],
)
def test_bad_arguments_get_one_sentence(
    arguments: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["run", *arguments, "--out", str(out)]) == 2
    shown = capsys.readouterr().err
    assert sentence in shown
    assert shown.count("\n") == 1
    assert not out.exists()


def test_binary_file_is_not_a_history(tmp_path: Path) -> None:
    path = tmp_path / "binary.csv"
    path.write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(ValueError, match=r"binary\.csv, row 1: the column time is missing"):
        read_torque_history(path)


def test_failure_while_writing_leaves_the_old_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    name = "qr30-180kpa"
    arguments = ["run", name, "--out", str(tmp_path), "--step", "0.01"]
    assert main(arguments) == 0
    before = (tmp_path / name / "summary.json").read_text()

    def fail(*_: object, **__: object) -> None:
        raise OSError("the disk is full")

    monkeypatch.setattr(Figure, "savefig", fail)
    assert main(arguments) == 3
    words = f"Cannot write {tmp_path / name}: the disk is full. Choose another folder with --out.\n"
    assert capsys.readouterr().err.endswith(words)  # preceded by the progress of a slow computer
    assert (tmp_path / name / "summary.json").read_text() == before
    assert [p.name for p in tmp_path.iterdir()] == [name]


def test_interrupted_run_ends_with_a_sentence_and_leaves_the_old_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["run", "critical-speed", "--out", str(tmp_path)]
    assert main(arguments) == 0
    before = (tmp_path / "critical-speed" / "summary.json").read_text()

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Figure, "savefig", interrupted)
    assert main(arguments) == 130
    assert capsys.readouterr().err == f"Interrupted; what {tmp_path} held before is as it was.\n"
    assert (tmp_path / "critical-speed" / "summary.json").read_text() == before
    assert [p.name for p in tmp_path.iterdir()] == ["critical-speed"]


def test_file_in_place_of_the_results_folder_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "taken").write_text("")
    assert main(["run", "qr30-180kpa", "--out", str(tmp_path / "taken")]) == 2
    assert "is a file. Choose another folder with --out." in capsys.readouterr().err


def test_exact_forces_in_the_creep_scenario_are_the_published_ones() -> None:
    names = ("longitudinal", "lateral", "spin_1_per_m", "exact_x_N", "exact_y_N")
    rows = csv.DictReader(PUBLISHED.read_text().splitlines())
    published = {tuple(float(row[name]) for name in names) for row in rows}
    assert {tuple(row) for row in EXACT} <= published


def test_list_names_every_scenario(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    shown = capsys.readouterr().out
    assert all(scenario.name in shown and scenario.summary in shown for scenario in SCENARIOS)


def test_bounds_ask_without_a_number_in_the_column_of_the_thesis() -> None:
    for asked, good, bad, text in (
        (report.at_most(0.4), 0.4, 0.41, "<= 0.4000"),
        (report.at_least(0.8), 0.8, 0.79, ">= 0.8000"),
        (report.between(1.0, 2.0), 2.0, 2.1, "1.000 to 2.000"),
        (report.near(1.0, 0.1), 0.91, 0.89, "1.000 +- 0.1000"),
    ):
        assert Row("q", "m", None, good, asked, "s").holds is True
        assert Row("q", "m", None, bad, asked, "s").holds is False
        assert Row("q", "m", None, math.nan, asked, "s").holds is False
        assert Row("q", "m", None, None, asked, "s").holds is False
        assert text in report.table([Row("q", "m", None, good, asked, "s")])


def test_a_printed_number_is_held_to_half_of_its_last_digit() -> None:
    for printed, half in (("496", 0.5), ("20.5", 0.05), ("1.109", 5e-4), ("-1.109", 5e-4)):
        assert report.rounding(printed) == pytest.approx(half)


def test_a_table_begins_with_what_does_not_hold_and_says_where_the_rest_is(tmp_path: Path) -> None:
    others = [Row(f"other {n}", "m", None, 1.0, None, "s") for n in range(report.FEW + 2)]
    rows = [*others[:3], Row("good", "m", None, 1.0, report.near(1.0, 0.1), "s"), *others[3:]]
    rows.append(Row("bad", "m", None, 2.0, report.near(1.0, 0.1), "s"))
    shown = report.short_table(rows, tmp_path)
    quantities = re.findall(r"^(good|bad|other \d)", shown, re.MULTILINE)
    assert quantities == ["bad", "good", *(f"other {n}" for n in range(report.FEW))]
    assert f"2 more rows that are not judged: {tmp_path / 'summary.json'}" in shown
    assert "more row" not in report.short_table(rows[1:4], tmp_path)
    assert re.findall(r"^(good|bad|other \d)", report.table(rows), re.MULTILINE) == [row.quantity for row in rows]


def test_a_table_leaves_out_columns_without_a_value() -> None:
    alone, beside = Row("q", "m", None, 1.0, None, "s"), Row("q", "m", 1.0, 1.0, 0.1, "s", vampire=1.0)
    heads = "quantity", "unit", "thesis", "VAMPIRE", "simulated", "deviation", "asked", "verdict"
    assert report.table([alone]).split("\n")[0].split() == [one for one in heads if one not in report.EMPTY]
    assert report.table([alone, beside]).split("\n")[0].split() == list(heads)


def test_verdicts_are_computed() -> None:
    assert Row("q", "m", 1.0, 1.05, 0.1, "s").holds is True
    assert Row("q", "m", 1.0, 1.2, 0.1, "s").holds is False
    assert Row("q", "m", 1.0, None, 0.1, "s").holds is False  # an expected event that did not happen
    assert Row("q", "m", None, 1.2, None, "s").holds is None
    assert "DOES NOT HOLD" in report.table([Row("q", "m", 1.0, 1.2, 0.1, "s")])
