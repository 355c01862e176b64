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
from fmu_src.host_programs import HOST_FILES
from products.building import write_in_c
from products.registry import IN_C, content_in_c
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
    unknown = "A name must be that of a parameter, input or output; got presure. See modelDescription.xml.\n"
    assert refusal(command, documentation) == unknown
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


#: Start of a train of three vehicles: full service with a slippery rail below the second one; duration of the run [s].
BRAKED = {"start_speed": 20.0, "driver_position": 3, "driver_step": 1.0, "friction[2]": 0.01}
LONG = 8.0
#: The same as arguments, and arguments that are refused.
BRAKED_AS_TEXT = [f"{name}={value}" for name, value in BRAKED.items()]
WRONG = ("friction[4]=0.1", "friction[0]=1", "friction[x=1", "friction[1x]=1", "driver_step=2", "driver_position=3.7")
WRONG += ("friction=0,2", "start_speed=25km/h", "friction=abc", "friction=nan", "seconds=1e9x", "seconds=-5", "x")


def train_folder(folder: Path, version: int) -> tuple[Path, Path]:
    """Write and unpack a train of three vehicles; return its documentation and its library."""
    write_in_c(train_fmu(block_train(2)), folder / "train.fmu", version)
    with zipfile.ZipFile(folder / "train.fmu") as archive:
        archive.extractall(folder)
    [library] = (folder / "binaries").rglob("TrainDynamics.*")
    return folder / "documentation", library


@pytest.mark.parametrize("version", [2, 3])
def test_the_programs_of_a_train_brake_it(tmp_path: Path, version: int) -> None:
    """C, C++ and C# give FMPy's speeds and forces of all vehicles and couplings, of a consist in the resources."""
    documentation, library = train_folder(tmp_path, version)
    strict = ["-Wall", "-Wextra", "-Werror", "-I../sources"]
    compiling.run([*strict, "host.c", "-ldl", "-o", "in_c"], None, documentation)
    commands: list[list[str | Path]] = [[documentation / "in_c", library]]
    if version == 2:
        cpp = shutil.which("c++") or needed("g++", packages="g++")
        subprocess.run([cpp, "-std=c++17", *strict, "host.cpp", "-ldl", "-o", "in_cpp"], cwd=documentation, check=True)
        compiler, mono = (needed(name, packages=package) for name, package in MONO.items())
        subprocess.run([compiler, "-warnaserror", "host.cs"], cwd=documentation, check=True)
        commands += [[documentation / "in_cpp", library], [mono, "host.exe", ".."]]
    names = [*shown(commands[0], documentation, {})]
    write_in_c(train_fmu(block_train(2)), tmp_path / "same.fmu", 2)
    expected = found_here(tmp_path / "same.fmu", BRAKED, names, round(100 * LONG))
    assert {"coupler_force[2]", "pipe_pressure[1]", "air_used"} <= expected.keys()
    assert (expected["speed[3]"] < 19.0, expected["locked[2]"], expected["locked[3]"]) == (True, 1.0, 0.0)
    for command in commands:
        assert shown(command, documentation, BRAKED | {"seconds": LONG}) == expected
        assert "The wheels of vehicle 2 locked" in call(command, documentation, *BRAKED_AS_TEXT, "seconds=8").stderr
        for wrong in WRONG:
            done = call(command, documentation, wrong)
            assert (done.returncode, done.stdout) == (1, "")
            assert re.search(r" must be .*; got ", done.stderr)


@pytest.mark.parametrize("name", IN_C)
def test_an_archive_around_an_object_in_c_has_what_that_of_a_bogie_has(
    name: str, fmus: Mapping, tmp_path: Path
) -> None:
    """Its page lists every array; each program is there for FMI 2.0, and compiles."""
    for kind, version in (("native", 2), ("fmi3", 3)):
        path = tmp_path / f"{version}.fmu"
        write_in_c(content_in_c(name, {}), path, version)
        with zipfile.ZipFile(path) as archive, zipfile.ZipFile(fmus["brake", kind]) as other:
            wanted = {
                one
                for one in other.namelist()
                if re.match("documentation/host|documentation/index|terminals|model.p", one)
            }
            assert wanted <= {*archive.namelist()}
            page = archive.read("documentation/index.html").decode()
            archive.extractall(tmp_path / str(version))
        for array in content_in_c(name, {}).given.arrays:
            assert f"<code>{array.name}</code>" in page
        strict = ["-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I../sources", "host.c"]
        compiling.run(strict, None, tmp_path / str(version) / "documentation")


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
