"""WheelSpeedSensor.fmu against the encoder of the test rig, and against the definition of a speed."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

import build_fmu
from brake_controller.sensors import LOWEST_FREQUENCY
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.building import write_in_c
from products.protection.sensor_fmu import sensor_fmu
from tests.encoder import Encoder

PERIOD, RADIUS = 5e-3, 0.5


@pytest.fixture(scope="module", params=[2, 3])
def fmu(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sensor") / f"{request.param}.fmu"
    write_in_c(sensor_fmu(2), path, request.param)
    return path


def rotation(time: float) -> float:
    """Rotation of a wheel [rad] that slows from 20 m/s by 4 m/s2."""
    return (20.0 * time - 2.0 * time**2) / RADIUS


def readings(path: Path, step: float, count: int, start: float = 0.0, **values: float) -> list[tuple[float, float]]:
    """Speeds of a wheel that slows and of one that stands, at the end of each step."""
    found = []
    with FmuInstance(path, wheel_radius=RADIUS, **values) as sensor:
        sensor.start(start)
        for n in range(count):
            sensor.set(rotation_1=rotation(n * step))
            sensor.step(start + n * step, step)
            found.append((sensor["wheel_speed_1"], sensor["wheel_speed_2"]))
    return found


def test_it_is_valid(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []


@pytest.mark.parametrize(
    "values", [{}, {"pulses": 300, "gate": 0.003}, {"pulses": 60, "timer": 1e-4}, {"lowest_frequency": 500.0}]
)
def test_it_reads_as_the_encoder_of_the_test_rig(fmu: Path, values: dict[str, float]) -> None:
    given = {"pulses": 100, "gate": 0.03, "timer": 1e-6, "lowest_frequency": LOWEST_FREQUENCY} | values
    encoder = Encoder(int(given["pulses"]), gate=given["gate"], resolution=given["timer"])
    encoder = replace(encoder, lowest_frequency=given["lowest_frequency"])
    expected = [RADIUS * encoder.angular_velocity(n * PERIOD, rotation(n * PERIOD)) for n in range(400)]
    found = readings(fmu, PERIOD, 400, **values)
    assert [one for one, _ in found] == expected
    assert {stands for _, stands in found} == {0.0}


def test_it_is_read_once_in_its_own_period(fmu: Path) -> None:
    encoder, found = Encoder(), [one for one, _ in readings(fmu, PERIOD, 400, period=2 * PERIOD)]
    times = [2 * PERIOD * n for n in range(200)]
    expected = [RADIUS * encoder.angular_velocity(time, rotation(time)) for time in times]
    assert found[::2] == found[1::2] == expected


def test_a_shorter_step_changes_nothing(fmu: Path) -> None:
    """It is read once a period; its output holds in between."""
    coarse, fine = ([one for one, _ in readings(fmu, PERIOD / parts, 100 * parts)] for parts in (1, 8))
    assert all(fine[k::8] == fine[::8] for k in range(8))
    assert fine[::8] == pytest.approx(coarse, rel=1e-9)


@pytest.mark.parametrize(("start", "band"), [(0.3, 1e-9), (1e6, 1e-8), (1.7e9, 5e-5)])
def test_another_start_time_changes_nothing(fmu: Path, start: float, band: float) -> None:
    """Doubles at 1.7e9 s are 2.4e-7 s apart, by which the times of edges err over a gate of 0.03 s."""
    expected = [one for one, _ in readings(fmu, PERIOD, 100)]
    assert [one for one, _ in readings(fmu, PERIOD, 100, start=start)] == pytest.approx(expected, rel=band)


def test_a_speed_is_right_to_the_timer_over_the_gate(fmu: Path) -> None:
    with FmuInstance(fmu, wheel_radius=RADIUS) as sensor:
        sensor.start()
        for n in range(100):
            sensor.set(rotation_1=31.0 / RADIUS * n * PERIOD)
            sensor.step(n * PERIOD, PERIOD)
        assert sensor["wheel_speed_1"] == pytest.approx(31.0, rel=1.01e-6 / 0.03)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"pulses": 0}, "pulses must be from 1 to 10000; got 0"),
        ({"gate": 0.0}, "gate must be from 0.0001 to 10 s; got 0"),
        ({"period": math.nan}, "period must be from 1e-05 to 1 s; got nan"),
        ({"wheel_radius": 460.0}, "wheel_radius must be from 0.1 to 2 m; got 460"),
    ],
)
def test_a_value_out_of_its_limits_is_refused(fmu: Path, values: dict[str, float], message: str) -> None:
    with FmuInstance(fmu) as sensor, pytest.raises(CosimulationError, match=message):
        sensor.start(**values)


def test_the_command_line_builds_it(tmp_path: Path) -> None:
    assert build_fmu.main(["sensor", "--wheelsets", "4", "--kind", "native", "--out", str(tmp_path)]) == 0
    with FmuInstance(tmp_path / "native" / "WheelSpeedSensor4.fmu") as sensor:
        assert sensor.units["wheel_speed_4"] == "m/s"


def test_it_measures_the_wheels_of_a_braked_bogie(fmu: Path, fmus: dict) -> None:
    """At a deceleration a the mean over a window w that ended t ago is a (w / 2 + t) too high; then the timer errs."""
    with FmuInstance(fmus["bogie", "native"], level=1, initial_speed=20.0, brake_torque_1=9e3) as bogie:
        radius = bogie["wheel_radius"]
        gate, pitch = 0.03, 2.0 * math.pi * radius / 100
        with FmuInstance(fmu, wheel_radius=radius) as sensor:
            bogie.start()
            sensor.start()
            for n in range(400):
                sensor.set(rotation_1=bogie["rotation_1"], rotation_2=bogie["rotation_2"])
                sensor.step(n * PERIOD, PERIOD)
                wheels = {number: radius * bogie[f"angular_velocity_{number}"] for number in (1, 2)}
                slows = -bogie["acceleration"]
                bogie.step(n * PERIOD, PERIOD)
                for number, true in wheels.items() if n > 40 else ():
                    late, timer = sensor[f"wheel_speed_{number}"] - true, true * 1e-6 / gate
                    least, most = slows * gate / 2, slows * ((gate + pitch / true) / 2 + pitch / true)
                    assert least - timer < late < most + timer
