"""A log as a table of text (`readers/tables.py`): its names, its units, and the values of the columns that are used."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from readers.columns import Cells, Column, DecimalMark, Place, TableError
from readers.decimal_numbers import THOUSANDS, is_decimal
from readers.log_columns import Head, LogColumn, head_of
from readers.log_times import Times, TimesPlace, times_of
from readers.tables import Begin, TableRows, begin_of
from readers.text import quoted, text_of
from readers.units import unit_like

#: Words of a cell that stand for a missing value, in small letters.
MISSING = {"", "nan", "n/a", "na", "#n/a", "#nv", "null", "none", "nil", "-", "--", "---", "?"}
#: Rows by which columns of text are found.
SAMPLE = 200
MOST_ROWS = 4_000_000
#: Minutes and seconds of a clock; a decimal mark and digits may follow.
CLOCK_DIGITS = r":\d\d:\d\d"


class TextLog:
    """A log that is text. Attributes and methods are those of `LogSource`."""

    def __init__(self, path: str | Path, by_position: Sequence[str] = ()) -> None:
        self.source = str(path)
        self.heads, self._begin, at = _heads(begin_of(text_of(path), self.source), by_position)
        self.place = f"{self.source}, row {at}"
        self.unusable = _texts(self.heads, self._begin)

    def bases(self, columns: Sequence[LogColumn]) -> list[TextRows]:
        """Return the rows, all on one time. Raises TableError."""
        return [self.rows(columns)]

    def rows(self, columns: Sequence[LogColumn]) -> TextRows:
        """Return the rows. Raises TableError."""
        return TextRows.of(self._begin, columns)


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
    """Return the places of columns that hold text in the first rows with values, or nothing, each with this word."""
    found: dict[int, list[str]] = {head.at: [] for head in heads}
    count = 0
    for count, (_, row) in enumerate(begin.rows_behind(), 1):
        sought = [at for at, cells in found.items() if count <= SAMPLE or not cells]
        if not sought:
            break
        for at in sought:
            found[at] += [cell for cell in row[at : at + 1] if cell.casefold() not in MISSING]
    numbers = {at for at, cells in found.items() if any(is_decimal(cell) for cell in cells)}
    return {at: "text" if cells else "no values" for at, cells in found.items() if count and at not in numbers}


@dataclass
class TextRows:
    """The rows of a log, with the cells of the columns that are used. Methods are those of `LogRows`."""

    begin: Begin
    columns: Sequence[LogColumn]
    places: NDArray[np.int64]
    cells: dict[LogColumn, list[str]]
    mark: DecimalMark = field(init=False)

    def __post_init__(self) -> None:
        self.mark = DecimalMark(self.begin.source)

    @classmethod
    def of(cls, begin: Begin, columns: Sequence[LogColumn]) -> TextRows:
        """Return the rows after the names. Raises TableError."""
        width = len(begin.cells)
        nameless = {at for at, cell in enumerate(begin.cells) if at and not cell}  # the first may number the rows
        places: list[int] = []
        cells: list[list[str]] = [[] for _ in columns]
        for number, row in begin.rows_behind():
            extra = next((at for at, cell in enumerate(row) if cell and at in nameless), None)
            if extra is not None or any(row[width:]):
                at = width + [bool(cell) for cell in row[width:]].index(True) if extra is None else extra
                body = TableRows(begin.source, begin.separator, MOST_ROWS)
                raise body.nameless(number, at, row[at], width - len(nameless))
            if len(places) == MOST_ROWS:
                raise TableError(f"{begin.source} must have at most {MOST_ROWS} rows; it has more. Split it.")
            places.append(number)
            for one, column in zip(columns, cells, strict=True):
                cell = row[one.head.at] if one.head.at < len(row) else ""
                column.append("" if cell.casefold() in MISSING else cell)
        return cls(begin, columns, np.array(places, np.int64), dict(zip(columns, cells, strict=True)))

    def times(self, column: LogColumn, factor: Callable[[], tuple[float, float]]) -> Times:
        """Return the times of a column; factor: from its unit to s, for numbers. Raises TableError."""
        cells, place = self.cells[column], TimesPlace(self.begin.source, "time", self.places)
        return times_of(cells, column.unit, lambda: self._numbers(column, "s", factor()), place)

    def numbers(self, column: LogColumn, unit: str) -> NDArray[np.float64]:
        """Return the numbers of a column in the unit of the file. Raises TableError."""
        return self._numbers(column, unit, (1.0, 1.0))

    def check(self) -> None:
        """Check, after all numbers were read, that they have one reading. Raises TableError."""
        self.mark.decimal = self.mark.decimal or self._has_decimal()
        self.mark.check_thousands(self.begin.separator)

    def _numbers(self, column: LogColumn, unit: str, both: tuple[float, float]) -> NDArray[np.float64]:
        place = Place(column.head.at, Column(column.variable, unit, filled=False), both)
        return Cells(self.begin.source, self.places, place).numbers(self.cells[column], self.mark)

    def _has_decimal(self) -> bool:
        """Return whether a cell of any column, such as a clock, has the mark of the numbers as a decimal one."""
        sign = "," if "," in self.mark.shown else "."
        cells = (cell for _, row in self.begin.rows_behind() for cell in row if sign in cell)
        decimals = re.compile(rf"{CLOCK_DIGITS}{re.escape(sign)}\d")
        return bool(self.mark.shown) and any(
            decimals.search(cell) or (is_decimal(cell) and not THOUSANDS.fullmatch(cell)) for cell in cells
        )
