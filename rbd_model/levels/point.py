"""Level 1, `point`: one speed and the wheel speeds on static axle loads, eq. (2.8).

m dV/dt = -F_x,   F_z = m g,   J dw/dt = F_x r_w - T_B

This level is valid far from the adhesion limit. It does not model the load transfer to the leading wheelsets during
braking. It may therefore miss a lock-up near the limit, or compute it wrongly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.contact.creep.law import SMALLEST_LOAD, at_least
from rbd_model.levels.resistance import Resistance, add_resistance
from rbd_model.track.friction import follow_patch
from rbd_model.track.line_table import along_line, follow_line
from rbd_model.vehicle.assembly import Assembly, assemble
from rbd_model.vehicle.description import Vehicle
from rbd_model.wheelset.level_rail import CentredLoad, Creeping, centred_load, creep_on_level_rail, roll_on_level_rail
from rbd_model.wheelset.rotation import (
    Grip,
    Hold,
    add_hold,
    add_wheelset_outputs,
    follow_creep,
    stand_still,
    traction_force,
)


def point_vehicle(vehicle: Vehicle, on_line: bool = False) -> System:
    """Return a vehicle as eq. (2.8): distance, speed, and rotation and angular velocity of each wheelset.

    Masses add up.
    """
    assembly = assemble("point", "Speed and wheel speeds, static loads", vehicle, "", on_line)
    system, distance, speed = assembly.system, assembly.distance, assembly.speed
    follow_creep(assembly, speed, speed)
    places = [distance + assembly.value(data.along) for data in vehicle.wheelsets]
    follow_patch(system, assembly.rail, distance, places)
    if on_line:
        follow_line(system, distance, [distance + assembly.value(part.along) for part in vehicle.parts])

    mass, gradient = assembly.total_mass, mean_gradient(assembly) if on_line else assembly.input["gradient"]
    loads = [static_load(assembly, number) for number, _ in vehicle.numbered]
    creeping = [
        creep_on_level_rail(assembly, number, place, speed, *load)
        for (number, _), place, load in zip(vehicle.numbered, places, loads, strict=True)
    ]
    resistance = add_resistance(assembly, speed, places)
    pulls = [assembly.input[pull.name] for pull in vehicle.pulls]
    outside = ca.SX(sum(pulls)) - mass * assembly.parameter["gravity"] * gradient
    pulled = outside + sum((one.force for one in creeping), ca.SX(0))
    holds, held = stand_on_locked_wheels(assembly, creeping, outside, pulled, resistance)
    resistance.hold(system, speed, holds[0].moves * pulled)
    acceleration = holds[0].moves * (resistance.moves * pulled + resistance.force) / mass
    wheelsets = [
        roll_on_level_rail(assembly, one, hold, (ca.SX(0), speed), axle_load, force)
        for one, hold, (_, axle_load), force in zip(creeping, holds, loads, held, strict=True)
    ]
    system.derivative(distance, speed)
    system.derivative(speed, acceleration)

    system.output(assembly.outputs["speed"], speed)
    system.output(assembly.outputs["distance"], distance)
    system.output(assembly.outputs["acceleration"], acceleration)
    for wheelset in wheelsets:
        add_wheelset_outputs(assembly, wheelset, speed)
    return system


def mean_gradient(assembly: Assembly) -> ca.SX:
    """Return the mean gradient of the line below all masses, weighted with them, for the force of gravity.

    Section 2.3.1.
    """
    pull = ca.SX(0)
    for part in assembly.vehicle.parts:
        distance = assembly.distance + assembly.value(part.along)
        pull += assembly.value(part.mass) * along_line(assembly.system, "rise", distance, 1)[1]
    return pull / assembly.total_mass


def stand_on_locked_wheels(
    assembly: Assembly, creeping: Sequence[Creeping], outside: ca.SX, pulled: ca.SX, resistance: Resistance
) -> tuple[list[Hold], list[ca.SX]]:
    """Return the holds of each wheelset, third line of (2.8), and the holding forces of its rails on a standing vehicle
    [N].

    outside, pulled [N]: forces along the track, without and with creep. Locked wheelsets hold, each by its `Grip`.
    Running resistance holds with them. All forces are in proportion to their maximum.
    """
    moving = assembly.system.direction("moving")
    speed = assembly.speed
    holds = [replace(add_hold(assembly.system, one.number, speed), moving=moving) for one in creeping]
    both = list(zip(holds, creeping, strict=True))
    grips = [Grip.of(assembly, one.number, hold, one.static) for hold, one in both]
    rolling = sum((hold.turns * one.force for hold, one in both), ca.SX(0))
    traction = sum(((1 - hold.turns) * traction_force(assembly, one.number) for hold, one in both), ca.SX(0))
    able, braked = (sum(all_, ca.SX(0)) for all_ in zip(*((grip.able, grip.braked) for grip in grips), strict=True))
    whole = Grip(able, braked, sum((grip.whole for grip in grips), resistance.steady))
    stand_still(assembly, "The vehicle", holds[0], [speed], (outside + rolling, traction), whole)
    share = (holds[0].moves - 1) * pulled / at_least(whole.whole, SMALLEST_LOAD)
    return holds, [share * grip.whole for grip in grips]


def static_load(assembly: Assembly, number: int) -> tuple[CentredLoad, ca.SX]:
    """Return the static load of a wheelset on level track [N], second line of eq. (2.8), and that of each wheel.

    On a gradient it is too large by the gradient's cosine, 8e-4 at 40 per mille; level 2 includes this effect.
    """
    system, data = assembly.system, assembly.vehicle.wheelsets[number - 1]
    weight = assembly.value(data.mass) * assembly.parameter["gravity"] + assembly.resting_on(number)
    axle_load = system.derived(f"static_load_{number}", weight)
    load = centred_load(axle_load)
    growth = system.derived(f"load_growth_{number}", load.growth)
    return CentredLoad(system.derived(f"wheel_load_{number}", load.wheel), growth), axle_load
