"""Wheel-slide protection of a vehicle in the columns of a consist, both ways."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from brake_controller.distributors import kind_of
from brake_controller.distributors.aar import FreightCar, balance
from brake_controller.distributors.distributor import DistributorParameters
from brake_controller.distributors.ep_direct import PACE_BY_TIME, RELEASED, VENTS, EpDirect
from brake_controller.distributors.uic import UicDistributor, emptied, freight
from brake_controller.distributors.vacuum import VacuumBrake
from brake_controller.vehicle_protection import BUILT_IN, FIRST_OWN, NO_PROTECTION, VOLUME, VehicleProtection
from products.controller_kinds import PUBLIC
from products.train.consist_columns import si
from readers.text import shown

#: Words of the column `protection`; any other text is a file.
NOTHING, OURS = "none", "built-in"


def check_controller(name: str) -> None:
    """Raise ValueError if a text is neither a word for a controller nor the name of a file."""
    if "." not in name and name not in (NOTHING, OURS, *PUBLIC):
        known = f"{', '.join((NOTHING, OURS, *PUBLIC))} or the file of a controller, such as mine.c"
        raise ValueError(f"protection must be one of {known}; got {shown(name)}. Correct it.")


def protection_of(values: Mapping[str, Any], parameters: DistributorParameters) -> VehicleProtection:
    """Return the protection of a row; parameters: its distributor."""
    name = values.get("protection", NOTHING)
    if name == NOTHING:
        return NO_PROTECTION
    check_controller(name)
    usual = NO_PROTECTION
    return VehicleProtection(
        controller=float(BUILT_IN if name == OURS else FIRST_OWN),
        wheel_radius=si(values, "wheel_diameter", 2.0 * usual.wheel_radius) / 2.0,
        teeth=values.get("encoder_teeth", usual.teeth),
        period=si(values, "sample_time", usual.period),
        valve_time=si(values, "valve_time", usual.valve_time),
        cylinders=counted_volume(parameters),
        wheelsets=usual.wheelsets,
    )


def counted_volume(parameters: DistributorParameters) -> float:
    """Return the volume of the cylinders whose air is counted [m3]: 0 of vacuum brakes, which press by less air."""
    return 0.0 if isinstance(parameters, VacuumBrake) else getattr(parameters, "cylinder_volume", VOLUME)


def vented_of(values: Mapping[str, Any], one: DistributorParameters) -> DistributorParameters:
    """Return a distributor whose dump valve empties a full cylinder to 0.4 bar in the time of a row, isothermal."""
    if "vent_time" not in values:
        return one
    time = si(values, "vent_time")
    if isinstance(one, EpDirect):
        rate = (one.full_pressure - RELEASED) / time
        return replace(one, vent_rate=rate, settling=max(one.settling, PACE_BY_TIME / time))
    if not isinstance(one, UicDistributor | FreightCar):
        name = kind_of(one).name
        words = f"vent_time must be of a built-in brake by compressed air; got distributor = {name}."
        raise ValueError(f"{words} Remove it.")
    return replace(one, vent_choke=(emptied(one.cylinder_volume, _full(one)) / time) ** 0.5)


def _full(one: UicDistributor | FreightCar) -> float:
    return balance(one) if isinstance(one, FreightCar) else one.full_pressure


def row_of_protection(protection: VehicleProtection, controller: str, one: DistributorParameters) -> dict[str, Any]:
    """Return the columns of a protection and of the dump valve of a distributor."""
    row: dict[str, Any] = {}
    if isinstance(one, EpDirect) and one.vent_rate != VENTS:
        row["vent_time"] = (one.full_pressure - RELEASED) / one.vent_rate
    elif isinstance(one, UicDistributor | FreightCar) and one.vent_choke != freight().vent_choke:
        row["vent_time"] = emptied(one.cylinder_volume, _full(one)) / one.vent_choke**2
    if not protection.controller:
        return row
    return row | {
        "protection": controller,
        "wheel_diameter": 2e3 * protection.wheel_radius,
        "encoder_teeth": protection.teeth,
        "sample_time": 1e3 * protection.period,
        "valve_time": protection.valve_time,
    }
