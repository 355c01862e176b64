"""docs/ways.md names functions that exist and the words in them that lead to the next one, in few files."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
#: Largest number of Python files on each path through the code.
MOST_FILES = {"`brake_torque_1`": 8, "A curvature": 9, "A creep law": 6}
ROW = re.compile(r"^\| `(?P<file>[\w/]+\.py): (?P<name>[\w.]+)` \| .+ \| `(?P<word>\w+)` \|$", re.MULTILINE)

Way = list[tuple[str, str, str]]


def ways() -> dict[str, Way]:
    """Return the rows (file, function, word) of each path by its title."""
    page = (ROOT / "docs" / "ways.md").read_text(encoding="utf-8")
    titles = re.split(r"^## (.+)$", page, flags=re.MULTILINE)[1:]
    return {title: ROW.findall(text) for title, text in zip(titles[::2], titles[1::2], strict=True)}


def source_of(file: str, name: str) -> str:
    """Return the source of a function, method or class. Raises AssertionError if the name does not exist."""
    text = (ROOT / file).read_text(encoding="utf-8")
    body: list[ast.stmt] = ast.parse(text).body
    found: ast.stmt | None = None
    for part in name.split("."):
        kinds = (ast.FunctionDef, ast.ClassDef)
        found = next((node for node in body if isinstance(node, kinds) and node.name == part), None)
        assert found, f"docs/ways.md: {file} has no {name}"
        body = found.body if isinstance(found, ast.ClassDef) else []
    return ast.get_source_segment(text, found) or "" if found else ""


def check(way: Way) -> None:
    for file, name, word in way:
        assert re.search(rf"\b{word}", source_of(file, name)), f"docs/ways.md: {word} is not in {file}: {name}"


@pytest.mark.parametrize("title", MOST_FILES)
def test_a_way_leads_through_functions_that_exist_in_few_files(title: str) -> None:
    way = ways()[title]
    assert len(way) > 5
    check(way)
    assert len({file for file, _, _ in way}) <= MOST_FILES[title]


def test_all_ways_are_looked_at_row_by_row() -> None:
    page = (ROOT / "docs" / "ways.md").read_text(encoding="utf-8")
    assert ways().keys() == MOST_FILES.keys()
    assert sum(map(len, ways().values())) == page.count("\n| `") == len(ROW.findall(page))


def test_a_word_that_leads_nowhere_is_found() -> None:
    file, name, _ = ways()["A curvature"][0]
    with pytest.raises(AssertionError, match="nowhere is not in"):
        check([(file, name, "nowhere")])
    with pytest.raises(AssertionError, match="has no nothing"):
        check([(file, "nothing", "curvature")])
