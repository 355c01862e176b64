"""Newton's and Euler's laws for a whole vehicle about one fixed point, in any state, moving or at rest.

Only weight and the forces of the rails on the wheels change momentum and angular momentum. The model supplies the
states, their derivatives and the forces of the rails. The parts are data, the track is analytical, and the contact
points are searched for on the surfaces.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fmu_src.kernel import Kernel
from rbd_model.contact.patches import SEARCH_PITCH, WheelPart, patches_of
from rbd_model.track.line import Segment, line_of
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.description import Vehicle, wheelset_name
from tests.evidence.maximal.correspondence import bodies_of, rates_of
from tests.evidence.maximal.machine import SIDES, Machine
from tests.evidence.maximal.motion import Moving
from tests.evidence.maximal.overlap import part_of
from tests.evidence.maximal.rails import Course, RailData, Rails, prisms
from tests.evidence.maximal.touch import Wheel

#: Force [N] up to which a patch is unloaded: the least approach of a contact (`contact/elastic.py`) leaves 1e-8 N.
UNLOADED = 1e-6
#: Pitch of the places across a contact [m]; start and length of a line of one curve [m].
GRID, BEGIN, LENGTH = 0.05e-3, -30.0, 3000.0
#: `prisms` or `swept`.
Shape = Callable[[Course, RailData], Rails]
#: States of a wheelset that a level may not have.
OF_WHEELSETS = ("lateral", "lateral_speed", "rise", "rise_speed", "roll", "roll_rate", "yaw", "yaw_rate")


@dataclass(frozen=True)
class Now:
    """States of a vehicle and their derivatives by name, on a course."""

    vehicle: Vehicle
    course: Course
    value: Mapping[str, float]
    slope: Mapping[str, float]

    @classmethod
    def of(cls, vehicle: Vehicle, course: Course, kernel: Kernel, names: list[str]) -> Now:
        """Return the current state of a kernel; names: the names of its states."""
        found = kernel.linearise()
        none = dict.fromkeys((f"{name}_{number}" for number, _ in vehicle.numbered for name in OF_WHEELSETS), 0.0)
        value, slope = (none | dict(zip(names, row, strict=True)) for row in (found.state, found.slope))
        return cls(vehicle, course, value, slope)

    def changed(self, **values: float) -> Now:
        """Return a copy with some states replaced."""
        return replace(self, value={**self.value, **values})

    @property
    def bodies(self) -> dict[str, Moving]:
        """Return all parts in the inertial frame."""
        return bodies_of(self.vehicle, self.course, self.value)

    def track(self, place: np.ndarray) -> np.ndarray:
        """Return the axes of the track (columns) at the point of the track nearest to a place."""
        return np.asarray(self.course.axes(self.course.place_of(place[None]))[0])


@dataclass(frozen=True)
class Reaction:
    """Force of a rail on a wheel [N] and the place where it acts [m], inertial."""

    place: np.ndarray
    force: np.ndarray


def parts(vehicle: Vehicle) -> dict[str, tuple[float, np.ndarray]]:
    """Return the mass [kg] and the moments of inertia of each body and wheelset by name."""
    every = {body.name: body for body in vehicle.bodies}
    every |= {wheelset_name(number): data for number, data in vehicle.numbered}  # type: ignore[dict-item]
    number = vehicle.number
    return {name: (number(one.mass), np.array([number(size) for size in one.inertia])) for name, one in every.items()}


def pushed(body: Moving, mass: float, inertia: np.ndarray, acceleration: np.ndarray, gravity: float) -> np.ndarray:
    """Return force and moment about the origin, without the weight, for an acceleration (Newton, Euler); shape (6,)."""
    tensor = body.axes @ np.diag(inertia) @ body.axes.T
    force = mass * (acceleration[:3] + np.array([0.0, 0.0, gravity]))
    turned = tensor @ acceleration[3:] + np.cross(body.rate, tensor @ body.rate)
    return np.concatenate([force, np.cross(body.position, force) + turned])


def curve(radius: float = np.inf, cant: float = 0.0, gradient: float = 0.0) -> Course:
    """Return an arc, to the left if its radius [m] is positive; cant [m] has the sign of the radius that it suits."""
    return Course((1 / radius, 0.0), (-cant / GAUGE, 0.0), (gradient, 0.0))


def file_of(course: Course, path: Path) -> str:
    """Write the course as a line file that the model can read; return its path."""
    curvature, cant, gradient = course.curvature[0], -course.roll[0] * GAUGE, course.gradient[0]
    whole = Segment(LENGTH, (curvature, curvature), (cant, cant), (gradient, gradient))
    return str(line_of([whole], BEGIN).write(path))


def imbalance(now: Now, reactions: list[Reaction]) -> np.ndarray:
    """Return the resultant of rail forces and weight minus the rate of momentum; shape (6,).

    Force and moment are about the track's centre under the first body, in the axes of the track there. The force is a
    share of the weight, the moment a share of the weight times half the distance of the rails.
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
    """Return the rail reactions of level 2, below each axle at rail height."""
    found = []
    for number, data in now.vehicle.numbered:
        axle = now.bodies[wheelset_name(number)].position
        track, radius = now.track(axle), now.vehicle.number(data.mean_radius)
        force = kernel[f"creep_force_{number}"] * track[:, 0] + kernel[f"axle_load_{number}"] * track[:, 2]
        found.append(Reaction(axle - radius * track[:, 2], force))
    return found


