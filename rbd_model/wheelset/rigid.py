"""One wheelset in space at its place in a vehicle: its states, the track and the suspension around its part.

What the rails do to it is in `rolling_wheelset`; suspension, brake and yaw torque come here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

import casadi as ca

from fmu_src.system import System
from rbd_model.body.bodies import add_axle_shift, move_along, start_along
from rbd_model.body.connections import Load
from rbd_model.body.kinematics import Body, turned_by
from rbd_model.contact.geometry import flange_of
from rbd_model.track.frame import TrackFrame
from rbd_model.track.irregularity import Section
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import Wheelset
from rbd_model.wheelset.rigid_contact import SIDES, Pieces, end_of_contact, given_to_contact, inside, look_up_profiles
from rbd_model.wheelset.rigid_part import (
    FlangePush,
    LinePieces,
    OnLine,
    RolledMotion,
    RollingConstants,
    RollingState,
    push_flanges,
    rolling_wheelset,
)
from rbd_model.wheelset.rotation import (
    NOMINAL_TRAVEL,
    NOMINAL_TRAVEL_SPEED,
    Grip,
    Rotation,
    add_hold,
    add_rotation,
    add_rotation_states,
    rail_friction,
    stand_still,
    traction_force,
)

if TYPE_CHECKING:
    from rbd_model.wheelset.elastic import PatchedWheelset

#: Scales of the error control: with tolerance 1e-7, 0.1 nm at the contact, 0.1 nrad of roll and 0.01 N.
NOMINAL_CONTACT = 1e-3
NOMINAL_ROLL = 1e-3
NOMINAL_NORMAL_FORCE = 1e5
#: Share of the rail head's curvature that is left when a tread contact counts as lost. The fold is where nothing is
#: left; there the contact moves infinitely fast.
FOLD_MARGIN = 0.02
#: Distance from the end of a profile at which a contact counts as run off it [m]; beyond the end there is no contact.
END_MARGIN = 1e-3


@dataclass(frozen=True)
class SpatialWheelset:
    """What a wheelset is and does before its suspension's forces are added up; `number` is from 1.

    The body's own axes are those that yaw and roll with the wheelset. Wheels are (left, right).
    """

    number: int
    data: Wheelset
    body: Body
    rotated: ca.SX  # angle that it has turned by [rad]
    yaw: ca.SX
    offset: ca.SX  # lateral displacement from the track's centre [m]
    rail_heights: ca.SX  # [m]
    frictions: ca.SX  # of the rails
    normal_forces: ca.SX
    rolled: RolledMotion
    flange: FlangePush
    ends: list[ca.SX]  # the `margins` of each wheel, from its geometry alone
    lost: list[ca.SX]  # the same, from what is known when its forces are

    @property
    def loads(self) -> ca.SX:
        """Vertical forces of the rails [N]."""
        return self.rolled.loads

    @property
    def thrusts(self) -> ca.SX:
        """Lateral forces on the rails' heads, away from the track's centre [N]."""
        return self.rolled.thrusts + ca.vertcat(*self.flange.push)

    @property
    def flange_force(self) -> ca.SX:
        """Lateral force of the rails on the flanges, to the left [N]."""
        return self.flange.force

    @property
    def creep(self) -> tuple[ca.SX, ca.SX]:
        """Creep forces along the rails [N] and what all creep forces take [W]."""
        return self.rolled.creep_along, self.rolled.creep_powers

    @property
    def kinetic_of_track(self) -> ca.SX:
        """Energy of the rails, which are rigid [J]."""
        return ca.SX(0)

    @property
    def stored(self) -> ca.SX:
        """Energy in the contacts [J]."""
        return self.flange.potential

    @property
    def damping_power(self) -> ca.SX:
        """What the contacts lose as they are pressed [W]."""
        return ca.SX(0)


@dataclass(frozen=True)
class Motion:
    """What the forces do: longitudinal acceleration [m/s2], rotation, power of the yaw torque [W].

    held [N]: force along the track with which the rails hold an axle that stands, else 0.
    """

    acceleration: ca.SX
    held: ca.SX
    rotation: Rotation
    yaw_power: ca.SX


@dataclass(frozen=True)
class OnTrack:
    """The states of a wheelset that do not depend on how it touches its rails, and the track under it."""

    along: ca.SX  # from the vehicle's place [m]
    forward: ca.SX
    lateral: ca.SX
    sideways: ca.SX
    yaw: ca.SX
    yaw_rate: ca.SX
    rotated: ca.SX
    angular_velocity: ca.SX
    centre: ca.SX  # lateral position of both rails' middle [m]
    heights: ca.SX  # of the (left, right) rail [m]
    slopes: ca.SX  # along the track, of its lateral position and of the heights [1]
    frictions: ca.SX  # of the (left, right) rail
    distance: ca.SX  # [m]
    spread: ca.SX  # of each rail, outwards [m]
    track: TrackFrame

    @property
    def offset(self) -> ca.SX:
        """Lateral displacement from the track's centre [m]."""
        return self.lateral - self.centre


