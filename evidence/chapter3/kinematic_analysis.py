"""Kinematically driven systems, end of section 3.3.3: as many constraints as coordinates, eqs (3.79), (3.80)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from evidence.chapter3.euler import cross, g_bar, rotation_matrix
from evidence.chapter3.mechanism import FIRST_WHEELSET, Mechanism, MechanismState
from evidence.chapter3.partition import CLOSED, MAXIMUM_ROUNDS, NoSolutionError
from evidence.chapter3.surfaces import OffTheProfileError, profile_derivatives


@dataclass(frozen=True)
class DrivenPosition:
    """Position to which a wheelset is driven: distance, lateral [m], yaw, pitch [rad]; and its velocities [m/s, rad/s].

    Those of yaw and pitch are about the third and second of the axes that yaw and roll with it.
    """

    distance: float = 0.0
    lateral: float = 0.0
    yaw: float = 0.0
    pitch: float = 0.0
    speed: float = 0.0
    lateral_speed: float = 0.0
    yaw_rate: float = 0.0
    pitch_rate: float = 0.0


@dataclass(frozen=True)
class Frame:
    """Position to which a body above the wheelsets is driven.

    Its seven coordinates, velocity [m/s] and angular velocity in its axes [rad/s].
    """

    coordinates: np.ndarray
    velocity: np.ndarray
    omega: np.ndarray


def frames_at_rest(mechanism: Mechanism) -> list[Frame]:
    """The bodies above the wheelsets at their places over the track, as section 3.3.3 holds them."""
    radius = mechanism.parameters.wheel_radius
    return [
        Frame(over_track(body.along, radius + body.height), np.zeros(3), np.zeros(3)) for body in mechanism.layout.upper
    ]


def over_track(distance: float, height: float) -> np.ndarray:
    """Coordinates (7,) of a body that stands upright over the track's middle [m], section 3.2.1."""
    return np.array([distance, 0.0, height, 1.0, 0.0, 0.0, 0.0])


