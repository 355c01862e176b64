"""Level 1, `point`: one speed and two wheel speeds on static axle loads, eq. (2.8).

m dV/dt = -F_x,   F_z = m g,   J dw/dt = F_x r_w - T_B

Good far from the adhesion limit; it does not know that braking moves load to the leading wheelset, and so misses or
misjudges a lock-up near the limit.
"""

from __future__ import annotations

from fmu_src.system import System
from rbd_model.adhesion import follow_patch
from rbd_model.parameters import BogieParameters
from rbd_model.wheelset import (
    NOMINAL_DISTANCE,
    NOMINAL_SPEED,
    SPATIAL_INPUTS,
    WHEELSET_PARAMETERS,
    CentredLoad,
    add_wheelset,
    add_wheelset_outputs,
    centred_contact,
    centred_load,
    follow_creep,
    start_bogie,
)


def point_bogie(defaults: BogieParameters) -> System:
    """The two-wheelset bogie as eq. (2.8): distance, speed, and rotation and angular velocity of each wheelset."""
    used = ("frame_mass", "wheel_base", *WHEELSET_PARAMETERS)
    bogie = start_bogie("point", "Speed and wheel speeds, static loads", defaults, used, SPATIAL_INPUTS)
    system, p = bogie.system, bogie.parameter
    distance = system.state("distance", "m", 0.0, NOMINAL_DISTANCE)
    speed = system.state("speed", "m/s", bogie.initial_speed, NOMINAL_SPEED)

    follow_creep(bogie, "speed")
    follow_patch(system, bogie.rail, "distance")
    load = (p["wheelset_mass"] + p["frame_mass"] / 2) * p["gravity"]
    contact, static = centred_contact(bogie), centred_load(load)
    static = CentredLoad(system.derived("wheel_load", static.wheel), system.derived("load_growth", static.growth))
    places = {1: distance + p["wheel_base"] / 2, 2: distance - p["wheel_base"] / 2}
    wheelsets = [add_wheelset(bogie, number, contact, place, speed, static) for number, place in places.items()]
    total_mass = p["frame_mass"] + 2 * p["wheelset_mass"]
    force = wheelsets[0].creep_force + wheelsets[1].creep_force + bogie.input["drawbar_force"]
    system.derivative("distance", speed)
    system.derivative("speed", force / total_mass)

    system.output(bogie.outputs["speed"], speed)
    system.output(bogie.outputs["distance"], distance)
    system.output(bogie.outputs["acceleration"], force / total_mass)
    for wheelset in wheelsets:
        add_wheelset_outputs(bogie, wheelset.rotation, speed, wheelset.creep_force, load)
    return system
