"""Trains of OSRD, ALTRIOS, OpenBVE and railML: numbers by hand from files that are written here, and damaged files."""

from __future__ import annotations

import json
import os
import re
import sys
from importlib import import_module
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from readers.formats import trains
from readers.formats.openbve import motor_cars
from readers.formats.trains import FORMATS, GROUP, read_foreign
from readers.formats.vehicle_rows import LONGEST
from readers.import_account import Imported
from readers.text import FileError

#: Acceleration of gravity [m/s2] and density of air [kg/m3] in the numbers by hand.
G, AIR = 9.80665, 1.225
#: Density of air of OpenBVE, at 20 degC (Atmosphere.cs) [kg/m3].
WARM = 101325 * 0.0289644 / (8.31447 * 293.15)
#: Speeds of the resistances that are compared [m/s].
SPEEDS = (0.0, 15.0, 30.0)
#: Rows have 10 significant digits.
ROUNDED = 1e-9

OSRD: dict[str, Any] = {
    "railjson_version": "3.3",
    "name": "Freight train",
    "length": 750.0,
    "mass": 2090000.0,
    "max_speed": 38.9,
    "inertia_coefficient": 1.048,
    "const_gamma": 0.3,
    "primary_category": "FREIGHT_TRAIN",
    "rolling_resistance": {"type": "davis", "A": 2508.0, "B": 67.7, "C": 10.8},
    "effort_curves": {"modes": {}},
}
CAR = """---
car_type: Coal_Loaded
freight_type: Coal_Loaded
length_meters: 18.0
axle_count: 4
brake_count: 1
mass_static_base_kilograms: 28500.0
mass_freight_kilograms: 101500.0
speed_max_meters_per_second: 20.0
braking_ratio: 0.11
mass_rot_per_axle_kilograms: 750.0
bearing_res_per_axle_newtons: 40.26
rolling_ratio: 1.546e-3
davis_b_seconds_per_meter: 1.0e-5
cd_area_square_meters: 4.087
curve_coeff_0: 0.056
"""
BVE = """OPENBVE
#PERFORMANCE
4.2      ; deceleration
0.35
0
0.0025
1.2
#DELAY
0,0.1
0,0.1
0,0.3
0,0.3
#MOVE
500
200
500
500
1000
800
#BRAKE
1
2
10
#PRESSURE
500
600
690
780
#CAR
35
3
25
2
20
1
3
4
1.5
6
2
#MOTOR_P1
1,100,128
"""
RAILML = """<?xml version="1.0" encoding="UTF-8"?>
<rail3:railML xmlns:rail3="https://www.railml.org/schemas/3.3" version="3.3"><rail3:rollingstock><rail3:vehicles>
  <rail3:vehicle id="loco" bruttoWeight="84" tareWeight="84" length="19" rotatingMassFactor="1.15">
    <rail3:vehiclePart id="p" partOrder="1" category="locomotive"/>
    <rail3:engine/>
    <rail3:brakes><rail3:vehicleBrakes brakeType="compressed air" airBrakeApplicationPosition="P"
      regularBrakePercentage="95" emergencyBrakePercentage="110"/>
      <rail3:vehicleBrakes airBrakeApplicationPosition="G" regularBrakePercentage="70"/></rail3:brakes>
    <rail3:drivingResistance tunnelFactor="1.5">
      <rail3:info airDragCoefficient="0.8" crossSectionArea="9.5" rollingResistance="1.5"/></rail3:drivingResistance>
  </rail3:vehicle>
  <rail3:vehicle id="coach" tareWeight="40" nettoWeight="8" length="26.4">
    <rail3:vehiclePart id="q" partOrder="1" category="passengerCoach"/>
    <rail3:brakes><rail3:vehicleBrakes airBrakeApplicationPosition="R" regularBrakeMass="60"/></rail3:brakes>
    <rail3:drivingResistance><rail3:details><rail3:valueTable xValueUnit="km/h" yValueUnit="kN">
      <rail3:valueLine xValue="0"><rail3:value yValue="0.5"/></rail3:valueLine>
      <rail3:valueLine xValue="36"><rail3:value yValue="0.8"/></rail3:valueLine>
      <rail3:valueLine xValue="72"><rail3:value yValue="1.5"/></rail3:valueLine>
      <rail3:valueLine xValue="108"><rail3:value yValue="2.6"/></rail3:valueLine>
    </rail3:valueTable></rail3:details></rail3:drivingResistance>
  </rail3:vehicle>
</rail3:vehicles><rail3:formations>
  <rail3:formation id="IC"><rail3:trainOrder orderNumber="2" vehicleRef="coach" vehicleCount="5"/>
    <rail3:trainOrder orderNumber="1" vehicleRef="loco"/></rail3:formation>
  <rail3:formation id="other"><rail3:trainOrder vehicleRef="coach"/></rail3:formation>
</rail3:formations></rail3:rollingstock></rail3:railML>
"""
UNIT = """<railml xmlns="http://www.railml.org/schemas/2013"><rollingstock version="2.2"><vehicles>
<vehicle id="v" length="25" bruttoWeight="50" vehicleCategory="motorCoach"/></vehicles>
<formations><formation id="f"><trainOrder orderNumber="1" vehicleRef="v" vehicleCount="2"/>
<trainBrakes meanDeceleration="0.9"/><trainResistance><daviesFormulaFactors constantFactorA="3800"
speedDependentFactorB="45" squareSpeedDependentFactorC="2.5" massDependent="false"/></trainResistance>
</formation></formations></rollingstock></railml>"""
#: Folder of trains of other programs, which are not part of this repository.
STRANGERS = Path(os.environ.get("CONSISTS_OF_OTHERS", "nowhere"))


