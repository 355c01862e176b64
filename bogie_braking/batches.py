"""Many runs of one machine at once, and many instances that go on in steps: arrays in, arrays out."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
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
)
from bogie_braking.machines import Runnable, batch_machine_of
from fmu_src.batch import BatchLibrary, Ends, Instances, run_batch
from fmu_src.system import Variable
from rbd_model.track.line import Line
from readers.storage import ANOTHER_TEMPORARY, writing


def batch(
    what: Runnable,
    duration: float,
    outputs: Sequence[str],
    line: Line | None = None,
    threads: int | None = None,
    said: bool = False,
    **values: ArrayLike,
) -> Ends:
    """Many runs of one machine over a duration [s], in vector lanes and threads; what each ends with.

    what, line: as `run` takes them. outputs: names of variables, whose values at the end of each run are arrays, by
    name. threads: as many as there are processors. said: whether to keep what each run said, too. values: parameters
    and inputs by name, in SI units, one number for all runs or an array with one for each; what chooses the equations,
    such as `level`, one number. Each run has the bits that it has alone. A run that cannot be made has NaN, and
    `failures` says why. Raises KeyError for another name, ValueError for what are no numbers, for arrays that differ in
    length, and for a level that there is not, SimulationError, CompilerError where no C compiler works.
    """
    duration = seconds("the duration", duration)
    library, given = prepared(what, line, values)
    names = names_of(outputs, variables_of_batch(library))
    with tempfile.TemporaryDirectory() as folder:
        return run_batch(library, given, duration, names, threads_or_none(threads), file_of(line, folder), said)


def instances(
    what: Runnable,
    count: int,
    inputs: Sequence[str],
    outputs: Sequence[str],
    line: Line | None = None,
    threads: int | None = None,
    **values: ArrayLike,
) -> Instances:
    """Many instances of one machine that go on in control steps together, as controllers that are functions of arrays
    ask them to: what vector environments of Gymnasium or EnvPool are made of.

    what, line, threads, values: as `batch` takes them. inputs, outputs: names of those that steps set and read.
    `step(size, {input: array})` goes on by `size` seconds and gives outputs by name, in the same arrays at every step:
    copy what is to be kept. A run that ends, such as by a derailment, stays where it ended; `ended` tells which rows,
    and `reset(rows, **values)` begins them anew. A step that fails raises SimulationError. It is a context manager;
    without a `with`, call `close`.
    """
    if not isinstance(count, int | np.integer) or count < 1:
        raise ValueError(f"Give a whole number of instances, at least 1: it was {shown(count)}.")
    at_most("instances", int(count), MOST_INSTANCES)
    library, given = prepared(what, line, values)
    variables = variables_of_batch(library)
    takes = [one.name for one in variables.values() if one.causality == "input"]
    if isinstance(inputs, str):
        raise TypeError(f'Give the names of inputs as a list, such as ["{inputs}"]: it was the text {inputs!r}.')
    names = once([known(name, takes, "input") for name in inputs], "input"), names_of(outputs, variables)
    with ExitStack() as kept:
        folder = kept.enter_context(tempfile.TemporaryDirectory())
        more: dict[str, Any] = {"threads": threads_or_none(threads), "path": file_of(line, folder), **given}
        made = Instances(library, int(count), *names, **more)
        made.at_close = kept.pop_all().close  # an instance that begins anew reads the line again
    return made


def prepared(
    what: Runnable, line: Line | None, values: Mapping[str, ArrayLike]
) -> tuple[BatchLibrary, dict[str, np.ndarray]]:
    """The compiled system, and values as arrays of numbers."""
    line = line_or_none(line)
    given = {name: _numbers(name, value) for name, value in values.items()}
    single: dict[str, Any] = {name: one.item(0) for name, one in given.items() if one.size and not np.ptp(one)}
    library = batch_machine_of(what, single, line is not None)
    for name in values:
        known(name, variables_of_batch(library), "variable")
    for name in library.model.selectors:
        if name in given.keys() - single.keys():
            raise ValueError(f"Give {name} one number for all runs: it chooses their equations; make a batch of each.")
    if line is not None and not library.file:
        raise refused(f"{library.model.name} runs on no line; leave the line out.")
    return library, given


def _numbers(name: str, value: ArrayLike) -> np.ndarray:
    """One number or a row of them."""
    found = np.asarray(value)
    if found.ndim > 1 or found.dtype.kind not in "biuf" or np.ma.is_masked(value):
        raise ValueError(f"Give {name} one number, or a list of numbers, one for each run: it was {shown(value)}.")
    return found.astype(float)


def variables_of_batch(library: BatchLibrary) -> dict[str, Variable]:
    """By name."""
    return {one.name: one for one in library.model.variables}


def threads_or_none(count: int | None) -> int | None:
    """How many threads make runs; None: one for each processor. Raises ValueError."""
    if count is not None and (not isinstance(count, int | np.integer) or count < 1):
        raise ValueError(f"Give a whole number of threads, at least 1: it was {shown(count)}.")
    return None if count is None else at_most("threads", int(count), MOST_THREADS)


def file_of(line: Line | None, folder: str) -> str | None:
    """The path of the file of a line, written into a temporary folder. Raises StorageError."""
    if line is None:
        return None
    with writing(Path(folder), ANOTHER_TEMPORARY):
        return str(line.write(Path(folder) / "line.csv"))
