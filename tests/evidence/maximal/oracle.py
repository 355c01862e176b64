"""Compute the accelerations of all bodies and the forces of all wheels of a vehicle at an instant."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from rbd_model.vehicle.description import SuspensionElement, Vehicle, wheelset_name
from tests.evidence.maximal.hertz import semi_axes_of
from tests.evidence.maximal.joints import Carriers, End, Ends, on_bodies, wrenches
from tests.evidence.maximal.motion import Moving, accelerations
from tests.evidence.maximal.overlap import STEP, Contact, contacts
from tests.evidence.maximal.rails import Course, Rails, Shifted
from tests.evidence.maximal.slip import Rolling, kalker_to_coulomb
from tests.evidence.maximal.statics import preloads
from tests.evidence.maximal.touch import Wheel

#: Slope above which a contact lies on the flange. It carries load in addition to a tread contact.
FLANGE_SLOPE = math.tan(math.radians(20.0))
#: Pitch of the places across a contact [m].
GRID = 0.05e-3


@dataclass(frozen=True)
class WheelForces:
    """Forces of the rail on one wheel [N].

    force: ahead, to the left and up in track axes. creep_along: creep force along the rail. flange: share of the flange
    in the force to the left.
    """

    force: np.ndarray
    creep_along: float
    flange: float


@dataclass(frozen=True)
class Scene:
    """Inputs per wheelset, rotating forwards: friction of its rails, brake torque and traction torque [N.m]."""

    friction: list[float]
    brake: list[float]
    traction: list[float]


@dataclass(frozen=True)
class GivenWay:
    """The left (0) or right (1) rail of an oracle, displaced by `give`, in the order of `Oracle.give`."""

    oracle: Oracle
    index: int
    give: np.ndarray

    def __call__(self, centre: np.ndarray) -> Shifted:
        """Implement `Rails`: return the rail at a wheelset's centre."""
        return Shifted(self.oracle.rails[self.index](centre), self.across(centre, 0))

    def speed(self, body: Moving) -> np.ndarray:
        """Return the inertial velocity of the rail [m/s]."""
        return self.across(body.position, 1)

    def across(self, centre: np.ndarray, row: int) -> np.ndarray:
        """Return a row of `give` for this rail as a vector."""
        aside, up = self.give[row, 0], self.give[row, 1 + self.index]
        return np.asarray(self.oracle.track(centre) @ [0.0, aside, up])


