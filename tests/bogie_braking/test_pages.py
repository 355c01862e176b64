"""Result pages in a real browser: no errors, all charts, the numbers of the files, moving bodies."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bogie_braking.__main__ import main
from bogie_braking.exit_status import DOES_NOT_HOLD
from bogie_braking.reporting.html_report import pictures, sentence, together, write_report
from bogie_braking.reporting.motion import Motion, Rails, box, motion_columns
from bogie_braking.reporting.plots import single
from bogie_braking.reporting.report import Report, Row, at_most, save
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import RIGID, prepare, prepare_on_line
from rbd_model.track.line import Line, Segment, line_of
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.parameters import AS_PRINTED
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.irregularities import DURATION, INTERVAL, LATERAL, SPEEDS
from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, Page, browser

__all__ = ["browser"]  # a fixture

ROOT = Path(__file__).parents[2]
NAME, WIDE, NARROW = "bogie-lateral", 1440, 390
REPORT, INDEX = f"{NAME}/report.html", "index.html"
WORDS = {True: "\u2713 holds", False: "\u2717 does not hold", None: "\u2013 not judged"}
#: Rounding of lengths by 32-bit floats, measured from rails that are straight over 0.25 m [m].
ROUNDED = 5e-6
#: Gap of a rigid contact in the drawn section [mm], which neglects yaw and draws profiles with straight lines.
TOUCHES = 0.05
#: Half width of contact on the tread [mm]; beyond it a flange at contact model 1 is an elastic spring.
TREAD = 25.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the results of one 3D scenario, with its page and the index."""
    out = tmp_path_factory.mktemp("results")
    assert main(["run", NAME, "--html", "--out", str(out)]) == DOES_NOT_HOLD  # as docs/checking.md says
    assert main(["report", "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def opened(browser: Browser, folder: Path) -> Callable[[str, int], Page]:
    """Return a function that opens a file of the folder in a window of a given width, once each."""
    return lru_cache(lambda file, width: browser.open(folder / file, width))


@pytest.fixture
def report(opened: Callable[[str, int], Page]) -> Page:
    """Return the report as the front page, where time and mouse are active."""
    page = opened(REPORT, WIDE)
    page.call("Page.bringToFront")
    return page


@pytest.fixture(scope="module")
def summary(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / NAME / "summary.json").read_text(encoding="utf-8")))


def cut(page: Page) -> list[str]:
    """Return the elements that extend beyond the window."""
    return list(
        page.evaluate(
            """[...document.querySelectorAll("body *:not(svg *):not(#js-plotly-tester)")].filter((one) => {
                const place = one.getBoundingClientRect();
                return place.width && (place.right > innerWidth + 1 || place.left < -1);
            }).map((one) => one.outerHTML.slice(0, 80))"""
        )
    )


@pytest.mark.study
@pytest.mark.parametrize("width", [NARROW, WIDE])
@pytest.mark.parametrize("file", [REPORT, INDEX])
def test_page_needs_nothing_else_says_no_error_and_cuts_nothing(
    opened: Callable[[str, int], Page], file: str, width: int
) -> None:
    page = opened(file, width)
    page.evaluate("new Promise((done) => setTimeout(done, 300))")
    assert page.errors == []
    assert page.requests == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert cut(page) == []


