"""Trains of Open Rails and MSTS: numbers by hand from files that are written here, and damaged files."""

from __future__ import annotations

from pathlib import Path

import pytest

from products.train.consist_file import consist_of
from products.train.imported_consist import imported_consist
from products.train.summary import brake_force
from readers.formats.open_rails_text import DEEPEST, DEEPEST_INCLUDE, MOST_INCLUDES, Reader
from readers.formats.trains import read_foreign
from readers.import_account import Imported
from readers.text import FileError

#: Pound-force [N], mile per hour [m/s], pound per square inch [bar] (NIST SP 811).
POUND, MILE, PSI = 4.4482216152605, 0.44704, 0.0689475729316836
CONSIST = """SIMISA@@@@@@@@@@JINX0D0t______

Train (
	TrainCfg ( "freight"
		Name ( "A freight train" )
		MaxVelocity ( 36.65728 1.00000 )
		Engine ( UiD ( 0 ) EngineData ( power "Big Power" ) )
		Wagon ( WagonData ( HOPPER hopper ) UiD ( 1 ) )
		Wagon ( WagonData ( HOPPER hopper ) UiD ( 2 ) )
		Engine ( Flip ( ) UiD ( 3 ) EngineData ( power "Big Power" ) )
	)
)
"""
ENGINE = """SIMISA@@@@@@@@@@JINX0D0t______
Wagon ( power
	comment ( a remark with ( brackets ) and MaxBrakeForce ( 1kN ) )
	Name ( "Power " + "no. 1" )
	Type ( Engine )
	Size ( 3.2m 4.7m 73ft )
	Mass ( 181.1t#estimate )
	#MaxBrakeForce ( 2kN )
	BrakeSystemType ( "Air_single_pipe" )
	BrakeEquipmentType ( "Handbrake, Triple_valve, Auxilary_reservoir, Emergency_brake_resevoir" )
	MaxHandbrakeForce ( 20kN )
	BrakeCylinderPressureForMaxBrakeBrakeForce ( 64 )
	MaxApplicationRate ( 0.9 )
	MaxReleaseRate ( 5psi/s )
	ORTSMaxBrakeShoeForce ( 31300lbf )
	ORTSBrakeShoeType ( High_Friction_Composite )
	ORTSNumberCarBrakeShoes ( 12 )
	ORTSDavis_A ( 184.784lbf )
	ORTSDavis_B ( 2.38lbf/mph )
	ORTSDavis_C ( 0.06458lbf/mph^2 )
	ORTSMaxBrakeShoeForse ( 3 )
	Coupling ( Type ( Automatic ) CouplingHasRigidConnection ( 1 ) )
	Coupling ( Type ( Automatic ) Spring ( Stiffness ( 1e6N/m 5e6N/m ) Break ( 2e6N 2e6N ) r0 ( 0 2cm ) ) )
)
Engine ( power Type ( Diesel ) MaxPower ( 3281kW ) )
"""
HOPPER = """include ( "..\\common\\Brakes.inc" )
Wagon ( hopper
	Type ( Freight ) Size ( 3m 4m 15.7 ) Mass ( 44 t )
	MaxBrakeForce ( 63.7kN )
"""
BRAKES = """Wagon ( brakes
	BrakeSystemType ( "Air_single_pipe" ) MaxBrakeForce ( 10kN )
	MaxApplicationRate ( 0.5bar/s ) MaxReleaseRate ( 0.25bar/s )
	BrakeCylinderPressureForMaxBrakeBrakeForce ( 380kpa )
)
"""


def written(folder: Path, encoding: str = "utf-8") -> Path:
    """Write the files as MSTS keeps them, with names in other cases than the consist's; return the consist."""
    for name, text in (
        ("CONSISTS/freight.con", CONSIST),
        ("TRAINSET/Big Power/Power.ENG", ENGINE),
        ("TRAINSET/Hopper/hopper.wag", HOPPER),
        ("TRAINSET/Common/brakes.inc", BRAKES),
    ):
        path = folder / "TRAINS" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding=encoding)
    return folder / "TRAINS" / "CONSISTS" / "freight.con"


