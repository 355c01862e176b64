"""The live page in a real browser: controls, figures, links; its kernel and protection against Python."""

from __future__ import annotations

import csv
import io
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from bogie_braking.live.machines import MACHINES, model_of
from bogie_braking.live.page import write_page
from bogie_braking.live.presets import PERIOD, PRESETS
from brake_controller.sensors import TIMER
from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, Page, browser
from tests.bogie_braking.live_run import Run

__all__ = ["browser"]

#: Start values here: wheels that slide; at level 3 a curve downhill over a wave, with uneven shoes.
FRICTION = 0.08
START = {
    1: {"gradient": -5},
    2: {"gradient": -5},
    3: {"gradient": -5, "curve": 500, "wave": 5, "uneven": 10},
}
ACTIONS = ((0, "lever", 100.0), (0, "leaves", 1.0))
#: Reference values of outputs that may be small: forces of contacts, loads [N].
NOMINAL = {"lateral_force": 1e3, "flange_force": 1e3, "guiding_force": 1e3, "creep_force": 1e3}
#: Samples of a stop without protection (20 s) and with it (8 s), where valves amplify rounding over time.
STEPS = {False: round(20 / PERIOD), True: round(8 / PERIOD)}
#: Resolution of the wheel sensors' timers [s], so fine that it does not amplify rounding.
FINE_TIMER = 1e-12
#: Relative rounding difference of two mathematical libraries. If valves react to the wheels, it grows to the allowed
#: local error, the default `tolerance`.
BANDS = {False: 1e-9, True: 1e-6}
#: Largest difference of an output beyond its tolerance, as a multiple of the spread of Python's own runs with friction
#: changed by ROUNDING. In a third of such runs the error control makes one step more or less, which moves a flange's
#: force by 5e-5 N instead of 1e-6.
MORE = 10.0
ROUNDING = tuple(sign * share * 10.0**-digits for digits in (15, 14, 13) for share in (1, 3) for sign in (1, -1))
#: Largest download for a telephone [bytes].
LARGEST = 3 * 2**20
GRAVITY = 9.81
#: Width and height of windows [pixels].
SIZES = [(1440, 900), (390, 844)]


#: Actions of a user, and the drive of `Run`, in JavaScript.
HANDS = f"""
function move(values) {{
  for (const [name, value] of Object.entries(values)) {{
    const control = document.getElementById(name);
    if (typeof value === "boolean") control.checked = value; else control.value = value;
    for (const event of ["input", "change"]) control.dispatchEvent(new Event(event));
  }}
}}
const isLocked = () => live.simulation.read("locked").includes(1);
async function played(start, actions, steps, outputs) {{
  const link = new URLSearchParams({{ ...start, do: actions.map((one) => one.join(":")).join(",") }});
  const {{ resolution }} = DATA.sensor;
  DATA.sensor.resolution = {FINE_TIMER};
  await openLink(`#${{link}}`);
  live.running = false;
  DATA.sensor.resolution = resolution;
  let vented = 0;
  for (let step = 0; step < steps; step += 1) {{
    live.simulation.advance({PERIOD});
    vented += live.simulation.valves.filter((valve) => valve === VENT).length;
  }}
  return {{ vented, values: outputs.map((output) => live.simulation.kernel.get(output)) }};
}}
async function stopped(link) {{
  await openLink(link);
  live.running = false;
  while (!live.simulation.ended) live.simulation.advance({PERIOD});
  followPlan();
  finish();
  return at("result").firstChild.textContent;
}}
async function commandsOnDryRail(machine, level) {{
  await openLink(`#machine=${{machine}}&level=${{level}}&do=0:lever:50,{round(3 / PERIOD)}:lever:100`);
  live.running = false;
  let commands = 0;
  while (!live.simulation.ended) {{
    live.simulation.advance({PERIOD});
    commands += live.simulation.valves.filter((valve) => valve !== APPLY).length;
  }}
  return [commands, live.simulation.kernel.get("speed")];
}}
"""


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_page(tmp_path_factory.mktemp("live") / "live.html")


def opened(browser: Browser, file: Path, width: int, height: int = 900, link: str = "") -> Iterator[Page]:
    page = browser.open(file, width, height, link)
    page.evaluate(HANDS)
    page.evaluate("live.ready")
    yield page
    page.close()
    assert page.errors == []
    assert page.requests == []


