"""The brake of a vehicle as a row of a consist states it: each combination has an effect, or is refused."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from brake_controller.air import AMBIENT
from brake_controller.brake_weight import FROM_100, SPEEDS, braking_way, check_percentage, force_of_percentage
from brake_controller.distributors import distributors, ep_direct
from brake_controller.distributors.aar import OF_AAR, AarValve, FreightCar, retaining, with_release_time
from brake_controller.distributors.distributor import DistributorParameters
from brake_controller.distributors.ecp import EcpValve, with_fill_time
from brake_controller.distributors.ep_direct import FILLING, RELEASE
from brake_controller.distributors.piped import Piped
from brake_controller.distributors.registered import ADJUSTED
from brake_controller.distributors.uic import OF_UIC, UIC, UicDistributor, filling_time, release_time, with_times
from brake_controller.point_table import MOST_POINTS
from brake_controller.shoe_friction import CONSTANT, KILOMETRES_PER_HOUR
from brake_controller.vehicle_brake import (
    FORCELESS,
    FRICTIONS,
    NO_LAW,
    VehicleBrake,
    braking,
    over_points,
    over_speed,
)
from products.train.columns import FORCE, HEAT
from products.train.consist import (
    EMPTY,
    EMPTY_UP_TO,
    PERCENTAGE,
    TrainVehicle,
    braked_by,
    braked_with,
    forces_of,
)
from products.train.stated_drive import table_in

#: Statements of a brake's force: the column that begins each, and those that belong to it alone.
STATEMENTS: dict[str, tuple[str, ...]] = {
    "lambda": (),
    "deceleration": (),
    "brake_force": (),
    "shoe_force": (),
    "cylinder_diameter": ("cylinders", "rigging_ratio", "rigging_efficiency", "return_force"),
}
#: Statements of the force at the rims, in which friction is included already.
AT_RIMS = ("lambda", "deceleration", "brake_force")
#: Cylinder data that are not stated: those of the wagon [1], [1], [N].
CYLINDER = {"cylinders": 1.0, "rigging_efficiency": 0.83, "return_force": 1500.0}
#: Friction radius of pads over the wheel's radius. Assumed.
PAD_RADIUS = 0.6
#: Columns without effect by kind of brake.
_BY_PIPE, _TIMES = (
    ("distributor", "position", "auxiliary", "cylinder", *OF_AAR),
    ("full_pressure", "fill_time", "release_time"),
)
WITHOUT_EFFECT = {
    "pneumatic": (),
    "ep-direct": _BY_PIPE,
    "none": ("dead_time", *_BY_PIPE, *_TIMES, *FORCE, *HEAT, "fade_table", "friction", "weighing"),
}

_BRAKING = braking()


def check_force(values: Mapping[str, Any]) -> None:
    """Check that a row states a brake's force once, and nothing that has no effect with it. Raises ValueError."""
    stated = [name for name in STATEMENTS if name in values]
    if len(stated) > 1:
        raise ValueError(f"a brake must be stated once; got {' and '.join(stated)}. Leave all but one out.")
    for first, others in STATEMENTS.items():
        for name in others:
            if name in values and first not in values:
                raise ValueError(f"{name} must come with {first}. Add {first}, or leave {name} out.")
    if "cylinder_diameter" in values and "rigging_ratio" not in values:
        raise ValueError("cylinder_diameter must come with rigging_ratio. Add it.")
    if stated and "weighing" in values:
        raise ValueError(f"weighing must be left out with {stated[0]}, which is that of the load. Leave it out.")
    _check_friction(values, stated)
    if "empty_load" in values:
        _check_empty(values, [name for name in stated if name != "cylinder_diameter"])


