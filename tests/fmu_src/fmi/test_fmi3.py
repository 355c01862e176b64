"""The FMI 3.0 interface of the same kernel, in FMPy."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

from fmu_src.model_description import TIME
from fmu_src.model_exchange import derivatives, indicators
from fmu_src.native_fmu import PLATFORMS3
from products import building
from products.building import write_fmu
from products.registry import DIFFERENT, model_of


@contextmanager
def open_fmi3(path: Path, early: bool = False) -> Iterator[tuple[FMU3Slave, dict[str, int], list[str]]]:
    """Yield an instance, its value references and its messages."""
    about = read_model_description(str(path))
    folder = extract(str(path))
    fmu = FMU3Slave(
        guid=about.guid,
        unzipDirectory=folder,
        modelIdentifier=about.coSimulation.modelIdentifier,
        instanceName="bogie",
    )
    said: list[str] = []
    fmu.instantiate(
        loggingOn=True, earlyReturnAllowed=early, logMessage=lambda env, status, kind, text: said.append(text.decode())
    )
    yield fmu, {v.name: v.valueReference for v in about.modelVariables}, said
    fmu.freeInstance()
    shutil.rmtree(folder)


def begin(fmu: FMU3Slave, refs: dict[str, int], level: int, **values: float) -> None:
    fmu.setInt32([refs["level"]], [level])
    for name, value in values.items():
        fmu.setFloat64([refs[name]], [value])
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()


@pytest.mark.study
@pytest.mark.parametrize("name", DIFFERENT)
def test_fmpy_finds_no_problem(fmus: dict, name: str) -> None:
    assert validate_fmu(str(fmus[name, "fmi3"])) == []
    about = read_model_description(str(fmus[name, "fmi3"]))
    assert about.fmiVersion == "3.0"
    model = model_of(name)
    shown = [*model.variables, TIME, *derivatives(model), *indicators(model)]
    assert {v.valueReference: v.name for v in about.modelVariables} == {n: v.name for n, v in enumerate(shown)}


@pytest.mark.parametrize("name", ["bogie", "brake"])
def test_both_standards_give_the_same_numbers(fmus: dict, name: str) -> None:
    values = {"bogie": {"brake_torque_1": 60e3, "initial_speed": 20.0}, "brake": {"pressure_demand": 1.5e5}}[name]
    outputs = {"bogie": ["speed", "rotation_1"], "brake": ["cylinder_pressure", "brake_torque"]}[name]
    tables = [
        simulate_fmu(str(fmus[name, kind]), stop_time=2.0, step_size=0.01, start_values=values, output=outputs)
        for kind in ("native", "fmi3")
    ]
    for output in outputs:
        assert np.abs(tables[0][output][-1] - tables[1][output][-1]) <= 1e-12 * np.abs(tables[0][output][-1])


def test_step_returns_early_where_a_wheelset_locks(fmus: dict) -> None:
    with open_fmi3(fmus["bogie", "fmi3"], early=True) as (fmu, refs, said):
        begin(fmu, refs, 2, brake_torque_1=60e3)
        _, ended, early, time = fmu.doStep(0.0, 5.0)
        assert early
        assert not ended
        assert 0.3 < time < 0.7
        assert fmu.getBoolean([refs["locked_1"]]) == [True]
        assert fmu.getFloat64([refs["time"]]) == [time]
        assert any(line.startswith("Wheelset 1 locked at 0.") for line in said)
        *_, early, after = fmu.doStep(time, 0.5)
        assert not early
        assert after == pytest.approx(time + 0.5)


def test_step_goes_on_where_no_early_return_is_allowed(fmus: dict) -> None:
    with open_fmi3(fmus["bogie", "fmi3"]) as (fmu, refs, _):
        begin(fmu, refs, 2, brake_torque_1=60e3)
        assert fmu.doStep(0.0, 5.0)[1:] == (False, False, 5.0)


@pytest.mark.study
@pytest.mark.parametrize("early", [True, False])
def test_derailment_ends_the_simulation_with_its_sentence(fmus: dict, early: bool) -> None:
    """With early return: OK and a request to terminate. Without: the step is discarded."""
    with open_fmi3(fmus["bogie", "fmi3"], early) as (fmu, refs, said):
        fmu.setInt32([refs["contact_model"], refs["wheel_lift_ends"], refs["constant_speed"]], [1, 0, 1])
        begin(fmu, refs, 3, initial_speed=10.0, flange_stiffness=1e6, yaw_torque_1=1.8e5)
        if early:
            _, ended, returned, time = fmu.doStep(0.0, 20.0)
            assert ended
            assert returned
            assert 0.0 < time < 20.0
        else:
            with pytest.raises(FMICallException):
                fmu.doStep(0.0, 20.0)
            [time] = fmu.getFloat64([refs["time"]])
            assert time == 0.0
        assert any("lost its tread contact" in line for line in said)
        assert fmu.getBoolean([refs["derailed"]]) == [early]
        with pytest.raises(FMICallException):  # a step beyond the end fails
            fmu.doStep(time, 20.0)
        if not early:
            fmu.doStep(time, 0.01)  # a step that ends before it succeeds


def test_saved_state_and_derivatives(fmus: dict) -> None:
    with open_fmi3(fmus["bogie", "fmi3"]) as (fmu, refs, _):
        begin(fmu, refs, 3, brake_torque_1=2e4)
        fmu.doStep(0.0, 0.5)
        state, found = fmu.getFMUState(), []
        for _ in range(2):
            fmu.setFMUState(state)
            fmu.doStep(0.5, 0.5)
            found.append(fmu.getFloat64([refs["speed"], refs["rotation_1"]]))
        assert found[0] == found[1]
        fmu.freeFMUState(state)
        [rate] = fmu.getOutputDerivatives([refs["speed"]], [1])
        assert rate == pytest.approx(fmu.getFloat64([refs["acceleration"]])[0], rel=1e-9)


def test_wrong_type_and_bad_value_are_refused_with_sentences(fmus: dict) -> None:
    with open_fmi3(fmus["bogie", "fmi3"]) as (fmu, refs, said):
        for call in (
            lambda: fmu.getFloat64([refs["level"]]),
            lambda: fmu.setFloat64([refs["wheelset_mass"]], [-1.0]),
            lambda: fmu.doStep(0.0, 0.1),
            lambda: fmu.setFloat64([refs["speed"]], [1.0]),
        ):
            with pytest.raises(FMICallException):
                call()
        assert "is not a variable of type Real" in said[0]
        assert "wheelset_mass must be at least" in said[1]
        assert "see the state machine of FMI 3.0" in said[2]
        assert "speed is an output" in said[3]


def test_page_speaks_of_its_own_standard(fmus: dict) -> None:
    for kind, own, other in (("native", "fmi2Discard", "fmi3"), ("fmi3", "fmi3Discard", "fmi2")):
        with zipfile.ZipFile(fmus["bogie", kind]) as archive:
            page = archive.read("documentation/index.html").decode()
        assert own in page
        assert other not in page


@pytest.mark.parametrize(
    "platforms",
    [
        pytest.param(["aarch64-darwin", "aarch64-linux"], id="two"),
        pytest.param(list(PLATFORMS3), id="all", marks=pytest.mark.long),
    ],
)
def test_one_archive_for_several_platforms_and_sources_that_are_listed(
    platforms: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(building, "PLATFORMS3", {name: PLATFORMS3[name] for name in platforms})
    path = write_fmu("brake", "fmi3", tmp_path, all_platforms=True)
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        for platform in platforms:
            assert f"binaries/{platform}/BrakeCylinder{PLATFORMS3[platform][1]}" in names
        text = archive.read("sources/buildDescription.xml").decode()
        for part in text.split('<SourceFile name="')[1:]:
            assert f"sources/{part.split(chr(34))[0]}" in names
        assert "terminalsAndIcons/icon.png" in names
    assert validate_fmu(str(path)) == []
