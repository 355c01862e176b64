"""Level 2, `planar`: a vehicle in its vertical plane; the bogie of chapter 5 has seven degrees of freedom there.

Each body moves along, up and down, and pitches; each wheelset moves along and turns, its wheels stay on a rigid, level
rail. This is the motion of the spatial level when track, loads and torques are symmetric about the vertical plane, with
nothing linearised: the same bodies and connections, with all that leaves the plane held.

Coordinates: x forward, z up, pitch positive nose down. `shift` is the longitudinal displacement of an axle relative to
its place in the vehicle; the axle heights do not change.
"""

from __future__ import annotations

import casadi as ca

from fmu_src.system import System
from rbd_model.adhesion import follow_patch
from rbd_model.assembly import Assembly, assemble
from rbd_model.bodies import add_axle_shift, place_body
from rbd_model.kinematics import Body
from rbd_model.motion import add_common_outputs, loads_of, move_bodies, observe_energy, react
from rbd_model.vehicle import Motion, Vehicle, wheelset_name
from rbd_model.wheelset import centred_load, roll_on_level_rail

OUT_OF_PLANE: frozenset[Motion] = frozenset({"lateral", "roll", "yaw"})


def planar_vehicle(vehicle: Vehicle) -> System:
    """A vehicle in its vertical plane (section 5.2), by Newton's and Euler's equations; see the module's text."""
    assembly = assemble("planar", "Bounce, pitch, load transfer, suspension", vehicle)
    system, p = assembly.system, assembly.parameter
    bodies = [place_body(assembly, data, OUT_OF_PLANE) for data in vehicle.bodies]
    axles = {number: place_axle(assembly, number) for number, _ in vehicle.numbered}
    places = [assembly.distance + axle.position[0] for axle in axles.values()]
    follow_patch(system, assembly.rail, f"{vehicle.bodies[0].name}_distance", places)
    loads = loads_of(assembly, bodies, axles)

    wheelsets = []
    for number, data in vehicle.numbered:
        carried = -loads.on(wheelset_name(number)).force[2]
        axle_load = assembly.value(data.mass) * p["gravity"] + carried
        distance, forward = assembly.distance + axles[number].position[0], axles[number].velocity[0]
        wheelsets.append(roll_on_level_rail(assembly, number, distance, forward, centred_load(axle_load), axle_load))
    react(assembly, wheelsets, loads)
    first = vehicle.bodies[0]
    first_acceleration = loads.on(first.name).force[0] / assembly.value(first.mass)
    move_bodies(assembly, bodies, loads, first_acceleration)
    accelerations = []
    for wheelset in wheelsets:
        number, pull = wheelset.number, loads.on(wheelset_name(wheelset.number)).force[0]
        accelerations.append((wheelset.creep_force + pull) / assembly.value(wheelset.data.mass))
        system.derivative(f"shift_speed_{number}", accelerations[-1] - first_acceleration)

    add_common_outputs(assembly, bodies, wheelsets, accelerations)
    kinetic = [
        assembly.value(w.data.mass) * w.forward**2 / 2
        + assembly.value(w.data.inertia[1]) * w.rotation.angular_velocity**2 / 2
        for w in wheelsets
    ]
    observe_energy(assembly, bodies, wheelsets, loads.effects, {"kinetic_energy": ca.SX(sum(kinetic))})
    for wheelset in wheelsets:
        static = assembly.value(wheelset.data.mass) * p["gravity"] + assembly.resting_on(wheelset.number)
        sentence = f"Wheelset {wheelset.number} lifted off the rail at %s s; the planar level ends here."
        system.end_when_negative(wheelset.load / static, sentence)
    return system


def place_axle(assembly: Assembly, number: int) -> Body:
    """A wheelset that moves along the track only, as a body that connections pull at; section 5.2."""
    shift, speed = add_axle_shift(assembly, number)
    along = assembly.value(assembly.vehicle.wheelsets[number - 1].along)
    none = ca.SX.zeros(3)
    return Body(ca.vertcat(along + shift, 0, 0), ca.vertcat(speed, 0, 0), ca.SX.eye(3), none, none)
