"""One wheelset in space: constraints, creep, flange, brake, and its equations of motion.

Six velocities (v_x, v_y, v_z in the axes of the track; omega_x, omega_y, omega_z in those that yaw and roll with the
wheelset) are bound by two contacts. v_z and omega_x follow from the constraints at the level of velocities (3.67), the
normal forces from those of accelerations (3.71); roll and contact positions from the constraints themselves.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from fmu_src.chain import Part
from rbd_model.adhesion import Surface
from rbd_model.assembly import Assembly
from rbd_model.bodies import add_shift, first_distance
from rbd_model.connections import Load
from rbd_model.contact import moving_ellipse
from rbd_model.contact_geometry import Flange, flange_of
from rbd_model.creep import polach_forces, smooth_kalker_coefficients
from rbd_model.kinematics import Body, axes_rate, yaw_roll
from rbd_model.rolling_contact import SIDES, Placement, WheelContact, wheel_contact
from rbd_model.track import Section
from rbd_model.vehicle import Wheelset
from rbd_model.wheelset import (
    NOMINAL_TRAVEL,
    NOMINAL_TRAVEL_SPEED,
    SMALLEST_FRICTION,
    SMALLEST_LOAD,
    Rotation,
    add_rotation,
    add_rotation_states,
    at_least,
    rail_friction,
)

#: Scales of the error control: with tolerance 1e-7, 0.1 nm at the contact, 0.1 nrad of roll and 0.01 N.
NOMINAL_CONTACT = 1e-3
NOMINAL_ROLL = 1e-3
NOMINAL_NORMAL_FORCE = 1e5
#: Share of the rail head's curvature that is left when a tread contact counts as lost. The fold is where nothing is
#: left; there the contact moves infinitely fast.
FOLD_MARGIN = 0.02
#: Distance from the end of a profile at which a contact counts as run off it [m]; beyond the end there is no contact.
END_MARGIN = 1e-3
#: Smallest sliding speed that is told from none [m/s]; the falling friction is smooth through zero on this scale.
SLIDING_FLOOR = 1e-9


@dataclass(frozen=True)
class Wheel:
    """One wheel: its contact, the constraint `row` on (v_x, v_y, v_z, omega_x, omega_z) and its rate, and forces."""

    contact: WheelContact
    row: ca.SX
    row_rate: ca.SX
    curvature_left: ca.SX  # share of the rail head's curvature that keeps the contact; 0 at the fold
    friction: ca.SX
    normal_force: ca.SX
    creep_along: ca.SX  # creep force on the wheel along the rail [N]
    creep_sideways: ca.SX  # and to the left
    creep_power: ca.SX  # what both take [W]

    @property
    def load(self) -> ca.SX:
        """Vertical force of the rail [N]."""
        return self.normal_force * self.contact.across[1] - self.creep_sideways * self.contact.across[0]

    @property
    def derailed(self) -> tuple[tuple[ca.SX, str], ...]:
        """What ends its contact: margins, negative when it is lost, and what the wheel has then done."""
        return (
            (self.curvature_left - FOLD_MARGIN, "lost its tread contact"),
            (self.contact.inside / END_MARGIN - 1, "ran off the end of its tread or of the rail's head"),
        )

    @property
    def thrust(self) -> ca.SX:
        """Lateral force on the rail's head, away from the track's centre [N]."""
        across = self.contact.across
        return -self.contact.side * (self.normal_force * across[0] + self.creep_sideways * across[1])


@dataclass(frozen=True)
class FlangePush:
    """Push of the rails on the flanges of the (left, right) wheel towards the track's centre [N], and what it stores.

    moment [N.m]: about the wheelset's own forward axis; potential [J].
    """

    push: tuple[ca.SX, ca.SX]
    moment: ca.SX
    potential: ca.SX

    @property
    def force(self) -> ca.SX:
        """On the wheelset, to the left [N]."""
        return self.push[1] - self.push[0]


@dataclass(frozen=True)
class SpatialWheelset:
    """What a wheelset is and does before its forces are added up; `number` is from 1, wheels are (left, right).

    The body's own axes are those that yaw and roll with the wheelset.
    """

    number: int
    data: Wheelset
    body: Body
    roll: ca.SX
    offset: ca.SX  # lateral displacement from the track's centre [m]
    wheels: tuple[Wheel, Wheel]
    flange: FlangePush


@dataclass(frozen=True)
class Motion:
    """What the forces do: longitudinal acceleration [m/s2], rotation, power of the yaw torque [W]."""

    acceleration: ca.SX
    rotation: Rotation
    yaw_power: ca.SX


def place_wheelset(assembly: Assembly, number: int, section: Callable[[int, ca.SX], Section]) -> SpatialWheelset:
    """Declares the states of a wheelset and finds its contacts, by (3.54), (3.57).

    section: the track by wheelset and distance. The static load is the guess for the normal forces.
    """
    system, p, data = assembly.system, assembly.parameter, assembly.vehicle.wheelsets[number - 1]
    shift, forward = add_shift(assembly, f"shift_{number}", f"shift_speed_{number}")
    lateral = system.state(f"lateral_{number}", "m", p["initial_lateral"], NOMINAL_TRAVEL)
    lateral_speed = system.state(f"lateral_speed_{number}", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    yaw = system.state(f"yaw_{number}", "rad", p["initial_yaw"], NOMINAL_TRAVEL)
    yaw_rate = system.state(f"yaw_rate_{number}", "rad/s", 0.0, NOMINAL_TRAVEL_SPEED)
    omega = add_rotation_states(assembly, number)
    roll = system.algebraic(f"roll_{number}", "rad", 0.0, NOMINAL_ROLL)
    positions = [
        system.algebraic(f"contact_{number}_{word}", "m", -side * p["initial_lateral"], NOMINAL_CONTACT)
        for side, word in SIDES.items()
    ]
    static_load = assembly.resting_on(number) / 2 + assembly.value(data.mass) * p["gravity"] / 2
    normals = [
        system.algebraic(f"normal_{number}_{word}", "N", static_load, NOMINAL_NORMAL_FORCE) for word in SIDES.values()
    ]

    along = assembly.value(data.along) + shift
    distance = first_distance(assembly) + along
    track = section(number, distance)
    offset = lateral - track.lateral
    contacts = []
    for (side, word), radius, position in zip(SIDES.items(), data.radius, positions, strict=True):
        placement = Placement(yaw, roll, offset, assembly.value(radius))
        contacts.append(wheel_contact(system, f"{number}_{word}", data.pair, placement, side, position))
    heights = [contacts[0].height + track.left, contacts[1].height + track.right]
    system.residual(f"roll_{number}", heights[1] - heights[0])
    for word, contact in zip(SIDES.values(), contacts, strict=True):
        system.residual(f"contact_{number}_{word}", contact.slope_error)

    system.limit_change(f"{assembly.vehicle.bodies[0].name}_distance", 1 / track.density)
    friction = rail_friction(assembly, number, distance) * track.friction
    rails = [ca.vertcat(track.lateral, rail) for rail in (track.left, track.right)]
    drifts = [ca.jacobian(rail, first_distance(assembly)) for rail in rails]
    rows = [constraint_row(contact, drift) for contact, drift in zip(contacts, drifts, strict=True)]
    height = (heights[0] + heights[1]) / 2
    rise, roll_rate = dependent_velocities(rows, forward, lateral_speed, yaw_rate)
    height, rise, roll_rate = ca.vertsplit(system.narrow(ca.vertcat(height, rise, roll_rate)))
    body = Body(
        ca.vertcat(along, lateral, height),
        ca.vertcat(forward, lateral_speed, rise),
        yaw_roll(yaw, roll),
        ca.vertcat(roll_rate, omega, yaw_rate),
        ca.vertcat(roll, 0, yaw),
    )
    turning = ca.vertcat(yaw_rate / ca.cos(roll), roll_rate)
    wheels = []
    for contact, drift, normal in zip(contacts, drifts, normals, strict=True):
        change = ca.jacobian(drift, first_distance(assembly)) * forward
        moving = contact.rate(ca.vertcat(lateral_speed - drift[0] * forward, turning))
        row_rate = ca.vertcat(-ca.dot(moving[:2], drift) - ca.dot(contact.across, change), moving)
        row = constraint_row(contact, drift)
        wheels.append(roll_wheel(assembly, body, contact, (row, row_rate), normal, friction))
    for name, derivative in (("lateral", lateral_speed), ("yaw", turning[0])):
        system.derivative(f"{name}_{number}", derivative)
    pushed = push_flanges(assembly, data, flange_of(data.pair), offset, roll)
    return SpatialWheelset(number, data, body, roll, offset, (wheels[0], wheels[1]), pushed)


def constraint_row(contact: WheelContact, drift: ca.SX) -> ca.SX:
    """A contact's motion along its normal, linear in (v_x, v_y, v_z, omega_x, omega_z), eq. (3.67).

    drift: slopes of the rails' section, sideways and upwards, as the wheelset moves along.
    """
    return ca.vertcat(-ca.dot(contact.across, drift), contact.across, contact.lever)


def dependent_velocities(rows: list[ca.SX], forward: ca.SX, sideways: ca.SX, yaw_rate: ca.SX) -> tuple[ca.SX, ca.SX]:
    """v_z [m/s] and omega_x [rad/s] from the two constraints: (3.115) solved for the dependent velocities."""
    left, right = (row[0] * forward + row[1] * sideways + row[4] * yaw_rate for row in rows)
    inverse = 1 / (rows[0][2] * rows[1][3] - rows[1][2] * rows[0][3])
    rise = inverse * (rows[0][3] * right - rows[1][3] * left)
    return rise, inverse * (rows[1][2] * left - rows[0][2] * right)


@lru_cache
def creep_of_wheel() -> Part:
    """Creep forces of one wheel [N] and the friction that is left, eqs (3.82)-(3.105) and the law of `Surface`.

    Of what it slides along and across [m/s], its spin [rad/s], the reciprocal of its speed [s/m], both curvatures
    [1/m], normal force [N] and friction without sliding; constants: shear modulus [Pa] and surface.
    """
    given, constants = ca.SX.sym("given", 8), ca.SX.sym("constants", 6)
    slide_x, slide_y, spin, slowness, along_rail, across_rail, normal_force, friction = ca.vertsplit(given)
    modulus, *law = ca.vertsplit(constants)
    surface = Surface(*law)
    load = at_least(normal_force, SMALLEST_LOAD)
    sliding_speed = ca.sqrt(slide_x**2 + slide_y**2 + SLIDING_FLOOR**2)
    friction = at_least(friction * surface.remaining(sliding_speed), SMALLEST_FRICTION)
    logarithm, semi_axis = moving_ellipse(along_rail, across_rail, load, modulus)
    stretch = ca.exp(logarithm / 2)
    creepages = (slide_x * slowness, slide_y * slowness, spin * slowness)
    axes, kalker = (semi_axis * stretch, semi_axis / stretch), smooth_kalker_coefficients(logarithm)
    forces = polach_forces(creepages, load, friction, axes, modulus, kalker, surface.reduction)
    return Part("creep", given, constants, ca.vertcat(*forces, friction))


def roll_wheel(
    assembly: Assembly,
    body: Body,
    contact: WheelContact,
    constraint: tuple[ca.SX, ca.SX],
    normal_force: ca.SX,
    friction: ca.SX,
) -> Wheel:
    """Creep of one wheel, eqs (3.89)-(3.105); `constraint`: its row and the rate of that, for (3.71).

    friction: the coefficient without sliding.
    """
    p = assembly.parameter
    sliding = body.axes.T @ body.velocity + ca.cross(body.own_rate, contact.arm)
    slides = ca.dot(sliding, contact.along), ca.dot(sliding, contact.sideways)
    slowness = 1 / ca.sqrt(body.velocity[0] ** 2 + p["creepage_speed"] ** 2)
    # Kalker's law is for axes that look ahead. Rolling backwards these are turned half round about the normal: the
    # force of spin turns with them, while that of sliding opposes the sliding either way.
    # Over v_eps it changes from one to the other: a jump at rest would have no solution.
    ahead = ca.fmax(ca.fmin(body.velocity[0] / p["creepage_speed"], 1), -1)
    spin = ahead * ca.dot(body.own_rate, contact.normal)
    curvatures = contact.curvature_along, contact.curvature_across
    given = ca.vertcat(*slides, spin, slowness, *curvatures, normal_force, friction)
    constants = ca.vertcat(p["shear_modulus"], assembly.rail.surface.symbols)
    along, sideways, friction = ca.vertsplit(assembly.system.call(creep_of_wheel(), given, constants))

    power = -along * slides[0] - sideways * slides[1]
    curvature_left = contact.bend * p["rail_head_radius"]
    return Wheel(contact, *constraint, curvature_left, friction, normal_force, along, sideways, power)


def move_wheelset(assembly: Assembly, wheelset: SpatialWheelset, suspension: Load, first_acceleration: ca.SX) -> Motion:
    """Newton's and Euler's equations of a wheelset, as (3.73), and the accelerations of its constraints, (3.71).

    first_acceleration [m/s2]: of the vehicle's first body along the track.
    Differs from the thesis, which has Euler parameters: about axes that yaw and roll with the wheelset, in which its
    inertia is constant. The yaw torque acts about the upright one of these, as the couple of the shoe forces (9.1)
    does, which are square to the axle; the vertical of the track, the other reading, is a roll (1e-3) away and would
    turn the axle by its sine. About an axis that turns with the wheelset's rotation as well when yaw_torque_rotates is
    1, which the body's matrix in place of the global one in (3.36) does.
    """
    system, p, number = assembly.system, assembly.parameter, wheelset.number
    mass = assembly.value(wheelset.data.mass)
    inertia = ca.vertcat(*[assembly.value(size) for size in wheelset.data.inertia])
    force = suspension.force + ca.vertcat(0, wheelset.flange.force, -mass * p["gravity"])
    moment = wheelset.body.axes.T @ suspension.moment + ca.vertcat(wheelset.flange.moment, 0, 0)
    rate = wheelset.body.own_rate
    moment = moment - ca.cross(axes_rate(wheelset.roll, rate), inertia * rate)
    for wheel in wheelset.wheels:
        contact, row = wheel.contact, wheel.row
        creep = wheel.creep_along * contact.along + wheel.creep_sideways * contact.sideways
        across = wheel.creep_sideways * ca.vertcat(contact.across[1], -contact.across[0])
        force = force + ca.vertcat(wheel.creep_along, across) + wheel.normal_force * row[:3]
        moment = (
            moment
            + ca.cross(contact.arm, creep)
            + wheel.normal_force * ca.vertcat(contact.lever[0], 0, contact.lever[1])
        )
    angle = p["yaw_torque_rotates"] * system.states[f"rotation_{number}"].symbol
    yaw_torque = assembly.input[f"yaw_torque_{number}"] * ca.vertcat(ca.sin(angle), 0, ca.cos(angle))

    turning = (1 / inertia) * (moment + yaw_torque)
    every = system.narrow(ca.vertcat((1 / mass) * force, turning[0], moment[1], turning[2]))
    acceleration, turning = every[:3], ca.vertcat(every[3], 0, every[5])
    rotation = add_rotation(assembly, number, rate[1], every[4])
    system.derivative(f"shift_speed_{number}", acceleration[0] - first_acceleration)
    system.derivative(f"lateral_speed_{number}", acceleration[1])
    system.derivative(f"yaw_rate_{number}", turning[2])
    velocities = ca.vertcat(wheelset.body.velocity, rate[0], rate[2])
    accelerations = ca.vertcat(acceleration, turning[0], turning[2])
    for wheel, word in zip(wheelset.wheels, SIDES.values(), strict=True):
        residual = ca.dot(wheel.row, accelerations) + ca.dot(wheel.row_rate, velocities)
        system.residual(f"normal_{number}_{word}", system.narrow(mass * residual))
    return Motion(acceleration[0], rotation, ca.dot(yaw_torque, rate))


def push_flanges(assembly: Assembly, data: Wheelset, geometry: Flange, offset: ca.SX, roll: ca.SX) -> FlangePush:
    """Lateral push of the rails on the flanges, eq. (3.106), where they touch or, as printed, at the wheelset's centre.

    offset [m]: of the wheelset's centre from that of the track.
    Differs from the thesis with flange_at_rail 1: the force acts at the gauge face, a wheel radius and the flange's
    depth below the axle, so that it presses the flanging wheel down and lifts the other one, each by force x arm over
    the distance of the contacts; and what meets the rail is the displacement down there, to which the roll adds, so
    that the spring gives back what it took. The clearance stays the displacement of a centre on level track. The
    vertical part of a flange's force is missing here as it is in (3.106).
    """
    p = assembly.parameter
    arm = p["flange_at_rail"] * (assembly.radius(data) + geometry.depth)
    displacement = offset + arm * ca.sin(roll)
    clearance = p["flange_clearance"] * (1 + arm * geometry.roll_by_shift)
    left, right = ca.fmax(displacement - clearance, 0), ca.fmax(-displacement - clearance, 0)
    push = p["flange_stiffness"] * left, p["flange_stiffness"] * right
    moment = (push[1] - push[0]) * arm * ca.cos(roll)
    return FlangePush(push, moment, (push[0] * left + push[1] * right) / 2)


def nadal_limit(angle: float, friction: ca.SX) -> ca.SX:
    """Largest Y/Q of a wheel that does not climb on a flange with this angle [rad].

    Nadal (1896), Annales des Mines 10: a flange that slides down carries Y and Q at its angle less that of friction.
    """
    return (math.tan(angle) - friction) / (1 + math.tan(angle) * friction)