def told(found: Imported, kind: str, words: str) -> bool:
    return any(words in sentence for sentence in getattr(found, kind))


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_a_consist_has_the_numbers_of_its_files(encoding: str, tmp_path: Path) -> None:
    found = read_foreign(written(tmp_path, encoding))
    head, wagons, last = found.rows
    assert (head["kind"], wagons["kind"], wagons["count"], last["kind"]) == ("locomotive", "wagon", 2, "locomotive")
    assert head["name"] == "Power no. 1"
    assert head["mass"] == 181.1
    assert head["length"] == pytest.approx(73 * 0.3048, rel=1e-9)
    assert wagons["mass"] == 44.0
    assert wagons["length"] == 15.7
    assert head["resistance_a"] == pytest.approx(184.784 * POUND, rel=1e-9)
    assert head["resistance_b"] == pytest.approx(2.38 * POUND / MILE, rel=1e-9)
    assert head["resistance_c"] == pytest.approx(0.06458 * POUND / MILE**2, rel=1e-9)
    assert head["shoe_force"] == pytest.approx(31.3 * POUND, rel=1e-9)
    assert (head["friction"], head["shoes"]) == ("composite", 12)
    assert head["full_pressure"] == pytest.approx(64 * PSI, rel=1e-9)
    assert head["fill_time"] == pytest.approx(0.95 * 64 / 0.9, rel=1e-9)
    assert head["release_time"] == pytest.approx((64 * PSI - 0.4) / (5 * PSI), rel=1e-9)
    assert (wagons["brake_force"], wagons["full_pressure"]) == (63.7, 3.8)
    assert wagons["fill_time"] == pytest.approx(0.95 * 3.8 / 0.5, rel=1e-9)
    assert wagons["release_time"] == pytest.approx(3.4 / 0.25, rel=1e-9)


def test_a_flipped_vehicle_has_the_second_coupler_of_its_file_behind_it(tmp_path: Path) -> None:
    """Open Rails, MSTSWagon.cs: Coupler. By hand: 7 x (1 + 5) MN/m; 2 cm / 2 x 5 / 6 = 8.33 mm."""
    head, _, last = read_foreign(written(tmp_path)).rows
    assert head["coupler"] == "rigid"
    assert (last["coupler"], last["coupler_stiffness"], last["coupler_strength"]) == ("draft-gear", 42.0, 2000.0)
    assert last["coupler_slack"] == pytest.approx(25 / 3)


@pytest.mark.parametrize(
    ("spring", "stiffness", "slack"),
    [
        ("Stiffness ( 1e6N/m 5e6N/m ) r0 ( 0 2cm )", 42.0, 25 / 3),
        ("r0 ( 0 2cm ) Stiffness ( 1e6N/m 5e6N/m )", 42.0, 20 / 3),
        ("Stiffness ( 1e6N/m 5e6N/m ) r0 ( 20cm 30cm )", 20.0, 12.0),
        ("Stiffness ( 1e6N/m 5e6N/m )", 42.0, 12.0),
        ("r0 ( 0 9m )", 210.0, 100.0),
        ("Stiffness ( 1e6N/m 0 ) r0 ( 0 2cm )", 7.0, 1.0),
        ("Stiffness ( -9e6N/m 1e6N/m ) r0 ( 0 3cm )", 210.0, 10.0),
    ],
)
def test_a_simple_coupler_has_stiffness_and_slack_of_open_rails(
    spring: str, stiffness: float, slack: float, tmp_path: Path
) -> None:
    """Open Rails, MSTSWagon.cs: GetSimpleCouplerStiffnessNpM, SetSimpleStiffness and SetSimpleR0."""
    path = tmp_path / "one.wag"
    path.write_text(f"Wagon ( one Size ( 3 4 14m ) Mass ( 20t ) Coupling ( Type ( Automatic ) Spring ( {spring} ) ) )")
    row = imported_consist(path)[1].rows[0]
    assert (row["coupler_stiffness"], row["coupler_slack"]) == (pytest.approx(stiffness), pytest.approx(slack))


