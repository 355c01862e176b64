"""Wheel-slide protection of each vehicle of a train: the rig's sensor and controller, on the controller's own clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from bogie_braking.live.carried_train import CarriedTrain
from brake_controller.air import AMBIENT, GAS_CONSTANT, WALL
from brake_controller.distributors import DISTRIBUTORS
from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from brake_controller.distributors.uic import freight, with_times
from brake_controller.drivers_valve import drivers_valve
from brake_controller.protection_fmu import wheel_slide_protection
from brake_controller.vehicle_protection import BUILT_IN, NO_PROTECTION
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from fmu_src.symbols import ca
from fmu_src.system import quantity
from products.building import build_protection, write_in_c
from products.machine import APPLICATION_TIME, CYLINDER_VOLUME, FULL_PRESSURE, RELEASE_TIME
from products.machine import coach as machine
from products.protection import compiled_machine
from products.protection.rails import LOCK_ABOVE
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from products.train.consist import Consist, TrainVehicle, braked_with, coach
from products.train.consist_file import consist_of, read_consist
from products.train.consist_writer import rows_of, write_consist
from products.train.fmu import train_fmu
from products.train.slide_columns import vented_of
from products.train.train import Train
from rbd_model.track.friction import RailCondition, low
from rbd_model.train.vehicle import GRAVITY

FALLING = {"friction_ratio": 0.4, "friction_decay": 0.6}
#: A train whose wheels slide from 20 m/s.
SPEED, FRICTION = 20.0, 0.08
#: Slip that the C and the class below do not exceed for long.
OWN_IN_C = """#include "wheel_slide.h"
typedef struct { double reference; } own;
size_t wheel_slide_size(int wheelsets) { (void)wheelsets; return sizeof(own); }
void wheel_slide_start(void *memory, int wheelsets, double period) { (void)memory; (void)wheelsets; (void)period; }
void wheel_slide_step(void *memory, double time, const double *speed, int *valve) {
    own *self = (own *)memory;
    self->reference -= time > 0.0 ? 0.5 * 0.005 : 0.0;
    if (speed[0] > self->reference) self->reference = speed[0];
    const double behind = self->reference - speed[0];
    valve[0] = behind > 0.8 ? WHEEL_SLIDE_VENT : behind > 0.4 ? WHEEL_SLIDE_HOLD : WHEEL_SLIDE_APPLY;
}
"""


class Own:
    """The same in Python; it stores the times and speeds that it is given."""

    def __init__(self) -> None:
        self.reference, self.given = 0.0, list[tuple[float, float]]()
        SEEN.append(self)

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return the command of the only wheelset."""
        [speed] = wheel_speeds
        self.given.append((time, speed))
        self.reference = max(speed, self.reference - (0.5 * 0.005 if time > 0.0 else 0.0))
        behind = self.reference - speed
        return [2 if behind > 0.8 else 1 if behind > 0.4 else 0]


SEEN: list[Own] = []


def sliding(controller: Any = None, coaches: int = 2, **columns: Any) -> Train:
    """Return a train in an emergency on a low rail."""
    rows = [{"kind": "locomotive", **FALLING}, {"kind": "coach", "count": coaches, **FALLING, **columns}]
    train = bb.train(rows, speed=SPEED, protection=controller)
    train.inputs["friction"] = FRICTION
    train.drive("emergency")
    return train


def stopped(train: Train) -> tuple[float, np.ndarray]:
    """Return distance [m], and time for which the wheels of each were locked above LOCK_ABOVE [s]."""
    begin = train.distance[0]
    stop = train.record(200.0, 0.05)
    vehicles = range(1, len(train.consist.vehicles) + 1)
    fast = [stop[f"speed[{n}]"] > LOCK_ABOVE for n in vehicles]
    locked = np.array([0.05 * stop[f"locked[{n}]"][fast[n - 1]].sum() for n in vehicles])
    return train.distance[0] - begin, locked


# ---- against the rig -------------------------------------------------------------------------------------------------


