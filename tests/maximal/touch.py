"""Find where a wheel touches its rail by brute force: points on a surface of revolution against the rail's surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbd_model.contact.profiles import Profile
from tests.maximal.motion import Moving
from tests.maximal.rails import Rails, Surface

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

    `arm` [m]: position of the wheel's point, from the wheelset's centre. `normal`: into the wheel. `along`: the rail's
    direction. `approach` [m]: penetration, negative if the bodies are apart. `curvatures` [1/m]: A along and B across,
    halves of those of the gap. `square`: the same if the wheel were square to its rail, from the curvatures of both
    bodies (Meusnier's theorem). `across` [m]: coordinate on the wheel's profile. `slope`: of the profile there.
    `steepness`: distance in the section per displacement along the normal, 1 where the section is square to the rail.
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

    def look(size: float, reach: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return steps from the centre [m], points from the wheelset's centre and their distances from the rail."""
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
    # Curvatures are evaluated where the bodies just touch: separated by as much as they penetrate.
    _, points, _ = look(step, STENCIL)
    on_plane = (points - arm) @ np.column_stack([along, np.cross(normal, along)])
    bend = paraboloid(on_plane, surface.distance(wheelset.position + depth * normal + points))[2] / steepness / 2
    height, slope, curve = (float(wheel.profile.height(centre[0], n)) for n in range(3))
    upright = 1 / np.hypot(1.0, slope)
    across_both = curve * upright**3 + surface.curvature(wheelset.position + arm)
    square = upright / (2 * (wheel.radius - height)), across_both / 2
    return Touch(arm, normal, along, depth, (bend[0, 0], bend[1, 1]), square, float(centre[0]), slope, steepness)


def paraboloid(places: np.ndarray, values: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Return value, gradient and second derivatives at 0 of the paraboloid through values at places, shape (n, 2)."""
    x, y = places.T / SCALE
    columns = np.column_stack([np.ones_like(x), x, y, x**2 / 2, x * y, y**2 / 2])
    level, first, second, xx, xy, yy = np.linalg.lstsq(columns, values, rcond=None)[0]
    return float(level), np.array([first, second]) / SCALE, np.array([[xx, xy], [xy, yy]]) / SCALE**2


def gradient_at(surface: Surface, point: np.ndarray) -> np.ndarray:
    """Return the gradient of the distance from a rail at a point, by central differences; along the normal, 1 on a
    prism.
    """
    ways = DIFFERENCE * np.concatenate([np.eye(3), -np.eye(3)])
    gap = surface.distance(point + ways)
    return np.asarray((gap[:3] - gap[3:]) / (2 * DIFFERENCE))
