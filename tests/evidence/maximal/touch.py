"""Find where a wheel touches its rail by brute force: points on a surface of revolution against the rail's surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbd_model.contact.profiles import Profile
from tests.evidence.maximal.motion import Moving
from tests.evidence.maximal.rails import Rails, Surface

#: First grid: pitch across the profile [m] and about the axle [rad], and its reach about the axle. A flange yawed by 15
#: mrad touches 0.05 rad ahead of the axle.
PITCH, TURN_PITCH, REACH = 0.4e-3, 4e-3, 0.08
#: Points of a finer grid in each direction, and the factor by which each grid is finer than the previous one.
POINTS, CLOSER = 9, 4
#: Number of times that the paraboloid is refitted about its own lowest point.
ROUNDS = 3
#: Half width of the grid to which the paraboloid is fitted, in steps.
STENCIL = 2
#: Unit of length in the fit of a paraboloid, and step of differences [m].
SCALE, DIFFERENCE = 1e-3, 1e-6
#: Margin left out at the ends of a profile [m].
MARGIN = 0.5e-3


@dataclass(frozen=True)
class Wheel:
    """A wheel: side (1 left, -1 right), radius at y = 0 and distance of y = 0 from the middle of the axle [m]."""

    side: int
    radius: float
    half_distance: float
    profile: Profile

    def points(self, across: np.ndarray, turned: np.ndarray, axle: np.ndarray) -> np.ndarray:
        """Return points of the surface of revolution, from the wheelset's centre [m], shape (..., 3).

        across [m]: coordinate on the profile, outwards. turned [rad]: angle about the axle, 0 at the lowest point.
        axle: non-rotating axes (columns): ahead, along the axle, up.
        """
        radius = self.radius - self.profile.height(across)
        local = [radius * np.sin(turned), self.side * (self.half_distance + across), -radius * np.cos(turned)]
        return np.stack(local, axis=-1) @ axle.T


@dataclass(frozen=True)
class Touch:
    """Point where a part of a wheel is nearest to its rail, or deepest in it.

    `approach` [m]: penetration, negative if the bodies are apart. `across` [m]: coordinate on the wheel's profile.
    `slope`: of the profile there.
    """

    approach: float
    across: float
    slope: float


def axle_axes(wheelset: Moving, ahead: np.ndarray) -> np.ndarray:
    """Return axes (columns) whose second one is the axle; the first is as close to `ahead` as possible."""
    axle = wheelset.axes[:, 1]
    first = ahead - axle * (axle @ ahead)
    first = first / np.linalg.norm(first)
    return np.column_stack([first, axle, np.cross(first, axle)])


def touches(wheelset: Moving, wheel: Wheel, rails: Rails, step: float) -> list[Touch]:
    """Return each local minimum of the distance wheel to rail, from the field side on; step [m]: finest pitch."""
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


#: Largest distance or penetration of a contact [m]. Beyond it a minimum is an end of a profile.
NEAR = 2e-3


def look_closer(
    wheelset: Moving, wheel: Wheel, surface: Surface, axle: np.ndarray, start: tuple[float, float], step: float
) -> Touch:
    """Refine one place with ever finer grids down to `step` [m], then with the paraboloid through the last grid."""
    centre, scale = np.array(start), np.array([1.0, 1 / wheel.radius])

    def look(size: float, reach: int) -> tuple[np.ndarray, np.ndarray]:
        """Return steps from the centre and distances from the rail there [m]."""
        one = size * np.arange(-reach, reach + 1)
        steps = np.stack(np.meshgrid(one, one, indexing="ij"), axis=-1).reshape(-1, 2)
        across, turned = (centre + steps * scale).T
        points = wheel.points(np.clip(across, *wheel.profile.limits), turned, axle)
        return steps, surface.distance(wheelset.position + points)

    size = max(PITCH, TURN_PITCH * wheel.radius)
    while size > step:
        size = max(size / CLOSER, step)
        steps, gap = look(size, POINTS)
        centre = centre + steps[np.argmin(gap)] * scale
    for _ in range(ROUNDS):
        steps, gap = look(step, STENCIL)
        _, steep, hessian = paraboloid(steps, gap)
        centre = centre - np.linalg.solve(hessian, steep) * scale

    centre[0] = np.clip(centre[0], *wheel.profile.limits)
    arm = wheel.points(centre[0], centre[1], axle)
    point = wheelset.position + arm
    depth = -float(surface.distance(point[None])[0]) / float(np.linalg.norm(gradient(surface, point[None])))
    return Touch(depth, float(centre[0]), float(wheel.profile.height(centre[0], 1)))


def paraboloid(places: np.ndarray, values: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Return value, gradient and second derivatives at 0 of the paraboloid through values at places, shape (n, 2)."""
    x, y = places.T / SCALE
    columns = np.column_stack([np.ones_like(x), x, y, x**2 / 2, x * y, y**2 / 2])
    level, first, second, xx, xy, yy = np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(level), np.array([first, second]) / SCALE, np.array([[xx, xy], [xy, yy]]) / SCALE**2


def gradient(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Return the gradient of the distance from a rail at points, shape (n, 3), by central differences.

    On a prism it has the length 1.
    """
    ways = DIFFERENCE * np.eye(3)
    ends = [surface.distance(points + way) - surface.distance(points - way) for way in ways]
    return np.stack(ends, axis=-1) / (2 * DIFFERENCE)
