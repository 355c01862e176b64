"""How a part of a wheel bears on its rail over its offset: one stored energy for a contact of any shape.

Hertz' theory presumes one curvature over the whole contact. A measured or conformal pair has none: its profiles have
waves and joints of arcs within the contact. Here the gap of a part at an offset is replaced by the parabola that has
the same overlap as this gap over the breadth of the contact. With the depth d and the gap h(y) above the lowest point,

    F(d) = integral of (d - h)^2 over h < d,    F = 16/15 d_e^2.5 / B^0.5,    F' = 8/3 d_e^1.5 / B^0.5

define the effective depth d_e = 2.5 F / F' and the effective curvature B. A parabola keeps its own depth and curvature.
F is Winkler's energy of strips (Johnson 1985, section 4.3). It is smooth in the offset, also where the lowest point
jumps or two places bear. The parabola depends on the depth: each offset has two, at the APPROACHES of a light and of a
usual wheel load. The energy of the contact is that of Hertz' theory with this parabola, U = 0.4 K d^2.5, (3.82)-(3.88).
Between both approaches it passes from one to the other. Each has the energy and the force that result if the contact is
pressed from 0 to its approach, with the parabola of each depth.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, CubicSpline, PPoly

from rbd_model.contact.elastic import stiffness_of
from rbd_model.contact.profiles import Profile

#: Effective depths at which a parabola is fitted [m]: the approaches of a wheel of 0.46 m on a head of 0.3 m under 6
#: and 50 kN.
APPROACHES = 15e-6, 60e-6
#: Effective depths over which the force is integrated [m]; APPROACHES are among them.
DEPTHS = 5e-6, 10e-6, 15e-6, 25e-6, 40e-6, 60e-6
#: Least height of a ridge between two places that bear as two contacts [m]: half of the larger approach (assumed).
LEAST_RIDGE = 30e-6
#: Largest height above the lowest point at which a place can bear [m], and rounds of Newton's method for the depth.
DEEPEST, ROUNDS = 0.6e-3, 12
#: Least curvature of a rail's head over the breadth of a contact [1/m]; a flatter one is turned about a far point.
LEAST_BEND = 1.0
#: Least cosine of a contact angle: that of 85 degrees.
LEAST_COSINE = 0.087
#: Quantities of both tables of a `Bearing`, in the order of their cubics.
CUBIC = 4  # terms of each
AT_FIRST = ("centre_along", "centre_square", "slope", "place", "depth")
IN_CONTACT = ("height", "stiffness", "place", "depth", "curvature")  # for each of APPROACHES


@dataclass(frozen=True)
class PartContour:
    """A part of a wheel and its rail in axes along `direction` [rad], from the origin of each.

    `place` [m] are points of the wheel's profile, `along` and `square` [m] the same points in these axes, `depth` [m]
    their height in the profile. `rail` is in these axes. `radius` [m]: of the wheel at y = 0.
    """

    direction: float
    place: np.ndarray
    along: np.ndarray
    square: np.ndarray
    depth: np.ndarray
    rail: Profile
    radius: float


@dataclass(frozen=True)
class Overlap:
    """The overlap of a part with its rail at one offset, at one of APPROACHES.

    `height` [m]: effective distance of wheel and rail at rest. `stiffness` [m^0.5]: stored energy over E* d^2.5,
    where d is square to the axes of the part. `curvature` [1/m]: square to the contact, B of (3.83). `place` [m]:
    mean place on the wheel, weighted with the square of the overlap (Vollebregt 2020). `depth` [m]: height of the
    wheel's profile there. `tilt`, `bend` [1/m]: slope and curvature of the rail there.
    """

    height: float
    stiffness: float
    curvature: float
    place: float
    depth: float
    tilt: float
    bend: float


def overlaps_at(part: PartContour, offset: float) -> list[Overlap] | None:
    """Return the overlap at each of APPROACHES, at an offset of the wheel's y = 0 from the rail's [m], (3.77).

    None if the part is beside its rail.
    """
    gap = part.square - part.rail.height(part.along + offset)
    beside = np.isfinite(gap)
    if not np.any(beside):
        return None
    lowest = float(np.min(gap[beside]))
    near = np.flatnonzero(beside & (np.where(beside, gap, np.inf) < lowest + DEEPEST))
    slopes, bends = (part.rail.height(part.along[near] + offset, order) for order in (1, 2))
    rise, width = gap[near] - lowest, _widths(part.along)[near]
    rail = Near(part.direction, rise, width, part.place[near], part.depth[near], slopes, bends)
    found, energy, before, press = [], 0.0, 0.0, 0.0
    for approach in DEPTHS:
        parabola = rail.parabola(approach)
        force = parabola.force(part)
        deeper = energy > 0.0 and parabola.whole > before  # on a wall, all depths are DEEPEST
        power = math.log(force / press) / math.log(parabola.whole / before) if deeper else 1.5
        energy += (force * parabola.whole - press * before) / (power + 1)
        before, press = parabola.whole, force
        if approach in APPROACHES:
            deep = 2.5 * energy / force
            rest = parabola.curvature, parabola.place, parabola.depth, parabola.tilt, parabola.bend
            found.append(Overlap(lowest + before - deep, energy / deep**2.5, *rest))
    return found


@dataclass(frozen=True)
class Parabola:
    """The parabola of an overlap: `whole` and `effective` depth [m], `slope` of the rail, the rest as in `Overlap`."""

    whole: float
    effective: float
    slope: float
    curvature: float
    place: float
    depth: float
    tilt: float
    bend: float

    def force(self, part: PartContour) -> float:
        """Return the force square to the axes of the part over E* [m2]: Hertz, Johnson (1985), section 4.2."""
        upright = 1 / math.sqrt(1 + self.slope**2)
        leaning = max(math.cos(part.direction + math.atan(self.slope)), LEAST_COSINE)
        rolling = leaning / (2 * (part.radius - self.depth))
        stiffness = float(stiffness_of(np.array(rolling), np.array(self.curvature)))
        return stiffness * (self.effective * upright) ** 1.5 * upright


@dataclass(frozen=True)
class Near:
    """Points of a part near its rail: height above the lowest one, breadth, `place` and `depth` as in `Contour` [m];
    slope [1] and second derivative [1/m] of the rail there. `direction` [rad]: of the part.
    """

    direction: float
    rise: np.ndarray
    width: np.ndarray
    place: np.ndarray
    depth: np.ndarray
    slope: np.ndarray
    bend: np.ndarray

    def parabola(self, approach: float) -> Parabola:
        """Return the parabola with the overlap of this effective depth, normal to the contact [m]."""
        depth, slope = approach, 0.0
        for _ in range(ROUNDS):
            inside = np.maximum(depth - self.rise, 0.0)
            weights = inside * self.width
            half, energy = float(np.sum(weights)), float(inside @ weights)
            area = float(np.sum(self.width[inside > 0.0]))
            slope = float(weights @ self.slope) / half
            wanted = approach * math.sqrt(1 + slope**2)
            effective = 1.25 * energy / half  # 2.5 F / F', F' = 2 half
            change = 1.25 * (2.0 - energy * area / half**2)
            depth = min(max(depth + (wanted - effective) / max(change, 0.2), wanted / 2), DEEPEST)
            if abs(wanted - effective) < 1e-13:
                break
        upright = 1 / math.sqrt(1 + slope**2)
        curvature = (16 / 15 * effective**2.5 / energy) ** 2 * upright**3
        weights = inside * weights / energy
        means = (float(weights @ one) for one in (self.place, self.depth, self.slope, self.bend))
        place, height, tilt, bend = means
        # Along the slope, a gap h square to the axes belongs to a point h slope / (1 + slope^2) before.
        before = slope * upright**2 * (depth - 2 / 3 * float(weights @ inside))
        cosine, sine = math.cos(self.direction), math.sin(self.direction)
        place, height = place - before * (cosine - sine * slope), height - before * (sine + cosine * slope)
        return Parabola(depth, effective, slope, curvature, place, height, tilt, -bend * upright**3)


def _widths(along: np.ndarray) -> np.ndarray:
    """Return the breadth of each point [m]."""
    return np.gradient(along)


@dataclass(frozen=True)
class Bearing:
    """How a part bears over its offset: breakpoints and rows of cubics, packed one behind the other.

    `at_first` holds AT_FIRST. A roll about the centre of the rail's arc [m] leaves the rail unchanged. The slope of the
    contact is that against the wheel's axis. The place on the wheel has its height in the profile [m]. `in_contact`
    holds IN_CONTACT for each of APPROACHES, as an `Overlap` has them.
    """

    at_first: tuple[np.ndarray, np.ndarray]
    in_contact: tuple[np.ndarray, np.ndarray]


def rigid_lines(part: PartContour, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the least distance of rigid profiles at each offset and its place on the wheel [m], (3.77), (3.78).

    Beside the rail they are those of the last offset over it.
    """
    gaps = [part.square - part.rail.height(part.along + offset) for offset in offsets]
    known = np.array([bool(np.any(np.isfinite(gap))) for gap in gaps])
    lowest = [int(np.nanargmin(gap)) if over else 0 for gap, over in zip(gaps, known, strict=True)]
    places = np.where(known, part.place[lowest], -np.inf)
    if part.direction:
        # The contact moves from the root to the tip. Before, the back of the flange may lie over the turned rail.
        known[: int(np.argmax(places))] = False
    least = [gap[here] for gap, here in zip(gaps, lowest, strict=True)]
    return _filled(offsets, known, least), _filled(offsets, known, places)