def read(folder: Path, name: str, text: str) -> Imported:
    (folder / name).write_text(text)
    return read_foreign(folder / name)


def read_or_message(path: Path) -> Imported | str:
    """Return the train of a file, or the message with which it is refused."""
    try:
        return read_foreign(path)
    except FileError as error:
        return str(error)


def told(found: Imported, kind: str, words: str) -> bool:
    return any(words in sentence for sentence in getattr(found, kind))


def whole(found: Imported, column: str) -> float:
    """Return the sum of a column over all vehicles."""
    return sum(row[column] * row.get("count", 1) for row in found.rows)


def resistance(found: Imported, speed: float) -> float:
    """Return the running resistance of the train [N]."""
    return sum(whole(found, f"resistance_{letter}") * speed**power for power, letter in enumerate("abc"))


# -- OSRD ------------------------------------------------------------------------------------------------------------


def test_an_osrd_train_keeps_its_sums(tmp_path: Path) -> None:
    found = read(tmp_path, "freight.json", json.dumps(OSRD))
    assert whole(found, "mass") == pytest.approx(2090.0, rel=ROUNDED)
    assert whole(found, "length") == pytest.approx(750.0, rel=ROUNDED)
    for speed in SPEEDS:
        assert resistance(found, speed) == pytest.approx(2508.0 + 67.7 * speed + 10.8 * speed**2, rel=1e-8)
    for row in found.rows:
        assert (row["kind"], row["deceleration"]) == ("wagon", 0.3)
        assert row["rotating"] == pytest.approx(4.8, rel=ROUNDED)
        assert row["length"] <= LONGEST
    assert sum(row.get("count", 1) for row in found.rows) == round(750 / 26.4)


def test_what_is_doubtful_in_an_osrd_train_is_told(tmp_path: Path) -> None:
    found = read(tmp_path, "freight.json", json.dumps(OSRD))
    assert told(found, "assumed", "A is 1.2 N/t; trains have 3 N/t")
    assert told(found, "assumed", "deceleration of operation")
    assert told(found, "assumed", "is a whole train")
    assert told(found, "left", "effort_curves: it has no mode")
    old = {name: value for name, value in OSRD.items() if name != "const_gamma"} | {
        "gamma": {"type": "CONST", "value": 0.5}
    }
    found = read(tmp_path, "old.json", json.dumps(old | {"rolling_resistance": {"A": 9e4, "B": 12, "C": 5000}}))
    assert {row["deceleration"] for row in found.rows} == {0.5}
    assert told(found, "assumed", "at 108 km/h is 2.2e+03 N/t")


