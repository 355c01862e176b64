"""Brakes of imported vehicles beside those of their own programs: each formula is written here from its source.

A test states each difference beyond 1 %. docs/consists.md gives its reason.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from products.train.consist import Consist
from products.train.consist_file import consist_of
from products.train.imported_consist import imported_consist
from products.train.summary import brake_force
from products.train.train import Train
from readers.formats.trains import read_foreign
from tests.readers.test_foreign_drives import forces
from tests.readers.test_foreign_trains import BVE, CAR, OSRD, RAILML, STRANGERS

#: Largest difference that needs no reason.
CLOSE = 0.01
#: Pounds per square inch [Pa] (NIST SP 811), acceleration of gravity [m/s2].
PSI, G = 6894.757293168, 9.80665
#: Time between two looks at a cylinder [s].
STEP = 0.02
WAGON = (
    "Wagon ( one Type ( Freight ) Size ( 3m 4m 14m ) Mass ( 80t ) MaxBrakeForce ( 100kN ) "
    'BrakeSystemType ( "{}" ) BrakeEquipmentType ( "{}" ) {} )'
)
NORTH_AMERICAN = "Handbrake, Triple_valve, Auxilary_reservoir, Emergency_brake_reservoir"


def imported(folder: Path, name: str, text: str) -> Consist:
    (folder / name).write_text(text, encoding="utf-8")
    return imported_consist(folder / name)[0]


def wagon(folder: Path, fields: str, system: str = "Air_single_pipe", equipment: str = "Distributor") -> Consist:
    return imported(folder, "one.wag", WAGON.format(system, equipment, fields))


def force(consist: Consist, speed: float) -> float:
    """Return the force of the first vehicle at its full pressure and a speed [m/s]."""
    return brake_force(consist.vehicles[0], speed)


def times(consist: Consist, position: str = "emergency") -> tuple[float, float]:
    """Return times [s] of the first vehicle: from a position to 95 % of its full pressure, released to 0.4 bar."""
    full = consist.vehicles[0].distributor.full_pressure
    train = Train(consist)
    train.drive(position, 1.0 if position == "service" else 0.0)
    filling = looks(train, lambda pressure: pressure >= 0.95 * full)
    train = Train(consist)
    train.drive("service", 1.0)
    train.advance(120.0)
    train.drive("running")
    return filling, looks(train, lambda pressure: pressure <= 40e3)


def looks(train: Train, ends: Callable[[float], bool]) -> float:
    """Return the time until the first cylinder meets a condition [s]."""
    begin = train.time
    while not ends(float(train.cylinder_pressure[0])):
        train.advance(STEP)
        assert train.time - begin < 200.0
    return float(train.time - begin)


def deceleration(consist: Consist, speed: float) -> tuple[float, float]:
    """Return the deceleration with full cylinders on level track [m/s2], and its speed [m/s]."""
    full = consist.vehicles[0].distributor.full_pressure
    train = Train(consist, speed=speed, cylinder=full, pipe=350e3)
    train.drive("service", 1.0)
    train.advance(5.0)
    before = float(train.speed.mean())
    train.advance(0.1)
    after = float(train.speed.mean())
    return (before - after) / 0.1, (before + after) / 2


# -- Open Rails: its manual, and its sources TrainCar.cs and AirSinglePipe.cs ----------------------------------------


def iron(speed: float) -> float:
    """Return Open Rails' factor of MaxBrakeForce without a type of shoe, with advanced adhesion, at a speed [m/s]."""
    return min((7.6 / (3.6 * speed + 17.5) + 0.07) / 0.2, 1.0)


@pytest.mark.parametrize("speed", [0.0, 11.0, 18.0, 25.0, 35.0, 50.0])
def test_a_force_at_the_rims_falls_as_in_open_rails(speed: float, tmp_path: Path) -> None:
    assert force(wagon(tmp_path, ""), speed) == pytest.approx(100e3 * iron(speed), rel=CLOSE)


