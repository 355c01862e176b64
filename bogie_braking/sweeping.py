"""Parameter studies: one run for each of many sets of values, and a table of their last values."""

from __future__ import annotations

import hashlib
import math
import os
import pickle
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
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
#: Outcomes of many points at once; None if they cannot be a batch. threads: None for all processors.
Batch = Callable[[int | None, Sequence[Point]], list[Outcome] | None]


def end_of(
    what: Runnable,
    duration: float,
    line: Line | None,
    names: Sequence[str],
    values: Mapping[str, Value],
    point: Point,
) -> Outcome:
    """Return the values of `names` at the end of one run and its messages, or the reason of its failure."""
    try:
        one = Simulation(what, line, **{**values, **point})
        found = one.advance(duration, names, duration)
        return outcome_of(names, [one[asked] for asked in names], point, found.status)
    except (SimulationError, ValueError) as error:
        return Outcome(failure=str(error), point=point)


def outcome_of(names: Sequence[str], values: Sequence[float], point: Point, message: str) -> Outcome:
    """Return the outcome of a run; a NaN becomes None."""
    ends = {name: None if math.isnan(value) else value for name, value in zip(names, values, strict=True)}
    return Outcome(ends, point=point, message=message)


def in_batch(
    what: Runnable,
    duration: float,
    line: Line | None,
    names: Sequence[str],
    values: Mapping[str, Value],
    threads: int | None,
    points: Sequence[Point],
) -> list[Outcome] | None:
    """Return `end_of` of many points with numeric values, bit-identical, or None if it fails."""
    columns = {name: np.array([point[name] for point in points], float) for name in points[0]}
    try:
        ends = batch(what, duration, names, line, threads, messages=True, **{**values, **columns})  # type: ignore[arg-type]
    except (CompilerError, SimulationError, ValueError):  # alone, each run reports the reason
        return None
    rows = zip(points, np.column_stack([ends[name] for name in names]).tolist(), ends.messages or [], strict=True)
    return [
        Outcome(failure=message, point=point)
        if message and all(map(math.isnan, row))
        else outcome_of(names, row, point, message)
        for point, row, message in rows
    ]


def task(many: Batch, evaluate: Evaluate, points: Sequence[Point]) -> list[Outcome]:
    """Run one task of an executor: many runs."""
    return many(1, points) or [evaluate(point) for point in points]


def run_by(executor: Executor | None, many: Batch | None, evaluate: Evaluate, points: Mapping[int, Point]) -> Outcomes:
    """Yield outcomes of runs, made here or by an executor; in batches if `many` makes them and they pay."""
    left = dict(points)
    pays = many is not None and len(left) >= PAYS_FROM
    if many and pays and executor:
        groups = dict(enumerate(np.array_split(list(left), len(left) // PAYS_FROM)))
        tasks = {group: [left[number] for number in numbers] for group, numbers in groups.items()}
        for group, made in outcomes_from(executor, partial(task, many, evaluate), tasks, len(tasks)):
            yield dict(zip(groups[group].tolist(), made.result(), strict=True))
        return
    while many and pays and left:
        some = dict(islice(left.items(), AT_ONCE))
        outcomes = many(None, list(some.values()))
        if outcomes is None:
            break
        yield dict(zip(some, outcomes, strict=True))
        left = dict(islice(left.items(), AT_ONCE, None))
    threads = os.cpu_count() or 1
    with nullcontext(executor) if executor else ThreadPoolExecutor(threads) as runs:
        for number, future in outcomes_from(runs, evaluate, left, len(left) if executor else AHEAD * threads):
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
    numbers = all(map(is_number, values.values()))
    many = partial(in_batch, what, duration, line, names, values) if numbers else None
    run_points = partial(run_by, executor, many)
    study = Study(
        "sweep" if folder is None else Path(folder).name,
        varied | results,
        names,
        rows,
        partial(end_of, what, duration, line, names, values),
        {} if folder is None else head_of(what, duration, columns, varied | results, line, values, own_law),
    )
    if folder is None:
        found = outcomes_of(study, run_points)
        return table_of(study, [found[number] for number in range(len(rows))])
    return table_of(study, kept_outcomes_of(study, nullcontext(run_points), Path(folder))[0])


def table_of(study: Study, outcomes: Sequence[Outcome]) -> Recording:
    """Return the table of a sweep: number, varied values and results of each row, and the messages."""
    ends = [[(one.results or {}).get(name) for name in study.results] for one in outcomes]
    rows = [[number, *row.values(), *end] for number, (row, end) in enumerate(zip(study.points, ends, strict=True))]
    messages = [one.message if one.failure is None else f"Row {row}: {one.failure}" for row, one in enumerate(outcomes)]
    return Recording({"number": "1"} | dict(study.units), np.array(rows, float), messages, {"runs": len(rows)})


def head_of(
    what: Runnable,
    duration: float,
    columns: Mapping[str, Sequence[float]],
    units: Mapping[str, str],
    line: Line | None,
    values: Mapping[str, Value],
    own_law: bool = False,
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
    if own_law or isinstance(what, System | Model):
        raise refused
    try:
        rest = hashlib.sha256(pickle.dumps((what, line, values, contents_of_files(values)))).hexdigest()[:24]
    except (pickle.PicklingError, AttributeError, TypeError):
        raise refused from None
    held = {name: float(value) for name, value in values.items() if is_number(value)}
    name = what if isinstance(what, str) else what.name
    return {
        "sweep": name,
        "vary": dict(columns),
        "held": held | {"duration": duration},
        "units": dict(units),
        "machine, line, values": rest,
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
