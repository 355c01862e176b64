"""Vehicles of the live page: the bogie of chapter 5 and the coach, each with its brake cylinders, and their views."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from fmu_src.system import NONE, Model, System, model_of_choices
from products import machine as braked
from products.machine import FULL_PRESSURE, coach, composed
from rbd_model.contact.depth import Contact
from rbd_model.contact.geometry import Pair, synthetic_pair, thesis_pair
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.levels.models import DEFAULT_TOLERANCE, DEPTH_ON_LINE, selectors
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.track.line_table import LINE
from rbd_model.vehicle.description import Vehicle

#: Torque capacity of one wheelset of the bogie, fully braked [N.m]: two thirds of the limit at a friction of 0.3;
#: assumed.
BOGIE_TORQUE = 26e3
#: Yaw torque of a wheelset over its brake torque at an error of the shoes of 100 %. Chapter 9 has 43.92 kN.m for an
#: error of 25 % at a brake torque of 20 kN.m, and its other rows are in proportion.
YAW_PER_BRAKE_TORQUE = 43.92 / 20 / 0.25


@dataclass(frozen=True)
class LiveVehicle:
    """A vehicle of the page and its view. full_traction [N.m]: of each wheelset; pair: profiles of its wheels.

    mass: the body whose mass the page sets, as a word, and the parameter.
    """

    title: str
    braked: braked.Machine
    pair: Callable[[], Pair]
    full_traction: float  # assumed
    mass: tuple[str, str] = ("body", "body_mass")


MACHINES = {
    "coach": LiveVehicle("coach", coach(), synthetic_pair, 5e3),
    "bogie": LiveVehicle(
        "bogie",
        braked.Machine("bogie", FULL_PRESSURE, BOGIE_TORQUE, FULL_PRESSURE),
        thesis_pair,
        15e3,
        ("frame", "frame_mass"),
    ),
}


def levels(vehicle: Vehicle) -> tuple[System, ...]:
    """Return the systems of the parameter `level`; the one in 3D runs on the line of a file."""
    spatial = spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(DEPTH_ON_LINE), on_line=True)
    return point_vehicle(vehicle), planar_vehicle(vehicle), spatial


@lru_cache
def model_of(name: str) -> Model:
    """Return the model inside the page, of a name in MACHINES."""
    machine = MACHINES[name]
    systems = tuple(composed(machine.braked, system) for system in levels(machine.braked.vehicle))
    level, _ = selectors()
    # Levels 1 and 2 run without a line's file, level 3 with one.
    choice = (0, 1, NONE, NONE, NONE, 2)
    name = f"Live{name.capitalize()}"
    return model_of_choices(
        name, machine.title, systems, [level], choice, DEFAULT_TOLERANCE, LINE.variable, PAIR_FILE.variable
    )
