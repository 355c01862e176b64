"""Pressure in the brake cylinder: regulator, flow restriction and solenoid valve of section 6.3.9 (Fig. 6.25)."""

from __future__ import annotations

import math

from fmu_src.symbols import ca

APPLY, HOLD, VENT = 0, 1, 2
#: Descriptions of these values.
VALVE = {APPLY: "apply (de-energised)", HOLD: "hold", VENT: "vent"}

#: A first-order lag covers 95 % of the way in ln(20) time constants.
TIME_CONSTANTS_TO_95_PERCENT = math.log(20.0)


def regulated_pressure(demand: ca.SX, supply_pressure: ca.SX) -> ca.SX:
    """Return the demand, limited to the supply [Pa], as passed by the regulator of section 6.3.9."""
    return ca.fmin(demand, supply_pressure)


def pressure_rate(pressure: ca.SX, target: ca.SX, valve: ca.SX, application_time: ca.SX, release_time: ca.SX) -> ca.SX:
    """Return dp/dt in the cylinder [Pa/s]: flow through a restriction, proportional to the pressure difference.

    application_time [s] is from 0 to 95 % of the target (section 2.4.2), release_time from 100 to 5 %.
    """
    application_rate = TIME_CONSTANTS_TO_95_PERCENT / application_time
    release_rate = TIME_CONSTANTS_TO_95_PERCENT / release_time
    filling = (target - pressure) * ca.if_else(target > pressure, application_rate, release_rate)
    return ca.if_else(valve == HOLD, 0, ca.if_else(valve == VENT, -pressure * release_rate, filling))
