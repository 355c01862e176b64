"""Lines in FMUs: from a string, from the resources, invalid, saved, in both versions of FMI."""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Mapping
from pathlib import Path

import pytest
from fmpy import read_model_description, simulate_fmu

from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from fmu_src.kernel import Kernel, Library
from rbd_model.track.line import arc, clothoid, line_of, straight

SPACE = {"level": 3, "initial_speed": 15.0}
SEEN = ("speed", "distance", "lateral_1", "yaw_2", "wheel_load_1_left")


@pytest.fixture
def curve(tmp_path: Path) -> Path:
    before, behind = straight(20), arc(200, 400, 0.05, 0.01)
    return line_of([before, clothoid(40, before, behind), behind]).write(tmp_path / "curve.csv")


def run(path: Path, **values: float | str) -> list[float]:
    """Return the outputs SEEN after 6 s."""
    with FmuInstance(path, **(SPACE | values)) as bogie:
        bogie.start()
        for number in range(6):
            bogie.step(float(number), 1.0)
        return bogie.get(SEEN)


@pytest.mark.parametrize("kind", ["native", "python"])
def test_an_fmu_runs_on_the_line_that_a_string_names(
    fmus: Mapping[tuple[str, str], Path], bogie: Library, curve: Path, kind: str
) -> None:
    kernel = Kernel(bogie, line_file=str(curve), **SPACE)
    kernel.initialise()
    for number in range(6):
        kernel.step(float(number), 1.0)
    found = run(fmus["bogie", kind], line_file=str(curve))
    assert found == pytest.approx([kernel[name] for name in SEEN], rel=1e-12, abs=1e-15)
    assert found[2] < -1e-3
    assert found != pytest.approx(run(fmus["bogie", kind]))


def test_a_line_among_the_resources_is_the_first_one(
    fmus: Mapping[tuple[str, str], Path], curve: Path, tmp_path: Path
) -> None:
    """The line needs no parameter. A reset and an empty string restore it."""
    path = tmp_path / "bogie on a line.fmu"
    shutil.copyfile(fmus["bogie", "native"], path)
    with zipfile.ZipFile(path, "a") as archive:
        archive.write(curve, "resources/line.csv")
    assert run(path) == run(fmus["bogie", "native"], line_file=str(curve))
    level = line_of([straight(500.0)]).write(tmp_path / "level.csv")
    with FmuInstance(path, **SPACE, line_file=str(level)) as one:
        one.start()
        one.restart(SPACE)
        one.step(0.0, 6.0)
        assert one["lateral_1"] < -1e-3
    remedy = r"or contact_model to 2, or remove resources/line\.csv"
    with (
        FmuInstance(path, **SPACE, contact_model=3, line_file="") as one,
        pytest.raises(CosimulationError, match=remedy),
    ):
        one.start()


def test_a_bad_line_among_the_resources_leaves_no_instance(
    fmus: Mapping[tuple[str, str], Path], tmp_path: Path
) -> None:
    path = tmp_path / "bad.fmu"
    shutil.copyfile(fmus["bogie", "native"], path)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("resources/line.csv", "distance,curvature,cant,gradient\n0,1,0,0\n")
    with pytest.raises(CosimulationError, match=r"line\.csv, row 2, column curvature: .* got '1' 1/m"):
        FmuInstance(path)


def test_a_bad_line_is_refused_with_its_row(fmus: Mapping[tuple[str, str], Path], tmp_path: Path, curve: Path) -> None:
    bad = tmp_path / "bad.csv"
    bad.write_text("distance,curvature,cant,gradient\n0,0,0,0\n1,0.5,0,0\n")
    with FmuInstance(fmus["bogie", "native"], **SPACE) as one:
        one.set(line_file=str(curve))
        with pytest.raises(CosimulationError, match=r"row 3, column curvature: .*0.5"):
            one.set(line_file=str(bad))
        one.start()
        one.step(0.0, 6.0)
        assert one["lateral_1"] < -1e-3
        with pytest.raises(CosimulationError, match="fixed once the run has begun"):
            one.set(line_file="")


def test_depths_that_no_line_has_are_refused(fmus: Mapping[tuple[str, str], Path], curve: Path) -> None:
    with (
        FmuInstance(fmus["bogie", "native"], **SPACE, contact_model=3, line_file=str(curve)) as one,
        pytest.raises(CosimulationError, match="Set level to 1 or 2, or contact_model to 2, or line_file to no text"),
    ):
        one.start()


