"""Kalker's exact theory of one Hertzian patch in steady rolling: slow; the reference for the fast creep laws.

J. J. Kalker (1990), Three-Dimensional Elastic Bodies in Rolling Contact, chapters 3 and 4. Both bodies are half spaces
of one material, so that pressure and tangential stress do not act on each other. In units of the patch: a b = 1, G = 1,
friction times load = 1.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rbd_model.contact.hertz import POISSON_RATIO

#: Place at which slip is evaluated, ahead of a cell's middle, in lengths of the cell. In sticking cells it lies ahead,
#: so that stress grows from 0 at the leading edge and does not alternate between cells. In slipping cells it is in the
#: middle of the stress.
AHEAD_STICKING, AHEAD_SLIPPING = 0.25, 0.0
#: Newton's steps in all; number of these in which slipping cells may stick again; largest turn of a stress per step
#: [rad].
STEPS, STEPS_TO_STICK, LARGEST_TURN = 60, 12, 1.0
#: Change of the forces that ends Newton's iteration; largest excess of a stress over its bound, as a share of it. The
#: change of stresses is not a criterion: that of a cell next to a place without slip may turn for many steps.
STILL, ABOVE = 1e-5, 1e-9


@dataclass(frozen=True)
class Rectangles:
    """Rectangles of constant stress: ends ahead and behind, to both sides; bound: mean friction over each."""

    behind: np.ndarray
    ahead: np.ndarray
    right: np.ndarray
    left: np.ndarray
    bound: np.ndarray

    @property
    def area(self) -> np.ndarray:
        """Area of each cell."""
        return (self.ahead - self.behind) * (self.left - self.right)


@dataclass(frozen=True)
class HalfSpace:
    """Data of a grid of n cells that do not depend on creepages; see `half_space`.

    `sticking` and `sliding` are slopes of the displacement against the rolling, by the stresses (x of all cells, then
    y), shape (2 n, 2 n). They are at the places of AHEAD_STICKING and AHEAD_SLIPPING. `x` holds these places, `y` those
    of the cells.
    """

    cells: Rectangles
    sticking: np.ndarray
    sliding: np.ndarray
    x: tuple[np.ndarray, np.ndarray]
    y: np.ndarray


@dataclass(frozen=True)
class StickAndSlip:
    """A solution: the sticking cells, and the stresses (x of all cells, then y) on the wheel."""

    sticks: np.ndarray
    stress: np.ndarray
    forces: np.ndarray


def cells(axis_ratio: float, counts: tuple[int, int]) -> Rectangles:
    """Return strips between equal angles across the patch, each cut at equal angles along it; counts: along, across.

    This follows Kalker (1990), section 4.1, whose cells are equal. A strip is as long as its mean length. The friction
    of each cell is the integral of Hertz's ellipsoid.
    """
    a, b = math.sqrt(axis_ratio), 1 / math.sqrt(axis_ratio)
    along, across = (-np.cos(np.pi * np.arange(count + 1) / count) for count in counts)
    half_length = np.diff(half_circle(across)) / np.diff(across)
    behind, ahead = (a * np.outer(half_length, side).ravel() for side in (along[:-1], along[1:]))
    right, left = (np.repeat(b * side, counts[0]) for side in (across[:-1], across[1:]))
    friction = np.outer(np.diff(across - across**3 / 3), np.diff(half_circle(along))).ravel()
    area = (ahead - behind) * (left - right)
    return Rectangles(behind, ahead, right, left, friction / friction.sum() / area)


def half_circle(place: np.ndarray) -> np.ndarray:
    """Return the area of half a unit disk from its middle to a place."""
    return np.asarray((place * np.sqrt(np.maximum(1 - place**2, 0)) + np.arcsin(place)) / 2)


def displacement(x: np.ndarray, y: np.ndarray, grid: Rectangles, nu: float = POISSON_RATIO) -> np.ndarray:
    """Return the displacement of wheel against rail at places (x, y), by the stresses, shape (2 places, 2 cells).

    Boussinesq's and Cerruti's solution summed over each rectangle, Kalker (1990), section 3.1.1:
    u_x = 1/(pi G) int ((1 - nu)/R + nu x^2/R^3) p_x + nu x y/R^3 p_y.
    """
    xx, yy, xy = (np.zeros((x.size, grid.bound.size)) for _ in range(3))
    for sign_x, end_x in ((1, grid.ahead), (-1, grid.behind)):
        for sign_y, end_y in ((1, grid.left), (-1, grid.right)):
            to_x, to_y = end_x - x[:, None], end_y - y[:, None]
            along, across = log_term(to_x, to_y), log_term(to_y, to_x)
            xx += sign_x * sign_y * (across + (1 - nu) * along)
            yy += sign_x * sign_y * ((1 - nu) * across + along)
            xy -= sign_x * sign_y * nu * np.hypot(to_x, to_y)
    return np.block([[xx, xy], [xy, yy]]) / math.pi


def log_term(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return x arsinh(y/|x|), the antiderivative of 1/R that Kalker (1990) writes as x ln(y + R); 0 at x = 0."""
    size = np.abs(x)
    return np.where(size > 0, x * np.arcsinh(y / np.where(size > 0, size, 1.0)), 0.0)


