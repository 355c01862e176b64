"""Newton's and Euler's laws for a vehicle as a whole, about one fixed point, at any state, at rest or not.

The rails push the wheels where they touch, and all parts have weight: that changes momentum and angular momentum, and
nothing else does. Of the model come states, their slopes and the forces of the rails. Parts are data, the track is
analytical, and places of contact are searched for on the surfaces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fmu_src.kernel import Kernel
from rbd_model.contact.patches import Patch, patches_of
from rbd_model.track.line import Segment, line_of
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.description import Vehicle, wheelset_name
from rbd_model.wheelset.touching_patch import LARGEST_STEP
from tests.maximal.correspondence import bodies_of, rates_of
from tests.maximal.machine import SIDES, Machine
from tests.maximal.motion import Moving
from tests.maximal.rails import Course, RailData, Rails, prisms
from tests.maximal.touch import Touch, Wheel, axle_axes, touches

#: Grid of the contacts [m], and where a line of one curve begins and how long it is [m].
GRID, BEGIN, LENGTH = 0.05e-3, -30.0, 3000.0
#: How far about the axle a wheel is looked at [rad], from whose lowest point a yawed tread is nearest.
FADING = 0.01
#: `prisms` or `swept`.
Shape = Callable[[Course, RailData], Rails]
#: States of a wheelset that a level may not have.
OF_WHEELSETS = ("lateral", "lateral_speed", "rise", "rise_speed", "roll", "roll_rate", "yaw", "yaw_rate")


@dataclass(frozen=True)
class Now:
    """States of a vehicle by name and their slopes, on a course."""

    vehicle: Vehicle
    course: Course
    value: Mapping[str, float]
    slope: Mapping[str, float]

    @classmethod
    def of(cls, vehicle: Vehicle, course: Course, kernel: Kernel, names: list[str]) -> Now:
        """As a kernel stands; names: of its states."""
        found = kernel.linearise()
        none = dict.fromkeys((f"{name}_{number}" for number, _ in vehicle.numbered for name in OF_WHEELSETS), 0.0)
        value, slope = (none | dict(zip(names, row, strict=True)) for row in (found.state, found.slope))
        return cls(vehicle, course, value, slope)

    def changed(self, **values: float) -> Now:
        """With other states."""
        return replace(self, value={**self.value, **values})

    @property
    def bodies(self) -> dict[str, Moving]:
        """All parts in the inertial frame."""
        return bodies_of(self.vehicle, self.course, self.value)

    def track(self, place: np.ndarray) -> np.ndarray:
        """Axes of the track (columns) beside a place."""
        return np.asarray(self.course.axes(self.course.place_of(place[None]))[0])


@dataclass(frozen=True)
class Reaction:
    """Force of a rail on a wheel [N] and the place where it acts [m], inertial."""

    place: np.ndarray
    force: np.ndarray


def parts(vehicle: Vehicle) -> dict[str, tuple[float, np.ndarray]]:
    """Mass [kg] and moments of inertia of bodies and wheelsets by name."""
    every = {body.name: body for body in vehicle.bodies}
    every |= {wheelset_name(number): data for number, data in vehicle.numbered}  # type: ignore[dict-item]
    number = vehicle.number
    return {name: (number(one.mass), np.array([number(size) for size in one.inertia])) for name, one in every.items()}


def pushed(body: Moving, mass: float, inertia: np.ndarray, acceleration: np.ndarray, gravity: float) -> np.ndarray:
    """Force and moment about the origin, beside the weight, that accelerate a body so: Newton, Euler; shape (6,)."""
    tensor = body.axes @ np.diag(inertia) @ body.axes.T
    force = mass * (acceleration[:3] + np.array([0.0, 0.0, gravity]))
    turned = tensor @ acceleration[3:] + np.cross(body.rate, tensor @ body.rate)
    return np.concatenate([force, np.cross(body.position, force) + turned])


def curve(radius: float = np.inf, cant: float = 0.0, gradient: float = 0.0) -> Course:
    """An arc, to the left where its radius [m] is positive; cant [m] has the sign of the radius it suits."""
    return Course((1 / radius, 0.0), (-cant / GAUGE, 0.0), (gradient, 0.0))


def file_of(course: Course, path: Path) -> str:
    """The same as the model reads it; the place."""
    curvature, cant, gradient = course.curvature[0], -course.roll[0] * GAUGE, course.gradient[0]
    whole = Segment(LENGTH, (curvature, curvature), (cant, cant), (gradient, gradient))
    return str(line_of([whole], BEGIN).write(path))


def imbalance(now: Now, reactions: list[Reaction]) -> np.ndarray:
    """What rails and weights have more than momentum asks for: force, and moment about the track's centre under the
    first body, in the axes of the track there, as shares of the weight and of what one rail could carry; shape (6,).
    """
    vehicle, bodies = now.vehicle, now.bodies
    rates = rates_of(vehicle, now.course, now.value, now.slope)
    gravity, half = vehicle.number("gravity"), vehicle.wheelsets[0].pair.left.rail_half_distance
    place = np.array([now.value[f"{vehicle.bodies[0].name}_distance"]])
    origin, axes = now.course.origin(place)[0], now.course.axes(place)[0]
    total = np.zeros(6)
    for name, (mass, inertia) in parts(vehicle).items():
        from_here = replace(bodies[name], position=bodies[name].position - origin)
        total -= pushed(from_here, mass, inertia, rates[name].acceleration, gravity)
    for one in reactions:
        total += np.concatenate([one.force, np.cross(one.place - origin, one.force)])
    weight = gravity * sum(mass for mass, _ in parts(vehicle).values())
    return np.concatenate([axes.T @ total[:3], axes.T @ total[3:] / half]) / weight


def in_plane(now: Now, kernel: Kernel) -> list[Reaction]:
    """Of the rails of level 2, below each axle at the height of the rails."""
    found = []
    for number, data in now.vehicle.numbered:
        axle = now.bodies[wheelset_name(number)].position
        track, radius = now.track(axle), now.vehicle.number(data.mean_radius)
        force = kernel[f"creep_force_{number}"] * track[:, 0] + kernel[f"axle_load_{number}"] * track[:, 2]
        found.append(Reaction(axle - radius * track[:, 2], force))
    return found


@dataclass(frozen=True)
class OnRail:
    """A wheel on its rail: number and body of its wheelset, its side, its surface and where that is nearest."""

    number: int
    side: int
    body: Moving
    wheel: Wheel
    rails: Rails
    near: list[Touch]

    def arm(self, patch: Patch) -> np.ndarray:
        """From the wheelset's centre to where a patch bears [m].

        One that has no place of its own, but fades, or lies flat on its rail beside that, bears on the last that its
        table has, towards the field, where the wheel is nearest to the rail about its axle.
        """
        last = np.max(patch.nearest[1][:, 0]) + LARGEST_STEP
        own = [one for one in self.near if one.approach > 0.0 and patch.limits[0] <= one.across <= last]
        if own:
            return max(own, key=lambda one: one.approach).arm
        rail, turned = self.rails(self.body.position), np.linspace(-FADING, FADING, 401)
        across = np.full_like(turned, last)
        points = self.wheel.points(across, turned, axle_axes(self.body, rail.along(self.body.position)))
        return np.asarray(points[np.argmin(rail.distance(self.body.position + points))])


def wheels(machine: Machine, now: Now, base: float, shape: Shape = prisms) -> Iterator[OnRail]:
    """All of level 3; base [m]: how high level rails lie."""
    bodies, oracle = now.bodies, machine.oracle(now.course, base)
    for number, _ in now.vehicle.numbered:
        body = bodies[wheelset_name(number)]
        for index, (side, word) in enumerate(SIDES.items()):
            beside, above = (now.value.get(name, 0.0) for name in (f"track_{number}", f"track_{number}_{word}"))
            rail = RailData(side, (machine.half_distance + side * beside, base + above), machine.curve)
            wheel, rails = oracle.wheel_of(number, index), shape(now.course, rail)
            yield OnRail(number, side, body, wheel, rails, touches(body, wheel, rails, GRID))


def in_space(machine: Machine, now: Now, kernel: Kernel, base: float, shape: Shape = prisms) -> list[Reaction]:
    """Of the rails of level 3, contact model 2, on each patch of each wheel."""
    found = []
    for one in wheels(machine, now, base, shape):
        track, data = now.track(one.body.position), now.vehicle.wheelsets[one.number - 1]
        for which, patch in enumerate(patches_of(data.pair.both[(1 - one.side) // 2])):
            names = [f"force_{which}_{one.number}_{SIDES[one.side]}_{row}" for row in ("ahead", "aside", "above")]
            force = np.array([kernel[name] for name in names])
            if force.any():
                found.append(Reaction(one.body.position + one.arm(patch), track @ force))
    return found + [one for number, _ in now.vehicle.numbered for one in holding(now, kernel, number)]


def holding(now: Now, kernel: Kernel, number: int) -> Iterator[Reaction]:
    """What holds an axle that stands on its locked wheelset, as far below it as that would roll."""
    if now.value[f"{now.vehicle.bodies[0].name}_speed"] + now.value[f"shift_speed_{number}"] == 0.0:
        axle = now.bodies[wheelset_name(number)].position
        track, radius = now.track(axle), now.vehicle.number(now.vehicle.wheelsets[number - 1].mean_radius)
        yield Reaction(axle - radius * track[:, 2], kernel[f"creep_force_{number}"] * track[:, 0])
