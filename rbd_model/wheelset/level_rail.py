"""A wheelset that rolls, skids or is locked on a level rail, its wheels centred: common parts of levels 1 and 2."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from fmu_src.symbols import ca
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import SMALLEST_FRICTION, SMALLEST_LOAD, at_least
from rbd_model.contact.creep.laws import DEFAULT_LAW, LAWS
from rbd_model.contact.creep.of_steel import law_of_ratio
from rbd_model.contact.creep.polach import saturated
from rbd_model.contact.creep_of_wheel import creep_of_wheel
from rbd_model.contact.friction import Surface
from rbd_model.contact.hertz import ellipse_shape
from rbd_model.track.line_table import mean_friction
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import Wheelset
from rbd_model.wheelset.rotation import Hold, RollingWheelset, add_rotation, add_rotation_states, rail_friction

#: Largest ratio of the semi-axes of a contact at the start of a run, the end of Kalker's table.
MOST_SLENDER = 10.0


@dataclass(frozen=True)
class CentredContact:
    """Contact of a wheel that does not move sideways: G pi a b c11 / 4 of eq. (3.94) over N^(2/3) [N^(1/3)]."""

    stiffness: ca.SX


@dataclass(frozen=True)
class CentredLoad:
    """Vertical force of one rail N [N], and N^(1/3), with which the semi-axes grow, eq. (3.87)."""

    wheel: ca.SX
    growth: ca.SX


def centred_contact(assembly: Assembly, wheelset: Wheelset) -> CentredContact:
    """Return the factor of (3.94), with the ellipse of `ellipse_shape`, computed from the curvatures at the start.

    It is not a number for an ellipse more slender than 1 : 10, so that a run is refused at its start. On half-spaces,
    as in Hertz and Kalker, no wheel has such a contact.
    """
    p, radius = assembly.parameter, wheelset.mean_radius
    same = next(number for number, other in assembly.vehicle.numbered if other.mean_radius == radius)
    name = f"contact_stiffness_{same}"
    if name not in assembly.system.derived_symbols:
        assembly.system.derived(name, contact_stiffness(assembly.value(radius), p, assembly.vehicle.poisson_ratio))
    return CentredContact(assembly.system.derived_symbols[name])


def contact_stiffness(radius: ca.SX, p: Mapping[str, ca.SX], poisson_ratio: float) -> ca.SX:
    """Return the factor of `CentredContact` [N^(1/3)] of (3.94).

    radius [m]: of the wheel; p: parameters of the vehicle.
    """
    curvatures = p["wheel_profile_curvature"], p["rail_head_radius"]
    shape = ellipse_shape(radius, *curvatures, p["shear_modulus"], poisson_ratio)
    slender = ca.fmax(shape.axis_ratio, 1 / shape.axis_ratio) > MOST_SLENDER
    c11 = ca.if_else(slender, math.nan, kalker_coefficients(shape.axis_ratio, poisson_ratio).c11)
    return 0.25 * ca.pi * p["shear_modulus"] * shape.longitudinal * shape.lateral * c11


def centred_load(load: ca.SX) -> CentredLoad:
    """Return the load of an axle that carries `load` [N], kept above zero for the creep law; growth as in (3.87)."""
    wheel = at_least(load / 2, SMALLEST_LOAD)
    return CentredLoad(wheel, wheel ** (1 / 3))


def creep_force_of_wheelset(
    assembly: Assembly, friction: ca.SX, contact: CentredContact, load: CentredLoad, sliding: ca.SX, forward: ca.SX
) -> ca.SX:
    """Return the longitudinal force of both rails on a wheelset, (3.94), (3.97).

    sliding [m/s]: its sliding speed; friction: mu0.
    """
    slowest = assembly.parameter["creepage_speed"]
    return centred_creep_force(assembly.rail.surface, friction, contact, load, (sliding, forward, slowest))


def centred_creep_force(
    surface: Surface,
    friction: ca.SX,
    contact: CentredContact,
    load: CentredLoad,
    speeds: tuple[ca.SX, ca.SX, ca.SX],
) -> ca.SX:
    """Return the same for a surface; (3.94), (3.97). speeds [m/s]: sliding, forward, and v_eps of the creepage."""
    sliding, forward, slowest = speeds
    # The corner of the absolute value has no effect: without sliding the force does not depend on friction.
    friction = at_least(friction * surface.remaining(ca.fabs(sliding)), SMALLEST_FRICTION)
    # Eq. (3.94) with the creepage over sqrt(V^2 + v_eps^2). All divisors are in one, because they take most of the
    # time.
    divisor = friction * load.growth * ca.sqrt(forward**2 + slowest**2)
    return 2 * saturated(contact.stiffness * sliding / divisor, friction * load.wheel, surface.reduction)


def creep_force_by_law(
    assembly: Assembly, wheelset: Wheelset, friction: ca.SX, load: CentredLoad, sliding: ca.SX, forward: ca.SX
) -> ca.SX:
    """Return the same by the vehicle's creep law, with curvatures (3.83) and the ellipse of `moving_ellipse`."""
    p = assembly.parameter
    slowness = 1 / ca.sqrt(forward**2 + p["creepage_speed"] ** 2)
    curvatures = (
        0.5 / assembly.radius(wheelset),
        0.5 * (1 / p["rail_head_radius"] + p["wheel_profile_curvature"]),
    )
    given = ca.vertcat(sliding, 0, 0, slowness, *curvatures, load.wheel, friction)
    constants = ca.vertcat(p["shear_modulus"], assembly.rail.surface.symbols)
    law = law_of_ratio(LAWS[assembly.vehicle.creep_law], assembly.vehicle.poisson_ratio)
    return 2 * assembly.chain.call(creep_of_wheel(law, "wheel"), given, constants)[0]


