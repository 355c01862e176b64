"""Parameter sets and experiments in the FMUs: complete, and reproduced by a host."""

from __future__ import annotations

import hashlib
import sys
import zipfile
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.ssp.ssd import read_ssv
from lxml import etree

from fmu_src import references
from fmu_src.references import DIGITS, FOLDER, NAMESPACE, PAGE, reference_files
from products.building import NATIVE
from products.experiments import experiments_of
from products.parameter_sets import PARAMETER_SETS, set_files
from products.registry import DIFFERENT, FMUS, model_of
from rbd_model.track.friction import wet

#: Relative to the largest value of a column: half a unit of its last digit, and as much for rounding of times.
ROUNDED = 10.0 ** (1 - DIGITS)
#: Roles of the draft of FMI-LS-REF in use.
ROLES = {"parameter", "experiment/validation", "result", "other"}
SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"


Unpack = Callable[[tuple[str, str]], Path]


@pytest.fixture
def unpacked(fmus: Mapping, tmp_path: Path) -> Unpack:
    """Return a function that unpacks an FMU and returns the folder of its references."""

    def unpack(key: tuple[str, str]) -> Path:
        with zipfile.ZipFile(fmus[key]) as archive:
            archive.extractall(tmp_path)
        return tmp_path / FOLDER

    return unpack


def read_table(path: Path) -> np.ndarray:
    return np.genfromtxt(path, delimiter=",", names=True)


@pytest.mark.study
@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("name", DIFFERENT)
def test_manifest_lists_every_file_with_role_and_digest(unpacked: Unpack, name: str, kind: str) -> None:
    folder = unpacked((name, kind))
    root = etree.parse(folder / "fmi-ls-manifest.xml").getroot()
    prefixed = {key: root.get(f"{{{NAMESPACE}}}fmi-ls-{key}") for key in ("name", "version", "description")}
    assert prefixed["name"] == folder.name
    assert all(prefixed.values())
    names = [one.get("source") for one in root]
    assert sorted([*names, "fmi-ls-manifest.xml"]) == sorted(path.name for path in folder.iterdir())
    for one in root:
        assert one.get("role") in ROLES
        assert one.get("checksum") == hashlib.sha3_256((folder / one.get("source")).read_bytes()).hexdigest()
    assert (folder.parents[1] / PAGE).exists()
    assert Path(PAGE).name in (folder.parents[1] / "documentation" / "index.html").read_text()


@pytest.mark.parametrize("name", FMUS)
def test_there_are_five_sets_and_three_experiments(name: str) -> None:
    assert len([one for one in PARAMETER_SETS.values() if one.fmu == name]) >= 5
    assert len(experiments_of(name)) >= 3


@pytest.mark.study
@pytest.mark.parametrize("name", DIFFERENT)
def test_sets_and_experiments_are_inside(unpacked: Unpack, name: str) -> None:
    folder = unpacked((name, "native"))
    own = [one for one, about in PARAMETER_SETS.items() if about.fmu == name]
    assert all(read_ssv(str(folder / f"{one}.ssv")).name == one for one in own)
    assert len(etree.parse(folder / "experiments.exp").getroot()) == len(experiments_of(name))


def test_set_of_a_rail_is_that_of_its_source() -> None:
    """Polach (2005), Table 2, wet: mu0, A, B, k_A, k_S; the friction coefficient of all wheelsets."""
    values = PARAMETER_SETS["coach-wet-rail"].values()
    assert [values[f"friction_{n}"] for n in (1, 2, 3, 4)] == [0.3] * 4
    assert [values[name] for name in wet().law.values()] == [0.4, 0.2, 0.3, 0.1]
    assert "friction_2" not in PARAMETER_SETS["wheelset-chapter-4-wet-rail"].values()


def run(path: Path, folder: Path, experiment: etree._Element, **other: float) -> tuple[np.ndarray, np.ndarray]:
    """Return FMPy's results of an experiment, with `other` parameters, and the expected results."""
    simulation, parameters, stimuli, results = experiment
    assert [one.tag for one in experiment] == ["TransientSimulation", "Parameters", "Stimuli", "References"]
    values = {p.name: p.value for p in read_ssv(str(folder / parameters.get("source"))).parameters}
    expected, step = read_table(folder / results.get("source")), float(simulation.get("stepSize"))
    inputs = read_table(folder / stimuli.get("source"))
    found = simulate_fmu(
        str(path),
        start_time=float(simulation.get("startTime")),
        stop_time=float(simulation.get("stopTime")),
        step_size=step,
        output_interval=step,
        start_values=values | other,
        input=inputs if len(inputs.dtype) > 1 else None,
        output=expected.dtype.names[1:],
    )
    return found, expected


@pytest.mark.study
@pytest.mark.parametrize("kind", NATIVE)
@pytest.mark.parametrize("name", DIFFERENT)
def test_host_finds_the_results_of_every_experiment(fmus: Mapping, unpacked: Unpack, name: str, kind: str) -> None:
    folder = unpacked((name, kind))
    experiments = etree.parse(folder / "experiments.exp").getroot()
    assert [one.get("name") for one in experiments] == [one.name for one in experiments_of(name)]
    for experiment in experiments:
        found, expected = run(fmus[name, kind], folder, experiment)
        for column in expected.dtype.names:
            off = np.abs(found[column] - expected[column]).max()
            assert off <= ROUNDED * np.abs(expected[column]).max(), (experiment.get("name"), column)


def test_another_parameter_gives_other_results(fmus: Mapping, unpacked: Unpack) -> None:
    """The tolerance is narrow: it detects a change of the mass by 0.1 %."""
    folder = unpacked(("bogie", "native"))
    [experiment] = [one for one in etree.parse(folder / "experiments.exp").getroot() if one.get("name") == "stop"]
    found, expected = run(fmus["bogie", "native"], folder, experiment, frame_mass=60060.0)
    assert np.abs(found["distance"] - expected["distance"]).max() > 100 * ROUNDED * expected["distance"].max()


@pytest.mark.study
@pytest.mark.parametrize("name", ["brake", "rail"])
def test_results_are_the_same_with_another_compiler(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Archives must be identical on all build machines."""
    made = []
    for compiler in ("", f"{sys.executable} -m ziglang cc -mcpu=baseline"):
        if compiler:
            monkeypatch.setenv("CC", compiler)
        made.append(reference_files(model_of(name), set_files(name), experiments_of(name)))
    assert made[0] == made[1]


def test_fmu_without_sets_and_experiments_has_no_folder_for_them() -> None:
    assert reference_files(model_of("rail"), {}, []) == {}
    [only, _, _] = reference_files(model_of("rail"), {"one.ssv": b""}, [])
    assert only == f"{FOLDER}/one.ssv"


def test_numbers_are_rounded_to_the_largest_of_their_column() -> None:
    rows = np.genfromtxt(BytesIO(references.table(["a", "b"], [[1234.56789, -1e-12], [1e-9, 0.5]])), delimiter=",")
    assert rows[1:].tolist() == [[1234.568, 0.0], [0.0, 0.5]]
