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
#: Largest roll that the search allows [rad]; a wheel that has climbed its flange rolls the wheelset by 0.03.
ROLL_LIMIT = 0.05


@dataclass(frozen=True)
class Pair:
    """Two equal wheels on two equal rails [m]: half the distances of the two wheels' and of the two rails' y = 0."""

    wheel: Profile
    rail: Profile
    radius: float
    wheel_half_distance: float
    rail_half_distance: float

    def gap(self, side: int, shift: float, roll: float, s: np.ndarray) -> np.ndarray:
        """Height of the wheel contour over the rail at the positions s, up to the height of the axle."""
        outward = self.wheel_half_distance + s
        below = self.radius - self.wheel.height(s)
        lateral = side * outward * math.cos(roll) + below * math.sin(roll)
        height = side * outward * math.sin(roll) - below * math.cos(roll)
        on_rail = side * (lateral + shift) - self.rail_half_distance
        gap = height - self.rail.height(on_rail)
        return np.where(np.isnan(gap), np.inf, gap)


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
class Contact:
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


def _lowest(pair: Pair, side: int, shift: float, roll: float, s: np.ndarray) -> tuple[float, float, bool]:
    """Smallest gap over the positions s, where it is, and whether it lies inside the range."""
    gap = pair.gap(side, shift, roll, s)
    i = int(np.argmin(gap))
    if i in (0, s.size - 1) or not np.all(np.isfinite(gap[i - 1 : i + 2])):
        return float(gap[i]), float(s[i]), False
    before, here, after = gap[i - 1 : i + 2]
    bend = before - 2 * here + after
    offset = 0.5 * (before - after) / bend if bend > 0 else 0.0
    return float(here - 0.25 * (before - after) * offset), float(s[i] + offset * (s[1] - s[0])), True


def _touch(pair: Pair, shift: float, search: tuple[np.ndarray, np.ndarray]) -> tuple[Contact, bool]:
    """Contact at the roll at which both gaps are equal; the flag: both contacts lie inside their search range."""

    def difference(roll: float) -> float:
        left, right = (_lowest(pair, side, shift, roll, s)[0] for side, s in zip((LEFT, RIGHT), search, strict=True))
        return left - right

    roll = float(brentq(difference, -ROLL_LIMIT, ROLL_LIMIT, xtol=1e-14))
    return _contact(pair, shift, roll, search)


def _contact(pair: Pair, shift: float, roll: float, search: tuple[np.ndarray, np.ndarray]) -> tuple[Contact, bool]:
    """Contact of each wheel for itself at a given roll; the flag as in `_touch`."""
    found = [_lowest(pair, side, shift, roll, s) for side, s in zip((LEFT, RIGHT), search, strict=True)]
    s = np.array([found[0][1], found[1][1]])
    radius = pair.radius - pair.wheel.height(s)
    angle = np.arctan(pair.wheel.height(s, 1)) + roll * np.array([LEFT, RIGHT])
    contact = Contact(shift, roll, (s[0], s[1]), (radius[0], radius[1]), (angle[0], angle[1]))
    return contact, found[0][2] and found[1][2]


def contact_at(pair: Pair, shift: float, rolls: bool = True) -> Contact:
    """Contact of rigid profiles, wherever on the contour it is (one-sided: nothing penetrates), section 4.3.

    shift [m]: of the axle.

    Beyond the flange contact there is no balance: as the wheel climbs by dz, the roll moves its contact sideways by
    r/2b dz, more than the flange recedes, and the search ends on the flange's tip.

    rolls False: the wheelset stays level, as EN 15302 assumes for the equivalent conicity.
    """
    low, high = pair.wheel.limits
    grid = np.arange(low, high, GRID)
    return _touch(pair, shift, (grid, grid))[0] if rolls else _contact(pair, shift, 0.0, (grid, grid))[0]


def flange_contact_shift(pair: Pair, largest: float = 15e-3) -> float:
    """Shift [m] at which the contact leaves the tread for the flange, as in Fig. 4.8; infinite if it stays.

    On the flange: angle above 30 degrees.
    """

    def on_flange(shift: float) -> float:
        return 1.0 if max(contact_at(pair, shift).angle) > math.radians(30.0) else -1.0

    for shift in np.arange(0.0, largest, 0.5e-3).tolist():
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


