"""A wheelset that is pushed sideways against its rail, at the height of the rail, until it climbs."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library, SimulationError
from fmu_src.system import model_of
from rbd_model.contact.depth import Contact
from rbd_model.contact.geometry import Pair
from rbd_model.contact.profiles import from_points, rail_60kg, synthetic_wheel
from rbd_model.levels.models import DEFAULT_TOLERANCE
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.description import Pull, Vehicle, Wheelset
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.vehicle.ready import axle_box_springs, sprung_mass

#: The wheelset of chapter 5 under 10 t; its springs fix the yaw and leave it free laterally, where a damper slows the
#: push. All assumed.
GUIDED = {
    "frame_mass": 10e3,
    "longitudinal_stiffness": 1e9,
    "longitudinal_damping": 1e6,
    "lateral_stiffness": 1e3,
    "lateral_damping": 2e5,
    "constant_speed": 1.0,
}
YAW_STIFFNESS = 2 * GUIDED["longitudinal_stiffness"] * tables_5_1_and_5_2().longitudinal_half_spacing ** 2
HELD = frozenset({"lateral", "roll", "pitch", "yaw"})
#: Speed [m/s]; initial position of the wheelset [m]; growth rate of the push [N/s], and its recording interval [s].
SPEED, START, GROWTH, INTERVAL = 1.0, 7.5e-3, 10e3, 0.01
#: Push at the start over friction [N]: less than the creep force of both wheels, so that the flange arrives slowly.
FIRST_PUSH = -27e3
#: Distance of the push below the axle [m], at the height of the flange's contact: no load shifts.
BELOW = 0.42


def vehicle_that_climbs(flange_angle: float) -> Vehicle:
    """Return the wheelset with the synthetic profile and this flange angle [rad]."""
    points = synthetic_wheel(flange_angle=flange_angle)
    wheel = from_points(f"synthetic wheel, flange {math.degrees(flange_angle):g} degrees", "as wheel_cone_120", *points)
    pair = Pair(wheel, rail_60kg(), 0.425, 0.570, 0.570)
    return Vehicle(
        "ClimbingWheelset",
        replace(tables_5_1_and_5_2(), **GUIDED),
        (
            sprung_mass(
                "frame", "frame", held=frozenset({"lateral", "roll", "pitch", "yaw"}), plain=("bounce", "pitch")
            ),
        ),
        (Wheelset(0.0, "frame", pair=pair),),
        axle_box_springs("frame", 1, 0.0),
        (Pull("lateral_push", "Lateral force on the wheelset", "wheelset_1", (0.0, 0.0, -BELOW), "lateral"),),
    )


@lru_cache
def climbing_wheelset(flange_angle: float, contact: Contact) -> Library:
    """Return its kernel, with contact model 2."""
    system = spatial_vehicle(vehicle_that_climbs(flange_angle), irregular_track(section_5_3()), contact)
    return Library(build_library(model_of(system, DEFAULT_TOLERANCE)))


@dataclass(frozen=True)
class Climb:
    """A push until the wheel climbs over the flange, every INTERVAL:

    Y/Q of the left wheel, rise of the wheelset's centre and of the wheel [m]; and the messages.
    """

    quotient: np.ndarray
    rise: np.ndarray
    wheel_rise: np.ndarray
    messages: list[str]
    steps: int

    def limit(self, low: float, high: float) -> float:
        """Return Y/Q while the wheel rises between two heights [m]; NaN if it never did."""
        chosen = self.quotient[(self.rise > low) & (self.rise < high)]
        return float(np.median(chosen)) if chosen.size else math.nan


def instants(library: Library, friction: float, yaw: float, gauge_face: float = 1.0) -> Iterator[Kernel]:
    """Yield the kernel every INTERVAL under a growing push to the left, until the run ends.

    Takes yaw [rad].
    """
    start = {"initial_lateral": START, "initial_yaw": yaw}
    kernel = Kernel(library, initial_speed=SPEED, friction_1=friction, gauge_face_friction=gauge_face, **start)
    kernel.set(yaw_torque_1=YAW_STIFFNESS * yaw)
    pushed = FIRST_PUSH * friction
    while not kernel.ended:
        kernel.set(lateral_push=pushed)
        kernel.set_rate(lateral_push=GROWTH)
        try:
            kernel.advance(INTERVAL)
        except SimulationError:
            break
        pushed += GROWTH * INTERVAL
        yield kernel


def push(library: Library, friction: float, yaw: float, gauge_face: float = 1.0) -> Climb:
    """Return the course of a growing push to the left.

    Takes yaw [rad].
    """
    noted = []
    for kernel in instants(library, friction, yaw, gauge_face):
        noted.append([kernel[name] for name in ("derailment_quotient_1_left", "state_rise_1", "wheel_rise_1_left")])
    quotient, rise, wheel_rise = np.array(noted).T
    return Climb(quotient, rise, wheel_rise, kernel.messages, kernel.counts["steps"])
