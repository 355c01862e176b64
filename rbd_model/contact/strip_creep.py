"""Creep forces strip by strip: Kalker's simplified theory (FASTSIM) on a patch of any shape.

Kalker (1982), A fast algorithm for the simplified theory of rolling contact. Each strip is followed from its leading to
its trailing edge. The stress grows with the sliding of the rigid surfaces over the flexibility and is limited to
friction times pressure.

The flexibility of a strip depends on its length and on the stress beside it, not on the patch as a whole. If a patch
has a long shoulder, one ellipse for all of it has errors of up to 21 % of mu N, with any number of strips. Therefore
the flexibility follows from the deformation of the surfaces, as the loads do in `normal`. If nothing slides, the stress
on each strip is that of Carter (1926), t G ((a - x) / (a + x))^(1/2). It stretches, by Cerruti, both surfaces in the
middles of all strips. The t are those for which the stretch equals the creepage. They give c = pi^2 / 2 t. In an
ellipse this is everywhere Kalker's coefficient of bodies with Poisson's ratio 0. The effect of Poisson's ratio, for
creepage ahead, to the side and from spin, is that of the ellipse with the same c.

Such linear forces vary with a strip's length a, FASTSIM's with its square, by which the right places slide. The
flexibilities are therefore those with which the surrounding strips carry each strip's linear force in proportion to
a^2, and that of spin in proportion to a^3. Surrounding strips are weighted by the inverse cube of the distance, as
everywhere in elasticity. On an ellipse the sums are exactly those of Kalker's linear theory.

The stress is limited by a parabola along the strip with the strip's true load. Kalker chose the parabola so that the
right places slide. Half an ellipse instead would be nearer to exact theory if spin is strong and opposed to creepage,
and less exact elsewhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rbd_model.contact.creep.kalker import column
from rbd_model.contact.hertz import POISSON_RATIO
from rbd_model.contact.normal import TINY, ContactArea, Steel, lowering_of

#: Cells along each strip; with 128 no creep force changes by more than 1 % of mu N.
CELLS = 16
#: a/b of the columns of Kalker's table, and strips of the ellipses for which they are read.
AXIS_RATIOS, ELLIPSE_STRIPS = np.array([*(i / 10 for i in range(1, 11)), *(10 / i for i in range(9, 0, -1))]), 120
#: `c_of_ellipse` of these ratios, which takes two seconds to compute. Stored numbers give bit-identical C code on all
#: machines.
C_OF_ELLIPSES = (
    *(2.52117499757, 2.56071976555, 2.62015980047, 2.68788325752, 2.7601100601, 2.83499761401, 2.91149582654),
    *(2.98895528647, 3.0669538226, 3.14520786226, 3.23222185247, 3.34082444236, 3.47985672326, 3.66375931593),
    *(3.91788160707, 4.2912654156, 4.89304225855, 6.02829002192, 9.06766963066),
)


@dataclass(frozen=True)
class Creepages:
    """Creepages of the wheel against the rail at the middle of each strip: ahead, sideways [1], spin [1/m].

    Compare eq. (2.3).
    """

    ahead: np.ndarray
    aside: np.ndarray
    spin: np.ndarray

    def of(self, which: np.ndarray) -> Creepages:
        """Return those of some strips."""
        return Creepages(self.ahead[which], self.aside[which], self.spin[which])


def stretches(away: np.ndarray, breadth: np.ndarray, half_length: np.ndarray) -> np.ndarray:
    """Return the stretch of both surfaces in the middles of strips (rows) by t = 1 on each (columns) [1].

    Poisson's ratio is 0. In Johnson (1985), section 3.6, a tangential force moves the surface there as a normal one
    does. Carter's stress therefore stretches it by the second derivative of the displacement below half an ellipse.
    away: distances between middles [m], 0 on the diagonal.
    """
    ratio = (away / half_length) ** 2
    matrix = np.pi / 2 * breadth * lowering_of(away, half_length) / (1 + ratio)
    # On the strip itself: the mean over its breadth, K(m) by the arithmetic-geometric mean.
    np.fill_diagonal(matrix, breadth / _arithmetic_geometric_mean(np.hypot(half_length, breadth / 2), breadth / 2))
    return np.asarray(matrix)


def _arithmetic_geometric_mean(large: np.ndarray, small: np.ndarray) -> np.ndarray:
    for _ in range(6):
        large, small = (large + small) / 2, np.sqrt(large * small)
    return large


@dataclass(frozen=True)
class Coefficients:
    """c11 / c, c22 / c and c23 / (c (a/b)^(1/2)) by the logarithm of an ellipse's c: Kalker (1990), table E.3.

    They are constant beyond axis ratios of 10 and 1/10, the ends of his table.
    """

    logarithm: np.ndarray
    ratios: np.ndarray

    def of(self, c: np.ndarray) -> np.ndarray:
        """Return the three ratios of strips, shape (3, n)."""
        known = np.log(np.maximum(c, TINY))
        return np.array([np.interp(known, self.logarithm, ratio) for ratio in self.ratios])


@lru_cache
def coefficients(poisson_ratio: float = POISSON_RATIO) -> Coefficients:
    """Return the coefficients of the ellipses of Kalker (1990), table E.3, at a Poisson's ratio."""
    c = np.array(C_OF_ELLIPSES)
    c11, c22, c23 = (np.array(column(name, poisson_ratio)) for name in ("c11", "c22", "c23"))
    return Coefficients(np.log(c), np.array([c11, c22, c23 / np.sqrt(AXIS_RATIOS)]) / c)


