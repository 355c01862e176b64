"""Patches of a wheel on its rail: parts of its profile with one contact patch each, such as tread and flange.

The profiles are rigid, without yaw and roll. Along a patch the distance of wheel and rail is measured square to its
`direction`: above the rail for the tread, beside it for the flange.

A wheel is divided where its contact would jump. Contact model 3 divides it at every jump. Contact model 2 divides it
only where the ridge between both places is high against the depth of a loaded contact (`bearing.LEAST_RIDGE`): places
within one contact area are one patch.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from rbd_model.contact.bearing import LEAST_RIDGE, PartContour
from rbd_model.contact.geometry import LEFT, RIGHT, ROLL_LIMITS, Side, Sides
from rbd_model.contact.profiles import Profile, from_points

#: Largest extra distance from the rail at which a part is followed, and smallest jump of its nearest point [m].
RELEVANT, JUMP = 0.3e-3, 1e-3
#: Roll of a wheelset against its rails up to which jumps are searched for [rad]: one rail 6 mm above the other.
TILT = 4e-3
#: Slope that separates treads from flanges [rad]. Parts of less slope are described along the track's own level.
TREAD_SLOPE = math.radians(20.0)
#: Largest angle between a rail's contour and the direction along which it is described [rad].
STEEPEST = math.radians(75.0)
#: Pitch of the search for nearest points, and of the table of nearest points [m].
SEARCH_PITCH, TABLE_PITCH = 0.02e-3, 0.1e-3
#: Least curvature of a rail's contour [1/m]. Every head is more curved where it bears.
LEAST_BEND = 1.0
#: Largest displacement of the wheel against the rail along a patch [m].
REACH = 20e-3
#: Least range of shift over which a part of a wheel is nearest by itself [m]. Parts that jump more often are joined.
LEAST_TRAVEL = 0.5e-3
#: Pitch of the points of a patch along its direction [m].
PATCH_PITCH = 0.04e-3
#: Remedy for a pair that contact model 2 refuses: contact model 3 runs on no contact table, and on no line.
AT_MODEL_3 = "give the pair to a vehicle in Python and run it at contact model 3 without a line (docs/vehicles.md)"
#: Largest offset between the y = 0 of a wheel and of its rail [m]. Offsets up to it are searched every TABLE_PITCH.
LARGEST_APART = 0.25
#: Pitch of the points through which a turned rail is laid [m].
TURNED_PITCH = 0.02e-3


@dataclass(frozen=True)
class WheelPart:
    """A part of a wheel from point `first` to point `last`.

    `direction` [rad]: slope of the line along which wheel and rail are described. `radius` [m]: of the rail's contour
    at the contact; a roll leaves this arc unchanged. `rail`: its contour in axes along and square to this line.
    nearest: position nearest to the rail at each offset [m], NaN if the part is not nearest there. `slopes` [rad]: of
    the wheel where the part bears, least and largest. `flange`: whether it bears on the flange alone.
    """

    first: int
    last: int
    direction: float
    radius: float
    rail: Profile
    nearest: np.ndarray
    slopes: tuple[float, float]
    flange: bool

    @property
    def travel(self) -> float:
        """Range of shift over which it is nearest by itself [m]."""
        return float(np.count_nonzero(np.isfinite(self.nearest)) - 1) * TABLE_PITCH


def patches_of(side: Side) -> tuple[WheelPart, ...]:
    """Return the parts of a wheel that are patches of contact model 2, from the field side on (section 9.4.1)."""
    return parts_of(side, LEAST_RIDGE)


def contour_of(side: Side, part: WheelPart) -> PartContour:
    """Return the points of a part and its rail in the axes of the part (section 3.3.2)."""
    first, last = positions_of(side)[[part.first, part.last - 1]]
    place = np.arange(first, last, PATCH_PITCH * math.cos(part.direction))
    depth = side.wheel.height(place)
    return PartContour(
        part.direction, place, *in_direction(place, depth, part.direction), depth, part.rail, side.radius
    )


@lru_cache
def parts_of(side: Side, least_ridge: float = 0.0, most: int | None = None) -> tuple[WheelPart, ...]:
    """Return the parts of a wheel from the field side to the flange, cut where the contact would jump (section 9.4.1).

    The nearest point of each part is followed over shifts of the wheel against its rail. It may jump while the part is
    as near as the rest of the wheel to within RELEVANT. The part is then cut at the ridge between both places if this
    ridge is at least `least_ridge` [m] high. Several parts may bear at once. On some conformal contours, such as those
    of EN 15302 in the flange root, the contact jumps every tenth of a millimetre. Parts are then joined again until
    each of them travels far enough, and until they are at most `most`. A part beyond the first one of the flange
    belongs to the flange, however flat it is: it is the flange's tip.
    """
    s = positions_of(side)
    gaps = gaps_of(side, s)
    cuts, whole = [], [(0, s.size)]
    while whole:
        first, last = whole.pop()
        cut = ridge(side, s, gaps, first, last, least_ridge)
        if cut is None:
            cuts.append((first, last))
        else:
            whole += [(first, cut), (cut, last)]
    parts = [follow(side, s, gaps, *ends) for ends in sorted(cuts, reverse=True)]
    join_tip(side, s, gaps, parts)
    while len(parts) > 1 and (min(part.travel for part in parts) < LEAST_TRAVEL or len(parts) > (most or len(parts))):
        join_shortest(side, s, gaps, parts)
    if parts[0].travel < LEAST_TRAVEL:
        raise ValueError(
            f"{side.wheel.name} must touch {side.rail.name} beside the ends of its profile over at least"
            f" {1e3 * LEAST_TRAVEL:g} mm of shift; it does not. Give longer profiles, or change where they have y = 0."
        )
    first = next((place for place, part in enumerate(parts) if part.flange), len(parts))
    return tuple(replace(part, flange=place >= first) for place, part in enumerate(parts))


def join_shortest(side: Side, s: np.ndarray, gaps: list[np.ndarray], parts: list[WheelPart]) -> None:
    """Join the part that travels least to the shorter of its neighbours. Tread and flange are joined last.

    This is a decision of this project, for contours on which a jump is shorter than the contact is wide
    (section 9.4.1).
    """
    at = int(np.argmin([part.travel for part in parts]))
    beside = [place for place in (at - 1, at + 1) if 0 <= place < len(parts)]
    other = min(beside, key=lambda place: (parts[place].flange != parts[at].flange, parts[place].travel))
    low, high = sorted((at, other))
    parts[low : high + 1] = [follow(side, s, gaps, parts[high].first, parts[low].last)]


def join_tip(side: Side, s: np.ndarray, gaps: list[np.ndarray], parts: list[WheelPart]) -> None:
    """Join the parts beyond the steepest one of a flange to it: where they bear, the wheel climbs over its flange.

    This is a decision of this project (section 9.4.1). The end of the last part is thus that of the flange.
    """
    at = int(np.argmax([part.direction for part in parts]))
    if parts[at].direction < TREAD_SLOPE or at == len(parts) - 1:
        return
    direction = (parts[at].direction + max(parts[-1].direction, TREAD_SLOPE)) / 2
    parts[at:] = [follow(side, s, gaps, parts[-1].first, parts[at].last, direction)]


def positions_of(side: Side) -> np.ndarray:
    """Return the points of the wheel's profile that are searched [m] (section 4.3)."""
    return np.arange(side.wheel.limits[0] + SEARCH_PITCH, side.wheel.limits[1] - SEARCH_PITCH, SEARCH_PITCH)


