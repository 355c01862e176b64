"""Reports on wheel-slide controllers: criteria at their limits, broken controllers, files that are refused, checks."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bogie_braking.__main__ import main
from bogie_braking.controllers.acceptance import (
    ACCEPTED,
    FAILS,
    OPEN,
    PASSES,
    REJECTED,
    STOPS,
    UNDECIDED,
    CaseResult,
    on_dry_rail,
    verdict_of,
)
from bogie_braking.controllers.acceptance import findings as found_in
from bogie_braking.controllers.report_text import NO_CLAIM, headline, lines
from bogie_braking.controllers.scoring import ScoredController
from products.protection.criteria import CRITERIA, MEASURES, Criterion, check_scopes, read_criteria
from products.protection.programme import OWN, Case, read_programme
from products.protection.runs import Stop
from products.protection.spread import Draw
from rbd_model.track.line import Line

#: A stop of 100 m from which each value is changed alone; ideal and dry rail have 100 m and a filling of 0.02 kg.
STOP = Stop(100.0, 0.01, 20.0, 0.0, 0.0, 1.0, 0.1, (1e3, 1e3), 400e3, 0, "")
DRY = replace(STOP, air=0.02)
#: Limit of each measure, a stop that just passes and one that just fails. A kilogram of air is 829.9 l: 287 J/(kg K)
#: times 293 K over 101325 Pa. A flat of 40 mm: 12 mm, and a skid of 56.47 m with 8 x 0.46 m x 55e-3 / 7850 of growth.
LIMITS: dict[str, tuple[str, float, Mapping[str, Any], Mapping[str, Any]]] = {
    "over_ideal": ("most", 1.25, {"distance": 125.0}, {"distance": 125.1}),
    "over_dry": ("most", 1.25, {"distance": 125.0}, {"distance": 125.1}),
    "in_band": ("least", 0.8, {"share_in_band": 0.8}, {"share_in_band": 0.799}),
    "air": ("most", 100.0, {"air": 0.1204}, {"air": 0.1206}),
    "fillings": ("most", 30.0, {"air": 0.5999}, {"air": 0.6001}),
    "sliding": ("most", 100.0, {"sliding": (1e3, 2e5)}, {"sliding": (1e3, 2.002e5)}),
    "longest_lock": ("most", 0.4, {"longest_lock": 0.4}, {"longest_lock": 0.405}),
    "longest_vent": ("most", 10.0, {"longest_vent": 10.0}, {"longest_vent": 10.005}),
    "flat": ("most", 40.0, {"longest_skid": 56.4}, {"longest_skid": 56.6}),
    "reservoir": ("least", 150.0, {"lowest_reservoir": 150e3}, {"lowest_reservoir": 149.9e3}),
    "commands": ("most", 0.0, {"commands": 0}, {"commands": 1}),
    "jerk": ("most", 2.0, {"jerk": 2.0}, {"jerk": 2.01}),
}
VENTS = """#include "wheel_slide.h"
size_t wheel_slide_size(int wheelsets) { (void)wheelsets; return sizeof(int); }
void wheel_slide_start(void *memory, int wheelsets, double period) { (void)period; *(int *)memory = wheelsets; }
void wheel_slide_step(void *memory, double time, const double *wheel_speed, int *valve)
{
    (void)time;
    (void)wheel_speed;
    for (int i = 0; i < *(int *)memory; ++i) valve[i] = COMMAND;
}
"""
CASES = """
[[case]]
name = "dry"
group = "no sliding"
rail = "dry"
speed = "36km/h"

