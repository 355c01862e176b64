"""The side of a contour towards the middle of the track: a wheel's flange, a rail's gauge corner.

Instruments and programs differ in the direction of y. A wheel's side is that of its flange. A rail as laid leans
towards the middle of the track, by 1:20 or 1:40, and a worn rail has lost its gauge corner. An upright, unworn head is
symmetric and has no side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

Points = NDArray[np.float64]
SIDES = ("y-", "y+")
#: Depths below the top at which a head's middle is taken [m]: from the crown's arcs down to the gauge face.
SHALLOWEST, DEEPEST, DEPTHS = 1.5e-3, 13.5e-3, 25
#: Least depth over which both flanks must exist to determine a side [m].
LEAST_DEPTH = 4e-3
#: Largest lean in the search, and the least that is treated as a lean: rails lie at 1:20 to 1:60.
LARGEST_LEAN, LEAST_LEAN = 1 / 12, 1 / 150
#: Lean from which a rail in a file is treated as laid [1]; wear of an upright rail has a smaller effect.
LAID = 1 / 60
#: Standard deviation of a symmetric head's middle over the depth [m], and how much less it must be if it leans.
SYMMETRIC, CLEARLY = 0.15e-3, 3.0
#: Least distance of a worn head's crown from the middle of its flanks for its side to be determined [m], and the depth
#: of the crown [m].
WORN, CROWN = 1e-3, 4e-3
#: Least height of a flange below most of the tread, and by which it is lower than the other side of the wheel [m].
LEAST_FLANGE, ONE_FLANGE = 10e-3, 5e-3


@dataclass(frozen=True)
class GaugeSide:
    """The side of a file's y towards the middle of the track.

    Attributes
    ----------
    side : str
        "y-", "y+", or "" if the contour has none, as a symmetric, upright head.

    reason : str
        Why this side was chosen.

    lean : float or None
        Slope by which a head's axis leans towards `side`, below 0: away from it; None if its shape does not determine
        it.
    """

    side: str
    reason: str
    lean: float | None = None

    def __str__(self) -> str:
        return f"{self.side or 'none'} ({self.reason})"


def upright(points: Points, kind: str) -> Points:
    """Return rows (y, z) turned over if a rail's head or a wheel's tread lies below its flanks.

    Most of a contour's breadth is head or tread. Points far from it belong to a flank or flange.
    """
    y, z = points.T
    order = np.argsort((z[1:] + z[:-1]) / 2)
    breadth = np.cumsum(np.abs(np.diff(y))[order])
    middle = float(((z[1:] + z[:-1]) / 2)[order][np.searchsorted(breadth, breadth[-1] / 2)])
    return points * [1.0, -1.0] if z.max() - middle > middle - z.min() else points


def gauge_side(points: Points, kind: str) -> GaugeSide | None:
    """Return the gauge side of an upright contour, rows (y, z) [m]; None if its shape does not determine it.

    A rail is laid inclined towards the middle of the track (section 4.3).

    Takes points (points, 2).
    """
    if kind == "wheel":
        y, z = points.T
        middle = y < np.median(y)
        if float(np.median(z) - np.min(z)) < LEAST_FLANGE or abs(z[middle].min() - z[~middle].min()) < ONE_FLANGE:
            return None
        return GaugeSide(SIDES[int(y[np.argmin(z)] > np.median(y))], "its flange lies there")
    return _of_rail(points)


def _of_rail(points: Points) -> GaugeSide | None:
    middles = _middles(points)
    if middles is None:
        return None
    straight, angle, least = float(np.std(middles)), *_axis(points)
    if straight < SYMMETRIC and abs(angle) < LEAST_LEAN:
        return GaugeSide("", "symmetric and upright", 0.0)
    if least < SYMMETRIC and CLEARLY * least < straight and abs(angle) < 0.99 * LARGEST_LEAN:
        lean = math.tan(abs(angle))
        return GaugeSide(SIDES[int(angle > 0.0)], f"it leans 1:{1 / lean:.3g} to there", lean)
    depths = np.linspace(0.0, 1.0, middles.size)
    crown = depths * (DEEPEST - SHALLOWEST) + SHALLOWEST < CROWN
    aside = float(np.mean(middles[crown]) - middles[-1])
    return GaugeSide(SIDES[int(aside < 0.0)], "its corner is worn there") if abs(aside) > WORN else None


def _axis(points: Points) -> tuple[float, float]:
    """Return the lean of a head's axis of symmetry to y+ [rad], and its deviation from symmetry [m]."""

    def unequal(angle: float) -> float:
        middles = _middles(_turned(points, angle))
        return math.inf if middles is None else float(np.std(middles))

    angles = np.linspace(-LARGEST_LEAN, LARGEST_LEAN, 41)
    best = float(angles[np.argmin([unequal(angle) for angle in angles])])
    width = float(angles[1] - angles[0])
    found = minimize_scalar(unequal, bounds=(best - width, best + width), method="bounded", options={"xatol": 1e-5})
    return float(found.x), float(found.fun)


def _turned(points: Points, angle: float) -> Points:
    cosine, sine = math.cos(angle), math.sin(angle)
    y, z = points.T
    return np.column_stack([cosine * y - sine * z, sine * y + cosine * z])


def _middles(points: Points) -> Points | None:
    """Return y of the middle between both flanks of a head at depths below its top [m]; None if they end too early."""
    z = points[:, 1]
    top = int(np.argmax(z))
    flanks = [points[top:], points[top::-1]]
    ends = [float(z[top] - np.min(flank[:, 1])) for flank in flanks]
    if min(ends) < LEAST_DEPTH:
        return None
    depths = np.linspace(SHALLOWEST, min(DEEPEST, *ends), DEPTHS)
    found = []
    for flank in flanks:
        deep = np.maximum.accumulate(z[top] - flank[:, 1])
        new = np.concatenate([[True], np.diff(deep) > 0.0])
        found.append(np.interp(depths, deep[new], flank[new, 0]))
    return (found[0] + found[1]) / 2
