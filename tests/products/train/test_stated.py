"""Consists with data of their own: brakes, friction, times, resistance against closed forms; files written and read."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from brake_controller.air import AMBIENT
from brake_controller.vehicle_brake import braking
from products.train.consist import Consist, block_train, wagon
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import rows_of, write_consist
from products.train.numbers import Settings, numbers_of
from products.train.train import Train

BRAKING = braking()
#: Rounding of a sized force: roots are found to 1e-13.
SIZED = 1e-9


def one_of(**row: Any) -> Any:
    """Return the only vehicle of a row, which has the head's valve."""
    return consist_of([{"kind": "wagon", "valve": "head"} | row]).vehicles[0]


def force(one: Any, speed: float) -> float:
    """Return the brake force at the rims of a vehicle with full cylinders [N]."""
    pressure = one.distributor.full_pressure + AMBIENT
    return float(BRAKING(pressure, speed, list(one.brake.values().values())))


def fraction(k: tuple[float, ...], kilonewton: float, speed: float) -> float:
    """Return k1 (F + k2) / (F + k3) (V + k4) / (V + k5), V in km/h."""
    k1, k2, k3, k4, k5 = k
    return k1 * (kilonewton + k2) / (kilonewton + k3) * (3.6 * speed + k4) / (3.6 * speed + k5)


#: Constants of the laws as printed by the public train simulation, k2 and k3 in kN, k4 and k5 in km/h.
LAWS = {
    "cast-iron-p6": (0.024, 62.5, 12.5, 100.0, 20.0),
    "cast-iron-p10": (0.05, 62.5, 31.25, 100.0, 20.0),
    "composite": (0.055, 200.0, 50.0, 150.0, 75.0),
    "pads": (0.385, -24.5, -27.2, 39.5, 33.0),
}
#: Shoe friction at 10 kN and 0, 60, 120 km/h of the same source, printed to three digits.
PRINTED = {
    "cast-iron-p6": (0.387, 0.155, 0.122),
    "cast-iron-p10": (0.439, 0.176, 0.138),
    "composite": (0.385, 0.299, 0.267),
    "pads": (0.388, 0.347, 0.338),
}


@pytest.mark.parametrize("law", LAWS)
def test_each_law_of_friction_has_its_printed_values(law: str) -> None:
    """Twelve points of the formula, three of them as printed; of two vehicles with other numbers of shoes."""
    radius = {"friction_radius": 1.0} if law == "pads" else {}
    for kilonewton, shoes in ((3.0, 16), (10.0, 8), (15.0, 16), (20.0, 8)):
        one = one_of(shoe_force=shoes * kilonewton, shoes=shoes, friction=law, **radius)
        for speed, printed in zip((0.0, 60.0, 120.0), PRINTED[law], strict=True):
            friction = force(one, speed / 3.6) / (1e3 * shoes * kilonewton)
            assert friction == pytest.approx(fraction(LAWS[law], kilonewton, speed / 3.6), rel=1e-12)
            assert kilonewton != 10.0 or friction == pytest.approx(printed, abs=6e-4)


def test_friction_of_pads_is_constant_from_20_kn_on() -> None:
    own = [one_of(shoe_force=8 * kn, shoes=8, friction="pads", friction_radius=0.5) for kn in (20.0, 26.0, 40.0)]
    assert [force(one, 10.0) / one.brake.force_per_pressure for one in own] == pytest.approx(
        [force(own[0], 10.0) / own[0].brake.force_per_pressure] * 3, rel=1e-12
    )
    assert force(own[0], 10.0) == pytest.approx(0.5 * 160e3 * fraction(LAWS["pads"], 20.0, 10.0), rel=1e-12)


def test_a_table_of_friction_is_linear_between_its_points_and_constant_outside() -> None:
    speeds, frictions = [5.0, 30.0, 70.0, 110.0], [0.31, 0.19, 0.21, 0.12]
    text = " ".join(f"{v:g}:{mu:g}" for v, mu in zip(speeds, frictions, strict=True))
    one = one_of(shoe_force=90.0, friction="table", friction_table=text)
    for speed in (0.0, 4.0, 5.0, 12.0, 30.0, 41.0, 55.0, 70.0, 93.0, 110.0, 140.0, 300.0):
        due = np.interp(speed, speeds, frictions)
        assert force(one, speed / 3.6) == pytest.approx(90e3 * due, rel=1e-12)


