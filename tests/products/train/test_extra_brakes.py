"""Track brakes and parking brakes of trains, against integrals, statics and balances of energy."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
from scipy.integrate import quad

from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import write_consist
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from products.train.summary import summary_of
from products.train.train import Train
from rbd_model.track.line import Line

#: Standard gravity [m/s2].
G = 9.80665
#: Relative error of a distance in steps of 5 ms: forces are those at the start of a step.
NEAR = 1e-4
#: Relative error of a balance of energy with steps of 10 ms, and of a limit of statics.
CLOSED, SHARP = 1e-5, 1e-6
#: Friction of sliding wheels, Polach (2005).
FALLS = {"friction_ratio": 0.4, "friction_decay": 0.6}
#: A vehicle of 50 t without resistance and without a brake of the air, and its magnets: 4 of 50 kN.
BARE: dict[str, Any] = {"kind": "coach", "valve": "head", "mass": 50.0, "resistance_a": 0.0, "brake": "none"}
MAGNETS: dict[str, Any] = {"magnetic_attraction": 200.0, "magnetic_rise": 0.0, "magnetic_lift": 0.0}
EDDY: dict[str, Any] = {"eddy_force": 30.0, "eddy_speed": 90.0, "eddy_rise": 0.0}


def train_of(row: dict[str, Any], speed: float, gradient: float = 0.0, friction: float = 0.3, **start: Any) -> Train:
    line = Line({"distance": np.array([-1e5, 1e5]), "gradient": np.array([gradient, gradient])}) if gradient else None
    train = Train(consist_of([row]), speed=speed, line=line, **start)
    train.inputs["friction"] = friction
    return train


def magnetic_force(v: float, attraction: float = 200e3, still: float = 0.25, fast: float = 0.05) -> float:
    """Return the force of magnets [N] whose friction has fallen half way at 50 km/h."""
    return attraction * (fast + (still - fast) * 50.0 / (50.0 + 3.6 * v))


def eddy_force(v: float) -> float:
    """Return the force of the eddy-current brake [N]."""
    x = 3.6 * v / 90.0
    return 30e3 * 2.0 * x / (1.0 + x * x)


def distance(force: Callable[[float], float], mass: float, begin: float, end: float) -> float:
    return float(quad(lambda v: mass * v / force(v), end, begin, epsabs=1e-9, epsrel=1e-10)[0])


def run_to(train: Train, speed: float, step: float = 0.005) -> float:
    """Advance until a speed [m/s] is passed; return the distance to it [m], linear in the square of the speed."""
    start = before = train.distance[0]
    fast = train.speed[0]
    while train.speed[0] > speed:
        before, fast = train.distance[0], train.speed[0]
        train.advance(step)
    share = (fast**2 - speed**2) / (fast**2 - train.speed[0] ** 2)
    return float(before + share * (train.distance[0] - before) - start)


@pytest.mark.study
@pytest.mark.parametrize("friction", [0.3, 0.03])
def test_magnets_alone_stop_in_the_distance_of_their_integral_on_any_rail(friction: float) -> None:
    """S = int m v / F(v) dv, with the rotating mass; friction between wheel and rail has no part in it."""
    train = train_of(BARE | MAGNETS, 45.0, friction=friction)
    train.inputs["track_brake"] = 1.0
    assert run_to(train, 0.0) == pytest.approx(distance(magnetic_force, 1.04 * 50e3, 45.0, 0.0), rel=NEAR)
    assert train.brake_force[0] == 0.0


@pytest.mark.study
@pytest.mark.parametrize("share", [1.0, 0.4])
@pytest.mark.parametrize("friction", [0.3, 0.03])
def test_eddy_currents_alone_slow_in_the_distance_of_their_integral(share: float, friction: float) -> None:
    """To 2 km/h, as their force vanishes at standstill."""
    train, end = train_of(BARE | EDDY, 80.0, friction=friction), 2.0 / 3.6
    train.inputs["track_brake"] = share
    due = distance(lambda v: share * eddy_force(v), 1.04 * 50e3, 80.0, end)
    assert run_to(train, end) == pytest.approx(due, rel=NEAR)


@pytest.mark.study
def test_magnets_add_to_wheels_that_slide_on_a_rail_of_friction_0_03() -> None:
    """Locked wheels: m dv = -(F + mu m g (0.4 + 0.6 exp(-0.6 v))) dt, Polach; without magnets it is much longer."""
    row = BARE | FALLS | {"brake": "ep-direct", "deceleration": 1.2, "rotating": 0.3, "fill_time": 0.5}

    def sliding(v: float) -> float:
        return 0.03 * 50e3 * G * (0.4 + 0.6 * math.exp(-0.6 * v))

    found = []
    for more in (MAGNETS, {}):
        train = train_of(row | more, 30.0, friction=0.03, cylinder=380e3)
        train.drive("emergency")
        train.inputs["track_brake"] = 1.0 if more else 0.0
        train.advance(0.4)  # wheels of 150 kg at the rims lock
        assert train.wheel_speed[0] == 0.0
        begin, own = float(train.speed[0]), magnetic_force if more else (lambda _: 0.0)
        due = distance(lambda v, own=own: own(v) + sliding(v), 50e3, begin, 0.0)  # type: ignore[misc]
        found.append(run_to(train, 0.0))
        assert found[-1] == pytest.approx(due, rel=NEAR)
    assert found[1] > 3 * found[0]


@pytest.mark.parametrize("seed", range(4))
def test_energy_of_the_motion_goes_into_rails_and_wheels(seed: int) -> None:
    """0.5 (1 + r) m v^2 + m g h = heat of the friction brake + int F v dt of the track brakes."""
    draw = np.random.default_rng(seed)
    gradient, speed = draw.uniform(-0.02, 0.02), draw.uniform(30.0, 60.0)
    row = BARE | MAGNETS | EDDY | {"brake": "pneumatic", "wheel_mass": 300.0, "magnetic_rise": draw.uniform(0.5, 3.0)}
    train = train_of(row | {"parking_force": 10.0}, speed, gradient, friction=0.5)
    train.drive("emergency")
    train.inputs["parking_brake"] = draw.uniform()
    run = train.record(draw.uniform(4.0, 9.0), 0.01)
    work = np.diff(run["distance[1]"]) @ run["track_brake_force[1]"][1:]
    moving = [1.04 * v**2 / 2 for v in (run["speed[1]"][0], run["speed[1]"][-1])]
    fallen = -G * gradient * (run["distance[1]"][-1] - run["distance[1]"][0])
    lost = 50e3 * (moving[0] - moving[1] + fallen)
    assert work + run["brake_heat[1]"][-1] == pytest.approx(lost, rel=CLOSED)
    assert min(work, float(run["brake_heat[1]"][-1])) > 0.05 * lost


@pytest.mark.parametrize("model", ["whole", "empirical", "delay"])
def test_an_emergency_lowers_magnets_from_a_speed_on_and_service_does_not(model: str) -> None:
    row = BARE | {"magnetic_attraction": 200.0, "magnetic_rise": 0.0}
    for position, speed, applies in (
        ("emergency", 51.0, True),
        ("emergency", 49.0, False),
        ("service", 100.0, False),
        ("running", 100.0, False),
    ):
        train = train_of(row, speed / 3.6, settings=Settings(model, cells=1.0))
        train.drive(position, 1.0 if position == "service" else 0.0)
        train.advance(20.0 if position == "service" else 3.0)
        assert (train.track_brake_force[0] > 20e3) == applies


def test_lowered_magnets_stay_down_below_that_speed_and_lift_below_another() -> None:
    train = train_of(BARE | {"magnetic_attraction": 200.0, "magnetic_rise": 0.0}, 60.0 / 3.6)
    train.drive("emergency")
    while train.speed[0] > 20.0 / 3.6:
        train.advance(0.01)
        if train.time > 3.0 and train.speed[0] > 20.2 / 3.6:
            assert train.track_brake_force[0] == pytest.approx(magnetic_force(train.speed[0]), rel=3e-3)
    train.advance(0.01)
    assert train.track_brake_force[0] == 0.0
    assert train.speed[0] > 19.0 / 3.6
    train.inputs["track_brake"] = 1.0
    train.advance(0.01)
    assert train.track_brake_force[0] == 0.0


def test_a_pressure_of_0_leaves_track_brakes_to_the_driver() -> None:
    train = train_of(BARE | MAGNETS | EDDY | {"track_brake_pressure": 0.0}, 40.0)
    train.drive("emergency")
    train.advance(10.0)
    assert train.track_brake_force[0] == 0.0
    train.inputs["track_brake"] = 0.5
    train.advance(0.001)
    speed = float(train.speed[0])
    assert train.track_brake_force[0] == pytest.approx(magnetic_force(speed) + 0.5 * eddy_force(speed), rel=1e-4)


@pytest.mark.parametrize(("pressure", "applies"), [(2.95e5, True), (3.05e5, False)])
def test_both_track_brakes_apply_below_a_gauge_pressure_of_the_pipe(pressure: float, applies: bool) -> None:
    train = train_of(BARE | MAGNETS | EDDY, 40.0, pipe=pressure)
    train.drive("shut-off")
    train.advance(0.001)
    speed = float(train.speed[0])
    due = (magnetic_force(speed) + eddy_force(speed)) * applies
    assert train.track_brake_force[0] == pytest.approx(due, rel=1e-4)


def test_a_curve_resists_in_addition_to_track_brakes() -> None:
    """Roeckl: 0.65 m / (R - 55 m) of the weight."""
    rows = {"distance": np.array([-1e5, 1e5]), "gradient": np.zeros(2), "curvature": np.full(2, 1 / 400)}
    train = Train(consist_of([BARE | EDDY]), speed=20.0, line=Line(rows))
    train.inputs["track_brake"] = 1.0
    train.advance(0.001)
    lost = 1.04 * 50e3 * (20.0 - train.speed[0]) / 0.001
    assert lost == pytest.approx(eddy_force(20.0) + 0.65 / 345.0 * 50e3 * G, rel=1e-3)


def test_the_excitation_of_eddy_currents_rises_and_falls_at_a_constant_rate() -> None:
    train = train_of(BARE | EDDY | {"eddy_rise": 4.0}, 60.0)
    for wanted, time, share in ((0.5, 1.0, 0.25), (0.5, 3.0, 0.5), (1.0, 1.0, 0.75), (0.2, 0.4, 0.65), (0.0, 9.0, 0.0)):
        train.inputs["track_brake"] = wanted
        train.advance(time)
        train.advance(1e-6)
        due = share * eddy_force(train.speed[0])
        assert train.track_brake_force[0] == pytest.approx(due, rel=1e-5, abs=1.0)


RISING = {
    "magnets": (
        {"magnetic_attraction": 200.0, "magnetic_friction": 0.15, "magnetic_fast": 0.15, "magnetic_lift": 0.0},
        "magnetic_rise",
        "track_brake",
        30e3,
    ),
    "parking brake": ({"parking_force": 30.0}, "parking_time", "parking_brake", 30e3),
}


@pytest.mark.parametrize("which", RISING)
@pytest.mark.parametrize(("step", "near"), [(0.05, 1e-6), (2.0, 1e-4)])
def test_a_stop_with_a_force_that_rises_has_its_closed_form(which: str, step: float, near: float) -> None:
    """S = v^2 / 2 a + v T / 2 - a T^2 / 24 for a constant force that rises linearly within T."""
    row, of_time, command, force = RISING[which]
    rise, speed = 1.7, 30.0
    train, slows = train_of(BARE | row | {of_time: rise}, speed), force / (1.04 * 50e3)
    train.advance(1e-9)  # a command before the first step would be applied already
    train.inputs[command] = 1.0
    exact = speed**2 / (2 * slows) + speed * rise / 2 - slows * rise**2 / 24
    assert run_to(train, 0.0, step) == pytest.approx(exact, rel=near)


@pytest.mark.parametrize("gradient", [0.03, -0.04, 0.12])
def test_a_parking_brake_holds_up_to_m_g_i_and_runs_away_beyond(gradient: float) -> None:
    """F = m g i within 1e-6; beyond it dv/dt = (m g i - F) / (m (1 + r))."""
    due = 50e3 * G * abs(gradient)
    for share, moves in ((1 + SHARP, False), (1 - SHARP, True), (0.9, True)):
        train = train_of(BARE | {"parking_force": 1e-3 * share * due}, 0.0, gradient)
        train.inputs["parking_brake"] = 1.0
        train.advance(20.0)
        slope = -math.copysign((1 - share) * abs(gradient) * G / 1.04, gradient) if moves else 0.0
        assert train.speed[0] == pytest.approx(20.0 * slope, rel=SHARP / abs(1 - share) * 1e-3 + 1e-9)


def test_a_stated_gradient_is_the_one_that_the_brake_holds() -> None:
    row = BARE | {"parking_gradient": 35.0}
    for gradient, moves in ((0.035 * (1 - SHARP), False), (0.035 * (1 + SHARP), True)):
        train = train_of(row, 0.0, gradient)
        train.inputs["parking_brake"] = 1.0
        train.advance(5.0)
        assert (train.speed[0] != 0.0) == moves


def test_a_parked_vehicle_slides_where_the_rail_does_not_hold() -> None:
    """m dv/dt = m g i - mu m g (0.4 + 0.6 exp(-0.6 v)) with locked wheels."""
    train = train_of(BARE | FALLS | {"parking_gradient": 60.0}, 0.0, -0.05, friction=0.02)
    train.inputs["parking_brake"] = 1.0
    before, lost = 0.0, 0.0
    for _ in range(1000):
        train.advance(0.005)
        speed = (before + train.speed[0]) / 2
        lost += 0.005 * 0.02 * G * (0.4 + 0.6 * math.exp(-0.6 * speed))
        before = float(train.speed[0])
    assert train.wheel_speed[0] == 0.0
    assert before == pytest.approx(5.0 * 0.05 * G - lost, rel=2e-4)


@pytest.mark.parametrize(("word", "due"), [("adds", (20e3, 45e3, 55e3)), ("larger", (20e3, 25e3, 35e3))])
def test_a_parking_brake_adds_to_the_air_or_the_larger_one_acts(word: str, due: tuple[float, ...]) -> None:
    row = {"kind": "coach", "valve": "head", "brake_force": 50.0, "parking_force": 20.0, "parking_compounding": word}
    for pressure, force in zip((0.0, 190e3, 266e3), due, strict=True):
        train = train_of(row, 0.0, cylinder=pressure, settings=Settings("delay"))
        train.inputs["parking_brake"] = 1.0
        train.advance(1e-6)
        assert train.brake_force[0] == pytest.approx(force, rel=1e-4)


def test_a_parking_brake_is_applied_and_released_at_a_constant_rate() -> None:
    train = train_of(BARE | {"parking_force": 20.0, "parking_time": 10.0}, 0.0)
    train.advance(1.0)
    for wanted, time, share in ((1.0, 4.0, 0.4), (1.0, 20.0, 1.0), (0.3, 2.0, 0.8), (0.3, 50.0, 0.3), (0.0, 2.9, 0.01)):
        train.inputs["parking_brake"] = wanted
        train.advance(time)
        train.advance(1e-7)
        assert train.brake_force[0] == pytest.approx(share * 20e3, abs=1.0)


def test_a_restored_run_continues_with_its_extra_brakes(tmp_path: Path) -> None:
    row = BARE | EDDY | {"magnetic_attraction": 150.0, "parking_force": 20.0, "parking_time": 5.0}
    train = train_of(row, 30.0)
    train.drive("emergency")
    train.inputs["parking_brake"] = 0.7
    train.advance(0.6)
    train.inputs["parking_brake"] = 0.1
    train.advance(0.1)
    state, found = train.state, []
    for _ in range(2):
        train.state = state
        run = train.record(4.0)
        found.append([list(run[f"{name}[1]"]) for name in ("speed", "track_brake_force")] + [list(train.brake_force)])
    assert found[0] == found[1]


def test_brakes_that_do_not_act_change_no_bit_and_add_no_column_without_magnets() -> None:
    plain = [{"kind": "locomotive"}, {"kind": "wagon", "count": 3}]
    parked = [row | {"parking_force": 20.0} for row in plain]
    runs = []
    for rows in (plain, parked, [row | EDDY | {"track_brake_pressure": 0.0} for row in parked]):
        train = Train(consist_of(rows), speed=25.0)
        train.drive("service", 1.0)
        runs.append(train.record(20.0))
    assert runs[0].names == runs[1].names
    assert {one.partition("[")[0] for one in runs[2].names} - {one.partition("[")[0] for one in runs[0].names} == {
        "track_brake_force"
    }
    for run in runs[1:]:
        assert all(np.array_equal(run[name], runs[0][name]) for name in runs[0].names)


@pytest.mark.study
def test_the_fmu_brakes_as_the_train_does(tmp_path: Path) -> None:
    rows = [BARE | {"magnetic_attraction": 150.0, "parking_force": 20.0}, {"kind": "coach", **EDDY}]
    consist, settings = consist_of(rows), Settings("whole", cells=1.0)
    write_in_c(train_fmu(consist, settings=settings), tmp_path / "TrainDynamics.fmu", 2)
    train = Train(consist, speed=30.0, settings=settings)
    train.inputs["track_brake"], train.inputs["parking_brake"] = [0.0, 0.6], [0.5, 0.0]
    train.drive("emergency")
    with FmuInstance(tmp_path / "TrainDynamics.fmu") as one:
        one.set(start_speed=30.0, driver_position=4, **{"track_brake[2]": 0.6, "parking_brake[1]": 0.5})
        one.start()
        for n in range(50):
            one.step(0.1 * n, 0.1)
            train.advance(0.1)
        names = [f"{name}[{n}]" for name in ("speed", "track_brake_force", "brake_force") for n in (1, 2)]
        due = [*train.speed, *train.track_brake_force, *train.brake_force]
        assert one.get(names) == due
        assert min(due[2:5]) > 5e3
    described = fmpy.read_model_description(str(tmp_path / "TrainDynamics.fmu"), validate=False)
    units = {one.name: one.unit for one in described.modelVariables}
    assert [units[f"{name}[1]"] for name in ("track_brake_force", "track_brake", "parking_brake")] == ["N", "1", "1"]


@pytest.mark.parametrize("name", ["a.toml", "a.csv"])
def test_rows_and_vehicles_with_extra_brakes_are_written_and_read(name: str, tmp_path: Path) -> None:
    rows = [
        BARE | MAGNETS | {"magnetic_friction": 0.3, "magnetic_fast": 0.1, "magnetic_from": 30.0, "parking_force": 12.0},
        {"kind": "coach", **EDDY, "track_brake_pressure": 2.5, "parking_gradient": 40.0, "parking_time": 30.0},
        {"kind": "wagon", "parking_force": 15.0, "parking_compounding": "larger"},
    ]
    write_consist(rows, tmp_path / name)
    assert read_consist(tmp_path / name) == consist_of(rows)
    write_consist(consist_of(rows), tmp_path / name)
    for one, again in zip(consist_of(rows).vehicles, read_consist(tmp_path / name).vehicles, strict=True):
        assert again.track.values() == pytest.approx(one.track.values(), rel=1e-12)
        assert again.parking.values() == pytest.approx(one.parking.values(), rel=1e-12)


REFUSED = {
    "friction alone": ({"magnetic_friction": 0.2}, "magnetic_friction must come with magnetic_attraction."),
    "speed alone": ({"eddy_speed": 80.0}, "eddy_speed must come with eddy_force."),
    "pressure alone": ({"track_brake_pressure": 2.0}, "track_brake_pressure must come with magnetic_attraction or"),
    "time alone": ({"parking_time": 2.0}, "parking_time must come with parking_force or parking_gradient."),
    "word alone": ({"parking_compounding": "larger"}, "parking_compounding must come with parking_force or"),
    "twice": (
        {"parking_force": 9.0, "parking_gradient": 30.0},
        "a parking brake must be stated once; got parking_force and parking_gradient.",
    ),
    "rising friction": (
        MAGNETS | {"magnetic_fast": 0.3},
        "magnetic_fast must be at most magnetic_friction, 0.25; got 0.3.",
    ),
    "lifts first": (MAGNETS | {"magnetic_lift": 60.0}, "magnetic_lift must be at most magnetic_from, 50 km/h; got 60"),
    "too strong": (
        {"eddy_force": 300.0, "mass": 80.0},
        "eddy_force must be at most 240 kN, which brakes 80 t with 3 m/s2; got 300 kN.",
    ),
    "too many magnets": (
        {"magnetic_attraction": 2000.0, "mass": 80.0},
        "magnetic_attraction must be at most 960 kN, which brakes 80 t with 3 m/s2; got 2000 kN.",
    ),
    "a unit": ({"magnetic_lift": 200.0}, "magnetic_lift must be a number from 0 to 100 km/h; got 200."),
    "a word": ({"parking_force": 9.0, "parking_compounding": "yes"}, "parking_compounding must be one of adds, larger"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_extra_brakes_that_cannot_be_are_refused(case: str) -> None:
    row, message = REFUSED[case]
    with pytest.raises(ValueError, match="the consist, row 2: ") as error:
        consist_of([{"kind": "locomotive"}, {"kind": "wagon"} | row])
    assert message in str(error.value)


def test_a_check_tells_the_gradient_that_holds_and_a_parking_brake_beyond_adhesion() -> None:
    rows = [{"kind": "locomotive", "parking_force": 40.0}, {"kind": "wagon", "mass": 20.0, "parking_force": 70.0}]
    found = summary_of(consist_of([*rows, {"kind": "coach", **EDDY}]), [50.0])
    held = 1e3 * (40e3 + 0.3 * 20e3 * G) / ((84e3 + 20e3 + 46e3) * G)  # wheels of the wagon would slide
    assert found.remarks == (
        f"Parking brakes: 98.8 kN, which hold the train on {held:.1f} permille.",
        "Vehicle 2: parking_force 70 kN is above the 58.84 kN that a rail of friction 0.3 transmits: its wheels slide "
        "first.",
        "Track brakes are part of the stops, not of lambda and brake force.",
    )


def test_a_step_of_no_time_applies_no_parking_brake() -> None:
    train = train_of(BARE | {"parking_force": 50.0, "parking_time": 10.0}, 10.0)
    train.advance(1.0)
    train.advance(0.0)
    train.inputs["parking_brake"] = 1.0
    train.advance(0.1)
    assert train.brake_force[0] < 1e3