@pytest.fixture(scope="module", params=SIZES, ids=str)
def page(browser: Browser, file: Path, request: pytest.FixtureRequest) -> Iterator[Page]:
    yield from opened(browser, file, *request.param)


@pytest.fixture(scope="module")
def still(browser: Browser, file: Path) -> Iterator[Page]:
    """Yield a page that does not run by itself."""
    for page in opened(browser, file, 800):
        page.evaluate("live.running = false")
        yield page


@pytest.mark.study
def test_the_page_is_small(file: Path) -> None:
    assert file.stat().st_size <= LARGEST


@pytest.mark.study
def test_brake_and_main_chart_are_on_the_first_screen(page: Page) -> None:
    for name in ("brake", "lever", "chart-speed", "result", "presets"):
        assert page.evaluate(f"at('{name}').getBoundingClientRect().bottom <= innerHeight"), name
    assert "Press Brake" in page.evaluate("at('result').textContent")


@pytest.mark.study
def test_the_lever_brakes_and_wheels_lock(page: Page) -> None:
    """The controls are moved as by a user: without protection wheels lock; charts move."""
    page.evaluate("openLink('')")
    page.evaluate(f"move({{ pace: 4, friction: {FRICTION}, protection: false, lever: 100 }})")
    moved = "chart.toDataURL() !== before"
    page.evaluate("globalThis.chart = at('chart-speed'), globalThis.before = chart.toDataURL(), null")
    page.evaluate(f"new Promise((found) => setInterval(() => isLocked() && {moved} && found(), 50))")
    assert page.evaluate("live.simulation.history.at(-1).speed") < 90.0
    page.evaluate(
        "new Promise((found) => setInterval(() => at('messages').textContent.includes('locked') && found(), 50))"
    )
    assert "times real time on this machine" in page.evaluate("showCost() ?? at('cost').textContent")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.study
def test_the_space_bar_brakes_releases_and_begins_anew(page: Page) -> None:
    page.evaluate("openLink('').then(() => document.activeElement.blur())")
    for word, lever in (("Release", 100), ("Brake", 0), ("Release", 100)):
        page.press(" ")
        assert page.evaluate("[at('brake-word').textContent, at('lever').value]") == [word, str(lever)]
    page.evaluate("live.running = false; while (!live.simulation.ended) live.simulation.advance(1); showControls()")
    assert page.evaluate("at('brake-word').textContent") == "New run"
    page.press(" ")
    page.evaluate("new Promise((found) => setInterval(() => live.simulation.time < 5 && found(), 20))")
    assert page.evaluate("[at('brake-word').textContent, at('lever').value]") == ["Brake", "0"]


@pytest.mark.study
def test_the_keyboard_reaches_everything(page: Page) -> None:
    page.evaluate("openLink('#level=3').then(() => { at('more').open = true; document.activeElement.blur() })")
    interactive = (
        "[...document.querySelectorAll('button, select, input, summary, a[href]')].filter((one) => !one.disabled)"
    )
    count = page.evaluate(f"{interactive}.length")
    page.evaluate(
        "globalThis.reached = new Set(); document.addEventListener('focusin', ({ target }) => reached.add(target))"
    )
    for _ in range(count + 1):
        page.press("Tab")
    assert (
        page.evaluate(f"{interactive}.filter((one) => !reached.has(one)).map((one) => one.id || one.textContent)") == []
    )


@pytest.mark.study
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_hard_to_read_or_to_use(page: Page, scheme: str) -> None:
    page.prefer(scheme)
    page.evaluate("openLink('#level=3&foo=1&do=0:lever:100').then(() => { at('more').open = true })")
    assert violations(page, "heading-order") == []
    page.prefer("light")


def test_pictures_for_the_documentation(page: Page) -> None:
    """Locked wheels, after a run with the full brake; optionally writes the figures of the documentation."""
    for name in ("full", "locks"):
        page.evaluate(f"stopped('#{PRESETS[name].link}')")
        page.evaluate("draw()")
    if "BOGIE_BRAKING_PICTURES" in os.environ:
        page.screenshot(Path(os.environ["BOGIE_BRAKING_PICTURES"]) / f"live-{page.evaluate('innerWidth')}.png")
    assert re.match(
        r"127\.\d m longer than the run before \(other friction, protection\)\.",
        page.evaluate("at('result').lastChild.textContent"),
    )