[[case]]
name = "low"
group = "low"
rail = "low"
speed = "36km/h"
"""
CRITERION = """
[[criterion]]
name = "distance"
measure = "over_ideal"
most = 1.25
unit = "1"
groups = ["low"]
source = "assumed"
"""


def result(name: str = "low", **changes: Any) -> CaseResult:
    case = Case(name, "low", group=name)
    return CaseResult(case, ScoredController(name, "mine", replace(STOP, **changes), 0.46, 100.0, 100.0), DRY)


def drawn(*distances: float) -> CaseResult:
    """Return a case with these distances in its draws, without spreads of friction and load."""
    stops = tuple(replace(STOP, distance=one) for one in distances)
    mean = sum(distances) / len(distances)
    draws = (Draw(1.0, 1.0, (), 1),) * len(stops)
    score = ScoredController("low", "mine", replace(STOP, distance=mean), 0.46, 100.0, 100.0, stops=stops, draws=draws)
    return CaseResult(Case("low", "low"), score, DRY)


@pytest.mark.parametrize("measure", MEASURES)
def test_each_measure_passes_at_its_limit_and_fails_beyond(measure: str) -> None:
    kind, limit, good, bad = LIMITS[measure]
    criterion = Criterion(f"limit of {measure}", measure, limit, kind == "most")
    [_, one] = found_in([result(**good)], [criterion], 1)
    assert (one.verdict, verdict_of([one])) == (PASSES, ACCEPTED)
    [_, other] = found_in([result(**bad)], [criterion], 1)
    assert (other.verdict, verdict_of([other])) == (FAILS, REJECTED)
    said = headline("mine", [other], [criterion])
    assert said.startswith(f"rejected: mine fails 1 of 2 criteria: limit of {measure} ")
    assert f", at {kind} {limit:g}" in said
    assert said.endswith("(in the case low).")


@pytest.mark.parametrize("criterion", read_criteria(CRITERIA), ids=lambda one: one.name.replace(" ", "-"))
def test_each_criterion_that_comes_along_rejects_beyond_its_limit(criterion: Criterion) -> None:
    """The stop is scaled from that of LIMITS: a value at the limit passes, a value 1 % beyond it fails."""
    beyond = 1.01 if criterion.at_most else 0.99
    names = {
        "over_ideal": "distance",
        "over_dry": "distance",
        "in_band": "share_in_band",
        "reservoir": "lowest_reservoir",
    }
    name = names.get(criterion.measure, criterion.measure)
    unit = {"distance": 100.0, "lowest_reservoir": 1e3}.get(name, 1.0)
    if criterion.measure == "fillings":
        name, unit = "air", 0.02
    if criterion.measure == "flat":
        name, unit = "longest_skid", 56.47 / criterion.limit
    for factor, wanted in ((1.0, PASSES), (beyond, FAILS)):
        if criterion.measure == "commands":
            value: float = criterion.limit + (factor > 1.0)
        else:
            value = criterion.limit * unit * factor * (0.9999 if wanted == PASSES and criterion.at_most else 1.0)
        scope = replace(criterion, groups=(), cases=())
        assert found_in([result(**{name: value})], [scope], 1)[1].verdict == wanted, (criterion, value)


def test_an_interval_that_holds_the_limit_decides_nothing() -> None:
    """Distances of 124 and 126 in turn: mean 125, deviation 1.069, so that the half width is 2.365 x 1.069 / 8^0.5."""
    criterion, four = Criterion("distance", "over_ideal", 1.25, True), (124.0, 126.0) * 4
    [_, one] = found_in([drawn(*four)], [criterion], 1)
    assert one.value == pytest.approx(1.25)
    assert one.half == pytest.approx(0.00894, abs=1e-5)
    assert (one.verdict, verdict_of([one])) == (UNDECIDED, OPEN)
    verdicts = [found_in([drawn(*(of + by for of in four))], [criterion], 1)[1].verdict for by in (-0.88, -0.90, 0.90)]
    assert verdicts == [UNDECIDED, PASSES, FAILS]
    [_, wider] = found_in([drawn(*four)], [criterion], 4)
    assert wider.half > 1.3 * one.half  # of all looks together


def test_the_worst_draw_decides_where_no_mean_does() -> None:
    stops = tuple(replace(STOP, commands=of) for of in (0, 0, 0, 1))
    score = ScoredController("low", "mine", STOP, 0.46, 100.0, 100.0, stops=stops)
    [_, one] = found_in([CaseResult(Case("low", "low"), score, DRY)], [Criterion("a", "commands", 0.0, True)], 1)
    assert (one.value, one.verdict) == (1.0, FAILS)


def test_a_stop_that_does_not_end_rejects_and_one_without_an_answer_does_not() -> None:
    criteria = [Criterion("distance", "over_ideal", 1.25, True)]
    [stops, distance] = found_in([result(distance=None, message="It did not stop: 3.0 m/s after 300 s.")], criteria, 1)
    assert (stops.criterion, stops.verdict, distance.verdict) == (STOPS, FAILS, UNDECIDED)
    said = headline("mine", [stops, distance], criteria)
    assert said == (
        "rejected: mine fails 1 of 2 criteria: stops: It did not stop: 3.0 m/s after 300 s (in the case low)."
    )
    silent = found_in([result(distance=None, judged=False, message="It gave no answer.")], criteria, 1)
    assert verdict_of(silent) == OPEN


def test_the_table_has_the_worst_case_of_each_criterion() -> None:
    criteria = [Criterion("distance", "over_ideal", 1.25, True), Criterion("slip", "in_band", 0.8, False)]
    both = [result("a", distance=130.0, share_in_band=0.9), result("b", distance=140.0, share_in_band=0.5)]
    text = "\n".join(lines("mine", found_in(both, criteria, 1), criteria))
    assert text.startswith(
        "rejected: mine fails 2 of 3 criteria: distance 1.4, at most 1.25 (in the case b); slip 0.5,"
    )
    assert "No claim of conformity" in text
    assert re.search(r"^distance +at most 1\.25 +2 +2 +0 +1\.4 +- +b +fails$", text, re.MULTILINE)
    assert re.search(r"^slip +at least 0\.8 +2 +1 +0 +0\.5 +- +b +fails$", text, re.MULTILINE)
    assert re.search(r"^stops +in every draw +2 +0 +0 +- +- +- +passes$", text, re.MULTILINE)
    assert re.search(r"^a +distance +1\.3 +- +at most 1\.25 +fails$", text, re.MULTILINE)


def test_criteria_and_cases_that_come_along_belong_together() -> None:
    criteria, cases = read_criteria(CRITERIA), read_programme(OWN)
    check_scopes(criteria, cases)
    alone = [case.name for case in cases if not any(one.holds_for(case) for one in criteria)]
    assert alone == []
    assert {one.measure for one in criteria} <= LIMITS.keys() == MEASURES.keys()
    by_name = {one.name: one for one in criteria}
    assert by_name["distance"].holds_for(next(case for case in cases if case.name == "low, 200 km/h"))
    assert not by_name["distance"].holds_for(next(case for case in cases if case.name == "dry"))


def test_the_dry_rail_of_a_case_keeps_its_brake_and_loses_its_faults() -> None:
    cases = {case.name: on_dry_rail(case) for case in read_programme(OWN)}
    soaped, dragging = cases["40 m of soap on a wet rail"], cases["low, dragging down a gradient of 3 %"]
    assert (soaped.rail, soaped.values, soaped.friction) == ("dry", (), None)
    assert (dragging.brake_ratio, dragging.values) == (0.6, (("gradient", -0.03),))
    assert cases["low, valve 1 sticks at 6 s"].faults == ()
    assert cases["water, 120 km/h"].friction is None
    rows = {"distance": np.array([0.0, 100.0]), "gradient": np.array([0.01, 0.01])}
    on_line = on_dry_rail(Case("a", "low", line=Line(rows | {"left_friction": np.array([0.5, 0.5])})))
    assert on_line.line == Line(rows)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            ("over_ideal", "over_ideel"),
            "criterion 1 (distance): measure must be a known one; got over_ideel; did you mean",
        ),
        (("most = 1.25", ""), "give either most or least as the limit; got neither."),
        (("most = 1.25", "most = 1.25\nleast = 1.0"), "give either most or least as the limit; got most and least."),
        (("most = 1.25", "most = '1.25'"), "most must be a number; got '1.25'."),
        (("most = 1.25", "most = -1"), "most must be at least 0; got -1."),
        (('unit = "1"', 'unit = "%"'), "unit of over_ideal must be 1; got %."),
        (('unit = "1"', ""), "unit of over_ideal must be 1; got nothing."),
        (('source = "assumed"', ""), "give the source of the limit, or source = 'assumed'."),
        (('["low"]', '"low"'), "give groups a list of names, as in groups = ['low']; got low."),
        (('["low"]', "[]"), "give groups a list of names, as in groups = ['low']; got []."),
        (("groups", "group"), "there is no group; did you mean groups?"),
        (
            ('["low"]', '["lov"]'),
            "The criterion distance is for the group lov, which no case has; did you mean low? Give",
        ),
        (
            ('groups = ["low"]', 'cases = ["a"]'),
            "The criterion distance is for the case a, which no case has; the groups",
        ),
        ((CRITERION, 2 * CRITERION), "2 of [[criterion]] are called distance; give each its own name."),
        ((CRITERION, ""), "has no [[criterion]]; give it one for each limit."),
    ],
)
def test_criteria_that_cannot_be_are_refused_in_a_sentence(
    change: tuple[str, str], sentence: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "limits.toml").write_text(CRITERION.replace(*change))
    assert main(["controllers", "report", "--programme", "cases.toml", "--criteria", "limits.toml"]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.count("\n") == 1


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Change to a folder with two short cases, a criterion, and two broken controllers."""
    (tmp_path / "never.c").write_text(VENTS.replace("COMMAND", "WHEEL_SLIDE_APPLY"))
    (tmp_path / "always.c").write_text(VENTS.replace("COMMAND", "WHEEL_SLIDE_VENT"))
    (tmp_path / "cases.toml").write_text(CASES)
    (tmp_path / "limits.toml").write_text(CRITERION)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.study