def follow_track(assembly: Assembly, number: int, section: Callable[[int, ca.SX], Section]) -> OnTrack:
    """Declares the states of a wheelset along and across the track (section 5.2) and looks at the track there."""
    system, data = assembly.system, assembly.vehicle.wheelsets[number - 1]
    shift, forward = add_axle_shift(assembly, number)
    lateral = system.state(f"lateral_{number}", "m", assembly.parameter["initial_lateral"], NOMINAL_TRAVEL)
    sideways = system.state(f"lateral_speed_{number}", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    yaw = system.state(f"yaw_{number}", "rad", assembly.parameter["initial_yaw"], NOMINAL_TRAVEL)
    yaw_rate = system.state(f"yaw_rate_{number}", "rad/s", 0.0, NOMINAL_TRAVEL_SPEED)
    rotated, omega = add_rotation_states(assembly, number)
    along = assembly.value(data.along) + shift
    distance = assembly.distance + along
    track = section(number, distance)
    system.limit_change(1 / track.density, f"{assembly.vehicle.bodies[0].name}_distance")
    rails = ca.vertcat(track.lateral, track.left, track.right)
    slopes = ca.jacobian(rails, assembly.distance)
    of_rails = ca.vertcat(*[assembly.parameter[f"{side}_rail_friction"] for side in SIDES.values()])
    frictions = rail_friction(assembly, number, distance) * track.friction * of_rails
    frame = assembly.track_at(along)
    motion = forward, lateral, sideways, yaw, yaw_rate, rotated, omega
    return OnTrack(along, *motion, track.lateral, rails[1:], slopes, frictions, distance, track.spread, frame)


def place_wheelset(assembly: Assembly, number: int, section: Callable[[int, ca.SX], Section]) -> SpatialWheelset:
    """Declares the states of a wheelset and lets it meet its rails, by (3.54), (3.57) and (3.67).

    section: the track by wheelset and distance. The static load is the guess for the normal forces.
    """
    system, data = assembly.system, assembly.vehicle.wheelsets[number - 1]
    on = follow_track(assembly, number, section)
    roll = system.algebraic(f"roll_{number}", "rad", 0.0, NOMINAL_ROLL)
    state = RollingState(
        on.forward,
        on.sideways,
        on.yaw,
        on.yaw_rate,
        on.angular_velocity,
        roll,
        add_contact_positions(assembly, number),
        add_normal_forces(assembly, number),
        on.offset,
        on.heights,
        on.slopes,
        ca.jacobian(on.slopes, assembly.distance),
        on.frictions,
    )
    fixed = rolling_constants(assembly, data)
    pieces = look_up_pieces(assembly, number, state, on.spread, fixed)
    terms = pieces[0].wheel.numel(), pieces[0].rail.numel()
    part = rolling_wheelset(*terms, assembly.contact.creep_law, assembly.on_line)
    given, constants = state.vector, ca.vertcat(fixed.vector, *[piece.vector for piece in pieces])
    if assembly.on_line:
        given = ca.vertcat(given, OnLine(on.distance, on.lateral).vector)
        constants = ca.vertcat(constants, line_pieces(system, on.distance).vector)
    rolled = RolledMotion.of(system.call(part, given, constants))
    body = Body(
        ca.vertcat(on.along, on.lateral, rolled.height),
        ca.vertcat(on.forward, on.sideways, rolled.rise),
        turned_by(state.placement.cosines),
        ca.vertcat(rolled.roll_rate, on.angular_velocity, on.yaw_rate),
        ca.vertcat(roll, 0, on.yaw),
        on.track,
    )
    stand_on_track(assembly, number, body)
    system.residual(f"roll_{number}", rolled.gap)
    for index, word in enumerate(SIDES.values()):
        system.residual(f"contact_{number}_{word}", rolled.slope_errors[index])
    ends = ends_alone(assembly, data, state, on.spread, fixed, pieces)
    known = zip(*map(ca.vertsplit, (rolled.bends, state.positions, rolled.on_rails)), strict=True)
    lost = [margins(assembly, data, *one) for one in known]
    flange = push_flanges(fixed, state.offset, on.spread, state.placement.cosines)
    return SpatialWheelset(
        number,
        data,
        body,
        on.rotated,
        on.yaw,
        on.offset,
        on.heights,
        on.frictions,
        state.normal_forces,
        rolled,
        flange,
        ends,
        lost,
    )


def stand_on_track(assembly: Assembly, number: int, body: Body) -> None:
    """How place, lateral position and yaw of a wheelset change, by (3.12) and section 3.2.2."""
    move_along(assembly, body, f"shift_{number}")
    assembly.system.derivative(f"lateral_{number}", body.moving[0])
    assembly.system.derivative(f"yaw_{number}", body.turning[2] / ca.cos(body.angles[0]))
    if assembly.on_line:
        names = ("lateral_speed", "rise_speed", "roll_rate", "", "yaw_rate")
        # Before its contacts are found, it stands as high as its wheels are.
        place = ca.vertcat(body.position[:2], assembly.radius(assembly.vehicle.wheelsets[number - 1]))
        start_along(assembly, replace(body, position=place), [f"{name}_{number}" for name in names])


def line_pieces(system: System, distance: ca.SX) -> LinePieces:
    """The pieces of the line under a wheelset, as `on_line` and the `Section` look them up (section 3.2.1)."""
    return LinePieces(**{item.name: system.line_piece(item.name, distance) for item in fields(LinePieces)})


def ends_alone(
    assembly: Assembly,
    data: Wheelset,
    state: RollingState,
    spread: ca.SX,
    fixed: RollingConstants,
    pieces: Sequence[Pieces],
) -> list[ca.SX]:
    """The `margins` of both wheels (section 9.4.1), told without what it costs to find their forces."""
    found = []
    for index, (side, piece) in enumerate(zip(SIDES, pieces, strict=True)):
        part = end_of_contact(piece.wheel.numel(), piece.rail.numel())
        position = state.positions[index]
        given = given_to_contact(state.placed_over(side, spread), fixed.wheel(index), position, piece)
        bend, on_rail = ca.vertsplit(assembly.system.call(part, *given))
        found.append(margins(assembly, data, bend, position, on_rail))
    return found


def add_contact_positions(assembly: Assembly, number: int) -> ca.SX:
    """Algebraic states: where the (left, right) wheel of a wheelset is touched (3.54) [m]."""
    return ca.vertcat(
        *[
            assembly.system.algebraic(
                f"contact_{number}_{word}", "m", -side * assembly.parameter["initial_lateral"], NOMINAL_CONTACT
            )
            for side, word in SIDES.items()
        ]
    )


def add_normal_forces(assembly: Assembly, number: int) -> ca.SX:
    """Algebraic states: normal forces (3.75) of the (left, right) wheel [N]; the static load is a guess."""
    weight = assembly.value(assembly.vehicle.wheelsets[number - 1].mass) * assembly.parameter["gravity"]
    static_load = assembly.resting_on(number) / 2 + weight / 2
    names = [f"normal_{number}_{word}" for word in SIDES.values()]
    return ca.vertcat(*[assembly.system.algebraic(name, "N", static_load, NOMINAL_NORMAL_FORCE) for name in names])


def rolling_constants(assembly: Assembly, data: Wheelset) -> RollingConstants:
    """What the part of a wheelset takes from its description and the parameters; the flange's place: (3.106)."""
    p, flange = assembly.parameter, flange_of(data.equal_sides)
    arm = p["flange_at_rail"] * (assembly.radius(data) + flange.depth)
    return RollingConstants(
        ca.SX(assembly.value(data.mass)),
        ca.vertcat(*[assembly.value(size) for size in data.inertia]),
        p["gravity"],
        ca.vertcat(*[assembly.value(size) for size in data.radius]),
        ca.SX([data.equal_sides.wheel_half_distance, data.equal_sides.rail_half_distance]),
        p["creepage_speed"],
        p["shear_modulus"],
        assembly.rail.surface.symbols,
        arm,
        p["flange_clearance"] * (1 + arm * flange.roll_by_shift),
        p["flange_stiffness"],
    )


def look_up_pieces(
    assembly: Assembly, number: int, state: RollingState, spread: ca.SX, fixed: RollingConstants
) -> list[Pieces]:
    """Pieces of the profiles at both contacts of a wheelset, (3.77), (3.78)."""
    pair = assembly.vehicle.wheelsets[number - 1].equal_sides
    return [
        look_up_profiles(
            assembly.system,
            f"{number}_{word}",
            pair,
            state.placed_over(side, spread),
            fixed.wheel(index),
            state.positions[index],
        )
        for index, (side, word) in enumerate(SIDES.items())
    ]


#: What a wheel has done whose contact ends (section 9.4.1), in the order of its `margins`.
ENDINGS = ("lost its tread contact", "ran off the end of its tread or of the rail's head")


def margins(assembly: Assembly, data: Wheelset, bend: ca.SX, position: ca.SX, on_rail: ca.SX) -> ca.SX:
    """What is left of a wheel's contact until it ends as ENDINGS say (section 9.4.1); negative where it has.

    bend [1/m]: of the contact, see `WheelContact`; position, on_rail [m]: its places on both profiles.
    """
    # The share of the rail head's curvature that keeps the contact.
    curvature_left = bend * assembly.parameter["rail_head_radius"]
    return ca.vertcat(curvature_left - FOLD_MARGIN, inside(data.equal_sides, position, on_rail) / END_MARGIN - 1)


def yaw_torque_of(assembly: Assembly, number: int, rotated: ca.SX) -> ca.SX:
    """Yaw torque in the axes that yaw and roll with a wheelset [N.m]; rotated: the angle that it has turned by.

    It acts about their upright axis, as the couple of the shoe forces (9.1) does, which are square to the axle; the
    vertical of the track, the other reading, is a roll (1e-3) away and would turn the axle by its sine. About an axis
    that turns with the wheelset's rotation as well when yaw_torque_rotates is 1, which the body's matrix in place of
    the global one in (3.36) does.
    """
    angle = assembly.parameter["yaw_torque_rotates"] * rotated
    return assembly.input[f"yaw_torque_{number}"] * ca.vertcat(ca.sin(angle), 0, ca.cos(angle))


@dataclass(frozen=True)
class Carried:
    """A wheelset as its suspension and its brake know it.

    rotated: angle that it has turned by; creep [N]: of both rails along the track; static [N]: the most that they hold.
    """

    number: int
    data: Wheelset
    body: Body
    rotated: ca.SX
    creep: ca.SX
    static: ca.SX

    @classmethod
    def of(cls, wheelset: SpatialWheelset | PatchedWheelset) -> Carried:
        """Of one on its rails, by friction times load as (3.97) ends."""
        static = ca.dot(wheelset.frictions, ca.fmax(wheelset.loads, 0))
        creep = ca.sum1(wheelset.creep[0])
        return cls(wheelset.number, wheelset.data, wheelset.body, wheelset.rotated, creep, static)


def push_wheelset(
    assembly: Assembly, wheelset: Carried, suspension: Load, free: ca.SX, first_acceleration: ca.SX
) -> tuple[ca.SX, Motion]:
    """What the suspension adds to what the rails do, and the motion along, across and about the vertical, (3.73).

    free: acceleration [m/s2] and turning by the rails, as in `RolledMotion`; what is added has the same rows, and with
    it what the rails add that hold an axle which stands.
    """
    system, data, body = assembly.system, wheelset.data, wheelset.body
    number, rotated = wheelset.number, wheelset.rotated
    mass, inertia = assembly.value(data.mass), [assembly.value(size) for size in data.inertia]
    yaw_torque = yaw_torque_of(assembly, number, rotated)
    moment = suspension.moment + yaw_torque
    turning = ca.vertcat(moment[0] / inertia[0], moment[1], moment[2] / inertia[2])
    push = system.narrow(ca.vertcat((1 / mass) * suspension.force, turning))
    moved = free + push
    hold = add_hold(system, number)
    held = (hold.moves - 1) * mass * moved[0]
    states = [f"shift_speed_{number}", f"{assembly.vehicle.bodies[0].name}_speed"]
    pushed = mass * moved[0] - wheelset.creep, traction_force(assembly, number)
    grip = Grip.of(assembly, number, hold, wheelset.static)
    stand_still(assembly, f"Wheelset {number}", hold, states, pushed, grip)
    turned = rotated, body.own_rate[1]
    rotation = add_rotation(assembly, number, hold, turned, moved[4], -held * assembly.radius(data))
    # It reacts on all angles of a body.
    rotation = replace(rotation, brake_torque=system.narrow(rotation.brake_torque))
    acceleration = hold.moves * moved[0]
    system.derivative(f"shift_speed_{number}", acceleration - first_acceleration)
    system.derivative(f"lateral_speed_{number}", moved[1])
    system.derivative(f"yaw_rate_{number}", moved[5])
    motion = Motion(acceleration, held, rotation, ca.dot(yaw_torque, body.own_rate))
    return push + ca.vertcat(held / mass, ca.SX(5, 1)), motion


def move_wheelset(assembly: Assembly, wheelset: SpatialWheelset, suspension: Load, first_acceleration: ca.SX) -> Motion:
    """Equations of motion of a wheelset, as (3.73), and the accelerations of its constraints, (3.71).

    To what the rails do comes what the suspension does. first_acceleration [m/s2]: of the vehicle's first body along
    the track.
    """
    number, rolled, mass = wheelset.number, wheelset.rolled, assembly.value(wheelset.data.mass)
    free = ca.vertcat(rolled.acceleration, rolled.turning)
    push, motion = push_wheelset(assembly, Carried.of(wheelset), suspension, free, first_acceleration)
    pushed = ca.vertcat(push[:4], push[5])
    for index, (word, row) in enumerate(zip(SIDES.values(), (rolled.left_row, rolled.right_row), strict=True)):
        parting = rolled.parting[index] + ca.dot(row, pushed)
        assembly.system.residual(f"normal_{number}_{word}", mass * parting)
    return motion