@pytest.mark.study
def test_a_page_that_stands_still_costs_nothing(still: Page) -> None:
    """A paused page draws nothing until a control moves."""
    frames = (
        "new Promise((done) => { let n = 0; const on = () => (n++ < 20 ? requestAnimationFrame(on) : done()); on(); })"
    )
    still.evaluate(f"globalThis.drawn = 0, live.side.draw = () => {{ drawn += 1; }}, {frames}")
    still.evaluate(f"drawn = 0, {frames}")
    assert still.evaluate("drawn") == 0
    still.evaluate(f"move({{ friction: {FRICTION} }}), {frames}")
    assert 0 < still.evaluate("drawn") < 10


@pytest.mark.study
@pytest.mark.parametrize("protection", [False, True])
@pytest.mark.parametrize("level", [1, 2, 3])
@pytest.mark.parametrize("name", MACHINES)
def test_the_page_computes_what_python_does(
    still: Page, name: str, level: int, protection: bool, tmp_path: Path
) -> None:
    """A stop with leaves, at level 3 over a wave in a curve: all outputs, and the number of valve commands."""
    outputs = [variable.name for variable in model_of(name).variables if variable.causality == "output"]
    start = {"machine": name, "level": level, "friction": FRICTION, "protection": int(protection), **START[level]}
    steps = STEPS[protection]
    found = still.evaluate(f"played({json.dumps(start)}, {json.dumps(ACTIONS)}, {steps}, {outputs})")

    def by_python(friction: float) -> tuple[int, np.ndarray]:
        run = Run({**start, "friction": friction}, ACTIONS, tmp_path, FINE_TIMER)
        for _ in range(steps):
            run.step()
        return run.vented, np.array([run.kernel[output] for output in outputs])

    vented, exact = by_python(FRICTION)
    assert found["vented"] == vented
    assert (vented > 10) == protection
    sizes = np.maximum(np.abs(exact), [NOMINAL.get(output.rstrip("_1234"), 1.0) for output in outputs])
    off = np.abs(found["values"] - exact)
    if not (off <= BANDS[protection] * sizes).all():
        rounded = [by_python(FRICTION * (1.0 + one))[1] for one in ROUNDING]
        allowed = np.maximum(BANDS[protection] * sizes, MORE * np.abs(rounded - exact).max(axis=0))
        assert [row for row in zip(outputs, off, allowed, strict=True) if not row[1] <= row[2]] == []


@pytest.mark.study
@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_ends_as_the_native_kernel_does(still: Page, name: str, tmp_path: Path) -> None:
    """Its final message agrees to 0.1 % in distance, and to 0.1 s in the longest lock."""
    sentence = still.evaluate(f"stopped('#{PRESETS[name].link}')")
    run = Run(PRESETS[name].start, PRESETS[name].actions, tmp_path, TIMER)
    distance = run.stop()
    found = re.match(r"Stopped in ([\d.]+) m and ([\d.]+) s from \d+ km/h; (.*?)\.( |$)", sentence)
    assert found, sentence
    assert float(found[1]) == pytest.approx(distance, rel=1e-3)
    locked = max(run.locked) * PERIOD
    assert ("no wheelset locked" in found[3]) == (locked == 0.0)
    told = re.search(r"for (?:up to )?([\d.]+) s", found[3])
    assert (float(told[1]) if told else 0.0) == pytest.approx(locked, abs=0.1)


@pytest.mark.study
def test_a_heavier_coach_from_200_kmh_stops_as_in_python(still: Page, tmp_path: Path) -> None:
    link = "#speed=200&mass=44&do=100:lever:100"
    still.evaluate(f"openLink('{link}')")
    still.evaluate("live.running = false")
    assert still.evaluate("live.simulation.kernel.get('body_mass')") == 44e3
    assert still.evaluate("writeLink(live.settings, [[100, 'lever', 1]])") == link
    start = {"speed": 200, "mass": 44}
    own = Run(start, [(100, "lever", 100)], tmp_path, FINE_TIMER)
    while own.steps < 400:
        own.step()
    found = still.evaluate(f"played({json.dumps(start)}, [[100, 'lever', 100]], 400, ['speed', 'distance'])")
    assert found["values"] == pytest.approx([own.kernel["speed"], own.kernel["distance"]], rel=1e-9)


def test_a_number_that_is_no_start_is_refused(still: Page) -> None:
    still.evaluate("openLink('#')")
    for name, value, said in (("speed", "999", "0 to 300 km/h; got 999"), ("mass", "1", "5 to 120 t; got 1")):
        still.evaluate(f"at('{name}').value = '{value}', at('{name}').dispatchEvent(new Event('change'))")
        assert f"{name} must be {said}. It stays as it was." in still.evaluate("at('messages').textContent")
    assert still.evaluate("[at('speed').value, at('mass').value]") == ["90", ""]


