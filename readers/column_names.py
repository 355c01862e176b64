"""The row of names of a table: which column has which name and unit, in which place."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from readers.column_words import column_meant, false_friend, nearest
from readers.columns import Column, Place, TableError, unit_factor
from readers.text import BLANK, LONGEST_ROW, quoted, shown
from readers.units import unit_like

#: The most names of columns that a message lists.
MOST_NAMES = 20
#: Further columns whose cells may be anything, as they are not used.
TEXT = "text"
#: A name that ends with the number of a vehicle, as `speed[3]`: where a unit is beside it, this is not its unit.
NUMBERED = re.compile(r".*[^\s\[\]]\[\d+\]")
#: A name with its unit in square brackets, and a name with or without its unit in round ones.
HEAD_SQUARE = re.compile(r"(?P<name>[^\[\]]+(?:\[\d+\][^\[\]]*)*)\[(?P<unit>[^\[\]]*)\]")
HEAD_ROUND = re.compile(r"(?P<name>[^\[\]()]+)(\((?P<unit>[^()]*)\))?")
#: A name and a unit behind a slash, a comma, blanks, an underscore or the word "in".
BEHIND = re.compile(r"(?P<name>.*?\w)(\s+in\s+|\s*[/,]\s*|[\s_]+)(?P<unit>[^\s,]+)", re.IGNORECASE)
BLANK_RUN = re.compile(f"[{BLANK}]+")
#: Characters that are equal to an underscore in names.
GAP = re.compile(rf"[{BLANK}_-]+")
CAPITALS = str.maketrans({chr(letter): chr(letter + 32) for letter in range(ord("A"), ord("Z") + 1)})


def tidy(name: str) -> str:
    """Return a name as names are compared: small letters, an underscore for blanks, hyphens and underscores."""
    return GAP.sub("_", name).translate(CAPITALS)


def columns_in_order(place: str, columns: Sequence[Column], units: Sequence[str]) -> list[Place]:
    """Return the first columns in their order; units: as the file has them, a text each, empty where it says none."""
    least = sum(column.required for column in columns)
    if not least <= len(units) <= len(columns):
        need = ", ".join(f"{one.name} [{one.unit}]" for one in columns)
        count = f"{least}" if least == len(columns) else f"{least} to {len(columns)}"
        raise TableError(f"{place}: a row must have {count} values ({need}); got {len(units)}. Correct the row.")
    both = zip(columns, units, strict=False)
    return [Place(at, column, unit_factor(column, unit, place)) for at, (column, unit) in enumerate(both)]


def layout_of(
    place: str, cells: Sequence[str], columns: Sequence[Column], others: bool | str, by_position: bool
) -> list[Place]:
    """Return the columns of a file by its row of names; others: whether it may have further ones, or TEXT."""
    known = {tidy(column.name): column for column in columns}
    parts = [(at, *name_and_unit(cell, place)) for at, cell in enumerate(cells) if cell]
    if any(column.as_written for column in columns):
        parts = [(at, *_as_written(name, unit, known, place)) for at, name, unit in parts]
    row = [name for _, name, _ in parts]
    meant = {at: _meant(name, known, place, row) for at, name, _ in parts}
    if by_position and not any(meant.values()):
        return columns_in_order(place, columns, [unit for _, _, unit in parts])
    found: dict[str, Place] = {}
    for at, name, unit in parts:
        column = meant[at]
        if column is None and not others:
            remedy = advice(name, [one.name for one in columns])
            raise TableError(f"{place}: the column {quoted(name)} is unknown. {remedy}")
        if column is None and others == TEXT:
            column, unit = Column(name, filled=False, text=True, longest=LONGEST_ROW), ""
        column = column or Column(name, unit or "1")
        word = "" if tidy(name) == tidy(column.name) else name
        if (same := found.get(tidy(column.name))) is not None:
            words = " and ".join(quoted(one or column.name) for one in (same.word, word)) if same.word or word else ""
            raise TableError(
                f"{place}: the column {shown(column.name)} must be there once; it is there twice"
                f"{f', as {words}' if words else ''}. Remove one."
            )
        found[tidy(column.name)] = Place(at, column, unit_factor(column, unit, place), word)
    missing = [column.name for key, column in known.items() if column.required and key not in found]
    if missing:
        there = ", ".join(one.column.name for one in found.values()) or "none"
        lacks = f"column {missing[0]} is" if len(missing) == 1 else f"columns {', '.join(missing)} are"
        add = "it" if len(missing) == 1 else "them"
        raise TableError(f"{place}: the {lacks} missing; there are {quoted(there, 200)}. Add {add}.")
    return list(found.values())


def _as_written(name: str, unit: str, known: Mapping[str, Column], place: str) -> tuple[str, str]:
    """Return name and unit of a column whose unit may be behind its name, or in another case.

    A column of words may have some of these there, as Bremsart P/G/R.
    """
    column = _meant(name, known, place)
    if column is not None and column.holds_words and unit:
        return name, "" if _has_words(column, unit) else unit
    behind = BEHIND.fullmatch(name) if column is None and not unit else None
    before = _meant(behind["name"], known, place) if behind else None
    if behind and before and (unit_like(behind["unit"]) or _has_words(before, behind["unit"])):
        return behind["name"], unit_like(behind["unit"])
    return name, unit_like(unit) or unit


def _has_words(column: Column, text: str) -> bool:
    """Return whether a text holds words of a column, with signs between them."""
    return bool(column.words) and all(column.word_of(one) for one in re.split(r"[/,|;\s]+", text))


def _meant(name: str, known: Mapping[str, Column], place: str, row: Sequence[str] = ()) -> Column | None:
    """Return the column of a name: its own, a German or a French one; None if it is unknown. Raises TableError.

    row: all names of the file, which decide on words of two columns.
    """
    try:
        meant = column_meant(name, [one.name for one in known.values()], row)
        return known.get(tidy(name)) or known.get(tidy(meant or ""))
    except ValueError as error:
        raise TableError(f"{place}: {error}") from None


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


def advice(name: str, names: Sequence[str]) -> str:
    """Return the end of the message for an unknown column: the nearest name or word, or the first names."""
    if sentence := false_friend(name) or nearest(name, names):
        return sentence
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"Columns are {', '.join(names[:MOST_NAMES])}{more}."
