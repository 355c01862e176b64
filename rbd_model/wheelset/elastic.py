"""Elastic contact, models 2 and 3: a wheelset on patches or strips at its place in a vehicle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from fmu_src.symbols import ca
from rbd_model.body.bodies import start_along
from rbd_model.body.effect import Load
from rbd_model.body.kinematics import Body, axes_rate, direction_cosines, turned_by
from rbd_model.contact.geometry import Side
from rbd_model.contact.pair_table import flange_of_wheel, line_record
from rbd_model.contact.patches import parts_of, patches_of
from rbd_model.contact.strips_in_c import MOST_SEGMENTS, OF_SEGMENT, wheel_on_strips
from rbd_model.track.irregularity import Section
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import Wheelset
from rbd_model.vehicle.scales import NOMINAL_TRAVEL_SPEED
from rbd_model.wheelset.contact_outputs import add_contact_outputs
from rbd_model.wheelset.in_space import (
    END_MARGIN,
    NOMINAL_ROLL,
    OnTrack,
    WheelsetMotion,
    WheelsetOnRails,
    follow_track,
    push_wheelset,
    stand_on_track,
)
from rbd_model.wheelset.pressing_patch import (
    PatchConstants,
    PatchState,
    Press,
    TurningTrack,
    WheelPress,
    pressing_patch,
)
from rbd_model.wheelset.profiles_of import ProfilesOf, record_of
from rbd_model.wheelset.standing import press_at_start, sinking, stand_at_start
from rbd_model.wheelset.touch import SIDES, Placement, Wheel
from rbd_model.wheelset.touching_patch import InNumbers, Stands, near_rail
from rbd_model.wheelset.wheel_on_record import (
    FLANGES,
    TREADS,
    Feeling,
    asked_of_record,
    given_of,
    room_of_tread,
    room_on,
    watched_wheel,
    wheel_on_record,
)
from rbd_model.wheelset.yielding_rails import Give, add_give, press_rails

#: Scales of the error control: with tolerance 1e-6, 1 nm of an approach that is 0.1 mm under load.
NOMINAL_RISE = 1e-3


@dataclass(frozen=True)
class ElasticWheelset(WheelsetOnRails):
    """A wheelset on elastic contacts.

    approaches: for each wheel (left, right) the largest approach of its patches to the rail except for the steepest one
    of its flange, and that of this one [m]; negative if they are apart.
    """

    stance: Stance
    approaches: list[tuple[ca.SX, ca.SX]]

    def wheel_half_distance(self, index: int) -> ca.SX | float:
        """Return half the distance of the y = 0 of the left (0) or right wheel (1) [m] (section 4.3)."""
        return self.stance.profiles.sides[index].wheel_half_distance


@dataclass(frozen=True)
class Stance:
    """Position of a wheelset: on the track, its height over it [m], its roll and their rates.

    settled [m]: height of level rails over the track's axes, because heights are measured from the position at rest.
    give: displacement of the rails below it.
    """

    on: OnTrack
    give: Give
    profiles: ProfilesOf
    height: ca.SX
    settled: ca.SX
    rise: ca.SX
    roll: ca.SX
    roll_rate: ca.SX
    cosines: ca.SX

    @property
    def placement(self) -> Placement:
        """Position and angles on the track."""
        return Placement(self.on.yaw, self.roll, self.cosines, self.on.offset)


def place_elastic(assembly: Assembly, number: int, section: Callable[[int, ca.SX, int], Section]) -> ElasticWheelset:
    """Declare the states of a wheelset, and compute the contact of its patches with the rails, by (3.54), (3.57) and
    Hertz.
    """
    system, data = assembly.system, assembly.vehicle.wheelsets[number - 1]
    on = follow_track(assembly, number, section)
    profiles = ProfilesOf.of(assembly, number)
    settled = system.derived(f"sinking_{number}", sinking(assembly, number, profiles)) - profiles.lift
    first_rise, first_roll = stand_at_start(assembly, profiles, on)
    # The rise is measured from the position at rest, as for the bodies that the wheelset carries.
    risen = system.state(f"rise_{number}", "m", first_rise, NOMINAL_RISE)
    height = assembly.radius(data) + risen - settled
    rising = system.state(f"rise_speed_{number}", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    roll = system.state(f"roll_{number}", "rad", first_roll, NOMINAL_ROLL)
    roll_rate = system.state(f"roll_rate_{number}", "rad/s", 0.0, NOMINAL_TRAVEL_SPEED)
    give = add_give(assembly, number) if assembly.on_line else Give.rigid()
    stance = Stance(on, give, profiles, height, settled, rising, roll, roll_rate, direction_cosines(on.yaw, roll))
    body = Body(
        ca.vertcat(on.along, on.lateral, assembly.radius(data) + risen),
        ca.vertcat(on.forward, on.sideways, rising),
        turned_by(stance.cosines),
        ca.vertcat(roll_rate, on.angular_velocity, on.yaw_rate),
        ca.vertcat(roll, 0, on.yaw),
        on.track,
    )
    stand_on_track(assembly, on, body)
    if assembly.on_line:
        # Before its contacts are found, its centre is at the height of its wheels' radius.
        standing = replace(body, position=ca.vertcat(body.position[:2], assembly.radius(data)))
        start_along(assembly, standing, [on.sideways, rising, roll_rate, None, on.yaw_rate])
    system.derivative(risen, body.moving[1])
    system.derivative(roll, body.turning[0])
    press = STRIPS_OR_PATCHES[assembly.contact.depth]
    found = [press(assembly, number, index, stance, body) for index in range(len(SIDES))]
    given = [wheel.given for wheel in found if wheel.given is not None]
    if given:
        press_at_start(assembly, number, profiles, (risen, roll), given)
    wheelset = add_up(assembly, number, body, stance, found)
    if assembly.on_line:
        press_rails(assembly, give, wheelset.thrusts[0] - wheelset.thrusts[1], wheelset.loads)
    observe_patches(assembly, number, found)
    return wheelset


def add_up(assembly: Assembly, number: int, body: Body, stance: Stance, found: Sequence[WheelFound]) -> ElasticWheelset:
    """Return the total effect of all patches of a wheelset, (3.35), (3.36); found: of the (left, right) wheel."""
    data, give = assembly.vehicle.wheelsets[number - 1], stance.give

    def of_wheels(value: Callable[[WheelPress], ca.SX]) -> ca.SX:
        return ca.vertcat(*[value(wheel.pressed) for wheel in found])

    return ElasticWheelset(
        number,
        data,
        body,
        stance.on,
        rail_heights=stance.on.heights + give.moved[1:],
        loads=of_wheels(lambda wheel: wheel.force[2]),
        thrusts=-ca.vertcat(*SIDES) * of_wheels(lambda wheel: wheel.force[1]),
        flange_force=ca.sum1(of_wheels(lambda wheel: wheel.flange_force)),
        creep_along=of_wheels(lambda wheel: wheel.creep_along),
        creep_powers=of_wheels(lambda wheel: wheel.creep_power),
        kinetic_of_track=give.kinetic,
        stored=ca.sum1(of_wheels(lambda wheel: wheel.stored)) + give.stored,
        damping_power=ca.sum1(of_wheels(lambda wheel: wheel.damping_power)) + give.damping_power,
        free=stand_freely(assembly, data, body, [wheel.pressed for wheel in found]),
        lost=[wheel.room / END_MARGIN - 1 for wheel in found],
        stance=stance,
        approaches=[wheel.approaches for wheel in found],
    )


def observe_patches(assembly: Assembly, number: int, found: Sequence[WheelFound]) -> None:
    """Observe the force of the rail on each patch of each wheel [N], in the track's axes at the wheelset, (3.35)."""
    for side, wheel in zip(SIDES.values(), found, strict=True):
        for place, patch in enumerate(wheel.each):
            for row, force in zip(("ahead", "aside", "above"), ca.vertsplit(patch), strict=True):
                assembly.system.observe(f"force_{place}_{number}_{side}_{row}", "N", force)


