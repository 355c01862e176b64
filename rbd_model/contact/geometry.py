"""Contact points of a wheelset that is shifted sideways: rolling radii, contact angles, conicity, the fold.

The profiles are rigid and do not yaw. The contact points lie in the vertical plane through the axle, so that the
problem is a planar one. Left is positive. Section 4.3, Figs 4.7 and 4.8.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from rbd_model.contact.profiles import GAUGE_DEPTH as GAUGE_DEPTH
from rbd_model.contact.profiles import Profile, rail_60e1, rail_60kg, wheel_cone_120, wheel_s1002

#: Pitch of the search grid on the contour [m]; a parabola through three points refines it to better than 1 um.
GRID = 0.02e-3
LEFT, RIGHT = 1, -1
#: Consecutive limits of the roll in the search for the balance [rad]. A wheelset on its treads rolls by 0.001. One that
#: has climbed its flange, where a balance exists too, rolls by 0.03.
ROLL_LIMITS = (0.002, 0.004, 0.008, 0.016, 0.05)


@dataclass(frozen=True)
class Side:
    """A wheel on its rail [m]: its radius at y = 0, and distances of the y = 0 of wheel and rail from the middle."""

    wheel: Profile
    rail: Profile
    radius: float
    wheel_half_distance: float
    rail_half_distance: float

    def gap(self, side: int, shift: float, roll: float, s: np.ndarray, heights: np.ndarray | None = None) -> np.ndarray:
        """Return the height of the wheel contour over the rail at the positions s [m], up to the height of the axle.

        It is infinite beside the rail. heights [m]: of the wheel's profile at s, if they are known.
        """
        gap = np.full(s.shape, np.inf)
        # Only positions that may be above the rail are computed: the roll moves no point sideways by more than this.
        aside, (low, high) = 2 * self.radius * abs(math.sin(roll)), self.rail.limits
        across = (self.wheel_half_distance + s) * math.cos(roll) + side * shift - self.rail_half_distance
        near = (across >= low - aside - GRID) & (across <= high + aside + GRID)
        outward = self.wheel_half_distance + s[near]
        below = self.radius - (self.wheel.height(s[near]) if heights is None else heights[near])
        lateral = side * outward * math.cos(roll) + below * math.sin(roll)
        height = side * outward * math.sin(roll) - below * math.cos(roll)
        over = height - self.rail.height(side * (lateral + shift) - self.rail_half_distance)
        gap[near] = np.where(np.isnan(over), np.inf, over)
        return gap


@dataclass(frozen=True)
class Sides:
    """A wheelset on its track: two sides that may differ in wheel, rail, radius and distances.

    `notes`: what was given, found or assumed for measured profiles; they are not compared.
    """

    left: Side
    right: Side
    notes: tuple[str, ...] = field(default=(), compare=False, repr=False)

    @property
    def both(self) -> tuple[Side, Side]:
        """Left and right."""
        return self.left, self.right

    @property
    def mirrored(self) -> Sides:
        """Left and right exchanged: the wheelset shifts and rolls in the opposite sense."""
        return Sides(self.right, self.left, self.notes)

    @property
    def mean_radius(self) -> float:
        """Mean radius of both wheels at y = 0 [m] (r0)."""
        return (self.left.radius + self.right.radius) / 2


class Pair(Sides):
    """Equal sides, as on the built-in vehicles: a wheel on a rail, and the half distances of the y = 0 of each [m]."""

    def __init__(
        self,
        wheel: Profile,
        rail: Profile,
        radius: float,
        wheel_half_distance: float,
        rail_half_distance: float,
        notes: tuple[str, ...] = (),
    ) -> None:
        side = Side(wheel, rail, radius, wheel_half_distance, rail_half_distance)
        super().__init__(side, side, notes)

    @property
    def wheel(self) -> Profile:
        """Profile of both wheels."""
        return self.left.wheel

    @property
    def rail(self) -> Profile:
        """Profile of both rails."""
        return self.left.rail

    @property
    def radius(self) -> float:
        """Radius of both wheels at y = 0 [m]."""
        return self.left.radius

    @property
    def wheel_half_distance(self) -> float:
        """Half the distance of the wheels' y = 0 [m]."""
        return self.left.wheel_half_distance

    @property
    def rail_half_distance(self) -> float:
        """Half the distance of the rails' y = 0 [m]."""
        return self.left.rail_half_distance


def thesis_pair() -> Pair:
    """Return the synthetic wheel on the 60 kg rail: contacts 1140 mm apart, r0 = 0.425 m (sections 4.3, 4.4)."""
    return Pair(wheel_cone_120(), rail_60kg(), 0.425, 0.570, 0.570)


