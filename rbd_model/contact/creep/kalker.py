"""Kalker's creepage and spin coefficients of a contact ellipse, the linear limit of every creep law."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from numbers import Real

import numpy as np

from fmu_src.symbols import ca
from rbd_model.contact.hertz import LONGEST, POISSON_RATIO, going_on, polynomial
from readers.text import shown

#: Kalker's coefficients at Poisson's ratios 0, 0.25 and 0.5: Kalker (1990), Three-Dimensional Elastic Bodies in Rolling
#: Contact, table E.3, for a/b = 0.1 ... 1.0 and then b/a = 0.9 ... 0.1.
RATIOS = (0.0, 0.25, 0.5)
TABLE = {
    "c11": (
        (
            *(2.51, 2.59, 2.68, 2.78, 2.88, 2.98, 3.09, 3.19, 3.29, 3.4),
            *(3.51, 3.65, 3.82, 4.06, 4.37, 4.84, 5.57, 6.96, 10.7),
        ),
        (
            *(3.31, 3.37, 3.44, 3.53, 3.62, 3.72, 3.81, 3.91, 4.01, 4.12),
            *(4.22, 4.36, 4.54, 4.78, 5.1, 5.57, 6.34, 7.78, 11.7),
        ),
        (
            *(4.85, 4.81, 4.8, 4.82, 4.83, 4.91, 4.97, 5.05, 5.12, 5.2),
            *(5.3, 5.42, 5.58, 5.8, 6.11, 6.57, 7.34, 8.82, 12.9),
        ),
    ),
    "c22": (
        (
            *(2.51, 2.59, 2.68, 2.78, 2.88, 2.98, 3.09, 3.19, 3.29, 3.4),
            *(3.51, 3.65, 3.82, 4.06, 4.37, 4.84, 5.57, 6.96, 10.7),
        ),
        (
            *(2.52, 2.63, 2.75, 2.88, 3.01, 3.14, 3.28, 3.41, 3.54, 3.67),
            *(3.81, 3.99, 4.21, 4.5, 4.9, 5.48, 6.4, 8.14, 12.8),
        ),
        (
            *(2.53, 2.66, 2.81, 2.98, 3.14, 3.31, 3.48, 3.65, 3.82, 3.98),
            *(4.16, 4.39, 4.67, 5.04, 5.56, 6.31, 7.51, 9.79, 16),
        ),
    ),
    "c23": (
        (
            *(0.334, 0.483, 0.607, 0.72, 0.827, 0.93, 1.03, 1.13, 1.23, 1.33),
            *(1.44, 1.58, 1.76, 2.01, 2.35, 2.88, 3.79, 5.72, 12.2),
        ),
        (
            *(0.473, 0.603, 0.715, 0.823, 0.929, 1.03, 1.14, 1.25, 1.36, 1.47),
            *(1.59, 1.75, 1.95, 2.23, 2.62, 3.24, 4.32, 6.63, 14.6),
        ),
        (
            *(0.731, 0.809, 0.889, 0.977, 1.07, 1.18, 1.29, 1.4, 1.51, 1.63),
            *(1.77, 1.94, 2.18, 2.5, 2.96, 3.7, 5.01, 7.89, 18),
        ),
    ),
}
#: g = min(a/b, b/a) of the table, and 0.
POINTS = [0.1 * i for i in range(11)]


@dataclass(frozen=True)
class Kalker:
    """Kalker's coefficients of a contact ellipse: longitudinal, lateral, lateral from spin."""

    c11: ca.SX
    c22: ca.SX
    c23: ca.SX


def checked_ratio(nu: float) -> float:
    """Return a Poisson's ratio of Kalker (1990), table E.3. Raises ValueError if it is not from 0 to 0.5."""
    if not (isinstance(nu, Real) and 0.0 <= nu <= 0.5):
        raise ValueError(f"poisson_ratio must be 0 to 0.5; got {shown(nu)}. Steel has 0.28.")
    return float(nu)


@lru_cache
def column(name: str, nu: float = POISSON_RATIO) -> tuple[float, ...]:
    """Return a column of Kalker (1990), table E.3, at a Poisson's ratio of 0 to 0.5.

    Between its three ratios 1/c is a parabola in nu, as in CONTACT (v25, m_hertz.f90, linrol): within 1 % of exact
    theory at 0.28, as the table itself is at 0.25.
    """
    if checked_ratio(nu) in RATIOS:
        return TABLE[name][RATIOS.index(nu)]
    terms = np.polyfit(RATIOS, 1 / np.array(TABLE[name]), 2)
    return tuple((1 / (terms[0] * nu**2 + terms[1] * nu + terms[2])).tolist())


