"""Traction of trains against quadratures: force and power, tables, slip, adhesion over speed, energies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.train.consist import Consist
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import Line

GRAVITY, MASS, TURNING = 9.80665, 84e3, 1.04
#: A locomotive of 300 kN and 4 MW without rise, with a resistance of 2000 N + 8 N.s2/m2 v2.
LOCOMOTIVE: dict[str, Any] = {
    "kind": "locomotive",
    "traction_force": 300.0,
    "traction_power": 4000.0,
    "traction_rise": 0.0,
    "resistance_a": 2000.0,
    "resistance_b": 0.0,
    "resistance_c": 8.0,
}
TABLE = "0:320.123456 40:300.5 60:240.25 80:191.125 100:150.0625 130:110.5 160:80.75 200:55.125"


def lone(speed: float = 0.0, gradient: float = 0.0, friction: float = 0.6, **columns: Any) -> Train:
    """Return the locomotive alone on a gradient, with all its traction; a column of None is left out."""
    falls = {"friction_ratio": 0.4, "friction_decay": 0.6}
    row = {name: value for name, value in (LOCOMOTIVE | falls | columns).items() if value is not None}
    line = Line({"distance": np.array([-1e5, 1e6]), "gradient": np.array([gradient] * 2)}) if gradient else None
    train = Train(consist_of([row]), speed=speed, line=line)
    train.inputs["friction"], train.inputs["traction"] = friction, 1.0
    return train


def by_table(v: float) -> float:
    """Return the force of TABLE [N], at constant power above its last point."""
    speeds, forces = zip(*[map(float, one.split(":")) for one in TABLE.split()], strict=True)
    force = 1e3 * float(np.interp(3.6 * v, speeds, forces))
    return force if 3.6 * v <= speeds[-1] else force * speeds[-1] / (3.6 * v)


@pytest.mark.parametrize(
    ("columns", "force"),
    [
        ({}, lambda v: min(300e3, 4e6 / max(v, 1e-9))),
        ({"traction_force": None, "traction_power": None, "traction_table": TABLE}, by_table),
        (
            {"traction_force": None, "traction_power": 3000.0, "traction_table": TABLE},
            lambda v: min(by_table(v), 3e6 / max(v, 1e-9)),
        ),
    ],
)
def test_a_locomotive_accelerates_by_its_force_then_by_its_power(
    columns: dict[str, Any], force: Callable[[float], float]
) -> None:
    """(m + m_r) dv/dt = min(F(v), P / v) - a - c v^2, up to 70 m/s, above the last speed of the table."""
    run = lone(**columns).record(120.0, 1.0)
    due = solve_ivp(
        lambda _, y: [(force(y[0]) - 2000.0 - 8.0 * y[0] ** 2) / (TURNING * MASS)],
        (0.0, 120.0), [0.0], t_eval=run["time"], rtol=1e-10, atol=1e-10, max_step=0.5,
    )  # fmt: skip
    assert run["speed[1]"][1:] == pytest.approx(due.y[0][1:], rel=1e-4)
    assert run["speed[1]"][-1] > 200.0 / 3.6


def test_it_ends_at_the_speed_of_balance_and_on_a_gradient_rolls_back_if_it_pulls_too_little() -> None:
    """P / v = a + c v^2 + m g i; 75 kN start it on 30 permille (24.7 kN), not on 90 (74.1 and 2 kN)."""
    gradient = 0.05
    train = lone(30.0, gradient)
    for _ in range(6):
        train.advance(100.0)
    balance = [v for v in np.roots([8.0, 0.0, 2000.0 + MASS * GRAVITY * gradient, -4e6]) if abs(v.imag) < 1e-9]
    assert float(train.speed[0]) == pytest.approx(float(balance[0].real), rel=1e-5)
    for steep, sign in ((0.03, 1.0), (0.09, 0.0), (0.095, -1.0)):
        train = lone(0.0, steep)
        train.inputs["traction"] = 0.25
        train.advance(5.0)
        assert np.sign(train.speed[0]) == sign


def test_the_force_rises_and_falls_within_its_time() -> None:
    train = lone(5.0, traction_rise=4.0)
    for share, time, due in ((1.0, 1.0, 0.25), (1.0, 1.0, 0.5), (0.2, 0.8, 0.3), (0.2, 1.0, 0.2)):
        train.inputs["traction"] = share
        train.advance(time)
        train.advance(1e-6)
        assert train.traction_force[0] == pytest.approx(due * 300e3, rel=1e-5)


@pytest.mark.parametrize(("column", "after"), [({}, 0.0), ({"traction_cut_out": 0.0}, 60e3)])
@pytest.mark.parametrize("model", ["whole", "delay"])
def test_an_emergency_cuts_traction_off_and_full_service_does_not(
    column: dict[str, Any], after: float, model: str
) -> None:
    train = Train(consist_of([LOCOMOTIVE | column]), speed=10.0, settings=Settings(model, cells=1.0))
    train.inputs["traction"] = 0.2
    train.drive("service", 1.0)
    train.advance(10.0)
    assert train.traction_force[0] == pytest.approx(60e3)
    train.drive("emergency")
    train.advance(5.0)
    assert train.traction_force[0] == pytest.approx(after)


def test_the_electric_brake_goes_before_traction() -> None:
    train = lone(10.0, dynamic_force=100.0, dynamic_rise=0.0)
    train.inputs["dynamic_brake"] = 0.5
    train.advance(0.5)
    assert [train.traction_force[0], train.brake_force[0]] == pytest.approx([0.0, 50e3])
    train.inputs["dynamic_brake"] = 0.0
    train.advance(0.5)
    assert train.traction_force[0] == 300e3


def test_a_dynamic_brake_by_a_table_has_its_forces() -> None:
    """Straight lines between points, without the fade of 8 km/h; at constant power above the last one."""
    train = lone(40.0, dynamic_table="0:0 10:120 60:100 120:60", dynamic_rise=0.0)
    train.inputs["traction"], train.inputs["dynamic_brake"] = 0.0, 1.0
    while train.speed[0] > 0.5:
        v = 3.6 * float(train.wheel_speed[0])
        train.advance(0.01)
        due = np.interp(v, [0.0, 10.0, 60.0, 120.0], [0.0, 120e3, 100e3, 60e3]) * min(1.0, 120.0 / v)
        assert train.brake_force[0] == pytest.approx(due, rel=1e-9)


def test_an_overpulled_locomotive_spins_up_to_its_power_and_not_without_end() -> None:
    """P / w = mu A N at the end, with Polach's (2005) share A = 0.4 of friction at high slip."""
    friction = 0.2
    train = lone(friction=friction)
    run = train.record(60.0, 0.02)
    assert train.wheel_speed[0] > 1.2 * train.speed[0]
    assert run["wheel_speed[1]"].max() <= 4e6 / (0.4 * friction * MASS * GRAVITY) * 1.01
    assert train.traction_force[0] == pytest.approx(4e6 / float(train.wheel_speed[0]), rel=1e-3)
    assert float(train.wheel_speed[0]) == pytest.approx(4e6 / (0.4 * friction * MASS * GRAVITY), rel=0.02)
    train.inputs["traction"] = 0.2
    train.advance(60.0)
    assert train.wheel_speed[0] == train.speed[0]


