"""What two rails do to a wheelset in space: constraints, creep, flange, and its equations of motion without suspension.

Six velocities (v_x, v_y, v_z in the axes of the track; omega_x, omega_y, omega_z in those that yaw and roll with the
wheelset) are bound by two contacts. v_z and omega_x follow from the constraints at the level of velocities (3.67), the
normal forces from those of accelerations (3.71); roll and contact positions from the constraints themselves.

All this is one part: generated once, called for each wheelset.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca

from fmu_src.chain import Bundle, Chain, Part, rows
from fmu_src.system import LINE_COLUMNS, polynomials
from rbd_model.body.kinematics import axes_rate, direction_cosines, turned_by
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep_of_wheel import creep_of_wheel, how_it_slides
from rbd_model.track.frame import LEVEL, Course
from rbd_model.wheelset.rigid_contact import SIDES, Pieces, Placement, Wheel, WheelContact, wheel_contact


@dataclass(frozen=True)
class RollingState(Bundle):
    """How a wheelset stands and moves on its rails, with what of these it feels there; pairs are (left, right)."""

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
        """Where the wheelset stands."""
        return Placement(self.yaw, self.roll, direction_cosines(self.yaw, self.roll), self.offset)

    def placed_over(self, side: int, spread: ca.SX) -> Placement:
        """Where it stands over the left (1) or the right rail (-1), which is `spread` further outwards [m]."""
        return replace(self.placement, lateral=self.offset - side * spread)


@dataclass(frozen=True)
class OnLine(Bundle):
    """Where a wheelset is on a line, beside its `RollingState`: distance and lateral position from its centre."""

    distance: ca.SX = rows(1)  # [m]
    lateral: ca.SX = rows(1)  # [m]


@dataclass(frozen=True)
class LinePieces(Bundle):
    """Pieces of a line where a wheelset is, (origin, c0 ...), as `System.line_piece` has them."""

    heading: ca.SX = rows(2 + LINE_COLUMNS["heading"])
    rise: ca.SX = rows(2 + LINE_COLUMNS["rise"])
    cant: ca.SX = rows(2 + LINE_COLUMNS["cant"])
    spread: ca.SX = rows(2 + LINE_COLUMNS["spread"])


@dataclass(frozen=True)
class TrackThere:
    """How the track turns and widens where a wheelset is; straight track does neither.

    turning, turning_rate: as in `TrackFrame`, and its change along the line [rad/m], [rad/m2]; up: in the axes of the
    track; lateral [m]: the wheelset's from their origin; spread [m]: of each rail, outwards, and its slope and bend.
    """

    turning: ca.SX
    turning_rate: ca.SX
    up: ca.SX
    lateral: ca.SX
    spread: tuple[ca.SX, ca.SX, ca.SX]

    @classmethod
    def straight(cls) -> TrackThere:
        """Straight and level track."""
        none = ca.SX.zeros(3)
        return cls(none, none, LEVEL.up, ca.SX(0), (ca.SX(0), ca.SX(0), ca.SX(0)))

    @classmethod
    def of(cls, place: OnLine, pieces: LinePieces) -> TrackThere:
        """Of the pieces of a line, section 3.2.2."""
        _, curvature = polynomials(pieces.heading, place.distance, 1)
        _, sine, steepening = polynomials(pieces.rise, place.distance, 2)
        cant, twist = polynomials(pieces.cant, place.distance, 1)
        course = Course(curvature, sine, cant, steepening, twist)
        spread, slope, bend = polynomials(pieces.spread, place.distance, 2)
        bends = ca.jacobian(course.turning, place.distance)
        return cls(course.turning, bends, course.tilt[2, :].T, place.lateral, (spread, slope, bend))


@dataclass(frozen=True)
class RollingConstants(Bundle):
    """What does not change while a wheelset rolls."""

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
    """What the rails make of a wheelset, which its suspension adds to."""

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
    thrusts: ca.SX = rows(
        2
    )  # lateral forces on the rails' heads, away from the track's centre, without the flanges' [N]
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
        """On the wheelset, to the left [N]."""
        return self.push[1] - self.push[0]


@dataclass(frozen=True)
class OnRails:
    """A wheelset on its rails: velocity in the axes of the track, own axes and angular velocity in them, wheels."""

    height: ca.SX
    gap: ca.SX
    velocity: ca.SX
    axes: ca.SX
    own_rate: ca.SX
    spin: ca.SX  # of the axes of the track [rad/s]
    up: ca.SX  # in the axes of the track
    wheels: tuple[RollingWheel, ...]
    flange: FlangePush
    dragging: ca.SX  # of the flanges, along the track [N]


def meet_rails(
    chain: Chain,
    state: RollingState,
    there: TrackThere,
    fixed: RollingConstants,
    pieces: Sequence[Pieces],
    creep_law: CreepLaw,
) -> OnRails:
    """Contacts of a wheelset and what acts there, by (3.54), (3.57), (3.67) and (3.82)-(3.106)."""
    placements = [state.placed_over(side, there.spread[0]) for side in SIDES]
    cosines = placements[0].cosines
    contacts = [
        wheel_contact(chain, placements[i], fixed.wheel(i), state.positions[i], piece) for i, piece in enumerate(pieces)
    ]
    heights = [contact.height + state.heights[i] for i, contact in enumerate(contacts)]
    axes = turned_by(cosines)
    moving = MovingTrack(there, axes, (heights[0] + heights[1]) / 2)
    drifts = [rail_slopes(side, state.slopes, i, there.spread[1]) for i, side in enumerate(SIDES)]
    row = [moving.constraint_row(contact, drift) for contact, drift in zip(contacts, drifts, strict=True)]
    rise, roll_rate = dependent_velocities(row, state.forward, state.sideways, state.yaw_rate)
    height, rise, roll_rate = ca.vertsplit(chain.narrow(ca.vertcat((heights[0] + heights[1]) / 2, rise, roll_rate)))
    velocity = ca.vertcat(state.forward, state.sideways, rise)
    own_rate = ca.vertcat(roll_rate, state.angular_velocity, state.yaw_rate)
    rates = moving.rates(velocity, own_rate, cosines)
    wheels = []
    for i, (side, contact) in enumerate(zip(SIDES, contacts, strict=True)):
        change = contact.rate(ca.vertcat(rates.lateral - drifts[i][0] * rates.travel, rates.turning))
        bend = rail_slopes(side, state.bends, i, there.spread[2])
        row_rate = moving.row_rate(contact, change, row[i][0], drifts[i], bend, rates)
        sliding = axes.T @ velocity + ca.cross(own_rate, contact.arm)
        moved = sliding, own_rate
        wheels.append(roll_wheel(chain, state, fixed, i, contact, (row[i], row_rate), moved, creep_law))
    flange = push_flanges(fixed, state.offset, there.spread[0], cosines)
    gap, dragging = heights[1] - heights[0], moving.dragging(flange, drifts)
    return OnRails(height, gap, velocity, axes, own_rate, rates.spin, there.up, tuple(wheels), flange, dragging)


def rail_slopes(side: int, slopes: ca.SX, index: int, spreading: ca.SX) -> ca.SX:
    """Slopes of a rail's section along the track, sideways and upwards (section 5.3); or, of bends, its bends."""
    return ca.vertcat(slopes[0] + side * spreading, slopes[1 + index])


