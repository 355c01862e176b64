"""Direct electro-pneumatic and electric brakes of trains, and vehicles without a brake, against quadratures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from products.train.summary import stopping_distance
from products.train.train import Train
from scenarios.benchmark.case_file import CASES, read_case

#: Published answers of the worked example of EN 14531-1.
EXAMPLE = read_case(CASES / "en-14531-1-twelve-axles.toml").points[0].published
#: Models of a train's brake.
MODELS = ("whole", "empirical", "delay")
#: A metro car: electric brake of 70 kN up to 900 kW, faded out below 10 km/h; air by an electric command.
METRO: dict[str, Any] = {
    "kind": "coach",
    "mass": 40.0,
    "length": 18.0,
    "brake": "ep-direct",
    "deceleration": 1.2,
    "resistance_a": 500.0,
    "fill_time": 1.2,
    "release_time": 1.6,
    "dynamic_force": 35.0,
    "dynamic_power": 450.0,
    "dynamic_fade": 10.0,
}


def stop(train: Train, step: float = 0.01) -> float:
    """Advance until the head stands; return its distance [m]."""
    begin = train.distance[0]
    while train.speed[0] > 0.0:
        train.advance(step)
    return float(train.distance[0] - begin)


def way_of(slows: Callable[[float, float, np.ndarray], float], speed: float, *states: Callable[..., float]) -> float:
    """Return the distance to the stop [m] with a deceleration [m/s2] of time, speed and other states."""

    def rates(time: float, y: np.ndarray) -> list[float]:
        return [y[1], -slows(time, y[1], y[2:]), *(one(time, y[1], y[2:]) for one in states)]

    def still(_: float, y: np.ndarray) -> float:
        return float(y[1])

    still.terminal = True  # type: ignore[attr-defined]
    start = [0.0, speed, *(0.0 for _ in states)]
    done = solve_ivp(rates, (0.0, 200.0), start, events=still, rtol=1e-9, atol=1e-9, max_step=0.02)
    return float(done.y[0][-1])


def axles(tread: dict[str, Any], disc: dict[str, Any]) -> list[dict[str, Any]]:
    """Return twelve axles as vehicles: 1, 2, 7, 8, 11, 12 with treads, the others with discs (EN 14531-1)."""
    same = {"kind": "wagon", "length": 3.0, "coupler": "rigid", "brake": "ep-direct", "release_time": 10.0}
    same |= {"resistance_a": 3000 / 12, "resistance_b": 110 / 12, "resistance_c": 7 / 12}
    rows = {
        "tread": same | {"mass": 15.0, "rotating": 10.0, "dead_time": 0.6, "fill_time": 0.95 * 3.0} | tread,
        "disc": same | {"mass": 14.5, "rotating": 100 * 0.7 / 14.5, "dead_time": 0.3, "fill_time": 0.95 * 2.0} | disc,
    }
    order = ("tread", "tread", *["disc"] * 4, "tread", "tread", "disc", "disc", "tread", "tread")
    return [rows[one] | ({"valve": "head"} if n == 0 else {}) for n, one in enumerate(order)]


@pytest.mark.parametrize("model", MODELS)
def test_twelve_axles_of_en_14531_1_stop_in_1242_9_m(model: str, tmp_path: Path) -> None:
    """Forces that rise linearly after a dead time, integrated exactly: 1242.91 m from 45 m/s, mean values 1245.86 m.

    A rise to 100 % in 3 s is one to 95 % in 2.85 s.
    """
    path = tmp_path / "axles.csv"
    write_consist(
        axles({"brake_force": EXAMPLE["tread_force"] / 1e3}, {"brake_force": EXAMPLE["disc_force"] / 1e3}), path
    )
    train = Train(read_consist(path), speed=45.0, settings=Settings(model, cells=1.0))
    assert sum((1 + one.rotating_share) * one.mass for one in train.consist.vehicles) == pytest.approx(
        190.2e3, rel=1e-12
    )
    train.drive("emergency")
    assert stop(train) == pytest.approx(EXAMPLE["distance"], rel=1e-3)
    assert train.brake_force.sum() == pytest.approx(EXAMPLE["brake_force"], rel=1e-6)


def test_the_same_axles_by_their_cylinders_have_its_forces() -> None:
    """Both springs of the example as one in the cylinder: F = i eta (p A - F_return), eqs (2.4) to (2.6)."""
    tread = {"cylinder_diameter": 2e3 * (0.0346 / np.pi) ** 0.5, "rigging_efficiency": 0.95 * 0.95}
    tread |= {"return_force": (300 * 4.75 + 500) / (5 * 0.95 * 0.95), "rigging_ratio": 5.0, "friction_value": 0.28}
    disc = {"cylinder_diameter": 2e3 * (0.0324 / np.pi) ** 0.5, "rigging_efficiency": 0.98 * 0.95, "full_pressure": 3.0}
    disc |= {"return_force": 500 * 4.75 / (5 * 0.98 * 0.95), "rigging_ratio": 5.0}
    disc |= {"friction_value": 0.35 * 2 * 0.27 / 0.89}
    own = axles(tread | {"friction": "constant"}, disc | {"friction": "constant"})
    train = Train(consist_of(own), speed=45.0, settings=Settings("whole", cells=1.0))
    train.drive("emergency")
    distance = stop(train)
    assert train.brake_force[[0, 2]] == pytest.approx([EXAMPLE["tread_force"], EXAMPLE["disc_force"]], rel=1e-6)
    assert train.brake_force.sum() == pytest.approx(EXAMPLE["brake_force"], rel=1e-6)
    assert EXAMPLE["distance"] < distance < 1245.5  # springs are overcome first


def test_a_stop_with_a_linear_build_up_has_its_closed_form() -> None:
    """S = v^2 / 2 a + v T / 2 - a T^2 / 24 for a force that rises linearly within T; 0.95 T to 95 %."""
    rise, slows, speed = 2.0, 1.1, 25.0
    row = {"kind": "coach", "valve": "head", "brake": "ep-direct", "deceleration": slows, "resistance_a": 0.0}
    train = Train(consist_of([row | {"fill_time": 0.95 * rise, "release_time": 60.0}]), speed=speed)
    train.drive("emergency")
    exact = speed**2 / (2 * slows) + speed * rise / 2 - slows * rise**2 / 24
    assert stop(train, 1e-3) == pytest.approx(exact, rel=2e-4)


@pytest.mark.parametrize("model", MODELS)
def test_a_pneumatic_deceleration_stops_after_the_build_up_of_its_cylinder(model: str) -> None:
    """The force is a m in proportion to the cylinder's pressure, which is integrated as it was recorded."""
    row = {"kind": "wagon", "valve": "head", "deceleration": 0.9, "resistance_a": 0.0, "fill_time": 6.0}
    train = Train(consist_of([row]), speed=25.0, settings=Settings(model, cells=1.0))
    train.drive("emergency")
    run = train.record(60.0, 0.01)
    share = run["cylinder_pressure[1]"] / 380e3
    lost = np.r_[0.0, np.cumsum(0.9 * 0.01 * (share[1:] + share[:-1]) / 2)]
    speed = np.maximum(25.0 - lost, 0.0)
    way = run["distance[1]"][-1] - run["distance[1]"][0]
    assert way == pytest.approx(np.trapezoid(speed, dx=0.01), rel=2e-4)
    assert 25.0**2 / 1.8 + 25.0 * 2.0 < way < 25.0**2 / 1.8 + 25.0 * 4.5


