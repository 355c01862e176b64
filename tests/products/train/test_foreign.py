"""Consists from files of other programs: forces by hand, round trips, the command, and `bb.train`."""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.__main__ import main
from products.building import build_all
from products.train.consist_columns import MOST, VEHICLE
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.imported_consist import ESSENTIAL, consist_from, imported_consist
from products.train.summary import brake_force, summary_of
from rbd_model.train.coupler import rigid
from readers.formats import vehicle_rows
from readers.formats.trains import FORMATS

#: Speeds at which resistances and forces are compared [m/s], and acceleration of gravity [m/s2].
SPEEDS, G = (0.0, 15.0, 30.0), 9.80665
#: Rows have 10 significant digits.
ROUNDED = 1e-8

WAGON = """SIMISA
Wagon ( hopper Type ( Freight ) Size ( 3m 4m 15m ) Mass ( 80t ) BrakeSystemType ( "Air_single_pipe" )
ORTSDavis_A ( 1200 ) ORTSDavis_B ( 20 ) ORTSDavis_C ( 5 ) ORTSMaxBrakeShoeForce ( 160kN )
ORTSBrakeShoeType ( Cast_Iron_P6 ) ORTSNumberCarBrakeShoes ( 16 ) MaxReleaseRate ( 0.001bar/s ) )
"""
OSRD = {
    "name": "unit",
    "length": 100.0,
    "mass": 200000.0,
    "const_gamma": 0.7,
    "inertia_coefficient": 1.05,
    "rolling_resistance": {"type": "davis", "A": 2000.0, "B": 30.0, "C": 8.0},
}
CAR = """car_type: Coal
length_meters: 18.0
axle_count: 4
mass_static_base_kilograms: 28500
mass_freight_kilograms: 101500
braking_ratio: 0.11
mass_rot_per_axle_kilograms: 750.0
bearing_res_per_axle_newtons: 40.26
rolling_ratio: 0.001546
cd_area_square_meters: 4.087
"""
BVE = (
    "BVE2000000\n#PERFORMANCE\n3.6\n0.35\n0\n0.0025\n1.2\n#BRAKE\n2\n0\n0\n#CAR\n35\n2\n25\n2\n20\n1\n3\n4\n1.5\n6\n2\n"
)
RAILML = """<railML><rollingstock><vehicles>
<vehicle id="loco" bruttoWeight="84" length="19"><vehiclePart category="locomotive"/>
<vehicleBrakes regularBrakePercentage="95"/>
<drivingResistance><info airDragCoefficient="0.8" crossSectionArea="9.5" rollingResistance="1.5"/></drivingResistance>
</vehicle><vehicle id="coach" bruttoWeight="48" length="26.4"><vehiclePart category="passengerCoach"/>
<vehicleBrakes meanDeceleration="0.9"/>
<drivingResistance><info airDragCoefficient="0.3" crossSectionArea="10" rollingResistance="1.8"/></drivingResistance>
</vehicle></vehicles></rollingstock></railML>"""
FILES = {
    "hopper.wag": WAGON,
    "unit.json": json.dumps(OSRD),
    "Coal.yaml": CAR,
    "train.dat": BVE,
    "ic.xml": RAILML,
}


