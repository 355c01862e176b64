"""The bogie of chapter 5 with one brake for both wheelsets."""

from __future__ import annotations

from brake_controller.parameters import qr30
from fmu_src.cosimulation.master import Connection
from fmu_src.cosimulation.slave import Slave
from rbd_model.vehicle.parameters import AS_PRINTED, tables_5_1_and_5_2

BOGIE = tables_5_1_and_5_2()
#: Pressure [Pa] and torque capacity on each wheelset [N.m] of the full brake, which slows the bogie at 1.48 m/s2.
FULL_PRESSURE, FULL_TORQUE = 180e3, 20e3
TORQUE_PER_PRESSURE = FULL_TORQUE / FULL_PRESSURE
#: Time in which the cylinder settles on its first pressure before t = 0 [s]; what is left of the way is e^-37.
FILLING = 10.0
#: Of both FMUs in studies of the macro step. It keeps their own errors far below those of the coupling.
TOLERANCE = 1e-10


def brake_values() -> dict[str, float]:
    """The QR30's brake with shoe forces scaled up to FULL_TORQUE; assumed: the thesis does not print this bogie's."""
    brake = qr30(int(FULL_PRESSURE / 1e3))
    per_force = brake.wheelset_share * brake.rigging_efficiency * brake.constant_shoe_friction * brake.wheel_radius
    return brake.values() | {"force_per_pressure": TORQUE_PER_PRESSURE / per_force, "tolerance": TOLERANCE}


def bogie_values(speed: float) -> dict[str, float]:
    """The planar level: straight track, and the torque is the same on both rails.

    Torques on the wheelsets alone, as in (3.36): the closed forms of these studies know no frame that rocks under them.
    """
    return {
        "level": 2,
        "initial_speed": speed,
        "tolerance": TOLERANCE,
        "torque_reaction": AS_PRINTED["torque_reaction"],
    }


def connections(brake: Slave, bogie: Slave) -> list[Connection]:
    """Torque to both wheelsets, and the trailing one's angular velocity back."""
    return [
        Connection(brake, "brake_torque", bogie, "brake_torque_1"),
        Connection(brake, "brake_torque", bogie, "brake_torque_2"),
        Connection(bogie, "angular_velocity_2", brake, "angular_velocity"),
    ]


def start_brake(brake: Slave, pressure: float) -> None:
    """Lets the cylinder stand at a pressure [Pa] at t = 0."""
    brake.restart(brake_values(), time=-FILLING, pressure_demand=pressure)
    brake.step(-FILLING, FILLING)


def acceleration_per_torque() -> float:
    """Deceleration of the rolling bogie by the torque on each wheelset, 2/r / (M + 2 J/r^2) [m/s2/N.m]."""
    mass = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass + 2 * BOGIE.wheelset_pitch_inertia / BOGIE.wheel_radius**2
    return 2 / BOGIE.wheel_radius / mass