@dataclass(frozen=True)
class WheelFound:
    """Effect of the patches of a wheel together, and the force of each of those of the vehicle's own profiles [N].

    `approaches` are those of an `ElasticWheelset`. `room` are the distances from their ends of the tread and of the
    steepest patch of the flange [m]. `given`: arguments and constants of `wheel_on_record`.
    """

    pressed: WheelPress
    each: list[ca.SX]
    approaches: tuple[ca.SX, ca.SX]
    room: ca.SX
    given: ca.SX | None = None


def press_patches(assembly: Assembly, number: int, index: int, stance: Stance, body: Body) -> WheelFound:
    """Return the forces on the wheel `index` (0: left) of a wheelset on its patches, (3.77), (3.78)."""
    system, profiles = assembly.system, stance.profiles.sides[index]
    wheel, state = feel_rail(assembly, number, index, stance)
    track = TurningTrack(body.track.turning, body.stretch)
    # The rail's place turns with the track about its own axis. The patch adds the part beside this axis.
    on, moved = stance.on, stance.give.moved
    lies = ca.vertcat(0, on.centre + wheel.side * on.spread[0], on.heights[index] + stance.settled)
    lies += ca.vertcat(0, moved[0], moved[1 + index])
    slopes = state.slopes + ca.cross(ca.vertcat(track.turning[0], 0, 0), lies)[1:]
    state = replace(state, slopes=system.narrow(slopes))
    fixed = PatchConstants(stance.cosines, wheel.vector, *surroundings(assembly))
    feeling = Feeling(state, fixed, track if assembly.on_line else None)
    assert profiles.record is not None
    whole = given_of(feeling, profiles.record)
    pressed = system.call(wheel_on_record(assembly.contact, assembly.on_line), *whole)
    given = ca.vertcat(state.offset, state.height, state.yaw, state.roll)
    constants = ca.vertcat(fixed.cosines, fixed.wheel, profiles.record)
    watched = system.call(watched_wheel(), given, constants)
    ends = ca.vertcat(profiles.wheel_limits[1], *profiles.rail_limits)
    of_tread = system.call(room_of_tread(), given, ca.vertcat(fixed.cosines, fixed.wheel, ends, profiles.record))
    room = ca.vertcat(-of_tread, -watched[2] - profiles.wheel_limits[0])
    each = force_of_each(assembly, number, index, feeling)
    if assembly.vehicle.contact_outputs:
        add_contact_outputs(assembly, f"{number}_{list(SIDES.values())[index]}", feeling, profiles.record)
    return WheelFound(WheelPress.of(pressed), each, (watched[0], watched[1]), room, ca.vertcat(*whole))