def synthetic_pair() -> Pair:
    """Return the same profiles on standard gauge: contacts 1.5 m apart, r0 = 0.46 m, as on the Manchester vehicles.

    Assumed, instead of S1002 on UIC 60. Contact of those jumps, and one contact point per wheel does not follow it.
    """
    return Pair(wheel_cone_120(), rail_60kg(), 0.460, 0.750, 0.750)


#: Standard gauge [m].
STANDARD_GAUGE = 1.435


def gauge_face(rail: Profile) -> float:
    """Return the y of the gauge face [m], GAUGE_DEPTH below the highest point of the rail as laid (EN 13848-1).

    That of a measured rail is known from its points.
    """
    if "gauge_face" in rail.facts:
        return rail.facts["gauge_face"]
    y = np.linspace(*rail.limits, 100001)
    height = rail.height(y)
    return float(y[np.argmax(height > np.max(height) - GAUGE_DEPTH)])


def european_pair() -> Pair:
    """Return S1002 (EN 13715) on 60E1 (EN 13674-1) 1:40, gauge 1435 mm, tape circles 1500 mm apart, r0 = 0.46 m.

    At the height where the gauge is measured, the head is 72 mm wide. The gauge face of the inclined head lies at y =
    -35.5 mm, not -36.
    """
    rail = rail_60e1()
    return Pair(wheel_s1002(), rail, 0.460, 0.750, STANDARD_GAUGE / 2 - gauge_face(rail))


@dataclass(frozen=True)
class ContactAtShift:
    """Contact of both wheels (left, right) at one shift: positions s on the wheels, rolling radii [m], angles [rad]."""

    shift: float
    roll: float
    position: tuple[float, float]
    radius: tuple[float, float]
    angle: tuple[float, float]

    @property
    def radius_difference(self) -> float:
        """r_left - r_right [m]."""
        return self.radius[0] - self.radius[1]


Search = tuple[np.ndarray, np.ndarray]


def _lowest(one: Side, side: int, shift: float, roll: float, s: np.ndarray) -> tuple[float, float, bool]:
    """Return the smallest gap over the positions s, its position, and whether that lies inside the range."""
    gap = one.gap(side, shift, roll, s)
    i = int(np.argmin(gap))
    if i in (0, s.size - 1) or not np.all(np.isfinite(gap[i - 1 : i + 2])):
        return float(gap[i]), float(s[i]), False
    before, here, after = gap[i - 1 : i + 2]
    bend = before - 2 * here + after
    offset = 0.5 * (before - after) / bend if bend > 0 else 0.0
    return float(here - 0.25 * (before - after) * offset), float(s[i] + offset * (s[1] - s[0])), True


def _both(pair: Sides, shift: float, roll: float, search: Search) -> list[tuple[float, float, bool]]:
    """Return `_lowest` of the left and of the right wheel."""
    left = _lowest(pair.left, LEFT, shift, roll, search[0])
    return [left, _lowest(pair.right, RIGHT, shift, roll, search[1])]


def _touch(pair: Sides, shift: float, search: Search) -> tuple[ContactAtShift, bool]:
    """Return the contact at the roll with equal gaps; the flag: both contacts lie inside their search range."""

    def difference(roll: float) -> float:
        left, right = _both(pair, shift, roll, search)
        return left[0] - right[0]

    within = next((limit for limit in ROLL_LIMITS if difference(-limit) * difference(limit) <= 0.0), ROLL_LIMITS[-1])
    roll = float(brentq(difference, -within, within, xtol=1e-14))
    return _contact(pair, shift, roll, search)


def _contact(pair: Sides, shift: float, roll: float, search: Search) -> tuple[ContactAtShift, bool]:
    """Return the contact of each wheel by itself at a given roll; the flag as in `_touch`."""
    found = _both(pair, shift, roll, search)
    if not all(math.isfinite(gap) for gap, _, _ in found):
        raise ValueError(f"With the wheelset {1e3 * shift:g} mm to the left a wheel stands beside its rail.")
    positions = [position for _, position, _ in found]
    ends = list(zip((LEFT, RIGHT), pair.both, positions, strict=True))
    radius = [one.radius - float(one.wheel.height(np.array(s))) for _, one, s in ends]
    angle = [math.atan(float(one.wheel.height(np.array(s), 1))) + side * roll for side, one, s in ends]
    contact = ContactAtShift(shift, roll, (positions[0], positions[1]), (radius[0], radius[1]), (angle[0], angle[1]))
    return contact, all(inside for _, _, inside in found)


