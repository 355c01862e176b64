"""The README leads to every part within minutes, and its commands work in a fresh clone."""

from __future__ import annotations

import ast
import functools
import importlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from bogie_braking.__main__ import main
from bogie_braking.exit_status import DOES_NOT_HOLD
from fmu_src.compile import CACHE
from fmu_src.model_description import variable_table
from products.registry import DIFFERENT, FMUS, model_of
from scenarios.catalogue import SCENARIOS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_is_read_in_minutes() -> None:
    assert len(README.splitlines()) <= 130


@functools.cache
def generated(name: str) -> str:
    """Return the tables that a generator writes on the site and for `make pages`."""
    sys.path.append(str(ROOT / "docs" / "generate"))
    return importlib.import_module(name).generated()


@pytest.mark.parametrize("name", list(FMUS))
def test_fmu_is_named_and_its_variables_are_on_their_page(name: str) -> None:
    model, page = model_of(name), generated("variables")
    assert f"`{model.name}`" in README
    assert f"## {model.name}\n" in page
    assert name not in DIFFERENT or variable_table(model.name, model.variables) in page


def test_every_scenario_is_on_the_page_to_which_the_readme_leads() -> None:
    page = generated("catalogue")
    for scenario in SCENARIOS:
        assert f"| `{scenario.name}` |" in page
    assert "(docs/scenarios.md)" in README


#: This file exists only next to the development checkout.
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


# -- its commands ----------------------------------------------------------------------------------------------------

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
#: Commands that take minutes and run tests, or are themselves run by tests; in the fresh clone they are only checked.
MINUTES = ("make test",)
#: Typical next commands: a result page, a sweep, and all results on one page.
NAME = "wheelset-constant-speed"
FURTHER = (
    f"python -m bogie_braking run {NAME} --html",
    "python -m bogie_braking run wheelset-skid",
    "python -m bogie_braking sweep levels --vary utilisation=0.5:1.1:2 --vary level=1 --jobs 1",
    "python -m bogie_braking report",
)


def commands() -> list[str]:
    """Return the shell commands of the README in order, each once."""
    shown = [line.split("#")[0] for kind, text in BLOCK.findall(README) if kind == "sh" for line in text.splitlines()]
    said = re.findall(r"`((?:make|python)\s[^`]+)`", BLOCK.sub("", README))
    return list(dict.fromkeys(" ".join(command.split()) for command in (*shown, *said)))


def test_every_target_of_make_can_be_made() -> None:
    [phony] = re.findall(r"^\.PHONY: (.*)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    for target in phony.split():
        subprocess.run(["make", "--dry-run", target], cwd=ROOT, capture_output=True, check=True)


def test_every_command_is_one_that_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    """A quick check: `make` dry runs and `--help` of the programs, also for the typical next commands."""
    found = commands()
    assert found[0] == "make demo"
    assert set(MINUTES) < set(found)
    for command in (*found, *FURTHER):
        program, *arguments = command.split()
        if program == "make":
            subprocess.run(["make", "--dry-run", *arguments], cwd=ROOT, capture_output=True, check=True)
        elif arguments[:2] == ["-m", "bogie_braking"]:
            with pytest.raises(SystemExit, match="0"):
                main([*arguments[2:], "--help"])
        else:
            subprocess.run([sys.executable, *arguments, "--help"], cwd=ROOT, capture_output=True, check=True)
    assert "usage: bogie-braking report" in capsys.readouterr().out


def fresh_clone(folder: Path) -> None:
    """Copy all files that git tracks, as they are in the working tree."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip("not a git checkout")
    for name in listed.stdout.splitlines():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, folder / name)


@pytest.mark.long
def test_every_command_works_in_a_fresh_clone(tmp_path: Path) -> None:
    """Run all commands from `make demo`, whose environment the others use, to the common page; run the Python too."""
    clone = tmp_path / "clone"
    fresh_clone(clone)
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}
    environment |= {"HOME": str(tmp_path), "BOGIE_BRAKING_CACHE": str(CACHE), "PYTHON": sys.executable}
    python = clone / ".venv" / "bin" / "python"

    def call(*command: str | Path) -> int:
        done = subprocess.run(command, cwd=clone, env=environment, capture_output=True, text=True)
        assert done.returncode in (0, DOES_NOT_HOLD), f"{command}\n{done.stdout}{done.stderr}"
        assert "Traceback" not in done.stderr
        return done.returncode

    for text in (text for kind, text in BLOCK.findall(README) if kind == "c"):
        (clone / text.split()[1]).write_text(text, encoding="utf-8")
    for command in (*commands(), *FURTHER):
        program, *arguments = command.split()
        if program == "make":
            assert call("make", *["--dry-run"] * (command in MINUTES), *arguments) == 0
        else:
            status = call(python, *arguments)
            assert (status == DOES_NOT_HOLD) is ("wheelset-skid" in arguments), command
    assert call(python, "-c", "\n".join(text for kind, text in BLOCK.findall(README) if kind == "python")) == 0
    results = clone / "results"
    page = (results / "index.html").read_text(encoding="utf-8")
    for name in ("demo/figure.png", "qr30-180kpa/figure.png", f"{NAME}/report.html", "sweep-levels/table.csv"):
        assert f'href="{name}"' in page
        assert (results / name).exists()
    assert (results / "live.html").exists()