@dataclass(frozen=True)
class Rates:
    """How a wheelset moves against axes of the track that go along with it.

    travel [m/s]: of these axes along the line; lateral, rise [m/s]; turning: of yaw and roll [rad/s]; spin: of the axes
    [rad/s]; relative: angular velocity against them, in the axes that yaw and roll with the wheelset.
    """

    travel: ca.SX
    lateral: ca.SX
    rise: ca.SX
    turning: ca.SX
    spin: ca.SX
    relative: ca.SX


@dataclass(frozen=True)
class MovingTrack:
    """The axes of the track under a wheelset, which turn as it goes along the line, in its constraints (3.67), (3.71).

    A contact's motion along its normal is linear in (v_x, v_y, v_z, omega_x, omega_z), which are inertial. In axes that
    go along with v_x / stretch and turn by `turning` for each metre of it, lateral position and height change by
    v - spin x (0, y, z), yaw and roll by omega - spin: so the first entry of the row holds what the axes take away.
    The axes are those of `axes`, the wheelset's own that yaw and roll with it.
    """

    there: TrackThere
    axes: ca.SX
    height: ca.SX

    @property
    def stretch(self) -> ca.SX:
        """Way of the wheelset's centre for each metre along the line [1], as `Body.stretch`."""
        turning = self.there.turning
        return 1 + turning[1] * self.height - turning[2] * self.there.lateral

    @property
    def own_turning(self) -> ca.SX:
        """The turning of the track in the wheelset's axes [rad/m]."""
        return self.axes.T @ self.there.turning

    def carried(self, drift: ca.SX) -> tuple[ca.SX, ca.SX]:
        """What the axes take from the motion, for each metre: of sideways and upwards; of omega_x and omega_z.

        drift: slopes of the rails' section.
        """
        twist = self.there.turning[0]
        sections = drift + twist * ca.vertcat(-self.height, self.there.lateral)
        turned = self.own_turning
        return sections, ca.vertcat(turned[0], turned[2])

    def constraint_row(self, contact: WheelContact, drift: ca.SX) -> ca.SX:
        """A contact's motion along its normal, linear in (v_x, v_y, v_z, omega_x, omega_z), eq. (3.67).

        drift: slopes of the rails' section, sideways and upwards, as the wheelset moves along.
        """
        sections, turned = self.carried(drift)
        first = -(ca.dot(contact.across, sections) + ca.dot(contact.lever, turned)) / self.stretch
        return ca.vertcat(first, contact.across, contact.lever)

    def dragging(self, flange: FlangePush, drifts: Sequence[ca.SX]) -> ca.SX:
        """Force along the track of flanges that press (3.106), so that on a line they give back what they took [N].

        Their rails move sideways and turn against a wheelset that goes along. On straight track there is none, as
        printed: what an irregularity of it would take is left out.
        """
        if self.there.turning.is_zero():
            return ca.SX(0)
        (left, turned), (right, _) = (self.carried(drift) for drift in drifts)
        pushed = flange.push[0] * left[0] - flange.push[1] * right[0] - flange.moment * turned[0]
        return pushed / self.stretch

    def rates(self, velocity: ca.SX, own_rate: ca.SX, cosines: ca.SX) -> Rates:
        """The motion against the axes of the track, eq. (3.12)."""
        travel = velocity[0] / self.stretch
        twist = travel * self.there.turning[0]
        relative = own_rate - travel * self.own_turning
        return Rates(
            travel,
            velocity[1] + twist * self.height,
            velocity[2] - twist * self.there.lateral,
            ca.vertcat(relative[2] / cosines[2], relative[0]),
            travel * self.there.turning,
            relative,
        )

    def row_rate(
        self, contact: WheelContact, change: ca.SX, first: ca.SX, drift: ca.SX, bend: ca.SX, rates: Rates
    ) -> ca.SX:
        """Rate of `constraint_row`, for (3.71); change: that of (across, lever), first: the row's first entry."""
        there, travel = self.there, rates.travel
        sections, turned = self.carried(drift)
        new_turning = travel * there.turning_rate
        moved = ca.vertcat(-rates.rise, rates.lateral)
        twisting = new_turning[0] * ca.vertcat(-self.height, there.lateral) + there.turning[0] * moved
        # The wheelset's axes turn against those of the track.
        tangent = self.axes[2, 1] / self.axes[2, 2]
        leaving = self.axes.T @ new_turning - ca.cross(axes_rate(tangent, rates.relative), self.own_turning)
        stretching = (
            new_turning[1] * self.height
            + there.turning[1] * rates.rise
            - new_turning[2] * there.lateral
            - there.turning[2] * rates.lateral
        )
        bending = ca.dot(change[:2], sections) + ca.dot(contact.across, travel * bend + twisting)
        turning = ca.dot(change[2:], turned) + ca.dot(contact.lever, ca.vertcat(leaving[0], leaving[2]))
        return ca.vertcat(-(bending + turning + first * stretching) / self.stretch, change)