def force_of_each(assembly: Assembly, number: int, index: int, feeling: Feeling) -> list[ca.SX]:
    """Return the force of the rail on each patch of the vehicle's own profiles [N], (3.35).

    With a contact table of other profiles they are those of its patches with the same numbers. The force on a patch
    that the table does not have is 0: its record is 0, and its parts are not called.
    """
    system = assembly.system
    counts, forces = {False: 0, True: 0}, []
    for patch in patches_of(side_of(assembly, number, index)):
        path = [(0, index), (FLANGES if patch.flange else TREADS, counts[patch.flange])]
        counts[patch.flange] += 1
        record = record_of(assembly, number, path)
        given = given_of(feeling, record)
        asked = system.call(asked_of_record(patch.flange, assembly.on_line), *given, record)
        part = pressing_patch(patch.flange, assembly.contact, assembly.on_line)
        forces.append(WheelPress.of(system.call(part, *given, asked)).force)
    return forces


def press_strips(assembly: Assembly, number: int, index: int, stance: Stance, body: Body) -> WheelFound:
    """Return the same as `press_patches`, by strips: Knothe (1984), Kalker (1982), see contact/strips.c.

    Nearest points only determine where tread and flange end. On a line, all strips of a wheel use the twist of the rail
    at its head's middle, a few cm away. The vertical motion on a ramp has a relative error of 1e-5.
    """
    one = side_of(assembly, number, index)
    middle = ca.vertcat(0, list(SIDES)[index] * one.rail_half_distance, 0)
    wheel, state = feel_rail(assembly, number, index, stance)
    slopes = (state.slopes + ca.cross(body.track.turning, middle)[1:]) / body.stretch
    state = replace(state, slopes=slopes)
    parts = parts_of(one, most=MOST_SEGMENTS)
    stands = Stands.of(replace(stance.placement, lateral=state.offset), wheel, state.height)
    nearest = [near_rail(assembly.system, InNumbers(line_record(one, part)), part.flange, stands) for part in parts]
    nu, (*steel, surface, damping, gauge_face) = assembly.contact.poisson_ratio, surroundings(assembly)
    without_slip = surface[: surface.numel() - 1]
    constants = ca.vertcat(wheel.vector, *steel, without_slip, damping, gauge_face, nu, assembly.on_line)
    found = assembly.system.call(wheel_on_strips(one, nu), state.vector, constants)
    each = [Press.of(found[OF_SEGMENT * i : OF_SEGMENT * (i + 1)]) for i in reversed(range(len(parts)))]
    pressed = WheelPress.of_patches(each, [part.flange for part in parts])
    *others, steepest = (near.approach for near in nearest)
    ends = stance.profiles.sides[index]
    treads = [near for near, part in zip(nearest, parts, strict=True) if not part.flange]
    begins = ca.SX(flange_of_wheel(one)[0])
    of_treads = [room_on(near, begins, ends.wheel_limits[1], ends.rail_limits) for near in treads]
    room = ca.vertcat(ca.mmin(ca.vertcat(*of_treads)), nearest[-1].position - ends.wheel_limits[0])
    return WheelFound(pressed, [patch.force for patch in each], (ca.mmax(ca.vertcat(*others)), steepest), room)


