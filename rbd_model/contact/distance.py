"""Undeformed distance of a wheel over its rail, strip by strip across the profile, and the areas in which they overlap.

Axes of one wheel: x ahead, y outwards (to the field side), z up; the right wheel is the mirror image of a left one.
Strips run along the rail, which is straight. The wheel is a surface of revolution. Each strip therefore has one place
nearest to the rail. Its normal is across the rail (3.54), in closed form even with yaw. The remaining problem is
planar: the outline of the wheel in the view along the rail, over the profile of the rail. Vollebregt (2020), Detailed
wheel/rail geometry processing using the planar contact approach, calls it the contact locus.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from rbd_model.contact.geometry import Pair

LEFT, RIGHT = 1, -1


@dataclass(frozen=True)
class Stand:
    """Position of a wheelset in the axes of one wheel.

    The centre is outwards of the track's and over the rails' origin [m]; roll (this wheel goes up) and yaw (this wheel
    goes back) are in rad.
    """

    lateral: float
    height: float
    roll: float
    yaw: float


def stand_of(side: int, lateral: float, height: float, roll: float, yaw: float) -> Stand:
    """Return the stand from the track's axes of section 3.2 (ahead, left, up), for the LEFT or the RIGHT wheel."""
    return Stand(side * lateral, height, side * roll, side * yaw)


@dataclass(frozen=True)
class Strips:
    """Strips across the profiles; arrays of one length.

    `on_wheel` and `on_rail` [m] are positions on both profiles. `arm` [m] goes from the wheelset's centre to the
    nearest point, shape (3, n). `gap` [m] is the height of that point over the rail, infinite beside the rail. `angle`
    [rad] is that of the contact. `curvature` [1/m] is A of eq. (3.83), half of that of the wheel along the strip,
    across the contact. `stretch` is the breadth of the wheel's contour over that of its position.
    """

    on_wheel: np.ndarray
    on_rail: np.ndarray
    arm: np.ndarray
    gap: np.ndarray
    angle: np.ndarray
    curvature: np.ndarray
    stretch: np.ndarray

    def part(self, which: slice | np.ndarray) -> Strips:
        """Return some of the strips."""
        return Strips(*(getattr(self, item.name)[..., which] for item in fields(self)))

    @property
    def distance(self) -> np.ndarray:
        """Distance of wheel and rail along the normal [m], negative if they overlap."""
        return self.gap * np.cos(self.angle)


def strips_at(pair: Pair, stand: Stand, on_wheel: np.ndarray) -> Strips:
    """Return the strips of the wheel over the rail at the positions on the wheel [m], eqs (3.54), (3.77).

    Meusnier's theorem gives the curvature along the strip: cos(angle) / r, as without yaw. The effect of yaw is of the
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


#: Strips of the search over the whole wheel, and of the refinement at each overlap.
SEARCH, CLOSER = 200, 65
#: Length at the ends of the contour that the search omits [m].
MARGIN = 0.5e-3


def areas(pair: Pair, stand: Stand) -> list[tuple[float, float]]:
    """Return the overlaps on the wheel [m], from the flange outwards: positions at which the gap by (3.77) is
    negative.
    """
    on_wheel, gap = _searched(pair, stand)
    found = []
    for first, last in _candidates(gap):
        closer = np.linspace(on_wheel[first], on_wheel[last], CLOSER)
        inside = strips_at(pair, stand, closer).gap
        below = np.flatnonzero(inside < 0.0)
        if below.size:
            found.append((_crossing(closer, inside, below[0], -1), _crossing(closer, inside, below[-1], 1)))
    return found


def _searched(pair: Pair, stand: Stand) -> tuple[np.ndarray, np.ndarray]:
    low, high = pair.wheel.limits
    on_wheel = np.linspace(low + MARGIN, high - MARGIN, SEARCH)
    return on_wheel, strips_at(pair, stand, on_wheel).gap


def _candidates(gap: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last strip around each run of negative gaps, and around each minimum that may be negative
    between.
    """
    inner = np.arange(1, gap.size - 1)
    lowest = (gap[inner] <= gap[inner - 1]) & (gap[inner] < gap[inner + 1])
    runs = np.flatnonzero(np.diff(np.concatenate([[False], gap[inner] < 0.0, [False]]).astype(int)))
    found = [(int(begin), int(end) + 1) for begin, end in runs.reshape(-1, 2)]
    return sorted([*found, *((int(i) - 1, int(i) + 1) for i in inner[lowest & (gap[inner] >= 0.0)])])


def _crossing(on_wheel: np.ndarray, gap: np.ndarray, i: int, step: int) -> float:
    """Return the position at which the gap becomes 0 between strip `i` and the next one, or at which the rail ends."""
    j = i + step
    if not 0 <= j < gap.size or not np.isfinite(gap[j]):
        return float(on_wheel[i])
    return float(on_wheel[i] + (on_wheel[j] - on_wheel[i]) * gap[i] / (gap[i] - gap[j]))


def touching(pair: Pair, stand: Stand) -> tuple[float, float]:
    """Return the height of the wheelset's centre at first contact of this wheel, and the place on the wheel [m].

    Equation (3.77).

    The height of the stand is not used.
    """
    lifted = replace(stand, height=2 * pair.radius)
    on_wheel, gap = _searched(pair, lifted)
    found = []
    for first, last in _candidates(gap):
        place = np.array([on_wheel[first], on_wheel[last]])
        for _ in range(2):
            place = np.linspace(place[0], place[-1], CLOSER)
            gap = strips_at(pair, lifted, place).gap
            i = int(np.clip(np.argmin(gap), 1, CLOSER - 2))
            place = place[i - 1 : i + 2]
        found.append((float(gap[i]), float(place[1])))
    if not found:
        raise ValueError(f"{pair.wheel.name} on {pair.rail.name} at {stand} touches at an end of its contour only.")
    lowest, where = min(found)
    return lifted.height - lowest, where
