"""How hard a wheel presses on its rail where they overlap: several patches of any shape, strip by strip.

With the approach d and the curvatures A along and B across, Hertz's ellipse has a^2 = d / (alpha A), b^2 = d / (beta B)
and is, strip by strip at the undeformed distance f = B y^2 above its deepest place,

    a(y)^2 = (d - beta f(y)) / (alpha A),    p(y) = kappa A a(y) G / (1 - nu),

where alpha, beta, kappa depend on B/A alone (Johnson 1985, Contact Mechanics, section 4.2). A patch of any other shape
takes the same law with its true f, and for alpha, beta, kappa its mean curvature B: the mean of f / y^2 over the patch,
weighted with the overlap d - f, which needs no second derivative of a measured contour. Where f is a parabola this is
Hertz, exactly. The virtual penetration of Kik and Piotrowski (1996), with the shape of Piotrowski and Kik (2008), is the
same law with the constant 0.55 in the place of 1 / beta; that Hertz's own beta serves better was seen by Sichani, Enblom
and Berg (2014), ANALYN. No constant is fitted.

Patches feel each other: each lowers the surface under the others as a point force would (Boussinesq; Johnson 1985, eq.
3.22). Each valley of the distance is a patch of its own; where two overlap they end at the ridge between them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import ellipe, ellipkm1

from rbd_model.contact.distance import Stand, Strips, Valley, strips_at, valleys
from rbd_model.contact.geometry import Pair


@dataclass(frozen=True)
class Steel:
    """Shear modulus [Pa] and Poisson's ratio of both bodies."""

    shear_modulus: float
    poisson_ratio: float

    @property
    def plane_modulus(self) -> float:
        """E* = G / (1 - nu) of two equal bodies [Pa], Johnson (1985), eq. (4.23)."""
        return self.shear_modulus / (1 - self.poisson_ratio)


@dataclass(frozen=True)
class HertzTable:
    """alpha, beta, kappa by ln(B/A); rows of `values`."""

    logarithm: np.ndarray
    values: np.ndarray


#: Stands for 0 where something divides by it.
TINY = float(np.finfo(float).tiny)
#: Slenderest ellipse of the table and its points; ln(B/A) then goes to 14.
SLENDEREST, TABLE_POINTS = 1e-3, 400


@lru_cache
def hertz_table() -> HertzTable:
    """What Hertz's ellipse makes of the ratio B/A, Johnson (1985), section 4.2.

    With g = minor / major axis and K, E, D = (K - E) / (1 - g^2) complete elliptic integrals: approach over curvature
    times square of its semi-axis is K / D for the major and K / (K - D) for the minor axis.
    """
    g = np.exp(np.linspace(np.log(SLENDEREST), np.log(0.999), TABLE_POINTS))
    k, e = ellipkm1(g**2), ellipe(1 - g**2)
    d = (k - e) / (1 - g**2)
    ratio = np.log((k - d) / (g**2 * d))
    across = np.array([k / d, k / (k - d), 1 / (g * d)])  # A < B: the major axis lies along the rail
    along = np.array([k / (k - d), k / d, 1 / (k - d)])
    return HertzTable(np.concatenate([-ratio, ratio[::-1]]), np.concatenate([along, across[:, ::-1]], axis=1))


def hertz_factors(curvature_along: float, curvature_across: float) -> np.ndarray:
    """alpha, beta, kappa of the ellipse with the curvatures A, B [1/m], Johnson (1985), section 4.2.

    Beyond the ends of the table they stay, so that a B of 0 is a very long ellipse.
    """
    table = hertz_table()
    ratio = math.log(max(curvature_across, TINY) / curvature_along)
    return np.array([np.interp(ratio, table.logarithm, row) for row in table.values])


@dataclass(frozen=True)
class Patch:
    """One area of contact: its strips, their breadth, half length [m] and largest pressure [Pa]; the approach [m].

    overlap [m4]: integral over each strip, seen from above, of the square of the height by which the undeformed
    surfaces overlap; its centre is where Vollebregt (2020) places the contact.
    """

    strips: Strips
    breadth: np.ndarray
    half_length: np.ndarray
    pressure: np.ndarray
    approach: float
    overlap: np.ndarray

    @property
    def loads(self) -> np.ndarray:
        """Normal force of each strip [N], whose pressure is a half ellipse."""
        return np.pi / 2 * self.pressure * self.half_length * self.breadth

    @property
    def load(self) -> float:
        """Normal force [N]."""
        return float(np.sum(self.loads))

    def centre(self, values: np.ndarray) -> np.ndarray:
        """Mean of something known strip by strip, weighted with the normal force."""
        return np.asarray(values @ self.loads / self.load)