def _check_empty(values: Mapping[str, Any], forces: list[str]) -> None:
    """Check that the force of a row with an empty/load device follows from its cylinder. Raises ValueError."""
    if "weighing" in values:
        raise ValueError("weighing must be left out with empty_load, which is in its place. Leave one of them out.")
    if not forces and values["kind"] in PERCENTAGE and "cylinder_diameter" not in values:
        forces = [f"the lambda of a {values['kind']}"]
    if forces:
        raise ValueError(
            f"empty_load must be left out with {forces[0]}, the force of this load. Leave it out, or state the brake "
            "by cylinder_diameter."
        )
    mass = values.get("mass", 1e-3 * EMPTY[values["kind"]] + values.get("load", math.nan))
    if not mass <= 1e-3 * EMPTY_UP_TO:
        got = "none" if math.isnan(mass) else f"{mass:g} t"
        raise ValueError(
            f"empty_load must come with the load or mass of an empty car, at most {1e-3 * EMPTY_UP_TO:g} t in all; got "
            f"{got}. Set load to 0, or leave empty_load out: a loaded car has its whole force."
        )


def _check_friction(values: Mapping[str, Any], stated: list[str]) -> None:
    friction, at_rims = values.get("friction"), [name for name in AT_RIMS if name in values]
    if not stated and values["kind"] in PERCENTAGE:
        at_rims = [f"the lambda of a {values['kind']}"]
    if "deceleration" in values and friction not in (None, "constant"):
        raise ValueError(f"friction must be constant with deceleration; got {friction}. State brake_force instead.")
    if "friction_value" in values and friction not in ("constant", "speed"):
        raise ValueError(
            "friction_value must come with friction = constant or speed. Add it, or leave friction_value out."
        )
    for name in ("friction_fast", "friction_speed"):
        if name in values and friction != "speed":
            raise ValueError(f"{name} must come with friction = speed. Add it, or leave {name} out.")
        if name not in values and friction == "speed":
            raise ValueError(f"friction = speed must come with {name}. Add it.")
    if "friction_table" in values and friction != "table":
        raise ValueError("friction_table must come with friction = table. Add it, or leave friction_table out.")
    if friction == "table":
        _points(values)
    if "friction_value" in values and friction == "constant" and at_rims:
        raise ValueError(f"friction_value must be left out with {at_rims[0]}, a force at the rims. Leave it out.")
    if "friction_radius" in values and friction != "pads":
        raise ValueError("friction_radius must come with friction = pads. Add it, or leave friction_radius out.")
    own = friction is None and values["kind"] == "wagon" and not at_rims  # the wagon's depends on that force
    if "shoes" in values and friction not in FRICTIONS and not own:
        raise ValueError(
            f"shoes must come with a friction that depends on the force of a shoe, one of {', '.join(FRICTIONS)}. Add "
            "friction, or leave shoes out."
        )
    needs = values["kind"] != "wagon" and ("shoe_force" in values or "cylinder_diameter" in values)
    if needs and friction is None:
        raise ValueError(f"friction must come with {stated[0]} of a {values['kind']}. Add friction.")
    if (friction == "speed" or (friction == "constant" and not at_rims)) and "friction_value" not in values:
        raise ValueError(f"friction = {friction} must come with friction_value. Add it.")


def check_control(values: Mapping[str, Any]) -> None:
    """Check that a row has nothing without effect on its kind of brake. Raises ValueError."""
    brake = values.get("brake", "pneumatic")
    for name in WITHOUT_EFFECT[brake]:
        if name in values:
            raise ValueError(f"{name} has no effect with brake = {brake}. Leave it out.")
    if brake == "pneumatic":
        _check_columns(values)


