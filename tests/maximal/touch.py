"""Where a wheel touches its rail, by brute force: points on a surface of revolution against the surface of the rail."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbd_model.contact.profiles import Profile
from tests.maximal.motion import Moving
from tests.maximal.rails import Rails, Surface

#: First look: pitch across the profile [m] and about the axle [rad], and how far about it; a flange that is yawed by
#: 15 mrad touches by 0.05 rad ahead of the axle.
PITCH, TURN_PITCH, REACH = 0.4e-3, 4e-3, 0.08
#: A closer look has so many points in each direction, and each is so much closer than the one before.
POINTS, CLOSER = 9, 4
#: Rounds in which the paraboloid is laid anew about its own lowest point.
ROUNDS = 3
#: Half the breadth of the grid through which the paraboloid is laid, in steps.
STENCIL = 2
#: In which places are counted where a paraboloid is laid through them, and of differences [m].
SCALE, DIFFERENCE = 1e-3, 1e-6
#: Left out at the ends of a profile [m].
MARGIN = 0.5e-3


@dataclass(frozen=True)
class Wheel:
    """A wheel: side (1 left, -1 right), radius at y = 0 and distance of y = 0 from the middle of the axle [m]."""

    side: int
    radius: float
    half_distance: float
    profile: Profile

    def points(self, across: np.ndarray, turned: np.ndarray, axle: np.ndarray) -> np.ndarray:
        """Points of the surface of revolution, from the wheelset's centre [m], shape (..., 3).

        across [m]: place on the profile, outwards; turned [rad]: about the axle, 0 at the lowest point. axle: axes
        (columns), ahead, along the axle, up, that do not turn with the wheel.
        """
        radius = self.radius - self.profile.height(across)
        local = [radius * np.sin(turned), self.side * (self.half_distance + across), -radius * np.cos(turned)]
        return np.stack(local, axis=-1) @ axle.T


@dataclass(frozen=True)
class Touch:
    """Where a part of a wheel is nearest to its rail or deepest in it.

    arm [m]: of the wheel's point, from the wheelset's centre; normal: into the wheel; along: the rail's direction;
    approach [m], negative where they are apart; curvatures [1/m]: A along and B across, halves of those of the gap, and
    `square` the same as if the wheel were square to its rail, of both bodies' own curvatures (Meusnier's theorem).
    across [m]: place on the wheel's profile; slope: of the profile there. steepness: of the distance in the section by
    the way along the normal, 1 where the section is square to the rail.
    """

    arm: np.ndarray
    normal: np.ndarray
    along: np.ndarray
    approach: float
    curvatures: tuple[float, float]
    square: tuple[float, float]
    across: float
    slope: float
    steepness: float


def axle_axes(wheelset: Moving, ahead: np.ndarray) -> np.ndarray:
    """Axes (columns) that have the axle as their second one, their first as near to `ahead` as that allows."""
    axle = wheelset.axes[:, 1]
    first = ahead - axle * (axle @ ahead)
    first = first / np.linalg.norm(first)
    return np.column_stack([first, axle, np.cross(first, axle)])


def touches(wheelset: Moving, wheel: Wheel, rails: Rails, step: float) -> list[Touch]:
    """Each place where a wheel is nearer to its rail than beside it, from the field side on; step [m]: of the grid."""
    surface = rails(wheelset.position)
    axle = axle_axes(wheelset, surface.along(wheelset.position))
    low, high = wheel.profile.limits
    across = np.arange(low + MARGIN, high - MARGIN, PITCH)
    turned = np.arange(-REACH, REACH, TURN_PITCH)
    grid = np.meshgrid(across, turned, indexing="ij")
    gap = surface.distance(wheelset.position + wheel.points(*grid, axle))
    best = np.min(gap, axis=1)
    inner = np.arange(1, across.size - 1)
    lowest = inner[(best[inner] < best[inner - 1]) & (best[inner] <= best[inner + 1]) & (np.abs(best[inner]) < NEAR)]
    starts = [(across[i], turned[int(np.argmin(gap[i]))]) for i in lowest[::-1]]
    found = [look_closer(wheelset, wheel, surface, axle, start, step) for start in starts]
    return [one for i, one in enumerate(found) if all(abs(one.across - other.across) > PITCH for other in found[:i])]


#: Farther from its rail, or deeper in it, than this [m] nothing is a contact but an end of a profile.
NEAR = 2e-3


def look_closer(
    wheelset: Moving, wheel: Wheel, surface: Surface, axle: np.ndarray, start: tuple[float, float], step: float
) -> Touch:
    """One place, by ever finer grids down to `step` [m] and then by the paraboloid through the last one."""
    centre, scale = np.array(start), np.array([1.0, 1 / wheel.radius])

    def look(size: float, reach: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Steps from the centre [m], points from the wheelset's centre and their distances from the rail."""
        one = size * np.arange(-reach, reach + 1)
        steps = np.stack(np.meshgrid(one, one, indexing="ij"), axis=-1).reshape(-1, 2)
        across, turned = (centre + steps * scale).T
        points = wheel.points(np.clip(across, *wheel.profile.limits), turned, axle)
        return steps, points, surface.distance(wheelset.position + points)

    size = max(PITCH, TURN_PITCH * wheel.radius)
    while size > step:
        size = max(size / CLOSER, step)
        steps, _, gap = look(size, POINTS)
        centre = centre + steps[np.argmin(gap)] * scale
    for _ in range(ROUNDS):
        steps, _, gap = look(step, STENCIL)
        _, gradient, hessian = paraboloid(steps, gap)
        centre = centre - np.linalg.solve(hessian, gradient) * scale

    centre[0] = np.clip(centre[0], *wheel.profile.limits)
    arm = wheel.points(centre[0], centre[1], axle)
    gradient = gradient_at(surface, wheelset.position + arm)
    steepness = float(np.linalg.norm(gradient))
    normal = gradient / steepness
    along = surface.along(wheelset.position + arm)
    along = along - normal * (normal @ along)
    along = along / np.linalg.norm(along)
    depth = -float(surface.distance(wheelset.position + arm[None])[0]) / steepness
    # Curvatures count where the bodies just touch: as far apart as they press into each other.
    _, points, _ = look(step, STENCIL)
    on_plane = (points - arm) @ np.column_stack([along, np.cross(normal, along)])
    bend = paraboloid(on_plane, surface.distance(wheelset.position + depth * normal + points))[2] / steepness / 2
    height, slope, curve = (float(wheel.profile.height(centre[0], n)) for n in range(3))
    upright = 1 / np.hypot(1.0, slope)
    across_both = curve * upright**3 + surface.curvature(wheelset.position + arm)
    square = upright / (2 * (wheel.radius - height)), across_both / 2
    return Touch(arm, normal, along, depth, (bend[0, 0], bend[1, 1]), square, float(centre[0]), slope, steepness)


def paraboloid(places: np.ndarray, values: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Value, gradient and second derivatives at 0 of the paraboloid through values at places, shape (n, 2)."""
    x, y = places.T / SCALE
    columns = np.column_stack([np.ones_like(x), x, y, x**2 / 2, x * y, y**2 / 2])
    level, first, second, xx, xy, yy = np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(level), np.array([first, second]) / SCALE, np.array([[xx, xy], [xy, yy]]) / SCALE**2


def gradient_at(surface: Surface, point: np.ndarray) -> np.ndarray:
    """Of the distance from a rail at a point, by central differences; along the normal, of length 1 on a prism."""
    ways = DIFFERENCE * np.concatenate([np.eye(3), -np.eye(3)])
    gap = surface.distance(point + ways)
    return np.asarray((gap[:3] - gap[3:]) / (2 * DIFFERENCE))