@pytest.mark.parametrize("rotating", [0.5, 4.0])
def test_wheels_spin_up_as_their_equation_says(rotating: float) -> None:
    """m_r dw/dt = min(F, P / w) - mu N (A + (1 - A) exp(-B (w - v))), m dv/dt of the same force (Polach 2005)."""
    train = lone(friction=0.2, rotating=rotating, resistance_a=0.0, resistance_c=0.0)
    run = train.record(6.0, 0.25)
    weight = MASS * GRAVITY

    def rates(_: float, y: np.ndarray) -> list[float]:
        gives = 0.2 * weight * (0.4 + 0.6 * np.exp(-0.6 * abs(y[1] - y[0])))
        return [gives / MASS, (min(300e3, 4e6 / max(y[1], 1e-9)) - gives) / (rotating / 100 * MASS)]

    due = solve_ivp(rates, (0.0, 6.0), [0.0, 1e-9], t_eval=run["time"], method="LSODA", rtol=1e-9, atol=1e-9)
    assert run["wheel_speed[1]"][1:] == pytest.approx(due.y[1][1:], rel=0.012)  # parts of 20 ms
    assert run["speed[1]"][1:] == pytest.approx(due.y[0][1:], abs=0.01)


def test_light_wheels_do_not_overshoot_the_speed_of_their_power() -> None:
    """Wheels of 252 kg at the rim reach P / (mu A N) of 15.2 m/s in 30 ms, and stay there while the vehicle is slow."""
    train = lone(friction=0.2, rotating=0.3, traction_power=1000.0)
    wheels = train.record(3.0, 0.01)["wheel_speed[1]"]
    bound = 1e6 / (0.4 * 0.2 * MASS * GRAVITY)
    assert wheels.max() < 1.01 * bound
    assert wheels[-1] == pytest.approx(bound, rel=0.01)


