"""Logs of users: one reader for fits, replays and scenarios.

A log is a table (`readers/tables.py`) as a logger writes it. Its columns get names of variables by a map, or by names
and units that loggers use (`log_columns.py`); times may be those of a clock (`rows.py`). Text, empty columns and
columns of other names are left out. Empty cells, `NaN` and numbers such as -999 that stand for a missing value are NaN.
A message tells each guess, each conversion that is not plain, and all that is left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from readers.log_columns import ColumnMap, Found, Head, Naming, factor_of, head_of
from readers.log_times import Place as PlaceOfTimes
from readers.log_times import Times, times_of
from readers.log_words import unit_like
from readers.tables import Begin, Body, Cells, Column, DecimalMark, Place, TableError, begin_of, number_in, unit_factor
from readers.text import quoted, shown, text_of

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
#: A step between rows is told as a gap from so many times the median step on.
GAP = 5.0
#: Longest bridged gap of an input, in median steps, and the least [s].
BRIDGED_STEPS, BRIDGED = 10.0, 2.0
#: Ratios of a wheel's speed to the vehicle's that show a wrong unit, their relative width, and least speeds [m/s].
WRONG = {"it were in km/h": 3.6, "it were in mph": 2.2369, "speed were in km/h": 1 / 3.6, "speed were in mph": 0.44704}
NEAR, MOVES = 0.03, 1.0
#: Share of an interval by which rounded times may be before its begin.
ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Log:
    """A log: columns by the names of variables, in their units.

    Attributes
    ----------
    source : str
        Its path, for messages.
    numbers : dict
        Columns by name, shape (rows,), `time` first and increasing; NaN: no value.
    units : dict
        Their units.
    places : array of int, shape (rows,)
        Number of each row as an editor shows it.
    messages : list of str
        What was guessed, converted and left out, one line each.
    """

    source: str
    numbers: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    places: NDArray[np.int64] = field(repr=False)
    messages: list[str] = field(default_factory=list)

    def refusal(self, row: int, column: str, text: str) -> TableError:
        """Return the error for a value; `row` is numbered from 0, `text` gives limit, value and remedy."""
        return TableError(f"{self.source}, row {self.places[row]}, column {shown(column)}: {text}")

    def rows(self, keep: NDArray[np.bool_]) -> Log:
        """Return the log with some of its rows."""
        numbers = {name: values[keep] for name, values in self.numbers.items()}
        return Log(self.source, numbers, self.units, self.places[keep], self.messages)


def read_log(
    path: str | Path,
    variables: Mapping[str, str],
    columns: ColumnMap | None = None,
    *,
    others: bool = False,
    by_position: Sequence[str] = (),
) -> Log:
    """Read a log.

    Parameters
    ----------
    path : str or Path
        The file.
    variables : mapping of str to str
        Units of the variables that it may have, by name; `time` [s] is always among them.
    columns : mapping, str or Path, optional
        A map of names (`log_columns.py`), or its TOML file.
    others : bool
        Whether other columns of numbers are kept, in the units of the file.
    by_position : sequence of str
        Names of the columns in their order, for a file without names or with none that is known.

    Raises
    ------
    TableError
        If it cannot be read as it is meant; the message names file, row, column, value and remedy.
    FileError
        If a file is not readable as text.
    """
    source, variables = str(path), {"time": "s"} | dict(variables)
    heads, begin, names_at = _heads(begin_of(text_of(path), source), by_position)
    place = f"{source}, row {names_at}"
    texts = _texts(heads, begin)
    naming = Naming(place, variables, texts, others)
    found, out = naming.found(heads, columns)
    if not found and len(heads) == len(by_position):
        found = [Found(head, name, head.unit) for head, name in zip(heads, by_position, strict=True)]
    if not any(one.variable == "time" for one in found):
        there = quoted(", ".join(one.cell for one in heads), 200)
        raise TableError(f"{place}: the column time is missing; there are {there}. Add it, or name it in a map.")
    used = {one.head.at for one in found}
    if others:
        rest = [head for head in heads if head.at not in used | out | set(texts)]
        found += [Found(head, head.name, head.unit or "1") for head in rest]
        used |= {head.at for head in rest}
    messages = [*_guesses(source, found, variables), *_left_out(source, heads, used, out, texts)]
    return _in_order(_Reading(place, begin, variables, found).log(messages))


def _heads(begin: Begin, by_position: Sequence[str]) -> tuple[list[Head], Begin, int]:
    """Return the names of the columns, the begin of the rows behind them, and their row. Raises TableError."""
    place = f"{begin.source}, row {begin.at}"
    if not all(number_in(cell) for cell in begin.cells if cell):
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
        if all(number_in(cell) for cell in found.cells if cell):
            return begin
    return found


def _with_units(heads: list[Head], begin: Begin) -> tuple[list[Head], Begin]:
    """Return the heads with the units of the row after the names, if that row has units alone, and the rest."""
    at, cells = next(begin.rows_behind(), (0, []))
    units = {place: cell.strip("[]()") for place, cell in enumerate(cells) if cell}
    words = {"-", "1", "text", "iso", "utc"}
    known = [one for one in units.values() if unit_like(one) or one.lower() in words]
    if not at or len(known) < len(units) or not any(unit_like(one) and not number_in(one) for one in known):
        return heads, begin
    named = [Head(one.at, one.cell, one.name, one.unit or unit_like(units.get(one.at, "")) or "") for one in heads]
    return named, Begin(begin.source, begin.lines, begin.separator, at, begin.cells)


def _texts(heads: Sequence[Head], begin: Begin) -> dict[int, str]:
    """Return the places of columns that hold text or nothing in the first rows, each with this word."""
    rows = [cells for (_, cells), _ in zip(begin.rows_behind(), range(SAMPLE), strict=False)]
    found = {}
    for head in heads:
        cells = [row[head.at] for row in rows if head.at < len(row) and row[head.at].casefold() not in MISSING]
        if rows and not any(number_in(cell) for cell in cells):
            found[head.at] = "text" if cells else "no values"
    return found


def _guesses(source: str, found: Sequence[Found], variables: Mapping[str, str]) -> list[str]:
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
    rest = [one for one in heads if one.at not in used | out]
    names = [f"{quoted(one.cell)} ({texts.get(one.at, 'no variable')})" for one in rest]
    more = f" and {len(names) - 12} more" if len(names) > 12 else ""
    return [f"{source}: left out {', '.join(names[:12])}{more}."] if names else []


@dataclass(frozen=True)
class _Reading:
    """Reads the values of the columns that are used."""

    place: str
    begin: Begin
    variables: Mapping[str, str]
    found: Sequence[Found]

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
                body = Body(self.begin.source, self.begin.separator, MOST_ROWS)
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
        mark.check_thousands(self.begin.separator)
        names = ["time", *(one for one in numbers if one != "time")]
        ordered = {name: numbers[name] for name in names}
        return Log(self.begin.source, ordered, {name: units[name] for name in names}, rows, messages)

    def _cells(self, one: Found, unit: str, rows: NDArray[np.int64]) -> Cells:
        column = Column(one.variable, unit, filled=False)
        both = factor_of(one, unit, self.place) or unit_factor(column, one.unit, self.place)
        return Cells(self.begin.source, rows, Place(one.head.at, column, both))

    def _times(
        self, one: Found, unit: str, cells: list[str], rows: NDArray[np.int64], mark: DecimalMark, messages: list[str]
    ) -> NDArray[np.float64]:
        place = PlaceOfTimes(self.begin.source, "time", rows)
        found: Times = times_of(cells, one.unit, lambda: self._cells(one, unit, rows).numbers(cells, mark), place)
        if not found.clock and not one.unit:
            messages.append(f"{self.begin.source}: {quoted(one.head.cell)} has no unit; s is assumed.")
        if found.clock:
            messages.append(f"{self.begin.source}: time counts from the first row, {quoted(found.clock)}.")
        return found.seconds

    def _values(
        self, one: Found, unit: str, cells: list[str], rows: NDArray[np.int64], mark: DecimalMark, messages: list[str]
    ) -> NDArray[np.float64]:
        reader = self._cells(one, unit, rows)
        raw = Cells(self.begin.source, rows, Place(one.head.at, reader.column)).numbers(cells, mark)
        for value in (*one.missing, *_sentinels(raw)):
            where = raw == value
            if np.any(where):
                raw[where] = math.nan
                said = f"{quoted(one.head.cell)} is {value:g} in {_rows(np.sum(where))}, taken as no value"
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
    below, above = [one < low - span for one in SENTINELS], [many and one > high + span for one in SENTINELS]
    far = [one for one, *sides in zip(SENTINELS, below, above, strict=True) if any(sides)]
    return [one for one in far if np.any(values == one)]


def _in_order(log: Log) -> Log:
    """Return the log without rows that have no time or repeat the row before, and tell gaps and missing values.

    Raises
    ------
    TableError
        If there are fewer than two rows, or the time does not grow.
    """
    timed = np.isfinite(log.numbers["time"])
    if not np.all(timed):
        log.messages.append(f"{log.source}: left out {_rows(np.sum(~timed))} without a time.")
        log = log.rows(timed)
    table = np.array(list(log.numbers.values()))
    same = np.all((table[:, 1:] == table[:, :-1]) | (np.isnan(table[:, 1:]) & np.isnan(table[:, :-1])), axis=0)
    again = np.concatenate([[False], same]) if table.shape[1] else np.zeros(0, bool)
    if np.any(again):
        first = log.places[np.argmax(again)]
        log.messages.append(f"{log.source}: left out {_rows(np.sum(again))} equal to the row before, as row {first}.")
        log = log.rows(~again)
    time = log.numbers["time"]
    if time.size < 2:
        raise TableError(f"{log.source} must have at least 2 rows of values; it has {time.size}. Add rows.")
    _check_growth(log, np.diff(time))
    _check_speeds(log)
    log.messages.extend(_gaps(log, np.diff(time)))
    return log


def _rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count} rows"


def _check_growth(log: Log, steps: NDArray[np.float64]) -> None:
    bad = np.flatnonzero(~(steps > 0.0))
    if not bad.size:
        return
    row, time = int(bad[0]), log.numbers["time"]
    remedy = "Sort the rows, or remove this one."
    if np.sum(steps == 0.0) > 1 and np.all(steps >= 0.0):
        remedy = f"{np.sum(steps == 0.0)} rows repeat a time: export it with more digits."
    raise TableError(
        f"{log.source}, row {log.places[row + 1]}, column time: values must grow from row to row; got "
        f"{time[row + 1]:.12g} s after {time[row]:.12g} s. {remedy}"
    )


def _check_speeds(log: Log) -> None:
    """Check that no wheel turns as if its speed or the vehicle's were in another unit."""
    wheels = [name for name in log.numbers if name.startswith("wheel_speed_")] if "speed" in log.numbers else []
    for name in wheels:
        wheel, speed = log.numbers[name], log.numbers["speed"]
        moves = (wheel > MOVES) & (speed > MOVES)
        ratio = float(np.median(wheel[moves] / speed[moves])) if np.any(moves) else 1.0
        for unit in (one for one, size in WRONG.items() if abs(ratio / size - 1.0) < NEAR):
            raise TableError(
                f"{log.source}: {name} must be near speed; got {ratio:.3g} times as much in the median, as if {unit}. "
                "Name the units, as in speed [km/h]."
            )


