"""An ordinary installation (a release's wheel in an empty environment, away from the checkout) runs and builds."""

from __future__ import annotations

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import time
import venv
import zipfile
from collections.abc import Iterator, Mapping
from email import message_from_bytes
from importlib.metadata import distribution, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.tags import platform_tags

import release
from bogie_braking.exit_status import BAD_INPUT, DOES_NOT_HOLD
from bogie_braking.live.page import page
from fmu_src import __version__
from fmu_src.compile import CACHE, compiler
from fmu_src.native_fmu import PLATFORMS
from products.sources import HOUSE, ROOMS
from readers.extras import EXTRAS
from readers.toml_files import toml_of
from scenarios.catalogue import EVIDENCE, SCENARIOS

#: The compiled FMU of the scenario that these tests run; a release compiles more.
FMUS = ["wheelset"]
OWN = next(tag for tag in platform_tags() if tag in release.WHEELS)

#: The cache and the compiler of all tests; the compiler is that of an extra if the system has none.
HERE = {"BOGIE_BRAKING_CACHE": str(CACHE), "CC": " ".join(compiler())}
#: Largest size of the packages without extras, with the files that Python compiled [bytes].
MOST_SIZE = 400e6


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder with the sdist, the universal wheel and the wheel for this platform."""
    out = tmp_path_factory.mktemp("release")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(release, "DIFFERENT", FMUS)
        patch.setattr(release, "READY", {})
        release.write_wheels([OWN], out)
    return out


def environment(place: Path) -> Path:
    """Create an empty environment and return its Python."""
    venv.create(place)
    return place / ("Scripts" if os.name == "nt" else "bin") / "python"


def install(wheels: Path, python: Path, *how: str) -> None:
    """Install the wheel of this platform and its requirements into an environment, by the pip of this one."""
    [wheel] = wheels.glob(f"*{OWN}.whl")
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--no-compile"]
    call = [*pip, "--disable-pip-version-check", *how, str(wheel)]
    subprocess.run(call, check=True, capture_output=True, text=True, cwd=python.parent)


def asked_for(wheel: Path, *extras: str) -> set[str]:
    """Return the names of all packages that a wheel requires, direct and indirect, with those of its extras."""
    with zipfile.ZipFile(wheel) as packed:
        [name] = [one for one in packed.namelist() if one.endswith(".dist-info/METADATA")]
        waiting = list(message_from_bytes(packed.read(name)).get_all("Requires-Dist") or [])
    found = {"bogie-braking"}
    while waiting:
        one = Requirement(waiting.pop())
        wanted = one.marker is None or any(one.marker.evaluate({"extra": extra}) for extra in ("", *extras))
        if one.name not in found and wanted:
            found.add(one.name)
            waiting += [text for text in requires(one.name) or [] if "extra ==" not in text]
    return found - {"bogie-braking"}


def link_packages(names: set[str], folder: Path) -> None:
    """Link packages of this environment into a folder, with the compiled files of Python; copies across disks."""
    for one in map(distribution, names):
        for file in one.files or []:
            if ".." in file.parts:
                continue
            target = folder / file
            target.parent.mkdir(parents=True, exist_ok=True)
            try:
                os.link(one.locate_file(file), target)
            except OSError:
                shutil.copy2(str(one.locate_file(file)), target)


@pytest.fixture(scope="module")
def installed(wheels: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the Python of an installation whose requirements are already there, so that pip fetches nothing.

    It has the extras of scenarios except `pages`.
    """
    folder = tmp_path_factory.mktemp("installation")
    python = environment(folder / "environment")
    [wheel] = wheels.glob(f"*{OWN}.whl")
    link_packages(asked_for(wheel, "equations", "fmu", "pythonfmu", "plots"), packages_of(python, folder))
    install(wheels, python, "--no-index")
    return python


def contents(folder: Path) -> dict[str, tuple[int, int]]:
    """Return the size and time of each file below a folder; files compiled by Python itself are left out."""
    files = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {str(path.relative_to(folder)): (path.stat().st_size, path.stat().st_mtime_ns) for path in files}


def call(python: Path, folder: Path, *arguments: str, status: int = 0, **variables: str) -> str:
    """Run the environment's Python in a folder with its own home and the common cache; return its output."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= HERE | {"HOME": str(folder)} | variables
    done = subprocess.run([python, *arguments], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout + done.stderr


def packages_of(python: Path, folder: Path) -> Path:
    where = "import sysconfig; print(sysconfig.get_path('purelib'))"
    return Path(call(python, folder, "-c", where).strip())


@pytest.fixture
def no_compiler(tmp_path: Path) -> Mapping[str, str]:
    """Return variables that hide every compiler: PATH is empty, and the environment lacks the compiler's extra."""
    return {"PATH": str(tmp_path / "empty"), "CC": "", "BOGIE_BRAKING_CACHE": str(tmp_path / "cache")}


