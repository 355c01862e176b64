"""Inputs over time: linear interpolation in a table, or a function of time sampled every millisecond."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bogie_braking.checks import number, refused
from bogie_braking.times_and_values import times_and_values
from fmu_src.system import Variable
from readers.usual import almost_0, is_almost_0, likely_unit

#: Value of an input or parameter, or the path of a file. An input may also be a function of time [s], columns of times
#: [s] and values, rows of (time, value), or an array with a field `time`.
Column = Sequence[float] | np.ndarray
Value = float | str | Callable[[float], float] | tuple[Column, Column] | Sequence[tuple[float, float]] | np.ndarray
#: Sampling interval of a function of time [s].
SAMPLING = 1e-3


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
            self._times, self._values = self._table(given)

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
