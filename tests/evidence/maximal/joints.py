"""Compute forces between two bodies: a potential and dampers, by numerical derivatives and virtual power."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from rbd_model.vehicle.description import (
    ANGLES,
    DIRECTIONS,
    ForceLaw,
    FrictionSlider,
    SeriesDamper,
    Size,
    Springs,
    SuspensionElement,
    TableDamper,
    TableSpring,
    Torsion,
    Vehicle,
)
from tests.evidence.maximal.motion import Moving, roll_pitch_yaw

#: Step of central differences [m], [rad]: their error is of second order, 2e-9 of the largest force.
STEP = 1e-5


@dataclass(frozen=True)
class End:
    """One end: the body in motion, the position of its centre at rest [m], and whether it is a wheelset."""

    body: Moving
    centre: np.ndarray
    rolls: bool


Ends = tuple[End, End]


@dataclass(frozen=True)
class Carried:
    """Axes (columns) in which the attachment points of upper and lower end are fixed, and those of the directions."""

    above: np.ndarray
    below: np.ndarray
    directions: np.ndarray


#: Returns the carrier axes of both ends' points and of the directions for given positions of upper and lower body.
Carriers = Callable[[Moving, Moving], Carried]


def box(axle: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return axes of an axle box: the axle is the second one, and the first is square to `up`."""
    ahead = np.cross(axle, up)
    ahead = ahead / np.linalg.norm(ahead)
    return np.column_stack([ahead, axle, np.cross(ahead, axle)])


def on_bodies(ends: Ends) -> Carriers:
    """Let the lower body carry the directions. A wheelset carries directions and points by its axle box.

    The axle box yaws and rolls with the axle and pitches with the other body.
    """

    def at(upper: Moving, lower: Moving) -> Carried:
        above = box(upper.axes[:, 1], lower.axes[:, 2]) if ends[0].rolls else upper.axes
        below = box(lower.axes[:, 1], upper.axes[:, 2]) if ends[1].rolls else lower.axes
        return Carried(above, below, below)

    return at


#: Returns the elongations for given upper and lower body, shape (n,).
Stretch = Callable[[Moving, Moving], np.ndarray]


def between(place: np.ndarray, ends: Ends, carriers: Carriers) -> Stretch:
    """Return the displacement between two points that coincide at rest [m], along the directions."""
    arms = [place - end.centre for end in ends]

    def stretch(upper: Moving, lower: Moving) -> np.ndarray:
        by = carriers(upper, lower)
        way = upper.position + by.above @ arms[0] - lower.position - by.below @ arms[1]
        return np.asarray(by.directions.T @ way)

    return stretch


def angle_between(angle: int, carriers: Carriers) -> Stretch:
    """Return roll (0), pitch or yaw of the upper end relative to the lower one [rad]."""

    def stretch(upper: Moving, lower: Moving) -> np.ndarray:
        by = carriers(upper, lower)
        return roll_pitch_yaw(by.below.T @ by.above)[[angle]]

    return stretch


def differenced(value: Stretch, bodies: tuple[Moving, Moving], step: float) -> np.ndarray:
    """Return derivatives of values, shape (n,), by small displacements of both bodies, shape (n, 12)."""
    columns = []
    for which in (0, 1):
        for way in step * np.eye(6):
            ahead, behind = (
                value(*[body.displaced(sign * way) if body is bodies[which] else body for body in bodies])
                for sign in (1, -1)
            )
            columns.append((ahead - behind) / (2 * step))
    return np.column_stack(columns)


@dataclass(frozen=True)
class Law:
    """Potential of an elongation [J], and the additional force by its rate [N]."""

    potential: Callable[[np.ndarray], float]
    beside: Callable[[np.ndarray], np.ndarray] = np.zeros_like


def wrenches_of(stretch: Stretch, law: Law, ends: Ends, step: float) -> np.ndarray:
    """Return force and moment about the centre of upper and lower body, inertial, shape (12,).

    It is minus the gradient of the potential, and minus the additional force, by virtual power.
    """
    bodies = ends[0].body, ends[1].body
    by_place = differenced(stretch, bodies, step)
    rate = by_place @ np.concatenate([body.twist for body in bodies])
    elastic = differenced(lambda *moved: np.array([law.potential(stretch(*moved))]), bodies, step)[0]
    return -elastic - by_place.T @ law.beside(rate)


