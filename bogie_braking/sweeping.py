"""One run for each of many sets of values, side by side: what they end with is one table."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from functools import partial

from tqdm import tqdm

from bogie_braking.fmus import known
from bogie_braking.simulation import Simulation
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import KernelError
from fmu_src.progress import PATIENCE
from products.building import variables_of


def end_of(
    name: str, duration: float, names: Sequence[str], values: Mapping[str, float | str]
) -> tuple[list[float], str]:
    """Values of `names` at the end of one run, and what it said; NaN, and why, where it could not be made."""
    try:
        one = Simulation(name)
        one.set(**dict(values))
        found = one.advance(duration, names, duration)
    except KernelError as error:
        return [math.nan] * len(names), str(error)
    return [one[asked] for asked in names], found.status


def sweep(
    name: str,
    duration: float,
    names: Sequence[str],
    vary: Mapping[str, Sequence[float]],
    executor: Executor | None = None,
    **values: float | str,
) -> Recording:
    """Runs as `run` makes them, one for each row of the equally long columns of `vary`: a row for each.

    Columns are the row's number, what is varied, and the variables `names` after the duration [s], or as a run ended
    before. The sentence of a row is what its run said. A run that is refused has NaN there, and its sentence says why.
    executor: what runs them, such as `dask.distributed.Client(...).get_executor()`; by default a thread for each
    processor, as the equations leave Python's lock. Raises KeyError for a name that there is not, ValueError where
    columns differ in length.
    """
    counts = {len(column) for column in vary.values()}
    every = variables_of(known(name))
    units = {"number": "1"} | {key: every[known(key, every, "variable")].unit for key in (*vary, *names)}
    if len(counts) != 1:
        raise ValueError(f"Give all that varies the same number of values: there are {sorted(counts)}.")
    rows = [dict(zip(vary, map(float, row), strict=True)) for row in zip(*vary.values(), strict=True)]
    one = partial(end_of, name, duration, list(names))
    given: list[dict[str, float | str]] = [{**values, **row} for row in rows]
    with nullcontext(executor) if executor else ThreadPoolExecutor(os.cpu_count()) as runs:
        ends = list(tqdm(runs.map(one, given), name, len(rows), delay=PATIENCE, leave=False, unit="run"))
    table = [[number, *row.values(), *end] for number, (row, (end, _)) in enumerate(zip(rows, ends, strict=True))]
    return Recording(units, table, [said for _, said in ends], {"runs": len(rows)})