@pytest.mark.parametrize(
    ("word", "law"),
    [
        ("Cast_Iron_P6", (0.024, 62.5, 12.5, 100.0, 20.0)),
        ("Cast_Iron_P10", (0.05, 62.5, 31.25, 100.0, 20.0)),
        ("High_Friction_Composite", (0.055, 200.0, 50.0, 150.0, 75.0)),
        ("Disc_Pads", (0.385, -24.5, -27.2, 39.5, 33.0)),
    ],
)
def test_a_force_of_shoes_has_the_friction_of_their_type(word: str, law: tuple[float, ...], tmp_path: Path) -> None:
    """160 kN of 16 shoes: 10 kN each; k1 (F + k2) / (F + k3) (V + k4) / (V + k5)."""
    found = wagon(
        tmp_path, f"ORTSMaxBrakeShoeForce ( 160kN ) ORTSBrakeShoeType ( {word} ) ORTSNumberCarBrakeShoes ( 16 )"
    )
    k1, k2, k3, k4, k5 = law
    for speed in (0.0, 60.0, 120.0):
        due = 160e3 * k1 * (10 + k2) / (10 + k3) * (speed + k4) / (speed + k5)
        assert force(found, speed / 3.6) == pytest.approx(due, rel=CLOSE)


def test_shoes_with_a_friction_of_their_own_are_read_before_the_force_at_the_rims(tmp_path: Path) -> None:
    """Open Rails takes ORTSMaxBrakeShoeForce with any type of shoe; 90 kN at 0.3 are 27 kN."""
    fields = "ORTSMaxBrakeShoeForce ( 90kN ) ORTSBrakeShoeType ( User_Defined ) ORTSBrakeShoeFriction ( 0 0.3 100 0.3 )"
    assert force(wagon(tmp_path, fields), 10.0) == pytest.approx(27e3, rel=CLOSE)


RATES = (
    "MaxApplicationRate ( {}bar/s ) MaxReleaseRate ( 0.2bar/s ) BrakeCylinderPressureForMaxBrakeBrakeForce ( 3.8bar )"
)


@pytest.mark.parametrize(
    ("system", "rate", "differs"),
    [
        ("Air_single_pipe", 0.95, 0.0),
        ("Air_single_pipe", 0.1, 0.0),
        ("EP", 0.95, 0.0),
        ("SME", 0.1, 0.0),
        ("Air_twin_pipe", 0.95, 0.0),
        ("Air_twin_pipe", 0.1, -0.038),
    ],
)
def test_a_cylinder_fills_and_empties_at_the_rates_of_open_rails(
    system: str, rate: float, differs: float, tmp_path: Path
) -> None:
    """0.95 x 3.8 bar at the rate, (3.8 - 0.4) bar at 0.2 bar/s; with a main pipe slow cylinders fill faster."""
    filling, release = times(wagon(tmp_path, RATES.format(rate), system))
    assert filling / (0.95 * 3.8 / rate) - 1.0 == pytest.approx(differs, abs=CLOSE)
    assert release == pytest.approx(17.0, rel=CLOSE)


@pytest.mark.parametrize(("pipe", "full", "ratio", "more"), [(90.0, 64.0, 2.5, 0.153), (72.5, 55.1, 10.0, 0.012)])
def test_open_rails_fills_more_slowly_near_the_pressure_of_the_reservoir(
    pipe: float, full: float, ratio: float, more: float, tmp_path: Path
) -> None:
    """Its rate is r min((a - c) / 20 psi, 1), with a = p - c / ratio in the reservoir: up to 15 % more time."""
    cylinder = np.linspace(0.0, 0.95 * full, 10_001)
    share = np.minimum((pipe - cylinder * (1 + 1 / ratio)) / 20.0, 1.0)
    theirs = np.trapezoid(1 / share, cylinder) / 5.0
    wagon(tmp_path, f"MaxApplicationRate ( 5 ) BrakeCylinderPressureForMaxBrakeBrakeForce ( {full} )")
    ours = read_foreign(tmp_path / "one.wag").rows[0]["fill_time"]
    assert theirs / ours - 1.0 == pytest.approx(more, abs=2e-3)


@pytest.mark.parametrize(("pressure", "ratio", "share"), [(64.0, 2.5, 1.0), (77.0, 2.5, 0.835), (70.0, 4.0, 1.0)])
def test_a_triple_valve_with_an_emergency_reservoir_has_its_force_at_full_service(
    pressure: float, ratio: float, share: float, tmp_path: Path
) -> None:
    """Full service from 90 psi is 90 r / (1 + r), 64.3 or 72 psi, and the force is proportional to the pressure."""
    fields = f"BrakeCylinderPressureForMaxBrakeBrakeForce ( {pressure} ) TripleValveRatio ( {ratio} )"
    found = wagon(tmp_path, fields, equipment=NORTH_AMERICAN)
    assert force(found, 0.0) == pytest.approx(share * 100e3, rel=CLOSE)


