"""Level 2, `planar`: the bogie in its vertical plane, seven degrees of freedom.

The sprung mass moves along, up and down, and pitches; each wheelset moves along and turns, its wheels stay on a rigid,
level rail. This is the motion of chapter 5's fourteen degrees of freedom when track, loads and torques are symmetric
about the vertical plane, with nothing linearised.

Coordinates: x forward, z up, pitch positive nose down. `shift` is the longitudinal displacement of an axle relative to
its place under the sprung mass; the axle heights do not change.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmu_src.system import System
from rbd_model.adhesion import follow_patch
from rbd_model.parameters import BogieParameters
from rbd_model.wheelset import (
    NOMINAL_DISTANCE,
    NOMINAL_SPEED,
    NOMINAL_TRAVEL,
    NOMINAL_TRAVEL_SPEED,
    SPATIAL_INPUTS,
    WHEELSET_PARAMETERS,
    Bogie,
    Wheelset,
    add_wheelset,
    add_wheelset_outputs,
    centred_contact,
    centred_load,
    follow_creep,
    start_bogie,
)

PLANAR_PARAMETERS = (
    "frame_mass",
    "frame_pitch_inertia",
    "frame_height",
    "wheel_base",
    "longitudinal_stiffness",
    "vertical_stiffness",
    "longitudinal_damping",
    "vertical_damping",
    "torque_reaction",
)
#: Two suspension elements act on each wheelset.
ELEMENTS = 2


@dataclass(frozen=True)
class Axle:
    """One axle along the track, and its suspension: forces on the sprung mass at the arm (x, z) from its centre."""

    distance: ca.SX
    forward_speed: ca.SX
    forward: ca.SX
    upward: ca.SX
    arm: tuple[ca.SX, ca.SX]
    potential: ca.SX
    damping_power: ca.SX


def planar_bogie(defaults: BogieParameters) -> System:
    """The bogie of section 5.2 in its vertical plane, by Newton's and Euler's equations; see the module's text."""
    used = (*PLANAR_PARAMETERS, *WHEELSET_PARAMETERS)
    bogie = start_bogie("planar", "Bounce, pitch, load transfer, suspension", defaults, used, SPATIAL_INPUTS)
    system, p = bogie.system, bogie.parameter
    system.state("frame_distance", "m", 0.0, NOMINAL_DISTANCE)
    speed = system.state("frame_speed", "m/s", bogie.initial_speed, NOMINAL_SPEED)
    follow_creep(bogie, "frame_speed")
    follow_patch(system, bogie.rail, "frame_distance")
    system.state("bounce", "m", 0.0, NOMINAL_TRAVEL)
    bounce_speed = system.state("bounce_speed", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    system.state("pitch", "rad", 0.0, NOMINAL_TRAVEL)
    pitch_rate = system.state("pitch_rate", "rad/s", 0.0, NOMINAL_TRAVEL_SPEED)

    axles = [add_axle(bogie, number) for number in (1, 2)]
    loads = [p["wheelset_mass"] * p["gravity"] + axle.upward for axle in axles]
    contact = centred_contact(bogie)
    wheelsets = [
        add_wheelset(bogie, number, contact, axle.distance, axle.forward_speed, centred_load(load))
        for number, axle, load in zip((1, 2), axles, loads, strict=True)
    ]

    mass = p["frame_mass"]
    acceleration = (sum(axle.forward for axle in axles) + bogie.input["drawbar_force"]) / mass
    # Moment about y of a force (X, Z) at an arm (x, z): z X - x Z. Torques that react on the frame turn it the way
    # they slow the wheel: braking presses the nose down.
    moment = sum(axle.arm[1] * axle.forward - axle.arm[0] * axle.upward for axle in axles)
    reaction = sum(w.rotation.brake_torque - w.rotation.traction_torque for w in wheelsets)
    pitch_acceleration = (moment + p["torque_reaction"] * reaction) / p["frame_pitch_inertia"]
    system.derivative("frame_distance", speed)
    system.derivative("frame_speed", acceleration)
    system.derivative("bounce", bounce_speed)
    system.derivative("bounce_speed", sum(axle.upward for axle in axles) / mass - p["gravity"])
    system.derivative("pitch", pitch_rate)
    system.derivative("pitch_rate", pitch_acceleration)
    for axle, wheelset in zip(axles, wheelsets, strict=True):
        number = wheelset.rotation.number
        system.derivative(f"shift_{number}", system.states[f"shift_speed_{number}"].symbol)
        along = (wheelset.creep_force - axle.forward) / p["wheelset_mass"]
        system.derivative(f"shift_speed_{number}", along - acceleration)

    add_outputs(bogie, axles, wheelsets, loads)
    observe_energy(bogie, axles, wheelsets)
    for number, load in zip((1, 2), loads, strict=True):
        static = (p["wheelset_mass"] + mass / 2) * p["gravity"]
        sentence = f"Wheelset {number} lifted off the rail at %s s; the planar level ends here."
        system.end_when_negative(load / static, sentence)
    return system


def add_axle(bogie: Bogie, number: int) -> Axle:
    """Suspension of wheelset 1 or 2 in level axes, eqs (3.38), (3.41), attached below the centre of mass.

    The static load is a constant upward force at the attachment point, so that it turns with the frame.
    """
    system, p = bogie.system, bogie.parameter
    shift = system.state(f"shift_{number}", "m", 0.0, NOMINAL_TRAVEL)
    shift_speed = system.state(f"shift_speed_{number}", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    bounce, bounce_speed, pitch, pitch_rate, speed = (
        system.states[name].symbol for name in ("bounce", "bounce_speed", "pitch", "pitch_rate", "frame_speed")
    )
    half = p["wheel_base"] / 2 if number == 1 else -p["wheel_base"] / 2
    height = p["frame_height"]
    # The attachment point is (half, -height) from the centre, turned by the pitch.
    arm_x = half * ca.cos(pitch) - height * ca.sin(pitch)
    arm_z = -half * ca.sin(pitch) - height * ca.cos(pitch)
    stretch_x = half + shift - arm_x
    stretch_x_rate = shift_speed - pitch_rate * arm_z
    rise = bounce + arm_z + height
    rise_rate = bounce_speed - pitch_rate * arm_x

    preload = p["frame_mass"] * p["gravity"] / 2
    spring_x, damper_x = ELEMENTS * p["longitudinal_stiffness"], ELEMENTS * p["longitudinal_damping"]
    spring_z, damper_z = ELEMENTS * p["vertical_stiffness"], ELEMENTS * p["vertical_damping"]
    forward = spring_x * stretch_x + damper_x * stretch_x_rate
    upward = preload - spring_z * rise - damper_z * rise_rate
    potential = spring_x * stretch_x**2 / 2 + spring_z * rise**2 / 2 - preload * rise
    damping_power = damper_x * stretch_x_rate**2 + damper_z * rise_rate**2
    distance = system.states["frame_distance"].symbol + half + shift
    return Axle(distance, speed + shift_speed, forward, upward, (arm_x, arm_z), potential, damping_power)


def add_outputs(bogie: Bogie, axles: list[Axle], wheelsets: list[Wheelset], loads: list[ca.SX]) -> None:
    """Outputs. Speed, distance and acceleration are those of the axles (mean of the two), where the experiment's
    instruments sat (section 6.3.4): a bogie at rest on locked wheels is at rest, while its frame still rocks.
    """
    system, mass = bogie.system, bogie.parameter["wheelset_mass"]
    value = {name: state.symbol for name, state in system.states.items()}
    speed = (axles[0].forward_speed + axles[1].forward_speed) / 2
    system.output(bogie.outputs["speed"], speed)
    system.output(bogie.outputs["distance"], value["frame_distance"] + (value["shift_1"] + value["shift_2"]) / 2)
    accelerations = [(w.creep_force - axle.forward) / mass for w, axle in zip(wheelsets, axles, strict=True)]
    system.output(bogie.outputs["acceleration"], (accelerations[0] + accelerations[1]) / 2)
    system.output(bogie.outputs["bounce"], value["bounce"])
    system.output(bogie.outputs["pitch"], value["pitch"])
    for wheelset, load in zip(wheelsets, loads, strict=True):
        add_wheelset_outputs(bogie, wheelset.rotation, speed, wheelset.creep_force, load)


def observe_energy(bogie: Bogie, axles: list[Axle], wheelsets: list[Wheelset]) -> None:
    """Energies [J] and powers lost [W] (section 2.4); their sum stays while no traction or drawbar force acts."""
    system, p = bogie.system, bogie.parameter
    value = {name: state.symbol for name, state in system.states.items()}
    kinetic = p["frame_mass"] * (value["frame_speed"] ** 2 + value["bounce_speed"] ** 2) / 2
    kinetic += p["frame_pitch_inertia"] * value["pitch_rate"] ** 2 / 2
    for axle, wheelset in zip(axles, wheelsets, strict=True):
        kinetic += p["wheelset_mass"] * axle.forward_speed**2 / 2
        kinetic += p["wheelset_pitch_inertia"] * wheelset.rotation.angular_velocity**2 / 2
    potential = sum(axle.potential for axle in axles) + p["frame_mass"] * p["gravity"] * value["bounce"]
    turning = [
        w.rotation.friction_torque * w.rotation.angular_velocity
        - p["torque_reaction"] * w.rotation.brake_torque * value["pitch_rate"]
        for w in wheelsets
    ]
    system.observe("kinetic_energy", "J", kinetic)
    system.observe("potential_energy", "J", potential)
    system.observe("brake_power", "W", turning[0] + turning[1])
    system.observe("creep_power", "W", ca.SX(sum(-w.creep_force * w.sliding_speed for w in wheelsets)))
    system.observe("damping_power", "W", axles[0].damping_power + axles[1].damping_power)
