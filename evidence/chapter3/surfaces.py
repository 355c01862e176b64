"""Wheel and rail as surfaces of two parameters, with derivatives up to the third, sections 3.3.1 and 3.3.2."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rbd_model.contact.profiles import DEGREE, Profile

#: Third derivatives enter Q_d (3.72), so the profiles are quintic splines (section 3.3.2).
ORDERS = 4


class OffTheProfileError(ArithmeticError):
    """A surface parameter has left the profile: there is no surface to touch."""


@lru_cache
def _pieces(profile: Profile) -> tuple[np.ndarray, np.ndarray]:
    """Breakpoints, and for each piece a matrix (4, 6) from the powers of the distance to z and its derivatives."""
    breakpoints, coefficients = profile.pieces
    matrices = np.zeros((len(coefficients), ORDERS, DEGREE + 1))
    for order in range(ORDERS):
        for power in range(order, DEGREE + 1):
            matrices[:, order, power - order] = math.perm(power, order) * coefficients[:, power]
    return breakpoints, matrices


def profile_derivatives(profile: Profile, y: float) -> np.ndarray:
    """z, z', z'', z''' at y [m], section 3.3.2; shape (4,). Raises OffTheProfileError."""
    breakpoints, matrices = _pieces(profile)
    if not breakpoints[0] <= y <= breakpoints[-1]:
        raise OffTheProfileError(f"The contact at y = {1e3 * y:.3g} mm has left the profile {profile.name}.")
    piece = min(int(breakpoints.searchsorted(y, "right")) - 1, len(matrices) - 1)
    x = y - breakpoints[piece]
    return np.asarray(matrices[piece] @ np.array([1.0, x, x * x, x**3, x**4, x**5]))


@dataclass(frozen=True)
class SurfacePoint:
    """A point of a surface in body axes and its derivatives by the two surface parameters, eqs (3.48)-(3.51).

    point (3,); tangents (3, 2), columns t_1 and t_2; second (3, 2, 2) and third (3, 2, 2, 2): derivatives of `point`.
    """

    point: np.ndarray
    tangents: np.ndarray
    second: np.ndarray
    third: np.ndarray


@dataclass(frozen=True)
class RailSurface:
    """A rail, in axes of its body, at the surface parameters s_1, s_2 [m], (3.48)-(3.51), with its normal (3.53).

    point (3,), tangents (3, 2), second (3, 2, 2) are as in Surface. The normal (3,) has any length; normal_slope (3, 2)
    and normal_bend (3, 2, 2) are its derivatives. Drift and drift_rate (3,) are the first and second derivative of
    `point` by the distance of the wheelset on it. This is the x of its position R of (3.1). The side is 1 left, -1
    right.
    """

    point: np.ndarray
    tangents: np.ndarray
    second: np.ndarray
    normal: np.ndarray
    normal_slope: np.ndarray
    normal_bend: np.ndarray
    drift: np.ndarray
    drift_rate: np.ndarray
    side: int

    @property
    def upwards(self) -> np.ndarray:
        """Unit normal, eq. (3.53), into the wheel."""
        return self.normal * (self.side / math.sqrt(self.normal @ self.normal))

    @property
    def curvature(self) -> float:
        """1/rho_y of (3.83) across the rail [1/m], positive for the crown of a rail.

        Along it a prism has no curvature.
        """
        across = self.tangents[:, 1]
        return -float(self.upwards @ self.second[:, 1, 1] / (across @ across))


def wheel_surface(
    profile: Profile, radius: float, half_distance: float, side: int, s: np.ndarray
) -> tuple[SurfacePoint, np.ndarray]:
    """Return the surface of revolution, eq. (3.77), at s = (angle [rad], profile position [m]); and r, r', r'', r'''.

    side: 1 left, -1 right. The second parameter increases towards the field side, so that both wheels share one
    profile: y = side (half_distance + s_2), r = radius - z(s_2).
    """
    z = profile_derivatives(profile, s[1])
    r = np.array([radius, 0.0, 0.0, 0.0]) - z
    sine, cosine = math.sin(s[0]), math.cos(s[0])
    outwards, along = np.array([sine, 0.0, -cosine]), np.array([cosine, 0.0, sine])
    point = r[0] * outwards
    point[1] = side * (half_distance + s[1])
    tangents = np.empty((3, 2))
    tangents[:, 0] = r[0] * along
    tangents[:, 1] = r[1] * outwards
    tangents[1, 1] = side
    second = np.empty((3, 2, 2))
    second[:, 0, 0] = -r[0] * outwards
    second[:, 0, 1] = second[:, 1, 0] = r[1] * along
    second[:, 1, 1] = r[2] * outwards
    third = np.empty((3, 2, 2, 2))
    third[:, 0, 0, 0] = -r[0] * along
    third[:, 0, 0, 1] = third[:, 0, 1, 0] = third[:, 1, 0, 0] = -r[1] * outwards
    third[:, 0, 1, 1] = third[:, 1, 0, 1] = third[:, 1, 1, 0] = r[2] * along
    third[:, 1, 1, 1] = r[3] * outwards
    return SurfacePoint(point, tangents, second, third), r


def rail_surface(
    profile: Profile, half_distance: float, side: int, s: np.ndarray, irregularity: np.ndarray
) -> RailSurface:
    """Return a prism along straight track, eq. (3.78), at s = (distance [m], position on the profile [m]).

    irregularity (3, 2): lateral and vertical shift of the rail at the wheelset's distance, and their first and second
    derivatives. The thesis does not define how its irregularities (5.3), (5.4) enter. Here each wheelset meets rails
    with the irregularity at its own distance, its x.
    """
    z = profile_derivatives(profile, s[1])
    shift = irregularity[0]
    point = np.array([s[0], side * (half_distance + s[1]) + shift[0], z[0] + shift[1]])
    tangents = np.array([[1.0, 0.0], [0.0, side], [0.0, z[1]]])
    second, normal_slope, normal_bend = np.zeros((3, 2, 2)), np.zeros((3, 2)), np.zeros((3, 2, 2))
    second[2, 1, 1] = z[2]
    normal_slope[1, 1], normal_bend[1, 1, 1] = -z[2], -z[3]
    normal = np.array([0.0, -z[1], float(side)])
    drift, drift_rate = np.array([0.0, *irregularity[1]]), np.array([0.0, *irregularity[2]])
    return RailSurface(point, tangents, second, normal, normal_slope, normal_bend, drift, drift_rate, side)
