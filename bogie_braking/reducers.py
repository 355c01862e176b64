"""Numbers of whole runs: maximum, minimum, mean and percentile of a variable, and own functions of the recording."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bogie_braking.checks import known, names_of, near, number, once, seconds, shown
from bogie_braking.simulation import INTERVAL
from fmu_src.cosimulation.recording import Recording
from fmu_src.system import Variable

#: Functions of the rows of a variable, by the words of their names in columns.
STATISTICS: Mapping[str, Callable[..., Any]] = {
    "maximum": np.max,
    "minimum": np.min,
    "mean": np.mean,
    "percentile": np.percentile,
}
#: A column such as `maximum(axle_load_1)` or `percentile(axle_load_1, 99.85)`, and the name of an own one.
COLUMN = re.compile(r"\s*(\w+)\s*\(\s*([^,()]+?)\s*(?:,\s*([^,()]*?)\s*)?\)\s*")
OWN = re.compile(r"\s*([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?\s*")
FORMS = '"distance", "maximum(axle_load_1)" or "percentile(axle_load_1, 99.85)"'
OWN_FORM = "functions by name, such as {'jerk [m/s3]': function}"
#: An own function of the recording of a run.
Reduce = Mapping[str, Callable[[Recording], float]]


@dataclass(frozen=True)
class Statistic:
    """A statistic of a variable over the rows of a run; share: of a percentile [%]."""

    word: str
    variable: str
    share: float | None = None

    @property
    def column(self) -> str:
        """Return its name in tables."""
        return f"{self.word}({self.variable}{'' if self.share is None else f', {self.share:.12g}'})"

    def __call__(self, run: Recording) -> float:
        """Return it for a run."""
        return float(STATISTICS[self.word](run[self.variable], *([] if self.share is None else [self.share])))


@dataclass(frozen=True)
class Results:
    """Columns that runs give: final values and statistics in their order, then own functions.

    columns: variables or statistics. own: functions by name. units: of all columns. recorded: variables of the runs'
    recordings.
    """

    columns: Sequence[str | Statistic]
    own: Reduce
    units: Mapping[str, str]
    recorded: Sequence[str]

    @property
    def names(self) -> list[str]:
        """Return the names of all columns."""
        return list(self.units)

    @property
    def final(self) -> bool:
        """Return whether all are final values."""
        return not self.own and all(isinstance(column, str) for column in self.columns)

    def of(self, run: Recording, final: Callable[[str], float]) -> list[float]:
        """Return the columns of a run. Raises ValueError if an own function fails.

        final: returns the value of a variable at the end.
        """
        found = [final(column) if isinstance(column, str) else column(run) for column in self.columns]
        return [*found, *(_called(name, function, run) for name, function in self.own.items())]


def is_statistic(name: Any) -> bool:
    """Return whether the name of a result is that of a statistic."""
    return isinstance(name, str) and COLUMN.fullmatch(name) is not None


def interval_of(interval: Any, results: Results, duration: float) -> float:
    """Return the interval of the rows of a run over a duration [s].

    Raises ValueError if it is invalid, longer than the run, or without effect on final values.
    """
    if interval is None:
        return min(INTERVAL, duration)
    if results.final:
        raise ValueError(f"interval must be left out where all results are final values; got {shown(interval)}.")
    if seconds("the interval", interval) > duration:
        raise ValueError(f"interval must be at most the duration, {duration:g} s; got {interval:g} s. Lower it.")
    return float(interval)


def _called(name: str, function: Callable[[Recording], float], run: Recording) -> float:
    try:
        found = function(run)
    except Exception as error:
        raise ValueError(f"The function of {name} failed: {type(error).__name__}: {error}") from error
    value = number(found.item() if isinstance(found, np.ndarray) and found.ndim == 0 else found)
    if np.isnan(value) and not isinstance(found, float | np.floating):
        raise ValueError(f"The function of {name} must return a number; got {shown(found)}.")
    return value


def results_of(names: Sequence[str], variables: Mapping[str, Variable], reduce: Reduce | None = None) -> Results:
    """Return the columns that are named, and own functions by `name [unit]`. Raises TypeError, KeyError, ValueError."""
    if isinstance(names, str):
        raise TypeError(f'names must be a list of variables, such as ["{names}"]; got the text {names!r}.')
    if not isinstance(reduce or {}, Mapping):
        raise TypeError(f"reduce must have {OWN_FORM}; got {shown(reduce)}.")
    columns, units, own = [_column(name, variables) for name in names], [], {}
    for one in columns:
        name, variable = (one, one) if isinstance(one, str) else (one.column, one.variable)
        units.append((name, variables[variable].unit))
    for text, function in (reduce or {}).items():
        name, unit = _own(text, function)
        units.append((name, unit))
        own[name] = function
    if not units:
        raise ValueError(f"names must have at least one result, such as {FORMS}; got none.")
    once((name for name, _ in units), "column")
    recorded = [column if isinstance(column, str) else column.variable for column in columns]
    recorded += names_of(None, variables) if own else []
    return Results(columns, own, dict(units), list(dict.fromkeys(recorded)))


def _column(name: Any, variables: Mapping[str, Variable]) -> str | Statistic:
    match = COLUMN.fullmatch(name) if isinstance(name, str) and name not in variables else None
    if not match:
        return known(name, variables, "variable")
    word, variable, share = match[1], known(match[2], variables, "variable"), match[3]
    if word not in STATISTICS:
        raise KeyError(f"There is no statistic {word}; {near(word, STATISTICS)}")
    if (share is not None) != (word == "percentile"):
        such = "percentile(NAME, SHARE)" if word == "percentile" else f"{word}(NAME)"
        raise ValueError(f"{name} must be written as {such}. Correct it.")
    return Statistic(word, variable, None if share is None else _share(name, share))


def _share(name: str, text: str) -> float:
    """Return the share of a percentile [%]. Raises ValueError."""
    try:
        share = float(text)
    except ValueError:
        share = float("nan")
    if not 0.0 <= share <= 100.0:
        raise ValueError(f"The share of {name} must be from 0 to 100 %; got {text}. Correct it.")
    if 0.5 <= share < 1.0:  # 0.15 % is usual, as in EN 14363
        raise ValueError(f"The share of {name} must be in %; got {text}. Write {100.0 * share:.12g}.")
    return share


def _own(text: Any, function: Any) -> tuple[str, str]:
    """Return name and unit of an own function. Raises TypeError."""
    match = OWN.fullmatch(text) if isinstance(text, str) else None
    if not match or not callable(function):
        raise TypeError(f"reduce must have {OWN_FORM}; got {shown(text)} with {shown(function)}.")
    return match[1], match[2] or "1"
