"""A model or page built from unchanged sources is found in the cache; any other is built again."""

from __future__ import annotations

import ast
import shutil
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from brake_controller.cylinder import brake_cylinder
from brake_controller.parameters import qr30
from fmu_src import compile as compiling
from fmu_src.cached_files import CHECKSUM
from fmu_src.system import Model, System
from products import build_notes, building, module_files
from products.module_files import files_of, imports_of
from products.prebuilt import PAGE_SOURCES
from products.promised_variables import TABLE
from products.registry import FMUS, Fmu, model_of
from products.sources import KINDS, ROOMS, ROOT
from rbd_model.levels import models
from rbd_model.vehicle.description import Vehicle


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a cache with only the rail kernel's objects, as all tests here compile the same files."""
    folder = tmp_path_factory.mktemp("objects")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiling, "CACHE", folder)
        building.kernel_of("rail")
    for path in folder.iterdir():
        if not path.name.endswith((".o", f".o{CHECKSUM}")):
            path.unlink()
    return folder


@pytest.fixture
def made(objects: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """Set up a cache without libraries and notes; return a function that counts how often equations were generated."""
    written: list[str] = []
    model_of = building.model_of

    def counted(name: str) -> object:
        written.append(name)
        return model_of(name)

    shutil.copytree(objects, tmp_path / "cache")
    monkeypatch.setattr(compiling, "CACHE", tmp_path / "cache")
    monkeypatch.setattr(building, "model_of", counted)
    return lambda: len(written)


@pytest.mark.study
def test_equations_are_written_once(made: Callable[[], int]) -> None:
    first = building.kernel_of("rail")
    once = made()
    assert building.kernel_of("rail") == first
    assert made() == once > 0


@pytest.mark.study
def test_changed_sources_are_written_again(made: Callable[[], int], monkeypatch: pytest.MonkeyPatch) -> None:
    building.kernel_of("rail")
    once = made()
    monkeypatch.setattr(build_notes, "digest_of", lambda *_: "others")
    building.kernel_of("rail")
    assert made() == 2 * once


@pytest.mark.parametrize(
    ("changed", "of_the_bogie", "of_the_brake"),
    [
        ("docs/train.md", False, False),
        ("products/kernel_runs.py", False, False),
        ("products/train/train.py", False, False),
        ("brake_controller/cylinder.py", False, True),
        ("rbd_model/contact/creep/polach.py", True, False),
        ("rbd_model/contact/strips.c", True, False),
        ("fmu_src/runtime/integrate.c", True, True),
        ("fmu_src/hosts/host.c", True, True),
        ("fmu_src/python_slave.py", True, True),
        ("products/registry.py", True, True),
    ],
)
def test_what_is_written_again_hangs_on_a_changed_file(changed: str, of_the_bogie: bool, of_the_brake: bool) -> None:
    """A model depends on the imports of its function, on C and data next to them, and on fmu_src, but on no page."""
    maker = building.build_library.__module__
    found = (files_of(FMUS[name].model.__module__, maker) for name in ("bogie", "brake"))
    assert (ROOT / changed).is_file()
    assert [ROOT / changed in files for files in found] == [of_the_bogie, of_the_brake]


@pytest.mark.study
def test_imports_are_read_as_python_reads_them() -> None:
    for room in ROOMS:
        for path in (ROOT / room).rglob("*.py"):
            named = set()
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ImportFrom):
                    named |= {node.module or "", *(f"{node.module}.{one.name}" for one in node.names)}
            assert imports_of(path) == {file for one in named for file in module_files._files_of(one)}, path


@pytest.mark.study
def test_another_compiler_is_asked_again(made: Callable[[], int], monkeypatch: pytest.MonkeyPatch) -> None:
    building.kernel_of("rail")
    once = made()
    monkeypatch.setattr(build_notes, "compiler", lambda: ["another"])
    building.kernel_of("rail")
    assert made() == 2 * once


@pytest.mark.study
def test_a_file_that_is_gone_is_made_again(made: Callable[[], int]) -> None:
    first = building.kernel_of("rail")
    first.unlink()
    assert building.kernel_of("rail") == first
    assert first.exists()


def test_a_note_that_was_not_finished_counts_for_nothing(made: Callable[[], int], tmp_path: Path) -> None:
    first = building.kernel_of("rail")
    [note] = (tmp_path / "cache").glob("*.made")
    note.write_text("")
    assert building.kernel_of("rail") == first


def test_a_model_that_other_sources_write_is_never_remembered(
    made: Callable[[], int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Changes of such sources, in a test or in a user's file, are not detected."""
    monkeypatch.setitem(FMUS, "rail", Fmu("", lambda: brake_cylinder(qr30(150))))
    building.kernel_of("rail")
    once = made()
    building.kernel_of("rail")
    assert made() == 2 * once > 0


def test_every_file_that_an_fmu_or_the_live_page_is_made_from_is_looked_at() -> None:
    """Other files than Python count too: a host in C#, an image, a style. The interface baseline is excluded."""
    found = (path for place in PAGE_SOURCES for path in (ROOT / place).rglob("*") if path != TABLE)
    places = [path for path in found if path.is_file()]
    kinds = {path.suffix for path in places if "__pycache__" not in path.parts and "prebuilt" not in path.parts}
    assert kinds == KINDS


def test_units_are_those_of_the_variables() -> None:
    units = building.units_of("brake")
    assert units == {variable.name: variable.unit for variable in building.model_of("brake").variables}


def test_a_model_is_written_once_however_many_threads_ask(monkeypatch: pytest.MonkeyPatch) -> None:
    """CasADi supports one thread that generates equations; several crash or hang the process with an empty cache."""
    begun, writing = [], threading.Semaphore()

    def slow() -> Model:
        begun.append(threading.get_ident())
        assert writing.acquire(blocking=False), "two threads write at once"
        time.sleep(0.05)
        writing.release()
        return brake_cylinder()

    monkeypatch.setitem(FMUS, "slow", Fmu("", slow))
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(model_of, ["slow"] * 4))
    assert len(begun) == 1
    assert all(model is found[0] for model in found)


@pytest.mark.study
def test_levels_are_written_by_one_thread_whichever_ask_which_serves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cases call it in threads: `thesis-step` crashed when two threads generated the bogie's equations."""
    writing, written = threading.Semaphore(), models.levels

    def slow(vehicle: Vehicle) -> tuple[System, ...]:
        assert writing.acquire(blocking=False), "two threads write at once"
        time.sleep(0.05)
        found = written(vehicle)
        writing.release()
        return found

    monkeypatch.setattr(models, "levels", slow)
    models._names_of_levels.cache_clear()
    with ThreadPoolExecutor(4) as pool:
        chosen = list(pool.map(models.recommend_level, [["brake_torque_1"]] * 4, [["axle_load_1"]] * 4))
    assert [choice.level for choice in chosen] == [2] * 4