def last_tread_contact(pair: Pair, largest: float = 15e-3, step: float = 20e-6) -> Contact:
    """The contact at the largest shift at which a tread contact exists; beyond lies a fold, to within `step` [m].

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


def rolling_radius_difference(pair: Pair, shifts: np.ndarray, rolls: bool = True) -> np.ndarray:
    """r_left - r_right [m] at the shifts [m], Fig. 4.8."""
    return np.array([contact_at(pair, shift, rolls).radius_difference for shift in shifts])


#: Longest step of the shift [m], half of that in which EN 15302 tabulates Dr. Its values carry what such a step makes
#: of a jump: with jumps to the micrometre E2 at 3.0 mm is 0.0282 (limit 0.029) and E3 at 2.6 mm 0.1145 (limit 0.112).
STEP = 0.05e-3
#: Points of the integral over a quarter wave.
PHASES = 2000
#: Radius differences below this are noise of the search [m], and conicities below the other guide nothing.
NOISE, UNGUIDED = 1e-9, 1e-9


def equivalent_conicity(
    pair: Pair, amplitudes: np.ndarray, rolls: bool = True, points: int | None = None
) -> np.ndarray:
    """tan(gamma_e) at the amplitudes [m], shape (n,): the cone whose wavelength, eq. (2.1), is the real profiles'.

    The wave eta(x) obeys eta'' = -Dr / (e r0), with e = 2 wheel_half_distance; its period follows from one integral
    over the amplitude (EN 15302:2008, annex B, which leaves the roll out: rolls False). eta is the shift of the
    contacts, y + r0 roll(y): free of lateral creep, it is their speed that the yaw turns into, and not the axle's.
    On cones gamma and crowns R, 2b apart, Dr / 2y = gamma (b + R gamma) / (b - r0 gamma) and eta / y =
    b / (b - r0 gamma) leave gamma (1 + R gamma / b).

    Dr is taken in the middle of `points` - 1 equal steps up to the largest amplitude and is linear between them, which
    smears its jumps over a step. Raises ValueError for an amplitude that is not above 0.

    A wheelset that starts at rest at the amplitude does not cross the centre where Dr has turned: it oscillates about
    another point, moves away, or, where Dr is 0, stays. Annex B has no answer there; returned is that of annex C, half
    the slope of the line through the origin that fits Dr best up to the amplitude: 0 where nothing guides the wheelset,
    negative where it is driven outwards.
    """
    amplitudes = np.asarray(amplitudes, float)
    if not np.all(amplitudes > 0.0):
        raise ValueError(f"Give amplitudes above 0 m: the smallest was {np.min(amplitudes):g} m.")
    largest = float(np.max(amplitudes))
    edges = np.linspace(0.0, largest, points or 1 + math.ceil(largest / STEP - 1e-6))
    shifts = np.concatenate([[0.0], (edges[1:] + edges[:-1]) / 2, [largest]])
    contacts = [contact_at(pair, shift, rolls) for shift in shifts]
    moved = shifts + pair.radius * np.array([contact.roll for contact in contacts])
    difference = np.array([contact.radius_difference for contact in contacts])
    difference[np.abs(difference) < NOISE] = 0.0
    areas = np.concatenate([[0.0], np.cumsum(np.diff(moved) * (difference[1:] + difference[:-1]) / 2)])

    def area(eta: np.ndarray) -> np.ndarray:
        """Integral of Dr from the centre to where the contacts have moved [m2]."""
        i = np.clip(np.searchsorted(moved, eta, "right") - 1, 0, moved.size - 2)
        return areas[i] + (eta - moved[i]) * (difference[i] + np.interp(eta, moved, difference)) / 2

    # Midpoints in the phase angle: the integrand is bounded there, also where the radius difference jumps.
    angle = (np.arange(PHASES) + 0.5) * (math.pi / 2) / PHASES
    sine, cosine = np.sin(angle), np.cos(angle)

    def conicity(reach: float) -> float:
        # The cone that would be as fast at each phase: what is left of the area, which on a cone is gamma eta^2.
        local = (area(np.array(reach)) - area(reach * sine)) / (reach * cosine) ** 2
        if np.min(local) > UNGUIDED:
            return float(np.mean(1 / np.sqrt(local)) ** -2)
        moment = np.mean(sine * cosine * np.interp(reach * sine, moved, difference)) * math.pi / 2
        return float(1.5 * moment / reach)

    return np.array([conicity(float(reach)) for reach in np.interp(amplitudes, shifts, moved)])
