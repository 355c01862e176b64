"""National values from a TOML file, by the names of the standard, SUBSET-026, 7.5.1."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from fmu_src.suggestion import suggestion
from products.supervision.arguments import path_of, within
from products.supervision.steps import Steps
from products.supervision.values import RANGES, NationalValues
from readers.documents import is_number
from readers.quantity import decimal_comma, number_in
from readers.text import BadInputError, FileError, shown
from readers.toml_files import toml_of

#: Numbers: field of `NationalValues`, and unit.
NUMBERS = {
    "M_NVEBCL": ("M_NVEBCL", "1"),
    "M_NVAVADH": ("M_NVAVADH", "1"),
    "M_NVKTINT": ("Kt_int", "1"),
    "A_NVP12": ("A_NVP12", "m/s2"),
    "A_NVP23": ("A_NVP23", "m/s2"),
}
#: Permissions by the field of `NationalValues`.
SWITCHES = {"Q_NVGUIPERM": "guidance", "Q_NVINHSMICPERM": "exact_speed", "Q_NVSBFBPERM": "feedback"}
#: Factors: field of `NationalValues`, list of the starts of their intervals, its unit and largest value.
INTERVALS = {
    "M_NVKVINT": ("Kv_int", "V_NVKVINT", "km/h", 600.0),
    "M_NVKVINT_b": ("Kv_int_b", "V_NVKVINT", "km/h", 600.0),
    "M_NVKRINT": ("Kr_int", "L_NVKRINT", "m", 2700.0),
}
STARTS = ("V_NVKVINT", "L_NVKRINT")
ADHESION = ("A_NVMAXREDADH1", "A_NVMAXREDADH2", "A_NVMAXREDADH3")
#: Largest number of intervals: the first, and N_ITER of 5 bits.
MOST_INTERVALS = 32
NAMES = (*NUMBERS, *SWITCHES, *INTERVALS, *STARTS, *ADHESION)


def read_national(path: str | Path) -> NationalValues:
    """Return the national values in a file; a variable that it does not have keeps its default.

    Takes path [0.7, 0.8].
    """
    path = path_of(path)
    read = toml_of(path)
    for name in read:
        if name not in NAMES:
            raise FileError(f"{path}: {shown(name)} is not a national value of the curves; {suggestion(name, NAMES)}")
    source = str(path)
    found: dict[str, Any] = {}
    for name, (field, unit) in NUMBERS.items():
        if name in read:
            found[field] = _number(read[name], name, unit, source, RANGES.get(field))
    found |= {field: _switch(read[name], name, source) for name, field in SWITCHES.items() if name in read}
    found |= {INTERVALS[name][0]: _intervals(read, name, source) for name in INTERVALS if name in read}
    for starts in STARTS:
        factors = [name for name, (_, list_name, *_) in INTERVALS.items() if list_name == starts]
        if starts in read and not any(isinstance(read.get(name), list) for name in factors):
            raise FileError(f"{source}: {starts} must have a list of factors, {' or '.join(factors)}; got none.")
    if any(name in read for name in ADHESION):
        limits = zip(ADHESION, NationalValues().reduced_adhesion, strict=True)
        found["reduced_adhesion"] = tuple(
            _number(read.get(name, default), name, "m/s2", source, RANGES["reduced_adhesion"])
            for name, default in limits
        )
    try:
        return NationalValues(**found)
    except BadInputError as error:
        raise FileError(f"{path}: {error}") from None


def _number(value: Any, name: str, unit: str, source: str, most: float | None) -> float:
    """Return a number, with or without its unit, from 0 to a limit; None: NationalValues checks it."""
    found = number_in(value, unit) if isinstance(value, str) else value if is_number(value) else None
    if found is None:
        wanted = "a number" if unit == "1" else f"a number, alone in {unit} or in quotes with its unit"
        raise FileError(f"{source}: {name} must be {wanted}; got {shown(value)}.{decimal_comma(value, unit)}")
    if most is None:
        return found
    try:
        return float(within(f"{source}: {name}", found, 0.0, most))
    except BadInputError as error:
        raise FileError(str(error)) from None


def _switch(value: Any, name: str, source: str) -> bool:
    if not (isinstance(value, bool) or value in (0, 1)) or isinstance(value, float):
        raise FileError(f"{source}: {name} must be true or false; got {shown(value)}.")
    return bool(value)


def _intervals(read: dict[str, Any], name: str, source: str) -> Steps:
    """Return factors by speed [m/s] or length [m]."""
    field, list_name, unit, most = INTERVALS[name]
    given = read[name] if isinstance(read[name], list) else [read[name]]
    places = read.get(list_name, [0]) if isinstance(read[name], list) else [0]
    if not isinstance(places, list) or not 1 <= len(given) <= MOST_INTERVALS or len(given) != len(places):
        count = len(places) if isinstance(places, list) else 1
        raise FileError(
            f"{source}: {name} must have one factor for each start of {list_name}, 1 to {MOST_INTERVALS}; got "
            f"{len(given)} factors and {count} starts."
        )
    values = [_number(value, name, "1", source, RANGES[field]) for value in given]
    ends = [_number(place, list_name, unit, source, math.inf) for place in places]
    if ends[0] != 0.0 or ends != sorted(set(ends)) or ends[-1] > most:
        raise FileError(
            f"{source}: {list_name} must ascend from 0 to at most {most:g} {unit}; got {shown(places)}. Begin with 0."
        )
    scale = 1.0 / 3.6 if unit == "km/h" else 1.0
    return Steps(np.array(ends[1:]) * scale, np.array(values))
