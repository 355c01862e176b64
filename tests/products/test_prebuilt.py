"""Files compiled by a release are used as long as the sources would give the same ones."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from packaging.tags import platform_tags

import release
from bogie_braking.exit_status import BAD_INPUT
from bogie_braking.live import page as live
from brake_controller.cylinder import brake_cylinder
from brake_controller.parameters import qr30
from fmu_src import compile as compiling
from fmu_src.compile import library_suffix
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.kernel import Kernel, Library
from products import building, prebuilt
from products.controller_kinds import InC
from products.protection import rig_in_c

PLATFORM = next(tag for tag in platform_tags() if tag in release.WHEELS)


@pytest.fixture(scope="module")
def filled_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder as in a wheel, with the brake."""
    folder = tmp_path_factory.mktemp("prebuilt")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(release, "DIFFERENT", ["brake"])
        patch.setattr(release, "READY", {})
        release.fill(folder, PLATFORM)
    return folder


@pytest.fixture
def filled(filled_once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a copy of `filled_once`."""
    shutil.copytree(filled_once, tmp_path / "prebuilt")
    monkeypatch.setattr(prebuilt, "PREBUILT", tmp_path / "prebuilt")
    return tmp_path / "prebuilt"


def refuse(*_: object) -> None:
    raise AssertionError("This was to be left alone.")


@pytest.mark.study
def test_of_unchanged_sources_nothing_is_generated(filled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prebuilt, "content_of", refuse)
    monkeypatch.setattr(building, "_in_cache", refuse)
    path = building.up_to_date("brake", "native")
    assert path == filled / "native" / "brake.fmu"
    with FmuInstance(path) as brake:
        brake.start(pressure_demand=180e3)
        brake.step(0.0, 5.0)
        from_fmu = brake["brake_torque"]
    library = building.kernel_of("brake")
    assert library.is_relative_to(filled)
    kernel = Kernel(Library(library), pressure_demand=180e3)
    kernel.advance(5.0)
    assert kernel["brake_torque"] == from_fmu > 0.0


@pytest.mark.study
def test_the_protection_that_a_wheel_brings_needs_no_compiler(filled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rig_in_c, "plain_library", refuse)
    path = rig_in_c.library.__wrapped__()
    assert path.is_relative_to(filled)
    assert InC(path).functions(2).size > 0


@pytest.mark.study
def test_sources_that_make_the_same_are_recognised_by_what_they_make(
    filled: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For example, after a change of a comment."""
    monkeypatch.setattr(prebuilt, "digest", lambda *_: "another")
    assert building.up_to_date("brake", "native").is_relative_to(filled)


@pytest.mark.study
def test_what_was_changed_is_built(filled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The brake has other start values, and nothing except its sources shows it.

    It has a cache of its own: in that of the other tests its kernel would be taken for the brake's.
    """
    monkeypatch.setattr(compiling, "CACHE", tmp_path / "cache")
    monkeypatch.setattr(prebuilt, "digest", lambda *_: "another")
    for module in (prebuilt, building):
        monkeypatch.setattr(module, "model_of", lambda _: brake_cylinder(qr30(150)))
    path = building.up_to_date("brake", "native")
    assert path.name == "BrakeCylinder.fmu"
    for found in (path, building.kernel_of("brake")):
        assert not found.is_relative_to(filled)


def test_an_fmu_with_another_picture_is_another(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache that ignored images returned FMUs with outdated ones."""
    before = prebuilt.content_of("brake")
    shutil.copytree(prebuilt.PICTURES, tmp_path / "pictures")
    monkeypatch.setattr(prebuilt, "PICTURES", tmp_path / "pictures")
    assert prebuilt.content_of("brake") == before
    (tmp_path / "pictures" / "icon.png").write_bytes(b"another")
    assert prebuilt.content_of("brake") != before


def test_the_live_page_is_made_anew_when_a_source_of_it_has_changed(
    filled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(live, "page", lambda: "another")
    out = tmp_path / "live.html"
    assert live.write_page(out).read_bytes() == (filled / "live.html").read_bytes()
    monkeypatch.setattr(prebuilt, "digest", lambda *_: "another")
    assert live.write_page(out).read_text(encoding="utf-8") == "another"


def test_what_no_release_brings_is_built(filled: Path) -> None:
    assert prebuilt.prebuilt("brake", "fmi3/brake.fmu") is None
    assert prebuilt.prebuilt("rail", "native/rail.fmu") is None


def test_a_release_goes_into_an_empty_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine").write_text("")
    assert release.main(["--out", str(tmp_path)]) == 2
    assert "holds files. Empty it, or name another one." in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine"]


def test_checksums_are_those_of_the_files(tmp_path: Path) -> None:
    (tmp_path / "abc").write_bytes(b"abc")
    release.write_checksums(tmp_path)
    # FIPS 180-4, example with one block.
    known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert (tmp_path / "SHA256SUMS").read_text() == f"{known}  abc\n"


#: Without the packages of all extras, and with the files of a release in the folder of the first argument.
BARE = """
import sys
from importlib.abc import MetaPathFinder
from pathlib import Path

from readers import extras


class Missing(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in extras.EXTRAS:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


sys.meta_path.insert(0, Missing())
extras.find_spec = lambda name: None
from products import prebuilt

prebuilt.PREBUILT = Path(sys.argv[1])
import bogie_braking as bb
from bogie_braking.__main__ import main
from tests.bogie_braking.ready import run_all

run_all(["train", "consist", "curves"])
print(bb.run("brake", 5.0, pressure_demand=180e3)["brake_torque"][-1])
assert main(["doctor"]) == main(["build", "brake", "--describe"]) == 0
for refused in (lambda: bb.run("rail", 1.0), lambda: bb.cosimulate, lambda: bb.write_fmu("brake", "brake.fmu")):
    try:
        refused()
    except extras.MissingExtraError as error:
        print(error)
sys.exit(main(["run", "demo"]))
"""


def test_without_extras_and_a_compiler_ready_machines_run_and_others_name_the_extra(
    filled: Path, tmp_path: Path
) -> None:
    """A torque on the brake's full pressure is that of its kernel here, with all packages."""
    nothing = {"PATH": "", "CC": "", "BOGIE_BRAKING_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(release.ROOT)}
    call = [sys.executable, "-c", BARE, str(filled)]
    done = subprocess.run(call, cwd=tmp_path, env=nothing, capture_output=True, text=True)
    *_, rail, master, fmu = [line for line in done.stdout.splitlines() if "pip install" in line and "->" not in line]
    assert rail == "Equations that are not compiled need CasADi: pip install 'bogie-braking[build]'."
    assert master == fmu == "FMUs need FMPy: pip install 'bogie-braking[fmu]'."
    etcs, run = done.stderr.splitlines()
    assert etcs == "No picture. Figures need Matplotlib: pip install 'bogie-braking[plots]'."
    assert run == "FMUs need FMPy, figures need Matplotlib: pip install 'bogie-braking[fmu,plots]'."
    assert done.returncode == BAD_INPUT
    kernel = Kernel(Library(filled / "kernel" / f"brake{library_suffix()}"), pressure_demand=180e3)
    kernel.advance(5.0)
    assert f"\n{kernel['brake_torque']}\n" in done.stdout
    assert not list((tmp_path / "cache").rglob("*.so"))
