"""Logs of users: one reader for fits, replays and scenarios.

A log is a table as a logger writes it: text (`log_text.py`), or a binary file (`log_arrays.py`, `formats/logs.py`). Its
columns get names of variables by a map, or by names and units that loggers use (`log_columns.py`); times may be those
of a clock (`log_times.py`). Text, empty columns and columns of other names are left out. Empty cells, `NaN` and numbers
such as -999 that stand for a missing value are NaN. A message reports each guess, each conversion that is not plain,
and all that is left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from readers.columns import Column, Place, TableError, unit_factor
from readers.formats.logs import opened_log
from readers.log_columns import ColumnMap, Head, LogColumn, Naming, factor_of, time_of
from readers.log_joined import joined
from readers.log_rows import Log, count_of, in_order
from readers.log_times import Times
from readers.text import quoted, shown

#: Numbers that stand for a missing value where they are far from all others.
SENTINELS = (-999.0, 999.0, -9999.0, 9999.0, -99999.0, 99999.0, -32768.0, 32767.0, 65535.0)
#: Their least distance from the other values, in spans of these.
FAR = 1.0
#: Reason for which a column of numbers is not used.
EMPTY = "no values"
#: Fewest other values by which a positive number is found to stand for a missing one.
MANY = 10


class LogRows(Protocol):
    """Rows of a log on one time, as a format has them."""

    @property
    def columns(self) -> Sequence[LogColumn]:
        """The columns that are used."""

    @property
    def places(self) -> NDArray[np.int64]:
        """Number of each row, for messages."""

    def times(self, column: LogColumn, factor: Callable[[], tuple[float, float]]) -> Times:
        """Return the times of a column; factor: from its unit to s, for numbers."""

    def numbers(self, column: LogColumn, unit: str) -> NDArray[np.float64]:
        """Return the numbers of a column in the unit of the file; unit: of the variable, for messages."""

    def check(self) -> None:
        """Check, after all numbers were read, that they have one reading."""


class LogSource(Protocol):
    """A log as a format has it.

    place: file and row of the names, for messages; unusable: columns without numbers, each with the reason.
    """

    source: str
    place: str
    heads: list[Head]
    unusable: dict[int, str]

    def bases(self, columns: Sequence[LogColumn]) -> Sequence[LogRows]:
        """Return the rows of each time with columns that are used."""

    def rows(self, columns: Sequence[LogColumn]) -> LogRows:
        """Return the rows of columns that have as many."""


def read_log(
    path: str | Path,
    variables: Mapping[str, str],
    columns: ColumnMap | None = None,
    *,
    others: bool = False,
    by_position: Sequence[str] = (),
) -> Log:
    """Read a log.

    Takes variables [s].
    """
    with opened_log(Path(path), by_position) as source:
        return log_of(source, {"time": "s"} | dict(variables), columns, others, by_position)


def read_columns(path: str | Path) -> Log:
    """Return all columns of numbers of a file as they are, in its own units; a table needs no time, and no order."""
    with opened_log(Path(path)) as source:
        empty = [head for head in source.heads if source.unusable.get(head.at) == EMPTY and head.unit]
        kept = [head for head in source.heads if head.at not in source.unusable or head in empty]
        if len({head.base[1] for head in kept}) != 1:
            got = ", ".join(f"{head.cell} with {head.base[1]}" for head in kept) or ", ".join(
                _told(head, source.unusable) for head in source.heads
            )
            raise TableError(f"{path} must have columns of numbers with as many values each; got {quoted(got, 200)}.")
        columns = _unnamed(kept, [], source.place)
        rows = source.rows(columns)
        numbers = {one.variable: rows.numbers(one, one.unit) for one in columns}
        rows.check()
        messages = _left_out(source.source, source.heads, {head.at for head in kept}, set(), source.unusable)
        return Log(str(path), numbers, {one.variable: one.unit for one in columns}, rows.places, messages)


def log_of(
    source: LogSource,
    variables: Mapping[str, str],
    columns: ColumnMap | None,
    others: bool,
    by_position: Sequence[str] = (),
) -> Log:
    """Return the log of a source, as `read_log` does."""
    heads, unusable, place = source.heads, source.unusable, source.place
    found, out = Naming(place, variables, unusable, others).found(heads, columns)
    if not found and len(heads) == len(by_position):
        found = [LogColumn(head, name, head.unit) for head, name in zip(heads, by_position, strict=True)]
    if not any(one.variable == "time" for one in found):
        there = quoted(", ".join(_told(head, unusable) for head in heads), 200)
        raise TableError(f"{place}: the column time is missing; there are {there}. Add it, or name it in a map.")
    used = {one.head.at for one in found}
    if others:
        rest = [head for head in heads if head.at not in used | out | set(unusable) and time_of(head, found)]
        found += _unnamed(rest, found, place)
        used |= {head.at for head in rest}
    messages = [*_guesses(source.source, found, variables), *_left_out(source.source, heads, used, out, unusable)]
    logs = [_Reading(place, rows, variables).log(source.source, messages) for rows in source.bases(found)]
    return in_order(logs[0][0]) if len(logs) == 1 else joined(source.source, logs, messages)


def _told(head: Head, unusable: Mapping[int, str]) -> str:
    """Return the name of a column, with the reason if it is of no use."""
    return f"{head.cell} ({unusable[head.at]})" if head.at in unusable else head.cell


def _unnamed(rest: Sequence[Head], found: Sequence[LogColumn], place: str) -> list[LogColumn]:
    """Return columns that keep their names, with those of their groups where a name is repeated. Raises TableError."""
    taken = [one.variable for one in found] + [head.name for head in rest]
    paths = [head.base[0] if taken.count(head.name) > 1 else () for head in rest]
    names = ["/".join([*path, head.name]) for path, head in zip(paths, rest, strict=True)]
    for name in names:
        if taken.count(name) > 1 or names.count(name) > 1:
            remedy = "Give each another name in a map (--columns, columns=)."
            raise TableError(f"{place}: the column {shown(name)} must be there once; it is there twice. {remedy}")
    return [LogColumn(head, name, head.unit or "1") for head, name in zip(rest, names, strict=True)]


def _guesses(source: str, found: Sequence[LogColumn], variables: Mapping[str, str]) -> list[str]:
    """Return a line for each column whose name was guessed, and for each unit that was assumed."""
    said = []
    for one in found:
        unit = variables.get(one.variable, "1")
        assumed = not one.unit and unit != "1" and one.variable != "time"
        if one.guessed:
            of = f" in {one.unit}" if one.unit and one.unit != one.head.unit else ""
            said.append(f"{source}: {quoted(one.head.cell)}{of} is read as {one.variable} [{unit}].")
        if assumed:
            said.append(f"{source}: {quoted(one.head.cell)} has no unit; {unit} is assumed.")
    return said


def _left_out(source: str, heads: Sequence[Head], used: set[int], out: set[int], texts: Mapping[int, str]) -> list[str]:
    """Return the line on columns that are not used and not left out by the map."""
    rest = [head for head in heads if head.at not in used | out]
    names = [f"{quoted(one.cell)} ({texts.get(one.at, 'no variable')})" for one in rest]
    more = f" and {len(names) - 12} more" if len(names) > 12 else ""
    return [f"{source}: left out {', '.join(names[:12])}{more}."] if names else []


@dataclass(frozen=True)
class _Reading:
    """Reads the values of the columns of one base."""

    place: str
    rows: LogRows
    variables: Mapping[str, str]

    def log(self, source: str, messages: list[str]) -> tuple[Log, Times]:
        """Return the log and its times. Raises TableError."""
        numbers, units = {}, {}
        times = Times(np.empty(0))
        for one in self.rows.columns:
            unit = units[one.variable] = self.variables.get(one.variable, one.unit or "1")
            if one.variable == "time":
                times = self.rows.times(one, partial(self._factor, one, unit))
                numbers["time"] = times.seconds
                messages += self._of_times(source, one, times)
            else:
                numbers[one.variable] = self._values(source, one, unit, messages)
        self.rows.check()
        names = ["time", *(one for one in numbers if one != "time")]
        ordered = {name: numbers[name] for name in names}
        return Log(source, ordered, {name: units[name] for name in names}, self.rows.places, messages), times

    def _factor(self, found: LogColumn, unit: str) -> tuple[float, float]:
        """Return the factor from the unit of the file to that of the variable. Raises TableError."""
        return factor_of(found, unit, self.place) or unit_factor(_column(found, unit), found.unit, self.place)

    def _of_times(self, source: str, one: LogColumn, times: Times) -> list[str]:
        if times.clock:
            return [f"{source}: time counts from the first row, {quoted(times.clock)}."]
        return [] if one.unit or times.has_unit else [f"{source}: {quoted(one.head.cell)} has no unit; s is assumed."]

    def _values(self, source: str, found: LogColumn, unit: str, messages: list[str]) -> NDArray[np.float64]:
        place = Place(found.head.at, _column(found, unit), self._factor(found, unit))
        raw = self.rows.numbers(found, unit)
        for value in (*found.missing, *_sentinels(raw)):
            where = raw == value
            if np.any(where):
                raw[where] = math.nan
                said = f"{quoted(found.head.cell)} is {value:g} in {count_of(np.sum(where))}, taken as no value"
                messages.append(f"{source}: {said}.")
        return place.converted(raw)


def _column(found: LogColumn, unit: str) -> Column:
    return Column(found.variable, unit, filled=False)


def _sentinels(values: NDArray[np.float64]) -> list[float]:
    """Return the numbers among the values that stand for a missing one: they are far from all others."""
    usual = values[~(np.isnan(values) | np.isin(values, SENTINELS))]
    if usual.size == 0:
        return []
    low, high = float(np.min(usual)), float(np.max(usual))
    span = max(high - low, abs(high), abs(low)) * FAR
    many = usual.size >= MANY and span > 0.0
    below, above = [sentinel < low - span for sentinel in SENTINELS], [many and one > high + span for one in SENTINELS]
    far = [one for one, *sides in zip(SENTINELS, below, above, strict=True) if any(sides)]
    return [one for one in far if np.any(values == one)]
