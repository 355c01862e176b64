"""The direct (independent) brake of a locomotive: the driver fills its cylinders from the main reservoir.

A double check valve joins it to the distributor: the higher of both pressures presses the brake. Each side fills a
volume of its own, as behind a check valve with a relay. Bail-off opens the distributor's side to the surroundings, and
does not reach the direct side.
"""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.air import (
    AMBIENT,
    GAS_CONSTANT,
    LAMINAR_DIFFERENCE,
    WALL,
    choke_flow,
    share_of,
)
from brake_controller.distributors.uic import RELAY, emptied, filled, flow_of_a_metre
from brake_controller.main_reservoir import MainReservoir
from brake_controller.vehicle_brake import named
from brake_controller.vehicle_protection import VOLUME
from fmu_src.chain import function_of
from fmu_src.symbols import ca
from fmu_src.system import ParameterSet, quantity

#: Times of filling to 95 % and of release to 0.4 bar [s]. Assumed: Open Rails' default of 12.5 psi/s gives 3.9 and 3.6
#: s with 3.5 bar.
FILLING, RELEASE = 4.0, 4.0
#: Choke that wheel-slide protection opens [m], as that of UIC distributors. Assumed.
VENT_CHOKE = 10e-3
#: Largest supply for which steps are stable [Pa, absolute].
LARGEST_SUPPLY = 1.7e6
#: Pressures of a moment [Pa, absolute]. Share that the driver demands; commands of wheel-slide protection, as shares.
PRESSED, COMMANDED = ("reservoir", "cylinder"), ("wanted", "held", "vented")


@dataclass(frozen=True)
class DirectBrake(ParameterSet):
    """Direct brake of one vehicle; pressures are gauge pressures."""

    direct_pressure: float = quantity("Pa", "Pressure of the cylinders with the whole direct brake; 0 without one", 0.0)
    direct_volume: float = quantity("m3", "Volume of the cylinders that the direct brake fills", 1e-5)
    direct_filling_choke: float = quantity("m", "Diameter of the choke that fills them", 0.0)
    direct_release_choke: float = quantity("m", "Diameter of the choke that empties them", 0.0)
    direct_pace: float = quantity("1/s", "Largest rate at which their pressure comes to rest", 0.0, 1e5)


#: A vehicle without a direct brake.
NO_DIRECT_BRAKE = DirectBrake(0.0, VOLUME, 0.0, 0.0, 0.0)


def with_direct_times(pressure: float, volume: float, supply: float, filling: float, release: float) -> DirectBrake:
    """Return a direct brake by its gauge pressure [Pa], volume [m3], and times [s] to 95 % and to 0.4 bar.

    The times are those from a supply of a constant gauge pressure [Pa].
    """
    fills = (filled(volume, 0.0, 0.95 * pressure, supply) / filling) ** 0.5
    empties = (emptied(volume, pressure) / release) ** 0.5
    return DirectBrake(pressure, volume, fills, empties, fastest_change(volume, fills, empties))


def times_of(p: DirectBrake, supply: float) -> tuple[float, float]:
    """Return the times of filling and of release [s] for `with_direct_times`."""
    filling = filled(p.direct_volume, 0.0, 0.95 * p.direct_pressure, supply) / p.direct_filling_choke**2
    return filling, emptied(p.direct_volume, p.direct_pressure) / p.direct_release_choke**2


def fastest_change(volume: float, fills: float, empties: float) -> float:
    """Return the largest rate at which the pressure comes to rest [1/s], as `fastest_change` of a UIC distributor."""
    steepest = 2 * flow_of_a_metre(1.0, 1.0 - LAMINAR_DIFFERENCE) / LAMINAR_DIFFERENCE
    relay = max(steepest, flow_of_a_metre(LARGEST_SUPPLY, AMBIENT) / RELAY)
    wide = max(fills**2 * relay, empties**2 * relay + VENT_CHOKE**2 * steepest)
    return GAS_CONSTANT * WALL * wide / volume


def direct_braking() -> ca.Function:
    """Return the function for a moment of a direct brake: rates of both pressures [Pa/s].

    Ideal gas at the temperature of the walls, V dp/dt = R T G, flows by ISO 6358-1. The reservoir loses the mass that
    the cylinders gain. Arguments: PRESSED, COMMANDED, the direct brake, the main reservoir.
    """
    pressures, order = ca.SX.sym("pressures", len(PRESSED)), ca.SX.sym("order", len(COMMANDED))
    given = [ca.SX.sym("direct", len(named(DirectBrake))), ca.SX.sym("main", len(named(MainReservoir)))]
    p, main = (
        dict(zip(named(of), ca.vertsplit(row), strict=True))
        for of, row in zip((DirectBrake, MainReservoir), given, strict=True)
    )
    (reservoir, cylinder), (wanted, held, vented) = ca.vertsplit(pressures), ca.vertsplit(order)
    lacks = wanted * p["direct_pressure"] - (cylinder - AMBIENT)
    fills = (1 - held) * share_of(lacks / RELAY) * choke_flow(p["direct_filling_choke"], reservoir, WALL, cylinder)
    empties = (1 - held) * share_of(-lacks / RELAY) * choke_flow(p["direct_release_choke"], cylinder, WALL, AMBIENT)
    vents = vented * choke_flow(ca.SX(VENT_CHOKE), cylinder, WALL, AMBIENT)
    specific = GAS_CONSTANT * WALL
    gains = specific * (fills - empties - vents) / p["direct_volume"]
    volume = main["reservoir_volume"]
    loses = ca.if_else(volume > 0, -specific * fills / ca.fmax(volume, 1e-9), 0)
    return function_of("direct_braking", [pressures, order, *given], ca.vertcat(loses, gains))