def _check_columns(values: Mapping[str, Any]) -> None:
    """Check that a row has only columns with an effect on its distributor. Raises ValueError."""
    kinds = distributors()
    kind = kinds[values.get("distributor", UIC.name)]
    for name in ADJUSTED:
        if name in values and name not in kind.adjustable:
            *first, last = [one.name for one in kinds.values() if name in one.adjustable]
            takers = f"{', '.join(first)} or {last}" if first else last
            raise ValueError(f"{name} must be of the distributor {takers}; got {kind.name}. Leave {name} out.")
    idle = {
        "dead_time": not (kind.wired or kind.assisted),
        "position": "position" in values and kind.ready("P") == kind.ready("G"),
    }
    for name in (one for one in idle if idle[one] and one in values):
        raise ValueError(f"{name} has no effect with distributor = {kind.name}. Leave it out.")
    if {"position", "fill_time", "release_time"} <= set(values):
        raise ValueError("position has no effect with fill_time and release_time. Leave one of them out.")


def distributor_of(values: Mapping[str, Any], one: DistributorParameters) -> DistributorParameters:
    """Return a vehicle's distributor with the pressure, times and volumes of a row."""
    if values.get("brake") == "none":
        return Piped(full_pressure=0.0)
    if values.get("brake") == "ep-direct":
        pressure = 1e5 * values["full_pressure"] if "full_pressure" in values else one.full_pressure
        times = values.get("fill_time", FILLING), values.get("release_time", RELEASE)
        return ep_direct.with_times(pressure, *times)
    if isinstance(one, FreightCar):
        one = _car_with_times(values, one)
    if isinstance(one, AarValve):
        return _aar_valve_of(values, one)
    usual = one
    if "full_pressure" in values:
        one = replace(one, full_pressure=1e5 * values["full_pressure"])
    if not isinstance(one, UicDistributor) or not {"full_pressure", *OF_UIC} & set(values):
        return one
    volumes = {"auxiliary": "auxiliary_volume", "cylinder": "cylinder_volume"}
    one = replace(one, **{of: 1e-3 * values[name] for name, of in volumes.items() if name in values})
    assert isinstance(usual, UicDistributor)
    filling, release = filling_time(usual, 0.95 * usual.full_pressure), release_time(usual)
    return with_times(one, values.get("fill_time", filling), values.get("release_time", release))


def _car_with_times(values: Mapping[str, Any], one: FreightCar) -> FreightCar:
    """Return an AAR or ECP valve with the times of a row. Raises ValueError for two times of one release."""
    if "release_time" in values and values.get("retainer") == "slow-direct":
        raise ValueError("release_time has no effect with retainer = slow-direct. Leave one of them out.")
    if "release_time" in values:
        one = with_release_time(one, values["release_time"])
    if "fill_time" in values and isinstance(one, EcpValve):
        one = with_fill_time(one, values["fill_time"])
    return one


def _aar_valve_of(values: Mapping[str, Any], one: AarValve) -> AarValve:
    """Return a control valve with the retainer, release and empty/load device of a row."""
    share = values.get("empty_load", 1.0)
    one = replace(one, empty_share=share, full_pressure=share * one.full_pressure)
    if values.get("accelerated_release") == "no":
        one = replace(one, accelerated_choke=0.0)
    return replace(one, **retaining(values["retainer"])) if "retainer" in values else one


def brake_of(values: Mapping[str, Any], one: TrainVehicle) -> VehicleBrake:
    """Return a vehicle's brake by a row."""
    pressure, friction = one.distributor.full_pressure, friction_of(values)
    shoes = values.get("shoes", one.brake.shoes)
    if "cylinder_diameter" in values:
        return _by_cylinder(values, replace(one.brake, shoes=shoes, **friction))
    if "shoe_force" in values:
        plain = replace(one.brake, counter_force=0.0, efficiency=1.0, shoes=shoes, **friction)
        return replace(plain, force_per_pressure=1e3 * values["shoe_force"] / pressure)
    if "deceleration" in values:
        return braked_with(values["deceleration"] * (1 + one.rotating_share) * one.mass, pressure)
    law = bool(friction) and friction["friction_law"] != CONSTANT
    if "brake_force" in values:
        force = 1e3 * values["brake_force"]
        return _standing_with(force, pressure, friction, shoes) if law else braked_with(force, pressure)
    percentage = values.get("lambda", PERCENTAGE.get(values["kind"]))
    if percentage is None:
        return replace(one.brake, shoes=shoes, **friction)
    if law:
        return _sized_by(percentage, one, friction, shoes)
    return braked_by(percentage, one.mass, one.resistance, one.rotating_share, pressure)


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
        return found | over_points(*_points(values))
    found |= dict({**FRICTIONS, **FORCELESS}[name]) | {"constant_friction": values.get("friction_value", 0.0)}
    if name == "pads":
        found["friction_scale"] *= values.get("friction_radius", PAD_RADIUS)
    return found