def contact_at(pair: Sides, shift: float, rolls: bool = True) -> ContactAtShift:
    """Return the contact of rigid profiles at any place of the contour (one-sided: no penetration), section 4.3.

    Beyond the flange contact no balance exists. The roll of a wheel that climbs by dz moves its contact sideways by
    r/2b dz. This is more than the flange recedes, and the search ends on the flange's tip.

    Takes shift [m].
    """
    left, right = (np.arange(*side.wheel.limits, GRID) for side in pair.both)
    return _touch(pair, shift, (left, right))[0] if rolls else _contact(pair, shift, 0.0, (left, right))[0]


#: Largest shift up to which contacts are searched [m].
LARGEST_SHIFT = 15e-3
#: A contact as steep as this lies on the flange [rad].
ON_FLANGE = math.radians(30.0)


def flange_contact_shift(pair: Sides, rolls: bool = True) -> float:
    """Return the shift [m] to the left at which the contact moves from the tread to the flange, as in Fig. 4.8.

    It is infinite if the contact stays on the tread, and 0 if it is on the flange from the start. For the shift to the
    right use `pair.mirrored`.
    """

    def on_flange(shift: float) -> float:
        return 1.0 if max(contact_at(pair, shift, rolls).angle) > ON_FLANGE else -1.0

    if on_flange(0.0) > 0.0:
        return 0.0
    for shift in np.arange(0.0, LARGEST_SHIFT, 0.5e-3).tolist():
        if on_flange(shift + 0.5e-3) > 0.0:
            return float(brentq(on_flange, shift, shift + 0.5e-3, xtol=1e-6))
    return math.inf


#: Chord over which a flange is as steep as its angle [m]; the spline's ripples at the flange's corners are shorter.
FLANGE_CHORD = 1e-3
#: Shift at which the roll of a wheelset on its treads is taken [m].
SMALL_SHIFT = 1e-3


@dataclass(frozen=True)
class Flange:
    """A wheel's flange on its rail.

    `angle` [rad] is its slope; `depth` [m] is the distance of the contact below the rail's top. `roll_by_shift` [rad/m]
    is the roll of the wheelset over its shift while it runs on its treads.
    """

    angle: float
    depth: float
    roll_by_shift: float


@lru_cache
def flange_of(pair: Pair) -> Flange:
    """Return the flange contact: where the gauge face is as steep as the flange, beside a tread contact.

    Section 9.4.1.
    """
    low, high = pair.wheel.limits
    begin = np.arange(low, high - FLANGE_CHORD, GRID)
    slope = float(np.max(pair.wheel.height(begin + FLANGE_CHORD) - pair.wheel.height(begin))) / FLANGE_CHORD
    face = np.arange(pair.rail.limits[0], 0.0, GRID)
    place = face[np.argmin(np.abs(pair.rail.height(face, 1) - slope))]
    roll = contact_at(pair, SMALL_SHIFT).roll
    return Flange(math.atan(slope), -float(pair.rail.height(place)), roll / SMALL_SHIFT)


#: Half width and pitch of the search around the previous tread contact while it is followed [m].
FOLLOW, FOLLOW_GRID = 0.1e-3, 2e-6


def last_tread_contact(pair: Sides, largest: float = LARGEST_SHIFT, step: float = 20e-6) -> ContactAtShift:
    """Return the contact at the largest shift to the left with a tread contact; a fold lies within `step` [m].

    At a fold the curvatures of wheel and rail sum to zero. The tread contact is followed even if the flange already
    touches, as the bilateral contact constraints of the thesis do. The thesis's program breaks down at the fold and
    reports a derailment (section 9.4.1).
    """
    around = np.arange(-FOLLOW, FOLLOW, FOLLOW_GRID)
    last = contact_at(pair, 0.0)
    for number in range(1, int(largest / step)):
        search = (last.position[0] + around, last.position[1] + around)
        contact, inside = _touch(pair, number * step, search)
        if not inside:
            break
        last = contact
    return last


def rolling_radius_difference(pair: Sides, shifts: np.ndarray, rolls: bool = True) -> np.ndarray:
    """Return r_left - r_right [m] at the shifts [m], Fig. 4.8."""
    return np.array([contact_at(pair, shift, rolls).radius_difference for shift in shifts])


#: Step of the shift in the search for a zero of the radius difference of unequal sides, and its largest value [m].
CENTRE_STEP, LARGEST_CENTRE = 0.5e-3, 25e-3
#: Radius differences below the first are noise of the search [m]. Conicities below the second do not guide.
NOISE, UNGUIDED = 1e-9, 1e-9


