"""One run for each of many sets of values, side by side: what they end with is one table."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from functools import partial
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from tqdm import tqdm

from bogie_braking.batches import batch
from bogie_braking.checks import is_number, known, line_or_none, names_of, not_both, once, seconds, shown
from bogie_braking.histories import Column, Value
from bogie_braking.machines import Runnable, machine_of, model_from
from bogie_braking.simulation import Simulation
from fmu_src.compile import CompilerError
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import KernelError
from fmu_src.progress import PATIENCE
from fmu_src.system import Model, System
from rbd_model.track.line import Line

#: From so many runs on a batch is made, for its compilation takes, once, as long as thousands of them. A task of an
#: executor is so many runs then.
PAYS_FROM = 1000
#: Values and sentences of one run.
Ending = tuple[list[float], str]
Task = TypeVar("Task")
Answer = TypeVar("Answer")


def end_of(
    what: Runnable, duration: float, line: Line | None, names: Sequence[str], values: Mapping[str, Value]
) -> Ending:
    """Values of `names` at the end of one run, and what it said; NaN, and why, where it could not be made."""
    try:
        one = Simulation(what, line, **values)
        found = one.advance(duration, names, duration)
        return [one[asked] for asked in names], found.status
    except (KernelError, ValueError) as error:
        return [math.nan] * len(names), str(error)


def in_batch(
    what: Runnable,
    duration: float,
    line: Line | None,
    names: Sequence[str],
    threads: int | None,
    given: Sequence[Mapping[str, Any]],
) -> list[Ending] | None:
    """`end_of` of many runs whose values are numbers, with the same bits and sentences; None where none can be."""
    values = {name: np.array([row[name] for row in given], float) for name in given[0]}
    try:
        ends = batch(what, duration, names, line, threads, said=True, **values)
    except (CompilerError, KernelError, ValueError):  # alone, each run says why
        return None
    rows = np.column_stack([ends[name] for name in names]).tolist()
    return list(zip(rows, ends.said or [], strict=True))


def mark_of(values: Mapping[str, ArrayLike]) -> str:
    """Return a digest of names and numbers, to all digits."""
    found = hashlib.sha256()
    for name, value in values.items():
        found.update(name.encode() + b"\0" + np.array(value, float).tobytes())
    return found.hexdigest()


def marked(mark: Callable[[Task], str], work: Callable[[Task], Answer], task: Task) -> tuple[str, Answer]:
    """Return the mark of a task and the result of the work on it. Workers run this."""
    return mark(task), work(task)


def of_their_tasks(
    mark: Callable[[Task], str], tasks: Sequence[Task], answers: Iterable[tuple[str, Answer]]
) -> Iterator[Answer]:
    """Yield answers in the order of their tasks. Raises RuntimeError if one is that of another task."""
    for number, (task, (own, answer)) in enumerate(zip(tasks, answers, strict=True)):
        if own != mark(task):
            raise RuntimeError(
                f"The executor's map must give results in the order of its tasks; got another one's for task {number}. "
                "Give an executor of concurrent.futures, or none."
            )
        yield answer


def task(
    what: Runnable, duration: float, line: Line | None, names: Sequence[str], given: Sequence[Mapping[str, Any]]
) -> list[Ending]:
    """What an executor is given: many runs."""
    ends = in_batch(what, duration, line, names, 1, given)
    return [end_of(what, duration, line, names, row) for row in given] if ends is None else ends


def ends_of(
    what: Runnable,
    duration: float,
    line: Line | None,
    names: Sequence[str],
    given: Sequence[Mapping[str, Value]],
    executor: Executor | None,
    varied: Sequence[str],
) -> list[Ending]:
    """`end_of` of all runs, here or by an executor, in batches where these pay; varied: names by which runs differ."""
    pays = len(given) >= PAYS_FROM and all(is_number(value) for value in given[0].values())
    if pays and executor:
        tasks = [list(some) for some in np.array_split(np.array(given, object), len(given) // PAYS_FROM)]
        mark = partial(mark_of_rows, varied)
        made = executor.map(partial(marked, mark, partial(task, what, duration, line, names)), tasks)
        bar = tqdm(of_their_tasks(mark, tasks, made), "sweep", len(tasks), delay=PATIENCE, leave=False, unit="batch")
        return [end for some in bar for end in some]
    ends = in_batch(what, duration, line, names, None, given) if pays else None
    if ends is not None:
        return ends
    own = partial(mark_of_row, varied)
    one = partial(marked, own, partial(end_of, what, duration, line, names))
    with nullcontext(executor) if executor else ThreadPoolExecutor(os.cpu_count()) as runs:
        done = of_their_tasks(own, given, runs.map(one, given))
        return list(tqdm(done, "sweep", len(given), delay=PATIENCE, leave=False, unit="run"))


def mark_of_row(varied: Sequence[str], row: Mapping[str, Any]) -> str:
    """Return the mark of one run."""
    return mark_of({name: row[name] for name in varied})


def mark_of_rows(varied: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the mark of many runs."""
    return mark_of({name: [row[name] for row in rows] for name in varied})


