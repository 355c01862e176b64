"""A wheel on its rail by strips: several patches of any shape from the undeformed distance, each with its creep forces.

Three nearly independent parts: `distance` (position of the overlap), `normal` (normal forces), `strip_creep` (creep
forces). This is a reference and study tool in NumPy with any number of strips. The level `spatial` has it in C, with
fewer strips, at contact model 3 (strips.c). There the height of the wheelset is a coordinate of the motion. Only here
it is searched for, for a given load.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from rbd_model.contact.distance import Stand, Strips, touching
from rbd_model.contact.geometry import Pair
from rbd_model.contact.normal import ContactArea, Steel, patches
from rbd_model.contact.strip_creep import Creepages, creep_forces


@dataclass(frozen=True)
class WheelVelocity:
    """Velocity of a wheelset's centre [m/s], ahead above 0, and its rotation [rad/s], in the axes of the stand.

    The sign of the rotation is that of right-handed axes of a left wheel; the right wheel is its mirror image.
    """

    velocity: tuple[float, float, float]
    rotation: tuple[float, float, float]


def motion_of(side: int, velocity: tuple[float, float, float], rotation: tuple[float, float, float]) -> WheelVelocity:
    """Return the motion from the track's axes of section 3.2 (ahead, left, up), for the LEFT or the RIGHT wheel."""
    return WheelVelocity(
        (velocity[0], side * velocity[1], velocity[2]), (side * rotation[0], rotation[1], side * rotation[2])
    )


def rolling(stand: Stand, speed: float, pitch_rate: float) -> WheelVelocity:
    """Return straight motion with rotation about the axle alone, in the direction of section 3.2's yaw and roll."""
    sin_yaw, cos_yaw = np.sin(stand.yaw), np.cos(stand.yaw)
    axle = (-sin_yaw * np.cos(stand.roll), cos_yaw * np.cos(stand.roll), np.sin(stand.roll))
    return WheelVelocity((speed, 0.0, 0.0), (pitch_rate * axle[0], pitch_rate * axle[1], pitch_rate * axle[2]))


def creepages_of(strips: Strips, motion: WheelVelocity) -> Creepages:
    """Return velocities of the wheel's surface over the speed, at each strip in its tangent plane.

    Equations (2.3), (3.89).
    """
    speed = motion.velocity[0]
    sliding = np.array(motion.velocity)[:, None] + np.cross(motion.rotation, strips.arm.T).T
    sine, cosine = np.sin(strips.angle), np.cos(strips.angle)
    _, about_side, about_up = motion.rotation
    return Creepages(
        sliding[0] / speed,
        (cosine * sliding[1] + sine * sliding[2]) / speed,
        (cosine * about_up - sine * about_side) / speed,
    )


@dataclass(frozen=True)
class Pressed:
    """A patch with the creep forces on the wheel, ahead and to the side, of each of its strips [N], shape (2, n)."""

    patch: ContactArea
    creep: np.ndarray

    @property
    def force(self) -> np.ndarray:
        """Force on the wheel, ahead, outwards and up [N]; each strip's in its own tangent plane."""
        sine, cosine = np.sin(self.patch.strips.angle), np.cos(self.patch.strips.angle)
        (ahead, aside), loads = self.creep, self.patch.loads
        return np.array([np.sum(ahead), np.sum(cosine * aside - sine * loads), np.sum(sine * aside + cosine * loads)])


CreepagesOf = Callable[[Strips], Creepages]


def pressed(
    pair: Pair, stand: Stand, steel: Steel, friction: float, creepages: CreepagesOf, apart: bool = False
) -> list[Pressed]:
    """Return all patches of a wheel with their forces, Kalker (1982); none if the wheel is above its rail.

    creepages: function of given strips, such as `creepages_of` with a motion. apart: as in `patches`.
    """
    return [
        Pressed(patch, creep_forces(patch, creepages(patch.strips), steel, friction))
        for patch in patches(pair, stand, steel, apart)
    ]


def total(contacts: list[Pressed]) -> np.ndarray:
    """Return the force on the wheel, ahead, outwards and up [N]: Newton's sum over the patches."""
    return np.sum([contact.force for contact in contacts] or np.zeros((1, 3)), axis=0)


#: First approach in the search for a load, doubled until it is large enough, and tolerance of the search [m].
FIRST_APPROACH, APPROACH_TOLERANCE = 20e-6, 1e-11


def under_load(
    pair: Pair,
    stand: Stand,
    steel: Steel,
    friction: float,
    creepages: CreepagesOf,
    load: float,
    apart: bool = False,
) -> tuple[Stand, list[Pressed]]:
    """Return the stand's height and the patches for a vertical force on the wheel equal to the load [N]: Newton's
    law.
    """
    top, _ = touching(pair, stand)

    def excess(approach: float) -> float:
        return float(total(pressed(pair, at(approach), steel, friction, creepages, apart))[2]) - load

    def at(approach: float) -> Stand:
        return replace(stand, height=top - approach)

    enough = FIRST_APPROACH
    while excess(enough) < 0.0:
        enough *= 2
    found = at(float(brentq(excess, 0.0, enough, xtol=APPROACH_TOLERANCE)))
    return found, pressed(pair, found, steel, friction, creepages, apart)


@dataclass(frozen=True)
class StripPlace:
    """One place for all patches of a wheel: on rail and wheel, along the rail from the axle [m], angle [rad]."""

    on_rail: float
    on_wheel: float
    along: float
    angle: float


def place_of(contacts: list[Pressed]) -> StripPlace:
    """Return the centre of the squared overlap of the undeformed surfaces, the contact's place in Vollebregt (2020)."""
    weights = np.concatenate([contact.patch.overlap for contact in contacts])
    columns = [(s.on_rail, s.on_wheel, s.arm[0], s.angle) for s in (contact.patch.strips for contact in contacts)]
    return StripPlace(*(float(np.average(np.concatenate(c), weights=weights)) for c in zip(*columns, strict=True)))