def centred_shift(pair: Sides, rolls: bool = True) -> float:
    """Return the shift [m] at which both wheels roll on equal radii, the centre of motion (EN 15302:2008, y_em).

    It is 0 for equal sides. This project decides: of several zeros of the radius difference, the one nearest to the
    middle of the track, as for equal sides; if the difference jumps over 0, the jump.
    """
    if pair.left == pair.right:
        return 0.0

    def difference(shift: float) -> float:
        return contact_at(pair, shift, rolls).radius_difference

    reached = {LEFT: (0.0, difference(0.0)), RIGHT: (0.0, difference(0.0))}
    if abs(reached[LEFT][1]) < NOISE:
        return 0.0
    for number in range(1, round(LARGEST_CENTRE / CENTRE_STEP) + 1):
        zeros = []
        for side, (last, before) in reached.items():
            shift = side * number * CENTRE_STEP
            reached[side] = (shift, difference(shift))
            if reached[side][1] * before <= 0.0:
                zeros.append(float(brentq(difference, last, shift, xtol=NOISE)))
        if zeros:
            return min(zeros, key=abs)
    raise ValueError(
        f"Within {1e3 * LARGEST_CENTRE:g} mm of the middle of the track the wheels nowhere roll on equal radii: they"
        f" differ by {1e3 * difference(0.0):.3g} mm there. Give radii that are closer, or profiles that are steeper."
    )


#: Longest step of the shift [m], half of the step in which EN 15302 tabulates Dr. Its values include the effect of such
#: a step on a jump. With jumps to the micrometre, E2 at 3.0 mm is 0.0282 (limit 0.029) and E3 at 2.6 mm 0.1145 (limit
#: 0.112).
STEP = 0.05e-3
#: Points of the integral over a half wave.
PHASES = 2000


@dataclass(frozen=True)
class Guidance:
    """Dr over the shift, both from the centre of rolling y_em [m], linear between its points, and its integral.

    `shift` is that of the axle. `moved` is that of the contacts, y + r0 roll(y). The integral S(y) is taken over it,
    from the centre, where it is 0 (EN 15302:2008, annex B).
    """

    shift: np.ndarray
    moved: np.ndarray
    difference: np.ndarray
    area: np.ndarray

    def area_at(self, eta: np.ndarray) -> np.ndarray:
        """Return the integral of Dr from the centre to the displacement `eta` of the contacts [m2]."""
        i = np.clip(np.searchsorted(self.moved, eta, "right") - 1, 0, self.moved.size - 2)
        mean = (self.difference[i] + np.interp(eta, self.moved, self.difference)) / 2
        return self.area[i] + (eta - self.moved[i]) * mean

    def middle(self, reach: float) -> float:
        """Return the middle of the wave that is 2 `reach` wide, from the centre [m]: S is equal at both its ends.

        If several exist, it is the one nearest to the centre. If no such wave is within the points, it is the centre.
        """

        def unequal(middle: np.ndarray) -> np.ndarray:
            return self.area_at(middle + reach) - self.area_at(middle - reach)

        places = np.unique(np.concatenate([[0.0], self.moved + reach, self.moved - reach]))
        seen = (places - reach >= self.moved[0]) & (places + reach <= self.moved[-1])
        places = places[seen & (np.abs(places) <= reach)]
        found = unequal(places)
        if places.size == 0 or np.any((places == 0.0) & (found == 0.0)):
            return 0.0
        turns = np.flatnonzero(found[1:] * found[:-1] <= 0.0)
        zeros = [float(brentq(unequal, places[i], places[i + 1], xtol=1e-15)) for i in turns]
        return min(zeros, key=abs, default=0.0)

    def conicity(self, reach: float) -> float:
        """Return tan(gamma_e) of the wave that moves the contacts by `reach` to both sides of its middle [m]."""
        # Midpoints in the phase angle: the integrand is bounded there, also where the radius difference jumps.
        angle = (np.arange(PHASES) + 0.5) * (math.pi / 2) / PHASES
        sine, cosine = np.sin(angle), np.cos(angle)
        middle = self.middle(reach)
        slowness, moment = [], 0.0
        for side in (LEFT, RIGHT):
            end, place = np.array(middle + side * reach), middle + side * reach * sine
            # The cone that would be as fast at each phase, from the remaining area: on a cone this is gamma eta^2.
            local = (self.area_at(end) - self.area_at(place)) / (reach * cosine) ** 2
            slowness.append(math.inf if np.min(local) <= UNGUIDED else float(np.mean(1 / np.sqrt(local))))
            moment += side * float(np.mean(sine * cosine * np.interp(place, self.moved, self.difference))) * math.pi / 4
        return float(np.mean(slowness)) ** -2 if math.isfinite(sum(slowness)) else 1.5 * moment / reach


