"""The distributor of UIC 540: from the pressure in the brake pipe to that in the brake cylinder.

Control chamber, accelerator, auxiliary reservoir and cylinder are volumes of air at the temperature of their walls (an
ideal gas). Chokes connect them (ISO 6358-1). The cylinder follows the difference between control chamber and pipe,
through relays without inertia. Values marked by a comment are those of UIC 540 and 541-1, from excerpts and from
memory; all others are assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from brake_controller.air import (
    AMBIENT,
    CHOKED_FLOW,
    CRITICAL_RATIO,
    DISCHARGE,
    GAS_CONSTANT,
    HEAT_CAPACITY,
    LAMINAR_DIFFERENCE,
    WALL,
    choke_flow,
    effective_area,
    elliptic_flow,
    share_of,
)
from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from brake_controller.pneumatics import TIME_CONSTANTS_TO_95_PERCENT
from fmu_src.symbols import ca
from fmu_src.system import quantity

#: Pressure difference over which a relay opens [Pa]: the cylinder is controlled to a few kPa.
RELAY = 5e3
#: Pressure of a charged reservoir [Pa, gauge] (UIC 540).
CHARGED = 500e3
#: States, absolute pressures [Pa], each with its start.
STATES = (("control", "charged"), ("accelerator", "around"), ("auxiliary", "charged"), ("cylinder", "cylinder"))

#: Columns of a consist that set times, reservoir and cylinder.
OF_UIC = ("fill_time", "release_time", "auxiliary", "cylinder")
#: Times of filling to 95 % and of release to 0.4 bar by position [s], the middle of those of UIC 540.
TIMES = {"P": (4.0, 17.5), "G": (24.0, 52.5)}


@dataclass(frozen=True)
class UicDistributor(DistributorParameters):
    """One distributor with its volumes and chokes; pressures are differences or gauge pressures."""

    control_volume: float = quantity("m3", "Volume of the control chamber", 1e-5)
    accelerator_volume: float = quantity("m3", "Volume of the chamber that takes air as braking begins", 0.0)
    auxiliary_volume: float = quantity("m3", "Volume of the auxiliary reservoir", 1e-4)
    cylinder_volume: float = quantity("m3", "Volume of the brake cylinders, full stroke", 1e-4)
    control_choke: float = quantity("m", "Diameter of the choke between pipe and control chamber", 0.0)
    auxiliary_choke: float = quantity("m", "Diameter of the choke between pipe and auxiliary reservoir", 0.0)
    filling_choke: float = quantity("m", "Diameter of the choke that fills the cylinder", 0.0)
    release_choke: float = quantity("m", "Diameter of the choke that empties the cylinder", 1e-4)
    inshot_choke: float = quantity("m", "Diameter of a choke beside it up to the in-shot", 0.0)
    inshot: float = quantity("Pa", "Pressure of the cylinder up to which it fills quickly", 0.0)
    accelerator_time: float = quantity("s", "Time to 95 % in which the accelerator's chamber fills", 1e-2)
    sensitivity: float = quantity("Pa", "Difference at which all brakes; from half of it on it begins to", 1e2)
    full_difference: float = quantity("Pa", "Difference that gives the full pressure of the cylinder", 1e3)
    vent_choke: float = quantity("m", "Diameter of the choke that wheel-slide protection opens", 0.0)
    cylinder_leak: float = quantity("m", "Diameter of a hole through which the cylinder leaks", 0.0)


@lru_cache
def freight(position: str = "P") -> UicDistributor:
    """Return the distributor of a wagon whose filling and release are in the middle of the times of UIC 540.

    The times are to 95 % and to 0.4 bar. P: 4 and 17.5 s, G: 24 and 52.5 s. 3.8 bar at a difference of 1.5 bar (UIC
    540). Auxiliary reservoir 100 l, accelerator 0.46 l, in-shot 0.69 bar, chokes of control chamber 0.59 and auxiliary
    reservoir 2.3 mm: data of Dako BV1 as published by train simulators. Assumed: volumes of control chamber 4 l and
    cylinder 10.3 l, sensitivity 10 kPa, 1 s in which the accelerator fills, 10 mm for wheel-slide protection.
    """
    filling, release = TIMES[position]
    bare = UicDistributor(
        control_volume=4e-3,
        accelerator_volume=0.46e-3,
        auxiliary_volume=0.1,
        cylinder_volume=10.3e-3,
        control_choke=0.59e-3,
        auxiliary_choke=2.3e-3,
        filling_choke=0.0,
        release_choke=1e-4,
        inshot_choke=6e-3,
        inshot=69e3,
        accelerator_time=1.0,
        sensitivity=10e3,
        full_difference=150e3,
        full_pressure=380e3,
        vent_choke=10e-3,
        cylinder_leak=0.0,
    )
    return replace(
        bare,
        filling_choke=filling_choke(bare, filling),
        release_choke=release_choke(bare, release),
    )


def flow_of_a_metre(pressure: float, behind: float) -> float:
    """Return the mass flow [kg/s] through a choke of 1 m, both pressures absolute (ISO 6358-1)."""
    return float(elliptic_flow(effective_area(1.0, DISCHARGE), pressure, WALL, behind))


def filling_choke(p: UicDistributor, time: float) -> float:
    """Return the diameter [m] with which a cylinder reaches 95 % in a time [s] (UIC 540), from a constant 5 bar.

    Isothermal. The in-shot is omitted, because it fills its share at once.
    """
    return float((filled(p.cylinder_volume, p.inshot, 0.95 * p.full_pressure, CHARGED) / time) ** 0.5)


def filled(volume: float, begin: float, end: float, supply: float) -> float:
    """Return the time [s] in which a volume [m3] fills between gauge pressures [Pa] through a choke of 1 m, isothermal.

    The supply has a constant gauge pressure [Pa]. The time, t = V / (R T) int dp / G, is inverse to the square of the
    choke (ISO 6358-1).
    """
    integral = quad(lambda x: 1.0 / flow_of_a_metre(supply + AMBIENT, x + AMBIENT), begin, end, limit=200)[0]
    return float(volume / (GAS_CONSTANT * WALL) * integral)


def release_choke(p: UicDistributor, time: float) -> float:
    """Return the diameter [m] with which a cylinder falls from full to 0.4 bar in a time [s] (UIC 540), isothermal."""
    return float((emptied(p.cylinder_volume, p.full_pressure) / time) ** 0.5)


def release_time(p: UicDistributor) -> float:
    """Return the time [s] in which a cylinder falls from full to 0.4 bar, isothermal (ISO 6358-1)."""
    return emptied(p.cylinder_volume, p.full_pressure) / p.release_choke**2


def emptied(volume: float, full_pressure: float) -> float:
    """Return the time [s] in which a volume [m3] empties through a choke of 1 m to 0.4 bar, isothermal (ISO 6358-1).

    It is inverse to the square of the choke. full_pressure: where it begins [Pa, gauge].
    """
    return volume / (GAS_CONSTANT * WALL) * _release_integral(full_pressure)


@lru_cache(maxsize=1024)
def _release_integral(full_pressure: float) -> float:
    """Return int dp / (G of a metre) from full to 0.4 bar [Pa.s/kg]."""
    return float(quad(lambda x: 1.0 / flow_of_a_metre(x + AMBIENT, AMBIENT), 40e3, full_pressure, limit=200)[0])


def reached_pressure(p: UicDistributor) -> float:
    """Return the gauge pressure [Pa] of reservoir and cylinder in balance, from a reservoir charged to 5 bar.

    Boyle (1662): the sum of p V is kept.
    """
    whole = p.auxiliary_volume + p.cylinder_volume
    return ((CHARGED + AMBIENT) * p.auxiliary_volume + AMBIENT * p.cylinder_volume) / whole - AMBIENT


@lru_cache(maxsize=1024)
def with_times(p: UicDistributor, filling: float, release: float) -> UicDistributor:
    """Return a distributor whose cylinder fills to 95 % of its pressure, and releases to 0.4 bar, in these times [s].

    Isothermal, from a charged reservoir that falls as the cylinder fills, through both chokes up to the in-shot:
    t = V / (R T) int dp / G (ISO 6358-1, Boyle). The pipe is taken to fall and rise at once.
    """
    reached = reached_pressure(p)
    if not reached > p.full_pressure:
        raise ValueError(
            f"full_pressure must be below {1e-5 * reached:.4g} bar, which a reservoir of {1e3 * p.auxiliary_volume:g} l"
            f" at 5 bar reaches with a cylinder of {1e3 * p.cylinder_volume:g} l; got {1e-5 * p.full_pressure:.4g} bar."
            " Increase auxiliary, or decrease cylinder or full_pressure."
        )

    def excess(logarithm: float) -> float:
        return filling_time(replace(p, filling_choke=math.exp(logarithm)), 0.95 * p.full_pressure) - filling

    choke = math.exp(brentq(excess, math.log(1e-5), math.log(1.0), xtol=1e-13))
    return replace(p, filling_choke=choke, release_choke=release_choke(p, release))


def filling_time(p: UicDistributor, pressure: float) -> float:
    """Return the time [s] in which an empty cylinder fills to a gauge pressure [Pa] from its reservoir, isothermal.

    Flows by ISO 6358-1. The in-shot closes over the band of its relay, as in `whole`.
    """
    edges = [0.0, *(edge for edge in (p.inshot - RELAY, p.inshot) if 0.0 < edge < pressure), pressure]
    nodes, weights = np.polynomial.legendre.leggauss(40)
    time = 0.0
    for low, high in pairwise(edges):
        over = (low + high) / 2 + (high - low) / 2 * nodes
        supply = CHARGED + AMBIENT - over * p.cylinder_volume / p.auxiliary_volume
        opens = np.clip((p.inshot - over) / RELAY, 0.0, 1.0)
        of_a_metre = elliptic_flow(effective_area(1.0, DISCHARGE), supply, WALL, over + AMBIENT)
        time += (
            float(weights @ (1.0 / ((p.filling_choke**2 + opens * p.inshot_choke**2) * of_a_metre))) * (high - low) / 2
        )
    return p.cylinder_volume / (GAS_CONSTANT * WALL) * time


def fastest_change(p: UicDistributor) -> float:
    """Return the largest rate at which a state comes to rest [1/s]: an explicit step must not exceed two over it.

    A choke of an area A into a volume V has sqrt(R T) A / V times the steepest slope of the flow (ISO 6358-1). After a
    relay it is the choked flow over the relay's band, if that is larger. The slope is steepest near zero flow. No
    cylinder fills and empties at once.
    """
    specific = GAS_CONSTANT * WALL
    steepest = 2 * flow_of_a_metre(1.0, 1.0 - LAMINAR_DIFFERENCE) / LAMINAR_DIFFERENCE
    relay = flow_of_a_metre(p.full_pressure + 2 * AMBIENT, AMBIENT) / RELAY
    filling = p.filling_choke**2 + p.inshot_choke**2
    paces = (
        p.control_choke**2 * steepest / p.control_volume,
        (p.auxiliary_choke**2 * steepest + filling * max(steepest, relay)) / p.auxiliary_volume,
        max(filling, p.release_choke**2) * max(steepest, relay) / p.cylinder_volume,
    )
    return max(TIME_CONSTANTS_TO_95_PERCENT / p.accelerator_time, *(specific * pace for pace in paces))


def accelerating(volume: ca.SX, time: ca.SX, line: ca.SX, chamber: ca.SX, brakes: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Return the rate of the accelerator's pressure [Pa/s], and its air flow from the pipe [kg/s].

    During braking, a chamber (V dp/dt = R T G, ideal gas; Boyle (1662)) of a volume [m3] fills from the pipe to 95 % in
    a time [s]; after release, it empties to
    the surroundings at the same rate.
    """
    pace = TIME_CONSTANTS_TO_95_PERCENT / time
    into = ca.fmax(line - chamber, 0) * pace * brakes
    return into - (chamber - AMBIENT) * pace * (1 - brakes), into * volume / (GAS_CONSTANT * WALL)


