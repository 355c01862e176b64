"""Tables of users: columns under names with units, or by position. One set of rules for all of them.

A table is text with rows. Columns are separated by tabs, semicolons or commas, and by blanks if the first row has
numbers. Numbers have a decimal point or, unless commas separate columns, a decimal comma; a file has one of the two. A
name may carry its unit, `cant [mm]` or `cant (mm)`, which is converted. Names are not case-sensitive; underscores,
blanks and hyphens are equal in them. Empty rows, rows of separators alone and remarks (`#`, `%`, `!`, `//`) are
ignored. A cell may be in quotes. `fmu_src/runtime/table_file.c` is the twin of this module in C.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from readers.text import BLANK, LONGEST_ROW, FileError, lines_of, quoted, rows_in, shown, text_of
from readers.units import different_units, factor, quantity_of

#: The most names of columns that a message lists.
MOST_NAMES = 20
#: Most rows of a table, unless a caller sets another limit.
MOST_ROWS = 4_000_000
#: Longest text in a cell of a column of texts.
LONGEST_TEXT = 60
#: Rows by which the separator is found where there are no names.
SAMPLE = 50
SEPARATORS = ("\t", ";", ",")
BLANKS = " "
NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
#: A number that may be one of thousands, with a separator between groups of three digits.
THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}", re.ASCII)
#: Cells that Python's float reads as they are meant.
PLAIN = re.compile(r"[0-9eE+.-]*", re.ASCII)
#: A name with its unit in square brackets, and a name with or without its unit in round ones.
HEAD_SQUARE = re.compile(r"(?P<name>[^\[\]]+)\[(?P<unit>[^\[\]]*)\]")
HEAD_ROUND = re.compile(r"(?P<name>[^\[\]()]+)(\((?P<unit>[^()]*)\))?")
#: A row with which some spreadsheets declare their separator.
DECLARED = re.compile(rf"sep=([,;\t|:])[{BLANK}]*", re.IGNORECASE | re.ASCII)
#: A cell in quotes, by its separator; and characters that are equal to an underscore in names.
IN_QUOTES = {
    one: re.compile(rf'[{BLANK.replace(one, "")}]*"((?:[^"]|"")*)"[{BLANK.replace(one, "")}]*({re.escape(one)}|\Z)')
    for one in ("\t", ";", ",", "|", ":")
}
BLANK_RUN = re.compile(f"[{BLANK}]+")
GAP = re.compile(rf"[{BLANK}_-]+")
CAPITALS = str.maketrans({chr(letter): chr(letter + 32) for letter in range(ord("A"), ord("Z") + 1)})
PLAIN_BYTES = b"0123456789eE+-"
#: Lines that are read at once where all cells are plain numbers.
BLOCK = 20_000
MINUS = "\u2212"


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

    @property
    def holds_words(self) -> bool:
        """Whether it holds words or text instead of numbers."""
        return bool(self.words) or self.text


@dataclass(frozen=True, eq=False)
class Table:
    """Content of a file.

    Attributes
    ----------
    source : str
        The path, for messages.
    numbers : dict
        Columns of numbers by name, shape (rows,), in the unit of `units`.
    words : dict
        Columns of words by name, a string a row.
    units : dict
        Unit of each column of numbers.
    places : array of int, shape (rows,)
        Number of each row as an editor or a spreadsheet shows it.
    """

    source: str
    numbers: dict[str, NDArray[np.float64]]
    words: dict[str, list[str]]
    units: dict[str, str]
    places: NDArray[np.int64] = field(repr=False)

    def converted(self, name: str, unit: str) -> NDArray[np.float64]:
        """Return a column of numbers in another unit.

        Raises
        ------
        TableError
            If the column has a unit of another quantity, or an unknown one.
        """
        numerator, denominator = unit_factor(Column(name, unit), self.units[name], self.source)
        return self.numbers[name] * numerator / denominator

    def refusal(self, row: int, column: str, text: str) -> TableError:
        """Return the error for a value; `row` is numbered from 0, `text` gives limit, value and remedy."""
        return TableError(f"{self.source}, row {self.places[row]}, column {shown(column)}: {text}")

    def check_rows(self, least: int = 2) -> None:
        """Check the number of rows.

        Raises
        ------
        TableError
            If there are fewer.
        """
        if self.places.size < least:
            raise TableError(
                f"{self.source} must have at least {least} rows of values; it has {self.places.size}. Add rows."
            )

    def check_growth(self, name: str, least: float = 0.0) -> None:
        """Check that each value of a column is above the one before, by `least` or more if that is above 0.

        Raises
        ------
        TableError
            If one is not.
        """
        values, unit = self.numbers[name], self.units[name]
        steps = np.diff(values)
        bad = np.flatnonzero(~((steps > 0.0) & (steps >= least)))
        if bad.size:
            row, of_unit = int(bad[0]), "" if unit == "1" else f" {unit}"
            limit = f"by at least {least:g}{of_unit}" if least else "from row to row"
            raise self.refusal(
                row + 1,
                name,
                f"values must grow {limit}; got {values[row + 1]:.12g}{of_unit} after {values[row]:.12g}{of_unit}. "
                "Sort the rows, or remove this one.",
            )


def read_table(
    path: str | Path,
    columns: Sequence[Column],
    *,
    others: bool = False,
    by_position: bool = False,
    most_rows: int = MOST_ROWS,
) -> Table:
    """Read a table from a file.

    Parameters
    ----------
    path : str or Path
        The file.
    columns : sequence of Column
        Allowed columns.
    others : bool
        Whether further columns of numbers are kept, each in the unit that its name carries ("1" without one).
    by_position : bool
        Whether the row of names may be missing or hold other names: columns then follow in the order of `columns`.
    most_rows : int
        Largest number of rows of values.

    Raises
    ------
    TableError
        If a name is unknown, missing or repeated, a unit is unknown, or a value is missing, not a number or out of its
        limits.
    FileError
        If the file is not readable as text.
    """
    return table_of(text_of(path), str(path), columns, others=others, by_position=by_position, most_rows=most_rows)


def table_of(
    text: str,
    source: str,
    columns: Sequence[Column],
    *,
    others: bool = False,
    by_position: bool = False,
    most_rows: int = MOST_ROWS,
) -> Table:
    """Read a table from its text, as `read_table` does; source: its name in messages."""
    begin = begin_of(text, source)
    place = f"{source}, row {begin.at}"
    numeric = all(number_in(cell) for cell in begin.cells if cell)
    if numeric and not by_position:
        example = ", ".join(f"{one.name} [{one.unit}]" for one in columns[:3])
        raise TableError(
            f"{place}: the first row must have names; got {quoted(begin.cells[0])}. Add them, as in {example}."
        )
    body = Body(source, begin.separator, most_rows)
    filled = begin.rows_behind()
    if numeric:
        layout = _by_position(place, columns, [""] * len(begin.cells))
        return body.table(layout, [(begin.at, list(begin.cells)), *filled])
    layout = _layout(place, begin.cells, columns, others, by_position)
    return body.plain(layout, begin.lines, begin.at) or body.table(layout, filled)


@dataclass(frozen=True)
class Begin:
    """The begin of a table: its lines, separator, and the number and cells of the first row with content."""

    source: str
    lines: Sequence[str] = field(repr=False)
    separator: str
    at: int
    cells: Sequence[str]

    def rows_behind(self) -> Iterator[tuple[int, list[str]]]:
        """Yield number and cells of each row with content after the first."""
        rows = rows_in(self.lines, self.source, self.at)
        split = ((at, cells_of(row, self.separator, f"{self.source}, row {at}")) for at, row in rows)
        return ((at, cells) for at, cells in split if any(cells))


def begin_of(text: str, source: str) -> Begin:
    """Return the begin of a table by its text.

    Raises
    ------
    TableError
        If the text has no row with content.
    """
    lines = lines_of(text)
    separator, behind = _form_of(lines, source)
    at, cells = next(Begin(source, lines, separator, behind, ()).rows_behind(), (0, []))
    if not cells:
        raise TableError(f"{source} must have a row of names and rows of values; it is empty. Give a table.")
    return Begin(source, lines, separator, at, cells)


def names_of(path: str | Path) -> list[str]:
    """Return the names in the first row of a table, in small letters and without units; empty if it has numbers.

    Raises
    ------
    FileError
        If the file is not readable as text.
    """
    lines = lines_of(text_of(path))
    separator, behind = _form_of(lines, str(path))
    at, row = next(rows_in(lines, str(path), behind), (0, ""))
    cells = [cell for cell in cells_of(row, separator, f"{path}, row {at}") if cell]
    named = [name_and_unit(cell, f"{path}, row {at}")[0] for cell in cells if not number_in(cell)]
    return [tidy(name) for name in named]


def _form_of(lines: Sequence[str], source: str) -> tuple[str, int]:
    """Return the separator of a table, and the number of lines before its first row."""
    first = list(islice(rows_in(lines, source), SAMPLE))
    declared = DECLARED.fullmatch(first[0][1]) if first else None
    first = first[1:] if declared else first
    separator = declared[1] if declared else _separator_of([row for _, row in first])
    return separator, first[0][0] - 1 if first else len(lines)


def cells_of(row: str, separator: str, place: str) -> list[str]:
    """Return the cells of a row without the blanks around them; place: file and row, for messages.

    Raises
    ------
    TableError
        If quotes do not close.
    """
    if separator == BLANKS:
        return [cell for cell in re.split(f"[{BLANK}]+", row) if cell]
    if '"' not in row:
        return [cell.strip(BLANK) for cell in row.split(separator)]
    cells, at, ends = [], 0, False
    while not ends:
        quotes = IN_QUOTES[separator].match(row, at)
        end = row.find(separator, at) if not quotes else -1
        cell = quotes[1].replace('""', '"') if quotes else row[at:end] if end >= 0 else row[at:]
        if not quotes and cell.lstrip(BLANK).startswith('"'):
            raise TableError(f"{place}: quotes must close within the row. Remove the quotes.")
        cells.append(cell.strip(BLANK))
        ends = not quotes[2] if quotes else at + len(cell) == len(row)
        at = quotes.end() if quotes else at + len(cell) + 1
    return cells


def _separator_of(rows: Sequence[str]) -> str:
    """Return the separator of columns.

    For names the first of SEPARATORS in the row, for numbers the one that leaves numbers.
    """
    first = rows[0] if rows else ""
    if any(letter.isalpha() for letter in re.sub(r"\d[eE][+-]?\d", "0", first)):
        bare = re.sub(r'"[^"]*"', "", first)
        return next((one for one in SEPARATORS if one in bare), ",")
    return separator_of_numbers(rows) or next((one for one in SEPARATORS if one in first), BLANKS)


def separator_of_numbers(rows: Sequence[str]) -> str | None:
    """Return the separator of rows of numbers, or None if some hold anything else."""
    for one in (*SEPARATORS, BLANKS):
        parts = [cells_of(row.replace('"', ""), one, "") for row in rows]
        if all(len(cells) > 1 and all(not cell or number_in(cell) for cell in cells) for cells in parts):
            return one
    return None


def number_in(cell: str) -> bool:
    """Return whether a cell holds a number in decimal writing, with a point or a comma."""
    return NUMBER.fullmatch(cell.replace(MINUS, "-")) is not None


def number_of(value: object) -> float:
    """Return a finite number, also one in a text in decimal writing; NaN for all else, `true` among it."""
    if isinstance(value, str):
        value = float(value.replace(MINUS, "-").replace(",", ".")) if number_in(value) else math.nan
    if isinstance(value, bool):
        return math.nan
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return math.nan
    return number if math.isfinite(number) else math.nan


@dataclass(frozen=True)
class Place:
    """A column of the file: its place in a row, its definition, the factor to its unit."""

    at: int
    column: Column
    factor: tuple[float, float] = (1.0, 1.0)

    def converted(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return values of the file in the column's unit."""
        up, down = self.factor
        return values if up == down == 1.0 else values * up / down

    def allows(self, values: NDArray[np.float64]) -> bool:
        """Return whether all values are within the column's limits and, where they must be, whole."""
        inside = np.all((values >= self.column.minimum) & (values <= self.column.maximum))
        return bool(inside and (not self.column.whole or np.all(values == np.floor(values))))


