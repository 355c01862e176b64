"""Convert states of level 3 at contact model 2 into bodies in an inertial frame, and slopes into accelerations.

The model measures positions and velocities in the axes of the track at each body; its slopes are their rates. Both are
converted by their meaning alone: states a moment earlier and later are differenced in the inertial frame.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fmu_src.kernel import Kernel
from rbd_model.track.line import Line
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.description import Vehicle, wheelset_name
from tests.evidence.maximal.motion import Moving, about
from tests.evidence.maximal.rails import Course

#: Half of the time over which states are differenced [s].
MOMENT = 1e-6
#: Two depths below the rest position to which a wheelset is pressed, to find where its wheels begin to touch [m].
PRESSED = 20e-6, 60e-6
#: Distance of the rows of a line [m]: short enough that interpolation gives the analytical line to 1e-14 rad.
ROW_DISTANCE, LINE_BEGIN, LINE_END = 0.25, -30.0, 40.0


def file_of(course: Course, path: Path) -> str:
    """Write the line as the model reads it, and return its path."""
    distance = np.arange(LINE_BEGIN, LINE_END, ROW_DISTANCE)
    rows = {"distance": distance}
    laws = {"curvature": course.curvature, "cant": course.roll, "gradient": course.gradient}
    # Positive cant raises the right rail, which is a roll to the right.
    factors = {"cant": -GAUGE}
    for name, (value, slope) in laws.items():
        rows[name] = factors.get(name, 1.0) * (value + slope * distance)
    return str(Line(rows).write(path))


def bodies_of(vehicle: Vehicle, course: Course, value: Mapping[str, float]) -> dict[str, Moving]:
    """Return bodies and wheelsets by name, from states by name."""
    first, found = vehicle.bodies[0].name, {}
    radius = vehicle.number(vehicle.wheelsets[0].mean_radius)

    def on_track(
        place: float, across: list[float], motion: list[float], angles: list[float], rates: list[float], spins: bool
    ) -> Moving:
        """across: to the left and up. spins: for a wheelset, whose rates are in axes that do not pitch with it."""
        track, (roll, pitch, yaw) = course.axes(place)[0], angles
        leaning = track @ about(2, yaw) @ about(0, roll)
        axes = leaning @ about(1, pitch)
        position = course.origin(place)[0] + track @ [0.0, *across]
        return Moving(position, axes, track @ motion, (leaning if spins else axes) @ rates)

    for body in vehicle.bodies:

        def of(motion: str, rate: str = "", body=body) -> float:  # type: ignore[no-untyped-def]
            return value.get(f"{body.variable(motion)}{rate}", 0.0)

        shift, ahead = value.get(f"{body.name}_shift", 0.0), value.get(f"{body.name}_shift_speed", 0.0)
        found[body.name] = on_track(
            value[f"{first}_distance"] + vehicle.number(body.along) + shift,
            [of("lateral"), radius + vehicle.number(body.height) + of("bounce")],
            [value[f"{first}_speed"] + ahead, of("lateral", "_rate"), of("bounce", "_rate")],
            [of("roll"), of("pitch"), of("yaw")],
            [of("roll", "_rate"), of("pitch", "_rate"), of("yaw", "_rate")],
            False,
        )
    for number, data in vehicle.numbered:

        def at(name: str, number: int = number) -> float:
            return value[f"{name}_{number}"]

        found[wheelset_name(number)] = on_track(
            value[f"{first}_distance"] + vehicle.number(data.along) + at("shift"),
            [at("lateral"), vehicle.number(data.mean_radius) + at("rise")],
            [value[f"{first}_speed"] + at("shift_speed"), at("lateral_speed"), at("rise_speed")],
            [at("roll"), at("rotation"), at("yaw")],
            [at("roll_rate"), at("angular_velocity"), at("yaw_rate")],
            True,
        )
    return found


@dataclass(frozen=True)
class Rate:
    """Rates of a body from the slopes, shape (6,) each.

    `kinematic`: change of position and axes less velocity and angular velocity. `acceleration`: linear and angular.
    """

    kinematic: np.ndarray
    acceleration: np.ndarray


def rates_of(
    vehicle: Vehicle, course: Course, value: Mapping[str, float], slope: Mapping[str, float]
) -> dict[str, Rate]:
    """Return the rates of the bodies in the inertial frame from the slopes of the states."""
    now, behind, ahead = (
        bodies_of(vehicle, course, {name: start + sign * MOMENT * slope[name] for name, start in value.items()})
        for sign in (0, -1, 1)
    )
    wheelsets = {wheelset_name(number) for number, _ in vehicle.numbered}

    def by_time(name: str, what: str) -> np.ndarray:
        return np.asarray((getattr(ahead[name], what) - getattr(behind[name], what)) / (2 * MOMENT))

    found = {}
    for name, body in now.items():
        turning = by_time(name, "axes") @ body.axes.T
        turned = np.array([turning[2, 1], turning[0, 2], turning[1, 0]]) - body.rate
        if name in wheelsets:
            # The rotation of a wheelset is a state of its own; its axes do not spin.
            turned -= body.axes[:, 1] * (body.axes[:, 1] @ turned)
        missing = np.concatenate([by_time(name, "position") - body.velocity, turned])
        found[name] = Rate(missing, np.concatenate([by_time(name, "velocity"), by_time(name, "rate")]))
    return found


def touching_rise(kernel: Kernel, names: list[str]) -> float:
    """Return `rise_1` [m] at which a centred wheelset on straight and level track begins to touch its rails.

    This origin is the only value taken from the model: it follows from two loads and the power 3/2 of Hertz' law.
    `kernel`: at rest, without friction. `names`: of its states.
    """
    state, which = kernel.linearise().state, names.index("rise_1")
    loads = []
    for pressed in PRESSED:
        place = list(state)
        place[which] -= pressed
        kernel.arrive(0.0, place)
        loads.append(kernel["wheel_load_1_left"])
    ratio = (loads[1] / loads[0]) ** (2 / 3)
    return state[which] + (PRESSED[1] - ratio * PRESSED[0]) / (ratio - 1)