def test_couplings_of_an_included_file_replace_those_before_them(tmp_path: Path) -> None:
    """The third Coupling is the first of its vehicle, the fourth the second (MSTSWagon.cs)."""
    path = tmp_path / "one.wag"
    springs = "".join(f"Coupling ( Spring ( Stiffness ( {one}e6N/m 0 ) ) )" for one in (1, 2, 3))
    path.write_text(f"Wagon ( one Size ( 3 4 14m ) Mass ( 20t ) {springs} )")
    assert read_foreign(path).rows[0]["coupler_stiffness"] == 21.0


def test_a_hand_brake_is_a_parking_brake_beside_which_the_larger_force_acts(tmp_path: Path) -> None:
    head, wagons, _ = read_foreign(written(tmp_path)).rows
    assert (head["parking_force"], head["parking_compounding"]) == (20.0, "larger")
    assert "parking_force" not in wagons
    own, _ = imported_consist(written(tmp_path))
    assert own.vehicles[0].parking.parking_force == pytest.approx(20e3)
    path = tmp_path / "power.eng"
    for force, due in (("0kN", 0.0), ("5000kN", 0.0), ("30kN", 30e3)):
        path.write_text(ENGINE.replace("20kN", force))
        own, found = imported_consist(path)
        assert own.vehicles[0].parking.parking_force == pytest.approx(due)
        assert bool(
            told(found, "left", "parking_force: 5000 is outside 0.1 to 1000 kN; the hand brake is left out.")
        ) == (force == "5000kN")


def test_what_is_misspelt_ignored_and_doubtful_is_told(tmp_path: Path) -> None:
    found = read_foreign(written(tmp_path))
    assert told(found, "left", "emergency_brake_resevoir")
    assert told(found, "left", "did you mean ORTSMaxBrakeShoeForce?")
    assert told(found, "assumed", "MaxHandbrakeForce with ORTSMaxBrakeShoeForce: taken at the rims")
    assert told(found, "assumed", "0.9 psi/s is Open Rails' default, 68 s")
    assert told(found, "assumed", "friction 0.20")
    assert told(found, "assumed", "44 t is read with its unit")
    assert told(found, "assumed", "closing bracket of wagon")


def test_open_rails_friction_of_old_files_is_as_told() -> None:
    """(7.6 / (V + 17.5) + 0.07) / 0.20: 1 at 41 km/h, 0.67 at 100 km/h."""
    for speed, share in ((41.0, 1.0), (100.0, 0.67)):
        own = (7.6 / (speed + 17.5) + 0.07) / 0.2
        assert own == pytest.approx(share, abs=5e-3)


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("MaxBrakeForce ( 0 )", {"brake": "none"}),
        ('BrakeSystemType ( "Air_piped" ) MaxBrakeForce ( 50kN )', {"brake": "none"}),
        ('BrakeSystemType ( "EP" ) MaxBrakeForce ( 11240lbf )', {"brake": "ep-direct", "brake_force": 11.24 * POUND}),
        (
            'BrakeSystemType ( "EP" ) ORTSEPBrakeControlsBrakePipe ( 1 ) MaxBrakeForce ( 50kN )',
            {"brake": "pneumatic", "distributor": "ep_uic", "brake_force": 50.0},
        ),
        (
            'BrakeSystemType ( "EP" ) ORTSEPBrakeControlsBrakePipe ( 1 ) MaxBrakeForce ( 0 )',
            {"brake": "none"},
        ),
        (
            'BrakeSystemType ( "Air_twin_pipe" ) MaxBrakeForce ( 50kN )',
            {"brake": "pneumatic", "distributor": "twin_pipe", "brake_force": 50.0},
        ),
        ("ORTSMaxBrakeShoeForce ( 100kN )", {"shoe_force": 100.0, "friction": "cast-iron-p6"}),
        (
            "ORTSMaxBrakeShoeForce ( 100kN ) ORTSBrakeShoeFriction ( 0 0.4 100 0.2 )",
            {"shoe_force": 100.0, "friction": "speed", "friction_value": 0.4},
        ),
        (
            "ORTSMaxBrakeShoeForce ( 100kN ) ORTSBrakeShoeFriction ( 0 0.35 100 0.35 )",
            {"shoe_force": 100.0, "friction": "constant", "friction_value": 0.35},
        ),
        (  # 200 l / 1.4 and, at a ratio of 2.5, that / 2.5; 20 l less pi / 4 31.75^2 mm2 (14 + 1.24) m
            "EmergencyResCapacity ( 200L ) TripleValveRatio ( 2.5 ) BrakePipeVolume ( 20L )",
            {"auxiliary": 200 / 1.4, "cylinder": 200 / 1.4 / 2.5, "branch": 20.0 - 12.065971846},
        ),
        (  # 2 cylinders of 10 x 12 in at a ratio of 3
            "ORTSBrakeCylinderDiameter ( 10in ) ORTSBrakeCylinderPistonTravel ( 12in ) ORTSNumberBrakeCylinders ( 2 ) "
            "TripleValveRatio ( 3 )",
            {"cylinder": 2 * 15.444443963, "auxiliary": 6 * 15.444443963},
        ),
        (
            "MaxBrakeForce ( 50kN ) ORTSBrakeShoeType ( Cast_Iron_P10 ) ORTSNumberCarBrakeShoes ( 8 )",
            {"brake_force": 50.0, "friction": "cast-iron-p10", "shoes": 8},
        ),
        (
            "MaxBrakeForce ( 50kN ) ORTSBrakeForceReferencePressure ( 50 ) "
            "BrakeCylinderPressureForMaxBrakeBrakeForce ( 60 )",
            {"brake_force": 60.0, "full_pressure": 60 * PSI},
        ),
        ("ORTSAuxiliaryResCapacity ( 2500in^3 )", {"auxiliary": 2500 * 0.254**3}),
        (
            "ORTSMaxBrakeShoeForce ( 75kN ) ORTSBrakeShoeType ( Disc_Pads ) ORTSNumberAxles ( 4 )",
            {"shoe_force": 75.0, "friction": "pads", "friction_radius": 1.0, "shoes": 16},
        ),
    ],
)
def test_a_brake_is_as_its_fields_say(text: str, columns: dict[str, object], tmp_path: Path) -> None:
    path = tmp_path / "one.wag"
    path.write_text(f"SIMISA\nWagon ( one Type ( Freight ) Size ( 3 4 14m ) Mass ( 20t ) {text} )")
    row = read_foreign(path).rows[0]
    for name, value in columns.items():
        assert row[name] == (pytest.approx(value, rel=1e-9) if isinstance(value, float) else value)