@pytest.fixture(params=FILES)
def file(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / request.param
    path.write_text(FILES[request.param])
    return path


def p6(force: float, speed: float) -> float:
    """Return the friction of cast iron P6; force of a shoe [kN], speed [km/h] (Karwatzki 1950)."""
    return 0.6 * (16 * force / G + 100) / (80 * force / G + 100) * (speed + 100) / (5 * speed + 100)


def by_hand(name: str, speed: float) -> tuple[float, float]:
    """Return resistance and brake force of a file's train [N] at a speed [m/s]."""
    if name == "hopper.wag":
        return 1200 + 20 * speed + 5 * speed**2, 160e3 * p6(10.0, 3.6 * speed)
    if name == "unit.json":
        return 2000 + 30 * speed + 8 * speed**2, 0.7 * 1.05 * 200e3
    if name == "Coal.yaml":
        weight = 130e3 * G
        return 4 * 40.26 + 0.001546 * weight + 1.225 * 4.087 * speed**2, 0.3 * 0.11 * weight
    drag = 0.5 * 101325 * 0.0289644 / (8.31447 * 293.15) * 1.2 * (6 + 3 * 2)
    return 0.0025 * 120e3 * G + drag * speed**2, 1.0 * 120e3


@pytest.mark.parametrize("name", ["hopper.wag", "unit.json", "Coal.yaml", "train.dat"])
def test_resistance_and_brake_force_are_those_by_hand(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text(FILES[name])
    consist, _ = imported_consist(path)
    for speed in SPEEDS:
        resistance, force = by_hand(name, speed)
        own = sum(a + b * speed + c * speed**2 for a, b, c in (one.resistance for one in consist.vehicles))
        assert own == pytest.approx(resistance, rel=ROUNDED)
        tolerance = 0.01 if name == "hopper.wag" else ROUNDED  # P6: Karwatzki within 1 %
        assert sum(brake_force(one, speed) for one in consist.vehicles) == pytest.approx(force, rel=tolerance)


def test_a_railml_train_has_its_percentage_and_deceleration(tmp_path: Path) -> None:
    path = tmp_path / "ic.xml"
    path.write_text(RAILML)
    loco, coach = imported_consist(path)[0].vehicles
    assert loco.percentage == pytest.approx(95.0, rel=1e-3)
    assert brake_force(coach, 20.0) == pytest.approx(0.9 * 1.04 * 48e3, rel=ROUNDED)
    assert coach.resistance == pytest.approx((1.8 * 48 * G, 0.0, 0.5 * 1.225 * 3.0), rel=ROUNDED)


@pytest.mark.parametrize("ending", ["toml", "csv"])
def test_what_is_imported_and_written_is_read_again(file: Path, ending: str, tmp_path: Path) -> None:
    consist, found = imported_consist(file)
    write_consist(found.rows, tmp_path / f"again.{ending}")
    assert read_consist(tmp_path / f"again.{ending}") == consist


def test_a_coupler_has_slack_stiffness_and_strength_of_its_file(tmp_path: Path) -> None:
    """r0 ( 0 2cm ) with equal stiffnesses is a slack of 5 mm; 7 x (1 + 1) MN/m gives 350 kN at 30 mm."""
    spring = "Spring ( Stiffness ( 1e6N/m 1e6N/m ) Break ( 2e6N 2e6N ) r0 ( 0 2cm ) )"
    path = tmp_path / "hopper.wag"
    path.write_text(WAGON.rstrip()[:-1] + f"Coupling ( Type ( Automatic ) {spring} ) )")
    coupler = imported_consist(path)[0].vehicles[0].coupler
    loading = coupler.tension[0]
    assert np.interp([0.005, 0.03], loading.ways, loading.forces) == pytest.approx([0.0, 350e3], abs=1e-6)
    assert coupler.strength == 2e6
    path.write_text(WAGON.rstrip()[:-1] + f"Coupling ( Type ( Bar ) {spring} ) )")
    assert imported_consist(path)[0].vehicles[0].coupler == rigid()


def test_refinements_beyond_their_limits_are_told_and_left(tmp_path: Path) -> None:
    path = tmp_path / "hopper.wag"
    path.write_text(WAGON)
    _, found = imported_consist(path)
    assert found.rows[0]["release_time"] == 240.0
    assert any(sentence.startswith("release_time: ") and "; 240 s is taken." in sentence for sentence in found.left)
    path.write_text(WAGON.replace("ORTSNumber", "BrakeCylinderPressureForMaxBrakeBrakeForce ( 70 ) ORTSNumber"))
    _, found = imported_consist(path)
    assert "full_pressure" not in found.rows[0]
    assert any("does not reach 4.826 bar" in sentence for sentence in found.left)


@pytest.mark.parametrize(
    ("name", "old", "new", "column"),
    [
        ("hopper.wag", "MaxReleaseRate", "ORTSBrakeCylinderVolume ( 1e6l ) MaxApplicationRate", "cylinder"),
        ("hopper.wag", "Shoes ( 16 ) MaxReleaseRate", "Shoes ( 200 ) MaxApplicationRate", "shoes"),
    ],
)
def test_the_default_that_is_told_is_the_one_that_is_taken(
    name: str, old: str, new: str, column: str, tmp_path: Path
) -> None:
    """A consist that states the number of the sentence is the one from which the value was left out."""
    path = tmp_path / name
    assert FILES[name].count(old) == 1
    path.write_text(FILES[name].replace(old, new).replace("0.001bar", "0.2bar"))
    consist, found = imported_consist(path)
    sentence = next(one for one in found.left if one.startswith(f"{column}: "))
    default = re.search(r"; the default of ([\d.]+)( s| l|) is taken\.$", sentence)
    assert default
    assert column not in found.rows[0]
    assert consist_of([row | {column: float(default[1])} for row in found.rows]) == consist


@pytest.mark.parametrize(
    ("brake", "up", "down", "column", "limit"),
    [
        ("2", "90", "1e4", "release_time", 0.5),
        ("1", "500", "1e4", "release_time", 0.5),
        ("1", "1e4", "200", "fill_time", 0.5),
        ("2", "3", "200", "fill_time", 120.0),
    ],
)
def test_of_a_time_beyond_its_limits_the_nearest_one_is_taken(
    brake: str, up: str, down: str, column: str, limit: float, tmp_path: Path
) -> None:
    path = tmp_path / "train.dat"
    path.write_text(BVE.replace("#BRAKE\n2", f"#MOVE\n500\n200\n500\n500\n{up}\n{down}\n#BRAKE\n{brake}"))
    _, found = imported_consist(path)
    sentence = next(one for one in found.left if one.startswith(f"{column}: "))
    assert sentence.endswith(f"; {limit:g} s is taken.")
    assert [row[column] for row in found.rows] == [limit] * len(found.rows)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("DynamicBrakesMaximumForce ( 5000kN ) DynamicBrakesFadingSpeed ( 9 )", "dynamic_force: 5000"),
        ("DynamicBrakesMaximumForce ( 5000kN ) DynamicBrakesMaximumEffectiveSpeed ( 90 )", "dynamic_force: 5000"),
    ],
)
def test_with_a_force_beyond_its_limits_its_brake_is_left_out(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "hopper.eng"
    path.write_text(f"{WAGON} Engine ( hopper {text} )")
    consist, found = imported_consist(path)
    assert consist.vehicles[0].electric.dynamic_force == 0.0
    told = [one for one in found.left if one.startswith("dynamic_")]
    assert [one.endswith("the dynamic brake is left out.") for one in told] == [True]
    assert told[0].startswith(sentence)


def test_a_resistance_beyond_its_limit_is_refused_with_it(tmp_path: Path) -> None:
    path = tmp_path / "hopper.wag"
    path.write_text(WAGON.replace("ORTSDavis_C ( 5 )", "ORTSDavis_C ( 2000 )"))
    with pytest.raises(ValueError, match=r"resistance_c must be a number from 0 to 1000 N/\(m/s\)\^2; got "):
        imported_consist(path)


def test_limits_of_importers_are_those_of_consists() -> None:
    length, mass = VEHICLE["length"], VEHICLE["mass"]
    assert (length.least, length.most) == (vehicle_rows.SHORTEST, vehicle_rows.LONGEST)
    assert (mass.least, mass.most) == (vehicle_rows.LIGHTEST, vehicle_rows.HEAVIEST)
    assert vehicle_rows.MOST == MOST
    assert "mass" in ESSENTIAL


def test_the_command_imports_writes_and_checks(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "train.toml"
    assert main(["consist", "import", str(file), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert f"({FORMATS[file.suffix][0]})" in said
    assert "assumed" in said
    assert read_consist(out) == consist_from(file)[0]
    assert main(["consist", "import", str(file), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["rows"] == imported_consist(file)[1].rows


def test_the_command_prints_numbers_of_a_consist(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "Coal.yaml"
    path.write_text(CAR)
    assert main(["consist", "check", str(path), "--speeds", "36", "72km/h", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["vehicles"], found["mass"], found["length"]) == (1, 130.0, 18.0)
    slow, fast = found["speeds"]
    resistance, force = by_hand("Coal.yaml", 10.0)
    assert slow["resistance"] == pytest.approx(1e-3 * resistance, rel=ROUNDED)
    assert slow["brake_force"] == pytest.approx(1e-3 * force, rel=ROUNDED)
    # Between the distance of brakes that are full at once, and that of brakes that are full after 6 s.
    for one, speed in ((slow, 10.0), (fast, 20.0)):
        at_once = (1 + 3 / 130) * 130e3 * speed**2 / 2 / (force + resistance)
        assert at_once < one["distance"] < at_once + 6 * speed
    assert main(["consist", "check", str(path), "--speeds", "36"]) == 0
    assert "emergency stop" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (["import", "none.con"], "does not exist"),
        (["import", "train.toml"], "must be a train of another program; got a .toml file, as a consist is."),
        (["import", "cut.json"], "must be JSON"),
        (["import", "heavy.json"], "mass of each"),
        (["import", "unit.json", "--out", "train.txt"], "--out must end in .toml or .csv"),
        (["check", "cut.json"], "must be JSON"),
        (["check", "none.toml"], "does not exist"),
        (["check", "unit.json", "--speeds", "900"], "--speeds must be"),
    ],
)
def test_what_is_no_train_ends_with_one_sentence_and_status_2(
    given: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "unit.json").write_text(json.dumps(OSRD))
    (tmp_path / "cut.json").write_text(json.dumps(OSRD)[:40])
    (tmp_path / "heavy.json").write_text(json.dumps(OSRD | {"length": 3.0, "mass": 1e9}))
    arguments = [str(tmp_path / one) if "." in one else one for one in given]
    assert main(["consist", *arguments]) == 2
    said = capsys.readouterr()
    assert sentence in said.err
    assert said.err.count("\n") == 1
    assert not said.out


def test_a_train_of_another_program_runs_with_its_account(tmp_path: Path) -> None:
    path = tmp_path / "unit.json"
    path.write_text(json.dumps(OSRD))
    train = bb.train(path, speed=20.0)
    assert train.imported is not None
    assert any("const_gamma" in sentence for sentence in train.imported.assumed)
    assert bb.train(1).imported is None
    train.drive("emergency")
    stop = train.record(120.0)
    assert float(train.speed[0]) == pytest.approx(0.0, abs=1e-3)
    way = float(stop["distance[1]"][-1] - stop["distance[1]"][0])
    assert 20.0**2 / 2 / 0.75 < way < 20.0**2 / 2 / 0.7 + 6 * 20.0


def test_an_fmu_of_another_programs_train_has_its_rows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "unit.json"
    path.write_text(json.dumps(OSRD))
    assert build_all(["train"], ["native"], tmp_path, consist=path) == []
    assert "assumptions; bogie-braking consist import" in capsys.readouterr().out
    with zipfile.ZipFile(tmp_path / "native" / "TrainDynamics.fmu") as packed:
        (tmp_path / "again.toml").write_bytes(packed.read("resources/unit.toml"))
    assert read_consist(tmp_path / "again.toml") == consist_from(path)[0]


def test_a_train_without_brakes_has_no_brake_weight(tmp_path: Path) -> None:
    path = tmp_path / "piped.wag"
    path.write_text('Wagon ( a Type ( Freight ) Size ( 3 4 14m ) Mass ( 20t ) BrakeSystemType ( "Air_piped" ) )')
    found = summary_of(imported_consist(path)[0], [])
    assert (found.brake_weight, found.percentage) == (0.0, 0.0)


def test_a_direct_brake_fills_at_the_rate_of_its_file(tmp_path: Path) -> None:
    """440 kPa at 0.3 x 300 kPa/s is full to 95 % after 4.64 s, after a dead time of 0.5 s."""
    path = tmp_path / "train.dat"
    path.write_text(BVE.replace("#BRAKE\n2", "#DELAY\n0\n0\n0.5\n0\n#BRAKE\n1"))
    train = bb.train(path, speed=25.0)
    train.drive("emergency")
    train.advance(0.5 + 0.95 * 440 / 90)
    assert train.cylinder_pressure[0] == pytest.approx(0.95 * 440e3, rel=0.02)


def test_a_summary_adds_brake_weights(tmp_path: Path) -> None:
    path = tmp_path / "ic.xml"
    path.write_text(RAILML)
    found = summary_of(imported_consist(path)[0], [])
    weight = sum(kind.count * kind.mass * kind.percentage / 100 for kind in found.kinds)
    assert found.brake_weight == pytest.approx(weight)
    assert found.percentage == pytest.approx(100 * weight / found.mass, rel=1e-6)
