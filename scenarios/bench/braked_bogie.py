"""The bogie of chapter 5 with one brake for both wheelsets."""

from fmu_src.cosimulation.master import Connection
from fmu_src.cosimulation.slave import FmuInstance
from products.bogie import BOGIE, TOLERANCE, brake_values
from rbd_model.vehicle.parameters import AS_PRINTED

#: Time in which the cylinder settles at its first pressure before t = 0 [s]; the residual is e^-37 of the change.
FILLING = 10.0


def bogie_values(speed: float) -> dict[str, float]:
    """Return the parameters of the planar level: straight track, and the same torque on both rails.

    Torques act on the wheelsets alone, as in (3.36): the closed forms of these studies do not model a rocking frame.
    """
    return {
        "level": 2,
        "initial_speed": speed,
        "tolerance": TOLERANCE,
        "torque_reaction": AS_PRINTED["torque_reaction"],
    }


def connections(brake: FmuInstance, bogie: FmuInstance) -> list[Connection]:
    """Return the connections: torque to both wheelsets, and the trailing one's angular velocity back."""
    return [
        Connection(brake, "brake_torque", bogie, "brake_torque_1"),
        Connection(brake, "brake_torque", bogie, "brake_torque_2"),
        Connection(bogie, "angular_velocity_2", brake, "angular_velocity"),
    ]


def start_brake(brake: FmuInstance, pressure: float) -> None:
    """Settle the cylinder at a pressure [Pa] at t = 0."""
    brake.restart(brake_values(), time=-FILLING, pressure_demand=pressure)
    brake.step(-FILLING, FILLING)


def acceleration_per_torque() -> float:
    """Return the deceleration of the rolling bogie by the torque on each wheelset, 2/r / (M + 2 J/r^2) [m/s2/N.m]."""
    mass = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass + 2 * BOGIE.wheelset_pitch_inertia / BOGIE.wheel_radius**2
    return 2 / BOGIE.wheel_radius / mass
