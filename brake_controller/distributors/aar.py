"""The control valve of North American freight cars: direct and accelerated release, quick service, local emergency.

The auxiliary reservoir fills the cylinder until it has fallen to the pipe's pressure; a full service ends in their
balance. Values that a comment marks are published, in excerpts or by train simulators; all others are assumed. All
volumes have the temperature of their walls (an ideal gas), and chokes follow ISO 6358-1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeVar

from scipy.integrate import quad

from brake_controller.air import (
    AMBIENT,
    GAS_CONSTANT,
    HEAT_CAPACITY,
    HEAT_CAPACITY_RATIO,
    LAMINAR_DIFFERENCE,
    WALL,
    choke_flow,
    share_of,
)
from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from brake_controller.distributors.uic import CHARGED, RELAY, accelerating, emptied, flow_of_a_metre
from brake_controller.pneumatics import TIME_CONSTANTS_TO_95_PERCENT
from fmu_src.symbols import ca
from fmu_src.system import quantity

#: Rate at which the slide valve moves [1/s], and difference over which the emergency portion opens [Pa]. Assumed.
SLIDES, OPENS = 20.0, 10e3
#: Gauge pressure of the pipe below which its vent closes gradually [Pa], and volume of the pipe of a short car [m3],
#: for the steps. Assumed: without both, a long step would empty the pipe to below the surroundings.
VENT_CLOSES, PIPE_VOLUME = 50e3, 5e-3
#: Cubic inch [m3].
CUBIC_INCH = 16.387064e-6
#: Pounds per square inch [Pa].
PSI = 6894.757
#: Columns of a consist that the AAR valve alone has.
OF_AAR = ("retainer", "accelerated_release", "empty_load")
#: Positions of a retaining valve.
RETAINERS = ("direct", "slow-direct", "low", "high")
#: States, absolute pressures [Pa]. `slide`, the place of the slide valve, is that of a pilot chamber: ambient pressure
#: in release, twice that in service.
STATES = (
    *(("auxiliary", "charged"), ("reservoir", "charged"), ("chamber", "charged")),
    *(("bulb", "around"), ("slide", "around"), ("cylinder", "cylinder")),
)


@dataclass(frozen=True)
class FreightCar(DistributorParameters):
    """Reservoirs, cylinder, chokes and emergency portion of a car; `full_pressure` is that of a full service."""

    auxiliary_volume: float = quantity("m3", "Volume of the auxiliary reservoir", 1e-4)
    reservoir_volume: float = quantity("m3", "Volume of the emergency reservoir", 1e-4)
    cylinder_volume: float = quantity("m3", "Volume of the brake cylinders, full stroke", 1e-4)
    service_choke: float = quantity("m", "Diameter of the choke between auxiliary reservoir and cylinder", 1e-4)
    release_choke: float = quantity("m", "Diameter of the choke that empties the cylinder", 1e-4)
    charging_choke: float = quantity("m", "Diameter of the choke from the pipe to each reservoir", 0.0)
    chamber_time: float = quantity("s", "Time constant at which the quick-action chamber follows the pipe", 1e-2)
    emergency_difference: float = quantity("Pa", "Difference of that chamber to the pipe that begins an emergency", 1e3)
    emergency_time: float = quantity("s", "Time constant at which that chamber empties in an emergency", 1e-1)
    emergency_choke: float = quantity("m", "Diameter of the choke from emergency reservoir to cylinder", 0.0)
    pipe_vent: float = quantity("m", "Diameter of the opening that vents the pipe in an emergency", 0.0)
    vent_choke: float = quantity("m", "Diameter of the choke that wheel-slide protection opens", 0.0)


@dataclass(frozen=True)
class AarValve(FreightCar):
    """A control valve with its reservoirs; `full_pressure` is that of a full service from 5 bar."""

    bulb_volume: float = quantity("m3", "Volume that takes air from the pipe as a service begins", 0.0)
    bulb_time: float = quantity("s", "Time to 95 % in which that volume fills", 1e-2)
    quick_choke: float = quantity("m", "Diameter of the choke from the pipe to the cylinder in quick service", 0.0)
    quick_limit: float = quantity("Pa", "Pressure of the cylinder up to which quick service fills it", 0.0)
    sensitivity: float = quantity("Pa", "Difference that moves the slide valve to service", 1e2)
    release_sensitivity: float = quantity("Pa", "Difference that moves it back to release", 1e2)
    accelerated_choke: float = quantity("m", "Diameter of the choke from emergency reservoir to pipe in release", 0.0)
    retained_pressure: float = quantity("Pa", "Pressure that a retainer keeps in the released cylinder; 0: none", 0.0)
    empty_share: float = quantity("1", "Share of a loaded car's pressure that the empty/load device passes", 0.1, 1.0)


#: A car with a valve of its own kind.
CarT = TypeVar("CarT", bound=FreightCar)


def balance(p: FreightCar, charged: float = CHARGED, emergency: bool = False) -> float:
    """Return the gauge pressure [Pa] in which reservoirs and cylinder balance, from a charged gauge pressure [Pa].

    Boyle (1662). Without air of the pipe, p V of the reservoirs is shared with an empty cylinder.
    """
    reservoirs = p.auxiliary_volume + (p.reservoir_volume if emergency else 0.0)
    return charged * reservoirs / (reservoirs + p.cylinder_volume)


def freight_car() -> FreightCar:
    """Return reservoirs, cylinder and chokes of a freight car.

    Auxiliary and emergency reservoir 2500 and 3500 cubic inches, cylinder 1000: the ratio 2.5 of train simulators. With
    it 90 psi give 64 and 77 psi by Boyle's law, as AAR handbooks have it. Assumed: all chokes and times.
    """
    auxiliary, cylinder = 2500 * CUBIC_INCH, 1000 * CUBIC_INCH
    return FreightCar(
        full_pressure=CHARGED * auxiliary / (auxiliary + cylinder),
        auxiliary_volume=auxiliary,
        reservoir_volume=3500 * CUBIC_INCH,
        cylinder_volume=cylinder,
        service_choke=3e-3,
        release_choke=4.5e-3,
        charging_choke=2.0e-3,
        chamber_time=1.0,
        emergency_difference=80e3,
        emergency_time=60.0,
        emergency_choke=2.5e-3,
        pipe_vent=20e-3,
        vent_choke=10e-3,
    )


def ready(position: str) -> AarValve:
    """Return the valve of a loaded freight car; positions make no difference.

    Quick service fills the cylinder to 11 psi; handbooks have 10 to 12. Accelerated release is that of valves from the
    ABD on: train simulators (Open Rails) let the emergency reservoir feed the pipe until the auxiliary is charged.
    Assumed: the chokes (ISO 6358-1), and 0.46 l of quick-service volume, that of the UIC distributor here.
    """
    del position
    return AarValve(
        **freight_car().values(),
        bulb_volume=0.46e-3,
        bulb_time=1.0,
        quick_choke=2e-3,
        quick_limit=76e3,
        sensitivity=10e3,
        release_sensitivity=20e3,
        accelerated_choke=3e-3,
        retained_pressure=0.0,
        empty_share=1.0,
    )


def with_release_time(p: CarT, time: float) -> CarT:
    """Return a car whose cylinder falls from a full service, loaded, to 0.4 bar in a time [s] (ISO 6358-1)."""
    return replace(p, release_choke=(emptied(p.cylinder_volume, balance(p)) / time) ** 0.5)


def release_time(p: FreightCar) -> float:
    """Return the time [s] in which a loaded cylinder falls from a full service to 0.4 bar, isothermal (ISO 6358-1)."""
    return emptied(p.cylinder_volume, balance(p)) / p.release_choke**2


@lru_cache
def slow_exhaust(time: float = 86.0) -> float:
    """Return the diameter [m] of the choke through which a full service from 90 psi empties in a time [s].

    Isothermal: t = V / (R T) int dp / (G of a metre) / d^2 (ISO 6358-1), down to the laminar difference. An Alaska
    Railroad manual, in excerpts, has 86 s for the slow direct position of retainers. Assumed: it begins at a full
    service.
    """
    car = freight_car()
    integral = quad(
        lambda x: 1.0 / flow_of_a_metre(x + AMBIENT, AMBIENT), LAMINAR_DIFFERENCE * AMBIENT, balance(car, 90 * PSI)
    )[0]
    return float((car.cylinder_volume / (GAS_CONSTANT * WALL) * integral / time) ** 0.5)


def retaining(position: str) -> dict[str, float]:
    """Return parameters of a retainer's position, one of RETAINERS: the choke of the exhaust, the kept pressure.

    10 and 20 psi, and a slow exhaust, which is a choke (ISO 6358-1): an Alaska Railroad manual, in excerpts.
    """
    return {
        "direct": {"retained_pressure": 0.0},
        "slow-direct": {"retained_pressure": 0.0, "release_choke": slow_exhaust()},
        "low": {"retained_pressure": 10 * PSI},
        "high": {"retained_pressure": 20 * PSI},
    }[position]


def _sliding(p: Mapping[str, ca.SX], place: ca.SX, fallen: ca.SX) -> ca.SX:
    """Return the rate of the slide valve's place, 0 release to 1 service [1/s]: between both it stays where it is."""
    to_service = share_of(2 * fallen / p["sensitivity"] - 1)
    to_release = share_of(-2 * fallen / p["release_sensitivity"] - 1)
    keeps = 4 * place * (1 - place) * (place - 0.5)
    return SLIDES * (to_service * (1 - place) - to_release * place + keeps)


