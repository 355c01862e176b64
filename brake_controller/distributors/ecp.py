"""An electrically controlled pneumatic brake of North American freight cars: a command by wire, air from the pipe.

The pipe only charges the reservoirs. Without current, and when the pipe falls as in an emergency or below a limit, both
reservoirs fill the cylinder. Volumes and chokes are those of the AAR valve; values that a comment does not mark are
assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

from scipy.optimize import brentq

from brake_controller.air import AMBIENT, GAS_CONSTANT, HEAT_CAPACITY, WALL, choke_flow, share_of
from brake_controller.distributors import aar
from brake_controller.distributors.aar import OPENS, FreightCar, fastest_volume, freight_car
from brake_controller.distributors.distributor import Answer, Distributor, Moment
from brake_controller.distributors.uic import CHARGED, RELAY, flow_of_a_metre
from fmu_src.symbols import ca
from fmu_src.system import quantity

#: Gauge pressure of the pipe below which the brake is fully applied [Pa]. Assumed.
LOW = 300e3
#: Steps of the cylinder's pressure in which its time of filling is summed.
FILLING_STEPS = 100
#: States, absolute pressures [Pa].
STATES = (
    *(("auxiliary", "charged"), ("reservoir", "charged"), ("chamber", "charged")),
    ("cylinder", "cylinder"),
)


@dataclass(frozen=True)
class EcpValve(FreightCar):
    """A valve by wire with the reservoirs of a freight car; `full_pressure` is that of a full service by wire."""

    low_pressure: float = quantity("Pa", "Pressure of the pipe below which the brake is fully applied", 0.0)


def ready(position: str) -> EcpValve:
    """Return a freight car with a wire instead of the AAR valve's slide valve; positions make no difference."""
    del position
    return EcpValve(**freight_car().values(), low_pressure=LOW)


@lru_cache(maxsize=1024)
def with_fill_time(p: EcpValve, time: float) -> EcpValve:
    """Return a car whose chokes fill a cylinder by wire to 95 % of its full pressure in a time [s] (ISO 6358-1)."""

    def scaled(logarithm: float) -> EcpValve:
        scale = math.exp(logarithm)
        return replace(p, service_choke=scale * p.service_choke, emergency_choke=scale * p.emergency_choke)

    return scaled(float(brentq(lambda one: fill_time(scaled(one)) - time, math.log(0.04), math.log(20.0), xtol=1e-10)))


def fill_time(p: EcpValve) -> float:
    """Return the time [s] in which a cylinder fills by wire to 95 % of its full pressure, at 5 bar in the pipe.

    Isothermal: V dp = R T G dt for the cylinder and both reservoirs, over the pressure of the cylinder (ISO 6358-1).
    """
    line = CHARGED + AMBIENT
    feeds = ((p.auxiliary_volume, p.service_choke), (p.reservoir_volume, p.emergency_choke))

    def per_pascal(supplies: list[float], over: float) -> tuple[list[float], float]:
        served = [
            choke**2 * flow_of_a_metre(supply, over + AMBIENT)
            for supply, (_, choke) in zip(supplies, feeds, strict=True)
        ]
        charged = [p.charging_choke**2 * flow_of_a_metre(line, one) for one in supplies]
        pace = p.cylinder_volume / (GAS_CONSTANT * WALL * sum(served))
        flows = zip(charged, served, feeds, strict=True)
        return [GAS_CONSTANT * WALL * pace * (into - out) / volume for into, out, (volume, _) in flows], pace

    step, supplies, time = 0.95 * p.full_pressure / FILLING_STEPS, [line, line], 0.0
    for number in range(FILLING_STEPS):  # the middle of each step
        slopes, _ = per_pascal(supplies, number * step)
        middle = [min(one + step / 2 * slope, line) for one, slope in zip(supplies, slopes, strict=True)]
        slopes, pace = per_pascal(middle, (number + 0.5) * step)
        supplies = [min(one + step * slope, line) for one, slope in zip(supplies, slopes, strict=True)]
        time += step * pace
    return time


def whole(moment: Moment) -> Answer:
    """Return rates and flows: a relay follows the demanded share of the full pressure, V dp/dt = R T G (ISO 6358-1).

    Emergency: the pipe falls faster than in service, or is low. Then both reservoirs balance with the cylinder, as in
    the AAR valve.
    """
    p, pipe, specific = moment.given, moment.pipe, GAS_CONSTANT * WALL
    auxiliary, reservoir, chamber, cylinder = moment.states.values()
    line, over = pipe.pressure, cylinder - AMBIENT

    quick = share_of((chamber - line - p["emergency_difference"]) / OPENS)
    applied = ca.fmax(quick, share_of((p["low_pressure"] + AMBIENT - line) / OPENS))
    wanted = p["demanded"] * p["full_pressure"]
    fills = (1 - p["held"]) * ca.fmax(share_of((wanted - over) / RELAY), applied)
    served = fills * choke_flow(p["service_choke"], auxiliary, WALL, cylinder)
    served -= (1 - p["held"]) * applied * choke_flow(p["service_choke"], cylinder, WALL, auxiliary)
    helped = fills * choke_flow(p["emergency_choke"], reservoir, WALL, cylinder)
    released = choke_flow(p["release_choke"], cylinder, WALL, AMBIENT)
    graduates = (1 - p["held"]) * (1 - applied) * share_of((over - wanted) / RELAY)
    empties = (graduates + p["vented"] * (p["vent_choke"] / p["release_choke"]) ** 2) * released
    charges = [choke_flow(p["charging_choke"], line, pipe.temperature, one) for one in (auxiliary, reservoir)]
    vented = quick * aar.vent(p, line, pipe.temperature)
    follows = (1 - quick) * (line - chamber) / p["chamber_time"]
    rates = {
        "auxiliary": specific * (charges[0] - served) / p["auxiliary_volume"],
        "reservoir": specific * (charges[1] - helped) / p["reservoir_volume"],
        "chamber": follows - quick * (chamber - AMBIENT) / p["emergency_time"],
        "cylinder": specific * (served + helped - empties) / p["cylinder_volume"],
    }
    taken = charges[0] + charges[1] + vented
    return Answer(rates, taken, HEAT_CAPACITY * taken * pipe.temperature, served + helped)


ECP = Distributor(
    name="ecp",
    parameters=EcpValve,
    states=STATES,
    ready=ready,
    whole=whole,
    pace=fastest_volume,
    adjustable=("fill_time", "release_time"),
    wired=True,
)
