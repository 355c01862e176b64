"""The track: its axes along an analytical line, and rails as prisms or as a section that is swept along the line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial import cKDTree

from rbd_model.contact.profiles import Profile

#: Gauss's quadrature of the way in the plan: on a line of 100 m with a curve of 200 m it is right to round-off; with
#: fewer points from the middle of some places to each of them, a metre away.
GAUSS, SHORT_GAUSS = np.polynomial.legendre.leggauss(16), np.polynomial.legendre.leggauss(5)
#: Pitch of the points of a rail from which the search for the nearest one starts [m], and its rounds; those that are
#: left for points beside one whose place on the line is known.
POINT_PITCH, ROUNDS, MORE_ROUNDS = 0.05e-3, 4, 3
#: Distance of the rails' heads over which cant is measured, EN 13803 [m].
GAUGE = 1.5
#: Of the difference by which the direction of a swept rail is found [m].
STEP = 1e-3


@dataclass(frozen=True)
class Course:
    """A line by its curvature [1/m], sine of roll (left rail up) and sine of gradient: value at 0 and slope along it.

    An arc, a clothoid with its ramp of cant and its vertical curve, or, with zeros, straight and level track.
    """

    curvature: tuple[float, float] = (0.0, 0.0)
    roll: tuple[float, float] = (0.0, 0.0)
    gradient: tuple[float, float] = (0.0, 0.0)

    @staticmethod
    def _linear(law: tuple[float, float], s: np.ndarray) -> np.ndarray:
        return law[0] + law[1] * s

    def heading(self, s: np.ndarray) -> np.ndarray:
        """Angle in the plan [rad], to the left."""
        return self.curvature[0] * s + self.curvature[1] * s**2 / 2

    def origin(self, s: np.ndarray) -> np.ndarray:
        """Places of the centre line [m], shape (n, 3), by quadrature of its direction from 0, over their middle."""
        s = np.atleast_1d(s)
        middle = np.mean(s, keepdims=True)
        return self._way(np.zeros(1), middle, GAUSS) + self._way(middle, s, SHORT_GAUSS)

    def _way(self, start: np.ndarray, end: np.ndarray, gauss: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """From places of the line to others [m], shape (n, 3)."""
        points, weights = gauss
        half = (end - start) / 2
        at = (start + half)[:, None] + half[:, None] * points
        level = np.sqrt(1 - self._linear(self.gradient, at) ** 2)
        ahead = [level * np.cos(self.heading(at)), level * np.sin(self.heading(at)), self._linear(self.gradient, at)]
        return np.stack([half * (one @ weights) for one in ahead], axis=-1)

    def axes(self, s: np.ndarray) -> np.ndarray:
        """Axes of the track (columns), shape (n, 3, 3): Rz(heading), then the gradient, then the roll about it."""
        s = np.atleast_1d(s)
        heading, rise, roll = self.heading(s), self._linear(self.gradient, s), self._linear(self.roll, s)
        c, w, level, upright = np.cos(heading), np.sin(heading), np.sqrt(1 - rise**2), np.sqrt(1 - roll**2)
        none = np.zeros_like(s)
        along = np.stack([level * c, level * w, rise], axis=-1)
        aside, above = np.stack([-w, c, none], axis=-1), np.stack([-rise * c, -rise * w, level], axis=-1)
        across, up = upright[:, None] * aside + roll[:, None] * above, upright[:, None] * above - roll[:, None] * aside
        return np.stack([along, across, up], axis=-1)

    def place_of(self, points: np.ndarray) -> np.ndarray:
        """Distances s at which points, shape (n, 3), lie in the section square to the line [m], by Newton's method."""
        middle = np.mean(points, axis=0, keepdims=True)
        known = self._newton(middle, middle[:, 0], ROUNDS)
        return self._newton(points, known + (points - middle) @ self.axes(known)[0][:, 0], MORE_ROUNDS)

    def _newton(self, points: np.ndarray, s: np.ndarray, rounds: int) -> np.ndarray:
        """Better distances s than these."""
        for _ in range(rounds):
            axes, away = self.axes(s), points - self.origin(s)
            ahead, aside = (np.einsum("ni,ni->n", axes[..., i], away) for i in (0, 1))
            s = s + ahead / (1 - self._linear(self.curvature, s) * aside)
        return s


STRAIGHT = Course()