def test_wheels_that_are_locked_slow_the_coach_by_friction_times_gravity(still: Page) -> None:
    """All weight rests on sliding wheels and nothing else brakes: deceleration is mu g for any vehicle."""
    still.evaluate(f"stopped('#{PRESETS['locks'].link}')")
    speeds = still.evaluate(
        "[10, 25].map((time) => live.simulation.history[Math.round(time / (PERIOD * KEPT))].speed / 3.6)"
    )
    assert (speeds[0] - speeds[1]) / 15.0 == pytest.approx(0.08 * GRAVITY, rel=1e-6)


@pytest.mark.study
@pytest.mark.parametrize("gradient", [-10, 20])
@pytest.mark.parametrize("level", [1, 2, 3])
def test_a_coach_rolls_downhill_as_masses_and_turning_wheels_do(still: Page, level: int, gradient: int) -> None:
    """m g sin = (m + 4 J / r^2) a, where m includes the four wheelsets. The values are the benchmark's."""
    mass, turning = 32000.0 + 2 * 2615.0 + 4 * 1813.0, 4 * 112.0 / 0.46**2
    still.evaluate(f"openLink('#level={level}&gradient={gradient}').then(() => {{ live.running = false }})")
    still.evaluate("live.simulation.advance(10)")
    gained = still.evaluate("live.simulation.kernel.get('speed')") - 25.0
    assert gained / 10.0 == pytest.approx(-GRAVITY * gradient / 1000 * mass / (mass + turning), rel=1e-3)


def test_in_a_curve_to_the_left_the_right_flange_of_the_leading_wheelset_guides(still: Page) -> None:
    still.evaluate("openLink('#level=3&speed=60&curve=300').then(() => { live.running = false })")
    still.evaluate("live.simulation.advance(12)")
    shift, force = still.evaluate("['lateral_1', 'flange_force_1'].map((name) => live.simulation.kernel.get(name))")
    assert shift < -5e-3
    assert force > 1e3


def test_of_two_runs_that_are_asked_for_the_second_goes(still: Page) -> None:
    """The kernel of the first one is ready later."""
    waits = "if (name === 'bogie') await new Promise((on) => setTimeout(on, 100));"
    still.evaluate(f"globalThis.own = kernelOf, kernelOf = async (name) => {{ {waits} return own(name) }}, null")
    still.evaluate("Promise.all([openLink('#machine=bogie'), openLink('#friction=0.2')])")
    assert still.evaluate("[live.settings.machine, live.simulation.count, live.settings.friction]") == [
        "coach",
        4,
        "0.2",
    ]
    still.evaluate("kernelOf = own, null")


@pytest.mark.study
def test_a_link_brings_back_the_run_to_the_last_digit(browser: Browser, file: Path) -> None:
    """A run by hand in frames of any length is repeated from its address, in a page that computes it at once."""
    for page in opened(browser, file, 800):
        page.evaluate("move({ machine: 'bogie', speed: 40, gradient: -10 })")
        page.evaluate("new Promise((found) => setInterval(() => live.settings.gradient === '-10' && found(), 20))")
        page.evaluate("move({ pace: 4 }), new Promise((found) => setTimeout(found, 200))")
        for controls in ({"lever": 35}, {"friction": 0.07}, {"lever": 90}, {"protection": False}, {"friction": 0.21}):
            page.evaluate(f"move({json.dumps(controls)}), new Promise((found) => setTimeout(found, 300))")
        page.evaluate("at('leaves').click()")
        page.evaluate("new Promise((found) => setInterval(() => live.told && found(), 50))")
        sentence, link = page.evaluate("[at('result').textContent, location.hash]")
    assert link.count(":") == 12, link
    for again in opened(browser, file, 800):
        assert again.evaluate(f"stopped({json.dumps(link)})") == sentence
    for fresh in opened(browser, file, 800, link=link):
        fresh.evaluate("at('pace').value = 4, new Promise((found) => setInterval(() => live.told && found(), 50))")
        assert fresh.evaluate("at('result').textContent") == sentence


