"""Wheel-slide protection of a vehicle in detail: a sensor, a cylinder and magnet valves of each wheelset."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from brake_controller.air import AMBIENT, GAS_CONSTANT, WALL
from brake_controller.distributors.uic import freight
from brake_controller.vehicle_protection import BUILT_IN
from fmu_src.cosimulation.slave import FmuInstance
from products.building import write_in_c
from products.coach import NUMBERS
from products.protection import compiled_machine
from products.protection.rig import Rig
from products.protection.runs import Run
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from products.train import detailed_kernel
from products.train.consist_file import consist_of
from products.train.consist_writer import rows_of
from products.train.detail_columns import detail_of
from products.train.fmu import train_fmu
from products.train.train import Train
from rbd_model.track.friction import RailCondition, low
from rbd_model.train.vehicle import GRAVITY
from tests.products.train.test_train_protection import (
    STEEP,
    in_a_train,
    machine,
    take_timed_cylinders,
    the_same_coach,
    timed_cylinder,
)

#: A coach whose wheels slide from 20 m/s; the dump valve is one for which the built-in controller is tuned.
COACH = {"kind": "coach", "friction_ratio": 0.4, "friction_decay": 0.6, "vent_time": 0.6, "fill_time": 2}
IN_DETAIL: dict[str, Any] = {**COACH, "detail": "coach", "level": 1}
SPEED = 20.0
#: Slip control of each wheelset by itself, as C.
OWN_IN_C = """#include "wheel_slide.h"
enum { MOST = 16 };
typedef struct { int wheelsets; double reference; } own;
size_t wheel_slide_size(int wheelsets) { (void)wheelsets; return sizeof(own); }
void wheel_slide_start(void *memory, int wheelsets, double period) {
    (void)period;
    ((own *)memory)->wheelsets = wheelsets;
}
void wheel_slide_step(void *memory, double time, const double *speed, int *valve) {
    own *self = (own *)memory;
    self->reference -= time > 0.0 ? 0.5 * 0.005 : 0.0;
    for (int n = 0; n < self->wheelsets; ++n)
        if (speed[n] > self->reference) self->reference = speed[n];
    for (int n = 0; n < self->wheelsets; ++n) {
        const double behind = self->reference - speed[n];
        valve[n] = behind > 0.8 + 0.1 * n ? WHEEL_SLIDE_VENT : behind > 0.4 ? WHEEL_SLIDE_HOLD : WHEEL_SLIDE_APPLY;
    }
}
"""


class Own:
    """The same in Python."""

    def __init__(self) -> None:
        self.reference = 0.0

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return a command for each wheelset."""
        self.reference = max(*wheel_speeds, self.reference - (0.5 * 0.005 if time > 0.0 else 0.0))
        behind = [self.reference - speed for speed in wheel_speeds]
        return [2 if one > 0.8 + 0.1 * n else 1 if one > 0.4 else 0 for n, one in enumerate(behind)]


def vents(wheelset: int, start: float, end: float) -> Callable[[], Any]:
    """Return a controller that vents one wheelset, from 0, between two times [s]."""

    class Vents:
        def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
            return [2 if n == wheelset and start <= time < end else 0 for n, _ in enumerate(wheel_speeds)]

    return Vents


def sliding(controller: Any, friction: float = 0.08, row: dict[str, Any] = IN_DETAIL) -> Train:
    """Return a train of a locomotive and this vehicle, with a controller, in an emergency."""
    train = bb.train([{"kind": "locomotive"}, row], speed=SPEED, protection={1: controller})
    train.inputs["friction"] = friction
    train.drive("emergency")
    return train


def torques(train: Train) -> list[float]:
    """Return the brake torques of its wheelsets [N.m]."""
    return [train.details[2][f"brake_torque_{n}"] for n in NUMBERS]