def test_a_triple_valve_releases_wholly_and_a_distributor_gradually(tmp_path: Path) -> None:
    left = {}
    for equipment in (NORTH_AMERICAN, "Distributor"):
        train = Train(wagon(tmp_path, "MaxApplicationRate ( 10 ) MaxReleaseRate ( 5 )", equipment=equipment))
        train.drive("service", 1.0)
        train.advance(60.0)
        full = float(train.cylinder_pressure[0])
        train.drive("service", 0.4)
        train.advance(60.0)
        left[equipment] = float(train.cylinder_pressure[0]) / full
    assert left[NORTH_AMERICAN] < 0.02
    assert 0.2 < left["Distributor"] < 0.8


def test_north_american_valves_have_rates_of_the_file_and_an_emergency_of_their_own(tmp_path: Path) -> None:
    """64 x 0.95 / 5 = 12.16 s, (64 - 5.8) / 5 = 11.64 s, and the same force in an emergency; AAR fills by its chokes.

    A release of an AAR valve begins as the pipe has risen, after half a second.
    """
    fields = "MaxApplicationRate ( 5 ) MaxReleaseRate ( 5 ) BrakeCylinderPressureForMaxBrakeBrakeForce ( 64 )"
    for system, fills, empties in (("Air_single_pipe", 5.36, 12.12), ("ECP", 12.16, 11.64)):
        found = wagon(tmp_path, fields, system, NORTH_AMERICAN)
        by_wire = system == "ECP"
        assert times(found, "service" if by_wire else "emergency") == pytest.approx((fills, empties), rel=CLOSE)
        assert force(found, 0.0) == pytest.approx(100e3, rel=CLOSE)
        train = Train(found)
        train.drive("emergency")
        train.advance(60.0)
        assert train.cylinder_pressure[0] / found.vehicles[0].distributor.full_pressure == pytest.approx(1.2, rel=CLOSE)


def test_accelerated_release_is_off_unless_the_file_has_it(tmp_path: Path) -> None:
    for text, on in (
        ("", False),
        ("ORTSEmergencyResQuickRelease ( 0 )", False),
        ("ORTSEmergencyResQuickRelease ( 1 )", True),
    ):
        own = wagon(tmp_path, text, equipment=NORTH_AMERICAN).vehicles[0].distributor
        assert (own.values()["accelerated_choke"] > 0.0) == on


@pytest.mark.parametrize(
    ("equipment", "kind"),
    [
        (NORTH_AMERICAN, "AarValve"),
        (f"{NORTH_AMERICAN}, Graduated_release_triple_valve", "UicDistributor"),
        (f"{NORTH_AMERICAN}, Distributor", "UicDistributor"),
        ("Triple_valve", "UicDistributor"),
        ("Emergency_brake_reservoir", "UicDistributor"),
    ],
)
def test_words_of_the_equipment_choose_the_valve(equipment: str, kind: str, tmp_path: Path) -> None:
    assert type(wagon(tmp_path, "", equipment=equipment).vehicles[0].distributor).__name__ == kind


def test_a_dynamic_brake_has_the_force_of_open_rails_between_its_speeds(tmp_path: Path) -> None:
    """All of the force from FadingSpeed to MaximumEffectiveSpeed; below MinUsableSpeed Open Rails has none."""
    text = (
        "Wagon ( one Type ( Engine ) Size ( 3 4 19m ) Mass ( 84t ) MaxBrakeForce ( 60kN ) ) Engine ( one "
        "DynamicBrakesMaximumForce ( 100kN ) DynamicBrakesMinUsableSpeed ( 2km/h ) DynamicBrakesFadingSpeed ( 18km/h ) "
        "DynamicBrakesMaximumEffectiveSpeed ( 72km/h ) )"
    )
    (tmp_path / "one.eng").write_text(text)
    own = forces(read_foreign(tmp_path / "one.eng"), "dynamic_brake", "brake_force", [5.5, 12.0, 19.5, 0.5])
    assert own[:3] == pytest.approx(100e3, rel=CLOSE)
    assert own[3] == pytest.approx(10e3, rel=CLOSE)  # 0 in Open Rails