def metro_force(v: float) -> float:
    """Return the force of the metro's electric brake [N]."""
    return min(35e3, 450e3 / max(v, 1e-9)) * min(3.6 * v / 10.0, 1.0)


@pytest.mark.parametrize("model", MODELS)
def test_a_metro_brakes_electrically_first_and_air_fills_what_is_missing(model: str) -> None:
    """Cylinders follow the missing share at their rates, settling with 25 over the shorter time."""
    car = METRO | {"deceleration": 1.2, "dynamic_rise": 0.0}
    train = Train(consist_of([car | {"valve": "head"}, *[car] * 3]), speed=22.0, settings=Settings(model, cells=1.0))
    mass, full = 1.04 * 40e3, 1.2 * 1.04 * 40e3

    def lacking(v: float) -> float:
        return 1.0 - min(metro_force(v), full) / full

    def fills(_: float, v: float, y: np.ndarray) -> float:
        return float(np.clip(25.0 / 1.2 * (lacking(v) - y[0]), -(380 - 40) / 380 / 1.6, 0.95 / 1.2))

    def slows(_: float, v: float, y: np.ndarray) -> float:
        return (min(metro_force(v), full) + full * y[0] + 500.0) / mass

    train.drive("emergency")
    assert stop(train, 0.005) == pytest.approx(way_of(slows, 22.0, fills), rel=5e-4)
    assert train.largest_compression < 70e3  # preload of the buffers: all cars brake alike


