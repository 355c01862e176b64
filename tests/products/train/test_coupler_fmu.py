"""Coupler.fmu against the play operator in closed form, and against the train's coupler."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

import build_fmu
from fmu_src.cosimulation.faces import face_of
from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.train.coupler_fmu import coupler_fmu
from rbd_model.train.coupler import Coupler, Curve
from tests.fmu_src.fmi.hosting import sign

LOADING, UNLOADING, LOCKED = 5e6, 2e6, 60e6


@pytest.fixture(scope="module", params=[2, 3])
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build a coupler with straight loading and unloading lines, symmetric in both directions."""
    load, back = (Curve((0.0, 1.0), (0.0, stiffness)) for stiffness in (LOADING, UNLOADING))
    path = tmp_path_factory.mktemp("coupler") / f"{request.param}.fmu"
    write_in_c(coupler_fmu(Coupler("lines", LOCKED, (load, back), (load, back))), path, request.param)
    return path


def ways(path: Path, course: list[float]) -> list[tuple[float, float, float]]:
    """Return force, mean force and work after each displacement."""
    found = []
    with FmuInstance(path) as coupler:
        coupler.start()
        for n, way in enumerate(course):
            coupler.set(way=way)
            coupler.step(n * 0.1, 0.1)
            found.append((coupler["force"], coupler["mean_force"], coupler["work"]))
    return found


@pytest.mark.study
def test_it_is_valid(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []


def test_it_loads_sticks_and_yields_back(fmu: Path) -> None:
    """Load along k1 s, unload a little along K and then along k2 s. The same in compression."""
    for sense in (1.0, -1.0):
        course = [0.02 * sense, 0.0199 * sense, 0.01 * sense, 0.0]
        force = [one[0] for one in ways(fmu, course)]
        peak = LOADING * 0.02
        assert force == pytest.approx([sense * v for v in (peak, peak - LOCKED * 1e-4, UNLOADING * 0.01, 0.0)], abs=1.0)


def test_a_closed_way_costs_the_area_between_both_lines(fmu: Path) -> None:
    most = 0.02
    meets = (LOCKED - LOADING) * most / (LOCKED - UNLOADING)
    area = LOADING * most**2 / 2 - (LOADING * most + UNLOADING * meets) / 2 * (most - meets) - UNLOADING * meets**2 / 2
    course = [*np.linspace(0.0, most, 50), *np.linspace(most, 0.0, 50)]
    assert ways(fmu, course)[-1][2] == pytest.approx(area, rel=1e-3)


def test_apart_it_only_pushes(fmu: Path) -> None:
    with FmuInstance(fmu) as coupler:
        coupler.start(coupling_closed=0)
        for n, (way, due) in enumerate(((0.02, 0.0), (-0.02, -LOADING * 0.02), (0.02, 0.0))):
            coupler.set(way=way)
            coupler.step(0.1 * n, 0.1)
            assert coupler["force"] == pytest.approx(due, abs=1.0)


def test_a_saved_state_goes_back_with_its_friction(fmu: Path) -> None:
    with FmuInstance(fmu) as coupler:
        coupler.start()
        coupler.set(way=0.02)
        coupler.step(0.0, 0.1)
        kept = coupler.save()
        forces = []
        for _ in range(2):
            coupler.restore(kept)
            coupler.set(way=0.0199)
            coupler.step(0.1, 0.1)
            forces.append(coupler["force"])
    assert forces[0] == forces[1] != 0.0


def test_the_command_line_builds_the_ready_ones(tmp_path: Path) -> None:
    assert build_fmu.main(["coupler", "--coupler", "draft-gear", "--out", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.rglob("*.fmu")} == {"Coupler.fmu"}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda path: path.write_bytes(b""), "coupler.bin cannot be read"),
        (lambda path: path.write_bytes(path.read_bytes()[:-8]), "coupler.bin are damaged"),
        (lambda path: np.full(50, np.nan).tofile(path), "coupler.bin are damaged"),
        (lambda path: np.r_[np.fromfile(path)[:9], np.inf, np.fromfile(path)[10:]].tofile(path), "are damaged"),
        (lambda path: np.r_[np.fromfile(path)[:9], 1.001e15, np.fromfile(path)[10:]].tofile(path), "are damaged"),
        (lambda path: np.r_[np.fromfile(path)[:9], -1.001e15, np.fromfile(path)[10:]].tofile(path), "are damaged"),
    ],
)
def test_damaged_curves_give_no_instance_and_one_sentence(
    change: Callable[[Path], None], words: str, fmu: Path, tmp_path: Path
) -> None:
    said = list[str]()
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(tmp_path)
    change(tmp_path / "resources" / "coupler.bin")
    sign(tmp_path / "resources", "coupler.bin")
    face = face_of(read_model_description(str(fmu)), str(tmp_path), "coupler", said.append)
    with pytest.raises(Exception, match="Failed to instantiate"):
        face.instantiate()
    [sentence] = said
    assert words in sentence
    assert sentence.endswith("build the FMU again.")
