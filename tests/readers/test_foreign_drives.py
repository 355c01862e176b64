"""Motors and dynamic brakes of other programs: forces at speeds, by hand from files that are written here."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from products.train.consist_file import consist_of
from products.train.train import Train
from readers.formats.trains import read_foreign
from readers.import_account import Imported
from readers.text import FileError

#: Pound-force [N], mile per hour [m/s], horsepower [W] (NIST SP 811).
POUND, MILE, HORSE = 4.4482216152605, 0.44704, 745.69987158227
ENGINE = """SIMISA@@@@@@@@@@JINX0D0t______
Wagon ( power Type ( Engine ) Size ( 3m 4m 19m ) Mass ( 84t ) BrakeSystemType ( "Air_single_pipe" )
	MaxBrakeForce ( 60kN ) )
Engine ( power Type ( Electric ) %s )
"""
CURVES = """MaxForce ( 320kN ) MaxPower ( 5600kW )
	ORTSMaxTractiveForceCurves ( 0 ( 0 0 50 0 ) 0.5 ( 0 100000 50 10000 ) 1 ( 0 300000 10 250kN 44.704mph 50000lbf ) )
	DynamicBrakeForceCurves ( 0 ( 0 0 60 0 ) 1 ( 0 0 5 150000 60 40000 ) ) DynamicBrakesMaximumForce ( 999kN )"""
STOCK: dict[str, Any] = {
    "name": "unit", "length": 75.0, "mass": 150000.0, "inertia_coefficient": 1.05, "const_gamma": 0.9,
    "rolling_resistance": {"type": "davis", "A": 1500.0, "B": 30.0, "C": 3.0},
}  # fmt: skip
LOCOMOTIVES = """loco_con:
  loco_vec:
  - mass: 195000
    force_max_newtons: 600000
    loco_type:
      BatteryElectricLoco:
        edrv: {pwr_out_max_watts: 3300000.0}
  - mass: 195000
