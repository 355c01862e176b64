"""An ordinary installation: a wheel in an empty environment, away from the checkout, works and writes nothing there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import pytest

from fmu_src.compile import CACHE

ROOT = Path(__file__).parents[1]
PARTS = ("fmu_src", "rbd_model", "brake_controller", "scenarios")
FILES = ("build_fmu.py", "pyproject.toml", "README.md", "LICENSE")


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Python of an environment that holds nothing but the wheel and what it asks for."""
    place = tmp_path_factory.mktemp("installation")
    copy = place / "sources"  # setuptools writes beside its sources
    copy.mkdir()
    for part in PARTS:
        shutil.copytree(ROOT / part, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
    for file in FILES:
        shutil.copyfile(ROOT / file, copy / file)
    venv.create(place / "environment", with_pip=True)
    python = place / "environment" / ("Scripts" if os.name == "nt" else "bin") / "python"
    pip = [python, "-m", "pip", "install", "--quiet", "--no-compile", "--disable-pip-version-check"]
    subprocess.run([*pip, str(copy)], check=True, capture_output=True, text=True, cwd=place)
    shutil.rmtree(copy)
    return python


def contents(folder: Path) -> dict[str, tuple[int, int]]:
    """Size and time of each file below a folder; Python's own compiled files come and go."""
    files = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {str(path.relative_to(folder)): (path.stat().st_size, path.stat().st_mtime_ns) for path in files}


def call(python: Path, folder: Path, *arguments: str) -> str:
    """Runs the environment's Python in a folder, with a home of its own and the cache of all tests; what it printed."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= {"BOGIE_BRAKING_CACHE": str(CACHE), "HOME": str(folder)}
    done = subprocess.run([python, *arguments], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_installed_package_runs_a_scenario_and_builds_fmus_and_is_left_as_it_was(
    installed: Path, tmp_path: Path
) -> None:
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    packages = Path(call(installed, tmp_path, "-c", where).strip())
    before = contents(packages)
    assert not (packages / "tests").exists()
    shown = call(installed, tmp_path, "-m", "scenarios", "run", "qr30-180kpa")
    assert "DOES NOT HOLD" not in shown
    assert (tmp_path / "results" / "qr30-180kpa" / "figure.png").exists()
    shown = call(installed, tmp_path, "-m", "build_fmu", "brake")
    assert shown.count("valid") == 3
    assert {path.parent.name for path in (tmp_path / "build").rglob("BrakeCylinder.fmu")} == {
        "native",
        "fmi3",
        "python",
    }
    assert contents(packages) == before


def test_installed_package_is_the_one_that_runs(installed: Path, tmp_path: Path) -> None:
    """Not this checkout, which the tests have on their path."""
    place = call(installed, tmp_path, "-c", "import scenarios; print(scenarios.__file__)").strip()
    assert Path(place).is_relative_to(installed.parents[1])
    assert sys.prefix not in place
