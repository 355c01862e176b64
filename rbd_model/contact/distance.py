"""Undeformed distance of a wheel over its rail, strip by strip across the profile, and the valleys in which they touch.

Seen from one wheel: x ahead, y outwards (to the field side), z up; the right wheel is the mirror image of a left one.
Strips run along the rail. The wheel is a surface of revolution, so that along each strip there is one place where it
is nearest to the rail, which is straight: where its normal stands across the rail (3.54), in closed form even with yaw.
What is left is plane: the outline of the wheel as it is seen along the rail, over the profile of the rail. Vollebregt
(2020), Detailed wheel/rail geometry processing using the planar contact approach, calls it the contact locus.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from rbd_model.contact.geometry import Pair

LEFT, RIGHT = 1, -1


@dataclass(frozen=True)
class Stand:
    """Where a wheelset stands, seen from one wheel: its centre outwards of the track's and over the rails' origin [m],
    roll (this wheel goes up) and yaw (this wheel goes back) [rad].
    """

    lateral: float
    height: float
    roll: float
    yaw: float


def stand_of(side: int, lateral: float, height: float, roll: float, yaw: float) -> Stand:
    """The stand in the track's axes of section 3.2 (ahead, left, up), seen from the LEFT or the RIGHT wheel."""
    return Stand(side * lateral, height, side * roll, side * yaw)


@dataclass(frozen=True)
class Strips:
    """Strips across the profiles; arrays of one length.

    on_wheel, on_rail [m]: positions on both profiles. arm [m]: from the wheelset's centre to the nearest point, shape
    (3, n). gap [m]: height of that point over the rail, infinite where there is no rail. angle [rad]: of the contact.
    curvature: A of eq. (3.83), half of that of the wheel along the strip, across the contact [1/m]. stretch: breadth of
    the wheel's contour over that of its position.
    """

    on_wheel: np.ndarray
    on_rail: np.ndarray
    arm: np.ndarray
    gap: np.ndarray
    angle: np.ndarray
    curvature: np.ndarray
    stretch: np.ndarray

    @property
    def without_first(self) -> Strips:
        """All but the first strip."""
        return Strips(*(getattr(self, item.name)[..., 1:] for item in fields(self)))

    @property
    def distance(self) -> np.ndarray:
        """Of wheel and rail along the normal [m], negative where they overlap."""
        return self.gap * np.cos(self.angle)


def strips_at(pair: Pair, stand: Stand, on_wheel: np.ndarray) -> Strips:
    """Wheel over rail at the positions on the wheel [m], eqs (3.54), (3.77).

    Meusnier's theorem gives the curvature along the strip: cos(angle) / r, as without yaw. What the yaw adds is of the
    order of yaw^2 times the curvature of the wheel's contour: 2 % in the flange root at 24 mrad.
    """
    contour, slope = pair.wheel.height(on_wheel), pair.wheel.height(on_wheel, 1)
    sin_yaw, cos_yaw = math.sin(stand.yaw), math.cos(stand.yaw)
    sin_roll, cos_roll = math.sin(stand.roll), math.cos(stand.roll)
    axes = np.array(
        [
            [cos_yaw, -sin_yaw * cos_roll, sin_yaw * sin_roll],
            [sin_yaw, cos_yaw * cos_roll, -cos_yaw * sin_roll],
            [0.0, sin_roll, cos_roll],
        ]
    )
    ahead, outwards, up = axes[0]
    radius = pair.radius - contour
    # -sin(theta) t1 - w' t2 + cos(theta) t3 = 0: the normal stands across the rail, whose direction is t.
    level = 1 / math.hypot(ahead, up)
    lead = -slope * outwards * level
    rest = np.sqrt(1 - lead**2)
    sine, cosine = level * (lead * ahead + rest * up), level * (rest * ahead - lead * up)
    arm = axes @ np.array([radius * sine, pair.wheel_half_distance + on_wheel, -radius * cosine])
    normal = axes @ np.array([-sine, -slope, cosine])
    angle = np.arctan2(-normal[1], normal[2])
    on_rail = stand.lateral + arm[1] - pair.rail_half_distance
    gap = stand.height + arm[2] - pair.rail.height(on_rail)
    return Strips(
        on_wheel,
        on_rail,
        arm,
        np.where(np.isnan(gap), np.inf, gap),
        angle,
        np.cos(angle) / (2 * radius),
        np.sqrt(1 + slope**2),
    )


