"""Parameter studies: one run for each of many sets of values, and a table of their last values."""

from __future__ import annotations

import hashlib
import math
import os
import pickle
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.batches import batch
from bogie_braking.checks import is_number, known, line_or_none, not_both, once, seconds, shown
from bogie_braking.histories import Column, Value
from bogie_braking.machines import CREEP_LAW, Runnable, machine_of, model_from, unfolded
from bogie_braking.provenance import absent, digest_of_file, encoded, encoded_values, files_in
from bogie_braking.reducers import Reduce, Results, interval_of, results_of
from bogie_braking.single_runs import SingleRuns
from fmu_src.compile import CompilerError
from fmu_src.cosimulation.arrays import heads_of, named_arrays
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import SimulationError
from fmu_src.system import Model, System, Variable
from products.registry import FMUS
from products.run_history import provenance_of
from products.study.points import AHEAD, Evaluate, Outcome, Outcomes, Point, outcomes_from
from products.study.study import Study, kept_outcomes_of, outcomes_of
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line
from readers.units import factor

#: From this number of runs a batch is made: it compiles once, for as long as thousands of them take. Tasks of an
#: executor have this size then.
PAYS_FROM = 1000
#: Largest number of runs of one batch here, and of runs that a folder loses when a study is interrupted.
AT_ONCE = 10_000