@pytest.fixture
def plotly(tmp_path: Path) -> Mapping[str, str]:
    """Return variables with which Python finds the packages of the extra `pages`, which the test environment has."""
    (tmp_path / "pages").mkdir()
    for one in map(distribution, ("plotly", "narwhals")):
        for name in {file.parts[0] for file in one.files or []} - {".."}:
            (tmp_path / "pages" / name).symlink_to(str(one.locate_file(name)))
    return {"PYTHONPATH": str(tmp_path / "pages")}


@pytest.mark.study
def test_wheel_runs_a_scenario_without_a_compiler_and_is_left_as_it_was(
    installed: Path, no_compiler: Mapping[str, str], plotly: Mapping[str, str], tmp_path: Path
) -> None:
    packages = packages_of(installed, tmp_path)
    before = contents(packages)
    shown = call(installed, tmp_path, "-m", "bogie_braking", "run", "critical-speed", **no_compiler)
    assert "DOES NOT HOLD" not in shown
    assert (tmp_path / "results" / "critical-speed" / "figure.png").exists()
    call(installed, tmp_path, "-m", "bogie_braking", "live", **no_compiler)
    assert (tmp_path / "results" / "live.html").read_text(encoding="utf-8") == page()
    assert not [path for path in (tmp_path / "cache").rglob("*") if path.suffix in (".c", ".o", ".so", ".dll")]
    # Pages need only their extra and what the wheel requires.
    pages = ("-m", "bogie_braking", "run", "creep-forces", "--html")
    shown = call(installed, tmp_path, *pages, status=BAD_INPUT, **no_compiler)
    assert shown == "A page of results needs Plotly: pip install 'bogie-braking[pages]'.\n"
    assert not (tmp_path / "results" / "creep-forces").exists()
    shown = call(installed, tmp_path, *pages, status=DOES_NOT_HOLD, **no_compiler, **plotly)
    assert "report.html" in shown
    call(installed, tmp_path, "-m", "bogie_braking", "report", **no_compiler, **plotly)
    assert "creep-forces/report.html" in (tmp_path / "results" / "index.html").read_text(encoding="utf-8")
    # This shows that the guard works: a model outside the wheel has to be compiled, which fails here.
    shown = call(installed, tmp_path, "-m", "bogie_braking", "run", "qr30-180kpa", status=3, **no_compiler)
    assert "There is no C compiler on this machine" in shown
    assert "pip install 'bogie-braking[compiler]'" in shown
    shown = call(installed, tmp_path, "-m", "bogie_braking", "doctor", **no_compiler)
    assert f"ok       prebuilt FMUs: wheelset for {OWN}" in shown
    assert "without  C compiler" in shown
    assert contents(packages) == before


@pytest.mark.study
def test_an_installation_is_light(wheels: Path) -> None:
    """CasADi, FMPy, Matplotlib and compilers are extras; NumPy and SciPy are 200 MB."""
    [wheel] = wheels.glob(f"*{OWN}.whl")
    names = asked_for(wheel)
    assert {"numpy", "scipy"} <= names
    assert not names & set(EXTRAS)
    files = [file.locate() for name in names for file in distribution(name).files or []]
    assert 100e6 < sum(path.stat().st_size for path in map(Path, map(str, files)) if path.exists()) < MOST_SIZE


@pytest.mark.study
def test_installed_package_builds_fmus_and_is_left_as_it_was(installed: Path, tmp_path: Path) -> None:
    packages = packages_of(installed, tmp_path)
    before = contents(packages)
    assert not (packages / "tests").exists()
    shown = call(installed, tmp_path, "-m", "bogie_braking", "build", "brake")
    assert shown.count("valid") == 3
    kinds = {path.parent.name for path in (tmp_path / "build").rglob("BrakeCylinder.fmu")}
    assert kinds == {"native", "fmi3", "python"}
    assert contents(packages) == before


