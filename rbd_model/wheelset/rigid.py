"""The contact of the thesis, model 1: a wheelset with one rigid contact a wheel, at its place in a vehicle.

It applies to straight track only. The effect of the rails on the wheelset is the part of `rigid_part`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

from fmu_src.symbols import ca
from rbd_model.body.effect import Load
from rbd_model.body.kinematics import Body, turned_by
from rbd_model.contact.geometry import Sides, contact_at, flange_of, last_tread_contact
from rbd_model.track.irregularity import Section
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import Wheelset
from rbd_model.wheelset.in_space import (
    END_MARGIN,
    NOMINAL_ROLL,
    WheelsetMotion,
    WheelsetOnRails,
    follow_track,
    push_wheelset,
    stand_on_track,
)
from rbd_model.wheelset.rigid_contact import end_of_contact, given_to_contact, inside, look_up_profiles
from rbd_model.wheelset.rigid_part import (
    FlangePush,
    RolledMotion,
    RollingConstants,
    RollingState,
    push_flanges,
    rolling_wheelset,
)
from rbd_model.wheelset.touch import SIDES, Pieces

#: Scales of the error control: with tolerance 1e-7, 0.1 nm at the contact, 0.1 nrad of roll and 0.01 N.
NOMINAL_CONTACT = 1e-3
NOMINAL_NORMAL_FORCE = 1e5
#: Remaining share of the rail head's curvature at which a tread contact is treated as lost. At the fold no share
#: remains, and the contact moves infinitely fast.
FOLD_MARGIN = 0.02


@dataclass(frozen=True)
class RigidWheelset(WheelsetOnRails):
    """A wheelset with rigid contacts; normal_forces [N]; ends: as `lost`, but from the wheels' geometry alone."""

    normal_forces: ca.SX
    rolled: RolledMotion
    flange: FlangePush
    ends: list[ca.SX]


def place_rigid(assembly: Assembly, number: int, section: Callable[[int, ca.SX, int], Section]) -> RigidWheelset:
    """Declare the states of a wheelset and compute its contact with the rails, by (3.54), (3.57) and (3.67).

    section: the track by wheelset and distance. The static load is the guess for the normal forces.
    """
    if assembly.on_line:
        raise ValueError("Contact model 1 runs on straight track alone, as in the thesis; take model 2 on a line.")
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
        on.bends,
        on.frictions,
    )
    fixed = rolling_constants(assembly, data)
    pieces = look_up_pieces(assembly, number, state, fixed)
    part = rolling_wheelset(pieces[0].wheel.numel(), pieces[0].rail.numel(), assembly.contact.law_of(flange=False))
    constants = ca.vertcat(fixed.vector, *[piece.vector for piece in pieces])
    rolled = RolledMotion.of(system.call(part, state.vector, constants))
    body = Body(
        ca.vertcat(on.along, on.lateral, rolled.height),
        ca.vertcat(on.forward, on.sideways, rolled.rise),
        turned_by(state.placement.cosines),
        ca.vertcat(rolled.roll_rate, on.angular_velocity, on.yaw_rate),
        ca.vertcat(roll, 0, on.yaw),
        on.track,
    )
    stand_on_track(assembly, on, body)
    system.residual(roll, rolled.gap)
    for position, error in zip(*map(ca.vertsplit, (state.positions, rolled.slope_errors)), strict=True):
        system.residual(position, error)
    ends = ends_alone(assembly, data, state, fixed, pieces)
    known = zip(*map(ca.vertsplit, (rolled.bends, state.positions, rolled.on_rails)), strict=True)
    flange = push_flanges(fixed, state.offset, state.placement.cosines)
    return RigidWheelset(
        number,
        data,
        body,
        on,
        rail_heights=on.heights,
        loads=rolled.loads,
        thrusts=rolled.thrusts + ca.vertcat(*flange.push),
        flange_force=flange.force,
        creep_along=rolled.creep_along,
        creep_powers=rolled.creep_powers,
        kinetic_of_track=ca.SX(0),
        stored=flange.potential,
        damping_power=ca.SX(0),
        free=ca.vertcat(rolled.acceleration, rolled.turning),
        lost=[margins(assembly, data, *one) for one in known],
        normal_forces=state.normal_forces,
        rolled=rolled,
        flange=flange,
        ends=ends,
    )


def ends_alone(
    assembly: Assembly, data: Wheelset, state: RollingState, fixed: RollingConstants, pieces: Sequence[Pieces]
) -> list[ca.SX]:
    """Return the `margins` of both wheels (section 9.4.1), without the computation of their forces."""
    found = []
    for index, piece in enumerate(pieces):
        part = end_of_contact(piece.wheel.numel(), piece.rail.numel())
        position = state.positions[index]
        given = given_to_contact(state.placement, fixed.wheel(index), position, piece)
        bend, on_rail = ca.vertsplit(assembly.system.call(part, *given))
        found.append(margins(assembly, data, bend, position, on_rail))
    return found


