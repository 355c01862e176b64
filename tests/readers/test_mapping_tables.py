"""The tables of docs/consists.md: each field in them is read, into a column of its row, and each column exists."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from products.train.consist_columns import NAMES, WORDS, choices
from readers.formats.trains import read_foreign
from readers.import_account import Row
from tests.readers.test_foreign_drives import CURVES, LOCOMOTIVES, STOCK
from tests.readers.test_foreign_trains import BVE, CAR, RAILML, UNIT

PAGE = Path(__file__).parents[2] / "docs" / "consists.md"
#: A file, and two contents of it that differ in one field.
Change = tuple[str, str, str]
OPEN_RAILS, RAIL = "Open Rails and MSTS", "railML"


def eng(before: str, after: str, context: str = "", engine: bool = False) -> Change:
    """Return a locomotive with a field before and after a change; of equal fields the last one is valid."""
    start = "Wagon ( one Type ( Engine ) Size ( 3 4 19m ) Mass ( 84t ) MaxBrakeForce ( 60kN ) "
    if engine:
        return "one.eng", *(f"{start} ) Engine ( one {context} {field} )" for field in (before, after))
    return "one.eng", *(f"{start} {context} {field} )" for field in (before, after))


def con(before: str, after: str) -> Change:
    return "train.con", *(f"Train ( TrainCfg ( x {entries} ) )" for entries in (before, after))


def equipment(before: str, after: str) -> Change:
    return eng(*(f'BrakeEquipmentType ( "{words}" )' for words in (before, after)))


def system(word: str) -> Change:
    return eng('BrakeSystemType ( "Air_single_pipe" )', f'BrakeSystemType ( "{word}" )')


def stock(name: str, value: Any) -> Change:
    return "unit.json", json.dumps(STOCK), json.dumps(STOCK | {name: value})


def swapped(name: str, text: str, old: str, new: str) -> Change:
    assert old in text
    return name, text, text.replace(old, new, 1)


def car(old: str, new: str) -> Change:
    return swapped("car.yaml", CAR, old, new)


def bve(section: str, line: int, value: str) -> Change:
    """Return a change of a line of a section, from 0."""
    lines = BVE.split("\n")
    at = lines.index(section) + 1 + line
    return "train.dat", BVE, "\n".join([*lines[:at], value, *lines[at + 1 :]])


def xml(old: str, new: str, text: str = RAILML) -> Change:
    return swapped("train.xml", text, old, new)


def table(element: str) -> Change:
    """Return a change of a table of a vehicle."""
    value_line = '<valueLine xValue="{}"><value yValue="{{0}}"/></valueLine>'
    line = value_line.format(0) + value_line.format(80)
    text = '<railml><rollingstock><vehicles><vehicle id="v" length="20" tareWeight="40" rotatingMassFactor="1.1">'
    text += "{}</vehicle></vehicles></rollingstock></railml>"
    tables = (f"<{element}><valueTable>{line.format(value)}</valueTable></{element}>" for value in ("1.0", "1.1"))
    if element != "decelerationTable":
        tables = (one.replace("<valueTable>", '<valueTable yValueUnit="kN">').replace('"1.', '"11.') for one in tables)
    return "table.xml", *(text.format(one) for one in tables)


EFFORTS = {"modes": {"a": {"default_curve": {"speeds": [0.0, 40.0], "max_efforts": [2e5, 5e4]}}}}
ENGINE, WAGON = "Engine ( EngineData ( power own ) )", "Wagon ( WagonData ( box own ) )"
DYNAMIC = "DynamicBrakesMaximumForce ( 100kN )"
INSIDE = CAR.replace("---\n", "- ").replace("Coal_Loaded", "car", 1).replace("18.0", "19.0").replace("\n", "\n  ")
COACH = '<rail3:formation id="first"><rail3:trainOrder vehicleRef="coach"/></rail3:formation>'
TRAIN = "n_cars_by_type:\n  car: 3\n"
ANIMS = "ORTSFreightAnims ( WagonEmptyWeight ( 20t ) FreightAnimStatic ( FreightWeight ( {} ) ) {} )"
#: Changes of each field in the tables, by program and by the words of the page.
CHANGES: dict[str, dict[str, list[Change]]] = {
    OPEN_RAILS: {
        "Engine": [con(ENGINE + WAGON, WAGON + ENGINE)],
        "Wagon": [con(ENGINE + WAGON, ENGINE + WAGON + WAGON)],
        "TrainCfg": [con(ENGINE + WAGON, f"{ENGINE} ) {WAGON} Nothing (")],
        "Flip": [con(ENGINE + WAGON, ENGINE.replace("( E", "( Flip ( ) E") + WAGON)],
        "Type": [eng("", "Type ( Freight )")],
        "Name": [eng("", 'Name ( "Big" )')],
        "Mass": [eng("", "Mass ( 90t )")],
        "Size": [eng("", "Size ( 3 4 20m )")],
        "ORTSFreightAnims": [eng("", ANIMS.format("60t", "")), eng(ANIMS.format("60t", ""), ANIMS.format("50t", ""))],
        "Full": [eng(ANIMS.format("60t", ""), ANIMS.format("60t", "FullMaxBrakeForce ( 90kN )"))],
        "Empty": [eng("", "ORTSFreightAnims ( EmptyMaxBrakeForce ( 20kN ) )")],
        **{f"ORTSDavis_{one}": [eng("", f"ORTSDavis_{one} ( 99 )", "ORTSDavis_A ( 1 )")] for one in "ABC"},
        "MaxBrakeForce": [eng("", "MaxBrakeForce ( 70kN )")],
        "ORTSMaxBrakeShoeForce": [
            eng(f"ORTSMaxBrakeShoeForce ( {a} )", "ORTSMaxBrakeShoeForce ( 99kN )", "ORTSBrakeShoeType ( Disc_Pads )")
            for a in ("98kN", "9kN")
        ],
        "ORTSBrakeShoeType": [eng("", "ORTSBrakeShoeType ( Cast_Iron_P10 )")],
        "ORTSNumberCarBrakeShoes": [eng("", "ORTSNumberCarBrakeShoes ( 12 )", "ORTSBrakeShoeType ( Cast_Iron_P6 )")],
        "ORTSBrakeShoeFriction": [eng("", "ORTSBrakeShoeFriction ( 0 0.4 50 0.2 )")],
        "BrakeCylinderPressureForMaxBrakeBrakeForce": [eng("", "BrakeCylinderPressureForMaxBrakeBrakeForce ( 50 )")],
        "ORTSBrakeForceReferencePressure": [eng("", "ORTSBrakeForceReferencePressure ( 50 )")],
        "MaxApplicationRate": [eng("", "MaxApplicationRate ( 9 )")],
        "MaxReleaseRate": [eng("", "MaxReleaseRate ( 9 )")],
        "BrakeSystemType": [system("Air_piped"), system("EP")],
        **{word: [system(word)] for word in ("EP", "SME", "ECP", "Air_twin_pipe")},
        "ORTSEPBrakeControlsBrakePipe": [
            eng("", "ORTSEPBrakeControlsBrakePipe ( 1 )", f'BrakeSystemType ( "{word}" )')
            for word in ("EP", "ECP", "SME")
        ],
        "BrakeEquipmentType": [equipment("", "Triple_valve, Emergency_brake_reservoir")],
        "triple_valve": [equipment("Emergency_brake_reservoir", "Emergency_brake_reservoir, Triple_valve")],
        "emergency_brake_reservoir": [equipment("Triple_valve", "Emergency_brake_reservoir, Triple_valve")],
        "graduated_release_triple_valve": [
            equipment(f"Triple_valve, Emergency_brake_reservoir{more}", "Triple_valve, Emergency_brake_reservoir")
            for more in (", Graduated_release_triple_valve", ", Distributor")
        ],
        "ORTSEmergencyResQuickRelease": [
            eng(
                "",
                "ORTSEmergencyResQuickRelease ( 2 )",
                'BrakeEquipmentType ( "Triple_valve, Emergency_brake_reservoir" )',
            )
        ],
        "ORTSAuxiliaryResCapacity": [eng("", "ORTSAuxiliaryResCapacity ( 40L )")],
        "EmergencyResCapacity": [eng("", "EmergencyResCapacity ( 40L )")],
        "EmergencyResVolumeMultiplier": [eng("", "EmergencyResVolumeMultiplier ( 2 )", "EmergencyResCapacity ( 40L )")],
        "ORTSBrakeCylinderVolume": [eng("", "ORTSBrakeCylinderVolume ( 9L )")],
        "ORTSNumberBrakeCylinders": [
            eng(
                "",
                "ORTSNumberBrakeCylinders ( 2 )",
                "ORTSBrakeCylinderDiameter ( 10in ) ORTSBrakeCylinderPistonTravel ( 8in )",
            )
        ],
        "ORTSBrakeCylinderDiameter": [
            eng("", "ORTSBrakeCylinderDiameter ( 9in )", "ORTSBrakeCylinderPistonTravel ( 8in )")
        ],
        "ORTSBrakeCylinderPistonTravel": [
            eng("", "ORTSBrakeCylinderPistonTravel ( 8in )", "ORTSBrakeCylinderDiameter ( 9in )")
        ],
        "TripleValveRatio": [
            eng("", "TripleValveRatio ( 3 )", f"{name} ( 40L )")
            for name in ("ORTSAuxiliaryResCapacity", "ORTSBrakeCylinderVolume")
        ],
        "BrakePipeVolume": [eng("", "BrakePipeVolume ( 20L )")],
        "DynamicBrakesMaximumForce": [eng("", DYNAMIC, engine=True)],
        "DynamicBrakesFadingSpeed": [eng("", "DynamicBrakesFadingSpeed ( 9 )", DYNAMIC, engine=True)],
        "DynamicBrakesMaximumEffectiveSpeed": [
            eng("", "DynamicBrakesMaximumEffectiveSpeed ( 9 )", DYNAMIC, engine=True)
        ],
        "ORTSDynamicBrakeForceRampUpRate": [
            eng("", "ORTSDynamicBrakeForceRampUpRate ( 40kN/s )", DYNAMIC, engine=True)
        ],
        "MaxHandbrakeForce": [eng("", "MaxHandbrakeForce ( 20kN )")],
        "ORTSMaxTractiveForceCurves": [eng("", CURVES, engine=True)],
        "MaxForce": [eng("", "MaxForce ( 90kN )", "MaxPower ( 999kW )", engine=True)],
        "MaxPower": [eng("", "MaxPower ( 999kW )", "MaxForce ( 90kN )", engine=True)],
        "DynamicBrakeForceCurves": [eng("", CURVES, engine=True)],
        "Coupling": [
            eng("", "Coupling ( Type ( Bar ) )"),
            *(
                eng(f"Coupling ( Spring ( {a} ) )", f"Coupling ( Spring ( {b} ) )")
                for a, b in (
                    ("Stiffness ( 1e6 1e6 )", "Stiffness ( 2e6 2e6 )"),
                    ("r0 ( 0 2cm )", "r0 ( 0 3cm )"),
                    ("Break ( 1e6 1e6 )", "Break ( 2e6 2e6 )"),
                )
            ),
        ],
    },
    "OSRD": {
        "length": [stock("length", 80.0)],
        "mass": [stock("mass", 160e3)],
        "name": [stock("name", "other")],
        "primary_category": [stock("primary_category", "FREIGHT_TRAIN")],
        "inertia_coefficient": [stock("inertia_coefficient", 1.1)],
        "rolling_resistance": [
            stock("rolling_resistance", STOCK["rolling_resistance"] | {one: 77.0}) for one in ("A", "B", "C")
        ],
        "effort_curves": [stock("effort_curves", EFFORTS)],
        "default_curve": [
            (
                "unit.json",
                json.dumps(STOCK | {"effort_curves": {"modes": {"a": {"curves": []}}}}),
                json.dumps(STOCK | {"effort_curves": EFFORTS}),
            )
        ],
        "const_gamma": [stock("const_gamma", 0.5)],
    },
    "ALTRIOS": {
        "length_meters": [car("18.0", "19.0")],
        "mass_static_base_kilograms": [car("28500", "29500")],
        "mass_freight_kilograms": [car("101500", "111500")],
        "mass_rot_per_axle_kilograms": [car("750.0", "800.0")],
        "bearing_res_per_axle_newtons": [car("40.26", "50.0")],
        "rolling_ratio": [car("1.546e-3", "2e-3")],
        "davis_b_seconds_per_meter": [car("1.0e-5", "2e-5")],
        "cd_area_square_meters": [car("4.087", "5.0")],
        "braking_ratio": [car("0.11", "0.12")],
        "n_cars_by_type": [swapped("train.yaml", TRAIN, "3", "4")],
        "cd_area_vec": [("train.yaml", TRAIN, f"{TRAIN}cd_area_vec: [9, 9, 9]\n")],
        "rail_vehicles": [("train.yaml", TRAIN, f"{TRAIN}rail_vehicles:\n{INSIDE}")],
        "NAME.yaml": [("train.yaml", TRAIN, TRAIN.replace(" car", " other"))],
        "loco_vec": [swapped("train.yaml", LOCOMOTIVES, "mass: 195000", "mass: 185000")],
        "force_max": [swapped("train.yaml", LOCOMOTIVES, "600000", "500000")],
        "pwr_out_max": [swapped("train.yaml", LOCOMOTIVES, "3300000", "2300000")],
        "edrv": [swapped("train.yaml", LOCOMOTIVES, "edrv", "motor")],
    },
    "OpenBVE": {
        "#CAR": [bve("#CAR", line, value) for line, value in enumerate(("36", "4", "26", "3", "21", "0"))],
        "#PERFORMANCE": [bve("#PERFORMANCE", 0, "5")],
        "#DECELERATION": [
            (
                "train.dat",
                BVE.replace("#PERFORMANCE", "#DECELERATION"),
                bve("#PERFORMANCE", 0, "5")[2].replace("#PERFORMANCE", "#DECELERATION"),
            )
        ],
        "coefficients of rolling and drag, frontal areas": [
            *(bve("#PERFORMANCE", line, value) for line, value in ((3, "0.003"), (4, "1.3"))),
            *(bve("#CAR", line, "7") for line in (9, 10)),
        ],
        "#BRAKE": [bve("#BRAKE", 0, "2")],
        "#DELAY": [bve("#DELAY", 2, "0,0.4")],
        "#PRESSURE": [bve("#PRESSURE", 0, "550")],
        "#MOVE": [bve("#MOVE", 4, "900"), bve("#MOVE", 5, "900")],
    },
    RAIL: {
        "formation": [xml('<rail3:formation id="IC">', f"{COACH}<rail3:formation id='IC'>")],
        "trainOrder": [xml('<rail3:trainOrder orderNumber="1" vehicleRef="loco"/>', "")],
        "orderNumber": [xml('orderNumber="1"', 'orderNumber="3"')],
        "vehicleRef": [xml('vehicleRef="loco"', 'vehicleRef="coach"')],
        "vehicleCount": [xml('vehicleCount="5"', 'vehicleCount="6"')],
        "bruttoWeight": [xml('bruttoWeight="84"', 'bruttoWeight="88"')],
        "tareWeight": [xml('tareWeight="40"', 'tareWeight="41"')],
        "nettoWeight": [xml('nettoWeight="8"', 'nettoWeight="9"')],
        "length": [xml('length="26.4"', 'length="27"')],
        "category": [xml("passengerCoach", "freightWagon")],
        "rotatingMassFactor": [xml("1.15", "1.2")],
        "vehicleBrakes": [xml('airBrakeApplicationPosition="P"', 'airBrakeApplicationPosition="X"')],
        "regularBrakePercentage": [xml('"95"', '"96"')],
        "regularBrakeMass": [xml('"60"', '"61"')],
        "meanDeceleration": [xml('"0.9"', '"0.8"', UNIT)],
        "decelerationTable": [table("decelerationTable")],
        "brakeEffort": [table("brakeEffort")],
        "airDragCoefficient": [xml('"0.8"', '"0.9"')],
        "crossSectionArea": [xml('"9.5"', '"9.6"')],
        "rollingResistance": [xml('rollingResistance="1.5"', 'rollingResistance="1.6"')],
        "daviesFormulaFactors": [xml(old, "33", UNIT) for old in ("3800", "45", "2.5")],
        "tractiveEffort": [table("tractiveEffort")],
        "valueTable": [table("tractiveEffort")],
        "trainBrakes": [xml('"0.9"', '"0.8"', UNIT)],
        "trainResistance": [xml("3800", "3900", UNIT)],
    },
}


def tokens(cell: str) -> list[str]:
    """Return the words in code of a cell, endings such as `_b` with the begin of the word before."""
    found: list[str] = []
    for word in re.findall(r"`([^`]+)`", cell):
        found.append(found[-1][: -len(word)] + word if word.startswith("_") else word)
    return found


@cache
def tables() -> dict[str, list[tuple[str, str]]]:
    """Return the rows of the tables of fields and columns, by program."""
    found: dict[str, list[tuple[str, str]]] = {}
    for section in PAGE.read_text(encoding="utf-8").split("\n## ")[1:]:
        _, head, body = section.partition("| field | column |\n|---|---|\n")
        if head:
            rows = [line.strip("| ").split(" | ") for line in body.partition("\n\n")[0].splitlines()]
            found[section.partition("\n")[0]] = [(field, column) for field, column in rows]
    return found


def columns(cell: str) -> set[str]:
    """Return the columns of a consist that a cell names."""
    return {one.partition(" = ")[0] for one in tokens(cell)} & set(NAMES)


def rows(folder: Path, name: str, text: str) -> list[Row]:
    (folder / "own").mkdir(exist_ok=True)
    bare = "Size ( 3 4 14m ) Mass ( 50t ) MaxBrakeForce ( 40kN )"
    couplers = "Coupling ( Type ( Bar ) ) Coupling ( Type ( Automatic ) )"
    (folder / "own" / "power.eng").write_text(f"Wagon ( power Type ( Engine ) {bare} {couplers} )")
    (folder / "own" / "box.wag").write_text(f"Wagon ( box Type ( Freight ) {bare} )")
    for own in ("car", "other"):
        (folder / f"{own}.yaml").write_text(CAR.replace("Coal_Loaded", own, 1))
    (folder / name).write_text(text, encoding="utf-8")
    return [{"count": 1} | row for row in read_foreign(folder / name).rows]


@pytest.mark.parametrize("program", CHANGES)
def test_each_field_of_a_table_is_read_into_a_column_of_its_row(program: str, tmp_path: Path) -> None:
    used = set()
    for fields, column in tables()[program]:
        named = tokens(fields) or [fields]
        named += [one for one in tokens(column) if one in CHANGES[program] and not one.islower()]
        for field in named:
            used.add(field)
            assert field in CHANGES[program], f"{program}: {field} has no change in this test"
            for name, before, after in CHANGES[program][field]:
                pair = [rows(tmp_path, name, text) for text in (before, after)]
                own = columns(column)
                kept = [[{key: row.get(key) for key in own or row} for row in read] for read in pair]
                assert kept[0] != kept[1], f"{program}: a change of {field} changes none of {own or 'all columns'}"
    assert set(CHANGES[program]) - used <= {word for word in CHANGES[program] if word.islower()}


@pytest.mark.parametrize("program", CHANGES)
def test_lower_words_of_the_columns_are_read_too(program: str, tmp_path: Path) -> None:
    """Such as words of BrakeEquipmentType, listed in the cell of the columns."""
    for _, column in tables()[program]:
        for word in tokens(column):
            for name, before, after in CHANGES[program].get(word, []):
                assert rows(tmp_path, name, before) != rows(tmp_path, name, after), word


def test_the_tables_are_those_of_all_programs_and_name_columns_that_exist() -> None:
    assert set(tables()) == set(CHANGES)
    words = {word for name in WORDS for word in choices(name)}
    for program, table_rows in tables().items():
        for fields, column in table_rows:
            for token in tokens(column):
                name, _, value = token.partition(" = ")
                assert name in {*NAMES, *words, *CHANGES[program], "dynamic_brake", "parking_brake"}, (
                    program,
                    fields,
                    token,
                )
                if value:
                    assert value.strip('"') in choices(name), token
