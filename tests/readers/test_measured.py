"""Test measured runs: names and units of a logger become those of variables."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fmu_src.cosimulation.measured import in_units_of, table_from
from fmu_src.cosimulation.recording import Recording

UNITS = {"time": "s", "speed": "m/s", "pressure_demand_1": "Pa"}


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "cp1252"])
def test_a_log_in_other_units_is_that_in_si(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    heads = "Speed [km/h];Pressure demand 1 (bar);Time [ms];Temp [\u00b0C]"
    path.write_bytes(f"{heads}\r\n72,0;3,5;5000;20\r\n36,0;3,6;5500;20\r\n;;;\r\n".encode(encoding))
    log = in_units_of(table_from(path), UNITS)
    assert log.units == {"time": "s", "speed": "m/s", "pressure_demand_1": "Pa", "Temp": "\u00b0C"}
    assert log["time"].tolist() == [5.0, 5.5]
    assert log["speed"].tolist() == [20.0, 10.0]
    assert log["pressure_demand_1"].tolist() == [350e3, 360e3]


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    run = Recording({"time": "s", "speed": "m/s", "torque (rear)": "N.m"}, np.arange(6.0).reshape(2, 3) / 7)
    read = table_from(run.write(tmp_path / "run.csv"))
    assert read.units == run.units
    for name in run.names:
        np.testing.assert_allclose(read[name], run[name], rtol=1e-9)


def test_units_of_another_quantity_stay_to_be_refused() -> None:
    log = Recording({"time": "s", "speed": "kPa"}, [[0.0, 1.0], [1.0, 1.0]])
    assert in_units_of(log, UNITS).units == log.units
