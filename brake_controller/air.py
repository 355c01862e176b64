"""Air: an ideal gas, and its flow through a restriction.

Isentropic flow to the narrowest section. It is choked if the pressure behind it is below the critical share of the
pressure before it. A discharge coefficient covers contraction and friction (any text on gas dynamics, and ISO 6358-1).
"""

from __future__ import annotations

import math

from fmu_src.symbols import Term, ca

#: Dry air: gas constant [J/(kg.K)] (ISO 2533) and ratio of the heat capacities (kappa).
GAS_CONSTANT, HEAT_CAPACITY_RATIO = 287.05287, 1.4
#: Values for trains: discharge coefficient of all chokes, temperature of all walls [K] and ambient pressure [Pa].
#: Assumed.
DISCHARGE, WALL, AMBIENT = 0.8, 293.15, 101325.0

_K = HEAT_CAPACITY_RATIO
#: Heat capacity at constant pressure [J/(kg.K)].
HEAT_CAPACITY = GAS_CONSTANT * _K / (_K - 1)
#: Pressure behind over pressure before the restriction below which the flow is choked: 0.528.
CRITICAL_RATIO = (2 / (_K + 1)) ** (_K / (_K - 1))
#: `flow_function` of a choked restriction: 0.685.
CHOKED_FLOW = math.sqrt(_K) * (2 / (_K + 1)) ** ((_K + 1) / (2 * (_K - 1)))
#: Relative pressure difference below which the root of the isentropic law, whose slope grows without bound, is replaced
#: by a parabola of the same value and slope there. Real restrictions turn laminar near it.
LAMINAR_DIFFERENCE = 1e-3
#: Place of that difference on the ellipse of ISO 6358-1, with value and slope there.
_PLACE = 1 - LAMINAR_DIFFERENCE / (1 - CRITICAL_RATIO)
_ELLIPSE = CHOKED_FLOW * math.sqrt(1 - _PLACE**2)
_ELLIPSE_SLOPE = CHOKED_FLOW**2 * _PLACE / (1 - CRITICAL_RATIO) / _ELLIPSE


def _isentropic(ratio: Term) -> Term:
    """Return the flow function between the critical ratio and 1, without a limit on either side."""
    return ca.sqrt(2 * _K / (_K - 1) * (ratio ** (2 / _K) - ratio ** ((_K + 1) / _K)))


def _joined(value: float, slope: float) -> tuple[float, float]:
    """Return coefficients of the difference and of its square for a parabola at LAMINAR_DIFFERENCE.

    It has the value and slope of a law there.
    """
    d = LAMINAR_DIFFERENCE
    return (2 * value - slope * d) / d, (slope * d - value) / d**2


def _parabola() -> tuple[float, float]:
    """Return the same for the isentropic law."""
    r = 1 - LAMINAR_DIFFERENCE
    value = float(_isentropic(r))
    slope = _K / (_K - 1) * ((_K + 1) / _K * r ** (1 / _K) - 2 / _K * r ** (2 / _K - 1)) / value
    return _joined(value, slope)


def flow_function(ratio: Term) -> Term:
    """Return mass flow over C_d A p / sqrt(R T), by the ratio of pressure behind to pressure before [1] (ISO 6358-1).

    It is differentiable: the parabola near 1 and the choked flow join the isentropic law with its slope. There is no
    backward flow.
    """
    linear, square = _parabola()
    difference = 1 - ratio
    # Limited to the law's range, because the branches that are not taken are evaluated too.
    inside = ca.fmin(ca.fmax(ratio, CRITICAL_RATIO), 1 - LAMINAR_DIFFERENCE)
    near = difference * (linear + square * difference)
    forward = ca.if_else(difference < LAMINAR_DIFFERENCE, near, _isentropic(inside))
    return ca.if_else(difference > 0, forward, 0)


def elliptic_flow_function(ratio: Term) -> Term:
    """Return the same by the ellipse of ISO 6358-1, choked at the same ratio: a root, with an error of at most 0.31 %.

    It replaces powers, for the computation of hundreds of valves at once.
    """
    linear, square = _joined(_ELLIPSE, _ELLIPSE_SLOPE)
    difference = 1 - ratio
    place = (ca.fmin(ca.fmax(ratio, CRITICAL_RATIO), 1 - LAMINAR_DIFFERENCE) - CRITICAL_RATIO) / (1 - CRITICAL_RATIO)
    near = difference * (linear + square * difference)
    forward = ca.if_else(difference < LAMINAR_DIFFERENCE, near, CHOKED_FLOW * ca.sqrt(1 - place**2))
    return ca.if_else(difference > 0, forward, 0)


def elliptic_flow(area: Term, pressure: Term, temperature: Term, pressure_behind: Term) -> Term:
    """Return the mass flow [kg/s] as `mass_flow`, by the ellipse of ISO 6358-1."""
    shape = elliptic_flow_function(pressure_behind / pressure)
    return area * pressure / ca.sqrt(GAS_CONSTANT * temperature) * shape


def mass_flow(area: Term, pressure: Term, temperature: Term, pressure_behind: Term) -> Term:
    """Return the mass flow [kg/s] through a restriction of effective area C_d A [m2].

    The flow is isentropic up to the narrowest section, and choked there as in ISO 6358-1. It is 0 if the pressure
    behind is the larger one. Pressures are absolute [Pa], the temperature in K is that before the restriction.
    """
    return area * pressure / ca.sqrt(GAS_CONSTANT * temperature) * flow_function(pressure_behind / pressure)


def effective_area(diameter: Term, discharge_coefficient: Term) -> Term:
    """Return C_d A of a round restriction [m2]: the area that isentropic flow would need; diameter in m."""
    return discharge_coefficient * math.pi / 4 * diameter**2


def choke_flow(diameter: ca.SX, pressure: ca.SX, temperature: ca.SX | float, pressure_behind: ca.SX | float) -> ca.SX:
    """Return the mass flow [kg/s] through a choke of a train's valves (ISO 6358-1); diameter in m."""
    area = effective_area(diameter, ca.SX(DISCHARGE))
    return elliptic_flow(area, pressure, ca.SX(temperature), ca.SX(pressure_behind))


def share_of(value: ca.SX) -> ca.SX:
    """Return a value limited to 0 and 1, such as the opening of a valve."""
    return ca.fmax(ca.fmin(value, 1), 0)