def tidy(name: str) -> str:
    """Return a name as names are compared: small letters, an underscore for blanks, hyphens and underscores."""
    return GAP.sub("_", name).translate(CAPITALS)


def _by_position(place: str, columns: Sequence[Column], units: Sequence[str]) -> list[Place]:
    """Return the first columns in their order; units: as the file has them, a text each, empty where it says none."""
    least = sum(column.required for column in columns)
    if not least <= len(units) <= len(columns):
        need = ", ".join(f"{one.name} [{one.unit}]" for one in columns)
        count = f"{least}" if least == len(columns) else f"{least} to {len(columns)}"
        raise TableError(f"{place}: a row must have {count} values ({need}); got {len(units)}. Correct the row.")
    both = zip(columns, units, strict=False)
    return [Place(at, column, unit_factor(column, unit, place)) for at, (column, unit) in enumerate(both)]


def _layout(
    place: str, cells: Sequence[str], columns: Sequence[Column], others: bool, by_position: bool
) -> list[Place]:
    """Return the columns of a file by its row of names."""
    known = {tidy(column.name): column for column in columns}
    parts = [(at, *name_and_unit(cell, place)) for at, cell in enumerate(cells) if cell]
    if by_position and not any(tidy(name) in known for _, name, _ in parts):
        return _by_position(place, columns, [unit for _, _, unit in parts])
    found: dict[str, Place] = {}
    for at, name, unit in parts:
        column = known.get(tidy(name))
        if column is None and not others:
            raise TableError(f"{place}: the column {quoted(name)} is unknown. {advice(name, known, columns)}")
        column = column or Column(name, unit or "1")
        if tidy(column.name) in found:
            raise TableError(
                f"{place}: the column {shown(column.name)} must be there once; it is there twice. Remove one."
            )
        found[tidy(column.name)] = Place(at, column, unit_factor(column, unit, place))
    for key, column in known.items():
        if column.required and key not in found:
            there = ", ".join(one.column.name for one in found.values()) or "none"
            raise TableError(f"{place}: the column {column.name} is missing; there are {quoted(there, 200)}. Add it.")
    return list(found.values())


