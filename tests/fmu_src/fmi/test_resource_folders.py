"""How an FMU finds its own files: by a URI in FMI 2.0, by a path in FMI 3.0. Other kinds of files in their place."""

from __future__ import annotations

import os
import shutil
import subprocess
import zipfile
from collections.abc import Callable
from ctypes import byref
from pathlib import Path
from urllib.parse import quote

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave, fmi3IntermediateUpdateCallback, fmi3LogMessageCallback

from fmu_src.codegen import RUNTIME
from fmu_src.compile import FLAGS, compiler
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.native_fmu import build_native_fmu, build_native_fmu3
from fmu_src.python_fmu import build_python_fmu
from fmu_src.system import System, Variable, model_of
from products.building import write_in_c
from products.train.coupler_fmu import coupler_fmu
from rbd_model.track.line_table import along_line
from rbd_model.train.coupler import screw_coupler

KINDS = ["native", "fmi3"]
NAMES = ["plain", "%7Babc%7D", "a%41b", "{abc}", "a b", "ü", "a#b?c", "100%", "%2F"]
CURVATURE, SPEED = 0.004, 7.0


def surveyor() -> System:
    """Return a system that outputs the curvature of the line in its file; speed is a parameter."""
    system = System("Surveyor", "looks at a line")
    speed = system.parameter(Variable("speed", "parameter", "m/s", "How fast", 1.0))
    place = system.state("distance", "m", 0.0, 1.0)
    system.derivative(place, speed)
    _, curvature = along_line(system, "heading", place, 1)
    system.output(Variable("shown", "output", "1/m", "Curvature"), curvature)
    return system


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str], Path]:
    folder, model = tmp_path_factory.mktemp("fmus"), model_of(surveyor(), 1e-6)
    paths = {(name, kind): folder / f"{name}_{kind}.fmu" for name in ("surveyor", "coupler") for kind in KINDS}
    build_native_fmu(model, paths["surveyor", "native"])
    build_native_fmu3(model, paths["surveyor", "fmi3"])
    paths["surveyor", "python"] = folder / "surveyor_python.fmu"
    build_python_fmu(model, paths["surveyor", "python"])
    for version, kind in enumerate(KINDS, 2):
        write_in_c(coupler_fmu(screw_coupler()), paths["coupler", kind], version)
    return paths


class Opened:
    """An instance of an FMU that receives `words` as its resource folder; `said` holds its messages."""

    def __init__(self, path: Path, folder: Path, words: str | None) -> None:
        about = read_model_description(str(path))
        given = {"guid": about.guid, "modelIdentifier": about.coSimulation.modelIdentifier}
        self.said: list[str] = []
        self.refs = {one.name: one.valueReference for one in about.modelVariables}
        self.three = about.fmiVersion == "3.0"
        names = (b"one", about.guid.encode(), None if words is None else os.fsencode(words))
        self.fmu = (FMU3Slave if self.three else FMU2Slave)(**given, unzipDirectory=str(folder), instanceName="one")
        if self.three:
            self.listen3 = fmi3LogMessageCallback(lambda e, s, c, text: self.said.append(text.decode()))
            flags, nobody = (False, True, False, False), (None, 0, None)
            self.component = self.fmu.fmi3InstantiateCoSimulation(
                *names, *flags, *nobody, self.listen3, fmi3IntermediateUpdateCallback()
            )
        else:
            self.calls = fmi2CallbackFunctions()
            self.calls.logger = fmi2CallbackLoggerTYPE(lambda *given: self.said.append(given[4].decode()))
            self.component = self.fmu.fmi2Instantiate(names[0], 1, *names[1:], byref(self.calls), 0, 1)
        self.fmu.component = self.component

    def __enter__(self) -> Opened:
        return self

    def __exit__(self, *_: object) -> None:
        if self.component:
            self.fmu.freeInstance()

    def start(self) -> None:
        if not self.three:
            self.fmu.setupExperiment()
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def __getitem__(self, name: str) -> float:
        return float((self.fmu.getFloat64 if self.three else self.fmu.getReal)([self.refs[name]])[0])


def unzipped(path: Path, folder: Path) -> Path:
    """Unpack an FMU; add start values and a line to a surveyor. Return the folder of its resources."""
    extract(str(path), str(folder))
    resources = folder / "resources"
    resources.mkdir(exist_ok=True)
    if path.name.startswith("surveyor"):
        (resources / "start_values.csv").write_text(f"speed,{SPEED}\n")
        (resources / "line.csv").write_text(
            f"distance,curvature,cant,gradient\n0,{CURVATURE},0,0\n10,{CURVATURE},0,0\n"
        )
    return resources