def _points(values: Mapping[str, Any]) -> tuple[list[float], list[float]]:
    """Return the speeds [m/s] and frictions of a row's `friction_table`. Raises ValueError."""
    speeds, frictions = table_in(values.get("friction_table", ""), MOST_POINTS, 0.001, 1.0)
    if not speeds:
        raise ValueError(
            f"friction_table must be 2 to {MOST_POINTS} pairs of a speed that rises by 0.001 km/h or more, up to 1000 "
            f"km/h, and a friction from 0.001 to 1; got {values.get('friction_table', '')!r}. Write it as 0:0.30 "
            "40:0.22 120:0.15."
        )
    return speeds, frictions


def _by_cylinder(values: Mapping[str, Any], one: VehicleBrake) -> VehicleBrake:
    """Return a brake by its cylinders and rigging, eqs (2.4) to (2.6)."""
    given = CYLINDER | {name: values[name] for name in CYLINDER if name in values}
    transmitted = given["cylinders"] * values["rigging_ratio"]
    return replace(
        one,
        force_per_pressure=transmitted * math.pi / 4 * (1e-3 * values["cylinder_diameter"]) ** 2,
        counter_force=transmitted * given["return_force"],
        efficiency=given["rigging_efficiency"],
    )


def _pressed(force: float, pressure: float, friction: Mapping[str, float], shoes: float) -> VehicleBrake:
    """Return a brake whose shoes have a force [N] at a pressure [Pa]."""
    return replace(braked_with(0.3 * force, pressure), shoes=shoes, **({"constant_friction": 0.0} | dict(friction)))


def _force_at(one: VehicleBrake, pressure: float, speed: float) -> float:
    return float(_BRAKING(pressure + AMBIENT, speed, list(one.values().values())))


def _standing_with(force: float, pressure: float, friction: Mapping[str, float], shoes: float) -> VehicleBrake:
    """Return a brake with a force at the rims [N] at standstill."""

    def excess(pressed: float) -> float:
        return _force_at(_pressed(pressed, pressure, friction, shoes), pressure, 0.0) - force

    return _pressed(_root(excess, force, 100.0 * force), pressure, friction, shoes)


def _sized_by(percentage: float, one: TrainVehicle, friction: Mapping[str, float], shoes: float) -> VehicleBrake:
    """Return a brake with a brake weight percentage [%] from 100 km/h, S = int m v / (F + R) dv (EN 14531-1)."""
    turning, pressure = (1 + one.rotating_share) * one.mass, one.distributor.full_pressure
    check_percentage(percentage, turning, one.resistance)
    mean = force_of_percentage(percentage, turning, FROM_100)
    way = turning * FROM_100.speed**2 / (2 * mean)

    def excess(pressed: float) -> float:
        own = _pressed(pressed, pressure, friction, shoes)
        force = forces_of(own, np.full(SPEEDS.size, pressure), SPEEDS)
        return way - braking_way(force, turning, one.resistance)

    return _pressed(_root(excess, 1e-2 * mean, 200.0 * mean), pressure, friction, shoes)


def _root(excess: Callable[[float], float], low: float, high: float) -> float:
    """Return the shoe force [N] without excess; the force at the rims grows with it in all laws."""
    return float(brentq(excess, low, high, rtol=1e-13))
