"""Tables of users: columns under names with units, or by position. One set of rules for all of them.

A table is text with rows. Columns are separated by tabs, semicolons or commas, and by blanks if the first row has
numbers. Numbers have a decimal point or, unless commas separate columns, a decimal comma; a file has one of the two. A
name may carry its unit, `cant [mm]` or `cant (mm)`, which is converted. Names are not case-sensitive; underscores,
blanks and hyphens are equal in them. German and French names are those of `column_words.py`. Empty rows, rows of
separators alone and remarks (`#`, `%`, `!`, `//`) are ignored. A cell may be in quotes.
`fmu_src/runtime/table_file.c` is the twin of this module in C.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from readers.column_names import columns_in_order, layout_of, name_and_unit, tidy
from readers.column_words import plain, read_as
from readers.columns import Cells, Column, DecimalMark, Place, TableError, unit_factor, word_read_as
from readers.decimal_numbers import THOUSANDS, is_decimal
from readers.text import BLANK, LONGEST_ROW, lines_of, quoted, rows_in, shown, text_of

#: Most rows of a table, unless a caller sets another limit.
MOST_ROWS = 4_000_000
#: Rows by which the separator is found where there are no names.
SAMPLE = 50
SEPARATORS = ("\t", ";", ",")
BLANKS = " "
#: A row with which some spreadsheets declare their separator.
DECLARED = re.compile(rf"sep=([,;\t|:])[{BLANK}]*", re.IGNORECASE | re.ASCII)
#: A cell in quotes, by its separator.
IN_QUOTES = {
    one: re.compile(rf'[{BLANK.replace(one, "")}]*"((?:[^"]|"")*)"[{BLANK.replace(one, "")}]*({re.escape(one)}|\Z)')
    for one in ("\t", ";", ",", "|", ":")
}
PLAIN_BYTES = b"0123456789eE+-"
#: Lines that are read at once where all cells are plain numbers.
BLOCK = 20_000


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
    meant : list of str
        The readings of columns with a German or French name, for an account.
    """

    source: str
    numbers: dict[str, NDArray[np.float64]]
    words: dict[str, list[str]]
    units: dict[str, str]
    places: NDArray[np.int64] = field(repr=False)
    meant: list[str] = field(default_factory=list)

    def converted(self, name: str, unit: str) -> NDArray[np.float64]:
        """Return a column of numbers in another unit."""
        numerator, denominator = unit_factor(Column(name, unit), self.units[name], self.source)
        return self.numbers[name] * numerator / denominator

    def refusal(self, row: int, column: str, text: str) -> TableError:
        """Return the error for a value; `row` is numbered from 0, `text` gives limit, value and remedy."""
        return TableError(f"{self.source}, row {self.places[row]}, column {shown(column)}: {text}")

    def check_rows(self, least: int = 2) -> None:
        """Check the number of rows."""
        if self.places.size < least:
            raise TableError(
                f"{self.source} must have at least {least} rows of values; it has {self.places.size}. Add rows."
            )

    def check_growth(self, name: str, least: float = 0.0) -> None:
        """Check that each value of a column is above the one before, by `least` or more if that is above 0."""
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
    others: bool | str = False,
    by_position: bool = False,
    most_rows: int = MOST_ROWS,
) -> Table:
    """Read a table from a file."""
    return table_of(text_of(path), str(path), columns, others=others, by_position=by_position, most_rows=most_rows)


