"""Generalised forces, section 3.2.4. Generalised coordinates of a body: R (3,) and Euler parameters (4,)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evidence.chapter3.euler import cross, g_bar, rotation_matrix


@dataclass(frozen=True)
class BodyMotion:
    """Position and motion of a body: R (3.3), A, G bar, and velocities; omega in body axes."""

    position: np.ndarray
    theta: np.ndarray
    axes: np.ndarray
    g: np.ndarray
    velocity: np.ndarray
    theta_rate: np.ndarray
    omega: np.ndarray

    @staticmethod
    def of(q: np.ndarray, q_rate: np.ndarray) -> BodyMotion:
        """Return the motion for the seven generalised coordinates of the body and their rates."""
        g = g_bar(q[3:])
        return BodyMotion(q[:3], q[3:], rotation_matrix(q[3:]), g, q_rate[:3], q_rate[3:], g @ q_rate[3:])

    def point(self, place: np.ndarray) -> np.ndarray:
        """Position of the point `place` (3.4) given in body axes, eq. (3.1)."""
        return self.position + self.axes @ place

    def velocity_of(self, place: np.ndarray) -> np.ndarray:
        """Velocity of a point of the body, eqs (3.7), (3.8), (3.12)."""
        return self.velocity + self.axes @ cross(self.omega, place)


def of_force(body: BodyMotion, force: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Generalised force (7,) of a force in inertial axes [N] on the point `place`, eqs (3.29)-(3.35).

    -(A u~ G)^T F is written as G^T (u x A^T F).
    """
    return np.concatenate([force, body.g.T @ cross(place, body.axes.T @ force)])


def of_moment(body: BodyMotion, moment: np.ndarray) -> np.ndarray:
    """Generalised force of a moment in inertial axes [N.m], first part of eq. (3.36); G = A G bar."""
    return of_body_moment(body, body.axes.T @ moment)


def of_body_moment(body: BodyMotion, moment: np.ndarray) -> np.ndarray:
    """The same for a moment in the axes of the body, which turn with it: (3.36) with G bar."""
    return np.concatenate([np.zeros(3), body.g.T @ moment])


def spring_damper(
    i: BodyMotion, place_i: np.ndarray, j: BodyMotion, place_j: np.ndarray, law: tuple[float, float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Generalised forces on both bodies of an element along the line between two points, eqs (3.37)-(3.42).

    law: stiffness [N/m], damping [N.s/m], free length [m].
    """
    stiffness, damping, free_length = law
    between = i.point(place_i) - j.point(place_j)  # (3.38)
    length = float(np.sqrt(between @ between))  # (3.39)
    direction = between / length  # (3.40)
    rate = float(direction @ (i.velocity_of(place_i) - j.velocity_of(place_j)))
    size = stiffness * (length - free_length) + damping * rate  # (3.37)
    return of_force(i, -size * direction, place_i), of_force(j, size * direction, place_j)


def torsional_spring_damper(
    i: BodyMotion, j: BodyMotion, axis: np.ndarray, angle: float, law: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Generalised forces of a torsional element about `axis` (inertial axes), eqs (3.43)-(3.45).

    angle [rad]: of i against j about the axis; law: stiffness [N.m/rad], damping [N.m.s/rad]. The bogies of chapters 4
    and 5 have none.
    """
    rate = float(axis @ (i.axes @ i.omega - j.axes @ j.omega))
    torque = law[0] * angle + law[1] * rate
    return of_moment(i, -torque * axis), of_moment(j, torque * axis)


def axle_box(
    wheelset: BodyMotion,
    place: np.ndarray,
    frame: BodyMotion,
    place_in_frame: np.ndarray,
    law: tuple[np.ndarray, np.ndarray, float],
) -> tuple[np.ndarray, np.ndarray]:
    """Return generalised forces on wheelset and frame of one suspension element of Tables 4.1 and 5.1, (3.33), (3.34).

    law: stiffness (3,) [N/m] and damping (3,) [N.s/m] along the axes of the box, and its static load [N]. The y axis of
    the box is along the axle; its x axis is square to the axle and to the frame's z axis. place: in its axes. This
    differs from the thesis, which draws three elements (3.37) at right angles and gives no length of them. The law here
    is the limit of long elements that turn with the box.
    """
    stiffness, damping, load = law
    axle, upright = wheelset.axes[:, 1], frame.axes[:, 2]
    ahead = cross(axle, upright)
    ahead = ahead / np.sqrt(ahead @ ahead)
    axes = np.column_stack([ahead, axle, cross(ahead, axle)])
    held = cross(ahead, upright)  # about it the box turns as the frame does, so that x stays square to z
    rate_of_wheelset, rate_of_frame = wheelset.axes @ wheelset.omega, frame.axes @ frame.omega
    spin = rate_of_wheelset + axle * ((rate_of_frame - rate_of_wheelset) @ held) / (axle @ held)
    reach = frame.point(place_in_frame) - wheelset.position
    rate = frame.velocity_of(place_in_frame) - wheelset.velocity - cross(spin, reach)
    components = stiffness * (axes.T @ reach - place) + damping * (axes.T @ rate)
    components[2] -= load
    pull = axes @ components
    turning = cross(reach, pull)
    passed = held * (turning @ axle) / (held @ axle)  # the wheelset turns freely
    on_wheelset = of_force(wheelset, pull, np.zeros(3)) + of_moment(wheelset, turning - passed)
    return on_wheelset, of_force(frame, -pull, place_in_frame) + of_moment(frame, passed)


def between_frames(
    lower: BodyMotion,
    place: np.ndarray,
    upper: BodyMotion,
    place_in_upper: np.ndarray,
    law: tuple[np.ndarray, np.ndarray, float],
) -> tuple[np.ndarray, np.ndarray]:
    """The same between two bodies above wheelsets, by (3.33), (3.34), along the axes of the lower one."""
    stiffness, damping, load = law
    reach = upper.point(place_in_upper) - lower.position
    rate = upper.velocity_of(place_in_upper) - lower.velocity - lower.axes @ cross(lower.omega, lower.axes.T @ reach)
    components = stiffness * (lower.axes.T @ reach - place) + damping * (lower.axes.T @ rate)
    components[2] -= load
    pull = lower.axes @ components
    on_lower = of_force(lower, pull, np.zeros(3)) + of_moment(lower, cross(reach, pull))
    return on_lower, of_force(upper, -pull, place_in_upper)
