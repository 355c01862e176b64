"""Accelerations of all bodies and forces of all wheels of a vehicle at an instant."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from rbd_model.vehicle.description import SuspensionElement, Vehicle, wheelset_name
from tests.maximal.hertz import load_of, semi_axes_of
from tests.maximal.joints import Carriers, End, Ends, on_bodies, wrenches
from tests.maximal.motion import Moving, accelerations
from tests.maximal.rails import Course, Rails, Shifted
from tests.maximal.slip import Rolling, polach, shen_hedrick_elkins
from tests.maximal.statics import preloads
from tests.maximal.touch import Touch, Wheel, touches

#: A contact that is steeper lies on the flange: its creep law is another, and beside a tread contact it bears as well.
FLANGE_SLOPE = math.tan(math.radians(20.0))
#: Grid of the contacts [m], and step of the displacements by which a normal force is told what it pushes [m], [rad].
GRID, STEP = 0.05e-3, 1e-5


@dataclass(frozen=True)
class WheelForces:
    """What the rail does to one wheel [N]: force ahead, to the left and up in the axes of the track; creep force along
    the rail; what the flange has of the force to the left.
    """

    force: np.ndarray
    creep_along: float
    flange: float


@dataclass(frozen=True)
class Scene:
    """Of each wheelset, which turns ahead: friction of its rails, brake and traction torque [N.m]."""

    friction: list[float]
    brake: list[float]
    traction: list[float]


@dataclass(frozen=True)
class GivenWay:
    """The left (0) or right rail of an oracle where the rails have given way; give: as `Oracle.give` has it."""

    oracle: Oracle
    index: int
    give: np.ndarray

    def __call__(self, centre: np.ndarray) -> Shifted:
        """As `Rails`: the rail beside a wheelset's centre."""
        return Shifted(self.oracle.rails[self.index](centre), self.across(centre, 0))

    def speed(self, body: Moving) -> np.ndarray:
        """Of the rail, inertial [m/s]."""
        return self.across(body.position, 1)

    def across(self, centre: np.ndarray, row: int) -> np.ndarray:
        """A row of `give` of this rail as a vector."""
        aside, up = self.give[row, 0], self.give[row, 1 + self.index]
        return np.asarray(self.oracle.track(centre) @ [0.0, aside, up])


