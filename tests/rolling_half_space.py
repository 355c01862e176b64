"""Exact theory of contact and rolling on rectangles of a half space, the reference for strips and creep laws.

Kalker (1990), Three-Dimensional Elastic Bodies in Rolling Contact. Boussinesq's and Cerruti's solutions are summed over
rectangles: pressure and tangential stress of any patch, which is unrolled into a plane. It shares only the positions of
the undeformed surfaces with the strips.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbd_model.contact.distance import Stand, Strips, strips_at
from rbd_model.contact.geometry import Pair
from rbd_model.contact.normal import Steel
from rbd_model.contact.strip_creep import Creepages

#: Largest number of rounds of both solutions, each with the change that ends it, as a share of the load and of the
#: largest stress.
ROUNDS, CHANGE, NEWTON_ROUNDS, SETTLED = 300, 1e-6, 100, 1e-8


@dataclass(frozen=True)
class Grid:
    """Rectangles: number and size along the rail and across it [m], and the strip in the middle of each column."""

    count: tuple[int, int]
    size: tuple[float, float]
    strips: Strips

    @property
    def along(self) -> np.ndarray:
        """Return the positions of the rows along the rail [m], 0 where the lowest column is nearest to it."""
        return (np.arange(self.count[0]) + 0.5 - self.count[0] / 2) * self.size[0]

    @property
    def ahead(self) -> np.ndarray:
        """Return the distance by which the nearest point of each column lies ahead [m]."""
        middle = self.strips.arm[0]
        return np.asarray(middle - middle[np.argmin(self.strips.distance)])

    @property
    def area(self) -> float:
        """Return the area of a rectangle [m2]."""
        return self.size[0] * self.size[1]


def grid_of(pair: Pair, stand: Stand, on_wheel: tuple[float, float], length: float, count: tuple[int, int]) -> Grid:
    """Return a grid; on_wheel: the part of the wheel that it covers, length: its length along the rail [m]."""
    fine = strips_at(pair, stand, np.linspace(*on_wheel, 4000))
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fine.arm[1]), np.diff(fine.arm[2])))])
    broad = arc[-1] / count[1]
    middles = np.interp((np.arange(count[1]) + 0.5) * broad, arc, fine.on_wheel)
    return Grid(count, (length / count[0], broad), strips_at(pair, stand, middles))


def pressure(grid: Grid, steel: Steel) -> np.ndarray:
    """Return the pressure on each rectangle [Pa], by conjugate gradients of Polonsky and Keer (1999), Wear 231."""
    gap = grid.strips.distance + grid.strips.curvature * (grid.along[:, None] - grid.ahead) ** 2
    influence, twice = _transformed_influence(grid, steel), tuple(2 * n for n in grid.count)

    def lowered(load: np.ndarray) -> np.ndarray:
        moved = np.fft.irfft2(np.fft.rfft2(load, s=twice) * influence, s=twice)
        return moved[: grid.count[0], : grid.count[1]]

    found = np.where(gap < 0.0, 1e8, 0.0)
    direction, before, restart = np.zeros_like(gap), 1.0, True
    for _ in range(ROUNDS):
        left = lowered(found) + gap
        touch = found > 0.0
        square = np.sum(left[touch] ** 2)
        direction = np.where(touch, left + (0.0 if restart else square / before) * direction, 0.0)
        before = square
        response = lowered(direction)
        step = np.sum(left[touch] * direction[touch]) / np.sum(response[touch] * direction[touch])
        new = np.maximum(found - step * direction, 0.0)
        overlap = (new == 0.0) & (left < 0.0)
        restart = bool(np.any(overlap))
        new = np.where(overlap, new - step * left, new)
        change, found = np.sum(np.abs(new - found)), new
        if change < CHANGE * np.sum(found):
            break
    return found


def _transformed_influence(grid: Grid, steel: Steel) -> np.ndarray:
    """Return the Fourier transform of an element's influence on all others, on a grid twice as large."""
    x, y = (np.fft.fftfreq(2 * n, 1 / (2 * n)) * size for n, size in zip(grid.count, grid.size, strict=True))
    along, across, _ = _integrals(x[:, None], y[None, :], grid.size)
    return np.fft.rfft2((along + across) * (1 - steel.poisson_ratio) / (np.pi * steel.shear_modulus))


