"""The arrows of the house, and what must never be in the repository."""

from __future__ import annotations

import ast
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
#: Which of our packages a package may import.
ALLOWED = {
    "fmu_src": {"fmu_src"},
    "rbd_model": {"rbd_model", "fmu_src.system"},
    "brake_controller": {"brake_controller", "fmu_src.system"},
}
OURS = {"fmu_src", "rbd_model", "brake_controller", "scenarios", "build_fmu"}


def imported(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module)
            names |= {f"{node.module}.{alias.name}" for alias in node.names if node.module.split(".")[0] in OURS}
    return names


@pytest.mark.parametrize("package", ALLOWED)
def test_imports_run_one_way(package: str) -> None:
    for path in (ROOT / package).rglob("*.py"):
        for name in imported(path):
            if name.split(".")[0] in OURS:
                allowed = any(name == ok or name.startswith(ok + ".") for ok in ALLOWED[package])
                assert allowed, f"{path.relative_to(ROOT)} imports {name}"


#: Rooms of scenarios/ that hold scenarios, one file each; the others are the machinery.
SUBJECTS = ("thesis", "brakes", "numerics", "coupling")


def test_no_scenario_imports_a_scenario() -> None:
    for path in (ROOT / "scenarios").rglob("*.py"):
        if path.name == "catalogue.py":
            continue
        for name in imported(path):
            leans = any(name == f"scenarios.{room}" or name.startswith(f"scenarios.{room}.") for room in SUBJECTS)
            assert not leans, f"{path.relative_to(ROOT)} imports {name}"


def test_rooms_of_subjects_hold_nothing_but_scenarios() -> None:
    catalogue = imported(ROOT / "scenarios" / "catalogue.py")
    for room in SUBJECTS:
        for path in (ROOT / "scenarios" / room).glob("[!_]*.py"):
            assert f"scenarios.{room}.{path.stem}" in catalogue, path.relative_to(ROOT)


def test_every_function_of_the_physics_says_what_it_is() -> None:
    for package in ("rbd_model", "brake_controller"):
        for path in (ROOT / package).rglob("*.py"):
            for node in ast.parse(path.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
                    needs_text = not node.name.startswith("add_")
                    assert ast.get_docstring(node) or not needs_text, f"{path.name}: {node.name} has no doc string"


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
