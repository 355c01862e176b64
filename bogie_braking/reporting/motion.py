"""The motion of a vehicle in the three-dimensional view of a report.

The model gives the positions of wheelsets relative to their rails (`lateral_...`, `wheel_rise_...`), and those of
bodies relative to the axes of the track. Here both use axes that move with the vehicle: x ahead, y to the left, z above
the rails. On a line these are the axes of the track under the middle of the vehicle, without cant. Curves displace and
turn the places ahead and astern of these axes; each place is then turned by its own cant.
"""

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fmu_src.cosimulation.recording import Recording
from rbd_model.contact.profiles import Profile
from rbd_model.track.irregularity import TrackParameters, derivatives_along, section_5_3
from rbd_model.track.line import Line
from rbd_model.track.line_table import GAUGE
from rbd_model.vehicle.description import RigidBody, Vehicle, Wheelset, wheelset_name

SIDES = ("left", "right")
RAIL_ROWS = ("lateral", "left", "right", "curvature", "cant", "gradient")
#: Motions of a body in addition to the one along the track.
MOTIONS = ("lateral", "bounce", "roll", "pitch", "yaw")
#: Largest number of frames of a motion, and pitch of the rails' irregularities [m].
MOST_FRAMES, PITCH = 1500, 0.25
#: Smallest size of a drawn body along each axis [m], and length of the rails beyond each end of the vehicle [m].
SMALLEST_BODY, RAILS_BEYOND = 0.3, 1.5
#: Displayed size of the largest displacement at first [m], exaggerated by no more than MOST_EXAGGERATION.
SHOWN_DISPLACEMENT, MOST_EXAGGERATION = 0.15, 50
#: Number of points of a drawn profile.
PROFILE_POINTS = 240


def motion_columns(vehicle: Vehicle) -> tuple[str, ...]:
    """Return the names of the variables that a `Motion` needs, at any level of detail; a variable that a level lacks is
    0.
    """
    wheels = [
        f"{name}_{number}_{side}"
        for number, _ in vehicle.numbered
        for side in SIDES
        for name in ("wheel_rise", "wheel_load", "lateral_force")
    ]
    wheelsets = [f"{name}_{number}" for number, _ in vehicle.numbered for name in ("lateral", "yaw", "rotation")]
    bodies = [body.variable(motion) for body in vehicle.bodies for motion in MOTIONS]
    return ("distance", "speed", *wheelsets, *wheels, *bodies)