def bearing_of(part: PartContour, offsets: np.ndarray) -> Bearing:
    """Return how a part bears (3.82)-(3.88).

    offsets [m]: equally spaced.
    """
    light, usual = _over(part, offsets)
    at_first = [_smoothed(offsets, value) for value in _centre(part, offsets, usual)]
    in_contact = [curve for found in (light, usual) for curve in _curves(offsets, found)]
    return Bearing(_packed(offsets, at_first), _packed(offsets, in_contact))


def _over(part: PartContour, offsets: np.ndarray) -> Iterator[dict[str, np.ndarray]]:
    """Yield each quantity of an `Overlap` at all offsets, for each of APPROACHES."""
    rows = [overlaps_at(part, float(offset)) for offset in offsets]
    known = np.array([row is not None for row in rows])
    if part.direction:
        known[: int(np.argmax(rigid_lines(part, offsets)[1]))] = False
    for which in range(len(APPROACHES)):
        own = [None if row is None else row[which] for row in rows]
        values = {name: [0.0 if one is None else getattr(one, name) for one in own] for name in Overlap.__annotations__}
        yield {name: _filled(offsets, known, value) for name, value in values.items()}


def _curves(offsets: np.ndarray, found: dict[str, np.ndarray]) -> list[PPoly]:
    """Return the curves of IN_CONTACT at one approach."""
    height, *rest = (found[name] for name in IN_CONTACT)
    return [CubicSpline(offsets, height), *(_smoothed(offsets, value) for value in rest)]


