"""Common parts of the levels with bodies: motion of bodies, their outputs and energies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fmu_src.symbols import ca
from rbd_model.body.bodies import MovingBody, move_body
from rbd_model.body.effect import Load
from rbd_model.body.kinematics import Body
from rbd_model.body.loads import Loads
from rbd_model.levels.resistance import Resistance
from rbd_model.vehicle.assembly import Assembly
from rbd_model.vehicle.description import ANGLES, RigidBody, Wheelset
from rbd_model.wheelset.rotation import RollingWheelset, add_wheelset_outputs


def react(assembly: Assembly, wheelsets: Sequence[RollingWheelset], loads: Loads) -> None:
    """Add the share of brake and traction torque that reacts on the body of brake and motor, about the axle.

    This differs from the thesis, which omits it (section 9.2): brakes and motors are mounted in the frame.
    """
    for wheelset in wheelsets:
        torque = wheelset.rotation.brake_torque - wheelset.rotation.traction_torque
        moment = assembly.parameter["torque_reaction"] * torque * loads.axle(wheelset.number, wheelset.data)
        loads.of[wheelset.data.reacts_on].append(Load(ca.SX.zeros(3), moment))


def pull_first_body(
    assembly: Assembly, resistance: Resistance, pulled: ca.SX, falling: ca.SX, share: ca.SX | float = 1.0
) -> ca.SX:
    """Return the acceleration of the vehicle's first body along the track [m/s2], (3.73), with running resistance.

    pulled [N], falling [m/s2]: by its connections and by gravity. share: 0 if the speed is constant (sections 4.2,
    5.2). Call this before the functions that hold wheelsets: their velocities are relative to this body's.
    """
    first = assembly.vehicle.bodies[0]
    mass = assembly.value(first.mass)
    resistance.hold(assembly.system, assembly.speed, pulled + mass * falling)
    moves, lightness = share * resistance.moves, share / mass
    return resistance.moves * lightness * pulled + moves * falling + lightness * resistance.force


def move_bodies(assembly: Assembly, bodies: Sequence[MovingBody], loads: Loads, first_acceleration: ca.SX) -> None:
    """Add Newton's and Euler's equations of all bodies, (3.73); first_acceleration [m/s2]: of the first, along x."""
    for moving in bodies:
        move_body(assembly, moving, loads.on(moving.data.name), first_acceleration)


def add_common_outputs(
    assembly: Assembly,
    bodies: Sequence[MovingBody],
    wheelsets: Sequence[RollingWheelset],
    accelerations: Sequence[ca.SX],
) -> None:
    """Add the outputs of every level above the static one; accelerations [m/s2]: of the axles.

    Speed, distance and acceleration are means of the axles, the place of the experiment's instruments (section 6.3.4).
    They are 0 for a vehicle at rest on locked wheels, while its bodies still oscillate.
    """
    system, outputs, count = assembly.system, assembly.outputs, len(wheelsets)
    speed = ca.SX(sum(wheelset.forward for wheelset in wheelsets)) / count
    shifts = sum(wheelset.displacement for wheelset in wheelsets) / count
    system.output(outputs["speed"], speed)
    system.output(outputs["distance"], assembly.distance + shifts)
    system.output(outputs["acceleration"], ca.SX(sum(accelerations)) / count)
    for moving in bodies:
        for motion in ("lateral", "bounce", *ANGLES):
            name = moving.data.variable(motion)
            if motion in moving.position:
                system.output(outputs[name], moving.position[motion])
            elif motion in moving.data.held:
                system.output(outputs[name], 0)
    for wheelset in wheelsets:
        add_wheelset_outputs(assembly, wheelset, speed)


def observe_energy(
    assembly: Assembly,
    bodies: Sequence[MovingBody],
    wheelsets: Sequence[RollingWheelset],
    loads: Loads,
    further: Mapping[str, ca.SX],
) -> None:
    """Observe energies [J] and dissipated powers [W] (section 2.4); their sum is constant without drives.

    Constraints do no work. further: additional energies and powers of a level, including those of its wheelsets.
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
        turned = ca.dot(loads.axle(wheelset.number, wheelset.data), carrier.own_rate)
        rotation = wheelset.rotation
        kinetic += assembly.drive_inertia * rotation.angular_velocity**2 / 2
        brake += rotation.friction_torque * rotation.angular_velocity - reaction * rotation.brake_torque * turned
    potential += loads.stored
    creep = sum((wheelset.creep_power for wheelset in wheelsets), ca.SX(0))
    own = {"kinetic_energy": kinetic, "potential_energy": potential, "brake_power": brake}
    for name, value in (own | {"creep_power": creep, "damping_power": loads.lost}).items():
        unit = "J" if name.endswith("energy") else "W"
        assembly.system.observe(name, unit, value + further.get(name, ca.SX(0)))


def elevation(assembly: Assembly, body: Body) -> ca.SX:
    """Return the height of a body [m], for its energy (section 2.4).

    Straight track on a gradient rises with distance.
    """
    return body.track.elevation(body.position + ca.vertcat(assembly.distance, 0, 0))


def kinetic_energy(assembly: Assembly, data: RigidBody | Wheelset, body: Body) -> ca.SX:
    """Return the kinetic energy of a rigid body that moves and turns [J], section 2.4."""
    inertia = ca.vertcat(*[assembly.value(size) for size in data.inertia])
    return (assembly.value(data.mass) * ca.sumsqr(body.velocity) + ca.dot(inertia, body.own_rate**2)) / 2
