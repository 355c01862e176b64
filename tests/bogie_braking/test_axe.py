"""axe-core finds the faults of a small page, and none after they are corrected."""

from __future__ import annotations

from pathlib import Path

from tests.bogie_braking.axe import violations
from tests.bogie_braking.browser import Browser, browser

__all__ = ["browser"]

#: An image without alternative text, grey on white (contrast 1.6 : 1), an unlabelled field, and h3 after h1.
BAD = """<!DOCTYPE html><html lang="en"><title>bad</title><body style="background: #fff">
<h1>Head</h1><h3>Below</h3><img src="data:,"><p style="color: #ccc">pale</p><input></body></html>"""
CHANGES = {"<img": '<img alt="a picture"', "#ccc": "#333", "<input": '<input aria-label="field"', "h3": "h2"}


def found(browser: Browser, page: Path, text: str, *more: str) -> list[str]:
    """Return the names of the rules that a page with this text breaks."""
    page.write_text(text, encoding="utf-8")
    opened = browser.open(page, 800)
    names = sorted(line.split(":")[0] for line in violations(opened, *more))
    opened.close()
    return names


def test_what_is_wrong_is_found_and_what_is_mended_is_not(browser: Browser, tmp_path: Path) -> None:
    page, order = tmp_path / "page.html", "heading-order"
    assert found(browser, page, BAD) == ["color-contrast", "image-alt", "label"]
    assert found(browser, page, BAD, order) == ["color-contrast", order, "image-alt", "label"]
    mended = BAD
    for old, new in CHANGES.items():
        mended = mended.replace(old, new)
    assert found(browser, page, mended, order) == []