def test_a_dynamic_brake_has_its_largest_force(tmp_path: Path) -> None:
    path = tmp_path / "one.eng"
    text = "Wagon ( one Type ( Engine ) Size ( 3 4 19m ) Mass ( 84t ) MaxBrakeForce ( 60kN ) )"
    path.write_text(f"{text} Engine ( one Type ( Diesel ) DynamicBrakesMaximumForce ( 100kN ) )")
    row = read_foreign(path).rows[0]
    assert row["dynamic_force"] == 100.0
    assert not {"dynamic_power", "dynamic_fade"} & set(row)
    speeds = "ORTSDynamicBrakeForceRampUpRate ( 40kN/s ) "
    speeds += "DynamicBrakesFadingSpeed ( 10 ) DynamicBrakesMaximumEffectiveSpeed ( 36km/h )"
    path.write_text(f"{text} Engine ( one Type ( Diesel ) DynamicBrakesMaximumForce ( 100kN ) {speeds} )")
    row = read_foreign(path).rows[0]
    assert row["dynamic_fade"] == pytest.approx(16.09344, rel=1e-9)  # 10 mph, the unit of the field
    assert row["dynamic_rise"] == 2.5
    assert row["dynamic_power"] == pytest.approx(1000.0, rel=1e-9)  # 100 kN at 10 m/s


