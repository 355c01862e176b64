"""The rails in space: straight ones and those of a line, which chapter 3 does not have but whose equations bear them.

The inertial frame of section 3.2.1 stands somewhere on the line. The centre line is C(D) with axes T(D): along, to the
left, upwards. Both come from the columns of the line by series in D alone, without any equation of the turning of axes,
so that nothing here is shared with the fast model.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

import numpy as np
from scipy.interpolate import BPoly, CubicHermiteSpline, PPoly

from rbd_model.contact.profiles import Profile
from rbd_model.thesis.surfaces import ORDERS, RailSurface, rail_surface
from rbd_model.track.line import GAUGE, Line

#: Factors between the coefficients of a series and derivatives.
FACTORIALS = np.array([math.factorial(order) for order in range(ORDERS)], dtype=float)
#: Places and weights of Gauss's quadrature, exact to round-off over the few hundredths of a radian between two rows.
PLACES, WEIGHTS = np.polynomial.legendre.leggauss(8)
#: Way [m] below which the search for a distance ends, after which its error is the square, and its largest number of
#: rounds.
FOUND, MAXIMUM_ROUNDS = 1e-9, 20


@dataclass(frozen=True)
class Section:
    """The line at a distance, with three derivatives by it: C [m], T of section 3.2.1, and what it moves its rails by.

    origin (4, 3); axes (4, 3, 3), columns along, to the left, upwards; shifts (4, 3) [m]: of both rails to the left, of
    the left and of the right one upwards; spread (4,) [m]: of each rail, outwards.
    """

    origin: np.ndarray
    axes: np.ndarray
    shifts: np.ndarray
    spread: np.ndarray

    def from_origin(self, position: np.ndarray) -> np.ndarray:
        """Components along T of the way from C to a position in space, after (3.1), shape (3,) [m]."""
        return np.asarray((position - self.origin[0]) @ self.axes[0])

    @property
    def turning(self) -> np.ndarray:
        """Angular velocity of T for each metre of D, in T, eqs (3.7)-(3.12) turned round, shape (3,) [rad/m]."""
        skew = self.axes[0].T @ self.axes[1]
        return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


@dataclass(frozen=True)
class Distance:
    """Where along the line a body is whose position R (3.1) is in the section's plane: (R - C) . T e_x = 0.

    value [m]; slope (3,), bend (3, 3) [1/m]: its derivatives by R.
    """

    value: float
    slope: np.ndarray
    bend: np.ndarray


#: Lateral and vertical shift of a rail [m] at a distance [m], with its derivatives: shape (4, 2).
Shift = Callable[[float], np.ndarray]


class Rails(Protocol):
    """Rails as surfaces on the ground, and the line that they follow."""

    @property
    def curved(self) -> bool:
        """Whether there is a line."""

    def distance(self, position: np.ndarray) -> Distance:
        """Where along the line a body is."""

    def section(self, distance: float) -> Section:
        """The line there."""

    def rail(
        self, profile: Profile, half_distance: float, side: int, s: np.ndarray, at: Distance, shift: Shift
    ) -> RailSurface:
        """A rail (3.78) at its surface parameters s; at: the distance of the wheelset on it."""


class StraightRails:
    """Prisms along straight and level track, eq. (3.78), that shift with the wheelset's distance."""

    curved = False

    def distance(self, position: np.ndarray) -> Distance:
        """The x of section 3.2.1."""
        return Distance(float(position[0]), np.array([1.0, 0.0, 0.0]), np.zeros((3, 3)))

    def section(self, distance: float) -> Section:
        """The inertial axes of section 3.2.1, with an origin that goes along."""
        origin, axes = np.zeros((ORDERS, 3)), np.zeros((ORDERS, 3, 3))
        origin[0, 0], origin[1, 0], axes[0] = distance, 1.0, np.eye(3)
        return Section(origin, axes, np.zeros((ORDERS, 3)), np.zeros(ORDERS))

    def rail(
        self, profile: Profile, half_distance: float, side: int, s: np.ndarray, at: Distance, shift: Shift
    ) -> RailSurface:
        """See `rail_surface`, eq. (3.78)."""
        return rail_surface(profile, half_distance, side, s, shift(at.value))


STRAIGHT = StraightRails()