@dataclass(frozen=True)
class OnRail:
    """A wheel on its rail: number and body of its wheelset, its side and its surface, and the shear modulus [Pa]."""

    number: int
    side: int
    body: Moving
    wheel: Wheel
    rails: Rails
    modulus: float

    def arm(self, patch: WheelPart) -> np.ndarray:
        """Return the vector from the wheelset's centre to the line along which a patch carries load [m]."""
        low = self.wheel.profile.limits[0] + SEARCH_PITCH
        ends = low + SEARCH_PITCH * patch.first, low + SEARCH_PITCH * (patch.last - 1)
        return part_of(self.body, self.wheel, self.rails, GRID, self.modulus, ends).on_line


def wheels(machine: Machine, now: Now, base: float, shape: Shape = prisms) -> Iterator[OnRail]:
    """Yield all wheels of level 3; base: height of level rails [m]."""
    bodies, oracle = now.bodies, machine.oracle(now.course, base)
    for number, _ in now.vehicle.numbered:
        body = bodies[wheelset_name(number)]
        for index, (side, word) in enumerate(SIDES.items()):
            beside, above = (now.value.get(name, 0.0) for name in (f"track_{number}", f"track_{number}_{word}"))
            rail = RailData(side, (machine.half_distance + side * beside, base + above), machine.curve)
            wheel, rails = oracle.wheel_of(number, index), shape(now.course, rail)
            yield OnRail(number, side, body, wheel, rails, now.vehicle.number("shear_modulus"))


def in_space(machine: Machine, now: Now, kernel: Kernel, base: float, shape: Shape = prisms) -> list[Reaction]:
    """Return the rail reactions of level 3, contact model 2, on each patch of each wheel."""
    found = []
    for one in wheels(machine, now, base, shape):
        track, data = now.track(one.body.position), now.vehicle.wheelsets[one.number - 1]
        for which, patch in enumerate(patches_of(data.pair.both[(1 - one.side) // 2])):
            names = [f"force_{which}_{one.number}_{SIDES[one.side]}_{row}" for row in ("ahead", "aside", "above")]
            force = np.array([kernel[name] for name in names])
            if np.max(np.abs(force)) > UNLOADED:
                found.append(Reaction(one.body.position + one.arm(patch), track @ force))
    return found + [one for number, _ in now.vehicle.numbered for one in holding(now, kernel, number)]


def holding(now: Now, kernel: Kernel, number: int) -> Iterator[Reaction]:
    """Yield the force that holds an axle at rest on its locked wheelset, one rolling radius below the axle."""
    if now.value[f"{now.vehicle.bodies[0].name}_speed"] + now.value[f"shift_speed_{number}"] == 0.0:
        axle = now.bodies[wheelset_name(number)].position
        track, radius = now.track(axle), now.vehicle.number(now.vehicle.wheelsets[number - 1].mean_radius)
        yield Reaction(axle - radius * track[:, 2], kernel[f"creep_force_{number}"] * track[:, 0])