#: Strips to each side of the deepest place, up to where the undeformed surfaces meet; the contact has about two thirds.
STRIPS = 16
#: How often neighbours are told each other's loads. After two rounds no load changes by more than 1 % of the wheel's.
ROUNDS = 2


def patches(pair: Pair, stand: Stand, steel: Steel, rounds: int = ROUNDS) -> list[Patch]:
    """All contacts of a wheel, from the flange outwards; the law of this module, after Piotrowski (2008).

    rounds: 0 keeps patches apart, as if each were alone.
    """
    grounds = [_ground(pair, stand, valley) for valley in valleys(pair, stand)]
    found = [_pressed(ground, steel, np.zeros(2 * STRIPS + 1)) for ground in grounds]
    for _ in range(rounds if len(grounds) > 1 else 0):
        found = [_pressed(ground, steel, _lowered(ground, found, steel)) for ground in grounds]
    return [patch for patch in found if patch.load > 0.0]


@dataclass(frozen=True)
class _Ground:
    """Strips of a valley, the deepest place in front of them; breadths [m] of the strips."""

    strips: Strips
    breadth: np.ndarray

    @property
    def aside(self) -> np.ndarray:
        """From the deepest place to each strip [m]."""
        arm = self.strips.arm
        return np.hypot(arm[1, 1:] - arm[1, 0], arm[2, 1:] - arm[2, 0])


def _ground(pair: Pair, stand: Stand, valley: Valley) -> _Ground:
    middles = (np.arange(STRIPS) + 0.5) / STRIPS
    inner, outer = valley.deepest - valley.first, valley.last - valley.deepest
    on_wheel = [[valley.deepest], valley.deepest - inner * middles[::-1], valley.deepest + outer * middles]
    strips = strips_at(pair, stand, np.concatenate(on_wheel))
    return _Ground(strips, np.repeat([inner, outer], STRIPS) / STRIPS * strips.stretch[1:])


def _lowered(ground: _Ground, others: list[Patch], steel: Steel) -> np.ndarray:
    """How far the other patches lower both surfaces at the strips [m], Johnson (1985), eq. (3.22b) for two bodies."""
    lowered = np.zeros_like(ground.strips.gap)
    for other in others:
        if other.load > 0.0 and other.strips.on_wheel[0] != ground.strips.on_wheel[1]:
            away = np.hypot(*(ground.strips.arm[i] - other.centre(other.strips.arm[i]) for i in (1, 2)))
            lowered += other.load / (math.pi * steel.plane_modulus * away)
    return lowered


def _pressed(ground: _Ground, steel: Steel, lowered: np.ndarray) -> Patch:
    """Half length and pressure of each strip; the law of this module, with the surfaces lowered [m]."""
    distance = ground.strips.distance + lowered
    approach = max(-float(distance[0]), 0.0)
    undeformed = np.maximum(distance[1:] - distance[0], 0.0)
    strips = ground.strips.without_first
    overlapping = np.maximum(approach - undeformed, 0.0) * ground.breadth
    across = np.sum(overlapping * undeformed / ground.aside**2) / max(float(np.sum(overlapping)), TINY)
    alpha, beta, kappa = hertz_factors(float(ground.strips.curvature[0]), float(across))
    half_length = np.sqrt(np.maximum(approach - beta * undeformed, 0.0) / (alpha * strips.curvature))
    pressure = kappa * strips.curvature * half_length * steel.plane_modulus
    # The gap grows by A / cos x^2 along the strip.
    cosine = np.cos(strips.angle)
    squared = 16 / 15 * np.maximum(-strips.gap, 0.0) ** 2.5 * np.sqrt(cosine / strips.curvature)
    return Patch(strips, ground.breadth, half_length, pressure, approach, squared * ground.breadth * cosine)
