"""Normal contact: the Hertz ellipse between wheel and rail, eqs (3.82)-(3.88)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fmu_src.symbols import ca

#: Default Poisson's ratio: a column of Kalker's table (`kalker.py`), assumed, because the thesis gives none. Steel has
#: 0.28, see `Vehicle.poisson_ratio`. For the effect see docs/limits.md, Creep laws.
POISSON_RATIO = 0.25
#: The arithmetic-geometric mean converges quadratically; 6 rounds reach round-off for axis ratios above 1e-3.
MEAN_ROUNDS = 6
NEWTON_ROUNDS = 8


@dataclass(frozen=True)
class EllipseShape:
    """Ellipse by the curvatures: `axis_ratio` = a/b; `longitudinal`, `lateral` = a, b over N^(1/3) [m/N^(1/3)]."""

    axis_ratio: ca.SX
    longitudinal: ca.SX
    lateral: ca.SX


def elliptic_integrals(minor_over_major: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the complete elliptic integrals K and D = (K - E)/e^2 of an ellipse, axis ratio g = sqrt(1 - e^2).

    Equation (3.88).

    They are computed by the arithmetic-geometric mean. D is formed without the difference K - E, so that a circle (e =
    0) needs no separate case.
    """
    g = minor_over_major
    mean, geometric, difference = (1 + g) / 2, ca.sqrt(g), (1 - g) / 2
    # sum of 2^(n-1) c_n^2 / e^2 with c_1 = (1 - g)/2 and e^2 = (1 - g)(1 + g): one factor (1 - g) cancels.
    share = difference / (2 * (1 + g))
    total, weight = share, ca.SX(1)
    for _ in range(MEAN_ROUNDS):
        next_mean = (mean + geometric) / 2
        # c_(n+1) = c_n^2 / (4 a_(n+1)), written as a factor on the previous term.
        weight = 2 * weight
        factor = difference / (4 * next_mean)
        share = share * factor**2
        total = total + weight * share
        difference = difference * factor
        geometric = ca.sqrt(mean * geometric)
        mean = next_mean
    k = ca.pi / (2 * mean)
    return k, k * (0.5 + total)


def curvature_ratio(minor_over_major: ca.SX) -> ca.SX:
    """Return the ratio of the relative curvatures, larger to smaller, of this ellipse: (K - D) / (g^2 D).

    Johnson (1985), Contact Mechanics, section 4.2, general profiles; 1 for a circle.
    """
    k, d = elliptic_integrals(minor_over_major)
    return (k - d) / (minor_over_major**2 * d)


def minor_over_major_axis(smaller: ca.SX, larger: ca.SX) -> ca.SX:
    """Return the axis ratio g of the ellipse from the relative curvatures, eqs (3.85)-(3.86), by Newton in ln g."""
    unknown = ca.SX.sym("log_axis_ratio")
    residual = ca.log(curvature_ratio(ca.exp(unknown)))
    function = ca.Function("residual", [unknown], [residual, ca.jacobian(residual, unknown)])
    target = ca.log(larger / smaller)
    logarithm = -target * 2 / 3  # near a circle, B/A = (a/b)^1.5
    for _ in range(NEWTON_ROUNDS):
        value, slope = function(logarithm)
        logarithm = logarithm - (value - target) / slope
    return ca.exp(logarithm)


def ellipse_shape(
    wheel_radius: ca.SX,
    wheel_curvature: ca.SX,
    rail_radius: ca.SX,
    shear_modulus: ca.SX,
    poisson_ratio: float = POISSON_RATIO,
) -> EllipseShape:
    """Return the contact ellipse of a wheel on a straight rail, eqs (3.82)-(3.88).

    wheel_radius [m] along the track, wheel_curvature [1/m] and rail_radius [m] across it; the rail is straight along
    the track. In (3.87), E is the complete elliptic integral, not Young's modulus.
    """
    along = 0.5 / wheel_radius  # A, eq. (3.83)
    across = 0.5 * (1 / rail_radius + wheel_curvature)  # B
    g = minor_over_major_axis(ca.fmin(along, across), ca.fmax(along, across))
    k, d = elliptic_integrals(g)
    e = k - (1 - g**2) * d
    # c^3 = a b sqrt(a b) for N = 1, with rho = 2/(A + B), eqs (3.84), (3.87)
    cube = 3 * (1 - poisson_ratio) * (2 / (along + across)) * e / (4 * ca.pi * shear_modulus * ca.sqrt(g))
    mean = cube ** (1 / 3)
    # The longer axis lies where the curvature is smaller, eq. (3.86).
    axis_ratio = ca.if_else(along <= across, 1 / g, g)
    return EllipseShape(axis_ratio, mean * ca.sqrt(axis_ratio), mean / ca.sqrt(axis_ratio))