#: Strips of the search over the whole wheel, of a closer look into a valley that it found, and around its lowest strip.
SEARCH, CLOSER, CLOSEST = 200, 65, 9
#: What the search leaves out at the ends of the contour [m].
MARGIN = 0.5e-3


@dataclass(frozen=True)
class Valley:
    """Where the distance has a minimum: its position on the wheel, where it ends to both sides [m], smallest gap [m].

    It ends where wheel and rail no longer overlap, or at the ridge to the next valley.
    """

    first: float
    deepest: float
    last: float
    gap: float


def valleys(pair: Pair, stand: Stand) -> list[Valley]:
    """All valleys in which wheel and rail overlap, from the flange outwards: minima of the gap, eq. (3.77)."""
    return [valley for valley in _minima(pair, stand) if valley.gap < 0.0]


def touching_height(pair: Pair, stand: Stand) -> float:
    """Height of the wheelset's centre [m] at which this wheel begins to touch, eq. (3.77); the stand's is not used."""
    lifted = replace(stand, height=2 * pair.radius)
    return lifted.height - min(valley.gap for valley in _minima(pair, lifted))


def _minima(pair: Pair, stand: Stand) -> list[Valley]:
    low, high = pair.wheel.limits
    on_wheel = np.linspace(low + MARGIN, high - MARGIN, SEARCH)
    gap = strips_at(pair, stand, on_wheel).gap
    inner = np.arange(1, SEARCH - 1)
    found = []
    for i in inner[(gap[inner] <= gap[inner - 1]) & (gap[inner] < gap[inner + 1])]:
        closer = np.linspace(on_wheel[_end(gap, i, -1)], on_wheel[_end(gap, i, 1)], CLOSER)
        found.append(_valley(pair, stand, closer))
    return found


def _end(gap: np.ndarray, i: int, step: int) -> int:
    """The first strip from the minimum at `i` on that does not overlap, or the ridge."""
    j = i + step
    while 0 < j < gap.size - 1 and gap[j] < 0.0 and gap[j + step] >= gap[j]:
        j += step
    return j


def _valley(pair: Pair, stand: Stand, on_wheel: np.ndarray) -> Valley:
    """The valley in a closer look: where the slopes are the same, (3.57), and where the gap becomes 0."""
    gap = strips_at(pair, stand, on_wheel).gap
    i = int(np.argmin(gap))
    around = np.linspace(on_wheel[max(i - 1, 0)], on_wheel[min(i + 1, gap.size - 1)], CLOSEST)
    strips = strips_at(pair, stand, around)
    tilt = np.tan(strips.angle) - pair.rail.height(strips.on_rail, 1)
    k = int(np.argmin(strips.gap))
    k -= int(tilt[k] > 0.0)
    deepest = around[max(k, 0)]
    if 0 <= k < CLOSEST - 1 and tilt[k] <= 0.0 < tilt[k + 1]:
        deepest -= tilt[k] / (tilt[k + 1] - tilt[k]) * (around[1] - around[0])
    lowest = float(strips_at(pair, stand, np.array([deepest])).gap[0])
    return Valley(_crossing(on_wheel, gap, i, -1), float(deepest), _crossing(on_wheel, gap, i, 1), lowest)


def _crossing(on_wheel: np.ndarray, gap: np.ndarray, i: int, step: int) -> float:
    """Where the gap becomes 0 from `i` on, or the end."""
    last = gap.size - 1 if step > 0 else 0
    while i != last and gap[i + step] < 0.0:
        i += step
    if i == last or not gap[i] < 0.0 or not np.isfinite(gap[i + step]):
        return float(on_wheel[i if i == last else i + step])
    return float(on_wheel[i] + step * (on_wheel[1] - on_wheel[0]) * gap[i] / (gap[i] - gap[i + step]))
