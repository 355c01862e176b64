"""ETCS brake parameters of an OSRD rolling stock: step functions of speed in m/s, decelerations, factors and times.

OSRD has had them as `etcs_brake_params` since 2025, and since 2026 as `brake_params` of the signalling system
ETCS_LEVEL2 (editoast/schemas/src/rolling_stock).
"""

from __future__ import annotations

from typing import Any

from readers.documents import is_number
from readers.text import FileError, shown

#: Step functions, and times [s].
CURVES = ("gamma_emergency", "gamma_service", "gamma_normal_service", "k_dry", "k_wet", "k_n_pos", "k_n_neg")
TIMES = ("t_traction_cut_off", "t_bs1", "t_bs2", "t_be")
#: Names of both places in a rolling stock.
BEFORE, SYSTEMS, SYSTEM, NOW = "etcs_brake_params", "supported_signaling_systems", "ETCS_LEVEL2", "brake_params"
#: Largest number of steps of a curve.
MOST = 1000

Curve = tuple[list[float], list[float]]


def brake_params_of(read: Any, source: str) -> tuple[dict[str, Curve], dict[str, float]] | None:
    """Return the ETCS brake parameters of a rolling stock.

    Returns curves [m/s], times [s].
    """
    if not isinstance(read, dict):
        return None
    systems = read.get(SYSTEMS)
    listed = [
        one.get(NOW)
        for one in (systems if isinstance(systems, list) else [])
        if isinstance(one, dict) and one.get("type") == SYSTEM
    ]
    places = [one for one in (read.get(BEFORE), *listed) if one is not None]
    if not places:
        return None
    if any(place != places[0] for place in places):
        raise FileError(f"{source} must state the ETCS brake once; got different ones in {BEFORE} and {SYSTEMS}.")
    given = places[0]
    if not isinstance(given, dict):
        raise FileError(f"{source}: {BEFORE} must be an object; got {shown(given)}.")
    for name in given:
        if name not in (*CURVES, *TIMES):
            raise FileError(f"{source}: {shown(name)} is not a parameter of an ETCS brake of OSRD. Leave it out.")
    for name in (*CURVES, *TIMES):
        if name not in given:
            raise FileError(f"{source}: {BEFORE} must have {name}; got none.")
    for name in TIMES:
        if not (is_number(given[name]) and given[name] >= 0):
            raise FileError(f"{source}: {name} must be a number of at least 0 s; got {shown(given[name])}.")
    return {name: _curve(given[name], name, source) for name in CURVES}, {name: float(given[name]) for name in TIMES}


def _curve(given: Any, name: str, source: str) -> Curve:
    """Return boundaries and values of a step function."""
    if not isinstance(given, dict) or set(given) != {"boundaries", "values"}:
        raise FileError(f"{source}: {name} must have boundaries and values; got {shown(given)}.")
    for of, numbers in given.items():
        if not isinstance(numbers, list) or not all(is_number(number) for number in numbers) or len(numbers) > MOST:
            raise FileError(f"{source}: {of} of {name} must be a list of at most {MOST} numbers; got {shown(numbers)}.")
    return [float(one) for one in given["boundaries"]], [float(one) for one in given["values"]]
