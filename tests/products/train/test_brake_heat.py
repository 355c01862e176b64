"""Heat of a train's brakes: balances of energy, cooling, fading, saved states, and rows of consists."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.driver import HoldingDriver
from products.train.train import Train
from rbd_model.track.line import Line

#: Standard gravity [m/s2], specific heat of steel and cast iron [J/(kg.K)], temperature of the surroundings [K].
G, STEEL, CAST_IRON, COLD = 9.80665, 500.0, 510.0, 293.15
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


@pytest.mark.study
@pytest.mark.parametrize("seed", range(8))
def test_energy_of_the_motion_becomes_heat_of_the_brake(seed: int) -> None:
    """0.5 (1 + r) m v^2 + m g h, with brakes that fade and gradients of both signs, to the stop and before it."""
    draw = np.random.default_rng(seed)
    mass, rotating, gradient = draw.uniform(20.0, 90.0), draw.uniform(2.0, 12.0), draw.uniform(-0.02, 0.02)
    fade = {"fade_table": f"21:1 {draw.uniform(22.0, 30.0)}:{draw.uniform(0.2, 1.0)}"}
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


@pytest.mark.parametrize(
    ("body", "capacity"),
    [
        ({"wheel_mass": 370.0, "wheels": 6, "friction": "cast-iron-p10"}, 6 * 370.0 * STEEL),
        ({"disc_mass": 95.0, "discs": 12, "friction": "pads"}, 12 * 95.0 * CAST_IRON),
    ],
)
def test_wheels_or_discs_and_blocks_take_their_shares_of_the_heat(body: dict[str, Any], capacity: float) -> None:
    """C (T - T0) + int (a + b v) (T - T0) dt = s Q of each, by the trapezoidal rule of a recording."""
    blocks = {"block_mass": 17.0, "block_heat": 820.0, "block_cooling": 14.0, "block_cooling_speed": 1.1}
    row = wagon(**body, **blocks, heat_share=0.7, cooling=90.0, cooling_speed=11.0)
    train = train_of(row, 30.0, -0.012)
    train.drive("service", 0.4)
    found = train.record(300.0, 0.05)
    number = body.get("wheels", body.get("discs"))
    heat = found["brake_heat[1]"][-1]
    for name, share, own, (rest, rise) in (
        ("brake_temperature[1]", 0.7, capacity, (90.0, 11.0)),
        ("block_temperature[1]", 0.3, number * 17.0 * 820.0, (14.0, 1.1)),
    ):
        over = found[name] - COLD
        lost = np.trapezoid(number * (rest + rise * found["speed[1]"]) * over, found["time"])
        assert lost > 0.03 * own * over[-1]
        assert own * over[-1] + lost == pytest.approx(share * heat, rel=CLOSED)


def test_half_of_a_capacity_and_cooling_in_discs_gives_the_same_as_in_wheels() -> None:
    """Twice the discs of half the mass, with equal capacities: numbers of wheels to the last digits."""
    base = {"brake_force": 60.0, "heat_share": 0.8, "block_mass": 10.0}
    wheels = wagon(**base, wheel_mass=408.0, cooling=30.0, cooling_speed=2.0, block_cooling=3.0)
    discs = wagon(**base, disc_mass=200.0, discs=16, cooling=15.0, cooling_speed=1.0, block_cooling=1.5)
    discs |= {"block_mass": 5.0, "block_cooling_speed": 0.15}
    found = []
    for row in (wheels, discs):
        train = train_of(row, 28.0, -0.01)
        train.drive("service", 0.6)
        train.advance(60.0)
        found.append([float(train.brake_temperature[0]), float(train.block_temperature[0])])
    assert found[0][1] > found[0][0] > COLD + 5.0
    assert found[1] == pytest.approx(found[0], rel=1e-12)


@pytest.mark.study
@pytest.mark.parametrize("fourier", [0.001, 0.003, 0.01, 0.03, 0.08, 4.0])
def test_a_surface_with_constant_heat_has_its_closed_forms(fourier: float) -> None:
    """Half space, 2 q sqrt(t / (pi k rho c)), before the heat reaches the back; q L / (3 k) above the mean long after.

    The gradient balances a constant brake force, so that the power is constant from the start.
    """
    force, thickness, area, conductivity, density = 40e3, 0.05, 0.23, 45.0, 7850.0
    row = wagon(mass=80.0, brake_force=1e-3 * force, wheel_mass=400.0, thickness=1e3 * thickness, rubbed_area=area)
    row |= {"heat_share": 0.8, "cooling": 0.0, "cooling_speed": 0.0}
    train = train_of(row, 20.0, -force / (80e3 * G), pipe=0.0, cylinder=380e3)
    train.drive("emergency")
    time = fourier * thickness**2 * density * STEEL / conductivity
    train.advance(time)
    assert train.speed[0] == pytest.approx(20.0, rel=1e-6)
    flux = 0.8 * force * 20.0 / (8 * area)
    early = 2 * flux * math.sqrt(time / (math.pi * conductivity * density * STEEL))
    early -= flux * time / (density * STEEL * thickness)  # of the mean of the slab
    due = flux * thickness / (3 * conductivity) if fourier > 1.0 else early
    above = float(train.surface_temperature[0] - train.brake_temperature[0])
    assert above == pytest.approx(due, rel=1e-6 if fourier > 1.0 else 6e-3)


def test_the_surface_of_a_disc_in_a_stop_is_that_of_finite_volumes() -> None:
    """Implicit finite volumes with the heat of the recording; the mean of disc and slab agree without cooling."""
    thickness, area, conductivity, density, cells, step = 0.022, 0.45, 50.0, 7200.0, 60, 0.02
    mass = density * area * thickness
    row = wagon(kind="coach", deceleration=1.1, disc_mass=mass, thickness=22.0, rubbed_area=area, cooling=0.0)
    train = train_of(row | {"cooling_speed": 0.0}, 160 / 3.6)
    train.drive("emergency")
    found = train.record(100.0, step)
    flux = 0.95 * np.diff(found["brake_heat[1]"]) / step / (8 * area)
    size, capacity = thickness / cells, density * CAST_IRON
    beside = np.diag(np.full(cells - 1, 1.0), 1)
    flows = beside + beside.T
    flows -= np.diag(flows.sum(axis=1))
    solved = np.linalg.inv(np.eye(cells) - conductivity * step / (capacity * size**2) * flows)
    warm, peak = np.zeros(cells), 0.0
    for number, one in enumerate(flux, 1):
        warm[0] += one * step / (capacity * size)
        warm = solved @ warm
        face = warm[0] + one * size / (2 * conductivity)
        peak = max(peak, face)
        if number * step > 2.0:
            assert found["surface_temperature[1]"][number] - COLD == pytest.approx(face, rel=0.01)
    assert peak > warm.mean() + 15.0 > 100.0
    assert found["brake_temperature[1]"][-1] - COLD == pytest.approx(warm.mean(), rel=1e-6)


def test_hot_wheels_at_rest_cool_as_one_lump() -> None:
    train = train_of(wagon(**HOT, cooling=300.0, cooling_speed=0.0), 25.0)
    train.drive("service", 1.0)
    while train.speed[0] > 0.0:
        train.advance(0.1)
    begin = float(train.brake_temperature[0]) - COLD
    train.advance(900.0)
    left = begin * math.exp(-900.0 * 300.0 / (370.0 * STEEL))
    assert begin > 10.0
    assert float(train.brake_temperature[0]) - COLD == pytest.approx(left, rel=1e-5)


def test_a_locked_wheel_makes_no_heat_at_its_block() -> None:
    train = train_of(wagon(**HOT, friction_ratio=0.4, friction_decay=0.6), 30.0, cylinder=380e3)
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
    assert train.brake_temperature[0] == pytest.approx(COLD, abs=1e-12)


@pytest.mark.parametrize("more", [{}, {"thickness": 2.0}])
def test_friction_follows_the_points_of_its_table_over_the_surfaces_temperature(more: dict[str, float]) -> None:
    """Straight lines between points, also rising ones, and constant outside, on wheels that warm from 20 degC."""
    places, shares = [24.0, 27.0, 31.0, 35.0], [0.8, 1.2, 0.9, 0.4]
    fade = {"fade_table": " ".join(f"{x:g}:{y:g}" for x, y in zip(places, shares, strict=True))}
    base = {"brake_force": 40.0, "wheel_mass": 500.0, "heat_share": 1.0} | more
    rows = [wagon(**base, **own) for own in (fade, {})]
    own, plain = (train_of(row, 30.0, -0.03) for row in rows)
    seen = []
    for train in (own, plain):
        train.drive("service", 1.0)
        train.advance(2.0)
    for _ in range(190):
        hot = float(own.surface_temperature[0]) - 273.15
        for train in (own, plain):
            train.advance(0.01)
        seen.append(float(own.brake_force[0] / plain.brake_force[0]))
        assert seen[-1] == pytest.approx(float(np.interp(hot, places, shares)), rel=1e-9)
        own.advance(0.2)
        plain.advance(0.2)
    assert seen[0] < 0.95
    assert max(seen) > 1.1
    assert seen[-1] == pytest.approx(0.4)


def test_a_restored_state_continues_with_its_heat() -> None:
    train = train_of(wagon(**HOT, fade_table="20:1 25:0.5", block_mass=20, thickness=40), 25.0)
    train.drive("service", 0.5)
    train.advance(15.0)
    kept = train.state
    train.advance(10.0)
    due = _of_heat(train)
    train.state = kept
    train.advance(10.0)
    assert [list(one) for one in _of_heat(train)] == [list(one) for one in due]


def _of_heat(train: Train) -> list[Any]:
    return [train.brake_temperature, train.surface_temperature, train.block_temperature, train.brake_heat, train.speed]


def test_cold_wheels_change_no_bit_and_add_no_column() -> None:
    rows = [wagon(count=1) | more for more in ({}, {"wheel_mass": 370.0})]
    cold, warm = (train_of(row, 25.0, -0.01) for row in rows)
    for train in (cold, warm):
        train.drive("service", 1.0)
    plain, own = cold.record(30.0), warm.record(30.0)
    for name in plain.names:
        assert np.array_equal(plain[name], own[name])
    assert {one.split("[")[0] for one in own.names} - {one.split("[")[0] for one in plain.names} == {
        "brake_temperature",
        "surface_temperature",
        "block_temperature",
        "brake_heat",
    }
    assert cold.brake_temperature[0] == cold.surface_temperature[0] == COLD
    assert warm.surface_temperature[0] == warm.brake_temperature[0] > COLD


def test_a_consist_with_hot_wheels_is_written_and_read(tmp_path: Path) -> None:
    more = {"wheels": 12, "heat_share": 0.83, "cooling": 31.0, "cooling_speed": 3.5}
    rows = [
        wagon(**HOT, friction="cast-iron-p6"),
        {"kind": "wagon", "wheel_mass": 4000.0, "wheels": 96},
        {"kind": "wagon", "wheel_mass": 300.0, "fade_table": "40:0.9 300:1.1 500:0.6"} | more,
        {"kind": "coach", "disc_mass": 90.0, "discs": 12, "friction": "pads", "block_mass": 6.0, "thickness": 20.0},
        {"kind": "wagon", "wheel_mass": 300.0, "friction": "cast-iron-p10", "block_mass": 28.0},
        {"kind": "wagon", "wheel_mass": 300.0, "fade_table": "30:1.2 60:0.3 90:2 400:0"},
    ]
    first = consist_of(rows)
    assert [one.heat.heat_share for one in first.vehicles] == [0.75, 0.9, 0.83, 0.95, 0.75, 0.9]
    for name in ("own.toml", "own.csv"):
        write_consist(first, tmp_path / name)
        for one, again in zip(first.vehicles, read_consist(tmp_path / name).vehicles, strict=True):
            assert again.heat.values() == pytest.approx(one.heat.values(), rel=1e-12)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"cooling": 20.0}, "cooling must come with wheel_mass or disc_mass."),
        ({"fade_table": "20:1 400:0.5"}, "fade_table must come with wheel_mass or disc_mass."),
        ({**HOT, "fade_table": "400:1 300:0.5"}, "fade_table must be 2 to 6 pairs of a temperature that rises"),
        ({**HOT, "fade_table": "300:1 400:2.5"}, "a share of friction from 0 to 2; got '300:1 400:2.5'"),
        ({**HOT, "block_cooling": 3.0}, "block_cooling must come with block_mass."),
        ({**HOT, "rubbed_area": 0.2}, "rubbed_area must come with thickness."),
        ({**HOT, "thickness": 205.0, "rubbed_area": 0.2}, "thickness must be a number from 2 to 200 mm"),
        ({**HOT, "thickness": 60.0, "rubbed_area": 1.0}, "thickness must be at most 47.13 mm, at which 1 m2 weigh"),
        ({"block_mass": 3.0}, "block_mass must come with wheel_mass or disc_mass."),
        ({**HOT, "discs": 4}, "discs must come with disc_mass."),
        ({**HOT, "disc_mass": 90.0}, "wheel_mass must be left out with disc_mass"),
        ({"disc_mass": 90.0}, "disc_mass must be of pads; the friction is composite, of blocks."),
        ({**HOT, "friction": "pads"}, "wheel_mass must be of blocks; the friction is that of pads."),
        ({**HOT, "brake": "none", "fade_table": "20:1 400:0.5"}, "wheel_mass has no effect with brake = none."),
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
    begin, heat, hot = train.time, float(train.brake_heat[0]), float(train.brake_temperature[0]) - COLD
    hold(train, driver, 40e3)
    time = train.time - begin
    power = (float(train.brake_heat[0]) - heat) / time / 8
    assert power == pytest.approx(45.06e3, rel=1e-3)
    assert time / 60 == pytest.approx(34.3, abs=0.05)
    cooled = math.exp(-cooling * time / (370.0 * STEEL))
    due = hot * cooled + 45.06e3 / cooling * (1 - cooled)
    assert float(train.brake_temperature[0]) - COLD == pytest.approx(due, rel=2e-3)


def hold(train: Train, driver: HoldingDriver, way: float) -> None:
    """Let a driver hold the speed over a distance [m]."""
    end = float(train.distance[0]) + way
    while train.distance[0] < end:
        driver.act(train)
        train.advance(driver.period)
