"""The brake of a vehicle in the columns of a consist, both ways: distributor, force and friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from brake_controller.brake_weight import (
    FROM_100,
    NOTHING,
    SPEEDS,
    braking_way,
    check_percentage,
    force_of_percentage,
)
from brake_controller.distributors import ep_direct, kind_of
from brake_controller.distributors.aar import (
    RETAINERS,
    AarValve,
    FreightCar,
    retaining,
    slow_exhaust,
    with_release_time,
)
from brake_controller.distributors.aar import release_time as release_time_of_car
from brake_controller.distributors.distributor import DistributorParameters
from brake_controller.distributors.ecp import EcpValve, with_fill_time
from brake_controller.distributors.ecp import fill_time as fill_time_of_ecp
from brake_controller.distributors.ep_direct import FILLING, RELEASE, RELEASED, EpDirect
from brake_controller.distributors.piped import Piped
from brake_controller.distributors.registered import POSITIONS
from brake_controller.distributors.uic import OF_UIC, UicDistributor, filling_time, release_time, with_times
from brake_controller.distributors.vacuum import VacuumBrake
from brake_controller.shoe_friction import CONSTANT, KILOMETRES_PER_HOUR
from brake_controller.track_brakes import lowered_magnets
from brake_controller.vehicle_brake import (
    FORCELESS,
    FRACTIONS,
    FRICTIONS,
    NO_LAW,
    TABLE,
    VehicleBrake,
    over_points,
    over_speed,
    points_of,
)
from products.train.cell_tables import points_in, text_of
from products.train.consist import PERCENTAGE, TrainVehicle, braked_by, braked_with, forces_of
from products.train.consist_columns import si
from products.train.vacuum_trains import brake_of_row, row_of_vacuum

#: Cylinder data that are not stated: those of the wagon [1], [1], [N].
CYLINDER = {"cylinders": 1.0, "rigging_efficiency": 0.83, "return_force": 1500.0}
#: Friction radius of pads over the wheel's radius. Assumed.
PAD_RADIUS = 0.6
#: Diameters of cylinders by which a brake without a stated cylinder is written [mm].
DIAMETERS = (406.0, 150.0, 1000.0, 50.0)


def distributor_of(values: Mapping[str, Any], usual: DistributorParameters) -> DistributorParameters:
    """Return a vehicle's distributor with the pressure, times and volumes of a row."""
    if values.get("brake") == "none":
        return Piped(full_pressure=0.0)
    if isinstance(usual, VacuumBrake):
        return brake_of_row(values)
    if values.get("brake") == "ep-direct":
        times = values.get("fill_time", FILLING), values.get("release_time", RELEASE)
        return ep_direct.with_times(si(values, "full_pressure", usual.full_pressure), *times)
    if isinstance(usual, FreightCar):
        return _freight_car(values, usual)
    one = replace(usual, full_pressure=si(values, "full_pressure", usual.full_pressure))
    if not isinstance(one, UicDistributor) or not {"full_pressure", *OF_UIC} & set(values):
        return one
    assert isinstance(usual, UicDistributor)
    filling, release = filling_time(usual, 0.95 * usual.full_pressure), release_time(usual)
    volumes = {f"{name}_volume": si(values, name) for name in ("auxiliary", "cylinder") if name in values}
    return with_times(replace(one, **volumes), values.get("fill_time", filling), values.get("release_time", release))


def _freight_car(values: Mapping[str, Any], freight_car: FreightCar) -> FreightCar:
    """Return an AAR or ECP valve with the times, retainer, release and empty/load device of a row."""
    if "release_time" in values:
        freight_car = with_release_time(freight_car, values["release_time"])
    if "fill_time" in values and isinstance(freight_car, EcpValve):
        freight_car = with_fill_time(freight_car, values["fill_time"])
    if not isinstance(freight_car, AarValve):
        return freight_car
    share = values.get("empty_load", 1.0)
    freight_car = replace(freight_car, empty_share=share, full_pressure=share * freight_car.full_pressure)
    if values.get("accelerated_release") == "no":
        freight_car = replace(freight_car, accelerated_choke=0.0)
    return replace(freight_car, **retaining(values["retainer"])) if "retainer" in values else freight_car