"""
RAILML = """<railml xmlns="http://www.railml.org/schemas/2013"><rollingstock version="2.2"><vehicles>
<vehicle id="v" length="19" bruttoWeight="84" vehicleCategory="locomotive"><engine><propulsion><tractiveEffort>
<valueTable xValueUnit="km/h" yValueUnit="kN"><valueLine xValue="0"><value yValue="300"/></valueLine>
<valueLine xValue="80"><value yValue="230"/></valueLine><valueLine xValue="160"><value yValue="110"/></valueLine>
</valueTable></tractiveEffort></propulsion></engine></vehicle></vehicles></rollingstock></railml>"""


def read(folder: Path, name: str, text: str) -> Imported:
    (folder / name).write_text(text, encoding="utf-8")
    return read_foreign(folder / name)


def told(found: Imported, kind: str, words: str) -> bool:
    return any(words in sentence for sentence in getattr(found, kind))


def forces(found: Imported, command: str, output: str, speeds: list[float]) -> np.ndarray:
    """Return an output of all vehicles together at speeds [m/s] with a whole command, after its rise."""
    total = []
    for speed in speeds:
        rows = [
            row | {"traction_rise": 0.0} if "traction_table" in row or "traction_force" in row else row
            for row in found.rows
        ]
        rows = [
            row | {"dynamic_rise": 0.0} if "dynamic_table" in row or "dynamic_force" in row else row for row in rows
        ]
        train = Train(consist_of(rows), speed=speed)
        train.inputs[command], train.inputs["friction"] = 1.0, 1.5
        train.advance(1e-6)
        total.append(float(getattr(train, output).sum()))
    return np.array(total)


def test_open_rails_has_its_force_up_to_its_power(tmp_path: Path) -> None:
    found = read(tmp_path, "power.eng", ENGINE % "MaxForce ( 60000lbf ) MaxPower ( 4000hp )")
    due = [min(60000 * POUND, 4000 * HORSE / v) for v in (2.0, 20.0)]
    assert forces(found, "traction", "traction_force", [2.0, 20.0]) == pytest.approx(due, rel=1e-8)
    assert told(found, "taken", "MaxForce, MaxPower -> traction_force")
    alone = read(tmp_path, "alone.eng", ENGINE % "MaxPower ( 4000hp )")
    assert "traction_power" not in alone.rows[0]
    assert told(alone, "left", "MaxPower: motors need both")


def test_curves_of_open_rails_are_those_of_the_highest_position(tmp_path: Path) -> None:
    """Speeds are m/s and forces N where no unit is written; 44.704 mph are 19.985 m/s."""
    found = read(tmp_path, "power.eng", ENGINE % CURVES)
    places, values = [0.0, 10.0, 44.704 * MILE], [300e3, 250e3, 50000 * POUND]
    due = [*np.interp([1.0, 5.0, 15.0], places, values), values[2] * places[2] / 30.0]
    assert forces(found, "traction", "traction_force", [1.0, 5.0, 15.0, 30.0]) == pytest.approx(due, rel=1e-6)
    due = list(np.interp([2.0, 30.0], [0.0, 5.0, 60.0], [0.0, 150e3, 40e3]))
    assert forces(found, "dynamic_brake", "brake_force", [2.0, 30.0]) == pytest.approx(due, rel=1e-6)
    for words in ("MaxForce, MaxPower: the curve", "curves of lower positions", "DynamicBrakesMaximumForce and its"):
        assert told(found, "left", words)


def test_a_curve_that_cannot_be_read_is_left_out(tmp_path: Path) -> None:
    for curve in ("1 ( 0 1e5 5 )", "1 ( 5 1e5 0 1e5 )", "1 ( 0 1e5 1e-9 9e4 )", "1 ( 0 1e5 5 -3 )"):
        found = read(tmp_path, "power.eng", ENGINE % f"ORTSMaxTractiveForceCurves ( {curve} )")
        assert "traction_table" not in found.rows[0]
        assert told(found, "left", "ORTSMaxTractiveForceCurves: it is not ")
    for curve in ("1 ( 0 one 5 2 )", "1 ( 0 1e5 5mach 2 )"):
        with pytest.raises(FileError, match="ORTSMaxTractiveForceCurves must be numbers in "):
            read(tmp_path, "power.eng", ENGINE % f"ORTSMaxTractiveForceCurves ( {curve} )")


def test_an_effort_curve_of_osrd_is_shared_by_the_vehicles_of_the_unit(tmp_path: Path) -> None:
    """A hyperbola of 41 points is kept within 3 % of the largest force by 8 of them, and this is reported."""
    speeds = np.linspace(0.0, 40.0, 41)
    efforts = np.minimum(200e3, 2e6 / np.maximum(speeds, 1.0))
    curve = {"speeds": speeds.tolist(), "max_efforts": efforts.tolist()}
    stock = STOCK | {"effort_curves": {"modes": {"25000V": {"default_curve": curve}}}}
    found = read(tmp_path, "unit.json", json.dumps(stock))
    at = [3.0, 12.0, 25.5, 39.0]
    own = forces(found, "traction", "traction_force", at)
    assert own == pytest.approx([min(200e3, 2e6 / v) for v in at], abs=0.03 * 200e3)
    assert sum(row.get("count", 1) for row in found.rows) > 1
    assert told(found, "converted", "8 of 41 points; the force deviates by up to ")
    assert told(found, "assumed", "the force is shared by all vehicles")
    light = read(tmp_path, "light.json", json.dumps(stock | {"inertia_coefficient": 1.0}))
    assert told(light, "left", "Motors: the file states no rotating mass")
    assert all("traction_table" not in row for row in light.rows)
    two = {"a": {"default_curve": curve}, "b": {"default_curve": curve}}
    assert told(read(tmp_path, "two.json", json.dumps(stock | {"effort_curves": {"modes": two}})), "left", "several")


def test_a_locomotive_of_altrios_needs_its_force_and_its_drivetrain(tmp_path: Path) -> None:
    found = read(tmp_path, "train.yaml", LOCOMOTIVES)
    assert [row.get("traction_force") for row in found.rows] == [600.0, None]
    assert found.rows[0]["traction_power"] == 3300.0
    assert told(found, "left", "Motors of a locomotive: they need force_max")


def test_a_table_of_tractive_effort_of_railml_is_read(tmp_path: Path) -> None:
    found = read(tmp_path, "loco.xml", RAILML)
    assert found.rows[0]["traction_table"] == "0:300 80:230 160:110"
    due = [np.interp(36.0, [0.0, 80.0], [300e3, 230e3])]
    assert forces(found, "traction", "traction_force", [10.0]) == pytest.approx(due, rel=1e-6)