#: Contacts of centred wheels this near to y = 0 of the profile start there [m]; others start at their place.
NEARLY_NOMINAL = 0.1e-3
#: Conditions of model 1 [m]: shift up to which the contact of a centred wheelset must move without a jump; step of the
#: shift. The third is the least distance of a jump, from the followed contact to the one that touches first.
WITHOUT_JUMP, JUMP_STEP, LONG_JUMP = 3e-3, 20e-6, 1e-3


def add_contact_positions(assembly: Assembly, number: int) -> ca.SX:
    """Return algebraic states: contact positions on the (left, right) wheel of a wheelset (3.54) [m]."""
    centred, starts = contact_at(assembly.vehicle.wheelsets[number - 1].equal_sides, 0.0).position, []
    for (side, word), place in zip(SIDES.items(), centred, strict=True):
        start = -side * assembly.parameter["initial_lateral"]
        start = start if abs(place) < NEARLY_NOMINAL else start + place
        starts.append(assembly.system.algebraic(f"contact_{number}_{word}", "m", start, NOMINAL_CONTACT))
    return ca.vertcat(*starts)


@lru_cache
def check_one_contact(pair: Sides) -> None:
    """Check that one moving contact describes a wheel, because model 1 has only one (section 9.4.1)."""
    last, one = last_tread_contact(pair, WITHOUT_JUMP + JUMP_STEP, JUMP_STEP), pair.left
    elsewhere = abs(contact_at(pair, last.shift).position[0] - last.position[0]) > LONG_JUMP
    if elsewhere or last.shift < WITHOUT_JUMP - JUMP_STEP / 2:
        raise ValueError(
            f"At contact model 1 the contact must move without a jump up to {1e3 * WITHOUT_JUMP:g} mm of shift; that "
            f"of {one.wheel.name} on {one.rail.name} jumps at {1e3 * last.shift:.2g} mm or before, from y = "
            f"{1e3 * last.position[0]:.3g} mm of the wheel. Take contact model 2 or 3, "
            "or smoother profiles."
        )


def add_normal_forces(assembly: Assembly, number: int) -> ca.SX:
    """Return algebraic states: normal forces (3.75) of the (left, right) wheel [N]; the static load is a guess."""
    weight = assembly.value(assembly.vehicle.wheelsets[number - 1].mass) * assembly.parameter["gravity"]
    static_load = assembly.resting_on(number) / 2 + weight / 2
    names = [f"normal_{number}_{word}" for word in SIDES.values()]
    return ca.vertcat(*[assembly.system.algebraic(name, "N", static_load, NOMINAL_NORMAL_FORCE) for name in names])


def rolling_constants(assembly: Assembly, data: Wheelset) -> RollingConstants:
    """Return the constants of a wheelset's part from its description and the parameters.

    The flange's place: (3.106).
    """
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


#: Ends of a wheel's contact in words (section 9.4.1), in the order of its `margins`.
ENDINGS = ("lost its tread contact", "ran off the end of its tread or of the rail's head")


def margins(assembly: Assembly, data: Wheelset, bend: ca.SX, position: ca.SX, on_rail: ca.SX) -> ca.SX:
    """Return the remaining margins of a wheel's contact for each of ENDINGS (section 9.4.1), negative beyond its end.

    bend [1/m]: of the contact, see `WheelContact`; position, on_rail [m]: its places on both profiles.
    """
    # The share of the rail head's curvature that keeps the contact.
    curvature_left = bend * assembly.parameter["rail_head_radius"]
    return ca.vertcat(curvature_left - FOLD_MARGIN, inside(data.equal_sides, position, on_rail) / END_MARGIN - 1)


def look_up_pieces(assembly: Assembly, number: int, state: RollingState, fixed: RollingConstants) -> list[Pieces]:
    """Return pieces of the profiles at both contacts of a wheelset, (3.77), (3.78)."""
    system, pair, placement = assembly.system, assembly.vehicle.wheelsets[number - 1].equal_sides, state.placement
    return [
        look_up_profiles(system, f"{number}_{word}", pair, placement, fixed.wheel(index), state.positions[index])
        for index, word in enumerate(SIDES.values())
    ]


def move_rigid(
    assembly: Assembly, wheelset: RigidWheelset, suspension: Load, first_acceleration: ca.SX
) -> WheelsetMotion:
    """Add equations of motion of a wheelset, as (3.73), and the accelerations of its constraints, (3.71).

    The suspension's effect is added to that of the rails. first_acceleration [m/s2]: of the vehicle's first body along
    the track.
    """
    rolled, mass = wheelset.rolled, assembly.value(wheelset.data.mass)
    push, motion = push_wheelset(assembly, wheelset, suspension, first_acceleration)
    pushed = ca.vertcat(push[:4], push[5])
    rows = zip(ca.vertsplit(wheelset.normal_forces), (rolled.left_row, rolled.right_row), strict=True)
    for index, (normal_force, row) in enumerate(rows):
        parting = rolled.parting[index] + ca.dot(row, pushed)
        assembly.system.residual(normal_force, mass * parting)
    return motion
