"""Level 2, `planar`: a vehicle in its vertical plane; the bogie of chapter 5 has seven degrees of freedom there.

Each body moves along, up and down, and pitches; each wheelset moves along and turns, its wheels stay on a rigid, level
rail. This is the motion of the spatial level when track, loads and torques are symmetric about the vertical plane, with
nothing linearised: the same bodies and connections, with all that leaves the plane held.

Coordinates: x forward, z up, pitch positive nose down. `shift` is the longitudinal displacement of an axle relative to
its place in the vehicle; the axle heights do not change.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from fmu_src.symbols import ca
from fmu_src.system import System
from rbd_model.body.bodies import Shift, move_along, place_bodies
from rbd_model.body.kinematics import Body
from rbd_model.body.suspension import loads_of
from rbd_model.levels.common import add_common_outputs, elevation, move_bodies, observe_energy, pull_first_body, react
from rbd_model.levels.resistance import add_resistance
from rbd_model.levels.steady import start_steady
from rbd_model.track.frame import on_gradient, on_profile
from rbd_model.track.friction import follow_patch
from rbd_model.track.line_table import follow_line
from rbd_model.vehicle.assembly import Assembly, assemble
from rbd_model.vehicle.description import Motion, Vehicle, wheelset_name
from rbd_model.wheelset.level_rail import centred_load, creep_on_level_rail, roll_on_level_rail
from rbd_model.wheelset.rotation import Grip, RollingWheelset, add_axle_shift, add_hold, stand_still, traction_force

OUT_OF_PLANE: frozenset[Motion] = frozenset({"lateral", "roll", "yaw"})


def planar_vehicle(vehicle: Vehicle, on_line: bool = False) -> System:
    """Return a vehicle in its vertical plane (section 5.2), by Newton's and Euler's equations; see the module."""
    first = vehicle.bodies[0]
    assembly = assemble("planar", "Bounce, pitch, load transfer, suspension", vehicle, f"{first.name}_", on_line)
    assembly = put_in_plane(assembly)
    system, p = assembly.system, assembly.parameter
    assembly, bodies = place_bodies(assembly, OUT_OF_PLANE)
    placed = {number: place_axle(assembly, number) for number, _ in vehicle.numbered}
    axles = {number: axle for number, (axle, _) in placed.items()}
    places = [assembly.distance + axle.position[0] for axle in axles.values()]
    follow_patch(system, assembly.rail, assembly.distance, places)
    if on_line:
        parts = [assembly.distance + assembly.value(part.along) for part in vehicle.parts]
        follow_line(system, assembly.distance, parts)
    loads = loads_of(assembly, bodies, axles)
    falling = bodies[0].body.falling(p["gravity"])[0]
    resistance = add_resistance(assembly, assembly.speed, places)
    first_acceleration = pull_first_body(assembly, resistance, loads.on(first.name).force[0], falling)

    every = [roll_under_load(assembly, n, *placed[n], loads.on(wheelset_name(n)).force) for n, _ in vehicle.numbered]
    wheelsets = [rolling for rolling, _ in every]
    react(assembly, wheelsets, loads)
    move_bodies(assembly, bodies, loads, first_acceleration)
    for wheelset, acceleration in every:
        system.derivative(placed[wheelset.number][1].lead, acceleration - first_acceleration)

    start_steady(assembly, loads.bodies.values(), wheelsets)
    add_common_outputs(assembly, bodies, wheelsets, [acceleration for _, acceleration in every])
    kinetic = [
        assembly.value(w.data.mass) * w.forward**2 / 2
        + assembly.value(w.data.inertia[1]) * w.rotation.angular_velocity**2 / 2
        for w in wheelsets
    ]
    weights = [assembly.value(data.mass) * p["gravity"] for _, data in vehicle.numbered]
    heights = [elevation(assembly, axle) for axle in axles.values()]
    potential = sum(weight * height for weight, height in zip(weights, heights, strict=True))
    energies = {"kinetic_energy": ca.SX(sum(kinetic)), "potential_energy": ca.SX(potential)}
    energies["damping_power"] = resistance.power
    observe_energy(assembly, bodies, wheelsets, loads, energies)
    for wheelset in wheelsets:
        static = assembly.value(wheelset.data.mass) * p["gravity"] + assembly.resting_on(wheelset.number)
        sentence = f"Wheelset {wheelset.number} lifted off the rail at %s s; the planar level ends here."
        system.end_when_negative(wheelset.load / static, sentence)
    return system


def roll_under_load(
    assembly: Assembly, number: int, axle: Body, shift: Shift, pull: ca.SX
) -> tuple[RollingWheelset, ca.SX]:
    """Return a wheelset below its suspension, eq. (2.8), and its acceleration along the track [m/s2].

    pull [N]: force of its suspension on it.
    """
    data = assembly.vehicle.wheelsets[number - 1]
    mass, falling = assembly.value(data.mass), axle.falling(assembly.parameter["gravity"])
    axle_load = -pull[2] - mass * falling[2]
    distance, forward = assembly.distance + axle.position[0], axle.velocity[0]
    creeping = creep_on_level_rail(assembly, number, distance, forward, centred_load(axle_load), axle_load)
    hold, outside = add_hold(assembly.system, number, forward), pull[0] + mass * falling[0]
    pushed, grip = (outside, traction_force(assembly, number)), Grip.of(assembly, number, hold, creeping.static)
    stand_still(assembly, f"Wheelset {number}", hold, [shift.lead, assembly.speed], pushed, grip)
    pulled = outside + creeping.force
    held = (hold.moves - 1) * pulled
    return roll_on_level_rail(
        assembly, creeping, hold, (shift.place, forward), axle_load, held
    ), hold.moves * pulled / mass


def place_axle(assembly: Assembly, number: int) -> tuple[Body, Shift]:
    """Return a wheelset that moves along the track only, as an end of connections; section 5.2."""
    shift = add_axle_shift(assembly, number)
    along = assembly.value(assembly.vehicle.wheelsets[number - 1].along) + shift.place
    none = ca.SX.zeros(3)
    place = ca.vertcat(along, 0, assembly.axle_height)
    body = Body(place, ca.vertcat(shift.speed, 0, 0), ca.SX.eye(3), none, none, assembly.track_at(along))
    body = replace(body, own_rate=body.spin)
    move_along(assembly, body, shift)
    return body, shift


def put_in_plane(assembly: Assembly) -> Assembly:
    """Return the assembly with the track's axes in its vertical plane: on the input gradient, or the line's profile.

    On a line, heights are relative to the rails, as in the 3D model. An input gradient turns gravity alone
    (section 5.2).
    """
    if not assembly.on_line:
        everywhere = on_gradient(assembly.input["gradient"])
        return replace(assembly, frame_at=lambda distance: everywhere)
    radius = assembly.radius(assembly.vehicle.wheelsets[0])
    return replace(assembly, axle_height=radius, frame_at=partial(on_profile, assembly.system))
