"""Points of a measured contour that lie off the smooth curve through their neighbours.

Splines follow such points: one point of a thousand, 0.5 mm off, changes the equivalent conicity by a third.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

Points = NDArray[np.float64]

#: Largest number of successive points that are tested as one group, and of neighbours to each side that are fitted.
#: Two outliers with up to LARGEST_GROUP - 2 good points between them are the ends of a group.
LARGEST_GROUP, BESIDE = 7, 6
#: Least number of points beyond a group; the first and last of a contour may be the begin of a corner.
BEYOND = 2
#: Degree of the curve through the neighbours.
DEGREE = 3
#: Groups that are computed at a time, which bounds the memory. Passes over a contour, each without the points found.
BLOCK, PASSES = 4096, 20
#: Least distance of an outlier from the curve [mm]: twice the rounding of the coarsest digits of files, 0.01 mm.
LEAST = 0.02
#: An outlier is also this many times further off than its neighbours are, by their standard deviation. The factor is at
#: most 5.0 where a contour of points at equal distances has a corner, a step or a change of curvature at any place.
OVER_NEIGHBOURS = 7.0
#: An outlier is also this many times further off than the median of AROUND points: 6 standard deviations of noise.
OVER_USUAL, AROUND = 8.0, 61
#: Share of the farthest point's distance by which the contour leaps to and from three or more outliers in a row. Lips
#: and notches leave the contour point by point.
LEAP = 0.5
#: Added to the normal equations, whose diagonal is about 1: points may coincide.
RIDGE = 1e-10


def outliers(points: Points) -> list[tuple[int, float]]:
    """Return the indices of outliers and their distances from the curve through their neighbours [mm].

    A group of successive points is tested with a cubic through the neighbours on both sides, in axes along these. Its
    first and last point are outliers if they lie further off than the limit, as are all points between that do. The
    limit grows with the distances of the neighbours from the same curve, so that corners and steps pass.

    Takes points [mm] (points, 2).
    """
    kept = np.arange(len(points))
    found: dict[int, float] = {}
    for _ in range(PASSES):
        of_pass = _outliers_of_pass(points[kept])
        if not of_pass:
            break
        found.update({int(kept[i]): off for i, off in of_pass.items()})
        kept = np.delete(kept, list(of_pass))
    return sorted(found.items())


def _outliers_of_pass(points: Points) -> dict[int, float]:
    """Return the outliers in the smallest groups that have some, with distance; groups of a pass share no neighbour."""
    usual = np.zeros(len(points))
    for size in range(1, LARGEST_GROUP + 1):
        tested = _test(points, size)
        if tested is None:
            break
        if size == 1:
            usual[tested.first] = median_filter(tested.off[:, 0], AROUND, mode="reflect")
        around = OVER_USUAL * usual[tested.first]
        limit = np.maximum(np.maximum(LEAST, OVER_NEIGHBOURS * tested.beside), around) * tested.uncertainty
        ratio = np.minimum(tested.off[:, 0], tested.off[:, -1]) / limit
        found: dict[int, float] = {}
        free = np.ones(len(points), bool)
        for row in sorted(np.flatnonzero(ratio > 1.0), key=lambda row: -ratio[row]):
            first, off = int(tested.first[row]), tested.off[row]
            far = np.flatnonzero(off > limit[row])
            if np.all(free[first : first + size]) and (far.size <= 2 or min(off[0], off[-1]) > LEAP * off.max()):
                found.update({first + int(i): float(off[i]) for i in far})
                free[max(0, first - 2 * BESIDE) : first + size + 2 * BESIDE] = False
        if found:
            return found
    return {}


@dataclass(frozen=True)
class Tested:
    """Groups of equal size: index of the first point, distances `off` (groups, size) from the curve [mm].

    `beside` [mm]: standard deviation of the neighbours from the curve. `uncertainty`: error of the curve at the group
    over that of the neighbours, at least 1; it is above 1 near the ends and if neighbours lie close together.
    """

    first: NDArray[np.int64]
    off: Points
    beside: Points
    uncertainty: Points


def _test(points: Points, size: int) -> Tested | None:
    """Return all groups with as many points beyond each end, or None if the contour has too few points."""
    count = len(points)
    if count < size + 2 * BESIDE:
        return None
    beyond = max(size, BEYOND)
    first = np.arange(beyond, count - size - beyond + 1)
    blocks = [_test_block(points, size, some) for some in np.array_split(first, -(-len(first) // BLOCK))]
    off, beside, uncertainty = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
    return Tested(first, off, beside, uncertainty)


def _test_block(points: Points, size: int, first: NDArray[np.int64]) -> tuple[Points, Points, Points]:
    """Return `off`, `beside` and `uncertainty` of the groups that begin at `first`."""
    begin = np.clip(first - BESIDE, 0, len(points) - size - 2 * BESIDE)[:, None] + np.arange(2 * BESIDE)
    before = begin < first[:, None]
    near, group = points[np.where(before, begin, begin + size)], points[first[:, None] + np.arange(size)]
    share = before / before.sum(axis=1, keepdims=True), ~before / (~before).sum(axis=1, keepdims=True)
    start, end = (np.einsum("gn,gnk->gk", one, near) for one in share)
    length = np.hypot(*(end - start).T)
    y, z = (end - start).T / np.where(length > 0.0, length, np.nan)
    turn = np.stack([np.stack([y, -z], -1), np.stack([z, y], -1)], -2)
    middle = near.mean(axis=1, keepdims=True)
    (u, v), (own_u, own_v) = (np.moveaxis((one - middle) @ turn, -1, 0) for one in (near, group))
    tested = np.isfinite(length) & (length > 0.0)
    scale = np.where(tested, np.max(np.abs(u), axis=1), 1.0)[:, None, None]
    powers = np.arange(DEGREE + 1)
    at, of_group = (np.where(tested[:, None, None], one[..., None] / scale, 0.0) ** powers for one in (u, own_u))
    normal = np.swapaxes(at, 1, 2) @ at + RIDGE * np.eye(DEGREE + 1)
    weights = of_group @ np.linalg.solve(normal, np.swapaxes(at, 1, 2))
    heights = np.where(tested[:, None], v, 0.0)[..., None]
    residual = heights - at @ np.linalg.solve(normal, np.swapaxes(at, 1, 2) @ heights)
    beside = np.sqrt(np.sum(residual**2, axis=(1, 2)) / (2 * BESIDE - DEGREE - 1))
    off = np.abs(np.where(tested[:, None], own_v, 0.0) - (weights @ heights)[..., 0])
    return off, beside, np.maximum(1.0, np.linalg.norm(weights, axis=2).max(axis=1))
