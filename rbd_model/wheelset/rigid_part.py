"""The contact of the thesis, model 1: the effect of two rails on a wheelset on straight track.

This includes constraints, creep, flange, and the wheelset's equations of motion without suspension.

Two contacts constrain six velocities. They are v_x, v_y, v_z in the axes of the track; omega_x, omega_y, omega_z in
those that yaw and roll with the wheelset. v_z and omega_x follow from the constraints at the level of velocities
(3.67). The normal forces follow from those of accelerations (3.71), roll and contact positions from the constraints
themselves.

All this is one part: generated once, called for each wheelset.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from fmu_src.chain import Bundle, Chain, Part, rows
from fmu_src.symbols import ca
from rbd_model.body.kinematics import axes_rate, direction_cosines, turned_by
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep_of_wheel import creep_of_wheel, how_it_slides
from rbd_model.wheelset.rigid_contact import WheelContact, wheel_contact
from rbd_model.wheelset.touch import SIDES, Pieces, Placement, Wheel


@dataclass(frozen=True)
class RollingState(Bundle):
    """Position and motion of a wheelset on its rails, and the rails' data there; pairs are (left, right)."""

    forward: ca.SX = rows(1)  # v_x [m/s]
    sideways: ca.SX = rows(1)  # v_y [m/s]
    yaw: ca.SX = rows(1)  # [rad]
    yaw_rate: ca.SX = rows(1)  # omega_z [rad/s]
    angular_velocity: ca.SX = rows(1)  # omega_y [rad/s]
    roll: ca.SX = rows(1)  # [rad]
    positions: ca.SX = rows(2)  # of the contacts on the wheels [m]
    normal_forces: ca.SX = rows(2)  # [N]
    offset: ca.SX = rows(1)  # lateral displacement from the track's centre [m]
    heights: ca.SX = rows(2)  # of the rails [m]
    slopes: ca.SX = rows(3)  # along the track, of its lateral position and of the heights [1]
    bends: ca.SX = rows(3)  # the same once more [1/m]
    frictions: ca.SX = rows(2)  # of the rails, without sliding [1]

    @property
    def placement(self) -> Placement:
        """Position and angles of the wheelset."""
        return Placement(self.yaw, self.roll, direction_cosines(self.yaw, self.roll), self.offset)


@dataclass(frozen=True)
class RollingConstants(Bundle):
    """Data that are constant while a wheelset rolls."""

    mass: ca.SX = rows(1)  # [kg]
    inertia: ca.SX = rows(3)  # [kg.m2]
    gravity: ca.SX = rows(1)  # [m/s2]
    radius: ca.SX = rows(2)  # of the wheels [m]
    half_distances: ca.SX = rows(2)  # of the wheels' and of the rails' y = 0 [m]
    creepage_speed: ca.SX = rows(1)  # [m/s]
    shear_modulus: ca.SX = rows(1)  # [Pa]
    surface: ca.SX = rows(5)
    flange_arm: ca.SX = rows(1)  # of the flange's force below the axle [m]
    flange_clearance: ca.SX = rows(1)  # [m]
    flange_stiffness: ca.SX = rows(1)  # [N/m]

    def wheel(self, index: int) -> Wheel:
        """The left (0) or the right wheel (1)."""
        side = list(SIDES)[index]
        return Wheel(ca.SX(side), self.radius[index], self.half_distances[0], self.half_distances[1])


@dataclass(frozen=True)
class RolledMotion(Bundle):
    """Effect of the rails on a wheelset, without its suspension."""

    height: ca.SX = rows(1)  # of its centre [m]
    rise: ca.SX = rows(1)  # v_z [m/s]
    roll_rate: ca.SX = rows(1)  # omega_x [rad/s]
    gap: ca.SX = rows(1)  # 0 where both wheels stand at one height [m]
    slope_errors: ca.SX = rows(2)  # 0 where wheel and rail have a common normal
    acceleration: ca.SX = rows(3)  # [m/s2]
    turning: ca.SX = rows(3)  # moments over inertia about x and z [rad/s2]; between them that about the axle [N.m]
    parting: ca.SX = rows(2)  # acceleration of each wheel away from its rail [m/s2]
    left_row: ca.SX = rows(5)  # of the constraint, on (v_x, v_y, v_z, omega_x, omega_z)
    right_row: ca.SX = rows(5)
    loads: ca.SX = rows(2)  # vertical forces of the rails [N]
    thrusts: ca.SX = rows(2)  # lateral forces on the rails' heads, outwards, without the flanges' [N]
    creep_along: ca.SX = rows(2)  # creep forces along the rails [N]
    creep_powers: ca.SX = rows(2)  # what all creep forces take [W]
    frictions: ca.SX = rows(2)  # coefficients that are left where the wheels slide [1]
    bends: ca.SX = rows(2)  # of the contacts [1/m], see `WheelContact`
    on_rails: ca.SX = rows(2)  # positions of the contacts on the rails [m]