def test_a_resistance_of_osrd_per_mass_is_that_of_its_whole_train(tmp_path: Path) -> None:
    """OSRD's fast_rolling_stock.json before June 2026 and since: 900 t, 5400 N or 0.006 N/kg at rest."""
    whole_train = {"type": "davis", "A": 5400.0, "B": 200.0, "C": 12.0}
    a_kilogram = {name: value / 9e5 if name != "type" else value for name, value in whole_train.items()}
    for given, kind, words in ((whole_train, "taken", "of the whole train"), (a_kilogram, "converted", "per kg")):
        found = read(tmp_path, "fast.json", json.dumps(OSRD | {"mass": 9e5, "rolling_resistance": given}))
        for speed in SPEEDS:
            assert resistance(found, speed) == pytest.approx(5400.0 + 200.0 * speed + 12.0 * speed**2, rel=1e-8)
        assert told(found, kind, words)
    still = read(tmp_path, "still.json", json.dumps(OSRD | {"rolling_resistance": {"A": 0, "B": 0, "C": 2.5e-5}}))
    assert resistance(still, 10.0) == pytest.approx(2.5e-3 * 2.09e6)
    none = read(tmp_path, "none.json", json.dumps(OSRD | {"rolling_resistance": {"A": 0, "B": 0, "C": 0}}))
    assert resistance(none, 30.0) == 0.0


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"A": 25.08, "B": 67.7, "C": 10.8}, "0.012 N/t or 2.51e+04 N/t at rest"),  # A in kN
        ({"A": 1.2, "B": 0.0, "C": 0.0}, "0.000574 N/t or 1.2e+03 N/t at rest"),  # A in daN/t
        ({"A": 0.006, "B": 200.0, "C": 12.0}, "2.87e-06 N/t or 6 N/t at rest"),  # A alone per mass
        ({"A": 0.0, "B": 0.5, "C": 0.0}, "0.00718 N/t or 1.5e+04 N/t at 108 km/h"),
    ],
)
def test_a_resistance_of_osrd_that_no_train_has_is_refused(given: dict[str, float], words: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match=re.escape(words)):
        read(tmp_path, "unit.json", json.dumps(OSRD | {"rolling_resistance": given}))
    light = OSRD | {"mass": 60e3, "length": 100.0, "rolling_resistance": {"A": 0.36, "B": 0.012, "C": 0.0008}}  # in kN
    with pytest.raises(FileError, match=r"0\.006 N/t or 360 N/t at rest"):
        read(tmp_path, "unit.json", json.dumps(light))
    with pytest.raises(FileError, match=r"rolling_resistance\.C must be a number; got null"):
        read(tmp_path, "unit.json", json.dumps(OSRD | {"rolling_resistance": {"A": 5000.0, "B": 1.0}}))


# -- ALTRIOS ---------------------------------------------------------------------------------------------------------


def test_an_altrios_car_has_the_numbers_of_its_file(tmp_path: Path) -> None:
    found = read(tmp_path, "Coal_Loaded.yaml", CAR)
    row = found.rows[0]
    weight = 130e3 * G
    assert (row["mass"], row["length"], row["valve"]) == (130.0, 18.0, "head")
    assert row["rotating"] == pytest.approx(100 * 4 * 750 / 130e3, rel=ROUNDED)
    for speed in SPEEDS:
        own = 4 * 40.26 + (1.546e-3 + 1e-5 * speed) * weight + AIR * 4.087 * speed**2
        assert resistance(found, speed) == pytest.approx(own, rel=ROUNDED)
    assert row["net_braking_ratio"] == pytest.approx(11.0, rel=ROUNDED)
    assert (row["friction"], row["friction_value"]) == ("constant", 0.3)
    assert told(found, "assumed", "0.32 m/s2. ALTRIOS takes it as retardation: 1.08 m/s2")


def test_an_altrios_train_has_its_cars_and_locomotives(tmp_path: Path) -> None:
    (tmp_path / "Coal_Loaded.yaml").write_text(CAR)
    inline = CAR.replace("---\n", "- ").replace("Coal", "Grain").replace("\n", "\n    ").rstrip()
    text = f"n_cars_by_type:\n  Coal_Loaded: 10\n  Grain_Loaded: 5\nrail_vehicles:\n  {inline}\ntrain_type: Freight\n"
    found = read(tmp_path, "train.yaml", f"{text}loco_con:\n  loco_vec:\n  - mass: 195000\n  - mass: 195000\n")
    assert [(row["kind"], row.get("count", 1)) for row in found.rows] == [
        ("locomotive", 1),
        ("locomotive", 1),
        ("wagon", 10),
        ("wagon", 5),
    ]
    assert whole(found, "mass") == pytest.approx(2 * 195 + 15 * 130)
    assert told(found, "assumed", "a train of ALTRIOS is a sum without an order")


#: Cars of ALTRIOS 1.1.0 (rolling_stock/Manifest_Loaded.yaml, Intermodal_Empty.yaml) and its default locomotive.
MANIFEST = (Path(__file__).parents[1] / "data" / "altrios_car.yaml").read_text(encoding="utf-8")
MANIFEST = MANIFEST.replace("car_type: car", "car_type: Manifest_Loaded")
EMPTY = {
    "Manifest_Loaded": "Empty",
    "101500.0": "0.0",
    "0.11": "0.25",
    "40.26": "80.0",
    "0.001546": "0.00075",
    "4.087": "4",
}


