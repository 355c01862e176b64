"""Strips of Kalker's strip theory (1967) with an elliptic bound, and slip that turns along each strip.

This law is between FaStrip and the exact theory. At the leading edge it has an area of adhesion by strip theory, scaled
to Kalker's coefficients as in FaStrip. The elliptic bound follows behind it, in a direction that obeys FASTSIM's
equation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fmu_src.symbols import ca
from rbd_model.contact.creep.fastsim import Rigid, flexibilities, rigid_slip
from rbd_model.contact.creep.law import ContactPatch, CreepLaw

#: Smallest length, over a, and smallest stress, over the largest, that are distinguished from 0.
FLOOR = 1e-12


@dataclass(frozen=True)
class GaussStrips:
    """Strips at Gauss's points: y/b, half lengths over a, weights; creepage_share: computed over exact sum of lengths.

    Their number is even: in the middle strip of an odd number the direction of pure spin would be undefined.
    """

    offsets: tuple[float, ...]
    half_lengths: tuple[float, ...]
    weights: tuple[float, ...]
    creepage_share: float


@lru_cache
def strips(count: int) -> GaussStrips:
    """Return Gauss's points. Friction and the force of spin add up exactly, that of creepage up to `creepage_share`.

    Bound and stress of spin vary with the square of a strip's length, that of creepage with its length: Kalker (1967).
    """
    if count < 2 or count % 2:
        raise ValueError(f"The number of strips is {count}; it must be even, so that no strip lies in the middle.")
    offsets, weights = np.polynomial.legendre.leggauss(count)
    lengths = np.sqrt(1 - offsets**2)
    share = float(np.sum(weights * lengths) / (math.pi / 2))
    return GaussStrips(tuple(offsets.tolist()), tuple(lengths.tolist()), tuple(weights.tolist()), share)


def adhesive_slip(patch: ContactPatch, limit: ca.SX, creepage_share: float) -> Rigid:
    """Return creepages of strip theory times 4 (1 - nu) c11/pi^2, 4 c22/pi^2 and 3 c23/pi sqrt(b/a), Sichani (2016).

    With these factors small creepages give Kalker's forces. The first two are half lengths of slip over a, the last is
    Kalker's psi; p_0 is that of Hertz, 3 N / (2 pi a b). The longitudinal part of spin, -xi_s y, is a creepage of the
    strip, with c11 as any other: c23 applies to the lateral part.
    """
    x, y, spin = patch.creepages
    a, b = patch.semi_axes
    kalker, strain = patch.kalker, 2 * ca.pi * a * b / (3 * limit) * patch.shear_modulus
    along = 2 / (math.pi**2 * creepage_share) * strain * kalker.c11
    sideways = 2 / (math.pi**2 * creepage_share) * strain * kalker.c22
    turning = 1.5 / math.pi * strain * ca.sqrt(a * b) * kalker.c23
    return Rigid(along * x, sideways * y, along * b * spin, turning * spin)


@dataclass(frozen=True)
class Adhesion:
    """Area of adhesion at the leading edge of a strip, whose rigid slip is (x, y) and, of Kalker's psi, spin.

    slip: half the length of the slip area behind it over a, at most the strip's half length, at which nothing sticks.
    root: the same by strip theory, also beyond psi = 1, at which less sticks.
    """

    slip: ca.SX
    root: ca.SX
    x: ca.SX
    y: ca.SX
    spin: ca.SX

    @property
    def direction(self) -> tuple[ca.SX, ca.SX]:
        """Direction of the stress at the start of the slip area, Kalker (1967): that of (x, y + psi d)."""
        with_spin = self.y + self.spin * self.slip
        per_size = 1 / ca.sqrt(self.x**2 + with_spin**2 + FLOOR**2)
        return per_size * self.x, per_size * with_spin


def adhesion(x: ca.SX, y: ca.SX, spin: ca.SX, half_length: float) -> Adhesion:
    """Return the area of adhesion: x^2 + (y + psi d)^2 = d^2 for half the length d of its slip, Kalker (1967).

    Each root is in the form without a difference. The source ends at psi = 1. This function continues with the
    remaining root beyond it. The length of adhesion, over the strip's, is then at most (2 k.k'/k'^2)^2 with the factors
    k and k' of both ellipses. At this limit the stress at the leading edge would exceed the bound. The length is 0 if
    no root exists.
    """
    root = ca.sqrt(ca.fmax(y**2 + (1 - spin**2) * x**2, 0) + FLOOR**2)
    product = y * spin
    with_spin = (root + product) / ca.fmax(1 - spin**2, FLOOR)
    against = (x**2 + y**2 + FLOOR**2) / (root + ca.fabs(product))
    root = ca.fmin(ca.if_else(product > 0, with_spin, against), half_length)
    remaining = 1 - spin * (y / root + spin)
    share = 2 * ca.fmax(remaining, 0) / ca.fmax(2 * remaining - 1 + spin**2, FLOOR)
    slip = ca.fmax(root, half_length * (1 - ca.fmin(share, 1) ** 2))
    return Adhesion(slip, root, x, y, spin)


def adhesive_force(area: Adhesion, half_length: float, slipping: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the force of a strip's area of adhesion over mu p_0 a b: two superposed ellipses, Kalker (1967).

    slipping: the sum of the bound over the area of slip. The form avoids cancellation for a vanishing area of slip.
    """
    from_creepage = (ca.pi / 2 * area.slip * (2 * half_length - area.slip) - slipping) / area.root
    from_spin = area.spin * (math.pi / 2 * half_length**2 - slipping)
    return from_creepage * area.x, from_creepage * area.y + from_spin