#: By the contact model: the function for the forces on a wheel.
STRIPS_OR_PATCHES = {2: press_patches, 3: press_strips}


def side_of(assembly: Assembly, number: int, index: int) -> Side:
    """Return a wheel on its rail (section 4.3), index 0 the left one."""
    return assembly.vehicle.wheelsets[number - 1].pair.both[index]


def feel_rail(assembly: Assembly, number: int, index: int, stance: Stance) -> tuple[Wheel, PatchState]:
    """Return a wheel, its position and its motion on its rail (section 3.2)."""
    data, on, one = assembly.vehicle.wheelsets[number - 1], stance.on, stance.profiles.sides[index]
    moved, speed = stance.give.moved, stance.give.speed
    distances = ca.SX(one.wheel_half_distance), ca.SX(one.rail_half_distance)
    side, (spread, spreading) = list(SIDES)[index], ca.horzsplit(on.spread)
    wheel = Wheel(ca.SX(side), assembly.value(data.radius[index]), *distances)
    state = PatchState(
        on.forward,
        on.sideways - speed[0],
        stance.rise - speed[1 + index],
        stance.roll_rate,
        on.angular_velocity,
        on.yaw_rate,
        on.offset - side * spread - moved[0],
        stance.height - on.heights[index] - moved[1 + index],
        on.yaw,
        stance.roll,
        ca.vertcat(on.slopes[0] + side * spreading, on.slopes[1 + index]),
        on.frictions[index],
    )
    return wheel, state


def surroundings(assembly: Assembly) -> tuple[ca.SX, ...]:
    """Return the constants that all contacts of a vehicle share, in the order of `PatchConstants`."""
    p = assembly.parameter
    steel, surface = (p["creepage_speed"], p["shear_modulus"]), assembly.rail.surface.symbols
    return *steel, surface, p["contact_damping"], p["gauge_face_friction"]


def stand_freely(assembly: Assembly, data: Wheelset, body: Body, pressed: Sequence[WheelPress]) -> ca.SX:
    """Return `free`: Newton's and Euler's equations of a wheelset on its patches without suspension, as (3.73).

    They are in axes that yaw and roll with the wheelset, in which its inertia is constant.
    """
    mass, inertia = assembly.value(data.mass), [assembly.value(size) for size in data.inertia]
    force = sum((wheel.force for wheel in pressed), mass * body.falling(assembly.parameter["gravity"]))
    rate, roll, spin = body.own_rate, body.angles[0], body.axes.T @ body.spin
    gyroscopic = ca.cross(axes_rate(ca.sin(roll) / ca.cos(roll), rate - spin) + spin, ca.vertcat(*inertia) * rate)
    moment = sum((wheel.moment for wheel in pressed), -gyroscopic)
    moved = ca.vertcat((1 / mass) * force, moment[0] / inertia[0], moment[1], moment[2] / inertia[2])
    return assembly.system.narrow(moved)


def move_elastic(
    assembly: Assembly, wheelset: ElasticWheelset, suspension: Load, first_acceleration: ca.SX
) -> WheelsetMotion:
    """Add the equations of motion of a wheelset, as (3.73): the effects of the rails and of the suspension."""
    push, motion = push_wheelset(assembly, wheelset, suspension, first_acceleration)
    assembly.system.derivative(wheelset.stance.rise, wheelset.free[2] + push[2])
    assembly.system.derivative(wheelset.stance.roll_rate, wheelset.free[3] + push[3])
    return motion