def train_of_altrios(folder: Path, loaded: int, empty: int, more: str = "") -> Imported:
    empty_car = MANIFEST
    for old, new in EMPTY.items():
        empty_car = empty_car.replace(old, new)
    (folder / "Manifest_Loaded.yaml").write_text(MANIFEST)
    (folder / "Empty.yaml").write_text(empty_car)
    cars = f"n_cars_by_type:\n  Manifest_Loaded: {loaded}\n  Empty: {empty}\n"
    return read(folder, "train.yaml", f"{cars}{more}loco_con:\n  loco_vec:\n  - mass_kilograms: 195000.0\n")


def test_the_resistance_of_an_altrios_train_is_that_of_altrios(tmp_path: Path) -> None:
    """State of SetSpeedTrainSim of altrios 1.1.0 at 20 m/s: rolling, bearing, davis_b and aero [N], mass_rot [kg]."""
    found = train_of_altrios(tmp_path, 10, 5)
    assert resistance(found, 0.0) == pytest.approx(23551.27 + 3210.40, rel=1e-3)
    assert resistance(found, 20.0) == pytest.approx(23551.27 + 3210.40 + 3210.01 + 29826.30, rel=1e-3)
    assert whole(found, "mass") == pytest.approx(1637.5)
    rotating = sum(10 * row["mass"] * row["rotating"] * row.get("count", 1) for row in found.rows if "rotating" in row)
    assert rotating == pytest.approx(45000.0, rel=ROUNDED)
    assert told(found, "assumed", "their mean by number")


def test_drag_areas_of_an_altrios_train_replace_those_of_its_cars(tmp_path: Path) -> None:
    """res_aero of altrios 1.1.0 at 20 m/s with cd_area_vec [3, 5, 7]: 7350 N."""
    found = train_of_altrios(tmp_path, 2, 1, "cd_area_vec: [3.0, 5.0, 7.0]\n")
    assert whole(found, "resistance_c") * 400 == pytest.approx(7350.0, rel=1e-6)
    with pytest.raises(FileError, match=r"cd_area_vec must have 3 numbers, one a car; got \[3.0\]"):
        train_of_altrios(tmp_path, 2, 1, "cd_area_vec: [3.0]\n")


@pytest.mark.parametrize(
    ("name", "other"),
    [("cd_area_square_meters", "cd_area_square_feet"), ("davis_b_seconds_per_meter", "Davis B (h/mi)")],
)
def test_a_number_of_an_altrios_car_in_another_unit_is_refused(name: str, other: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match=f"must have {name}; got {re.escape(other)}. Convert it to this unit."):
        read(tmp_path, "car.yaml", MANIFEST.replace(name, other))
    missing = read(tmp_path, "car.yaml", MANIFEST.replace(name, "unknown"))
    assert told(missing, "assumed", f"{name}: missing; 0.")
    empty = read(tmp_path, "car.yaml", MANIFEST.replace("mass_freight_kilograms", "unknown"))
    assert told(empty, "assumed", "mass_freight_kilograms: missing; 0.")
    text = "loco_con:\n  loco_vec:\n  - mass_pounds: 430000\n"
    with pytest.raises(FileError, match="must have mass_kilograms; got mass_pounds"):
        read(tmp_path, "loco.yaml", text)


def test_a_car_from_a_table_of_altrios_has_its_columns_names(tmp_path: Path) -> None:
    text = (
        "Car Type: Bulk\nLength (m): 18.0\nAxle Count: 4\nMass Static Base (kg): 28500.0\nMass Freight (kg): 101500.0\n"
        "Braking Ratio: 0.11\nMass Extra per Axle (kg): 750.0\nBearing Res per Axle (N): 40.26\n"
        "Rolling Ratio: 0.001546\nDavis B (s/m): 1e-5\nCd*A (m^2): 4.087\n"
    )
    new = read(tmp_path, "Coal.yaml", CAR).rows[0] | {"name": "Bulk"}
    assert read(tmp_path, "Bulk.yaml", text).rows[0] == new


def test_an_old_altrios_car_is_read_loaded(tmp_path: Path) -> None:
    text = (
        "Car Type: Manifest\nLength (m): 18.0\nAxle Count: 4\nMass Static Empty (kg): 28500.0\n"
        "Mass Static Loaded (kg): 130000.0\nBraking Ratio Empty: 0.25\nBraking Ratio Loaded: 0.11\n"
        "Mass Extra per Axle (kg): 750.0\nBearing Res per Axle (N): 40.26\nRolling Ratio: 0.001546\n"
        "Davis B (s/m): 0.0\nDrag Area Cd*A Loaded (m^2): 4.087\n"
    )
    row = read(tmp_path, "Manifest.yaml", text).rows[0]
    assert row["mass"] == 130.0
    assert row["net_braking_ratio"] == pytest.approx(11.0, rel=ROUNDED)