@pytest.mark.parametrize(
    ("blending", "fast", "slow"),
    [({}, 1.0, 1.0), ({"blending": "adds"}, 1.5, 1.5), ({"blending": "closes", "blending_speed": 36.0}, 0.5, 1.5)],
)
def test_air_fills_adds_or_is_shut_out(blending: dict[str, Any], fast: float, slow: float) -> None:
    """Force over that of the demand, 48 kN, of which the electric brake has the half at any speed."""
    row = {"kind": "coach", "mass": 40.0, "valve": "head", "brake": "ep-direct", "brake_force": 48.0, "fill_time": 0.5}
    train = Train(
        consist_of([row | {"dynamic_force": 24.0, "dynamic_fade": 0.0, "dynamic_rise": 0.0} | blending]), speed=15.0
    )
    train.drive("service", 1.0)
    train.advance(2.0)
    assert train.brake_force[0] == pytest.approx(48e3 * fast, rel=1e-6)
    while train.speed[0] > 8.0:
        train.advance(0.1)
    train.advance(2.0)
    assert train.brake_force[0] == pytest.approx(48e3 * slow, rel=1e-6)


def test_a_stop_with_an_electric_brake_that_rises_has_its_closed_form() -> None:
    """S = v^2 / 2 a + v T / 2 - a T^2 / 24 for a force that rises linearly within T; it falls at the same rate."""
    rise, force, speed = 3.0, 44e3, 25.0
    row = {"kind": "coach", "valve": "head", "mass": 40.0, "rotating": 0.0, "resistance_a": 0.0, "brake_force": 0.1}
    row |= {"dynamic_force": 1e-3 * force, "dynamic_fade": 0.0, "dynamic_rise": rise}
    train, slows = Train(consist_of([row]), speed=speed), force / 40e3
    train.inputs["dynamic_brake"][0] = 1.0
    start = train.state
    assert stop(train, 1e-3) == pytest.approx(
        speed**2 / (2 * slows) + speed * rise / 2 - slows * rise**2 / 24, rel=1e-4
    )
    train.state = start
    train.inputs["dynamic_brake"][0] = 0.6
    for demand, time, due in ((0.6, 1.2, 0.4), (0.6, 2.0, 0.6), (0.0, 0.9, 0.3), (0.0, 1.0, 0.0)):
        train.inputs["dynamic_brake"][0] = demand
        train.advance(time)
        train.advance(1e-6)
        assert train.brake_force[0] == pytest.approx(due * force, abs=1e-5 * force)


@pytest.mark.parametrize(("rise", "least", "most"), [(0.0, 25e3, 31e3), (1.0, 0.0, 1e3)])
def test_rigid_couplers_oscillate_by_a_step_of_force_and_not_by_a_rise(rise: float, least: float, most: float) -> None:
    """The step excites an amplitude of the force that it moves; a rise over T one of 2 / (omega T) of it and less."""
    motor = {"kind": "coach", "valve": "head", "mass": 45.0, "length": 18.0, "rotating": 9.0, "coupler": "rigid"}
    motor |= {"brake": "ep-direct", "deceleration": 1.2, "dead_time": 0.3, "fill_time": 1.2}
    motor |= {"dynamic_force": 60.0, "dynamic_power": 900.0, "dynamic_fade": 10.0, "dynamic_rise": rise}
    trailer = {"kind": "coach", "mass": 38.0, "length": 18.0, "coupler": "rigid", "count": 2}
    trailer |= {name: motor[name] for name in ("brake", "deceleration", "dead_time", "fill_time")}
    train = Train(consist_of([motor, trailer]), speed=20.0)
    train.drive("service", 1.0)
    train.advance(4.0)
    forces = train.record(1.0, 0.004)["coupler_force[1]"]
    assert least <= float(np.ptp(forces)) / 2 <= most