class SectionRails:
    """Prisms (3.78) along the track's axes at the wheelset's own section, as the fast model has its rails on a line."""

    curved = True

    def __init__(self, line: Line, start: float) -> None:
        """Columns become what docs/line.md says of them: cubic or quintic between the rows.

        start [m]: distance at which the inertial frame stands, which looks along the heading there. Near it coordinates
        are small: with 1e8 N/m of a flange the round-off of a place 30 m away is 1e-6 N.
        """
        rows = line.rows
        self.rows = rows["distance"]
        none = np.zeros_like(self.rows)
        left, right, widening = (rows.get(name, none) for name in ("left_lateral", "right_lateral", "gauge_widening"))
        heights = rows.get("left_vertical", none), rows.get("right_vertical", none)
        spread = (left - right + widening) / 2
        # Heading [rad] and rise [m]; sine of the roll, both rails to the left, left one up, right one up, outwards [m].
        self.turned_and_risen = integral(self.rows, np.column_stack([rows["curvature"], rows["gradient"]]))
        self.turned_and_risen.c[-1] -= self.turned_and_risen(start)
        self.smooth = quintic(self.rows, np.column_stack([-rows["cant"] / GAUGE, (left + right) / 2, *heights, spread]))
        half = np.diff(self.rows) / 2
        ways = self.forwards(self.rows[:-1, None] + half[:, None] * (1 + PLACES)) @ WEIGHTS * half
        self.plan = np.concatenate([np.zeros((2, 1)), np.cumsum(ways, axis=1)], axis=1)
        self.plan -= self.place(start)[:2, None]
        self.section = lru_cache(maxsize=64)(self._section)

    def forwards(self, distances: np.ndarray) -> np.ndarray:
        """Cosine and sine of the heading times the cosine of the slope, by section 3.2.1, shape (2, ...)."""
        heading, sine = self.turned_and_risen(distances)[..., 0], self.turned_and_risen(distances, 1)[..., 1]
        return np.asarray(np.sqrt(1 - sine**2) * np.array([np.cos(heading), np.sin(heading)]))

    def place(self, distance: float) -> np.ndarray:
        """C, shape (3,) [m]: R of (3.1) by quadrature from the row before. Raises ValueError beyond the line's ends."""
        if not self.rows[0] <= distance <= self.rows[-1]:
            raise ValueError(
                f"A wheel or body is at {distance:.6g} m; the line goes from {self.rows[0]:g} to {self.rows[-1]:g} m."
            )
        row = int(self.rows.searchsorted(distance, "right")) - 1
        half = (distance - self.rows[row]) / 2
        way = self.forwards(self.rows[row] + half * (1 + PLACES)) @ WEIGHTS * half
        return np.append(self.plan[:, row] + way, self.turned_and_risen(distance)[1])

    def _section(self, distance: float) -> Section:
        origin = np.zeros((ORDERS, 3))
        origin[0] = self.place(distance)
        integrals = np.array([self.turned_and_risen(distance, order) for order in range(ORDERS + 1)])
        columns = np.array([self.smooth(distance, order) for order in range(ORDERS)])
        series = columns / FACTORIALS[:, None]
        axes = axes_of(integrals[:-1, 0] / FACTORIALS, integrals[1:, 1] / FACTORIALS, series[:, 0])
        axes *= FACTORIALS[:, None, None]
        origin[1:] = axes[:-1, :, 0]
        return Section(origin, axes, columns[:, 1:4], columns[:, 4])

    def distance(self, position: np.ndarray) -> Distance:
        """By Newton's method from the nearest row: (R - C) . T e_x = 0, as points are found in (3.119)-(3.124)."""
        away = self.plan - position[:2, None]
        found = float(self.rows[np.argmin(np.sum(away**2, axis=0))])
        for _ in range(MAXIMUM_ROUNDS):
            section = self.section(found)
            step = section.from_origin(position)[0] / self.stretch(section, position)
            found = float(np.clip(found + step, self.rows[0], self.rows[-1]))
            if abs(step) < FOUND:
                break
        section = self.section(found)
        along, turned, bent = section.axes[:3, :, 0]
        stretch = self.stretch(section, position)
        slope = along / stretch
        both = np.outer(turned, along) / stretch**2
        bend = both + both.T + np.outer(slope, slope) * ((position - section.origin[0]) @ bent / stretch)
        return Distance(found, slope, bend)

    @staticmethod
    def stretch(section: Section, position: np.ndarray) -> float:
        """Way of a body for each metre of D [1]: less than 1 inside of a curve."""
        return 1.0 - float((position - section.origin[0]) @ section.axes[1, :, 0])

    def rail(
        self, profile: Profile, half_distance: float, side: int, s: np.ndarray, at: Distance, shift: Shift
    ) -> RailSurface:
        """The prism (3.78) of straight track in the axes of the wheelset's section, with which it moves."""
        own, section = rail_surface(profile, half_distance, side, s, shift(at.value)), self.section(at.value)
        origin, axes = section.origin, section.axes
        # s_1 counts along the line as on straight track: the prism lies still in its axes, which go along.
        ahead = np.array([1.0, 0.0, 0.0])
        point, drift = own.point - at.value * ahead, own.tangents[:, 2] - ahead
        tangents, second = axes[0] @ own.tangents, np.tensordot(axes[0], own.second, 1)
        tangents[:, 2] = origin[1] + axes[1] @ point + axes[0] @ drift
        second[:, :2, 2] = second[:, 2, :2] = axes[1] @ own.tangents[:, :2]
        second[:, 2, 2] += origin[2] + axes[2] @ point + 2 * axes[1] @ drift
        slope, bend = axes[0] @ own.normal_slope, np.tensordot(axes[0], own.normal_bend, 1)
        slope[:, 2] = axes[1] @ own.normal
        bend[:, :2, 2] = bend[:, 2, :2] = axes[1] @ own.normal_slope[:, :2]
        bend[:, 2, 2] = axes[2] @ own.normal
        return replace(
            own,
            point=origin[0] + axes[0] @ point,
            tangents=tangents,
            second=second,
            normal=axes[0] @ own.normal,
            normal_slope=slope,
            normal_bend=bend,
            distance_slope=at.slope,
            distance_bend=at.bend,
        )


