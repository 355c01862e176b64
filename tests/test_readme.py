"""What there is can be found from the README, in minutes."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from fmu_src.model_description import variable_table
from scenarios.catalogue import SCENARIOS
from scenarios.fmus.registry import DIFFERENT, FMUS, model_of

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_is_read_in_minutes() -> None:
    assert len(README.splitlines()) <= 160


@pytest.mark.parametrize("name", list(FMUS))
def test_fmu_is_named_and_its_variables_are_on_their_page(name: str) -> None:
    model, page = model_of(name), (ROOT / "docs" / "variables.md").read_text(encoding="utf-8")
    assert f"`{model.name}`" in README
    assert f"## {model.name}\n" in page
    assert name not in DIFFERENT or variable_table(model) in page


def test_every_scenario_is_on_the_page_and_every_room_in_the_readme() -> None:
    page = (ROOT / "docs" / "scenarios.md").read_text(encoding="utf-8")
    for scenario in SCENARIOS:
        assert f"| `{scenario.name}` |" in page
    for room in re.findall(r"^## (\w+)$", page, re.MULTILINE):
        assert f"* **{room}**" in README


#: Lies in a folder beside the development checkout only.
THESIS = next(ROOT.parent.glob("*/thesis.txt"), None)


@pytest.mark.skipif(THESIS is None, reason="the thesis lies beside the development checkout only")
def test_numbers_of_equations_are_those_of_the_thesis() -> None:
    assert THESIS
    found: dict[int, int] = {}
    for chapter, number in re.findall(r"(?:\(|tag\{)(\d)\.(\d+)[)}]", THESIS.read_text(encoding="utf-8")):
        found[int(chapter)] = max(found.get(int(chapter), 0), int(number))
    last = re.search(r"LAST = (\{.*\})", (ROOT / "docs" / "generate" / "equations.py").read_text(encoding="utf-8"))
    assert last
    numbered = ast.literal_eval(last.group(1))
    assert numbered == {chapter: found[chapter] for chapter in numbered}
