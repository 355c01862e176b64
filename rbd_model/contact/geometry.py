"""Where wheels and rails touch when a wheelset is shifted sideways: rolling radii, contact angles, conicity, the fold.

Rigid profiles, no yaw: the contact points lie in the vertical plane through the axle, so this is a problem in that
plane. Left is positive. Section 4.3, Figs 4.7 and 4.8.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import brentq

from rbd_model.contact.profiles import Profile, rail_60e1, rail_60kg, wheel_cone_120, wheel_s1002

#: Pitch of the search grid on the contour [m]; a parabola through three points refines it to better than 1 um.
GRID = 0.02e-3
LEFT, RIGHT = 1, -1
#: Rolls within which the balance is looked for, one after the other [rad]: a wheelset on its treads rolls by 0.001, and
#: one that has climbed its flange, which balances too, by 0.03.
ROLL_LIMITS = (0.002, 0.004, 0.008, 0.016, 0.05)


@dataclass(frozen=True)
class Side:
    """A wheel on its rail [m]: its radius at y = 0, and how far the y = 0 of wheel and rail lie from the middle."""

    wheel: Profile
    rail: Profile
    radius: float
    wheel_half_distance: float
    rail_half_distance: float

    def gap(self, side: int, shift: float, roll: float, s: np.ndarray, heights: np.ndarray | None = None) -> np.ndarray:
        """Height of the wheel contour over the rail at the positions s, up to the height of the axle.

        Infinite beside the rail. heights: of the wheel's profile at s, where they are known.
        """
        gap = np.full(s.shape, np.inf)
        # Only what can lie over the rail is computed: the roll moves no point of the wheel sideways by more than this.
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
    """A wheelset on its track: two sides that may differ in wheel, rail, radius and distances."""

    left: Side
    right: Side

    @property
    def both(self) -> tuple[Side, Side]:
        """Left and right."""
        return self.left, self.right

    @property
    def mirrored(self) -> Sides:
        """Left and right exchanged: it shifts and rolls the other way."""
        return Sides(self.right, self.left)

    @property
    def mean_radius(self) -> float:
        """Of both wheels at y = 0 [m] (r0)."""
        return (self.left.radius + self.right.radius) / 2


class Pair(Sides):
    """Equal sides, which is what the vehicles have: a wheel on a rail, and the half distances of either's y = 0 [m]."""

    def __init__(
        self, wheel: Profile, rail: Profile, radius: float, wheel_half_distance: float, rail_half_distance: float
    ) -> None:
        side = Side(wheel, rail, radius, wheel_half_distance, rail_half_distance)
        super().__init__(side, side)

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
        """Of both wheels at y = 0 [m]."""
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
    """Synthetic wheel on the 60 kg rail: contact points 1140 mm apart (section 4.3), r0 = 0.425 m (section 4.4)."""
    return Pair(wheel_cone_120(), rail_60kg(), 0.425, 0.570, 0.570)


def synthetic_pair() -> Pair:
    """The same profiles on standard gauge: contact points 1.5 m apart, r0 = 0.46 m, as the Manchester vehicles have.

    Assumed, in the place of S1002 on UIC 60, whose contact jumps: one point a wheel does not follow it.
    """
    return Pair(wheel_cone_120(), rail_60kg(), 0.460, 0.750, 0.750)


#: Depth below the top of the rails at which the gauge is measured (EN 13848-1), and the standard gauge [m].
GAUGE_DEPTH, STANDARD_GAUGE = 14e-3, 1.435


def gauge_face(rail: Profile) -> float:
    """y of the gauge face, GAUGE_DEPTH below the highest point of the rail as it is laid (EN 13848-1) [m]."""
    y = np.linspace(*rail.limits, 100001)
    height = rail.height(y)
    return float(y[np.argmax(height > np.max(height) - GAUGE_DEPTH)])


