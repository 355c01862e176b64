"""Check of a line's rows given as arrays, by the rules of a line file, whose reader is readers/tables.py."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbd_model.track.line_table import LINE
from readers.column_names import advice
from readers.columns import Column
from readers.text import quoted

Numbers = NDArray[np.float64]
COLUMNS = {column.name: column for column in LINE.columns}


def checked_rows(rows: Mapping[str, ArrayLike]) -> dict[str, Numbers]:
    """Return the rows of a line as arrays of numbers."""
    if not isinstance(rows, Mapping):
        raise TypeError(f"A line must have columns by name, such as distance; got a {type(rows).__name__}. Name them.")
    for name in rows:
        if name not in COLUMNS:
            raise KeyError(f"A line has no column {quoted(str(name))}. {advice(str(name), list(COLUMNS))}")
    if "distance" not in rows:
        raise ValueError("A line must have the column distance; it is missing. Add it.")
    found = {name: _numbers(name, values) for name, values in rows.items()}
    count = found["distance"].size
    if count < 2:
        raise ValueError(f"A line must have at least 2 rows; got {count}. Add rows.")
    for name, values in found.items():
        if values.size != count:
            raise ValueError(f"A line's {name} must have {count} rows as distance has; got {values.size}. Correct it.")
        _check_limits(COLUMNS[name], values)
    short = np.flatnonzero(~(np.diff(found["distance"]) >= LINE.least_growth))
    if short.size:
        before, behind = found["distance"][short[0] : short[0] + 2]
        raise ValueError(
            f"A line's distance must grow by at least {LINE.least_growth:g} m from row to row; got {behind:.12g} m in "
            f"row {short[0] + 2} after {before:.12g} m. Sort the rows, or remove this one."
        )
    return found


def _numbers(name: str, values: ArrayLike) -> Numbers:
    """Return a column as numbers. Raises ValueError for anything else."""
    try:
        given = np.asarray(values)
    except ValueError:  # rows of different lengths
        given = np.empty(0, object)
    if given.ndim != 1 or given.dtype.kind not in "iuf" or np.ma.is_masked(values):
        raise ValueError(
            f"A line's {name} must be a list of numbers, none of them masked; got an array of {given.dtype} and shape "
            f"{given.shape}. Correct it."
        )
    return given.astype(float, copy=False)


def _check_limits(column: Column, values: Numbers) -> None:
    """Raise ValueError for the first value outside the limits of its column; NaN is outside."""
    if values.min() >= column.minimum and values.max() <= column.maximum:
        return
    row = int(np.flatnonzero(~((values >= column.minimum) & (values <= column.maximum)))[0])
    unit = "" if column.unit == "1" else f" {column.unit}"
    raise ValueError(
        f"A line's {column.name} must be from {column.minimum:g} to {column.maximum:g}{unit}; got {values[row]:.12g}"
        f"{unit} in row {row + 1}. Check value and unit."
    )
