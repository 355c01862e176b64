"""The page that brakes a train, in a real browser: its numbers agree with Python, and its controls work."""

from __future__ import annotations

import base64
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from bogie_braking.live.carried_train import CarriedTrain, carried_from
from bogie_braking.live.train_page import HILL, PAGE, PRESETS, trains, write_train_page
from fmu_src.arrays_fmu import build_arrays_fmu
from products.train.consist import block_train
from products.train.consist_file import consist_of
from products.train.fmu import train_of_files_fmu
from products.train.numbers import Settings, numbers_of
from products.train.train import Train
from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, Page, browser

__all__ = ["browser"]

#: Rounding difference of browser and C, relative to 1 bar; largest download for a telephone [bytes].
ROUNDING, LARGEST = 1e-6, 300_000
#: STEP and RESTS of train.js: [s], [m/s].
STEP, RESTS = 0.02, 0.01
#: Width and height of windows [pixels].
SIZES = [(1440, 900), (390, 844)]

HANDS = """
async function stopped(link) {
  await openLink(link);
  live.running = false;
  while (!live.train.ended) live.train.step();
  advance(0);
  return at("result").firstChild.textContent;
}
"""


#: A user's train with all controls, and a line with a descent.
CONSIST = """kind,name,count,load,traction_force,traction_power,dynamic_force,eddy_force,parking_force
locomotive,Ae 6/6,1,,300,5600,150,,60
coach,"A <b> '4'",3,,,,,40,
wagon,Eaos,7,60,,,,,
"""
LINE = "distance,curvature,cant,gradient\n0,0,0,0\n300,0,0,0\n400,0,0,-0.02\n3000,0,0,-0.02\n"
#: Actions of a link: steps, inputs, values [%]; the driver's valve.
ACTIONS = ((0, "traction", 60), (300, "traction", 0), (300, "dynamic_brake", 80), (500, "track_brake", 100))
ENDS = 900
#: Vehicles with the equipment of an input: 1, others 0.
HAVE = {name: [1.0] + [0.0] * 10 for name in ("traction", "dynamic_brake")}
HAVE["track_brake"] = [0.0] + [1.0] * 3 + [0.0] * 7
#: Relative difference of browser and Python: none with equal mathematical libraries.
ALIKE = 1e-12
#: Least speed relative to real time of 101 vehicles in a browser on a busy computer; it reached 16 to 150.
LEAST_PACE = 5.0


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_train_page(tmp_path_factory.mktemp("train") / PAGE)


@pytest.fixture(scope="module")
def user_files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("own")
    consist, line = folder / "freight.csv", folder / "valley.csv"
    consist.write_text(CONSIST)
    line.write_text(LINE)
    return consist, line


@pytest.fixture(scope="module", params=SIZES, ids=str)
def page(browser: Browser, file: Path, request: pytest.FixtureRequest) -> Iterator[Page]:
    assert file.stat().st_size < LARGEST
    page = browser.open(file, *request.param)
    page.evaluate(HANDS)
    page.evaluate("live.ready.then(() => { live.running = false })")
    yield page
    page.close()
    assert page.errors == []
    assert page.requests == []


def begin(page: Page, link: str = "") -> None:
    page.evaluate(f"openLink({json.dumps(link)}).then(() => {{ live.running = false }})")


def pressures(page: Page) -> list[float]:
    return [float(one) for one in page.evaluate("[...live.train.output('pipe_pressure')]")]


@pytest.mark.study
def test_brake_and_pictures_are_on_the_first_screen(page: Page) -> None:
    begin(page)
    for name in ("brake", "train-view", "chart-speed", "result", "presets"):
        assert page.evaluate(f"at('{name}').getBoundingClientRect().bottom <= innerHeight"), name
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.study
def test_an_emergency_on_the_page_is_that_of_python(page: Page) -> None:
    begin(page)
    page.evaluate("document.querySelector('#valve button:last-child').click()")
    page.evaluate("for (let n = 0; n < 250; n += 1) live.train.step()")
    train = Train(block_train(40), speed=100 / 3.6, settings=Settings())
    train.drive("emergency")
    for _ in range(250):
        train.advance(STEP)
    assert pressures(page) == pytest.approx([float(p) + 101325.0 for p in train.pipe_pressure], abs=ROUNDING * 1e5)
    speed = float(page.evaluate("live.train.output('speed')[0]"))
    assert speed == pytest.approx(float(train.speed[0]), abs=1e-6)
    assert pressures(page)[0] < pressures(page)[-1] < 6e5


