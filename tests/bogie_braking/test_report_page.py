"""The page of a report on a controller, in a real browser: verdict, tables, and stops that play."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from bogie_braking.controllers.report_text import NO_CLAIM
from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, Page, browser

__all__ = ["browser"]  # a fixture
#: Name of a case that must stay plain text.
NASTY = "<script>globalThis.bad = 1</script>&"
CASES = f"""
[[case]]
name = "{NASTY}"
group = "low"
source = "somebody's memory"
rail = "low"
speed = "30km/h"

[[case]]
name = "dry"
rail = "dry"
speed = "30km/h"
"""
LIMITS = """
[[criterion]]
name = "distance"
measure = "over_ideal"
most = 1.05
unit = "1"
groups = ["low"]
source = "no standard"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a report on the built-in protection."""
    found = tmp_path_factory.mktemp("report")
    (found / "cases.toml").write_text(CASES)
    (found / "limits.toml").write_text(LIMITS)
    given = ["--programme", str(found / "cases.toml"), "--criteria", str(found / "limits.toml"), "--out", str(found)]
    assert main(["controllers", "report", "--html", "--quiet", "--draws", "2", *given]) == 1
    return found / "controllers"


@pytest.fixture(scope="module", params=[1440, 390])
def page(browser: Browser, folder: Path, request: pytest.FixtureRequest) -> Iterator[Page]:
    opened = browser.open(folder / "report.html", request.param)
    opened.evaluate("comparison.then((player) => { globalThis.player = player; })")
    yield opened
    assert opened.errors == []
    assert opened.requests == []
    opened.close()


@pytest.mark.study
def test_the_page_has_verdict_claim_sources_and_digests(page: Page, folder: Path) -> None:
    made = json.loads((folder / "report.json").read_text())
    text = page.evaluate("document.body.textContent")
    assert page.evaluate("at('headline').textContent") == made["message"]
    assert made["message"].startswith("rejected: protection fails 1 of 2 criteria: distance 1.")
    assert NO_CLAIM in text
    for words in (
        "no standard",
        "somebody's memory",
        made["sources"],
        *(one["sha256"] for one in made["inputs"].values()),
    ):
        assert words in text
    cells = "Array.from(document.querySelectorAll('#criteria tbody:last-child td')).map((one) => one.textContent)"
    assert page.evaluate(cells)[:4] == ["at most 1.05", "1", "1", "0"]


def test_the_failed_case_is_played_first_and_names_are_text(page: Page) -> None:
    assert page.evaluate("at('case').selectedOptions[0].textContent") == NASTY
    assert page.evaluate("globalThis.bad") is None
    page.evaluate("player.go(3)")
    assert page.evaluate("player.tracks.map(({ stop }) => stop.controller)") == ["protection"]
    page.evaluate("document.querySelectorAll('#scores button')[1].click()")
    assert page.evaluate("at('case').selectedOptions[0].textContent") == "dry"


@pytest.mark.study
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_nothing_is_hard_to_read_and_all_fits(page: Page, scheme: str) -> None:
    page.prefer(scheme)
    assert violations(page, "heading-order") == []
    page.prefer("light")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    if "BOGIE_BRAKING_PICTURES" in os.environ:
        name = f"report-{page.evaluate('innerWidth')}.png"
        page.screenshot(Path(os.environ["BOGIE_BRAKING_PICTURES"]) / name)