@pytest.mark.parametrize("force", ["MaxBrakeForce ( 60kN )", "ORTSMaxBrakeShoeForce ( 60kN )"])
def test_a_table_of_friction_is_a_friction_that_changes_with_speed(force: str, tmp_path: Path) -> None:
    """mu = 0.1 + 0.3 40 / (V + 40): 0.4, 0.3, 0.25, 0.2, 0.18571 at 0, 20, 40, 80, 100 km/h."""
    path = tmp_path / "one.wag"
    start = f"Wagon ( one Type ( Freight ) Size ( 3 4 14m ) Mass ( 20t ) {force} ORTSBrakeShoeFriction ("
    table = [(v, 0.1 + 12 / (v + 40)) for v in range(0, 121)]
    path.write_text(f"{start} {' '.join(f'{v} {mu}' for v, mu in table)} ) )")
    found = read_foreign(path)
    row = found.rows[0]
    assert (row["friction_value"], row["friction_fast"]) == pytest.approx((0.4, 0.1), rel=0.01)
    assert row["friction_speed"] == pytest.approx(40.0, rel=0.02)
    assert told(found, "converted", "largest deviation from the table 0.")
    rims = force.startswith("Max")
    for speed, mu in ((0.0, 0.4), (40.0, 0.25), (100.0, 0.1 + 12 / 140)):
        own = brake_force(consist_of([*found.rows]).vehicles[0], speed / 3.6)
        assert own == pytest.approx(60e3 * mu / (0.4 if rims else 1.0), rel=3e-3)
    path.write_text(f"{start} 0 0.4 60 0.1 100 0.3 ) )")
    assert told(read_foreign(path), "assumed", "deviates by 63 % from the table")
    path.write_text(f"{start} 0 0.4 60 ) )")
    with pytest.raises(FileError, match="row 1: ORTSBrakeShoeFriction must be pairs of a speed that grows"):
        read_foreign(path)


@pytest.mark.parametrize(
    ("field", "column", "due"),
    [
        ("ORTSDavis_C ( 5.8N/m/s^2 )", "resistance_c", 5.8),
        ("ORTSDavis_C ( 5.8 N/m/s^2 )", "resistance_c", 5.8),
        ("ORTSDavis_C ( 5.8N/(m/s)^2 )", "resistance_c", 5.8),
        ("ORTSDavis_C ( 5.8 N/(m/s)^2 )", "resistance_c", 5.8),
        ("ORTSAuxiliaryResCapacity ( 2*(ft^3) )", "auxiliary", 2 * 28.316846592),
        ('ORTSDavis_C ( "0.0058kN/(m/s)^2" )', "resistance_c", 5.8),
        ('ORTSDavis_C ( "1N/(km/h)^2" )', "resistance_c", 12.96),
        ('ORTSDavis_B ( "10N/(km/h)" )', "resistance_b", 36.0),
        ("ORTSDavis_B ( 36kg/s )", "resistance_b", 36.0),
        ("MaxBrakeForce ( 5daN )", "brake_force", 0.05),
        ("MaxBrakeForce ( 5 kN )", "brake_force", 5.0),
        ("MaxReleaseRate ( 10kPa/s )", "release_time", (64 * PSI - 0.4) / 0.1),
    ],
)
def test_a_unit_of_a_number_is_that_of_any_reader(field: str, column: str, due: float, tmp_path: Path) -> None:
    path = tmp_path / "one.wag"
    path.write_text(f"Wagon ( one Type ( Freight ) Size ( 3 m 4 m 14 m ) Mass ( 20t ) ORTSDavis_A ( 1 ) {field} )")
    assert read_foreign(path).rows[0][column] == pytest.approx(due, rel=1e-9)


@pytest.mark.parametrize(
    "field",
    [
        *("ORTSDavis_C ( 5.8kips )", "ORTSDavis_C ( 5.8 kips )", "ORTSDavis_A ( none )", "ORTSDavis_B ( )"),
        *("MaxBrakeForce ( 13000 pounds )", "BrakePipeVolume ( 3hogsheads )", "MaxApplicationRate ( 1bar/h )"),
        *("ORTSNumberCarBrakeShoes ( 8pairs )", "MaxHandbrakeForce ( 20x )", "TripleValveRatio ( 2.5:1 )"),
        *("ORTSDavis_C ( 5.8N/(m/s) )", "ORTSDavis_C ( 5.8 N/(m/s) )"),
        "Coupling ( Spring ( Stiffness ( 1e6N/m 5e6lbf/yd ) ) )",
    ],
)
def test_a_unit_that_is_unknown_is_refused_and_not_0(field: str, tmp_path: Path) -> None:
    path = tmp_path / "one.wag"
    path.write_text(
        f"Wagon ( one Type ( Freight ) Size ( 3 4 14m ) Mass ( 20t )\n{field} ORTSMaxBrakeShoeForce ( 9kN ) )"
    )
    with pytest.raises(FileError, match=r"one\.wag, row 2: \w+ must be a number( in .*)?; got '.*'\. Correct it"):
        read_foreign(path)