def test_a_saved_state_goes_back_on_its_line_alone(fmus: Mapping[tuple[str, str], Path], curve: Path) -> None:
    path = fmus["bogie", "native"]
    with FmuInstance(path, **SPACE, line_file=str(curve)) as one, FmuInstance(path, **SPACE) as other:
        for slave in (one, other):
            slave.start()
            slave.step(0.0, 3.0)
        state = one.save()
        one.step(3.0, 2.0)
        ahead = one.get(SEEN)
        one.restore(state)
        one.step(3.0, 2.0)
        assert one.get(SEEN) == ahead
        with pytest.raises(CosimulationError, match="one on another line"):
            other.restore(state)
        one.forget(state)


def test_fmi_3_takes_a_line_as_well(fmus: Mapping[tuple[str, str], Path], curve: Path) -> None:
    path = str(fmus["bogie", "fmi3"])
    start = {"level": 3, "initial_speed": 15.0, "line_file": str(curve)}
    found = simulate_fmu(path, stop_time=6.0, output_interval=1.0, start_values=start, output=["lateral_1", "speed"])
    straight_on = simulate_fmu(
        path, stop_time=6.0, output_interval=1.0, start_values=start | {"line_file": ""}, output=["lateral_1"]
    )
    assert found["lateral_1"][-1] < -1e-3 < straight_on["lateral_1"][-1]
    variable = next(v for v in read_model_description(path).modelVariables if v.name == "line_file")
    assert variable.type == "String"


#: Outputs that describe the steady state of a vehicle in a curve.
STANDING = ("lateral_1", "lateral_2", "yaw_1", "guiding_force_1", "wheel_load_1_left", "wheel_load_2_right")


@pytest.mark.parametrize("kind", ["native", "fmi3", "python"])
def test_an_fmu_starts_in_the_steady_state_of_its_curve(
    fmus: Mapping[tuple[str, str], Path], bogie: Library, tmp_path: Path, kind: str
) -> None:
    """The first outputs are those of the kernel's steady state with a brake applied."""
    path = str(line_of([arc(200.0, 400.0, 0.05)], -10.0).write(tmp_path / "curve.csv"))
    kernel = Kernel(bogie, line_file=path, brake_torque_1=1e3, **SPACE)
    kernel.initialise()
    start = SPACE | {"line_file": path, "brake_torque_1": 1e3}
    found = simulate_fmu(
        str(fmus["bogie", kind]),
        fmi_type="CoSimulation",
        stop_time=0.01,
        output_interval=0.01,
        start_values=start,
        output=STANDING,
    )
    expected = [kernel[name] for name in STANDING]
    assert [found[name][0] for name in STANDING] == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert expected[0] < -5e-3


@pytest.mark.parametrize("kind", ["native", "fmi3"])
def test_model_exchange_starts_in_the_steady_state_of_its_gradient(
    fmus: Mapping[tuple[str, str], Path], tmp_path: Path, kind: str
) -> None:
    """The bogie rolls freely downhill: it does not oscillate, and its acceleration is constant."""
    path = str(line_of([straight(400.0, -0.02)], -10.0).write(tmp_path / "down.csv"))
    found = simulate_fmu(
        str(fmus["bogie", kind]),
        fmi_type="ModelExchange",
        stop_time=2.0,
        output_interval=0.1,
        relative_tolerance=1e-8,
        start_values={"initial_speed": 20.0, "line_file": path},
        output=["acceleration", "pitch"],
    )
    assert found["acceleration"] == pytest.approx(found["acceleration"][0], rel=1e-4)
    assert found["pitch"] == pytest.approx(found["pitch"][0], abs=1e-7)
    assert found["acceleration"][0] > 0.18


def test_a_start_without_a_steady_state_is_refused(fmus: Mapping[tuple[str, str], Path], tmp_path: Path) -> None:
    path = str(line_of([arc(200.0, 100.0)], -10.0).write(tmp_path / "curve.csv"))
    with (
        FmuInstance(fmus["bogie", "native"], level=3, initial_speed=40.0, line_file=path) as one,
        pytest.raises(CosimulationError, match="no steady state of rolling freely where it starts on its line at 0 s"),
    ):
        one.start()


def test_a_model_without_a_line_takes_no_text(fmus: Mapping[tuple[str, str], Path]) -> None:
    with (
        FmuInstance(fmus["brake", "native"]) as brake,
        pytest.raises(CosimulationError, match="not a variable of type String"),
    ):
        brake._call(brake.fmu.setString, [0], ["line.csv"])