@dataclass(frozen=True)
class Oracle:
    """A vehicle on its rails. rails: for each wheelset's left and right wheel, on the course.

    carriers: what carries the directions of a connection. square: what the fast model has simpler than it is,
    `Touch.square` in place of curvatures of a wheel that yaws. grid, step [m]: of contacts, and of differences. below:
    stiffness [N/m] and damping [N.s/m] that hold the rails below a wheelset, in the order of `give`.
    """

    vehicle: Vehicle
    rails: tuple[Rails, Rails]
    course: Course
    carriers: Callable[[SuspensionElement, Ends], Carriers] = lambda connection, ends: on_bodies(ends)
    below: np.ndarray = field(default_factory=lambda: np.zeros((2, 3)))
    square: bool = False
    grid: float = GRID
    step: float = STEP
    _preloads: dict[str, float] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_preloads", preloads(self.vehicle))

    def answer(
        self, bodies: Mapping[str, Moving], scene: Scene, states: Mapping[str, float]
    ) -> tuple[dict[str, np.ndarray], dict[tuple[int, int], WheelForces], dict[int, np.ndarray]]:
        """Accelerations, (6,) by body, forces by wheelset's number and side, what moves rails (3,) by number [N]."""
        total = {name: np.zeros(6) for name in bodies}
        for connection in self.vehicle.connections:
            both = self.ends(connection, bodies)
            preload = self._preloads.get(connection.name, 0.0)
            pushed = wrenches(self.vehicle, connection, both, self.carriers(connection, both), preload, states)
            total[connection.upper] += pushed[:6]
            total[connection.lower] += pushed[6:]
        wheels, below = {}, {}
        for number, data in self.vehicle.numbered:
            name = wheelset_name(number)
            give = self.give(number, states)
            for index, side in enumerate((1, -1)):
                rail = GivenWay(self, index, give)
                pushed, wheels[number, side] = self.wheel(number, rail, bodies[name], scene.friction[number - 1])
                total[name] += pushed
            below[number] = self.moving_rails(number, give, [wheels[number, side].force for side in (1, -1)])
            # Brake and motor hang in a body; the brake works against the rotation, ahead.
            torque = (scene.traction[number - 1] - scene.brake[number - 1]) * bodies[name].axes[:, 1]
            total[name][3:] += torque
            total[data.reacts_on][3:] -= torque
        return {name: self.acceleration(name, body, total[name]) for name, body in bodies.items()}, wheels, below

    def give(self, number: int, states: Mapping[str, float]) -> np.ndarray:
        """How far [m] and how fast [m/s] the rails below a wheelset give way, (2, 3): to the left, each of them up."""
        rows = (f"track_{number}", f"track_{number}_left", f"track_{number}_right")
        return np.array([[states.get(f"{row}{end}", 0.0) for row in rows] for end in ("", "_speed")])

    def moving_rails(self, number: int, give: np.ndarray, wheels: list[np.ndarray]) -> np.ndarray:
        """Forces that speed up the rails below a wheelset, in the order of `give`; wheels: forces on its wheels [N]."""
        value = self.vehicle.number
        name, mass = wheelset_name(number), value(self.vehicle.wheelsets[number - 1].mass)
        resting = [self._preloads[one.name] for one in self.vehicle.carrying if one.lower == name for _ in one.sides()]
        static, (left, right) = (sum(resting) + mass * value("gravity")) / 2, wheels
        pushed = np.array([-left[1] - right[1], static - left[2], static - right[2]])
        return np.asarray(pushed - np.sum(self.below * give, axis=0))

    def ends(self, connection: SuspensionElement, bodies: Mapping[str, Moving]) -> Ends:
        """Upper and lower end."""
        upper, lower = (
            End(bodies[name], self.place(name), name in self.wheelsets) for name in (connection.upper, connection.lower)
        )
        return upper, lower

    @property
    def wheelsets(self) -> dict[str, int]:
        """Numbers of the wheelsets by name."""
        return {wheelset_name(number): number for number, _ in self.vehicle.numbered}

    def place(self, name: str) -> np.ndarray:
        """Of a body's centre in the vehicle at rest [m]."""
        number = self.vehicle.number
        if name in self.wheelsets:
            return np.array([number(self.vehicle.wheelsets[self.wheelsets[name] - 1].along), 0.0, 0.0])
        body = next(body for body in self.vehicle.bodies if body.name == name)
        return np.array([number(body.along), 0.0, number(body.height)])

    def acceleration(self, name: str, body: Moving, wrench: np.ndarray) -> np.ndarray:
        """By all that acts, and by its weight."""
        number = self.vehicle.number
        parts = {part.name: part for part in self.vehicle.bodies}
        part = parts.get(name) or self.vehicle.wheelsets[self.wheelsets[name] - 1]
        mass = number(part.mass)
        weight = np.array([0.0, 0.0, -mass * number("gravity"), 0.0, 0.0, 0.0])
        return accelerations(body, mass, np.array([number(size) for size in part.inertia]), wrench + weight)

    def wheel(self, number: int, rail: GivenWay, body: Moving, friction: float) -> tuple[np.ndarray, WheelForces]:
        """What the rail does to a wheel of a wheelset: wrench about its centre (6,), and forces."""
        found = touches(body, self.wheel_of(number, rail.index), rail, self.grid)
        track = self.track(body.position)
        wrench, force, creep, flange = np.zeros(6), np.zeros(3), 0.0, 0.0
        for touch in found:
            if touch.approach <= 0.0:
                continue
            on_flange = touch.slope > FLANGE_SLOPE
            pushed, creeping = self.press(rail, body, touch, friction, on_flange)
            wrench += pushed
            force += track.T @ pushed[:3]
            creep += creeping
            flange += on_flange * float(track[:, 1] @ pushed[:3])
        return wrench, WheelForces(force, creep, flange)

    def wheel_of(self, number: int, index: int) -> Wheel:
        """The left (0) or right wheel of a wheelset."""
        data = self.vehicle.wheelsets[number - 1]
        one = data.pair.both[index]
        return Wheel((1, -1)[index], self.vehicle.number(data.radius[index]), one.wheel_half_distance, one.wheel)

    def track(self, centre: np.ndarray) -> np.ndarray:
        """Axes of the track (columns) where a body's centre is."""
        return np.asarray(self.course.axes(self.course.place_of(centre[None]))[0])

    def press(
        self, rail: GivenWay, body: Moving, touch: Touch, friction: float, flange: bool
    ) -> tuple[np.ndarray, float]:
        """Wrench of one contact on the wheelset (6,), and its creep force along the rail [N]."""
        number = self.vehicle.number
        modulus = number("shear_modulus")
        by_place, moved = self.parting(rail, body, touch), rail.speed(body)
        closing = float(by_place[:3] @ moved - by_place @ body.twist)
        curvatures = touch.square if self.square else touch.curvatures
        elastic = load_of(touch.approach, *curvatures, modulus)
        load = elastic * max(1 + number("contact_damping") * closing, 0.0)
        if load <= 0.0:
            return np.zeros(6), 0.0

        sideways = np.cross(touch.normal, touch.along)
        sliding = body.velocity + np.cross(body.rate, touch.arm) - moved
        least, forward = number("creepage_speed"), float(self.track(body.position)[:, 0] @ body.velocity)
        slides = sliding @ touch.along, sliding @ sideways, body.rate @ touch.normal * np.clip(forward / least, -1, 1)
        creepages = np.array(slides) / math.hypot(forward, least)
        axes = semi_axes_of(load, *curvatures, modulus)
        patch = Rolling(tuple(creepages.tolist()), load, friction, axes, modulus)  # type: ignore[arg-type]
        along, aside = (shen_hedrick_elkins if flange else polach)(patch)
        creep = along * touch.along + aside * sideways
        return load * by_place + np.concatenate([creep, np.cross(touch.arm, creep)]), along

    def parting(self, rail: GivenWay, body: Moving, touch: Touch) -> np.ndarray:
        """How the touching point of the wheel parts from its rail with small displacements of the wheelset, (6,).

        By virtual work that is the direction in which a normal force pushes, and where.
        """
        ends = []
        for sign in (1, -1):
            found = []
            for way in sign * self.step * np.eye(6):
                moved = body.displaced(way)
                arm = moved.axes @ body.axes.T @ touch.arm
                found.append(rail(moved.position).distance((moved.position + arm)[None])[0])
            ends.append(np.array(found))
        return (ends[0] - ends[1]) / (2 * self.step) / touch.steepness
