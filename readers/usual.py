"""Usual sizes of quantities on railways, and the widest ones: the unit that a person meant, and limits of variables."""

from __future__ import annotations

import math
from typing import Any

from readers.units import factor, quantity_of, si_of

#: Usual sizes by quantity, in SI units: vehicles on main lines, their parts and brakes. They decide which reading of a
#: number is likely. Assumed. A main reservoir has 10 bar, and trains are rarely faster than 144 km/h.
USUAL: dict[str, tuple[float, float]] = {
    "ratio": (0.01, 2.0),
    "length": (0.01, 100.0),
    "time": (0.1, 100.0),
    "speed": (1.0, 40.0),
    "force": (1e2, 1e6),
    "force per speed": (1e3, 1e6),
    "stiffness": (1e5, 1e8),
    "torque": (1e2, 5e4),
    "pressure": (5e4, 1e6),
    "mass": (1e2, 1e5),
    "volume": (1e-3, 1.0),
    "power": (2e4, 1e7),
    "energy": (1e3, 1e9),
    "temperature": (250.0, 900.0),
}
#: Units that people write instead of a unit, the likeliest first.
READINGS: dict[str, tuple[str, ...]] = {
    "1": ("%",),
    "%": ("1",),
    "permille": ("%", "1"),
    "m": ("mm", "cm", "km"),
    "mm": ("m", "cm"),
    "s": ("ms", "min"),
    "m/s": ("km/h",),
    "km/h": ("m/s",),
    "kg": ("t",),
    "t": ("kg",),
    "Pa": ("bar", "kPa", "mbar"),
    "bar": ("kPa", "Pa", "mbar"),
    "N": ("kN",),
    "kN": ("N",),
    "N.m": ("kN.m",),
    "N/m": ("kN/mm", "MN/m", "kN/m"),
    "N.s/m": ("kN.s/m",),
    "W": ("kW", "MW"),
    "kW": ("MW", "W"),
    "l": ("m3",),
    "K": ("degC",),
}
#: 0 degC [K].
ICE = 273.15
#: Smallest pressure of a brake above 0 [Pa]: below it return springs hold every piston, at 0.1 bar and more.
LEAST_PRESSURE = 5e3
#: Stiffness below which a number is in another unit [N/m], unless a spring is to have no effect.
SOFTEST = 100.0

#: Largest sizes by unit, in SI units, of inputs and parameters that state no limit: some ten times what railways have.
#: Heaviest wagons and strongest couplers have 1e6 kg and 10 MN, rigid suspensions 1e10 N/m, main reservoirs 1 MPa.
WIDEST: dict[str, float] = {
    "1": 1e6,
    "m": 1e7,
    "m2": 1e2,
    "m3": 1e3,
    "1/m": 1e3,
    "rad": 1e3,
    "s": 86400.0,
    "1/s": 1e6,
    "Hz": 1e6,
    "m/s": 1e3,
    "s/m": 1e3,
    "m/s2": 1e3,
    "rad/s": 1e4,
    "kg": 1e6,
    "kg/s": 1e3,
    "kg.m2": 1e9,
    "N": 1e8,
    "N.m": 1e9,
    "N/m": 1e13,
    "N.s/m": 1e10,
    "N.s2/m2": 1e6,
    "N.m/rad": 1e12,
    "N.m.s/rad": 1e9,
    "N/Pa": 1e4,
    "Pa": 1e7,
    "W": 1e9,
    "J": 1e12,
    "J/m": 1e8,
    "J/(kg.K)": 1e5,
    "K": 1e4,
    "1/K": 1.0,
    "W/K": 1e5,
    "W.s/(K.m)": 1e5,
}


def widest(unit: str, least: float, most: float) -> tuple[float, float]:
    """Return limits in which infinite ones are replaced by the widest of a unit; those of an unknown unit stay."""
    end = WIDEST.get(unit, math.inf)
    return (-end if least == -math.inf else least), (end if most == math.inf else most)


def reading_of(usual: str, unit: str) -> tuple[float, float, float] | None:
    """Return numerator, denominator and summand of a reading in another unit; None if it does not convert."""
    if (usual, unit) == ("degC", "K"):
        return 1.0, 1.0, ICE
    both = factor(usual, unit)
    return None if both is None else (*both, 0.0)


def usual_range(unit: str) -> tuple[float, float]:
    """Return the usual sizes of a quantity in a unit of it; 0 and infinity for an unknown one."""
    least, most = USUAL.get(quantity_of(unit) or "", (0.0, math.inf))
    up, down = factor(unit, si_of(unit)) or (1.0, 1.0)
    return least * down / up, most * down / up


def rows_for_c() -> list[tuple[Any, ...]]:
    """Return READINGS of SI units in rows: both units, numerator, denominator, summand, usual sizes [unit]."""
    return [
        (unit, other, *numbers, *usual_range(unit))
        for unit, others in READINGS.items()
        if unit in WIDEST
        for other in others
        if (numbers := reading_of(other, unit))
    ]


def is_almost_0(value: float, unit: str) -> bool:
    """Return whether a pressure of a brake is above 0, and below what any brake applies."""
    both = factor(unit, "Pa")
    return both is not None and 0.0 < value * both[0] / both[1] < LEAST_PRESSURE


def almost_0(name: str, value: float, unit: str, most: float = math.inf) -> str:
    """Return the message for such a pressure."""
    up, down = factor("Pa", unit) or (1.0, 1.0)
    least = LEAST_PRESSURE * up / down
    return f"{name} must be 0 or reach {least:g} {unit}; got {value:g} {unit}.{likely_unit(value, unit, least, most)}"


def note(name: str, value: float, unit: str) -> str:
    """Return a message about a speed or stiffness that is possible and rare, or no text."""
    is_fast = unit == "m/s" and abs(value) > usual_range(unit)[1]
    if not is_fast and not (unit == "N/m" and 0.0 < value < SOFTEST):
        return ""
    also = f" = {3.6 * value:g} km/h" if is_fast else ""
    return f"{name} is {value:g} {unit}{also}.{likely_unit(value, unit, -math.inf, math.inf)}"


def likely_unit(value: float, unit: str, least: float, most: float) -> str:
    """Return the end of a message about a doubtful number: the unit in which it is inside limits, and most usual.

    Takes value [unit], least, most [unit].
    """
    typed = _distance(value, unit, least, most)
    found: list[tuple[float, str]] = []
    for other in READINGS.get(unit, ()) if value and math.isfinite(value) else ():
        up, down, more = reading_of(other, unit) or (math.nan, 1.0, 0.0)
        own = value * up / down + more
        apart = _distance(own, unit, least, most)
        if least <= own <= most and apart <= typed:
            pure, to = "" if other == "1" else f" {other}", "" if unit == "1" else f" {unit}"
            found.append((apart, f" Did you mean {value:g}{pure} = {own:.4g}{to}?"))
    return min(found, key=lambda one: one[0])[1] if found else ""


def _distance(value: float, unit: str, least: float, most: float) -> float:
    """Return the factor between a number and the usual sizes that lie inside limits; 1: it is usual."""
    low, high = (min(max(end, least), most) for end in usual_range(unit))
    size = abs(value)
    return max(low / size, size / high, 1.0) if size and high > 0.0 else math.inf
