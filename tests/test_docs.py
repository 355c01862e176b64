"""The pages are true: what they show runs and prints what they say, what they name exists, what is generated is new."""

from __future__ import annotations

import doctest
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("fmu_src", "rbd_model", "brake_controller", "scenarios")
#: A fenced block: its language and its text.
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks(page: str) -> list[tuple[str, str]]:
    """Language and text of the fenced blocks of a page."""
    return BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of what a newcomer has, to write into."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("build_fmu.py", "LICENSE"):
        shutil.copyfile(ROOT / name, tmp_path / name)
    return tmp_path


def apply(change: str, folder: Path, page: str) -> None:
    """Puts the lines with + behind the line above them, in the file that the page names last before the block."""
    before = page[: page.index(change)]
    target = folder / re.findall(r"`([\w/]+\.py)`", before)[-1]
    text, above = target.read_text(encoding="utf-8"), ""
    for line in change.splitlines(keepends=True):
        if line.startswith("+"):
            assert text.count(above) == 1, above
            text = text.replace(above, above + line[1:])
        above = line[1:]
    target.write_text(text, encoding="utf-8")


def shown_by(commands: str, folder: Path) -> str:
    """What the shell commands of a block print; each must succeed."""
    shown = ""
    for command in commands.splitlines():
        program, *arguments = command.split()
        assert program == "python", command
        environment = os.environ | {"PYTHONPATH": str(folder), "COLUMNS": "200"}
        done = subprocess.run(
            [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
        shown += done.stdout
    return shown


def test_a_newcomer_gets_from_equations_to_an_fmu_as_the_page_says(checkout: Path) -> None:
    """Files are written, commands run and their output compared, from the top of the page to its end."""
    page, shown, kinds = (ROOT / "docs/writing-a-system.md").read_text(encoding="utf-8"), "", []
    for kind, text in blocks("docs/writing-a-system.md"):
        kinds.append(kind)
        if kind == "python":
            (checkout / text.split()[1]).write_text(text, encoding="utf-8")
        elif kind == "diff":
            apply(text, checkout, page)
        elif kind == "sh":
            shown = shown_by(text, checkout)
        else:
            same = doctest.OutputChecker().check_output(text, shown, doctest.ELLIPSIS)
            assert same, f"The page says\n{text}\nand there came\n{shown}"
    assert [kinds.count(kind) for kind in ("python", "diff", "sh", "text")] == [4, 1, 4, 4]
