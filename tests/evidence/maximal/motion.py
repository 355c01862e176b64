"""Rigid bodies in an inertial frame: position, motion and accelerations by forces (Newton, Euler)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Moving:
    """A body: position of its centre [m], own axes (columns), velocity [m/s], angular velocity [rad/s]; inertial."""

    position: np.ndarray
    axes: np.ndarray
    velocity: np.ndarray
    rate: np.ndarray

    def displaced(self, way: np.ndarray) -> Moving:
        """Return the body after a small displacement: three of its centre [m], three of its rotation [rad]."""
        return replace(self, position=self.position + way[:3], axes=turn(way[3:]) @ self.axes)

    @property
    def twist(self) -> np.ndarray:
        """Velocity and angular velocity, as the rate of `displaced`, shape (6,)."""
        return np.concatenate([self.velocity, self.rate])


def turn(vector: np.ndarray) -> np.ndarray:
    """Return the rotation matrix about a vector by its length [rad] (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    across = skew(vector / angle)
    return np.asarray(np.eye(3) + np.sin(angle) * across + 2 * np.sin(angle / 2) ** 2 * across @ across)


def skew(vector: np.ndarray) -> np.ndarray:
    """Return the matrix of a cross product from the left."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def about(axis: int, angle: float) -> np.ndarray:
    """Return the rotation matrix about the first (0), second or third axis."""
    return turn(angle * np.eye(3)[axis])


def roll_pitch_yaw(axes: np.ndarray) -> np.ndarray:
    """Return roll, pitch and yaw of axes that are turned by Rz(yaw) Rx(roll) Ry(pitch)."""
    second, third = axes[:, 1], axes[2]
    return np.array([np.arcsin(second[2]), np.arctan2(-third[0], third[2]), np.arctan2(-second[0], second[1])])


def accelerations(body: Moving, mass: float, inertia: np.ndarray, wrench: np.ndarray) -> np.ndarray:
    """Return accelerations of the centre [m/s2] and of the angular velocity [rad/s2], inertial, Newton and Euler; shape
    (6,).

    inertia: about the own axes; wrench: force [N] and moment about the centre [N.m], inertial.
    """
    tensor = body.axes @ np.diag(inertia) @ body.axes.T
    gyroscopic = np.cross(body.rate, tensor @ body.rate)
    return np.concatenate([wrench[:3] / mass, np.linalg.solve(tensor, wrench[3:] - gyroscopic)])
