"""The cab of a train: direct brake, interlock, main reservoir, penalty and vigilance, against closed forms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.train.consist_file import consist_of
from products.train.consist_writer import rows_of
from products.train.fmu import train_fmu
from products.train.numbers import Settings
from products.train.train import Train

#: Air: gas constant [J/(kg.K)], temperature of the walls [K], ambient pressure [Pa], discharge coefficient of chokes.
R, T, P0, DISCHARGE = 287.05, 293.15, 101325.0, 0.8
#: Share of the full pressure by which the ellipse of ISO 6358-1 and the band of a relay miss isentropic flow.
OF_FLOW = 0.006
#: Relative error of a balance of air, and of a time in steps of 10 ms of 10 s.
CLOSED, TIMED = 1e-9, 1e-3
#: Relative error of a mass that is summed from recorded pressures.
OF_RECORD = 2e-3
LOCOMOTIVE: dict[str, Any] = {"kind": "locomotive", "direct_pressure": 3.8, "main_reservoir": 800.0}
#: Friction of sliding wheels, Polach (2005).
FALLS = {"friction_ratio": 0.4, "friction_decay": 0.6}
WAGONS: dict[str, Any] = {"kind": "wagon", "count": 4}


def train_of(head: dict[str, Any], *others: dict[str, Any], **start: Any) -> Train:
    return Train(consist_of([head, *others]), settings=Settings(cells=1.0), **start)


def isentropic(area: float, pressure: float, behind: float) -> float:
    """Return the mass flow [kg/s] through an orifice, de Saint-Venant and Wantzel (1839)."""
    ratio = max(behind / pressure, (2.0 / 2.4) ** 3.5)
    shape = math.sqrt(max(7.0 * (ratio ** (2.0 / 1.4) - ratio ** (2.4 / 1.4)), 0.0))
    return area * pressure / math.sqrt(R * T) * shape


@pytest.mark.parametrize("time", [0.4, 4.0, 40.0])
def test_direct_brake_fills_and_empties_as_a_volume_behind_an_orifice(time: float) -> None:
    """V dp/dt = R T G with isentropic flow, whose area gives 95 % and 0.4 bar in the stated times."""
    train = train_of(LOCOMOTIVE | {"direct_fill_time": time, "direct_release_time": time, "main_reservoir": 10e3})
    volume, full = 10.3e-3, 380e3

    def flow(area: float, filling: bool, pressure: float) -> float:
        return isentropic(area, 1000e3 + P0, pressure) if filling else -isentropic(area, pressure, P0)

    for filling, begin, end, wanted in ((True, P0, P0 + 0.95 * full, 1.0), (False, P0 + full, P0 + 40e3, 0.0)):
        steps = np.linspace(begin, end, 20001)
        slowness = [1.0 / flow(1.0, filling, p) for p in (steps[1:] + steps[:-1]) / 2.0]
        area = volume / (R * T) * float(np.diff(steps) @ slowness) / time
        train.inputs["direct_brake"][0] = wanted
        run = train.record(2.0 * time, time / 100.0)
        times = np.linspace(0.0, time, 101)
        due = solve_ivp(
            lambda _, p, f=filling: R * T / volume * flow(1.0, f, p[0]),
            (0.0, area * time),
            [begin],
            t_eval=np.minimum(area * times, area * time),
            rtol=1e-9,
        )
        assert np.abs(run["cylinder_pressure[1]"][:101] + P0 - due.y[0]).max() < OF_FLOW * full
        assert run["cylinder_pressure[1]"][-1] == pytest.approx(wanted * full, abs=0.01 * full)


def test_defaults_of_the_direct_brake_are_those_of_the_page() -> None:
    """0.90 bar/s on average to 95 %, and 0.85 bar/s to 0.4 bar."""
    train = train_of(LOCOMOTIVE)
    for wanted, reached in ((1.0, 361e3), (0.0, 40e3)):
        train.inputs["direct_brake"][0] = wanted
        run = train.record(10.0, 0.01)
        passed = np.argmax(run["cylinder_pressure[1]"] >= reached if wanted else run["cylinder_pressure[1]"] <= reached)
        assert run["time"][passed] - run["time"][0] == pytest.approx(4.0, abs=0.04)


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_reservoir_pays_by_boyle_and_is_pumped_up_as_free_air_is_compressed(scale: float) -> None:
    """V_r dp_r = -V_c dp_c without a compressor; with one, dp_r = p0 Q t / V_r, from the cut-in to the cut-out."""
    volume = max(800.0 * scale, 20.0)
    idle = train_of(LOCOMOTIVE | {"main_reservoir": volume, "compressor": 0.0})
    idle.inputs["direct_brake"][0] = 1.0
    idle.advance(20.0)
    lost, won = 1000e3 - idle.main_reservoir_pressure[0], idle.cylinder_pressure[0]
    assert lost * volume == pytest.approx(won * 10.3, rel=1e-6)  # overshoot of the relay empties again
    head = LOCOMOTIVE | {"main_reservoir": volume, "compressor": 240.0 * scale, "cut_in": 9.9999, "direct_volume": 20.0}
    train = train_of(head | {"direct_fill_time": 0.4})
    train.inputs["direct_brake"][0] = 1.0
    train.advance(1.0)
    assert train.compressor_on[0]
    begin, time = train.main_reservoir_pressure[0], 0.0
    while train.compressor_on[0]:
        train.advance(0.01)
        time += 0.01
    rate = P0 * 240e-3 * scale / 60.0 / (1e-3 * volume)
    assert time == pytest.approx((1000e3 - begin) / rate, abs=0.011)
    assert train.main_reservoir_pressure[0] == pytest.approx(1000e3, rel=CLOSED)


def test_an_empty_main_reservoir_is_pumped_up_in_the_time_of_the_page() -> None:
    """t = V p / (p0 Q), 197 s: 800 l to 10 bar with 2400 l/min, while the pipe is charged and takes nothing."""
    run = train_of(LOCOMOTIVE | {"start_pressure": 0.0}).record(250.0, 0.1)
    due = 0.8 * 1000e3 / (P0 * 0.04)
    assert due == pytest.approx(197.0, abs=0.5)
    assert run["time"][np.argmax(run["compressor_on[1]"][1:] == 0.0) + 1] == pytest.approx(due, abs=0.11)
    assert run["main_reservoir_pressure[1]"][1000] == pytest.approx(1000e3 * 100.0 / due, rel=1e-6)


def test_governor_starts_at_the_cut_in_and_stops_at_the_cut_out() -> None:
    train = train_of(LOCOMOTIVE | {"main_reservoir": 100.0, "leak": 4.0}, WAGONS)
    run = train.record(120.0, 0.05)
    on, pressure = run["compressor_on[1]"], run["main_reservoir_pressure[1]"]
    starts, stops = (np.flatnonzero(np.diff(on) == way) for way in (1.0, -1.0))
    assert min(starts.size, stops.size) >= 2
    assert np.abs(pressure[starts + 1] - 850e3).max() < 10e3
    assert pressure[stops + 1] == pytest.approx(1000e3, rel=1e-2)
    assert pressure.max() <= 1000e3 * (1.0 + CLOSED)


@pytest.mark.parametrize("reservoir", [20.0, 200.0])
def test_pipe_wins_what_the_main_reservoir_loses(reservoir: float) -> None:
    """Boyle: p V of an empty pipe and a reservoir that cannot fill it is kept, at the temperature of the walls.

    The rush of air carries the pipe above the reservoir by about a kPa, and the check valve holds it there.
    """
    bare: dict[str, Any] = {"brake": "none", "length": 14.0}
    head = {"kind": "locomotive", "main_reservoir": reservoir, "compressor": 0.0, "cut_in": 2.0, "cut_out": 3.0}
    train = train_of(head | bare, {"kind": "wagon", "count": 20} | bare, pipe=0.0)
    train.advance(200.0)
    own, pipe = train.main_reservoir_pressure[0], train.pipe_pressure.mean()
    assert own * reservoir + pipe * 1e3 * float(train.air.volume.sum()) == pytest.approx(300e3 * reservoir, rel=1e-6)
    assert train.pipe_pressure.max() < own + 2e3
    assert own < 150e3


def test_an_exhausted_main_reservoir_does_not_empty_the_pipe() -> None:
    head = LOCOMOTIVE | {
        "main_reservoir": 20.0,
        "compressor": 0.0,
        "cut_in": 6.0,
        "cut_out": 7.0,
        "direct_volume": 60.0,
    }
    train = train_of(head, WAGONS)
    train.inputs["direct_brake"][0] = 1.0
    train.advance(60.0)
    assert train.main_reservoir_pressure[0] < 200e3
    assert train.pipe_pressure.min() > 480e3
    train.drive("service", 1.0)
    train.advance(20.0)
    train.drive("running")
    train.advance(60.0)  # nothing is left to release with
    assert train.pipe_pressure.max() < 370e3
    assert train.main_reservoir_pressure[0] < 200e3


@pytest.mark.parametrize("seed", range(6))
def test_compressed_air_is_in_reservoirs_pipe_and_cylinders_or_let_out(seed: int) -> None:
    """At random inputs and parameters of a tenth to ten times the usual: delivered = held + passed on, by mass.

    A cylinder never fills and empties at once, so that its gains are those of its recorded pressure. Both locomotives
    are bailed off, so that their cylinders have the pressure of the direct brake.
    """
    draw = np.random.default_rng(seed)

    def scaled(usual: float, least: float = 0.0) -> float:
        return max(usual * 10.0 ** draw.uniform(-1.0, 1.0), least)

    head: dict[str, Any] = {"kind": "locomotive", "direct_pressure": 3.8, "main_reservoir": scaled(800.0)}
    head |= {"compressor": scaled(2400.0), "direct_volume": scaled(10.3), "direct_fill_time": scaled(4.0, 0.4)}
    head |= {"direct_release_time": scaled(4.0, 0.4)}
    train = train_of(head, {"kind": "wagon", "brake": "none", "leak": draw.uniform(0.0, 3.0)}, head | {"valve": "none"})
    seen, reservoir = [0, 2], 1e-3 * head["main_reservoir"] / (R * T)
    cylinder, let_in = 1e-3 * head["direct_volume"] / (R * T), 0.0
    train.inputs["bail_off"] = 1
    pipe = train.air.mass
    begin, before = train.main_reservoir_pressure.sum() * reservoir, train.cylinder_pressure[seen]
    for n in range(3000):
        if n % 300 == 0:
            train.inputs["direct_brake"] = draw.choice([0.0, 1.0, draw.random()], 3)
            train.inputs["protection"] = draw.choice([0.0, 0.0, 1.0, 2.0], 3)
            train.drive(str(draw.choice(["running", "service", "service", "emergency"])), draw.random())
        train.advance(0.01)
        let_in += cylinder * np.maximum(train.cylinder_pressure[seen] - before, 0.0).sum()
        before = train.cylinder_pressure[seen]
    held = train.main_reservoir_pressure.sum() * reservoir - begin
    gone = train.air.passed
    left = train.air.mass - pipe + gone.leak_mass + gone.vehicle_mass + (gone.valve_mass + gone.let_in)
    assert train.air_used == pytest.approx(left, rel=CLOSED)
    assert train.compressor_air.sum() == pytest.approx(held + train.air_used + let_in, rel=OF_RECORD, abs=1e-4)
    assert let_in > 1e-4


def test_cylinder_has_the_higher_pressure_and_bail_off_leaves_the_direct_brake() -> None:
    """UIC brakes refill after a bail-off; an AAR valve in lap does not, until a further reduction."""
    for more, again in (({}, 380e3), ({"distributor": "aar"}, 190e3)):
        train = train_of(LOCOMOTIVE | more, WAGONS)
        train.inputs["direct_brake"][0] = 0.5
        train.drive("service", 1.0)
        train.advance(60.0)
        automatic = train.cylinder_pressure[0]
        assert automatic > 330e3
        wagons = train.cylinder_pressure[1:].copy()
        train.inputs["bail_off"] = 1.0
        train.advance(20.0)
        assert train.cylinder_pressure[0] == pytest.approx(190e3, abs=3e3)
        assert train.cylinder_pressure[1:] == pytest.approx(wagons, rel=0.02)  # they have no valve for it
        train.inputs["bail_off"] = 0.0
        train.advance(30.0)
        assert train.cylinder_pressure[0] == pytest.approx(again, abs=6e3)


def electric(**more: Any) -> dict[str, Any]:
    return {"kind": "locomotive", "dynamic_force": 150.0, "dynamic_power": 3000.0} | more


@pytest.mark.parametrize("position", ["service", "emergency"])
def test_interlock_keeps_air_out_until_the_electric_brake_fades_or_fails(position: str) -> None:
    train = train_of(electric(blending="interlock"), WAGONS, speed=25.0)
    train.inputs["dynamic_brake"][0] = 1.0
    train.advance(1.0)
    train.drive(position, 1.0 if position == "service" else 0.0)
    run = train.record(60.0, 0.05)
    fast = run["wheel_speed[1]"] > 8.0 / 3.6 + 0.1
    assert run["cylinder_pressure[1]"][fast].max() < 5e3
    assert run["cylinder_pressure[2]"][fast].max() > 370e3
    assert run["cylinder_pressure[1]"][-1] > 30e3  # fades below 8 km/h
    train = train_of(electric(blending="interlock"), WAGONS, speed=25.0)
    train.inputs["dynamic_brake"][0] = 1.0
    train.drive(position, 1.0 if position == "service" else 0.0)
    train.advance(5.0)
    train.inputs["dynamic_brake"][0] = 0.0
    train.advance(4.6)
    assert train.cylinder_pressure[0] > 0.95 * 375e3


def test_locked_wheels_are_told_once_and_the_interlock_prevents_them() -> None:
    found = {}
    for name, more in (("adds", {}), ("interlock", {"blending": "interlock"})):
        train = train_of(electric(**more, **FALLS, dynamic_force=80.0), WAGONS, speed=25.0)
        train.inputs["friction"] = 0.15
        train.inputs["dynamic_brake"][0] = 1.0
        train.drive("service", 1.0)
        run = train.record(30.0, 0.01)
        locked = (run["wheel_speed[1]"] == 0.0) & (run["speed[1]"] != 0.0)
        found[name] = run.messages
        if name == "adds":
            assert run["time"][np.argmax(locked)] == pytest.approx(train.locked_at[0], abs=1e-9)
            again = train.record(1.0).messages
            assert again == run.messages
    told = "The wheels of vehicle 1 locked at"
    assert [message[: len(told)] for message in found["adds"]] == [told]
    assert "blending = interlock" in found["adds"][0]
    assert found["interlock"] == []


@pytest.mark.parametrize(("penalty", "position"), [(1, "service"), (2, "emergency")])
@pytest.mark.parametrize("wagons", ["uic", "ecp"])
def test_a_penalty_is_the_brake_of_its_position_without_traction(penalty: int, position: str, wagons: str) -> None:
    motors = {"kind": "locomotive", "traction_force": 300.0, "traction_power": 4000.0, "traction_cut_out": 0.0}
    trains = [train_of(motors, {"kind": "wagon", "count": 5, "distributor": wagons}, speed=15.0) for _ in range(2)]
    for train in trains:
        train.inputs["traction"][0] = 1.0
        train.advance(3.0)
        assert train.traction_force[0] > 100e3
    trains[0].inputs["penalty"] = penalty
    trains[1].drive(position, 1.0)
    trains[1].inputs["traction"] = 0.0
    for train in trains:
        train.advance(8.0)
    assert trains[0].traction_force[0] == 0.0
    for name in ("pipe_pressure", "cylinder_pressure"):
        assert np.array_equal(getattr(trains[0], name), getattr(trains[1], name))


def test_a_penalty_does_not_weaken_the_driver_s_emergency() -> None:
    trains = [train_of({"kind": "locomotive"}, WAGONS, speed=15.0) for _ in range(2)]
    trains[0].inputs["penalty"] = 1
    for train in trains:
        train.drive("emergency")
        train.advance(5.0)
    assert np.array_equal(trains[0].pipe_pressure, trains[1].pipe_pressure)


def when(run: Any, name: str, least: float) -> float:
    """Return the first time at which a column is at least a value [s]."""
    return float(run["time"][np.argmax(run[name] >= least)])


def test_vigilance_warns_brakes_and_lets_go_of_a_standing_train_that_was_acknowledged() -> None:
    """Times of the device from the last acknowledgement; 30 s and 5 s."""
    train = train_of({"kind": "locomotive", "vigilance_time": 30.0, "vigilance_penalty": "service"}, WAGONS, speed=15.0)
    train.inputs["pull"][0] = 20e3
    train.advance(20.0)
    train.inputs["vigilance"] = 1
    run = train.record(40.0, 0.01)
    assert when(run, "vigilance_warning[1]", 1.0) == pytest.approx(50.0, abs=TIMED * 20.0)
    assert when(run, "penalty_applied[1]", 1.0) == pytest.approx(55.0, abs=TIMED * 20.0)
    train.inputs["pull"] = 0.0
    train.advance(5.0)
    train.inputs["vigilance"] = 0  # while it moves: the penalty stays
    train.advance(1.0)
    assert train.penalty_applied[0] == 1.0
    assert train.speed[0] > 0.1
    train.record(100.0)
    train.advance(1.0)
    assert train.penalty_applied[0] == 0.0
    train.advance(100.0)  # standing
    assert train.vigilance_warning[0] == 0.0
    assert train.pipe_pressure[-1] > 480e3


STATED = LOCOMOTIVE | {"compressor": 1200.0, "cut_in": 7.0, "cut_out": 9.0, "vigilance_time": 3.0, "warning_time": 1.0}
STATED |= {"start_pressure": 8.0, "dynamic_force": 150.0, "blending": "interlock", "direct_volume": 15.0}


def disturbed(train: Any, inputs: Sequence[tuple[str, float]]) -> None:
    for name, value in inputs:
        train.inputs[name][0] = value


COMMANDS = [
    [("direct_brake", 0.7), ("dynamic_brake", 0.4)],
    [("driver_position", 3.0), ("driver_step", 0.5), ("vigilance", 1.0)],
    [("bail_off", 1.0), ("direct_brake", 0.2)],
    [("penalty", 1.0), ("bail_off", 0.0), ("vigilance", 0.0)],
    [("penalty", 0.0), ("driver_position", 1.0), ("dynamic_brake", 0.0)],
]
OUT = ("speed", "pipe_pressure", "cylinder_pressure", "main_reservoir_pressure", "compressor_on", "compressor_air")


def test_saved_states_restore_the_cab_bit_for_bit() -> None:
    train = train_of(STATED, WAGONS, speed=15.0)
    found = []
    for commands in COMMANDS:
        disturbed(train, commands)
        state = train.state
        for _ in range(2):
            train.advance(2.0)
            found.append([getattr(train, name).tobytes() for name in (*OUT, "penalty_applied", "vigilance_warning")])
            if len(found) % 2:
                train.advance(1.0)
                train.state = state
        assert found[-1] == found[-2]


@pytest.mark.parametrize("version", [2, 3])
def test_fmus_have_the_cab_of_the_class(version: int, tmp_path: Path) -> None:
    consist, settings, path = consist_of([STATED, WAGONS]), Settings(cells=1.0), tmp_path / "cab.fmu"
    write_in_c(train_fmu(consist, settings), path, version)
    train = Train(consist, settings=settings, speed=15.0)
    with FmuInstance(path) as slave:
        slave.set(start_speed=15.0)
        slave.start()
        for n, commands in enumerate(COMMANDS):
            for name, value in commands:
                train.inputs[name][0] = value
                first = f"{name}[1]" if f"{name}[1]" in slave.units else name
                slave.set(**{first: value if version == 2 or len(train.inputs[name]) == 1 else [*train.inputs[name]]})
            train.advance(2.0)
            slave.step(2.0 * n, 2.0)
            for name in (*OUT, "penalty_applied", "vigilance_warning"):
                due = getattr(train, name)
                each = [f"{name}[{i + 1}]" for i in range(due.size)] if f"{name}[1]" in slave.units else [name]
                found = slave.array(name) if version == 3 and due.size > 1 else slave.get(each)
                assert np.array_equal(np.array(found, float), due), name


def test_columns_of_the_cab_are_written_as_they_are_read() -> None:
    [row, _] = rows_of(consist_of([STATED, WAGONS]))
    for name in set(STATED) - {"kind"}:
        assert row[name] == (pytest.approx(STATED[name], rel=1e-9) if name != "blending" else "interlock")


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ({"direct_fill_time": 3.0}, "direct_fill_time must come with direct_pressure"),
        ({"compressor": 300.0}, "compressor must come with main_reservoir"),
        ({"compressor": 2.4, "main_reservoir": 800}, "compressor must be 0 or from 10 to 30000 l/min"),
        ({"warning_time": 3.0}, "warning_time must come with vigilance_time"),
        ({"main_reservoir": 800, "valve": "none"}, "main_reservoir must supply a driver's valve or a direct brake"),
        ({"main_reservoir": 800, "cut_in": 10}, "cut_in must be below cut_out"),
        ({"main_reservoir": 800, "start_pressure": 11}, "start_pressure must be at most cut_out, 10 bar"),
        ({"direct_pressure": 9}, "direct_pressure must be below the pressure of its supply, 8 bar"),
        ({"direct_pressure": 3, "brake": "none"}, "direct_pressure has no effect with brake = none"),
        ({"blending": "interlock"}, "blending must come with dynamic_force or dynamic_table"),
        ({"blending": "adds", "dynamic_force": 100}, "blending must be of brake = ep-direct"),
        (
            {"blending": "interlock", "dynamic_force": 100, "brake": "ep-direct"},
            "blending = interlock must be of a brake that the pipe controls",
        ),
    ],
)
def test_columns_without_an_effect_are_refused(row: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message.replace("(", r"\(")):
        consist_of([{"kind": "locomotive", "valve": "head"} | row, WAGONS])


def test_inputs_that_no_vehicle_uses_are_refused() -> None:
    train = train_of({"kind": "locomotive"}, WAGONS)
    for name, lacks in (("direct_brake", "a direct brake"), ("bail_off", "a direct brake or the interlock")):
        train.inputs[name] = 1.0
        with pytest.raises(ValueError, match=f"no vehicle has {lacks}"):
            train.advance(0.1)
        train.inputs[name] = 0.0
    with pytest.raises(ValueError, match="main_reservoir of vehicle 1 has no effect with brake_model = delay"):
        Train(consist_of([LOCOMOTIVE, WAGONS]), settings=Settings("delay"))