def centred(mechanism: Mechanism) -> np.ndarray:
    """Return (q, s), the unknowns (3.80), of all parts at their places, as a start of the Newton-Raphson iteration."""
    near = np.zeros(mechanism.unknowns)
    for number in range(mechanism.bodies):
        near[mechanism.body(number)][3] = 1.0
    for number, frame in enumerate(frames_at_rest(mechanism), mechanism.frame):
        near[mechanism.body(number)] = frame.coordinates
    for number in range(mechanism.wheelsets):
        place = over_track(mechanism.place(number), mechanism.parameters.wheel_radius)
        near[mechanism.body(FIRST_WHEELSET + number)] = place
    for contact in range(mechanism.contacts):
        near[mechanism.q_count + mechanism.rail_parameters(contact).start] = mechanism.place(contact // 2)
    return near


def rolling(mechanism: Mechanism, speed: float) -> MechanismState:
    """Everything at its place over the track and moving at `speed` [m/s], the wheels rolling (section 2.3.1)."""
    pitch_rate = speed / mechanism.parameters.wheel_radius
    wheelsets = [DrivenPosition(place, speed=speed, pitch_rate=pitch_rate) for place in mechanism.layout.wheelsets]
    frames = [replace(frame, velocity=np.array([speed, 0.0, 0.0])) for frame in frames_at_rest(mechanism)]
    return drive_to(mechanism, wheelsets, frames, centred(mechanism))


def drive_to(
    mechanism: Mechanism, wheelsets: Sequence[DrivenPosition], frames: Sequence[Frame], near: np.ndarray
) -> MechanismState:
    """Return the state with these driving constraints in addition to the system's, eq. (3.79); near: first (q, s).

    The speed must be free.
    """
    found, cut = near.copy(), mechanism.q_count
    for _ in range(MAXIMUM_ROUNDS):
        try:
            c, jacobian = mechanism.constraints(0.0, found[:cut], found[cut:])
        except OffTheProfileError:
            break
        errors, rows = driving_constraints(mechanism, wheelsets, frames, found)
        error, square = np.concatenate([c, errors]), np.vstack([jacobian, rows])
        if float(np.sqrt(error @ error)) < CLOSED:
            rates = np.linalg.solve(
                square_of_rates(mechanism, wheelsets, jacobian, found), driven_rates(mechanism, wheelsets, frames)
            )
            turning = [1] * mechanism.wheelsets
            return MechanismState(0.0, found[:cut], found[cut:], rates[:cut], rates[cut:], turning)
        try:
            found = found - np.linalg.solve(square, error)
        except np.linalg.LinAlgError:
            break
    shifts = ", ".join(f"{1e3 * wheelset.lateral:.4g}" for wheelset in wheelsets)
    raise NoSolutionError(f"No contact of all treads exists at a lateral shift of {shifts} mm.")


def driving_constraints(
    mechanism: Mechanism, wheelsets: Sequence[DrivenPosition], frames: Sequence[Frame], coordinates: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return errors and Jacobian of the drives (section 3.3.3): place, lateral, yaw, pitch of wheelsets, the frame."""
    errors, rows = [], []

    def hold(column: int, value: float) -> None:
        errors.append(coordinates[column] - value)
        rows.append(np.eye(1, mechanism.unknowns, column)[0])

    def level(start: int, vector: np.ndarray, place: np.ndarray) -> None:
        """vector . A place = 0"""
        theta = coordinates[start + 3 : start + 7]
        in_body = rotation_matrix(theta).T @ vector
        row = np.zeros(mechanism.unknowns)
        row[start + 3 : start + 7] = -cross(in_body, place) @ g_bar(theta)
        errors.append(in_body @ place)
        rows.append(row)

    for number, wheelset in enumerate(wheelsets):
        start = mechanism.body(FIRST_WHEELSET + number).start
        hold(start, wheelset.distance)
        hold(start + 1, wheelset.lateral)
        ahead = np.array([math.cos(wheelset.yaw), math.sin(wheelset.yaw), 0.0])
        level(start, ahead, np.array([0.0, 1.0, 0.0]))
        level(start, ahead, np.array([-math.sin(wheelset.pitch), 0.0, math.cos(wheelset.pitch)]))
    for number, frame in enumerate(frames, mechanism.frame):
        start = mechanism.body(number).start
        for i in (0, 1, 2, 4, *(() if mechanism.layout.level else (5,)), 6):
            hold(start + i, float(frame.coordinates[i]))
    return np.array(errors), np.array(rows)


def square_of_rates(
    mechanism: Mechanism, wheelsets: Sequence[DrivenPosition], jacobian: np.ndarray, coordinates: np.ndarray
) -> np.ndarray:
    """The constraints' Jacobian, as in (3.67), and, below it, the rows that give the driven rates."""
    rows = []
    for number, wheelset in enumerate(wheelsets):
        start = mechanism.body(FIRST_WHEELSET + number).start
        rows += [np.eye(1, mechanism.unknowns, start + i)[0] for i in (0, 1)]
        g = g_bar(coordinates[start + 3 : start + 7])
        for axis in (np.array([-math.sin(wheelset.pitch), 0.0, math.cos(wheelset.pitch)]), np.array([0.0, 1.0, 0.0])):
            row = np.zeros(mechanism.unknowns)
            row[start + 3 : start + 7] = axis @ g
            rows.append(row)
    for number in range(mechanism.frame, mechanism.bodies):
        start = mechanism.body(number).start
        rows += [np.eye(1, mechanism.unknowns, start + i)[0] for i in (0, 1, 2)]
        g = g_bar(coordinates[start + 3 : start + 7])
        for i in (0, 2) if mechanism.layout.level else (0, 1, 2):
            row = np.zeros(mechanism.unknowns)
            row[start + 3 : start + 7] = g[i]
            rows.append(row)
    return np.vstack([jacobian, *rows])


def driven_rates(mechanism: Mechanism, wheelsets: Sequence[DrivenPosition], frames: Sequence[Frame]) -> np.ndarray:
    """Return the right-hand side for the rates: zeros of the constraints (3.67), then the driven rates."""
    values = [0.0] * mechanism.equations
    for wheelset in wheelsets:
        values += [wheelset.speed, wheelset.lateral_speed, wheelset.yaw_rate, wheelset.pitch_rate]
    for frame in frames:
        values += [*frame.velocity, *(frame.omega[[0, 2]] if mechanism.layout.level else frame.omega)]
    return np.array(values)


def rolling_radii(mechanism: Mechanism, state: MechanismState, wheelset: int = 0) -> tuple[float, float]:
    """Radii [m] at which the right and the left wheel touch: their difference is Fig. 4.8."""
    profile, radius = mechanism.pair.wheel, mechanism.parameters.wheel_radius
    positions = [float(state.s[mechanism.wheel_parameters(2 * wheelset + side)][1]) for side in (0, 1)]
    right, left = (radius - float(profile_derivatives(profile, y)[0]) for y in positions)
    return right, left
