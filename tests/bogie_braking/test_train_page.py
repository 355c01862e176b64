"""The page that brakes a train, in a real browser: its numbers agree with Python, and its controls work."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from bogie_braking.live.train_page import PAGE, PRESETS, TRAINS, write_train_page
from products.train.consist import block_train
from products.train.numbers import Settings
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


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_train_page(tmp_path_factory.mktemp("train") / PAGE)


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
    page.evaluate("document.querySelector('#valve button:nth-child(5)').click()")
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
    for name in TRAINS:
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


def test_each_page_leads_to_the_other(page: Page) -> None:
    assert "live.html" in page.evaluate(
        "[...document.querySelectorAll('#presets a')].map((one) => one.getAttribute('href'))"
    )


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_hard_to_read_or_to_use(page: Page, scheme: str) -> None:
    page.prefer(scheme)
    begin(page)
    assert violations(page, "heading-order") == []
    page.prefer("light")


def test_it_is_drawn(page: Page, tmp_path: Path) -> None:
    begin(page)
    page.evaluate("act('emergency'); for (let n = 0; n < 100; n += 1) live.train.step(); show()")
    shot = Path(os.environ.get("BOGIE_BRAKING_PICTURES", tmp_path)) / f"train-{page.evaluate('innerWidth')}.png"
    page.screenshot(shot)
    assert shot.stat().st_size > 10_000
