"""The route over drawn ways: that of the map if it has no branches, or the shortest one over named ways."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from readers.formats.line_tracks import BACKWARDS, LISTED
from readers.formats.ways import DIGITS, JOINED, Course, Numbers, Way, along, check_size, on_sphere, without_repetitions
from readers.import_account import Account
from readers.text import FileError, shown

#: Part of a way between junctions: index of the way, first and last point. A step along it, forwards or not.
Part = tuple[int, int, int]
Step = tuple[int, bool]
#: A route: length of its parts that are not named [m], steps, messages about gaps.
Route = tuple[float, list[Step], list[str]]
#: Ends that are compared with each end: itself and the nearest other one.
NEAR = 2
#: Largest gap [m] before a named way. Cosine of the largest turn at a junction: no vehicle turns back at a switch.
BRIDGED, LEAST_COSINE = 100.0, 0.0
#: Times that the length of sidings and crossovers counts in a route.
SERVICE = 5.0


def course_of(ways: Sequence[Way], asked: Sequence[str], source: str, account: Account) -> Course:
    """Return the route over drawn ways: that of the file if it is one line, or the shortest one over named ways."""
    check_size(ways, source)
    ways = [cleaned for way in ways if len((cleaned := without_repetitions(way)).places) > 1]
    net = Net(ways, source)
    steps, gaps = net.named(asked) if asked else (net.whole(), [])
    account.assumed += gaps
    names = [f"{one}{BACKWARDS if back else ''}" for one, back in net.ways_of(steps)]
    more = f" and {len(names) - LISTED} more" if len(names) > LISTED else ""
    account.taken.append(f"ways {', '.join(shown(one) for one in names[:LISTED])}{more}: latitude, longitude")
    runs = []
    for part, forwards in steps:
        number, first, last = net.parts[part]
        runs.append((ways[number].places[first : last + 1], ways[number].tags, not forwards))
    return along(runs, source, False, account)


class Net:
    """Ways cut at their junctions, and the steps that follow each step."""

    def __init__(self, ways: Sequence[Way], source: str) -> None:
        self.ways, self.source = ways, source
        self._spots = [on_sphere(way.places) for way in ways]
        labels = _labels(ways)
        shared = Counter(label for one in labels for label in one)
        self.parts: list[Part] = []
        self.leaving: dict[int, list[Step]] = defaultdict(list)
        self._ends: list[tuple[int, int]] = []
        for number, one in enumerate(labels):
            cuts = [at for at, label in enumerate(one) if at in (0, len(one) - 1) or shared[label] > 1]
            for first, last in pairwise(cuts):
                self.leaving[one[first]].append((len(self.parts), True))
                self.leaving[one[last]].append((len(self.parts), False))
                self._ends.append((one[first], one[last]))
                self.parts.append((number, first, last))

    def behind(self, step: Step) -> int:
        """Return the junction at the end of a step."""
        return self._ends[step[0]][step[1]]

    def points(self, step: Step) -> Numbers:
        """Return the points of a step on a sphere, in its direction."""
        number, first, last = self.parts[step[0]]
        found = self._spots[number][first : last + 1]
        return found if step[1] else found[::-1]

    def turns_back(self, one: Step, other: Step) -> bool:
        """Return whether a step turns back into another one."""
        (*_, before, here), (there, after, *_) = self.points(one), self.points(other)
        return float((here - before) @ (after - there)) <= LEAST_COSINE

    def after(self, step: Step) -> Iterable[Step]:
        """Return the steps that may follow."""
        return (one for one in self.leaving[self.behind(step)] if one[0] != step[0] and not self.turns_back(step, one))

    def ways_of(self, steps: Sequence[Step]) -> list[tuple[str, bool]]:
        """Return the name of each way of a route, and whether it is run backwards."""
        found = [(self.ways[self.parts[part][0]].name, not forwards) for part, forwards in steps]
        return [one for number, one in enumerate(found) if not number or found[number - 1] != one]

    def whole(self) -> list[Step]:
        """Return all steps as one line. Raises FileError if they are not one."""
        free = [steps[0] for steps in self.leaving.values() if len(steps) == 1]
        meeting = next((steps for steps in self.leaving.values() if len(steps) > 2), None)
        if meeting:
            raise FileError(
                f"{self.source}: the ways must be one line without branches; {len(meeting)} meet at "
                f"{self._place(meeting[0])}: {self._list(meeting)}. Name the first and the last way of the route, as "
                "--tracks FIRST LAST, or others between; the shortest route is used."
            )
        route = [min(free, key=lambda step: (step[0], not step[1]), default=(0, True))]
        while len(route) <= len(self.parts):
            following = [one for one in self.leaving[self.behind(route[-1])] if one[0] != route[-1][0]]
            if not following or following[0] == route[0]:
                break
            route.append(following[0])
        if len(route) < len(self.parts):
            raise self._gap(free)
        return route

    def _gap(self, free: Sequence[Step]) -> FileError:
        """Return the error for lines that do not join, with the smallest gap between ends of two of them."""
        ends = np.array([self.points(one)[0] for one in free]).reshape(-1, 3)
        reached = [self._reached(one) for one in free]
        ways = np.linalg.norm(ends[:, None] - ends, axis=2) + np.where(np.equal.outer(reached, reached), np.inf, 0.0)
        if not np.any(np.isfinite(ways)):
            tells = "it has closed loops beside the line"
        else:
            one, other = divmod(int(np.argmin(ways)), len(free))
            gap, pair = f"{ways[one, other]:.4g} m", self._list([free[one], free[other]])
            tells = f"it has {len(free) // 2} lines, the nearest ends {gap} apart at {self._place(free[one])}: {pair}"
        return FileError(
            f"{self.source}: the ways must join end to end; {tells}. Add the missing way, or name the first and the "
            f"last way of the route, as --tracks FIRST LAST: gaps between named ways may have {BRIDGED:g} m."
        )

    def _reached(self, step: Step) -> int:
        """Return the lowest of the two end parts of the line that begins with a step."""
        first = step[0]
        while following := [one for one in self.leaving[self.behind(step)] if one[0] != step[0]]:
            step = following[0]
        return min(first, step[0])

    def _place(self, step: Step) -> str:
        number, first, last = self.parts[step[0]]
        latitude, longitude, _ = self.ways[number].places[first if step[1] else last]
        return f"latitude {latitude:.6f}, longitude {longitude:.6f}"

    def _list(self, steps: Iterable[Step]) -> str:
        return ", ".join(dict.fromkeys(str(self.ways[self.parts[part][0]]) for part, _ in steps))

    def named(self, asked: Sequence[str]) -> tuple[list[Step], list[str]]:
        """Return the shortest route over whole named ways, and messages about its gaps. Raises FileError."""
        routes: list[Route] = [(0.0, [], [])]
        for name in asked:
            routes = [best for way in self._runs(name) if (best := self._joined(routes, way))]
            if not routes:
                raise FileError(f"{self.source}: no way leads on to {shown(name)} without turning back. Name others.")
        _, steps, gaps = min(routes, key=lambda one: one[0])
        return steps, gaps

    def _runs(self, name: str) -> list[list[Step]]:
        """Return the steps over a whole way, in both directions or in the one asked for."""
        numbers = {way.name: number for number, way in enumerate(self.ways)}
        back = name not in numbers and name.endswith(BACKWARDS)
        own = name.removesuffix(BACKWARDS) if back else name
        if own not in numbers:
            more = f" and {len(self.ways) - LISTED} more" if len(self.ways) > LISTED else ""
            names = ", ".join(str(way) for way in self.ways[:LISTED])
            raise FileError(f"{self.source} must have the way {shown(own)}; it has {names}{more}. Name one of these.")
        parts = [part for part, (number, *_) in enumerate(self.parts) if number == numbers[own]]
        return [[(part, False) for part in reversed(parts)]] + ([] if back else [[(part, True) for part in parts]])

    def _joined(self, routes: Sequence[Route], way: list[Step]) -> Route | None:
        """Return the shortest of the routes continued to the end of a way; None if none leads there."""
        found = []
        for cost, steps, gaps in routes:
            if not steps:
                # a single way is run as drawn
                found.append((0.0 if way[0][1] else 1e-9, way, gaps))
            elif (between := self._between(steps[-1], way[0])) is not None:
                found.append((cost + between[0], [*steps, *between[1], *way], gaps))
            elif (gap := self._open(steps[-1], way[0])) is not None:
                found.append((cost + gap, [*steps, *way], [*gaps, f"a gap of {gap:.3g} m at {self._place(way[0])}"]))
        return min(found, key=lambda one: one[0], default=None)

    def _open(self, one: Step, other: Step) -> float | None:
        """Return the gap before a step [m], None if it is too wide or turns back."""
        here, there = self.points(one)[-1], self.points(other)[0]
        gap = float(np.linalg.norm(there - here))
        return None if gap > BRIDGED or self.turns_back(one, other) else gap

    def _cost(self, step: Step) -> float:
        """Return the length of a step [m], times SERVICE on sidings and crossovers."""
        length = float(np.sum(np.linalg.norm(np.diff(self.points(step), axis=0), axis=1)))
        return length * (SERVICE if "service" in self.ways[self.parts[step[0]][0]].tags else 1.0)

    @cached_property
    def _turns(self) -> Any:
        """Cost of each step behind each one that it may follow [m]; a step has the number 2 part + direction."""
        steps = [(part, forwards) for part in range(len(self.parts)) for forwards in (False, True)]
        turns = [(at, 2 * part + forwards) for at, step in enumerate(steps) for part, forwards in self.after(step)]
        before, after = np.array(turns, int).reshape(-1, 2).T
        costs = np.array([self._cost(step) for step in steps])
        return csr_array((costs[after], (before, after)), (len(steps), len(steps)))

    def _between(self, begin: Step, goal: Step) -> tuple[float, list[Step]] | None:
        """Return length [m] and steps of the shortest way from the end of a step to another one."""
        first, (part, forwards) = 2 * begin[0] + begin[1], goal
        costs, before = dijkstra(self._turns, indices=first, return_predecessors=True)
        ends = [2 * part + (not forwards) for part, forwards in self.after((part, not forwards))]
        last = min(ends, key=costs.__getitem__, default=None)
        if last is None or not np.isfinite(costs[last]):
            return None
        cost, route = float(costs[last]), []
        while last != first:
            route.append((last // 2, bool(last % 2)))
            last = int(before[last])
        return cost, route[::-1]


def _labels(ways: Sequence[Way]) -> list[list[int]]:
    """Return a number for each place: points of equal degrees are one, and ends that are closer than JOINED."""
    sizes = np.cumsum([len(way.places) for way in ways])
    everywhere = np.concatenate([way.places for way in ways])
    _, labels = np.unique(np.round(everywhere[:, :2], DIGITS), axis=0, return_inverse=True)
    labels = labels.reshape(-1)
    ends = np.union1d(np.append(0, sizes[:-1]), sizes - 1)
    ends = ends[np.unique(labels[ends], return_index=True)[1]]
    spots = on_sphere(everywhere[ends])
    _, near = cKDTree(spots).query(spots, k=NEAR, distance_upper_bound=JOINED)
    for one, other in zip(ends, near[:, 1], strict=True):
        if other < ends.size:
            labels[labels == labels[ends[other]]] = labels[one]
    return [part.tolist() for part in np.split(labels, sizes[:-1])]