def guidance(pair: Sides, largest: float, points: int | None = None, rolls: bool = True) -> Guidance:
    """Return Dr about the centre of rolling, in the middle of `points` - 1 equal steps up to the shift `largest` [m].

    EN 15302:2008, annex B. Unequal sides do not guide the wheelset equally. To the softer side Dr is followed further,
    until S equals its value at `largest` on the other side. Every wave up to this amplitude is then within the points.
    """
    count = points - 1 if points else math.ceil(largest / STEP - 1e-6)
    outward = [*((np.arange(count) + 0.5) * largest / count), largest]
    centre = centred_shift(pair, rolls)
    upright = contact_at(pair, centre, rolls).roll

    def row(shift: float) -> tuple[float, float, float]:
        contact = contact_at(pair, centre + shift, rolls)
        difference = contact.radius_difference
        return shift, shift + pair.mean_radius * (contact.roll - upright), difference * (abs(difference) >= NOISE)

    halves = {LEFT: [(0.0, 0.0, 0.0), *(row(shift) for shift in outward)]}
    if pair.left == pair.right:
        halves[RIGHT] = [(-shift, -moved, -difference) for shift, moved, difference in halves[LEFT]]
    else:
        halves[RIGHT] = [(0.0, 0.0, 0.0), *(row(-shift) for shift in outward)]
        softer = min(halves, key=lambda side: _area(halves[side])[-1])
        enough = _area(halves[-softer])[-1]
        for shift in outward:
            if _area(halves[softer])[-1] >= enough:
                break
            halves[softer].append(row(softer * (largest + shift)))
    shift, moved, difference = np.array([*halves[RIGHT][:0:-1], *halves[LEFT]]).T
    area = np.concatenate([_area(halves[RIGHT])[:0:-1], _area(halves[LEFT])])
    return Guidance(shift, moved, difference, area)


def _area(half: list[tuple[float, float, float]]) -> np.ndarray:
    """Return the integral of Dr over the movement of the contacts, from the first row to each [m2]."""
    _, moved, difference = np.array(half).T
    return np.concatenate([[0.0], np.cumsum(np.diff(moved) * (difference[1:] + difference[:-1]) / 2)])


def equivalent_conicity(
    pair: Sides, amplitudes: np.ndarray, rolls: bool = True, points: int | None = None
) -> np.ndarray:
    """Return tan(gamma_e): the cone with the wavelength, eq. (2.1), of the real profiles.

    The wave eta(x) obeys eta'' = -Dr / (e r0), with e = 2 wheel_half_distance. Its period follows from one integral
    over the amplitude (EN 15302:2008, annex B, which omits the roll: rolls False). eta is the shift of the contacts, y
    + r0 roll(y). Without lateral creep, the yaw turns into their speed, not into that of the axle. On cones gamma and
    crowns R, 2b apart, Dr / 2y = gamma (b + R gamma) / (b - r0 gamma) and eta / y = b / (b - r0 gamma). The result is
    gamma (1 + R gamma / b).

    Unequal sides: the wave runs about the shift at which the radii are equal (`centred_shift`). Its positive and its
    negative half wave differ. S, the integral of Dr, is equal at its ends, and its amplitude is half the distance
    between them. This gives the cases E5 to E9 of annex E, wheels of 918 and 920 mm and A with B.

    Dr is taken in the middle of `points` - 1 equal steps up to the largest amplitude and is linear between them, which
    smears its jumps over a step.

    A wheelset that starts at rest at the amplitude does not cross the centre if Dr has changed its sign. It oscillates
    about another point, moves away, or, if Dr is 0, stays. Annex B gives no result there. The function then returns
    that of annex C, half the slope of the line that fits Dr best between the ends. This is 0 if the wheelset is not
    guided, and negative if it is driven outwards.

    Takes amplitudes [m] (n,); returns [1].
    """
    amplitudes = np.asarray(amplitudes, float)
    if not np.all(amplitudes > 0.0):
        raise ValueError(f"All amplitudes must be above 0 m; got {np.min(amplitudes):g} m. Leave it out.")
    along = guidance(pair, float(np.max(amplitudes)), points, rolls)
    moved = [np.interp(side * amplitudes, along.shift, along.moved) for side in (LEFT, RIGHT)]
    return np.array([along.conicity(float(reach)) for reach in (moved[0] - moved[1]) / 2])