def _gaps(log: Log, steps: NDArray[np.float64]) -> list[str]:
    """Return the lines on gaps in time and on missing values."""
    said = []
    usual = float(np.median(steps))
    wide = np.flatnonzero(steps > GAP * usual)
    if wide.size:
        at = int(np.argmax(steps))
        count = "1 gap" if wide.size == 1 else f"{wide.size} gaps"
        said.append(
            f"{log.source}: {count} between rows, the longest {steps[at]:.4g} s after row {log.places[at]}; the usual "
            f"step is {usual:.4g} s."
        )
    for name, values in log.numbers.items():
        if empty := int(np.sum(np.isnan(values))):
            said.append(f"{log.source}: {shown(name)} has no value in {empty} of {values.size} rows.")
    return said


def filled(
    clock: NDArray[np.float64], values: NDArray[np.float64], name: str, longest: float | None = None
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return times and values of an input without its missing values.

    Parameters
    ----------
    clock, values : array, shape (rows,)
        Times [s] and values; NaN: none.
    name : str
        Name of the input, for messages.
    longest : float, optional
        Longest bridged gap [s]; by default ten median steps, and at least 2 s.

    Raises
    ------
    TableError
        If a gap is longer, or there are fewer than two values.
    """
    there = np.isfinite(values)
    times = clock[there]
    if times.size < 2:
        raise TableError(f"{name} must have at least 2 values; it has {times.size}. Check the column.")
    if longest is None:
        longest = max(BRIDGED, BRIDGED_STEPS * float(np.median(np.diff(clock))))
    steps = np.diff(np.concatenate([clock[:1], times, clock[-1:]]))
    if np.max(steps) > longest:
        at = int(np.argmax(steps))
        since = clock[0] if at == 0 else times[at - 1]
        raise TableError(
            f"{name} must have no gap above {longest:g} s, as it drives the run; got one of {steps[at]:.4g} s after "
            f"{since:.6g} s. Cut the log there, or allow it (--longest-gap, longest_gap=)."
        )
    return times, values[there]


def averaged(rows: NDArray[np.float64], interval: float) -> NDArray[np.float64]:
    """Return means of rows over intervals from the first row on.

    Parameters
    ----------
    rows : array, shape (rows, columns)
        Times [s] in the first column; NaN: no value.
    interval : float
        [s]

    Returns
    -------
    array, shape (intervals with rows, columns)
        Means of times and of the values that there are.
    """
    bins = np.floor((rows[:, 0] - rows[0, 0]) / interval + ROUNDING).astype(np.int64)
    starts = np.flatnonzero(np.concatenate([[True], np.diff(bins) > 0]))
    there = np.isfinite(rows)
    count = np.add.reduceat(there.astype(float), starts)
    total = np.add.reduceat(np.where(there, rows, 0.0), starts)
    return np.divide(total, count, out=np.full(total.shape, math.nan), where=count > 0)