@dataclass(frozen=True)
class Creeping:
    """A wheelset that creeps on a level rail, eq. (2.8).

    rotated: its angle of rotation; sliding [m/s]; force [N]: of both rails; static [N]: the largest holding force.
    """

    number: int
    rotated: ca.SX
    angular_velocity: ca.SX
    sliding: ca.SX
    force: ca.SX
    static: ca.SX


def creep_on_level_rail(
    assembly: Assembly, number: int, distance: ca.SX, forward: ca.SX, load: CentredLoad, axle_load: ca.SX
) -> Creeping:
    """Return a wheelset on a level rail, eq. (2.8), with the states of its rotation.

    distance [m], forward [m/s]: of its axle; load: of each wheel; axle_load [N]: of both.
    """
    data = assembly.vehicle.wheelsets[number - 1]
    rotated, omega = add_rotation_states(assembly, number)
    sliding = forward - assembly.radius(data) * omega
    friction = rail_friction(assembly, number, distance)
    if assembly.on_line:
        friction = friction * mean_friction(assembly.system, distance)
    contact = centred_contact(assembly, data)
    if assembly.vehicle.creep_law == DEFAULT_LAW:
        force = creep_force_of_wheelset(assembly, friction, contact, load, sliding, forward)
    else:
        force = creep_force_by_law(assembly, data, friction, load, sliding, forward)
        force = ca.if_else(contact.stiffness > 0, force, math.nan)  # no wheel touches a rail like that
    return Creeping(number, rotated, omega, sliding, force, friction * axle_load)


def roll_on_level_rail(
    assembly: Assembly,
    creeping: Creeping,
    hold: Hold,
    axle: tuple[ca.SX, ca.SX],
    axle_load: ca.SX,
    held: ca.SX,
) -> RollingWheelset:
    """Add the rotation of a wheelset, third line of eq. (2.8).

    axle: displacement from its place in the vehicle [m] and speed [m/s]; held [N]: force of the rails that holds a
    standing axle, else 0.
    """
    number, data = creeping.number, assembly.vehicle.wheelsets[creeping.number - 1]
    turned, radius = (creeping.rotated, creeping.angular_velocity), assembly.radius(data)
    rotation = add_rotation(assembly, number, hold, turned, -creeping.force * radius, -held * radius)
    power = -creeping.force * creeping.sliding
    return RollingWheelset(number, data, rotation, *axle, creeping.force + held, axle_load, power)
