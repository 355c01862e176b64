"""Times and values in common forms: a pair of columns, rows of (time, value), or an array with a field `time`."""

from __future__ import annotations

import datetime
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bogie_braking.checks import durations, refused, shown

Numbers = NDArray[np.float64]
#: Accepted forms, for messages.
FORMS = (
    "one number, a function of time, a pair of columns ([0, 2], [0, 5e3]), times [s] and values, "
    "rows [(0, 0), (2, 5e3)], or an array with a field time"
)
#: Remedy if rows and columns cannot be distinguished.
UNCLEAR = "Write ([0, 2], [0, 5e3]) for columns, times [s] and values, or [(0, 0), (2, 5e3)] for rows"


def times_and_values(name: str, given: Any) -> tuple[Numbers, Numbers]:
    """Return the times [s] and values of an input, two arrays of shape (rows,).

    A pair of columns and rows of (time, value) differ in their lengths. With two of each, a tuple of two lists or
    arrays is columns, and a list of two tuples is rows.
    """
    columns = _columns(name, given)
    if columns is None:
        raise refused(f"{name} must be {FORMS}; got {shown(given)}.")
    times, values = (_numbers(name, column, times=place == 0) for place, column in enumerate(columns))
    if times.ndim != 1 or times.shape != values.shape or times.size == 0:
        raise refused(
            f"{name} must have as many values as times, and at least one of each; got {_counted(times)} and "
            f"{_counted(values)}. Give equally long columns."
        )
    return times, values


def _counted(column: Numbers) -> str:
    return f"{column.size}" if column.ndim == 1 else f"an array of shape {column.shape}"


def _columns(name: str, given: Any) -> Sequence[Any] | None:
    """Return times and values as they were given, or None if the form is unknown."""
    if isinstance(given, np.ndarray):
        return _columns_of_array(name, given)
    if not isinstance(given, list | tuple) or not given or not all(_is_column(one) for one in given):
        return None
    lengths = {len(one) for one in given}
    if len(given) == 2 and lengths == {2}:
        return _two_by_two(name, given)
    if len(given) == 2:
        return given
    return list(zip(*given, strict=True)) if lengths == {2} else None


def _is_column(one: Any) -> bool:
    """Return whether something holds numbers in an order: a list, tuple, array or column of a data frame.

    An array of no dimension holds one number, and has no length although it has the method.
    """
    ordered = hasattr(one, "__len__") and hasattr(one, "__getitem__") and getattr(one, "ndim", 1) != 0
    return ordered and not isinstance(one, str | bytes | Mapping)


def _two_by_two(name: str, given: Any) -> Sequence[Any]:
    """Return the columns of two by two numbers."""
    kinds = [tuple if isinstance(one, tuple) else list if isinstance(one, list) else None for one in given]
    if kinds == [None, None] or (isinstance(given, tuple) and tuple not in kinds):
        return list(given)
    if isinstance(given, list) and kinds == [tuple, tuple]:
        return list(zip(*given, strict=True))
    raise refused(f"{name} must be columns or rows; {shown(given)} can be both. {UNCLEAR}.")


def _columns_of_array(name: str, given: np.ndarray) -> Sequence[Any] | None:
    """Return times and values of an array: with a field `time`, of shape (rows, 2) or (2, rows)."""
    fields = given.dtype.names
    if fields:
        others = [one for one in fields if one != "time"]
        value = name if name in others else others[0] if len(others) == 1 else None
        if "time" not in fields or value is None:
            there = ", ".join(fields)
            raise refused(f"{name} must be an array with the fields time and {name}; it has {there}. Name them so.")
        return given["time"], given[value]
    if given.ndim != 2 or 2 not in given.shape:
        return None
    if given.shape == (2, 2):
        raise refused(f"{name} must be columns or rows; an array of shape (2, 2) can be both. {UNCLEAR}.")
    return list(given if given.shape[0] == 2 else given.T)


def _numbers(name: str, column: Any, times: bool) -> Numbers:
    """Return a column as numbers; times in seconds."""
    what = "times" if times else "values"
    if np.ma.is_masked(column):
        raise refused(f"{name} must have all its {what}; some are masked. Leave these rows out.")
    try:
        found = np.asarray(column)
        if times and found.dtype.kind in "mO":
            found = _seconds(found)
        if found.dtype.kind in "biuf":
            return found.astype(float)
    except (TypeError, ValueError, OverflowError):
        found = np.empty(0, object)
    unit = " of seconds from the start of the run, or timedelta64" if times else ""
    hint = " Subtract the first time." if found.dtype.kind == "M" or _is_date(column) else " Write numbers."
    raise refused(f"The {what} of {name} must be numbers{unit}; got {shown(column)}.{hint}")


def _is_date(column: Any) -> bool:
    return any(isinstance(one, datetime.date) for one in column)


def _seconds(times: np.ndarray) -> np.ndarray:
    """Return durations in seconds; return an array without durations unchanged."""
    if times.dtype.kind == "m":
        return durations(times)
    if times.size and all(isinstance(one, datetime.timedelta) for one in times.flat):
        return np.array([one.total_seconds() for one in times.flat]).reshape(times.shape)
    return times
