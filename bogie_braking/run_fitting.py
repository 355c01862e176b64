"""Calibration: least-squares estimates of a run's parameters from measured data, and their identifiability."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares

from bogie_braking.checks import known, line_or_none, not_both, number, shown
from bogie_braking.histories import Value
from bogie_braking.machines import Machine, Runnable, machine_of, model_from, unfolded
from bogie_braking.measured_data import (
    Data,
    Options,
    check_units,
    covariance,
    data_of,
    errors_by_output,
    mismatches,
    rows_until,
)
from bogie_braking.simulation import Simulation
from fmu_src.cosimulation.measured import in_units_of, table_from
from fmu_src.cosimulation.recording import Recording
from fmu_src.suggestion import suggestion
from fmu_src.system import System
from products.vehicle_file import DataSheet
from rbd_model.track.line import Line
from readers.log_columns import ColumnMap
from readers.log_rows import after_events
from readers.renamed import FormerNames

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Distance from a limit at which a fitted value is at it, over the limit or the value at the start.
AT_LIMIT = 1e-3
#: Limits over start values above which a fit has no bound: `least_squares` scales its steps by the distance to bounds.
FAR = 1e3
#: Relative step of a parameter for a finite difference. Runs are accurate to a tolerance of 1e-6.
STEP = 1e-3
#: Largest number of rows of a run, between which measured instants are interpolated.
MOST_ROWS = 1_000_000
#: Steps of a run are at least this share of the median step of the rows, between which it is interpolated.
SHORTEST_STEP = 0.25
#: Parameters are not identifiable separately if their joint effect on the measured data is smaller than this share of
#: their single effects.
SEPARABLE = 1e-3
#: Least share of a parameter in an unidentifiable direction for which it is named.
NAMED = 0.1


@dataclass(frozen=True)
class Fit(FormerNames):
    """Fitted values and their standard errors by name, in the units of the parameters.

    Attributes
    ----------
    values : dict
        Fitted values.
    standard_errors : dict
        Standard errors; infinite if a parameter is not identifiable.
    unidentifiable : list of tuple
        Groups of parameters that the data cannot separate: only one combination of each group matters.
    deviations : dict
        Standard deviation of the measured values from the run, for each column in its unit.
    held_out : dict
        The same for the rows that were not fitted.
    measured : Recording
        Measured data.
    fitted : Recording
        The run with the fitted values at the measured instants.
    correlation_times : dict
        Correlation time of the errors of each output [s]; 0 if they are independent.
    warnings : list of str
        Outputs that the run does not describe, and why this may be.
    """

    values: dict[str, float]
    standard_errors: dict[str, float]
    unidentifiable: list[tuple[str, ...]]
    deviations: dict[str, float]
    held_out: dict[str, float]
    measured: Recording
    fitted: Recording
    correlation_times: dict[str, float]
    warnings: list[str]

    @property
    def status(self) -> str:
        """The result as messages."""
        messages = [f"{key} = {self.values[key]:.4g} +- {self.standard_errors[key]:.2g}." for key in self.values]
        for group in self.unidentifiable:
            alone = f"{group[0]} is not identifiable: no measured output depends on it."
            several = (
                f"{' and '.join(group)} are not identifiable separately: fix one of them, or measure other outputs."
            )
            messages.append(several if len(group) > 1 else alone)
        for name, off in self.held_out.items():
            messages.append(f"In the rows that were not fitted {name} is off by {off:.2g} {self.measured.units[name]}.")
        for name, over in self.correlation_times.items():
            if over:
                messages.append(f"Errors of {name} are correlated over {over:.2g} s, which standard errors include.")
        messages += self.warnings
        return " ".join(messages)

    def plot(self) -> Figure:
        """Plot the measured data as dots, and the fitted run.

        Returns
        -------
        Figure
            A Matplotlib figure with a chart for each unit.
        """
        figure, first = self.fitted.plot(), self.measured.names[0]
        for chart in figure.axes:
            for line in list(chart.lines):
                name = str(line.get_label())
                chart.plot(
                    self.measured[first], self.measured[name], ".", color="0.6", label=f"{name}, measured", zorder=1
                )
                line.set_label(f"{name}, fitted")
            chart.legend(loc="best")
        return figure


def measured_from(path: str | Path, columns: ColumnMap | None = None) -> Recording:
    """Return a measured run from a file, with time counted from the first row if it is that of a clock.

    Parameters
    ----------
    path : str or Path
        A log with names and units, such as `time [s],speed [km/h]`.
    columns : mapping, str or Path, optional
        A map from its names to those of variables, or its TOML file. By default names are guessed, and told on standard
        error.

    Returns
    -------
    Recording
        Its columns, in the units of its head.

    Raises
    ------
    FileError
        If a file is invalid; the message names file, row, column, value and remedy.
    TypeError
        If `path` is not a path.
    """
    return _printed(_log(path, None, columns))


def _log(path: str | Path, units: Mapping[str, str] | None, columns: ColumnMap | None) -> Recording:
    if not isinstance(path, str | Path):
        raise TypeError(f"The log must be a Recording or the path of a CSV file; got {shown(path)}.")
    return table_from(path, units, columns)


def _printed(log: Recording) -> Recording:
    """Print what was guessed and left out of a log."""
    for message in log.messages:
        print(message, file=sys.stderr)
    return log


@dataclass(frozen=True)
class _Runs:
    """Runs with other parameters, as shares of their values at the start, at the instants of measured data.

    last: number of rows that are fitted. Raises ValueError if these have not more values than there are parameters.
    """

    what: Runnable
    line: Line | None
    values: dict[str, Value]
    parameters: tuple[str, ...]
    first: np.ndarray
    names: list[str]
    data: Data
    last: int

    def __post_init__(self) -> None:
        count = np.sum(np.isfinite(self.data.wanted[: self.last]))
        if count <= self.first.size:
            raise ValueError(f"{count} measured values do not decide on {self.first.size} parameters. Measure more.")

    def off_by(self, share: np.ndarray, rows: int) -> np.ndarray:
        """Return simulated less measured outputs of the first rows, shape (rows, outputs)."""
        fitted = dict(zip(self.parameters, (share * self.first).tolist(), strict=True))
        given = self.values | self.data.inputs | fitted
        simulation = Simulation(self.what, self.line, **given)
        return at_times(simulation, self.names, self.data.times[:rows]) - self.data.wanted[:rows]

    def fitted(self, limits: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the shares that fit best, and the slopes of the scaled outputs by them; limits: of the parameters."""
        there, sizes = np.isfinite(self.data.wanted[: self.last]), self.data.sizes(self.last)
        bounds = np.sort(limits / self.first[:, None]).T
        found = least_squares(
            lambda share: (self.off_by(share, self.last) / sizes)[there],
            np.ones_like(self.first),
            bounds=np.where(np.abs(bounds) > FAR, np.copysign(np.inf, bounds), bounds),
            diff_step=STEP,
        )
        return found.x, found.jac