@pytest.mark.study
@pytest.mark.parametrize(("level", "rail"), [(1, STEEP), (2, STEEP), (3, STEEP), (1, low())])
def test_a_coach_in_detail_stops_as_on_the_rig(
    monkeypatch: pytest.MonkeyPatch, level: int, rail: RailCondition
) -> None:
    """With the same cylinder and creep law: four sensors and valves, as the rig has."""
    start, law = detailed_kernel.start_values, {"slip_reduction": rail.values(4)["slip_reduction"]}
    monkeypatch.setattr(detailed_kernel, "start_values", lambda *given: start(*given) | law)
    monkeypatch.setattr(compiled_machine, "LEVELS", (1, 2, 3))
    take_timed_cylinders(monkeypatch)
    rig = Rig(machine(), SlideProtection, Settings(), by_flow=False, level=level)
    [stop] = rig.runs([Run({"gravity": GRAVITY, **rail.values(4)})])
    own = the_same_coach(timed_cylinder(""), rail, controller=float(BUILT_IN), valve_time=0.0)
    distance, air = in_a_train(replace(own, detail=detail_of({"detail": "coach", "level": level})))
    assert distance == pytest.approx(stop.distance, rel=4e-3)
    assert air == pytest.approx(stop.air, rel=3e-2)


def test_where_one_sensor_lets_the_wheels_lock_four_do_not() -> None:
    """At a friction of 0.06, by samples of 50 ms above 0.3 m/s."""
    locked = []
    wheelsets = [f"vehicle_2.angular_velocity_{n}" for n in NUMBERS]
    for row, names in ((COACH, ["wheel_speed[2]"]), (IN_DETAIL, wheelsets)):
        stop = sliding("built-in", 0.06, row | {"release_time": 10}).record(200.0, 0.05)
        locked.append(max(0.05 * ((stop[name] == 0.0) & (stop["speed[2]"] > 0.3)).sum() for name in names))
    assert locked[0] > 2.0
    assert locked[1] < 0.5


def test_a_wheelset_that_is_vented_alone_loses_its_torque_and_a_quarter_of_the_air() -> None:
    """Air is conserved: what leaves the reservoirs is what all cylinders were filled with, p V / (R T)."""
    train = sliding(vents(1, 12.0, 15.0), 0.4)
    reservoir = train.air.vehicle_pressures("auxiliary")[1]
    train.advance(12.0)
    full, before, filled = torques(train), train.cylinder_pressure[1], train.protection_air[1]
    cylinder = freight().cylinder_volume / (GAS_CONSTANT * WALL)
    assert full == pytest.approx([full[0]] * 4)
    assert filled == pytest.approx(before * cylinder, rel=1e-2)
    train.advance(3.0)
    assert torques(train)[1] < 0.01 * full[1]
    assert torques(train)[0] == pytest.approx(full[0], rel=0.02)
    assert train.cylinder_pressure[1] == pytest.approx(0.75 * before, rel=0.02)
    assert train.protection_state[1] == 2.0
    train.advance(10.0)
    assert torques(train) == pytest.approx([torques(train)[0]] * 4, rel=1e-3)
    pressure = train.cylinder_pressure[1]
    assert train.protection_air[1] == pytest.approx((pressure + pressure / 4) * cylinder, rel=2e-2)
    lost = reservoir - train.air.vehicle_pressures("auxiliary")[1]
    taken = lost * freight().auxiliary_volume / (GAS_CONSTANT * WALL)
    assert taken == pytest.approx(train.protection_air[1], rel=1e-2)
    assert train.air.vehicle_pressures("auxiliary")[1] > AMBIENT