def european_pair() -> Pair:
    """S1002 (EN 13715) on 60E1 (EN 13674-1) 1:40, gauge 1435 mm, tape circles 1500 mm apart, r0 = 0.46 m.

    The head is 72 mm wide where the gauge is measured, but inclined, its gauge face lies at y = -35.5 mm, not -36.
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
    """Smallest gap over the positions s, where it is, and whether it lies inside the range."""
    gap = one.gap(side, shift, roll, s)
    i = int(np.argmin(gap))
    if i in (0, s.size - 1) or not np.all(np.isfinite(gap[i - 1 : i + 2])):
        return float(gap[i]), float(s[i]), False
    before, here, after = gap[i - 1 : i + 2]
    bend = before - 2 * here + after
    offset = 0.5 * (before - after) / bend if bend > 0 else 0.0
    return float(here - 0.25 * (before - after) * offset), float(s[i] + offset * (s[1] - s[0])), True


def _both(pair: Sides, shift: float, roll: float, search: Search) -> list[tuple[float, float, bool]]:
    """`_lowest` of the left and of the right wheel."""
    left = _lowest(pair.left, LEFT, shift, roll, search[0])
    return [left, _lowest(pair.right, RIGHT, shift, roll, search[1])]


def _touch(pair: Sides, shift: float, search: Search) -> tuple[ContactAtShift, bool]:
    """Contact at the roll at which both gaps are equal; the flag: both contacts lie inside their search range."""

    def difference(roll: float) -> float:
        left, right = _both(pair, shift, roll, search)
        return left[0] - right[0]

    within = next((limit for limit in ROLL_LIMITS if difference(-limit) * difference(limit) <= 0.0), ROLL_LIMITS[-1])
    roll = float(brentq(difference, -within, within, xtol=1e-14))
    return _contact(pair, shift, roll, search)


def _contact(pair: Sides, shift: float, roll: float, search: Search) -> tuple[ContactAtShift, bool]:
    """Contact of each wheel for itself at a given roll; the flag as in `_touch`."""
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
    """Contact of rigid profiles, wherever on the contour it is (one-sided: nothing penetrates), section 4.3.

    shift [m]: of the axle.

    Beyond the flange contact there is no balance: as the wheel climbs by dz, the roll moves its contact sideways by
    r/2b dz, more than the flange recedes, and the search ends on the flange's tip.

    rolls False: the wheelset stays level, as EN 15302 assumes for the equivalent conicity.
    """
    left, right = (np.arange(*side.wheel.limits, GRID) for side in pair.both)
    return _touch(pair, shift, (left, right))[0] if rolls else _contact(pair, shift, 0.0, (left, right))[0]


#: Contacts are looked for up to this shift [m].
LARGEST_SHIFT = 15e-3
#: A contact as steep as this lies on the flange [rad].
ON_FLANGE = math.radians(30.0)


def flange_contact_shift(pair: Sides, rolls: bool = True) -> float:
    """Shift [m] to the left at which the contact leaves the tread for the flange, as in Fig. 4.8.

    Infinite if it stays on the tread, 0 if it is on the flange from the start. To the right: that of `pair.mirrored`.
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
    """A wheel's flange on its rail: its angle [rad], how far below the rail's top they touch [m], and the roll of the
    wheelset, which stands on its treads until then, by its shift [rad/m].
    """

    angle: float
    depth: float
    roll_by_shift: float


@lru_cache
def flange_of(pair: Pair) -> Flange:
    """They touch where the rail's gauge face is as steep as the flange, beside a tread contact (section 9.4.1)."""
    low, high = pair.wheel.limits
    begin = np.arange(low, high - FLANGE_CHORD, GRID)
    slope = float(np.max(pair.wheel.height(begin + FLANGE_CHORD) - pair.wheel.height(begin))) / FLANGE_CHORD
    face = np.arange(pair.rail.limits[0], 0.0, GRID)
    place = face[np.argmin(np.abs(pair.rail.height(face, 1) - slope))]
    roll = contact_at(pair, SMALL_SHIFT).roll
    return Flange(math.atan(slope), -float(pair.rail.height(place)), roll / SMALL_SHIFT)


#: Half width and pitch of the search around the last tread contact, when it is followed [m].
FOLLOW, FOLLOW_GRID = 0.1e-3, 2e-6


def last_tread_contact(pair: Sides, largest: float = LARGEST_SHIFT, step: float = 20e-6) -> ContactAtShift:
    """The contact at the largest shift to the left at which a tread contact exists; a fold lies within `step` [m].

    There the curvatures of wheel and rail sum to zero. Follows the tread contact even where the flange already touches,
    as the bilateral contact constraints of the thesis do; its program breaks down at the fold and calls it derailment
    (section 9.4.1).
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
    """r_left - r_right [m] at the shifts [m], Fig. 4.8."""
    return np.array([contact_at(pair, shift, rolls).radius_difference for shift in shifts])


#: Shifts between which a radius difference of unequal sides is first looked for a zero, and how far out [m].
CENTRE_STEP, LARGEST_CENTRE = 0.5e-3, 25e-3
#: Radius differences below this are noise of the search [m], and conicities below the other guide nothing.
NOISE, UNGUIDED = 1e-9, 1e-9


def centred_shift(pair: Sides, rolls: bool = True) -> float:
    """Shift [m] at which both wheels roll on equal radii, about which the wheelset runs (EN 15302:2008, y_em).

    0 for equal sides. Decided here: of several zeros of the radius difference the nearest to the middle of the track,
    as for equal sides; where it jumps over 0, the jump. Raises ValueError where there is none up to LARGEST_CENTRE.
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


#: Longest step of the shift [m], half of that in which EN 15302 tabulates Dr. Its values carry what such a step makes
#: of a jump: with jumps to the micrometre E2 at 3.0 mm is 0.0282 (limit 0.029) and E3 at 2.6 mm 0.1145 (limit 0.112).
STEP = 0.05e-3
#: Points of the integral over a half wave.
PHASES = 2000