def whole(moment: Moment) -> Answer:
    """Return rates and flows of the whole distributor.

    Ideal gas at the temperature of the walls, V dp/dt = R T G; flows by ISO 6358-1. Air that returns to the pipe has
    the temperature of the walls.
    """
    p = moment.given
    control, accelerator, auxiliary, cylinder = moment.states.values()
    line, air_temperature = moment.pipe.pressure, moment.pipe.temperature

    fallen = control - line
    # Above half of the sensitivity the control chamber is gradually shut off.
    brakes = share_of(2 * fallen / p["sensitivity"] - 1)
    to_control = choke_flow(p["control_choke"], line, air_temperature, control)
    from_control = (1 - brakes) * choke_flow(p["control_choke"], control, WALL, line)
    specific = GAS_CONSTANT * WALL
    quickens, to_accelerator = accelerating(p["accelerator_volume"], p["accelerator_time"], line, accelerator, brakes)
    to_auxiliary = choke_flow(p["auxiliary_choke"], line, air_temperature, auxiliary)
    wanted = ca.fmin(p["full_pressure"] / p["full_difference"] * fallen, p["full_pressure"]) * brakes
    over = cylinder - AMBIENT
    quick = share_of((p["inshot"] - over) / RELAY) * choke_flow(p["inshot_choke"], auxiliary, WALL, cylinder)
    fills = share_of((wanted - over) / RELAY) * (choke_flow(p["filling_choke"], auxiliary, WALL, cylinder) + quick)
    released = choke_flow(p["release_choke"], cylinder, WALL, AMBIENT)
    vents = (p["vented"] * p["vent_choke"] ** 2 + p["cylinder_leak"] ** 2) / p["release_choke"] ** 2 * released
    fills, empties = (1 - p["held"]) * fills, (1 - p["held"]) * share_of((over - wanted) / RELAY) * released + vents
    rates = {
        "control": specific * (to_control - from_control) / p["control_volume"],
        "accelerator": quickens,
        "auxiliary": specific * (to_auxiliary - fills) / p["auxiliary_volume"],
        "cylinder": specific * (fills - empties) / p["cylinder_volume"],
    }
    taken = to_control - from_control + to_auxiliary + to_accelerator
    enthalpy = HEAT_CAPACITY * taken * ca.if_else(taken > 0, air_temperature, WALL)
    return Answer(rates, taken, enthalpy, fills)


