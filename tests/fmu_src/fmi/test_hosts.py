"""The host programs in an archive give the same values as FMPy and refuse wrong names with a message."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src.native_fmu import HOST_FILES
from products.building import write_in_c
from products.train.consist import block_train
from products.train.fmu import train_fmu
from tests.fmu_src.fmi.programs import MONO, call, found_here, shown
from tests.needed import needed

ROOT = Path(__file__).parents[3]
GIVEN = {"pressure_demand": 180e3, "cylinder_model": 2}
OUTPUTS = ("cylinder_pressure", "shoe_force", "shoe_friction", "brake_torque")


@pytest.fixture
def documentation(fmus: Mapping, tmp_path: Path) -> Path:
    """Unpack the brake; return the folder of the host programs."""
    with zipfile.ZipFile(fmus["brake", "native"]) as archive:
        archive.extractall(tmp_path)
    return tmp_path / "documentation"


@pytest.fixture(scope="module")
def expected(fmus: Mapping) -> dict[str, float]:
    return found_here(fmus["brake", "native"], GIVEN, OUTPUTS)


def refusal(command: list[str | Path], folder: Path) -> str:
    """Return the error message for an unknown name."""
    done = call(command, folder, "presure=1")
    assert done.returncode == 1
    return done.stderr


def test_cpp(documentation: Path, expected: dict[str, float]) -> None:
    environment = os.environ | {"ZIG_GLOBAL_CACHE_DIR": str(compiling.CACHE / "zig")}
    compiler = [shutil.which("c++")] if shutil.which("c++") else [sys.executable, "-m", "ziglang", "c++"]
    strict = ["-std=c++17", "-Wall", "-Wextra", "-Werror", "-I../sources", "host.cpp", "-ldl", "-o", "host"]
    done = subprocess.run([*compiler, *strict], cwd=documentation, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    [library] = (documentation.parent / "binaries").rglob("BrakeCylinder.*")
    command = [documentation / "host", library]
    assert shown(command, documentation, GIVEN) == expected
    assert refusal(command, documentation) == "presure=1 was refused with status 3.\n"
    none = subprocess.run([documentation / "host", "nowhere"], capture_output=True, text=True)
    assert none.stderr == "The library as the first argument has no fmi2Instantiate.\n"


def test_csharp(documentation: Path, expected: dict[str, float]) -> None:
    compiler, mono = (needed(name, packages=package) for name, package in MONO.items())
    subprocess.run([compiler, "-warnaserror", "host.cs"], cwd=documentation, check=True)
    command: list[str | Path] = [mono, "host.exe", ".."]
    assert shown(command, documentation, GIVEN) == expected
    unknown = "A name must be that of a number of BrakeCylinder; got presure. See modelDescription.xml.\n"
    assert refusal(command, documentation) == unknown


def test_the_csharp_of_the_page_runs(fmus: Mapping, tmp_path: Path) -> None:
    page = (ROOT / "docs" / "hosts" / "c-and-cpp.md").read_text(encoding="utf-8")
    [code, speed] = re.findall(r"```csharp\n(.*// ([\d.]+)\n.*)```", page, re.DOTALL)[0]
    using = "using System; using System.Collections.Generic; static class Page { static void Main() {"
    (tmp_path / "page.cs").write_text(f"{using}\n{code}\n}} }}")
    with zipfile.ZipFile(fmus["bogie", "native"]) as archive:
        archive.extractall(tmp_path / "bogie")
    compiler, mono = (needed(name, packages=package) for name, package in MONO.items())
    files = ["page.cs", "bogie/documentation/host.cs"]
    subprocess.run([compiler, "-warnaserror", "-main:Page", *files], cwd=tmp_path, check=True)
    done = subprocess.run([mono, "page.exe"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert float(done.stdout) == pytest.approx(float(speed), abs=1e-6)
    assert "Wheelset 2 locked at 0.2716" in done.stderr


def test_csharp_runs_a_train(tmp_path: Path) -> None:
    """The consist is in the resources of the FMU, whose variables are elements of arrays."""
    fmu, start = tmp_path / "train.fmu", {"start_speed": 20.0, "driver_position": 3, "friction[2]": 0.1}
    write_in_c(train_fmu(block_train(3)), fmu, 2)
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path)
    compiler, mono = (needed(name, packages=package) for name, package in MONO.items())
    subprocess.run([compiler, "-warnaserror", "documentation/host.cs", "-out:host.exe"], cwd=tmp_path, check=True)
    found = shown([mono, "host.exe", "."], tmp_path, start)
    assert found == found_here(fmu, start, list(found))
    assert 19.0 < found["speed[3]"] < 20.0


def test_python(documentation: Path, expected: dict[str, float], fmus: Mapping) -> None:
    for fmu in ("..", fmus["brake", "fmi3"]):
        assert shown([sys.executable, "host.py", fmu], documentation, GIVEN) == expected


@pytest.mark.parametrize(("kind", "version"), [("native", 2), ("fmi3", 3)])
def test_no_place_for_a_name_is_left(fmus: Mapping, kind: str, version: int) -> None:
    with zipfile.ZipFile(fmus["brake", kind]) as archive:
        for name in HOST_FILES[version]:
            text = archive.read(f"documentation/{name}").decode()
            assert "BrakeCylinder" in text
            assert "@" not in text
