"""The page that plays stops, in a real browser: numbers, controls, and names that must stay plain text."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from bogie_braking.__main__ import main
from bogie_braking.controllers.page import MOST_SAMPLES, thinned
from products.machine import bogie
from products.protection.history import EVERY
from products.protection.programme import read_programme
from products.protection.rig import Rig
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from products.protection.spread import Spread, draws_of
from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, Page, browser

__all__ = ["browser"]  # a fixture
#: Largest page of two cases and three controllers [bytes]: scripts and style take 45 kB, a stop 3 kB.
LARGEST = 70_000
NASTY = "<script>globalThis.bad = 1</script>@DATA@ & \"'"
PROGRAMME = f"""
[[case]]
name = '''{NASTY}'''
rail = "low"
speed = "36km/h"
fault = [{{ wheelset = 2, sensor = "doubled", sensor_from = 2.0 }}]

[[case]]
name = "wet"
rail = "wet"
speed = "36km/h"
"""
CONTROLLER = """
class Named:
    def __init__(self, name):
        pass

    def step(self, time, speeds):
        return [2 if speed < 0.8 * max(speeds) else 0 for speed in speeds]
"""
GAINS = "Named('<img src=x onerror=globalThis.bad=2>')"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a case file and the page of a comparison."""
    found = tmp_path_factory.mktemp("compared")
    (found / "named.py").write_text(CONTROLLER)
    (found / "my.toml").write_text(PROGRAMME)
    given = [f"{found / 'named.py'}:{GAINS}", "--programme", str(found / "my.toml"), "--out", str(found)]
    assert main(["controllers", "compare", "--html", "--quiet", *given]) == 0
    return found


@pytest.fixture(scope="module", params=[1440, 390])
def page(browser: Browser, folder: Path, request: pytest.FixtureRequest) -> Iterator[Page]:
    opened = browser.open(folder / "controllers" / "compare.html", request.param)
    opened.evaluate("comparison.then((player) => { globalThis.player = player; })")
    yield opened
    assert opened.errors == []
    assert opened.requests == []
    opened.close()


def choose(page: Page, case: int) -> None:
    """Choose a case in the selection list."""
    page.evaluate(f"at('case').value = '{case}', at('case').dispatchEvent(new Event('change'))")


@pytest.mark.study
def test_names_are_text_and_never_obeyed(page: Page) -> None:
    choose(page, 0)
    assert page.evaluate("globalThis.bad") is None
    assert page.evaluate("at('case').options[0].textContent") == NASTY
    assert page.evaluate("document.querySelector('#scores button').textContent") == NASTY
    assert page.evaluate("document.querySelectorAll('h3')[2].textContent") == GAINS
    assert NASTY in page.evaluate("at('headline').textContent")
    assert page.evaluate("document.scripts.length") == 2


@pytest.mark.study
def test_the_page_is_small_and_fits_its_window(page: Page, folder: Path) -> None:
    assert (folder / "controllers" / "compare.html").stat().st_size < LARGEST
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    if "BOGIE_BRAKING_PICTURES" in os.environ:
        page.evaluate("player.go(4)")
        name = f"compare-{page.evaluate('innerWidth')}.png"
        page.screenshot(Path(os.environ["BOGIE_BRAKING_PICTURES"]) / name)


@pytest.mark.study
def test_the_page_has_the_numbers_of_the_rig(page: Page, folder: Path) -> None:
    """The first draw with the built-in protection: speeds within 1 cm/s, distances within 1 dm, linear in between."""
    choose(page, 0)
    case, spread = read_programme(folder / "my.toml")[0], Spread()
    [draw] = draws_of(case.name, range(1), 2, spread, 1)
    rig = Rig(bogie(), SlideProtection, Settings(jitter=spread.jitter), by_flow=True)
    [stop] = rig.runs([draw.applied(case.run(bogie()), bogie())], every=EVERY)
    history = stop.history
    assert history
    assert page.evaluate("player.tracks[1].stop.end") == pytest.approx(stop.time, abs=1e-3)
    rolling = bogie().parameters.wheel_radius * history.angular_velocity
    for time in (0.0, 3.7, 5.25, 11.0):
        found = page.evaluate(f"player.tracks[1].stop.at({time})")
        for name, values, least in (("speed", history.speed, 0.01), ("way", history.distance, 0.1)):
            assert found[name] == pytest.approx(np.interp(time, history.time, values), abs=least)
        wheels = [np.interp(time, history.time, column) for column in rolling.T]
        assert found["wheel"] == pytest.approx(wheels, abs=0.01)
        assert found["valve"] == history.valve[history.time.searchsorted(time + 1e-9)].tolist()
    shown, turning = (page.evaluate(f"player.tracks[1].stop.{name}[1]") for name in ("shown", "wheel"))
    # A median over several samples, because a sensor lags behind an accelerating wheel.
    assert np.median(np.divide(shown[30:42], turning[30:42])) == pytest.approx(2.0, rel=0.05)
    assert page.evaluate("player.tracks[1].stop.at(3.7).speed") != pytest.approx(history.speed[40], abs=0.01)


