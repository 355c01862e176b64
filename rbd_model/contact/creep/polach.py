"""Polach's creep forces (1999), the default: fast, and with spin, eqs (3.92)-(3.105)."""

from __future__ import annotations

from fmu_src.symbols import ca
from rbd_model.contact.creep.law import CLEAN, ContactPatch, Reduction


def polach_force(
    creepage: ca.SX,
    load: ca.SX,
    friction: ca.SX,
    semi_axes: tuple[ca.SX, ca.SX],
    shear_modulus: ca.SX,
    c11: ca.SX,
    reduction: Reduction = CLEAN,
) -> ca.SX:
    """Return the creep force of one wheel along the track, eqs (3.94) and (3.97); it opposes the sliding.

    load [N] (Q), semi_axes [m] (a_e, b_e), shear_modulus [Pa] (G). For small creepage it is -G a b c11 xi (Kalker),
    times the mean of k_A and k_S, for large creepage -mu Q. It is odd in the creepage, so that no absolute value is
    needed. This differs from the thesis: the last factor of (3.94) is nu there and should be the creepage; (3.97) has
    the reduction factors of Polach (2005), 1 on clean surfaces.
    """
    a, b = semi_axes
    limit = friction * load
    gradient = 0.25 * shear_modulus * ca.pi * a * b * c11 / limit * creepage
    return saturated(gradient, limit, reduction)


def saturated(gradient: ca.SX, limit: ca.SX, reduction: Reduction = CLEAN) -> ca.SX:
    """Return the creep force from the gradient of tangential stress (phi) and mu Q [N], eq. (3.97)."""
    adhesion = reduction.adhesion * gradient
    return -2 / ca.pi * limit * (adhesion / (1 + adhesion**2) + ca.atan(reduction.slip * gradient))


#: Smallest creepage that is distinguished from 0. The forces below are smooth through zero on this scale.
CREEPAGE_FLOOR = 1e-12


def polach(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Return the creep forces (F_x, F_y) [N] of one patch, Polach (1999) with spin, (3.92)-(3.105).

    For small creepages F_x = -G a b c11 xi_x and F_y = -G a b c22 xi_y - G (a b)^1.5 c23 xi_s (Kalker). Without spin
    and lateral creepage they equal `polach_force`. With a reduction all these limits are multiplied by the mean of k_A
    and k_S. Polach (2005) does not treat spin: here the gradient of its force (3.103) is multiplied by that mean.
    Differences from the thesis: the spin force (3.100) has the opposite sign, as required by right-handed axes. It is
    divided by the creepage with spin (3.104), because pure spin would otherwise be singular. (3.105) is written as a
    maximum. sqrt((1 - d^2)^3) in (3.101) is written as 8 e^3 / (1 + e^2)^3. These forms have no roots at zero.
    """
    x, y, spin = patch.creepages
    a, b = patch.semi_axes
    kalker, reduction, shear_modulus = patch.kalker, patch.reduction, patch.shear_modulus
    limit = patch.friction * patch.load
    # Divisions are written as products with one reciprocal: they and their derivatives take most of the time.
    per_limit = 1 / limit
    with_spin = y + spin * a
    y_corrected = ca.if_else(ca.fabs(with_spin) > ca.fabs(y), with_spin, y)  # (3.105)
    total = ca.sqrt(x**2 + y_corrected**2 + CREEPAGE_FLOOR**2)  # (3.104)
    # (3.92), a mean of c11 and c22 in the direction of the creepage; it has no effect without creepage
    plain = x**2 + y**2 + CREEPAGE_FLOOR**2
    stiffness = ca.sqrt(((kalker.c11 * x) ** 2 + (kalker.c22 * y) ** 2 + (kalker.c22 * CREEPAGE_FLOOR) ** 2) / plain)
    per_total = 1 / total
    force = (
        polach_force(total, patch.load, patch.friction, patch.semi_axes, shear_modulus, stiffness, reduction)
        * per_total
    )

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