@pytest.mark.study
def test_an_emergency_stops_where_that_of_python_does(page: Page) -> None:
    """The final message agrees to 0.1 % in distance and 1 kN in force, and once more from the resulting link."""
    sentence = page.evaluate(f"stopped({json.dumps('#' + PRESETS['Emergency, 40 wagons'])})")
    train, begun, pushed = Train(block_train(40), speed=100 / 3.6, settings=Settings()), 0.0, 0.0
    while train.speed[0] >= RESTS:
        if train.time == pytest.approx(50 * STEP):
            begun = float(train.distance[0])
            train.drive("emergency")
        train.advance(STEP)
        pushed = max(pushed, -float(min(train.coupler_force)))
    found = re.match(r"The head stopped in ([\d.]+) m .* were pushed by (\d+) kN", sentence)
    assert found, sentence
    assert float(found[1]) == pytest.approx(float(train.distance[0]) - begun, rel=1e-3)
    assert float(found[2]) == pytest.approx(pushed / 1e3, abs=1.0)
    assert page.evaluate("stopped(location.hash)") == sentence


@pytest.mark.study
def test_a_train_that_is_parted_empties_its_pipe_in_the_middle(page: Page) -> None:
    begin(page)
    page.evaluate("document.getElementById('part').click()")
    page.evaluate("for (let n = 0; n < 150; n += 1) live.train.step()")
    found = pressures(page)
    assert found[19] < 4.5e5
    assert found[20] < 4.5e5
    assert found[0] > 5.5e5
    page.evaluate("show()")
    assert "since braking" in page.evaluate("at('state').textContent")


def test_the_space_bar_brakes_and_releases(page: Page) -> None:
    begin(page)
    page.evaluate("document.activeElement.blur()")
    for word, valve in (("Release", "full service"), ("Brake", "running")):
        page.press(" ")
        assert page.evaluate("[at('brake-word').textContent, live.train.valve]") == [word, valve]


def test_every_button_and_every_train_runs(page: Page) -> None:
    for name in trains():
        begin(page, f"#train={name}")
        assert page.evaluate("live.consist") == name
        for valve in range(1, 7):
            page.evaluate(f"document.querySelector('#valve button:nth-child({valve})').click(); advance(0.5)")
    assert float(page.evaluate("live.train.output('speed')[0]")) > 0.0


def test_a_link_that_cannot_be_says_what_is_left_out(page: Page) -> None:
    begin(page, "#train=9 wagons&do=90000:emergency,6:whistle")
    told = page.evaluate("at('result').textContent")
    assert "train=9 wagons and 6:whistle" in told
    assert page.evaluate("live.train.plan") == [[90000, "emergency"]]


def test_a_link_that_is_no_text_leaves_a_train_that_brakes(page: Page) -> None:
    begin(page, "#%E0%A4%A")
    assert "left out" in page.evaluate("at('result').textContent")
    assert page.evaluate("pressBrake(), live.train.valve") == "full service"


def driven(page: Page, steps: int = ENDS) -> list[float]:
    """Return speed and pressures after the actions, exactly as JavaScript has them."""
    page.evaluate(f"for (let n = live.train.steps; n < {steps}; n += 1) live.train.step()")
    return [
        float(one) for one in page.evaluate("[...live.train.output('speed'), ...live.train.output('pipe_pressure')]")
    ]


