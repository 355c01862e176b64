"""Entries of a case's file: each is valid, or is refused with a message that has file and place."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from fmu_src.suggestion import suggestion
from readers.text import FileError, shown
from scenarios.benchmark.quantities import Input, input_of, quantity

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