#: Speeds of the check of the adhesion law [km/h].
SPEEDS = (0.0, 5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 80.0, 100.0, 130.0, 160.0, 250.0)


@pytest.mark.parametrize("speed", SPEEDS)
def test_adhesion_falls_over_speed_by_curtius_and_kniffler(speed: float) -> None:
    """(0.161 + 7.5 / (V + 44)) times what makes it the input at rest; locked wheels show it, without their own fall."""
    one = consist_of([LOCOMOTIVE | {"adhesion": "curtius-kniffler"}]).vehicles[0]
    brake = replace(one.brake, force_per_pressure=1.0, constant_friction=0.5)
    for adhesion in ("curtius-kniffler", "input"):
        own = replace(one, adhesion=adhesion, friction_ratio=1.0, brake=brake)
        train = Train(Consist((own,)), speed=max(speed / 3.6, 1e-3), cylinder=380e3, pipe=350e3)
        train.inputs["friction"] = 0.28
        train.drive("service", 1.0)
        train.motion = np.array([[0.0], [speed / 3.6 + 0.0], [0.0], [0.0]])
        train.advance(1e-3)
        fallen = (0.161 + 7.5 / (speed + 44.0)) / (0.161 + 7.5 / 44.0) if adhesion != "input" else 1.0
        if speed:
            assert -train.rail_force[0] == pytest.approx(0.28 * fallen * MASS * GRAVITY, rel=1e-5)


def test_energies_at_the_wheel_close() -> None:
    """Traction = kinetic + potential + resistance + both brakes, exact in all steps with a constant resistance."""
    gradient = 0.004
    train = lone(2.0, gradient, resistance_c=0.0, dynamic_force=80.0, traction_rise=1.0)
    begin, turning = float(train.distance[0]), TURNING * MASS / 2
    train.advance(40.0)
    train.inputs["traction"], train.inputs["dynamic_brake"] = 0.0, 0.7
    train.advance(20.0)
    train.inputs["dynamic_brake"] = 0.0
    train.drive("service", 0.5)
    train.advance(15.0)
    assert train.speed[0] > 1.0
    assert min(train.electric_brake_energy[0], train.brake_heat[0]) > 1e6
    lifted = (2000.0 + MASS * GRAVITY * gradient) * (float(train.distance[0]) - begin)
    spent = turning * (float(train.speed[0]) ** 2 - 2.0**2) + lifted
    spent += float(train.electric_brake_energy[0]) + float(train.brake_heat[0])
    assert float(train.traction_energy[0]) == pytest.approx(spent, rel=1e-6)


def test_the_energy_of_slip_closes_too() -> None:
    """The rail takes H (w - v) of slipping wheels; the mean over records of 2 ms."""
    train = lone(friction=0.15, resistance_c=0.0)
    run = train.record(10.0, 2e-3)
    speed, wheel = run["speed[1]"], run["wheel_speed[1]"]
    slip = (wheel - speed)[1:] + (wheel - speed)[:-1]
    lost = float(np.sum(run["rail_force[1]"][1:] * slip / 2 * 2e-3))
    way = run["distance[1]"][-1] - run["distance[1]"][0]
    kept = MASS * speed[-1] ** 2 / 2 + (TURNING - 1) * MASS * wheel[-1] ** 2 / 2 + 2000.0 * way
    assert float(train.traction_energy[0]) == pytest.approx(kept + lost, rel=1e-4)
    assert lost > 1e6


def test_a_run_with_traction_is_saved_and_restored() -> None:
    train = Train(consist_of([LOCOMOTIVE | {"traction_rise": 5.0}, {"kind": "wagon", "count": 3}]))
    train.inputs["traction"][0] = 0.8
    train.advance(2.0)
    state = train.state
    own = [train.record(3.0)["traction_energy[1]"]]
    train.state = state
    own.append(train.record(3.0)["traction_energy[1]"])
    assert np.array_equal(*own)


