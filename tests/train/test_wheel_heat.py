"""Heat of a train's wheels: balances of energy, cooling, fading, saved states, and rows of consists."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.train import Train
from rbd_model.track.line import Line
from scenarios.bench.holding_driver import HoldingDriver

#: Standard gravity [m/s2], specific heat of steel [J/(kg.K)], and temperature of the surroundings [K].
G, STEEL, COLD = 9.80665, 500.0, 293.15
#: Relative error of a balance of energy.
CLOSED = 1e-6
HOT: dict[str, Any] = {"wheel_mass": 370.0}


def wagon(**row: Any) -> dict[str, Any]:
    return {"kind": "wagon", "valve": "head", "resistance_a": 0.0, "resistance_b": 0.0, "resistance_c": 0.0} | row


def train_of(row: dict[str, Any], speed: float, gradient: float = 0.0, **start: float) -> Train:
    line = Line({"distance": np.array([-1e5, 1e5]), "gradient": np.array([gradient, gradient])})
    train = Train(consist_of([row]), speed=speed, line=line, **start)
    train.inputs["friction"] = 0.6
    return train


@pytest.mark.parametrize("seed", range(8))
def test_energy_of_the_motion_becomes_heat_of_the_brake(seed: int) -> None:
    """0.5 (1 + r) m v^2 + m g h, with brakes that fade and gradients of both signs, to the stop and before it."""
    draw = np.random.default_rng(seed)
    mass, rotating, gradient = draw.uniform(20.0, 90.0), draw.uniform(2.0, 12.0), draw.uniform(-0.02, 0.02)
    fade = {"fade_from": 21.0, "fade_to": draw.uniform(22.0, 30.0), "fade_left": draw.uniform(0.2, 1.0)}
    law = {"friction": ("composite", "cast-iron-p10", "composite-k")[seed % 3]}
    train = train_of(wagon(mass=mass, rotating=rotating, **HOT, **fade, **law), draw.uniform(15.0, 40.0), gradient)
    before = energy(train, mass, rotating, gradient)
    train.drive("service", draw.uniform(0.0, 1.0))
    for step in draw.uniform(0.05, 5.0, 20):
        train.advance(step)
    lost = before - energy(train, mass, rotating, gradient)
    assert float(train.brake_heat[0]) == pytest.approx(lost, rel=CLOSED)
    assert lost > 1e5


def energy(train: Train, mass: float, rotating: float, gradient: float) -> float:
    """Return the energy of a vehicle [J]; mass [t], rotating share [%]."""
    moving = (1 + rotating / 100) * float(train.speed[0]) ** 2 / 2
    return 1e3 * mass * (moving + G * gradient * float(train.distance[0]))


def test_wheels_take_their_share_of_the_heat_and_lose_it_to_the_air() -> None:
    """C (T - T0) + int (a + b v) (T - T0) dt = s Q, by the trapezoidal rule of a recording."""
    row = wagon(**HOT, wheels=6, heat_share=0.7, cooling=90.0, cooling_speed=11.0)
    train = train_of(row, 30.0, -0.012)
    train.drive("service", 0.4)
    found = train.record(300.0, 0.05)
    over = found["wheel_temperature[1]"] - COLD
    cooling = 6 * (90.0 + 11.0 * found["speed[1]"]) * over
    lost = np.trapezoid(cooling, found["time"])
    taken = 6 * 370.0 * STEEL * over[-1]
    assert lost > 0.03 * taken
    assert taken + lost == pytest.approx(0.7 * found["brake_heat[1]"][-1], rel=CLOSED)


def test_hot_wheels_at_rest_cool_as_one_lump() -> None:
    train = train_of(wagon(**HOT, cooling=300.0, cooling_speed=0.0), 25.0)
    train.drive("service", 1.0)
    while train.speed[0] > 0.0:
        train.advance(0.1)
    begin = float(train.wheel_temperature[0]) - COLD
    train.advance(900.0)
    left = begin * math.exp(-900.0 * 300.0 / (370.0 * STEEL))
    assert begin > 10.0
    assert float(train.wheel_temperature[0]) - COLD == pytest.approx(left, rel=1e-5)


def test_a_locked_wheel_makes_no_heat_at_its_block() -> None:
    train = train_of(wagon(**HOT), 30.0, cylinder=380e3)
    train.drive("emergency")
    train.inputs["friction"] = 0.02
    train.advance(3.0)
    assert train.wheel_speed[0] == 0.0
    heat = float(train.brake_heat[0])
    train.advance(5.0)
    assert train.brake_heat[0] == pytest.approx(heat, rel=1e-11)
    # the rotating mass stops at the block, and what the rail gave to the wheels until then
    turning = 0.04 * 80e3 * 30.0**2 / 2
    assert turning < heat < 1.2 * turning


def test_an_electric_brake_makes_no_heat_at_the_wheels() -> None:
    train = train_of(wagon(**HOT, dynamic_force=60.0), 25.0)
    train.inputs["dynamic_brake"] = 1.0
    train.advance(20.0)
    assert train.speed[0] < 20.0
    assert train.brake_heat[0] == 0.0
    assert train.wheel_temperature[0] == pytest.approx(COLD, abs=1e-12)


def test_friction_fades_on_a_straight_line_between_two_temperatures() -> None:
    fade = {"fade_from": 27.0, "fade_to": 35.0, "fade_left": 0.4}
    rows = [wagon(brake_force=40.0, wheel_mass=500.0, heat_share=1.0, **more) for more in (fade, {})]
    own, plain = (train_of(row, 30.0, -0.03) for row in rows)
    seen = []
    for train in (own, plain):
        train.drive("service", 1.0)
        train.advance(10.0)
    for _ in range(150):
        hot = float(own.wheel_temperature[0]) - 273.15
        for train in (own, plain):
            train.advance(0.01)
        seen.append(float(own.brake_force[0] / plain.brake_force[0]))
        left = 1.0 - 0.6 * min(max((hot - 27.0) / 8.0, 0.0), 1.0)
        assert seen[-1] == pytest.approx(left, rel=1e-9)
        own.advance(0.2)
        plain.advance(0.2)
    assert seen[0] > 0.9
    assert seen[-1] == pytest.approx(0.4)


def test_a_restored_state_continues_with_its_heat() -> None:
    train = train_of(wagon(**HOT, fade_from=20.0, fade_to=25.0, fade_left=0.5), 25.0)
    train.drive("service", 0.5)
    train.advance(15.0)
    kept = train.state
    train.advance(10.0)
    due = [train.wheel_temperature, train.brake_heat, train.speed]
    train.state = kept
    train.advance(10.0)
    assert [list(one) for one in (train.wheel_temperature, train.brake_heat, train.speed)] == [list(one) for one in due]


def test_cold_wheels_change_no_bit_and_add_no_column() -> None:
    rows = [wagon(count=1) | more for more in ({}, {"wheel_mass": 370.0})]
    cold, warm = (train_of(row, 25.0, -0.01) for row in rows)
    for train in (cold, warm):
        train.drive("service", 1.0)
    plain, own = cold.record(30.0), warm.record(30.0)
    for name in plain.names:
        assert np.array_equal(plain[name], own[name])
    assert {one.split("[")[0] for one in own.names} - {one.split("[")[0] for one in plain.names} == {
        "wheel_temperature",
        "brake_heat",
    }
    assert cold.wheel_temperature[0] == COLD


def test_a_consist_with_hot_wheels_is_written_and_read(tmp_path: Path) -> None:
    more = {"wheels": 12, "heat_share": 0.83, "cooling": 31.0, "cooling_speed": 3.5}
    rows = [
        wagon(**HOT, friction="cast-iron-p6"),
        {"kind": "wagon", "wheel_mass": 4000.0, "wheels": 96},
        {"kind": "wagon", "wheel_mass": 300.0, "fade_from": 300.0, "fade_to": 500.0, "fade_left": 0.6} | more,
    ]
    first = consist_of(rows)
    assert [one.heat.heat_share for one in first.vehicles] == [0.75, 0.9, 0.83]
    for name in ("own.toml", "own.csv"):
        write_consist(first, tmp_path / name)
        for one, again in zip(first.vehicles, read_consist(tmp_path / name).vehicles, strict=True):
            assert again.heat.values() == pytest.approx(one.heat.values(), rel=1e-12)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"cooling": 20.0}, "cooling must come with wheel_mass."),
        ({**HOT, "fade_to": 400.0}, "fade_to must come with fade_from."),
        ({**HOT, "fade_from": 400.0, "fade_to": 300.0, "fade_left": 0.5}, "fade_to must be above fade_from, 400 degC"),
        ({**HOT, "brake": "none"}, "wheel_mass has no effect with brake = none."),
        ({**HOT, "heat_share": 1.1}, "heat_share must be a number from 0 to 1; got 1.1."),
        ({**HOT, "wheels": 2.5}, "wheels must be an integer from 1 to 96"),
    ],
)
def test_wheels_that_cannot_be_are_refused(row: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        consist_of([{"kind": "locomotive"}, {"kind": "wagon"} | row])


def test_a_held_speed_on_a_gradient_has_the_power_of_the_drag_case_of_the_tsi() -> None:
    """TSI WAG: 21 permille, 70 km/h, 40 km, 22.5 t an axle: m g i v = 45.06 kW a wheel for 34.3 min.

    The wheel is the lump of a constant power: s P / G (1 - exp(-G t / C)), from the temperature before.
    """
    speed, cooling = 70.0 / 3.6, 48.0
    row = wagon(**HOT, mass=90.0, heat_share=1.0, cooling=cooling, cooling_speed=0.0)
    train, driver = train_of(row, speed, -0.021), HoldingDriver(speed)
    hold(train, driver, 5e3)
    begin, heat, hot = train.time, float(train.brake_heat[0]), float(train.wheel_temperature[0]) - COLD
    hold(train, driver, 40e3)
    time = train.time - begin
    power = (float(train.brake_heat[0]) - heat) / time / 8
    assert power == pytest.approx(45.06e3, rel=1e-3)
    assert time / 60 == pytest.approx(34.3, abs=0.05)
    cooled = math.exp(-cooling * time / (370.0 * STEEL))
    due = hot * cooled + 45.06e3 / cooling * (1 - cooled)
    assert float(train.wheel_temperature[0]) - COLD == pytest.approx(due, rel=2e-3)


def hold(train: Train, driver: HoldingDriver, way: float) -> None:
    """Let a driver hold the speed over a distance [m]."""
    end = float(train.distance[0]) + way
    while train.distance[0] < end:
        driver.act(train)
        train.advance(driver.period)