@pytest.mark.study
def test_it_plays_to_the_end_and_says_who_stands(page: Page) -> None:
    choose(page, 0)
    page.evaluate("player.go(player.latest - 16), at('pace').value = '20', at('play').click()")
    assert page.evaluate("at('play').textContent") == "Pause"
    page.evaluate("new Promise((done) => setInterval(() => !player.running && done(), 20))")
    assert page.evaluate("player.time === player.latest")
    assert page.evaluate("at('play').textContent") == "Play"
    distance = page.evaluate("player.tracks[0].stop.distance")
    assert page.evaluate("player.tracks[0].state.textContent").startswith(f"stands after {distance:.1f} m")
    assert " m" in page.evaluate("at('told').textContent")


@pytest.mark.study
def test_it_is_led_by_keys_by_the_bar_and_by_a_touch(page: Page) -> None:
    choose(page, 0)

    def press(key: str) -> None:
        page.call("Input.dispatchKeyEvent", type="keyDown", key=key, text=key if key == " " else "")
        page.call("Input.dispatchKeyEvent", type="keyUp", key=key)

    for key in ("ArrowRight", "ArrowRight", "ArrowLeft"):
        press(key)
    assert page.evaluate("player.time") == 1.0
    press(" ")
    page.evaluate("new Promise((done) => setInterval(() => player.time > 1 && done(), 10))")
    press(" ")
    assert page.evaluate("player.running") is False
    page.evaluate("at('time').value = 6, at('time').dispatchEvent(new Event('input'))")
    assert page.evaluate("player.time") == 6.0
    assert "locked" in page.evaluate("player.tracks[0].canvas.getAttribute('aria-label')")
    place = "player.charts[0].canvas.scrollIntoView(), player.charts[0].canvas.getBoundingClientRect().toJSON()"
    box = page.evaluate(f"({place})")
    at = {"x": box["x"] + box["width"] / 2, "y": box["y"] + 50}
    for kind in ("mousePressed", "mouseReleased"):
        page.call("Input.dispatchMouseEvent", type=kind, button="left", buttons=1, clickCount=1, **at)
    middle = page.evaluate("player.time / player.latest")
    assert middle == pytest.approx(0.46, abs=0.04)


@pytest.mark.study
def test_machines_and_cursor_move_and_colours_follow_the_night(page: Page) -> None:
    choose(page, 0)
    drawn = "[player.tracks[0].canvas.toDataURL(), player.charts[0].canvas.toDataURL()]"
    first = page.evaluate(f"player.go(2), {drawn}")
    assert page.evaluate(f"player.go(2), {drawn}") == first
    assert all(one != other for one, other in zip(page.evaluate(f"player.go(5), {drawn}"), first, strict=True))
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    dark = page.evaluate(f"player.go(2), {drawn}")
    page.call("Emulation.setEmulatedMedia", features=[])
    assert all(one != other for one, other in zip(dark, first, strict=True))


def test_a_case_is_chosen_in_the_table(page: Page) -> None:
    page.evaluate("document.querySelectorAll('#scores button')[1].click()")
    assert page.evaluate("at('case').selectedOptions[0].textContent") == "wet"
    assert page.evaluate("player.tracks.map(({ stop }) => stop.case)") == ["wet"] * 3


@pytest.mark.study
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_hard_to_read_or_to_use(page: Page, scheme: str) -> None:
    page.prefer(scheme)
    assert violations(page, "heading-order") == []
    page.prefer("light")


@pytest.mark.study
def test_long_stops_are_thinned_and_keep_their_end(folder: Path) -> None:
    run = read_programme(folder / "my.toml")[0].run(bogie())
    [stop] = Rig(bogie(), None, Settings(brake_ratio=1e-3)).runs([run], every=EVERY)
    history = stop.history
    assert history
    assert history.time.size > 2 * MOST_SAMPLES
    few = thinned(history)
    assert MOST_SAMPLES / 2 < few.time.size <= MOST_SAMPLES + 1
    assert (few.time[0], few.time[-1]) == (0.0, stop.time)
    assert set(few.speed) <= set(history.speed)


@pytest.mark.study
def test_a_comparison_without_a_page_writes_none(folder: Path, tmp_path: Path) -> None:
    given = [f"{folder / 'named.py'}:Named('a')", "--programme", str(folder / "my.toml"), "--out", str(tmp_path)]
    assert main(["controllers", "compare", "--quiet", *given]) == 0
    assert sorted(path.name for path in (tmp_path / "controllers").iterdir()) == ["compare.json", "compare.png"]
    with_page, without = (
        json.loads((one / "controllers" / "compare.json").read_text())["runs"] for one in (folder, tmp_path)
    )
    assert [run["distance"] for run in with_page] == [run["distance"] for run in without]
