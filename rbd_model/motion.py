"""What connects bodies and wheelsets at a level of detail, moves them, and shows their speed and energy."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import casadi as ca

from fmu_src.system import System
from rbd_model.assembly import Assembly
from rbd_model.bodies import MovingBody, move_body
from rbd_model.connections import Effect, End, Load, Push, connect, seat_of
from rbd_model.kinematics import Body
from rbd_model.resistance import Resistance
from rbd_model.track_frame import HERE, Pose, relative
from rbd_model.vehicle import ANGLES, DIRECTIONS, RigidBody, Wheelset, wheelset_name
from rbd_model.wheelset import Rolling, add_wheelset_outputs

#: Operations down to which arms are compared: places of a description are sums of a few sizes.
DEPTH = 10


def end_of(assembly: Assembly, name: str, data: RigidBody | Wheelset, body: Body) -> End:
    """A body or wheelset as an end of connections, with the place of its centre at rest, eq. (3.1)."""
    height = assembly.value(data.height) if isinstance(data, RigidBody) else 0
    return End(name, body, ca.vertcat(assembly.value(data.along), 0, height))


@dataclass
class Loads:
    """Pushes while they are added up, by body and by the body that gives them their axes; what did them."""

    system: System
    bodies: dict[str, Body]
    poses: dict[tuple[str, str], Pose] = field(default_factory=dict)
    bodies_seen: dict[tuple[str, str], Body] = field(default_factory=dict)
    of: defaultdict[tuple[str, str], list[Push]] = field(default_factory=lambda: defaultdict(list))
    effects: list[Effect] = field(default_factory=list)

    def on(self, name: str) -> Load:
        """What all of them do to one body, eqs (3.35), (3.36)."""
        load = Load(ca.SX.zeros(3), ca.SX.zeros(3))
        for found in [self.total(seat, name) for on, seat in self.of if on == name]:
            load = Load(load.force + found.force, load.moment + found.moment)
        return load

    def total(self, seat: str, name: str) -> Load:
        """What those on one body do that have the axes of `seat`, eqs (3.35), (3.36).

        The moment of forces is u x (A^T F), with arms u that do not change: added up by their components before
        anything is turned.
        """
        pushes, own = self.of[name, seat], self.seen(seat, name).axes
        moment = own.T @ sum((push.moment for push in pushes), ca.SX.zeros(3))
        for component in range(3):
            shifted = levered([(push.arm[component], push.force) for push in pushes])
            moment += ca.cross(ca.SX.eye(3)[:, component], own.T @ shifted)
        force = self.system.narrow(sum((push.force for push in pushes), ca.SX.zeros(3)))
        return Load(self.pose(seat, name).axes.T @ force, moment)

    def pose(self, seat: str, name: str) -> Pose:
        """The track where a body is as seen from where `seat` is, section 3.2.1."""
        if (seat, name) not in self.poses:
            pose = relative(self.system, self.bodies[seat].track, self.bodies[name].track)
            self.poses |= {(seat, name): pose, (name, seat): pose.back}
        return self.poses[seat, name]

    def seen(self, seat: str, name: str) -> Body:
        """A body in the axes of the track where `seat` is, eq. (3.1)."""
        if (seat, name) not in self.bodies_seen:
            pose = self.pose(seat, name)
            body = self.bodies[name].seen(pose)
            if pose is not HERE:
                moved = ca.densify(ca.vertcat(body.position, body.velocity, ca.vec(body.axes)))
                position, velocity, axes = ca.vertsplit(self.system.narrow(moved), [0, 3, 6, 15])
                body = replace(body, position=position, velocity=velocity, axes=ca.reshape(axes, 3, 3))
            self.bodies_seen[seat, name] = body
        return self.bodies_seen[seat, name]

    def axle(self, wheelset: Rolling) -> ca.SX:
        """Unit vector along an axle in the axes of the track where its torque reacts on a body (section 9.2)."""
        return self.seen(wheelset.data.reacts_on, wheelset_name(wheelset.number)).axes[:, 1]


def levered(pushes: Sequence[tuple[ca.SX, ca.SX]]) -> ca.SX:
    """Sum of arms [m] times forces [N], of (3.42), shape (3,); forces on equal arms are added up before."""
    groups: list[tuple[ca.SX, ca.SX]] = []
    for arm, force in pushes:
        place = next((i for i, (known, _) in enumerate(groups) if ca.is_equal(known, arm, DEPTH)), len(groups))
        groups[place:] = [(arm, force if place == len(groups) else groups[place][1] + force), *groups[place + 1 :]]
    return sum((arm * force for arm, force in groups), ca.SX.zeros(3))


def loads_of(assembly: Assembly, bodies: Sequence[MovingBody], axles: Mapping[int, Body]) -> Loads:
    """Loads of all connections and of the forces from outside; axles: the wheelsets by number, eqs (3.35), (3.36)."""
    vehicle = assembly.vehicle
    ends = {moving.data.name: end_of(assembly, moving.data.name, moving.data, moving.body) for moving in bodies}
    for number, wheelset in vehicle.numbered:
        name = wheelset_name(number)
        ends[name] = end_of(assembly, name, wheelset, axles[number])
    loads = Loads(assembly.system, {name: end.body for name, end in ends.items()})
    for connection in vehicle.connections:
        seat = seat_of(vehicle, connection)
        both = [replace(ends[name], body=loads.seen(seat, name)) for name in (connection.upper, connection.lower)]
        effects = connect(assembly, connection, (both[0], both[1]), ends[seat].body.spin)
        for effect in effects:
            for name, push in effect.pushes:
                loads.of[name, seat].append(push)
        loads.effects += effects
    for pull in vehicle.pulls:
        end = ends[pull.body]
        place = ca.vertcat(*[ca.SX(assembly.value(size)) for size in pull.place])
        force = ca.vertcat(*[assembly.input[pull.name] if pull.direction == along else 0 for along in DIRECTIONS])
        loads.of[pull.body, pull.body].append(Push(force, ca.SX.zeros(3), place - end.centre))
    return loads


def react(assembly: Assembly, wheelsets: Sequence[Rolling], loads: Loads) -> None:
    """Adds the share of brake and traction torque that reacts on the body that they hang in, about the axle.

    Differs from the thesis, which leaves it out (section 9.2): brakes and motors hang in the frame.
    """
    for wheelset in wheelsets:
        torque = wheelset.rotation.brake_torque - wheelset.rotation.traction_torque
        carrier, none = wheelset.data.reacts_on, ca.SX.zeros(3)
        moment = assembly.parameter["torque_reaction"] * torque * loads.axle(wheelset)
        loads.of[carrier, carrier].append(Push(none, moment, none))


def pull_first_body(
    assembly: Assembly, resistance: Resistance, pulled: ca.SX, falling: ca.SX, share: ca.SX | float = 1.0
) -> ca.SX:
    """Acceleration of the vehicle's first body along the track [m/s2], (3.73), which running resistance holds back.

    pulled [N], falling [m/s2]: by its connections and by gravity. share: 0 where the speed is held (sections 4.2, 5.2).
    Declare it before what holds wheelsets, whose velocities count from this body's.
    """
    first = assembly.vehicle.bodies[0]
    mass = assembly.value(first.mass)
    resistance.hold(assembly.system, f"{first.name}_speed", pulled + mass * falling)
    moves, lightness = share * resistance.moves, share / mass
    return resistance.moves * lightness * pulled + moves * falling + lightness * resistance.force


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
    loads: Loads,
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
        potential += assembly.value(moving.data.mass) * gravity * elevation(assembly, moving.body)
    for wheelset in wheelsets:
        # A torque that reacts on a body works on the difference of the two rotations.
        carrier = carriers[wheelset.data.reacts_on].body
        turned = ca.dot(loads.axle(wheelset), carrier.rate)
        rotation = wheelset.rotation
        kinetic += assembly.drive_inertia * rotation.angular_velocity**2 / 2
        brake += rotation.friction_torque * rotation.angular_velocity - reaction * rotation.brake_torque * turned
    potential += sum(effect.potential for effect in loads.effects)
    damping = sum((effect.power for effect in loads.effects), ca.SX(0))
    creep = sum((wheelset.creep_power for wheelset in wheelsets), ca.SX(0))
    own = {"kinetic_energy": kinetic, "potential_energy": potential, "brake_power": brake}
    for name, value in (own | {"creep_power": creep, "damping_power": damping}).items():
        unit = "J" if name.endswith("energy") else "W"
        assembly.system.observe(name, unit, value + further.get(name, ca.SX(0)))


def elevation(assembly: Assembly, body: Body) -> ca.SX:
    """Height of a body [m], for its energy (section 2.4); straight track on a gradient rises along the distance."""
    return body.track.elevation(body.position + ca.vertcat(assembly.distance, 0, 0))


def kinetic_energy(assembly: Assembly, data: RigidBody | Wheelset, body: Body) -> ca.SX:
    """Of a rigid body that moves and turns [J], section 2.4."""
    inertia = ca.vertcat(*[assembly.value(size) for size in data.inertia])
    return (assembly.value(data.mass) * ca.sumsqr(body.velocity) + ca.dot(inertia, body.own_rate**2)) / 2
