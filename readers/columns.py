"""A column of a table: its unit and limits, and the numbers and words in its cells."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from readers.column_words import EITHER, plain
from readers.decimal_numbers import MINUS, NUMBER, THOUSANDS, of_thousands
from readers.text import FileError, quoted, shown
from readers.units import AMBIGUOUS, different_units, factor, quantity_of, unit_like
from readers.usual import likely_unit

#: Largest number of characters in a cell, for columns of free text without a limit of their own.
LONGEST_TEXT = 60
#: Cells that Python's float reads as they are meant.
PLAIN = re.compile(r"[0-9eE+.-]*", re.ASCII)
#: A number with a unit behind it.
WITH_UNIT = re.compile(rf"(?P<number>{NUMBER.pattern})\s*(?P<unit>[^\s\d+.,-].*)", re.ASCII)


class TableError(FileError):
    """A table that cannot be read; the message names file, row, column, value, limit and remedy."""


@dataclass(frozen=True)
class Column:
    """A column that a reader accepts.

    Attributes
    ----------
    name : str
        Its name.
    unit : str
        The unit of its values in memory; "1" for a pure number.
    minimum, maximum : float
        Limits in that unit, both included.
    required : bool
        Whether the table must have it.
    filled : bool
        Whether every row must have a value; otherwise an empty cell is NaN, or an empty string.
    words : tuple of str
        Allowed words of a column of words; empty: it holds numbers.
    whole : bool
        Whether its numbers are integers.
    text : bool
        Whether it holds any printable text instead of numbers.
    remedies : tuple of (str, str)
        Words that are not allowed, and what a message says to do instead.
    longest : int
        Largest number of characters in a cell of such a column.
    meanings : tuple of (str, str)
        Further spellings of words, as `plain` returns them, each with its word.
    as_written : bool
        Whether files may write it as people do: a unit after the name without brackets or after the number in a
        cell, units and words in any case.
    """

    name: str
    unit: str = "1"
    minimum: float = -math.inf
    maximum: float = math.inf
    required: bool = False
    filled: bool = True
    words: tuple[str, ...] = ()
    whole: bool = False
    text: bool = False
    remedies: tuple[tuple[str, str], ...] = ()
    longest: int = LONGEST_TEXT
    meanings: tuple[tuple[str, str], ...] = ()
    as_written: bool = False

    def word_of(self, cell: str) -> str | None:
        """Return the allowed word of a cell, None if it has none."""
        if cell in self.words:
            return cell
        return (
            {**dict(self.meanings), **{plain(word): word for word in self.words}}.get(plain(cell))
            if (self.as_written)
            else None
        )

    @property
    def holds_words(self) -> bool:
        """Whether it holds words or text instead of numbers."""
        return bool(self.words) or self.text


@dataclass(frozen=True)
class Place:
    """A column of the file: its place in a row, its definition, the factor to its unit.

    word: its name in the file if that is German or French.
    """

    at: int
    column: Column
    factor: tuple[float, float] = (1.0, 1.0)
    word: str = ""

    def converted(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return values of the file in the column's unit."""
        up, down = self.factor
        return values if up == down == 1.0 else values * up / down

    def allows(self, values: NDArray[np.float64]) -> bool:
        """Return whether all values are within the column's limits and, where they must be, whole."""
        inside = np.all((values >= self.column.minimum) & (values <= self.column.maximum))
        return bool(inside and (not self.column.whole or np.all(values == np.floor(values))))


def number_and_unit(cell: str) -> tuple[str, str]:
    """Return the number of a cell and the unit behind it, or the cell and no unit."""
    match = None if NUMBER.fullmatch(cell) else WITH_UNIT.fullmatch(cell)
    return (match["number"], match["unit"].strip()) if match else (cell, "")


def word_read_as(cell: str, name: str, word: str) -> str:
    """Return the message of an account about a cell that is read as another word."""
    return f"{quoted(cell)} is read as {name} = {word}"