# -- OSRD: its documentation of const_gamma --------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [10.0, 35.0])
def test_the_brake_of_osrd_has_its_deceleration_and_resistance_is_added(speed: float, tmp_path: Path) -> None:
    """OSRD's trains brake with const_gamma, resistance included; here it comes on top: 5 to 9 % at 0.3 m/s2."""
    stock = OSRD | {"rolling_resistance": {"type": "davis", "A": 2e4, "B": 200.0, "C": 12.0}}
    found = imported(tmp_path, "unit.json", json.dumps(stock))
    turning = 1.048 * 2090e3
    own, at = deceleration(found, speed)
    resistance = (2e4 + 200.0 * at + 12.0 * at**2) / turning
    assert sum(brake_force(one, speed) for one in found.vehicles) / turning == pytest.approx(0.3, rel=CLOSE)
    assert own == pytest.approx(0.3 + resistance, rel=CLOSE)
    assert 0.03 < resistance / 0.3 < 0.08


# -- ALTRIOS: its module train/rail_vehicle --------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [0.0, 20.0])
def test_the_force_of_an_altrios_car_is_0_3_of_altrios_own(speed: float, tmp_path: Path) -> None:
    """ALTRIOS: braking_ratio x weight; here that is the force of the shoes, with a friction of 0.3."""
    found = imported(tmp_path, "car.yaml", CAR)
    theirs = 0.11 * 130e3 * G
    assert force(found, speed) / theirs == pytest.approx(0.3, rel=CLOSE)
    rows = [row | {"friction_value": 1.0} for row in read_foreign(tmp_path / "car.yaml").rows]
    assert force(consist_of(rows), speed) == pytest.approx(theirs, rel=CLOSE)


def test_an_altrios_car_fills_in_the_time_of_position_p(tmp_path: Path) -> None:
    """The ramp of a built train of ALTRIOS is 0 s."""
    assert times(imported(tmp_path, "car.yaml", CAR))[0] == pytest.approx(4.5, abs=0.1)


# -- OpenBVE: its manual of train.dat ----------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [15.0, 30.0])
def test_a_train_of_openbve_decelerates_as_it_states(speed: float, tmp_path: Path) -> None:
    """4.2 km/h/s, and the resistance (0.0025 W + 0.5 rho 1.2 A v^2) / m of 155 t and 14 m2 in all."""
    found = imported(tmp_path, "train.dat", BVE)
    own, at = deceleration(found, speed)
    assert own == pytest.approx(4.2 / 3.6 + 0.0025 * G + 0.5 * 1.2041 * 1.2 * 14 * at**2 / 155e3, rel=CLOSE)
    assert [brake_force(one, at) / one.mass for one in found.vehicles] == pytest.approx([4.2 / 3.6] * 5, rel=CLOSE)


def test_cylinders_of_openbve_fill_at_0_3_of_the_rate_after_their_delay(tmp_path: Path) -> None:
    """0.3 s, then 0.95 x 500 kPa at 300 kPa/s; 0.3 s, then 460 kPa at 800 kPa/s. Emergencies have 600 kPa there."""
    found = imported(tmp_path, "train.dat", BVE)
    assert times(found) == pytest.approx((0.3 + 0.95 * 500 / 300, 0.3 + 460 / 800), rel=CLOSE, abs=2 * STEP)
    train = Train(found)
    train.drive("emergency")
    train.advance(10.0)
    assert train.cylinder_pressure[0] / 600e3 == pytest.approx(1 / 1.2, rel=CLOSE)


# -- railML: braked weight percentages, decelerations and forces as its documentation names them -----------------------


def test_a_percentage_of_railml_stops_in_its_distance(tmp_path: Path) -> None:
    """lambda = 52840 / S - 10 with S [m] from 100 km/h, and 2 s at that speed instead of the build-up (EN 16834)."""
    found = imported(tmp_path, "ic.xml", RAILML)
    for vehicle, percentage in ((found.vehicles[0], 95.0), (found.vehicles[1], 125.0)):
        assert vehicle.percentage == pytest.approx(percentage, rel=CLOSE)
        speeds = np.linspace(0.0, 100 / 3.6, 2001)
        a, b, c = vehicle.resistance
        turning = vehicle.mass * (1 + vehicle.rotating_share)
        decelerating = np.array([brake_force(vehicle, v) for v in speeds[::100]])
        total = np.interp(speeds, speeds[::100], decelerating) + a + b * speeds + c * speeds**2
        distance = np.trapezoid(turning * speeds / total, speeds) + 2.0 * 100 / 3.6
        assert 52840 / distance - 10 == pytest.approx(percentage, rel=CLOSE)


