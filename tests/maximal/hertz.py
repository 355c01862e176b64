"""Hertz's contact by its approach and by its load: K. L. Johnson (1985), Contact Mechanics, section 4.2."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipkm1

#: Steel, as Kalker's tabulated column has it.
POISSON = 0.25
#: Range of ln(minor / major axis) in which the ellipse is looked for.
SLENDER = math.log(1e-3), math.log(1 - 1e-9)


def integrals(g: float) -> tuple[float, float]:
    """Complete elliptic integrals K and E of an ellipse whose minor axis is g times the major one."""
    return float(ellipkm1(g**2)), float(ellipe(1 - g**2))


@lru_cache(maxsize=4096)
def minor_over_major(ratio: float) -> float:
    """Axis ratio g <= 1 from the larger curvature over the smaller one: (E / g^2 - K) / (K - E)."""

    def missing(logarithm: float) -> float:
        g = math.exp(logarithm)
        k, e = integrals(g)
        return math.log((e / g**2 - k) / (k - e)) - math.log(ratio)

    return 1.0 if missing(SLENDER[1]) > 0.0 else math.exp(brentq(missing, *SLENDER, xtol=1e-14, rtol=1e-14))


@dataclass(frozen=True)
class Hertz:
    """Load of an approach [m] and semi-axes along and across [m] of a load [N].

    Both from curvatures A along and B across [1/m], halves of those of the gap, and the shear modulus [Pa].
    """

    load: Callable[[float, float, float, float], float]
    semi_axes: Callable[[float, float, float, float], tuple[float, float]]


def load_of(approach: float, along: float, across: float, shear_modulus: float) -> float:
    """approach = 3 N K / (2 pi a E*) and a b^2 = 3 N E / (2 pi E* (A + B)), solved for N [N]."""
    if approach <= 0.0:
        return 0.0
    g = minor_over_major(max(along, across) / min(along, across))
    k, e = integrals(g)
    modulus = shear_modulus / (1 - POISSON)
    return 2 * math.pi / 3 * modulus * (approach / k) ** 1.5 * math.sqrt(e / (g**2 * (along + across)))


def semi_axes_of(load: float, along: float, across: float, shear_modulus: float) -> tuple[float, float]:
    """Of the same ellipse by its load [m]."""
    g = minor_over_major(max(along, across) / min(along, across))
    _, e = integrals(g)
    major = (3 * load * e * (1 - POISSON) / (2 * math.pi * shear_modulus * (along + across) * g**2)) ** (1 / 3)
    return (major, g * major) if along <= across else (g * major, major)


EXACT = Hertz(load_of, semi_axes_of)
#: What the fast model says of its polynomials: range of ln(a/b), points and terms of the stiffness, of the ratio and of
#: the size of the ellipse.
OF_LOAD, OF_RATIO, OF_SIZE, FITTED_POINTS = (4.0, 7), (2.35, 4), (2.35, 5), 400


def drawn(law: Callable[[float, float, float], float], reach: float, terms: int, odd: bool) -> tuple[float, np.ndarray]:
    """Largest q = ln(B/A) and the polynomial of q^2, by least squares, for a law of g, K and E; odd: times q."""
    g = np.exp(-np.linspace(0.0, reach, FITTED_POINTS))
    both = [integrals(one) for one in g.tolist()]
    q = [
        math.log((e / one**2 - k) / (k - e)) if one < 1.0 else 0.0 for one, (k, e) in zip(g.tolist(), both, strict=True)
    ]
    powers = np.column_stack([np.array(q) ** (2 * i + odd) for i in range(terms)])
    values = [law(one, *pair) for one, pair in zip(g.tolist(), both, strict=True)]
    return q[-1], np.linalg.lstsq(powers, values, rcond=None)[0]


@lru_cache
def by_polynomials() -> Hertz:
    """The same drawn by polynomials of ln(B/A) that are laid through it as the fast model lays its own."""
    far, size = drawn(lambda g, k, e: math.log(2 * math.pi / 3 * math.sqrt(e / k**3) / g), *OF_LOAD, odd=False)
    near, ratio = drawn(lambda g, k, e: -math.log(g), *OF_RATIO, odd=True)
    _, mean = drawn(lambda g, k, e: math.log(e / math.sqrt(g)), *OF_SIZE, odd=False)

    def value(terms: np.ndarray, q: float) -> float:
        return float(np.polyval(terms[::-1], q**2))

    def load(approach: float, along: float, across: float, shear_modulus: float) -> float:
        q = min(math.log(across / along), far)
        return shear_modulus / (1 - POISSON) * math.exp(value(size, q)) / math.sqrt(along + across) * approach**1.5

    def semi_axes(load: float, along: float, across: float, shear_modulus: float) -> tuple[float, float]:
        q = min(math.log(across / along), near)
        cube = 3 * (1 - POISSON) * load / (2 * math.pi * shear_modulus * (along + across))
        middle, stretch = (cube * math.exp(value(mean, q))) ** (1 / 3), math.exp(q * value(ratio, q) / 2)
        return middle * stretch, middle / stretch

    return Hertz(load, semi_axes)