#: Range of ln(a/b) of the fit: Kalker's table ends at 10 and 1/10.
FIT_RANGE, FIT_POINTS = 2.35, 400
#: Terms of the polynomials; they are within 1e-4 of the axis ratio and 2e-4 of the mean semi-axis.
RATIO_TERMS, SIZE_TERMS = 4, 5
#: Largest ln(a/b) of ellipses that are long along the rail; those of a flange have a/b of 17 to 18. Beyond the
#: polynomials, cubics continue with their value and slope. They are within 3e-4 of the axis ratio and 5e-4 of the mean
#: semi-axis.
LONGEST = math.log(30.0)


@dataclass(frozen=True)
class EllipseFit:
    """Polynomials in q = ln(B/A), |q| <= limit: ln(a/b) = q sum r_i q^2i, and ln(E / sqrt(g)) = sum s_i q^2i.

    Beyond the limit, up to q = end, the cubics `ratio_on` and `size_on` of q - limit are added to the values at the
    limit.
    """

    limit: float
    ratio: tuple[float, ...]
    size: tuple[float, ...]
    end: float
    ratio_on: tuple[float, ...]
    size_on: tuple[float, ...]


@lru_cache
def ellipse_fit() -> EllipseFit:
    """Return least-squares fits of the exact a/b of (3.86) and E of (3.87), so that moving contacts need no
    iteration.
    """
    g = ca.SX.sym("g")
    k, d = elliptic_integrals(g)
    exact = ca.Function("exact", [g], [ca.log(curvature_ratio(g)), ca.log((k - (1 - g**2) * d) / ca.sqrt(g))])
    logarithm = np.linspace(0.0, FIT_RANGE, FIT_POINTS)
    q, size = (np.array(column).ravel() for column in exact(np.exp(-logarithm)[None, :]))
    odd = np.column_stack([q ** (2 * i + 1) for i in range(RATIO_TERMS)])
    even = np.column_stack([q ** (2 * i) for i in range(SIZE_TERMS)])
    ratio, sizes = (np.linalg.lstsq(matrix, y, rcond=None)[0] for matrix, y in ((odd, logarithm), (even, size)))
    limit = float(q[-1])
    longer = np.linspace(FIT_RANGE, LONGEST, FIT_POINTS)
    q, size = (np.array(column).ravel() for column in exact(np.exp(-longer)[None, :]))
    # The same polynomials in powers of q itself.
    own = np.kron(ratio, [0.0, 1.0]), np.kron(sizes, [1.0, 0.0])
    on = [going_on(one, limit, q, y) for one, y in zip(own, (longer, size), strict=True)]
    return EllipseFit(limit, tuple(ratio.tolist()), tuple(sizes.tolist()), float(q[-1]), *on)


def going_on(terms: np.ndarray, limit: float, x: np.ndarray, y: np.ndarray) -> tuple[float, ...]:
    """Return coefficients of a cubic of x - limit that continues a polynomial, added to its value at the limit.

    It has the polynomial's value and slope there. Its other terms are the least-squares fit of y, such as E of (3.87).
    """
    inside, past = np.polynomial.Polynomial(terms), x - limit
    slope = float(inside.deriv()(limit))
    bends = np.linalg.lstsq(past[:, None] ** [2, 3], y - inside(limit) - slope * past, rcond=None)[0]
    return 0.0, slope, *bends.tolist()


def polynomial(coefficients: tuple[float, ...], x: ca.SX) -> ca.SX:
    """Return the sum of coefficients[i] x^i by Horner's rule."""
    value = ca.SX(coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient
    return value


def moving_ellipse(
    along: ca.SX, across: ca.SX, load: ca.SX, shear_modulus: ca.SX, poisson_ratio: float = POISSON_RATIO
) -> tuple[ca.SX, ca.SX]:
    """Return ln(a/b) and semi-axis (a b)^(1/2) [m] of a contact that moves, eqs (3.82), (3.84), (3.87).

    along, across: the curvatures A and B [1/m], which change; load [N]. The result equals that of `ellipse_shape`
    within the fit. The ratio is limited to ellipses 30 times as long along the rail as across, and 10 times as broad as
    long. Therefore a contact that loses its curvature (`across` near 0, or below in a trial step) remains finite.
    """
    fit = ellipse_fit()
    floor = along * np.exp(-fit.limit)
    whole = ca.log(ca.fmax(across, floor) / along)
    q = ca.fmin(whole, fit.limit)
    past = ca.fmin(whole, fit.end) - q
    logarithm = q * polynomial(fit.ratio, q**2) + polynomial(fit.ratio_on, past)
    scale = 3 * (1 - poisson_ratio) / (2 * ca.pi * shear_modulus)
    cube = scale * load / (along + ca.fmax(across, floor))
    size = polynomial(fit.size, q**2) + polynomial(fit.size_on, past)
    return logarithm, ca.exp((ca.log(cube) + size) / 3)