class Curve:
    """The contour of a rail in its section, as points and as the function that gives them."""

    def __init__(self, profile: Profile) -> None:
        self.height = profile.height
        margin = POINT_PITCH / 2
        self.low, self.high = profile.limits[0] + margin, profile.limits[1] - margin
        self.u = np.linspace(self.low, self.high, int((self.high - self.low) / POINT_PITCH))
        self.tree = cKDTree(np.column_stack([self.u, self.height(self.u)]))

    def distance(self, outward: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of points from the contour, negative inside the rail, and the nearest place u on it [m]."""
        shape = outward.shape
        y, z = outward.ravel(), up.ravel()
        u = self.u[self.tree.query(np.column_stack([y, z]))[1]]
        for _ in range(ROUNDS):
            rho, slope, bend = (self.height(u, n) for n in range(3))
            change = ((u - y) + (rho - z) * slope) / (1 + slope**2 + (rho - z) * bend)
            u = np.clip(u - np.clip(change, -POINT_PITCH, POINT_PITCH), self.low, self.high)
        rho, slope = self.height(u), self.height(u, 1)
        away = ((z - rho) - (y - u) * slope) / np.sqrt(1 + slope**2)
        return away.reshape(shape), u.reshape(shape)

    def curvature(self, outward: float, up: float) -> float:
        """Of the contour nearest to a point [1/m], positive as that of a rail's head."""
        u = self.distance(np.array([outward]), np.array([up]))[1]
        return float((-self.height(u, 2) / (1 + self.height(u, 1) ** 2) ** 1.5)[0])


@dataclass(frozen=True)
class RailData:
    """One rail: side 1 left, -1 right; y outwards and z of its contour's origin in the axes of the track [m]."""

    side: int
    middle: tuple[float, float]
    curve: Curve

    def distance(self, across: np.ndarray, up: np.ndarray) -> np.ndarray:
        """Of points of a section [m], given in the axes of the track, from the contour."""
        return self.curve.distance(self.side * across - self.middle[0], up - self.middle[1])[0]

    def curvature(self, across: float, up: float) -> float:
        """Of the contour nearest to a point of a section [1/m]."""
        return self.curve.curvature(self.side * across - self.middle[0], up - self.middle[1])


class Surface(Protocol):
    """A rail in space."""

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Of points, shape (..., 3), from the rail in its section [m], negative inside it."""

    def along(self, point: np.ndarray) -> np.ndarray:
        """Unit vector of the rail's direction beside a point."""

    def curvature(self, point: np.ndarray) -> float:
        """Of the contour beside a point, in its section [1/m]."""


@dataclass(frozen=True)
class Shifted:
    """A rail that has given way [m]."""

    rail: Surface
    way: np.ndarray

    def distance(self, points: np.ndarray) -> np.ndarray:
        """As in `Surface`."""
        return self.rail.distance(points - self.way)

    def along(self, point: np.ndarray) -> np.ndarray:
        """As in `Surface`."""
        return self.rail.along(point - self.way)

    def curvature(self, point: np.ndarray) -> float:
        """As in `Surface`."""
        return self.rail.curvature(point - self.way)


#: Of a wheelset's centre: how the rail lies that its wheel meets.
Rails = Callable[[np.ndarray], Surface]


@dataclass(frozen=True)
class Prism:
    """The rail of one section, straight on along the track there."""

    course: Course
    place: float
    rail: RailData

    def distance(self, points: np.ndarray) -> np.ndarray:
        """As in `Surface`."""
        local = (points - self.course.origin(self.place)[0]) @ self.course.axes(self.place)[0]
        return self.rail.distance(local[..., 1], local[..., 2])

    def along(self, point: np.ndarray) -> np.ndarray:
        """As in `Surface`."""
        return np.asarray(self.course.axes(self.place)[0][:, 0])

    def curvature(self, point: np.ndarray) -> float:
        """As in `Surface`."""
        local = self.course.axes(self.place)[0].T @ (point - self.course.origin(self.place)[0])
        return self.rail.curvature(float(local[1]), float(local[2]))


@dataclass(frozen=True)
class Swept:
    """The contour moved along the course: a surface that stands still, curved and twisted as the line is."""

    course: Course
    rail: RailData

    def distance(self, points: np.ndarray) -> np.ndarray:
        """As in `Surface`, in the section square to the line that holds each point."""
        flat = points.reshape(-1, 3)
        place = self.course.place_of(flat)
        local = np.einsum("nji,nj->ni", self.course.axes(place), flat - self.course.origin(place))
        return self.rail.distance(local[:, 1], local[:, 2]).reshape(points.shape[:-1])

    def along(self, point: np.ndarray) -> np.ndarray:
        """As in `Surface`: where a place of the section goes as the section moves on."""
        place = self.course.place_of(point[None])[0]
        beside = self.course.axes(place)[0].T @ (point - self.course.origin(place)[0])
        ends = place + np.array([-STEP, STEP])
        before, behind = self.course.origin(ends) + self.course.axes(ends) @ beside
        return np.asarray((behind - before) / np.linalg.norm(behind - before))

    def curvature(self, point: np.ndarray) -> float:
        """As in `Surface`."""
        place = float(self.course.place_of(point[None])[0])
        return Prism(self.course, place, self.rail).curvature(point)


def prisms(course: Course, rail: RailData) -> Rails:
    """A rail whose wheel meets it as if it were straight at the section in which the wheelset's centre is."""
    return lambda centre: Prism(course, float(course.place_of(centre[None])[0]), rail)


def swept(course: Course, rail: RailData) -> Rails:
    """A rail that is what it is, wherever the wheelset is."""
    surface = Swept(course, rail)
    return lambda centre: surface
