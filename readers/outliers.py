"""Single points of a measured contour that lie off the smooth curve through their neighbours.

Splines follow such points: one point of a thousand, 0.5 mm off, changes the equivalent conicity by a third.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

#: Largest number of successive points that are tested as one outlier, and neighbours to each side that are fitted.
LARGEST_GROUP, BESIDE = 3, 4
#: Degree of the curve through the neighbours.
DEGREE = 3
#: Groups that are computed at a time, which bounds the memory.
BLOCK = 4096
#: Least distance of an outlier from the curve [mm]. It must also be FACTOR times the distance of the neighbours from
#: the same curve, and FACTOR times the median distance of all points. Noise of a good instrument is below 0.02 mm.
LEAST, FACTOR = 0.08, 8.0


def outliers(points: Points) -> list[tuple[int, float]]:
    """Return the indices of outliers and their distances from the curve through their neighbours [mm].

    Parameters
    ----------
    points : array, shape (points, 2)
        y and z [mm], from one side of the contour to the other.
    """
    found: dict[int, float] = {}
    for size in range(1, LARGEST_GROUP + 1):
        off, beside = _distances(points, size)
        usual = float(np.median(off[np.isfinite(off)])) if np.any(np.isfinite(off)) else 0.0
        limit = np.maximum(LEAST, FACTOR * np.maximum(beside, usual))
        for i in np.flatnonzero(off > limit):
            group = range(int(i), int(i) + size)
            if not found.keys() & set(range(int(i) - BESIDE, int(i) + size + BESIDE)):
                found.update(dict.fromkeys(group, float(off[i])))
    return sorted(found.items())


def _distances(points: Points, size: int) -> tuple[Points, Points]:
    """Return the least distance of each group from the curve, and the largest of its neighbours; NaN at the ends."""
    off, beside = np.full(len(points), np.nan), np.full(len(points), np.nan)
    first = np.arange(BESIDE, len(points) - size - BESIDE + 1)
    for some in np.array_split(first, max(1, len(first) // BLOCK)):
        off[some], beside[some] = _distances_of(points, size, some)
    return off, beside


def _distances_of(points: Points, size: int, first: NDArray[np.int64]) -> tuple[Points, Points]:
    """Return the distances of the groups that begin at `first`, in axes along each group's neighbours."""
    around = np.r_[-BESIDE:0, size : size + BESIDE]
    near, group = points[first[:, None] + around], points[first[:, None] + np.arange(size)]
    along = near[:, BESIDE:].mean(axis=1) - near[:, :BESIDE].mean(axis=1)
    length = np.hypot(*along.T)
    y, z = along.T / np.where(length > 0.0, length, np.nan)
    middle = near.mean(axis=1, keepdims=True)
    turn = np.stack([np.stack([y, -z], -1), np.stack([z, y], -1)], -2)
    (u, v), (own_u, own_v) = (np.moveaxis((one - middle) @ turn, -1, 0) for one in (near, group))
    clean = np.all(np.diff(u, axis=1) > 0.0, axis=1)  # false for NaN, too
    scale = np.where(clean, np.max(np.abs(u), axis=1), 1.0)[:, None]
    powers = np.arange(DEGREE + 1)
    matrix = np.where(clean[:, None, None], (u / scale)[..., None] ** powers, 0.0)
    weights = np.linalg.pinv(matrix) @ np.where(clean[:, None], v, 0.0)[..., None]
    beside = np.max(np.abs(v[..., None] - matrix @ weights), axis=(1, 2))
    own = np.abs(own_v[..., None] - (own_u / scale)[..., None] ** powers @ weights)
    return np.where(clean, np.min(own, axis=(1, 2)), np.nan), np.where(clean, beside, np.nan)
