"""The FMUs and the systems in third-party masters (FMPy, ecos, libcosim) and in fmutool's check.

All except FMPy are in the extra `masters`.
"""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from fmpy import read_model_description
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu

from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from fmu_src.ssp import Component, write_ssp
from fmu_src.start_values import FILE, with_start_values
from products.building import fmu_path, write_in_c
from products.machine import FULL_PRESSURE, FULL_TORQUE, coach
from products.registry import DIFFERENT
from products.systems import SLIDING_FRICTION, build_system
from products.train.coupler_fmu import coupler_fmu
from products.train.coupler_tables import coupler_named
from rbd_model.vehicle.parameters import manchester_vehicle_1
from tests.fmu_src.fmi.hosting import host
from tests.fmu_src.fmi.masters import MASTERS, master, parameters_of

#: Tolerance of the end speed by docs/checking.md [m/s].
SPEED_BAND = 1e-6
#: Relative difference between masters if a controller decides: FMPy passes it the first speeds one step later.
CONTROLLED_BAND = 1e-3
#: Largest slip of a protected wheel [1], assumed: the protection vents above 0.8 m/s (common_protection).
LARGEST_SLIP = 0.2


@pytest.fixture(scope="module")
def systems(fmus: dict, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return a function that writes a system by its name."""
    out = tmp_path_factory.mktemp("systems")
    for name in ("bogie", "brake", "braked-vehicle"):
        target = fmu_path(name, "native", out)
        target.parent.mkdir(exist_ok=True)
        shutil.copyfile(fmus[name, "native"], target)
    return cache(lambda name: build_system(name, out))


@cache
def in_fmpy(system: Path, step: float, count: int, outputs: tuple[tuple[str, str], ...]) -> list[float]:
    """Return FMPy's values, with which the other masters are compared."""
    return list(MASTERS["fmpy"](system, step, count, outputs))


@pytest.mark.study
@pytest.mark.parametrize("name", MASTERS)
def test_bogie_brakes_in_every_master(systems: Callable[[str], Path], name: str) -> None:
    outputs = (("bogie", "speed"), ("brake", "cylinder_pressure"))
    system = systems("BogieBraking")
    speed, pressure = master(name)(system, 1e-3, 1000, outputs)
    assert 2.0 < speed < 2.9
    assert pressure == pytest.approx(180e3, rel=0.05)
    expected = in_fmpy(system, 1e-3, 1000, outputs)
    assert speed == pytest.approx(expected[0], abs=SPEED_BAND)
    assert pressure == pytest.approx(expected[1], rel=1e-6)


@pytest.mark.study
@pytest.mark.parametrize("name", MASTERS)
def test_vehicle_brakes_in_every_master(systems: Callable[[str], Path], name: str) -> None:
    """The deceleration is the full brake torque over the mass, after the time in which the brakes apply."""
    system, count, step = systems("VehicleBraking"), 1000, 1e-2
    outputs = (("vehicle", "speed"), ("vehicle", "cylinder_pressure_4"))
    speed, pressure = master(name)(system, step, count, outputs)
    assert pressure == pytest.approx(FULL_PRESSURE, rel=1e-4)
    assert speed == pytest.approx(in_fmpy(system, step, count, outputs)[0], abs=SPEED_BAND)
    applying = 2.0 / 3.0  # mean delay of a cylinder that reaches 95 % after 2 s
    assert speed == pytest.approx(25.0 - coach().deceleration(FULL_TORQUE) * (10.0 - applying), rel=2e-3)


@pytest.mark.study
@pytest.mark.parametrize("name", MASTERS)
def test_protection_keeps_the_wheels_rolling_in_every_master(systems: Callable[[str], Path], name: str) -> None:
    wheels = [("vehicle", f"wheel_speed_{number}") for number in (1, 2, 3, 4)]
    outputs = (("vehicle", "distance"), ("vehicle", "speed"), *wheels)
    system = systems("VehicleProtection")
    distance, speed, *rolling = master(name)(system, 5e-3, 1000, outputs)
    assert min(rolling) > (1.0 - LARGEST_SLIP) * speed
    assert distance == pytest.approx(in_fmpy(system, 5e-3, 1000, outputs)[0], rel=CONTROLLED_BAND)


@pytest.mark.study
def test_a_master_that_reads_no_parameters_starts_with_those_of_the_system(systems: Callable[[str], Path]) -> None:
    """FMPy does not change values in the structure. With the FMUs' own defaults the distance would be 50 m instead of 5
    m.
    """
    system = systems("BogieBraking")
    alone = simulate_ssp(str(system), stop_time=5.0, step_size=5e-3)
    given = simulate_ssp(str(system), stop_time=5.0, step_size=5e-3, parameter_set=parameters_of(system))
    assert 4.0 < alone["bogie.distance"][-1] < 10.0
    for name in ("bogie.distance", "brake.cylinder_pressure"):
        assert (alone[name] == given[name]).all()


@pytest.mark.study
@pytest.mark.parametrize("name", ["BogieBraking", "VehicleBraking"])
def test_no_fmu_of_a_system_warns_as_it_starts(systems: Callable[[str], Path], name: str, tmp_path: Path) -> None:
    """A parameter without effect at the level would give a warning. Strict hosts treat a warning as an error."""
    with zipfile.ZipFile(systems(name)) as archive:
        archive.extractall(tmp_path)
    found = sorted(tmp_path.rglob("*.fmu"))
    assert found
    for fmu in found:
        with FmuInstance(fmu) as slave:
            slave.start()
            assert not [line for line in slave.messages if "no effect" in line], fmu.name


def test_start_values_in_the_resources_are_those_of_the_description_and_survive_a_reset(
    fmus: dict, tmp_path: Path
) -> None:
    path = tmp_path / "Brake.fmu"
    path.write_bytes(with_start_values(fmus["brake", "native"], {"pressure_demand": 180e3, "valve": 1}))
    assert validate_fmu(str(path)) == []
    described = {v.name: v.start for v in read_model_description(str(path)).modelVariables}
    assert (float(described["pressure_demand"]), int(described["valve"])) == (180e3, 1)
    with host(path) as brake:
        for _ in range(2):
            assert brake["pressure_demand"] == 180e3
            brake.fmu.reset()
    with pytest.raises(ValueError, match="has no variable pressure"):
        with_start_values(path, {"pressure": 1.0})


def test_start_values_are_read_as_all_tables_are(fmus: dict, tmp_path: Path) -> None:
    path = tmp_path / "Brake.fmu"
    shutil.copyfile(fmus["brake", "native"], path)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(
            f"resources/{FILE}", '\ufeff# by hand\r\n\r\npressure_demand; 180000,5 \r\n;\r\n"valve";1;\r\n'.encode()
        )
    with host(path) as brake:
        assert brake["pressure_demand"] == 180000.5


@pytest.mark.study
@pytest.mark.parametrize(
    "row", ["pressure,1", "pressure_demand", "pressure_demand,1 bar", "pressure_demand,-1", 999 * "x"]
)
def test_start_values_that_are_none_leave_no_instance(fmus: dict, tmp_path: Path, row: str) -> None:
    path = tmp_path / "Brake.fmu"
    shutil.copyfile(fmus["brake", "native"], path)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(f"resources/{FILE}", f"{row}\n")
    with pytest.raises(CosimulationError, match=r"start_values\.csv, row 1: |pressure_demand must be at least 0 Pa"):
        FmuInstance(path)


@pytest.mark.parametrize("row", ["way[2],0.1", "way[0],0.1", "way[1,0.1", "force,1", "way,11", "coupling_closed"])
def test_start_values_of_arrays_are_checked_as_those_of_a_host(tmp_path: Path, row: str) -> None:
    fmu = coupler_fmu(coupler_named("screw"))
    for rows, works in (("way[1],0.01\ncoupling_closed,0\n", True), (row, False)):
        path = tmp_path / "Coupler.fmu"
        write_in_c(replace(fmu, data={**fmu.data, FILE: rows.encode()}), path)
        if works:
            with FmuInstance(path) as coupler:
                assert coupler.get(["way", "coupling_closed"]) == [0.01, 0.0]
            continue
        with pytest.raises(CosimulationError, match=r"start_values\.csv, row 1: |way must be from -10 to 10 m; got 11"):
            FmuInstance(path)


def test_wheels_lock_on_that_rail_without_protection(fmus: dict) -> None:
    friction = {f"friction_{number}": SLIDING_FRICTION for number in (1, 2, 3, 4)}
    with FmuInstance(fmus["braked-vehicle", "native"], level=2, initial_speed=25.0) as vehicle:
        vehicle.start(**friction)  # a demand that is never set defaults to full braking
        for number in range(500):
            vehicle.step(number * 0.01, 0.01)
        assert vehicle["wheel_speed_1"] == 0.0
        assert vehicle["speed"] > 20.0


def test_wheel_speed_is_that_of_a_wheel_that_rolls(fmus: dict) -> None:
    with FmuInstance(fmus["braked-vehicle", "native"], level=1, initial_speed=10.0) as vehicle:
        vehicle.start()
        radius = manchester_vehicle_1().wheel_radius
        assert vehicle["wheel_speed_2"] == pytest.approx(radius * vehicle["angular_velocity_2"], rel=1e-15)
        assert vehicle["wheel_speed_2"] == pytest.approx(10.0, rel=1e-9)


@pytest.mark.study
@pytest.mark.skipif(
    importlib.util.find_spec("fmu_manipulation_toolbox") is None, reason="install the extra: pip install -e .[masters]"
)
@pytest.mark.parametrize("key", [(name, kind) for name in DIFFERENT for kind in ("native", "python")])
def test_fmutool_finds_no_fault(fmus: dict, key: tuple[str, str]) -> None:
    tool = Path(sys.executable).parent / "fmutool"
    done = subprocess.run([tool, "-input", str(fmus[key]), "-check"], capture_output=True, text=True)
    assert "This FMU seems to be compliant with FMI-2.0" in done.stdout + done.stderr


def test_parameter_that_does_not_exist_is_refused(fmus: dict, tmp_path: Path) -> None:
    component = Component("brake", fmus["brake", "native"], {"pressure": 1.0})
    with pytest.raises(ValueError, match="has no variable pressure"):
        write_ssp(tmp_path / "x.ssp", "x", [component], [], (1.0, 1e-3))
    assert list(tmp_path.iterdir()) == []
