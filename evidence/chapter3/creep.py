"""Contact area and creep forces, sections 3.3.5 to 3.3.7, for plain numbers."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.hertz import POISSON_RATIO


@dataclass(frozen=True)
class Ellipse:
    """Contact area: semi-axes along and across the track [m], and Kalker's c_11, c_22, c_23."""

    along: float
    across: float
    kalker: tuple[float, float, float]


#: Function of the curvatures A, B (3.83) [1/m], the normal force [N] and the shear modulus [Pa].
EllipseLaw = Callable[[float, float, float, float], Ellipse]


def hertz_ellipse(a: float, b: float, normal_force: float, shear_modulus: float) -> Ellipse:
    """Return the exact ellipse, eqs (3.82)-(3.88), with Kalker's coefficients interpolated in his table.

    a, b: A and B. This differs from the thesis, which refers to de Pater for the ratio of the semi-axes. Here it
    follows from B / A = (E / g^2 - K) / (K - E), Johnson (1985), section 4.2. The angle (3.85) carries the same
    information and is not needed.
    """
    ratio = max(a, b) / min(a, b)

    def error(logarithm: float) -> float:
        g = math.exp(logarithm)
        m = 1.0 - g * g
        return (ellipe(m) / g**2 - ellipk(m)) / (ellipk(m) - ellipe(m)) / ratio - 1.0

    g = 1.0 if ratio < 1.0 + 1e-9 else math.exp(brentq(error, -6.0, -1e-9, xtol=1e-15))  # (3.88)
    rho = 2.0 / (a + b)  # (3.84)
    e = ellipe(1.0 - g * g)
    mean = (3 * normal_force * (1 - POISSON_RATIO) * rho * e / (4 * math.pi * shear_modulus * math.sqrt(g))) ** (1 / 3)
    axis_ratio = g if a >= b else 1.0 / g  # (3.86)
    along, across = mean * math.sqrt(axis_ratio), mean / math.sqrt(axis_ratio)  # (3.82)
    c11, c22, c23 = (float(value) for value in kalker_function()(axis_ratio))
    return Ellipse(along, across, (c11, c22, c23))


@lru_cache
def kalker_function() -> ca.Function:
    """Kalker's (c11, c22, c23) of an axis ratio, Kalker (1990), table E.3, compiled once."""
    ratio = ca.SX.sym("ratio")
    kalker = kalker_coefficients(ratio)
    return ca.Function("kalker", [ratio], [kalker.c11, kalker.c22, kalker.c23])


def polach(
    creepages: tuple[float, float, float], load: float, friction: float, ellipse: Ellipse, shear_modulus: float
) -> tuple[float, float]:
    """Return creep forces (F_x, F_y) [N] of Polach's method, eqs (3.89)-(3.105).

    creepages: along, lateral [1], spin [1/m].

    The stresses (3.89), (3.95), (3.96) and the form (3.90), (3.91) are steps of the derivation of (3.94), (3.97).
    Differences from the thesis: see `spin_force`; the last factor of (3.94) is nu there and should be the creepage; and
    (3.98) divides by the total creepage.
    """
    x, y, spin = creepages
    a, b = ellipse.along, ellipse.across
    c11, c22, _ = ellipse.kalker
    y_corrected = y + spin * a if abs(y + spin * a) > abs(y) else y  # (3.105)
    corrected = math.hypot(x, y_corrected)  # (3.104)
    if corrected == 0.0:
        return 0.0, 0.0
    plain = math.hypot(x, y)  # (3.93)
    stiffness = math.hypot(c11 * x / plain, c22 * y / plain) if plain > 0.0 else c22  # (3.92)
    phi = shear_modulus * math.pi * a * b * stiffness / (4 * load * friction) * corrected  # (3.94)
    force = -2 * load * friction / math.pi * (phi / (1 + phi**2) + math.atan(phi))  # (3.97)
    sideways = spin_force(y_corrected, corrected, spin, load * friction, ellipse, shear_modulus)
    return force * x / corrected, force * y / corrected + sideways  # (3.98), (3.99)


def spin_force(
    y_corrected: float, corrected: float, spin: float, limit: float, ellipse: Ellipse, shear_modulus: float
) -> float:
    """Return the lateral force from spin [N], eqs (3.100)-(3.103); limit: friction times load [N].

    Differences from the thesis: the force has the opposite sign, as required by right-handed axes (in pure spin it must
    be Kalker's -G (ab)^1.5 c_23 spin). The denominator is the creepage with spin (3.104), because pure spin would
    otherwise be singular.
    """
    a, b = ellipse.along, ellipse.across
    shape = 1 + 6.3 * (1 - math.exp(-a / b))
    phi = 8 / 3 * shear_modulus * b * math.sqrt(a * b) / limit * ellipse.kalker[2] * y_corrected / shape  # (3.103)
    delta = (phi**2 - 1) / (phi**2 + 1)  # (3.102)
    factor = abs(phi) * (delta**3 / 3 - delta**2 / 2 + 1 / 6) - math.sqrt((1 - delta**2) ** 3) / 3  # (3.101)
    return 9 / 16 * a * limit * factor * shape * spin / corrected  # (3.100)


def flange_force(shift: float, clearance: float, stiffness: float) -> float:
    """Return the lateral force [N] of the rails on the flanges, eq. (3.106).

    This differs from the thesis, which gives its size: it is directed to the centre.
    """
    if shift > clearance:
        return -(shift - clearance) * stiffness
    if shift < -clearance:
        return -(shift + clearance) * stiffness
    return 0.0
