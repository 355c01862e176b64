"""Wheel-slide controllers of a train's vehicles, of its consist and of the user's call."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from bogie_braking.checks import shown
from bogie_braking.controllers.controller_loader import KINDS, controller_of, form_of
from bogie_braking.protection import maker_of
from bogie_braking.provenance import absent, encoded
from brake_controller.distributors.piped import Piped
from brake_controller.vehicle_protection import BUILT_IN, FIRST_OWN, NO_PROTECTION
from products.controller_kinds import Form
from products.protection.own_process import Apart, NoControllerError
from products.train.consist import Consist, TrainVehicle
from products.train.slide_columns import NOTHING, OURS, check_controller, counted_volume

#: A controller: its name or file, or a class or another function that returns a new one.
Controller = str | Path | Callable[[], Any] | None
#: Accepted forms, for messages.
FORMS = "a class, 'built-in', a file (.c, a library, .fmu, FILE.py:CLASS) or None"


def with_controllers(consist: Consist, given: Any) -> tuple[Consist, dict[int, Form]]:
    """Return a consist with the controllers of a call, and the loaded ones of users by their vehicle, from 0.

    Raises TypeError, ValueError.
    """
    vehicles = list(consist.vehicles)
    asked = _by_vehicle(given, vehicles)
    made: dict[Any, Form] = {}
    for vehicle, controller in asked.items():
        vehicles[vehicle] = _protected(vehicles[vehicle], controller, vehicle)
    forms: dict[int, Form] = {}
    for vehicle, one in enumerate(vehicles):
        if one.protection.controller >= FIRST_OWN:
            controller = asked.get(vehicle, one.controller)
            key = controller, one.sensors, one.protection.period
            if key not in made:
                made[key] = _loaded(*key)
            forms[vehicle] = made[key]
    return replace(consist, vehicles=tuple(vehicles)), forms


def encoded_controllers(given: Any) -> Any:
    """Return controllers of a call as JSON, those of several vehicles as pairs of a vehicle and its controller."""
    if not isinstance(given, Mapping):
        is_file = isinstance(given, str) and Path(given).suffix in KINDS
        return encoded(Path(given) if is_file else given)
    if any(callable(one) for one in given.values()):
        return absent("controllers in Python")
    return [[encoded(vehicle), encoded_controllers(one)] for vehicle, one in given.items()]


def _by_vehicle(given: Any, vehicles: list[TrainVehicle]) -> dict[int, Any]:
    if given is None:
        return {}
    if isinstance(given, list):  # pairs, as `encoded_controllers` writes them
        given = dict(given)
    if not isinstance(given, Mapping):
        return {place: given for place, one in enumerate(vehicles) if not isinstance(one.distributor, Piped)}
    for place in given:
        if not isinstance(place, int) or isinstance(place, bool) or not 0 <= place < len(vehicles):
            raise ValueError(
                f"The vehicle of a protection must be an integer from 0 to {len(vehicles) - 1}; got {shown(place)}. "
                "Number the vehicles as train.inputs does."
            )
    return dict(given)


def _protected(train_vehicle: TrainVehicle, controller: Any, place: int) -> TrainVehicle:
    """Return a vehicle with a controller. Raises ValueError without brake or rotating mass, TypeError."""
    if isinstance(controller, str):
        check_controller(controller)
    if controller is None or controller == NOTHING:
        return replace(train_vehicle, protection=replace(train_vehicle.protection, controller=0.0), controller=NOTHING)
    if isinstance(train_vehicle.distributor, Piped):
        raise ValueError(f"The vehicle of a protection must have a brake; vehicle {place} has none. Leave it out.")
    if train_vehicle.rotating_share == 0.0:
        raise ValueError(
            f"rotating must be above 0 % on a vehicle with a protection; got 0 of vehicle {place}. Raise it."
        )
    if not isinstance(controller, str | Path):
        maker_of(controller)
    usual = train_vehicle.protection
    if not usual.controller:
        usual = replace(NO_PROTECTION, cylinders=counted_volume(train_vehicle.distributor))
    name = str(controller) if isinstance(controller, str | Path) else getattr(controller, "__name__", "own")
    return replace(
        train_vehicle,
        protection=replace(usual, controller=float(BUILT_IN if name == OURS else FIRST_OWN)),
        controller=name,
    )


def _loaded(controller: Any, sensors: int, period: float) -> Form:
    """Return the form of a controller. Raises ValueError."""
    if not isinstance(controller, str | Path):
        return form_of(controller)
    name, found = controller_of(str(controller), sensors)
    if not isinstance(found, Apart):
        return found
    try:
        return found.made(sensors, period)
    except NoControllerError as error:
        raise ValueError(f"The controller {name} cannot be used: {error}. Correct {controller}.") from None