def offsets_of(side: Side) -> np.ndarray:
    """Return the searched offsets of the wheel's y = 0 from the rail's [m] (3.77).

    Profiles may have any origin. The offsets therefore extend by REACH beyond 0 and beyond the offset of a centred
    wheelset.
    """
    apart = side.wheel_half_distance - side.rail_half_distance
    if not abs(apart) <= LARGEST_APART:
        raise ValueError(
            f"The half distances of a wheel and of its rail must be within {LARGEST_APART:g} m of each other; got "
            f"{side.wheel_half_distance:g} and {side.rail_half_distance:g} m. Give both in metres."
        )
    centred = (side.wheel_half_distance - side.rail_half_distance) / TABLE_PITCH
    first, last = math.floor(min(centred, 0.0)) * TABLE_PITCH, math.ceil(max(centred, 0.0)) * TABLE_PITCH
    return np.arange(first - REACH, last + REACH, TABLE_PITCH)


def gaps_of(side: Side, s: np.ndarray) -> list[np.ndarray]:
    """Return the height of the wheel's contour over the rail's at the positions s [m], for each offset (3.77), (3.78).

    It is infinite beside the rail.
    """
    heights = side.wheel.height(s)
    gaps = (heights - side.rail.height(s + offset) for offset in offsets_of(side))
    return [np.where(np.isfinite(gap), gap, np.inf) for gap in gaps]


