"""Creep forces strip by strip: Kalker's simplified theory (FASTSIM) on a patch of any shape.

Kalker (1982), A fast algorithm for the simplified theory of rolling contact. Each strip is followed from its leading to
its trailing edge; the stress grows with the sliding of the rigid surfaces over the flexibility and is cut at friction
times pressure. Three flexibilities, for creepage ahead, to the side and from spin, keep Kalker's linear theory exact on
an ellipse; one weighted mean of them, as is often used, is up to 17 % of mu N off where spin works against creepage.
They are those of an ellipse as long as the longest strip and of the same area.

It is cut at a parabola along the strip, as Kalker chose it so that the right places slide, with the load that the strip
truly has. Half an ellipse instead would be nearer to exact theory where spin is strong and creepage against it, and
further off elsewhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rbd_model.contact.creep.kalker import C11, C22, C23
from rbd_model.contact.normal import TINY, ContactArea, Steel

#: Cells along each strip; with 128 no creep force changes by more than 1 % of mu N.
CELLS = 16
#: ln(a/b) of the columns of Kalker's table.
LOGARITHMS = np.log([*(i / 10 for i in range(1, 11)), *(10 / i for i in range(9, 0, -1))])


@dataclass(frozen=True)
class Creepages:
    """Of the wheel against the rail at the middle of each strip: ahead, to the side [1], spin [1/m]; cf. eq. (2.3)."""

    ahead: np.ndarray
    aside: np.ndarray
    spin: np.ndarray


def flexibilities(patch: ContactArea, steel: Steel) -> tuple[float, float, float]:
    """L1, L2, L3 [m/Pa] of Kalker (1982): for creepage ahead, to the side, from spin.

    Kalker's coefficients are those of Poisson's ratio 0.25, as everywhere here; at 0.28 those of creepage ahead are 4 %
    larger. Beyond axis ratios of 10 and 1/10, the ends of his table, they stay.
    """
    longest = float(np.max(patch.half_length))
    across = 2 * float(np.sum(patch.half_length * patch.breadth)) / (math.pi * longest)
    c11, c22, c23 = (float(np.interp(math.log(longest / across), LOGARITHMS, c)) for c in (C11, C22, C23))
    size = longest / steel.shear_modulus
    spin = math.pi * size * math.sqrt(longest / across) / (4 * c23)
    return 8 * size / (3 * c11), 8 * size / (3 * c22), spin


def creep_forces(patch: ContactArea, creepages: Creepages, steel: Steel, friction: float) -> np.ndarray:
    """Forces on the wheel, ahead and to the side, of each strip [N], shape (2, n); Kalker (1982).

    What differs from strip to strip is spin's doing: on a flat patch the creepage ahead falls by spin times breadth.
    """
    ahead, aside, from_spin = flexibilities(patch, steel)
    mean = patch.centre(creepages.ahead), patch.centre(creepages.aside)
    steady = np.array(
        [
            mean[0] / ahead + (creepages.ahead - mean[0]) / from_spin,
            mean[1] / aside + (creepages.aside - mean[1]) / from_spin,
        ]
    )
    turning = creepages.spin / from_spin
    flexible = 2 * np.array([[ahead], [aside]]) / (ahead + aside)
    places = 1 - (2 * np.arange(CELLS) + 1) / CELLS
    # The parabola has the load of half an ellipse, whose mean is pi / 4.
    shape = 1 - places**2
    shape *= math.pi / 4 / np.mean(shape)
    stress, total, moved = np.zeros_like(steady), np.zeros_like(steady), np.zeros_like(steady)
    for place, height in zip(places, shape, strict=True):
        # By how much the surfaces would have moved over each other since the leading edge.
        before, moved = moved, steady * (1 - place)
        moved[1] += turning * patch.half_length * (1 - place**2) / 2
        stress = _cut(stress - (moved - before) * patch.half_length, friction * patch.pressure * height, flexible)
        total += stress
    return np.asarray(total * 2 * patch.half_length / CELLS * patch.breadth)


def _cut(stress: np.ndarray, limit: np.ndarray, flexible: np.ndarray) -> np.ndarray:
    """The stress, no larger than the limit, where friction is met by sliding in its own direction.

    Sliding takes from each component in inverse proportion to its flexibility: far beyond the limit the stress then
    lies along the sliding, and not along the stress before it.
    """
    beyond = np.maximum(np.hypot(*stress) / np.maximum(limit, TINY), 1.0) - 1
    turned = stress / (1 + beyond / flexible)
    return np.asarray(turned * np.where(beyond > 0.0, limit / np.maximum(np.hypot(*turned), TINY), 1.0))