def _centre(part: PartContour, offsets: np.ndarray, found: dict[str, np.ndarray]) -> tuple[np.ndarray, ...]:
    """Return the quantities of AT_FIRST."""
    slope = -CubicSpline(offsets, found["height"])(offsets, 1)
    cosine, sine = math.cos(part.direction), math.sin(part.direction)
    level = (sine + cosine * slope) / (cosine - sine * slope)
    # The normal at the mean place passes through the centre of an arc. The slope of the distance has other weights.
    tilt, arc = found["tilt"], 1 / np.maximum(found["bend"], LEAST_BEND)
    straight = 1 / np.sqrt(1 + tilt**2)
    along = cosine * found["place"] + sine * found["depth"] + offsets
    square = cosine * found["depth"] - sine * found["place"] - found["height"]
    return along + arc * tilt * straight, square - arc * straight, level, found["place"], found["depth"]


def _filled(offsets: np.ndarray, known: np.ndarray, values: list[float] | np.ndarray) -> np.ndarray:
    """Return values with those beside the known offsets replaced by the nearest known ones."""
    return np.interp(offsets, offsets[known], np.array(values)[known])


def _smoothed(x: np.ndarray, y: np.ndarray) -> PPoly:
    """Return the cubic B-spline with these control points: twice differentiable, and never beyond the points."""
    step = x[1] - x[0]
    knots = x[0] + step * np.arange(-2, x.size + 2)
    spline = PPoly.from_spline(BSpline(knots, y, 3))
    keep = slice(3, -3)
    return PPoly(spline.c[:, keep], spline.x[3:-3])


def _packed(offsets: np.ndarray, curves: list[PPoly]) -> tuple[np.ndarray, np.ndarray]:
    """Return breakpoints and the coefficients of all curves in one row for each piece, lowest power first."""
    first, last = offsets[1], offsets[-2]
    places = offsets[1:-1]
    rows = []
    for curve in curves:
        pieces = np.searchsorted(curve.x, (places[:-1] + places[1:]) / 2) - 1
        assert np.allclose(curve.x[pieces], places[:-1], rtol=0.0, atol=1e-9 * (last - first))
        rows.append(curve.c[::-1, pieces].T)
    return places, np.hstack(rows)
