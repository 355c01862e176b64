"""FaStrip: strip theory in the area of adhesion, the elliptic bound in FASTSIM's direction in the area of slip.

M. Sh. Sichani, R. Enblom, M. Berg (2016), An alternative to FASTSIM for tangential solution of the wheel-rail contact,
Vehicle System Dynamics 54, 748-764.
"""

from __future__ import annotations

import math
from dataclasses import replace

from fmu_src.symbols import ca
from rbd_model.contact.creep.fastsim import STRESS_FLOOR, Rigid, cells, flexibilities, march, rigid_slip
from rbd_model.contact.creep.law import ContactPatch, CreepLaw
from rbd_model.contact.creep.strip_theory import adhesion, adhesive_force, adhesive_slip, strips

#: Smallest length of slip at a strip's end. Round-off in the smallest areas of slip stays below 1e-7 of them.
SMALLEST_SLIP = 1e-9


def segment(place: ca.SX | float) -> ca.SX:
    """Return the area of half a unit circle behind a place from 1 (all, pi/2) to -1: the bound's sum.

    Sichani (2016).
    """
    return place * ca.sqrt(1 - place**2) / 2 + (ca.asin(place) + math.pi / 2) / 2


def sliding_slip(patch: ContactPatch, limit: ca.SX) -> Rigid:
    """Return the rigid slip that directs the slip.

    It is that of FASTSIM, Kalker (1982), with different flexibilities of spin.

    FASTSIM takes L_3 for both parts of spin. It belongs to c23, to which the longitudinal part does not contribute:
    this part is a creepage of the strip, with L_1. In the lateral part L_3 is right if all sticks. If all slips, the
    stress opposes the true slip, in which spin and creepage have equal weights. It would then be L_2. This law uses the
    geometric mean of both: at random states 99 % are within 10 % of mu N, with L_3 13 %, with L_2 18 %.
    """
    first, second, third = flexibilities(patch)
    slip = rigid_slip(patch, 0.75 * limit)
    return replace(slip, twist=slip.twist * third / first, spin=slip.spin * ca.sqrt(third / second))


def ellipse_over_parabola(offset: float, place: float) -> float:
    """Return Hertz's bound, as in Sichani (2016), over that of `march`, at y/b = offset and x/a = place."""
    return 1 / math.sqrt(1 - offset**2 - place**2)


def fastrip(count: int) -> CreepLaw:
    """Return FaStrip with count strips of count cells, count even, Sichani, Enblom and Berg (2016).

    Cells of slip that adhesion cuts are included in part, so that the forces have no jumps. Differences from the
    source: Gauss's strips, flexibilities of spin as in `sliding_slip`, and large spin. Strip theory divides by 1 -
    psi^2 and has no adhesion beyond psi = 1, so that all would slip. There this law uses the stress of the elliptic
    FASTSIM, which sticks. Below, that stress has a weight of psi^8, so that strip theory dominates in its range of
    validity. A weight of psi^2 gives the same errors at random states. For a published row with psi = 0.95 it has an
    error of 6.7 % of mu N instead of 4.6 %. The order is first in 1/count.
    """
    lines, grid = strips(count), cells(count)
    ends = [float(segment(1 - 2 * number / count)) for number in range(count + 1)]

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        limit = patch.friction * patch.load
        sticking = adhesive_slip(patch, limit, lines.creepage_share)
        sliding = sliding_slip(patch, limit)
        marched = ca.fmin(sticking.spin**8, 1)
        x, y = ca.SX(0), ca.SX(0)
        for offset, half_length, weight in zip(lines.offsets, lines.half_lengths, lines.weights, strict=True):
            area = adhesion(sticking.along(offset), sticking.y, sticking.spin, half_length)
            border = ca.fmin(2 * area.slip / half_length, 2 - SMALLEST_SLIP) - 1
            slipping = [half_length**2 * ca.fmin(end, segment(border)) for end in ends]
            force = adhesive_force(area, half_length, slipping[0])
            by_strip = weight * (1 - marched)
            x, y = x + by_strip * force[0], y + by_strip * force[1]
            stresses = march(grid, sliding, offset, half_length, ellipse_over_parabola)
            for number, (along, sideways) in enumerate(stresses):
                size = ca.sqrt(along**2 + sideways**2 + STRESS_FLOOR**2)
                bound = math.sqrt(1 - grid.centres[number] ** 2) / half_length
                share = by_strip * (slipping[number] - slipping[number + 1]) / size
                share += weight * marched * half_length**2 * (ends[number] - ends[number + 1]) / bound
                x, y = x + share * along, y + share * sideways
        return -1.5 / ca.pi * limit * x, -1.5 / ca.pi * limit * y

    return law