@pytest.mark.study
def test_installed_package_is_the_one_that_runs(installed: Path, tmp_path: Path) -> None:
    """The checkout is on the path of the tests but not of this Python; the command equals the module."""
    place = call(installed, tmp_path, "-c", "import bogie_braking; print(bogie_braking.__file__)").strip()
    assert Path(place).is_relative_to(installed.parents[1])
    assert call(installed, tmp_path, "-m", "bogie_braking", "--version") == f"bogie-braking {__version__}\n"
    command = installed.with_name("bogie-braking" + installed.suffix)
    done = subprocess.run([command, "list", "--quiet"], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "qr30-180kpa" in done.stdout.splitlines()


@pytest.mark.study
def test_a_wheel_brings_one_name_and_minds_no_folder_of_the_user(installed: Path, tmp_path: Path) -> None:
    """A user's folder with the name of one of our packages hides none of them."""
    files = "print(*importlib.metadata.files('bogie-braking'), sep='\\n')"
    names = call(installed, tmp_path, "-c", f"import importlib.metadata; {files}").splitlines()
    info = f"bogie_braking-{__version__}.dist-info"
    assert {Path(name).parts[0] for name in names} - {".."} == {"bogie_braking", info}
    assert [name for name in names if name.startswith("..")] == ["../../../bin/bogie-braking"]
    assert not [name for name in names if "comparisons" in name]
    for room in (*ROOMS, "tests", "build_fmu"):
        (tmp_path / room).mkdir()
        (tmp_path / room / "__init__.py").write_text("raise ImportError('This is the folder of a user.')\n")
    assert "qr30-180kpa" in call(installed, tmp_path, "-m", "bogie_braking", "list")
    assert "usage: bogie-braking build" in call(installed, tmp_path, "-m", "bogie_braking", "build", "--help")


@pytest.mark.study
@pytest.mark.parametrize("part", ["begin", pytest.param("whole", marks=pytest.mark.long)])
def test_the_page_of_the_public_face_runs_from_a_wheel(installed: Path, tmp_path: Path, part: str) -> None:
    """Run its blocks in order and compare their output. The part `begin`: runs, lines, own vehicles, controllers.

    tests/docs/test_pages_run.py runs all of them from the checkout.
    """
    page = (ROOT / "docs" / "public.md").read_text(encoding="utf-8")
    if part == "begin":
        page = page[: page.index("```python\nbogie = bb.Simulation(")]
        assert all(f"bb.{name}(" in page for name in ("run", "line_of", "vehicle", "write_fmu", "protected_stops"))
    blocks = re.findall(r"^```(\w+)\n(.*?)^```$", page, re.DOTALL | re.MULTILINE)
    (tmp_path / "page.py").write_text("".join(text for kind, text in blocks if kind == "python"), encoding="utf-8")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment |= HERE | {"HOME": str(tmp_path)}
    done = subprocess.run([installed, "page.py"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "".join(text for kind, text in blocks if kind == "text")


@pytest.mark.study
@pytest.mark.parametrize("name", ["stop", "hunting"])
def test_a_notebook_runs_from_a_wheel(installed: Path, tmp_path: Path, name: str) -> None:
    """The other one needs the extra `gym`; tests/docs/test_pages_run.py runs it from the checkout."""
    notebook = json.loads((ROOT / "docs" / "notebooks" / f"{name}.ipynb").read_text(encoding="utf-8"))
    code = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    (tmp_path / "notebook.py").write_text("\n".join(code), encoding="utf-8")
    call(installed, tmp_path, "notebook.py", MPLBACKEND="Agg")


@pytest.mark.study
def test_comparisons_with_other_programs_need_a_checkout(installed: Path, tmp_path: Path) -> None:
    listed = call(installed, tmp_path, "-m", "bogie_braking", "list", "--quiet").split()
    assert {one.name for one in SCENARIOS} - set(listed) == set(EVIDENCE)
    shown = call(installed, tmp_path, "-m", "bogie_braking", "run", "throughput", status=BAD_INPUT)
    assert shown.startswith("throughput needs a checkout")


@pytest.mark.study
def test_a_wheel_that_is_uninstalled_leaves_nothing(wheels: Path, tmp_path: Path) -> None:
    python = environment(tmp_path / "environment")
    packages = packages_of(python, tmp_path)
    before = {path.name for path in packages.iterdir()}
    install(wheels, python, "--no-deps", "--no-index")
    assert {path.name for path in packages.iterdir()} - before == {
        "bogie_braking",
        f"bogie_braking-{__version__}.dist-info",
    }
    pip = [sys.executable, "-m", "pip", "--python", str(python), "--disable-pip-version-check"]
    subprocess.run([*pip, "uninstall", "--quiet", "--yes", "bogie-braking"], check=True, capture_output=True)
    assert {path.name for path in packages.iterdir()} == before


@pytest.mark.study
def test_a_release_made_again_is_the_same(wheels: Path, tmp_path: Path) -> None:
    """The second release is made in another folder at another time and is identical byte for byte."""
    release.write_wheels([], tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {path.name for path in wheels.iterdir() if OWN not in path.name}
    assert len(names) == 2
    for name in names:
        assert (tmp_path / name).read_bytes() == (wheels / name).read_bytes(), name


ROOT = Path(release.__file__).parent
#: Packages whose absence has one message (`readers/extras.py`, `evidence/peers/sundials.py: is_installed`).
LOOKED_FOR = {"sksundae", *EXTRAS}
#: Other programs of the benchmark: `version` of each adapter checks its package, and a wheel has no adapters.
LOOKED_FOR |= {"altrios", "exudyn", "libsumo", "pandas", "sumo", "transportation_ai999x"}


def imported_without_a_way_out(body: list[ast.stmt]) -> Iterator[str]:
    """Yield the packages that statements import without a message for the case that they are missing."""
    for node in body:
        guarded = isinstance(node, ast.Try) and "ImportError" in ast.unparse(node.handlers)
        for_types = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        if guarded or for_types:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module.split(".")[0]
        for inner in ("body", "orelse", "finalbody"):
            yield from imported_without_a_way_out(getattr(node, inner, []))


@pytest.mark.study
def test_what_is_imported_without_a_way_out_is_installed_with_the_rest() -> None:
    """No command needs an extra without a message about it."""
    asked = {Requirement(text).name for text in requires("bogie-braking") or [] if "extra ==" not in text}
    files = [path for package in HOUSE for path in (ROOT / package).rglob("*.py") if "hosts" not in path.parts]
    found = {
        name for path in files for name in imported_without_a_way_out(ast.parse(path.read_text(encoding="utf-8")).body)
    }
    others = found - set(sys.stdlib_module_names) - {*HOUSE, "build_fmu"} - LOOKED_FOR
    assert {"jinja2", "scipy"} <= others
    assert others <= asked


def test_a_message_about_a_missing_package_names_the_extra_that_brings_it() -> None:
    extras = toml_of(ROOT / "pyproject.toml")["project"]["optional-dependencies"]

    def brought(extra: str) -> set[str]:
        own = [Requirement(text) for text in extras[extra]]
        return {one.name for one in own} | {
            name for one in own for inner in one.extras & {*extras} for name in brought(inner)
        }

    for package, (extra, _) in EXTRAS.items():
        assert package in brought(extra), f"{package} is not in {extra}"


@pytest.mark.long
def test_archive_holds_the_fmus_for_all_platforms_sets_and_systems(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(release, "FMUS", ["brake", "bogie"])
    release.write_fmus(tmp_path)
    [path] = tmp_path.iterdir()
    with zipfile.ZipFile(path) as archive:
        names = set(archive.namelist())
        with zipfile.ZipFile(archive.open("native/BogieDynamics.fmu")) as fmu:
            inside = {name.split("/")[1] for name in fmu.namelist() if name.startswith("binaries/")}
    fmus = {f"{kind}/{name}.fmu" for kind in ("native", "fmi3") for name in ("BogieDynamics", "BrakeCylinder")}
    fmus |= {f"{kind}/WheelSpeedSensor{n}.fmu" for kind in ("native", "fmi3") for n in ("", "4")}
    fmus |= {f"{kind}/BrakingCurves.fmu" for kind in ("native", "fmi3")}
    assert names >= {"LICENSE", "BogieBraking.ssp", "parameters/bogie-qr30.ssv", *fmus}
    assert inside == set(PLATFORMS)


@pytest.mark.long
@pytest.mark.parametrize("place", release.WHEELS.values())
def test_ready_machines_are_in_the_lanes_of_each_processor(
    place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ARM has two doubles in a vector, x86-64 up to eight."""
    name, machine = next(iter(release.READY.items()))
    monkeypatch.setattr(release, "READY", {name: machine})
    release.fill_machines(tmp_path, *PLATFORMS[place])
    lanes = {path.name.split("-")[-2] for path in tmp_path.rglob("*-lanes*")}
    assert lanes == ({"2"} if place == "aarch64-linux" else {"2", "4", "8"})


@pytest.mark.long
def test_from_an_empty_machine_to_all_that_is_ready(tmp_path: Path) -> None:
    """The whole wheel of this platform is reproducible, and runs `ready.py` without extras and a compiler."""
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        release.write_wheels([OWN], tmp_path / folder)
    [one, two] = (next((tmp_path / folder).glob(f"*{OWN}.whl")).read_bytes() for folder in ("one", "two"))
    assert one == two
    begin = time.perf_counter()
    python = environment(tmp_path / "environment")
    install(tmp_path / "one", python)
    ready = time.perf_counter()
    no_compiler = {"PATH": "", "CC": "", "BOGIE_BRAKING_CACHE": str(tmp_path / "cache")}
    call(python, tmp_path, str(ROOT / "tests" / "bogie_braking" / "ready.py"), **no_compiler)
    done = time.perf_counter()
    assert done - ready < 30.0
    assert done - begin < 90.0
