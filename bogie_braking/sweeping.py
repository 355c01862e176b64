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
from bogie_braking.checks import is_number, known, line_or_none, names_of, not_both, once, seconds, shown
from bogie_braking.histories import Column, Value
from bogie_braking.machines import CREEP_LAW, Runnable, machine_of, model_from, unfolded
from bogie_braking.simulation import Simulation
from fmu_src.compile import CompilerError
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import SimulationError
from fmu_src.system import Model, System
from products.registry import FMUS
from products.study.points import AHEAD, Evaluate, Outcome, Outcomes, Point, outcomes_from
from products.study.study import Study, kept_outcomes_of, outcomes_of
from products.vehicle_file import DataSheet
from rbd_model.track.line import Line

#: From this number of runs a batch is made: it compiles once, for as long as thousands of them take. Tasks of an
#: executor have this size then.
PAYS_FROM = 1000
#: Largest number of runs of one batch here, and of runs that a folder loses when a study is interrupted.
AT_ONCE = 10_000


@dataclass(frozen=True)
class Runs:
    """Runs that differ in the values of their points, and the names of the variables at their ends."""

    what: Runnable
    duration: float
    line: Line | None
    names: Sequence[str]
    values: Mapping[str, Value]

    def end(self, point: Point) -> Outcome:
        """Return the values at the end of one run and its messages, or the reason of its failure."""
        try:
            simulation = Simulation(self.what, self.line, **{**self.values, **point})
            advanced = simulation.advance(self.duration, self.names, self.duration)
            return self._outcome([simulation[name] for name in self.names], point, advanced.status)
        except (SimulationError, ValueError) as error:
            return Outcome(failure=str(error), point=point)

    def ends(self, threads: int | None, points: Sequence[Point]) -> list[Outcome] | None:
        """Return `end` of many points by a batch, bit-identical; None if they cannot be one.

        threads: None for all processors.
        """
        if not all(map(is_number, self.values.values())):
            return None
        columns: dict[str, Any] = {name: np.array([point[name] for point in points], float) for name in points[0]}
        try:
            made = batch(self.what, self.duration, self.names, self.line, threads, True, **{**self.values, **columns})
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
        pays = len(left) >= PAYS_FROM and all(map(is_number, self.values.values()))
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
    vary: Mapping[str, Column],
    executor: Executor | None = None,
    line: Line | None = None,
    folder: str | Path | None = None,
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
        Variables to return at the end of each run.
    vary : mapping of str to sequence
        Columns of equal length, shape (rows,), by the names of parameters and inputs.
    executor : Executor, optional
        Makes the runs, such as `dask.distributed.Client(...).get_executor()`. By default there is a thread for each
        processor, as the equations release Python's lock.
    line : Line, optional
        As in `run`.
    folder : str or Path, optional
        Keeps finished runs and the table. After an interruption the same call resumes.
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
        If your own equations should go to an executor, or if a folder cannot keep the values.
    RuntimeError
        If an executor returns the results of another row.
    """
    duration, line = seconds("the duration", duration), line_or_none(line)
    own_law = callable(values.get(CREEP_LAW))
    columns = columns_of(vary)
    not_both(columns, values, "as a column of what varies and as a value")
    what, values = unfolded(what, values)
    values = {name: value for name, value in values.items() if name not in columns}  # those of a file may vary
    check_executor(executor, what, own_law)
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    what = model_from(what) if isinstance(what, System) else what
    what = known(what, FMUS, "FMU") if isinstance(what, str) else what
    machine = machine_of(what, {**values, **rows[0]}, line is not None)
    for name in (*vary, *values):
        known(name, machine.variables, "variable")
    names = names_of(names, machine.variables)
    once(("number", *vary, *names), "column")
    varied = {key: machine.variables[key].unit for key in vary}
    results = {key: machine.variables[key].unit for key in names}
    runs, units = Runs(what, duration, line, names, values), varied | results
    if folder is None:
        study = Study("sweep", units, names, rows, runs.end, {})
        outcomes = outcomes_of(study, partial(runs.by, executor))
        return table_of(study, [outcomes[number] for number in range(len(rows))])
    head = head_of(runs, columns, units, own_law)
    study = Study(Path(folder).name, units, names, rows, runs.end, head)
    return table_of(study, kept_outcomes_of(study, nullcontext(partial(runs.by, executor)), Path(folder))[0])


def table_of(study: Study, outcomes: Sequence[Outcome]) -> Recording:
    """Return the table of a sweep: number, varied values and results of each row, and the messages."""
    ends = [[(outcome.results or {}).get(name) for name in study.results] for outcome in outcomes]
    rows = [[number, *row.values(), *end] for number, (row, end) in enumerate(zip(study.points, ends, strict=True))]
    messages = [one.message if one.failure is None else f"Row {row}: {one.failure}" for row, one in enumerate(outcomes)]
    return Recording({"number": "1"} | dict(study.units), np.array(rows, float), messages, {"runs": len(rows)})


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
    if own_law or isinstance(runs.what, System | Model):
        raise refused
    try:
        rest = pickle.dumps((runs.what, runs.line, runs.values, contents_of_files(runs.values)))
    except (pickle.PicklingError, AttributeError, TypeError):
        raise refused from None
    held = {name: float(value) for name, value in runs.values.items() if is_number(value)}
    return {
        "sweep": runs.what if isinstance(runs.what, str) else runs.what.name,
        "vary": dict(columns),
        "held": held | {"duration": runs.duration},
        "units": dict(units),
        "machine, line, values": hashlib.sha256(rest).hexdigest()[:24],
    }


def contents_of_files(values: Mapping[str, Value]) -> list[bytes]:
    """Return the digests of the files that values name: paths alone do not decide an answer."""
    texts = [value for value in values.values() if isinstance(value, str)]
    files = [Path(one.strip()) for text in texts for one in text.split(";")]
    return [hashlib.sha256(file.read_bytes()).digest() for file in files if file.is_file()]


def check_executor(executor: Any, what: Runnable | DataSheet, own_law: bool = False) -> None:
    """Raise TypeError if it is not an executor, or if the equations cannot be sent to one."""
    if not (executor is None or callable(getattr(executor, "submit", None))):
        raise TypeError(f"executor must be an executor of concurrent.futures, or None; got {shown(executor)}.")
    if executor and (own_law or isinstance(what, System | Model)):
        raise TypeError("Equations of your own cannot be sent to an executor; leave it out, and threads run them here.")


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