def test_a_brake_force_is_that_at_standstill_and_a_force_without_a_law_is_constant() -> None:
    for law in LAWS:
        assert force(one_of(brake_force=60.0, friction=law), 0.0) == pytest.approx(60e3, rel=SIZED)
    assert [force(one_of(brake_force=60.0), v) for v in (0.0, 30.0)] == pytest.approx([60e3, 60e3], rel=1e-12)


def test_lambda_is_that_of_the_vehicle_with_every_law_resistance_pressure_and_rotating_mass() -> None:
    own: list[dict[str, Any]] = [{}, {"friction": "cast-iron-p10"}, {"resistance_a": 2e3}, {"rotating": 9.0}]
    for more in [*own, {"full_pressure": 3.0}, {"friction": "pads", "full_pressure": 3.0}]:
        assert one_of(**{"lambda": 65.0} | more).percentage == pytest.approx(65.0, rel=1e-8)


def test_cylinder_data_give_the_force_of_the_rigging() -> None:
    """F = n i eta (p A - F_return), eqs (2.4) to (2.6)."""
    data = {"cylinder_diameter": 355.0, "cylinders": 2, "rigging_ratio": 3.0, "rigging_efficiency": 0.9}
    one = one_of(return_force=1200.0, friction="constant", friction_value=0.25, full_pressure=3.6, **data)
    area = math.pi / 4 * 0.355**2
    assert force(one, 20.0) == pytest.approx(0.25 * 2 * 3.0 * 0.9 * (3.6e5 * area - 1200.0), rel=1e-12)


def stop(consist: Consist, speed: float, valve: str = "emergency", step: float = 0.01, **start: float) -> float:
    """Return the stopping distance [m]."""
    train = Train(consist, speed=speed, settings=Settings("whole", cells=1.0), **start)
    train.drive(valve, 1.0 if valve == "service" else 0.0)
    while train.speed[0] > 0.0:
        train.advance(step)
    return float(train.distance[0] + consist.vehicles[0].length / 2)


#: Cylinders and pipe as in a full service stop that lasts already.
BRAKED = {"pipe": 350e3, "cylinder": 380e3}


def test_a_deceleration_stops_in_its_distance() -> None:
    """v^2 / 2 a with full cylinders and without a resistance."""
    one = consist_of([{"kind": "wagon", "valve": "head", "deceleration": 0.8, "resistance_a": 0.0, "rotating": 7.0}])
    assert stop(one, 25.0, "service", **BRAKED) == pytest.approx(25.0**2 / 1.6, rel=1e-4)


def test_a_stop_with_cast_iron_is_the_quadrature_of_its_law() -> None:
    """S = int m v / F dv with F = mu(F_shoe, v) F_shoes (EN 14531-1), and the standstill force from the row."""
    row = {"brake_force": 80.0, "friction": "cast-iron-p6", "shoes": 8, "mass": 40.0, "resistance_a": 900.0}
    one = consist_of([{"kind": "wagon", "valve": "head", **row}])
    kilonewton = one.vehicles[0].brake.force_per_pressure * 380.0
    assert fraction(LAWS["cast-iron-p6"], kilonewton / 8, 0.0) * kilonewton == pytest.approx(80.0, rel=SIZED)

    def slows(v: float) -> float:
        return 1.04 * 40e3 * v / (fraction(LAWS["cast-iron-p6"], kilonewton / 8, v) * 1e3 * kilonewton + 900.0)

    assert stop(one, 27.0, "service", 2e-3, **BRAKED) == pytest.approx(quad(slows, 0.0, 27.0)[0], rel=1e-4)


def test_coasting_with_a_davis_resistance_is_its_arc_tangent() -> None:
    """dv/dt = -(a + b v + c v^2) / m: with d = sqrt(4 a c - b^2), v = (d tan(phi0 - d t / 2 m) - b) / 2 c."""
    a, b, c, mass = 3000.0, 110.0, 7.0, 190.2e3
    row = {"resistance_a": a, "resistance_b": b, "resistance_c": c, "mass": 180.0, "rotating": 100 * 10.2 / 180}
    train = Train(consist_of([{"kind": "wagon", "valve": "head", **row}]), speed=45.0)
    for _ in range(1000):
        train.advance(0.01)
    d = math.sqrt(4 * a * c - b * b)
    phase = math.atan((2 * c * 45.0 + b) / d) - d * 10.0 / (2 * mass)
    exact = (d * math.tan(phase) - b) / (2 * c)
    assert 45.0 - train.speed[0] == pytest.approx(45.0 - exact, rel=2e-4)
    assert train.speed[0] == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize(("filling", "release"), [(1.5, 3.0), (4.0, 17.5), (12.0, 40.0)])
