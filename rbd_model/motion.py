"""What connects bodies and wheelsets at a level of detail, moves them, and shows their speed and energy."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import casadi as ca

from fmu_src.system import System
from rbd_model.assembly import Assembly
from rbd_model.bodies import MovingBody, move_body
from rbd_model.connections import Effect, End, Load, connect, seat_of, total
from rbd_model.kinematics import Body
from rbd_model.track_frame import Pose, relative
from rbd_model.vehicle import ANGLES, DIRECTIONS, RigidBody, Wheelset, wheelset_name
from rbd_model.wheelset import Rolling, add_wheelset_outputs


def end_of(assembly: Assembly, name: str, data: RigidBody | Wheelset, body: Body) -> End:
    """A body or wheelset as an end of connections, with the place of its centre at rest, eq. (3.1)."""
    height = assembly.value(data.height) if isinstance(data, RigidBody) else 0
    return End(name, body, ca.vertcat(assembly.value(data.along), 0, height))


@dataclass
class Loads:
    """Loads while they are added up, by body and by the body in whose axes of the track they are; what did them."""

    system: System
    bodies: dict[str, Body]
    poses: dict[tuple[str, str], Pose | None] = field(default_factory=dict)
    seen: dict[tuple[str, str], End] = field(default_factory=dict)
    of: defaultdict[tuple[str, str], list[Load]] = field(default_factory=lambda: defaultdict(list))
    effects: list[Effect] = field(default_factory=list)

    def add(self, name: str, seat: str, load: Load) -> None:
        """Adds a load on a body, given in the axes of the track where `seat` is; straight track has but one."""
        straight = self.pose(name, seat) is None
        self.of[name, name if straight else seat].append(load)

    def on(self, name: str) -> Load:
        """Sum of those on one body, eqs (3.35), (3.36), in the axes of the track where it is."""
        return total([self.turned(seat, name, total(loads)) for (on, seat), loads in self.of.items() if on == name])

    def pose(self, seat: str, name: str) -> Pose | None:
        """The track where a body is as seen from where `seat` is, section 3.2.1; None: all is straight track."""
        if (seat, name) not in self.poses:
            back = self.poses.get((name, seat))
            found = relative(self.system, self.bodies[seat].track, self.bodies[name].track) if back is None else None
            self.poses[seat, name] = found if back is None else (back[0].T, -back[0].T @ back[1])
        return self.poses[seat, name]

    def turned(self, seat: str, name: str, load: Load) -> Load:
        """A load in the axes of the track where `seat` is as one in those of another body."""
        pose = self.pose(name, seat) if seat != name else None
        if pose is None:
            return load
        force, moment = ca.vertsplit(self.system.narrow(ca.densify(ca.vertcat(load.force, load.moment))), 3)
        return Load(pose[0] @ force, pose[0] @ moment)

    def seen_from(self, seat: str, end: End) -> End:
        """An end of connections in the axes of the track where `seat` is, eq. (3.12)."""
        pose = self.pose(seat, end.name)
        if pose is None:
            return end
        if (seat, end.name) not in self.seen:
            body = end.body.seen_from(self.bodies[seat], pose)
            parts = (body.position, body.velocity, ca.vec(body.axes), body.own_rate)
            narrowed = self.system.narrow(ca.densify(ca.vertcat(*parts)))
            position, velocity, axes, own_rate = ca.vertsplit(narrowed, [0, 3, 6, 15, 18])
            axes = ca.reshape(axes, 3, 3)
            body = replace(body, position=position, velocity=velocity, axes=axes, own_rate=own_rate)
            self.seen[seat, end.name] = replace(end, body=body)
        return self.seen[seat, end.name]


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
        both = [loads.seen_from(seat, ends[name]) for name in (connection.upper, connection.lower)]
        effects = connect(assembly, connection, (both[0], both[1]), ends[seat].body.spin)
        for effect in effects:
            for name, load in effect.loads:
                loads.add(name, seat, load)
        loads.effects += effects
    for pull in vehicle.pulls:
        end = ends[pull.body]
        place = ca.vertcat(*[ca.SX(assembly.value(size)) for size in pull.place])
        force = ca.vertcat(*[assembly.input[pull.name] if pull.direction == along else 0 for along in DIRECTIONS])
        loads.add(pull.body, pull.body, Load(force, ca.cross(end.body.arm(place - end.centre), force)))
    return loads


def react(assembly: Assembly, wheelsets: Sequence[Rolling], loads: Loads) -> None:
    """Adds the share of brake and traction torque that reacts on the body that they hang in, about the axle.

    Differs from the thesis, which leaves it out (section 9.2): brakes and motors hang in the frame.
    """
    for wheelset in wheelsets:
        torque = wheelset.rotation.brake_torque - wheelset.rotation.traction_torque
        moment = assembly.parameter["torque_reaction"] * torque * wheelset.axle
        loads.add(wheelset.data.reacts_on, wheelset_name(wheelset.number), Load(ca.SX.zeros(3), moment))


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
        pose = loads.pose(wheelset.data.reacts_on, wheelset_name(wheelset.number))
        turned = ca.dot(wheelset.axle if pose is None else pose[0] @ wheelset.axle, carrier.rate)
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