def sentences_of(ends: Sequence[Ending]) -> list[str]:
    """What runs said; of one that was refused with the number of its row."""
    refused = (all(map(math.isnan, values)) and said for values, said in ends)
    return [
        f"Row {row}: {said}" if one else said for row, (one, (_, said)) in enumerate(zip(refused, ends, strict=True))
    ]


def sweep(
    what: Runnable,
    duration: float,
    names: Sequence[str],
    vary: Mapping[str, Column],
    executor: Executor | None = None,
    line: Line | None = None,
    **values: Value,
) -> Recording:
    """Runs as `run` makes them, one for each row of the equally long columns of `vary`: a row for each.

    Columns have shape (rows,): the row's number, what is varied, and the variables `names` after the duration [s], or
    as a run ended before. The sentence of a row is what its run said. A run that is refused has NaN there, and its
    sentence says why, after the number of its row. executor: what runs them, such as
    `dask.distributed.Client(...).get_executor()`; by default a thread for each processor, as the equations leave
    Python's lock. A thousand runs or more whose values are numbers are made by `batch`, on an executor a thousand a
    task; that changes no bit. Raises KeyError for a name that there is not, ValueError where columns differ in length
    or the duration is not above 0, TypeError for equations of one's own on an executor, which they cannot be sent to,
    RuntimeError where an executor gives another row's results.
    """
    duration, line = seconds("the duration", duration), line_or_none(line)
    check_executor(executor, what)
    columns = columns_of(vary)
    not_both(columns, values, "as a column of what varies and as a value")
    rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    what = model_from(what) if isinstance(what, System) else what
    machine = machine_of(what, {**values, **rows[0]}, line is not None)
    for name in (*vary, *values):
        known(name, machine.variables, "variable")
    names = names_of(names, machine.variables)
    once(("number", *vary, *names), "column")
    units = {"number": "1"} | {key: machine.variables[key].unit for key in (*vary, *names)}
    given: list[dict[str, Value]] = [{**values, **row} for row in rows]
    ends = ends_of(what, duration, line, names, given, executor, list(columns))
    table = [[number, *row.values(), *end] for number, (row, (end, _)) in enumerate(zip(rows, ends, strict=True))]
    return Recording(units, table, sentences_of(ends), {"runs": len(rows)})


def check_executor(executor: Any, what: Runnable) -> None:
    """Raises TypeError for what is no executor, and for equations that none can be sent."""
    if not (executor is None or callable(getattr(executor, "map", None))):
        raise TypeError(f"Give an executor of concurrent.futures, or none: it was {shown(executor)}.")
    if executor and isinstance(what, System | Model):
        raise TypeError("Equations of your own cannot be sent to an executor; leave it out, and threads run them here.")


def columns_of(vary: Mapping[str, Column]) -> dict[str, list[float]]:
    """What varies, as numbers. Raises TypeError for what has no names, ValueError for no numbers."""
    if not isinstance(vary, Mapping):
        raise TypeError(f"Give what varies by its names, such as {{'friction_1': [0.1, 0.2]}}: it was {shown(vary)}.")
    columns = {}
    for name, column in vary.items():
        values = np.array(column)
        if values.ndim != 1 or values.size == 0 or values.dtype.kind not in "biuf" or np.ma.is_masked(column):
            raise ValueError(f"Give {name} a list of numbers, one for each run: it was {shown(column)}.")
        columns[name] = values.astype(float).tolist()
    counts = sorted({len(column) for column in columns.values()})
    if len(counts) != 1:
        raise ValueError(f"Give all that varies the same number of values: there are {counts or 'none'}.")
    return columns
