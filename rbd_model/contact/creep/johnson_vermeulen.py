"""Vermeulen and Johnson (1964): creepage without spin, with an ellipse of adhesion within the ellipse of contact."""

from __future__ import annotations

from fmu_src.symbols import ca
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.shen_hedrick_elkins import FORCE_FLOOR, saturated_share
from rbd_model.contact.hertz import POISSON_RATIO, elliptic_integrals

#: Axis ratio used for circles, because the integral C below is 0/0 for them; the error of C is as small.
ROUNDEST = 1 - 1e-6


def slopes(axis_ratio: ca.SX, nu: float = POISSON_RATIO) -> tuple[ca.SX, ca.SX]:
    """Return pi/Phi and pi/Psi, the counterparts of Kalker's c11 and c22, Vermeulen and Johnson (1964).

    They use the elliptic integrals B, C, D of e^2 = 1 - g^2, g = min(a/b, b/a). For a circle pi/Phi = 16/(4 - 3 nu) and
    pi/Psi = 16/(4 - nu): 19 % and 16 % above Kalker's.
    """
    g = ca.fmin(ca.fmin(axis_ratio, 1 / axis_ratio), ROUNDEST)
    k, d = elliptic_integrals(g)
    b, c = k - d, (2 * d - k) / (1 - g**2)
    across = b - nu * (d - c), b - nu * g**2 * c
    along = g * (d - nu * (d - c)), g * (d - nu * c)
    phi, psi = (ca.if_else(axis_ratio <= 1, *pair) for pair in zip(across, along, strict=True))
    return ca.pi / phi, ca.pi / psi


def johnson_vermeulen(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Return the creep forces (F_x, F_y) [N] without spin, Vermeulen and Johnson (1964).

    The law does not include spin. Its ellipse of adhesion touches that of contact in one point, so that there is slip
    at the leading edge, against the sliding. For small creepages it is stiffer than Kalker's theory.
    """
    x, y, _ = patch.creepages
    a, b = patch.semi_axes
    limit = patch.friction * patch.load
    first, second = slopes(a / b, patch.poisson_ratio)
    stiffness = patch.shear_modulus * a * b
    along, sideways = stiffness * first * x, stiffness * second * y
    share = saturated_share(ca.sqrt((along / limit) ** 2 + (sideways / limit) ** 2 + FORCE_FLOOR**2))
    return -share * along, -share * sideways
