"""Level 3, `spatial`: wheelsets and bodies in 3D; the bogie of chapter 5 has 14 degrees of freedom there.

Roll, contact positions and normal forces are algebraic states. The thesis adds them to the equations of motion with
Lagrange multipliers (3.75). Here they are residuals, which the integration method solves within its steps.

Positions along the track are relative to the vehicle's place; `shift` is that of a body or an axle from its own place
there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.body.bodies import place_bodies
from rbd_model.body.kinematics import Body
from rbd_model.body.suspension import loads_of
from rbd_model.contact.creep.law import SMALLEST_LOAD, at_least
from rbd_model.contact.depth import ONE_RIGID_CONTACT, Contact
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.levels.common import (
    add_common_outputs,
    elevation,
    kinetic_energy,
    move_bodies,
    observe_energy,
    pull_first_body,
    react,
)
from rbd_model.levels.endings import warn_of_limits, watch_patches, watch_rigid, wheel_rise
from rbd_model.levels.resistance import add_davis
from rbd_model.levels.steady import start_steady
from rbd_model.track.frame import on_line as frame_on_line
from rbd_model.track.friction import follow_patch
from rbd_model.track.irregularity import Track, with_line
from rbd_model.vehicle.assembly import Assembly, assemble
from rbd_model.vehicle.description import Vehicle, wheelset_name
from rbd_model.wheelset.elastic import move_elastic, place_elastic
from rbd_model.wheelset.in_space import WheelsetMotion, WheelsetOnRails
from rbd_model.wheelset.rigid import move_rigid, place_rigid
from rbd_model.wheelset.rotation import RollingWheelset
from rbd_model.wheelset.touch import SIDES


@dataclass(frozen=True)
class Depth:
    """Functions of a contact model: for a wheelset on its rails, its equations of motion, and its end conditions."""

    name: str
    place: Callable[..., WheelsetOnRails]
    move: Callable[..., WheelsetMotion]
    watch: Callable[..., None]


#: Contact models by their number.
DEPTHS = {
    1: Depth("spatial", place_rigid, move_rigid, watch_rigid),
    2: Depth("spatial_patches", place_elastic, move_elastic, watch_patches),
    3: Depth("spatial_strips", place_elastic, move_elastic, watch_patches),
}


#: The contact model whose profiles are data of an instance.
OF_ANY_PROFILES = 2


def spatial_vehicle(
    vehicle: Vehicle, track: Track, contact: Contact = ONE_RIGID_CONTACT, on_line: bool = False
) -> System:
    """Return a vehicle in 3D on a track: the bogie of chapter 5, the wheelset in a frame of chapter 4, a wagon."""
    depth = DEPTHS[contact.depth]
    first = vehicle.bodies[0]
    assembly = assemble(depth.name, "3-D contact, hunting, derailment", vehicle, f"{first.name}_", on_line)
    assembly = replace(assembly, contact=contact, axle_height=assembly.radius(vehicle.wheelsets[0]))
    system, p = assembly.system, assembly.parameter
    if contact.depth != OF_ANY_PROFILES:
        system.refuses_records = (
            f"{PAIR_FILE.variable.name} must be empty at contact model {contact.depth}, which has the vehicle's own "
            f"profiles in its equations. Leave it out, or set contact_model to {OF_ANY_PROFILES}."
        )
    if on_line:
        # Each body has the axes of the track at its own place on the line (section 3.2.1).
        assembly, track = replace(assembly, frame_at=partial(frame_on_line, system)), with_line(track)
    assembly, bodies = place_bodies(assembly)
    section, of_bodies = track(system), len(system.states)
    wheelsets = [depth.place(assembly, number, section) for number, _ in vehicle.numbered]
    of_wheelsets = list(system.states)[of_bodies:]
    places = [assembly.distance + wheelset.body.position[0] for wheelset in wheelsets]
    follow_patch(system, assembly.rail, assembly.distance, places)
    loads = loads_of(assembly, bodies, {wheelset.number: wheelset.body for wheelset in wheelsets})

    # 0 at constant speed (sections 4.2, 5.2), which an external force maintains.
    share = 1 - p["constant_speed"]
    falling, resistance = bodies[0].body.falling(p["gravity"])[0], add_davis(assembly, assembly.speed)
    first_acceleration = pull_first_body(assembly, resistance, loads.on(first.name).force[0], falling, share)
    motions = [
        depth.move(assembly, wheelset, loads.on(wheelset_name(wheelset.number)), first_acceleration)
        for wheelset in wheelsets
    ]
    rolling = [rolling_of(wheelset, motion) for wheelset, motion in zip(wheelsets, motions, strict=True)]
    react(assembly, rolling, loads)
    move_bodies(assembly, bodies, loads, first_acceleration)

    add_common_outputs(assembly, bodies, rolling, [motion.acceleration for motion in motions])
    add_outputs(assembly, wheelsets)
    further = own_energies(assembly, wheelsets, motions)
    further["damping_power"] += resistance.power
    observe_energy(assembly, bodies, rolling, loads, further)
    if on_line:
        observe_places(assembly, loads.bodies)
        start_steady(assembly, loads.bodies.values(), rolling, of_wheelsets)
    depth.watch(assembly, wheelsets)
    warn_of_limits(assembly, wheelsets)
    return system


def observe_places(assembly: Assembly, bodies: Mapping[str, Body]) -> None:
    """Observe positions of bodies in 3D, from the line's first row along its first heading, eq. (3.1)."""
    for name, body in bodies.items():
        plan = body.track.plan
        assert plan is not None
        place, ahead = plan.place(body.position), body.axes[:, 0]
        rows = {"ahead": place[0], "aside": place[1], "above": place[2]}
        for row, value in rows.items():
            assembly.system.observe(f"{name}_{row}", "m", value)
        forward = plan.tilt @ ahead
        assembly.system.observe(f"{name}_heading", "rad", plan.turned + ca.atan2(forward[1], forward[0]))


