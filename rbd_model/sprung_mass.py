"""The sprung mass in space: six degrees of freedom, or five when its pitch is held (section 4.2)."""

from __future__ import annotations

import casadi as ca

from rbd_model.kinematics import Body, axes_rate, pitch_rotation, yaw_roll
from rbd_model.suspension import Load
from rbd_model.wheelset import (
    NOMINAL_DISTANCE,
    NOMINAL_SPEED,
    NOMINAL_TRAVEL,
    NOMINAL_TRAVEL_SPEED,
    Bogie,
    follow_creep,
)

#: Angles by name, each with the component of the angular velocity that is its state.
ANGLES = {"frame_roll": 0, "pitch": 1, "frame_yaw": 2}


def place_frame(bogie: Bogie, pitches: bool) -> Body:
    """Declares the states of the sprung mass (sections 4.2, 5.2); its position is counted from itself along the track.

    Angular velocities are in the axes of the body. With the pitch held, the mass still turns about its lateral axis as
    far as its yaw axis leans.
    """
    system, p = bogie.system, bogie.parameter
    system.state("frame_distance", "m", 0.0, NOMINAL_DISTANCE)
    speed = system.state("frame_speed", "m/s", bogie.initial_speed, NOMINAL_SPEED)
    follow_creep(bogie, "frame_speed")
    system.derivative("frame_distance", speed)
    position = {}
    for name in ("frame_lateral", "bounce", *ANGLES):
        if name == "pitch" and not pitches:
            continue
        unit = "rad" if name in ANGLES else "m"
        start = p["initial_lateral"] if name == "frame_lateral" else 0.0
        position[name] = system.state(name, unit, start, NOMINAL_TRAVEL)
        rate = system.state(f"{name}_rate", f"{unit}/s", 0.0, NOMINAL_TRAVEL_SPEED)
        if name not in ANGLES:
            system.derivative(name, rate)
    rates = {name: system.states[f"{name}_rate"].symbol for name in position}

    roll, pitch = position["frame_roll"], position.get("pitch", ca.SX(0))
    to_body = pitch_rotation(pitch)
    body_rate = ca.vertcat(rates["frame_roll"], rates.get("pitch", 0), rates["frame_yaw"])
    if not pitches:
        body_rate[1] = axes_rate(roll, body_rate)[1]
    rate = to_body @ body_rate  # in the yaw-roll axes
    system.derivative("frame_roll", rate[0])
    system.derivative("frame_yaw", rate[2] / ca.cos(roll))
    if pitches:
        system.derivative("pitch", rate[1] - axes_rate(roll, rate)[1])
    axes = yaw_roll(position["frame_yaw"], roll)
    height = p["wheel_radius"] + p["frame_height"] + position["bounce"]
    return Body(
        ca.vertcat(0, position["frame_lateral"], height),
        ca.vertcat(speed, rates["frame_lateral"], rates["bounce"]),
        axes @ to_body,
        body_rate,
    )


def hold_or_pull(bogie: Bogie, force: ca.SX) -> None:
    """Longitudinal acceleration of the sprung mass, by Newton's second law; force [N]: of the suspension.

    None at constant speed (sections 4.2, 5.2), where something pulls as much as needed.
    """
    p = bogie.parameter
    acceleration = (1 - p["constant_speed"]) / p["frame_mass"] * (force + bogie.input["drawbar_force"])
    bogie.system.derivative("frame_speed", acceleration)


def move_frame(bogie: Bogie, frame: Body, load: Load) -> None:
    """Newton's and Euler's equations of the sprung mass, but for its longitudinal motion: (3.73) in its own axes."""
    system, p = bogie.system, bogie.parameter
    lightness = 1 / p["frame_mass"]
    system.derivative("frame_lateral_rate", lightness * load.force[1])
    system.derivative("bounce_rate", lightness * load.force[2] - p["gravity"])
    inertia = ca.vertcat(*[p[f"frame_{name}_inertia"] for name in ("roll", "pitch", "yaw")])
    moment = frame.axes.T @ load.moment - ca.cross(frame.own_rate, inertia * frame.own_rate)
    if "pitch" in system.states:
        turning = moment / inertia
    else:
        turning = turning_without_pitch(system.states["frame_roll"].symbol, frame.own_rate, inertia, moment)
    for name, component in ANGLES.items():
        if name in system.states:
            system.derivative(f"{name}_rate", turning[component])


def turning_without_pitch(roll: ca.SX, rate: ca.SX, inertia: ca.SX, moment: ca.SX) -> ca.SX:
    """Angular acceleration in the own axes while something holds the pitch at 0 (section 4.2).

    What holds it has no moment about the roll axis and the vertical, (0, sin roll, cos roll) in the own axes, so that
    it does no work; the rate about the own lateral axis is that about the third one times tan(roll).
    """
    sine, cosine = ca.sin(roll), ca.cos(roll)
    lateral = rate[2] * rate[0] / cosine**2  # the part of its acceleration that comes from rolling
    about_vertical = sine * (moment[1] - inertia[1] * lateral) + cosine * moment[2]
    yaw = about_vertical / (inertia[1] * sine**2 / cosine + inertia[2] * cosine)
    return ca.vertcat(moment[0] / inertia[0], lateral + yaw * sine / cosine, yaw)