def c_of_ellipse(axis_ratio: float) -> float:
    """Return the force over G a b and the creepage, with b = 1, of an ellipse of Kalker (1990), table E.3.

    It is rounded, because the last digits depend on the threads of BLAS.
    """
    y = (2 * np.arange(ELLIPSE_STRIPS) + 1) / ELLIPSE_STRIPS - 1
    breadth, half_length = np.full_like(y, 2 / ELLIPSE_STRIPS), axis_ratio * np.sqrt(1 - y**2)
    pull = np.linalg.solve(stretches(np.abs(y[:, None] - y), breadth, half_length), np.ones_like(y))
    return float(f"{np.pi * np.sum(pull * half_length * breadth) / axis_ratio:.{DIGITS}g}")


#: Digits of constants that are written into C code, so that the code is bit-identical on all machines.
DIGITS = 12
#: Least t of a strip for a creepage of 1; an ellipse has 0.5 and more. It limits a quotient if other strips carry all.
LEAST_PULL = 0.05


@dataclass(frozen=True)
class Growth:
    """Growth of the stress along each strip while nothing slides.

    `steady` is the growth ahead and to the side [Pa/m], shape (2, n), `turning` that by spin [Pa/m2]. `flexible` is the
    flexibility ahead and to the side over the mean of both [1], shape (2, n).
    """

    steady: np.ndarray
    turning: np.ndarray
    flexible: np.ndarray


def growth_of(patch: ContactArea, creepages: Creepages, steel: Steel) -> Growth:
    """Return the growth for a patch whose strips all touch: Carter (1926) and Kalker (1982), see the module."""
    a, breadth = patch.half_length, patch.breadth
    away = np.hypot(*(patch.strips.arm[i][:, None] - patch.strips.arm[i] for i in (1, 2)))
    asked = np.array([np.ones_like(a), creepages.ahead, creepages.aside])
    pull, *pulls = np.linalg.solve(stretches(away, breadth, a), asked.T).T
    pull = np.maximum(pull, LEAST_PULL)
    c = np.pi**2 / 2 * pull
    *along, spin = coefficients(steel.poisson_ratio).of(c)
    near = (a**2 + away**2) ** -1.5
    carried, turned = (near.T @ (breadth * a**power) for power in (2, 3))
    stiff = np.array([near @ (breadth * a * c * ratio / carried) for ratio in along]) / np.pi
    turning = 9 / 8 * near @ (breadth * a**2 * c * spin / turned)
    flexible = 2 * np.array(along[::-1]) / (along[0] + along[1])
    return Growth(steel.shear_modulus * stiff * pulls / pull, steel.shear_modulus * turning * creepages.spin, flexible)


def creep_forces(patch: ContactArea, creepages: Creepages, steel: Steel, friction: float | np.ndarray) -> np.ndarray:
    """Return the forces on the wheel, ahead and to the side, of each strip [N], shape (2, n); Kalker (1982).

    friction [1]: of all strips or of each.
    """
    touching = patch.half_length > 0.0
    inside = patch.of(touching)
    grown = growth_of(inside, creepages.of(touching), steel)
    limit = (friction * patch.pressure)[touching]
    places = 1 - (2 * np.arange(CELLS) + 1) / CELLS
    # The parabola has the load of half an ellipse, whose mean is pi / 4.
    shape = 1 - places**2
    shape *= math.pi / 4 / np.mean(shape)
    stress, total, moved = (np.zeros_like(grown.steady) for _ in range(3))
    for place, height in zip(places, shape, strict=True):
        # The displacement of the rigid surfaces over each other since the leading edge.
        before, moved = moved, grown.steady * (1 - place)
        moved[1] += grown.turning * inside.half_length * (1 - place**2) / 2
        stress = _cut(stress - (moved - before) * inside.half_length, limit * height, grown.flexible)
        total += stress
    forces = np.zeros((2, touching.size))
    forces[:, touching] = total * 2 * inside.half_length / CELLS * inside.breadth
    return forces


def _cut(stress: np.ndarray, limit: np.ndarray, flexible: np.ndarray) -> np.ndarray:
    """Return the stress limited by friction. If it reaches the limit, the sliding has the stress's direction.

    Sliding reduces each component in inverse proportion to its flexibility. Far beyond the limit the stress is thus
    directed along the sliding, and not along the stress before it.
    """
    beyond = np.maximum(np.hypot(*stress) / np.maximum(limit, TINY), 1.0) - 1
    turned = stress / (1 + beyond / flexible)
    return np.asarray(turned * np.where(beyond > 0.0, limit / np.maximum(np.hypot(*turned), TINY), 1.0))