def ridge(side: Side, s: np.ndarray, gaps: list[np.ndarray], first: int, last: int, least: float) -> int | None:
    """Return the index at which to cut a part whose nearest point jumps, or None: the highest point of the jump.

    least [m]: height of the ridge over both places, square to the steeper one, below which the part is not cut.

    Section 9.4.1. A roll moves the wheel along each arc of the rail by its radius times the roll. It therefore moves a
    jump from one arc to another by the difference of both. The jump is relevant if wheelsets that roll by up to TILT
    reach it.
    """
    offsets, own = offsets_of(side), np.array([gap[first:last] for gap in gaps])
    places = np.argmin(own, axis=1)
    inside = (places > 0) & (places < own.shape[1] - 1)
    bears = inside & (np.min(own, axis=1) < np.array([np.min(gap) for gap in gaps]) + RELEVANT)
    jumps = inside[1:] & inside[:-1] & (np.abs(np.diff(s[first + places])) > JUMP)
    for after in 1 + np.flatnonzero(jumps):
        both = [1 / max(rail_bend(side, s[first + places[i]] + offsets[i]), LEAST_BEND) for i in (after - 1, after)]
        reached = TILT * abs(both[1] - both[0])
        near = (offsets[after - 1] - reached <= offsets) & (offsets <= offsets[after] + reached)
        if np.any(bears & near):
            low, high = sorted(places[after - 1 : after + 1])
            steep = float(np.max(np.abs(side.wheel.height(s[[first + low, first + high]], 1))))
            if ridge_height(own[after - 1 : after + 1], low, high) >= least * math.sqrt(1 + steep**2):
                return first + low + int(np.argmax(own[after, low:high]))
    return None


def ridge_height(gaps: np.ndarray, low: int, high: int) -> float:
    """Return the height of the ridge between the points `low` and `high` where both are equally near [m], (3.78).

    gaps [m]: at the offsets before and after the jump, shape (2, n).
    """
    ends, tops = gaps[:, [low, high]], np.max(gaps[:, low : high + 1], axis=1)
    if not np.all(np.isfinite([*ends.ravel(), *tops])):
        return math.inf  # beside the rail
    apart = ends[:, 0] - ends[:, 1]
    share = float(apart[0] / (apart[0] - apart[1])) if apart[0] * apart[1] < 0.0 else 0.5
    return float(np.interp(share, [0.0, 1.0], tops - ends[:, 0]))


def rail_bend(side: Side, y: float) -> float:
    """Curvature of a rail's contour [1/m], positive where it is a head's (3.83)."""
    slope, bend = (float(side.rail.height(np.array(y), n)) for n in (1, 2))
    return -bend / (1 + slope**2) ** 1.5


def bearing(
    side: Side, s: np.ndarray, gaps: list[np.ndarray], first: int, last: int
) -> tuple[list[float], list[float]]:
    """Slopes of the wheel [rad] and curvatures of the rail [1/m] (3.83) where a part is nearest and bears.

    Those of a part that bears only on a rolling wheelset are taken where it is nearest to bearing.
    """
    places = [first + int(np.argmin(gap[first:last])) for gap in gaps]
    above = [
        gap[here] - np.min(gap) if first < here < last - 1 else math.inf for here, gap in zip(places, gaps, strict=True)
    ]
    most = max(RELEVANT, math.nextafter(min(above), math.inf))
    slopes, bends = [], []
    for offset, here, more in zip(offsets_of(side), places, above, strict=True):
        if more < most and more < math.inf:
            slopes.append(math.atan(float(side.wheel.height(s[here], 1))))
            bends.append(rail_bend(side, s[here] + offset))
    return slopes, bends