class SweptRails(SectionRails):
    """The profile swept along the line (3.77): curved surfaces that do not move, whatever wheelset is on them."""

    def rail(
        self, profile: Profile, half_distance: float, side: int, s: np.ndarray, at: Distance, shift: Shift
    ) -> RailSurface:
        """P = C(s_1) + T(s_1) r(s_1, s_2), r in the plane of the section at s_1, with (3.48)-(3.53) of that."""
        section, shifted = self.section(float(s[0])), shift(float(s[0]))
        own = rail_surface(profile, half_distance, side, s, shifted)
        origin, axes = section.origin, section.axes
        # r and its derivatives by s_1; by s_2 alone they are the profile's.
        r = np.vstack([own.point - np.array([s[0], 0.0, 0.0]), np.column_stack([np.zeros(ORDERS - 1), shifted[1:]])])
        across, bent, third = own.tangents[:, 1], own.second[:, 1, 1], np.array([0.0, 0.0, -own.normal_bend[1, 1, 1]])
        tangents, second = np.zeros((3, 3)), np.zeros((3, 3, 3))
        tangents[:, 0] = origin[1] + axes[1] @ r[0] + axes[0] @ r[1]
        tangents[:, 1] = axes[0] @ across
        second[:, 0, 0] = origin[2] + axes[2] @ r[0] + 2 * axes[1] @ r[1] + axes[0] @ r[2]
        second[:, 0, 1] = second[:, 1, 0] = axes[1] @ across
        second[:, 1, 1] = axes[0] @ bent
        thirds = np.zeros((3, 2, 2, 2))
        thirds[:, 0, 0, 0] = origin[3] + axes[3] @ r[0] + 3 * axes[2] @ r[1] + 3 * axes[1] @ r[2] + axes[0] @ r[3]
        thirds[:, 0, 0, 1] = thirds[:, 0, 1, 0] = thirds[:, 1, 0, 0] = axes[2] @ across
        thirds[:, 0, 1, 1] = thirds[:, 1, 0, 1] = thirds[:, 1, 1, 0] = axes[1] @ bent
        thirds[:, 1, 1, 1] = axes[0] @ third
        normal, slope, bend = normals(tangents[:, :2], second[:, :2, :2], thirds)
        return RailSurface(origin[0] + axes[0] @ r[0], tangents, second, normal, slope, bend, side, at.slope, at.bend)


