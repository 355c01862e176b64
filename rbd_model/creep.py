"""Tangential contact: Polach's creep forces (1999) with Kalker's coefficients, eqs (3.89)-(3.105)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from rbd_model.contact import POISSON_RATIO, polynomial

#: Kalker's coefficients at Poisson's ratio 0.25: Kalker (1990), Three-Dimensional Elastic Bodies in Rolling Contact,
#: table E.3, for a/b = 0.1 ... 1.0 and then b/a = 0.9 ... 0.1.
C11 = (
    *(3.31, 3.37, 3.44, 3.53, 3.62, 3.72, 3.81, 3.91, 4.01, 4.12),
    *(4.22, 4.36, 4.54, 4.78, 5.10, 5.57, 6.34, 7.78, 11.7),
)
C22 = (
    *(2.52, 2.63, 2.75, 2.88, 3.01, 3.14, 3.28, 3.41, 3.54, 3.67),
    *(3.81, 3.99, 4.21, 4.50, 4.90, 5.48, 6.40, 8.14, 12.8),
)
C23 = (
    *(0.473, 0.603, 0.715, 0.823, 0.929, 1.03, 1.14, 1.25, 1.36, 1.47),
    *(1.59, 1.75, 1.95, 2.23, 2.62, 3.24, 4.32, 6.63, 14.6),
)


@dataclass(frozen=True)
class Kalker:
    """Kalker's coefficients of a contact ellipse: longitudinal, lateral, lateral from spin."""

    c11: ca.SX
    c22: ca.SX
    c23: ca.SX


def slender_coefficients(g: ca.SX) -> tuple[Kalker, Kalker]:
    """Limits for slender ellipses, g = min(a/b, b/a) -> 0: of those with a < b, and of those with a > b.

    Kalker (1990), table E.3, its rows of g -> 0.
    """
    nu = POISSON_RATIO
    across = Kalker(
        ca.SX(math.pi**2 / (4 * (1 - nu))),
        ca.SX(math.pi**2 / 4),
        math.pi * ca.sqrt(g) / (3 * (1 - nu)) * (1 + nu * (ca.log(16 / g) - 5)),
    )
    size, rest = ca.log(16 / g**2), 3 - math.log(4)
    first, second = size - 2 * nu, (1 - nu) * size + 2 * nu
    along = Kalker(
        2 * math.pi / (first * g) * (1 + rest / first),
        2 * math.pi / (second * g) * (1 + (1 - nu) * rest / second),
        2 * math.pi / (3 * g**1.5 * ((1 - nu) * size - 2 + 4 * nu)),
    )
    return across, along


def kalker_coefficients(axis_ratio: ca.SX) -> Kalker:
    """Coefficients of an ellipse of any axis ratio a/b > 0, equal to Kalker (1990), table E.3, at its points.

    Times a factor linear in g = min(a/b, b/a), which is 1 at g = 0, the limits for slender ellipses follow the table
    between its points within 0.4 % (the coefficients themselves curve: 7 % at a/b = 7), and beyond it into the limits.
    """
    g = ca.fmin(axis_ratio, 1 / axis_ratio)
    points = [0.1 * i for i in range(11)]
    limits = slender_coefficients(g)
    at_points = [slender_coefficients(ca.SX(point)) for point in points[1:]]

    def value(name: str, column: tuple[float, ...]) -> ca.SX:
        sides = []
        for side, part in enumerate((column[:10], column[:8:-1])):
            at_point = [float(getattr(limit[side], name)) for limit in at_points]
            factors = [1.0, *(c / limit for c, limit in zip(part, at_point, strict=True))]
            sides.append(getattr(limits[side], name) * ca.pw_lin(g, points, factors))
        return ca.if_else(axis_ratio <= 1, *sides)

    return Kalker(value("c11", C11), value("c22", C22), value("c23", C23))


#: Degree of the polynomials below; within 0.5 % of the table, which has three digits, and between its points.
FIT_DEGREE = 5


@lru_cache
def _fit(column: tuple[float, ...]) -> tuple[float, ...]:
    ratios = np.array([*range(1, 11), *(100 / i for i in range(9, 0, -1))]) / 10
    return tuple(np.polynomial.polynomial.polyfit(np.log(ratios), np.log(column), FIT_DEGREE).tolist())


def smooth_kalker_coefficients(logarithm: ca.SX) -> Kalker:
    """Kalker (1990), table E.3, by ln(a/b) from 1/10 to 10, without corners, for a contact that moves."""
    return Kalker(*(ca.exp(polynomial(_fit(column), logarithm)) for column in (C11, C22, C23)))


def creepage(sliding_speed: ca.SX, forward_speed: ca.SX, creepage_speed: ca.SX) -> ca.SX:
    """Longitudinal creepage (xi_x), eq. (2.3): sliding speed over forward speed.

    Differs from the thesis: sqrt(V^2 + v_eps^2) instead of V, which is 0 at rest.
    """
    return sliding_speed / ca.sqrt(forward_speed**2 + creepage_speed**2)


