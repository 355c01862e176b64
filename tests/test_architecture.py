"""Permitted imports between packages, and content that must never be in the repository."""

from __future__ import annotations

import ast
import re
import subprocess
from pathlib import Path

import pytest

import hatch_build
from products.sources import ROOMS
from scenarios.catalogue import MODULES

ROOT = Path(__file__).parents[1]
OURS = {*ROOMS, "bogie_braking", "build_fmu", "evidence"}


def test_rooms_are_imported_from_by_name() -> None:
    """A wheel moves all packages below one name, and `import fmu_src.system` cannot be adapted (hatch_build.py)."""
    for room in (*ROOMS, "bogie_braking"):
        for path in (ROOT / room).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Import):
                    found = {alias.name.split(".")[0] for alias in node.names} & OURS
                    assert not found, f"{path.relative_to(ROOT)}: write from {found.pop()} import ..."


def test_a_wheel_has_all_rooms() -> None:
    assert hatch_build.ROOMS == ROOMS


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
            names |= {f"{node.module}.{alias.name}" for alias in node.names if node.module.split(".")[0] in OURS}
    return names


def test_casadi_has_one_home() -> None:
    """Another module that imports it could not be imported where only ready machines run."""
    files = [path for room in (*ROOMS, "bogie_braking") for path in (ROOT / room).rglob("*.py")]
    assert [path.relative_to(ROOT).as_posix() for path in files if "casadi" in imported(path)] == ["fmu_src/symbols.py"]


#: Subpackages of scenarios/ with one scenario in each file (`coupling` is one scenario in several files). The others
#: are infrastructure.
SUBJECTS = ("thesis", "brakes", "vehicles", "contact", "lines", "trains")


def test_no_scenario_imports_a_scenario() -> None:
    for path in (ROOT / "scenarios").rglob("*.py"):
        if path.name == "catalogue.py":
            continue
        for name in imported(path):
            leans = any(name == f"scenarios.{room}" or name.startswith(f"scenarios.{room}.") for room in SUBJECTS)
            assert not leans, f"{path.relative_to(ROOT)} imports {name}"


def test_rooms_of_subjects_hold_nothing_but_scenarios() -> None:
    catalogue = {module.__name__ for module in MODULES}
    for room in SUBJECTS:
        for path in (ROOT / "scenarios" / room).glob("[!_]*.py"):
            assert f"scenarios.{room}.{path.stem}" in catalogue, path.relative_to(ROOT)


def tracked() -> list[Path]:
    done = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        pytest.skip("not a git checkout")
    return [ROOT / line for line in done.stdout.splitlines()]


def test_repository_holds_no_machine_paths_download_addresses_or_build_products() -> None:
    address = re.compile(r"(?<![\w.])/(work|home|tmp|root)/[a-z]|https?://\S+\.(whl|tgz|jar)\b|pythonhosted")
    for path in tracked():
        if not path.exists() or path == Path(__file__):
            continue
        assert path.suffix not in {".so", ".dll", ".dylib", ".fmu", ".o", ".pyc"}, path
        text = path.read_text(encoding="utf-8", errors="ignore")
        found = address.search(text)
        assert not found, f"{path.relative_to(ROOT)}: {found.group() if found else ''}"