def test_a_users_train_on_a_line_runs_as_in_python_and_from_its_link(
    browser: Browser, file: Path, user_files: tuple[Path, Path], tmp_path: Path
) -> None:
    consist, line = user_files
    own = carried_from(consist, line)
    assert main(["live", "--consist", str(consist), "--line", str(line), "--out", str(tmp_path)]) == 0
    done = ",".join(f"{step}:{name}:{value}" for step, name, value in ACTIONS)
    page = browser.open(tmp_path / PAGE, *SIZES[0], link=f"#speed=30&place=250&do={done},600:first step")
    page.evaluate("live.ready.then(() => { live.running = false })")
    found = driven(page)
    assert page.evaluate("[live.consist, live.train.consist.nameOf(1), live.train.consist.nameOf(10)]") == [
        *("freight on valley", "A <b> '4'", "Eaos")
    ]
    train = Train(own.consist, speed=30 / 3.6, distance=250.0, line=own.line, settings=Settings())
    for step in range(ENDS):
        for at, name, value in ACTIONS:
            if at == step:
                train.inputs[name] = [value / 100 * has for has in HAVE[name]]
        if step == 600:
            train.drive("service", 0.0)
        train.advance(STEP)
    python = [*train.speed, *(train.pipe_pressure + 101325.0)]
    assert found == pytest.approx([float(one) for one in python], rel=ALIKE)
    assert float(page.evaluate("live.train.consist.gradientAt(live.train.front)")) == pytest.approx(-0.02)
    page.evaluate("showLink()")
    link = page.evaluate("location.hash")
    page.close()
    other = browser.open(file, *SIZES[1], link=link)
    other.evaluate("live.ready.then(() => { live.running = false })")
    assert driven(other) == found
    assert other.evaluate("live.consist") == own.name
    assert other.evaluate("document.documentElement.scrollWidth <= innerWidth")
    other.close()
    assert page.errors + other.errors == []


def drop(page: Page, path: Path) -> str:
    """Drop a file on the page; return the message."""
    content = base64.b64encode(path.read_bytes()).decode()
    page.evaluate(
        f"openFile(new File([Uint8Array.from(atob('{content}'), (one) => one.charCodeAt(0))], '{path.name}'))"
        ".then(() => { live.running = false })"
    )
    return str(page.evaluate("at('result').textContent"))


def test_a_trains_fmu_is_opened_and_other_files_say_what_to_do(
    page: Page, user_files: tuple[Path, Path], tmp_path: Path
) -> None:
    consist, line = user_files
    fmu = tmp_path / "TrainDynamics.fmu"
    build_arrays_fmu(train_of_files_fmu(consist, line), fmu, 3, {})
    begin(page)
    assert f"live --consist {consist.name}" in drop(page, consist)
    bad = tmp_path / "bad.fmu"
    bad.write_bytes(fmu.read_bytes()[:9000])
    assert "cannot be opened" in drop(page, bad)
    assert page.evaluate("live.consist") == "40 wagons, P"
    drop(page, fmu)
    own = carried_from(consist, line)
    numbers = "[...live.train.consist.numbers]"
    assert page.evaluate(numbers) == numbers_of(own.consist, Settings(), own.line).tolist()
    page.evaluate("act('traction', 50), driven = live.train, showLink()")
    link = page.evaluate("location.hash")
    assert page.evaluate(f"openLink({json.dumps(link)}).then(() => live.train.plan)") == [[0, "traction", 50]]
    assert page.evaluate("live.train.consist.vehicles") == len(own.consist.vehicles)


@pytest.mark.parametrize("data", ["AAAA", "eJwDAAAAAAE", ""])
def test_a_link_with_a_damaged_train_leaves_one_that_runs(page: Page, data: str) -> None:
    begin(page, f"#data={data}&do=0:emergency")
    assert "cannot be read" in page.evaluate("at('result').textContent")
    page.evaluate("live.train.step()")


def test_keys_move_the_controls_that_a_train_has(page: Page) -> None:
    begin(page, f"#train={HILL}&speed=0")
    for code in ("Quote", "KeyD", "KeyD", "Period", "KeyM", "Backspace", "Semicolon"):
        page.evaluate(f"document.body.dispatchEvent(new KeyboardEvent('keydown', {{code: '{code}', bubbles: true}}))")
    assert page.evaluate("[live.train.valve, live.train.levers]") == [
        "full service",
        {"traction": 20, "dynamic_brake": 10, "parking_brake": 0},
    ]
    assert page.evaluate("at('lever-traction').value") == "20"
    begin(page)
    assert page.evaluate("at('levers').children.length") == 0


