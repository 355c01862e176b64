"""A table of named columns as charts and notebooks see it: numbered columns are one quantity."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol

import numpy as np


class Table(Protocol):
    """Columns with units; see `Recording`."""

    units: dict[str, str]
    messages: list[str]
    coordinates: tuple[str, ...]

    @property
    def names(self) -> Sequence[str]:
        """Return the names of the columns."""

    @property
    def rows(self) -> int:
        """Return the number of rows."""

    def __getitem__(self, name: str) -> np.ndarray: ...


def quantity_of(name: str) -> str:
    """Return the name of a column with # for its numbers: `speed[3]` and `slip_2` are numbered."""
    return re.sub(r"(?<=\[)\d+(?=\])|(?<=_)\d+(?=_|$)", "#", name)


def quantities_of(names: Iterable[str]) -> dict[str, list[str]]:
    """Return the columns of each quantity, in their order."""
    found: dict[str, list[str]] = {}
    for name in names:
        found.setdefault(quantity_of(name), []).append(name)
    return found


def quantities_with_units(units: Mapping[str, str]) -> list[str]:
    """Return each quantity with its unit and, if there are several, the number of its columns; units: by name."""
    return [
        f"{names[0] if len(names) == 1 else quantity} [{units[names[0]]}]" + (f" x {len(names)}" if names[1:] else "")
        for quantity, names in quantities_of(units).items()
    ]
