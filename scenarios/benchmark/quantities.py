"""Values of a case: numbers with units, strings, and lists of either; in SI units in memory."""

from __future__ import annotations

import math
from typing import Any

from readers.command_line import NUMBER
from readers.documents import is_number
from readers.text import FileError, shown
from readers.units import SPELLINGS, factor, quantity_of

#: Value of an input: a number in SI units, a string, or a list of either.
Input = float | str | tuple[float, ...] | tuple[str, ...]
#: Longest list of an input.
LONGEST = 100_000
#: Units of areas, by their factor to m2; no table of a model has an area (readers/units.py).
AREAS = {"m2": 1.0, "cm2": 1e-4, "mm2": 1e-6}


def si_unit(unit: str) -> str:
    """Return the SI unit of a quantity by any of its units; "1" for a pure number."""
    if unit in AREAS:
        return "m2"
    quantity = quantity_of(unit)
    if quantity is None:
        known = "such as m/s, km/h, kN, bar or 1"
        raise FileError(f"a unit must be one that is known, {known}; got {shown(unit)}. Begin a text with a letter.")
    return next(one for one, both in SPELLINGS[quantity].items() if both == (1, 1))


def scale_of(unit: str) -> float:
    """Return the SI value of one unit. Raises FileError if it is unknown."""
    numerator, denominator = (AREAS[unit], 1.0) if unit in AREAS else factor(unit, si_unit(unit)) or (1.0, 1.0)
    return numerator / denominator


def quantity(given: Any) -> tuple[float, str]:
    """Return a number in SI units and its SI unit, from a number or a string such as "45 km/h"."""
    if is_number(given):
        return float(given), "1"
    found = NUMBER.fullmatch(given.strip()) if isinstance(given, str) else None
    if not found:
        raise FileError(f'a value must be a number, or a number with its unit, as "45 km/h"; got {shown(given)}.')
    if found[2] is None:
        raise FileError(f'a number in quotes must have its unit, as "45 km/h"; got {shown(given)}. Remove the quotes.')
    unit = si_unit(found[2])
    numerator, denominator = (AREAS[found[2]], 1.0) if unit == "m2" else factor(found[2], unit) or (1.0, 1.0)
    value = float(found[1]) * numerator / denominator
    if not math.isfinite(value):
        raise FileError(f"a value must be finite; got {shown(given)}. Correct it.")
    return value, unit


def input_of(given: Any) -> tuple[Input, str]:
    """Return an input and its SI unit; that of a string is empty.

    A string is a number with its unit if it begins with a digit.
    """
    if isinstance(given, list):
        return _list_of(given)
    if isinstance(given, str) and not given.strip()[:1].isdigit() and not NUMBER.fullmatch(given.strip()):
        if given.strip() and given.isprintable():
            return given.strip(), ""
        raise FileError(f"a text must have letters; got {shown(given)}.")
    return quantity(given)


def _list_of(given: list[Any]) -> tuple[Input, str]:
    if not 0 < len(given) <= LONGEST:
        raise FileError(f"a list must have from 1 to {LONGEST} values; got {len(given)}.")
    found = [input_of(one) for one in given]
    units = sorted({unit for _, unit in found})
    if len(units) > 1 or isinstance(found[0][0], tuple):
        raise FileError(f"a list must have values of one kind; got {', '.join(unit or 'text' for unit in units)}.")
    values: Any = tuple(value for value, _ in found)
    return values, units[0]
