"""Normal force of a wheel on its rail where they overlap: several patches of any shape, strip by strip.

Each strip across the overlap carries a load q per metre of breadth. As in Hertz, it is spread along the strip over the
length 2 a, which is unknown too: Knothe and Le The (1984), Computers & Structures 18(6). It lowers, by Boussinesq's
solution, both surfaces, there and below all other strips. For strips in contact the sum equals the overlap of the
undeformed surfaces; elsewhere the load is 0. The method thus assumes neither shape nor number nor mutual influence of
the patches. The lengths follow from the loads: in an ellipse of Hertz with curvature A along it

    p = kappa A a G / (1 - nu),    q = pi / 2 p a,

with kappa a function of a/b alone (Johnson 1985, Contact Mechanics, section 4.2). Any patch takes the kappa of the
ellipse with its load, its A and its largest q, whose breadth is b = 3/4 N / q. No constant is fitted, and the contour's
curvature is not needed.

This is the exact theory except for the distribution along the strips. The virtual penetration of Kik and Piotrowski
(1996) is cheaper. So are the ellipses in each strip of Ayasse and Chollet (2005) or Sichani, Enblom and Berg (2014).
There the loads follow from the overlap of the same strip in closed form. On S1002 and UIC60 near the centre a patch has
a shoulder 8 mm long. There closed forms had errors of up to a third in load and 2 mm in place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ellipe, ellipkm1

from rbd_model.contact.distance import Stand, Strips, areas, strips_at
from rbd_model.contact.geometry import Pair

#: Replaces 0 in denominators.
TINY = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Steel:
    """Shear modulus [Pa] and Poisson's ratio of both bodies."""

    shear_modulus: float
    poisson_ratio: float

    @property
    def plane_modulus(self) -> float:
        """E* = G / (1 - nu) of two equal bodies [Pa], Johnson (1985), section 4.2."""
        return self.shear_modulus / (1 - self.poisson_ratio)


@dataclass(frozen=True)
class ContactArea:
    """One area of contact: its strips, their breadth, half length [m] and largest pressure [Pa].

    Strips at its ends may be idle, with half length and pressure 0. overlap [m4]: integral over each strip, in plan
    view, of the square of the height by which the undeformed surfaces overlap.
    """

    strips: Strips
    breadth: np.ndarray
    half_length: np.ndarray
    pressure: np.ndarray
    overlap: np.ndarray

    def of(self, which: np.ndarray) -> ContactArea:
        """Return some of its strips, where `which` is true."""
        rows = (self.breadth, self.half_length, self.pressure, self.overlap)
        return ContactArea(self.strips.part(which), *(row[which] for row in rows))

    @property
    def loads(self) -> np.ndarray:
        """Normal force of each strip [N], whose pressure is a half ellipse."""
        return np.pi / 2 * self.pressure * self.half_length * self.breadth

    @property
    def load(self) -> float:
        """Normal force [N]."""
        return float(np.sum(self.loads))

    def centre(self, values: np.ndarray) -> float:
        """Return the mean of a value by strips, weighted with the normal force."""
        return float(values @ self.loads / self.load)


#: Strips across each area of overlap; about two thirds of them touch. With 64 no load changes by more than 1 %.
STRIPS = 24
#: Number of rounds in which lengths follow loads and loads lengths; more rounds change no load by more than 1.1 %.
ROUNDS = 2
#: Share of the approach that gives a length to a strip without one by Hertz, in case it is loaded after all.
IDLE = 0.1
#: Overlap that is treated as 0 [m].
ROUND_OFF = 1e-14
#: Slenderest ellipse of the table, and its points.
SLENDEREST, TABLE_POINTS = 1e-3, 400


