"""Track axes along an analytical line; rails as prisms or as a section swept along the line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial import cKDTree

from rbd_model.contact.profiles import Profile

#: Gauss points for the integral of the direction in plan. 16 points are exact to round-off on a line of 100 m with a
#: 200 m curve. 5 points suffice from the middle of a set of places to each of them, about a metre away.
GAUSS, SHORT_GAUSS = np.polynomial.legendre.leggauss(16), np.polynomial.legendre.leggauss(5)
#: Pitch of the rail points from which the search for the nearest one starts [m], and number of Newton rounds.
#: MORE_ROUNDS is for points close to one whose place on the line is known.
POINT_PITCH, ROUNDS, MORE_ROUNDS = 0.05e-3, 4, 3
#: Distance between the rail heads over which cant is measured, EN 13803 [m].
GAUGE = 1.5
#: Half step of the central difference that gives the direction of a swept rail [m].
STEP = 1e-3


@dataclass(frozen=True)
class Course:
    """A line given by curvature [1/m], sine of roll (left rail up) and sine of gradient: value at 0 and slope along it.

    Represents an arc, a clothoid with its cant ramp and vertical curve, or, with zeros, straight and level track.
    """

    curvature: tuple[float, float] = (0.0, 0.0)
    roll: tuple[float, float] = (0.0, 0.0)
    gradient: tuple[float, float] = (0.0, 0.0)

    @staticmethod
    def _linear(law: tuple[float, float], s: np.ndarray) -> np.ndarray:
        return law[0] + law[1] * s

    def heading(self, s: np.ndarray) -> np.ndarray:
        """Return the heading in plan [rad], positive to the left."""
        return self.curvature[0] * s + self.curvature[1] * s**2 / 2

    def origin(self, s: np.ndarray) -> np.ndarray:
        """Return points of the centre line [m], shape (n, 3): the integral of its direction from 0, by way of their
        mean.
        """
        s = np.atleast_1d(s)
        middle = np.mean(s, keepdims=True)
        return self._way(np.zeros(1), middle, GAUSS) + self._way(middle, s, SHORT_GAUSS)

    def _way(self, start: np.ndarray, end: np.ndarray, gauss: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Return the displacements from one set of places on the line to another [m], shape (n, 3)."""
        points, weights = gauss
        half = (end - start) / 2
        at = (start + half)[:, None] + half[:, None] * points
        level = np.sqrt(1 - self._linear(self.gradient, at) ** 2)
        ahead = [level * np.cos(self.heading(at)), level * np.sin(self.heading(at)), self._linear(self.gradient, at)]
        return np.stack([half * (one @ weights) for one in ahead], axis=-1)

    def axes(self, s: np.ndarray) -> np.ndarray:
        """Return the axes of the track (columns), shape (n, 3, 3): Rz(heading), then the gradient, then the roll."""
        s = np.atleast_1d(s)
        heading, rise, roll = self.heading(s), self._linear(self.gradient, s), self._linear(self.roll, s)
        c, w, level, upright = np.cos(heading), np.sin(heading), np.sqrt(1 - rise**2), np.sqrt(1 - roll**2)
        none = np.zeros_like(s)
        along = np.stack([level * c, level * w, rise], axis=-1)
        aside, above = np.stack([-w, c, none], axis=-1), np.stack([-rise * c, -rise * w, level], axis=-1)
        across, up = upright[:, None] * aside + roll[:, None] * above, upright[:, None] * above - roll[:, None] * aside
        return np.stack([along, across, up], axis=-1)

    def place_of(self, points: np.ndarray) -> np.ndarray:
        """Return the distances s of the sections square to the line that contain points, shape (n, 3) [m]; Newton's
        method.
        """
        middle = np.mean(points, axis=0, keepdims=True)
        known = self._newton(middle, middle[:, 0], ROUNDS)
        return self._newton(points, known + (points - middle) @ self.axes(known)[0][:, 0], MORE_ROUNDS)

    def _newton(self, points: np.ndarray, s: np.ndarray, rounds: int) -> np.ndarray:
        """Refine the distances s by Newton steps."""
        for _ in range(rounds):
            axes, away = self.axes(s), points - self.origin(s)
            ahead, aside = (np.einsum("ni,ni->n", axes[..., i], away) for i in (0, 1))
            s = s + ahead / (1 - self._linear(self.curvature, s) * aside)
        return s


