"""Least-squares estimates of parameters from measured data, their standard errors and identifiability."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares

from bogie_braking.checks import in_unit, number, shown
from bogie_braking.correlated import Errors, errors_of
from bogie_braking.measured_data import Data, mismatches
from fmu_src.cosimulation.recording import Recording
from readers.extras import named_extras
from readers.renamed import FormerNames

if TYPE_CHECKING:
    from fmu_src.figure import NotebookFigure

#: Distance from a limit at which a fitted value is at it, over the limit or the value at the start.
AT_LIMIT = 1e-3
#: Relative step of a parameter for a finite difference. Runs are accurate to a tolerance of 1e-6.
STEP = 1e-3
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

    def plot(self) -> NotebookFigure:
        """Plot the measured data as dots, and the fitted run.

        Returns
        -------
        Figure
            A Matplotlib figure with a chart for each unit.
        """
        with named_extras():
            from fmu_src.cosimulation.recording_chart import draw  # heavy

        return draw(self.fitted, self.fitted.names[1:], self.measured)


@dataclass(frozen=True)
class Problem:
    """Measured outputs of a table, and runs with other parameters, as shares of their values at the start.

    The first `last` rows are fitted. `simulated` returns the outputs of the first rows, shape (rows, outputs).
    Limits above `far` times the start value are not used.

    Raises ValueError if there are not more measured values than parameters.
    """

    table: Recording
    parameters: tuple[str, ...]
    first: np.ndarray  # values at the start
    limits: np.ndarray  # shape (parameters, 2)
    names: Sequence[str]  # of the outputs
    data: Data
    last: int
    simulated: Callable[[np.ndarray, int], np.ndarray]
    far: float = math.inf

    def __post_init__(self) -> None:
        count = np.sum(np.isfinite(self.data.wanted[: self.last]))
        if count <= self.first.size:
            raise ValueError(f"{count} measured values do not decide on {self.first.size} parameters. Measure more.")

    def off_by(self, share: np.ndarray, rows: int) -> np.ndarray:
        """Return simulated less measured outputs of the first rows, shape (rows, outputs)."""
        return self.simulated(share, rows) - self.data.wanted[:rows]

    def fitted(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the shares that fit best, and the slopes of the scaled outputs by them."""
        there, sizes = np.isfinite(self.data.wanted[: self.last]), self.data.sizes(self.last)
        bounds = np.sort(self.limits / self.first[:, None]).T
        found = least_squares(
            lambda share: (self.off_by(share, self.last) / sizes)[there],
            np.ones_like(self.first),
            bounds=np.where(np.abs(bounds) > self.far, np.copysign(np.inf, bounds), bounds),
            diff_step=STEP,
        )
        return found.x, found.jac

    def errors(self, slopes: np.ndarray, off: np.ndarray, over_time: bool) -> list[Errors]:
        """Return the errors of each output in its size; off: simulated less measured outputs, shape (rows, outputs)."""
        times, there, sizes = self.data.times, np.isfinite(self.data.wanted[: self.last]), self.data.sizes(self.last)
        if not over_time:
            free = off.size - self.first.size
            return [Errors(float(np.sum((off / sizes) ** 2)) / free, 0.0, 0.0)]
        of = np.nonzero(there)[1]
        columns = [(there[:, place], slopes[of == place], place) for place in range(there.shape[1])]
        return [
            errors_of(times[: self.last][rows], off[rows, place] / sizes[place], part) for rows, part, place in columns
        ]

    def covariance(self, errors: Sequence[Errors], columns: np.ndarray) -> np.ndarray:
        """Return columns, shape (values, n), multiplied by the covariance of the errors."""
        there, found = np.isfinite(self.data.wanted[: self.last]), np.empty_like(columns)
        of = np.nonzero(there)[1]
        for place, error in enumerate(errors):
            times = self.data.times[: self.last][there[:, place]]
            found[of == place] = error.times(times, columns[of == place])
        return found


def fit_of(problem: Problem, warnings: Sequence[str] = (), over_time: bool = True) -> Fit:
    """Return the result of a fit. over_time: rows are those of a run, whose errors may be correlated in time."""
    share, slopes = problem.fitted()
    data, names, first, last = problem.data, problem.names, problem.first, problem.last
    off = problem.off_by(share, data.times.size)
    errors = problem.errors(slopes, off[:last], over_time)
    standard, unidentifiable = identifiability(
        slopes, lambda columns: problem.covariance(errors, columns), problem.parameters
    )
    deviations, units, clock = spread(names, off[:last]), problem.table.units, problem.table.names[0]
    return Fit(
        dict(zip(problem.parameters, (share * first).tolist(), strict=True)),
        dict(zip(problem.parameters, (standard * np.abs(first)).tolist(), strict=True)),
        unidentifiable,
        deviations,
        spread(names, off[last:]) if last < data.times.size else {},
        problem.table,
        Recording({one: units[one] for one in (clock, *names)}, np.c_[data.clock, off + data.wanted]),
        {name: error.time for name, error in zip(names, errors, strict=True)},
        [
            *at_limits(problem.parameters, share * first, problem.limits, first),
            *warnings,
            *mismatches(deviations, off if over_time else np.zeros_like(off), data.wanted[:last], units),
        ],
    )


def check_parameters(parameters: Mapping[str, float]) -> None:
    """Raise ValueError if there are no parameters by name."""
    if not isinstance(parameters, Mapping) or not parameters:
        raise ValueError(f"parameters must have start values by name; got {shown(parameters)}.")


def check_begin(name: str, value: float, least: float, most: float, unit: str = "1") -> None:
    """Raise ValueError if the initial value of a parameter is not between its limits."""
    if not least < number(value) < most:
        limits = f"{least:g} and {most:g}{in_unit(unit)}"
        raise ValueError(f"The initial value of {name} must be between {limits}; got {value!r}.")


def at_limits(names: Iterable[str], values: np.ndarray, limits: np.ndarray, first: np.ndarray) -> list[str]:
    """Return a warning for each fitted value at one of its limits."""
    return [
        f"{name} ended at its limit of {limit:g}; check the units of the data and the inputs that the log lacks."
        for name, value, both, start in zip(names, values.tolist(), limits.tolist(), first.tolist(), strict=True)
        for limit in both
        if math.isfinite(limit) and abs(value - limit) <= AT_LIMIT * max(abs(limit), abs(start))
    ]


def spread(names: Sequence[str], off: np.ndarray) -> dict[str, float]:
    """Return the root mean square of each column of `off`, shape (rows, names), without NaN; NaN if nothing is left."""
    there = np.isfinite(off)
    count = np.sum(there, axis=0)
    total = np.sum(np.where(there, off, 0.0) ** 2, axis=0)
    means = np.divide(total, count, out=np.full(count.shape, math.nan), where=count > 0)
    return dict(zip(names, np.sqrt(means).tolist(), strict=True))


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