def brake_of(values: Mapping[str, Any], train_vehicle: TrainVehicle) -> VehicleBrake:
    """Return a vehicle's brake by a row."""
    pressure, friction = train_vehicle.distributor.full_pressure, friction_of(values)
    beside = lowered_magnets(train_vehicle.track, SPEEDS) if values.get("position") == "R+Mg" else NOTHING
    usual = replace(train_vehicle.brake, shoes=values.get("shoes", train_vehicle.brake.shoes), **friction)
    law = bool(friction) and friction["friction_law"] != CONSTANT
    if "cylinder_diameter" in values:  # eqs (2.4) to (2.6)
        light = {"return_force": 0.0} if isinstance(train_vehicle.distributor, VacuumBrake) else {}
        stated = CYLINDER | light | {name: values[name] for name in CYLINDER if name in values}
        transmitted = stated["cylinders"] * values["rigging_ratio"]
        return replace(
            usual,
            force_per_pressure=transmitted * math.pi / 4 * si(values, "cylinder_diameter") ** 2,
            counter_force=transmitted * stated["return_force"],
            efficiency=stated["rigging_efficiency"],
        )
    if "shoe_force" in values:
        force = si(values, "shoe_force") / pressure
        return replace(usual, counter_force=0.0, efficiency=1.0, force_per_pressure=force)
    if "deceleration" in values:
        return braked_with(values["deceleration"] * train_vehicle.moved_mass, pressure)
    if "brake_force" in values:
        force = si(values, "brake_force")
        return _standing_with(force, pressure, friction, usual.shoes) if law else braked_with(force, pressure)
    percentage = values.get("lambda", PERCENTAGE.get(values["kind"]))
    if percentage is None:
        return usual
    if law:
        return _sized_by(percentage, train_vehicle, friction, usual.shoes, beside)
    turning = train_vehicle.mass, train_vehicle.resistance, train_vehicle.rotating_share
    return braked_by(percentage, *turning, pressure, beside)