def fit(
    what: Runnable | DataSheet,
    measured: Recording | str | Path,
    parameters: Mapping[str, float],
    line: Line | None,
    options: Options,
    values: dict[str, Value],
) -> Fit:
    """Fit parameters of a vehicle or a brake; arguments, result and errors are those of `calibration.fit`."""
    given, (what, values) = values, unfolded(what, values)
    machine = machine_of(what, values, line_or_none(line) is not None)
    table = _table(measured, machine, options.columns)
    what = model_from(what) if isinstance(what, System) else what
    names, driven = parted(table, machine)
    data = data_of(table, names, driven, options)
    last = rows_until(options.until, data.clock)
    first = begin_of(parameters, machine, driven)
    not_both(parameters, given, "as a parameter to be fitted and as a value")
    not_both(driven, given, "as a column of the measured data and as a value")
    values = {name: value for name, value in values.items() if name not in {*parameters, *driven}}  # those of a file
    runs = _Runs(what, line, values, tuple(parameters), first, names, data, last)
    limits = np.array([[machine.variables[one].minimum, machine.variables[one].maximum] for one in parameters])
    if "initial_speed" not in parameters:
        begins = (runs.off_by(np.ones_like(first), 2) + data.wanted[:2])[0]
        check_units(names, begins, data, table.units)
    share, slopes = runs.fitted(limits)
    warnings = [*at_limits(parameters, share * first, limits, first), *lacking(driven, {*values, *parameters}, machine)]
    return _fit_of(runs, table, share, slopes, warnings)


