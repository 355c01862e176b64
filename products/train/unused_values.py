"""Values of a consist that a brake model of trains does not use: such a model is refused, and not chosen."""

from __future__ import annotations

import math

from brake_controller.distributors import kind_of
from brake_controller.distributors.uic import UicDistributor, freight
from brake_controller.drivers_valve import DriversValve, drivers_valve
from products.train.consist import Consist, TrainVehicle

#: Diameter of a pipe that is not stated [m], and volume of a reservoir [m3].
PIPE, AUXILIARY = 0.03175, freight().auxiliary_volume
#: Remedies: brake model, and cells a vehicle of values that depend on them.
WHOLE, NEEDED_CELLS = "brake_model = whole", {"at": "two cells", "coupler_strength": "one cell"}
#: Place of a distributor that is not stated, as a share of the vehicle's length.
MIDDLE = 0.5
#: Area of a driver's valve's exhaust that is not stated [m2].
EXHAUST = drivers_valve().exhaust_area


def without_effect(consist: Consist, brake_model: str, cells: float) -> str:
    """Return a message about the first vehicle with a value that a brake model does not use; empty without one."""
    vehicles = list(enumerate(consist.vehicles, 1))
    vacuums = [number for number, vehicle in vehicles if kind_of(vehicle.distributor).vacuum]
    found = [(vacuums[0], "distributor")] if vacuums and brake_model != "whole" else []
    found += ((number, name) for number, vehicle in vehicles if (name := _unused(vehicle, brake_model, cells)))
    for number, name in found[:1]:
        model = f"brake_model = {brake_model} with {cells:g} cells a vehicle"
        take = NEEDED_CELLS.get(name, WHOLE) if brake_model != "delay" else WHOLE
        return f"{name} of vehicle {number} has no effect with {model}. Take {take}, or leave it out."
    return ""


def _unused(train_vehicle: TrainVehicle, model: str, cells: float) -> str:
    """Return the name of a vehicle's value that a brake model does not use."""
    own = train_vehicle.distributor
    if train_vehicle.distributor_at != MIDDLE and (model == "delay" or cells < 2.0):
        return "at"
    if model != "whole" and isinstance(own, UicDistributor) and own.auxiliary_volume != AUXILIARY:
        return "auxiliary"
    if train_vehicle.coupler.strength < math.inf and (model == "delay" or cells < 1.0):
        return "coupler_strength"
    if model != "delay":
        return ""
    if kind_of(own).assisted:
        return "distributor"
    narrow = isinstance(train_vehicle.valve, DriversValve) and train_vehicle.valve.exhaust_area != EXHAUST
    found = {
        "exhaust": narrow,
        "main_reservoir": train_vehicle.main_reservoir.reservoir_volume > 0.0,
        "pipe_diameter": train_vehicle.pipe_diameter != PIPE,
        "leak": train_vehicle.leak > 0.0,
        "branch": train_vehicle.branch > 0.0,
    }
    return next((name for name, is_stated in found.items() if is_stated), "")
