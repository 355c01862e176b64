"""The README tells the truth: its code runs, its tables are those of the equations, its names exist."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fmu_src.model_description import variable_table
from scenarios.catalogue import SCENARIOS
from scenarios.fmus.registry import FMUS, model_of

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_python_examples_run(fmus: dict, capsys: pytest.CaptureFixture[str]) -> None:
    blocks = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(blocks) == 3
    assert len([line for line in blocks[0].splitlines() if line]) == 8
    for code in blocks:
        for (_, kind), path in fmus.items():
            code = code.replace(f"build/{kind}/{path.name}", str(path))
        exec(code, {})
    shown = capsys.readouterr().out
    assert "Torque capacity at 180 kPa: 1248 N.m" in shown
    assert "Leading wheelset locked at 0." in shown
    assert "Speed after 10 s: " in shown
    assert "low: " in shown


@pytest.mark.parametrize("name", list(FMUS))
def test_table_of_variables_is_that_of_the_equations(name: str) -> None:
    """When this fails, put the output of `python build_fmu.py --describe` into the README."""
    assert variable_table(model_of(name)) in README


def test_every_scenario_is_named() -> None:
    for scenario in SCENARIOS:
        assert f"`{scenario.name}`" in README


def test_equations_have_homes_and_tests_and_their_page_is_up_to_date() -> None:
    """When this fails, run `make pages` and read what it says."""
    done = subprocess.run(
        [sys.executable, ROOT / "docs" / "generate" / "equations.py", "--check"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


def test_numbers_of_the_pages_are_those_measured_beside_the_pictures() -> None:
    """When this fails, run `make charts`, or `make pages` after a change of the templates."""
    done = subprocess.run(
        [sys.executable, ROOT / "docs" / "generate" / "charts.py", "--check"], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


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


def test_named_files_exist() -> None:
    for name in re.findall(r"`((?:[\w-]+/)+[\w-]+\.\w+)`", README) + re.findall(r"\]\((docs/[^)]+)\)", README):
        if not name.startswith(("build/", "results/")):
            assert (ROOT / name).exists(), name