def wrenches(
    vehicle: Vehicle,
    connection: SuspensionElement,
    ends: Ends,
    carriers: Carriers,
    preload: float,
    states: Mapping[str, float],
    step: float = STEP,
) -> np.ndarray:
    """Return the wrenches of a connection, both sides together, on upper and lower body, shape (12,).

    `preload` [N]: of each side. `states`: travels of dampers and sliders, and their rates, by name.
    """

    def number(*sizes: Size) -> np.ndarray:
        return np.array([vehicle.number(size) for size in sizes])

    if isinstance(connection, Torsion):
        law = beside_a_damper(number(connection.stiffness), number(connection.damping), preload=0.0)
        stretch = angle_between(ANGLES.index(connection.angle), carriers)
        return wrenches_of(stretch, law, ends, step)
    total = np.zeros(12)
    for side, place in connection.sides():
        stretch = between(number(*place), ends, carriers)
        if isinstance(connection, Springs):
            law = beside_a_damper(number(*connection.stiffness), number(*connection.damping), preload)
            stretch = tilted(stretch, float(number(connection.inclination)[0]))
        elif isinstance(connection, TableSpring):
            law = along_a_table(connection, preload)
        elif isinstance(connection, TableDamper):
            law = Law(lambda way: 0.0, lambda rate: table_force(connection.rate, connection.force, rate))
        elif isinstance(connection, ForceLaw):
            travel = stretch(ends[0].body, ends[1].body)[DIRECTIONS.index(connection.direction)]
            law = of_a_function(connection, number(*connection.sizes).tolist(), float(travel))
        elif isinstance(connection, SeriesDamper):
            law = behind_a_spring(float(number(connection.stiffness)[0]), 0.0, states[f"{side}_travel"], 0.0)
        elif isinstance(connection, FrictionSlider):
            sizes = number(connection.stiffness, connection.damping)
            law = behind_a_spring(*sizes.tolist(), states[f"{side}_travel"], states[f"{side}_travel_rate"])
        if not isinstance(connection, Springs):
            stretch = component(stretch, DIRECTIONS.index(connection.direction))
        total += wrenches_of(stretch, law, ends, step)
    return total


def tilted(stretch: Stretch, angle: float) -> Stretch:
    """Return elongations along axes that are pitched by an angle, nose down [rad]."""
    ahead, up = np.array([math.cos(angle), 0.0, -math.sin(angle)]), np.array([math.sin(angle), 0.0, math.cos(angle)])
    axes = np.array([ahead, [0.0, 1.0, 0.0], up])
    return lambda upper, lower: axes @ stretch(upper, lower)


def component(stretch: Stretch, which: int) -> Stretch:
    """Return one component of an elongation."""
    return lambda upper, lower: stretch(upper, lower)[[which]]


def beside_a_damper(stiffness: np.ndarray, damping: np.ndarray, preload: float) -> Law:
    """Return the law of springs and dampers in parallel, with a constant force that supports the upper body."""
    held = np.zeros_like(stiffness)
    held[-1] = preload
    return Law(lambda way: float(stiffness @ way**2) / 2 - float(held @ way), lambda rate: damping * rate)


def behind_a_spring(stiffness: float, damping: float, travel: float, travel_rate: float) -> Law:
    """Return the law of a spring and a damper in parallel whose far end has its own displacement [m] and rate [m/s]."""
    return Law(
        lambda way: stiffness * float((way[0] - travel) ** 2) / 2,
        lambda rate: damping * (rate - travel_rate),
    )


def of_a_function(connection: ForceLaw, sizes: list[float], travel: float) -> Law:
    """Return the law of a force over travel and rate, at a travel [m]."""

    def force(way: float, rate: float) -> float:
        assert connection.force is not None
        return float(connection.force(way, rate, *sizes))

    return Law(
        lambda way: float(quad(force, 0.0, float(way[0]), (0.0,), epsabs=1e-12)[0]),
        lambda rate: np.array([force(travel, float(rate[0])) - force(travel, 0.0)]),
    )


def table_force(places: tuple[float, ...], forces: tuple[float, ...], at: np.ndarray) -> np.ndarray:
    """Return a piecewise linear force through points on one side, extrapolated and odd [N]."""
    x, f = np.array([0.0, *places]), np.array([0.0, *forces])
    slope, reached = (f[-1] - f[-2]) / (x[-1] - x[-2]), np.abs(at)
    there = np.where(reached > x[-1], f[-1] + slope * (reached - x[-1]), np.interp(reached, x, f))
    return np.asarray(np.sign(at) * there)


def along_a_table(connection: TableSpring, preload: float) -> Law:
    """Return the law of a force that is piecewise linear in the travel, from where it carries the preload."""
    points = connection.travel, connection.force

    def excess(travel: float) -> float:
        return float(table_force(*points, np.array(travel))) - preload

    rest = brentq(excess, 0.0, 1.0, xtol=1e-15) if connection.carries else 0.0
    return Law(lambda way: table_energy(*points, float(way[0]) - rest))


def table_energy(travel: tuple[float, ...], force: tuple[float, ...], way: float) -> float:
    """Return the work of a piecewise linear force through (travel, force), extrapolated and symmetric [J]."""
    reached = abs(way)
    x = np.array([0.0, *[one for one in travel if one < reached], reached])
    f = table_force(travel, force, x)
    return float(np.sum(np.diff(x) * (f[:-1] + f[1:])) / 2)