def slender_coefficients(g: ca.SX, nu: float = POISSON_RATIO) -> tuple[Kalker, Kalker]:
    """Return the limits for slender ellipses, g = min(a/b, b/a) -> 0: of those with a < b, and of those with a > b.

    Kalker (1990), table E.3, its rows of g -> 0; nu: Poisson's ratio.
    """
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


def kalker_coefficients(axis_ratio: ca.SX, nu: float = POISSON_RATIO) -> Kalker:
    """Return coefficients of an ellipse of any axis ratio a/b > 0, equal to Kalker (1990), table E.3, at its points.

    nu: Poisson's ratio, see `column`.

    They are the limits for slender ellipses, times a factor linear in g = min(a/b, b/a), which is 1 at g = 0. Between
    the table's points they have an error of up to 0.4 %. Linear interpolation of the coefficients themselves would have
    7 % at a/b = 7. Beyond the table they continue into the limits.
    """
    g = ca.fmin(axis_ratio, 1 / axis_ratio)
    limits = slender_coefficients(g, nu)

    def value(name: str) -> ca.SX:
        both = zip(limits, _factors(name, nu), strict=True)
        return ca.if_else(axis_ratio <= 1, *(getattr(one, name) * ca.pw_lin(g, POINTS, by) for one, by in both))

    return Kalker(value("c11"), value("c22"), value("c23"))


@lru_cache
def _factors(name: str, nu: float) -> tuple[list[float], list[float]]:
    """Return the table over the limits for slender ellipses at POINTS: of those with a < b, and of those with a > b."""
    at_points = [slender_coefficients(ca.SX(point), nu) for point in POINTS[1:]]
    values, sides = column(name, nu), []
    for side, part in enumerate((values[:10], values[:8:-1])):
        at_point = [float(getattr(limit[side], name)) for limit in at_points]
        sides.append([1.0, *(c / limit for c, limit in zip(part, at_point, strict=True))])
    return sides[0], sides[1]


#: Degree of the polynomials below; within 0.5 % of the table, which has three digits, and between its points.
FIT_DEGREE = 5
#: ln(a/b) at the end of the table, and of ellipses beyond it, up to `LONGEST`, through which the cubics below are
#: fitted.
TABLE_END = math.log(10.0)
_LONGER = np.linspace(TABLE_END, LONGEST, 100)


@lru_cache
def _beyond_the_table(nu: float) -> list[Kalker]:
    """Return the coefficients of ellipses that are longer than the table's, as numbers."""
    return [kalker_coefficients(ca.SX(ratio), nu) for ratio in np.exp(_LONGER)]


@lru_cache
def _fit(name: str, nu: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return fits of a coefficient's logarithm: a polynomial of ln(a/b), and its continuation beyond the table's
    end.
    """
    ratios = np.array([*range(1, 11), *(100 / i for i in range(9, 0, -1))]) / 10
    terms = np.polynomial.polynomial.polyfit(np.log(ratios), np.log(column(name, nu)), FIT_DEGREE)
    values = [float(getattr(one, name)) for one in _beyond_the_table(nu)]
    return tuple(terms.tolist()), going_on(terms, TABLE_END, _LONGER, np.log(values))


def smooth_kalker_coefficients(logarithm: ca.SX, nu: float = POISSON_RATIO) -> Kalker:
    """Return coefficients as `kalker_coefficients`, by ln(a/b) from 1/10 to 30, without corners, for a moving contact.

    Up to 10 they are those of Kalker (1990), table E.3. Beyond it they are cubics, within 0.1 % of the transition from
    the table to his limits for slender ellipses. They are within 1.6 % of his exact theory (`exact`), from which the
    table itself differs by 1.1 % at its end.
    """
    inside = ca.fmin(logarithm, TABLE_END)
    fits = [_fit(name, nu) for name in ("c11", "c22", "c23")]
    return Kalker(*(ca.exp(polynomial(fit, inside) + polynomial(on, logarithm - inside)) for fit, on in fits))
