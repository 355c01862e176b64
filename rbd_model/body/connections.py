"""Forces between bodies: springs, dampers, stops, torsion and dry friction, in axes that the lower end carries.

A law depends only on the position and motion of the upper end relative to these axes. Turning or shifting both ends
together thus has no effect, and their mutual forces add up to no force and no moment (Noether (1918)).
This differs from the thesis, which gives (3.37) for an element along the line between its two points. It lists
stiffnesses in three directions, Tables 4.1 and 5.1, but not their axes. Here the bogie frame carries those of a body
above it. An axle box, which yaws and rolls with its wheelset and pitches with the frame, carries those of a frame.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import accumulate

import numpy as np

from fmu_src.piecewise import interpolation, look_up, polynomials
from fmu_src.symbols import ca
from rbd_model.body.effect import Effect, along, sum_of
from rbd_model.body.kinematics import axis_of, pitch_rotation
from rbd_model.body.relation import Relation, Stretch
from rbd_model.vehicle.assembly import Assembly, Sizes
from rbd_model.vehicle.description import (
    ANGLES,
    DIRECTIONS,
    ForceLaw,
    FrictionSlider,
    Place,
    SeriesDamper,
    Springs,
    SuspensionElement,
    TableDamper,
    TableSpring,
    Torsion,
)
from rbd_model.vehicle.force_table import lines
from rbd_model.vehicle.scales import BEYOND, BEYOND_RATE, NOMINAL_TRAVEL, NOMINAL_TRAVEL_SPEED

#: Nodes and weights of Gauss's rule for the potential of a force.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def connect(assembly: Assembly, connection: SuspensionElement, relation: Relation) -> Effect:
    """Return the effect of a connection, of both its sides if it has two. Each law is (3.38), or one instead of it."""
    if isinstance(connection, STATELESS):
        return connect_stateless(assembly, connection, relation)
    law = _law_of(connection, WITH_STATES)
    return sum_of(
        [
            law(assembly, connection, side, relation, relation.stretch(assembly, place))
            for side, place in connection.sides()
        ]
    )


def connect_stateless(sizes: Sizes, connection: SuspensionElement, relation: Relation) -> Effect:
    """Return the effect of one of STATELESS, (3.38)."""
    return _law_of(connection, LAWS)(sizes, connection, relation)


def _law_of(connection: SuspensionElement, laws: Mapping[type, Callable[..., Effect]]) -> Callable[..., Effect]:
    return next(law for kind, law in laws.items() if isinstance(connection, kind))


def springs(sizes: Sizes, connection: Springs, relation: Relation) -> Effect:
    """Return springs and dampers in parallel, eqs (3.38), (3.41), (3.42), with stiffness and damping in each direction.

    The preload is a constant force that supports the upper body. A direction without preload, stiffness and damping is
    omitted. Of two sides, the mean of both pushes, and half of their difference turns: this is exact for linear laws.
    """
    stiffness, damping = (
        ca.vertcat(*[ca.SX(sizes.value(size)) for size in three])
        for three in (connection.stiffness, connection.damping)
    )

    turned = ca.SX.eye(3)
    if connection.inclination != 0.0:
        turned = pitch_rotation(ca.SX(sizes.value(connection.inclination)))

    def spring(stretch: Stretch, carried: ca.SX, count: int) -> Effect:
        weight = ca.vertcat(0, 0, carried)
        way, rate = turned.T @ stretch.way, turned.T @ stretch.rate
        pull = count * (turned @ (stiffness * way + damping * rate) - weight)
        potential = count * (ca.dot(stiffness, way**2) / 2 - ca.dot(weight, stretch.way))
        return Effect.of(relation, stretch, pull, potential, count * ca.dot(damping, rate**2))

    carried = [sizes.preload(side) if connection.carries else ca.SX(0) for side, _ in connection.sides()]
    along, across, upwards = connection.place
    if not connection.both_sides:
        return spring(relation.stretch(sizes, connection.place), carried[0], 1)
    left, right = carried
    middle = relation.stretch(sizes, (along, 0.0, upwards))
    beside = relation.spread(ca.vertcat(0, sizes.value(across), 0))
    turning = replace(spring(beside, (left - right) / 2, 2), force=ca.SX.zeros(3))
    return spring(middle, (left + right) / 2, 2) + turning


def torsion(sizes: Sizes, connection: Torsion, relation: Relation) -> Effect:
    """Return a torque proportional to an angle between both ends and to its rate: Hooke's law for (3.42).

    The angle is that of Rz(yaw) Rx(roll) Ry(pitch), by which the upper end is turned relative to the lower one's axes.
    The torque is about the vector whose product with the spin is the rate of that angle, so that it does the work of
    the spring.
    """
    angle = ANGLES.index(connection.angle)
    way, axis = relation.angle(angle), axis_of(relation.axes, angle)
    rate = -ca.dot(relation.axes.T @ axis, relation.spin)
    stiffness, damping = sizes.value(connection.stiffness), sizes.value(connection.damping)
    moment = (stiffness * way + damping * rate) * axis
    none = ca.SX.zeros(3)
    return Effect(none, -relation.axes.T @ moment, moment, stiffness * way**2 / 2, damping * rate**2)


def table_spring(sizes: Sizes, connection: TableSpring, relation: Relation) -> Effect:
    """Return forces by straight lines over the travel, with their potential, instead of the spring of (3.38).

    A spring that carries rests where its table has the preload.
    """
    return sum_of([_spring_of_side(sizes, connection, relation, side, place) for side, place in connection.sides()])


def _spring_of_side(sizes: Sizes, connection: TableSpring, relation: Relation, side: str, place: Place) -> Effect:
    points, forces = lines(connection.travel, connection.force, BEYOND)
    slopes = np.diff(forces) / np.diff(points)
    steps = np.diff(points) * (forces[:-1] + forces[1:]) / 2
    energy = np.array(list(accumulate(steps, initial=0.0)))
    pieces = np.column_stack([(energy - energy[np.searchsorted(points, 0.0)])[:-1], forces[:-1], slopes / 2])
    stretch = relation.stretch(sizes, place)
    way = stretch.way[DIRECTIONS.index(connection.direction)]
    if connection.carries:
        way = way + travel_at_rest(sizes, connection, sizes.preload(side))
    potential, pull = polynomials(look_up(sizes.chain, connection.name, points, pieces, way), way, 1)
    return Effect.of(relation, stretch, along(connection.direction, pull), potential, ca.SX(0))


def travel_at_rest(sizes: Sizes, connection: TableSpring, preload: ca.SX) -> ca.SX:
    """Return the travel at which a table instead of (3.38) has the preload [m]: forces and travels are exchanged."""
    travel, force = (np.array(one) for one in connection.under_load)
    slope = (force[1] - force[0]) / (travel[1] - travel[0])
    further = np.array([force[0] - slope * BEYOND, *force]), np.array([travel[0] - BEYOND, *travel])
    points, pieces = interpolation(*further)
    (found,) = polynomials(look_up(sizes.chain, connection.name, points, pieces, -preload), -preload, 0)
    return found


def table_damper(sizes: Sizes, connection: TableDamper, relation: Relation) -> Effect:
    """Return forces by straight lines over the rate, instead of the damper of (3.38)."""
    points, pieces = interpolation(*lines(connection.rate, connection.force, BEYOND_RATE))
    effects = []
    for _, place in connection.sides():
        stretch = relation.stretch(sizes, place)
        rate = stretch.rate[DIRECTIONS.index(connection.direction)]
        (pull,) = polynomials(look_up(sizes.chain, connection.name, points, pieces, rate), rate, 0)
        effects.append(Effect.of(relation, stretch, along(connection.direction, pull), ca.SX(0), pull * rate))
    return sum_of(effects)


def force_law(sizes: Sizes, connection: ForceLaw, relation: Relation) -> Effect:
    """Return a user's force over travel and rate, instead of (3.38): its part without rate has a potential.

    The potential is the integral by Gauss's rule, exact for polynomials of degree 47; it has no effect on the motion.
    """
    assert connection.force is not None
    further, effects = [sizes.value(size) for size in connection.sizes], []
    for _, place in connection.sides():
        stretch = relation.stretch(sizes, place)
        way, rate = (one[DIRECTIONS.index(connection.direction)] for one in (stretch.way, stretch.rate))
        pull, elastic = (connection.force(way, one, *further) for one in (rate, 0.0))
        inner = [connection.force(way * (1 + node) / 2, 0.0, *further) for node in NODES]
        potential = ca.dot(ca.vertcat(*inner), WEIGHTS) * way / 2
        lost = (pull - elastic) * rate
        effects.append(Effect.of(relation, stretch, along(connection.direction, pull), potential, lost))
    return sum_of(effects)


def series_damper(
    assembly: Assembly, connection: SeriesDamper, side: str, relation: Relation, stretch: Stretch
) -> Effect:
    """Return a spring and a damper in series (Maxwell (1867)), instead of the parallel ones of (3.38).

    Both have the same force; the travel of the damper is a state.
    """
    which = DIRECTIONS.index(connection.direction)
    damper = assembly.system.state(f"{side}_travel", "m", 0.0, NOMINAL_TRAVEL)
    pull = assembly.value(connection.stiffness) * (stretch.way[which] - damper)
    rate = pull / assembly.value(connection.damping)
    assembly.system.derivative(damper, rate)
    return Effect.of(
        relation, stretch, along(connection.direction, pull), pull * (stretch.way[which] - damper) / 2, pull * rate
    )


def friction_slider(
    assembly: Assembly, connection: FrictionSlider, side: str, relation: Relation, stretch: Stretch
) -> Effect:
    """Return dry friction on a slider in series with a spring and damper: it holds as in the third line of (2.8).

    Coulomb's law with the normal force of a wedge, whose spring is compressed along with the suspension.
    The slider is fixed to the upper end by its spring and rubs on the lower one; its mass is not part of a body.
    """
    system, which = assembly.system, DIRECTIONS.index(connection.direction)
    stiffness, damping = assembly.value(connection.stiffness), assembly.value(connection.damping)
    capacity = ca.SX(assembly.value(connection.capacity))
    if connection.capacity_slope != 0.0:
        compressed = -stretch.way[DIRECTIONS.index("vertical")]
        capacity = ca.fmax(capacity + assembly.value(connection.capacity_slope) * compressed, 0.0)
    travel = system.state(f"{side}_travel", "m", 0.0, NOMINAL_TRAVEL)
    rate = system.state(f"{side}_travel_rate", "m/s", 0.0, NOMINAL_TRAVEL_SPEED)
    direction = system.direction(f"{side}_direction")
    bent, bending = stretch.way[which] - travel, stretch.rate[which] - rate
    drive = stiffness * bent + damping * bending
    moving = direction**2
    system.derivative(travel, rate)
    mass = assembly.value(connection.slider_mass)
    system.derivative(rate, moving * (drive - direction * capacity) / mass)
    system.dry_friction(side, direction, [rate], drive, capacity, ("sticks", "slides again"))
    power = damping * bending**2 + moving * direction * capacity * rate
    return Effect.of(
        relation, stretch, along(connection.direction, drive), stiffness * bent**2 / 2 + mass * rate**2 / 2, power
    )


#: Law of each kind of connection without states of its own, and of those with states, one side at a time. A new
#: element is a class, its law and a row (CONTRIBUTING.md).
LAWS: dict[type, Callable[..., Effect]] = {
    Springs: springs,
    Torsion: torsion,
    TableSpring: table_spring,
    TableDamper: table_damper,
    ForceLaw: force_law,
}
WITH_STATES: dict[type, Callable[..., Effect]] = {SeriesDamper: series_damper, FrictionSlider: friction_slider}
STATELESS = tuple(LAWS)