def _fit_of(runs: _Runs, table: Recording, share: np.ndarray, slopes: np.ndarray, warnings: list[str]) -> Fit:
    """Return the result of a fit to a table."""
    data, names, first, last = runs.data, runs.names, runs.first, runs.last
    there, sizes = np.isfinite(data.wanted[:last]), data.sizes(last)
    off = runs.off_by(share, data.times.size)
    errors = errors_by_output(data.times[:last], there, slopes, off[:last], sizes)
    standard, unidentifiable = identifiability(
        slopes, covariance(data.times[:last], there, errors), list(runs.parameters)
    )
    deviations = spread(names, off[:last])
    return Fit(
        dict(zip(runs.parameters, (share * first).tolist(), strict=True)),
        dict(zip(runs.parameters, (standard * np.abs(first)).tolist(), strict=True)),
        unidentifiable,
        deviations,
        spread(names, off[last:]) if last < data.times.size else {},
        table,
        Recording({one: table.units[one] for one in ("time", *names)}, np.c_[data.clock, off + data.wanted]),
        {name: one.time for name, one in zip(names, errors, strict=True)},
        [*warnings, *mismatches(deviations, off[0], data.wanted[:last], table.units)],
    )


def lacking(driven: Sequence[str], given: Collection[str], machine: Machine) -> list[str]:
    """Return a warning for inputs that a log has for some wheelsets only: the others stay at their start values."""
    found = []
    for stem in dict.fromkeys(name.rstrip("0123456789") for name in driven if name[-1].isdigit()):
        inputs = [one for one in machine.variables.values() if one.causality == "input"]
        like = [one for one in inputs if one.name.rstrip("0123456789") == stem]
        left = [one for one in like if one.name not in driven and one.name not in given]
        stays = [f"{one.name} ({one.start:g}{in_unit(one.unit)})" for one in left]
        if stays:
            has = next(name for name in driven if name.rstrip("0123456789") == stem)
            found.append(
                f"The log has {has}, but it lacks {', '.join(stays)}: start values are taken. Map a column to these "
                "too, or give their values."
            )
    return found


def at_limits(names: Iterable[str], values: np.ndarray, limits: np.ndarray, first: np.ndarray) -> list[str]:
    """Return a warning for each fitted value at one of its limits.

    Takes values, limits, first (parameters,).
    """
    return [
        f"{name} ended at its limit of {limit:g}; check the units of the data and the inputs that the log lacks."
        for name, value, both, start in zip(names, values.tolist(), limits.tolist(), first.tolist(), strict=True)
        for limit in both
        if math.isfinite(limit) and abs(value - limit) <= AT_LIMIT * max(abs(limit), abs(start))
    ]


def in_unit(unit: str) -> str:
    """Return a unit as the end of a number, nothing for pure numbers."""
    return "" if unit == "1" else f" {unit}"


def _table(measured: Recording | str | Path, machine: Machine, columns: ColumnMap | None) -> Recording:
    """Return measured data in the units of the variables. Raises ValueError, TypeError."""
    units = {"time": "s"} | {name: one.unit for name, one in machine.variables.items()}
    if isinstance(measured, Recording):
        if columns is not None:
            raise ValueError("columns must be None for a Recording, as its columns have names; give the path of a log.")
        return in_units_of(measured, units)
    return _printed(_log(measured, units, columns))


def spread(names: Sequence[str], off: np.ndarray) -> dict[str, float]:
    """Return the root mean square of each column of `off`, shape (rows, names), without NaN; NaN if nothing is left."""
    there = np.isfinite(off)
    count = np.sum(there, axis=0)
    total = np.sum(np.where(there, off, 0.0) ** 2, axis=0)
    means = np.divide(total, count, out=np.full(count.shape, math.nan), where=count > 0)
    return dict(zip(names, np.sqrt(means).tolist(), strict=True))


