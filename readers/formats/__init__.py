"""Trains and profiles in files of other programs: a module for each format, which reads it and maps its fields only."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

#: A vehicle as a row of a consist file, by column.
Row = dict[str, Any]


@dataclass(frozen=True)
class Imported:
    """A train of another program as rows of a consist, and sentences that account for the fields of its file.

    Attributes
    ----------
    rows : list of dict
        A row for each kind of vehicle in turn, with the columns of `products/train/consist_file.py`.
    taken : list of str
        Fields that have a column, with equal meaning.
    converted : list of str
        Fields that a stated calculation turns into a column.
    left : list of str
        Fields without a column, each with the reason.
    assumed : list of str
        Values that the file does not state, or whose meaning is uncertain.
    """

    rows: list[Row]
    taken: list[str] = field(default_factory=list)
    converted: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