def vent(p: Mapping[str, ca.SX], line: ca.SX, temperature: ca.SX) -> ca.SX:
    """Return the flow [kg/s] through the open vent of the pipe (ISO 6358-1), which closes as the pipe empties."""
    return share_of((line - AMBIENT) / VENT_CLOSES) * choke_flow(p["pipe_vent"], line, temperature, AMBIENT)


def whole(moment: Moment) -> Answer:
    """Return rates and flows of the valve. Ideal gas at the temperature of the walls, V dp/dt = R T G (ISO 6358-1)."""
    p, pipe, specific = moment.given, moment.pipe, GAS_CONSTANT * WALL
    auxiliary, reservoir, chamber, bulb, slide, cylinder = moment.states.values()
    # Before the empty/load device, whose equalising volume takes the air that a loaded car's cylinder has more.
    line, over = pipe.pressure, (cylinder - AMBIENT) / p["empty_share"]
    loaded, place = over + AMBIENT, share_of(slide / AMBIENT - 1)
    fallen = auxiliary - line
    emergency = share_of((chamber - line - p["emergency_difference"]) / OPENS)
    applies = (1 - p["held"]) * place
    # Service: to the cylinder as far as the auxiliary reservoir is above the pipe; emergency joins all three volumes.
    graduates = share_of(fallen / RELAY)
    serves = applies * (
        graduates * choke_flow(p["service_choke"], auxiliary, WALL, loaded)
        - emergency * choke_flow(p["service_choke"], loaded, WALL, auxiliary)
    )
    helps = applies * emergency * choke_flow(p["emergency_choke"], reservoir, WALL, loaded)
    quick = (
        applies
        * share_of((p["quick_limit"] - over) / RELAY)
        * choke_flow(p["quick_choke"], line, pipe.temperature, loaded)
    )
    released = choke_flow(p["release_choke"], loaded, WALL, AMBIENT)
    vents = p["vented"] * (p["vent_choke"] / p["release_choke"]) ** 2 * released
    kept = ca.if_else(p["retained_pressure"] > 0, share_of((over - p["retained_pressure"]) / RELAY), 1)
    empties = (1 - p["held"]) * (1 - place) * kept * released + vents
    charges = [
        (1 - place) * choke_flow(p["charging_choke"], line, pipe.temperature, one) for one in (auxiliary, reservoir)
    ]
    # The emergency reservoir feeds the pipe until the auxiliary reservoir has its pressure.
    lags = share_of((reservoir - auxiliary) / RELAY)
    fed = (1 - place) * lags * choke_flow(p["accelerated_choke"], reservoir, WALL, line)
    quickens, to_bulb = accelerating(p["bulb_volume"], p["bulb_time"], line, bulb, place)
    vented = emergency * vent(p, line, pipe.temperature)
    follows = (1 - emergency) * (line - chamber) / p["chamber_time"]
    rates = {
        "auxiliary": specific * (charges[0] - serves) / p["auxiliary_volume"],
        "reservoir": specific * (charges[1] - helps - fed) / p["reservoir_volume"],
        "chamber": follows - emergency * (chamber - AMBIENT) / p["emergency_time"],
        "bulb": quickens,
        "slide": AMBIENT * _sliding(p, place, fallen),
        "cylinder": p["empty_share"] * specific * (serves + helps + quick - empties) / p["cylinder_volume"],
    }
    taken = charges[0] + charges[1] + quick + to_bulb + vented
    enthalpy = HEAT_CAPACITY * (taken * pipe.temperature - fed * WALL)
    return Answer(rates, taken - fed, enthalpy, serves + helps + quick)