def unit_factor(column: Column, unit: str, place: str) -> tuple[float, float]:
    """Return the factor from a unit of a file to the column's, as `factor` returns it. Raises TableError."""
    if column.holds_words and unit:
        raise TableError(
            f"{place}: the column {column.name} holds words and has no unit; got {quoted(unit)}. Remove it."
        )
    if not unit or unit == column.unit:
        return 1.0, 1.0
    both = factor(unit, column.unit)
    if both is None and unit.casefold() in AMBIGUOUS:
        raise TableError(
            f"{place}: the unit {quoted(unit)} of {shown(column.name)} can be several. {AMBIGUOUS[unit.casefold()]}"
        )
    if both is None:
        kind = "unknown" if quantity_of(unit) is None else "of another quantity"
        units = ", ".join(different_units(column.unit))
        raise TableError(
            f"{place}: the unit {quoted(unit)} of {shown(column.name)} is {kind}. "
            f"Use {units}; none means {column.unit}."
        )
    return both


@dataclass
class DecimalMark:
    """The decimal mark of a file, once a number has shown it: that number, its row and column.

    decimal: whether a number has shown that the mark does not separate thousands, as in 1,000.
    """

    source: str
    shown: str = ""
    row: int = 0
    column: str = ""
    decimal: bool = False

    def check(self, cell: str, row: int, column: str) -> None:
        """Check that a number has the file's decimal mark."""
        if self.shown and ("," in cell) != ("," in self.shown):
            raise TableError(
                f"{self.source}, row {row}, column {shown(column)}: numbers must have one decimal mark; got "
                f"{quoted(cell)}, and {quoted(self.shown)} in row {self.row}. Use one, and no separators of thousands."
            )
        self.shown, self.row, self.column = self.shown or cell, self.row or row, self.column or column
        self.decimal = self.decimal or not THOUSANDS.fullmatch(cell)

    def check_thousands(self, separator: str) -> None:
        """Check that not every number with the mark can be one of thousands, where people write those with it."""
        if self.shown and not self.decimal and ("," in self.shown or separator == ";"):
            whole, part = re.sub("[.,]", "", self.shown), float(self.shown.replace(",", "."))
            raise TableError(
                f"{self.source}, row {self.row}, column {shown(self.column)}: numbers must have one reading; "
                f"{quoted(self.shown)} can be {whole} or {part:g}, and so can all with this mark. Write {whole}, or "
                f"{part!r} with a decimal point in a file with commas or tabs."
            )