def test_a_wheelset_that_is_vented_loses_its_electric_brake() -> None:
    """The interlock of the electric brake has let the air out of the cylinders of all wheelsets."""
    row = {**IN_DETAIL, "dynamic_force": 40, "dynamic_power": 2000, "blending": "interlock"}
    train = sliding(vents(2, 5.0, 60.0), 0.4, row)
    train.inputs["dynamic_brake"][1] = 1.0
    train.advance(4.9)
    full = torques(train)
    train.advance(1.0)
    assert full[0] == pytest.approx(full[2]) != 0.0
    assert torques(train)[2] < 1e-3 * full[0]
    assert train.cylinder_pressure[1] < 1e3
    assert torques(train)[0] == pytest.approx(full[0], rel=0.05)
    assert train.brake_force[1] == pytest.approx(sum(torques(train)) / 0.46, rel=1e-9)


def test_the_stop_is_the_same_for_any_step_of_the_host_and_after_a_saved_state() -> None:
    """Bit for bit: controllers step on the grid of the vehicles in detail."""
    fine = sliding("built-in")
    for _ in range(8000):
        fine.advance(1e-3)
    state = fine.state
    for step in (0.05, 0.2):
        coarse = sliding("built-in")
        for _ in range(round(8.0 / step)):
            coarse.advance(step)
        for name in ("speed", "wheel_speed", "cylinder_pressure", "protection_air"):
            assert np.array_equal(getattr(coarse, name), getattr(fine, name))
    fine.advance(2.0)
    after = fine.state
    fine.state = state
    fine.advance(2.0)
    assert np.array_equal(fine.state.view(np.int64), after.view(np.int64))
    assert fine.protection_air[1] > 0.06


def test_controllers_in_c_in_python_and_in_an_fmu_of_the_train_are_the_same(tmp_path: Path) -> None:
    """Two vehicles at levels 1 and 2, one with a controller of the user and one with the built-in one."""
    own, path = tmp_path / "own.c", tmp_path / "TrainDynamics.fmu"
    own.write_text(OWN_IN_C)
    rows = [{"kind": "locomotive"}, IN_DETAIL, {**IN_DETAIL, "level": 2, "protection": "built-in"}]
    trains = [bb.train(rows, speed=SPEED, protection={1: controller}) for controller in (own, Own)]
    write_in_c(train_fmu(trains[0].consist, trains[0].settings), path, 3)
    for train in trains:
        train.inputs["friction"] = 0.08
        train.drive("emergency")
    with FmuInstance(path, start_speed=SPEED) as fmu:
        fmu.start(driver_position=4, friction=[0.08] * 3)
        for number in range(160):
            if number == 80:
                state = fmu.save()
            for train in trains:
                train.advance(0.05)
            fmu.step(0.05 * number, 0.05)
            for name in ("speed", "wheel_speed", "cylinder_pressure", "protection_state", "protection_air"):
                ours = getattr(trains[0], name)
                assert np.array_equal(ours, getattr(trains[1], name))
                assert np.array_equal(ours, fmu.array(name))
        end = fmu.array("protection_air")
        fmu.restore(state)
        for number in range(80, 160):
            fmu.step(0.05 * number, 0.05)
        assert np.array_equal(end, fmu.array("protection_air"))
    speeds = [trains[0].details[2][f"angular_velocity_{n}"] for n in NUMBERS]
    assert len(set(speeds)) > 1
    assert (end[1:] > 0.06).all()


def test_a_protected_vehicle_in_detail_is_written_and_has_its_own_wheels() -> None:
    rows = [{"kind": "locomotive"}, {**IN_DETAIL, "protection": "built-in"}]
    consist = consist_of(rows)
    assert consist.vehicles[1].sensed.wheelsets == 4.0
    assert "wheel_diameter" not in rows_of(consist)[1]
    assert consist_of(rows_of(consist)).vehicles[1].sensed == consist.vehicles[1].sensed
    with pytest.raises(ValueError, match="wheel_diameter must be left out with detail"):
        consist_of([rows[0], {**rows[1], "wheel_diameter": 900}])
    with pytest.raises(ValueError, match="direct_pressure must be left out with detail and protection"):
        bb.train([rows[0], {**IN_DETAIL, "direct_pressure": 3.8}], protection={1: "built-in"})
