"""An electrically controlled pneumatic brake of North American freight cars: a command by wire, air from the pipe.

The pipe only charges the reservoirs. Without current, and when the pipe falls as in an emergency or below a limit, both
reservoirs fill the cylinder. Volumes and chokes are those of the AAR valve; values that a comment does not mark are
assumed.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from brake_controller.air import AMBIENT, GAS_CONSTANT, HEAT_CAPACITY, WALL, choke_flow, share_of
from brake_controller.distributors import aar
from brake_controller.distributors.aar import OF_AAR, OPENS, FreightCar, fastest_volume, freight_car
from brake_controller.distributors.distributor import Answer, Distributor, Moment
from brake_controller.distributors.uic import RELAY
from fmu_src.system import quantity

#: Gauge pressure of the pipe below which the brake is fully applied [Pa]. Assumed.
LOW = 300e3
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
    """Return a freight car with a wire in place of the AAR valve's slide valve; positions make no difference."""
    del position
    return EcpValve(**freight_car().values(), low_pressure=LOW)


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
    without_effect=("position", "full_pressure", *OF_AAR),
    wired=True,
)
