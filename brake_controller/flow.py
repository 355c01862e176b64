"""Brake cylinder filled and emptied by the flow of air: supply, restrictions and valve of section 6.3.9 (Fig. 6.25).

The regulator keeps the demanded pressure before the application restriction; above the demand it opens the exhaust. The
state of the air is its mass and its pressure. The piston is in balance of air and return spring. Its inertia and
friction, with effects within milliseconds, are not modelled.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from brake_controller.air import GAS_CONSTANT, HEAT_CAPACITY, HEAT_CAPACITY_RATIO, effective_area, mass_flow
from brake_controller.pneumatics import APPLY, VENT
from fmu_src.symbols import Term, ca

#: Travel over which the piston starts and the shoes come to bear [m]; the corners of the stroke are rounded by it.
STROKE_BLEND = 2e-3
#: Pressure above the demand at which the exhaust is fully open [Pa]. Assumed: relay valves work within a few kPa.
REGULATING_BAND = 1e3

#: Values of `FlowParameters` by name: numbers, or symbols of them.
Values = Mapping[str, Term]


@dataclass(frozen=True)
class Piston:
    """Position of the piston at a pressure: travel [m], its derivative by pressure [m/Pa], volume of air [m3]."""

    travel: ca.SX
    travel_per_pressure: ca.SX
    volume: ca.SX


def piston(pressure: Term, flow: Values) -> Piston:
    """Return the piston in balance with its return spring at a gauge pressure [Pa], from rest to contact of the shoes.

    The travel is (p A - preload) / stiffness, p A being the thrust (2.5), limited to 0 and to the slack by two
    hyperbolas of width STROKE_BLEND.
    """
    free = (pressure * flow["piston_area"] - flow["spring_preload"]) / flow["spring_stiffness"]
    past = free - flow["piston_slack"]
    start, touch = ca.sqrt(free**2 + STROKE_BLEND**2), ca.sqrt(past**2 + STROKE_BLEND**2)
    travel = (start - touch + flow["piston_slack"]) / 2
    slope = (free / start - past / touch) / 2 * flow["piston_area"] / flow["spring_stiffness"]
    return Piston(travel, slope, flow["dead_volume"] + flow["piston_area"] * travel)


def spring_force(position: Piston, flow: Values) -> ca.SX:
    """Return the return spring's force [N], by Hooke's law; the piston must exceed it before the shoes press."""
    return flow["spring_preload"] + flow["spring_stiffness"] * position.travel


def air_temperature(pressure: ca.SX, mass: ca.SX, position: Piston, flow: Values) -> ca.SX:
    """Return the temperature of the cylinder's air [K], an ideal gas: T = p V / (m R).

    Gauge pressure [Pa], mass [kg].
    """
    return (pressure + flow["ambient_pressure"]) * position.volume / (mass * GAS_CONSTANT)


def inflow(pressure: Term, target: Term, flow: Values) -> Term:
    """Return the mass flow [kg/s] through the application restriction (section 6.3.9); gauge pressures [Pa]."""
    area = effective_area(flow["application_orifice"], flow["discharge_coefficient"])
    ambient = flow["ambient_pressure"]
    return mass_flow(area, target + ambient, flow["air_temperature"], pressure + ambient)


def outflow(pressure: Term, temperature: Term, orifice: Term, flow: Values) -> Term:
    """Return the mass flow [kg/s] to the surroundings through an opening [m], isentropic; gauge pressure [Pa]."""
    area = effective_area(orifice, flow["discharge_coefficient"])
    return mass_flow(area, pressure + flow["ambient_pressure"], temperature, flow["ambient_pressure"])


@dataclass(frozen=True)
class Openings:
    """Openings of a cylinder's valves, from 0 to 1: to the regulator, and to the surroundings."""

    refill: ca.SX
    dump: ca.SX


def commanded(valve: ca.SX) -> Openings:
    """Return valves that follow their command at once: the solenoid of section 6.3.9 applies when it is de-energised.

    This differs from the thesis: the valve also holds and vents.
    """
    return Openings(ca.if_else(valve == APPLY, 1, 0), ca.if_else(valve == VENT, 1, 0))


@dataclass(frozen=True)
class Regulator:
    """Gauge pressures [Pa]: the demand, above which the exhaust opens, and the supply before the cylinder."""

    demand: ca.SX
    supply: ca.SX


def valve_flows(
    pressure: ca.SX, temperature: ca.SX, regulator: Regulator, valves: Openings, flow: Values
) -> tuple[ca.SX, ca.SX]:
    """Return mass flows into and out of the cylinder [kg/s] (section 6.3.9); gauge pressure [Pa], temperature [K]."""
    opening = ca.fmax(ca.fmin((pressure - regulator.demand) / REGULATING_BAND, 1), 0)
    release = opening * outflow(pressure, temperature, flow["release_orifice"], flow)
    vent = outflow(pressure, temperature, flow["vent_orifice"], flow)
    return valves.refill * inflow(pressure, regulator.supply, flow), valves.refill * release + valves.dump * vent


@dataclass(frozen=True)
class AirRates:
    """Change of the air in the cylinder: pressure [Pa/s]; enthalpy in and out, work on the piston, heat out [W]."""

    pressure: ca.SX
    enthalpy_in: ca.SX
    enthalpy_out: ca.SX
    piston_work: ca.SX
    heat_loss: ca.SX


def air_rates(pressure: Term, temperature: Term, position: Piston, flows: tuple[Term, Term], flow: Values) -> AirRates:
    """Return the First law for the air in the cylinder, an open system: dU/dt = H_in - H_out - p dV/dt - Q.

    The heat Q to the walls is the share of the rest for which V dp/dt = n (R T_s m_in - R T m_out - p dV/dt), with the
    polytropic exponent n. It is 0 at n = kappa. It is all of the compression at n = 1, so that the air stays at the
    temperature of the supply. Heat is exchanged only while air flows: hot air that is held stays hot.
    """
    n, k = flow["polytropic_exponent"], HEAT_CAPACITY_RATIO
    absolute = pressure + flow["ambient_pressure"]
    flow_work = GAS_CONSTANT * (flow["air_temperature"] * flows[0] - temperature * flows[1])
    growth = flow["piston_area"] * position.travel_per_pressure
    rate = n * flow_work / (position.volume + n * absolute * growth)
    work = absolute * growth * rate
    return AirRates(
        pressure=rate,
        enthalpy_in=HEAT_CAPACITY * flow["air_temperature"] * flows[0],
        enthalpy_out=HEAT_CAPACITY * temperature * flows[1],
        piston_work=work,
        heat_loss=(k - n) / (k - 1) * (flow_work - work),
    )