@pytest.mark.study
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [NARROW, WIDE])
@pytest.mark.parametrize("file", [REPORT, INDEX])
def test_page_is_for_people_who_hear_it_or_enlarge_it_too(
    opened: Callable[[str, int], Page], file: str, width: int, scheme: str
) -> None:
    page = opened(file, width)
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
    page.evaluate("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
    dark = page.evaluate("getComputedStyle(document.documentElement).backgroundColor") != "rgb(255, 255, 255)"
    assert dark == (scheme == "dark")
    assert violations(page, "heading-order", "region") == []


@pytest.mark.study
def test_the_verdict_comes_first_the_picture_second_the_table_third(report: Page, summary: dict[str, Any]) -> None:
    shown = report.evaluate(
        """[...document.querySelectorAll("main img, #verdict, main table, main h2")].map((one) => one.id || one.alt
            || one.innerText)"""
    )
    failing = next(row["quantity"] for row in summary["rows"] if row["holds"] is False)
    assert shown[:4] == ["verdict", summary["pictures"]["figure.png"], "Thesis against simulation", "rows"]
    heads = report.evaluate("[...document.querySelectorAll('h2')].map((one) => one.innerText)")
    assert heads == ["Thesis against simulation", "Motion", "Charts", "Parameters", "Made by"]
    told = report.evaluate("document.getElementById('verdict').innerText")
    assert told == f"\u2717 1 of 3 judged rows does not hold: {failing}."


@pytest.mark.study
def test_numbers_of_the_table_are_those_of_the_summary(report: Page, summary: dict[str, Any]) -> None:
    shown = report.evaluate(
        """[...document.querySelectorAll(".rows tbody tr")].map((row) => Object.fromEntries(
            [...row.querySelectorAll("td.number data")].map((one) =>
                [one.parentNode.dataset.head, Number(one.value)])))"""
    )
    heads = {"thesis": "thesis", "VAMPIRE": "vampire", "simulated": "simulated", "deviation": "deviation"}
    judged = [row for holds in (False, True, None) for row in summary["rows"] if row["holds"] is holds]
    assert {row["holds"] for row in judged} == set(WORDS)
    for cells, row in zip(shown, judged, strict=True):
        assert cells == {head: row[key] for head, key in heads.items() if row[key] is not None}
    verdicts = report.evaluate("[...document.querySelectorAll('.rows .verdict')].map((one) => one.textContent)")
    assert verdicts == [WORDS[row["holds"]] for row in judged]


def test_charts_have_every_column_whole_and_with_its_unit(report: Page, folder: Path) -> None:
    shown = report.evaluate(
        """[...document.querySelectorAll(".chart .js-plotly-plot")].flatMap((chart) => chart.data.map((line, n) => ({
            name: line.name, unit: chart.layout.yaxis.title.text, along: chart.layout.xaxis.title.text,
            drawn: chart.querySelectorAll(".scatterlayer .trace").length === chart.data.length,
            count: chart.calcdata[n].length, sum: chart.calcdata[n].reduce((sum, { y }) => sum + y, 0)})))"""
    )
    series = Recording.read(folder / NAME / "timeseries.csv")
    heads = [f"{name} [{unit}]" for name, unit in series.units.items()]
    sums = [values.sum() for values in series.values()]
    assert {f"{line['name']} {line['unit']}" for line in shown} == set(heads[1:])
    assert len(shown) == len(heads) - 1
    for line in shown:
        assert line["drawn"]
        assert line["along"] == heads[0]
        assert line["count"] == series.rows
        assert line["sum"] == pytest.approx(sums[heads.index(f"{line['name']} {line['unit']}")], rel=1e-5, abs=1e-5)


def test_dragging_zooms_a_chart(report: Page) -> None:
    where = report.evaluate(
        """(() => { const layer = document.querySelector(".chart .nsewdrag"); layer.scrollIntoView({ block: "center" });
            const { x, y, width, height } = layer.getBoundingClientRect(); return [x, y, width, height]; })()"""
    )
    x, y, width, height = where
    begin = "document.querySelector('.chart .js-plotly-plot')._fullLayout.xaxis.range"
    before = report.evaluate(begin)
    report.drag((x + 0.25 * width, y + height / 2), (x + 0.5 * width, y + height / 2))
    first, last = report.evaluate(begin)
    span = before[1] - before[0]
    assert first == pytest.approx(before[0] + 0.25 * span, abs=0.02 * span)
    assert last == pytest.approx(before[0] + 0.5 * span, abs=0.02 * span)


def shown_at(page: Page, row: int, factor: int) -> dict[str, np.ndarray]:
    """Return the points of each vehicle part by name, with the time bar at a row; shape (3, n)."""
    page.evaluate(
        f"""["time", "exaggeration"].forEach((name, n) => {{
            const bar = document.getElementById(`${{name}}`);
            bar.value = [{row}, {factor}][n];
            bar.dispatchEvent(new Event("input"));
        }})"""
    )
    parts = page.evaluate(
        """document.getElementById("space").data.map(({ name, x, y, z }) =>
            [name, [x, y, z].map((row) => [...row])])"""
    )
    return {name: np.array(points, dtype=float) for name, points in parts}


@pytest.mark.study
def test_time_bar_moves_the_bodies_as_the_run_did(report: Page) -> None:
    """Compare with the kernel's states, which the page does not have: lateral position of a wheelset, not of rails."""
    vehicle, factor = two_axle_bogie(), 5
    scene = AS_PRINTED | {"constant_speed": 1, LATERAL.name: LATERAL.amplitude}
    kernel = prepare("bogie", **RIGID, initial_speed=SPEEDS[0], **scene)
    names = ("state_lateral_1", "rotation_1", "frame_lateral", "frame_roll")
    run = {name: np.array(values) for name, values in kernel.record(DURATION, INTERVAL, names).items()}
    count = len(report.evaluate("[...Array(1 + Number(document.getElementById('time').max)).keys()]"))
    stride = -(-run["time"].size // count)
    centre = np.mean(box(vehicle, vehicle.bodies[0])[:, 2]) - vehicle.number(vehicle.bodies[0].height)
    places = []
    for row in (0, count // 10, count // 5, count - 1):
        parts, sample = shown_at(report, row, factor), row * stride
        places.append(parts["wheelset 1"][1].mean())
        assert places[-1] == pytest.approx(factor * run["state_lateral_1"][sample], abs=factor * ROUNDED)
        aside = factor * run["frame_lateral"][sample] - centre * np.sin(factor * run["frame_roll"][sample])
        assert parts["sprung mass"][1].mean() == pytest.approx(aside, abs=1e-4)
        first = parts["wheelset 1"][:, 0] - parts["wheelset 1"].mean(axis=1)
        turned = np.arctan2(first[0], first[2]) - run["rotation_1"][sample]
        assert np.cos(turned) == pytest.approx(1.0, abs=1e-4)
    assert np.ptp(places) > factor * 5e-3


@pytest.mark.study
def test_wheels_touch_their_rails_in_the_section(report: Page, summary: dict[str, Any]) -> None:
    shifts = []
    for row in (0, 100, 110, 150):
        shown_at(report, row, 1)
        curves = report.evaluate(
            "document.getElementById('section').data.map(({ x, y }) => [[...x], [...y]])",
        )
        for rail, wheel in ((curves[0], curves[1]), (curves[2], curves[3])):
            (rail_x, rail_y), (x, y) = (np.array(sorted(zip(*curve, strict=True))).T for curve in (rail, wheel))
            inside = (rail_x > x[0]) & (rail_x < x[-1]) & (np.abs(rail_x) < TREAD)
            gap = np.interp(rail_x[inside], x, y) - rail_y[inside]
            assert abs(gap.min()) < TOUCHES
        shifts.append(curves[1][0][0])
    largest = next(row["simulated"] for row in summary["rows"] if "largest shift of the leading" in row["quantity"])
    assert np.ptp(shifts) > 0.8 * largest
    assert "kN" in report.evaluate("document.getElementById('forces').innerText")


@pytest.mark.study
def test_play_runs_and_stops(report: Page) -> None:
    shown_at(report, 0, 1)
    press = "document.getElementById('play').click()"
    state = "[Number(document.getElementById('time').value), document.getElementById('play').innerText]"
    report.evaluate(press)
    report.evaluate("new Promise((done) => setTimeout(done, 600))")
    row, word = report.evaluate(state)
    assert word == "Stop"
    assert row > 10
    report.evaluate(press)
    assert report.evaluate(state)[1] == "Play"


@pytest.mark.study
def test_index_links_to_the_report_and_marks_what_the_thesis_prints(
    opened: Callable[[str, int], Page], folder: Path, summary: dict[str, Any]
) -> None:
    page = opened(INDEX, WIDE)
    link = page.evaluate("document.querySelector('#scenarios a').href")
    assert link == (folder / NAME / "report.html").as_uri()
    marks = page.evaluate("document.querySelector('.js-plotly-plot').data.flatMap((one) => [...one.x])")
    printed = [row for row in summary["rows"] if row["thesis"] is not None]
    assert sorted(marks) == pytest.approx(sorted(row["simulated"] / row["thesis"] for row in printed))
    assert page.evaluate("document.getElementById('verdict').innerText").endswith(f"does not hold, in {NAME}.")
    cells = page.evaluate(
        "[...document.querySelectorAll('#scenarios td.number')].slice(0, 3).map((one) => one.innerText)"
    )
    verdicts = [row["holds"] for row in summary["rows"]]
    assert cells == [str(verdicts.count(word)) for word in (True, False, None)]


# -- what people write into results ----------------------------------------------------------------------------------

BREAKS = "</script><script>document.title = 'broken'</script> <b>&lt; 1 'x' \"y\" {{ 1 }}"


def nasty_report() -> Report:
    """Return a report whose strings could each end the page, with a row of each verdict and a planar motion."""
    time = np.linspace(0.0, 1.0, 11)
    series = Recording({"time": "s"}, [[instant] for instant in time])
    series.add(BREAKS, BREAKS, time)
    rows = [
        Row(BREAKS, BREAKS, 1.0, 1.0, 0.1, BREAKS, BREAKS, vampire=1.0),
        Row("fails", "m", None, 2.0, at_most(1.0), ""),
        Row("is not there", "m", 1.0, None, None, ""),
    ]
    vehicle = two_axle_bogie()
    recorded = Recording({"time": "s"}, [[instant] for instant in time])
    for name in motion_columns(vehicle):
        recorded.add(name, "m", time if name == "distance" else np.zeros(11))
    parameters = {BREAKS: BREAKS, "group": {"wheel_radius": 0.425}, "long": 99 * ["word"], "longer": 999 * "w"}
    report = Report(rows, series, lambda: single("title", "x [m]", "y [m]")[0], parameters, 0.0, [BREAKS])
    report.guids = {BREAKS: BREAKS}
    report.motion = lambda: Motion(BREAKS, vehicle, recorded)
    return report


@pytest.mark.study
def test_texts_of_a_result_are_shown_and_never_obeyed(browser: Browser, tmp_path: Path) -> None:
    scenario = Scenario("nasty", BREAKS, lambda options: nasty_report())
    report = scenario.run(Options())
    save(report, "nasty", tmp_path, 1.0, lambda report, folder: write_report(scenario, report, folder))
    page = browser.open(tmp_path / "nasty" / "report.html", NARROW)
    assert page.errors == []
    assert cut(page) == []
    assert page.evaluate("document.title") == "nasty"
    shown = page.evaluate("document.body.innerText")
    assert shown.count(BREAKS) >= 9
    assert "0.4250 m" in shown
    verdicts = page.evaluate("[...document.querySelectorAll('.rows .verdict')].map((one) => one.textContent)")
    assert verdicts == [WORDS[False], WORDS[True], WORDS[None]]
    assert page.evaluate("document.getElementById('section')") is None
    # Planar: everything is on the centre line, and the wheels' radius has its unit.
    assert abs(shown_at(page, 10, 50)["wheelset 1"][1].mean()) < ROUNDED
    assert main(["report", "--out", str(tmp_path)]) == 0
    assert browser.open(tmp_path / "index.html", WIDE).errors == []


# -- on a line -------------------------------------------------------------------------------------------------------

RADIUS, CANT, RAMP, GRADIENT = 300.0, 0.15, 60.0, 5e-3


@pytest.fixture(scope="module")
def curve() -> Motion:
    """Return a bogie in an arc to the left, up a cant ramp and a gradient; its rails are displaced by 3 mm."""
    bend, uphill = (1 / RADIUS, 1 / RADIUS), (GRADIENT, GRADIENT)
    vehicle, line = two_axle_bogie(), line_of([Segment(RAMP, bend, (0.0, CANT), uphill)])
    aside = {f"{side}_lateral": np.full_like(line.rows["distance"], 3e-3) for side in ("left", "right")}
    line = Line(line.rows | aside)
    kernel = prepare_on_line("bogie", line, level=3.0, initial_speed=10.0)
    table = kernel.record(1.0, 0.1, motion_columns(vehicle))
    return Motion(
        "in an arc", vehicle, Recording(dict.fromkeys(table, ""), list(zip(*table.values(), strict=True))), line
    )


def without_cant(points: np.ndarray, middle: float) -> np.ndarray:
    """Rotate points (3, n) back about the track's axis by the cant at their part; cant raises the right side.

    All points of a wheelset turn with its centre; rails and sleepers are lines across or along the track.
    """
    x, y, z = points
    rigid = points.shape[1] > 2 and not np.isnan(points).any()
    sine = CANT * (middle + (x.mean() if rigid else x)) / RAMP / GAUGE
    cosine = np.sqrt(1 - sine**2)
    return np.array([x, cosine * y - sine * z, sine * y + cosine * z])


@pytest.mark.study
def test_a_curve_bends_before_and_behind_the_vehicle(browser: Browser, curve: Motion, tmp_path: Path) -> None:
    """The offset is x^2 / (2 R) from its tangent, and the wheelsets turn by x / R."""
    report = Report([], curve.series, lambda: single("title", "x [m]", "y [m]")[0], {}, 1.0, motion=lambda: curve)
    scenario, factor, row = Scenario("curve", "An arc.", lambda options: report), 20, 5
    save(report, "curve", tmp_path, 1.0, lambda report, folder: write_report(scenario, report, folder))
    page = browser.open(tmp_path / "curve" / "report.html", WIDE)
    assert page.errors == []
    parts = shown_at(page, row, factor)
    told = page.evaluate("document.getElementById('line').innerText")
    assert told == "curve to the left of 300 m, cant 12 mm, gradient 5.0 \u2030"
    middle = curve.series["distance"][row]
    parts = {name: without_cant(points, middle) for name, points in parts.items()}
    count = parts["rails"].shape[1] // 2
    x, y, left = parts["rails"][:, : count - 1]  # without the gap after it
    right = parts["rails"][2, count:-1]
    assert [left, right] == [pytest.approx(0.0, abs=ROUNDED)] * 2
    half = curve.vehicle.wheelsets[0].pair.left.wheel_half_distance
    assert y == pytest.approx(half + factor * (3e-3 + x**2 / 2 / RADIUS), abs=factor * ROUNDED)
    assert np.ptp(x) > 5.0
    for number, sign in ((1, 1), (2, -1)):
        along, offset = sign * 0.8375, curve.series[f"lateral_{number}"][row]
        wheels = parts[f"wheelset {number}"]
        bend = along**2 / 2 / RADIUS
        assert wheels[1].mean() == pytest.approx(factor * (offset + 3e-3 + bend), abs=factor * ROUNDED)
        axle = wheels[:, 24] - wheels[:, 74]  # from the middle of the right wheel to that of the left one
        turned = factor * (curve.series[f"yaw_{number}"][row] + along / RADIUS)
        assert np.arctan2(-axle[0], axle[1]) == pytest.approx(turned, abs=1e-4)


def test_the_bend_of_a_transition_is_its_double_integral() -> None:
    """The result is exact for linear curvature 1e-4 x; the vehicle is 10 m on, the point 2 m behind it."""
    rails = Rails(np.array([0.0, 100.0]), {"curvature": np.array([0.0, 1e-2])})
    aside, turned = rails.bend(np.array([10.0]), -2.0)
    assert aside == pytest.approx(1e-4 * (10.0 * 2.0**2 / 2 - 2.0**3 / 6))
    assert turned == pytest.approx(1e-4 * (8.0**2 - 10.0**2) / 2)


# -- without a browser ------------------------------------------------------------------------------------------------


def test_columns_share_a_chart_with_their_like() -> None:
    series = Recording(
        {"time": "s", "distance": "m", "lateral_1": "m", "speed": "m/s", "lateral_2": "m", "none": "m"}, []
    )
    sizes = {"distance": 100.0, "lateral_1": 1e-3, "speed": 25.0, "lateral_2": 2e-2, "none": np.nan}
    for name, size in {"time": 1.0, **sizes}.items():
        series.add(name, series.units[name], np.array([0.0, -size]))
    assert list(together(series)) == [["distance"], ["lateral_1", "lateral_2"], ["speed"], ["none"]]


@pytest.mark.parametrize(
    ("verdicts", "told"),
    [
        ([None], "No row is judged."),
        ([True, None], "The only judged row holds."),
        ([True, True, None], "All 2 judged rows hold."),
        ([True, False, None], "1 of 2 judged rows does not hold: a; b."),
        ([False, False], "2 of 2 judged rows do not hold: a; b."),
    ],
)
def test_one_sentence_says_whether_all_holds(verdicts: list[bool | None], told: str) -> None:
    assert sentence([{"holds": one} for one in verdicts], ": a; b") == told


def test_pictures_have_the_sentence_of_the_summary_or_their_name(tmp_path: Path) -> None:
    for name in ("a", "figure", "map"):
        (tmp_path / f"{name}.png").write_bytes(b"")
    summary = {"scenario": "curve", "pictures": {"figure.png": "It derails.", "a.png": "It stops."}}
    assert [one["text"] for one in pictures(tmp_path, summary)] == ["It derails.", "It stops.", "Picture of curve: map"]


def test_index_shows_what_does_not_hold_first_and_what_is_not_judged_last(tmp_path: Path) -> None:
    for name, asked in {"levels": None, "bogie-pitch": at_most(2.0), "speed": at_most(0.5)}.items():
        report = nasty_report()
        report.rows = [Row("row", "m", None, 1.0, asked, "")]
        save(report, name, tmp_path, 1.0)
    assert main(["report", "--out", str(tmp_path)]) == 0
    text = (tmp_path / "index.html").read_text(encoding="utf-8")
    places = [text.index(f'<a href="{name}/') for name in ("speed", "bogie-pitch", "levels")]
    assert places == sorted(places)
    assert "1 of 2 judged rows does not hold, in speed." in text


@pytest.mark.study
def test_what_pages_need_is_imported_for_pages_alone() -> None:
    asked = (
        "import sys; from bogie_braking import commands; [commands.module_of(name) for name in commands.COMMANDS]; "
        "print([name for name in ('plotly', 'jinja2') if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", asked], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_no_results_are_refused_with_a_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "--out", str(tmp_path)]) == 2
    assert f"There are no results in {tmp_path}; run a scenario first" in capsys.readouterr().err


#: An incomplete row and an incomplete sweep.
BARE_RUN = '{"scenario": "levels", "rows": [{"holds": true}], "wall_seconds": 1.0}'
BARE_SWEEP = '{"sweep": "levels", "vary": {"level": []}, "units": {"level": "1"}, "points": 0, "failed": 0}'


@pytest.mark.study
@pytest.mark.parametrize(
    ("file", "text", "reason"),
    [
        ("summary.json", '{"scenario": "levels", "ro', "summary.json must be JSON; got a fault in line 1, column 24"),
        ("summary.json", "\x00", "summary.json must be JSON"),
        ("summary.json", "[]", "summary.json must be an object"),
        ("summary.json", "{}", "summary.json must have scenario; got nothing"),
        ("summary.json", BARE_RUN, "summary.json, row 1 must have quantity; got holds"),
        ("summary.json", BARE_SWEEP, "summary.json: vary level must be a list of numbers; got []"),
        ("journal.jsonl", "{}\n", "its sweep has not come to its end, and the same command goes on from there"),
        ("holiday.txt", "sun", "it has no summary.json"),
    ],
)
def test_what_is_neither_run_nor_sweep_is_named_and_left_and_the_rest_is_shown(
    file: str, text: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / file).write_text(text)
    assert main(["report", "--out", str(tmp_path)]) == 2
    assert "There are no results in" in capsys.readouterr().err
    save(nasty_report(), "nasty", tmp_path, 1.0)
    assert main(["report", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.startswith(f"{tmp_path / 'other'} is not shown: ")
    assert reason in said
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert reason in page
    assert 'href="nasty/figure.png"' in page
    assert (tmp_path / "other" / file).read_text() == text


def test_what_is_being_written_is_not_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("nasty", ".nasty-abc"):
        save(nasty_report(), name, tmp_path, 1.0)
    assert main(["report", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().err == ""
    assert ".nasty" not in (tmp_path / "index.html").read_text(encoding="utf-8")