@dataclass(frozen=True)
class Oracle:
    """A vehicle on its rails.

    `rails`: the left and the right one, on the course; `Rails` gives the surface for a wheelset's centre. `carriers`:
    the bodies whose axes give the directions of a connection. `below`: stiffness [N/m] and damping [N.s/m] of the track
    below a wheelset, in the order of `give`. `square`: use the curvature along the rail of a wheel square to it,
    the one simplification of the fast model. `grid`, `step` [m]: pitch of the places across and step of differences.
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
        """Return accelerations (6,) by body, forces by wheelset and side, and forces that accelerate rails (3,) by
        wheelset [N].
        """
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
            # Brake and motor are mounted in a body. The brake torque opposes the forward rotation.
            torque = (scene.traction[number - 1] - scene.brake[number - 1]) * bodies[name].axes[:, 1]
            total[name][3:] += torque
            total[data.reacts_on][3:] -= torque
        return {name: self.acceleration(name, body, total[name]) for name, body in bodies.items()}, wheels, below

    def give(self, number: int, states: Mapping[str, float]) -> np.ndarray:
        """Return displacement [m] and speed [m/s] of the rails below a wheelset, (2, 3): to the left, each one up."""
        rows = (f"track_{number}", f"track_{number}_left", f"track_{number}_right")
        return np.array([[states.get(f"{row}{end}", 0.0) for row in rows] for end in ("", "_speed")])

    def moving_rails(self, number: int, give: np.ndarray, wheels: list[np.ndarray]) -> np.ndarray:
        """Return the forces that accelerate the rails below a wheelset, in the order of `give`; wheels: forces on its
        wheels [N].
        """
        value = self.vehicle.number
        name, mass = wheelset_name(number), value(self.vehicle.wheelsets[number - 1].mass)
        resting = [self._preloads[one.name] for one in self.vehicle.carrying if one.lower == name for _ in one.sides()]
        static, (left, right) = (sum(resting) + mass * value("gravity")) / 2, wheels
        pushed = np.array([-left[1] - right[1], static - left[2], static - right[2]])
        return np.asarray(pushed - np.sum(self.below * give, axis=0))

    def ends(self, connection: SuspensionElement, bodies: Mapping[str, Moving]) -> Ends:
        """Return the upper and the lower end."""
        upper, lower = (
            End(bodies[name], self.place(name), name in self.wheelsets) for name in (connection.upper, connection.lower)
        )
        return upper, lower

    @property
    def wheelsets(self) -> dict[str, int]:
        """Return the numbers of the wheelsets by name."""
        return {wheelset_name(number): number for number, _ in self.vehicle.numbered}

    def place(self, name: str) -> np.ndarray:
        """Return the centre of a body in the vehicle at rest [m]."""
        number = self.vehicle.number
        if name in self.wheelsets:
            return np.array([number(self.vehicle.wheelsets[self.wheelsets[name] - 1].along), 0.0, 0.0])
        body = next(body for body in self.vehicle.bodies if body.name == name)
        return np.array([number(body.along), 0.0, number(body.height)])

    def acceleration(self, name: str, body: Moving, wrench: np.ndarray) -> np.ndarray:
        """Return the acceleration of a body under an applied wrench and its weight."""
        number = self.vehicle.number
        parts = {part.name: part for part in self.vehicle.bodies}
        part = parts.get(name) or self.vehicle.wheelsets[self.wheelsets[name] - 1]
        mass = number(part.mass)
        weight = np.array([0.0, 0.0, -mass * number("gravity"), 0.0, 0.0, 0.0])
        return accelerations(body, mass, np.array([number(size) for size in part.inertia]), wrench + weight)

    def wheel(self, number: int, rail: GivenWay, body: Moving, friction: float) -> tuple[np.ndarray, WheelForces]:
        """Return the wrench of the rail on a wheel about the wheelset's centre (6,), and its forces."""
        modulus, on = self.vehicle.number("shear_modulus"), self.wheel_of(number, rail.index)
        track = self.track(body.position)
        wrench, force, creep, flange = np.zeros(6), np.zeros(3), 0.0, 0.0
        for contact in contacts(body, on, rail, self.grid, modulus, self.square, self.step):
            on_flange = contact.slope > FLANGE_SLOPE
            pushed, creeping = self.press(rail, body, contact, friction)
            wrench += pushed
            force += track.T @ pushed[:3]
            creep += creeping
            flange += on_flange * float(track[:, 1] @ pushed[:3])
        return wrench, WheelForces(force, creep, flange)

    def wheel_of(self, number: int, index: int) -> Wheel:
        """Return the left (0) or right (1) wheel of a wheelset."""
        data = self.vehicle.wheelsets[number - 1]
        one = data.pair.both[index]
        return Wheel((1, -1)[index], self.vehicle.number(data.radius[index]), one.wheel_half_distance, one.wheel)

    def track(self, centre: np.ndarray) -> np.ndarray:
        """Return the axes of the track (columns) at a body's centre."""
        return np.asarray(self.course.axes(self.course.place_of(centre[None]))[0])

    def press(self, rail: GivenWay, body: Moving, contact: Contact, friction: float) -> tuple[np.ndarray, float]:
        """Return the wrench of one contact on the wheelset (6,), and its creep force along the rail [N]."""
        number = self.vehicle.number
        modulus, moved = number("shear_modulus"), rail.speed(body)
        closing = float(contact.parting[:3] @ moved - contact.parting @ body.twist)
        load = contact.load * max(1 + number("contact_damping") * closing, 0.0)
        elastic = contact.push + (load - contact.load) * contact.parting
        if load <= 0.0:
            return elastic, 0.0

        sideways = np.cross(contact.normal, contact.along)
        sliding = body.velocity + np.cross(body.rate, contact.arm) - moved
        least, forward = number("creepage_speed"), float(self.track(body.position)[:, 0] @ body.velocity)
        slides = (
            sliding @ contact.along,
            sliding @ sideways,
            body.rate @ contact.normal * np.clip(forward / least, -1, 1),
        )
        creepages = np.array(slides) / math.hypot(forward, least)
        axes = semi_axes_of(load, *contact.curvatures, modulus)
        patch = Rolling(tuple(creepages.tolist()), load, friction, axes, modulus)  # type: ignore[arg-type]
        along, aside = kalker_to_coulomb(patch)
        creep = along * contact.along + aside * sideways
        return elastic + np.concatenate([creep, np.cross(contact.arm, creep)]), along
