"""Contact constraints between two bodies, their sub-Jacobians and Q_d, sections 3.2.5, 3.2.6 and Appendix I."""

from dataclasses import dataclass

import numpy as np

from evidence.chapter3.euler import cross
from evidence.chapter3.forces import BodyMotion
from evidence.chapter3.surfaces import RailSurface, SurfacePoint

#: Equations of one contact: three for the point (3.54), two for the orientation (3.57).
EQUATIONS = 5


@dataclass(frozen=True)
class SubJacobian:
    """C_q and C_s of one contact, eqs (3.59), (3.60): blocks of bodies i and j (5 x 7) and of s^i and s^j (5 x 2)."""

    wheel: np.ndarray
    rail: np.ndarray
    wheel_parameters: np.ndarray
    rail_parameters: np.ndarray


def residual(i: BodyMotion, j: BodyMotion, wheel: SurfacePoint, rail: RailSurface) -> np.ndarray:
    """C (5,): the same point (3.46), (3.47), (3.54)-(3.56) [m], and one normal (3.52), (3.53), (3.57), (3.58)."""
    out = np.empty(EQUATIONS)
    out[:3] = i.point(wheel.point) - j.point(rail.point)
    out[3:] = (j.axes @ rail.normal) @ (i.axes @ wheel.tangents)
    return out


def sub_jacobian(i: BodyMotion, j: BodyMotion, wheel: SurfacePoint, rail: RailSurface) -> SubJacobian:
    """Return C_q and C_s, eqs (3.61)-(3.65), as derived in Appendix I.

    v^T w~ is written as (v x w)^T. Differences from the thesis: (3.64), (3.65) have A^jT A^j where A^iT A^j belongs, as
    in Appendix I; and the rail moves with the distance of the wheelset, see `RailSurface`.
    """
    of_wheel, of_rail = np.zeros((EQUATIONS, 7)), np.zeros((EQUATIONS, 7))
    wheel_s, rail_s = np.empty((EQUATIONS, 2)), np.empty((EQUATIONS, 2))
    tangents, normal = i.axes @ wheel.tangents, j.axes @ rail.normal
    of_wheel[0, 0] = of_wheel[1, 1] = of_wheel[2, 2] = 1.0
    of_rail[0, 0] = of_rail[1, 1] = of_rail[2, 2] = -1.0
    of_wheel[:3, 0] -= j.axes @ rail.drift
    of_wheel[:3, 3:] = -i.axes @ _skew_times(wheel.point, i.g)
    of_rail[:3, 3:] = j.axes @ _skew_times(rail.point, j.g)
    in_wheel = i.axes.T @ normal
    for row in range(2):
        of_wheel[3 + row, 3:] = -cross(in_wheel, wheel.tangents[:, row]) @ i.g
        of_rail[3 + row, 3:] = -cross(j.axes.T @ tangents[:, row], rail.normal) @ j.g
    wheel_s[:3] = tangents
    rail_s[:3] = -j.axes @ rail.tangents
    wheel_s[3:] = np.tensordot(in_wheel, wheel.second, 1)
    rail_s[3:] = tangents.T @ (j.axes @ rail.normal_slope)
    return SubJacobian(of_wheel, of_rail, wheel_s, rail_s)


def _skew_times(v: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """v~ M: the cross products of v with the columns."""
    x, y, z = v
    a, b, c = matrix
    return np.array([y * c - z * b, z * a - x * c, x * b - y * a])


def quadratic_terms(
    i: BodyMotion, j: BodyMotion, wheel: SurfacePoint, rail: RailSurface, rates: tuple[np.ndarray, np.ndarray]
) -> np.ndarray:
    """Return Q_d (5,): the second derivative of C without accelerations, eqs (3.69)-(3.72).

    rates: of the surface parameters of wheel and rail. It includes third derivatives of the wheel's profile.
    """
    (of_wheel, of_rail), speed = rates, float(i.velocity[0])
    relative = wheel.tangents @ of_wheel, rail.tangents @ of_rail + rail.drift * speed
    bend = _twice(wheel.second, of_wheel), _twice(rail.second, of_rail) + rail.drift_rate * speed**2
    out = np.empty(EQUATIONS)
    out[:3] = _second(j, rail.point, relative[1], bend[1]) - _second(i, wheel.point, relative[0], bend[0])
    normal = j.axes @ rail.normal
    normal_rate = _first(j, rail.normal, rail.normal_slope @ of_rail)
    normal_second = _second(j, rail.normal, rail.normal_slope @ of_rail, _twice(rail.normal_bend, of_rail))
    for row in range(2):
        tangent, change = wheel.tangents[:, row], wheel.second[:, row] @ of_wheel
        second = _second(i, tangent, change, _twice(wheel.third[:, row], of_wheel))
        out[3 + row] = -(
            normal_second @ (i.axes @ tangent) + 2.0 * (normal_rate @ _first(i, tangent, change)) + normal @ second
        )
    return out


def _twice(derivative: np.ndarray, rates: np.ndarray) -> np.ndarray:
    return (derivative @ rates) @ rates


def _first(body: BodyMotion, vector: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Return the rate of A v for a v that changes in body axes at `rate`."""
    return body.axes @ (cross(body.omega, vector) + rate)


def _second(body: BodyMotion, vector: np.ndarray, rate: np.ndarray, bend: np.ndarray) -> np.ndarray:
    """Second derivative of A v without the angular acceleration, eqs (3.15)-(3.19), and with `bend` for that of v."""
    return body.axes @ (cross(body.omega, cross(body.omega, vector) + 2.0 * rate) + bend)
