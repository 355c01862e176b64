"""Asymmetric brake shoes on one wheelset of the bogie: the scene of chapter 9 and what is printed about it."""

from __future__ import annotations

from dataclasses import dataclass

from fmu_src.kernel import Kernel
from scenarios.bench.drive import bogie, play
from scenarios.cosimulation.recording import Recording

BRAKE_TORQUE, BRAKE_START, SPEED = 20e3, 1.0, 25.0
#: Yaw torque at full brake by error of the shoe forces [%], Tables 9.2 and 9.3.
YAW_TORQUE = {25: 43.92e3, 50: 87.84e3, 75: 131.76e3}
APPLICATION_TIMES = (10.0, 5.0, 1.0)
#: Stop times [s] by application time; peak lateral shift [mm] of leading and trailing wheelset, in that order.
STOP_TIME = {10.0: 22.9, 5.0: 20.4, 1.0: 18.3}
PEAKS = {
    (1, 25): ((2.4, 1.5), (2.5, 1.7), (2.5, 1.9)),
    (1, 50): ((8.3, 6.1), (9.2, 6.5), (9.3, 7.3)),
    (2, 25): ((1.6, 2.2), (1.7, 2.4), (1.7, 2.7)),
    (2, 50): ((7.4, 5.6), (7.5, 5.9), (7.8, 6.2)),
    (2, 75): ((10.9, 10.8), (11.1, 11.2), (11.2, 11.1)),
}
#: Speed at which the program of the thesis broke down [m/s].
DERAILED_AT = {10.0: 5.9, 5.0: 6.1, 1.0: 6.1}
INTERVAL = 2e-3
RECORDED = ("speed", "lateral_1", "lateral_2")


@dataclass(frozen=True)
class Case:
    """One line of the tables; `rotates`: the yaw torque's axis turns with the wheelset."""

    wheelset: int
    error: int
    application: float
    rotates: bool

    @property
    def name(self) -> str:
        place = {1: "leading", 2: "trailing"}[self.wheelset]
        return f"{'rotating' if self.rotates else 'fixed'} axis, {place}, {self.error} %, {self.application:g} s"


def brake(case: Case, duration: float, **values: float) -> tuple[Kernel, Recording]:
    """A stop from 25 m/s, the contact held where a wheel would lift: where the run ended, and what it recorded."""
    full = BRAKE_START + case.application
    torque = [(0.0, 0.0), (BRAKE_START, 0.0), (full, BRAKE_TORQUE)]
    yaw = [(0.0, 0.0), (BRAKE_START, 0.0), (full, YAW_TORQUE[case.error])]
    inputs = {"brake_torque_1": torque, "brake_torque_2": torque, f"yaw_torque_{case.wheelset}": yaw}
    reading = {"yaw_torque_rotates": int(case.rotates), "wheel_lift_ends": 0}
    kernel = bogie(inputs, RECORDED, initial_speed=SPEED, **reading | values)
    return kernel, play("bogie", kernel, duration, INTERVAL, RECORDED, inputs)
