"""Elastic contact after Hertz: the normal force of two bodies that approach each other, unilateral, with damping."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fmu_src.symbols import ca
from rbd_model.contact.hertz import POISSON_RATIO, curvature_ratio, elliptic_integrals, polynomial

#: Range of ln(a/b) of the fit and its terms. A wheel's straight flange on a gauge corner of 13 mm reaches 3.
FIT_RANGE, FIT_POINTS, FIT_TERMS = 4.0, 400, 7
#: Approach that is distinguished from 0 [m]. Below it the force is that of 0.1 uN, so that the root has a slope.
SMALLEST_APPROACH = 1e-12


@dataclass(frozen=True)
class StiffnessFit:
    """A polynomial in q = ln(B/A), |q| <= limit: ln of N / (G / (1 - nu)) times ((A + B) / delta^3)^(1/2)."""

    limit: float
    terms: tuple[float, ...]


@lru_cache
def stiffness_fit() -> StiffnessFit:
    """Return the least-squares fit of the exact force of Johnson (1985), section 4.2.

    delta = 3 N K / (2 pi a E*), a b^2 = 3 N E / (2 pi E* (A + B)), with a >= b, g = b/a. They give
    N = (2 pi / 3) E* (delta / K)^1.5 (E / (g^2 (A + B)))^0.5. E* = G / (1 - nu) for two equal bodies.
    """
    g = ca.SX.sym("g")
    k, d = elliptic_integrals(g)
    e = k - (1 - g**2) * d
    size = 2 * ca.pi / 3 * ca.sqrt(e / k**3) / g
    exact = ca.Function("exact", [g], [ca.log(curvature_ratio(g)), ca.log(size)])
    q, logarithm = (np.array(one).ravel() for one in exact(np.exp(-np.linspace(0.0, FIT_RANGE, FIT_POINTS))[None, :]))
    even = np.column_stack([q ** (2 * i) for i in range(FIT_TERMS)])
    terms = np.linalg.lstsq(even, logarithm, rcond=None)[0]
    return StiffnessFit(float(q[-1]), tuple(terms.tolist()))


def stiffness_of(along: np.ndarray, across: np.ndarray) -> np.ndarray:
    """Return N / (E* delta^1.5) [m^0.5] of Hertz' contact from its curvatures A and B (3.83) [1/m]."""
    fit = stiffness_fit()
    across = np.maximum(across, along * np.exp(-fit.limit))
    q = np.minimum(np.log(across / along), fit.limit)
    return np.asarray(np.exp(np.polynomial.polynomial.polyval(q**2, fit.terms)) / np.sqrt(along + across))


def elastic_force(
    approach: ca.SX, along: ca.SX, across: ca.SX, shear_modulus: ca.SX, poisson_ratio: float = POISSON_RATIO
) -> ca.SX:
    """Return the normal force N [N] of Hertz' contact by its approach [m], K delta^1.5; 0 if the bodies are apart.

    along, across: the curvatures A and B of (3.83) [1/m]; Johnson (1985), section 4.2. Beyond the fit's range of B/A
    the ratio is constant, so that a contact without curvature remains finite.
    """
    fit = stiffness_fit()
    floor = along * np.exp(-fit.limit)
    across = ca.if_else(across > floor, across, floor)
    q = ca.fmin(ca.log(across / along), fit.limit)
    pressed = ca.if_else(approach > SMALLEST_APPROACH, approach, SMALLEST_APPROACH)
    stiffness = ca.exp(polynomial(fit.terms, q**2)) / ca.sqrt(along + across)
    return shear_modulus / (1 - poisson_ratio) * stiffness * pressed * ca.sqrt(pressed)


def damped(force: ca.SX, closing: ca.SX, damping: ca.SX) -> ca.SX:
    """Return the force with damping, Hunt and Crossley (1975): N (1 + damping x closing), never a pull.

    closing [m/s]: speed at which the bodies approach; damping [s/m].
    """
    factor = 1 + damping * closing
    return force * ca.if_else(factor > 0, factor, 0)