def test_yaml_is_the_same_without_the_parser_in_c(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("a: [1e3, 1., -2, .5, '3', 4_0, yes, ~]\nb:\n- {c: 2026-05-01}\n- |\n  text\n")
    quick = import_module("readers.yaml_files").yaml_of(path)
    assert quick["a"] == [1000.0, 1.0, -2, 0.5, "3", "4_0", True, None]
    monkeypatch.setattr("yaml.__with_libyaml__", False)
    monkeypatch.delitem(sys.modules, "readers.yaml_files")
    slow = import_module("readers.yaml_files")
    assert slow.yaml_of(path) == quick
    path.write_text("a: &b 1")
    with pytest.raises(FileError, match="anchors"):
        slow.yaml_of(path)


def test_yaml_without_its_package_is_refused_with_the_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.yaml").write_text(CAR)
    for name in ("readers.yaml_files", "readers.formats.altrios"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "yaml", None)
    with pytest.raises(FileError, match=r"Install it: pip install pyyaml\."):
        read_foreign(tmp_path / "a.yaml")


# -- OpenBVE ---------------------------------------------------------------------------------------------------------


def test_an_openbve_train_has_the_numbers_of_its_file(tmp_path: Path) -> None:
    found = read(tmp_path, "train.dat", BVE)
    assert whole(found, "mass") == pytest.approx(3 * 35 + 2 * 25)
    assert whole(found, "length") == 100.0
    assert [row["mass"] for row in found.rows for _ in range(row.get("count", 1))] == [35, 25, 35, 25, 35]
    for speed in SPEEDS:
        own = 0.0025 * 155e3 * G + 0.5 * WARM * 1.2 * (6 + 4 * 2) * speed**2
        assert resistance(found, speed) == pytest.approx(own, rel=1e-8)
    row = found.rows[0]
    assert (row["brake"], row["full_pressure"], row["rotating"], row["valve"]) == ("ep-direct", 5.0, 0.0, "head")
    assert row["deceleration"] == pytest.approx(4.2 / 3.6, rel=ROUNDED)
    assert row["fill_time"] == pytest.approx(0.95 * 500 / (0.3 * 1000), rel=ROUNDED)
    assert row["release_time"] == pytest.approx((500 - 40) / 800, rel=ROUNDED)
    assert told(found, "left", "600 kPa")
    assert told(found, "left", "OpenBVE counts them by cars")
    assert row["dead_time"] == 0.3


def test_a_unit_or_a_remark_behind_a_number_of_openbve_changes_nothing(tmp_path: Path) -> None:
    plain = read(tmp_path, "train.dat", BVE)
    text = BVE.replace("#CAR\n35", "#CAR\n35 t").replace("#PRESSURE\n500", "#PRESSURE\n500kPa, in service")
    assert read(tmp_path, "train.dat", text).rows == plain.rows


def test_an_automatic_brake_fills_at_the_whole_rate(tmp_path: Path) -> None:
    text = (
        BVE.replace("#BRAKE\n1\n2", "#BRAKE\n2\n0")
        .replace("OPENBVE", "BVE2000000")
        .replace("#PERF", "#DECELERATION\n;")
    )
    row = read(tmp_path, "train.dat", text.replace(";ORMANCE\n", "")).rows[0]
    assert row["brake"] == "pneumatic"
    assert row["fill_time"] == pytest.approx(0.95 * 500 / 1000, rel=ROUNDED)


def test_missing_numbers_are_openbves_defaults(tmp_path: Path) -> None:
    found = read(tmp_path, "train.dat", "BVE1220000\n#CAR\n30\n2\n\n1\n")
    assert whole(found, "mass") == 61.0
    row = found.rows[0]
    assert row["deceleration"] == pytest.approx(1 / 3.6, rel=ROUNDED)
    assert row["resistance_c"] == pytest.approx(0.5 * WARM * 1.1 * 0.6 * 2.6 * 3.6, rel=ROUNDED)
    assert found.rows[1]["resistance_c"] == pytest.approx(0.5 * WARM * 1.1 * 0.2 * 2.6 * 3.6, rel=ROUNDED)
    assert told(found, "assumed", "TrailerCarMass: missing; OpenBVE's default of 1")


@pytest.mark.parametrize(
    ("motors", "trailers", "front", "places"),
    [
        (1, 3, True, "M..."),
        (1, 3, False, "...M"),
        (2, 4, True, "M....M"),
        (2, 1, False, ".MM"),
        (2, 4, False, "..MM.."),
        (3, 2, True, "M.M.M"),
        (4, 6, True, "M..M..M..M"),
        (3, 3, False, ".M.M.M"),
        (6, 0, False, "MMMMMM"),
    ],
)
def test_motor_cars_stand_where_openbve_puts_them(motors: int, trailers: int, front: bool, places: str) -> None:
    found = motor_cars(motors, trailers, front)
    assert "".join("M" if one else "." for one in found) == places
    assert sum(found) == motors


# -- railML ----------------------------------------------------------------------------------------------------------


def test_a_railml_formation_has_the_numbers_of_its_vehicles(tmp_path: Path) -> None:
    found = read(tmp_path, "ic.xml", RAILML)
    loco, coach = found.rows
    assert (loco["kind"], loco["lambda"], loco["position"], loco["mass"]) == ("locomotive", 95.0, "P", 84.0)
    assert (coach["kind"], coach["count"], coach["position"], coach["mass"]) == ("coach", 5, "R", 48.0)
    assert coach["brake_weight"] == 60.0
    assert loco["rotating"] == pytest.approx(15.0, rel=ROUNDED)
    assert whole(found, "length") == pytest.approx(19 + 5 * 26.4)
    for speed in SPEEDS:
        own = 1.5 * 84 * G + 0.5 * AIR * 0.8 * 9.5 * speed**2
        assert sum(loco[f"resistance_{x}"] * speed**n for n, x in enumerate("abc")) == pytest.approx(own, rel=ROUNDED)
    for speed, force in ((0.0, 500.0), (10.0, 800.0), (20.0, 1500.0), (30.0, 2600.0)):
        fit = sum(coach[f"resistance_{x}"] * speed**n for n, x in enumerate("abc"))
        assert fit == pytest.approx(force, abs=1e-6)
    assert told(found, "left", "emergencyBrakePercentage")
    assert told(found, "left", "Formations other: the first, IC, is read")
    assert told(found, "left", "2 sets")


def test_additional_brakes_of_railml_have_no_force_and_name_their_column(tmp_path: Path) -> None:
    vehicle = (
        '<railml><rollingstock><vehicles><vehicle id="v" length="20" tareWeight="40"><vehicleBrakes>'
        '<auxiliaryBrakes Mg="true" Wb="1" E="false"/></vehicleBrakes></vehicle></vehicles></rollingstock></railml>'
    )
    found = read(tmp_path, "a.xml", vehicle)
    assert told(found, "left", "auxiliaryBrakes Mg: the file does not state its force. Set magnetic_attraction.")
    assert told(found, "left", "auxiliaryBrakes Wb: the file does not state its force. Set eddy_force.")
    assert not told(found, "left", "auxiliaryBrakes E")


def test_a_formation_gives_its_vehicles_what_they_lack(tmp_path: Path) -> None:
    found = read(tmp_path, "unit.railml", UNIT)
    assert whole(found, "mass") == 100.0
    assert {row["deceleration"] for row in found.rows} == {0.9}
    for speed in SPEEDS:
        own = 3800 + 45 * 3.6 * speed + 2.5 * 12.96 * speed**2
        assert resistance(found, speed) == pytest.approx(own, rel=ROUNDED)


def test_a_coefficient_that_railml_or_osrd_lacks_is_told(tmp_path: Path) -> None:
    bare = '<railML><rollingstock><vehicles><vehicle id="a" bruttoWeight="50" length="20">{}</vehicle></vehicles>'
    text = f"{bare}</rollingstock></railML>"
    drag = '<drivingResistance><info rollingResistance="1.5" airDragCoefficient="0.8"/></drivingResistance>'
    assert told(read(tmp_path, "a.xml", text.format(drag)), "assumed", "crossSectionArea: missing; 0.")
    davis = '<drivingResistance><daviesFormulaFactors constantFactorA="500"/></drivingResistance>'
    found = read(tmp_path, "a.xml", text.format(davis))
    assert told(found, "assumed", "speedDependentFactorB, squareSpeedDependentFactorC: missing; 0.")
    stock = {name: value for name, value in OSRD.items() if name != "inertia_coefficient"}
    assert told(read(tmp_path, "a.json", json.dumps(stock)), "assumed", "the file has no inertia_coefficient")


def test_a_table_of_railml_without_a_unit_is_told(tmp_path: Path) -> None:
    text = RAILML.replace('<rail3:valueTable xValueUnit="km/h" yValueUnit="kN">', "<rail3:valueTable>")
    assert text != RAILML
    assert told(read(tmp_path, "ic.xml", text), "assumed", "a unit of its table is missing; km/h and N.")


def test_a_table_of_deceleration_becomes_its_mean_over_a_stop(tmp_path: Path) -> None:
    """A constant 0.8 m/s2, and steps whose mean by hand is v^2 / 2 over int v / a dv."""
    table = (
        '<brakes><decelerationTable><valueTable xValueUnit="m/s" yValueUnit="m/s/s">{}</valueTable>'
        "</decelerationTable></brakes>"
    )
    line = '<valueLine xValue="{}"><value yValue="{}"/></valueLine>'
    start = '<railml><rollingstock><vehicles><vehicle id="v" length="20" tareWeight="40">'
    end = "</vehicle></vehicles></rollingstock></railml>"
    flat = "".join(line.format(speed, 0.8) for speed in (0, 10, 30))
    row = read(tmp_path, "a.xml", start + table.format(flat) + end).rows[0]
    assert row["deceleration"] == pytest.approx(0.8, rel=1e-9)
    rising = line.format(0, 0.5) + line.format(20, 1.0)  # a = 0.5 + v / 40: int v / a dv = 40 (20 - 20 ln 2)
    row = read(tmp_path, "b.xml", start + table.format(rising) + end).rows[0]
    assert row["deceleration"] == pytest.approx(200 / (40 * (20 - 20 * 0.6931471805599453)), rel=1e-6)


# -- damaged files ---------------------------------------------------------------------------------------------------

LAUGHS = '<!DOCTYPE a [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]><railml>&b;</railml>'


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("a.json", "[1]", "must be a rolling stock with length and mass"),
        ("a.json", "{", "must be JSON"),
        ("a.json", "[" * 100_000, "must nest brackets at most 64 deep"),
        ("a.json", json.dumps(OSRD | {"mass": "2090 t"}), "mass must be a number; got 2090 t."),
        ("a.json", json.dumps(OSRD | {"length": 1e9}), "length must be from 3 to 20000 m"),
        ("a.json", json.dumps(OSRD | {"const_gamma": 30}), "const_gamma must be from 0.01 to 3 m/s2; got 30"),
        ("a.json", json.dumps(OSRD | {"rolling_resistance": {"A": None}}), "rolling_resistance.A must be a number"),
        ("a.yaml", "", "must be a rolling stock or a train of ALTRIOS; got null."),
        ("a.yaml", "a: &b [1]\nc: *b", "anchors (& and *) are not read"),
        ("a.yaml", "a: {b: [", "must be YAML; got a fault in row"),
        ("a.yaml", "[" * 5000, "levels are more than 64 deep"),
        ("a.yaml", "a: 1\na: 2", "the name a occurs twice"),
        ("a.yaml", "car_type: x", "must have length_meters"),
        ("a.yaml", CAR.replace("18.0", "18,0"), "length_meters must be a number; got 18,0."),
        ("a.yaml", CAR.replace("0.11", "11"), "braking_ratio must be from 0 to 2"),
        ("a.yaml", CAR.replace("18.0", "018"), "length_meters must be a number; got 018."),
        ("a.yaml", CAR.replace("18.0", "1:18"), "length_meters must be a number; got 1:18."),
        ("a.yaml", CAR.replace("18.0", "1_8"), "length_meters must be a number; got 1_8."),
        ("a.yaml", CAR.replace("18.0", ".nan"), "must have finite numbers; got nan."),
        ("a.yaml", "n_cars_by_type: {none: 3}", "must have the car 'none' in rail_vehicles"),
        ("a.yaml", "n_cars_by_type: {none: 1000000}", "n_cars_by_type must have integers from 0 to 2000"),
        ("train.dat", "", "must have a section #CAR; got none."),
        (
            "train.dat",
            BVE.replace("\n35\n", "\nmuch\n"),
            "MotorCarMass must be a number with a decimal point; got 'much'",
        ),
        ("train.dat", BVE.replace("\n0.0025\n", "\n0,0025\n"), "CoefficientOfRollingResistance must be a number"),
        ("train.dat", BVE.replace("\n3\n25", "\n1e9\n25"), "NumberOfMotorCars must be from 1 to 2000"),
        ("train.dat", "OPENBVE\n#CAR\n1\n2000\n1\n2000\n", "must have 1 to 2000 vehicles; got 4000."),
        ("a.xml", LAUGHS, "must have no document type; got <!DOCTYPE a."),
        ("a.xml", "<a>" * 1000, "must nest elements at most 64 deep"),
        ("a.xml", "<railml><vehicle>", "must be XML; got a fault in row 1, column 18"),
        ("a.xml", "<railml/>", "must have rollingstock with vehicles; got railml without."),
        ("a.xml", RAILML.replace('"coach" vehicle', '"none" vehicle'), "must name vehicles of the file; got 'none'."),
        (
            "a.xml",
            RAILML.replace('"84"', '"84 t"'),
            "bruttoWeight of vehicle loco must be a number up to 1e+12; got 84 t.",
        ),
        ("a.xml", RAILML.replace('yValueUnit="kN"', 'yValueUnit="stone"'), "must be over km/h or m/s"),
        ("a.xml", RAILML.replace('yValueUnit="kN"', 'yValueUnit="m/s/s"'), "in N or daN or kN; got km/h and m/s/s."),
        ("train.dat", BVE.replace("#CAR\n35", "#CAR\n35 kg"), "MotorCarMass must be in t; got '35 kg'."),
        ("train.dat", BVE.replace("4.2      ; dec", "1.2 m/s2 ; dec"), "must be in km/h/s; got '1.2 m/s2'."),
        ("train.dat", BVE.replace("#PRESSURE\n500", "#PRESSURE\n500 bar"), "Pressure must be in kPa; got '500 bar'."),
        (
            "train.dat",
            BVE.replace("#MOVE\n500\n200\n500\n500\n1000", "#MOVE\n1\n2\n3\n4\n5 bar/s"),
            "in kPa/s; got '5 bar/s'",
        ),
        ("a.xml", RAILML.replace('"26.4"', '"0.9"'), "length must be from 3 to 31 m; got 0.9 m."),
        ("a.xml", UNIT.replace('vehicleCount="2"', 'vehicleCount="0"'), "must have 1 to 2000 vehicles; got 0."),
        ("a.txt", "", "must end in one of .con"),
    ],
)
def test_a_damaged_file_is_refused_in_one_sentence(name: str, text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(FileError) as refused:
        read(tmp_path, name, text)
    assert sentence in str(refused.value)
    assert "\n" not in str(refused.value)
    assert str(tmp_path / name) in str(refused.value)


def test_a_package_adds_a_format_by_an_entry_point(monkeypatch: pytest.MonkeyPatch) -> None:
    added = [EntryPoint(name, "readers.formats.osrd:read_osrd", GROUP) for name in ("sim", "con")]
    monkeypatch.setattr(trains, "entry_points", lambda group: added if group == GROUP else [])
    assert list(trains.formats()) == [*FORMATS, ".sim"]
    assert trains.formats()[".sim"][1].load().__name__ == "read_osrd"
    assert trains.formats()[".con"] == FORMATS[".con"]


@pytest.mark.parametrize("ending", FORMATS)
def test_what_is_missing_a_folder_or_huge_is_refused_unread(ending: str, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="does not exist"):
        read_foreign(tmp_path / f"none{ending}")
    (tmp_path / f"folder{ending}").mkdir()
    with pytest.raises(FileError, match="must be a file"):
        read_foreign(tmp_path / f"folder{ending}")
    with (tmp_path / f"huge{ending}").open("wb") as file:
        file.truncate(10**9)
    with pytest.raises(FileError, match="must have at most"):
        read_foreign(tmp_path / f"huge{ending}")


@pytest.mark.parametrize(
    ("name", "text"), [("a.json", json.dumps(OSRD)), ("a.yaml", CAR), ("train.dat", BVE), ("a.xml", RAILML)]
)
def test_every_cut_of_a_file_is_read_or_refused_in_one_sentence(name: str, text: str, tmp_path: Path) -> None:
    for cut in range(0, len(text), 41):
        (tmp_path / name).write_text(text[:cut])
        found = read_or_message(tmp_path / name)
        assert isinstance(found, Imported) or "\n" not in found


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="CONSISTS_OF_OTHERS names no folder of their files")
def test_trains_of_others_are_read_or_refused_in_one_sentence() -> None:
    files = [path for path in sorted(STRANGERS.rglob("*")) if path.suffix.lower() in FORMATS]
    assert files
    for path in files:
        found = read_or_message(path)
        if isinstance(found, str):
            assert "\n" not in found
        else:
            assert whole(found, "mass") > 0.0
            assert whole(found, "length") > 0.0
