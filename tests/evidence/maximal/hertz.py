"""Compute Hertz's contact from its approach or its load: K. L. Johnson (1985), Contact Mechanics, section 4.2."""

from __future__ import annotations

import math
from functools import lru_cache

from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1

#: Poisson's ratio of steel in Kalker's table.
POISSON = 0.25
#: Range of ln(minor / major axis) of the search for the ellipse.
SLENDER = math.log(1e-3), math.log(1 - 1e-9)


def integrals(g: float) -> tuple[float, float]:
    """Return the complete elliptic integrals K and E of an ellipse whose minor axis is g times the major one."""
    return float(ellipkm1(g**2)), float(ellipe(1 - g**2))


@lru_cache(maxsize=4096)
def minor_over_major(ratio: float) -> float:
    """Return the axis ratio g <= 1 from the larger curvature over the smaller one: (E / g^2 - K) / (K - E)."""

    def missing(logarithm: float) -> float:
        g = math.exp(logarithm)
        k, e = integrals(g)
        return math.log((e / g**2 - k) / (k - e)) - math.log(ratio)

    return 1.0 if missing(SLENDER[1]) > 0.0 else math.exp(brentq(missing, *SLENDER, xtol=1e-14, rtol=1e-14))


def load_of(approach: float, along: float, across: float, shear_modulus: float) -> float:
    """Return the load [N] of an approach [m] and curvatures A along and B across [1/m], halves of those of the gap.

    approach = 3 N K / (2 pi a E*) and a b^2 = 3 N E / (2 pi E* (A + B)), solved for N. shear_modulus [Pa].
    """
    if approach <= 0.0:
        return 0.0
    g = minor_over_major(max(along, across) / min(along, across))
    k, e = integrals(g)
    modulus = shear_modulus / (1 - POISSON)
    return 2 * math.pi / 3 * modulus * (approach / k) ** 1.5 * math.sqrt(e / (g**2 * (along + across)))


def semi_axes_of(load: float, along: float, across: float, shear_modulus: float) -> tuple[float, float]:
    """Return the semi-axes along and across [m] of the same ellipse from its load [N]."""
    g = minor_over_major(max(along, across) / min(along, across))
    _, e = integrals(g)
    major = (3 * load * e * (1 - POISSON) / (2 * math.pi * shear_modulus * (along + across) * g**2)) ** (1 / 3)
    return (major, g * major) if along <= across else (g * major, major)