@dataclass(frozen=True)
class Reduction:
    """What a contaminated surface leaves of the gradient, Polach (2005): in the areas of adhesion (k_A), slip (k_S)."""

    adhesion: ca.SX | float = 1.0
    slip: ca.SX | float = 1.0


#: Clean surfaces, the law of 1999.
CLEAN = Reduction()


def polach_force(
    creepage: ca.SX,
    load: ca.SX,
    friction: ca.SX,
    semi_axes: tuple[ca.SX, ca.SX],
    shear_modulus: ca.SX,
    c11: ca.SX,
    reduction: Reduction = CLEAN,
) -> ca.SX:
    """Creep force of one wheel along the track, eqs (3.94) and (3.97); opposes the sliding.

    load [N] (Q), semi_axes [m] (a_e, b_e), shear_modulus [Pa] (G). For small creepage it is -G a b c11 xi (Kalker),
    times the mean of k_A and k_S, for large creepage -mu Q. Odd in the creepage, so that no absolute value is needed.
    Differs from the thesis: the last factor of (3.94) is printed as nu and is the creepage; (3.97) has the reduction
    factors of Polach (2005), 1 on clean surfaces.
    """
    a, b = semi_axes
    limit = friction * load
    gradient = 0.25 * shear_modulus * ca.pi * a * b * c11 / limit * creepage
    return saturated(gradient, limit, reduction)


def saturated(gradient: ca.SX, limit: ca.SX, reduction: Reduction = CLEAN) -> ca.SX:
    """Creep force from the gradient of tangential stress (phi) and mu Q [N], eq. (3.97)."""
    adhesion = reduction.adhesion * gradient
    return -2 / ca.pi * limit * (adhesion / (1 + adhesion**2) + ca.atan(reduction.slip * gradient))


#: Smallest creepage that is told from none; the forces below are smooth through zero on this scale.
CREEPAGE_FLOOR = 1e-12


def polach_forces(
    creepages: tuple[ca.SX, ca.SX, ca.SX],
    load: ca.SX,
    friction: ca.SX,
    semi_axes: tuple[ca.SX, ca.SX],
    shear_modulus: ca.SX,
    kalker: Kalker,
    reduction: Reduction = CLEAN,
) -> tuple[ca.SX, ca.SX]:
    """Creep forces (F_x, F_y) [N] of one wheel for longitudinal, lateral [1] and spin [1/m] creepage, (3.92)-(3.105).

    For small creepages F_x = -G a b c11 xi_x and F_y = -G a b c22 xi_y - G (a b)^1.5 c23 xi_s (Kalker); without spin
    and lateral creepage `polach_force`. Reduction: these limits all times the mean of k_A and k_S. Polach (2005) says
    nothing of spin: the gradient of its force (3.103) is multiplied with that mean.
    Differs from the thesis: the spin force (3.100) has the other sign, as right-handed axes ask for, and is divided by
    the creepage with spin (3.104), without which pure spin would be singular; (3.105) is written as a maximum, and
    sqrt((1 - d^2)^3) in (3.101) as 8 e^3 / (1 + e^2)^3, which have no roots at zero.
    """
    x, y, spin = creepages
    a, b = semi_axes
    limit = friction * load
    # Divisions are written as products with one reciprocal: they are what this costs, with its derivatives.
    per_limit = 1 / limit
    with_spin = y + spin * a
    y_corrected = ca.if_else(ca.fabs(with_spin) > ca.fabs(y), with_spin, y)  # (3.105)
    total = ca.sqrt(x**2 + y_corrected**2 + CREEPAGE_FLOOR**2)  # (3.104)
    # (3.92), a mean of c11 and c22 in the direction of the creepage; of no weight where there is none
    plain = x**2 + y**2 + CREEPAGE_FLOOR**2
    stiffness = ca.sqrt(((kalker.c11 * x) ** 2 + (kalker.c22 * y) ** 2 + (kalker.c22 * CREEPAGE_FLOOR) ** 2) / plain)
    per_total = 1 / total
    force = polach_force(total, load, friction, semi_axes, shear_modulus, stiffness, reduction) * per_total

    shape = 1 + 6.3 * (1 - ca.exp(-a / b))
    gradient = 8 / 3 * shear_modulus * b * ca.sqrt(a * b) * per_limit * kalker.c23 * y_corrected / shape  # (3.103)
    gradient = (reduction.adhesion + reduction.slip) / 2 * gradient
    square = gradient**2
    saturation = 1 / (1 + square)
    delta = (square - 1) * saturation  # (3.102)
    size = ca.sqrt(square + CREEPAGE_FLOOR**2)
    factor = size * (delta**3 / 3 - delta**2 / 2 + 1 / 6) - 8 / 3 * (size * saturation) ** 3  # (3.101)
    from_spin = 9 / 16 * a * limit * factor * shape * spin * per_total  # (3.100)
    return force * x, force * y + from_spin
