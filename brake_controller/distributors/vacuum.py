"""The automatic vacuum brake: the pipe holds the vacuum, and air that enters it lifts the pistons.

A cylinder has its chamber above the piston, with a reservoir, and the side below it, which the pipe joins. A ball valve
lets air out of the chamber, and none back: as the pipe fills, the vacuum above remains and the piston rises. All
volumes have the temperature of their walls (an ideal gas), and chokes follow ISO 6358-1. The difference of both sides
of the piston presses the brake. Values that a comment marks are those of train simulators (Open Rails, from drawings
of LMS coaches); all others are assumed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from brake_controller.air import AMBIENT, GAS_CONSTANT, HEAT_CAPACITY, HEAT_CAPACITY_RATIO, WALL, choke_flow, share_of
from brake_controller.distributors.aar import CUBIC_INCH, PSI
from brake_controller.distributors.distributor import Answer, Distributor, DistributorParameters, Moment
from brake_controller.distributors.uic import RELAY, flow_of_a_metre
from fmu_src.symbols import Term, ca
from fmu_src.system import quantity

#: Inch of mercury at 0 degC [Pa]; vacuum of a charged pipe of British railways (Open Rails).
INCH_OF_MERCURY = 3386.389
VACUUM = 21 * INCH_OF_MERCURY
#: Difference over which a passage opens [Pa]: near balance its flow is laminar. Assumed.
BAND = 1e3
#: Least pressure that presses [Pa]. Assumed.
LEAST = 5e3
#: Stroke of a piston [m]: 4.5 inches (Open Rails).
STROKE = 4.5 * 0.0254
#: Columns of a consist that the vacuum brake alone has.
OF_VACUUM = ("vacuum", "direct_admission")


@dataclass(frozen=True)
class VacuumBrake(DistributorParameters):
    """The cylinders of one vehicle; `full_pressure` is what presses as the pipe has lost its vacuum."""

    vacuum: float = quantity("Pa", "Vacuum of the charged pipe, below the surroundings", 1e3, 95e3)
    chamber_volume: float = quantity("m3", "Volume above the lowered pistons, with its reservoir", 1e-4)
    swept_volume: float = quantity("m3", "Volume that the pistons sweep", 0.0)
    lower_volume: float = quantity("m3", "Volume below the lowered pistons", 1e-4)
    choke: float = quantity("m", "Diameter of the choke through which the cylinders fill and empty", 1e-4)
    ball_choke: float = quantity("m", "Diameter of the ball valve, from the chamber to the side below the pistons", 0.0)
    direct_admission: float = quantity("1", "1 if the cylinders fill from the surroundings, 0 from the pipe", 0.0, 1.0)
    lift: float = quantity("Pa", "Difference that carries the pistons' weight on their way", 0.0)
    release_choke: float = quantity("m", "Diameter of the release valve between both sides of the pistons", 0.0)


def full_pressing(p: VacuumBrake) -> float:
    """Return the pressure that presses as the pipe has lost its vacuum [Pa], isothermal (Boyle (1662)).

    The pistons have risen, so that the air above them has the volume that they leave to it.
    """
    return AMBIENT - (AMBIENT - p.vacuum) * p.chamber_volume / (p.chamber_volume - p.swept_volume) - p.lift


def sides(p: Mapping[str, Term], chamber: Term, cylinder: Term) -> tuple[Term, Term]:
    """Return the pressures above and below the pistons [Pa] from those with lowered pistons, isothermal.

    With the swept volume x both are P V / (V - x) and B W / (W + x) (Boyle (1662)). On its way a piston is in balance
    with its weight, B W / (W + x) - P V / (V - x) = lift, which is a quadratic equation of x.
    """
    above, below, lift = p["chamber_volume"], p["lower_volume"], p["lift"]
    slope = lift * (above - below) + cylinder * below + chamber * above
    excess = (cylinder - chamber - lift) * above * below
    root = 2 * excess / (slope + ca.sqrt(ca.fmax(slope**2 - 4 * lift * excess, 0)))
    risen = ca.fmax(ca.fmin(root, p["swept_volume"]), 0)
    return chamber * above / (above - risen), cylinder * below / (below + risen)


def filling_integral(p: VacuumBrake) -> float:
    """Return the time [s] in which the cylinders come to 95 % through a choke of 1 m; the pipe has lost its vacuum.

    t = int dM / G / d^2 with R T M = B W below the pistons, isothermal (ISO 6358-1, Boyle).
    """
    values, chamber = p.values(), AMBIENT - p.vacuum
    last = 0.95 * p.full_pressure

    def pressed(cylinder: float) -> float:
        above, below = sides(values, chamber, cylinder)
        return float(below - above) - p.lift

    def time(cylinder: float) -> float:
        _, below = sides(values, chamber, cylinder)
        opens = min((AMBIENT - float(below)) / (RELAY if p.direct_admission else BAND), 1.0)
        return p.lower_volume / (GAS_CONSTANT * WALL * opens * flow_of_a_metre(AMBIENT, float(below)))

    end = brentq(lambda cylinder: pressed(cylinder) - last, chamber + p.lift, 100 * AMBIENT, xtol=1e-6)
    nodes, weights = np.polynomial.legendre.leggauss(60)
    raised = brentq(lambda cylinder: pressed(cylinder) - 1e-3, chamber + p.lift, end, xtol=1e-6)
    edges = (chamber, chamber + p.lift, raised, end)
    total = 0.0
    for low, high in pairwise(edges):
        places = (low + high) / 2 + (high - low) / 2 * nodes
        total += (high - low) / 2 * float(weights @ [time(place) for place in places])
    return total


def with_fill_time(p: VacuumBrake, time: float) -> VacuumBrake:
    """Return cylinders that come to 95 % of their pressure in a time [s], isothermal (ISO 6358-1)."""
    return replace(p, choke=(filling_integral(p) / time) ** 0.5)


def fill_time(p: VacuumBrake) -> float:
    """Return the time [s] in which the cylinders come to 95 % of their pressure, isothermal (ISO 6358-1)."""
    return filling_integral(p) / p.choke**2


def vacuum_brake(
    vacuum: float = VACUUM,
    chamber_volume: float = 7238 * CUBIC_INCH,
    swept_volume: float = 2290 * CUBIC_INCH,
    filling: float | None = None,
    direct_admission: bool = False,
) -> VacuumBrake:
    """Return the cylinders of a vehicle from volumes [m3] and the time of filling [s] (Boyle (1662), ISO 6358-1).

    Two cylinders of 18 inches with a stroke of 4.5, a chamber of 24 by 16 inches, and 2.5 psi/s of filling: the
    defaults of Open Rails. Assumed: 10 l below the pistons, 5 mm of the ball valve and of the release valve,
    pistons that 3 kPa lift.

    Raises ValueError if the pistons would not press.
    """
    bare = VacuumBrake(
        full_pressure=0.0,
        vacuum=vacuum,
        chamber_volume=chamber_volume,
        swept_volume=swept_volume,
        lower_volume=10e-3,
        choke=1e-2,
        ball_choke=5e-3,
        direct_admission=float(direct_admission),
        lift=3e3,
        release_choke=5e-3,
    )
    if not (chamber_volume > swept_volume and full_pressing(bare) > LEAST):
        most = chamber_volume * (1 - (AMBIENT - vacuum) / (AMBIENT - LEAST - bare.lift))
        raise ValueError(
            f"cylinder must be at most {1e3 * most:.4g} l with auxiliary = {1e3 * chamber_volume:.4g} l above the "
            f"pistons and a vacuum of {1e-5 * vacuum:.4g} bar, or the rising pistons use the vacuum up; got "
            f"{1e3 * swept_volume:.4g} l. Increase auxiliary or vacuum, or decrease cylinder."
        )
    full = replace(bare, full_pressure=full_pressing(bare))
    return with_fill_time(full, filling or 0.95 * full.full_pressure / (2.5 * PSI))


def ready(position: str) -> VacuumBrake:
    """Return the cylinders of a coach; positions make no difference."""
    del position
    return vacuum_brake()


def _passes(choke: ca.SX, pressure: ca.SX, temperature: ca.SX | float, behind: ca.SX) -> ca.SX:
    """Return the flow [kg/s] through a choke that opens over BAND (ISO 6358-1); none backwards."""
    return share_of((pressure - behind) / BAND) * choke_flow(choke, pressure, temperature, behind)


def pressing(states: Mapping[str, ca.SX], p: Mapping[str, ca.SX]) -> ca.SX:
    """Return what the difference of both sides presses beyond the pistons' weight, over ambient pressure [Pa].

    Boyle (1662), as `sides`. Nothing presses until the pistons have risen.
    """
    above, below = sides(p, states["chamber"], states["cylinder"])
    return ca.fmax(below - above - p["lift"], 0) + AMBIENT


def whole(moment: Moment) -> Answer:
    """Return rates and flows of the brake.

    The states are the air above and below the pistons, as its pressures with lowered pistons: V dp/dt = R T G. It is an
    ideal gas at the temperature of the walls. Flows follow ISO 6358-1 between the pressures of `sides`.
    """
    p, pipe, specific = moment.given, moment.pipe, GAS_CONSTANT * WALL
    above, below = sides(p, moment.states["chamber"], moment.states["cylinder"])
    moves = 1 - p["held"]
    admitted = share_of((pipe.pressure - below) / RELAY) * choke_flow(p["choke"], ca.SX(AMBIENT), WALL, below)
    from_pipe = moves * (1 - p["direct_admission"]) * _passes(p["choke"], pipe.pressure, pipe.temperature, below)
    fills = from_pipe + moves * p["direct_admission"] * admitted
    empties = moves * _passes(p["choke"], below, WALL, pipe.pressure)
    exhausted = moves * _passes(p["ball_choke"], above, WALL, below)
    released = p["vented"] * _passes(p["release_choke"], below, WALL, above)
    rates = {
        "chamber": specific * (released - exhausted) / p["chamber_volume"],
        "cylinder": specific * (fills + exhausted - empties - released) / p["lower_volume"],
    }
    enthalpy = HEAT_CAPACITY * (from_pipe * pipe.temperature - empties * WALL)
    return Answer(rates, from_pipe - empties, enthalpy, fills)


def fastest_change(p: VacuumBrake) -> float:
    """Return the largest rate at which a state comes to rest [1/s]: the steepest flow over a volume (ISO 6358-1).

    In BAND a flow grows as the power 1.5 of the difference; a direct admission opens over RELAY.
    """
    steepest = 2 * flow_of_a_metre(AMBIENT, AMBIENT - BAND) / BAND
    admits = p.direct_admission * flow_of_a_metre(AMBIENT, 0.1 * AMBIENT) / RELAY
    valves = p.ball_choke**2 + p.release_choke**2
    below = (p.choke**2 * max(steepest, admits) + valves * steepest) / p.lower_volume
    above = valves * steepest / (p.chamber_volume - p.swept_volume)
    return GAS_CONSTANT * WALL * (below + above)


def drawing(p: VacuumBrake) -> float:
    """Return the rate at which the pipe comes to rest with the cylinders, times its volume [m3/s] (ISO 6358-1)."""
    steepest = 2 * flow_of_a_metre(AMBIENT, AMBIENT - BAND) / BAND
    return HEAT_CAPACITY_RATIO * GAS_CONSTANT * WALL * p.choke**2 * steepest


VACUUM_BRAKE = Distributor(
    name="vacuum",
    vacuum=True,
    parameters=VacuumBrake,
    states=(("chamber", "charged"), ("cylinder", "charged")),
    pressing=pressing,
    drawing=drawing,
    ready=ready,
    whole=whole,
    pace=fastest_change,
    adjustable=("auxiliary", "cylinder", "fill_time", *OF_VACUUM),
)
