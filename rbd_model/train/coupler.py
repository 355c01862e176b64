"""Couplers between vehicles: curves of loading and unloading, with dry friction between them that sticks.

While it moves, a coupler's force rises along the curve of loading and falls along that of unloading. Between them
friction sticks, and the coupler has the stiffness of its steel, the sticking stiffness. This is a play operator with
bounds that depend on the travel (Q. Wu, M. Spiryagin, C. Cole: Longitudinal train dynamics: an overview, Vehicle
System Dynamics 54 (2016), on draft gear models). It does not depend on speed: a coupler at rest keeps its force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.variables import Field

#: Largest number of points of a curve, including the one that a preload adds, and that of curves with few points. A
#: train whose curves all have few points computes these alone.
POINTS, FEW_POINTS = 20, 6
#: Curves in the order of the C code.
CURVES = ("tension_loading", "tension_unloading", "compression_loading", "compression_unloading")
_TEXT = "a number of a coupler"
#: Constants of a coupler: sticking stiffness, whether it is coupled, and for each curve travels and changes of slope
#: there.
COUPLER = (
    Field("sticking_stiffness", "N/m", -1e15, 1e15, _TEXT),
    Field("coupling_closed", "1", -1e15, 1e15, _TEXT),
    *(
        Field(f"{curve}_{what}_{point}", unit, -1e15, 1e15, _TEXT)
        for curve in CURVES
        for what, unit in (("way", "m"), ("slope", "N/m"))
        for point in range(1, POINTS + 1)
    ),
)


@dataclass(frozen=True)
class Curve:
    """Force [N] over the travel, linear between the points; beyond the last one see `Coupler`.

    `ways` are in m. The first point has travel 0; a force there is a preload.
    """

    ways: tuple[float, ...]
    forces: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.ways) != len(self.forces) or not 2 <= len(self.ways) < POINTS or self.ways[0] != 0.0:
            raise ValueError(
                f"A coupler's curve must have 2 to {POINTS - 1} ways, the first 0 m, and as many forces; got"
                f" {list(self.ways)} and {list(self.forces)}. Correct its points."
            )
        if any(b <= a for a, b in pairwise(self.ways)) or any(b < a for a, b in pairwise(self.forces)):
            raise ValueError(
                f"Ways of a coupler's curve must rise and its forces never fall; got {self}. Sort its points."
            )
        if self.forces[0] < 0.0:
            raise ValueError(
                f"The preload of a coupler's curve must be at least 0 N; got {self.forces[0]:g} N. "
                "Correct its first force."
            )

    def bends(self, stiffness: float, stroke: float) -> list[tuple[float, float]]:
        """Return pairs of travel [m] and change of slope [N/m] there.

        A preload is reached at the sticking `stiffness` [N/m]. The last piece continues to the stroke [m], where that
        stiffness begins.
        """
        points = list(zip(self.ways, self.forces, strict=True))
        if points[0][1] > 0.0:
            points = [(0.0, 0.0), (points[0][1] / stiffness, points[0][1]), *points[1:]]
        if any(b <= a for (a, _), (b, _) in pairwise(points)):
            raise ValueError(
                f"A coupler's preload must be reached before {points[2][0]:g} m; at its sticking stiffness it is"
                f" reached at {points[1][0]:g} m. Increase the sticking stiffness."
            )
        slopes = [(fb - fa) / (b - a) for (a, fa), (b, fb) in pairwise(points)]
        if max(slopes) > stiffness * (1 + 1e-9):
            raise ValueError(
                "A coupler's sticking stiffness must be at least the steepest slope of its curves,"
                f" {max(slopes):g} N/m; got {stiffness:g} N/m. Increase it, or give flatter curves."
            )
        changes = [after - before for before, after in pairwise([0.0, *slopes, stiffness])]
        found = list(zip([*(way for way, _ in points[:-1]), stroke], changes, strict=True))
        return found + [(1.0, 0.0)] * (POINTS - len(found))


@dataclass(frozen=True)
class Coupler:
    """Both directions of a coupling between two vehicles, and its sticking stiffness [N/m]. Travels are its own.

    Each direction has a curve of loading and one of unloading. Both meet steel at one travel, the stroke: the larger of
    their last points. Up to there the other curve continues along its last piece. Steel has no friction. Unloading
    therefore lies below loading everywhere, and a closed cycle loses energy (Wu, Spiryagin and Cole (2016)).

    strength: tension above which it breaks [N].

    Raises
    ------
    ValueError
        If unloading lies above loading.
    """

    name: str
    sticking_stiffness: float
    tension: tuple[Curve, Curve]
    compression: tuple[Curve, Curve]
    strength: float = math.inf

    def __post_init__(self) -> None:
        for sense, (loading, unloading) in (("tension", self.tension), ("compression", self.compression)):
            both = self._bends(loading, unloading)
            for way in sorted({way for bends in both for way, _ in bends}):
                load, unload = (sum(change * max(way - at, 0.0) for at, change in bends) for bends in both)
                if unload > load * (1 + 1e-9):
                    raise ValueError(
                        f"A coupler's unloading force in {sense} must be at most that of loading, {load:g} N at {way:g}"
                        f" m; got {unload:g} N. Lower the curve of unloading."
                    )

    @property
    def dissipates(self) -> bool:
        """Whether friction slides: whether a loading curve with a force is flatter than the sticking stiffness.

        Otherwise unloading follows loading, whatever its own curve.
        """
        most = self.sticking_stiffness * (1 - 1e-9)
        for loading, _ in (self.tension, self.compression):
            points = list(zip(loading.ways, loading.forces, strict=True))
            if any(fb > 0.0 and fb - fa < most * (b - a) for (a, fa), (b, fb) in pairwise(points)):
                return True
        return False

    def bends(self, sense: str) -> list[list[tuple[float, float]]]:
        """Return travels [m] and changes of slope there [N/m] of loading and unloading; sense: tension, compression."""
        return self._bends(*(self.tension if sense == "tension" else self.compression))

    def _bends(self, *curves: Curve) -> list[list[tuple[float, float]]]:
        """Return the bends of loading and unloading, which have one stroke."""
        stroke = max(curve.ways[-1] for curve in curves)
        return [curve.bends(self.sticking_stiffness, stroke) for curve in curves]

    def constants(self) -> list[float]:
        """Return the numbers of COUPLER."""
        rows = [self.sticking_stiffness, 1.0]
        for bends in (*self._bends(*self.tension), *self._bends(*self.compression)):
            ways, changes = zip(*bends, strict=True)
            rows += [*ways, *changes]
        return rows

    def values(self) -> dict[str, float]:
        """Return the numbers of COUPLER by name."""
        return dict(zip((one.name for one in COUPLER), self.constants(), strict=True))


def _scaled(curve: Curve, share: float) -> Curve:
    return Curve(curve.ways, tuple(share * force for force in curve.forces))


def screw_coupler() -> Coupler:
    """Return a screw coupler with side buffers of 105 mm (UIC 526-1), two in parallel and two in series.

    Assumed: the middle of the forces that are known of buffers of categories A and B, 30 kN at rest, 80 at 25 mm, 250
    at 60, 675 at 105. Friction takes half of the energy (required: at least 0.42). The draw gear has 20 kN at rest and
    400 kN at 60 mm. The stiffness is 50 MN/m while the friction holds.
    """
    compression = Curve((0.0, 0.05, 0.12, 0.21), (60e3, 160e3, 500e3, 1350e3))
    tension = Curve((0.0, 0.12), (20e3, 400e3))
    return Coupler("screw", 50e6, (tension, _scaled(tension, 0.5)), (compression, _scaled(compression, 0.5)))


def draft_gear() -> Coupler:
    """Return an automatic coupler with friction draft gear and slack (kind: Wu, Spiryagin and Cole (2016)).

    The curves are those of a freight car that GE Research published in code.

    Loading 0 N up to 11.9 mm, 120 kN at 18.8, 681 at 49.5, 1352 at 125.5. Unloading 120 kN at 18.8, 284 at 119.4. The
    stiffness is 198 MN/m while the friction holds.
    """
    loading = Curve((0.0, 11.9e-3, 18.8e-3, 49.5e-3, 125.5e-3), (0.0, 0.0, 120e3, 681e3, 1352e3))
    unloading = Curve((0.0, 11.9e-3, 18.8e-3, 119.4e-3), (0.0, 0.0, 120e3, 284e3))
    return Coupler("draft-gear", 198e6, (loading, unloading), (loading, unloading))


def rigid(stiffness: float = 1e9) -> Coupler:
    """Return a bar: one stiffness [N/m] in tension and compression, no friction (Hooke (1678))."""
    bar = Curve((0.0, 1.0), (0.0, stiffness))
    return Coupler("rigid", stiffness, (bar, bar), (bar, bar))


#: Force at which the travel of a coupler with one stiffness ends, and steel begins [N]. Assumed.
STEEL = 5e6


def _straight(stiffness: float, preload: float, slack: float, sticking_stiffness: float) -> Curve:
    """Return a curve of one stiffness [N/m] after a slack [m] and a preload [N]; it ends at STEEL more."""
    begins = slack + preload / sticking_stiffness
    points = [(0.0, 0.0), (slack, 0.0), (begins, preload), (begins + STEEL / stiffness, preload + STEEL)]
    points = [point for n, point in enumerate(points) if n == 0 or point[0] > points[n - 1][0]]
    return Curve(*zip(*points, strict=True))


def _slackened(curve: Curve, slack: float, sticking_stiffness: float) -> Curve:
    """Return a curve with another travel [m] before its force begins."""
    points = list(zip(curve.ways, curve.forces, strict=True))
    while points[1][1] == 0.0:  # its own slack
        points.pop(0)
    (first, preload), *rest = points
    rest = [(slack + way - first, force) for way, force in rest]
    if slack == 0.0:
        return Curve(*zip((0.0, preload), *rest, strict=True))
    begins = [(slack, 0.0)] + ([(slack + preload / sticking_stiffness, preload)] if preload > 0.0 else [])
    return Curve(*zip((0.0, 0.0), *begins, *rest, strict=True))


def with_numbers(
    coupler: Coupler,
    stiffness: float | None = None,
    preload: float = 0.0,
    slack: float | None = None,
    damping: float | None = None,
    strength: float = math.inf,
) -> Coupler:
    """Return a coupler with numbers of its own in both directions, and those of a built-in one where not given.

    Takes stiffness [N/m], preload [N], slack [m], strength [N].
    """
    sticking = coupler.sticking_stiffness if stiffness is None else max(coupler.sticking_stiffness, stiffness)
    tension, compression = coupler.tension, coupler.compression
    touches = compression[0].forces[0] > 0.0
    if stiffness is not None:
        plain = _straight(stiffness, preload, slack or 0.0, sticking)
        tension = compression = plain, _scaled(plain, 0.5)
    elif slack is not None:
        tension = _slackened(tension[0], slack, sticking), _slackened(tension[1], slack, sticking)
        if not touches:
            compression = _slackened(compression[0], slack, sticking), _slackened(compression[1], slack, sticking)
    if damping is not None:
        tension = tension[0], _scaled(tension[0], 1.0 - damping)
        compression = compression[0], _scaled(compression[0], 1.0 - damping)
    found = replace(coupler, sticking_stiffness=sticking, tension=tension, compression=compression)
    return replace(found, strength=strength)


#: Couplers by their names in consists.
COUPLERS = {"screw": screw_coupler, "draft-gear": draft_gear, "rigid": rigid}


def coupling() -> ca.Function:
    """Return the function for a coupler's force [N] and new unloaded place.

    Arguments: the places of two vehicles, the place at which the force of the sticking stiffness is zero, and the
    constants. Tension is above 0. Play operator with bounds: F = min(max(K (s - z), lower(s)), upper(s)),
    z = s - F / K (Wu, Spiryagin and Cole (2016)).
    """
    return _coupling("coupling", POINTS)


def coupling_of_few() -> ca.Function:
    """Return `coupling` for curves of at most FEW_POINTS points (Wu, Spiryagin and Cole (2016))."""
    return _coupling("coupling_of_few", FEW_POINTS)


def _coupling(name: str, points: int) -> ca.Function:
    """Return the function of couplings, with the first points of each curve."""

    def curve(way: ca.SX, bends: ca.SX) -> ca.SX:
        ways, changes = bends[:points], bends[POINTS : POINTS + points]
        return ca.dot(changes, ca.fmax(way - ways, 0))

    ahead, behind, rest = (ca.SX.sym(name) for name in ("ahead", "behind", "rest"))
    given = ca.SX.sym("given", len(COUPLER))
    stiffness, coupled = given[0], given[1]
    size = 2 * POINTS
    loads, unloads, presses, eases = (given[2 + n * size : 2 + (n + 1) * size] for n in range(len(CURVES)))
    way = ahead - behind
    upper = coupled * curve(way, loads) - curve(-way, eases)
    lower = coupled * curve(way, unloads) - curve(-way, presses)
    force = ca.fmin(ca.fmax(stiffness * (way - rest), lower), upper)
    return function_of(name, [ahead, behind, rest, given], ca.vertcat(force, way - force / stiffness))


def fastest(couplers: Sequence[Coupler], masses: Sequence[float]) -> float:
    """Return an upper bound of the angular frequency [1/s] of a chain with all couplers sticking.

    Circles of Gershgorin (1931).

    An explicit step is stable up to 2 over it, as central differences are (Hairer, Lubich and Wanner, Geometric
    Numerical Integration, section I.1).
    """
    stiff = [0.0, *(coupler.sticking_stiffness for coupler in couplers), 0.0]
    return float(max(2 * (stiff[n] + stiff[n + 1]) / mass for n, mass in enumerate(masses)) ** 0.5)
