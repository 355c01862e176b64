"""What every level of detail shares: the variables of a bogie, and one wheelset that rolls, skids or is locked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from fmu_src.system import Friction, System, Variable
from rbd_model import variables
from rbd_model.adhesion import Rail, add_rail
from rbd_model.contact import ellipse_shape
from rbd_model.creep import creepage, kalker_coefficients, saturated
from rbd_model.parameters import BogieParameters

#: Used where a trial step would ask for the contact of a wheel that carries nothing; a run ends before (wheel lift).
SMALLEST_LOAD = 1.0
SMALLEST_FRICTION = 1e-9

#: Longer over shorter semi-axis of a contact that a run may start with; where Kalker's table ends.
MOST_SLENDER = 10.0

#: Scales of the error control: with tolerance 1e-7, a local error of 1 um/s in speed.
NOMINAL_SPEED = 10.0
NOMINAL_DISTANCE = 10.0
NOMINAL_ANGULAR_VELOCITY = 25.0
NOMINAL_ROTATION = 25.0
#: Motions in the suspension: with tolerance 1e-7, 1 nm and 0.1 um/s.
NOMINAL_TRAVEL = 0.01
NOMINAL_TRAVEL_SPEED = 1.0


@dataclass
class Bogie:
    """The symbols common to all levels while a System is being written."""

    system: System
    parameter: dict[str, ca.SX]
    input: dict[str, ca.SX]
    outputs: dict[str, Variable]
    initial_speed: ca.SX
    rail: Rail


@dataclass(frozen=True)
class Rotation:
    """Symbols of one wheelset that turns: velocity, torques of its brake with sign, and 0 where it is locked."""

    number: int
    angular_velocity: ca.SX
    friction_torque: ca.SX  # brake and rolling resistance
    brake_torque: ca.SX  # the brake's part of it
    traction_torque: ca.SX
    moving: ca.SX


@dataclass(frozen=True)
class Wheelset:
    """One wheelset on a level rail."""

    rotation: Rotation
    creep_force: ca.SX
    sliding_speed: ca.SX


def start_bogie(
    name: str,
    description: str,
    defaults: BogieParameters,
    used: Sequence[str],
    unused_inputs: Sequence[str] = (),
    speed: float = 25.0,
) -> Bogie:
    """A System with the parameters named in `used` and of the rail's friction, and all inputs but some."""
    system = System(name, description)
    initial = system.parameter(variables.initial_speed(speed))
    parameter = {field: system.parameter(defaults.variable(field)) for field in used}
    symbols = {name: system.input(row) for name, row in variables.inputs().items() if name not in unused_inputs}
    rail = add_rail(system, [number for number in variables.WHEELSETS if f"friction_{number}" in symbols])
    return Bogie(system, parameter, symbols, variables.outputs(), initial, rail)


#: Inputs that only the spatial level has.
SPATIAL_INPUTS = ("yaw_torque_1", "yaw_torque_2")
#: Parameters that a wheelset on a level rail needs.
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


@dataclass(frozen=True)
class CentredContact:
    """Contact of a wheel that does not move sideways: G pi a b c11 / 4 of eq. (3.94) over N^(2/3) [N^(1/3)]."""

    stiffness: ca.SX


@dataclass(frozen=True)
class CentredLoad:
    """Vertical force of one rail N [N], and N^(1/3), with which the semi-axes grow, eq. (3.87)."""

    wheel: ca.SX
    growth: ca.SX


def follow_creep(bogie: Bogie, speed: str) -> None:
    """No step may change the state `speed` by more than half: the creepage (2.3) goes with its reciprocal.

    The error of a step says nothing of that: at the end of a stop the creep is so stiff that it is solved for at once,
    but with a Jacobian of another speed the force comes out wrong.
    """
    value, least = bogie.system.states[speed].symbol, bogie.parameter["creepage_speed"]
    bogie.system.limit_change(speed, ca.sqrt(value**2 + least**2) / 2)


def centred_contact(bogie: Bogie) -> CentredContact:
    """Factor of (3.94), with the ellipse of `ellipse_shape`: constant from the curvatures, computed once at the start.

    Not a number, so that a run is refused at its start, for an ellipse more slender than 1 : 10: on half-spaces, as
    Hertz and Kalker have them, no wheel touches a rail like that.
    """
    p = bogie.parameter
    shape = ellipse_shape(p["wheel_radius"], p["wheel_profile_curvature"], p["rail_head_radius"], p["shear_modulus"])
    slender = ca.fmax(shape.axis_ratio, 1 / shape.axis_ratio) > MOST_SLENDER
    c11 = ca.if_else(slender, math.nan, kalker_coefficients(shape.axis_ratio).c11)
    stiffness = 0.25 * ca.pi * p["shear_modulus"] * shape.longitudinal * shape.lateral * c11
    return CentredContact(bogie.system.derived("contact_stiffness", stiffness))