def name_and_unit(cell: str, place: str) -> tuple[str, str]:
    """Return name and unit, or "", of a cell in the row of names; place: file and row. Raises TableError."""
    match = HEAD_SQUARE.fullmatch(cell) or HEAD_ROUND.fullmatch(cell)
    name = BLANK_RUN.sub(" ", match["name"]).strip(" ") if match else ""
    unit = (match["unit"] or "").strip(BLANK) if match else ""
    if not name or not (name + unit).isprintable():
        raise TableError(
            f"{place}: a column must have a name, and its unit in brackets; got {quoted(cell)}. Write speed [m/s]."
        )
    return name, unit


def advice(name: str, known: Collection[str], columns: Sequence[Column]) -> str:
    """Return the end of the message for an unknown column: the nearest of the known tidy names, or the first."""
    near = difflib.get_close_matches(tidy(name)[:100], list(known), 1)
    if near:
        return f"Did you mean {near[0]}?"
    names = [column.name for column in columns]
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"Columns are {', '.join(names[:MOST_NAMES])}{more}."


def unit_factor(column: Column, unit: str, place: str) -> tuple[float, float]:
    """Return the factor from a unit of a file to the column's, as `factor` returns it. Raises TableError."""
    if column.holds_words and unit:
        raise TableError(
            f"{place}: the column {column.name} holds words and has no unit; got {quoted(unit)}. Remove it."
        )
    if not unit or unit == column.unit:
        return 1.0, 1.0
    both = factor(unit, column.unit)
    if both is None:
        kind = "unknown" if quantity_of(unit) is None else "of another quantity"
        units = ", ".join(different_units(column.unit))
        raise TableError(
            f"{place}: the unit {quoted(unit)} of {shown(column.name)} is {kind}. "
            f"Use {units}; none means {column.unit}."
        )
    return both


