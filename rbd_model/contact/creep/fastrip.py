"""FaStrip: strip theory where it sticks, the elliptic bound in FASTSIM's direction where it slips.

M. Sh. Sichani, R. Enblom, M. Berg (2016), An alternative to FASTSIM for tangential solution of the wheel-rail contact,
Vehicle System Dynamics 54, 748-764.
"""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca

from rbd_model.contact.creep.fastsim import STRESS_FLOOR, Rigid, cells, flexibilities, march, rigid_slip
from rbd_model.contact.creep.law import ContactPatch, CreepLaw
from rbd_model.contact.creep.strip_theory import adhesion, adhesive_force, adhesive_slip, strips

#: A strip's end, from which the area of slip is told: round-off in its smallest areas stays below 1e-7 of them.
SMALLEST_SLIP = 1e-9


def segment(place: ca.SX | float) -> ca.SX:
    """Area of half a unit circle behind a place from 1 (all of it, pi/2) to -1, the bound's sum in Sichani (2016)."""
    return place * ca.sqrt(1 - place**2) / 2 + (ca.asin(place) + math.pi / 2) / 2


def sliding_slip(patch: ContactPatch, limit: ca.SX) -> Rigid:
    """Rigid slip that gives slip its direction: as FASTSIM's, Kalker (1982), but with flexibilities of spin of our own.

    FASTSIM takes L_3 for spin, which is right where all sticks; where all slips the stress lies against the true slip,
    whose parts from spin and from creepage count alike. Strip theory keeps adhesion, so that the geometric mean of L_3
    and of the creepage's L_1, L_2 can stand here. Of the exponents 0, 1/2, 3/4 and 1 random states prefer 3/4 by half a
    per cent of mu N, with which a published row is further off than 5 % of it: 1/2 was taken.
    """
    first, second, third = flexibilities(patch)
    slip = rigid_slip(patch, limit, 1.0)
    return replace(slip, twist=slip.twist * ca.sqrt(third / first), spin=slip.spin * ca.sqrt(third / second))


def fastrip(count: int) -> CreepLaw:
    """FaStrip with count strips of count cells, count even, Sichani, Enblom and Berg (2016).

    Cells of slip that adhesion cuts count in part, so that the forces have no jumps. Differs from the source: Gauss's
    strips, flexibilities of spin as in `sliding_slip`, and beyond spins of psi = 1 adhesion goes on as in `adhesion`.
    Of first order in 1/count; with strong spin 8 cells are some 3 % of mu N further off than 16.
    """
    lines, grid = strips(count), cells(count)
    ends = [float(segment(1 - 2 * number / count)) for number in range(count + 1)]

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        limit = patch.friction * patch.load
        sticking = adhesive_slip(patch, limit, lines.creepage_share)
        sliding = sliding_slip(patch, limit)
        x, y = ca.SX(0), ca.SX(0)
        for offset, half_length, weight in zip(lines.offsets, lines.half_lengths, lines.weights, strict=True):
            area = adhesion(sticking.along(offset), sticking.y, sticking.spin, half_length)
            border = ca.fmin(2 * area.slip / half_length, 2 - SMALLEST_SLIP) - 1
            slipping = [half_length**2 * ca.fmin(end, segment(border)) for end in ends]
            force = adhesive_force(area, half_length, slipping[0])
            x, y = x + weight * force[0], y + weight * force[1]
            for number, (along, sideways) in enumerate(march(grid, sliding, offset, half_length)):
                share = weight * (slipping[number] - slipping[number + 1])
                share = share / ca.sqrt(along**2 + sideways**2 + STRESS_FLOOR**2)
                x, y = x + share * along, y + share * sideways
        return -1.5 / ca.pi * limit * x, -1.5 / ca.pi * limit * y

    return law
