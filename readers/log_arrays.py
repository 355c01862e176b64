"""A log as columns of a binary file: numbers, dates, durations or text, which are read when they are used.

Columns in one group of the file that have as many rows are a base, with a time of its own. Columns without a time have
that of the group around theirs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from readers.column_names import NUMBERED
from readers.columns import Cells, Column, DecimalMark, Place, TableError
from readers.decimal_numbers import is_decimal
from readers.log_columns import Head, LogColumn, head_of, time_of
from readers.log_text import MISSING, MOST_ROWS, SAMPLE
from readers.log_times import Times, TimesPlace, times_of, times_of_array
from readers.text import FileError, quoted, shown
from readers.units import unit_like

#: Most values of the columns that are used.
MOST_VALUES = 250_000_000
#: Values of a column as a file has them: an array, or text.
Values = NDArray[Any] | list[str]


@dataclass(frozen=True)
class RawColumn:
    """A column of a file.

    Attributes
    ----------
    name, unit : str
        As in the file. The unit may be empty.
    size : int
        Number of its rows.
    read : callable
        Returns its first values; None: all of them.
    path : tuple of str
        Groups of the file around it.
    unusable : str
        Why it cannot be a column, for a message; "": it can.
    """

    name: str
    unit: str
    size: int
    read: Callable[[int | None], Values] = field(repr=False)
    path: tuple[str, ...] = ()
    unusable: str = ""


class ArrayLog:
    """A log in a binary file. Attributes and methods are those of `LogSource`.

    program: of the format, for messages.
    """

    def __init__(self, source: str, program: str, raw: Sequence[RawColumn]) -> None:
        self.source = self.place = source
        self._program, self._raw = program, raw
        names = [column.name for column in raw]
        self.heads = [_head(at, column, names.count(column.name) > 1, source) for at, column in enumerate(raw)]
        self.unusable = {head.at: kind for head in self.heads if (kind := self._kind(raw[head.at]))}

    def _kind(self, raw: RawColumn) -> str:
        """Return why a column holds no numbers, by its first rows with values; "" if it does."""
        if raw.unusable or not raw.size:
            return raw.unusable or "no values"
        kind = _kind_of(self._read(raw, SAMPLE))
        begins_late = kind == "no values" and SAMPLE < raw.size <= MOST_ROWS
        return _kind_of(self._read(raw)) if begins_late else kind

    def _read(self, raw: RawColumn, count: int | None = None) -> Values:
        """Return values of a column. Raises FileError, also for an error of the package that reads the format."""
        try:
            return raw.read(count)
        except FileError:
            raise
        except Exception as error:
            raise damaged(self.source, self._program, error) from error

    def bases(self, columns: Sequence[LogColumn]) -> list[ArrayRows]:
        """Return the rows of each base with columns that are used. Raises TableError."""
        times = [column for column in columns if column.variable == "time"]
        found: dict[LogColumn, list[LogColumn]] = {}
        for column in columns:
            if column.variable != "time":
                found.setdefault(self._time_of(column.head, times), []).append(column)
        used = found or {time: [] for time in times[:1]}
        return [self.rows([time, *others]) for time, others in used.items()]

    def _time_of(self, head: Head, times: Sequence[LogColumn]) -> LogColumn:
        if (found := time_of(head, times)) is not None:
            return found
        if reason := self._raw[head.at].unusable:
            raise TableError(f"{self.source}: the column {quoted(head.cell)} must have numbers; it is {reason}.")
        there = ", ".join(f"{quoted(one.head.cell)} has {one.head.base[1]}" for one in times[:4])
        raise TableError(
            f"{self.source}: the column {quoted(head.cell)} must have a time with as many values, {head.base[1]}; "
            f'{there}. Name its time in a map (--columns, columns=), as "t2" = "time", or leave the column out by '
            "false."
        )

    def rows(self, columns: Sequence[LogColumn]) -> ArrayRows:
        """Return the rows of columns that have as many. Raises TableError, FileError."""
        size = columns[0].head.base[1]
        if size > MOST_ROWS or size * len(columns) > MOST_VALUES:
            limit = f"{MOST_ROWS} rows and {MOST_VALUES} values"
            got = f"{size} rows of {len(columns)} columns"
            raise TableError(f"{self.source} must have at most {limit}; it has {got}. Split it.")
        values = {column: self._read(self._raw[column.head.at]) for column in columns}
        for column, one in values.items():
            if len(one) != size:
                got = f"{quoted(column.head.cell)} has {len(one)} values, {size} are declared"
                raise damaged(self.source, self._program, ValueError(got))
        return ArrayRows(self.source, columns, values)


def _kind_of(values: Values) -> str:
    """Return why values are not numbers; "" if they are."""
    if isinstance(values, list):
        cells = [cell for cell in values if cell.casefold() not in MISSING]
        return "" if any(is_decimal(cell) for cell in cells) else "text" if cells else "no values"
    if values.dtype.kind in "mM":
        return "times"
    return "no values" if values.dtype.kind == "f" and not np.any(~np.isnan(values)) else ""


def damaged(source: str, program: str, error: BaseException) -> FileError:
    """Return the error for a file that the package of its format cannot read."""
    reason = (str(error).strip().splitlines() or [""])[0][:200] or type(error).__name__
    return FileError(f"{source} cannot be read as {program} ({shown(reason, 200)}). Export it again.")


def _head(at: int, raw: RawColumn, is_repeated: bool, source: str) -> Head:
    """Return the head of a column, named with its groups if its name is not unique. Raises TableError."""
    head, unit = head_of(at, raw.name), unit_like(raw.unit) or raw.unit.strip()
    if unit and NUMBERED.fullmatch(raw.name):
        head = Head(at, raw.name, raw.name, "")
    if unit and head.unit and unit != head.unit:
        got = f"{quoted(head.unit)} in its name and {quoted(unit)} beside it"
        raise TableError(f"{source}: the column {quoted(raw.name)} must have one unit; got {got}. Correct one.")
    cell = "/".join([*raw.path, raw.name]) if is_repeated else raw.name
    return Head(at, cell, head.name, head.unit or unit, (raw.path, raw.size))


@dataclass(frozen=True)
class ArrayRows:
    """The rows of a base, with the values of the columns that are used. Methods are those of `LogRows`."""

    source: str
    columns: Sequence[LogColumn]
    values: dict[LogColumn, Values]

    @property
    def places(self) -> NDArray[np.int64]:
        """Number of each row, from 1."""
        return np.arange(1, len(self.values[self.columns[0]]) + 1)

    def times(self, column: LogColumn, factor: Callable[[], tuple[float, float]]) -> Times:
        """Return the times of a column; factor: from its unit to s, for numbers. Raises TableError."""
        values, place = self.values[column], TimesPlace(self.source, column.head.cell, self.places)
        if isinstance(values, list):
            return times_of(_cells(values), column.unit, lambda: self._text(column, values, "s", factor()), place)
        return times_of_array(values, column.unit, lambda numbers: numbers * factor()[0] / factor()[1], place)

    def numbers(self, column: LogColumn, unit: str) -> NDArray[np.float64]:
        """Return the numbers of a column in the unit of the file. Raises TableError."""
        values = self.values[column]
        if isinstance(values, list):
            return self._text(column, values, unit, (1.0, 1.0))
        place = TimesPlace(self.source, column.head.cell, self.places)
        if values.dtype.kind not in "biuf":
            raise place.refusal(0, f"the value must be a number; got {shown(values[0])}. Give another column.")
        found = values.astype(np.float64)  # a copy, as missing values are marked in it
        for row in np.flatnonzero(np.isinf(found))[:1].tolist():
            raise place.refusal(row, f"the value must be finite; got {found[row]}. Correct it.")
        return found

    def check(self) -> None:
        """Do nothing: numbers have one reading."""

    def _text(
        self, column: LogColumn, values: Sequence[str], unit: str, both: tuple[float, float]
    ) -> NDArray[np.float64]:
        place = Place(column.head.at, Column(column.variable, unit, filled=False), both)
        mark = DecimalMark(self.source)
        found = Cells(self.source, self.places, place).numbers(_cells(values), mark)
        if mark.shown and not mark.decimal:
            mark.check_thousands(";")
        return found


def _cells(values: Sequence[str]) -> list[str]:
    return ["" if cell.strip().casefold() in MISSING else cell.strip() for cell in values]
