"""A machine and the cylinders of its wheelsets as one system, for the test rig."""

from __future__ import annotations

from functools import lru_cache

from brake_controller.cylinder import timed_brake
from fmu_src.system import Model, model_of
from products.braked_vehicle import brake_of, with_brakes
from products.protection.braked_machine import bogie, coach
from rbd_model.levels.models import DEFAULT_TOLERANCE, places_of, system_at
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie


@lru_cache
def machine_model(counted: str) -> Model:
    """The planar bogie (counted: frame) or coach (body) with a timed cylinder on each wheelset, one system."""
    machine = bogie() if counted == "frame" else coach()
    vehicle = two_axle_bogie() if counted == "frame" else passenger_coach()
    brake, [planar] = brake_of(vehicle, machine.full_torque), places_of(level=2, on_line=False)
    system = with_brakes(system_at(vehicle, planar), vehicle, lambda: timed_brake(brake))
    return model_of(system, DEFAULT_TOLERANCE)