def test_the_fmu_of_a_train_with_traction_is_the_train(tmp_path: Path) -> None:
    rows = [LOCOMOTIVE | {"adhesion": "curtius-kniffler", "traction_rise": 3.0}, {"kind": "wagon", "count": 2}]
    consist = consist_of(rows)
    write_in_c(train_fmu(consist, settings=Settings("whole", cells=1.0)), tmp_path / "TrainDynamics.fmu", 2)
    train = Train(consist, settings=Settings("whole", cells=1.0))
    train.inputs["traction"][0] = 1.0
    with FmuInstance(tmp_path / "TrainDynamics.fmu") as one:
        one.set(**{"traction[1]": 1.0})
        one.start()
        for n in range(100):
            one.step(0.1 * n, 0.1)
            train.advance(0.1)
        found = one.get(["speed[2]", "wheel_speed[1]", "traction_force[1]", "traction_energy[1]"])
    assert found == [train.speed[1], train.wheel_speed[0], train.traction_force[0], train.traction_energy[0]]
    assert train.wheel_speed[0] > train.speed[0] > 3.0  # it slips


@pytest.mark.parametrize("name", ["a.toml", "a.csv"])
def test_rows_of_drives_are_written_and_read(name: str, tmp_path: Path) -> None:
    table = {"traction_force": None, "traction_power": None, "traction_table": TABLE, "adhesion": "curtius-kniffler"}
    table |= {"dynamic_table": "0:0 10:120 60:100 120:60", "traction_cut_out": 2.0}
    rows = [LOCOMOTIVE, {key: value for key, value in (LOCOMOTIVE | table).items() if value is not None}]
    write_consist(rows, tmp_path / name)
    own = read_consist(tmp_path / name)
    assert own == consist_of(rows)
    write_consist(own, tmp_path / name)
    for one, again in zip(own.vehicles, read_consist(tmp_path / name).vehicles, strict=True):
        assert again.traction.values() == pytest.approx(one.traction.values(), rel=1e-12)
        assert again.electric.values() == pytest.approx(one.electric.values(), rel=1e-12)
        assert again.adhesion == one.adhesion


REFUSED = {
    "a force without a power": ({"traction_power": None}, "traction_force must come with traction_power,"),
    "a power alone": ({"traction_force": None}, "traction_power must come with traction_force or traction_table."),
    "two forces": ({"traction_table": TABLE}, "traction_force must be left out with traction_table,"),
    "no table": (
        {"traction_force": None, "traction_table": "0:100 90"},
        "traction_table must be 2 to 8 pairs of a speed",
    ),
    "a table of nothing": ({"traction_force": None, "traction_table": "0:0 9:0"}, "not all of them 0"),
    "a speed that falls": (
        {"dynamic_table": "10:100 0:100"},
        "dynamic_table must be 2 to 8 pairs of a speed that rises",
    ),
    "wheels without mass": ({"rotating": 0.0}, "rotating must be above 0 % on a vehicle with motors"),
    "an unknown law": ({"adhesion": "polach"}, "adhesion must be one of input, curtius-kniffler"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_drive_with_something_without_effect_is_refused(case: str) -> None:
    columns, message = REFUSED[case]
    row = {name: value for name, value in (LOCOMOTIVE | columns).items() if value is not None}
    with pytest.raises(ValueError, match="the consist, row 1: ") as error:
        consist_of([row])
    assert message in str(error.value)


def test_service_by_air_leaves_the_motors_of_a_vehicle_with_a_dynamic_brake() -> None:
    train = lone(10.0, **{"dynamic_force": 100.0})
    train.drive("service", 0.0)
    train.inputs["traction"] = 1.0
    train.advance(5.0)
    assert train.traction_force[0] > 1e5


@pytest.mark.parametrize("row", [{"brake": "ep-direct", "brake_force": 60.0}, {}])
def test_motors_stay_off_while_slide_protection_releases_a_demanded_brake(row: dict[str, Any]) -> None:
    train = lone(20.0, **{"dynamic_force": 100.0, **row})
    train.inputs["traction"], train.inputs["dynamic_brake"] = 1.0, 0.0 if row else 1.0
    train.drive(*(("service", 0.5) if row else ("running", 0.0)))
    train.advance(2.0)
    train.inputs["protection"] = 2.0
    train.advance(1.0)
    assert train.traction_force[0] == 0.0


def test_vehicles_without_motors_do_no_work() -> None:
    rows = [{"kind": "coach", "valve": "head", "adhesion": "curtius-kniffler"}]
    train = Train(consist_of(rows), speed=20.0)
    train.advance(10.0)
    assert train.traction_energy[0] == 0.0
