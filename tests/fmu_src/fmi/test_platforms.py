"""Binaries for other platforms: their format, their exported functions, and a run if an emulator is installed."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import generate
from fmu_src.native_fmu import PLATFORMS, universal
from products import building
from products.building import write_fmu
from products.registry import model_of
from tests.fmu_src.fmi.exports import exports
from tests.fmu_src.fmi.programs import found_here, shown
from tests.needed import needed

#: Start symbols of a Mach-O library: zig's linker exports them from every library; no library uses another's.
MARKS = {"_mh_dylib_header", "__dso_handle"}
PROGRAM_FLAGS = [flag for flag in compiling.FLAGS if flag != "-fPIC"]
#: On a new computer, zig first compiles the C library of Windows, which takes two minutes.
SOME = [
    pytest.param(["darwin64", "aarch64-linux"], id="two"),
    pytest.param(list(PLATFORMS), id="all", marks=pytest.mark.long),
]
#: Commands that run programs of another platform, and their Debian packages.
RUNNERS = {
    "aarch64-linux": (["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"], "qemu-user libc6-arm64-cross"),
    "win64": (["wine"], "wine wine64"),
}
#: Inputs and parameters by FMU. The bogie's leading wheelset locks at level 3 on a rail of low adhesion.
GIVEN = {
    "brake": {"pressure_demand": 180e3, "cylinder_model": 2},
    "bogie": {
        **{"level": 3, "initial_speed": 20.0, "friction_1": 0.1, "friction_2": 0.1},
        **{"brake_torque_1": 60e3, "brake_torque_2": 9e3},
    },
}
RUN = [
    ("aarch64-linux", "brake"),
    pytest.param("aarch64-linux", "bogie", marks=pytest.mark.long),
    pytest.param("win64", "brake", marks=pytest.mark.long),
    pytest.param("win64", "bogie", marks=pytest.mark.long),
]
READ = {"brake": {"cylinder_pressure", "brake_torque"}, "bogie": {"speed", "angular_velocity_1", "lateral_1"}}
#: Least scale by unit: forces may be small differences of wheel loads.
SIZES = {"N": 1e5}


@pytest.mark.study
@pytest.mark.parametrize("platforms", SOME)
def test_one_archive_for_several_platforms(
    platforms: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each cross-compiled binary has the format of its folder and exports the functions of FMI only."""
    monkeypatch.setattr(building, "PLATFORMS", {name: PLATFORMS[name] for name in platforms})
    path = write_fmu("brake", "native", tmp_path, all_platforms=True)
    begins = dict.fromkeys(("linux64", "aarch64-linux"), b"\x7fELF") | dict.fromkeys(("win64", "win32"), b"MZ")
    begins["darwin64"] = b"\xca\xfe\xba\xbe"
    with zipfile.ZipFile(path) as archive:
        for platform in platforms:
            binary = archive.read(f"binaries/{platform}/BrakeCylinder{PLATFORMS[platform][1]}")
            assert binary.startswith(begins[platform])
            functions = exports(binary)
            assert {"fmi2DoStep", "fmi3DoStep"} <= functions
            assert {name for name in functions - MARKS if not name.startswith(("fmi2", "fmi3"))} == set()
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
    """The 32-bit code of win32 is compiled for Linux, where it runs. The C libraries differ in the last digits."""
    with zipfile.ZipFile(fmus["brake", "native"]) as archive:
        archive.extractall(tmp_path)
    folder = tmp_path / "documentation"
    program = ["-I../sources", "-DFMI2_FUNCTION_PREFIX=BrakeCylinder_", "host.c", "../sources/all.c", "-lm"]
    found = []
    for target, more in ((None, []), ("x86-linux-musl", [*compiling.FLAGS_X86, "-static"])):
        compiling.run([*PROGRAM_FLAGS, *more, "-O1", *program, "-o", "host"], target, folder)
        try:
            found.append(shown([folder / "host"], folder, GIVEN["brake"]))
        except OSError:
            pytest.skip("this system runs no programs of 32 bits")
    assert found[0] == pytest.approx(found[1], rel=1e-12)


def test_universal_binary_holds_both_parts_on_pages() -> None:
    both = universal({"x86_64-macos.11.0": b"a" * 10, "aarch64-macos.11.0": b"b" * 20})
    assert both[1 << 14 : (1 << 14) + 10] == b"a" * 10
    assert both[2 << 14 : (2 << 14) + 20] == b"b" * 20
    assert int.from_bytes(both[4:8], "big") == 2


@pytest.mark.study
@pytest.mark.parametrize(("platform", "fmu"), RUN)
def test_binary_runs_on_its_platform(
    platform: str, fmu: str, fmus: dict, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The host program of the archive gives the same values there as FMPy here."""
    runner, packages = RUNNERS[platform]
    needed(runner[0], packages=packages)
    monkeypatch.setattr(building, "PLATFORMS", {platform: PLATFORMS[platform]})
    monkeypatch.setenv("WINEDEBUG", "-all")
    monkeypatch.setenv("WINEPREFIX", str(tmp_path.parent / "wine"))
    with zipfile.ZipFile(write_fmu(fmu, "native", tmp_path, all_platforms=True)) as archive:
        archive.extractall(tmp_path)
    (target,), suffix = PLATFORMS[platform]
    folder, binary = tmp_path / "documentation", f"../binaries/{platform}/{model_of(fmu).name}{suffix}"
    compiling.run([*PROGRAM_FLAGS, "-I../sources", "host.c", "-o", "host.exe"], target, folder)
    found = shown([*runner, "host.exe", binary], folder, GIVEN[fmu])
    assert found.keys() > READ[fmu]
    expected = found_here(fmus[fmu, "native"], GIVEN[fmu], list(found))
    assert expected.get("angular_velocity_1", 0.0) == 0.0  # locked
    units = {variable.name: variable.unit for variable in model_of(fmu).variables}
    for output, value in found.items():
        size = max(SIZES.get(units[output], 1.0), abs(expected[output]))
        assert abs(value - expected[output]) < 1e-10 * size, output
