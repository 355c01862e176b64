"""Records: data of a user's file that equations read, as numbers, tables of polynomials, and lists of further records.

A `TableFile` is one table along one argument. A file of records has any number of tables, and lists whose lengths are
data. An instance has one root record: that of its file, or the one that the equations were made with.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

#: Breakpoints and rows of coefficients of a piecewise polynomial, lowest power first, as in `piecewise.look_up`.
Pieces = tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]
#: Most pieces of a table, and the largest size of any number in it: polynomials of larger ones overflow.
MOST_PIECES, LARGEST_NUMBER = 20_000, 1e100


@dataclass(frozen=True)
class NumberOfRecord:
    """A number of a record with its limits."""

    name: str
    unit: str
    minimum: float
    maximum: float


@dataclass(frozen=True)
class TableOfRecord:
    """A piecewise polynomial of a record: its degree, and the limits of its breakpoints."""

    name: str
    unit: str
    degree: int
    minimum: float
    maximum: float


@dataclass(frozen=True)
class ListOfRecord:
    """A list of records of one kind; least, most: how many it may have; shared: a single one is that of all places."""

    name: str
    kind: RecordKind
    least: int
    most: int
    shared: bool = False


@dataclass(frozen=True)
class RecordKind:
    """What a record has, in the order of its file."""

    name: str
    numbers: tuple[NumberOfRecord, ...] = ()
    tables: tuple[TableOfRecord, ...] = ()
    lists: tuple[ListOfRecord, ...] = ()


@dataclass(frozen=True)
class OwnRecord:
    """The record that a function makes of something; it is made where C is written, not with the equations."""

    made_by: Callable[[Any], Record]
    of: Hashable

    @property
    def record(self) -> Record:
        """Return the record."""
        return self.made_by(self.of)


@dataclass(frozen=True)
class Record:
    """Numbers, tables and lists of a record, in the order of its kind."""

    kind: RecordKind
    numbers: tuple[float, ...] = ()
    tables: tuple[Pieces, ...] = ()
    lists: tuple[tuple[Record, ...], ...] = ()

    def number(self, name: str) -> float:
        """Return one of its numbers by name."""
        return self.numbers[[one.name for one in self.kind.numbers].index(name)]