def friction_of(values: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers of a row's friction for `VehicleBrake`; none: that of the vehicle's kind."""
    name = values.get("friction")
    if name is None:
        return {}
    found = NO_LAW | {"constant_friction": 0.0}
    if name == "speed":
        half = values["friction_speed"] / KILOMETRES_PER_HOUR
        return found | over_speed(values["friction_value"], values["friction_fast"], half)
    if name == "table":
        speeds, frictions = points_in("friction_table", values.get("friction_table", ""))
        return found | over_points([speed / KILOMETRES_PER_HOUR for speed in speeds], frictions)
    found |= dict({**FRICTIONS, **FORCELESS}[name]) | {"constant_friction": values.get("friction_value", 0.0)}
    if name == "pads":
        found["friction_scale"] *= values.get("friction_radius", PAD_RADIUS)
    return found


def _pressed(force: float, pressure: float, friction: Mapping[str, float], shoes: float) -> VehicleBrake:
    """Return a brake whose shoes have a force [N] at a pressure [Pa]."""
    return replace(braked_with(0.3 * force, pressure), shoes=shoes, **({"constant_friction": 0.0} | dict(friction)))


def _standing_with(force: float, pressure: float, friction: Mapping[str, float], shoes: float) -> VehicleBrake:
    """Return a brake with a force at the rims [N] at standstill."""

    def excess(pressed: float) -> float:
        return float(forces_of(_pressed(pressed, pressure, friction, shoes), pressure, 0.0)) - force

    return _pressed(_root(excess, force, 100.0 * force), pressure, friction, shoes)


def _sized_by(
    percentage: float,
    train_vehicle: TrainVehicle,
    friction: Mapping[str, float],
    shoes: float,
    beside: NDArray[np.float64],
) -> VehicleBrake:
    """Return a brake with a brake weight percentage [%] from 100 km/h, S = int m v / (F + R) dv (EN 14531-1).

    beside: further forces of the vehicle at SPEEDS [N].
    """
    turning, pressure = train_vehicle.moved_mass, train_vehicle.distributor.full_pressure
    check_percentage(percentage, turning, train_vehicle.resistance, beside)
    mean = force_of_percentage(percentage, turning, FROM_100)
    way = turning * FROM_100.speed**2 / (2 * mean)

    def excess(pressed: float) -> float:
        own = _pressed(pressed, pressure, friction, shoes)
        force = forces_of(own, np.full(SPEEDS.size, pressure), SPEEDS)
        return way - braking_way(force + beside, turning, train_vehicle.resistance)

    return _pressed(_root(excess, 1e-2 * mean, 200.0 * mean), pressure, friction, shoes)


def _root(excess: Callable[[float], float], low: float, high: float) -> float:
    """Return the shoe force [N] without excess; the force at the rims grows with it in all laws."""
    return float(brentq(excess, low, high, rtol=1e-13))


# -- writing ---------------------------------------------------------------------------------------------------------


def row_of_distributor(train_vehicle: TrainVehicle) -> dict[str, Any]:
    """Return the columns of a distributor: a built-in one by its name and position, or one of UIC with its times."""
    own = train_vehicle.distributor
    if isinstance(own, Piped):
        return {"brake": "none"}
    if isinstance(own, EpDirect):
        fill, release = 0.95 * own.full_pressure / own.filling_rate, (own.full_pressure - RELEASED) / own.release_rate
        times = {"fill_time": fill, "release_time": release}
        return {"brake": "ep-direct", "full_pressure": 1e-5 * own.full_pressure} | times
    kind = kind_of(own)
    named: dict[str, Any] = {} if kind.name == "uic" else {"distributor": kind.name}
    if isinstance(own, VacuumBrake):
        return named | row_of_vacuum(own)
    if isinstance(own, FreightCar):
        return named | (_aar_valve(own) if isinstance(own, AarValve) else {}) | _times_of_car(own)
    ready = {position: kind.ready(position) for position in POSITIONS}
    for position, usual in ready.items():
        if usual == own:
            return named | ({} if ready["P"] == ready["G"] else {"position": position})
    if not isinstance(own, UicDistributor):
        return named | ({"full_pressure": 1e-5 * own.full_pressure} if "full_pressure" in kind.adjustable else {})
    volumes = {"auxiliary": 1e3 * own.auxiliary_volume, "cylinder": 1e3 * own.cylinder_volume}
    times = {"fill_time": filling_time(own, 0.95 * own.full_pressure), "release_time": release_time(own)}
    row = {"full_pressure": 1e-5 * own.full_pressure} | volumes | times
    return named | {name: value for name, value in row.items() if name in kind.adjustable}


def _times_of_car(own: FreightCar) -> dict[str, Any]:
    """Return the times of an AAR or ECP valve that are not those of its kind."""
    plain, row = kind_of(own).ready("P"), {}
    if own.release_choke not in (getattr(plain, "release_choke", 0.0), slow_exhaust()):
        row["release_time"] = release_time_of_car(own)
    if isinstance(own, EcpValve) and own.service_choke != getattr(plain, "service_choke", 0.0):
        row["fill_time"] = fill_time_of_ecp(own)
    return row


def _aar_valve(own: AarValve) -> dict[str, Any]:
    """Return the columns of the retainer, release and empty/load device of a control valve."""
    row: dict[str, Any] = {"accelerated_release": "no"} if own.accelerated_choke == 0.0 else {}
    row |= {"empty_load": own.empty_share} if own.empty_share < 1.0 else {}
    found = [retainer for retainer in RETAINERS[1:] if replace(own, **retaining(retainer)) == own]
    return row | ({"retainer": found[0]} if found else {})


def _friction(vehicle_brake: VehicleBrake) -> dict[str, Any]:
    """Return the columns of a brake's friction."""
    if (
        vehicle_brake.friction_law == FRACTIONS
        and vehicle_brake.friction_force_added == vehicle_brake.friction_force_divisor
    ):
        standing = (
            vehicle_brake.friction_scale * vehicle_brake.friction_speed_added / vehicle_brake.friction_speed_divisor
        )
        half = KILOMETRES_PER_HOUR * vehicle_brake.friction_speed_divisor
        own = {"friction_value": standing, "friction_fast": vehicle_brake.friction_scale, "friction_speed": half}
        return {"friction": "speed"} | own
    if vehicle_brake.friction_law == TABLE:
        speeds, frictions = points_of(vehicle_brake.values())
        return {"friction": "table", "friction_table": text_of([KILOMETRES_PER_HOUR * v for v in speeds], frictions)}
    scaled = vehicle_brake.friction_scale / FRICTIONS["pads"]["friction_scale"]
    for name, law in {**FRICTIONS, **FORCELESS}.items():
        pads = {"friction_scale": law["friction_scale"] * scaled} if name == "pads" else {}
        if replace(vehicle_brake, **(dict(law) | pads)) != vehicle_brake:
            continue
        if name == "pads":
            return {"friction": name, "shoes": vehicle_brake.shoes} | (
                {} if scaled == PAD_RADIUS else {"friction_radius": scaled}
            )
        more = {"shoes": vehicle_brake.shoes} if name in FRICTIONS else {}
        return (
            {"friction": name}
            | more
            | ({"friction_value": vehicle_brake.constant_friction} if name == "constant" else {})
        )
    return {}


def row_of_brake(train_vehicle: TrainVehicle) -> dict[str, Any]:
    """Return the columns of a brake: force of the shoes, or cylinder data if springs draw these back."""
    own, friction = train_vehicle.brake, _friction(train_vehicle.brake)
    if isinstance(train_vehicle.distributor, Piped):
        return {}
    by_cylinder = isinstance(train_vehicle.distributor, AarValve) and train_vehicle.distributor.empty_share < 1.0
    if own.counter_force == 0.0 and not by_cylinder:
        force = own.force_per_pressure * own.efficiency * train_vehicle.distributor.full_pressure
        return {"shoe_force": 1e-3 * force} | friction
    ratios = {d: own.force_per_pressure / (math.pi / 4 * (1e-3 * d) ** 2) for d in DIAMETERS}
    diameter, ratio = next(
        ((d, i) for d, i in ratios.items() if 0.2 <= i <= 40.0), (DIAMETERS[0], ratios[DIAMETERS[0]])
    )
    data = {"cylinder_diameter": diameter, "rigging_ratio": ratio, "rigging_efficiency": own.efficiency}
    return data | {"return_force": own.counter_force / ratio} | friction