@dataclass(frozen=True)
class Motion:
    """A run, its vehicle, its recording (`motion_columns`), and the track if it is uneven or curved."""

    text: str
    vehicle: Vehicle
    series: Recording
    track: TrackParameters | Line | None = None

    @property
    def frames(self) -> slice:
        """Return the rows that are shown."""
        return slice(None, None, -(-self.series["time"].size // MOST_FRAMES))

    def column(self, name: str) -> np.ndarray:
        """Return the shown rows of one column."""
        return self.series[name][self.frames]

    @property
    def in_space(self) -> bool:
        """Return whether the motion leaves the vertical plane."""
        return any(np.any(self.column(f"lateral_{number}")) for number, _ in self.vehicle.numbered)


@dataclass(frozen=True)
class Rails:
    """Lateral position of both rails, height of the left and of the right one [m], curvature [1/m], cant [m] and
    gradient [1] over the distance [m]: `RAIL_ROWS`.
    """

    distance: np.ndarray
    rows: Mapping[str, np.ndarray]

    def at(self, distance: np.ndarray, name: str) -> np.ndarray:
        """Return one of the rows at places along the track [m]."""
        return np.interp(distance, self.distance, self.rows[name])

    def bend(self, distance: np.ndarray, ahead: float) -> tuple[np.ndarray, np.ndarray]:
        """Return displacement [m] and angle [rad] of the track due to curvature at a distance `ahead` of a place [m].

        The curvature is linear between both places, and angles are small.
        """
        here, there = self.at(distance, "curvature"), self.at(distance + ahead, "curvature")
        return ahead**2 * (2 * here + there) / 6, ahead * (here + there) / 2


def rails_under(motion: Motion) -> Rails:
    """Return the rails over the distance that the vehicle covers, and RAILS_BEYOND."""
    beyond = half_length(motion.vehicle) + RAILS_BEYOND
    first, last = motion.column("distance")[[0, -1]] + [-beyond, beyond]
    distance = np.arange(first, last + PITCH, PITCH)
    if motion.track is None:
        distance, table = np.array([first, last]), np.zeros((len(RAIL_ROWS), 2))
    elif isinstance(motion.track, Line):
        table = rows_of_line(motion.track, distance)
    else:
        table = rows_of_track(motion.track, distance)
    return Rails(distance, dict(zip(RAIL_ROWS, table, strict=True)))


def rows_of_track(track: TrackParameters, distance: np.ndarray) -> np.ndarray:
    """Return the rows of `Rails`, shape (6, n), of a track."""
    at = derivatives_along(track)
    return np.array([[*at(place)[0], 0.0, 0.0, 0.0] for place in distance.tolist()]).T


def rows_of_line(line: Line, distance: np.ndarray) -> np.ndarray:
    """Return the rows of `Rails`, shape (6, n), of a line; columns that its file lacks are 0."""
    names = ("left_lateral", "right_lateral", "left_vertical", "right_vertical", "curvature", "cant", "gradient")
    rows = [line.value(name, distance) for name in names]
    return np.array([(rows[0] + rows[1]) / 2, *rows[2:]])


def half_length(vehicle: Vehicle) -> float:
    """Return the distance from the middle to the end of the last box or wheel [m]."""
    boxes = [box(vehicle, body) for body in vehicle.bodies]
    wheels = [
        abs(vehicle.number(wheelset.along)) + vehicle.number(wheelset.mean_radius) for wheelset in vehicle.wheelsets
    ]
    return float(max(*wheels, *(np.abs(corners[:, 0]).max() for corners in boxes)))


def box(vehicle: Vehicle, body: RigidBody) -> np.ndarray:
    """Return the lowest and highest corner of a body above the axles [m]: a box around its centre and its forces'
    points.
    """
    centre = np.array([vehicle.number(size) for size in (body.along, 0.0, body.height)])
    ends = [
        connection.sides() for connection in vehicle.connections if body.name in (connection.upper, connection.lower)
    ]
    places = [place for sides in ends for _, place in sides]
    places += [pull.place for pull in vehicle.pulls if pull.body == body.name]
    points = np.array([centre, *([vehicle.number(size) for size in place] for place in places)])
    low, high = points.min(axis=0), points.max(axis=0)
    lacking = np.maximum(SMALLEST_BODY - (high - low), 0.0) / 2
    return np.array([low - lacking, high + lacking])


def packed(motion: Motion) -> dict[str, Any]:
    """Return all data of motion.js in the form of JSON; series as base64 of 32-bit floats."""
    rails, vehicle = rails_under(motion), motion.vehicle
    return {
        "time": series(motion.column("time")),
        "speed": series(motion.column("speed")),
        "distance": series(motion.column("distance")),
        "half_length": half_length(vehicle) + RAILS_BEYOND,
        "exaggeration": exaggeration(motion),
        "in_space": motion.in_space,
        "on_line": isinstance(motion.track, Line),
        "gauge": GAUGE,
        "bodies": [body_of(motion, rails, body) for body in vehicle.bodies],
        "wheelsets": [wheelset_of(motion, rails, number, one) for number, one in vehicle.numbered],
        "rails": {name: series(values) for name, values in {"distance": rails.distance, **rails.rows}.items()},
    }


def series(values: np.ndarray) -> str:
    """Return values as base64 of little-endian single precision."""
    return base64.b64encode(values.astype("<f4").tobytes()).decode()


def exaggeration(motion: Motion) -> int:
    """Return the first exaggeration factor [1], which makes the largest displacement visible."""
    across = [f"lateral_{number}" for number, _ in motion.vehicle.numbered]
    names = [*across, *(body.variable(one) for body in motion.vehicle.bodies for one in ("lateral", "bounce"))]
    largest = max(float(np.abs(motion.column(name)).max()) for name in names)
    return int(np.clip(SHOWN_DISPLACEMENT / max(largest, 1e-9), 1, MOST_EXAGGERATION))


def body_of(motion: Motion, rails: Rails, body: RigidBody) -> dict[str, Any]:
    """Return a body's centre at rest, its box around that centre, and its motions."""
    vehicle = motion.vehicle
    centre = [vehicle.number(size) for size in (body.along, 0.0, body.height)]
    moves = {name: motion.column(body.variable(name)) for name in MOTIONS}
    aside, turned = rails.bend(motion.column("distance"), centre[0])
    moves |= {"lateral": moves["lateral"] + aside, "yaw": moves["yaw"] + turned}
    above = [centre[0], centre[1], centre[2] + vehicle.number(vehicle.wheelsets[0].mean_radius)]
    shown = {name: series(values) for name, values in moves.items()}
    return {"text": body.text, "centre": above, "box": (box(vehicle, body) - centre).tolist()} | shown


def wheelset_of(motion: Motion, rails: Rails, number: int, wheelset: Wheelset) -> dict[str, Any]:
    """Return a wheelset's place, its motions relative to the track's axes, and the data of each wheel on its rail."""
    along = motion.vehicle.number(wheelset.along)
    under = motion.column("distance") + along
    aside, turned = rails.bend(motion.column("distance"), along)
    half = (wheelset.pair.left.wheel_half_distance + wheelset.pair.right.wheel_half_distance) / 2
    rises = [motion.column(f"wheel_rise_{number}_{side}") for side in SIDES]
    left, right = (rise + rails.at(under, side) for rise, side in zip(rises, SIDES, strict=True))
    offset = motion.column(f"lateral_{number}")
    return {
        "text": wheelset_name(number).replace("_", " "),
        "along": along,
        "radius": motion.vehicle.number(wheelset.mean_radius),
        "half_distance": half,
        "lateral": series(offset + rails.at(under, "lateral") + aside),
        "bounce": series((left + right) / 2),
        "roll": series(np.arcsin((left - right) / (2 * half))),
        "yaw": series(motion.column(f"yaw_{number}") + turned),
        "rotation": series(motion.column(f"rotation_{number}")),
        "offset": series(offset),
        "wheels": [wheel_of(motion, wheelset, number, place) for place in range(2)] if motion.in_space else [],
    }


def wheel_of(motion: Motion, wheelset: Wheelset, number: int, place: int) -> dict[str, Any]:
    """Return one wheel on its rail, viewed along the track: both profiles, rise [m], vertical and lateral force [N]."""
    side, word = wheelset.pair.both[place], SIDES[place]
    return {
        "text": word,
        "side": 1 - 2 * place,
        "radius": side.radius,
        "wheel_half_distance": side.wheel_half_distance,
        "rail_half_distance": side.rail_half_distance,
        "wheel": drawn(side.wheel),
        "rail": drawn(side.rail),
        "rise": series(motion.column(f"wheel_rise_{number}_{word}")),
        "load": series(motion.column(f"wheel_load_{number}_{word}")),
        "lateral_force": series(motion.column(f"lateral_force_{number}_{word}")),
    }


def drawn(profile: Profile) -> list[list[float]]:
    """Return the points (y outwards, z) of a profile [mm]."""
    y = np.linspace(*profile.limits, PROFILE_POINTS)
    return np.round(1e3 * np.column_stack([y, profile.height(y)]), 3).tolist()


def irregular(**amplitudes: float) -> TrackParameters:
    """Return the track of section 5.3 with these irregularities [m]."""
    return TrackParameters(**section_5_3().values() | amplitudes)
