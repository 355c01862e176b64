"""Several FMUs in one process: the symbols of their binaries, and that each runs its own code, opened or linked."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from itertools import permutations, product
from pathlib import Path

import pytest

from fmu_src import compile as compiling
from fmu_src.codegen import generate, guid_of
from fmu_src.compile import build_library, compiler, library_of
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.kernel import _SIGNATURES
from fmu_src.system import Model
from products.registry import DIFFERENT, FMUS, model_of
from tests.fmu_src.fmi.exports import exports

HERE = Path(__file__).parent
ZIG = f"{sys.executable} -m ziglang cc -mcpu=baseline"
#: Inputs and parameters that make each FMU move.
SCENE = {
    "wheelset": {"brake_torque_1": 4e3, "friction_1": 0.2},
    "brake": {"pressure_demand": 180e3},
    "rail": {"speed": 10.0, "creep_force_1": -5e3, "slip_1": 2.0},
    "vehicle": {"brake_torque_1": 4e3, "friction_1": 0.2},
    "braked-vehicle": {"pressure_demand_1": 2e5, "friction_1": 0.2},
}
#: Small FMUs that are opened together.
TOGETHER = ("wheelset", "brake", "rail")
#: The two that are also compiled by zig, and linked into one program.
SMALLEST = ("brake", "rail")
#: The FMU with the longest sources.
LARGEST = "braked-vehicle"
#: Relative difference of outputs between optimised code and code without optimisation, after 0.3 s of adaptive steps.
OPTIMISED_OTHERWISE = 1e-6
#: Brake torque at 180 kPa after 3 s [N.m]: 0.164 N/Pa, half a bogie, efficiency, friction 0.25, radius 0.398 m.
BRAKE_TORQUE = 180e3 * 0.164 * 0.5 * 0.85 * 0.25 * 0.398
SETTLED = 1e-4  # missing share of the demand after 3 s; the cylinder takes 0.8 s to 95 %: exp(-3 * 3 / 0.8)


@pytest.fixture(scope="module")
def models() -> dict[str, Model]:
    return {name: model_of(name) for name in TOGETHER}


@pytest.fixture(scope="module")
def sources(models: dict[str, Model]) -> dict[str, dict[str, str]]:
    return {name: generate(model) for name, model in models.items()}


@pytest.mark.parametrize("kind", ["native", "fmi3", "python"])
@pytest.mark.parametrize("name", TOGETHER)
def test_binary_shows_what_its_users_call_and_nothing_else(fmus: dict, name: str, kind: str) -> None:
    """FMUs export the functions of FMI. The library in a pythonfmu FMU exports the functions that kernel.py calls."""
    with zipfile.ZipFile(fmus[name, kind]) as packed:
        place = "resources/kernel" if kind == "python" else "binaries/"
        [library] = [entry for entry in packed.namelist() if entry.startswith(place)]
        shown = exports(packed.read(library))
    if kind == "python":
        assert set(_SIGNATURES) <= shown
        assert {one for one in shown if not one.startswith("kernel_")} == set()
    else:
        assert {"fmi2DoStep", "fmi3DoStep", "fmi2GetDerivatives", "fmi3GetContinuousStateDerivatives"} <= shown
        assert {one for one in shown if not one.startswith(("fmi2", "fmi3"))} == set()


def build(parts: Sequence[str | Path], folder: Path, command: Sequence[str] = ()) -> None:
    environment = {
        "ZIG_GLOBAL_CACHE_DIR": str(compiling.CACHE / "zig"),
        "ZIG_LOCAL_CACHE_DIR": str(folder),
    } | os.environ
    call = [*(command or compiler()), *map(str, parts)]
    done = subprocess.run(call, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def archive(fmus: Mapping, name: str, version: int, folder: Path) -> Path:
    """Unpack an FMU."""
    target = folder / f"{name}{version}"
    with zipfile.ZipFile(fmus[name, {2: "native", 3: "fmi3"}[version]]) as packed:
        packed.extractall(target)
    return target


def outputs(model: Model) -> list[int]:
    return [n for n, v in enumerate(model.variables) if v.causality == "output" and v.kind == "real"]


def ask(host: Path, names: Mapping[str, str | Path], models: Mapping[str, Model], sources: Mapping) -> dict[str, str]:
    """Return the outputs of each FMU, in hexadecimal, after the host has run all in the given order."""
    command = [str(host)]
    for key, name in names.items():
        model = models[key]
        values = ",".join(f"{model.index(variable)}={value!r}" for variable, value in SCENE[key].items())
        asked = ",".join(map(str, outputs(model)))
        command += [str(name), guid_of(sources[key]), values, asked]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, f"{done.returncode} {done.stderr}"
    return dict(zip(names, done.stdout.split("-\n"), strict=False))


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> dict[int, Path]:
    """Return hosts that open libraries with global symbols, as hosts in Java do, by version of FMI."""
    folder = tmp_path_factory.mktemp("opened")
    flags = ["-Wall", "-Wextra", "-Werror", f"-I{compiling.fmi_headers()}", HERE / "together.c", "-ldl"]
    for version in (2, 3):
        build(["-O1", f"-DVERSION={version}", *flags, "-o", f"host{version}"], folder)
    return {version: folder / f"host{version}" for version in (2, 3)}


@pytest.mark.study
@pytest.mark.parametrize("cc", ["", ZIG], ids=["cc", "zig"])
def test_global_symbols_of_one_fmu_do_not_reach_another(
    opened: dict, models: dict, sources: dict, monkeypatch: pytest.MonkeyPatch, cc: str
) -> None:
    """In any order each FMU has the same values as alone. A call into another FMU would give OK and no brake torque."""
    names = TOGETHER
    if cc:
        monkeypatch.setenv("CC", cc)
        names = SMALLEST
    libraries = {name: library_of(sources[name], fmu=True) for name in names}
    for version, host in opened.items():
        alone = {name: ask(host, {name: libraries[name]}, models, sources)[name] for name in names}
        assert len(set(alone.values())) == len(names)
        torque = dict(line.split() for line in alone["brake"].splitlines())[str(models["brake"].index("brake_torque"))]
        assert float.fromhex(torque) == pytest.approx(BRAKE_TORQUE, rel=SETTLED)
        for order in permutations(names):
            assert ask(host, {name: libraries[name] for name in order}, models, sources) == alone, (version, order)


def test_kernels_for_python_do_not_reach_each_other(models: dict) -> None:
    """The library of a pythonfmu FMU is loaded in a process that has loaded the symbols of another one before."""
    first, second = build_library(models["wheelset"]), build_library(models["brake"])
    program = (
        "import ctypes, sys\nfrom fmu_src.kernel import Kernel, Library\n"
        "ctypes.CDLL(sys.argv[1], ctypes.RTLD_GLOBAL)\n"
        "kernel = Kernel(Library(sys.argv[2]), pressure_demand=180e3)\n"
        "kernel.advance(3.0)\nprint(kernel['brake_torque'])"
    )
    command = [sys.executable, "-c", program, str(first), str(second)]
    done = subprocess.run(command, cwd=HERE.parents[1], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(BRAKE_TORQUE, rel=SETTLED)


def linked(folders: Mapping[str, Path], models: Mapping[str, Model], version: int, folder: Path, optimise: str) -> Path:
    """Return the program of together.c, linked with the all.c of each FMU."""
    objects: list[str | Path] = []
    for name, sources in folders.items():
        model = models[name].name
        common = [*compiling.FLAGS, optimise, f"-DFMI{version}_FUNCTION_PREFIX={model}_", f"-I{sources}", "-c"]
        build([*common, sources / "all.c", "-o", f"{name}.o"], folder)
        build([*common, f"-DVERSION={version}", f"-DTABLE={model}", HERE / "table.c", "-o", f"{name}t.o"], folder)
        objects += [f"{name}.o", f"{name}t.o"]
    tables = " ".join(f"DO({models[name].name})" for name in folders)
    flags = ["-O1", f"-DVERSION={version}", f"-DLINKED(DO)={tables}", f"-I{compiling.fmi_headers()}"]
    build([*flags, HERE / "together.c", *objects, "-ldl", "-lm", "-o", "together"], folder)
    return folder / "together"


def size_of_sources(fmu: Path) -> int:
    with zipfile.ZipFile(fmu) as packed:
        return sum(entry.file_size for entry in packed.infolist() if entry.filename.startswith("sources/"))


def numbers(lines: str) -> dict[str, float]:
    return {name: float.fromhex(value) for name, value in (line.split() for line in lines.splitlines())}


def test_the_largest_sources_are_those_of_the_braked_vehicle(fmus: dict) -> None:
    assert max(DIFFERENT, key=lambda name: size_of_sources(fmus[name, "native"])) == LARGEST


@pytest.mark.long
def test_largest_sources_compile_and_run_linked_to_others(fmus: dict, opened: dict, tmp_path: Path) -> None:
    """A target without our binaries compiles the sources. Here they are those with the most names."""
    models = {name: model_of(name) for name in (LARGEST, "brake")}
    archives = {name: archive(fmus, name, 2, tmp_path) for name in models}
    folders = {name: one / "sources" for name, one in archives.items()}
    sources = {name: {"model.c": (one / "model.c").read_text()} for name, one in folders.items()}
    together = linked(folders, models, 2, tmp_path, "-O0")
    found = ask(together, {name: model.name for name, model in models.items()}, models, sources)
    for name, one in archives.items():
        [library] = (one / "binaries").rglob(f"{models[name].name}.*")
        binary = ask(opened[2], {name: library}, models, sources)[name]
        assert numbers(found[name]) == pytest.approx(numbers(binary), rel=OPTIMISED_OTHERWISE, abs=1e-9)


@pytest.mark.study
@pytest.mark.parametrize("version", [2, 3])
def test_fmus_linked_into_one_program_give_the_values_of_their_binaries(
    fmus: dict, opened: dict, models: dict, sources: dict, tmp_path: Path, version: int
) -> None:
    """Each all.c of an archive is compiled with the function prefix of the standard. Values are bit-identical."""
    folders = {name: archive(fmus, name, version, tmp_path) / "sources" for name in SMALLEST}
    together = linked(folders, models, version, tmp_path, "-O1")
    found = ask(together, {name: models[name].name for name in SMALLEST}, models, sources)
    libraries = {name: library_of(sources[name], fmu=True) for name in SMALLEST}
    assert found == ask(opened[version], libraries, models, sources)


CC, ZIG_CPP = compiler(), [sys.executable, "-m", "ziglang", "c++"]
LANGUAGES = {
    "C99": [*CC, "-std=c99"],
    "C11": [*CC, "-std=c11"],
    "C++": [*CC, "-x", "c++"],
    "C++20": [*CC, "-x", "c++", "-std=c++20"],
    "C++ of zig": [*ZIG_CPP, "-x", "c++"],
}


#: The vehicle has contact by strips, whose C is hand-written. C11 is the language of its binary.
@pytest.mark.parametrize(
    ("language", "version"),
    [
        ("C99", 2),
        ("C++20", 3),
        *(pytest.param(*one, marks=pytest.mark.long) for one in (("C11", 2), ("C99", 3), ("C11", 3), ("C++20", 2))),
    ],
)
def test_largest_sources_are_what_every_language_takes(fmus: dict, tmp_path: Path, version: int, language: str) -> None:
    """The syntax check is fast. It finds name clashes and constructs that only one language allows."""
    folder = archive(fmus, LARGEST, version, tmp_path) / "sources"
    build(["-Wall", "-Wextra", "-Werror", "-fsyntax-only", "all.c"], folder, LANGUAGES[language])


#: The sources depend on the version only in the prefix, so that the suite has each language once.
OF_THE_SUITE = [("brake", 2 + place % 2, language) for place, language in enumerate(LANGUAGES)]
LONG = [one for one in product(FMUS, (2, 3), LANGUAGES) if one not in OF_THE_SUITE]


@pytest.mark.parametrize(
    ("name", "version", "language"), [*OF_THE_SUITE, *(pytest.param(*one, marks=pytest.mark.long) for one in LONG)]
)
def test_sources_compile_without_a_warning(fmus: dict, tmp_path: Path, name: str, version: int, language: str) -> None:
    """Only the functions of FMI are global symbols, so that any two FMUs can be linked."""
    folder = archive(fmus, name, version, tmp_path) / "sources"
    strict = ["-Wall", "-Wextra", "-Werror", "-c", "all.c", "-o", "all.o"]
    build([f"-DFMI{version}_FUNCTION_PREFIX=Other_", *strict], folder, LANGUAGES[language])
    if not shutil.which("nm"):
        pytest.skip("there is no nm that lists the names")
    listed = subprocess.run(["nm", "-g", "--defined-only", folder / "all.o"], capture_output=True, text=True).stdout
    strong = [line.split()[2] for line in listed.splitlines() if line.split()[1] != "W"]  # weak: inside <cmath>
    assert {f"Other_fmi{version}{name}" for name in ("DoStep", "SetContinuousStates")} <= set(strong)
    assert [name for name in strong if not name.startswith(f"Other_fmi{version}")] == []


@pytest.mark.study
@pytest.mark.parametrize("version", [2, 3])
def test_page_of_c_runs_the_fmu_opened_and_linked(fmus: dict, models: dict, tmp_path: Path, version: int) -> None:
    """The program in documentation/, compiled as its first lines specify, and FMPy agree to all digits."""
    folder = archive(fmus, "brake", version, tmp_path) / "documentation"
    [library] = (folder.parent / "binaries").rglob("BrakeCylinder.*")
    strict = ["-Wall", "-Wextra", "-Werror", "-I../sources", "host.c"]
    build([*strict, "-ldl", "-o", "opening"], folder)
    prefix = f"-DFMI{version}_FUNCTION_PREFIX=BrakeCylinder_"
    build([*compiling.FLAGS, "-O1", prefix, *strict, "../sources/all.c", "-lm", "-o", "linking"], folder)
    calls = [[folder / "opening", library], [folder / "linking"]]
    opening, linking = (
        subprocess.run([*call, "pressure_demand=180e3"], capture_output=True, text=True, check=True).stdout
        for call in calls
    )
    with FmuInstance(fmus["brake", "native"]) as brake:
        brake.start(pressure_demand=180e3)
        for n in range(100):
            brake.step(n * 0.01, 0.01)
        names = [models["brake"].variables[n].name for n in outputs(models["brake"])]
        expected = {name: brake[name] for name in names}
    assert {name: float(value) for name, value in (line.split() for line in opening.splitlines())} == expected
    assert linking == opening
    wrong = subprocess.run([folder / "linking", "presure=1"], capture_output=True, text=True)
    assert wrong.returncode == 1
    said = "A name must be that of a parameter or input in modelDescription.xml; got presure=1. Correct it.\n"
    assert wrong.stderr == said