def test_broken_controllers_are_rejected_by_the_name_of_the_criterion(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ["controllers", "report", "--programme", "cases.toml", "--criteria", "limits.toml", "--draws", "2"]
    assert main([*given, "never.c"]) == 1
    shown = capsys.readouterr().out
    assert re.match(r"rejected: never fails 1 of 2 criteria: distance 1\.4\d+ ± [\d.e-]+, at most 1\.25 \(in ", shown)
    assert NO_CLAIM[:40] in shown
    (folder / "limits.toml").write_text(CRITERION.replace("1.25", "2.0"))
    assert main([*given, "never.c"]) == 0
    assert capsys.readouterr().out.startswith("accepted: never passes all 2 criteria in 2 cases.")
    assert main([*given, "--draws", "1", "always.c"]) == 1
    shown = capsys.readouterr().out
    assert shown.startswith("rejected: always fails 1 of 2 criteria: stops: It did not stop: 10.0 m/s after 300 s (in")


#: Broken controllers with their cases: one that releases the brake for 12 s and applies it for 12 s in turn, and one
#: that empties and fills the cylinders every 0.6 s. The built-in criteria that each of them fails.
SLOW = ("(int)(time / 12.0) % 2 ? WHEEL_SLIDE_APPLY : WHEEL_SLIDE_VENT", ("dry", "low"))
FAST = ("(int)(time / 0.6) % 2 ? WHEEL_SLIDE_VENT : WHEEL_SLIDE_APPLY", ("low", "small reservoir"))
DISTANCES = {"distance", "distance over dry", "distance in degraded mode", "no harm to the distance", "no valve moves"}
FAILED = {
    SLOW: {*DISTANCES, "lock", "lock in degraded mode", "watchdog", "slip", "flats", "jerk"},
    FAST: {*DISTANCES, "air", "reservoir"},
}
SHORT_SUITE = {
    "dry": 'rail = "dry"',
    "low": 'rail = "low"',
    "small reservoir": 'rail = "dry"\nspeed = "10km/h"\n'
    "values = { initial_reservoir_pressure = 250e3, feed_orifice = 0.0 }",
}


@pytest.mark.study
@pytest.mark.parametrize("controller", FAILED, ids=["slow", "fast"])
def test_stops_of_broken_controllers_fail_built_in_criteria_by_their_names(
    controller: tuple[str, tuple[str, ...]], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command, cases = controller
    (folder / "broken.c").write_text(VENTS.replace("(void)time;", "").replace("COMMAND", command))
    tables = [f'[[case]]\nname = "{name}"\nsource = "assumed"\n{SHORT_SUITE[name]}\n' for name in cases]
    (folder / "cases.toml").write_text("\n".join(tables))
    everywhere = re.sub(r"(?s)groups = \[.*?\]", "", CRITERIA.read_text(encoding="utf-8"))
    (folder / "limits.toml").write_text(everywhere)
    given = "controllers report broken.c --programme cases.toml --criteria limits.toml --draws 1 --json"
    assert main(given.split()) == 1
    found = json.loads(capsys.readouterr().out)["findings"]
    assert {one["criterion"] for one in found if one["verdict"] == FAILS} == FAILED[controller]


def test_every_built_in_criterion_is_failed_by_a_broken_controller() -> None:
    """Besides STOPS, which a controller that always vents fails."""
    assert set.union(*FAILED.values()) == {one.name for one in read_criteria(CRITERIA)}


@pytest.mark.study
@pytest.mark.parametrize(("seconds", "status"), [("9.998", 0), ("10.003", 1)])
def test_a_brake_that_is_kept_released_for_longer_than_the_watchdog_allows_rejects(
    seconds: str, status: int, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Valves vent in 2000 periods of 5 ms, which are 10 s, or in one more; then the brake applies."""
    vents = VENTS.replace("(void)time;", "").replace(
        "COMMAND", f"time < {seconds} ? WHEEL_SLIDE_VENT : WHEEL_SLIDE_APPLY"
    )
    (folder / "late.c").write_text(vents)
    watchdog = next(one for one in read_criteria(CRITERIA) if one.measure == "longest_vent")
    table = CRITERION.replace('"distance"', f'"{watchdog.name}"').replace("over_ideal", watchdog.measure)
    (folder / "limits.toml").write_text(
        table.replace("1.25", f"{watchdog.limit:g}").replace('unit = "1"', 'unit = "s"')
    )
    given = ["controllers", "report", "--programme", "cases.toml", "--criteria", "limits.toml", "--draws", "1"]
    assert main([*given, "late.c"]) == status
    said = "rejected: late fails 1 of 2 criteria: watchdog 10.01 s, at most 10 s (in the case low)."
    assert capsys.readouterr().out.startswith(said if status else "accepted: late passes all 2 criteria in 2 cases.")


@pytest.mark.study
def test_a_report_is_reproduced_from_its_own_options(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    given = ["--programme", "cases.toml", "--criteria", "limits.toml", "--draws", "2", "--pulses", "80", "--seed", "3"]
    assert main(["controllers", "report", "never.c", *given, "--json"]) == 1
    made = json.loads(capsys.readouterr().out)
    assert (made["verdict"], made["claim"]) == ("rejected", NO_CLAIM)
    assert {key: of["file"] for key, of in made["inputs"].items()} == {
        "controller": "never.c",
        "programme": "cases.toml",
        "criteria": "limits.toml",
    }
    path = folder / "results" / "controllers" / "report.json"
    assert json.loads(path.read_text()) == made
    check = ["controllers", "report", "--check", str(path)]
    assert main(check) == 0
    assert (
        "report.json is reproduced: files, sources, verdict, 3 findings and all stops are equal."
        in capsys.readouterr().out
    )
    path.write_text(json.dumps(made | {"findings": [*made["findings"][:2], made["findings"][2] | {"value": 1.6}]}))
    assert main(check) == 1
    assert "is not reproduced. distance, low: fails with 1.6 in the report, fails with 1." in capsys.readouterr().out
    for part in ("message", "controller", "claim"):
        path.write_text(json.dumps(made | {part: "another"}))
        assert main(check) == 1
        assert f"is not reproduced. {part}: another in the report, " in capsys.readouterr().out
    path.write_text(json.dumps(made | {"cases": []}))
    assert main(check) == 1
    limits = json.loads(json.dumps(made["criteria"]))
    limits[0]["limit"] = 1000.0
    path.write_text(json.dumps(made | {"criteria": limits}))
    assert main(check) == 1
    assert "criteria 1, limit: 1000.0 in the report, " in capsys.readouterr().out
    path.write_text(json.dumps(made))
    assert main([*check, "--vehicle", "coach", "--pulses", "10"]) == 2
    assert "--check takes all options from the report; got --vehicle, --pulses." in capsys.readouterr().err
    (folder / "never.c").write_text("int other;\n")  # would not run
    assert main(check) == 1
    assert "is not reproduced. controller: never.c has another SHA-256." in capsys.readouterr().out
    path.write_text(json.dumps(made | {"arguments": [3]}))
    assert main(check) == 2
    assert "arguments must be strings; got 3." in capsys.readouterr().err