@dataclass(frozen=True)
class Guidance:
    """Dr over the shift, both from the centre of rolling y_em [m], linear between its points, and its integral.

    `shift` is the axle's, `moved` that of the contacts, y + r0 roll(y), over which the integral S(y) is taken, from the
    centre, where it is 0 (EN 15302:2008, annex B).
    """

    shift: np.ndarray
    moved: np.ndarray
    difference: np.ndarray
    area: np.ndarray

    def area_at(self, eta: np.ndarray) -> np.ndarray:
        """Integral of Dr from the centre to where the contacts have moved [m2]."""
        i = np.clip(np.searchsorted(self.moved, eta, "right") - 1, 0, self.moved.size - 2)
        mean = (self.difference[i] + np.interp(eta, self.moved, self.difference)) / 2
        return self.area[i] + (eta - self.moved[i]) * mean

    def middle(self, reach: float) -> float:
        """Middle of the wave that is 2 `reach` wide, from the centre [m]: S is equal at both its ends.

        Of several the nearest to the centre; the centre, where no such wave is seen.
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
        """tan(gamma_e) of the wave that moves the contacts by `reach` to both sides of its middle [m]."""
        # Midpoints in the phase angle: the integrand is bounded there, also where the radius difference jumps.
        angle = (np.arange(PHASES) + 0.5) * (math.pi / 2) / PHASES
        sine, cosine = np.sin(angle), np.cos(angle)
        middle = self.middle(reach)
        slowness, moment = [], 0.0
        for side in (LEFT, RIGHT):
            end, place = np.array(middle + side * reach), middle + side * reach * sine
            # The cone that would be as fast at each phase: what is left of the area, which on a cone is gamma eta^2.
            local = (self.area_at(end) - self.area_at(place)) / (reach * cosine) ** 2
            slowness.append(math.inf if np.min(local) <= UNGUIDED else float(np.mean(1 / np.sqrt(local))))
            moment += side * float(np.mean(sine * cosine * np.interp(place, self.moved, self.difference))) * math.pi / 4
        return float(np.mean(slowness)) ** -2 if math.isfinite(sum(slowness)) else 1.5 * moment / reach


def guidance(pair: Sides, largest: float, points: int | None = None, rolls: bool = True) -> Guidance:
    """Dr about the centre of rolling, in the middle of `points` - 1 equal steps up to the shift `largest` [m].

    EN 15302:2008, annex B. Unequal sides do not hold the wheelset equally: to the softer one Dr is followed further,
    until S is what it is at `largest` on the other, so that every wave up to this amplitude is there.
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
    """Integral of Dr over the movement of the contacts, from the first row to each [m2]."""
    _, moved, difference = np.array(half).T
    return np.concatenate([[0.0], np.cumsum(np.diff(moved) * (difference[1:] + difference[:-1]) / 2)])


def equivalent_conicity(
    pair: Sides, amplitudes: np.ndarray, rolls: bool = True, points: int | None = None
) -> np.ndarray:
    """tan(gamma_e) at the amplitudes [m], shape (n,): the cone whose wavelength, eq. (2.1), is the real profiles'.

    The wave eta(x) obeys eta'' = -Dr / (e r0), with e = 2 wheel_half_distance; its period follows from one integral
    over the amplitude (EN 15302:2008, annex B, which leaves the roll out: rolls False). eta is the shift of the
    contacts, y + r0 roll(y): free of lateral creep, it is their speed that the yaw turns into, and not the axle's.
    On cones gamma and crowns R, 2b apart, Dr / 2y = gamma (b + R gamma) / (b - r0 gamma) and eta / y =
    b / (b - r0 gamma) leave gamma (1 + R gamma / b).

    Unequal sides: the wave runs about the shift at which the radii are equal (`centred_shift`), and its positive and
    its negative half wave differ. Its ends are those at which S, the integral of Dr, is equal, and its amplitude is
    half the distance between them: so come out the cases E5 to E9 of annex E, wheels of 918 and 920 mm and A with B.

    Dr is taken in the middle of `points` - 1 equal steps up to the largest amplitude and is linear between them, which
    smears its jumps over a step. Raises ValueError for an amplitude that is not above 0, and as `centred_shift`.

    A wheelset that starts at rest at the amplitude does not cross the centre where Dr has turned: it oscillates about
    another point, moves away, or, where Dr is 0, stays. Annex B has no answer there; returned is that of annex C, half
    the slope of the line that fits Dr best between the ends: 0 where nothing guides the wheelset, negative where it is
    driven outwards.
    """
    amplitudes = np.asarray(amplitudes, float)
    if not np.all(amplitudes > 0.0):
        raise ValueError(f"Give amplitudes above 0 m: the smallest was {np.min(amplitudes):g} m.")
    along = guidance(pair, float(np.max(amplitudes)), points, rolls)
    moved = [np.interp(side * amplitudes, along.shift, along.moved) for side in (LEFT, RIGHT)]
    return np.array([along.conicity(float(reach)) for reach in (moved[0] - moved[1]) / 2])
