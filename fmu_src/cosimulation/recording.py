"""Time series by name, with units."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np


class Recording:
    """Time series by name, each with its unit; `time` is the first."""

    def __init__(self, units: Mapping[str, str], rows: Sequence[Sequence[float]]) -> None:
        self.units = dict(units)
        table = np.array(rows, dtype=float).reshape(-1, len(self.units))
        self._columns = dict(zip(self.units, table.T, strict=True))

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    @property
    def names(self) -> list[str]:
        return list(self.units)

    def add(self, name: str, unit: str, values: np.ndarray) -> None:
        """Adds a column with as many rows as `time`, for example of a second run."""
        self.units[name] = unit
        self._columns[name] = values

    def add_from(self, name: str, other: Recording, column: str) -> None:
        """Adds a column of another run at the times of this one; NaN after that run's end."""
        values = np.interp(self["time"], other["time"], other[column], right=math.nan)
        self.add(name, other.units[column], values)

    def first_time(self, condition: np.ndarray) -> float | None:
        """Time of the first row where the condition holds; None when it never does."""
        rows = np.flatnonzero(condition)
        return float(self["time"][rows[0]]) if rows.size else None
