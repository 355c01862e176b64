"""Kalker's creepage and spin coefficients of a contact ellipse, the linear limit of every creep law."""

import math
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from rbd_model.contact.hertz import LONGEST, POISSON_RATIO, going_on, polynomial

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
#: The columns by their names.
TABLE = {"c11": C11, "c22": C22, "c23": C23}
#: g = min(a/b, b/a) of the table, and 0.
POINTS = [0.1 * i for i in range(11)]


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
    limits = slender_coefficients(g)

    def value(name: str) -> ca.SX:
        both = zip(limits, _factors(name), strict=True)
        return ca.if_else(axis_ratio <= 1, *(getattr(one, name) * ca.pw_lin(g, POINTS, by) for one, by in both))

    return Kalker(value("c11"), value("c22"), value("c23"))


@lru_cache
def _factors(name: str) -> tuple[list[float], list[float]]:
    """The table over the limits for slender ellipses at POINTS: of ellipses with a < b, and of those with a > b."""
    at_points = [slender_coefficients(ca.SX(point)) for point in POINTS[1:]]
    column, sides = TABLE[name], []
    for side, part in enumerate((column[:10], column[:8:-1])):
        at_point = [float(getattr(limit[side], name)) for limit in at_points]
        sides.append([1.0, *(c / limit for c, limit in zip(part, at_point, strict=True))])
    return sides[0], sides[1]


#: Degree of the polynomials below; within 0.5 % of the table, which has three digits, and between its points.
FIT_DEGREE = 5
#: ln(a/b) where the table ends, and of the ellipses beyond it, up to `LONGEST`, that the cubics below are laid through.
TABLE_END = math.log(10.0)
_LONGER = np.linspace(TABLE_END, LONGEST, 100)


@lru_cache
def _beyond_the_table() -> list[Kalker]:
    """Coefficients of ellipses that are longer than the table's, numbers."""
    return [kalker_coefficients(ca.SX(ratio)) for ratio in np.exp(_LONGER)]


@lru_cache
def _fit(name: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Of the logarithm of a coefficient: polynomial of ln(a/b), and what goes on behind the end of the table."""
    ratios = np.array([*range(1, 11), *(100 / i for i in range(9, 0, -1))]) / 10
    column = TABLE[name]
    terms = np.polynomial.polynomial.polyfit(np.log(ratios), np.log(column), FIT_DEGREE)
    values = [float(getattr(one, name)) for one in _beyond_the_table()]
    return tuple(terms.tolist()), going_on(terms, TABLE_END, _LONGER, np.log(values))


def smooth_kalker_coefficients(logarithm: ca.SX) -> Kalker:
    """As `kalker_coefficients`, by ln(a/b) from 1/10 to 30, without corners, for a contact that moves.

    To 10 Kalker (1990), table E.3; beyond it cubics, within 0.1 % of what goes over from the table into his limits for
    slender ellipses, and 1.6 % of his exact theory (`exact`), which at the table's own end is 1.1 % off.
    """
    inside = ca.fmin(logarithm, TABLE_END)
    fits = [_fit(name) for name in ("c11", "c22", "c23")]
    return Kalker(*(ca.exp(polynomial(fit, inside) + polynomial(on, logarithm - inside)) for fit, on in fits))