def fastest_volume(p: FreightCar, quick: float = 0.0, accelerated: float = 0.0) -> float:
    """Return the largest rate at which an air volume comes to rest [1/s], as UIC's (ISO 6358-1).

    Other chokes: from the pipe to the cylinder, and from the emergency reservoir to the pipe [m].
    """
    steepest = 2 * flow_of_a_metre(1.0, 1.0 - LAMINAR_DIFFERENCE) / LAMINAR_DIFFERENCE
    relay = max(steepest, flow_of_a_metre(CHARGED + 2 * AMBIENT, AMBIENT) / RELAY)
    closing = flow_of_a_metre(VENT_CLOSES + AMBIENT, AMBIENT) / VENT_CLOSES
    paces = (
        (p.service_choke**2 * relay + p.charging_choke**2 * steepest) / p.auxiliary_volume,
        ((p.emergency_choke**2 + p.charging_choke**2) * steepest + accelerated**2 * relay) / p.reservoir_volume,
        (p.service_choke**2 + p.emergency_choke**2 + quick**2) * relay / p.cylinder_volume,
        p.release_choke**2 * relay / p.cylinder_volume,
        2 * HEAT_CAPACITY_RATIO * p.pipe_vent**2 * closing / PIPE_VOLUME,
    )
    return max(1 / p.chamber_time, *(GAS_CONSTANT * WALL * pace for pace in paces))


def fastest_change(p: AarValve) -> float:
    """Return the largest rate at which a state comes to rest [1/s], as that of the UIC distributor (ISO 6358-1)."""
    volumes = fastest_volume(p, p.quick_choke, p.accelerated_choke)
    return max(3 * SLIDES, TIME_CONSTANTS_TO_95_PERCENT / p.bulb_time, volumes)


AAR = Distributor(
    name="aar",
    releases_wholly=True,
    parameters=AarValve,
    states=STATES,
    ready=ready,
    whole=whole,
    pace=fastest_change,
    adjustable=("release_time", *OF_AAR),
)
