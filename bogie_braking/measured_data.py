"""Measured data that a run is fitted to, and the signs that they are not those of the run."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.checks import number, seconds, shown
from bogie_braking.histories import Value
from fmu_src.cosimulation.arrays import log_from, named_arrays
from fmu_src.cosimulation.measured import in_units_of, table_from
from fmu_src.cosimulation.recording import Recording
from readers.log_columns import ColumnMap
from readers.log_rows import after_events, averaged, filled
from readers.usual import LEAST_PRESSURE, is_almost_0, likely_unit

#: Accepted forms of a log, for messages.
FORMS = "a Recording, columns by name (a mapping, a data frame), or the path of a log"
#: Size of errors, relative to the range of the measured values, from which a run does not describe them.
FAILS = 0.2
#: Ratios of measured and simulated speed at the begin that show a wrong unit.
UNIT_RATIOS = {3.6: "km/h", 1 / 0.44704: "mph"}
#: Relative deviation from such a ratio, least speed for which it is tested [m/s], and relative mismatch that is told.
NEAR_RATIO, LEAST_SPEED, MISMATCH = 0.03, 1.0, 0.1
#: Longest average and longest gap [s].
LONGEST = 86400.0


@dataclass(frozen=True)
class DataOptions:
    """How measured data are read and prepared, as the arguments of `calibration.fit`."""

    until: float | None = None
    begin: float | None = None
    columns: ColumnMap | None = None
    interval: float | None = None
    longest_gap: float | None = None


@dataclass(frozen=True)
class Data:
    """Measured data: times of the table (`clock`) and of the run [s], outputs, shape (rows, outputs), and inputs.

    A missing output is NaN. Inputs are times and values by name.
    """

    clock: np.ndarray
    times: np.ndarray
    wanted: np.ndarray
    inputs: dict[str, Value]

    def sizes(self, rows: int) -> np.ndarray:
        """Return the range of each output in the first rows, 1 if it is constant."""
        wanted = self.wanted[:rows]
        there = np.isfinite(wanted)
        high = np.max(np.where(there, wanted, -math.inf), axis=0)
        low = np.min(np.where(there, wanted, math.inf), axis=0)
        return np.where(high > low, high - low, 1.0)


def measured_from(path: Any, columns: ColumnMap | None = None) -> Recording:
    """Return a measured run from a file or data frame, with time counted from the first row if it is that of a clock.

    Parameters
    ----------
    path : str, Path, mapping of arrays, data frame, data set or structured array
        A log. Its names have units, as in `speed [km/h]`. A file is text, Parquet, MATLAB, MDF or HDF5, by the end of
        its name.
    columns : mapping, str or Path, optional
        A map from its names to those of variables, or its TOML file. By default names are guessed, and a message on
        standard error shows the guesses.

    Returns
    -------
    Recording
        Its columns, in the units of its head.

    Raises
    ------
    FileError
        If a file is invalid; the message names file, row, column, value and remedy.
    TypeError
        If `path` is not a path and has no named columns.
    """
    if isinstance(path, Recording):
        raise not_a_log("The log", path)
    return log_of(path, None, columns)


def log_of(
    measured: object,
    units: Mapping[str, str] | None,
    columns: ColumnMap | None = None,
    name: str = "The log",
    end: str = "",
) -> Recording:
    """Return a log, in `units` by name if it has these columns. Guesses are printed to standard error.

    A log is a Recording, the path of a file, or named arrays: a mapping, data frame, data set or structured array.
    name, end: of messages. Raises TypeError, ValueError, FileError.
    """
    if isinstance(measured, Recording):
        if columns is not None:
            raise ValueError("columns must be None for a Recording, as its columns have names; give the path of a log.")
        return in_units_of(measured, units or {})
    if isinstance(measured, str | Path):
        log = table_from(measured, units, columns)
    elif (arrays := named_arrays(measured, f"{name}{end}")) is not None:
        log = log_from(arrays, units, columns, f"{name}{end}")
    else:
        raise not_a_log(name, measured, end)
    for message in log.messages:
        print(message, file=sys.stderr)
    return log


def not_a_log(name: str, measured: object, end: str = "") -> TypeError:
    """Return the error of something that is not a log."""
    return TypeError(f"{name} must be {FORMS}; got {shown(measured)}{end}.")


def check_unit(table: Recording, name: str, unit: str, where: str = "the measured data.") -> None:
    """Raise ValueError if a column has another unit."""
    if table.units[name] != unit:
        raise ValueError(f"{name} must be in {unit}; got {table.units[name]} in {where}")


def data_of(table: Recording, names: Sequence[str], driven: Sequence[str], options: DataOptions) -> Data:
    """Return measured data; names, driven: of outputs and inputs."""
    clock, begin, interval, longest_gap = table["time"], options.begin, options.interval, options.longest_gap
    for name in (*names, *driven):
        if table.units[name] == "Pa":
            check_pressure(name, table[name])
    rows = np.column_stack([since(begin, clock), *(table[one] for one in (*names, *driven))])
    if interval is not None:
        rows = averaged(rows, seconds("interval", interval, LONGEST))
        if len(rows) < 2:
            raise ValueError(f"interval must leave at least 2 rows; got {interval!r} s, which leaves one. Lower it.")
        clock = clock[0] - since(begin, clock)[0] + rows[:, 0]
    gap = None if longest_gap is None else seconds("longest_gap", longest_gap, LONGEST)
    times, wanted = rows[:, 0], rows[:, 1 : 1 + len(names)].copy()
    wanted[~after_events(times)] = math.nan
    for name, values in zip(names, wanted.T, strict=True):
        if not np.any(np.isfinite(values)):
            raise ValueError(f"{name} must have at least one value in the measured data; got none.")
    inputs: dict[str, Value] = {
        name: filled(times, values, name, gap) for name, values in zip(driven, rows[:, 1 + len(names) :].T, strict=True)
    }
    return Data(clock, times, wanted, inputs)


def since(begin: float | None, times: np.ndarray) -> np.ndarray:
    """Return the times of a table relative to the start of the run [s].

    begin: time of the table at the start. None: the time of its first row, as the clock of a log may start at any time.
    Raises ValueError if `begin` is after the first row.
    """
    if begin is None:
        return times - times[0]
    if not -math.inf < number(begin) <= times[0]:
        raise ValueError(
            f"begin must be at most {times[0]:.12g} s, the time of the first row; got {begin!r}. Lower it."
        )
    return times - float(begin)


def rows_until(until: float | None, times: np.ndarray) -> int:
    """Return the number of rows that are fitted. Raises ValueError if there are fewer than two, or none is left."""
    if until is None:
        return times.size
    if not number(until) >= times[1]:
        raise ValueError(f"until must be at least {times[1]:.12g} s, the time of the second row; got {until!r}.")
    if float(until) > times[-1]:
        raise ValueError(
            f"until must be at most {times[-1]:.12g} s, the time of the last row; got {until!r}. Lower it."
        )
    return int(np.searchsorted(times, float(until), "right"))


def check_pressure(name: str, values: np.ndarray) -> None:
    """Check that a column of pressures in Pa is not in bar or kPa."""
    most = float(np.nanmax(np.abs(values), initial=0.0))
    if is_almost_0(most, "Pa"):
        raise ValueError(
            f"{name} must reach {LEAST_PRESSURE:g} Pa in the measured data; got at most {most:.4g} Pa."
            f"{likely_unit(most, 'Pa', LEAST_PRESSURE, math.inf)} Correct the unit of the column, or leave it out."
        )


def first_rows(wanted: np.ndarray) -> list[int]:
    """Return the first row in which each output has a value, 0 without one; wanted: shape (rows, outputs)."""
    return [int(np.argmax(there)) for there in np.isfinite(wanted).T]


def check_units(names: Sequence[str], simulated: np.ndarray, data: Data, units: Mapping[str, str]) -> None:
    """Check that no speed begins as in another unit; simulated: shape (rows, outputs), up to the last of first_rows."""
    for column, (name, row) in enumerate(zip(names, first_rows(data.wanted), strict=True)):
        run, log = simulated[row, column], data.wanted[row, column]
        if units[name] != "m/s" or not min(run, log) > LEAST_SPEED:
            continue
        for ratio, unit in UNIT_RATIOS.items():
            for times, words in ((ratio, f"as if in {unit}"), (1 / ratio, f"as if converted twice from {unit}")):
                if abs(log / run / times - 1.0) < NEAR_RATIO:
                    raise ValueError(
                        f"{name} must begin near {run:.4g} m/s, as the run does; got {log:.4g} m/s in the first row, "
                        f"{words}. Correct the unit of the column, or set initial_speed."
                    )


def mismatches(
    deviations: Mapping[str, float], off: np.ndarray, wanted: np.ndarray, units: Mapping[str, str]
) -> list[str]:
    """Return a message for each output that the run does not describe; off: simulated less measured rows."""
    found = []
    for column, ((name, size), row) in enumerate(zip(deviations.items(), first_rows(wanted), strict=True)):
        values, unit = wanted[:, column], units[name]
        span = float(np.nanmax(values) - np.nanmin(values))
        begin, error = values[row], off[row, column]
        first, simulated = f"{begin:.4g} {unit}", f"{begin + error:.4g} {unit}"
        if 0.0 < FAILS * span < size:
            found.append(
                f"The run does not describe {name}: it is off by {size:.2g} {unit}, {100 * size / span:.0f} % of its "
                "range. Check units, initial values and what is not fitted."
            )
        if abs(error) > MISMATCH * max(abs(begin), span):
            begins = f"{name} begins at {first} in the log and at {simulated} in the run."
            found.append(f"{begins} Check initial values and begin.")
    return found
