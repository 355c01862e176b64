"""Level 3, `spatial`: wheelsets and sprung mass in space, 14 degrees of freedom with two wheelsets, 9 with one.

Roll, contact positions and normal forces are algebraic states: what the thesis adds to the equations of motion with
Lagrange multipliers (3.75) are residuals here, which the integration method solves within its steps.

Positions along the track are counted from the sprung mass; `shift` is that of an axle from its place under it.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from fmu_src.system import System
from rbd_model import variables
from rbd_model.adhesion import follow_patch
from rbd_model.contact_geometry import Pair, flange_of
from rbd_model.kinematics import Body
from rbd_model.parameters import BogieParameters
from rbd_model.rolling_contact import SIDES
from rbd_model.spatial_wheelset import Motion, SpatialWheelset, move_wheelset, nadal_limit, place_wheelset
from rbd_model.sprung_mass import hold_or_pull, move_frame, place_frame
from rbd_model.suspension import Load, Suspension, suspend, total
from rbd_model.track import Track
from rbd_model.wheelset import SMALLEST_LOAD, Bogie, add_wheelset_outputs, at_least, start_bogie

#: Fields of the parameter set that only the levels below need.
UNUSED = ("wheel_profile_curvature",)


def spatial_bogie(defaults: BogieParameters, pair: Pair, track: Track, numbers: Sequence[int] = (1, 2)) -> System:
    """The two-axle bogie (chapter 5), or with numbers = (1,) a wheelset in a frame whose pitch is held (chapter 4)."""
    unused = UNUSED if len(numbers) > 1 else (*UNUSED, "wheel_base")
    used = [name for name in defaults.values() if name not in unused]
    absent = [name for name in variables.inputs() if name.endswith("_2")] if 2 not in numbers else []
    bogie = start_bogie("spatial", "3-D contact, hunting, derailment", defaults, used, absent)
    system, p = bogie.system, bogie.parameter
    p.update({offset.name: system.parameter(offset) for offset in variables.initial_offsets()})
    frame = place_frame(bogie, pitches=len(numbers) > 1)
    follow_patch(system, bogie.rail, "frame_distance")
    section = track(system)

    share = p["frame_mass"] * p["gravity"] / (2 * len(numbers))
    places = {number: place_under_frame(bogie, number, len(numbers)) for number in numbers}
    wheelsets, suspensions = [], []
    for number, along in places.items():
        static_load = share + p["wheelset_mass"] * p["gravity"] / 2
        wheelset = place_wheelset(bogie, number, along, pair, section, static_load)
        wheelsets.append(wheelset)
        suspensions.append(suspend(p, wheelset.body, frame, (along, -p["frame_height"]), share))

    hold_or_pull(bogie, ca.SX(sum(s.on_frame.force[0] for s in suspensions)))
    motions = [move_wheelset(bogie, w, s.on_wheelset) for w, s in zip(wheelsets, suspensions, strict=True)]
    reactions = [torque_reaction(bogie, w, m) for w, m in zip(wheelsets, motions, strict=True)]
    move_frame(bogie, frame, total([*(s.on_frame for s in suspensions), *reactions]))

    add_outputs(bogie, wheelsets, motions)
    observe_energy(bogie, frame, wheelsets, suspensions, motions)
    add_ends(bogie, wheelsets, share)
    warn_of_climbing(bogie, wheelsets, share, flange_of(pair).angle)
    return system


def place_under_frame(bogie: Bogie, number: int, count: int) -> ca.SX:
    """Place of an axle along the sprung mass [m], Fig. 5.1; one alone is below its centre, Fig. 4.1."""
    if count == 1:
        return ca.SX(0)
    return bogie.parameter["wheel_base"] * (0.5 if number == 1 else -0.5)


def torque_reaction(bogie: Bogie, wheelset: SpatialWheelset, motion: Motion) -> Load:
    """The share of brake and traction torque that reacts on the sprung mass, about the axle.

    Differs from the thesis, which leaves it out (section 9.2): brakes and motors hang in the frame.
    """
    torque = motion.rotation.brake_torque - motion.rotation.traction_torque
    axle = wheelset.body.axes[:, 1]
    return Load(ca.SX.zeros(3), bogie.parameter["torque_reaction"] * torque * axle)


def add_outputs(bogie: Bogie, wheelsets: Sequence[SpatialWheelset], motions: Sequence[Motion]) -> None:
    """Outputs; speed, distance and acceleration are those of the axles (section 6.3.4) as at the planar level."""
    system, outputs, count = bogie.system, bogie.outputs, len(wheelsets)
    value = {name: state.symbol for name, state in system.states.items()}
    speed = ca.SX(sum(wheelset.body.velocity[0] for wheelset in wheelsets)) / count
    shift = sum(value[f"shift_{wheelset.number}"] for wheelset in wheelsets) / count
    rows = {
        "speed": speed,
        "distance": value["frame_distance"] + shift,
        "acceleration": sum(motion.acceleration for motion in motions) / count,
        "bounce": value["bounce"],
        "pitch": value.get("pitch", ca.SX(0)),
        "frame_lateral": value["frame_lateral"],
        "frame_roll": value["frame_roll"],
        "frame_yaw": value["frame_yaw"],
        "derailed": 0,
    }
    for wheelset in wheelsets:
        number = wheelset.number
        rows[f"lateral_{number}"] = wheelset.offset
        rows[f"yaw_{number}"] = value[f"yaw_{number}"]
        rows[f"flange_force_{number}"] = wheelset.flange.force
        for wheel, push, side in zip(wheelset.wheels, wheelset.flange.push, SIDES.values(), strict=True):
            rows[f"wheel_load_{number}_{side}"] = wheel.load
            rows[f"derailment_quotient_{number}_{side}"] = (wheel.thrust + push) / at_least(wheel.load, SMALLEST_LOAD)
            for margin, _ in wheel.derailed:
                rows["derailed"] = ca.fmax(rows["derailed"], margin < 0)
    for name, expression in rows.items():
        system.output(outputs[name], expression)
    for wheelset, motion in zip(wheelsets, motions, strict=True):
        along = ca.SX(sum(wheel.creep_along for wheel in wheelset.wheels))
        load = ca.SX(sum(wheel.load for wheel in wheelset.wheels))
        add_wheelset_outputs(bogie, motion.rotation, speed, along, load)


def add_ends(bogie: Bogie, wheelsets: Sequence[SpatialWheelset], share: ca.SX) -> None:
    """Where the model ends: a tread contact reaches its fold (section 9.4.1) or an end, or a wheel carries nothing."""
    system = bogie.system
    for wheelset in wheelsets:
        for wheel, side in zip(wheelset.wheels, SIDES.values(), strict=True):
            name = f"{side} wheel of wheelset {wheelset.number}"
            for margin, word in wheel.derailed:
                system.end_when_negative(margin, f"Derailed: the {name} {word} at %s s; results up to there are kept.")
            load = wheel.normal_force / share
            ends = bogie.parameter["wheel_lift_ends"]
            system.end_when_negative(
                ca.if_else(ends, load, 1),
                f"Wheel lift: the {name} carried no load at %s s; results up to there are kept.",
            )
            system.warn_when_negative(
                ca.if_else(ends, 1, load),
                f"Wheel lift: the {name} carried no load at %s s; from there on the rail pulls it down where needed.",
            )


def warn_of_climbing(bogie: Bogie, wheelsets: Sequence[SpatialWheelset], share: ca.SX, angle: float) -> None:
    """Limit of Y/Q after Nadal (1896) for a wheel whose flange touches; angle [rad]: of the flange.

    As a margin of forces, which needs no load to divide by.
    """
    for wheelset in wheelsets:
        for wheel, push, side in zip(wheelset.wheels, wheelset.flange.push, SIDES.values(), strict=True):
            margin = nadal_limit(angle, wheel.friction) * wheel.load - wheel.thrust - push
            # The creep forces in it cost as much as half of a right-hand side: only where the flange touches.
            bogie.system.warn_when_negative(
                ca.if_else(push > 0, margin / share, 1),
                f"Flange climb: Y/Q of the {side} wheel of wheelset {wheelset.number} rose above Nadal's limit for its "
                "flange and friction at %s s; a real wheel may climb the rail from there on, this one stays on it.",
                candidate=-push / share,
            )


def observe_energy(
    bogie: Bogie,
    frame: Body,
    wheelsets: Sequence[SpatialWheelset],
    suspensions: Sequence[Suspension],
    motions: Sequence[Motion],
) -> None:
    """Energies [J] and powers lost [W] (section 2.4); their sum stays while nothing drives: constraints do no work."""
    system, p = bogie.system, bogie.parameter

    def kinetic(body: Body, name: str) -> ca.SX:
        inertia = ca.vertcat(*[p[f"{name}_{axis}_inertia"] for axis in ("roll", "pitch", "yaw")])
        return (p[f"{name}_mass"] * ca.sumsqr(body.velocity) + ca.dot(inertia, body.own_rate**2)) / 2

    energy = kinetic(frame, "frame")
    potential = p["frame_mass"] * p["gravity"] * frame.position[2]
    brake = creep = damping = ca.SX(0)
    for wheelset, suspension, motion in zip(wheelsets, suspensions, motions, strict=True):
        energy += kinetic(wheelset.body, "wheelset")
        potential += p["wheelset_mass"] * p["gravity"] * wheelset.body.position[2]
        potential += suspension.potential + wheelset.flange.potential
        # A torque that reacts on the sprung mass works on the difference of the two rotations.
        turned = ca.dot(wheelset.body.axes[:, 1], frame.rate)
        rotation = motion.rotation
        brake += rotation.friction_torque * rotation.angular_velocity
        brake -= p["torque_reaction"] * rotation.brake_torque * turned + motion.yaw_power
        creep += ca.SX(sum(wheel.creep_power for wheel in wheelset.wheels))
        damping += suspension.damping_power
    system.observe("kinetic_energy", "J", energy)
    system.observe("potential_energy", "J", potential)
    system.observe("brake_power", "W", brake)
    system.observe("creep_power", "W", creep)
    system.observe("damping_power", "W", damping)
    gaps = [system.derivatives[f"roll_{w.number}"] for w in wheelsets]
    system.observe("largest_gap", "m", ca.mmax(ca.fabs(ca.vertcat(*gaps))))
