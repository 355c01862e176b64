"""Consists with other brakes, filling times and resistances: the parameters that can be fitted to measured stops."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from brake_controller.distributors import ep_direct, kind_of
from brake_controller.distributors.ep_direct import RELEASED, EpDirect
from brake_controller.distributors.piped import Piped
from brake_controller.distributors.uic import UicDistributor, release_time, with_times
from brake_controller.distributors.vacuum import VacuumBrake, with_fill_time
from products.train.consist import Consist, TrainVehicle, braked_by
from products.train.consist_columns import AIR, FORCE
from readers.quantity import Quantity, by_name

#: Parameters with unit and limits: brake weight percentage of each braked vehicle; factor on all brake forces; filling
#: time; factor on the running resistance; running resistance of the whole train.
PARAMETERS = by_name(
    FORCE["lambda"],
    Quantity("brake_factor", "1", 0.01, 100.0),
    AIR["fill_time"],
    Quantity("resistance_factor", "1", 0.01, 100.0),
    Quantity("resistance_a", "N", 0.1, 1e8),
    Quantity("resistance_b", "N/(m/s)", 1e-3, 1e7),
    Quantity("resistance_c", "N/(m/s)^2", 1e-4, 1e6),
)
#: Pairs of parameters that say the same in two ways.
TWICE = (
    ("lambda", "brake_factor"),
    *(("resistance_factor", f"resistance_{one}") for one in "abc"),
)


def changed(consist: Consist, values: Mapping[str, float]) -> Consist:
    """Return a consist with other parameters."""
    mass = consist.mass
    return Consist(tuple(_vehicle(vehicle, values, vehicle.mass / mass) for vehicle in consist.vehicles))


def _vehicle(train_vehicle: TrainVehicle, values: Mapping[str, float], share: float) -> TrainVehicle:
    factor = values.get("resistance_factor", 1.0)
    a, b, c = (
        share * values[name] if (name := f"resistance_{letter}") in values else factor * own
        for letter, own in zip("abc", train_vehicle.resistance, strict=True)
    )
    train_vehicle = replace(train_vehicle, resistance=(a, b, c))
    if isinstance(train_vehicle.distributor, Piped):
        return train_vehicle
    if "fill_time" in values:
        train_vehicle = _filling(train_vehicle, values["fill_time"])
    if "lambda" in values:
        pressure = train_vehicle.distributor.full_pressure
        train_vehicle = replace(
            train_vehicle,
            brake=braked_by(
                values["lambda"], train_vehicle.mass, train_vehicle.resistance, train_vehicle.rotating_share, pressure
            ),
        )
    if "brake_factor" in values:
        times, brake, electric = values["brake_factor"], train_vehicle.brake, train_vehicle.electric
        force, counter = times * brake.force_per_pressure, times * brake.counter_force
        train_vehicle = replace(train_vehicle, brake=replace(brake, force_per_pressure=force, counter_force=counter))
        train_vehicle = replace(train_vehicle, electric=replace(electric, dynamic_force=times * electric.dynamic_force))
    return train_vehicle


def _filling(train_vehicle: TrainVehicle, time: float) -> TrainVehicle:
    """Return a vehicle with another filling time [s] and its own release time."""
    own = train_vehicle.distributor
    if isinstance(own, UicDistributor) and "fill_time" in kind_of(own).adjustable:
        return replace(train_vehicle, distributor=with_times(own, time, release_time(own)))
    if isinstance(own, VacuumBrake):
        return replace(train_vehicle, distributor=with_fill_time(own, time))
    if isinstance(own, EpDirect):
        release = (own.full_pressure - RELEASED) / own.release_rate
        return replace(train_vehicle, distributor=ep_direct.with_times(own.full_pressure, time, release))
    raise ValueError(
        f"fill_time must be of vehicles with a filling time; a {train_vehicle.kind} has another. Fit other parameters."
    )
