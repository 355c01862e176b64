"""The heat of a vehicle's brake in the columns of a consist, both ways."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from brake_controller.brake_heat import DISCS, FADE, NO_BRAKE_HEAT, NO_FADE, WHEELS, BrakeHeat
from brake_controller.discs import axle_discs
from brake_controller.vehicle_brake import VehicleBrake, law_named
from products.train.brake_columns import PAD_RADIUS
from products.train.cell_tables import points_in, text_of
from products.train.consist_columns import HEAT, si

#: Temperature of 0 degC [K].
ZERO = 273.15
#: Specific heat capacity of wheels [J/(kg.K)], steel.
STEEL = 500.0
#: Share of the heat in wheels with blocks of cast iron, which take 20 to 30 % of it, and with other blocks. Assumed.
SHARE_CAST_IRON, SHARE = 0.75, 0.9
#: Specific heat capacity of blocks of cast iron, and of other blocks and pads [J/(kg.K)]. Assumed.
BLOCK_CAST_IRON, BLOCK = 510.0, 1000.0
#: Cooling of the blocks at one wheel at rest [W/K], and its growth with speed [W.s/(K.m)]: some 0.1 m2 of surface at 20
#: W/(m2.K), and 3 more for each m/s. Assumed.
BLOCK_COOLING, BLOCK_COOLING_SPEED = 2.0, 0.3
#: Laws of friction of blocks on treads.
OF_BLOCKS = ("cast-iron-p6", "cast-iron-p10", "composite", "composite-k")
#: Relative excess of a thickness that is rounding.
ROUNDING = 1e-9


@dataclass(frozen=True)
class HeatedBody:
    """A body that blocks or pads rub on: columns of its mass and number, and values if these are not stated.

    capacity: specific heat capacity [J/(kg.K)]; conductivity [W/(m.K)]; density [kg/m3]. cooling: of one, at rest
    [W/K]; cooling_speed: its growth with the speed of the vehicle [W.s/(K.m)]. area: that is rubbed on one [m2].
    """

    mass: str
    number: str
    capacity: float
    conductivity: float
    density: float
    cooling: float
    cooling_speed: float
    area: float


def _bodies() -> dict[int, HeatedBody]:
    """Return wheels of steel and discs of cast iron, all assumed except for materials.

    The cooling of a wheel at 70 km/h is 59 W/K, between 48 and 80 that fit reported time constants. A disc is one of
    two on a wheelset, whose fan moves air in proportion to its speed. Areas are those of a tread of 80 mm on a wheel of
    920 mm, and of both faces of a disc from 350 to 640 mm.
    """
    two = axle_discs()
    fan = two.disc_cooling_over_speed * PAD_RADIUS
    return {
        WHEELS: HeatedBody("wheel_mass", "wheels", STEEL, 45.0, 7850.0, 20.0, 2.0, 0.231),
        DISCS: HeatedBody(
            "disc_mass", "discs", two.disc_heat_capacity, 50.0, 7200.0, two.disc_cooling_at_rest / 2, fan / 2, 0.451
        ),
    }


BODIES = _bodies()
#: Number of wheels or discs of a vehicle if it is not stated. Assumed.
NUMBER = 8.0


def heat_of(values: Mapping[str, Any], brake: VehicleBrake) -> BrakeHeat:
    """Return the heat of a brake by a row; without masses it stays cold. Raises ValueError."""
    rubbed = next((number for number, one in BODIES.items() if one.mass in values), None)
    if rubbed is None:
        return NO_BRAKE_HEAT
    body, law = BODIES[rubbed], law_named(brake)
    if rubbed == DISCS and law in OF_BLOCKS:
        raise ValueError(f"disc_mass must be of pads; the friction is {law}, of blocks. Set friction, or wheel_mass.")
    if rubbed == WHEELS and law == "pads":
        raise ValueError("wheel_mass must be of blocks; the friction is that of pads. State disc_mass instead.")
    iron, number = law.startswith("cast-iron"), values.get(body.number, NUMBER)
    usual = axle_discs().disc_heat_share if rubbed == DISCS else SHARE_CAST_IRON if iron else SHARE
    block = BLOCK_CAST_IRON if iron else BLOCK
    blocks = number if "block_mass" in values else 0.0
    fade: Mapping[str, float] = NO_FADE
    if "fade_table" in values:
        places, shares = points_in("fade_table", values["fade_table"])
        fade = FADE.numbers([place + ZERO for place in places], shares)
    return BrakeHeat(
        rubbed=float(rubbed),
        heat_capacity=number * values[body.mass] * body.capacity,
        heat_share=values.get("heat_share", usual),
        cooling_at_rest=number * values.get("cooling", body.cooling),
        cooling_over_speed=number * values.get("cooling_speed", body.cooling_speed),
        **_conduction(values, body, number),
        block_capacity=blocks * values.get("block_mass", 0.0) * values.get("block_heat", block),
        block_cooling_at_rest=blocks * values.get("block_cooling", BLOCK_COOLING),
        block_cooling_over_speed=blocks * values.get("block_cooling_speed", BLOCK_COOLING_SPEED),
        **fade,
    )


def _conduction(values: Mapping[str, Any], body: HeatedBody, number: float) -> dict[str, float]:
    """Return time and resistance of conduction through rims or discs: L^2 / a and L / (k A). Raises ValueError."""
    if "thickness" not in values:
        return {"conduction_time": 0.0, "conduction_resistance": 0.0}
    thickness, area = si(values, "thickness"), values.get("rubbed_area", body.area)
    most = 1e3 * values[body.mass] / (body.density * area)
    if 1e3 * thickness > most * (1 + ROUNDING):
        raise ValueError(
            f"thickness must be at most {most:.4g} mm, at which {area:g} m2 weigh {body.mass}; got {1e3 * thickness:g} "
            f"mm. Decrease it or rubbed_area, or increase {body.mass}."
        )
    return {
        "conduction_time": thickness**2 * body.density * body.capacity / body.conductivity,
        "conduction_resistance": thickness / (body.conductivity * area * number),
    }


def row_of_heat(brake_heat: BrakeHeat) -> dict[str, Any]:
    """Return the columns of a brake's heat: eight wheels or discs alike, or as many more as the limits of one need."""
    if not brake_heat.heat_capacity:
        return {}
    row: dict[str, Any] = {}
    for number in (8, 16, 32, 64, 96):
        row = _row_of(brake_heat, number)
        if all(row[name] <= HEAT[name].most for name in row):
            break
    if any(brake_heat.values()[name] != value for name, value in NO_FADE.items()):
        places, shares = FADE.points(brake_heat.values())
        row["fade_table"] = text_of([place - ZERO for place in places], shares)
    return row


def _row_of(brake_heat: BrakeHeat, number: int) -> dict[str, Any]:
    """Return the columns without the table, for a number of wheels or discs."""
    body = BODIES[int(brake_heat.rubbed)]
    row: dict[str, Any] = {body.mass: brake_heat.heat_capacity / body.capacity / number, body.number: number}
    row |= {"heat_share": brake_heat.heat_share}
    if brake_heat.conduction_time:
        thickness = (brake_heat.conduction_time * body.conductivity / (body.density * body.capacity)) ** 0.5
        row["thickness"] = 1e3 * thickness
        row["rubbed_area"] = thickness / (body.conductivity * brake_heat.conduction_resistance * number)
    row |= {"cooling": brake_heat.cooling_at_rest / number, "cooling_speed": brake_heat.cooling_over_speed / number}
    if brake_heat.block_capacity:
        row |= {"block_mass": brake_heat.block_capacity / BLOCK / number, "block_heat": BLOCK}
        row |= {"block_cooling": brake_heat.block_cooling_at_rest / number}
        row["block_cooling_speed"] = brake_heat.block_cooling_over_speed / number
    return row
