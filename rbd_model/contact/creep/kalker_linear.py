"""Kalker's linear theory (1967): the forces of small creepages, without saturation."""

from __future__ import annotations

from fmu_src.symbols import ca
from rbd_model.contact.creep.law import ContactPatch


def kalker_linear(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
    """Creep forces (F_x, F_y) [N], Kalker (1967), On the rolling contact of two elastic bodies.

    F_x = -G a b c11 xi_x, F_y = -G a b c22 xi_y - G (a b)^1.5 c23 xi_s. Grows without bound: right while the forces are
    a small part of friction times load, wrong beyond.
    """
    x, y, spin = patch.creepages
    a, b = patch.semi_axes
    kalker = patch.kalker
    area = a * b
    stiffness = patch.shear_modulus * area
    return -stiffness * kalker.c11 * x, -stiffness * (kalker.c22 * y + ca.sqrt(area) * kalker.c23 * spin)