def named(kind: str, resources: Path) -> str:
    """Return the folder's name as the standard of this kind specifies it."""
    return f"{resources}/" if kind == "fmi3" else resources.as_uri()


def found(path: Path, folder: Path, words: str) -> None:
    """Check that the FMU finds its own files."""
    with Opened(path, folder, words) as one:
        assert one.component, one.said
        if "speed" in one.refs:
            assert one["speed"] == SPEED
            one.start()
            assert one["shown"] == pytest.approx(CURVATURE)


def refused(path: Path, folder: Path, words: str | None) -> str:
    """Check that no instance is made; return the only error message."""
    with Opened(path, folder, words) as one:
        assert not one.component
    [sentence] = one.said
    return sentence


@pytest.mark.study
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", ["surveyor", "coupler"])
def test_a_folder_of_any_name_is_found(what: str, kind: str, fmus: dict, tmp_path: Path) -> None:
    for name in NAMES:
        resources = unzipped(fmus[what, kind], tmp_path / name)
        found(fmus[what, kind], tmp_path / name, named(kind, resources))


@pytest.mark.parametrize("kind", [*KINDS, "python"])
def test_an_empty_text_selects_the_fmus_own_file(kind: str, fmus: dict, tmp_path: Path) -> None:
    """Hosts set each start value of modelDescription.xml, the empty text too."""
    own, other = (f"distance,curvature,cant,gradient\n0,{c},0,0\n10,{c},0,0\n" for c in (CURVATURE, 2 * CURVATURE))
    (tmp_path / "other.csv").write_text(other)
    path = Path(shutil.copyfile(fmus["surveyor", kind], tmp_path / "own.fmu"))
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("resources/line.csv", own)
    shown = []
    for texts in ([], [""], [str(tmp_path / "other.csv")], [str(tmp_path / "other.csv"), ""]):
        with FmuInstance(path) as one:
            for text in texts:
                one.set(line_file=text)
            one.start()
            shown.append(one["shown"] / CURVATURE)
    assert shown == pytest.approx([1.0, 1.0, 2.0, 1.0])


@pytest.mark.parametrize("what", ["surveyor", "coupler"])
def test_a_path_is_never_decoded(what: str, fmus: dict, tmp_path: Path) -> None:
    """The folder of the decoded name has another line and damaged curves."""
    resources, other = (unzipped(fmus[what, "fmi3"], tmp_path / name) for name in ("a%41b", "aAb"))
    for file in other.iterdir():
        file.write_bytes(b"speed,99\n" if file.name == "start_values.csv" else b"1")
    found(fmus[what, "fmi3"], tmp_path / "a%41b", str(resources))


#: Forms of the URI of an absolute path; each letter may be percent-encoded.
URIS: dict[str, Callable[[str], str]] = {
    "capital": lambda path: f"FILE://{quote(path)}",
    "this host": lambda path: f"file://LocalHost{quote(path)}",
    "no host": lambda path: f"file:{quote(path)}",
    "every letter": lambda path: "file://" + "".join(f"%{ord(one):02x}" if one != "/" else one for one in path),
    "trailing": lambda path: f"file://{quote(path)}///",
    "up and down": lambda path: f"file://{quote(path)}/../resources/.",
    "no URI": lambda path: path,
}


@pytest.mark.parametrize("words", URIS)
@pytest.mark.parametrize("what", ["surveyor", "coupler"])
def test_a_folder_is_found_by_each_form_of_its_uri(what: str, words: str, fmus: dict, tmp_path: Path) -> None:
    resources = unzipped(fmus[what, "native"], tmp_path / "a b")
    found(fmus[what, "native"], tmp_path / "a b", URIS[words](str(resources)))


@pytest.mark.parametrize("kind", KINDS)
def test_links_and_ways_back_lead_to_the_folder(kind: str, fmus: dict, tmp_path: Path) -> None:
    resources, path = unzipped(fmus["surveyor", kind], tmp_path / "own"), fmus["surveyor", kind]
    (tmp_path / "link").symlink_to(resources)
    (resources / "line.csv").rename(tmp_path / "elsewhere.csv")
    (resources / "line.csv").symlink_to(tmp_path / "elsewhere.csv")
    deep = tmp_path.joinpath(*["d" * 200] * 12)
    deep.mkdir(parents=True)
    (deep / "link").symlink_to(resources)
    for place in (tmp_path / "link", deep / "link", resources.parent / ".." / "own" / "resources"):
        found(path, tmp_path / "own", named(kind, place))


