"""Columns of a log by the names of variables: named by the user's map, or guessed from names and units.

A map has their names as keys, with or without the unit, and names of variables as values:

  "v_ist [km/h]" = "speed"
  Zeit = { name = "time", unit = "ms" }
  n1 = { name = "wheel_speed_1", unit = "rpm", diameter = 0.92 }
  "C [bar]" = ["pressure_1", "pressure_2"]
  engine = false
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from readers.column_names import BEHIND, HEAD_ROUND, HEAD_SQUARE, tidy
from readers.columns import TableError
from readers.decimal_numbers import number_of
from readers.log_words import meant, plain, suffixed
from readers.text import BLANK, quoted, shown
from readers.toml_files import toml_of
from readers.units import factor, quantity_of, unit_like

#: Smallest and largest diameter of a wheel [m].
DIAMETERS = (0.2, 2.5)
#: Likeness of a name and a variable from which it is a typing error.
ALIKE = 0.85
KEYS = ("name", "unit", "diameter", "missing")
#: Quantities of a wheel that its diameter converts.
TURNS = {"speed", "angular velocity"}

#: A map of names as a user gives it: names of variables by names of columns, or its TOML file.
ColumnMap = Mapping[str, Any] | str | Path


@dataclass(frozen=True)
class Head:
    """A cell of the row of names: its place, its text, and name and unit in it; unit "": none.

    base: groups of the file around its column, and number of its rows. Each base has a time of its own.
    """

    at: int
    cell: str
    name: str
    unit: str
    base: tuple[tuple[str, ...], int] = ((), 0)


@dataclass(frozen=True)
class LogColumn:
    """A column that is used as a variable.

    Attributes
    ----------
    head : Head
    variable : str
    unit : str
        Unit of the file; "" means the variable's.
    diameter : float, optional
        Of the wheel whose angular velocity or speed it is [m].
    missing : tuple of float
        Numbers of the file that mean that there is no value.
    guessed : bool
        Whether its name or unit was guessed.
    """

    head: Head
    variable: str
    unit: str
    diameter: float | None = None
    missing: tuple[float, ...] = ()
    guessed: bool = False

    @property
    def slot(self) -> object:
        """The variable, or the time of a base: one column alone may have it."""
        return (self.variable, self.head.base) if self.variable == "time" else self.variable


def time_of(head: Head, columns: Sequence[LogColumn]) -> LogColumn | None:
    """Return the time of a column: that of its base, or of the nearest group around it with as many rows."""
    times = {column.head.base: column for column in columns if column.variable == "time"}
    path, size = head.base
    bases = ((path[:count], size) for count in range(len(path), -1, -1))
    return next((times[base] for base in bases if base in times), None)


def head_of(at: int, cell: str) -> Head:
    """Return name and unit of a cell: in brackets, or behind a slash, a comma or "in" if the unit is known."""
    match = HEAD_SQUARE.fullmatch(cell) or HEAD_ROUND.fullmatch(cell)
    if match and match["unit"] is not None:
        unit = match["unit"].strip(BLANK)
        if unit.casefold() == "utc":  # a clock, no unit
            return Head(at, cell, f"{match['name'].strip(BLANK)} {unit}", "")
        return Head(at, cell, match["name"].strip(BLANK), unit_like(unit) or unit)
    behind = BEHIND.fullmatch(cell)
    if behind and not behind["unit"].isalnum() and (unit := unit_like(behind["unit"])):
        return Head(at, cell, behind["name"].strip(BLANK), unit)
    if behind and (behind[2].strip().lower() in ("/", ",", "in")) and (unit := unit_like(behind["unit"])):
        return Head(at, cell, behind["name"].strip(BLANK), unit)
    return Head(at, cell, cell, "")


@dataclass(frozen=True)
class Naming:
    """Names the columns of a log.

    Attributes
    ----------
    place : str
        File and row, for messages.
    variables : mapping of str to str
        Units of the variables that a log may have, by name.
    texts : collection of int
        Places of columns that hold text or nothing.
    free : bool
        Whether a map may also give other names.
    """

    place: str
    variables: Mapping[str, str]
    texts: Collection[int]
    free: bool = False

    def found(self, heads: Sequence[Head], columns: ColumnMap | None) -> tuple[list[LogColumn], set[int]]:
        """Return the used columns, and the places of those that the map leaves out. Raises TableError."""
        mapped, out = self._mapped(heads, columns)
        taken = {one.head.at for one in mapped} | out
        own = {one.slot for one in mapped}
        exact = [one for head in heads if head.at not in taken for one in self._exact(head) if one.slot not in own]
        self._check_once(exact)
        taken |= {head.at for head in heads if self._exact(head)}  # also if a map gives its variable to another one
        own |= {one.slot for one in exact}
        rest = {name: unit for name, unit in self.variables.items() if name not in own}
        timed = {name: unit for name, unit in rest.items() if name != "time"}
        guessed = [
            one
            for head in heads
            if head.at not in taken
            for one in self._guessed(head, timed if ("time", head.base) in own else rest)
        ]
        self._check_once(guessed)
        return sorted([*mapped, *exact, *guessed], key=lambda one: one.head.at), out

    def _mapped(self, heads: Sequence[Head], columns: ColumnMap | None) -> tuple[list[LogColumn], set[int]]:
        if columns is None:
            return [], set()
        given = toml_of(columns) if isinstance(columns, str | Path) else columns
        source = str(columns) if isinstance(columns, str | Path) else "columns"
        if not isinstance(given, Mapping):
            raise TableError(f"columns must be a map of names or the path of one; got {shown(given)}.")
        found: list[LogColumn] = []
        out: set[int] = set()
        for key, value in given.items():
            head = self._head_named(heads, key, source)
            if value is False or value is None:
                out.add(head.at)
            else:
                found += _rule(source, str(key), value, head, self.variables, self.free)
        slots = [one.slot for one in found]
        for one in found:
            if (times := slots.count(one.slot)) > 1:
                raise TableError(f"{source}: {one.variable} must be named once; it is named {times} times.")
        return found, out

    def _head_named(self, heads: Sequence[Head], key: object, source: str) -> Head:
        text = tidy(str(key))
        for of in (lambda one: tidy(one.cell), lambda one: tidy(one.name)):
            named = [one for one in heads if of(one) == text]
            if len(named) == 1:
                return named[0]
            if named:
                raise TableError(f"{self.place}: the column {shown(key)} must be there once; it is there twice.")
        cells = [head.cell for head in heads]
        near = get_close_matches(str(key), cells, 1)
        hint = f"did you mean {near[0]}?" if near else f"it has {quoted(', '.join(cells), 200)}."
        raise TableError(f"{source}: {self.place} has no column {shown(key)}; {hint}")

    def _exact(self, head: Head) -> list[LogColumn]:
        """Return the variable with this name, also with a unit as the last word."""
        known = {tidy(variable): variable for variable in self.variables}
        bare = tidy(head.name)
        if bare in known:
            return [LogColumn(head, known[bare], head.unit)]
        if head.unit:
            return []
        for name, unit in suffixed(bare):
            if name in known and quantity_of(unit) == quantity_of(self.variables[known[name]]):
                return [LogColumn(head, known[name], unit, guessed=True)]
        return []

    def _guessed(self, head: Head, variables: Mapping[str, str]) -> list[LogColumn]:
        words = plain(head.name)
        readings = [(words, head.unit)] if head.unit else [*suffixed(words), (words, "")]
        for name, unit in readings:
            timed = head.at not in self.texts or meant(name, unit, variables) == ["time"]
            found = meant(name, unit, variables) if timed else []
            if len(found) == 1:
                return [LogColumn(head, found[0], unit, guessed=True)]
            several = found or (self._of_all(name, unit, variables) if head.at not in self.texts else [])
            if several:
                rule = json.dumps(several[0] if found else several)
                remedy = "or false to leave it out." if found else "or those of them that have it, or false."
                raise TableError(
                    f"{self.place}: the column {quoted(head.cell)} can be {', '.join(several[:4])}. Name it in a map "
                    f"(--columns, columns=): {_key(head)} = {rule}, {remedy}"
                )
        self._check_typing(head, variables)
        return []

    def _of_all(self, words: str, unit: str, variables: Mapping[str, str]) -> list[str]:
        """Return the variables of all wheelsets that a name without a number may mean."""
        if not unit:
            return []
        numbered = [meant(f"{words}_{number}", unit, variables) for number in range(1, 17)]
        return [one for found in numbered for one in found]

    def _check_typing(self, head: Head, variables: Mapping[str, str]) -> None:
        near = get_close_matches(tidy(head.name)[:100], variables, 1, ALIKE)
        if near and head.at not in self.texts and _digits(head.name) == _digits(near[0]):
            raise TableError(f"{self.place}: the column {shown(head.name)} is unknown. Did you mean {near[0]}?")

    def _check_once(self, found: Sequence[LogColumn]) -> None:
        for one in found:
            same = [other.head.cell for other in found if other.slot == one.slot]
            if len(same) > len(set(same)) and not one.guessed:
                raise TableError(
                    f"{self.place}: the column {shown(one.variable)} must be there once; it is there twice. Remove one."
                )
            if len(same) > 1:
                raise TableError(
                    f"{self.place}: the columns {quoted(' and '.join(same), 100)} can both be {one.variable}. Name one "
                    f'in a map (--columns, columns=): {_key(one.head)} = "{one.variable}".'
                )


def _key(head: Head) -> str:
    """Return the key of a column in a map, for messages."""
    return json.dumps(head.cell[:60])


def _digits(name: str) -> list[str]:
    return re.findall(r"\d+", name)


def _rule(
    source: str, key: str, value: object, head: Head, variables: Mapping[str, str], free: bool
) -> list[LogColumn]:
    """Return the columns that an entry of a map makes of one of the file. Raises TableError."""
    rule = value if isinstance(value, Mapping) else {"name": value}
    place = f"{source}: {shown(key)}"
    for one in rule:
        if one not in KEYS:
            raise TableError(f"{place} must have the keys {', '.join(KEYS)}; got {shown(one)}.")
    names = rule.get("name")
    unit, missing = rule.get("unit", head.unit), rule.get("missing", [])
    values = [number_of(one) for one in (missing if isinstance(missing, list | tuple) else [missing])]
    if not isinstance(unit, str) or any(one != one for one in values):
        raise TableError(f"{place} must have a text as unit and numbers as missing; got {shown(rule)}.")
    found = []
    for name in names if isinstance(names, list | tuple) else [names]:
        if not isinstance(name, str) or not (_variable(name) if free else name in variables):
            known = list(COMMON if free else variables)
            near = get_close_matches(str(name), known, 1)
            hint = f"Did you mean {near[0]}?" if near else f"Names are {quoted(', '.join(known), 200)}."
            raise TableError(f"{place} must be the name of a variable; got {shown(name)}. {hint}")
        last = "" if unit or "unit" in rule else _last_word(head.name, variables.get(name, "1"))
        found.append(LogColumn(head, name, unit.strip() or last, _diameter(place, rule), tuple(values), bool(last)))
    if not found:
        raise TableError(f"{place} must be the name of a variable; got an empty list.")
    return found


def _last_word(words: str, target: str) -> str:
    """Return the unit that is the last word of a name, if a variable with the unit `target` may have it; "": none."""
    able = TURNS if quantity_of(target) in TURNS else {quantity_of(target)}
    return next((unit for _, unit in suffixed(plain(words)) if quantity_of(unit) in able), "")


def _variable(name: str) -> bool:
    return re.fullmatch(r"[a-zA-Z]\w*", name) is not None


def _diameter(place: str, rule: Mapping[str, Any]) -> float | None:
    """Return the diameter of an entry [m], a number or a text with a unit. Raises TableError."""
    given = rule.get("diameter")
    if given is None:
        return None
    match = re.fullmatch(r"\s*([-+.,\deE]+)\s*(\w*)\s*", given) if isinstance(given, str) else None
    value, unit = (number_of(match[1]), match[2] or "m") if match else (number_of(given), "m")
    both = factor(unit, "m")
    found = value * both[0] / both[1] if both else float("nan")
    least, most = DIAMETERS
    if not least <= found <= most:
        raise TableError(
            f'{place}: diameter must be from {least:g} to {most:g} m; got {shown(given)}. Write 0.92 or "920 mm".'
        )
    return found


def factor_of(one: LogColumn, unit: str, place: str) -> tuple[float, float] | None:
    """Return the factor of a wheel's column to a variable's unit by its diameter; None if the units need none."""
    pair = {quantity_of(one.unit), quantity_of(unit)}
    if pair != TURNS:
        return None
    if one.diameter is None:
        raise TableError(
            f"{place}: the column {quoted(one.head.cell)} in {one.unit} needs the diameter of its wheel to be "
            f"{one.variable} [{unit}]. Give it in a map (--columns, columns=): {_key(one.head)} = "
            f'{{ name = "{one.variable}", diameter = "920 mm" }}.'
        )
    radius = one.diameter / 2
    to_si, from_si = factor(one.unit, _si(one.unit)), factor(_si(unit), unit)
    assert to_si is not None
    assert from_si is not None
    turn = radius if quantity_of(unit) == "speed" else 1 / radius
    return to_si[0] * from_si[0] * turn, to_si[1] * from_si[1]


def _si(unit: str) -> str:
    return "m/s" if quantity_of(unit) == "speed" else "rad/s"


#: Variables that names are guessed as if a log is read without a model, with their units.
COMMON: dict[str, str] = {"time": "s", "speed": "m/s", "distance": "m", "acceleration": "m/s2"}
for _number in range(1, 17):
    COMMON |= {f"wheel_speed_{_number}": "m/s", f"angular_velocity_{_number}": "rad/s"}