def test_a_train_that_has_stopped_goes_on_once_it_is_released(page: Page) -> None:
    begin(page, f"#train={HILL}&speed=10&place=2500&do=0:emergency")
    page.evaluate("while (!live.train.ended) live.train.step(); advance(0)")
    assert "The head stopped" in page.evaluate("at('result').textContent")
    assert "-15.0 ‰ · limit 60 km/h" in page.evaluate("at('gauges').textContent")
    page.evaluate("act('running'); for (let n = 0; n < 5000; n += 1) live.train.step(); show()")
    assert page.evaluate("live.train.speed") > 1.0
    assert page.evaluate("live.train.ended") is False


def test_a_hundred_wagons_run_faster_than_real_time(page: Page) -> None:
    begin(page, "#train=100 wagons, G&do=0:full service")
    run = "begun = performance.now(); for (let n = 0; n < 500; n += 1) live.train.step(); performance.now() - begun"
    assert 500 * STEP / (float(page.evaluate(run)) / 1e3) > LEAST_PACE


def test_each_page_leads_to_the_other(page: Page) -> None:
    assert "live.html" in page.evaluate(
        "[...document.querySelectorAll('#presets a')].map((one) => one.getAttribute('href'))"
    )


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_hard_to_read_or_to_use(page: Page, scheme: str) -> None:
    page.prefer(scheme)
    begin(page, f"#train={HILL}")
    assert violations(page, "heading-order") == []
    page.prefer("light")


def test_it_is_drawn(page: Page, tmp_path: Path) -> None:
    actions = "do=0:traction:60,400:traction:0,1000:dynamic_brake:60,1600:emergency"
    begin(page, f"#train={HILL}&speed=60&place=700&{actions}")
    page.evaluate("for (let n = 0; n < 1900; n += 1) live.train.step(); show()")
    shot = Path(os.environ.get("BOGIE_BRAKING_PICTURES", tmp_path)) / f"train-{page.evaluate('innerWidth')}.png"
    page.screenshot(shot)
    assert shot.stat().st_size > 10_000


#: Consists with a handle: the notch that releases, and that of the large button; a notch of its own.
HANDLES = {
    "26-L": (("release", "full service"), "15 psi"),
    "PBL2": (("desserrage", "serrage maximal"), "serrage"),
    "H-6": (("running", "service until lap"), "release"),
    "British vacuum": (("running", "full brake"), "10 inches"),
}


@pytest.mark.parametrize("handle", HANDLES)
def test_a_trains_handle_has_its_notches_and_they_act_as_in_python(page: Page, handle: str) -> None:
    (released, braked), notch = HANDLES[handle]
    vacuum = {"distributor": "vacuum"} if "vacuum" in handle else {}
    rows = [{"kind": "locomotive", "handle": handle, **vacuum}, {"kind": "coach", "count": 4, **vacuum}]
    consist = consist_of(rows)
    link = CarriedTrain("own", consist).packed().replace("+", "-").replace("/", "_").replace("=", "")
    begin(page, f"#data={link}&speed=60&do=0:{notch},5:half service")
    assert "5:half service" in page.evaluate("at('result').textContent")
    page.evaluate("for (let n = 0; n < 100; n += 1) live.train.step(); show()")
    train = Train(consist, speed=60 / 3.6, settings=Settings())
    train.drive(notch)
    for _ in range(100):
        train.advance(STEP)
    assert pressures(page) == pytest.approx([float(p) + 101325.0 for p in train.pipe_pressure], abs=ROUNDING * 1e5)
    pressed = "[...at('valve').children].find((one) => one.ariaPressed === 'true').textContent"
    assert page.evaluate(pressed) == notch
    page.evaluate(f"act({json.dumps(released)}), pressBrake()")
    assert page.evaluate(pressed) == braked
    page.evaluate("pressBrake()")
    assert page.evaluate(pressed) == released
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