@lru_cache(maxsize=4)
def half_space(axis_ratio: float, counts: tuple[int, int], nu: float = POISSON_RATIO) -> HalfSpace:
    """Return the half space of an ellipse a/b = axis_ratio with `counts` cells along and across.

    Kalker (1990), section 4.1.

    nu: Poisson's ratio.

    The slope at a place is the difference of the displacements half a cell behind it and half a cell ahead.
    """
    grid = cells(axis_ratio, counts)
    y, length = (grid.right + grid.left) / 2, grid.ahead - grid.behind
    places, slopes = [], []
    for share in (AHEAD_STICKING, AHEAD_SLIPPING):
        x = (grid.behind + grid.ahead) / 2 + share * length
        both = displacement(x - length / 2, y, grid, nu) - displacement(x + length / 2, y, grid, nu)
        places.append(x)
        slopes.append(both / np.tile(length, 2)[:, None])
    return HalfSpace(grid, slopes[0], slopes[1], (places[0], places[1]), y)


def exact(space: HalfSpace, creepages: np.ndarray, start: StickAndSlip | None = None) -> StickAndSlip:
    """Return steady rolling with creepages (xi_x, xi_y, spin) over mu N/(G a b), the spin also times (a b)^(1/2).

    forces: (F_x, F_y) on the wheel over mu N. Kalker's algorithm TANG: cells stick until the stress would exceed the
    bound. They stick again if they would slip along their stress. Each change includes one step of Newton's method.
    start: a solution nearby.
    """
    count = space.y.size
    sticks, stress = np.ones(count, bool), np.zeros(2 * count)
    if start is not None:
        sticks, stress = start.sticks, start.stress
    last = np.full(2, np.inf)
    for number in range(STEPS):
        stress, slips_along = newton_step(space, creepages, sticks, stress)
        size = np.hypot(stress[:count], stress[count:])
        now = sticks & (size <= space.cells.bound * (1 + ABOVE))
        if number < STEPS_TO_STICK:
            now |= slips_along
        forces = stress.reshape(2, count) @ space.cells.area
        settled = np.array_equal(now, sticks) and np.max(np.abs(forces - last)) < STILL
        sticks, last = now, forces
        if settled:
            return StickAndSlip(sticks, stress, forces)
    raise ArithmeticError(f"The exact theory found no end in {STEPS} steps at creepages {creepages}; use other cells.")


def newton_step(
    space: HalfSpace, creepages: np.ndarray, sticks: np.ndarray, stress: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return new stresses, and the cells that slip along their stress instead of against it.

    Unknowns of a sticking cell are both stresses; its slip is 0. The unknown of a slipping cell is the angle of its
    stress. The stress equals the bound, and the slip has no component across it; Kalker (1990), section 4.3.
    """
    count, (x, y, spin) = sticks.size, creepages
    stuck, loose = np.flatnonzero(sticks), np.flatnonzero(~sticks)
    both_stuck, both_loose = np.concatenate([stuck, stuck + count]), np.concatenate([loose, loose + count])
    angle, bound = np.arctan2(stress[loose + count], stress[loose]), space.cells.bound[loose]
    cosine, sine = np.cos(angle), np.sin(angle)
    at = stress.copy()
    at[both_loose] = np.concatenate([bound * cosine, bound * sine])
    rigid = [np.concatenate([x - spin * space.y, y + spin * place]) for place in space.x]
    sticking, sliding = space.sticking[both_stuck], space.sliding[both_loose]
    slip = rigid[1][both_loose] + sliding @ at
    slip_x, slip_y = np.split(slip, 2)

    def turning(slopes: np.ndarray) -> np.ndarray:
        """Return derivatives by the stresses of sticking cells and the angles of slipping ones."""
        by_angle = slopes[:, loose + count] * (bound * cosine) - slopes[:, loose] * (bound * sine)
        return np.hstack([slopes[:, both_stuck], by_angle])

    of_sliding = turning(sliding)
    across = cosine[:, None] * of_sliding[loose.size :] - sine[:, None] * of_sliding[: loose.size]
    matrix = np.vstack([turning(sticking), across])
    diagonal = both_stuck.size + np.arange(loose.size)
    matrix[diagonal, diagonal] -= np.minimum(cosine * slip_x + sine * slip_y, 0.0)
    wrong = np.concatenate([rigid[0][both_stuck] + sticking @ at, cosine * slip_y - sine * slip_x])
    change = np.linalg.solve(matrix, -wrong)
    turn = np.clip(change[both_stuck.size :], -LARGEST_TURN, LARGEST_TURN)
    at[both_stuck] += change[: both_stuck.size]
    cosine, sine = np.cos(angle + turn), np.sin(angle + turn)
    at[both_loose] = np.concatenate([bound * cosine, bound * sine])
    slip_x, slip_y = np.split(rigid[1][both_loose] + sliding @ at, 2)
    along = np.zeros(count, bool)
    along[loose] = cosine * slip_x + sine * slip_y > 0
    return at, along
