"""FASTSIM for large traction: slopes fall with the area of slip, friction with the sliding in each cell.

M. Spiryagin, O. Polach, C. Cole (2013), Creep force modelling for rail traction vehicles based on the Fastsim
algorithm, Vehicle System Dynamics 51, 1765-1783.
"""

from __future__ import annotations

from dataclasses import dataclass

from fmu_src.symbols import ca
from rbd_model.contact.creep.fastsim import cells, march, rigid_slip, summed
from rbd_model.contact.creep.law import ContactPatch, CreepLaw

#: Smallest creepage that is distinguished from 0.
CREEPAGE_FLOOR = 1e-12


@dataclass(frozen=True)
class SlopeReduction:
    """Reduction of Kalker's slopes: k = k_0 (alpha + (1 - alpha) / (1 + beta epsilon)).

    Spiryagin, Polach and Cole (2013). Here epsilon is Polach's gradient of the stress in the area of adhesion, with
    slopes reduced by k_0. `initial` is k_0, without slip; `final` is alpha, a share of k_0, if all slips; `decay` is
    beta. That epsilon includes k_0 was found from a curve computed with CONTACT's modified FASTSIM. Without it forces
    have errors of 16 % of mu N.
    """

    initial: ca.SX | float
    final: ca.SX | float
    decay: ca.SX | float

    def at(self, patch: ContactPatch, friction: ca.SX) -> ca.SX:
        """Return the share of the slopes at the creepages of a patch; epsilon does not include spin."""
        x, y, _ = patch.creepages
        a, b = patch.semi_axes
        slopes = (patch.kalker.c11 * x) ** 2 + (patch.kalker.c22 * y) ** 2 + CREEPAGE_FLOOR**2
        softer = self.initial * patch.shear_modulus / (friction * patch.load)
        gradient = ca.pi / 4 * a * b * softer * ca.sqrt(slopes)
        return self.initial * (self.final + (1 - self.final) / (1 + self.decay * gradient))


def modified_fastsim(count: int, reduction: SlopeReduction) -> CreepLaw:
    """Return FASTSIM with count x count cells, Spiryagin, Polach and Cole (2013).

    The coefficient of friction is the patch's `friction_at` at the speed of rigid sliding in each cell; without one it
    is the patch's everywhere. Differences from the source: three flexibilities instead of one, stress at the centres of
    the cells.
    """
    grid = cells(count)

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        fall = patch.friction_at
        friction = patch.friction if fall is None else fall(ca.SX(0))
        limit = friction * patch.load
        rigid = grid.shared(rigid_slip(patch, limit)).times(reduction.at(patch, friction))

        def left(offset: float, place: float) -> ca.SX:
            assert fall is not None
            return fall(sliding_speed(patch, offset, place)) / friction

        chosen = None if fall is None else left
        return summed(grid, limit, lambda offset, length: march(grid, rigid, offset, length, chosen))

    return law


def sliding_speed(patch: ContactPatch, offset: float, place: float) -> ca.SX:
    """Return the speed of rigid sliding [m/s] at y/b = offset and x/a = place, Kalker (1982)."""
    x, y, spin = patch.creepages
    a, b = patch.semi_axes
    along, sideways = x - offset * b * spin, y + place * a * spin
    return patch.rolling_speed * ca.sqrt(along**2 + sideways**2 + CREEPAGE_FLOOR**2)