def table_of(
    text: str,
    source: str,
    columns: Sequence[Column],
    *,
    others: bool | str = False,
    by_position: bool = False,
    most_rows: int = MOST_ROWS,
) -> Table:
    """Read a table from its text, as `read_table` does; source: its name in messages."""
    begin = begin_of(text, source)
    place = f"{source}, row {begin.at}"
    numeric = all(is_decimal(cell) for cell in begin.cells if cell)
    if numeric and not by_position:
        example = ", ".join(f"{column.name} [{column.unit}]" for column in columns[:3])
        raise TableError(
            f"{place}: the first row must have names; got {quoted(begin.cells[0])}. Add them, as in {example}."
        )
    body = TableRows(source, begin.separator, most_rows)
    filled = begin.rows_behind()
    if numeric:
        layout = columns_in_order(place, columns, [""] * len(begin.cells))
        return body.table(layout, [(begin.at, list(begin.cells)), *filled])
    layout = layout_of(place, begin.cells, columns, others, by_position)
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
    """Return the begin of a table by its text."""
    lines = lines_of(text)
    separator, behind = _form_of(lines, source)
    at, cells = next(Begin(source, lines, separator, behind, ()).rows_behind(), (0, []))
    if not cells:
        raise TableError(f"{source} must have a row of names and rows of values; it is empty. Give a table.")
    return Begin(source, lines, separator, at, cells)


def names_of(path: str | Path) -> list[str]:
    """Return the names in the first row of a table, in small letters and without units; empty if it has numbers."""
    lines = lines_of(text_of(path))
    separator, behind = _form_of(lines, str(path))
    at, row = next(rows_in(lines, str(path), behind), (0, ""))
    cells = [cell for cell in cells_of(row, separator, f"{path}, row {at}") if cell]
    named = [name_and_unit(cell, f"{path}, row {at}")[0] for cell in cells if not is_decimal(cell)]
    return [tidy(name) for name in named]


def _form_of(lines: Sequence[str], source: str) -> tuple[str, int]:
    """Return the separator of a table, and the number of lines before its first row."""
    first = list(islice(rows_in(lines, source), SAMPLE))
    declared = DECLARED.fullmatch(first[0][1]) if first else None
    first = first[1:] if declared else first
    separator = declared[1] if declared else _separator_of([row for _, row in first])
    return separator, first[0][0] - 1 if first else len(lines)


def cells_of(row: str, separator: str, place: str) -> list[str]:
    """Return the cells of a row without the blanks around them; place: file and row, for messages."""
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
        return next((separator for separator in SEPARATORS if separator in bare), ",")
    return separator_of_numbers(rows) or next((one for one in SEPARATORS if one in first), BLANKS)


def separator_of_numbers(rows: Sequence[str]) -> str | None:
    """Return the separator of rows of numbers, or None if some hold anything else."""
    for one in (*SEPARATORS, BLANKS):
        parts = [cells_of(row.replace('"', ""), one, "") for row in rows]
        if all(len(cells) > 1 and all(not cell or is_decimal(cell) for cell in cells) for cells in parts):
            return one
    return None


def _meant(layout: Sequence[Place]) -> list[str]:
    return [read_as(one.word, one.column.name) for one in layout if one.word]


def _words_meant(column: Column, cells: Iterable[str]) -> dict[str, None]:
    """Return the readings of words that are written differently, each once."""
    read = {cell: column.word_of(cell) for cell in cells if cell and not column.text}
    other = {cell: word for cell, word in read.items() if word and plain(word) != plain(cell)}
    return {word_read_as(cell, column.name, word): None for cell, word in other.items()}


@dataclass(frozen=True)
class TableRows:
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
        return Table(self.source, numbers, {}, units, np.array(places) + 1, _meant(layout))

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
        meant = dict.fromkeys(_meant(layout))
        mark = DecimalMark(self.source)
        for one in layout:
            texts = [row[one.at] if one.at < len(row) else "" for _, row in body]
            cells_of_column = Cells(self.source, places, one)
            if one.column.holds_words:
                words[one.column.name] = cells_of_column.words(texts)
                meant |= _words_meant(one.column, texts)
            else:
                numbers[one.column.name] = cells_of_column.numbers(texts, mark)
                units[one.column.name] = one.column.unit
        mark.check_thousands(self.separator)
        return Table(self.source, numbers, words, units, places, list(meant))

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
