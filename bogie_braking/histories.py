"""Inputs over time: linear interpolation in a table, or a function of time sampled every millisecond.

Tables have common forms: a pair of columns, rows of (time, value), or an array with a field `time`.
"""

from __future__ import annotations

import datetime
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bogie_braking.checks import durations, number, refused, shown
from fmu_src.cosimulation.arrays import heads_of, named_arrays
from fmu_src.system import Variable
from readers.columns import TableError
from readers.log_columns import Head
from readers.units import factor
from readers.usual import almost_0, is_almost_0, likely_unit

#: Value of an input or parameter, or the path of a file. An input may also be a function of time [s], columns of times
#: [s] and values, rows of (time, value), or an array with a field `time`.
Column = Sequence[float] | np.ndarray
Value = float | str | Callable[[float], float] | tuple[Column, Column] | Sequence[tuple[float, float]] | np.ndarray
#: Sampling interval of a function of time [s].
SAMPLING = 1e-3
Numbers = NDArray[np.float64]
#: Accepted forms, for messages.
FORMS = (
    "one number, a function of time, a pair of columns ([0, 2], [0, 5e3]), times [s] and values, "
    "rows [(0, 0), (2, 5e3)], an array with a field time, or a log: a Recording, a mapping or a data frame"
)
#: Remedy if rows and columns cannot be distinguished.
UNCLEAR = "Write ([0, 2], [0, 5e3]) for columns, times [s] and values, or [(0, 0), (2, 5e3)] for rows"


class History:
    """One input over time. Before the first point of a table and after its last one the value is held.

    Between two points of the same time the value jumps. An integer input keeps the value of the last point.
    """

    def __init__(self, variable: Variable, given: Any) -> None:
        """Raise SimulationError if it cannot be an input over time."""
        self.variable, self.steps = variable, variable.kind != "real"
        if variable.causality != "input":
            raise refused(f"{variable.name} is not an input and cannot change over time; give it one number.")
        self._function = given if callable(given) else None
        if not self._function:
            self._times, self._values = self._table(columns_of(variable, given))

    @property
    def table(self) -> tuple[Numbers, Numbers] | None:
        """Return times [s] and values; None for a function."""
        return None if self._function else (self._times, self._values)

    def corners(self, begin: float, end: float) -> list[float]:
        """Return the instants between two others at which a straight line ends [s]."""
        if not self._function:
            return [time for time in self._times.tolist() if begin < time < end]
        first, last = math.floor(begin / SAMPLING) + 1, math.ceil(end / SAMPLING)
        return [number * SAMPLING for number in range(first, last) if begin < number * SAMPLING < end]

    def check_begin(self, duration: float) -> None:
        """Raise SimulationError if a table begins after the end of a run, which lasts from 0 to `duration` [s].

        Clocks of logs begin at any time. Such a table would hold its first value throughout.
        """
        if not self._function and self._times[0] > duration:
            raise refused(
                f"The times of {self.variable.name} must begin within the run, from 0 to {duration:g} s; the first is "
                f"{self._times[0]:.12g} s. Time 0 is the start of the run: subtract the first, or run for longer."
            )

    def at(self, time: float, after: bool = True) -> float:
        """Return the value at a time [s]; at a jump, the value after or before it. Raises SimulationError."""
        if self._function:
            return self._allowed(time, self._function(time))
        place = int(np.searchsorted(self._times, time, "right" if after else "left"))
        if self.steps or place in (0, self._times.size):
            return float(self._values[max(place - 1, 0)])
        pair = slice(place - 1, place + 1)
        return float(np.interp(time, self._times[pair], self._values[pair]))

    def _table(self, given: Any) -> tuple[np.ndarray, np.ndarray]:
        name = self.variable.name
        times, values = times_and_values(name, given)
        if not np.all(np.isfinite(times)) or np.any(np.diff(times) < 0.0):
            where = int(np.argmax(~np.isfinite(times) | (np.diff(times, prepend=-math.inf) < 0.0)))
            raise refused(f"The times of {name} must increase; row {where} has {times[where]:g} s.")
        for time, value in zip(times, values, strict=True):
            self._allowed(float(time), float(value))
        if is_almost_0(most := float(np.max(values, initial=0.0)), self.variable.unit):
            raise refused(almost_0(name, most, "Pa", self.variable.maximum))
        return times, values

    def _allowed(self, time: float, value: Any) -> float:
        one = self.variable
        found = number(value)
        if one.minimum <= found <= one.maximum and math.isfinite(found):
            return found
        limits = f"from {one.minimum:g} to {one.maximum:g} {one.unit}"
        hint = likely_unit(found, one.unit, one.minimum, one.maximum)
        raise refused(f"{one.name} must be a finite value {limits} at all times; got {value!r} at {time:g} s.{hint}")


def columns_of(variable: Variable, given: Any) -> Any:
    """Return times [s] and values of an input in a log with named columns; others unchanged. Raises SimulationError.

    A log is a Recording, mapping of arrays, data frame or data set. It has `time`, and the input or one other column.
    """
    name = variable.name
    try:
        arrays = None if isinstance(given, np.ndarray) else named_arrays(given, name)
        heads = heads_of(arrays or {})
    except TableError as error:
        raise refused(str(error)) from None
    if arrays is None:
        return given
    others = [other for other in heads if other != "time"]
    column = name if name in heads else others[0] if len(others) == 1 else None
    if "time" not in heads or column is None:
        raise refused(
            f"{name} must be a log with the columns time and {name}; it has {', '.join(heads)}. Name them so."
        )
    units = {"time": "s", column: variable.unit}
    return tuple(_in_unit(name, heads[key], arrays[heads[key].cell], unit) for key, unit in units.items())


def _in_unit(name: str, head: Head, values: np.ndarray, unit: str) -> np.ndarray:
    """Return numbers in another unit, unchanged if their unit is unknown. Raises SimulationError."""
    if not head.unit or values.dtype.kind not in "biuf":
        return values
    both = factor(head.unit, unit)
    if both is None:
        raise refused(f"{head.name} of the log of {name} must be in {unit}; got {head.unit}. Correct the unit.")
    return values if both[0] == both[1] else values * both[0] / both[1]


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
        others = [field for field in fields if field != "time"]
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
