"""Accelerations at a point of a body, as sensors on its floor measure them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bogie_braking.checks import known, line_or_none, number, shown
from bogie_braking.machines import described
from bogie_braking.running.filters import finite, interval_of
from fmu_src.cosimulation.recording import Recording
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.description import Vehicle

#: Degree of the splines through the rows whose derivatives are taken.
DEGREE = 5
#: Largest distance of a point from the middle of a body [m].
FARTHEST = 50.0


@dataclass(frozen=True)
class _Motion:
    """Motion of a body over rails: place of its centre in the axes of the track [m], angles [rad], gravity [m/s2]."""

    time: np.ndarray
    lateral: np.ndarray
    height: float
    bounce: np.ndarray
    roll: np.ndarray
    pitch: np.ndarray
    yaw: np.ndarray
    gravity: float

    @classmethod
    def of(cls, recording: Recording, vehicle: Vehicle, body: str) -> _Motion:
        """Return that of a body by its name. Raises KeyError."""
        data = {one.name: one for one in vehicle.bodies}[known(body, [one.name for one in vehicle.bodies], "body")]
        lateral, bounce, roll, pitch, yaw = (
            finite(recording, data.variable(motion)) for motion in ("lateral", "bounce", "roll", "pitch", "yaw")
        )
        height = vehicle.number(vehicle.wheelsets[0].mean_radius) + vehicle.number(data.height)
        return cls(recording["time"], lateral, height, bounce, roll, pitch, yaw, vehicle.number("gravity"))


def floor_accelerations(
    recording: Recording,
    vehicle: str | DataSheet | Vehicle,
    place: Sequence[float],
    body: str = "body",
    line: Line | None = None,
) -> Recording:
    """Return the accelerations at a point of a rigid body, as sensors there measure them.

    They are derivatives of the recorded motion, in the axes of the body and with the part of gravity that its roll and
    pitch turn into these axes. The vertical one is 0 at rest. A shorter recording interval gives them more precisely.

    Parameters
    ----------
    recording : Recording
        Run of the vehicle at level 3 with a row every 5 ms or more often. Its columns are `distance`, `speed`,
        `acceleration`, and lateral, bounce, roll, pitch and yaw of the body.
    vehicle : str, DataSheet or Vehicle
        The vehicle of the run. It has the height of the body's centre of gravity.
    place : sequence of float
        Place of the point [m]. It is ahead of the body's centre, to the left of it, and above the rails.
    body : str
        Name of the body. A frame is "front_frame" or "rear_frame".
    line : Line, optional
        Line of the run. Its curvature, cant and gradient add to the accelerations; without it the track is straight.

    Returns
    -------
    Recording
        `time`, `distance`, and `acceleration_x`, `acceleration_y`, `acceleration_z` [m/s2]: ahead, to the left, up.

    Raises
    ------
    KeyError
        If the vehicle, the body or a column is unknown.
    ValueError
        If the place is not three numbers within 50 m, the run is not at level 3, or rows are uneven or more than 5 ms
        apart.
    """
    from scipy.spatial.transform import Rotation  # heavy

    x, y, z = _place(place)
    interval_of(recording)
    own = _Motion.of(recording, described(vehicle), body)
    if not any(np.any(values) for values in (own.lateral, own.roll, own.yaw)):
        raise ValueError(
            f"{body} must move sideways; lateral, roll and yaw are 0 in all rows, as at levels 1 and 2. Run with "
            "level=3, not on a smooth and straight line."
        )
    time, distance, speed = own.time, finite(recording, "distance"), finite(recording, "speed")
    laid = line_or_none(line)
    curvature, cant, gradient = (
        np.zeros_like(time) if laid is None else laid.value(name, distance)
        for name in ("curvature", "cant", "gradient")
    )
    # Of a point of the track, and of the place from there to the point of the body, in axes that do not turn.
    heading, slope, cants = _slope(time, speed * curvature, -1), -np.arcsin(gradient), -np.arcsin(cant / GAUGE)
    ahead = Rotation.from_euler("ZY", np.column_stack([heading, slope]))
    above = Rotation.from_euler("ZX", np.column_stack([heading, cants]))
    axes = Rotation.from_euler("ZYX", np.column_stack([heading, slope, cants]))
    axes *= Rotation.from_euler("ZYX", np.column_stack([own.yaw, own.pitch, own.roll]))
    centre = above.apply(np.column_stack([np.zeros_like(time), own.lateral, own.height + own.bounce]))
    bends = speed * np.array([speed * curvature, -_slope(time, slope, 1)])
    moves = ahead.apply(np.vstack([finite(recording, "acceleration"), bends]).T)
    moves += _slope(time, centre + axes.apply([x, y, z - own.height]), 2)
    weight = np.array([0.0, 0.0, own.gravity])
    found = axes.inv().apply(moves + weight) - weight
    units = {"time": "s", "distance": "m"} | dict.fromkeys((f"acceleration_{axis}" for axis in "xyz"), "m/s2")
    return Recording(units, np.column_stack([time, distance, found]))


def _place(place: Sequence[float]) -> tuple[float, float, float]:
    try:
        found = [number(one) for one in place]
    except TypeError:
        found = []
    if len(found) != 3 or not all(abs(one) <= FARTHEST for one in found):
        raise ValueError(
            f"place must be three numbers within {FARTHEST:g} m; got {shown(place)}. Give x ahead, y to the left, z "
            "above the rails."
        )
    return found[0], found[1], found[2]


def _slope(time: np.ndarray, values: np.ndarray, order: int) -> np.ndarray:
    """Return a derivative of columns by time, of order -1 the integral."""
    from scipy.interpolate import make_interp_spline  # heavy

    return np.asarray(make_interp_spline(time, values, min(DEGREE, time.size - 1)).derivative(order)(time))