@dataclass(frozen=True)
class RollingWheel:
    """One wheel: its contact, the constraint `row` on (v_x, v_y, v_z, omega_x, omega_z) and its rate, and forces."""

    contact: WheelContact
    row: ca.SX
    row_rate: ca.SX
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
        """Force on the wheelset, to the left [N]."""
        return self.push[1] - self.push[0]


@dataclass(frozen=True)
class OnRails:
    """A wheelset on its rails: velocity in the axes of the track, own axes and angular velocity in them, wheels."""

    height: ca.SX
    gap: ca.SX
    velocity: ca.SX
    axes: ca.SX
    own_rate: ca.SX
    wheels: tuple[RollingWheel, ...]
    flange: FlangePush


def meet_rails(
    chain: Chain, state: RollingState, fixed: RollingConstants, pieces: Sequence[Pieces], creep_law: CreepLaw
) -> OnRails:
    """Return the contacts of a wheelset and the forces there, by (3.54), (3.57), (3.67) and (3.82)-(3.106)."""
    placement = state.placement
    contacts = [
        wheel_contact(chain, placement, fixed.wheel(index), state.positions[index], piece)
        for index, piece in enumerate(pieces)
    ]
    heights = [contact.height + state.heights[i] for i, contact in enumerate(contacts)]
    axes = turned_by(placement.cosines)
    drifts = [rail_slopes(state.slopes, i) for i in range(len(SIDES))]
    row = [constraint_row(contact, drift) for contact, drift in zip(contacts, drifts, strict=True)]
    rise, roll_rate = dependent_velocities(row, state.forward, state.sideways, state.yaw_rate)
    height, rise, roll_rate = ca.vertsplit(chain.narrow(ca.vertcat((heights[0] + heights[1]) / 2, rise, roll_rate)))
    velocity = ca.vertcat(state.forward, state.sideways, rise)
    own_rate = ca.vertcat(roll_rate, state.angular_velocity, state.yaw_rate)
    turning = ca.vertcat(own_rate[2] / placement.cosines[2], own_rate[0])
    wheels = []
    for i, contact in enumerate(contacts):
        change = contact.rate(ca.vertcat(velocity[1] - drifts[i][0] * velocity[0], turning))
        bending = ca.dot(change[:2], drifts[i]) + ca.dot(contact.across, velocity[0] * rail_slopes(state.bends, i))
        constraint = row[i], ca.vertcat(-bending, change)
        moved = axes.T @ velocity + ca.cross(own_rate, contact.arm), own_rate
        wheels.append(roll_wheel(chain, state, fixed, i, contact, constraint, moved, creep_law))
    flange = push_flanges(fixed, state.offset, placement.cosines)
    return OnRails(height, heights[1] - heights[0], velocity, axes, own_rate, tuple(wheels), flange)


def constraint_row(contact: WheelContact, drift: ca.SX) -> ca.SX:
    """Return the row of a contact's motion along its normal, linear in (v_x, v_y, v_z, omega_x, omega_z), eq. (3.67).

    drift: slopes of the rail's section, sideways and upwards, as the wheelset moves along.
    """
    return ca.vertcat(-ca.dot(contact.across, drift), contact.across, contact.lever)