STRAIGHT = Course()


class Curve:
    """Contour of a rail in its section, as points and as the function that gives them."""

    def __init__(self, profile: Profile) -> None:
        self.height = profile.height
        margin = POINT_PITCH / 2
        self.low, self.high = profile.limits[0] + margin, profile.limits[1] - margin
        self.u = np.linspace(self.low, self.high, int((self.high - self.low) / POINT_PITCH))
        self.tree = cKDTree(np.column_stack([self.u, self.height(self.u)]))

    def distance(self, outward: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the distance of points from the contour, negative inside the rail, and the nearest coordinate u on it
        [m].
        """
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


@dataclass(frozen=True)
class RailData:
    """One rail: side 1 left, -1 right; `middle`: y (outwards) and z of the contour's origin in track axes [m]."""

    side: int
    middle: tuple[float, float]
    curve: Curve

    def distance(self, across: np.ndarray, up: np.ndarray) -> np.ndarray:
        """Return the distance from the contour of points of a section, given in track axes [m]."""
        return self.curve.distance(self.side * across - self.middle[0], up - self.middle[1])[0]


class Surface(Protocol):
    """A rail as a 3D surface."""

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Return the distance of points, shape (..., 3), from the rail in its section [m], negative inside it."""

    def along(self, point: np.ndarray) -> np.ndarray:
        """Return the unit vector of the rail's direction near a point."""


@dataclass(frozen=True)
class Shifted:
    """A rail displaced by `way` [m]."""

    rail: Surface
    way: np.ndarray

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Implement `Surface.distance`."""
        return self.rail.distance(points - self.way)

    def along(self, point: np.ndarray) -> np.ndarray:
        """Implement `Surface.along`."""
        return self.rail.along(point - self.way)


#: Maps a wheelset's centre to the rail surface that its wheel touches.
Rails = Callable[[np.ndarray], Surface]


@dataclass(frozen=True)
class Prism:
    """A straight rail of one section, extended along the track direction at `place`."""

    course: Course
    place: float
    rail: RailData

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Implement `Surface.distance`."""
        local = (points - self.course.origin(self.place)[0]) @ self.course.axes(self.place)[0]
        return self.rail.distance(local[..., 1], local[..., 2])

    def along(self, point: np.ndarray) -> np.ndarray:
        """Implement `Surface.along`."""
        return np.asarray(self.course.axes(self.place)[0][:, 0])


@dataclass(frozen=True)
class Swept:
    """The contour swept along the course: a fixed surface, curved and twisted like the line."""

    course: Course
    rail: RailData

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Implement `Surface.distance`, in the section square to the line that contains each point."""
        flat = points.reshape(-1, 3)
        place = self.course.place_of(flat)
        local = np.einsum("nji,nj->ni", self.course.axes(place), flat - self.course.origin(place))
        return self.rail.distance(local[:, 1], local[:, 2]).reshape(points.shape[:-1])

    def along(self, point: np.ndarray) -> np.ndarray:
        """Implement `Surface.along`: the path of a point of the section as the section moves along the line."""
        place = self.course.place_of(point[None])[0]
        beside = self.course.axes(place)[0].T @ (point - self.course.origin(place)[0])
        ends = place + np.array([-STEP, STEP])
        before, behind = self.course.origin(ends) + self.course.axes(ends) @ beside
        return np.asarray((behind - before) / np.linalg.norm(behind - before))


def prisms(course: Course, rail: RailData) -> Rails:
    """Return a rail that is a straight prism of the section at the wheelset's centre."""
    return lambda centre: Prism(course, float(course.place_of(centre[None])[0]), rail)


def swept(course: Course, rail: RailData) -> Rails:
    """Return a rail that is the same swept surface at every wheelset position."""
    surface = Swept(course, rail)
    return lambda centre: surface
