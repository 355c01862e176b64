"""What acts between bodies: springs, dampers, stops, torsion and dry friction, each at a point of either body.

Forces act in the axes of the track, each at its own attachment point, and do the same work on both ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate

import casadi as ca
import numpy as np

from fmu_src.system import Friction, System
from rbd_model.assembly import Assembly
from rbd_model.kinematics import Body
from rbd_model.vehicle import (
    ANGLES,
    DIRECTIONS,
    BumpStop,
    Connection,
    FrictionSlider,
    Place,
    SeriesDamper,
    Springs,
    Torsion,
    Vehicle,
)
from rbd_model.wheelset import NOMINAL_TRAVEL, NOMINAL_TRAVEL_SPEED

#: Travel beyond the last point of a bump stop up to which its last slope goes on [m]; no vehicle gets there.
BEYOND = 1.0


@dataclass(frozen=True)
class Push:
    """Force [N] on a point of a body, and moment [N.m], in the axes that give a connection its directions.

    arm [m]: of the point from the centre of mass, in the body's own axes, in which it stays as it is.
    """

    force: ca.SX
    moment: ca.SX
    arm: ca.SX


@dataclass(frozen=True)
class Load:
    """On a body: force [N] in the axes of the track where it is, moment about its centre [N.m] in its own axes."""

    force: ca.SX
    moment: ca.SX


@dataclass(frozen=True)
class End:
    """One end of connections: the body's name, its symbols, and the place of its centre in the vehicle at rest [m].

    The body is as seen in the axes of the track that give a connection its directions.
    """

    name: str
    body: Body
    centre: ca.SX


@dataclass(frozen=True)
class Effect:
    """What a connection does: pushes by body, energy stored [J] and power lost [W]."""

    pushes: tuple[tuple[str, Push], ...]
    potential: ca.SX
    power: ca.SX


def narrow(system: System, force: ca.SX) -> ca.SX:
    """The components of a force that there are, by which what it does is differentiated: of (3.41)."""
    acting = [i for i in range(3) if not force[i].is_zero()]
    force[acting] = system.narrow(force[acting])
    return force


@dataclass(frozen=True)
class Stretch:
    """Upper end less lower end of a single connection: way [m] and rate [m/s] in the axes that give its directions.

    arms [m]: from the centre of each end to its attachment point, in its own axes.
    """

    system: System
    ends: tuple[End, End]
    arms: tuple[ca.SX, ca.SX]
    way: ca.SX
    rate: ca.SX
    spin: ca.SX  # of these axes [rad/s]

    def effect(self, pull: ca.SX, potential: ca.SX, power: ca.SX) -> Effect:
        """Of a force on the lower end [N], which pulls the upper one the other way: eqs (3.41), (3.42).

        To the power comes what the axes take that turn along the line, and the directions of the forces with them.
        """
        power = power + ca.dot(self.spin, ca.cross(self.way, pull))
        pull = narrow(self.system, pull)
        none = ca.SX.zeros(3)
        upper, lower = (
            (end.name, Push(sign * pull, none, arm))
            for end, arm, sign in zip(self.ends, self.arms, (-1, 1), strict=True)
        )
        return Effect((upper, lower), potential, power)


def seat_of(vehicle: Vehicle, connection: Connection) -> str:
    """The body in whose axes of the track the directions of a connection are (section 3.2.3), by name.

    On straight track all have the same. On a line it is the body that is nearest along the vehicle: primary and
    secondary springs stand in the frame of the bogie. A wheelset, which steers below them, only where there is none.
    """
    along = {body.name: body.along for body in vehicle.bodies if body.name in (connection.upper, connection.lower)}
    place = vehicle.number(connection.place[0])
    return min(along, key=lambda name: abs(vehicle.number(along[name]) - place)) if along else connection.upper


def connect(assembly: Assembly, connection: Connection, both: tuple[End, End], spin: ca.SX) -> list[Effect]:
    """Effects of a connection on both its sides; the laws are in the functions of the same names.

    Each is (3.38) along one direction of the track, or a law of its own in place of a spring and a damper. both: the
    upper and the lower end; spin [rad/s]: of these axes.
    """
    if isinstance(connection, Torsion):
        return [torsion(assembly, connection, both, spin)]
    effects = []
    for side, place in connection.sides():
        stretch = stretch_of(assembly, both, place, spin)
        if isinstance(connection, Springs):
            effects.append(springs(assembly, connection, side, stretch))
        elif isinstance(connection, BumpStop):
            effects.append(bump_stop(assembly, connection, side, stretch))
        elif isinstance(connection, SeriesDamper):
            effects.append(series_damper(assembly, connection, side, stretch))
        elif isinstance(connection, FrictionSlider):
            effects.append(friction_slider(assembly, connection, side, stretch))
    return effects


def stretch_of(assembly: Assembly, ends: tuple[End, End], place: Place, spin: ca.SX) -> Stretch:
    """Way and rate between two points that are one place at rest, eqs (3.1), (3.12), in axes that turn with `spin`."""
    at = ca.vertcat(*[ca.SX(assembly.value(size)) for size in place])
    own = at - ends[0].centre, at - ends[1].centre
    (upper, upper_arm), (lower, lower_arm) = ((end.body, end.body.arm(arm)) for end, arm in zip(ends, own, strict=True))
    way = upper.position + upper_arm - lower.position - lower_arm
    rate = upper.velocity_at(upper_arm) - lower.velocity_at(lower_arm) - ca.cross(spin, way)
    return Stretch(assembly.system, ends, own, way, rate, spin)


def springs(assembly: Assembly, connection: Springs, side: str, stretch: Stretch) -> Effect:
    """Springs and dampers in parallel, eqs (3.38), (3.41), (3.42), with a stiffness and a damping in each direction.

    The preload is a constant force that holds the upper body up; without it nothing of a direction that has none acts.
    Differs from the thesis, which prints (3.37) for an element along one line: three springs in the axes of the track,
    as its Tables 4.1 and 5.1 list them, each force at its own attachment point.
    """
    stiffness, damping = (
        ca.vertcat(*[ca.SX(assembly.value(size)) for size in sizes])
        for sizes in (connection.stiffness, connection.damping)
    )
    weight = ca.vertcat(0, 0, assembly.preload(side) if connection.carries else 0)
    pull = stiffness * stretch.way + damping * stretch.rate - weight
    potential = ca.dot(stiffness, stretch.way**2) / 2 - ca.dot(weight, stretch.way)
    return stretch.effect(pull, potential, ca.dot(damping, stretch.rate**2))


def along(direction: str, value: ca.SX) -> ca.SX:
    """A vector of this size along one of DIRECTIONS, the axes of section 3.2.1."""
    return ca.vertcat(*[value if name == direction else 0 for name in DIRECTIONS])


def torsion(assembly: Assembly, connection: Torsion, ends: tuple[End, End], spin: ca.SX) -> Effect:
    """A torque proportional to the difference of an angle of both bodies and its rate: Hooke's law for (3.42).

    About the vectors with which each body's angular velocity makes the rate of that angle, so that it does the work of
    the spring and no other. spin [rad/s]: of the axes of the track in which these angles are.
    """
    angle = ANGLES.index(connection.angle)
    upper, lower = (end.body.axis_of(angle) for end in ends)
    way = ends[0].body.angles[angle] - ends[1].body.angles[angle]
    rate = ca.dot(upper, ends[0].body.rate - spin) - ca.dot(lower, ends[1].body.rate - spin)
    stiffness, damping = assembly.value(connection.stiffness), assembly.value(connection.damping)
    torque = stiffness * way + damping * rate
    none = ca.SX.zeros(3)
    pushes = ((ends[0].name, Push(none, -torque * upper, none)), (ends[1].name, Push(none, torque * lower, none)))
    return Effect(pushes, stiffness * way**2 / 2, damping * rate**2)


def bump_stop(assembly: Assembly, connection: BumpStop, side: str, stretch: Stretch) -> Effect:
    """A force by straight lines over the travel, odd, with its potential, in place of the spring of (3.38)."""
    travel, force = np.array(connection.travel), np.array(connection.force)
    slope = (force[-1] - force[-2]) / (travel[-1] - travel[-2])
    travel, force = np.append(travel, travel[-1] + BEYOND), np.append(force, force[-1] + slope * BEYOND)
    points, forces = np.concatenate([-travel[::-1], travel]), np.concatenate([-force[::-1], force])
    slopes = np.diff(forces) / np.diff(points)
    steps = np.diff(points) * (forces[:-1] + forces[1:]) / 2
    energy = np.array(list(accumulate(steps, initial=0.0)))[:-1] - np.sum(steps[: len(travel)])
    way = stretch.way[DIRECTIONS.index(connection.direction)]
    pieces = np.column_stack([energy, forces[:-1], slopes / 2])
    potential, pull = assembly.system.curve(side, points, pieces, way, 1)
    return stretch.effect(along(connection.direction, pull), potential, ca.SX(0))


def series_damper(assembly: Assembly, connection: SeriesDamper, side: str, stretch: Stretch) -> Effect:
    """Spring and damper behind one another (Maxwell (1867)), in place of those side by side of (3.38).

    Both have the same force; the way of the damper is a state.
    """
    which = DIRECTIONS.index(connection.direction)
    damper = assembly.system.state(f"{side}_travel", "m", 0.0, NOMINAL_TRAVEL)
    pull = assembly.value(connection.stiffness) * (stretch.way[which] - damper)
    rate = pull / assembly.value(connection.damping)
    assembly.system.derivative(f"{side}_travel", rate)
    return stretch.effect(along(connection.direction, pull), pull * (stretch.way[which] - damper) / 2, pull * rate)


def friction_slider(assembly: Assembly, connection: FrictionSlider, side: str, stretch: Stretch) -> Effect:
    """Dry friction on a slider behind a spring and a damper: it holds as a locked wheelset does, third line of (2.8).

    The slider is fixed to the upper end by its spring and rubs on the lower one; its mass counts in no body.
    """
    system, which = assembly.system, DIRECTIONS.index(connection.direction)
    stiffness, damping = assembly.value(connection.stiffness), assembly.value(connection.damping)
    capacity = ca.SX(assembly.value(connection.capacity))
    travel = system.state(f"{side}_travel", "m", 0.0, NOMINAL_TRAVEL)
    rate = system.state(f"{side}_travel_rate", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    direction = system.direction(f"{side}_direction")
    bent, bending = stretch.way[which] - travel, stretch.rate[which] - rate
    drive = stiffness * bent + damping * bending
    moving = direction**2
    system.derivative(f"{side}_travel", rate)
    mass = assembly.value(connection.slider_mass)
    system.derivative(f"{side}_travel_rate", moving * (drive - direction * capacity) / mass)
    system.dry_friction(Friction(side, direction, f"{side}_travel_rate", drive, capacity, "sticks", "slides again"))
    power = damping * bending**2 + moving * direction * capacity * rate
    return stretch.effect(along(connection.direction, drive), stiffness * bent**2 / 2 + mass * rate**2 / 2, power)