def centred_load(load: ca.SX) -> CentredLoad:
    """Of an axle that carries `load` [N], kept above zero for the creep law; growth as in (3.87)."""
    wheel = at_least(load / 2, SMALLEST_LOAD)
    return CentredLoad(wheel, wheel ** (1 / 3))


def rail_friction(bogie: Bogie, number: int, distance: ca.SX) -> ca.SX:
    """Friction coefficient without sliding, mu0 of Polach (2005), under a wheelset at a distance [m]."""
    return bogie.input[f"friction_{number}"] * bogie.rail.factor(number, distance)


def at_least(value: ca.SX, least: float) -> ca.SX:
    """The larger of both; as a comparison, which costs less in C than fmax."""
    return ca.if_else(value > least, value, least)


def creep_force_of_wheelset(
    bogie: Bogie, friction: ca.SX, contact: CentredContact, load: CentredLoad, sliding: ca.SX, forward: ca.SX
) -> ca.SX:
    """Longitudinal force of both rails on a wheelset that slides at `sliding` [m/s], (3.94), (3.97); friction: mu0."""
    # The corner of the absolute value is not felt: without sliding the force does not depend on friction.
    friction = at_least(friction * bogie.rail.remaining(ca.fabs(sliding)), SMALLEST_FRICTION)
    # Eq. (3.94) with the creepage over sqrt(V^2 + v_eps^2). All divisors in one: they are what this costs.
    divisor = friction * load.growth * ca.sqrt(forward**2 + bogie.parameter["creepage_speed"] ** 2)
    return 2 * saturated(contact.stiffness * sliding / divisor, friction * load.wheel, bogie.rail.reduction)


def add_wheelset(
    bogie: Bogie, number: int, contact: CentredContact, distance: ca.SX, forward: ca.SX, load: CentredLoad
) -> Wheelset:
    """A wheelset on a level rail, eq. (2.8); distance [m], forward [m/s]: of its axle along the track."""
    omega = add_rotation_states(bogie, number)
    radius = bogie.parameter["wheel_radius"]
    sliding = forward - radius * omega
    friction = rail_friction(bogie, number, distance)
    force = creep_force_of_wheelset(bogie, friction, contact, load, sliding, forward)
    return Wheelset(add_rotation(bogie, number, omega, -force * radius), force, sliding)


def add_rotation_states(bogie: Bogie, number: int) -> ca.SX:
    """Declares the rotation of a wheelset and returns its angular velocity, omega of (2.8); at the start it rolls."""
    start = bogie.initial_speed / bogie.parameter["wheel_radius"]
    bogie.system.state(f"rotation_{number}", "rad", 0.0, NOMINAL_ROTATION)
    return bogie.system.state(f"angular_velocity_{number}", "rad/s", start, NOMINAL_ANGULAR_VELOCITY)


def add_rotation(bogie: Bogie, number: int, omega: ca.SX, rail_torque: ca.SX) -> Rotation:
    """Rotation of one wheelset, third line of eq. (2.8): J dw/dt = F_x r - T_B, with traction and rolling resistance.

    rail_torque [N.m]: moment about the axle from the rails. The brake torque is a capacity: dry friction that opposes
    the rotation, or holds the wheelset locked while the rail cannot turn it.
    """
    system, parameter = bogie.system, bogie.parameter
    direction = system.direction(f"direction_{number}")
    brake = bogie.input[f"brake_torque_{number}"]
    capacity = brake + parameter["rolling_resistance_torque"]
    traction = bogie.input[f"traction_torque_{number}"]
    drive = traction + rail_torque
    # Sliding, the friction is the capacity; locked, it is whatever balances the drive, shared in proportion.
    moving = direction**2
    friction_torque = moving * direction * capacity + (1 - moving) * drive
    velocity = f"angular_velocity_{number}"
    system.derivative(f"rotation_{number}", omega)
    system.derivative(velocity, moving * (drive - direction * capacity) / parameter["wheelset_pitch_inertia"])
    system.dry_friction(Friction(f"Wheelset {number}", direction, velocity, drive, capacity, "locked", "turns again"))
    share = brake / ca.fmax(capacity, 1e-9)
    return Rotation(number, omega, friction_torque, share * friction_torque, traction, moving)


def add_wheelset_outputs(bogie: Bogie, rotation: Rotation, speed: ca.SX, creep_force: ca.SX, load: ca.SX) -> None:
    """Outputs of one wheelset; the slip ratio is (2.10), regularised as the creepage is."""
    system, number = bogie.system, rotation.number
    slip = speed - bogie.parameter["wheel_radius"] * rotation.angular_velocity
    rows = {
        "angular_velocity": rotation.angular_velocity,
        "rotation": system.states[f"rotation_{number}"].symbol,
        "slip": slip,
        "slip_ratio": creepage(slip, speed, bogie.parameter["creepage_speed"]),
        "creep_force": creep_force,
        "axle_load": load,
        "locked": 1 - rotation.moving,
    }
    for name, expression in rows.items():
        system.output(bogie.outputs[f"{name}_{number}"], expression)
