"""The parameter sets as files: valid, complete, with units, and accepted by their FMUs."""

from __future__ import annotations

from pathlib import Path

import pytest
from fmpy.ssp.ssd import ParameterSet, read_ssv

from build_fmu import main
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.parameter_file import parameter_file
from products.parameter_sets import PARAMETER_SETS, set_files, write_sets
from products.registry import ALIKE, FMUS, model_of
from rbd_model.vehicle.ready import loaded_coal_wagon, passenger_coach, two_axle_bogie, wheelset_under_frame


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, ParameterSet]:
    """Return the files as read by FMPy, validated against the schema of SSP 1.0."""
    out = tmp_path_factory.mktemp("sets")
    write_sets(list(FMUS), out)
    return {path.stem: read_ssv(str(path)) for path in (out / "parameters").iterdir()}


@pytest.mark.study
def test_every_set_is_written_under_its_name(files: dict[str, ParameterSet]) -> None:
    assert files.keys() == PARAMETER_SETS.keys()
    assert all(one.name == name for name, one in files.items())


@pytest.mark.study
def test_every_vehicle_has_its_set(files: dict[str, ParameterSet]) -> None:
    for vehicle in (two_axle_bogie(), wheelset_under_frame(), passenger_coach(), loaded_coal_wagon()):
        own = vehicle.parameters.values()
        written = [{p.name: float(p.value) for p in one.parameters} for one in files.values()]
        assert any(one == {name: own.get(name) for name in one} for one in written), vehicle.name


@pytest.mark.study
@pytest.mark.parametrize("name", PARAMETER_SETS)
def test_fmu_takes_its_set_and_gives_it_back(fmus: dict, files: dict[str, ParameterSet], name: str) -> None:
    fmu = PARAMETER_SETS[name].fmu
    expected = PARAMETER_SETS[name].values()
    values = {p.name: float(p.value) for p in files[name].parameters}
    assert values == expected
    with FmuInstance(fmus[ALIKE.get(fmu, fmu), "native"], **values) as slave:
        assert {p.name: p.unit for p in files[name].parameters if p.unit} == {
            p.name: slave.units[p.name] for p in files[name].parameters if p.type == "Real"
        }
        slave.start()
        slave.step(0.0, 0.01)
        assert {key: slave[key] for key in values} == values


def test_parameter_of_another_fmu_is_refused() -> None:
    with pytest.raises(ValueError, match="The parameter set odd has frame_mass, which is not a variable of the FMU"):
        parameter_file("odd", "", {"frame_mass": 1.0}, model_of("brake").variables)


def test_sets_are_the_same_in_every_build() -> None:
    assert set_files("brake") == set_files("brake")


def test_command_writes_the_sets_of_its_fmu(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["brake", "--kind", "native", "--out", str(tmp_path)]) == 0
    written = sorted(path.stem for path in (tmp_path / "parameters").iterdir())
    assert written == sorted(name for name, one in PARAMETER_SETS.items() if one.fmu == "brake")
    assert f"{tmp_path / 'parameters'}  {len(written)} parameter sets (.ssv)" in capsys.readouterr().out
