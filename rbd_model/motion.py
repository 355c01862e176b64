"""What connects bodies and wheelsets at a level of detail, moves them, and shows their speed and energy."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca

from rbd_model.assembly import Assembly
from rbd_model.bodies import MovingBody, move_body
from rbd_model.connections import Effect, End, Load, connect, total
from rbd_model.kinematics import Body
from rbd_model.vehicle import ANGLES, DIRECTIONS, RigidBody, Wheelset, wheelset_name
from rbd_model.wheelset import Rolling, add_wheelset_outputs


def end_of(assembly: Assembly, name: str, data: RigidBody | Wheelset, body: Body) -> End:
    """A body or wheelset as an end of connections, with the place of its centre at rest, eq. (3.1)."""
    height = assembly.value(data.height) if isinstance(data, RigidBody) else 0
    return End(name, body, ca.vertcat(assembly.value(data.along), 0, height))


@dataclass
class Loads:
    """Loads by body while they are added up, and what the connections did."""

    of: defaultdict[str, list[Load]] = field(default_factory=lambda: defaultdict(list))
    effects: list[Effect] = field(default_factory=list)

    def on(self, name: str) -> Load:
        """Sum of those on one body, eqs (3.35), (3.36)."""
        return total(self.of[name])


def loads_of(assembly: Assembly, bodies: Sequence[MovingBody], axles: Mapping[int, Body]) -> Loads:
    """Loads of all connections and of the forces from outside; axles: the wheelsets by number, eqs (3.35), (3.36)."""
    vehicle, loads = assembly.vehicle, Loads()
    ends = {moving.data.name: end_of(assembly, moving.data.name, moving.data, moving.body) for moving in bodies}
    for number, wheelset in vehicle.numbered:
        name = wheelset_name(number)
        ends[name] = end_of(assembly, name, wheelset, axles[number])
    for connection in vehicle.connections:
        loads.effects += connect(assembly, connection, ends)
    for effect in loads.effects:
        for name, load in effect.loads:
            loads.of[name].append(load)
    for pull in vehicle.pulls:
        end = ends[pull.body]
        place = ca.vertcat(*[ca.SX(assembly.value(size)) for size in pull.place])
        force = ca.vertcat(*[assembly.input[pull.name] if pull.direction == along else 0 for along in DIRECTIONS])
        loads.of[pull.body].append(Load(force, ca.cross(end.body.arm(place - end.centre), force)))
    return loads


def react(assembly: Assembly, wheelsets: Sequence[Rolling], loads: Loads) -> None:
    """Adds the share of brake and traction torque that reacts on the body that they hang in, about the axle.

    Differs from the thesis, which leaves it out (section 9.2): brakes and motors hang in the frame.
    """
    for wheelset in wheelsets:
        torque = wheelset.rotation.brake_torque - wheelset.rotation.traction_torque
        moment = assembly.parameter["torque_reaction"] * torque * wheelset.axle
        loads.of[wheelset.data.reacts_on].append(Load(ca.SX.zeros(3), moment))


def move_bodies(assembly: Assembly, bodies: Sequence[MovingBody], loads: Loads, first_acceleration: ca.SX) -> None:
    """Newton's and Euler's equations of all bodies, (3.73); first_acceleration [m/s2]: of the first, along x."""
    for moving in bodies:
        move_body(assembly, moving, loads.on(moving.data.name), first_acceleration)


def add_common_outputs(
    assembly: Assembly, bodies: Sequence[MovingBody], wheelsets: Sequence[Rolling], accelerations: Sequence[ca.SX]
) -> None:
    """Outputs of every level above the static one. Speed, distance and acceleration are means of the axles, where the
    experiment's instruments sat (section 6.3.4): at rest on locked wheels it is at rest, while what is above still
    rocks. accelerations [m/s2]: of the axles.
    """
    system, outputs, count = assembly.system, assembly.outputs, len(wheelsets)
    speed = ca.SX(sum(wheelset.forward for wheelset in wheelsets)) / count
    shifts = sum(system.states[f"shift_{wheelset.number}"].symbol for wheelset in wheelsets) / count
    system.output(outputs["speed"], speed)
    system.output(outputs["distance"], assembly.distance + shifts)
    system.output(outputs["acceleration"], ca.SX(sum(accelerations)) / count)
    for moving in bodies:
        for motion in ("lateral", "bounce", *ANGLES):
            name = moving.data.variable(motion)
            if name in system.states:
                system.output(outputs[name], system.states[name].symbol)
            elif motion in moving.data.held:
                system.output(outputs[name], 0)
    for wheelset in wheelsets:
        add_wheelset_outputs(assembly, wheelset, speed)


def observe_energy(
    assembly: Assembly,
    bodies: Sequence[MovingBody],
    wheelsets: Sequence[Rolling],
    effects: Sequence[Effect],
    further: Mapping[str, ca.SX],
) -> None:
    """Energies [J] and powers lost [W] (section 2.4); their sum stays while nothing drives: constraints do no work.

    further: what a level adds to them, the energies of its wheelsets among it.
    """
    gravity, reaction = assembly.parameter["gravity"], assembly.parameter["torque_reaction"]
    carriers = {moving.data.name: moving for moving in bodies}
    kinetic, potential, brake = ca.SX(0), ca.SX(0), ca.SX(0)
    for moving in bodies:
        kinetic += kinetic_energy(assembly, moving.data, moving.body)
        potential += assembly.value(moving.data.mass) * gravity * moving.body.position[2]
    for wheelset in wheelsets:
        # A torque that reacts on a body works on the difference of the two rotations.
        turned = ca.dot(wheelset.axle, carriers[wheelset.data.reacts_on].body.rate)
        rotation = wheelset.rotation
        brake += rotation.friction_torque * rotation.angular_velocity - reaction * rotation.brake_torque * turned
    potential += sum(effect.potential for effect in effects)
    damping = sum((effect.power for effect in effects), ca.SX(0))
    creep = sum((wheelset.creep_power for wheelset in wheelsets), ca.SX(0))
    own = {"kinetic_energy": kinetic, "potential_energy": potential, "brake_power": brake}
    for name, value in (own | {"creep_power": creep, "damping_power": damping}).items():
        unit = "J" if name.endswith("energy") else "W"
        assembly.system.observe(name, unit, value + further.get(name, ca.SX(0)))


def kinetic_energy(assembly: Assembly, data: RigidBody | Wheelset, body: Body) -> ca.SX:
    """Of a rigid body that moves and turns [J], section 2.4."""
    inertia = ca.vertcat(*[assembly.value(size) for size in data.inertia])
    return (assembly.value(data.mass) * ca.sumsqr(body.velocity) + ca.dot(inertia, body.own_rate**2)) / 2
