"""Level 3, `spatial`: wheelsets and bodies in space; the bogie of chapter 5 has 14 degrees of freedom there.

Roll, contact positions and normal forces are algebraic states: what the thesis adds to the equations of motion with
Lagrange multipliers (3.75) are residuals here, which the integration method solves within its steps.

Positions along the track are counted from the vehicle's place; `shift` is that of a body or an axle from its own there.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from fmu_src.system import System
from rbd_model.adhesion import follow_patch
from rbd_model.assembly import Assembly, assemble
from rbd_model.bodies import place_body
from rbd_model.contact.geometry import flange_of
from rbd_model.motion import add_common_outputs, kinetic_energy, loads_of, move_bodies, observe_energy, react
from rbd_model.rolling_contact import SIDES
from rbd_model.rolling_wheelset import nadal_limit
from rbd_model.spatial_wheelset import ENDINGS, Motion, SpatialWheelset, move_wheelset, place_wheelset
from rbd_model.track import Track
from rbd_model.vehicle import Vehicle, wheelset_name
from rbd_model.wheelset import SMALLEST_LOAD, Rolling, at_least


def spatial_vehicle(vehicle: Vehicle, track: Track) -> System:
    """A vehicle in space on a track: the bogie of chapter 5, the wheelset in a frame of chapter 4, a wagon."""
    assembly = assemble("spatial", "3-D contact, hunting, derailment", vehicle)
    system, p, first = assembly.system, assembly.parameter, vehicle.bodies[0]
    assembly.axle_height = assembly.radius(vehicle.wheelsets[0])
    bodies = [place_body(assembly, data) for data in vehicle.bodies]
    section = track(system)
    wheelsets = [place_wheelset(assembly, number, section) for number, _ in vehicle.numbered]
    places = [assembly.distance + wheelset.body.position[0] for wheelset in wheelsets]
    follow_patch(system, assembly.rail, f"{first.name}_distance", places)
    loads = loads_of(assembly, bodies, {wheelset.number: wheelset.body for wheelset in wheelsets})

    # None at constant speed (sections 4.2, 5.2), where something pulls as much as needed.
    share = (1 - p["constant_speed"]) / assembly.value(first.mass)
    first_acceleration = share * loads.on(first.name).force[0]
    motions = [
        move_wheelset(assembly, wheelset, loads.on(wheelset_name(wheelset.number)), first_acceleration)
        for wheelset in wheelsets
    ]
    rolling = [rolling_of(wheelset, motion) for wheelset, motion in zip(wheelsets, motions, strict=True)]
    react(assembly, rolling, loads)
    move_bodies(assembly, bodies, loads, first_acceleration)

    add_common_outputs(assembly, bodies, rolling, [motion.acceleration for motion in motions])
    add_outputs(assembly, wheelsets)
    further = own_energies(assembly, wheelsets, motions)
    observe_energy(assembly, bodies, rolling, loads.effects, further)
    gaps = [system.derivatives[f"roll_{wheelset.number}"] for wheelset in wheelsets]
    system.observe("largest_gap", "m", ca.mmax(ca.fabs(ca.vertcat(*gaps))))
    add_ends(assembly, wheelsets)
    warn_of_climbing(assembly, wheelsets)
    return system


def rolling_of(wheelset: SpatialWheelset, motion: Motion) -> Rolling:
    """A wheelset in space as every level has it: sums of its two wheels, (3.35)."""
    body, rolled = wheelset.body, wheelset.rolled
    along, load, power = (ca.sum1(both) for both in (rolled.creep_along, rolled.loads, rolled.creep_powers))
    return Rolling(
        wheelset.number, wheelset.data, motion.rotation, body.velocity[0], body.axes[:, 1], along, load, power
    )


def add_outputs(assembly: Assembly, wheelsets: Sequence[SpatialWheelset]) -> None:
    """Outputs that only this level has; the derailment quotient is that of section 9.4.1."""
    system = assembly.system
    rows: dict[str, ca.SX] = {"derailed": ca.SX(0)}
    for wheelset in wheelsets:
        number = wheelset.number
        rows[f"lateral_{number}"] = wheelset.offset
        rows[f"yaw_{number}"] = wheelset.yaw
        rows[f"flange_force_{number}"] = wheelset.flange.force
        for index, side in enumerate(SIDES.values()):
            load, thrust = wheelset.rolled.loads[index], wheelset.rolled.thrusts[index] + wheelset.flange.push[index]
            rows[f"wheel_load_{number}_{side}"] = load
            rows[f"derailment_quotient_{number}_{side}"] = thrust / at_least(load, SMALLEST_LOAD)
            rows["derailed"] = ca.fmax(rows["derailed"], ca.mmin(wheelset.lost[index]) < 0)
    for name, expression in rows.items():
        system.output(assembly.outputs[name], expression)


def add_ends(assembly: Assembly, wheelsets: Sequence[SpatialWheelset]) -> None:
    """Where the model ends: a tread contact reaches its fold (section 9.4.1) or an end, or a wheel carries nothing."""
    system = assembly.system
    for wheelset in wheelsets:
        share = assembly.resting_on(wheelset.number) / 2
        for index, side in enumerate(SIDES.values()):
            name = f"{side} wheel of wheelset {wheelset.number}"
            for margin, word in zip(ca.vertsplit(wheelset.ends[index]), ENDINGS, strict=True):
                system.end_when_negative(margin, f"Derailed: the {name} {word} at %s s; results up to there are kept.")
            load = wheelset.normal_forces[index] / share
            ends = assembly.parameter["wheel_lift_ends"]
            system.end_when_negative(
                ca.if_else(ends, load, 1),
                f"Wheel lift: the {name} carried no load at %s s; results up to there are kept.",
            )
            system.warn_when_negative(
                ca.if_else(ends, 1, load),
                f"Wheel lift: the {name} carried no load at %s s; from there on the rail pulls it down where needed.",
            )


def warn_of_climbing(assembly: Assembly, wheelsets: Sequence[SpatialWheelset]) -> None:
    """Limit of Y/Q after Nadal (1896) for a wheel whose flange touches.

    As a margin of forces, which needs no load to divide by.
    """
    for wheelset in wheelsets:
        share, angle = assembly.resting_on(wheelset.number) / 2, flange_of(wheelset.data.pair).angle
        for index, (push, side) in enumerate(zip(wheelset.flange.push, SIDES.values(), strict=True)):
            rolled = wheelset.rolled
            margin = nadal_limit(angle, rolled.frictions[index]) * rolled.loads[index] - rolled.thrusts[index] - push
            # The creep forces in it cost as much as half of a right-hand side: only where the flange touches.
            assembly.system.warn_when_negative(
                ca.if_else(push > 0, margin / share, 1),
                f"Flange climb: Y/Q of the {side} wheel of wheelset {wheelset.number} rose above Nadal's limit for its "
                "flange and friction at %s s; a real wheel may climb the rail from there on, this one stays on it.",
                candidate=-push / share,
            )


def own_energies(
    assembly: Assembly, wheelsets: Sequence[SpatialWheelset], motions: Sequence[Motion]
) -> dict[str, ca.SX]:
    """Energies of the wheelsets themselves [J] and power of the yaw torques [W], for section 2.4."""
    kinetic, potential, brake = ca.SX(0), ca.SX(0), ca.SX(0)
    for wheelset, motion in zip(wheelsets, motions, strict=True):
        kinetic += kinetic_energy(assembly, wheelset.data, wheelset.body)
        weight = assembly.value(wheelset.data.mass) * assembly.parameter["gravity"]
        potential += weight * wheelset.body.position[2] + wheelset.flange.potential
        brake -= motion.yaw_power
    return {"kinetic_energy": kinetic, "potential_energy": potential, "brake_power": brake}
