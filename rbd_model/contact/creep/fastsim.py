"""Kalker's FASTSIM (1982): a bed of springs, marched from the leading edge of each strip to its trailing edge.

All lengths along a strip are over its half length, all stresses over the bound in the middle of the strip, so that the
bound is the same for all strips. What is left of the patch stands in `Rigid`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from rbd_model.contact.creep.law import ContactPatch, CreepLaw

#: Smallest stress, over the bound in the middle of the strip, that is told from none.
STRESS_FLOOR = 1e-12


@dataclass(frozen=True)
class Cells:
    """n strips of n cells: equal angles across the ellipse (y = b sin), equal lengths along each strip.

    offsets: y/b of the strips; half_lengths: over a; strip_weights, cell_weights: add up to the whole bound, 1.
    centres: of the cells, from 1 at the leading edge to -1. creepage_share: what the sums make of the force of a linear
    stress; the flexibilities are divided by it. Those of the bound and of spin are exact, as is that of friction.
    """

    offsets: tuple[float, ...]
    half_lengths: tuple[float, ...]
    strip_weights: tuple[float, ...]
    centres: tuple[float, ...]
    cell_weights: tuple[float, ...]
    creepage_share: float

    @property
    def steps(self) -> list[tuple[float, float]]:
        """Length and middle of the way to each centre, from the one before it or from the leading edge."""
        begins = (1.0, *self.centres[:-1])
        return [(begin - end, (begin + end) / 2) for begin, end in zip(begins, self.centres, strict=True)]


@lru_cache
def cells(count: int) -> Cells:
    """The cells of Kalker (1982), with strips at equal angles.

    Equal angles integrate the cos^4 of bound and spin exactly from 3 strips on; equal cells the parabola of both up to
    the same factor, which is divided out.
    """
    angles = math.pi * ((np.arange(count) + 0.5) / count - 0.5)
    offsets, half_lengths = np.sin(angles), np.cos(angles)
    centres = 1 - (2 * np.arange(count) + 1) / count
    strip_weights, cell_weights = half_lengths**4, 1 - centres**2
    total = strip_weights.sum() * cell_weights.sum()
    # A stress that grows from the leading edge with slope 1/R over R^2: in the sums, and in the integral 2/(2 pi/4).
    found = np.sum(half_lengths**3) * np.sum(1 - centres) / total
    return Cells(
        tuple(offsets.tolist()),
        tuple(half_lengths.tolist()),
        tuple((strip_weights / strip_weights.sum()).tolist()),
        tuple(centres.tolist()),
        (float(1 / cell_weights.sum()),) * count,
        float(found / (16 / (3 * math.pi))),
    )


@dataclass(frozen=True)
class Rigid:
    """Rigid slip of a patch over what would reach the bound, Kalker (1982): a / (mu p_0 L) times creepages.

    x, y: of xi_x, xi_y; twist, spin: of the longitudinal and lateral parts of spin, b xi_s and a xi_s, at the ends of
    the axes.
    """

    x: ca.SX
    y: ca.SX
    twist: ca.SX
    spin: ca.SX

    def along(self, offset: float) -> ca.SX:
        """Longitudinal rigid slip of the strip at y/b = offset."""
        return self.x - offset * self.twist

    def times(self, factor: ca.SX) -> Rigid:
        """All of them, more or fewer."""
        return Rigid(factor * self.x, factor * self.y, factor * self.twist, factor * self.spin)


def flexibilities(patch: ContactPatch) -> tuple[ca.SX, ca.SX, ca.SX]:
    """L_1, L_2, L_3 [m/Pa] from c11, c22, c23: Kalker (1982), so that FASTSIM has the limits of his theory."""
    a, b = patch.semi_axes
    kalker, modulus = patch.kalker, patch.shear_modulus
    return (
        8 * a / (3 * modulus * kalker.c11),
        8 * a / (3 * modulus * kalker.c22),
        ca.pi * a * ca.sqrt(a / b) / (4 * modulus * kalker.c23),
    )


def rigid_slip(patch: ContactPatch, limit: ca.SX, creepage_share: float) -> Rigid:
    """What decides of a patch, Kalker (1982), with the parabolic bound mu p_0 = 2 mu N / (pi a b).

    limit [N]: mu N; creepage_share: see `Cells`.
    """
    x, y, spin = patch.creepages
    a, b = patch.semi_axes
    first, second, third = flexibilities(patch)
    per_bound = a * ca.pi * a * b / (2 * limit)
    share, turning = per_bound / creepage_share, per_bound * spin / third
    return Rigid(share * x / first, share * y / second, b * turning, a * turning)


def fastsim(count: int) -> CreepLaw:
    """FASTSIM with count x count cells, Kalker (1982), A fast algorithm for the simplified theory of rolling contact.

    Three flexibilities, parabolic bound. Differs from Kalker's program: strips at equal angles instead of equal widths,
    stress at the centres of the cells, flexibilities that make the sums, not the integrals, Kalker's. Of first order in
    1/count where stresses turn in the area of slip, that is with spin; of second where they do not.
    """
    grid = cells(count)

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        limit = patch.friction * patch.load
        rigid = rigid_slip(patch, limit, grid.creepage_share)
        return summed(grid, limit, lambda *strip: march(grid, rigid, *strip))

    return law


#: Stresses (p_x, p_y) in the cells of a strip, over the bound in its middle; of its y/b and its half length over a.
Marched = Callable[[float, float], list[tuple[ca.SX, ca.SX]]]


def summed(grid: Cells, limit: ca.SX, marched: Marched) -> tuple[ca.SX, ca.SX]:
    """Forces (F_x, F_y) [N] of the stresses of all strips, Kalker (1982)."""
    x, y = ca.SX(0), ca.SX(0)
    for offset, half_length, weight in zip(grid.offsets, grid.half_lengths, grid.strip_weights, strict=True):
        stresses = marched(offset, half_length)
        x += weight * sum(cell * p for cell, (p, _) in zip(grid.cell_weights, stresses, strict=True))
        y += weight * sum(cell * p for cell, (_, p) in zip(grid.cell_weights, stresses, strict=True))
    return -limit * x, -limit * y


#: Share of the friction that is left in a cell; of its y/b and x/a.
Left = Callable[[float, float], ca.SX]


def march(
    grid: Cells, rigid: Rigid, offset: float, half_length: float, left: Left | None = None
) -> list[tuple[ca.SX, ca.SX]]:
    """Stresses of one strip from its leading edge on: grown by the rigid slip, cut to the bound, Kalker (1982).

    Where nothing slips the stress is that of the integral at each centre; the sum is Kalker's.
    """
    along, sideways = rigid.along(offset) / half_length, rigid.y / half_length
    x, y, stresses = ca.SX(0), ca.SX(0), []
    for centre, (step, middle) in zip(grid.centres, grid.steps, strict=True):
        x, y = x + step * along, y + step * sideways + step * middle * rigid.spin
        bound = (1 - centre**2) * (left(offset, half_length * centre) if left else 1)
        share = bound / ca.fmax(ca.sqrt(x**2 + y**2 + STRESS_FLOOR**2), bound)
        x, y = share * x, share * y
        stresses.append((x, y))
    return stresses
