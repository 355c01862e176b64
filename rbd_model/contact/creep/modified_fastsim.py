"""FASTSIM for large traction: slopes fall with the area of slip, friction with the sliding in each cell.

M. Spiryagin, O. Polach, C. Cole (2013), Creep force modelling for rail traction vehicles based on the Fastsim
algorithm, Vehicle System Dynamics 51, 1765-1783.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from rbd_model.contact.creep.fastsim import (
    STRESS_FLOOR,
    Cells,
    Rigid,
    cells,
    cut,
    flexibilities,
    march,
    rigid_slip,
    summed,
)
from rbd_model.contact.creep.law import ContactPatch, CreepLaw

#: Smallest creepage that is told from none.
CREEPAGE_FLOOR = 1e-12


@dataclass(frozen=True)
class SlopeReduction:
    """What is left of Kalker's slopes: k = k_0 (alpha + (1 - alpha) / (1 + beta epsilon)).

    Spiryagin, Polach and Cole (2013): epsilon is Polach's gradient of the stress in the area of adhesion; initial: k_0,
    without slip; final: alpha, of k_0, where all slips; decay: beta.
    """

    initial: float
    final: float
    decay: float

    def at(self, patch: ContactPatch, friction: ca.SX) -> ca.SX:
        """Share of the slopes at the creepages of a patch; spin has no part in epsilon."""
        x, y, _ = patch.creepages
        a, b = patch.semi_axes
        slopes = (patch.kalker.c11 * x) ** 2 + (patch.kalker.c22 * y) ** 2 + CREEPAGE_FLOOR**2
        gradient = ca.pi / 4 * patch.shear_modulus * a * b / (friction * patch.load) * ca.sqrt(slopes)
        return self.initial * (self.final + (1 - self.final) / (1 + self.decay * gradient))


def modified_fastsim(count: int, reduction: SlopeReduction) -> CreepLaw:
    """FASTSIM with count x count cells, Spiryagin, Polach and Cole (2013).

    The coefficient of friction is the patch's `friction_at`, of the sliding speed in each cell; without one it is the
    patch's everywhere. Differs from the source: three flexibilities instead of one; and the friction of the cell before
    stands in the sliding that friction is found from, so that no cell needs an iteration.
    """
    grid = cells(count)

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        fall = patch.friction_at
        friction = patch.friction if fall is None else fall(ca.SX(0))
        limit, softer = friction * patch.load, reduction.at(patch, friction)
        rigid = rigid_slip(patch, limit, grid.creepage_share).times(softer)
        if fall is None:
            return summed(grid, limit, lambda *strip: march(grid, rigid, *strip))
        speed = sliding_per_excess(patch, friction) / softer

        def left(excess: ca.SX) -> ca.SX:
            return fall(speed * excess) / friction

        return summed(grid, limit, lambda *strip: march_falling(grid, rigid, left, *strip))

    return law


def sliding_per_excess(patch: ContactPatch, friction: ca.SX) -> ca.SX:
    """Sliding speed [m/s] in the middle strip per stress beyond the bound, over p_0, per length over a: V mu p_0 L/a.

    Kalker (1982), eq. 11; L is the mean of those of both creepages.
    """
    a, b = patch.semi_axes
    first, second, _ = flexibilities(patch)
    bound = 2 * friction * patch.load / (ca.pi * a * b)
    return patch.rolling_speed * bound * (first + second) / (2 * a)


def march_falling(
    grid: Cells, rigid: Rigid, left: Callable[[ca.SX], ca.SX], offset: float, half_length: float
) -> list[tuple[ca.SX, ca.SX]]:
    """Stresses of one strip as `march` finds them, the bound times the share of friction that is left in each cell.

    left: that share by the growth of the stress that slip takes away. Spiryagin, Polach and Cole (2013).
    """
    along, sideways = rigid.along(offset) / half_length, rigid.y / half_length
    x, y, share, stresses = ca.SX(0), ca.SX(0), ca.SX(1), []
    for centre, (step, middle) in zip(grid.centres, grid.steps, strict=True):
        x, y = x + step * along, y + step * sideways + step * middle * rigid.spin
        size, bound = ca.sqrt(x**2 + y**2 + STRESS_FLOOR**2), 1 - centre**2
        share = left(ca.fmax(size - share * bound, 0) * (half_length / step))
        kept = cut(size, share * bound)
        x, y = kept * x, kept * y
        stresses.append((x, y))
    return stresses
