"""Closed forms of gas dynamics for a vessel of constant volume, filled from a constant supply or vented; SI units.

Derived from the isentropic flow through a restriction and dp/dt = n R (T_s m_in - T m_out) / V, n the polytropic
exponent. They share constants with the brake, no equation.
"""

import math
from dataclasses import dataclass

from brake_controller.air import GAS_CONSTANT, HEAT_CAPACITY_RATIO

_K = HEAT_CAPACITY_RATIO
#: Exponent of y = r^((kappa - 1) / kappa), in which the isentropic law integrates to a root.
_Y = (_K - 1) / _K
CRITICAL = (2 / (_K + 1)) ** (1 / _Y)


@dataclass(frozen=True)
class Vessel:
    """Volume [m3] with an opening of effective area [m2]; polytropic exponent of the air inside."""

    volume: float
    area: float
    exponent: float


def choked_mass_flow(area: float, pressure: float, temperature: float) -> float:
    """Return the largest mass flow from an absolute pressure [Pa] and temperature [K], by the speed of sound in the
    throat.
    """
    throat_temperature = temperature * 2 / (_K + 1)
    throat_density = CRITICAL * pressure / (GAS_CONSTANT * throat_temperature)
    return area * throat_density * math.sqrt(_K * GAS_CONSTANT * throat_temperature)


def choked_filling_time(vessel: Vessel, supply: float, temperature: float, start: float, end: float) -> float:
    """Return the time between two pressures while the restriction is choked: the pressure is linear in time.

    Takes supply [Pa], temperature [K], start, end [Pa]; returns [s].
    """
    flow = choked_mass_flow(vessel.area, supply, temperature)
    return (end - start) * vessel.volume / (vessel.exponent * GAS_CONSTANT * temperature * flow)


def unchoked_filling_time(vessel: Vessel, supply: float, temperature: float, start: float, end: float) -> float:
    """Return the time between two pressures beyond the critical ratio: proportional to the difference of sqrt(1 - y).

    Takes supply [Pa], temperature [K], start, end [Pa]; returns [s].
    """
    roots = [math.sqrt(1 - (pressure / supply) ** _Y) for pressure in (start, end)]
    speed = vessel.exponent * vessel.area * math.sqrt(GAS_CONSTANT * temperature) / vessel.volume
    return math.sqrt(2 / _Y) * (roots[0] - roots[1]) / speed


def choked_venting_time(vessel: Vessel, temperature: float, start: float, end: float) -> float:
    """Return the time of choked venting between two pressures.

    p / p_0 = (1 + a K t)^(-1/a) with a = (n - 1) / 2n, which is exponential for n = 1.

    Takes temperature [K], start, end [Pa]; returns [s].
    """
    speed = choked_mass_flow(vessel.area, start, temperature) * GAS_CONSTANT * temperature / (vessel.volume * start)
    power = (vessel.exponent - 1) / (2 * vessel.exponent)
    fall = math.log(start / end) if power == 0.0 else ((start / end) ** power - 1) / power
    return fall / (vessel.exponent * speed)
