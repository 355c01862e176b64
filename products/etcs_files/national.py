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
from readers.command_line import decimal_comma, number_in
from readers.documents import is_number
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
    found: dict[str, Any] = {
        of: _number(read[name], name, unit, str(path)) for name, (of, unit) in NUMBERS.items() if name in read
    }
    found |= {of: _switch(read[name], name, str(path)) for name, of in SWITCHES.items() if name in read}
    for name, (of, starts, unit, most) in INTERVALS.items():
        if name in read:
            found[of] = _intervals(read, name, (starts, unit, most), str(path))
    _check_starts(read, str(path))
    if any(name in read for name in ADHESION):
        limits = zip(ADHESION, NationalValues().reduced_adhesion, strict=True)
        found["reduced_adhesion"] = tuple(
            _number(read.get(name, default), name, "m/s2", str(path)) for name, default in limits
        )
    try:
        return NationalValues(**found)
    except BadInputError as error:
        raise FileError(f"{path}: {error}") from None


def _number(value: Any, name: str, unit: str, source: str) -> float:
    """Return a number, with or without its unit."""
    found = number_in(value, unit) if isinstance(value, str) else value if is_number(value) else None
    if found is None:
        wanted = "a number" if unit == "1" else f"a number, alone in {unit} or in quotes with its unit"
        raise FileError(f"{source}: {name} must be {wanted}; got {shown(value)}.{decimal_comma(value, unit)}")
    if name == "M_NVEBCL":
        return found  # NationalValues checks levels
    of = {"M_NVKVINT_b": "Kv_int", "M_NVKVINT": "Kv_int", "M_NVKRINT": "Kr_int", "M_NVKTINT": "Kt_int"}.get(name, name)
    most = RANGES["reduced_adhesion" if name in ADHESION else of] if name not in STARTS else math.inf
    try:
        within(f"{source}: {name}", found, 0.0, most)
    except BadInputError as error:
        raise FileError(str(error)) from None
    return float(found)


def _switch(value: Any, name: str, source: str) -> bool:
    if not (isinstance(value, bool) or value in (0, 1)) or isinstance(value, float):
        raise FileError(f"{source}: {name} must be true or false; got {shown(value)}.")
    return bool(value)


def _intervals(read: dict[str, Any], name: str, starts: tuple[str, str, float], source: str) -> Steps:
    """Return factors by speed [m/s] or length [m]."""
    list_name, unit, most = starts
    given = read[name] if isinstance(read[name], list) else [read[name]]
    places = read.get(list_name, [0]) if isinstance(read[name], list) else [0]
    if not isinstance(places, list) or not 1 <= len(given) <= MOST_INTERVALS or len(given) != len(places):
        count = len(places) if isinstance(places, list) else 1
        raise FileError(
            f"{source}: {name} must have one factor for each start of {list_name}, 1 to {MOST_INTERVALS}; got "
            f"{len(given)} factors and {count} starts."
        )
    values = [_number(value, name, "1", source) for value in given]
    ends = [_number(place, list_name, unit, source) for place in places]
    if ends[0] != 0.0 or ends != sorted(set(ends)) or ends[-1] > most:
        raise FileError(
            f"{source}: {list_name} must ascend from 0 to at most {most:g} {unit}; got {shown(places)}. Begin with 0."
        )
    scale = 1.0 / 3.6 if unit == "km/h" else 1.0
    return Steps(np.array(ends[1:]) * scale, np.array(values))


def _check_starts(read: dict[str, Any], source: str) -> None:
    """Refuse starts of intervals without a list of factors."""
    for name in STARTS:
        factors = [one for one, (_, starts, *_) in INTERVALS.items() if starts == name]
        if name in read and not any(isinstance(read.get(one), list) for one in factors):
            raise FileError(f"{source}: {name} must have a list of factors, {' or '.join(factors)}; got none.")