@pytest.mark.parametrize("what", ["surveyor", "coupler"])
@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("native", "http://example.org/resources"),
        ("native", "file://elsewhere/resources"),
        ("native", "file:///folder/a%00b"),
        ("fmi3", "file:///folder/own"),
    ],
)
def test_what_names_no_folder_here_is_refused(what: str, kind: str, words: str, fmus: dict, tmp_path: Path) -> None:
    sentence = refused(fmus[what, kind], extracted(fmus[what, kind], tmp_path), words)
    assert words in sentence.replace("%%", "%")
    assert "must be the " in sentence


def extracted(path: Path, folder: Path) -> Path:
    """Unpack the FMU into the folder; return the folder."""
    extract(str(path), str(folder))
    return folder


def is_loop(file: Path) -> None:
    file.symlink_to(file)


IN_PLACE: dict[str, tuple[Callable[[Path], object], str]] = {
    "a pipe": (lambda file: os.mkfifo(file), "is a folder, a pipe or a device"),
    "a folder": (Path.mkdir, "is a folder, a pipe or a device"),
    "a device": (lambda file: file.symlink_to("/dev/zero"), "is a folder, a pipe or a device"),
    "a loop": (is_loop, "cannot be opened"),
}


@pytest.mark.study
@pytest.mark.parametrize("place", IN_PLACE)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("what", "file"), [("surveyor", "start_values.csv"), ("surveyor", "line.csv"), ("coupler", "coupler.bin")]
)
def test_what_is_no_file_is_refused_at_once(
    what: str, file: str, kind: str, place: str, fmus: dict, tmp_path: Path
) -> None:
    make, words = IN_PLACE[place]
    resources = unzipped(fmus[what, kind], tmp_path)
    (resources / file).unlink()
    make(resources / file)
    sentence = refused(fmus[what, kind], tmp_path, named(kind, resources))
    assert f"{file} {words}" in sentence


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("what", ["surveyor", "coupler"])
def test_a_path_that_no_system_takes_is_told(what: str, kind: str, fmus: dict, tmp_path: Path) -> None:
    longest = Path("/" + "/".join(["d" * 200] * 40))
    assert "too long" in refused(fmus[what, kind], extracted(fmus[what, kind], tmp_path), named(kind, longest))


@pytest.mark.parametrize("kind", KINDS)
def test_no_folder_is_no_fault_where_nothing_is_asked_of_it(kind: str, fmus: dict, tmp_path: Path) -> None:
    with Opened(
        fmus["surveyor", kind], extracted(fmus["surveyor", kind], tmp_path), named(kind, tmp_path / "no")
    ) as one:
        assert one.component
        assert (one["speed"], one.said) == (1.0, [])


def test_drives_and_shares_of_windows(tmp_path: Path) -> None:
    """Compile the same C with Windows drives enabled."""
    program = (
        '#include "resources.h"\n'
        "int main(int count, char **texts) {\n"
        "    char path[200], problem[RESOURCES_PROBLEM];\n"
        "    for (int n = 1; n < count; ++n) puts(resources_of_uri(texts[n], path, problem) ? path : problem);\n"
        "    return 0;\n}\n"
    )
    (tmp_path / "drives.c").write_text(program)
    made = [*compiler(), *FLAGS, "-DRESOURCES_ON_DRIVES=1", f"-I{RUNTIME}", "drives.c", "-o", "drives"]
    subprocess.run(made, cwd=tmp_path, check=True)
    given = {
        "file:///C:/a%20b/resources": "C:/a b/resources",
        "file:///c|/a/": "c:/a",
        "file://C:/a": "C:/a",
        "file:C:/a": "C:/a",
        "FILE://localhost/D:/a%41/": "D:/aA",
        "file://server/share/a": "//server/share/a",
        "C:\\a\\resources\\": "C:\\a\\resources",
    }
    done = subprocess.run([tmp_path / "drives", *given], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == [*given.values()]


def test_pythonfmu_fmus_open_in_a_folder_of_any_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """pythonfmu's binary decodes blanks only. If it finds no module it ends the process. FmuInstance adds the path."""
    system = System("Still", "stands")
    system.output(Variable("one", "output", "1", "One"), 1.0 + 0.0 * system.state("x", "1", 0.0, 1.0))
    system.derivative(next(iter(system.states.values())).symbol, 0.0 * system.time)
    build_python_fmu(model_of(system, 1e-6), tmp_path / "Still.fmu")
    for name in NAMES:
        (tmp_path / name).mkdir()
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path / name))
        with FmuInstance(tmp_path / "Still.fmu") as one:
            one.start()
            assert one["one"] == 1.0