def test_a_link_that_cannot_be_says_what_is_left_out(still: Page) -> None:
    still.evaluate(
        "openLink('#level=7&friction=1e9&colour=red&do=90000:lever:100,x:y,5:lever:1e4,6:gradient:3,7:lever')"
    )
    told = still.evaluate("[...at('messages').children].map((one) => one.textContent)")
    assert len(told) == 7
    assert "The link has level 7; this page takes 1, 2, 3, and starts with 2." in told
    assert any('"colour"' in one for one in told)
    assert still.evaluate("live.simulation.plan") == [[90000, "lever", 1]]
    assert still.evaluate("live.simulation.controls.friction") == 0.3


def test_a_stop_counts_from_the_last_braking(still: Page) -> None:
    """After a release, the stop starts with the second braking."""
    whole = "#do=0:lever:100,600:lever:0,1600:lever:100"
    assert re.match(r"Stopped in [\d.]+ m and [\d.]+ s from 7\d km/h;", still.evaluate(f"stopped('{whole}')"))
    begun = still.evaluate("live.simulation.stop.begun.time")
    assert begun == pytest.approx(1600 * PERIOD)


def test_a_vehicle_that_its_brake_does_not_hold_is_told_of(still: Page) -> None:
    """40 in 1000 with a friction of 0.03: it stands for an instant and slides back; downhill it accelerates."""
    assert "slides back" in still.evaluate("stopped('#gradient=40&friction=0.03&speed=40&do=0:lever:100')")
    still.evaluate("openLink('#gradient=-40&friction=0.02&do=0:lever:100').then(() => { live.running = false })")
    still.evaluate("live.simulation.advance(20), showDoing()")
    assert still.evaluate("at('result').textContent") == "The brake does not hold it: it gets faster."


def test_a_stop_on_the_way_back_is_one_too(still: Page) -> None:
    """It rolls backwards down the gradient until the brake is applied."""
    sentence = still.evaluate("stopped('#gradient=40&speed=0&do=1000:lever:100')")
    assert re.match(r"Stopped in \d+\.\d m and [\d.]+ s from \d km/h; no wheelset locked\.$", sentence)


def test_what_it_does_is_said_in_a_sentence(still: Page) -> None:
    still.evaluate("openLink('').then(() => { live.running = false })")
    for lever, said in ((100, "It brakes."), (0, "It rolls. Press Brake."), (-50, "It drives.")):
        still.evaluate(f"move({{ lever: {lever} }}), live.simulation.advance(1), showDoing()")
        assert still.evaluate("at('result').textContent") == said


def test_a_wheel_that_leaves_its_rail_is_in_the_result(still: Page) -> None:
    still.evaluate("stopped('#machine=bogie&level=3&speed=120&curve=300&uneven=100&do=50:lever:100')")
    assert "A wheel came off its rail" in still.evaluate("at('result').textContent")


def test_back_leads_to_the_run_before(still: Page) -> None:
    still.evaluate("document.querySelector('#presets a').click(), live.ready")
    still.evaluate("[...document.querySelectorAll('#presets a')][1].click()")
    first, second = (PRESETS[name].link for name in ("full", "locks"))
    assert still.evaluate("location.hash") == f"#{second}"
    still.evaluate("new Promise((done) => { addEventListener('popstate', done, { once: true }); history.back() })")
    assert still.evaluate("location.hash") == f"#{first}"
    still.evaluate("new Promise((found) => setInterval(() => at('friction').value === '0.3' && found(), 20))")


def test_the_table_holds_the_run(still: Page) -> None:
    still.evaluate(f"stopped('#{PRESETS['locks'].link}')")
    rows = list(csv.DictReader(io.StringIO(still.evaluate("live.simulation.table().join('\\n')"))))
    assert len(rows) == still.evaluate("live.simulation.history.length")
    assert {"time [s]", "distance [m]", "speed [km/h]", "wheel speed 4 [km/h]", "axle load 1 [kN]"} <= set(rows[0])
    assert float(rows[0]["speed [km/h]"]) == pytest.approx(90.0)
    assert float(rows[-1]["wheel speed 1 [km/h]"]) == pytest.approx(0.0, abs=1e-9)
    assert all(None not in row and None not in row.values() for row in rows)


@pytest.mark.parametrize("level", [1, 2])
@pytest.mark.parametrize("name", MACHINES)
def test_no_valve_of_the_page_leaves_apply_on_dry_rail(still: Page, name: str, level: int) -> None:
    """Half the brake and then all of it, to rest and beyond, with the page's initial friction."""
    commands, speed = still.evaluate(f"commandsOnDryRail({name!r}, {level})")
    assert commands == 0
    assert abs(speed) < 0.01