@dataclass(frozen=True)
class Body:
    """The rows after the names."""

    source: str
    separator: str
    most_rows: int

    def plain(self, layout: Sequence[Place], lines: Sequence[str], names: int) -> Table | None:
        """Return the table where each cell is a number in its place and within limits, the quick way; None where not.

        names: number of the row of names.
        """
        bare = self.separator + BLANK
        places = [at for at in range(names, len(lines)) if lines[at].strip(bare)]
        gapless = [one.at for one in layout] == list(range(len(layout)))
        if not gapless or not 0 < len(places) <= self.most_rows or any(one.column.holds_words for one in layout):
            return None
        values, marks = np.empty((len(places), len(layout))), set()
        for begin in range(0, len(places), BLOCK):
            found, mark = self._plain_block([lines[at] for at in places[begin : begin + BLOCK]])
            marks.add(mark)
            if found is None or found.shape != values[begin : begin + BLOCK].shape:
                return None
            values[begin : begin + BLOCK] = found
        numbers = {one.column.name: one.converted(column.copy()) for one, column in zip(layout, values.T, strict=True)}
        if marks >= {",", "."} or max(map(len, lines)) > LONGEST_ROW:
            return None
        if ("," in marks or self.separator == ";") and marks & {",", "."}:
            cells = (cell.strip() for at in places for cell in lines[at].split(self.separator))
            if all(THOUSANDS.fullmatch(cell) for cell in cells if "." in cell or "," in cell):
                return None
        if not all(one.allows(numbers[one.column.name]) for one in layout):
            return None
        units = {one.column.name: one.column.unit for one in layout}
        return Table(self.source, numbers, {}, units, np.array(places) + 1)

    def _plain_block(self, lines: Sequence[str]) -> tuple[NDArray[np.float64] | None, str]:
        """Return the values of rows and their decimal mark; None if a cell is not a plain number."""
        text = "".join(lines)
        mark = "," if self.separator != "," and "," in text else "." if "." in text else ""
        if text.encode().translate(None, PLAIN_BYTES + f"{self.separator}{mark}".encode()):
            return None, mark
        try:
            points = (line.replace(",", ".") for line in lines) if mark == "," else lines
            values = np.loadtxt(points, delimiter=self.separator, comments=None, ndmin=2)
        except ValueError:
            return None, mark
        return values if np.all(np.isfinite(values)) else None, mark

    def table(self, layout: Sequence[Place], rows: Iterable[tuple[int, list[str]]]) -> Table:
        """Return the table; rows: number and cells of each. Raises TableError."""
        body = list(islice(rows, self.most_rows + 1))
        if len(body) > self.most_rows:
            raise TableError(f"{self.source} must have at most {self.most_rows} rows; it has more. Split it.")
        self._check_names(layout, body)
        places = np.array([number for number, _ in body], np.int64)
        numbers, words, units = {}, {}, {}
        mark = DecimalMark(self.source)
        for one in layout:
            texts = [row[one.at] if one.at < len(row) else "" for _, row in body]
            cells_of_column = Cells(self.source, places, one)
            if one.column.holds_words:
                words[one.column.name] = cells_of_column.words(texts)
            else:
                numbers[one.column.name] = cells_of_column.numbers(texts, mark)
                units[one.column.name] = one.column.unit
        mark.check_thousands(self.separator)
        return Table(self.source, numbers, words, units, places)

    def _check_names(self, layout: Sequence[Place], body: Sequence[tuple[int, list[str]]]) -> None:
        named = {one.at for one in layout}
        width = max(named, default=-1) + 1
        gaps = sorted({*range(width)} - named)
        for number, cells in body:
            if gaps or len(cells) > width:
                for at in [*gaps, *range(width, len(cells))]:
                    if at < len(cells) and cells[at]:
                        raise self.nameless(number, at, cells[at], len(named))

    def nameless(self, number: int, at: int, cell: str, count: int) -> TableError:
        """Return the error for a cell without a name; number: its row, at: its place in it, count: named columns."""
        hint = " With decimal commas, separate columns by semicolons." if self.separator == "," else ""
        return TableError(
            f"{self.source}, row {number}: a row must have at most {count} values; got {at + 1}: {quoted(cell)} has no "
            f"name. Name each column in the first row.{hint}"
        )


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
            if self.column.text and (len(cell) > LONGEST_TEXT or not cell.isprintable()):
                raise self.refusal(
                    row,
                    f"the text must be printable, at most {LONGEST_TEXT} characters; got {quoted(cell)}. Shorten it.",
                )
            if not self.column.text and cell not in choice and (cell or self.column.filled):
                raise self.refusal(
                    row, f"the value must be one of {', '.join(choice)}; got {quoted(cell)}. Choose one."
                )
        return list(cells)

    def numbers(self, cells: Sequence[str], mark: DecimalMark) -> NDArray[np.float64]:
        """Return the numbers of the column in its unit. Raises TableError if one is not valid."""
        values = self._plain(cells, mark)
        if values is None:
            values = np.array([self._number(row, cell, mark) for row, cell in enumerate(cells)], float)
        values = self.place.converted(values)
        low, high = self.column.minimum, self.column.maximum
        for row in np.flatnonzero((values < low) | (values > high))[:1].tolist():
            got = f"{quoted(cells[row])}{self._unit(self.place.factor)}"
            raise self.refusal(row, f"the value must be {self._limits()}; got {got}. Check value and unit.")
        parts = ~np.isnan(values) & (values != np.floor(values)) & self.column.whole
        for row in np.flatnonzero(parts)[:1].tolist():
            raise self.refusal(row, f"the value must be an integer; got {quoted(cells[row])}. Round it.")
        return values

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
        plain = cell.replace(MINUS, "-")
        if not NUMBER.fullmatch(plain):
            wrong = "the cell is empty" if not cell else f"got {quoted(cell)}"
            raise self.refusal(row, f"the value must be a number; {wrong}. Write it as 0.015 or 1.5e-2.")
        if "." in plain or "," in plain:
            mark.check(plain, int(self.places[row]), self.column.name)
            plain = plain.replace(",", ".")
        value = float(plain)
        if not math.isfinite(value):
            raise self.refusal(row, f"the value must be below 1.8e308 in size; got {quoted(cell)}. Check it.")
        return value

    def _limits(self) -> str:
        low, high, unit = self.column.minimum, self.column.maximum, self._of_unit(self.column.unit)
        if math.isinf(high):
            return f"at least {low:g}{unit}"
        return f"from {low:g} to {high:g}{unit}"

    def _unit(self, both: tuple[float, float]) -> str:
        if both != (1.0, 1.0):
            return f", in the file's unit, 1 of which is {both[0] / both[1]:g}{self._of_unit(self.column.unit)}"
        return self._of_unit(self.column.unit)

    def _of_unit(self, unit: str) -> str:
        return "" if unit == "1" else f" {unit}"