EFFORT = (
    '<railml><rollingstock><vehicles><vehicle id="v" length="20" tareWeight="40"><brakes><brakeEffort>'
    '<valueTable xValueUnit="km/h" yValueUnit="kN">{}</valueTable></brakeEffort></brakes></vehicle>'
    "</vehicles></rollingstock></railml>"
)
LINE = '<valueLine xValue="{}"><value yValue="{}"/></valueLine>'


@pytest.mark.parametrize("points", [((0, 60), (100, 20)), ((0, 30), (30, 45), (60, 45), (100, 30), (160, 12))])
def test_forces_of_railml_are_those_of_its_table(points: tuple[tuple[float, float], ...], tmp_path: Path) -> None:
    found = imported(tmp_path, "table.xml", EFFORT.format("".join(LINE.format(*one) for one in points)))
    for speed in (0.0, 20.0, 50.0, 80.0, 150.0):
        due = 1e3 * np.interp(speed, [v for v, _ in points], [f for _, f in points])
        assert force(found, speed / 3.6) == pytest.approx(due, rel=CLOSE)


def test_a_table_of_forces_of_railml_that_is_none_is_told(tmp_path: Path) -> None:
    for points in (((0, 60), (1e-9, 20)), ((0, 60), (100, 0.1)), ((0, 60),)):
        (tmp_path / "table.xml").write_text(EFFORT.format("".join(LINE.format(*one) for one in points)))
        found = read_foreign(tmp_path / "table.xml")
        assert "brake_force" not in found.rows[0]
        assert any("brakeEffort: it is not two rows" in sentence for sentence in found.left)


def test_a_table_of_many_forces_of_railml_is_kept_within_3_percent(tmp_path: Path) -> None:
    """A hyperbola of 33 points on 6 of them, and the deviation is reported."""
    points = [(v, min(60.0, 2400.0 / max(v, 1.0))) for v in range(0, 165, 5)]
    found = imported(tmp_path, "table.xml", EFFORT.format("".join(LINE.format(*one) for one in points)))
    off = max(abs(force(found, v / 3.6) - 1e3 * f) for v, f in points) / 60e3
    told = [one for one in read_foreign(tmp_path / "table.xml").converted if "deviates by up to" in one]
    assert f"{100 * off:.1f} % of the largest" in told[0]
    assert 0.0 < off < 0.03


def test_brakes_of_a_formation_of_railml_leave_a_table_of_forces(tmp_path: Path) -> None:
    text = EFFORT.format(LINE.format(0, 60) + LINE.format(100, 20)).replace("</rollingstock>", "")
    formation = '<formations><formation id="f"><trainOrder vehicleRef="v"/><trainBrakes meanDeceleration="0.9"/>'
    text = text.replace("</railml>", f"{formation}</formation></formations></rollingstock></railml>")
    assert force(imported(tmp_path, "table.xml", text), 0.0) == pytest.approx(60e3, rel=CLOSE)


# -- files of users ----------------------------------------------------------------------------------------------------


def number(pattern: str, text: str) -> float:
    found = re.search(rf"{pattern}\s*([\d.]+)", text)
    assert found
    return float(found[1])


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="CONSISTS_OF_OTHERS names no folder of their files")
def test_cars_of_altrios_and_trains_of_openbve_of_others_brake_as_they_state() -> None:
    cars = [path for path in STRANGERS.rglob("*.yaml") if "braking_ratio:" in path.read_text(encoding="utf-8")]
    for path in cars:
        text = path.read_text(encoding="utf-8")
        mass = number("mass_static_base_kilograms:", text) + number("mass_freight_kilograms:", text)
        due = 0.3 * number("braking_ratio:", text) * mass * G
        assert force(imported_consist(path)[0], 20.0) == pytest.approx(due, rel=CLOSE)
    trains = sorted(STRANGERS.rglob("*.dat"))
    for path in trains:
        due = number("#(?:DECELERATION|PERFORMANCE)", path.read_text(encoding="utf-8", errors="replace")) / 3.6
        for one in imported_consist(path)[0].vehicles:
            assert brake_force(one, 20.0) / one.mass == pytest.approx(due, rel=CLOSE)
    assert cars or trains