@dataclass(frozen=True)
class Cells:
    """The cells of one column, to be read."""

    source: str
    places: NDArray[np.int64]
    place: Place

    @property
    def column(self) -> Column:
        """The definition of the column."""
        return self.place.column

    def refusal(self, row: int, text: str) -> TableError:
        """Return the error for a value; `row` is numbered from 0."""
        return TableError(f"{self.source}, row {self.places[row]}, column {shown(self.column.name)}: {text}")

    def words(self, cells: Sequence[str]) -> list[str]:
        """Return the words of the column. Raises TableError if one is not allowed."""
        choice = self.column.words
        for row, cell in enumerate(cells):
            if self.column.text and (len(cell) > self.column.longest or not cell.isprintable()):
                limit = f"the text must be printable, at most {self.column.longest} characters"
                raise self.refusal(row, f"{limit}; got {quoted(cell)}. Shorten it.")
            if not self.column.text and self.column.word_of(cell) is None and (cell or self.column.filled):
                remedy = dict(self.column.remedies).get(plain(cell), self._choose)
                raise self.refusal(row, f"the value must be one of {', '.join(choice)}; got {quoted(cell)}. {remedy}")
        return [self.column.word_of(cell) or cell for cell in cells]

    @property
    def _choose(self) -> str:
        """Return the remedy for a word that is not allowed."""
        if plain(self.place.word) not in EITHER:
            return "Choose one."
        return f"Choose one, or add a column {self.column.name}: {quoted(self.place.word)} is then the name."

    def numbers(self, cells: Sequence[str], mark: DecimalMark) -> NDArray[np.float64]:
        """Return the numbers of the column in its unit. Raises TableError if one is not valid."""
        values = self._plain(cells, mark)
        if values is None:
            values = np.array([self._number(row, cell, mark) for row, cell in enumerate(cells)], float)
        values = self.place.converted(values)
        low, high = self.column.minimum, self.column.maximum
        for row in np.flatnonzero((values < low) | (values > high))[:1].tolist():
            got = f"{quoted(cells[row])}{self._unit_of(cells[row])}"
            likely = self._likely(cells[row], float(values[row])) or " Check value and unit."
            raise self.refusal(row, f"the value must be {self._limits()}; got {got}.{likely}")
        parts = ~np.isnan(values) & (values != np.floor(values)) & self.column.whole
        for row in np.flatnonzero(parts)[:1].tolist():
            raise self.refusal(row, f"the value must be an integer; got {quoted(cells[row])}. Round it.")
        return values

    def _likely(self, cell: str, value: float) -> str:
        """Return the end of a message about a value outside of the limits: what was likely meant, or nothing."""
        column, (number, unit) = self.column, number_and_unit(cell.replace(MINUS, "-"))
        if thousands := of_thousands(number, unit, value, column.minimum, column.maximum):
            return thousands
        if not unit and self.place.factor == (1.0, 1.0):
            return likely_unit(value, column.unit, column.minimum, column.maximum)
        bare = float(number.replace(",", "."))
        fits = column.minimum <= bare <= column.maximum and column.unit != "1"
        return f" Did you mean {bare:g} {column.unit}?" if fits else ""

    def _plain(self, cells: Sequence[str], mark: DecimalMark) -> NDArray[np.float64] | None:
        """Return the values where every cell is a number with a point, the quick way; None where one is not."""
        if not PLAIN.fullmatch("".join(cells)):
            return None
        try:
            values = np.array([float(cell) for cell in cells], float)
        except ValueError:
            return None
        marked = [next((row for row, cell in enumerate(cells) if "." in cell), None)]
        if marked[0] is not None and not mark.decimal:  # one that decides, if there is one
            marked.append(
                next((row for row, cell in enumerate(cells) if "." in cell and not THOUSANDS.fullmatch(cell)), None)
            )
        for row in marked:
            if row is not None:
                mark.check(cells[row], int(self.places[row]), self.column.name)
        return values if np.all(np.isfinite(values)) else None

    def _number(self, row: int, cell: str, mark: DecimalMark) -> float:
        if not cell and not self.column.filled:
            return math.nan
        number, (up, down) = self._parts(row, cell.replace(MINUS, "-"))
        if not NUMBER.fullmatch(number):
            wrong = "the cell is empty" if not cell else f"got {quoted(cell)}"
            raise self.refusal(row, f"the value must be a number; {wrong}. Write it as 0.015 or 1.5e-2.")
        if "." in number or "," in number:
            mark.check(number, int(self.places[row]), self.column.name)
            number = number.replace(",", ".")
        value = float(number) * up / down
        if not math.isfinite(value):
            raise self.refusal(row, f"the value must be below 1.8e308 in size; got {quoted(cell)}. Check it.")
        return value

    def _parts(self, row: int, cell: str) -> tuple[str, tuple[float, float]]:
        """Return the number of a cell, and the factor of a unit behind it to the unit of the file."""
        number, unit = number_and_unit(cell) if self.column.as_written else (cell, "")
        if not unit:
            return cell, (1.0, 1.0)
        try:
            up, down = unit_factor(self.column, unit_like(unit) or unit, self.source)
        except TableError as error:
            raise self.refusal(row, str(error).removeprefix(f"{self.source}: ")) from None
        return number, (up * self.place.factor[1], down * self.place.factor[0])

    def _limits(self) -> str:
        low, high, unit = self.column.minimum, self.column.maximum, self._of_unit(self.column.unit)
        if math.isinf(high):
            return f"at least {low:g}{unit}"
        return f"from {low:g} to {high:g}{unit}"

    def _unit_of(self, cell: str) -> str:
        """Return the unit of a cell as a message has it; nothing if it is in the cell."""
        both = self.place.factor
        if number_and_unit(cell.replace(MINUS, "-"))[1]:
            return ""
        if both != (1.0, 1.0):
            return f", in the file's unit, 1 of which is {both[0] / both[1]:g}{self._of_unit(self.column.unit)}"
        return self._of_unit(self.column.unit)

    def _of_unit(self, unit: str) -> str:
        return "" if unit == "1" else f" {unit}"
