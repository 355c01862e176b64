"""Application and release times of a cylinder filled by flow, and the restrictions that give required times.

The equations of `flow` are integrated over pressure instead of time: a quadrature instead of a simulation. All flows
are proportional to the area of their restriction. A time is thus inverse to the area, and the restriction follows
without a search.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

from scipy.integrate import quad

from brake_controller.air import GAS_CONSTANT
from brake_controller.flow import air_rates, inflow, outflow, piston
from brake_controller.flow_parameters import FlowParameters

#: Shares of the demanded pressure at which an application and a release are complete (section 2.4.2).
APPLIED_SHARE, RELEASED_SHARE = 0.95, 0.05
#: No flow; and the temperature of air that does not flow.
NONE = 0.0


def filling_time(flow: FlowParameters, target: float, pressure: float, start: float = 0.0) -> float:
    """Return the time from a gauge pressure to a higher one [s], the regulator (section 6.3.9) at `target` [Pa]."""
    values = flow.values()

    def time_per_pressure(p: float) -> float:
        return float(1 / air_rates(p, NONE, piston(p, values), (inflow(p, target, values), NONE), values).pressure)

    return _integral(time_per_pressure, start, pressure, flow)


def emptying_time(flow: FlowParameters, orifice: float, start: float, end: float) -> float:
    """Return the time from one gauge pressure to a lower one [s] through an opening.

    The remaining air, an ideal gas, expands along its polytrope, T ~ p^(1 - 1 / n), including the piston's return.

    Takes orifice [m], start, end [Pa].
    """
    values, n = flow.values(), flow.polytropic_exponent
    hot = temperature_after_filling(flow, start)

    def time_per_pressure(p: float) -> float:
        ratio = (p + flow.ambient_pressure) / (start + flow.ambient_pressure)
        temperature = hot * ratio ** ((n - 1) / n)
        out = outflow(p, temperature, orifice, values)
        return float(1 / air_rates(p, temperature, piston(p, values), (NONE, out), values).pressure)

    return _integral(time_per_pressure, start, end, flow)


def temperature_after_filling(flow: FlowParameters, pressure: float) -> float:
    """Return the temperature of the air, an ideal gas, after the cylinder was filled from empty to `pressure` [K]."""
    values = flow.values()
    empty, full = (float(piston(x, values).volume) for x in (0.0, pressure))
    specific = GAS_CONSTANT * flow.air_temperature

    def mass_per_pressure(p: float) -> float:
        return float(1 / air_rates(p, NONE, piston(p, values), (1.0, NONE), values).pressure)

    mass = flow.ambient_pressure * empty / specific + _integral(mass_per_pressure, 0.0, pressure, flow)
    return (pressure + flow.ambient_pressure) * full / (mass * GAS_CONSTANT)


def application_time(flow: FlowParameters, pressure: float) -> float:
    """Return the time from 0 to 95 % of a demanded gauge pressure [Pa], section 2.4.2 [s]."""
    return filling_time(flow, pressure, APPLIED_SHARE * pressure)


def release_time(flow: FlowParameters, pressure: float, end: float | None = None) -> float:
    """Return the time from a gauge pressure [Pa] to 5 % of it, or to `end` [Pa], by the exhaust, section 2.4.2 [s]."""
    return emptying_time(flow, flow.release_orifice, pressure, _end(pressure, end))


def vent_time(flow: FlowParameters, pressure: float, end: float | None = None) -> float:
    """Return a time as `release_time`, through the venting valve of a wheel-slide protection (EN 15595) [s]."""
    return emptying_time(flow, flow.vent_orifice, pressure, _end(pressure, end))


def with_application_time(flow: FlowParameters, pressure: float, time: float) -> FlowParameters:
    """Return the cylinder with the application restriction that fills it to 95 % of `pressure` [Pa] in `time` [s].

    The restriction sets the time as in section 6.3.9.
    """
    return replace(flow, application_orifice=_scaled(flow.application_orifice, application_time(flow, pressure), time))


def with_release_time(flow: FlowParameters, pressure: float, time: float, end: float | None = None) -> FlowParameters:
    """Return the cylinder with the exhaust that releases it from `pressure` to 5 % or `end` [Pa] in `time` [s].

    Times are as in section 2.4.2; the venting valve opens the same exhaust.
    """
    orifice = _scaled(flow.release_orifice, release_time(flow, pressure, end), time)
    return replace(flow, release_orifice=orifice, vent_orifice=orifice)


def with_vent_time(flow: FlowParameters, pressure: float, time: float, end: float | None = None) -> FlowParameters:
    """Return the cylinder with a valve that vents it from `pressure` to 5 % or `end` [Pa] in `time` [s].

    It is for wheel-slide protection (EN 15595).
    """
    return replace(flow, vent_orifice=_scaled(flow.vent_orifice, vent_time(flow, pressure, end), time))


def _end(pressure: float, end: float | None) -> float:
    return RELEASED_SHARE * pressure if end is None else end


def _scaled(diameter: float, takes: float, wanted: float) -> float:
    """Return the diameter [m] for the required time, rounded to 0.1 um: the same start values on every computer."""
    if not wanted > 0.0:
        raise ValueError(f"The time must be above 0 s; got {wanted:g} s. Give a longer time.")
    return round(diameter * math.sqrt(takes / wanted), 7)


def _integral(integrand: Callable[[float], float], start: float, end: float, flow: FlowParameters) -> float:
    """Return the integral over gauge pressure [Pa], split where the piston starts and where the shoes touch."""
    touch = flow.spring_preload + flow.spring_stiffness * flow.piston_slack
    corners = [force / flow.piston_area for force in (flow.spring_preload, touch)]
    low, high = sorted((start, end))
    marks = [low, *sorted(corner for corner in set(corners) if low < corner < high), high]
    pieces = itertools.pairwise(marks)
    total = sum(quad(lambda x: float(integrand(x)), *piece, limit=200, epsrel=1e-9)[0] for piece in pieces)
    return float(total if end >= start else -total)