class Alike:
    """The built-in protection with one sensor and one valve for all wheelsets, as a vehicle of a train has it."""

    def __init__(self) -> None:
        self.one = SlideProtection()

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return the command of the first wheelset for all."""
        return self.one.step(time, wheel_speeds[:1]) * len(wheel_speeds)


#: A low rail whose creep law is steep: its best slip is nearly 0, as in a train's vehicle. Steel, ten times as stiff.
STEEP, STEEL = replace(low(), law=replace(low().law, slip_reduction=1.0)), {"shear_modulus": 8.2e11}


def on_the_rig(controller: Callable[[], Any] | None, by_flow: bool, monkeypatch: pytest.MonkeyPatch) -> Stop:
    """Return a stop of the rig's coach at level 1, where its wheelsets do not differ."""
    monkeypatch.setattr(compiled_machine, "LEVELS", (1, 2, 3))
    rig = Rig(machine(), controller, Settings(), by_flow=by_flow, level=1)
    [stop] = rig.runs([Run({"gravity": GRAVITY, **STEEP.values(4), **STEEL})])
    return stop


def the_same_coach(distributor: DistributorParameters, rail: RailCondition, **protection: float) -> TrainVehicle:
    """Return a vehicle of a train with masses, brake force and sensor of the rig's coach, and with a driver's valve."""
    one, p = machine(), machine().parameters
    rotating = 4.0 * p.wheelset_pitch_inertia / p.wheel_radius**2
    own = {"wheel_radius": p.wheel_radius, "cylinders": 4 * CYLINDER_VOLUME} | protection
    vehicle = replace(
        coach(),
        mass=one.mass,
        rotating_share=rotating / one.mass,
        resistance=(0.0, 0.0, 0.0),
        brake=braked_with(4.0 * one.full_torque / p.wheel_radius, FULL_PRESSURE),
        valve=drivers_valve(),
        friction_ratio=rail.law.friction_ratio,
        friction_decay=rail.law.friction_decay,
        protection=replace(NO_PROTECTION, **own),
    )
    electric = replace(vehicle.electric, blended_pressure=FULL_PRESSURE)
    return replace(vehicle, distributor=distributor, electric=electric)


def in_a_train(vehicle: TrainVehicle) -> tuple[float, float]:
    """Return distance [m] and air [kg] of a stop of one vehicle that brakes after 1 s, as on the rig."""
    train = Train(Consist((vehicle,)), speed=25.0)
    train.inputs["friction"] = low().friction
    begin = train.distance[0]
    train.advance(1.0)
    train.drive("emergency")
    while train.speed[0] > 0.02:
        train.advance(0.05)
    return float(train.distance[0] - begin), float(train.protection_air[0])


def test_a_coach_whose_reservoir_feeds_its_cylinders_stops_as_on_the_rig(monkeypatch: pytest.MonkeyPatch) -> None:
    """Chokes of the same times give the same distance. Its air is isothermal, that of the rig cools: it uses less."""
    rig = on_the_rig(Alike, True, monkeypatch)
    usual = replace(freight(), auxiliary_volume=0.2, cylinder_volume=4 * CYLINDER_VOLUME)
    chokes = vented_of({"vent_time": RELEASE_TIME}, with_times(usual, APPLICATION_TIME, 10.0))
    distance, air = in_a_train(the_same_coach(chokes, STEEP, controller=float(BUILT_IN)))
    assert distance == pytest.approx(rig.distance, rel=0.01)
    assert 0.7 * rig.air < air < 0.9 * rig.air
    unprotected, _ = in_a_train(the_same_coach(chokes, STEEP))
    assert unprotected > 1.5 * distance


@dataclass(frozen=True)
class Timed(DistributorParameters):
    """The rig's cylinder by application and release time."""

    application: float = quantity("1/s", "Rate of application", 0.1)
    release: float = quantity("1/s", "Rate of release", 0.1)


def timed(moment: Moment) -> Answer:
    """Return `pressure_rate` of brake_controller/pneumatics.py, written again."""
    p, over = moment.given, moment.states["cylinder"] - AMBIENT
    apart = p["demanded"] * p["full_pressure"] - over
    fills = apart * ca.if_else(apart > 0, p["application"], p["release"])
    none = ca.SX(0)
    return Answer({"cylinder": (1 - p["held"]) * fills - p["vented"] * over * p["release"]}, none, none, none)