@dataclass(frozen=True)
class Runs:
    """Runs that differ in the values of their points. values: those that all share."""

    single: SingleRuns
    values: Mapping[str, Value]

    @property
    def names(self) -> list[str]:
        """Return the names of the results."""
        return self.single.results.names

    @property
    def batched(self) -> bool:
        """Return whether batches can make the runs."""
        return self.single.results.final and all(map(is_number, self.values.values()))

    def end(self, point: Point) -> Outcome:
        """Return the results of one run and its messages, or the reason of its failure."""
        try:
            end = self.single.end({**self.values, **point})
            return self._outcome(end.results, point, end.status)
        except (SimulationError, ValueError) as error:
            return Outcome(failure=str(error), point=point)

    def ends(self, threads: int | None, points: Sequence[Point]) -> list[Outcome] | None:
        """Return `end` of many points by a batch, bit-identical; None if they cannot be one.

        threads: None for all processors.
        """
        if not self.batched:
            return None
        columns: dict[str, Any] = {name: np.array([point[name] for point in points], float) for name in points[0]}
        try:
            single, values = self.single, {**self.values, **columns}
            made = batch(single.what, single.duration, self.names, single.line, threads, True, **values)
        except (CompilerError, SimulationError, ValueError):  # alone, each run reports the reason
            return None
        table = np.column_stack([made[name] for name in self.names]).tolist()
        return [
            Outcome(failure=message, point=point)
            if message and all(map(math.isnan, row))
            else self._outcome(row, point, message)
            for point, row, message in zip(points, table, made.messages or [], strict=True)
        ]

    def task(self, points: Sequence[Point]) -> list[Outcome]:
        """Return `end` of the points of one task of an executor."""
        return self.ends(1, points) or [self.end(point) for point in points]

    def _outcome(self, values: Sequence[float], point: Point, message: str) -> Outcome:
        """Return the outcome of a run; a NaN becomes None."""
        ends = {name: None if math.isnan(value) else value for name, value in zip(self.names, values, strict=True)}
        return Outcome(ends, point=point, message=message)

    def by(self, executor: Executor | None, evaluate: Evaluate, points: Mapping[int, Point]) -> Outcomes:
        """Yield outcomes of runs, made here or by an executor; in batches where these pay."""
        left = dict(points)
        pays = len(left) >= PAYS_FROM and self.batched
        if pays and executor:
            groups = dict(enumerate(np.array_split(list(left), len(left) // PAYS_FROM)))
            tasks = {group: [left[number] for number in numbers] for group, numbers in groups.items()}
            for group, made in outcomes_from(executor, self.task, tasks, len(tasks)):
                yield dict(zip(groups[group].tolist(), made.result(), strict=True))
            return
        while pays and left:
            some = dict(islice(left.items(), AT_ONCE))
            outcomes = self.ends(None, list(some.values()))
            if outcomes is None:
                break
            yield dict(zip(some, outcomes, strict=True))
            left = dict(islice(left.items(), AT_ONCE, None))
        threads = os.cpu_count() or 1
        with nullcontext(executor) if executor else ThreadPoolExecutor(threads) as pool:
            for number, future in outcomes_from(pool, evaluate, left, len(left) if executor else AHEAD * threads):
                yield {number: future.result()}


def sweep(
    what: Runnable | DataSheet,
    duration: float,
    names: Sequence[str],
    vary: Any,
    executor: Executor | None = None,
    line: Line | None = None,
    folder: str | Path | None = None,
    reduce: Reduce | None = None,
    interval: float | None = None,
    **values: Value,
) -> Recording:
    """Run `run` once for each row of the columns of `vary`, and return a table with a row for each.

    A thousand runs or more with numeric values are made by `batch`, on an executor in tasks of a thousand. The results
    are bit-identical.

    Parameters
    ----------
    what : str, DataSheet, Vehicle, System or Model
        Vehicle or brake, as in `run`.
    duration : float
        Duration of each run [s].
    names : sequence of str
        Results of each run: a variable is its final value; `maximum(NAME)`, `minimum(NAME)`, `mean(NAME)` and
        `percentile(NAME, 99.85)` are of the rows of the run.
    vary : mapping of str to sequence, Recording or data frame
        Columns of equal length, shape (rows,), by the names of parameters and inputs.
    executor : Executor, optional
        Makes the runs, such as `dask.distributed.Client(...).get_executor()`. By default there is a thread for each
        processor, as the equations release Python's lock.
    line : Line, optional
        As in `run`.
    folder : str or Path, optional
        Keeps finished runs and the table. After an interruption the same call resumes.
    reduce : mapping of str to function, optional
        Own functions of the Recording of a run by `name [unit]`; it has all outputs.
    interval : float, optional
        Interval of the rows of a run [s], for statistics and own functions; by default 0.01 s.
    **values
        Values that all runs share, as in `run`.

    Returns
    -------
    Recording
        Columns of shape (rows,): number of the row, the varied values, and the variables `names` after the duration, or
        at an early end. The message of a row is that of its run. A refused run has NaN, and its message states the
        number of its row and the reason.

    Raises
    ------
    KeyError
        If a name is unknown.
    ValueError
        If columns differ in length, the duration is not above 0, or the folder holds another sweep.
    TypeError
        If own equations or functions cannot be sent to an executor, or if a folder cannot keep them.
    RuntimeError
        If an executor returns the results of another row.
    """
    duration, line = seconds("the duration", duration), line_or_none(line)
    own_law = callable(values.get(CREEP_LAW))
    vary, stated = with_units(vary)
    columns = columns_of(vary)
    not_both(columns, values, "as a column of what varies and as a value")
    given, (what, values) = (what, values), unfolded(what, values)
    values = {name: value for name, value in values.items() if name not in columns}  # those of a file may vary
    check_executor(executor, what, own_law)
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    what = model_from(what) if isinstance(what, System) else what
    what = known(what, FMUS, "FMU") if isinstance(what, str) else what
    machine = machine_of(what, {**values, **rows[0]}, line is not None)
    for name in (*vary, *values):
        known(name, machine.variables, "variable")
    columns |= {name: converted(name, columns[name], unit, machine.variables[name]) for name, unit in stated.items()}
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    results = results_of(names, machine.variables, reduce)
    check_sent(executor, results)
    once(("number", *vary, *results.names), "column")
    units = {key: machine.variables[key].unit for key in vary} | dict(results.units)
    every = interval_of(interval, results, duration)
    runs = Runs(SingleRuns(what, duration, line, results, every), values)
    arguments = {"what": encoded(given[0]), "duration": duration, "names": list(names), "vary": list(columns)}
    arguments |= {} if results.final else {"interval": every}
    arguments |= {"reduce": absent(f"own functions for {', '.join(reduce)}")} if reduce else {}
    arguments |= {"values": encoded_values(given[1], machine.variables), "line": encoded(line)}
    provenance = provenance_of("sweep", arguments, machine.identity)
    if folder is None:
        study = Study("sweep", units, results.names, rows, runs.end, {}, provenance)
        outcomes = outcomes_of(study, partial(runs.by, executor))
        return table_of(study, [outcomes[number] for number in range(len(rows))])
    head = head_of(runs, columns, units, own_law)
    study = Study(Path(folder).name, units, results.names, rows, runs.end, head, provenance)
    return table_of(study, kept_outcomes_of(study, nullcontext(partial(runs.by, executor)), Path(folder))[0])


def table_of(study: Study, outcomes: Sequence[Outcome]) -> Recording:
    """Return the table of a sweep: number, varied values and results of each row, and the messages."""
    ends = [[(outcome.results or {}).get(name) for name in study.results] for outcome in outcomes]
    rows = [[number, *row.values(), *end] for number, (row, end) in enumerate(zip(study.points, ends, strict=True))]
    messages = [one.message if one.failure is None else f"Row {row}: {one.failure}" for row, one in enumerate(outcomes)]
    units, coordinates = {"number": "1"} | dict(study.units), ("number", *study.points[0])
    return Recording(units, np.array(rows, float), messages, {"runs": len(rows)}, coordinates, study.provenance)


def head_of(
    runs: Runs, columns: Mapping[str, Sequence[float]], units: Mapping[str, str], own_law: bool = False
) -> dict[str, Any]:
    """Return the settings that all runs in one folder share.

    Raises TypeError or ValueError if a folder cannot keep them.
    """
    for name, column in columns.items():
        if not all(map(math.isfinite, column)):
            raise ValueError(f"{name} must be finite where a folder keeps the runs; got {shown(column)}.")
    refused = TypeError(
        "A folder keeps runs of ready machines and of vehicles, with numbers and tables; got equations or a function. "
        "Leave folder out."
    )
    what, line = runs.single.what, runs.single.line
    if own_law or runs.single.results.own or isinstance(what, System | Model):
        raise refused
    try:
        rest = pickle.dumps((what, line, runs.values, contents_of_files(runs.values)))
    except (pickle.PicklingError, AttributeError, TypeError):
        raise refused from None
    interval = {} if runs.single.results.final else {"interval": runs.single.interval}
    held = {name: float(value) for name, value in runs.values.items() if is_number(value)}
    return {
        "sweep": what if isinstance(what, str) else what.name,
        "vary": dict(columns),
        "held": held | {"duration": runs.single.duration} | interval,
        "units": dict(units),
        "machine, line, values": hashlib.sha256(rest).hexdigest()[:24],
    }


def contents_of_files(values: Mapping[str, Value]) -> list[str]:
    """Return the digests of the files that values name: paths alone do not decide an answer."""
    return [digest_of_file(path) for value in values.values() if isinstance(value, str) for path in files_in(value)]


def check_executor(executor: Any, what: Runnable | DataSheet, own_law: bool = False) -> None:
    """Raise TypeError if it is not an executor, or if the equations cannot be sent to one."""
    if not (executor is None or callable(getattr(executor, "submit", None))):
        raise TypeError(f"executor must be an executor of concurrent.futures, or None; got {shown(executor)}.")
    if executor and (own_law or isinstance(what, System | Model)):
        raise TypeError("Equations of your own cannot be sent to an executor; leave it out, and threads run them here.")


def check_sent(executor: Executor | None, results: Results) -> None:
    """Raise TypeError if own functions of a run cannot be sent to an executor."""
    if isinstance(executor, ThreadPoolExecutor) or executor is None:
        return
    for name, function in results.own.items():
        try:
            pickle.dumps(function)
        except (pickle.PicklingError, AttributeError, TypeError):
            raise TypeError(
                f"The function of {name} must stand at the top level of a file that the executor can import; got "
                f"{shown(function)}. Move it there, or leave the executor out."
            ) from None


def with_units(vary: Any) -> tuple[Any, dict[str, str]]:
    """Return varied columns by name, and the units that a Recording or data frame states."""
    if isinstance(vary, Mapping) and not isinstance(vary, Recording):
        return vary, {}
    arrays = named_arrays(vary, "vary")
    if arrays is None:
        return vary, {}
    heads = heads_of(arrays).values()
    return {head.name: arrays[head.cell] for head in heads}, {head.name: head.unit for head in heads if head.unit}


def converted(name: str, column: Sequence[float], unit: str, variable: Variable) -> list[float]:
    """Return a varied column in the unit of its variable. Raises ValueError."""
    both = factor(unit, variable.unit)
    if both is None:
        raise ValueError(f"{name} must be in {variable.unit}; got {unit}. Correct the unit of the column.")
    return [value * both[0] / both[1] for value in column]


def columns_of(vary: Mapping[str, Column]) -> dict[str, list[float]]:
    """Return the varied columns as numbers. Raises TypeError without names, ValueError if not numeric."""
    if not isinstance(vary, Mapping):
        raise TypeError(f"vary must have columns by name, such as {{'friction_1': [0.1, 0.2]}}; got {shown(vary)}.")
    columns = {}
    for name, column in vary.items():
        values = np.array(column)
        if values.ndim != 1 or values.size == 0 or values.dtype.kind not in "biuf" or np.ma.is_masked(column):
            raise ValueError(f"{name} must be a list of numbers, one for each run; got {shown(column)}.")
        columns[name] = values.astype(float).tolist()
    counts = sorted({len(column) for column in columns.values()})
    if len(counts) != 1:
        raise ValueError(f"All columns of vary must have the same number of values; got {counts or 'none'}.")
    return columns