def test_a_service_step_demands_a_share_of_the_force_and_needs_no_pipe() -> None:
    """First service 0.4 bar of 1.5 bar, full service all of it; the pipe's hose has parted behind the head."""
    train = Train(consist_of([METRO | {"valve": "head"}, METRO]), speed=15.0, settings=Settings("whole", cells=1.0))
    full = 1.2 * 1.04 * 40e3
    for step in (0.0, 0.5, 1.0):
        train.drive("service", step)
        train.advance(3.0)
        share = 0.4 / 1.5 + step * (1 - 0.4 / 1.5)
        assert train.brake_force == pytest.approx([share * full] * 2, rel=1e-3)
    train.drive("running")
    train.advance(4.0)
    assert train.brake_force == pytest.approx([0.0, 0.0], abs=1.0)


def test_a_dead_time_delays_the_command() -> None:
    train = Train(consist_of([METRO | {"valve": "head", "dead_time": 0.5}]), speed=2.0)
    train.advance(1.0)
    train.drive("emergency")
    train.advance(0.49)
    assert train.brake_force[0] == 0.0
    train.advance(0.05)
    assert train.brake_force[0] > 100.0


@pytest.mark.parametrize("model", MODELS)
def test_an_electric_brake_of_a_pneumatic_locomotive_adds_by_its_own_command(model: str) -> None:
    rows = [{"kind": "locomotive", "dynamic_force": 150.0, "dynamic_power": 4000.0}, {"kind": "wagon", "count": 3}]
    train = Train(consist_of(rows), speed=40.0, settings=Settings(model, cells=1.0))
    train.inputs["dynamic_brake"][0] = 0.5
    train.advance(1.0)
    speed = train.wheel_speed[0]
    train.advance(1e-3)
    assert train.brake_force[0] == pytest.approx(0.5 * 4e6 / speed, rel=1e-6)
    assert train.brake_force[1:] == pytest.approx([0.0] * 3)
    train.inputs["protection"][0] = 2
    train.advance(1e-3)
    assert train.brake_force[0] == 0.0
    train.inputs["protection"][0] = 0
    train.drive("emergency")
    train.advance(15.0)
    alone = Train(consist_of(rows), speed=float(train.speed[0]), settings=Settings(model, cells=1.0), cylinder=380e3)
    assert train.brake_force[0] > alone.brake_force[0] + 70e3


@pytest.mark.parametrize("model", MODELS)
def test_a_piped_vehicle_carries_the_pipe_and_does_not_brake(model: str) -> None:
    rows = [{"kind": "locomotive"}, {"kind": "wagon", "brake": "none", "count": 2}, {"kind": "wagon"}]
    train = Train(consist_of(rows), speed=20.0, settings=Settings(model, cells=1.0))
    assert [one.percentage for one in train.consist.vehicles][1] == 0.0
    train.drive("emergency")
    train.advance(10.0)
    assert train.brake_force[1:3] == pytest.approx([0.0, 0.0])
    assert train.cylinder_pressure[1:3] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert train.cylinder_pressure[3] > 3e5


def test_a_run_with_electric_brakes_is_saved_and_restored() -> None:
    train = Train(consist_of([METRO | {"valve": "head", "dead_time": 0.4}, METRO]), speed=20.0)
    train.drive("emergency")
    train.advance(0.3)
    state = train.state
    own = [train.record(3.0)["speed[2]"]]
    train.state = state
    own.append(train.record(3.0)["speed[2]"])
    assert np.array_equal(*own)


