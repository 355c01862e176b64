"""Logs of users: one reader for fits, replays and scenarios.

A log is a table (`readers/tables.py`) as a logger writes it. Its columns get names of variables by a map, or by names
and units that loggers use (`log_columns.py`); times may be those of a clock (`log_times.py`). Text, empty columns
and columns of other names are left out. Empty cells, `NaN` and numbers such as -999 that stand for a missing value are
NaN. A message tells each guess, each conversion that is not plain, and all that is left out.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from readers.columns import THOUSANDS, Cells, Column, DecimalMark, Place, TableError, unit_factor
from readers.decimal_numbers import is_decimal
from readers.log_columns import ColumnMap, Head, LogColumn, Naming, factor_of, head_of
from readers.log_rows import Log, count_of, in_order
from readers.log_times import Times, TimesPlace, times_of
from readers.log_words import unit_like
from readers.tables import Begin, TableRows, begin_of
from readers.text import quoted, text_of

#: Words of a cell that stand for a missing value, in small letters.
MISSING = {"", "nan", "n/a", "na", "#n/a", "#nv", "null", "none", "nil", "-", "--", "---", "?"}
#: Numbers that stand for a missing value where they are far from all others.
SENTINELS = (-999.0, 999.0, -9999.0, 9999.0, -99999.0, 99999.0, -32768.0, 32767.0, 65535.0)
#: Their least distance from the other values, in spans of these.
FAR = 1.0
#: Fewest other values by which a positive number is found to stand for a missing one.
MANY = 10
#: Rows by which columns of text are found.
SAMPLE = 200
MOST_ROWS = 4_000_000
#: Minutes and seconds of a clock; a decimal mark and digits may follow.
CLOCK_DIGITS = r":\d\d:\d\d"


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
    source, variables = str(path), {"time": "s"} | dict(variables)
    heads, begin, names_at = _heads(begin_of(text_of(path), source), by_position)
    place = f"{source}, row {names_at}"
    texts = _texts(heads, begin)
    naming = Naming(place, variables, texts, others)
    found, out = naming.found(heads, columns)
    if not found and len(heads) == len(by_position):
        found = [LogColumn(head, name, head.unit) for head, name in zip(heads, by_position, strict=True)]
    if not any(one.variable == "time" for one in found):
        there = quoted(", ".join(one.cell for one in heads), 200)
        raise TableError(f"{place}: the column time is missing; there are {there}. Add it, or name it in a map.")
    used = {one.head.at for one in found}
    if others:
        rest = [head for head in heads if head.at not in used | out | set(texts)]
        found += [LogColumn(head, head.name, head.unit or "1") for head in rest]
        used |= {head.at for head in rest}
    messages = [*_guesses(source, found, variables), *_left_out(source, heads, used, out, texts)]
    return in_order(_Reading(place, begin, variables, found).log(messages))


def _heads(begin: Begin, by_position: Sequence[str]) -> tuple[list[Head], Begin, int]:
    """Return the names of the columns, the begin of the rows behind them, and their row. Raises TableError."""
    place = f"{begin.source}, row {begin.at}"
    if not all(is_decimal(cell) for cell in begin.cells if cell):
        begin = _without_title(begin)
        heads = [head_of(at, cell) for at, cell in enumerate(begin.cells) if cell]
        return *_with_units(heads, begin), begin.at
    if not by_position:
        got = quoted(begin.cells[0])
        raise TableError(f"{place}: the first row must have names; got {got}. Add them, as in time [s], speed [m/s].")
    if len(begin.cells) != len(by_position):
        need = f"{len(by_position)} values ({', '.join(by_position)})"
        raise TableError(f"{place}: a row must have {need}; got {len(begin.cells)}. Correct the row.")
    heads = [Head(at, name, name, "") for at, name in enumerate(by_position)]
    return heads, Begin(begin.source, begin.lines, begin.separator, begin.at - 1, list(by_position)), begin.at


def _without_title(begin: Begin) -> Begin:
    """Return the begin of the table after rows with a single cell, such as a title; as it is if there are others."""
    found = begin
    while len(found.cells) == 1:
        try:
            found = begin_of("\n" * found.at + "\n".join(found.lines[found.at :]), begin.source)
        except TableError:
            return begin
        if all(is_decimal(cell) for cell in found.cells if cell):
            return begin
    return found


def _with_units(heads: list[Head], begin: Begin) -> tuple[list[Head], Begin]:
    """Return the heads with the units of the row after the names, if that row has units alone, and the rest."""
    at, cells = next(begin.rows_behind(), (0, []))
    units = {place: cell.strip("[]()") for place, cell in enumerate(cells) if cell}
    words = {"-", "1", "text", "iso", "utc"}
    known = [unit for unit in units.values() if unit_like(unit) or unit.lower() in words]
    if not at or len(known) < len(units) or not any(unit_like(one) and not is_decimal(one) for one in known):
        return heads, begin
    named = [
        Head(head.at, head.cell, head.name, head.unit or unit_like(units.get(head.at, "")) or "") for head in heads
    ]
    return named, Begin(begin.source, begin.lines, begin.separator, at, begin.cells)


def _texts(heads: Sequence[Head], begin: Begin) -> dict[int, str]:
    """Return the places of columns that hold text or nothing in the first rows, each with this word."""
    rows = [cells for (_, cells), _ in zip(begin.rows_behind(), range(SAMPLE), strict=False)]
    found = {}
    for head in heads:
        cells = [row[head.at] for row in rows if head.at < len(row) and row[head.at].casefold() not in MISSING]
        if rows and not any(is_decimal(cell) for cell in cells):
            found[head.at] = "text" if cells else "no values"
    return found


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
    """Reads the values of the columns that are used."""

    place: str
    begin: Begin
    variables: Mapping[str, str]
    found: Sequence[LogColumn]

    def log(self, messages: list[str]) -> Log:
        """Return the log. Raises TableError."""
        width = len(self.begin.cells)
        nameless = {at for at, cell in enumerate(self.begin.cells) if at and not cell}  # the first may number the rows
        places: list[int] = []
        cells: list[list[str]] = [[] for _ in self.found]
        for number, row in self.begin.rows_behind():
            extra = next((at for at, cell in enumerate(row) if cell and at in nameless), None)
            if extra is not None or any(row[width:]):
                at = width + [bool(cell) for cell in row[width:]].index(True) if extra is None else extra
                body = TableRows(self.begin.source, self.begin.separator, MOST_ROWS)
                raise body.nameless(number, at, row[at], width - len(nameless))
            if len(places) == MOST_ROWS:
                raise TableError(f"{self.begin.source} must have at most {MOST_ROWS} rows; it has more. Split it.")
            places.append(number)
            for one, column in zip(self.found, cells, strict=True):
                cell = row[one.head.at] if one.head.at < len(row) else ""
                column.append("" if cell.casefold() in MISSING else cell)
        rows, mark = np.array(places, np.int64), DecimalMark(self.begin.source)
        numbers, units = {}, {}
        for one, column in zip(self.found, cells, strict=True):
            unit = self.variables.get(one.variable, one.unit or "1")
            read = self._times if one.variable == "time" else self._values
            numbers[one.variable] = read(one, unit, column, rows, mark, messages)
            units[one.variable] = unit
        mark.decimal = mark.decimal or self._has_decimal(mark)
        mark.check_thousands(self.begin.separator)
        names = ["time", *(one for one in numbers if one != "time")]
        ordered = {name: numbers[name] for name in names}
        return Log(self.begin.source, ordered, {name: units[name] for name in names}, rows, messages)

    def _has_decimal(self, mark: DecimalMark) -> bool:
        """Return whether a cell of any column, such as a clock, has the mark of the numbers as a decimal one."""
        sign = "," if "," in mark.shown else "."
        cells = (cell for _, row in self.begin.rows_behind() for cell in row if sign in cell)
        decimals = re.compile(rf"{CLOCK_DIGITS}{re.escape(sign)}\d")
        return bool(mark.shown) and any(
            decimals.search(cell) or (is_decimal(cell) and not THOUSANDS.fullmatch(cell)) for cell in cells
        )

    def _cells(self, found: LogColumn, unit: str, rows: NDArray[np.int64]) -> Cells:
        column = Column(found.variable, unit, filled=False)
        both = factor_of(found, unit, self.place) or unit_factor(column, found.unit, self.place)
        return Cells(self.begin.source, rows, Place(found.head.at, column, both))

    def _times(
        self,
        one: LogColumn,
        unit: str,
        cells: list[str],
        rows: NDArray[np.int64],
        mark: DecimalMark,
        messages: list[str],
    ) -> NDArray[np.float64]:
        place = TimesPlace(self.begin.source, "time", rows)
        found: Times = times_of(cells, one.unit, lambda: self._cells(one, unit, rows).numbers(cells, mark), place)
        if not found.clock and not one.unit:
            messages.append(f"{self.begin.source}: {quoted(one.head.cell)} has no unit; s is assumed.")
        if found.clock:
            messages.append(f"{self.begin.source}: time counts from the first row, {quoted(found.clock)}.")
        return found.seconds

    def _values(
        self,
        found: LogColumn,
        unit: str,
        cells: list[str],
        rows: NDArray[np.int64],
        mark: DecimalMark,
        messages: list[str],
    ) -> NDArray[np.float64]:
        reader = self._cells(found, unit, rows)
        raw = Cells(self.begin.source, rows, Place(found.head.at, reader.column)).numbers(cells, mark)
        for value in (*found.missing, *_sentinels(raw)):
            where = raw == value
            if np.any(where):
                raw[where] = math.nan
                said = f"{quoted(found.head.cell)} is {value:g} in {count_of(np.sum(where))}, taken as no value"
                messages.append(f"{self.begin.source}: {said}.")
        return reader.place.converted(raw)


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