#: Largest rate at which an empirical valve reaches its target [1/s]. Assumed: a relay near balance opens less.
EMPIRICAL_PACE = 10.0


def empirical(moment: Moment) -> Answer:
    """Return the answer of a valve that follows the pipe and takes air from it only for its accelerator.

    The cylinder fills from 5 bar and empties by its chokes, by ISO 6358-1 with sqrt(1 - y^2) replaced by 1 - y^2 / 2.
    It reaches its target, and empties when vented, with EMPIRICAL_PACE. The auxiliary reservoir stays full. The control
    chamber fills with a time constant of its choke. This omits the roots and volumes of the whole valve, and is wrong
    if a reservoir is not full.
    """
    p, line = moment.given, moment.pipe.pressure
    control, accelerator, auxiliary, cylinder = moment.states.values()
    fallen = control - line
    brakes = share_of(2 * fallen / p["sensitivity"] - 1)
    choked = CHOKED_FLOW * DISCHARGE * math.pi / 4 * (GAS_CONSTANT * WALL) ** 0.5

    def passes(choke: ca.SX, volume: ca.SX, pressure: ca.SX, behind: ca.SX | float) -> ca.SX:
        y = ca.fmax((behind / pressure - CRITICAL_RATIO) / (1 - CRITICAL_RATIO), 0)
        return choked * choke**2 / volume * pressure * (1 - y**2 / 2)

    over = cylinder - AMBIENT
    wanted = ca.fmin(p["full_pressure"] / p["full_difference"] * fallen, p["full_pressure"]) * brakes
    wide = p["filling_choke"] ** 2 + p["inshot_choke"] ** 2 * ca.if_else(over < p["inshot"], 1, 0)
    fills = passes(ca.sqrt(wide), p["cylinder_volume"], auxiliary, cylinder)
    empties = passes(p["release_choke"], p["cylinder_volume"], cylinder, AMBIENT)
    open_area = (p["vented"] * p["vent_choke"] ** 2 + p["cylinder_leak"] ** 2) / p["release_choke"] ** 2
    vents = ca.fmin(open_area * empties, EMPIRICAL_PACE * ca.fmax(over, 0))
    changes = (1 - p["held"]) * ca.fmax(ca.fmin(EMPIRICAL_PACE * (wanted - over), fills), -empties) - vents
    charged = ca.fmin(-fallen, 0.1 * line) * (1 - brakes) * choked * 10 * p["control_choke"] ** 2 / p["control_volume"]
    quickens, taken = accelerating(p["accelerator_volume"], p["accelerator_time"], line, accelerator, brakes)
    enthalpy = HEAT_CAPACITY * taken * moment.pipe.temperature
    rates = {"control": charged, "accelerator": quickens, "auxiliary": 0.0, "cylinder": changes}
    return Answer(rates, taken, enthalpy, ca.fmax(changes, 0))


UIC = Distributor(
    name="uic",
    parameters=UicDistributor,
    states=STATES,
    ready=freight,
    whole=whole,
    pace=fastest_change,
    empirical=empirical,
    empirical_pace=EMPIRICAL_PACE,
    adjustable=("full_pressure", *OF_UIC),
)