def test_a_resistance_that_open_rails_ignores_is_told(tmp_path: Path) -> None:
    """MSTSWagon.cs, UpdateTrainBaseResistance: a coefficient of 0 turns ORTSDavis off."""
    path = tmp_path / "one.wag"
    for fields, rest, words in (
        ("ORTSDavis_A ( 1200N ) ORTSDavis_B ( 0 ) ORTSDavis_C ( 5.8 )", 1200.0, "read as it stands"),
        ("ORTSDavis_C ( 5.8 )", None, "the file has no ORTSDavis_A; that of the vehicle's kind applies"),
        ("", None, "the file has no ORTSDavis_A, B, C; that of the vehicle's kind applies"),
    ):
        path.write_text(f"Wagon ( one Type ( Freight ) Size ( 3 4 14m ) Mass ( 20t ) {fields} )")
        found = read_foreign(path)
        assert found.rows[0].get("resistance_a") == rest
        assert told(found, "assumed", f"{words}, where Open Rails takes its own formula")


def test_a_locomotive_behind_the_first_one_has_the_drag_of_open_rails(tmp_path: Path) -> None:
    """MSTSWagon.cs: 0.2083 of it, or ORTSTrailLocomotiveResistanceFactor."""
    path = written(tmp_path)
    head, _, last = read_foreign(path).rows
    assert last["resistance_c"] == pytest.approx(0.2083 * head["resistance_c"])
    assert (last["resistance_a"], last["resistance_b"]) == (head["resistance_a"], head["resistance_b"])
    engine = tmp_path / "TRAINS" / "TRAINSET" / "Big Power" / "Power.ENG"
    engine.write_text(ENGINE.replace("Type ( Engine )", "Type ( Engine ) ORTSTrailLocomotiveResistanceFactor ( 0.5 )"))
    head, _, last = read_foreign(path).rows
    assert last["resistance_c"] == pytest.approx(0.5 * head["resistance_c"])


def test_freight_animations_load_a_wagon(tmp_path: Path) -> None:
    path = tmp_path / "one.wag"
    path.write_text(
        "Wagon ( one Type ( Freight ) Size ( 3 4 14m ) Mass ( 99t ) MaxBrakeForce ( 30kN ) ORTSFreightAnims ( "
        "WagonEmptyWeight ( 20t ) FullMaxBrakeForce ( 60kN ) EmptyMaxBrakeForce ( 20kN ) "
        "FreightAnimContinuous ( FreightWeightWhenFull ( 60t ) FullAtStart ( 1 ) ) ) )"
    )
    row = read_foreign(path).rows[0]
    assert (row["mass"], row["brake_force"]) == (80.0, 60.0)


def test_a_long_vehicle_becomes_several_with_the_same_sums(tmp_path: Path) -> None:
    path = tmp_path / "spine.wag"
    path.write_text("Wagon ( one Type ( Freight ) Size ( 3 4 80m ) Mass ( 150t ) MaxBrakeForce ( 90kN ) )")
    rows = read_foreign(path).rows
    assert sum(row.get("count", 1) for row in rows) == 3
    for name, whole in (("length", 80.0), ("mass", 150.0), ("brake_force", 90.0)):
        assert sum(row[name] * row.get("count", 1) for row in rows) == pytest.approx(whole, rel=1e-9)


