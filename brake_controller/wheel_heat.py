"""Heat of braked wheels: one lump for each vehicle, cooled by the air, and friction that fades when it is hot.

A lump has one temperature, so it gives the mean of tread and rim over minutes of drag braking, not the peak at the
surface in a stop. The share of the heat that goes into the blocks, rail chill and radiation are parts of its numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from brake_controller.vehicle_brake import named
from fmu_src.chain import function_of
from fmu_src.system import ParameterSet, quantity

#: Temperature of air, rails and wheels at the start [K].
SURROUNDINGS = 293.15
#: Specific heat capacity of wheels [J/(kg.K)], steel.
STEEL = 500.0
#: Work of a brake in a step: its force at the rims [N], distance of the rims [m], mean speed of the vehicle [m/s].
WORKED = ("force", "way", "speed", "step")
#: Least difference of temperatures in a denominator [K].
LEAST = 1e-6


@dataclass(frozen=True)
class WheelHeat(ParameterSet):
    """All braked wheels of one vehicle, alike and equally warm."""

    heat_capacity: float = quantity("J/K", "Heat capacity of the wheels that takes part; 0: they stay cold", 0.0)
    heat_share: float = quantity("1", "Share of the heat of friction brakes that goes into the wheels", 0.0, 1.0)
    cooling_at_rest: float = quantity("W/K", "Heat lost for each K above the surroundings, standing", 0.0)
    cooling_over_speed: float = quantity("W.s/(K.m)", "Its growth with each m/s of the vehicle", 0.0)
    fade_from: float = quantity("K", "Temperature from which friction falls", 0.0)
    fade_to: float = quantity("K", "Temperature up to which it falls", 0.0)
    fade_left: float = quantity("1", "Share of friction that is left there", 0.0, 1.0)


#: Wheels that stay cold, and friction that does not fade.
NO_WHEEL_HEAT = WheelHeat(0.0, 0.0, 0.0, 0.0, SURROUNDINGS, SURROUNDINGS, 1.0)


def heating() -> ca.Function:
    """Return the function for wheels in a step: temperature [K] and heat of the friction brake so far [J] at its end.

    First law of a lump: C dT/dt = s P - (a + b v) (T - T0), by the trapezoidal rule. It is stable for all steps, and
    what the wheels take and lose sums to their heat exactly. Cooling grows linearly with speed, assumed as for discs.
    Arguments: temperature and heat before, force and distance of the rims, speed of the vehicle and step, the wheels.
    """
    before, heat = ca.SX.sym("before"), ca.SX.sym("heat")
    worked, given = ca.SX.sym("worked", len(WORKED)), ca.SX.sym("given", len(named(WheelHeat)))
    p = dict(zip(named(WheelHeat), ca.vertsplit(given), strict=True))
    force, way, speed, step = ca.vertsplit(worked)
    made = force * ca.fabs(way)
    cooling = step * (p["cooling_at_rest"] + p["cooling_over_speed"] * ca.fabs(speed))
    gained = p["heat_share"] * made - cooling * (before - SURROUNDINGS)
    # without a capacity the temperature stays
    held = ca.if_else(p["heat_capacity"] > 0, p["heat_capacity"] + cooling / 2, 1)
    change = ca.if_else(p["heat_capacity"] > 0, gained / held, 0)
    return function_of("heating", [before, heat, worked, given], ca.vertcat(before + change, heat + made))


def fading() -> ca.Function:
    """Return the function for the share of friction that is left at a temperature [K].

    A table of two points: 1 up to the first temperature, a straight line as for discs in regressions of
    Sawczuk (2021), and a constant from the second on. No public curve of blocks was found, so by default friction does
    not fall.
    """
    temperature, given = ca.SX.sym("temperature"), ca.SX.sym("given", len(named(WheelHeat)))
    p = dict(zip(named(WheelHeat), ca.vertsplit(given), strict=True))
    over = (temperature - p["fade_from"]) / ca.fmax(p["fade_to"] - p["fade_from"], LEAST)
    left = 1 - (1 - p["fade_left"]) * ca.fmin(ca.fmax(over, 0), 1)
    return function_of("fading", [temperature, given], left)