def begin_of(parameters: Mapping[str, float], machine: Machine, driven: Sequence[str] = ()) -> np.ndarray:
    """Return the initial values of parameters, shape (parameters,); `driven`: measured inputs, which cannot be fitted.

    Raises ValueError if a parameter cannot be fitted.
    """
    if not isinstance(parameters, Mapping) or not parameters:
        raise ValueError(f"parameters must have start values by name; got {shown(parameters)}.")
    constant = [one for one in machine.variables.values() if one.causality in ("parameter", "input")]
    able = [one.name for one in constant if one.kind == "real" and one.name not in driven]
    for name, value in parameters.items():
        if name not in able:
            raise ValueError(f"{machine.name} has no real parameter or free input {name}; {suggestion(name, able)}")
        one = machine.variables[name]
        if not one.minimum < number(value) < one.maximum or value == 0.0:
            between = f"between {one.minimum:g} and {one.maximum:g}{in_unit(one.unit)}"
            raise ValueError(f"The initial value of {name} must be {between}, and not 0; got {value!r}.")
    return np.array(list(parameters.values()), float)


def parted(table: Recording, machine: Machine) -> tuple[list[str], list[str]]:
    """Return the names of measured outputs and of measured inputs.

    Raises KeyError if a name is unknown, ValueError if the time or a unit is wrong or no output is measured.
    """
    if table.names[0] != "time" or not np.all(np.isfinite(table["time"])) or np.any(np.diff(table["time"]) <= 0.0):
        raise ValueError("The first column of the measured data must be time [s], finite and increasing.")
    if table.units["time"] != "s":
        raise ValueError(f"time must be in s; got {table.units['time']} in the measured data.")
    for name in table.names[1:]:
        unit = machine.variables[known(name, machine.variables, "variable")].unit
        if table.units[name] != unit:
            raise ValueError(f"{name} must be in {unit}; got {table.units[name]} in the measured data.")
    driven = [name for name in table.names[1:] if machine.variables[name].causality == "input"]
    names = [name for name in table.names[1:] if name not in driven]
    if not names:
        raise ValueError("The measured data must have at least one output to fit; got none.")
    return names, driven


def at_times(simulation: Simulation, names: Sequence[str], times: np.ndarray) -> np.ndarray:
    """Return outputs of a run at instants [s], shape (instants, names). After an early end the last values are used."""
    steps = np.diff(times[after_events(times)])
    step = max(float(np.min(steps)), SHORTEST_STEP * float(np.median(steps)), float(times[-1]) / MOST_ROWS)
    series = simulation.advance(float(times[-1]) + step, names, step)
    return np.column_stack([np.interp(times, series["time"], series[one]) for one in names])


def identifiability(
    slopes: np.ndarray, covariance: Callable[[np.ndarray], np.ndarray], names: Sequence[str]
) -> tuple[np.ndarray, list[tuple[str, ...]]]:
    """Return standard errors of parameters, and groups that cannot be separated.

    They follow from the singular values of the slopes with columns scaled to length 1: Golub and Van Loan (2013),
    section 5.5. The covariance of least squares is that of errors with any covariance: Davidson and MacKinnon (2004),
    eq. (5.31).

    Takes slopes (values, parameters), covariance (values, n).
    """
    lengths = np.linalg.norm(slopes, axis=0)
    silent = lengths <= SEPARABLE * np.max(lengths)
    unidentifiable: list[tuple[str, ...]] = [(name,) for name, none in zip(names, silent, strict=True) if none]
    errors = np.full(len(names), np.inf)
    heard = np.flatnonzero(~silent)
    left, sizes, directions = np.linalg.svd(slopes[:, heard] / lengths[heard], full_matrices=False)
    lost = sizes < SEPARABLE
    mixed = np.zeros(heard.size, bool)
    for direction in directions[lost]:
        group = np.abs(direction) > NAMED
        unidentifiable.append(tuple(names[place] for place in heard[group]))
        mixed |= group
    told = left[:, ~lost]
    across = directions[~lost] / sizes[~lost, None]
    variances = np.einsum("ip,ij,jp->p", across, told.T @ covariance(told), across)
    kept = heard[~mixed]
    errors[kept] = np.sqrt(variances[~mixed]) / lengths[kept]
    return errors, unidentifiable
