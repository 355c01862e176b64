"""Entries of a case's file: numbers with units, strings, lists and tables; SI units in memory.

Each entry is valid, or is refused with a message that has file and place.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from typing import Any

from fmu_src.suggestion import suggestion
from readers.documents import is_number
from readers.quantity import NUMBER
from readers.text import FileError, shown
from readers.units import factor, quantity_of, si_of

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
    if quantity_of(unit) is None:
        known = "such as m/s, km/h, kN, bar or 1"
        raise FileError(f"a unit must be one that is known, {known}; got {shown(unit)}. Begin a text with a letter.")
    return si_of(unit)


def scale_of(unit: str) -> float:
    """Return the SI value of one unit. Raises FileError if it is unknown."""
    numerator, denominator = _factor(unit, si_unit(unit))
    return numerator / denominator


def _factor(unit: str, si: str) -> tuple[float, float]:
    return (AREAS[unit], 1.0) if unit in AREAS else factor(unit, si) or (1.0, 1.0)


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
    numerator, denominator = _factor(found[2], unit)
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


#: Names of cases, inputs and answers.
NAME = re.compile(r"[a-z][a-z0-9_.-]*")


def check_names(table: Mapping[str, Any], known: Iterable[str], place: str) -> None:
    """Raise FileError for an entry that is not among the known ones."""
    for name in table:
        if name not in known:
            raise FileError(f"{place}: the entry {shown(name)} is unknown; {suggestion(name, known)}")


def valid_name(name: str, place: str, taken: Iterable[str] = ()) -> bool:
    """Return True for a name of an input or answer that is not taken. Raises FileError for others."""
    if not NAME.fullmatch(name):
        raise FileError(f"{place}: a name must have small letters, digits, _, - and .; got {shown(name)}. Rename it.")
    if name in taken:
        raise FileError(f"{place}: {name} must not be the name of an input too. Rename one.")
    return True


def text_at(table: Mapping[str, Any], name: str, place: str) -> str:
    """Return the string of an entry. Raises FileError."""
    value = table.get(name)
    if not isinstance(value, str) or not value.strip() or not value.strip().isprintable():
        got = "nothing" if value is None else shown(value)
        raise FileError(f'{place}: {name} must be a text of one line; got {got}. Write {name} = "...".')
    return value.strip()


def table_at(table: Mapping[str, Any], name: str, place: str) -> dict[str, Any]:
    """Return the table of an entry. Raises FileError."""
    value = table.get(name)
    if not isinstance(value, dict):
        raise FileError(f"{place} must have a table [{name}]; got {shown(value) if name in table else 'none'}. Add it.")
    return value


def flat(table: Any, place: str, leaves: Iterable[str] = ()) -> dict[str, Any]:
    """Return the entries of nested tables under names with dots; a table with one of `leaves` is an entry."""
    if not isinstance(table, dict):
        raise FileError(f"{place} must be a table; got {shown(table)}.")
    found: dict[str, Any] = {}
    for name, value in table.items():
        if isinstance(value, dict) and not set(leaves) & value.keys():
            found |= {f"{name}.{inner}": one for inner, one in flat(value, f"{place}.{name}", leaves).items()}
        else:
            found[name] = value
    return found


def input_at(place: str, given: Any) -> tuple[Input, str]:
    """Return an input and its SI unit, as `input_of`. Raises FileError with the place."""
    try:
        return input_of(given)
    except FileError as error:
        raise FileError(f"{place}: {error}") from None


def quantity_at(place: str, given: Any, unit: str) -> float:
    """Return a number in an SI unit. Raises FileError with the place."""
    try:
        value, own = quantity(given)
    except FileError as error:
        raise FileError(f"{place}: {error}") from None
    if own != unit:
        raise FileError(f"{place} must have a unit that converts to {unit}; got {shown(given)}.")
    return value
