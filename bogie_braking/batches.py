"""Many runs of one vehicle at once, and many instances advanced together in control steps, as arrays."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bogie_braking.checks import (
    MOST_INSTANCES,
    MOST_THREADS,
    at_most,
    known,
    line_or_none,
    names_of,
    once,
    refused,
    seconds,
    shown,
    whole,
)
from bogie_braking.line_in_file import file_of
from bogie_braking.machines import Runnable, batch_machine_of, machine_of, model_from, unfolded
from bogie_braking.provenance import encoded, encoded_value
from bogie_braking.reducers import interval_of, is_statistic, results_of
from bogie_braking.single_runs import SingleRuns
from fmu_src.batch import BatchLibrary, Ends, Instances, run_batch, table_of
from fmu_src.cosimulation.recording import Recording
from fmu_src.system import System, Variable
from products.run_history import provenance_of
from products.vehicle_sheet import DataSheet
from rbd_model.contact.pair_file import PAIR_FILE
from rbd_model.track.line import Line
from readers.usual import almost_0, is_almost_0, note

#: Parameters that name a file of all runs; a line is given as such.
FILES = (PAIR_FILE.variable.name,)


def batch(
    what: Runnable | DataSheet,
    duration: float,
    outputs: Sequence[str],
    line: Line | None = None,
    threads: int | None = None,
    messages: bool = False,
    interval: float | None = None,
    **values: ArrayLike,
) -> BatchEnds:
    """Run one vehicle many times over a duration, in vector lanes and threads.

    Each run is bit-identical with the same run made alone. Runs with statistics are made one by one, in threads.

    Parameters
    ----------
    what : str, DataSheet, Vehicle, System or Model
        Vehicle or brake, as in `run`.
    duration : float
        Duration of each run [s].
    outputs : sequence of str
        Results of each run: variables at its end, or statistics as in `sweep`.
    line : Line, optional
        As in `run`.
    threads : int, optional
        Number of threads; by default the number of processors.
    messages : bool
        Whether to keep the messages of each run, too.
    interval : float, optional
        Interval of the rows of a run [s], for statistics; by default 0.01 s.
    **values : float or array
        Parameters and inputs by name, in SI units: one number for all runs, or an array of shape (runs,). Parameters
        that choose the equations, such as `level`, take one number.

    Returns
    -------
    BatchEnds
        Values by name, each of shape (runs,). A run that cannot be made has NaN, and `failures` states the reason.
        `table` is a Recording with a row for each run.

    Raises
    ------
    KeyError
        If a name is unknown.
    ValueError
        If a value is not numeric, if arrays differ in length, or if the level does not exist.
    SimulationError
        If a value is invalid, or a line is given to equations without one.
    CompilerError
        If no C compiler works.
    """
    duration = seconds("the duration", duration)
    threads = threads_or_none(threads)
    if not isinstance(outputs, str) and any(map(is_statistic, outputs)):
        ends, given, units, identity = _single_ends(what, duration, outputs, line, threads, messages, interval, values)
    else:
        library, given = prepared(what, line, values, ("messages", "interval"))
        variables, identity = variables_of_batch(library), library.identity
        results = results_of(outputs, variables)
        interval_of(interval, results, duration)
        with tempfile.TemporaryDirectory() as folder:
            ends = run_batch(library, given, duration, results.names, threads, file_of(line, folder), messages)
        ends = _with_notes(ends, library, given)
        units = {name: variables[name].unit for name in given if name in variables} | dict(results.units)
    columns = {name: value for name, value in given.items() if not isinstance(value, str) and value.ndim}
    arguments = {"what": encoded(what), "duration": duration, "outputs": list(outputs), "vary": list(columns)}
    arguments |= {"values": {name: encoded_value(value) for name, value in values.items() if name not in columns}}
    arguments |= {"line": encoded(line)} | ({} if interval is None else {"interval": interval})
    provenance = provenance_of("batch", arguments, identity)
    units = {name: units[name] for name in (*columns, *ends.outputs)}
    return BatchEnds(**vars(ends), given=columns, units=units, provenance=provenance)


def _single_ends(
    what: Runnable | DataSheet,
    duration: float,
    outputs: Sequence[str],
    line: Line | None,
    threads: int | None,
    messages: bool,
    interval: float | None,
    values: Mapping[str, ArrayLike],
) -> tuple[Ends, dict[str, np.ndarray | str], dict[str, str], str]:
    """Return the ends of runs with statistics, their values, all units, and the identity of the equations."""
    what, values = unfolded(what, values)
    what, line = model_from(what) if isinstance(what, System) else what, line_or_none(line)
    files, numbers = _parted(values)
    table = table_of(numbers)
    first = dict(zip(numbers, table[0].tolist(), strict=True)) if len(table) else {}
    machine = machine_of(what, {**files, **first}, line is not None)
    for name in values:
        known(name, machine.variables, "variable")
    results = results_of(outputs, machine.variables)
    single = SingleRuns(what, duration, line, results, interval_of(interval, results, duration))
    points = [{**files, **dict(zip(numbers, row, strict=True))} for row in table.tolist()]
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        ends = list(pool.map(single.end_or_failure, points))
    rows = np.array([end.results for end in ends]).reshape(-1, len(results.names))
    failures = {run: end.failure for run, end in enumerate(ends) if end.failure}
    units = {name: machine.variables[name].unit for name in numbers} | dict(results.units)
    return (
        Ends(
            dict(zip(results.names, rows.T, strict=True)),
            np.array([end.time for end in ends]),
            np.array([end.ended for end in ends], bool),
            failures,
            [end.failure or end.status for end in ends] if messages else None,
        ),
        {**numbers, **files},
        units,
        machine.identity,
    )


@dataclass(frozen=True)
class BatchEnds(Ends):
    """Results of a batch, which also are a table.

    Attributes
    ----------
    given : dict of str to ndarray
        Varied values by name.
    units : dict of str to str
        Units of these and of the outputs.
    provenance : dict
        What was run, as in a Recording.
    """

    given: dict[str, np.ndarray] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def table(self) -> Recording:
        """Return number, varied values and outputs of each run, shape (runs,), with its message."""
        count = self.time.size
        columns = {"number": np.arange(count), **self.given, **self.outputs}
        ends = [f"Ended at {time:g} s." if ended else "" for time, ended in zip(self.time, self.ended, strict=True)]
        messages = self.messages or [self.failures.get(run, end) for run, end in enumerate(ends)]
        rows, units = np.column_stack(list(columns.values())), {"number": "1"} | self.units
        return Recording(units, rows, messages, {"runs": count}, ("number", *self.given), self.provenance)


def _with_notes(ends: Ends, library: BatchLibrary, given: Mapping[str, np.ndarray | str]) -> Ends:
    """Return the ends with messages about rare values, before those of each run, as a single run has them."""
    if ends.messages is None:
        return ends
    variables, said = variables_of_batch(library), list(ends.messages)
    for name in reversed([name for name, value in given.items() if name in variables and not isinstance(value, str)]):
        for run, value in enumerate(np.broadcast_to(given[name], len(said)).tolist()):
            if run not in ends.failures and (text := note(name, value, variables[name].unit)):
                said[run] = " ".join(filter(None, (text, said[run])))
    return replace(ends, messages=said)


def instances(
    what: Runnable | DataSheet,
    count: int,
    inputs: Sequence[str],
    outputs: Sequence[str],
    line: Line | None = None,
    threads: int | None = None,
    **values: ArrayLike,
) -> Instances:
    """Return instances of one vehicle that advance together in control steps, for controllers on arrays.

    Vector environments of Gymnasium or EnvPool can be built on it. `step(size, {input: array})` advances all instances
    by `size` [s] and returns outputs by name. It uses the same arrays at every step: copy values to keep them. An
    instance that ends, such as by a derailment, keeps its last state. `ended` marks these rows, and `reset(rows,
    **values)` restarts them. A step that fails raises SimulationError. Use the object as a context manager, or call
    `close`.

    Parameters
    ----------
    what : str, DataSheet, Vehicle, System or Model
        Vehicle or brake, as in `run`.
    count : int
        Number of instances.
    inputs : sequence of str
        Names of the inputs that `step` sets.
    outputs : sequence of str
        Names of the variables that `step` returns.
    line : Line, optional
        As in `run`.
    threads : int, optional
        Number of threads; by default the number of processors.
    **values : float or array
        Parameters and inputs at the start, as in `batch`; arrays have shape (count,).

    Returns
    -------
    Instances
        The instances at time 0.

    Raises
    ------
    TypeError
        If `inputs` is a string.
    ValueError
        If `count` is not an integer of at least 1, or for the reasons given in `batch`.
    KeyError
        If a name is unknown.
    SimulationError
        If a value is invalid.
    CompilerError
        If no C compiler works.
    """
    count = at_most("instances", whole("the number of instances", count, 1), MOST_INSTANCES)
    library, given = prepared(what, line, values)
    variables = variables_of_batch(library)
    takes = [variable.name for variable in variables.values() if variable.causality == "input"]
    if isinstance(inputs, str):
        raise TypeError(f'inputs must be a list of names, such as ["{inputs}"]; got the text {inputs!r}.')
    names = once([known(name, takes, "input") for name in inputs], "input"), names_of(outputs, variables)
    with ExitStack() as kept:
        folder = kept.enter_context(tempfile.TemporaryDirectory())
        more: dict[str, Any] = {"threads": threads_or_none(threads), "path": file_of(line, folder), **given}
        made = Instances(library, count, *names, **more)
        made.at_close = kept.pop_all().close  # a restarted instance reads the line again
    return made


def prepared(
    what: Runnable | DataSheet, line: Line | None, values: Mapping[str, ArrayLike], options: Sequence[str] = ()
) -> tuple[BatchLibrary, dict[str, np.ndarray | str]]:
    """Return the compiled system, and the values as arrays of numbers, or as the path of a file.

    options: further names in messages.
    """
    what, values = unfolded(what, values)
    line = line_or_none(line)
    files, numbers = _parted(values)
    single: dict[str, Any] = {name: one.item(0) for name, one in numbers.items() if one.size and not np.ptp(one)}
    library = batch_machine_of(what, single, line is not None)
    for name in values:
        known(name, [*variables_of_batch(library), *options], "variable")
    variables = variables_of_batch(library)
    for name in numbers.keys() & variables.keys():
        unit, most = variables[name].unit, variables[name].maximum
        if small := [value for value in numbers[name].ravel().tolist() if is_almost_0(value, unit)]:
            raise refused(almost_0(name, small[0], unit, most))
    for name in library.model.selectors:
        if name in numbers.keys() - single.keys():
            raise ValueError(
                f"{name} must be one number for all runs, because it chooses their equations. Make a batch of each."
            )
    if line is not None and not library.file:
        raise refused(f"{library.model.name} runs on no line; leave the line out.")
    return library, {**numbers, **files}


def _parted(values: Mapping[str, Any]) -> tuple[dict[str, str], dict[str, np.ndarray]]:
    """Return the paths of files, and the numbers as arrays."""
    files = {name: value for name, value in values.items() if name in FILES and isinstance(value, str)}
    return files, {name: _numbers(name, value) for name, value in values.items() if name not in files}


def _numbers(name: str, value: ArrayLike) -> np.ndarray:
    """Return one number or a row of them as an array. Raises ValueError."""
    found = np.asarray(value)
    if found.ndim > 1 or found.dtype.kind not in "biuf" or np.ma.is_masked(value):
        raise ValueError(f"{name} must be one number, or a list of numbers, one for each run; got {shown(value)}.")
    return found.astype(float)


def variables_of_batch(library: BatchLibrary) -> dict[str, Variable]:
    """Return the variables of a batch by name."""
    return {variable.name: variable for variable in library.model.variables}


def threads_or_none(count: int | None) -> int | None:
    """Return the number of threads, or None for one per processor. Raises ValueError."""
    return None if count is None else at_most("threads", whole("the number of threads", count, 1), MOST_THREADS)
