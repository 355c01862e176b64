"""Level 1, `point`: one speed and the wheel speeds on static axle loads, eq. (2.8).

m dV/dt = -F_x,   F_z = m g,   J dw/dt = F_x r_w - T_B

Good far from the adhesion limit; it does not know that braking moves load to the leading wheelsets, and so misses or
misjudges a lock-up near the limit.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from fmu_src.system import System
from rbd_model.adhesion import follow_patch
from rbd_model.assembly import Assembly, assemble
from rbd_model.resistance import add_resistance
from rbd_model.vehicle import RigidBody, Vehicle, Wheelset
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


def point_vehicle(vehicle: Vehicle, on_line: bool = False) -> System:
    """A vehicle as eq. (2.8): distance, speed, and rotation and angular velocity of each wheelset; masses add up.

    on_line: with gradient and curvature of the line that an instance runs on, in place of those inputs.
    """
    name = "point_on_line" if on_line else "point"
    assembly = assemble(name, "Speed and wheel speeds, static loads", vehicle)
    assembly.on_line = on_line
    system = assembly.system
    assembly.distance = distance = system.state("distance", "m", 0.0, NOMINAL_DISTANCE)
    assembly.speed = speed = system.state("speed", "m/s", assembly.initial_speed, NOMINAL_SPEED)
    follow_creep(assembly, speed, "speed")
    places = [distance + assembly.value(data.along) for data in vehicle.wheelsets]
    follow_patch(system, assembly.rail, "distance", places)

    parts: list[RigidBody | Wheelset] = [*vehicle.bodies, *vehicle.wheelsets]
    mass = system.derived("total_mass", ca.SX(sum(assembly.value(part.mass) for part in parts)))
    gradient, curvatures = (line_under if on_line else line_from_inputs)(assembly, parts)
    wheelsets = [roll_under_static_load(assembly, number) for number, _ in vehicle.numbered]
    resistance = add_resistance(assembly, speed, curvatures, mass * assembly.parameter["gravity"])
    pulls = [assembly.input[pull.name] for pull in vehicle.pulls]
    pulled = ca.SX(sum([*(wheelset.creep_force for wheelset in wheelsets), *pulls, resistance[0]]))
    acceleration = pulled / mass - assembly.parameter["gravity"] * gradient
    system.derivative("distance", speed)
    system.derivative("speed", acceleration)

    system.output(assembly.outputs["speed"], speed)
    system.output(assembly.outputs["distance"], distance)
    system.output(assembly.outputs["acceleration"], acceleration)
    for wheelset in wheelsets:
        add_wheelset_outputs(assembly, wheelset, speed)
    return system


def line_from_inputs(assembly: Assembly, parts: Sequence[RigidBody | Wheelset]) -> tuple[ca.SX, list[ca.SX]]:
    """Gradient (its sine) and curvatures [1/m] under the wheelsets (2.8), for hosts that know the line themselves."""
    curvature = assembly.input["curvature"]
    return assembly.input["gradient"], [curvature for _ in assembly.vehicle.wheelsets]


def line_under(assembly: Assembly, parts: Sequence[RigidBody | Wheelset]) -> tuple[ca.SX, list[ca.SX]]:
    """The same of the line that an instance runs on: the mean of the gradients under all masses, weighted with them.

    So that what gravity pulls with is that of each body at its own place (section 2.3.1).
    """
    system, pull, curvatures = assembly.system, ca.SX(0), []
    for number, part in enumerate(parts):
        distance = assembly.distance + assembly.value(part.along)
        sine = system.along_line("rise", f"part_{number}", distance, 1)[1]
        pull += assembly.value(part.mass) * sine
        if isinstance(part, Wheelset):
            curvatures.append(system.along_line("heading", f"part_{number}", distance, 1)[1])
    return pull / system.derived_symbols["total_mass"], curvatures


def roll_under_static_load(assembly: Assembly, number: int) -> Rolling:
    """A wheelset at its place in the vehicle, second line of eq. (2.8), under the load that it has on level track.

    On a gradient that is too much by its cosine, 8e-4 at 40 per mille, which level 2 knows.
    """
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
