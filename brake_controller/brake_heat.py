"""Heat of friction brakes: the wheels or discs of a vehicle and its blocks or pads, each as one lump that air cools.

A lump has one temperature, the mean of wheel or disc. The surface that is rubbed is warmer by the modes of a slab
(`slab_surface`), if a time of conduction is stated. The share of the heat that goes into each is constant. Heat does
not flow between wheel and block. Rail chill and radiation are parts of the numbers of cooling. Friction follows the
temperature of the surface.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from brake_controller.point_table import PointTable
from brake_controller.slab_surface import RATES, excesses
from brake_controller.vehicle_brake import named
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, choice, quantity

#: Temperature of air, rails and brakes at the start [K].
SURROUNDINGS = 293.15
#: Bodies on which blocks or pads rub.
WHEELS, DISCS = 0, 1
#: State of the heat: temperature of wheels or discs [K], of blocks or pads [K], and heat of the friction brake so far
#: [J]. Modes of the surface of wheels or discs above their temperature [K].
HEATED = ("temperature", "block_temperature", "heat", *(f"excess_{n}" for n in range(1, len(RATES) + 1)))
#: Work of a brake in a step: its force at the rims [N], distance of the rims [m], mean speed of the vehicle [m/s].
WORKED = ("force", "way", "speed", "step")
#: Least time in a denominator [s].
LEAST = 1e-9
#: Share of friction over temperature.
FADE = PointTable("fade_share", "fade_temperature", "fade_change")


@dataclass(frozen=True)
class BrakeHeat(ParameterSet):
    """All braked wheels or discs of one vehicle, alike and equally warm, and their blocks or pads."""

    rubbed: float = choice("What blocks or pads rub on", {WHEELS: "wheels", DISCS: "discs"})
    heat_capacity: float = quantity("J/K", "Heat capacity of wheels or discs that takes part; 0: they stay cold", 0.0)
    heat_share: float = quantity("1", "Share of the heat of friction brakes that goes into wheels or discs", 0.0, 1.0)
    cooling_at_rest: float = quantity("W/K", "Heat that wheels or discs lose for each K, standing", 0.0)
    cooling_over_speed: float = quantity("W.s/(K.m)", "Its growth with each m/s of the vehicle", 0.0)
    conduction_time: float = quantity("s", "Time of conduction through rim or disc, L^2 / a; 0: no surface", 0.0)
    conduction_resistance: float = quantity("K/W", "Thermal resistance of rims or discs, L / (k A)", 0.0)
    block_capacity: float = quantity("J/K", "Heat capacity of blocks or pads; 0: they stay cold", 0.0)
    block_cooling_at_rest: float = quantity("W/K", "Heat that blocks or pads lose for each K, standing", 0.0)
    block_cooling_over_speed: float = quantity("W.s/(K.m)", "Its growth with each m/s of the vehicle", 0.0)
    fade_share: float = quantity("1", "Share of friction up to the first temperature", 0.0)
    fade_temperature_1: float = quantity("K", "Temperature 1 of the share of friction", 0.0)
    fade_temperature_2: float = quantity("K", "Temperature 2 of the share of friction", 0.0)
    fade_temperature_3: float = quantity("K", "Temperature 3 of the share of friction", 0.0)
    fade_temperature_4: float = quantity("K", "Temperature 4 of the share of friction", 0.0)
    fade_temperature_5: float = quantity("K", "Temperature 5 of the share of friction", 0.0)
    fade_temperature_6: float = quantity("K", "Temperature 6 of the share of friction", 0.0)
    fade_change_1: float = quantity("1/K", "Change of its slope at temperature 1")
    fade_change_2: float = quantity("1/K", "Change of its slope at temperature 2")
    fade_change_3: float = quantity("1/K", "Change of its slope at temperature 3")
    fade_change_4: float = quantity("1/K", "Change of its slope at temperature 4")
    fade_change_5: float = quantity("1/K", "Change of its slope at temperature 5")
    fade_change_6: float = quantity("1/K", "Change of its slope at temperature 6")


#: Friction that temperature does not change.
NO_FADE = FADE.numbers((SURROUNDINGS, SURROUNDINGS + 1.0), (1.0, 1.0))
#: Wheels and blocks that stay cold.
NO_BRAKE_HEAT = BrakeHeat(float(WHEELS), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, **NO_FADE)


def lump(before: ca.SX, gained: ca.SX, capacity: ca.SX, cooling: ca.SX) -> ca.SX:
    """Return the temperature of a lump after a step [K]; it stays without a capacity.

    First law: C dT/dt = P - G (T - T0), by the trapezoidal rule. It is stable for all steps, and what the lump takes
    and loses sums to its heat exactly.

    Takes before [K], gained [J], capacity [J/K], cooling [J/K].
    """
    held = ca.if_else(capacity > 0, capacity + cooling / 2, 1)
    return before + ca.if_else(capacity > 0, (gained - cooling * (before - SURROUNDINGS)) / held, 0)


def heating() -> ca.Function:
    """Return the function for HEATED at the end of a step.

    First law of two lumps (`lump`). Wheels or discs take a share of the heat, blocks or pads the rest. Cooling grows
    linearly with speed, assumed as for discs. Arguments: HEATED before the step, WORKED, and the parameters.
    """
    state, worked = ca.SX.sym("state", len(HEATED)), ca.SX.sym("worked", len(WORKED))
    given = ca.SX.sym("given", len(named(BrakeHeat)))
    p = dict(zip(named(BrakeHeat), ca.vertsplit(given), strict=True))
    temperature, block, heat, *modes = ca.vertsplit(state)
    force, way, speed, step = ca.vertsplit(worked)
    made = force * ca.fabs(way)
    cooling = step * _cooling(p, "", speed)
    warm = lump(temperature, p["heat_share"] * made, p["heat_capacity"], cooling)
    block_cooling = step * _cooling(p, "block_", speed)
    block = lump(block, (1 - p["heat_share"]) * made, p["block_capacity"], block_cooling)
    steady = p["conduction_resistance"] * p["heat_share"] * made / ca.fmax(step, LEAST)
    time = p["conduction_time"]
    fourier = ca.if_else(time > 0, step / ca.fmax(time, LEAST), 0)
    above = excesses(ca.vertcat(*modes), steady, fourier)
    return function_of("heating", [state, worked, given], ca.vertcat(warm, block, heat + made, above))


def surfacing() -> ca.Function:
    """Return the function for the temperature of the surface [K]: the sum of mean and modes, by HEATED.

    Carslaw and Jaeger (1959), as in `slab_surface`.
    """
    state = ca.SX.sym("state", len(HEATED))
    return function_of("surfacing", [state], _surface(state))


def _surface(state: ca.SX) -> ca.SX:
    temperature, _, _, *modes = ca.vertsplit(state)
    return temperature + ca.sum1(ca.vertcat(*modes))


def _cooling(p: Mapping[str, ca.SX], of: str, speed: ca.SX) -> ca.SX:
    return p[f"{of}cooling_at_rest"] + p[f"{of}cooling_over_speed"] * ca.fabs(speed)


def fading() -> ca.Function:
    """Return the function for the share of friction at the surface's temperature, by the points of FADE.

    Regressions of Sawczuk (2021) for discs are straight lines. No public curve of blocks was found, so by default
    friction does not change. Arguments: HEATED, and the parameters.
    """
    state, given = ca.SX.sym("state", len(HEATED)), ca.SX.sym("given", len(named(BrakeHeat)))
    p = dict(zip(named(BrakeHeat), ca.vertsplit(given), strict=True))
    return function_of("fading", [state, given], FADE.at(p, _surface(state)))