def test_a_remark_that_hides_a_field_is_told(tmp_path: Path) -> None:
    path = tmp_path / "one.wag"
    path.write_text("Wagon ( one Size ( 3 4 14m ) Mass ( 20t )\n#Brakes\nMaxBrakeForce ( 50kN ) )")
    found = read_foreign(path)
    assert "brake_force" not in found.rows[0]
    assert told(found, "assumed", "hides MaxBrakeForce")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "must have a block Wagon ( ); got none."),
        ("Wagon ( one Size ( 3 4 14m ) )", "must have Mass in kg, t or lb; got null."),
        (
            "Wagon ( one Size ( 3 4 14m ) Mass ( 3,5t ) )",
            "row 1: Mass must be a number in kg, g, t, lb, t-us, t-uk; got '3,5t'.",
        ),
        ("Wagon ( one Size ( 3 4 ) Mass ( 20t ) )", "must have Size ( width height length )"),
        ('Wagon ( one Size ( 3 4 14m ) Mass ( 20t ) Name ( "a )', "a text in quotes must end"),
        ("Wagon ( one Size ( 3 4 14m ) Mass ( 20t ", "must close the bracket of 'mass'"),
        ("Wagon ( one comment ( Size ( 3 4 14m ) Mass ( 20t )", "the bracket of a comment must be closed"),
        ("Wagon ( one Size ( 3 4 1m ) Mass ( 20t ) )", "length must be from 3 to 31 m; got 1 m."),
        ("Wagon ( one Size ( 3 4 14m ) Mass ( 2 ) )", "mass must be from 1 to 300 t; got 0.002 t."),
        ("Wagon ( one Size ( 3 4 1e9m ) Mass ( 20t ) )", "number of parts"),
        ("(" * 100_000, f"brackets must nest at most {DEEPEST} deep"),
        ('include ( "one.wag" )', "a file must not include itself"),
        ('include ( "none.inc" )', "the included file 'none.inc' does not exist"),
        ("include ( )", "include must name one file"),
        ('include ( "twice.inc" )', f"{DEEPEST_INCLUDE} deep and {MOST_INCLUDES} in number"),
    ],
)
def test_a_damaged_vehicle_is_refused_in_one_sentence(text: str, sentence: str, tmp_path: Path) -> None:
    for number in range(20):
        (tmp_path / f"{number}.inc").write_text(f'include ( "{number + 1}.inc" ) include ( "{number + 1}.inc" )')
    (tmp_path / "twice.inc").write_text('include ( "12.inc" )')
    (tmp_path / "20.inc").write_text("Wagon ( )")
    path = tmp_path / "one.wag"
    path.write_text(text)
    with pytest.raises(FileError) as refused:
        read_foreign(path)
    assert sentence in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_beyond_the_largest_size_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "huge.wag"
    with path.open("wb") as file:
        file.truncate(10**9)
    with pytest.raises(FileError, match="must have at most 8000000 bytes; it has 1000000000"):
        read_foreign(path)


def test_missing_wagons_are_named_once(tmp_path: Path) -> None:
    path = written(tmp_path)
    (tmp_path / "TRAINS" / "TRAINSET" / "Hopper" / "hopper.wag").unlink()
    with pytest.raises(FileError, match=r"got no hopper/HOPPER\.wag\. Copy"):
        read_foreign(path)


@pytest.mark.parametrize(("cut", "sentence"), [(0.55, "must close the bracket"), (0.05, "must have Train")])
def test_a_cut_consist_is_refused(cut: float, sentence: str, tmp_path: Path) -> None:
    path = written(tmp_path)
    path.write_text(CONSIST[: int(cut * len(CONSIST))])
    with pytest.raises(FileError, match=sentence):
        read_foreign(path)


def test_every_cut_of_a_vehicle_is_read_or_refused_in_one_sentence(tmp_path: Path) -> None:
    path = tmp_path / "one.eng"
    whole_from = ENGINE.index("Engine ( power") - 3
    for cut in range(0, len(ENGINE), 37):
        path.write_text(ENGINE[:cut])
        found: Imported | str
        try:
            found = read_foreign(path)
        except FileError as error:
            found = str(error)
        if isinstance(found, str):
            assert "\n" not in found
        else:
            assert told(found, "assumed", "closing bracket") or cut > whole_from


def test_words_brackets_and_remarks_are_separated_as_in_open_rails(tmp_path: Path) -> None:
    path = tmp_path / "text.inc"
    path.write_text('A(1"b c"2)_hidden ( x ( y ) ) #one two B ( "d\\"e" ) skip ( C ( 1 ) ) comment D()')
    root = Reader().read(path)
    assert [block.name for block in root.blocks] == ["a", "b", "d"]
    assert root.blocks[0].words == ["1", "b c", "2"]
    assert root.blocks[1].words == ['d"e']
    assert root.words == ["comment"]
