"""Each page of a host has its row in the common table and states what was run or tried.

`tests/docs/test_pages_run.py` runs the code on these pages.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = sorted(path.name for path in ROOT.glob("docs/hosts/*.md"))
#: A row of the table: whether the host was run, its versions, its page.
ROW = re.compile(r"^\|[^|]+\| (yes|no)\b[^|]*\| *([^|]*?) *\| \[[^]]+\]\(hosts/([\w-]+\.md)\) \|$", re.MULTILINE)
NOT_RUN, VERSION, NUMBER = "**Not run here.**", re.compile(r"\b\d+\.\d+(?:\.\d+)*\b"), re.compile(r"\b\d+\.\d{4,}\b")


def table() -> dict[str, tuple[bool, list[str]]]:
    """Return by page whether the host was run, and its versions. Each page has one row."""
    rows = ROW.findall((ROOT / "docs" / "hosts.md").read_text(encoding="utf-8"))
    found = {page: (run == "yes", VERSION.findall(versions)) for run, versions, page in rows}
    assert len(found) == len(rows)
    return found


def faults(text: str, run: bool, versions: list[str]) -> list[str]:
    """Return the required statements that a page lacks."""
    first = " ".join(text.split("\n\n")[1].split())
    says = {
        "steps": re.search(r"^1\. .*\n", text, re.MULTILINE),
        "settings that matter": "ettings that matter" in text,
        "a number": NUMBER.search(text),
        "whether it was run, first": first.startswith("Run here" if run else NOT_RUN),
        "the versions of the table, first": set(versions) <= set(VERSION.findall(first)),
        "no versions in the table, where nothing was run": run or not versions,
        "how": run or "\n## How to " in text,
        "how it was tried": run or "that were tried" in first or "Tried were" in first,
    }
    return [what for what, said in says.items() if not said]


def test_every_host_of_the_table_has_its_page_and_every_page_its_host() -> None:
    assert sorted(table()) == PAGES


@pytest.mark.parametrize("page", PAGES)
def test_a_page_says_what_was_run_or_how_it_was_tried(page: str) -> None:
    assert faults((ROOT / "docs" / "hosts" / page).read_text(encoding="utf-8"), *table()[page]) == []


def test_what_a_page_does_not_say_is_found() -> None:
    run = "# Host\n\nRun here: host 1.2.\n\n1. Do it.\n\nSettings that matter: none. 11.034966 m/s\n"
    assert faults(run, True, ["1.2"]) == []
    assert faults(run, True, ["1.3"]) == ["the versions of the table, first"]
    assert faults(run.replace("11.034966", "11"), True, ["1.2"]) == ["a number"]
    not_run = f"# Host\n\n{NOT_RUN} Tried were all.\n\n## How to run it\n\n1. Do it.\n\nSettings that matter: 0.0001.\n"
    assert faults(not_run, False, []) == []
    assert faults(not_run.replace("How to", "To"), False, []) == ["how"]
    assert faults(not_run.replace("Tried were all.", ""), False, []) == ["how it was tried"]
    assert "whether it was run, first" in faults(run, False, [])
