"""Runs of vehicles are bit-identical in any number of lanes, with any compiler, on any processor."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import KERNEL_SOURCES, RUNTIME, STUDY_SOURCES, generate
from products.registry import model_of
from rbd_model.track.line import arc, line_of
from rbd_model.track.spectra import ERRI_HIGH, irregular
from tests.fmu_src.fmi.sanitized import SANITIZERS
from tests.needed import needed

#: Numbers of lanes. Parts are compiled for one lane only if the compiler does not support vectors.
WIDTHS = (8, 4, 2)
STEP, ROWS, STEPS_OF_A_ROW = 0.005, 6, 20
ZIG = [sys.executable, "-m", "ziglang", "cc", "-mcpu=baseline"]
#: The leading wheelset locks on a slippery rail while a yaw torque presses its flange.
VALUES = {
    **{"level": 3, "contact_model": 2, "initial_speed": 20, "initial_lateral": 0.006, "initial_yaw": 0.01},
    **{"friction_1": 0.1, "friction_2": 0.1, "brake_torque_1": 60e3, "brake_torque_2": 9e3, "yaw_torque_1": 20e3},
}
#: Least flange force that shows flange contact [N].
PRESSED = 1e3


@lru_cache
def program(fmu: str, folder: Path, flags: Sequence[str] = (), compiler: str | None = None) -> Path:
    """Return stop.c, linked with the kernel of an FMU and the functions of studies; compiler: its command."""
    sources = generate(model_of(fmu))
    runtime = {name: (RUNTIME / name).read_text() for name in (*KERNEL_SOURCES, *STUDY_SOURCES)}
    optimised = [compiling.OPTIMISE_GENERATED, compiling.OPTIMISE_RUNTIME] if not flags else ["-O1", "-O1"]
    with pytest.MonkeyPatch.context() as patch:
        if compiler:
            patch.setenv("CC", compiler)
        own, path = [*compiling.FLAGS, *flags], folder / f"{fmu}{len(list(folder.iterdir()))}"
        objects = compiling.objects_of(sources, [*own, optimised[0]])
        objects += compiling.objects_of(runtime, [*own, "-DKERNEL_LIBRARY", optimised[1]])
        stop = Path(__file__).with_name("stop.c")
        compiling.run([*own, f"-I{RUNTIME}", "-o", str(path), str(stop), *map(str, objects), "-lm"], None, folder)
    return path


def run_of(one: Path, lanes: int, values: dict[str, object], before: Sequence[str] = ()) -> tuple[int, list[str]]:
    """Return the number of lanes and one line for each row with all outputs, in hexadecimal."""
    given = [f"{name}={value}" for name, value in values.items()]
    command = [*before, one, str(lanes), str(STEP), str(ROWS), str(STEPS_OF_A_ROW), *given]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr[-3000:]
    first, *rows = done.stdout.splitlines()
    assert len(rows) == ROWS
    return int(first), rows


def numbers(row: str) -> dict[str, float]:
    words = row.split()
    return {name: float.fromhex(value) for name, value in zip(words[::2], words[1::2], strict=True)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("runs")


@pytest.fixture(scope="module")
def curve(tmp_path_factory: pytest.TempPathFactory) -> Path:
    line = irregular(line_of([arc(300, 250, 0.1, 0.02)]), ERRI_HIGH, seed=1)
    return line.write(tmp_path_factory.mktemp("line") / "curve.csv")


def values_of(fmu: str, curve: Path, on_line: bool) -> dict[str, object]:
    known = {variable.name for variable in model_of(fmu).variables}
    line = {"line_file": curve} if on_line else {}
    return {name: value for name, value in (VALUES | line).items() if name in known}


@pytest.mark.study
@pytest.mark.parametrize("on_line", [False, True], ids=["straight", "line"])
@pytest.mark.parametrize("fmu", ["bogie", "vehicle"])
def test_a_run_has_the_same_bits_in_any_number_of_lanes(fmu: str, on_line: bool, folder: Path, curve: Path) -> None:
    one, values = program(fmu, folder), values_of(fmu, curve, on_line)
    found = dict(run_of(one, lanes, values) for lanes in WIDTHS)
    for rows in found.values():
        assert rows == found[2]
    assert numbers(found[2][-1])["locked_1"] == 1.0
    assert any(abs(numbers(row)["flange_force_1"]) > PRESSED for row in found[2])
    _, other = run_of(one, 2, values | {"initial_speed": 20 * (1 + 2**-52)})
    assert other != found[2]  # one bit of the start is seen in the end


@pytest.mark.long
def test_parts_of_one_lane_have_the_bits_of_those_in_lanes(folder: Path, curve: Path) -> None:
    """Compilers without vectors compile one lane only."""
    values = values_of("bogie", curve, True)
    lanes, rows = run_of(program("bogie", folder, ("-DLANES_WIDEST=1",)), 8, values)
    assert lanes == 1
    assert rows == run_of(program("bogie", folder), 8, values)[1]


@pytest.mark.long
@pytest.mark.skipif(find_spec("ziglang") is None, reason="install the extra: pip install -e .[compiler]")
def test_a_run_has_the_same_bits_of_both_compilers(folder: Path, curve: Path) -> None:
    values = values_of("bogie", curve, True)
    expected = run_of(program("bogie", folder), 8, values)[1]
    one = program("bogie", folder, compiler=" ".join(ZIG))
    for lanes in WIDTHS:
        assert run_of(one, lanes, values)[1] == expected


@pytest.mark.long
@pytest.mark.skipif(os.uname().machine != "x86_64" if hasattr(os, "uname") else True, reason="for processors of x86")
@pytest.mark.parametrize(("processor", "lanes"), [("Nehalem", 2), ("Haswell", 4)])
def test_a_run_has_the_same_bits_on_other_processors(processor: str, lanes: int, folder: Path, curve: Path) -> None:
    """QEMU emulates a processor without AVX, and one with AVX2 and without AVX-512."""
    needed("qemu-x86_64", packages="qemu-user")
    one, values = program("bogie", folder), values_of("bogie", curve, True)
    assert run_of(one, 8, values, ["qemu-x86_64", "-cpu", processor]) == (lanes, run_of(one, 2, values)[1])


@pytest.mark.long
def test_runs_in_lanes_are_clean_under_sanitizers(folder: Path, curve: Path) -> None:
    """The contact models also give bit-identical results when compiled without optimisation."""
    try:
        one = program("bogie", folder, ("-O0", *SANITIZERS))
    except compiling.CompilerError as error:
        pytest.skip(f"this compiler has no sanitizer libraries: {str(error)[-200:]}")
    for depth in (1, 2, 3):
        for lanes in WIDTHS:
            values = values_of("bogie", curve, depth == 2) | {"contact_model": depth}
            assert run_of(one, lanes, values)[1] == run_of(program("bogie", folder), lanes, values)[1]
