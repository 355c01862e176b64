"""The heat of a vehicle's wheels as a row of a consist states it, and the row that states it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.wheel_heat import NO_WHEEL_HEAT, STEEL, SURROUNDINGS, WheelHeat
from products.train.columns import HEAT

#: Temperature of 0 degC [K].
ZERO = 273.15
#: Where a row does not state them: braked wheels of a vehicle [1], cooling of a wheel at rest [W/K] and its growth with
#: speed [W.s/(K.m)]. Assumed; at 70 km/h the cooling is 59 W/K, between 48 and 80 that fit reported time constants.
WHEELS, COOLING, COOLING_SPEED = 8.0, 20.0, 2.0
#: Share of the heat in wheels with blocks of cast iron, which take 20 to 30 % of it, and with other blocks. Assumed.
SHARE_CAST_IRON, SHARE = 0.75, 0.9
_FADE = ("fade_from", "fade_to", "fade_left")


def check_heat(values: Mapping[str, Any]) -> None:
    """Check that a row states the heat of its wheels completely. Raises ValueError."""
    for name in HEAT:
        if name in values and "wheel_mass" not in values:
            raise ValueError(f"{name} must come with wheel_mass. Add it, or leave {name} out.")
    stated = [name for name in _FADE if name in values]
    missing = [name for name in _FADE if name not in values]
    if stated and missing:
        raise ValueError(f"{stated[0]} must come with {missing[0]}. Add it, or leave {stated[0]} out.")
    if stated and values["fade_to"] <= values["fade_from"]:
        raise ValueError(
            f"fade_to must be above fade_from, {values['fade_from']:g} degC; got {values['fade_to']:g} degC. Raise it."
        )


def heat_of(values: Mapping[str, Any]) -> WheelHeat:
    """Return the wheels of a row that `check_heat` has checked; without wheel_mass they stay cold."""
    if "wheel_mass" not in values:
        return NO_WHEEL_HEAT
    wheels = values.get("wheels", WHEELS)
    share = SHARE_CAST_IRON if str(values.get("friction", "")).startswith("cast-iron") else SHARE
    return WheelHeat(
        heat_capacity=wheels * values["wheel_mass"] * STEEL,
        heat_share=values.get("heat_share", share),
        cooling_at_rest=wheels * values.get("cooling", COOLING),
        cooling_over_speed=wheels * values.get("cooling_speed", COOLING_SPEED),
        fade_from=values["fade_from"] + ZERO if "fade_from" in values else SURROUNDINGS,
        fade_to=values["fade_to"] + ZERO if "fade_to" in values else SURROUNDINGS,
        fade_left=values.get("fade_left", 1.0),
    )


def row_of_heat(one: WheelHeat) -> dict[str, Any]:
    """Return the columns of wheels: eight alike, or as many more as the limits of one need."""
    if not one.heat_capacity:
        return {}
    row: dict[str, Any] = {}
    for wheels in (8, 16, 32, 64, 96):
        row = {"wheel_mass": one.heat_capacity / STEEL / wheels, "wheels": wheels, "heat_share": one.heat_share}
        row |= {"cooling": one.cooling_at_rest / wheels, "cooling_speed": one.cooling_over_speed / wheels}
        if all(row[name] <= HEAT[name][2] for name in row):
            break
    if one.fade_left < 1.0:
        row |= {"fade_from": one.fade_from - ZERO, "fade_to": one.fade_to - ZERO, "fade_left": one.fade_left}
    return row
