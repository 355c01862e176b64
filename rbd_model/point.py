"""Level 1, `point`: one speed and the wheel speeds on static axle loads, eq. (2.8).

m dV/dt = -F_x,   F_z = m g,   J dw/dt = F_x r_w - T_B

Good far from the adhesion limit; it does not know that braking moves load to the leading wheelsets, and so misses or
misjudges a lock-up near the limit.
"""

from __future__ import annotations

import casadi as ca

from fmu_src.system import System
from rbd_model.adhesion import follow_patch
from rbd_model.assembly import Assembly, assemble
from rbd_model.vehicle import Vehicle
from rbd_model.wheelset import (
    NOMINAL_DISTANCE,
    NOMINAL_SPEED,
    CentredLoad,
    Rolling,
    add_wheelset_outputs,
    centred_load,
    follow_creep,
    roll_on_level_rail,
)


def point_vehicle(vehicle: Vehicle) -> System:
    """A vehicle as eq. (2.8): distance, speed, and rotation and angular velocity of each wheelset; masses add up."""
    assembly = assemble("point", "Speed and wheel speeds, static loads", vehicle)
    system = assembly.system
    assembly.distance = distance = system.state("distance", "m", 0.0, NOMINAL_DISTANCE)
    assembly.speed = speed = system.state("speed", "m/s", assembly.initial_speed, NOMINAL_SPEED)
    follow_creep(assembly, speed, "speed")
    places = [distance + assembly.value(data.along) for data in vehicle.wheelsets]
    follow_patch(system, assembly.rail, "distance", places)

    wheelsets = [roll_under_static_load(assembly, number) for number, _ in vehicle.numbered]
    masses = [*(body.mass for body in vehicle.bodies), *(wheelset.mass for wheelset in vehicle.wheelsets)]
    mass = system.derived("total_mass", ca.SX(sum(assembly.value(size) for size in masses)))
    pulls = [assembly.input[pull.name] for pull in vehicle.pulls]
    acceleration = ca.SX(sum([*(wheelset.creep_force for wheelset in wheelsets), *pulls])) / mass
    system.derivative("distance", speed)
    system.derivative("speed", acceleration)

    system.output(assembly.outputs["speed"], speed)
    system.output(assembly.outputs["distance"], distance)
    system.output(assembly.outputs["acceleration"], acceleration)
    for wheelset in wheelsets:
        add_wheelset_outputs(assembly, wheelset, speed)
    return system


def roll_under_static_load(assembly: Assembly, number: int) -> Rolling:
    """A wheelset at its place in the vehicle, second line of eq. (2.8)."""
    system, data = assembly.system, assembly.vehicle.wheelsets[number - 1]
    weight = assembly.value(data.mass) * assembly.parameter["gravity"] + assembly.resting_on(number)
    axle_load = system.derived(f"static_load_{number}", weight)
    load = centred_load(axle_load)
    static = CentredLoad(
        system.derived(f"wheel_load_{number}", load.wheel), system.derived(f"load_growth_{number}", load.growth)
    )
    return roll_on_level_rail(
        assembly, number, assembly.distance + assembly.value(data.along), assembly.speed, static, axle_load
    )
