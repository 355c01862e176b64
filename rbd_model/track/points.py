"""Points in their order along a track. Those of a receiver turn back by noise, mostly where it stands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from readers.import_account import Account

Numbers = NDArray[np.float64]
#: Fewest points. Points closer than this are one point [m].
FEWEST, SAME = 8, 1e-3
#: Receivers that stand: SEVERAL and more points within a radius of their mean [m] are one.
SEVERAL, RADIUS = 4, 20.0
#: Distance of neighbours that are averaged where a receiver turns back [m], share of points that may be jumps.
NEIGHBOURS, MOST_JUMPS = 40.0, 0.01


@dataclass(frozen=True, eq=False)
class Points:
    """Points in their order along the track.

    Attributes
    ----------
    source : str
        Name of the file. Messages state it.
    plan : array, shape (n, 2)
        East and north [m]. The first point is 0.
    height : array, shape (n,), optional
        Height [m].
    places : array of int, shape (n,)
        Row of each point in its file. `word` states what else they count.
    account : Account
        Use of the input.
    rough : bool
        Whether noise is of metres. Maps and receivers have it.
    recorded : bool
        Whether points far beside the line are left out.
    stretches : list
        First and last place, rise per metre and limit of speed [m/s] of a map. None: it is not stated.
    word : str
        What a place counts.
    """

    source: str
    plan: Numbers
    height: Numbers | None
    places: NDArray[np.int64]
    account: Account
    rough: bool = False
    recorded: bool = False
    stretches: Sequence[tuple[int, int, float | None, float | None]] = ()
    word: str = "row"

    def kept(self, keep: NDArray[np.bool_]) -> Points:
        """Return some of the points."""
        height = None if self.height is None else self.height[keep]
        return replace(self, plan=self.plan[keep], height=height, places=self.places[keep])


def ways_of(points: Points) -> Numbers:
    """Return the distances of points that follow each other [m]."""
    return np.asarray(np.hypot(*np.diff(points.plan, axis=0).T))


def forwards(points: Points, error: type[ValueError]) -> Points:
    """Return points that do not turn back. Those of receivers do so where it stands, and are joined there."""
    count, jumps, back = points.places.size, 0, _turns_back(points)
    group = np.column_stack([np.ones(count), np.zeros(count)])
    if back.size and points.recorded:
        points, group = _at_rest(points)
        back = _turns_back(points)
    before = 0
    while back.size and points.recorded and points.places.size != before and jumps <= MOST_JUMPS * count:
        before = points.places.size
        points, group, left = _joined(points, group, back)
        back, jumps = _turns_back(points), jumps + left
    if back.size:
        raise _refusal(points, back, error)
    if jumps:
        points.account.assumed.append(f"points that jump by more than {NEIGHBOURS:g} m and back are left out: {jumps}")
    if joined := count - jumps - points.places.size:
        points.account.converted.append(f"{joined} of {count} points turn back and are averaged with those beside them")
    if points.places.size < FEWEST:
        limit = f"{FEWEST} points along a line"
        raise error(f"{points.source} must have {limit}; got {points.places.size}. Check the file.")
    return points


def _at_rest(points: Points) -> tuple[Points, Numbers]:
    """Return points of which SEVERAL and more within RADIUS of their mean are one, with weight and spread of each."""
    rows = _rows(points)
    found, first, group, begin = [], [], [], 0
    total = rows[0].copy()
    for at in range(1, len(rows) + 1):
        count = at - begin
        if at < len(rows) and np.hypot(*(rows[at] - total / count)[:2]) < RADIUS:
            total += rows[at]
            continue
        alone = count < SEVERAL
        found += list(rows[begin:at]) if alone else [total / count]
        first += list(range(begin, at)) if alone else [begin]
        group += [(1.0, 0.0)] * count if alone else [(float(count), 0.0)]
        if at < len(rows):
            begin, total = at, rows[at].copy()
    return _moved(points, np.array(found), np.array(first)), np.array(group)


def _joined(points: Points, group: Numbers, back: NDArray[np.int64]) -> tuple[Points, Numbers, int]:
    """Return points of which those that turn back are averaged with their nearer neighbour, and the number of jumps.

    A jump is farther than NEIGHBOURS from both neighbours, which follow each other without it. It is left out. Points
    that are spread by more than twice that are not joined: there the vehicle turns back, not the noise.
    """
    rows, group, ways = _rows(points), group.copy(), ways_of(points)
    keep, last, jumps = np.ones(len(rows), bool), -1, 0
    for at in back.tolist():
        near = at - 1 if ways[at - 1] <= ways[at] else at + 1
        if min(at, near) <= last:
            continue
        last = max(at, near)
        way, spread = min(ways[at - 1], ways[at]), group[at, 1] + group[near, 1]
        before, over = rows[at - 1] - rows[max(at - 2, 0)], rows[at + 1] - rows[at - 1]
        if way < NEIGHBOURS and way + spread < 2.0 * NEIGHBOURS:
            keep[at] = False
            rows[near] += (rows[at] - rows[near]) * group[at, 0] / (group[at, 0] + group[near, 0])
            group[near] = group[at, 0] + group[near, 0], way + spread
        elif way >= NEIGHBOURS and before[:2] @ over[:2] >= 0.0:
            keep[at] = False
            jumps += 1
    return _moved(points, rows[keep], np.flatnonzero(keep)), group[keep], jumps


def _rows(points: Points) -> Numbers:
    """Return plan and, if known, height in columns."""
    return np.column_stack([points.plan] if points.height is None else [points.plan, points.height])


def _moved(points: Points, rows: Numbers, first: NDArray[np.int64]) -> Points:
    """Return points at other places; first: number of each among those before."""
    height = None if points.height is None else rows[:, 2]
    return replace(points, plan=rows[:, :2], height=height, places=points.places[first])


def _turns_back(points: Points) -> NDArray[np.int64]:
    """Return the points at which the course turns by 90 degrees and more, or rests."""
    steps = np.diff(points.plan, axis=0)
    return np.flatnonzero(np.sum(steps[1:] * steps[:-1], axis=1) <= 0.0) + 1


def _refusal(points: Points, back: NDArray[np.int64], error: type[ValueError]) -> ValueError:
    """Return the error for points that turn back."""
    row, steps = int(back[0]), np.diff(points.plan, axis=0)
    before, after = np.hypot(*steps[row - 1]), np.hypot(*steps[row])
    cosine = steps[row - 1] @ steps[row] / (before * after) if before * after > SAME**2 else -1.0
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    place = f"{points.source}, {points.word} {points.places[row]}"
    return error(
        f"{place}: points must follow the line; got a turn by {angle:.0f} degrees between {before:.4g} m before and "
        f"{after:.4g} m after. Sort the points, or leave out some that are closer than their noise."
    )