def timed_cylinder(position: str) -> Timed:
    """Return the cylinder of the rig's coach."""
    del position
    return Timed(FULL_PRESSURE, math.log(20.0) / APPLICATION_TIME, math.log(20.0) / RELEASE_TIME)


def take_timed_cylinders(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let trains have the cylinder of the rig's coach as their distributor."""
    form = Distributor(
        name="timed",
        parameters=Timed,
        states=(("cylinder", "cylinder"),),
        ready=timed_cylinder,
        whole=timed,
        pace=lambda p: p.release,
        wired=True,
    )
    monkeypatch.setitem(DISTRIBUTORS, "timed", form)


@pytest.mark.study
def test_a_train_of_one_coach_equals_the_stop_of_the_rig(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the same cylinder and a steep creep law, what remains is the integration: 0.2 % of the distance."""
    take_timed_cylinders(monkeypatch)
    for controller, make in ((0.0, None), (float(BUILT_IN), Alike)):
        rig = on_the_rig(make, False, monkeypatch)
        own = the_same_coach(timed_cylinder(""), STEEP, controller=controller, valve_time=0.0)
        distance, air = in_a_train(own)
        assert distance == pytest.approx(rig.distance, rel=3e-3)
        if controller:
            assert air == pytest.approx(rig.air, rel=2e-2)
            assert distance < 0.6 * in_a_train(replace(own, protection=NO_PROTECTION))[0]


# ---- sensor, clock, valves -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("host", [0.005, 0.012, 0.7])
def test_controllers_step_on_their_own_clock_whatever_the_host_does(host: float) -> None:
    """Times are multiples of the period; readings are the true speed while the wheels roll evenly."""
    SEEN.clear()
    train = sliding(Own, protection="built-in", sample_time=4.0)
    train.drive("running")
    for _ in range(round(2.1 / host)):
        train.advance(host)
    train.advance(1e-9)
    locomotive, *coaches = (one for one in SEEN if one.given)
    for own, period in ((locomotive, 5e-3), (coaches[0], 4e-3)):
        times, readings = np.array(own.given).T
        assert np.array_equal(times, period * np.arange(times.size))
        assert times[-1] == pytest.approx(train.time, abs=1.01 * period)
        assert readings[times > 0.2] == pytest.approx(np.full((times > 0.2).sum(), SPEED), rel=5e-3)


@pytest.mark.parametrize(
    ("columns", "full"),
    [({}, 3.8e5), ({"distributor": "aar"}, 3.5e5), ({"brake": "ep-direct", "fill_time": 2, "release_time": 3}, 3.8e5)],
)
def test_a_dump_valve_empties_a_full_cylinder_in_its_time(columns: dict[str, Any], full: float) -> None:
    """The time is that from full to 0.4 bar, with valves that open at once."""

    class VentsFrom60:
        def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
            return [2 if time >= 60.0 else 0]

    train = sliding({1: VentsFrom60}, 1, vent_time=0.8, valve_time=0.0, **{"protection": "built-in"} | columns)
    train.inputs["friction"] = 2.0
    train.drive("service", 1.0)
    train.advance(60.0)
    begin = train.cylinder_pressure[1]
    assert begin > 0.9 * full
    while train.cylinder_pressure[1] > 40e3:
        train.advance(0.005)
    assert train.time - 60.0 == pytest.approx(0.8, rel=0.08 if "distributor" in columns else 0.03)


def test_a_magnet_valve_follows_its_command_by_a_lag() -> None:
    """A cylinder that fills at a constant rate gains, after a hold, the rate times the lag, valve_time over ln 20."""

    class HoldsFrom1:
        def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
            return [1 if time >= 1.0 else 0]

    def held(valve_time: float) -> float:
        columns = {"protection": "built-in", "brake": "ep-direct", "fill_time": 4, "release_time": 3}
        train = sliding({1: HoldsFrom1}, 1, valve_time=valve_time, **columns)
        train.advance(3.0)
        return float(train.cylinder_pressure[1])

    rate = 0.95 * 3.8e5 / 4.0
    assert held(0.6) - held(0.0) == pytest.approx(rate * 0.6 / math.log(20.0), rel=1e-3)


def test_on_a_good_rail_a_protection_changes_nothing_and_its_cylinders_fill_once() -> None:
    """The air of one filling is p V / (R T); the step of the clock changes the distance by less than 1e-3."""
    distances = []
    for protection in (None, "built-in"):
        train = sliding(protection)
        train.inputs["friction"] = 0.4
        begin = train.distance[0]
        train.record(100.0)
        distances.append(train.distance[0] - begin)
    assert distances[1] == pytest.approx(distances[0], rel=1e-3)
    assert not train.protection_state.any()
    filled = train.cylinder_pressure * freight().cylinder_volume / (GAS_CONSTANT * WALL)
    assert train.protection_air == pytest.approx(filled, rel=5e-3)


# ---- forms of controllers --------------------------------------------------------------------------------------------


def test_eight_vehicles_with_eight_controllers_stop_shorter_and_hardly_lock() -> None:
    """Above 0.3 m/s each is locked for less than a second, instead of most of the stop."""
    free, locked = stopped(sliding(coaches=7))
    distance, never = stopped(sliding("built-in", coaches=7, vent_time=0.6))
    assert (locked[1:] > 10.0).all()  # the locomotive rolls
    assert never.max() < 1.0
    assert distance < 0.9 * free


def test_the_built_in_controller_as_an_fmu_of_its_own_gives_the_same(tmp_path: Path) -> None:
    path = build_protection(tmp_path, wheel_slide_protection(1))
    trains = [sliding(controller) for controller in ("built-in", path)]
    for train in trains:
        train.advance(12.0)
    assert np.array_equal(trains[0].wheel_speed, trains[1].wheel_speed)
    assert trains[0].protection_air.max() > 0.06


def test_a_controller_in_c_in_python_and_in_an_fmu_of_the_train_are_the_same(tmp_path: Path) -> None:
    """Its commands, pressures and speeds are bit-identical in all forms and both versions of FMI."""
    own = tmp_path / "own.c"
    own.write_text(OWN_IN_C)
    trains = [sliding(controller) for controller in (own, Own)]
    fmu = train_fmu(trains[0].consist, trains[0].settings)
    paths = [tmp_path / str(version) / "TrainDynamics.fmu" for version in (2, 3)]
    for version, path in zip((2, 3), paths, strict=True):
        path.parent.mkdir()
        write_in_c(fmu, path, version)
    with FmuInstance(paths[0], start_speed=SPEED) as two, FmuInstance(paths[1], start_speed=SPEED) as three:
        two.start(driver_position=4, **{f"friction[{n}]": FRICTION for n in (1, 2, 3)})
        three.start(driver_position=4, friction=[FRICTION] * 3)
        states = set[float]()
        for number in range(1000):
            for train in trains:
                train.advance(0.012)
            two.step(0.012 * number, 0.012)
            three.step(0.012 * number, 0.012)
            for name in ("speed", "wheel_speed", "cylinder_pressure", "protection_state", "protection_air", "slip"):
                ours = getattr(trains[0], name)
                assert np.array_equal(ours, getattr(trains[1], name))
                assert np.array_equal(ours, [two[f"{name}[{n}]"] for n in (1, 2, 3)])
                assert np.array_equal(ours, three.array(name))
            states |= set(trains[0].protection_state)
    assert states == {0.0, 1.0, 2.0}


@pytest.mark.parametrize("version", [2, 3])
def test_the_built_in_protection_has_the_same_numbers_in_an_fmu(tmp_path: Path, version: int) -> None:
    train = sliding("built-in")
    path = tmp_path / "TrainDynamics.fmu"
    write_in_c(train_fmu(train.consist, train.settings), path, version)
    with FmuInstance(path, start_speed=SPEED) as fmu:
        values: dict[str, Any] = {f"friction[{n}]": FRICTION for n in (1, 2, 3)}
        fmu.start(driver_position=4, **(values if version == 2 else {"friction": [FRICTION] * 3}))
        for number in range(200):
            fmu.step(0.1 * number, 0.1)
            train.advance(0.1)
        for name in ("speed", "wheel_speed", "protection_state", "protection_air"):
            theirs = [fmu[f"{name}[{n}]"] for n in (1, 2, 3)] if version == 2 else fmu.array(name)
            assert np.array_equal(getattr(train, name), theirs)
        hand = {"protection[2]": 1} if version == 2 else {"protection": [0, 1, 0]}
        fmu.set(**hand)
        with pytest.raises(
            CosimulationError, match=r"protection\[2\] must be possible at its place; got 1. This vehicle"
        ):
            fmu.step(20.0, 0.1)


def test_a_saved_state_has_sensors_controllers_and_valves() -> None:
    train = sliding("built-in")
    train.advance(6.013)
    kept = train.state
    train.advance(4.0)
    after = train.state
    train.state = kept
    train.advance(4.0)
    assert np.array_equal(train.state.view(np.int64), after.view(np.int64))
    assert set(train.protection_state) <= {0.0, 1.0, 2.0}
    mine = sliding(Own)
    with pytest.raises(ValueError, match="The state must be of controllers in C; that of vehicle 1 is in Python"):
        _ = mine.state


def test_a_run_with_controllers_is_repeated_from_its_provenance(tmp_path: Path) -> None:
    own = tmp_path / "own.c"
    own.write_text(OWN_IN_C)
    messages = bb.repeat(sliding({0: "built-in", 1: str(own), 2: None}).record(8.0)).messages
    assert next(message for message in messages if "locked" not in message).startswith("Equal to The result")


def test_a_controller_that_fails_keeps_its_brake_applied_and_is_told() -> None:
    class Fails:
        def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
            if time > 3.0:
                raise RuntimeError("no more")
            return [1]

    train = sliding({2: Fails})
    train.advance(2.9)
    held = train.cylinder_pressure[2]
    stop = train.record(20.0)
    assert held < 1e3
    assert train.cylinder_pressure[2] == pytest.approx(train.cylinder_pressure[1], rel=0.02)
    assert train.protection_state.tolist() == [0.0, 0.0, 3.0]
    assert "Vehicle 3: The controller Fails failed at 3.005 s (RuntimeError: no more" in stop.status

    class Stops:
        def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sliding(Stops).advance(1.0)


def test_a_library_that_writes_beyond_its_memory_keeps_its_brake_applied(tmp_path: Path) -> None:
    own = tmp_path / "beyond.c"
    own.write_text(
        OWN_IN_C.replace("self->reference -=", "if (time > 1.0) ((char *)memory)[9] = 1;\n    self->reference -=")
    )
    train = sliding(own)
    train.advance(5.0)
    assert train.protection_state.tolist() == [3.0] * 3
    assert train.controller_failures[0].startswith("Vehicle 1: Its controller gave an invalid command or wrote beyond")
    path = tmp_path / "TrainDynamics.fmu"
    write_in_c(train_fmu(train.consist), path, 2)
    with FmuInstance(path) as fmu:
        fmu.start()
        fmu.step(0.0, 5.0)
        assert [fmu[f"protection_state[{number}]"] for number in (1, 2, 3)] == [3] * 3
        assert "The controller of vehicle 1 failed before 5 s" in fmu.messages[-1]


# ---- columns ---------------------------------------------------------------------------------------------------------


def test_a_consist_with_protections_is_written_and_read_again(tmp_path: Path) -> None:
    own = tmp_path / "my own, first.c"
    own.write_text(OWN_IN_C)
    rows = [
        {"kind": "locomotive", "protection": "built-in", "vent_time": 0.7},
        {"kind": "wagon", "distributor": "aar", "vent_time": 1.2},
        {"kind": "coach", "brake": "ep-direct", "protection": "built-in", "encoder_teeth": 80, "wheel_diameter": 880.0},
        {"kind": "coach", "protection": str(own), "sample_time": 10.0, "valve_time": 0.05},
    ]
    consist = consist_of(rows)
    again = consist_of(rows_of(consist))
    for one, other in zip(consist.vehicles, again.vehicles, strict=True):
        assert one.controller == other.controller
        assert one.protection.values() == pytest.approx(other.protection.values(), rel=1e-12)
        assert one.distributor.values() == pytest.approx(other.distributor.values(), rel=1e-9)
    for name in ("train.csv", "train.toml"):
        write_consist(consist, tmp_path / name)
        assert [one.controller for one in read_consist(tmp_path / name).vehicles] == [
            *("built-in", "none", "built-in"),
            str(own),
        ]
    (tmp_path / "beside.toml").write_text('[[vehicle]]\nkind = "locomotive"\nprotection = "my own, first.c"\n')
    assert read_consist(tmp_path / "beside.toml").vehicles[0].controller == str(own)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"encoder_teeth": 80}, "encoder_teeth must come with protection = built-in or a file"),
        ({"brake": "none", "protection": "built-in"}, "protection has no effect with brake = none"),
        ({"protection": "builtin"}, "protection must be one of none, built-in, dump-valve or the file of a controller"),
        ({"brake": "none", "vent_time": 1.0}, "vent_time has no effect with brake = none"),
        (
            {"distributor": "vacuum", "vent_time": 1.0},
            "vent_time must be of a built-in brake by compressed air; got distributor = vacuum",
        ),
        ({"rotating": 0, "protection": "built-in"}, "rotating must be above 0 % on a vehicle with a protection"),
    ],
)
def test_columns_without_an_effect_are_refused(columns: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        consist_of([{"kind": "locomotive"}, {"kind": "coach", **columns}])


def test_a_protection_that_is_stated_twice_or_cannot_be_is_refused(tmp_path: Path) -> None:
    train = sliding({1: "built-in"})
    train.inputs["protection"] = [2.0, 0.0, 1.0]
    train.advance(0.1)
    train.inputs["protection"][1] = 2.0
    with pytest.raises(
        ValueError, match=r"inputs\['protection'\]\[1\] must be 0: vehicle 2 has a controller of its own"
    ):
        train.advance(0.1)
    train.inputs["protection"][1] = 0.0
    train.inputs["external_vehicle"][1] = 1.0
    with pytest.raises(ValueError, match="must be 0: vehicle 2 has a controller of its own, whose sensor"):
        train.advance(0.1)
    with pytest.raises(ValueError, match="The vehicle of a protection must be an integer from 0 to 2; got 3"):
        sliding({3: "built-in"})
    with pytest.raises(ValueError, match="The vehicle of a protection must have a brake; vehicle 1 has none"):
        bb.train([{"kind": "locomotive"}, {"kind": "coach", "brake": "none"}], protection={1: "built-in"})
    with pytest.raises(
        ValueError, match="rotating must be above 0 % on a vehicle with a protection; got 0 of vehicle 1"
    ):
        bb.train([{"kind": "locomotive"}, {"kind": "coach", "rotating": 0}], protection={1: "built-in"})
    with pytest.raises(TypeError, match="The controller must be the class Own; got an object of it"):
        sliding(Own())
    with pytest.raises(ValueError, match="protection must be one of none, built-in, dump-valve or the file of"):
        sliding("builtin")
    with pytest.raises(ValueError, match="protection of a page must be built-in or none; got Own"):
        CarriedTrain("", sliding(Own).consist).packed()
    (tmp_path / "lacks.c").write_text(OWN_IN_C.replace("wheel_slide_start", "begin"))
    for name, message in (
        ("lacks.c", "it lacks wheel_slide_start. Add"),
        ("none.c", "must be a file that exists; got"),
    ):
        with pytest.raises(ValueError, match=message):
            train_fmu(consist_of([{"kind": "locomotive", "protection": str(tmp_path / name)}]))
    with pytest.raises(ValueError, match="The controller of a train's FMU must be built-in or a C file; got Own"):
        train_fmu(sliding(Own).consist)
