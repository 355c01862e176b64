"""Euler parameters, velocities and mass matrices, sections 3.2.1 to 3.2.3."""

import math

import numpy as np


def rotation_matrix(theta: np.ndarray) -> np.ndarray:
    """A (3 x 3), from the axes of the body to the inertial ones, eq. (3.2); theta (4,): Euler parameters (3.5)."""
    t0, t1, t2, t3 = theta
    return np.array(
        [
            [1 - 2 * (t2 * t2 + t3 * t3), 2 * (t1 * t2 - t0 * t3), 2 * (t1 * t3 + t0 * t2)],
            [2 * (t1 * t2 + t0 * t3), 1 - 2 * (t1 * t1 + t3 * t3), 2 * (t2 * t3 - t0 * t1)],
            [2 * (t1 * t3 - t0 * t2), 2 * (t2 * t3 + t0 * t1), 1 - 2 * (t1 * t1 + t2 * t2)],
        ]
    )


def norm_error(theta: np.ndarray) -> float:
    """Return the error of the constraint on the Euler parameters, eq. (3.6)."""
    return float(theta @ theta) - 1.0


def skew(v: np.ndarray) -> np.ndarray:
    """Matrix (3 x 3) whose product with w is v x w, eqs (3.10), (3.11), (3.18)."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def cross(v: np.ndarray, w: np.ndarray) -> np.ndarray:
    """v x w, eq. (3.10); faster than numpy's for single vectors."""
    a, b, c = v
    x, y, z = w
    return np.array([b * z - c * y, c * x - a * z, a * y - b * x])


def g_bar(theta: np.ndarray) -> np.ndarray:
    """G bar (3 x 4), from rates of the Euler parameters to the angular velocity in body axes, eq. (3.14)."""
    t0, t1, t2, t3 = theta
    return 2.0 * np.array([[-t1, t0, t3, -t2], [-t2, -t3, t0, t1], [-t3, t2, -t1, t0]])


def angular_velocity(theta: np.ndarray, theta_rate: np.ndarray) -> np.ndarray:
    """Angular velocity in body axes [rad/s], eqs (3.9), (3.13)."""
    return g_bar(theta) @ theta_rate


def theta_rate_of(theta: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Rates of the Euler parameters of a body that turns with omega [rad/s] in body axes: (3.13) turned round.

    G bar G bar^T = 4 I, and the rates are at right angles to the parameters because of (3.6).
    """
    return g_bar(theta).T @ omega / 4.0


def from_angles(yaw: float, roll: float, pitch: float) -> np.ndarray:
    """Euler parameters of Rz(yaw) Rx(roll) Ry(pitch), angles in rad, consistent with (3.2)."""
    product = np.array([math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)])
    for axis, angle in ((1, roll), (2, pitch)):
        turn = np.zeros(4)
        turn[0], turn[axis] = math.cos(angle / 2), math.sin(angle / 2)
        product = composed(product, turn)
    return product


def composed(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Euler parameters of the product of two matrices (3.2)."""
    vector = first[0] * second[1:] + second[0] * first[1:] + cross(first[1:], second[1:])
    return np.concatenate([[first[0] * second[0] - first[1:] @ second[1:]], vector])


def mass_matrix(mass: float, inertia: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """M (7 x 7) of a body whose origin is its centre of mass, eqs (3.20), (3.24)-(3.28).

    inertia [kg.m2]: the three principal moments. The integrals (3.21)-(3.23), (3.27) are done: they are the mass, zero
    and the inertia. The rotational part has rank 3: only the constraint (3.6) makes the system solvable.
    """
    matrix = np.zeros((7, 7))
    matrix[0, 0] = matrix[1, 1] = matrix[2, 2] = mass
    g = g_bar(theta)
    matrix[3:, 3:] = g.T @ (inertia[:, None] * g)
    return matrix


def quadratic_velocity(inertia: np.ndarray, theta_rate: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """Return Q_v (7,), the gyroscopic part of the generalised forces, eq. (3.74).

    This differs from the thesis: -2 (dG/dt)^T I omega. There the dot over G is missing, with which the units agree.
    """
    return np.concatenate([np.zeros(3), -2.0 * g_bar(theta_rate).T @ (inertia * omega)])