def rolling_of(wheelset: WheelsetOnRails, motion: WheelsetMotion) -> RollingWheelset:
    """Return the common data of all levels for a wheelset in 3D: sums of its two wheels, (3.35)."""
    along, load, power = (ca.sum1(both) for both in (wheelset.creep_along, wheelset.loads, wheelset.creep_powers))
    shift = wheelset.on.shift
    return RollingWheelset(
        wheelset.number,
        wheelset.data,
        motion.rotation,
        shift.place,
        shift.speed,
        along + motion.held,
        load,
        power,
    )


def add_outputs(assembly: Assembly, wheelsets: Sequence[WheelsetOnRails]) -> None:
    """Add the outputs that only this level has; the derailment quotient is that of section 9.4.1."""
    system = assembly.system
    rows: dict[str, ca.SX] = {"derailed": ca.SX(0)}
    for wheelset in wheelsets:
        number = wheelset.number
        rows[f"lateral_{number}"] = wheelset.on.offset
        rows[f"yaw_{number}"] = wheelset.on.yaw
        rows[f"flange_force_{number}"] = wheelset.flange_force
        for index, side in enumerate(SIDES.values()):
            load, thrust = wheelset.loads[index], wheelset.thrusts[index]
            rows[f"wheel_load_{number}_{side}"] = load
            rows[f"lateral_force_{number}_{side}"] = thrust
            rows[f"derailment_quotient_{number}_{side}"] = thrust / at_least(load, SMALLEST_LOAD)
            rows[f"wheel_rise_{number}_{side}"] = wheel_rise(assembly, wheelset, index)
            rows["derailed"] = ca.fmax(rows["derailed"], ca.mmin(wheelset.lost[index]) < 0)
        rows[f"guiding_force_{number}"] = wheelset.thrusts[1] - wheelset.thrusts[0]
    for name, expression in rows.items():
        system.output(assembly.outputs[name], expression)


def own_energies(
    assembly: Assembly, wheelsets: Sequence[WheelsetOnRails], motions: Sequence[WheelsetMotion]
) -> dict[str, ca.SX]:
    """Return energies of the wheelsets and the rails below them [J] and power of the yaw torques [W].

    Section 2.4.
    """
    kinetic, potential, brake, damping = ca.SX(0), ca.SX(0), ca.SX(0), ca.SX(0)
    for wheelset, motion in zip(wheelsets, motions, strict=True):
        kinetic += kinetic_energy(assembly, wheelset.data, wheelset.body) + wheelset.kinetic_of_track
        weight = assembly.value(wheelset.data.mass) * assembly.parameter["gravity"]
        potential += weight * elevation(assembly, wheelset.body) + wheelset.stored
        brake -= motion.yaw_power
        damping += wheelset.damping_power
    own = {"kinetic_energy": kinetic, "potential_energy": potential, "brake_power": brake}
    return own | {"damping_power": damping}