def patches(pair: Pair, stand: Stand, steel: Steel, apart: bool = False) -> list[ContactArea]:
    """Return all contacts of a wheel, from the flange outwards; Knothe (1984), see the module.

    apart: as if each area of overlap were alone.
    """
    found = areas(pair, stand)
    if not found:
        return []
    step = np.repeat([(last - first) / STRIPS for first, last in found], STRIPS)
    middles = (np.arange(STRIPS) + 0.5) / STRIPS
    strips = strips_at(pair, stand, np.concatenate([first + (last - first) * middles for first, last in found]))
    breadth, area = step * strips.stretch, np.repeat(np.arange(len(found)), STRIPS)
    felt = area[:, None] == area if apart else np.ones((area.size, area.size), dtype=bool)
    away = np.hypot(*(strips.arm[i][:, None] - strips.arm[i] for i in (1, 2)))
    # The mean of the logarithm over the breadth of a strip, in its middle.
    np.fill_diagonal(away, breadth / (2 * math.e))

    overlap = -strips.distance
    half_length = np.empty_like(overlap)
    for part in (slice(i * STRIPS, (i + 1) * STRIPS) for i in range(len(found))):
        half_length[part] = length_alone(overlap[part], breadth[part], strips.curvature[part])
    touch = overlap > 0.0
    for _ in range(ROUNDS):
        lowering = np.where(felt, breadth * lowering_of(away, half_length) / steel.plane_modulus, 0.0)
        line_load = line_loads(lowering, overlap, touch)
        touch = line_load > 0.0
        runs = _runs(touch, area)
        kappa = np.ones_like(overlap)
        for run in runs:
            kappa[run] = kappa_of(line_load[run], breadth[run], strips.curvature[run], steel)
        stiffness = kappa * strips.curvature * steel.plane_modulus
        # Strips that do not touch keep their length, in case they do in the next round.
        half_length = np.where(touch, np.sqrt(2 / np.pi * line_load / stiffness), half_length)

    cosine = np.cos(strips.angle)
    # The gap grows by A / cos x^2 along the strip.
    squared = 16 / 15 * np.maximum(-strips.gap, 0.0) ** 2.5 * np.sqrt(cosine / strips.curvature) * breadth * cosine
    half_length = np.where(touch, half_length, 0.0)
    return [
        ContactArea(strips.part(part), breadth[part], half_length[part], (stiffness * half_length)[part], squared[part])
        for part in _parts(runs, area)
    ]


def lowering_of(away: np.ndarray, half_length: np.ndarray) -> np.ndarray:
    """Return the lowering of both surfaces by 1 N on a strip beside it, times E* [1/m]; Johnson (1985), section 3.2.

    The load is spread along the strip as half an ellipse. At a large distance r it acts like a point force, 1 / (pi r).
    """
    ratio = (away / half_length) ** 2
    # With the complete elliptic integrals of m = 1 / (1 + ratio).
    integral = ellipkm1(ratio / (1 + ratio)) - ellipe(1 / (1 + ratio))
    return np.asarray(4 / np.pi**2 * np.sqrt(1 + ratio) * integral / half_length)


def line_loads(lowering: np.ndarray, overlap: np.ndarray, touch: np.ndarray) -> np.ndarray:
    """Return the loads of the strips [N/m], all at least 0, that lower the surfaces by their overlap, Knothe (1984).

    touch: the initial set of strips in contact. Strips with a pull are removed, and strips with a remaining overlap are
    added, until there are neither.
    """
    touch = touch.copy()
    for _ in range(2 * overlap.size):
        inside = np.flatnonzero(touch)
        line_load = np.zeros_like(overlap)
        line_load[inside] = np.linalg.solve(lowering[np.ix_(inside, inside)], overlap[inside])
        pulls = line_load < 0.0
        left = ~touch & (overlap - lowering @ line_load > 1e-6 * np.max(overlap))
        if np.any(pulls):
            touch &= ~pulls
        elif np.any(left):
            touch |= left
        else:
            break
    return np.maximum(line_load, 0.0)