def dependent_velocities(row: Sequence[ca.SX], forward: ca.SX, sideways: ca.SX, yaw_rate: ca.SX) -> tuple[ca.SX, ca.SX]:
    """v_z [m/s] and omega_x [rad/s] from the two constraints: (3.115) solved for the dependent velocities."""
    left, right = (one[0] * forward + one[1] * sideways + one[4] * yaw_rate for one in row)
    inverse = 1 / (row[0][2] * row[1][3] - row[1][2] * row[0][3])
    rise = inverse * (row[0][3] * right - row[1][3] * left)
    return rise, inverse * (row[1][2] * left - row[0][2] * right)


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
    """The left (0) or the right wheel with its creep, eqs (3.89)-(3.105); `constraint`: its row and the rate of that.

    moving: velocity where it touches [m/s] and angular velocity [rad/s], in the wheelset's own axes.
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


def push_flanges(fixed: RollingConstants, offset: ca.SX, spread: ca.SX, cosines: ca.SX) -> FlangePush:
    """Lateral push of the rails on the flanges, eq. (3.106), where they touch or, as printed, at the wheelset's centre.

    offset [m]: of the wheelset's centre from that of the track; spread [m]: of each rail, outwards; cosines: the
    wheelset's `direction_cosines`.
    Differs from the thesis with flange_at_rail 1: the force acts at the gauge face, a wheel radius and the flange's
    depth below the axle, so that it presses the flanging wheel down and lifts the other one, each by force x arm over
    the distance of the contacts; and what meets the rail is the displacement down there, to which the roll adds, so
    that the spring gives back what it took. The clearance stays the displacement of a centre on level track. The
    vertical part of a flange's force is missing here as it is in (3.106).
    """
    displacement = offset + fixed.flange_arm * cosines[3]
    left = ca.fmax(displacement - fixed.flange_clearance - spread, 0)
    right = ca.fmax(-displacement - fixed.flange_clearance - spread, 0)
    push = fixed.flange_stiffness * left, fixed.flange_stiffness * right
    moment = (push[1] - push[0]) * fixed.flange_arm * cosines[2]
    return FlangePush(push, moment, (push[0] * left + push[1] * right) / 2)


@lru_cache
def rolling_wheelset(wheel_terms: int, rail_terms: int, creep_law: CreepLaw, on_line: bool = False) -> Part:
    """A `RolledMotion` of a `RollingState`, (3.67), (3.71), (3.73): all that is between two rails and a suspension.

    Constants: `RollingConstants`, then the pieces of both profiles with so many terms, left wheel first. on_line: where
    the track is not straight, an `OnLine` comes behind the state, and `LinePieces` behind the constants.
    """
    state, fixed, chain = RollingState.symbols("state"), RollingConstants.symbols("constants"), Chain()
    pieces = [Pieces(ca.SX.sym("wheel", wheel_terms), ca.SX.sym("rail", rail_terms)) for _ in SIDES]
    given, constants = state.vector, ca.vertcat(fixed.vector, *[piece.vector for piece in pieces])
    there = TrackThere.straight()
    if on_line:
        place, line = OnLine.symbols("place"), LinePieces.symbols("line")
        given, constants = ca.vertcat(given, place.vector), ca.vertcat(constants, line.vector)
        there = TrackThere.of(place, line)
    results = roll_freely(chain, meet_rails(chain, state, there, fixed, pieces, creep_law), fixed).vector
    return Part(f"wheelset_{wheel_terms}_{rail_terms}", given, constants, results, chain)


def roll_freely(chain: Chain, wheelset: OnRails, fixed: RollingConstants) -> RolledMotion:
    """Newton's and Euler's equations of a wheelset on its rails, as (3.73), and how its wheels part from them, (3.71).

    Differs from the thesis, which has Euler parameters: about axes that yaw and roll with the wheelset, in which its
    inertia is constant.
    """
    rate = wheelset.own_rate
    turned = ca.cross(wheelset.spin, wheelset.velocity)
    force = ca.vertcat(wheelset.dragging, wheelset.flange.force, 0) - fixed.mass * (
        fixed.gravity * wheelset.up + turned
    )
    tangent, spin = wheelset.axes[2, 1] / wheelset.axes[2, 2], wheelset.axes.T @ wheelset.spin
    own_axes = axes_rate(tangent, rate - spin) + spin
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
    """Largest Y/Q of a wheel that does not climb on a flange with this angle [rad].

    Nadal (1896), Annales des Mines 10: a flange that slides down carries Y and Q at its angle less that of friction.
    """
    return (math.tan(angle) - friction) / (1 + math.tan(angle) * friction)
