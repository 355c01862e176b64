"""The page on which a train brakes, in a real browser: its numbers are those of Python, controls do what they say."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from products.train.consist import block_train
from products.train.numbers import Settings
from products.train.train import Train
from scenarios.live.train_page import write_train_page
from tests.browser import Browser, Page, browser

__all__ = ["browser"]

#: Rounding of what a browser and C compute, relative to 1 bar; bytes that a telephone should be asked to load at most.
ROUNDING, LARGEST = 1e-6, 300_000
STEP = 0.05


@pytest.fixture(scope="module", params=[1440, 390])
def page(browser: Browser, tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Iterator[Page]:
    file = write_train_page(tmp_path_factory.mktemp("train") / "train.html")
    assert file.stat().st_size < LARGEST
    page = browser.open(file, request.param)
    page.evaluate("live.ready")
    page.evaluate("live.running = false; start()")
    yield page
    page.close()
    assert page.errors == []
    assert page.requests == []


def pressures(page: Page) -> list[float]:
    return [float(one) for one in page.evaluate("[...live.train.output('pipe')]")]


def test_an_emergency_on_the_page_is_that_of_python(page: Page) -> None:
    page.evaluate("start()")
    page.evaluate("document.querySelector('#valve button:nth-child(5)').click()")
    page.evaluate(f"for (let n = 0; n < 100; n += 1) advance({STEP})")
    train = Train(block_train(40), speed=100 / 3.6, settings=Settings())
    train.drive("emergency")
    for _ in range(100):
        train.advance(STEP)
    assert pressures(page) == pytest.approx([float(p) + 101325.0 for p in train.pipe_pressure], abs=ROUNDING * 1e5)
    speed = float(page.evaluate("live.train.output('speed')[0]"))
    assert speed == pytest.approx(float(train.speed[0]), abs=1e-6)
    assert pressures(page)[0] < pressures(page)[-1] < 6e5


def test_a_train_that_is_parted_empties_its_pipe_in_the_middle(page: Page) -> None:
    page.evaluate("start()")
    page.evaluate("document.getElementById('part').click()")
    page.evaluate("for (let n = 0; n < 60; n += 1) advance(0.05)")
    found = pressures(page)
    assert found[19] < 4.5e5
    assert found[20] < 4.5e5
    assert found[0] > 5.5e5
    assert "km/h" in page.evaluate("document.getElementById('state').textContent")


def test_every_button_and_every_train_runs(page: Page) -> None:
    for number in range(4):
        page.evaluate(f"document.getElementById('consist').selectedIndex = {number}; start()")
        for valve in range(1, 7):
            page.evaluate(f"document.querySelector('#valve button:nth-child({valve})').click(); advance(0.5)")
    assert float(page.evaluate("live.train.output('speed')[0]")) > 0.0


def test_it_is_drawn(page: Page, tmp_path: Path) -> None:
    page.evaluate("document.getElementById('consist').selectedIndex = 0; start()")
    page.evaluate("press('emergency'); for (let n = 0; n < 40; n += 1) advance(0.05)")
    shot = Path(os.environ.get("BOGIE_BRAKING_PICTURES", tmp_path)) / "train-page.png"
    page.screenshot(shot)
    assert shot.stat().st_size > 10_000