def kappa_of(line_load: np.ndarray, breadth: np.ndarray, curvature: np.ndarray, steel: Steel) -> float:
    """Return kappa of the ellipse with the load, the curvature A and the largest q of a patch, Johnson (1985), 4.2.

    From N = 2/3 pi p a b and p = kappa A a E*: kappa (a/b)^2 = 3/2 N / (pi E* A b^3).
    """
    load = float(np.sum(line_load * breadth))
    along = float(np.sum(line_load * breadth * curvature)) / load
    across = 0.75 * load / float(np.max(line_load))
    table = ellipses()
    known = math.log(1.5 * load / (math.pi * steel.plane_modulus * along * across**3))
    return float(np.exp(np.interp(known, table.kappa + 2 * table.axis_ratio, table.kappa)))


def length_alone(overlap: np.ndarray, breadth: np.ndarray, curvature: np.ndarray) -> np.ndarray:
    """Return the initial half lengths [m] of an area's strips: Hertz's ellipse, Johnson (1985), section 4.2.

    With the approach d and the distance f = d - overlap, a^2 = (d - beta f) / (alpha A). Here d = beta B b^2, with the
    B for which d = B y^2 at the ends of the area.
    """
    deepest, half = max(float(np.max(overlap)), ROUND_OFF), float(np.sum(breadth)) / 2
    along = float(np.mean(curvature))
    table = ellipses()
    ratio = math.log(deepest / (half**2 * along))
    # Alpha across corresponds to beta along.
    alpha, beta = (math.exp(np.interp(x, table.curvature_ratio, table.alpha)) for x in (ratio, -ratio))
    square = np.maximum(deepest - beta * (deepest - overlap), IDLE * deepest)
    return np.asarray(np.sqrt(square / (alpha * along)))


@dataclass(frozen=True)
class Ellipses:
    """Logarithms of a/b, B/A, alpha = approach / (A a^2) and kappa for ellipses from the widest to the longest."""

    axis_ratio: np.ndarray
    curvature_ratio: np.ndarray
    alpha: np.ndarray
    kappa: np.ndarray


@lru_cache
def ellipses() -> Ellipses:
    """Return the quantities of Hertz's ellipse by its axis ratio, Johnson (1985), section 4.2.

    With g = minor / major axis, K, E and D = (K - E) / (1 - g^2) are complete elliptic integrals. Along the major axis
    the approach is K / D times curvature times semi-axis squared. The pressure is 1 / (g D) times E* times both. Along
    the minor axis the factors are K / (K - D) and 1 / (K - D).
    """
    g = np.exp(np.linspace(np.log(SLENDEREST), np.log(0.999), TABLE_POINTS))
    k, e = ellipkm1(g**2), ellipe(1 - g**2)
    d = (k - e) / (1 - g**2)
    larger = (k - d) / (g**2 * d)
    rows = ((g, 1 / g), (1 / larger, larger), (k / (k - d), k / d), (1 / (k - d), 1 / (g * d)))
    return Ellipses(*(np.log(np.concatenate([wide, long[::-1]])) for wide, long in rows))


def _runs(touch: np.ndarray, area: np.ndarray) -> list[slice]:
    """Return runs of neighbouring strips of the same area that touch."""
    places = np.flatnonzero(touch)
    breaks = np.flatnonzero((np.diff(places) > 1) | (np.diff(area[places]) > 0)) + 1
    return [slice(int(run[0]), int(run[-1]) + 1) for run in np.split(places, breaks) if run.size]


def _parts(runs: list[slice], area: np.ndarray) -> list[slice]:
    """Return each run with the idle strips of its area; neighbours share those between them at the middle."""
    parts = []
    for i, run in enumerate(runs):
        same = np.flatnonzero(area == area[run.start])
        first, last = int(same[0]), int(same[-1]) + 1
        if i > 0 and area[runs[i - 1].start] == area[run.start]:
            first = (runs[i - 1].stop + run.start) // 2
        if i + 1 < len(runs) and area[runs[i + 1].start] == area[run.start]:
            last = (run.stop + runs[i + 1].start) // 2
        parts.append(slice(first, last))
    return parts
