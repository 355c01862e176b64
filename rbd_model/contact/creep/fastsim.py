"""Kalker's FASTSIM (1982): a bed of springs, marched from the leading edge of each strip to its trailing edge.

All lengths along a strip are over its half length, all stresses over the bound in the middle of the strip, so that the
bound is the same for all strips. `Rigid` holds the remaining data of the patch.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fmu_src.symbols import ca
from rbd_model.contact.creep.law import ContactPatch, CreepLaw

#: Smallest stress that is distinguished from 0, over the bound in the middle of the strip.
STRESS_FLOOR = 1e-12


@dataclass(frozen=True)
class StripCells:
    """n strips of n cells: equal angles across the ellipse (y = b sin), equal lengths along each strip.

    `offsets` are y/b of the strips; `half_lengths` are over a. `strip_weights` and `cell_weights` add up to the whole
    bound, 1. `centres` are those of the cells, from 1 at the leading edge to -1. `steps` are length and middle of the
    distance over which the stress of each has grown since the one before it. `creepage_share` and `spin_share` are the
    ratios of sum to exact force, for a stress that is linear, or a parabola, along the strip. Friction adds up exactly.
    """

    offsets: tuple[float, ...]
    half_lengths: tuple[float, ...]
    strip_weights: tuple[float, ...]
    centres: tuple[float, ...]
    cell_weights: tuple[float, ...]
    steps: tuple[tuple[float, float], ...]
    creepage_share: float
    spin_share: float

    def shared(self, rigid: Rigid) -> Rigid:
        """Return a rigid slip by which the sums, not the integrals, have the linear limits of Kalker (1982)."""
        creepage = self.creepage_share
        return Rigid(rigid.x / creepage, rigid.y / creepage, rigid.twist / creepage, rigid.spin / self.spin_share)


@lru_cache
def cells(count: int, whole: bool = False) -> StripCells:
    """Return the cells of Kalker (1982), with strips at equal angles.

    whole: the stress of a cell has grown over the whole of it, not up to its middle.

    Equal angles integrate the cos^4 of bound and spin exactly from 3 strips on. Equal cells integrate the parabola of
    both up to the same factor, which is divided out.
    """
    angles = math.pi * ((np.arange(count) + 0.5) / count - 0.5)
    offsets, half_lengths = np.sin(angles), np.cos(angles)
    centres, ends = 1 - (2 * np.arange(count) + 1) / count, 1 - 2 * (np.arange(count) + 1) / count
    reached = ends if whole else centres
    begins = np.concatenate([[1.0], reached[:-1]])
    strip_weights, cell_weights = half_lengths**4, 1 - centres**2
    total = strip_weights.sum() * cell_weights.sum()
    # A stress that grows from the leading edge with slope 1/R, over R^2: in the sums, and in the integral 2/(2 pi/4).
    found = np.sum(half_lengths**3) * np.sum(1 - reached) / total
    return StripCells(
        tuple(offsets.tolist()),
        tuple(half_lengths.tolist()),
        tuple((strip_weights / strip_weights.sum()).tolist()),
        tuple(centres.tolist()),
        (float(1 / cell_weights.sum()),) * count,
        tuple(zip((begins - reached).tolist(), ((begins + reached) / 2).tolist(), strict=True)),
        float(found / (16 / (3 * math.pi))),
        float(np.sum(1 - reached**2) / cell_weights.sum()),
    )


@dataclass(frozen=True)
class Rigid:
    """Rigid slip of a patch over the slip at which the bound is reached, Kalker (1982): a / (mu p_0 L) times creepages.

    x, y: of xi_x, xi_y; twist, spin: of the longitudinal and lateral parts of spin, b xi_s and a xi_s, at the ends of
    the axes.
    """

    x: ca.SX
    y: ca.SX
    twist: ca.SX
    spin: ca.SX

    def along(self, offset: float) -> ca.SX:
        """Return the longitudinal rigid slip of the strip at y/b = offset."""
        return self.x - offset * self.twist

    def times(self, factor: ca.SX) -> Rigid:
        """Return all of them times a factor."""
        return Rigid(factor * self.x, factor * self.y, factor * self.twist, factor * self.spin)


def flexibilities(patch: ContactPatch) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Return L_1, L_2, L_3 [m/Pa] from c11, c22, c23: Kalker (1982), so that FASTSIM has the limits of his theory."""
    a, b = patch.semi_axes
    kalker, modulus = patch.kalker, patch.shear_modulus
    return (
        8 * a / (3 * modulus * kalker.c11),
        8 * a / (3 * modulus * kalker.c22),
        ca.pi * a * ca.sqrt(a / b) / (4 * modulus * kalker.c23),
    )


def rigid_slip(patch: ContactPatch, limit: ca.SX) -> Rigid:
    """Return the rigid slip of a patch, Kalker (1982), with the parabolic bound mu p_0 = 2 mu N / (pi a b).

    limit [N]: mu N.
    """
    x, y, spin = patch.creepages
    a, b = patch.semi_axes
    first, second, third = flexibilities(patch)
    per_bound = a * ca.pi * a * b / (2 * limit)
    turning = per_bound * spin / third
    return Rigid(per_bound * x / first, per_bound * y / second, b * turning, a * turning)


def fastsim(count: int) -> CreepLaw:
    """Return FASTSIM with count x count cells, Kalker (1982), A fast algorithm for the simplified theory of rolling
    contact.

    It has three flexibilities, a parabolic bound and implicit Euler: the stress that has grown over a whole cell is
    limited by the bound in its middle. It differs from Kalker's program by strips at equal angles instead of equal
    widths. Its flexibilities make the sums, not the integrals, Kalker's. The order is first in 1/count. The error of 10
    to 20 cells against exact theory is about that of their limit. Fewer cells have large errors with spin.
    """
    grid = cells(count, whole=True)

    def law(patch: ContactPatch) -> tuple[ca.SX, ca.SX]:
        limit = patch.friction * patch.load
        rigid = grid.shared(rigid_slip(patch, limit))
        return summed(grid, limit, lambda *strip: march(grid, rigid, *strip))

    return law


#: Function of y/b of a strip and its half length over a: stresses (p_x, p_y) in its cells, over the bound in its
#: middle.
Marched = Callable[[float, float], "list[tuple[ca.SX, ca.SX]]"]


def summed(grid: StripCells, limit: ca.SX, marched: Marched) -> tuple[ca.SX, ca.SX]:
    """Return the forces (F_x, F_y) [N] of the stresses of all strips, Kalker (1982)."""
    x, y = ca.SX(0), ca.SX(0)
    for offset, half_length, weight in zip(grid.offsets, grid.half_lengths, grid.strip_weights, strict=True):
        stresses = marched(offset, half_length)
        x += weight * sum(cell * p for cell, (p, _) in zip(grid.cell_weights, stresses, strict=True))
        y += weight * sum(cell * p for cell, (_, p) in zip(grid.cell_weights, stresses, strict=True))
    return -limit * x, -limit * y


#: Function of y/b and x/a: remaining share of the friction in a cell.
Left = Callable[[float, float], "ca.SX | float"]


def march(
    grid: StripCells, rigid: Rigid, offset: float, half_length: float, left: Left | None = None
) -> list[tuple[ca.SX, ca.SX]]:
    """Return stresses of one strip from its leading edge on: grown by the rigid slip, cut to the bound.

    Kalker (1982).
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