def dependent_velocities(row: Sequence[ca.SX], forward: ca.SX, sideways: ca.SX, yaw_rate: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return v_z [m/s] and omega_x [rad/s] from the two constraints: (3.115) solved for the dependent velocities."""
    left, right = (one[0] * forward + one[1] * sideways + one[4] * yaw_rate for one in row)
    inverse = 1 / (row[0][2] * row[1][3] - row[1][2] * row[0][3])
    rise = inverse * (row[0][3] * right - row[1][3] * left)
    return rise, inverse * (row[1][2] * left - row[0][2] * right)


def rail_slopes(slopes: ca.SX, index: int) -> ca.SX:
    """Return slopes, or bends, of the left (0) or right rail (1) along the track, sideways and upwards, section 5.3."""
    return ca.vertcat(slopes[0], slopes[1 + index])


def roll_wheel(
    chain: Chain,
    state: RollingState,
    fixed: RollingConstants,
    index: int,
    contact: WheelContact,
    constraint: tuple[ca.SX, ca.SX],
    moving: tuple[ca.SX, ca.SX],
    creep_law: CreepLaw,
) -> RollingWheel:
    """Return the left (0) or the right wheel with its creep, eqs (3.89)-(3.105).

    `constraint`: its row and its row's rate.

    moving: velocity at the contact [m/s] and angular velocity [rad/s], in the wheelset's own axes.
    """
    sliding, own_rate = moving
    directions = contact.along, contact.sideways, contact.normal
    slides = how_it_slides(sliding, own_rate, directions, state.forward, fixed.creepage_speed)
    curvatures = contact.curvature_along, contact.curvature_across
    normal_force = state.normal_forces[index]
    given = ca.vertcat(slides, *curvatures, normal_force, state.frictions[index])
    constants = ca.vertcat(fixed.shear_modulus, fixed.surface)
    along, sideways, friction = ca.vertsplit(chain.call(creep_of_wheel(creep_law, "wheel"), given, constants))
    power = -along * slides[0] - sideways * slides[1]
    return RollingWheel(contact, *constraint, friction, normal_force, along, sideways, power)


def push_flanges(fixed: RollingConstants, offset: ca.SX, cosines: ca.SX) -> FlangePush:
    """Return the lateral push of the rails on the flanges, eq. (3.106), at the gauge face or at the wheelset's centre.

    offset [m]: of the wheelset's centre from that of the track; cosines: the wheelset's `direction_cosines`. The centre
    is the thesis's point of action. The other, flange_at_rail 1, differs from it: the force acts at the gauge face, a
    wheel radius and the flange's depth below the axle. It presses the flanging wheel down and lifts the other one, each
    by force x arm over the distance of the contacts. The displacement at the rail is then that at the gauge face,
    including roll, so that the spring returns its energy. The clearance remains the displacement of a centre on level
    track. The vertical part of a flange's force is not included, as in (3.106).
    """
    displacement = offset + fixed.flange_arm * cosines[3]
    left = ca.fmax(displacement - fixed.flange_clearance, 0)
    right = ca.fmax(-displacement - fixed.flange_clearance, 0)
    push = fixed.flange_stiffness * left, fixed.flange_stiffness * right
    moment = (push[1] - push[0]) * fixed.flange_arm * cosines[2]
    return FlangePush(push, moment, (push[0] * left + push[1] * right) / 2)


@lru_cache
def rolling_wheelset(wheel_terms: int, rail_terms: int, creep_law: CreepLaw) -> Part:
    """Return the part for a `RolledMotion` of a `RollingState`, (3.67), (3.71), (3.73): from two rails to the
    suspension.

    Constants: `RollingConstants`, then the pieces of both profiles with `wheel_terms` and `rail_terms` terms, left
    wheel first.
    """
    state, fixed, chain = RollingState.symbols("state"), RollingConstants.symbols("constants"), Chain()
    pieces = [Pieces(ca.SX.sym("wheel", wheel_terms), ca.SX.sym("rail", rail_terms)) for _ in SIDES]
    constants = ca.vertcat(fixed.vector, *[piece.vector for piece in pieces])
    results = roll_freely(chain, meet_rails(chain, state, fixed, pieces, creep_law), fixed).vector
    return Part(f"wheelset_{wheel_terms}_{rail_terms}", state.vector, constants, results, chain)


def roll_freely(chain: Chain, wheelset: OnRails, fixed: RollingConstants) -> RolledMotion:
    """Return Newton's and Euler's equations of a wheelset on its rails, as (3.73), and its parting from them, (3.71).

    This differs from the thesis, which has Euler parameters. The axes here yaw and roll with the wheelset, so that its
    inertia is constant.
    """
    rate = wheelset.own_rate
    force = ca.vertcat(0, wheelset.flange.force, -fixed.mass * fixed.gravity)
    own_axes = axes_rate(wheelset.axes[2, 1] / wheelset.axes[2, 2], rate)
    moment = ca.vertcat(wheelset.flange.moment, 0, 0) - ca.cross(own_axes, fixed.inertia * rate)
    for wheel in wheelset.wheels:
        contact = wheel.contact
        creep = wheel.creep_along * contact.along + wheel.creep_sideways * contact.sideways
        across = wheel.creep_sideways * ca.vertcat(contact.across[1], -contact.across[0])
        force = force + ca.vertcat(wheel.creep_along, across) + wheel.normal_force * wheel.row[:3]
        lever = ca.vertcat(contact.lever[0], 0, contact.lever[1])
        moment = moment + ca.cross(contact.arm, creep) + wheel.normal_force * lever
    every = ca.vertcat((1 / fixed.mass) * force, moment[0] / fixed.inertia[0], moment[1], moment[2] / fixed.inertia[2])
    acceleration, turning = ca.vertsplit(chain.narrow(every), 3)
    velocities = ca.vertcat(wheelset.velocity, rate[0], rate[2])
    accelerations = ca.vertcat(acceleration, turning[0], turning[2])
    parting = [ca.dot(wheel.row, accelerations) + ca.dot(wheel.row_rate, velocities) for wheel in wheelset.wheels]
    left, right = wheelset.wheels

    def both(name: str) -> ca.SX:
        return ca.vertcat(*[getattr(wheel, name) for wheel in wheelset.wheels])

    return RolledMotion(
        wheelset.height,
        wheelset.velocity[2],
        rate[0],
        wheelset.gap,
        ca.vertcat(left.contact.slope_error, right.contact.slope_error),
        acceleration,
        turning,
        ca.vertcat(*parting),
        left.row,
        right.row,
        both("load"),
        both("thrust"),
        both("creep_along"),
        both("creep_power"),
        both("friction"),
        ca.vertcat(left.contact.bend, right.contact.bend),
        ca.vertcat(left.contact.on_rail, right.contact.on_rail),
    )


def nadal_limit(angle: float, friction: ca.SX) -> ca.SX:
    """Return the largest Y/Q at which a wheel does not climb on a flange with this angle [rad].

    Nadal (1896), Annales des Mines 10: a flange that slides down carries Y and Q at its angle less that of friction.
    """
    return (math.tan(angle) - friction) / (1 + math.tan(angle) * friction)