def normals(tangents: np.ndarray, second: np.ndarray, third: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """n = t_1 x t_2 (3.53) and its derivatives by s_1, s_2 in the shapes of a RailSurface, with zeros for the third."""
    (one, two), slope, bend = tangents.T, np.zeros((3, 3)), np.zeros((3, 3, 3))
    for i in range(2):
        slope[:, i] = np.cross(second[:, 0, i], two) + np.cross(one, second[:, 1, i])
        for j in range(2):
            crossed = np.cross(second[:, 0, i], second[:, 1, j]) + np.cross(second[:, 0, j], second[:, 1, i])
            bend[:, i, j] = np.cross(third[:, 0, i, j], two) + np.cross(one, third[:, 1, i, j]) + crossed
    return np.cross(one, two), slope, bend


# -- columns of the line ---------------------------------------------------------------------------------------------


def integral(distance: np.ndarray, values: np.ndarray) -> PPoly:
    """Of columns (rows, columns) that are cubic with slopes of parabolas, as docs/line.md says; for section 3.2.1.

    At the ends of the line there is none.
    """
    return CubicHermiteSpline(distance, values, slopes_of(distance, values)).antiderivative()


def slopes_of(distance: np.ndarray, values: np.ndarray) -> np.ndarray:
    """By parabolas through three rows, none at the ends (section 5.3), in the shape of the values."""
    slopes = np.gradient(values, distance, axis=0)
    slopes[[0, -1]] = 0.0
    return slopes


def quintic(distance: np.ndarray, values: np.ndarray) -> PPoly:
    """Columns (rows, columns) with slopes and bends of parabolas at the rows, none at the ends; for section 5.3."""
    rises = np.diff(values, axis=0) / np.diff(distance)[:, None]
    bends = np.zeros_like(values)
    bends[1:-1] = 2 * np.diff(rises, axis=0) / (distance[2:] - distance[:-2])[:, None]
    nodes = np.stack([values, slopes_of(distance, values), bends], axis=1)
    return PPoly.from_bernstein_basis(BPoly.from_derivatives(distance, nodes))


# -- series in D, coefficients first: shape (4, ...) -----------------------------------------------------------------


def axes_of(heading: np.ndarray, rising: np.ndarray, leaning: np.ndarray) -> np.ndarray:
    """T of section 3.2.1, (4, 3, 3), from the heading and the sines of gradient and roll, each (4,).

    Along is a unit vector of this heading and gradient; level to the left and square to both, turned by the roll.
    """
    cosine, sine = circle(heading)
    level, upright = cosine_of(rising), cosine_of(leaning)
    along = np.stack([product(level, cosine), product(level, sine), rising], axis=1)
    left = np.stack([-sine, cosine, np.zeros(ORDERS)], axis=1)
    above = np.stack([-product(rising, cosine), -product(rising, sine), level], axis=1)
    lateral = product(upright, left) + product(leaning, above)
    upwards = product(upright, above) - product(leaning, left)
    return np.stack([along, lateral, upwards], axis=2)


def product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of two series in D, for section 3.2.1; a: of numbers, shape (4,)."""
    return np.array([sum(a[i] * b[order - i] for i in range(order + 1)) for order in range(ORDERS)])


def cosine_of(sine: np.ndarray) -> np.ndarray:
    """Of an angle in section 3.2.1 by its sine: the root of 1 - sine^2."""
    square = -product(sine, sine)
    square[0] += 1.0
    root = np.zeros(ORDERS)
    root[0] = math.sqrt(square[0])
    for order in range(1, ORDERS):
        root[order] = (square[order] - sum(root[i] * root[order - i] for i in range(1, order))) / (2 * root[0])
    return root


def circle(angle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and sine of an angle in section 3.2.1, by Euler's formula."""
    turned = np.zeros(ORDERS, dtype=complex)
    turned[0] = complex(math.cos(angle[0]), math.sin(angle[0]))
    for order in range(1, ORDERS):
        turned[order] = sum(1j * i * angle[i] * turned[order - i] for i in range(1, order + 1)) / order
    return turned.real, turned.imag