def _integrals(x: np.ndarray, y: np.ndarray, size: tuple[float, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the integrals over a rectangle at the origin of x^2 / R^3, y^2 / R^3 and x y / R^3, seen from (x, y)."""
    a, b = size[0] / 2, size[1] / 2
    corners = [(x + i * a, y + j * b, i * j) for i in (1, -1) for j in (1, -1)]
    along = sum(sign * v * np.arcsinh(u / np.abs(v)) for u, v, sign in corners)
    across = sum(sign * u * np.arcsinh(v / np.abs(u)) for u, v, sign in corners)
    return along, across, -sum(sign * np.hypot(u, v) for u, v, sign in corners)


def tractions(
    places: np.ndarray, size: tuple[float, float], limit: np.ndarray, rigid: np.ndarray, steel: Steel
) -> np.ndarray:
    """Return the stresses on the wheel in steady rolling, ahead and to the side [Pa], shape (2, n).

    places: positions of the rectangles in units of their sizes, limit: friction times pressure [Pa], rigid: velocity of
    the undeformed surface over the speed, (2, n). The surfaces stretch by the difference of their displacements from
    here to one rectangle ahead, Kalker (1990), chapter 4. Newton's method solves p = P(p - r s), where P projects onto
    the friction limit. This equation contains both conditions: adhering points do not slide, and friction opposes
    sliding.
    """
    slopes = _slopes(places, size, steel)
    count, r = limit.size, 1 / slopes[0, 0]
    stress = np.zeros((2, count))

    def left(stress: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        trial = stress - r * (rigid + (slopes @ stress.ravel()).reshape(2, count))
        beyond = np.hypot(*trial)
        return stress - trial * np.minimum(limit / np.maximum(beyond, 1e-300), 1.0), trial, beyond

    for _ in range(NEWTON_ROUNDS):
        wrong, trial, beyond = left(stress)
        if np.max(np.abs(wrong)) < SETTLED * np.max(limit):
            return stress
        step = np.linalg.solve(_newton_matrix(r * slopes, trial, beyond, limit), -wrong.ravel()).reshape(2, count)
        share = 1.0
        while share > 0.01 and np.linalg.norm(left(stress + share * step)[0]) > np.linalg.norm(wrong):
            share /= 2
        stress = stress + share * step
    raise ArithmeticError(f"Newton's method found no stresses in {NEWTON_ROUNDS} rounds; take another grid.")


def _slopes(places: np.ndarray, size: tuple[float, float], steel: Steel) -> np.ndarray:
    """Return minus the derivative of the displacement ahead by the stresses (x of all, then y), shape (2 n, 2 n)."""
    x, y = ((one[:, None] - one) * length for one, length in zip(places, size, strict=True))
    moved = []
    for there in (x, x + size[0]):
        along, across, skew = _integrals(there, y, size)
        nu, rest = steel.poisson_ratio, (1 - steel.poisson_ratio) * (along + across)
        moved.append(np.block([[rest + nu * along, nu * skew], [nu * skew, rest + nu * across]]))
    return (moved[0] - moved[1]) / (np.pi * steel.shear_modulus * size[0])


def _newton_matrix(slopes: np.ndarray, trial: np.ndarray, beyond: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """Return the derivative of `left`: adhering rectangles follow the trial stress, sliding ones turn with it."""
    count, slides = limit.size, beyond > limit
    share, ahead = np.where(slides, limit / np.maximum(beyond, 1e-300), 1.0), trial / np.maximum(beyond, 1e-300)
    matrix, rows = np.empty((2 * count, 2 * count)), np.arange(count)
    for i in range(2):
        turned = [share * ((i == j) - slides * ahead[i] * ahead[j]) for j in range(2)]
        block = matrix[i * count : (i + 1) * count]
        block[:] = turned[0][:, None] * slopes[:count] + turned[1][:, None] * slopes[count:]
        for j in range(2):
            block[rows, j * count + rows] += (i == j) - turned[j]
    return matrix


def rolling_forces(
    grid: Grid, pressed: np.ndarray, creepages: Creepages, steel: Steel, friction: float | np.ndarray
) -> np.ndarray:
    """Return the creep forces on the wheel of each column, ahead and to the side [N], shape (2, columns).

    creepages: of the grid's strips; friction: one value, or one for each column.
    """
    rows, columns = np.nonzero(pressed > 0.0)
    limit = np.broadcast_to(friction, grid.count[1])[columns] * pressed[rows, columns]
    turned = creepages.spin[columns] * (grid.along[rows] - grid.ahead[columns])
    rigid = np.array([creepages.ahead[columns], creepages.aside[columns] + turned])
    stress = tractions(np.array([rows, columns]), grid.size, limit, rigid, steel)
    return np.array([np.bincount(columns, one * grid.area, grid.count[1]) for one in stress])