@pytest.mark.parametrize("volumes", [{}, {"auxiliary": 60.0, "cylinder": 15.0}])
def test_a_cylinder_fills_and_releases_in_its_times(filling: float, release: float, volumes: dict[str, float]) -> None:
    """With one vehicle at a driver's valve the pipe falls within a tenth of a second; the rest is its distributor's."""
    row = {"kind": "wagon", "valve": "head", "fill_time": filling, "release_time": release, **volumes}
    train = Train(consist_of([row]), settings=Settings("whole", cells=1.0))
    train.drive("emergency")
    while train.cylinder_pressure[0] < 0.95 * 380e3:
        train.advance(0.01)
    assert train.time == pytest.approx(filling, rel=0.02, abs=0.15)


#: A row of each kind, with nearly all columns.
ROWS: list[dict[str, Any]] = [
    {"kind": "locomotive", "name": 'Lok "1", head', "mass": 88.4, "position": "G", "friction": "cast-iron-p10"},
    {"kind": "wagon", "count": 3, "load": 40.25, "lambda": 65.5, "leak": 2.0, "at": 0.25, "branch": 1.5},
    {"kind": "wagon", "brake_force": 61.7, "friction": "cast-iron-p6", "shoes": 16, "coupler": "draft-gear"},
    {"kind": "wagon", "shoe_force": 140.0, "friction": "table", "friction_table": "0:0.3 35:0.2 60:0.22 120:0.15"},
    {"kind": "wagon", "lambda": 80.0, "friction": "table", "friction_table": "10:0.3 90:0.2"},
    {"kind": "wagon", "name": "Eanos", "cylinder_diameter": 355.0, "rigging_ratio": 6.1, "return_force": 1400.0},
    {"kind": "coach", "deceleration": 1.05, "fill_time": 3.25, "release_time": 12.0, "full_pressure": 3.6},
    {"kind": "coach", "shoe_force": 210.0, "shoes": 8, "friction": "pads", "friction_radius": 0.61},
    {"kind": "coach", "resistance_a": 600.0, "resistance_b": 12.5, "resistance_c": 3.125, "rotating": 6.5},
    {
        "kind": "wagon",
        "shoe_force": 90.0,
        "friction": "speed",
        "friction_value": 0.4,
        "friction_fast": 0.1,
        "friction_speed": 35.0,
    },
    {"kind": "locomotive", "valve": "second", "delay": 1.5, "auxiliary": 150.0, "cylinder": 22.5},
]


@pytest.mark.parametrize("name", ["a.toml", "a.csv"])
def test_rows_that_are_written_are_read_back_equal(name: str, tmp_path: Path) -> None:
    write_consist(ROWS, tmp_path / name)
    assert read_consist(tmp_path / name) == consist_of(ROWS)


@pytest.mark.parametrize("name", ["a.toml", "a.csv"])
def test_vehicles_become_rows_that_state_them(name: str, tmp_path: Path) -> None:
    for own in (
        consist_of(ROWS),
        block_train(4, 12e3, "G"),
        Consist((*block_train(1).vehicles, wagon(9e3, "P", "continuous"))),
    ):
        write_consist(own, tmp_path / name)
        found = read_consist(tmp_path / name)
        both = [numbers_of(one, Settings(), None) for one in (own, found)]
        assert both[0].size == both[1].size
        assert [one.name for one in found.vehicles] == [one.name for one in own.vehicles]
        assert [force(one, 20.0) for one in found.vehicles] == pytest.approx(
            [force(one, 20.0) for one in own.vehicles], rel=1e-9
        )
        assert [one.motion() for one in found.vehicles] == [
            pytest.approx(one.motion(), rel=1e-12) for one in own.vehicles
        ]
        assert len(rows_of(found)) == len(rows_of(own))