def strip_theory(count: int) -> CreepLaw:
    """Return strip theory that slips in a turning direction, with count strips of count steps, count even.

    This follows Kalker (1967), A strip theory for rolling with slip and spin, and Sichani, Enblom and Berg (2016). It
    differs from their FaStrip in the direction of slip, which starts from that of the stress at the end of adhesion
    instead of the leading edge of FASTSIM. Also, L_1 is that of all longitudinal slip, including that of spin. No
    constant is fitted, but L_1 was preferred to Kalker's L_3 there by comparison with exact forces. With L_3 one of 45
    cases has an error of 6 % of mu N; with L_1 all are within 5 %. The order is second in 1/count.
    """
    grid = strips(count)

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        first, _, third = flexibilities(patch)
        limit = patch.friction * patch.load
        sticking = adhesive_slip(patch, limit, grid.creepage_share)
        sliding = rigid_slip(patch, 0.75 * limit)
        sliding = replace(sliding, twist=sliding.twist * third / first)
        x, y = ca.SX(0), ca.SX(0)
        for offset, half_length, weight in zip(grid.offsets, grid.half_lengths, grid.weights, strict=True):
            area = adhesion(sticking.along(offset), sticking.y, sticking.spin, half_length)
            steps = list(turning_slip(area, sliding, offset, half_length, count))
            force = adhesive_force(area, half_length, sum((bound for bound, _, _ in steps), ca.SX(0)))
            x += weight * (force[0] + sum(bound * along for bound, along, _ in steps))
            y += weight * (force[1] + sum(bound * sideways for bound, _, sideways in steps))
        return -1.5 / ca.pi * limit * x, -1.5 / ca.pi * limit * y

    return law


def turning_slip(
    area: Adhesion, sliding: Rigid, offset: float, half_length: float, count: int
) -> Iterator[tuple[ca.SX, ca.SX, ca.SX]]:
    """Yield bound times length [over p_0 a], and direction (x, y), of each step over the area of slip, from adhesion
    back.

    Kalker (1982), for x = d cos(angle) - (half_length - d) and equal angles. The sum of the bound is exact if all
    slips.
    """
    along = sliding.along(offset)
    step = math.pi / count
    ahead = 2 * (half_length - area.slip) / area.slip  # length of adhesion over half that of slip
    direction, last = area.direction, 0.0
    for number in range(count):
        angle = (number + 0.5) * step
        middle, turn = (last + angle) / 2, angle - last
        place = area.slip * (1 + math.cos(middle)) - half_length
        edge = 1 - math.cos(middle)
        # Length over bound, dx/sqrt(R^2 - x^2), between the middles of two steps.
        reach = turn * ca.sqrt(edge / (ahead + edge))
        direction = turned(direction, (along, sliding.y + sliding.spin * place), reach)
        edge = 1 - math.cos(angle)
        bound = step * math.sin(angle) * area.slip**2 * ca.sqrt((2 - edge) * (ahead + edge))
        yield bound, *direction
        last = angle


def turned(direction: tuple[ca.SX, ca.SX], slip: tuple[ca.SX, ca.SX], reach: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the direction of the stress after a distance at its bound under a rigid slip: it turns towards the slip.

    FASTSIM's equation, Kalker (1982), for a stress of given size reduces the tangent of the half angle between both to
    its e^(-|slip| reach)-th part. Here e^-r is written as 1/(1 + r + r^2/2 + r^3/6), which is stable for any distance.
    """
    size = ca.sqrt(slip[0] ** 2 + slip[1] ** 2 + FLOOR**2)
    along, sideways = slip[0] / size, slip[1] / size
    way = size * reach
    growth = 1 + way * (1 + way * (0.5 + way / 6))
    left = 1 / growth
    cosine = direction[0] * along + direction[1] * sideways
    sine = direction[0] * sideways - direction[1] * along
    ahead, behind = 1 + cosine, (1 - cosine) * left**2
    per_sum = 1 / (ahead + behind + FLOOR)
    cosine, sine = (ahead - behind) * per_sum, 2 * left * sine * per_sum
    return cosine * along + sine * sideways, cosine * sideways - sine * along
