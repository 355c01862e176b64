"""Trains and profiles in files of other programs: a module for each format, which reads it and maps its fields only."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from readers.account import Account

#: A vehicle as a row of a consist file, by column.
Row = dict[str, Any]


@dataclass
class Imported(Account):
    """A train of another program as rows of a consist, with the account of the fields of its file.

    Attributes
    ----------
    rows : list of dict
        A row for each kind of vehicle in turn, with the columns of `products/train/consist_file.py`.
    """

    rows: list[Row] = field(default_factory=list)
