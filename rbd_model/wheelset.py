"""What every level of detail shares: the variables of a bogie, and one wheelset that rolls, skids or is locked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from fmu_src.system import Friction, System, Variable
from rbd_model import variables
from rbd_model.contact import ellipse_shape
from rbd_model.creep import creepage, kalker_coefficients, polach_force
from rbd_model.parameters import BogieParameters

#: Used where a trial step would ask for the contact of a wheel that carries nothing; a run ends before (wheel lift).
SMALLEST_LOAD = 1.0
SMALLEST_FRICTION = 1e-9

#: Scales of the error control: with tolerance 1e-7, a local error of 1 um/s in speed.
NOMINAL_SPEED = 10.0
NOMINAL_DISTANCE = 10.0
NOMINAL_ANGULAR_VELOCITY = 25.0
NOMINAL_ROTATION = 25.0


@dataclass
class Bogie:
    """The symbols common to all levels while a System is being written."""

    system: System
    parameter: dict[str, ca.SX]
    input: dict[str, ca.SX]
    outputs: dict[str, Variable]
    initial_speed: ca.SX
    contact: dict[str, ca.SX]


@dataclass(frozen=True)
class Wheelset:
    """Symbols of one wheelset: states, forces and torques in the equations of motion."""

    number: int
    angular_velocity: ca.SX
    creep_force: ca.SX
    friction_torque: ca.SX  # brake and rolling resistance, with its sign
    brake_torque: ca.SX  # the brake's part of it
    traction_torque: ca.SX
    sliding_speed: ca.SX


def start_bogie(name: str, description: str, defaults: BogieParameters, used: Sequence[str], speed: float) -> Bogie:
    """A System with the parameters named in `used`, all inputs that the levels share, and the contact constants."""
    system = System(name, description)
    initial = system.parameter(variables.initial_speed(speed))
    parameter = {field: system.parameter(defaults.variable(field)) for field in used}
    table = variables.inputs()
    wanted = [n for n in table if not n.startswith("yaw_torque")]
    symbols = {n: system.input(table[n]) for n in wanted}
    shape = ellipse_shape(
        parameter["wheel_radius"],
        parameter["wheel_profile_curvature"],
        parameter["rail_head_radius"],
        parameter["shear_modulus"],
    )
    contact = {
        "semi_axis_longitudinal": system.derived("semi_axis_longitudinal", shape.longitudinal),
        "semi_axis_lateral": system.derived("semi_axis_lateral", shape.lateral),
        "c11": system.derived("c11", kalker_coefficients(shape.axis_ratio).c11),
    }
    return Bogie(system, parameter, symbols, variables.outputs(), initial, contact)


#: Parameters that the wheelset below needs.
WHEELSET_PARAMETERS = (
    "wheelset_mass",
    "wheelset_pitch_inertia",
    "wheel_radius",
    "rolling_resistance_torque",
    "wheel_profile_curvature",
    "rail_head_radius",
    "shear_modulus",
    "creepage_speed",
    "gravity",
)


def creep_force_of_wheelset(bogie: Bogie, number: int, load: ca.SX, sliding: ca.SX, forward: ca.SX) -> ca.SX:
    """Longitudinal force of both rails on a wheelset that carries `load` [N] and slides at `sliding` [m/s]."""
    wheel_load = ca.fmax(load / 2, SMALLEST_LOAD)
    growth = wheel_load ** (1 / 3)  # eq. (3.87): the semi-axes grow with the cube root of the load
    semi_axes = (bogie.contact["semi_axis_longitudinal"] * growth, bogie.contact["semi_axis_lateral"] * growth)
    friction = ca.fmax(bogie.input[f"friction_{number}"], SMALLEST_FRICTION)
    xi = creepage(sliding, forward, bogie.parameter["creepage_speed"])
    return 2 * polach_force(xi, wheel_load, friction, semi_axes, bogie.parameter["shear_modulus"], bogie.contact["c11"])


def add_wheelset(bogie: Bogie, number: int, forward: ca.SX, load: ca.SX) -> Wheelset:
    """Rotation of one wheelset, third line of eq. (2.8): J dw/dt = F_x r - T_B, with traction and rolling resistance.

    forward [m/s]: speed of its axle; load [N]: vertical force of both rails. The brake torque is a capacity: dry
    friction that opposes the rotation, or holds the wheelset locked while the rail cannot turn it.
    """
    system, parameter = bogie.system, bogie.parameter
    radius, inertia = parameter["wheel_radius"], parameter["wheelset_pitch_inertia"]
    rotation, velocity = f"rotation_{number}", f"angular_velocity_{number}"
    start = bogie.initial_speed / radius
    system.state(rotation, "rad", 0.0, NOMINAL_ROTATION)
    omega = system.state(velocity, "rad/s", start, NOMINAL_ANGULAR_VELOCITY)
    direction = system.direction(f"direction_{number}")

    sliding = forward - radius * omega
    force = creep_force_of_wheelset(bogie, number, load, sliding, forward)
    brake = bogie.input[f"brake_torque_{number}"]
    capacity = brake + parameter["rolling_resistance_torque"]
    traction = bogie.input[f"traction_torque_{number}"]
    drive = traction - force * radius
    # Sliding, the friction is the capacity; locked, it is whatever balances the drive, shared in proportion.
    moving = direction**2
    friction_torque = moving * direction * capacity + (1 - moving) * drive
    system.derivative(rotation, omega)
    system.derivative(velocity, moving * (drive - direction * capacity) / inertia)
    system.dry_friction(Friction(f"Wheelset {number}", direction, velocity, drive, capacity, "locked", "turns again"))

    share = brake / ca.fmax(capacity, 1e-9)
    return Wheelset(number, omega, force, friction_torque, share * friction_torque, traction, sliding)


def add_wheelset_outputs(bogie: Bogie, wheelset: Wheelset, speed: ca.SX, load: ca.SX) -> None:
    system, number = bogie.system, wheelset.number
    slip = speed - bogie.parameter["wheel_radius"] * wheelset.angular_velocity
    moving = system.frictions[number - 1].direction ** 2
    rows = {
        "angular_velocity": wheelset.angular_velocity,
        "rotation": system.states[f"rotation_{number}"].symbol,
        "slip": slip,
        "slip_ratio": creepage(slip, speed, bogie.parameter["creepage_speed"]),
        "creep_force": wheelset.creep_force,
        "axle_load": load,
        "locked": 1 - moving,
    }
    for name, expression in rows.items():
        system.output(bogie.outputs[f"{name}_{number}"], expression)