@pytest.mark.study
def test_the_fmu_of_a_metro_is_the_train(tmp_path: Path) -> None:
    consist = consist_of([METRO | {"valve": "head", "dead_time": 0.4}, METRO])
    write_in_c(train_fmu(consist, settings=Settings("whole", cells=1.0)), tmp_path / "TrainDynamics.fmu", 2)
    train = Train(consist, speed=20.0, settings=Settings("whole", cells=1.0))
    train.drive("emergency")
    with FmuInstance(tmp_path / "TrainDynamics.fmu") as one:
        one.set(start_speed=20.0, driver_position=4)
        one.start()
        for n in range(100):
            one.step(0.1 * n, 0.1)
            train.advance(0.1)
        assert one.get(["speed[2]", "brake_force[1]"]) == [train.speed[1], train.brake_force[0]]


REFUSED = {
    "a pipe's distributor": ({"brake": "ep-direct", "position": "G"}, "position has no effect with brake = ep-direct."),
    "times of no position": (
        {"position": "G", "fill_time": 9.0, "release_time": 9.0},
        "position has no effect with fill_time and release_time.",
    ),
    "its reservoir": ({"brake": "ep-direct", "auxiliary": 100.0}, "auxiliary has no effect with brake = ep-direct."),
    "a force of none": ({"brake": "none", "lambda": 50.0}, "lambda has no effect with brake = none."),
    "a time of none": ({"brake": "none", "fill_time": 5.0}, "fill_time has no effect with brake = none."),
    "dead time of a pipe": ({"dead_time": 0.5}, "dead_time has no effect with distributor = uic."),
    "power alone": ({"dynamic_power": 500.0}, "dynamic_power must come with dynamic_force or dynamic_table."),
    "blending of none": ({"brake": "ep-direct", "blending": "adds"}, "blending must come with dynamic_force"),
    "blending by air": (
        {"dynamic_force": 50.0, "blending": "adds"},
        "blending must be of brake = ep-direct, or of a distributor by wire",
    ),
    "no speed": (
        {"brake": "ep-direct", "dynamic_force": 50.0, "blending": "closes"},
        "blending_speed must come with blending = closes",
    ),
    "a distributor": (
        {"distributor": "ep_direct"},
        "distributor must be one of uic, aar, ecp, ep_uic, twin_pipe, vacuum; got ep_direct.",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_brake_with_something_without_effect_is_refused(case: str) -> None:
    row, message = REFUSED[case]
    with pytest.raises(ValueError, match="the consist, row 1: ") as error:
        consist_of([{"kind": "wagon", "valve": "head"} | row])
    assert message in str(error.value)


@pytest.mark.parametrize("name", ["a.toml", "a.csv"])
def test_electric_rows_and_vehicles_are_written_and_read(name: str, tmp_path: Path) -> None:
    rows = [
        METRO | {"valve": "head", "dead_time": 0.25},
        METRO | {"full_pressure": 4.4, "blending": "closes", "blending_speed": 30.0},
        {"kind": "wagon", "brake": "none"},
    ]
    write_consist(rows, tmp_path / name)
    own = read_consist(tmp_path / name)
    assert own == consist_of(rows)
    write_consist(own, tmp_path / name)
    for one, again in zip(own.vehicles, read_consist(tmp_path / name).vehicles, strict=True):
        assert again.electric.values() == pytest.approx(one.electric.values(), rel=1e-12)
        assert again.distributor.values() == pytest.approx(one.distributor.values(), rel=1e-12)


def test_a_checked_stop_is_counted_from_its_start() -> None:
    """S = v^2 / 2a + v (t_dead + T / 2) - a T^2 / 24 for a linear build-up in T, less what 0.1 s of stepping adds."""
    slows, filled, dead, speed = 1.2, 1.5, 0.3, 80 / 3.6
    row = {"kind": "coach", "valve": "head", "brake": "ep-direct", "deceleration": slows, "resistance_a": 0.0}
    consist = consist_of([row | {"fill_time": 0.95 * filled, "dead_time": dead, "length": 24.0}])
    expected = speed**2 / (2 * slows) + speed * (dead + filled / 2) - slows * filled**2 / 24
    assert stopping_distance(consist, speed) == pytest.approx(expected, abs=0.5)