def follow(
    side: Side, s: np.ndarray, gaps: list[np.ndarray], first: int, last: int, direction: float | None = None
) -> WheelPart:
    """Follow the nearest place of the points `first` to `last` of the wheel's profile (section 3.3.2).

    Described along `direction` [rad], by default the slope of the wheel in the middle of where it bears; level for a
    tread, which lies over its rail.
    """
    slopes, bends = bearing(side, s, gaps, first, last)
    middle = direction if direction is not None else (min(slopes) + max(slopes)) / 2 if slopes else 0.0
    direction = 0.0 if abs(middle) < TREAD_SLOPE else middle
    radius = 1 / max(float(np.median(bends)), LEAST_BEND) if bends else 0.0
    rail = turned(side.rail, direction)
    inside = np.arange(s[first] + SEARCH_PITCH, s[last - 1] - SEARCH_PITCH, SEARCH_PITCH)
    along, square = in_direction(inside, side.wheel.height(inside), direction)
    offsets = offsets_of(side)
    found = np.full(offsets.size, np.nan)
    for i, offset in enumerate(offsets):
        gap = square - rail.height(along + offset)
        if np.any(np.isfinite(gap)):
            found[i] = nearest_point(inside, gap, (first > 0, last < s.size))
    if first == 0 and direction and np.any(np.isfinite(found)):
        # The contact moves from the root to the tip. Before, the back of the flange may lie over the turned rail.
        found[: np.nanargmax(found)] = np.nan
    ends = (min(slopes), max(slopes)) if slopes else (direction, direction)
    flange = direction >= TREAD_SLOPE and ends[0] >= TREAD_SLOPE / 2
    return WheelPart(first, last, direction, radius, rail, found, ends, flange)


def nearest_point(s: np.ndarray, gap: np.ndarray, cut: tuple[bool, bool]) -> float:
    """Return the position of the smallest gap (section 4.3), refined by a parabola through three positions [m].

    cut: true for each end of the positions that lies at a cut. The contact is not there, because the part beyond the
    cut is nearer. Returns NaN if no position is nearer than both its neighbours.
    """
    known = np.where(np.isfinite(gap), gap, np.inf)
    beside = np.concatenate([[-np.inf if cut[0] else np.inf], known, [-np.inf if cut[1] else np.inf]])
    lower = (known < beside[:-2]) & (known <= beside[2:])
    if not np.any(lower):
        return math.nan
    here = int(np.argmin(np.where(lower, known, np.inf)))
    near = gap[max(here - 1, 0) : here + 2]
    bend = near[0] - 2 * near[1] + near[-1] if near.size == 3 else math.nan
    if not bend > 0.0:
        return float(s[here])
    return float(s[here] + 0.5 * (near[0] - near[2]) / bend * (s[1] - s[0]))


def in_direction(y: np.ndarray, z: np.ndarray, direction: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the coordinates of points (y, z) [m] along a line of slope `direction` [rad] and square to it, upwards.

    Section 3.3.2.
    """
    cosine, sine = math.cos(direction), math.sin(direction)
    return cosine * y + sine * z, cosine * z - sine * y


def turned(rail: Profile, direction: float) -> Profile:
    """Return the contour of a rail in axes along `direction` [rad], up to where it becomes too steep.

    Section 3.3.2.
    """
    if direction == 0.0:
        return rail
    y = np.arange(rail.limits[0], rail.limits[1], TURNED_PITCH)
    off = np.abs(np.arctan(rail.height(y, 1)) - direction) < STEEPEST
    first = int(np.argmax(off))
    last = first + (int(np.argmin(off[first:])) or off.size - first)
    along, square = in_direction(y[first:last], rail.height(y[first:last]), direction)
    return from_points(f"{rail.name} along {math.degrees(direction):.0f} degrees", rail.source, along, square)


@dataclass(frozen=True)
class TreadStand:
    """A wheelset on its treads: height of its centre over the rails' origins [m], roll, places (left, right) [m]."""

    height: float
    roll: float
    position: tuple[float, float]


@lru_cache
def stand_on_treads(pair: Sides, shift: float) -> TreadStand:
    """Return the rigid contact of both treads at a shift of the axle [m], without the flanges (section 4.3)."""
    places = []
    for one in pair.both:
        s = positions_of(one)
        treads = [part for part in parts_of(one) if not part.flange]
        places.append(s[min(part.first for part in treads) : max(part.last for part in treads)])
    heights = [one.wheel.height(s) for one, s in zip(pair.both, places, strict=True)]

    def gaps(roll: float) -> list[np.ndarray]:
        each = zip(pair.both, (LEFT, RIGHT), places, heights, strict=True)
        return [one.gap(side, shift, roll, s, known) for one, side, s, known in each]

    def difference(roll: float) -> float:
        left, right = gaps(roll)
        return float(np.min(left) - np.min(right))

    roll = float(brentq(difference, -ROLL_LIMITS[-1], ROLL_LIMITS[-1], xtol=1e-14))
    found = gaps(roll)
    left, right = (float(s[np.argmin(gap)]) for s, gap in zip(places, found, strict=True))
    return TreadStand(-float(np.min(found[0])), roll, (left, right))
