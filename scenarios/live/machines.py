"""What the live page drives: the bogie of chapter 5 and the coach, each with its brake cylinders, and how they look."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from brake_controller.cylinder import timed_brake
from brake_controller.parameters import BrakeParameters
from fmu_src.system import Model, System, model_of_choices
from products.braked_vehicle import brake_of, coach_brake, with_brakes
from rbd_model.contact.depth import Contact
from rbd_model.contact.geometry import Pair, synthetic_pair, thesis_pair
from rbd_model.levels.models import DEFAULT_DEPTH, DEFAULT_TOLERANCE, selectors
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.point import point_vehicle
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.description import Vehicle
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie

#: Torque capacity of one wheelset of the bogie, fully braked [N.m]: two thirds of what dry rails bear. Assumed.
BOGIE_TORQUE = 26e3


@dataclass(frozen=True)
class Machine:
    """A vehicle with its brakes. full_traction [N.m]: of each wheelset, assumed; pair: the profiles of its wheels."""

    title: str
    vehicle: Callable[[], Vehicle]
    brake: Callable[[], BrakeParameters]
    pair: Callable[[], Pair]
    full_traction: float


MACHINES = {
    "bogie": Machine(
        "Bogie (60 t on two axles)", two_axle_bogie, lambda: brake_of(two_axle_bogie(), BOGIE_TORQUE), thesis_pair, 15e3
    ),
    "coach": Machine("Coach (four axles)", passenger_coach, coach_brake, synthetic_pair, 5e3),
}


def levels(vehicle: Vehicle) -> tuple[System, ...]:
    """Those of the parameter `level`; in space with the depth of contact that the FMUs start with."""
    spatial = spatial_vehicle(vehicle, irregular_track(section_5_3()), Contact(int(DEFAULT_DEPTH)))
    return point_vehicle(vehicle), planar_vehicle(vehicle), spatial


@lru_cache
def model_of(name: str) -> Model:
    """The model inside the page, of a name in MACHINES."""
    machine = MACHINES[name]
    vehicle, brake = machine.vehicle(), machine.brake()
    systems = tuple(with_brakes(system, vehicle, lambda: timed_brake(brake)) for system in levels(vehicle))
    level, _ = selectors()
    return model_of_choices(
        f"Live{name.capitalize()}", machine.title, systems, [level], tuple(range(len(systems))), DEFAULT_TOLERANCE
    )