#: Rows that state too much, too little, or something without effect, and the beginnings of their messages.
REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "twice": ({"lambda": 65.0, "brake_force": 50.0}, "a brake must be stated once; got lambda and brake_force."),
    "rigging alone": ({"rigging_ratio": 5.0}, "rigging_ratio must come with cylinder_diameter."),
    "cylinder alone": ({"cylinder_diameter": 400.0}, "cylinder_diameter must come with rigging_ratio."),
    "weighed": ({"lambda": 65.0, "weighing": "lever"}, "weighing must be left out with lambda"),
    "falling mean": ({"deceleration": 1.0, "friction": "composite"}, "friction must be constant with deceleration"),
    "a value alone": ({"friction_value": 0.3}, "friction_value must come with friction = constant or speed."),
    "no table": ({"friction": "table"}, "friction_table must be 2 to 6 pairs of a speed that rises"),
    "a table alone": ({"friction_table": "0:0.3 9:0.2"}, "friction_table must come with friction = table."),
    "one point": ({"friction": "table", "friction_table": "0:0.3"}, "got '0:0.3'. Write it as"),
    "falling speeds": ({"friction": "table", "friction_table": "9:0.3 3:0.2"}, "a speed that rises"),
    "equal speeds": ({"friction": "table", "friction_table": "0:0.3 5e-324:0.2"}, "rises by 0.001 km/h or more"),
    "no pairs": ({"friction": "table", "friction_table": "0.3 0.2"}, "got '0.3 0.2'. Write it as"),
    "friction below 0": ({"friction": "table", "friction_table": "0:0.3 9:-0.2"}, "a friction from 0.001 to 1"),
    "not over speed": ({"friction": "speed", "friction_value": 0.4}, "friction = speed must come with friction_fast."),
    "no value": ({"friction": "constant"}, "friction = constant must come with friction_value."),
    "at the rims": (
        {"brake_force": 50.0, "friction": "constant", "friction_value": 0.3},
        "friction_value must be left out with brake_force",
    ),
    "of a locomotive": (
        {"kind": "locomotive", "friction": "constant", "friction_value": 0.3},
        "friction_value must be left out with the lambda of a locomotive",
    ),
    "no pads": ({"friction": "composite", "friction_radius": 0.6}, "friction_radius must come with friction = pads."),
    "shoes for nothing": (
        {"shoe_force": 90.0, "shoes": 8, "friction": "constant", "friction_value": 0.3},
        "shoes must come with a friction that depends on the force",
    ),
    "no friction": ({"kind": "coach", "shoe_force": 90.0}, "friction must come with shoe_force of a coach."),
    "two of three": ({"resistance_a": 1.0, "resistance_c": 1.0}, "resistance_a must come alone, or all of"),
    "resistance brakes": ({"lambda": 5.0, "resistance_a": 9e4}, "lambda must be above that of the running resistance"),
    "small reservoir": (
        {"auxiliary": 20.0, "cylinder": 20.0},
        "full_pressure must be below 2.5 bar, which a reservoir",
    ),
    "long name": ({"name": "x" * 61}, "name must be printable text of at most 60 characters"),
    "a number as name": ({"name": 5}, "name must be printable text of at most 60 characters"),
    "half a shoe": (
        {"brake_force": 9.0, "friction": "composite", "shoes": 2.5},
        "shoes must be an integer from 1 to 96",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_row_without_one_meaning_is_refused_in_one_sentence(case: str) -> None:
    row, message = REFUSED[case]
    with pytest.raises(ValueError, match="the consist, row 1: ") as error:
        consist_of([{"kind": "wagon", "valve": "head"} | row])
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_pipes_of_two_diameters_are_refused() -> None:
    with pytest.raises(ValueError, match="one number for all vehicles; got 25 and"):
        consist_of([{"kind": "locomotive"}, {"kind": "wagon", "pipe_diameter": 25.0}])


def test_units_in_the_row_of_names_are_converted(tmp_path: Path) -> None:
    names = "kind,resistance_a [lbf],resistance_b [N/(km/h)],resistance_c [N/(km/h)^2],brake_force [lbf],fill_time [ms]"
    (tmp_path / "a.csv").write_text(names + ",full_pressure [psi]\nlocomotive,100,36,5,10000,4000,50\n")
    one = read_consist(tmp_path / "a.csv").vehicles[0]
    assert one.resistance == pytest.approx((444.82216152605, 129.6, 64.8), rel=1e-12)
    assert force(one, 0.0) == pytest.approx(44482.216152605, rel=1e-9)
    assert one.distributor.full_pressure == pytest.approx(344737.865, rel=1e-6)


def test_a_vehicle_that_no_row_states_is_refused() -> None:
    own = block_train(1)
    odd = replace(own.vehicles[1], braked_share=0.5)
    with pytest.raises(ValueError, match="vehicle 2 must have values that columns state; its braked_share has none"):
        rows_of(Consist((own.vehicles[0], odd)))
