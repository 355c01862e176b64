"""Binaries for other systems: of their kind, showing FMI alone, and run where there is something that runs them."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import generate
from fmu_src.native_fmu import PLATFORMS, universal
from scenarios.cosimulation.slave import Slave
from scenarios.fmus import building
from scenarios.fmus.building import write_fmu
from scenarios.fmus.registry import model_of
from tests.fmu.exports import exports

#: Where a Mach-O library begins: zig's linker writes these into each, and no library uses another one's.
MARKS = {"_mh_dylib_header", "__dso_handle"}

#: On a new machine zig compiles the C library of Windows first, which takes two minutes.
SOME = [
    pytest.param(["darwin64", "aarch64-linux"], id="two"),
    pytest.param(list(PLATFORMS), id="all", marks=pytest.mark.long),
]


@pytest.mark.parametrize("platforms", SOME)
def test_one_archive_for_several_platforms(
    platforms: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Cross-compiled; each binary is of the kind that its folder asks for, and shows the functions of FMI alone."""
    monkeypatch.setattr(building, "PLATFORMS", {name: PLATFORMS[name] for name in platforms})
    path = write_fmu("brake", "native", tmp_path, all_platforms=True)
    begins = dict.fromkeys(("linux64", "aarch64-linux"), b"\x7fELF") | dict.fromkeys(("win64", "win32"), b"MZ")
    begins["darwin64"] = b"\xca\xfe\xba\xbe"
    with zipfile.ZipFile(path) as archive:
        for platform in platforms:
            binary = archive.read(f"binaries/{platform}/BrakeCylinder{PLATFORMS[platform][1]}")
            assert binary.startswith(begins[platform])
            shown = exports(binary)
            assert {"fmi2DoStep", "fmi3DoStep"} <= shown
            assert {name for name in shown - MARKS if not name.startswith(("fmi2", "fmi3"))} == set()
    machine = {"linux64": 0x3E, "aarch64-linux": 0xB7}
    windows = {"win64": 0x8664, "win32": 0x14C}
    with zipfile.ZipFile(path) as archive:
        for platform, number in machine.items():
            if platform not in platforms:
                continue
            binary = archive.read(f"binaries/{platform}/BrakeCylinder.so")
            assert int.from_bytes(binary[18:20], "little") == number
            assert b"GLIBC_2.3" not in binary  # no symbol newer than that of the declared, old library
        for platform in windows.keys() & set(platforms):
            binary = archive.read(f"binaries/{platform}/BrakeCylinder.dll")
            place = int.from_bytes(binary[60:64], "little") + 4
            assert int.from_bytes(binary[place : place + 2], "little") == windows[platform]
        name = next(name for name in ("win32", "aarch64-linux") if name in platforms)
        (target,), suffix = PLATFORMS[name]
        again = tmp_path / f"again{suffix}"
        compiling.compile_library(generate(model_of("brake")), again, target=target, fmu=True)
        assert again.read_bytes() == archive.read(f"binaries/{name}/BrakeCylinder{suffix}")


@pytest.mark.long
def test_code_of_32_bits_gives_the_numbers_of_64_bits(fmus: dict, tmp_path: Path) -> None:
    """That of win32, here for Linux, where it runs; compilers divide differently in the last digits (FLAGS)."""
    with zipfile.ZipFile(fmus["brake", "native"]) as archive:
        archive.extractall(tmp_path)
    program = ["-I../sources", "-DFMI2_FUNCTION_PREFIX=BrakeCylinder_", "host.c", "../sources/all.c", "-lm"]
    shown = []
    for target, more in ((None, []), ("x86-linux-musl", [*compiling.FLAGS_X86, "-static"])):
        flags = [flag for flag in compiling.FLAGS if flag != "-fPIC"]
        compiling.run([*flags, *more, "-O1", *program, "-o", "host"], target, tmp_path / "documentation")
        try:
            call = [tmp_path / "documentation" / "host", "pressure_demand=180e3", "pneumatics=2"]
            lines = subprocess.run(call, capture_output=True, text=True, check=True).stdout.splitlines()
            shown.append({name: float(value) for name, value in map(str.split, lines)})
        except OSError:
            pytest.skip("this system runs no programs of 32 bits")
    assert shown[0] == pytest.approx(shown[1], rel=1e-12)


def test_universal_binary_holds_both_parts_on_pages() -> None:
    both = universal({"x86_64-macos.11.0": b"a" * 10, "aarch64-macos.11.0": b"b" * 20})
    assert both[1 << 14 : (1 << 14) + 10] == b"a" * 10
    assert both[2 << 14 : (2 << 14) + 20] == b"b" * 20
    assert int.from_bytes(both[4:8], "big") == 2


#: What runs programs of another platform, and how it is to be had on Debian.
RUNNERS = {
    "aarch64-linux": (["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], "qemu-user libc6-arm64-cross"),
    "win64": (["wine"], "wine wine64"),
}
#: Inputs and parameters by FMU; the bogie's leading wheelset locks in space, on a rail of low adhesion.
GIVEN = {
    "brake": {"pressure_demand": 180e3, "pneumatics": 2},
    "bogie": {
        **{"level": 3, "initial_speed": 20.0, "friction_1": 0.1, "friction_2": 0.1},
        **{"brake_torque_1": 60e3, "brake_torque_2": 9e3},
    },
}
LONG = [(platform, fmu) for platform in RUNNERS for fmu in ("brake", "bogie")]
RUN = [("aarch64-linux", "brake"), *(pytest.param(*one, marks=pytest.mark.long) for one in LONG[1:])]
#: Least size by unit: forces may be small differences of wheel loads.
SIZES = {"N": 1e5}


@pytest.mark.parametrize(("platform", "fmu"), RUN)
def test_binary_runs_on_its_platform(
    platform: str, fmu: str, fmus: dict, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The host of the archive opens it there, and finds the numbers of here: 100 steps of 10 ms."""
    runner, packages = RUNNERS[platform]
    if not shutil.which(runner[0]):
        pytest.skip(f"no {runner[0]} here; on Debian: apt-get install {packages}")
    monkeypatch.setattr(building, "PLATFORMS", {platform: PLATFORMS[platform]})
    monkeypatch.setenv("WINEDEBUG", "-all")
    monkeypatch.setenv("WINEPREFIX", str(tmp_path.parent / "wine"))
    with zipfile.ZipFile(write_fmu(fmu, "native", tmp_path, all_platforms=True)) as archive:
        archive.extractall(tmp_path)
    (target,), suffix = PLATFORMS[platform]
    name = model_of(fmu).name
    flags = [flag for flag in compiling.FLAGS if flag != "-fPIC"]
    compiling.run([*flags, "-I../sources", "host.c", "-o", "host.exe"], target, tmp_path / "documentation")
    call = [*runner, "host.exe", f"../binaries/{platform}/{name}{suffix}", *(f"{k}={v}" for k, v in GIVEN[fmu].items())]
    done = subprocess.run(call, cwd=tmp_path / "documentation", capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    found = {name: float(value) for name, value in map(str.split, done.stdout.splitlines())}
    with Slave(fmus[fmu, "native"]) as here:
        here.start(**GIVEN[fmu])
        for n in range(100):
            here.step(n * 0.01, 0.01)
        expected = {name: here[name] for name in found}
    assert len(found) > 3
    units = {variable.name: variable.unit for variable in model_of(fmu).variables}
    for output, value in found.items():
        size = max(SIZES.get(units[output], 1.0), abs(expected[output]))
        assert abs(value - expected[output]) < 1e-10 * size, output
