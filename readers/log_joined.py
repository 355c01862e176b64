"""One log of several time bases, such as the groups of a file with rasters of their own.

The rows are those of all bases. A column has no value in the rows of other bases: nothing is interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from readers.columns import TableError
from readers.log_arrays import MOST_VALUES
from readers.log_rows import Log, check_speeds, ordered
from readers.log_times import Times
from readers.text import shown

#: Times of two bases are one row up to this distance [s], and up to this share of the least step.
SAME, SHARE = 1e-6, 0.25
#: Fewest times of a base.
FEWEST = 2


def joined(source: str, parts: Sequence[tuple[Log, Times]], messages: list[str]) -> Log:
    """Return one log; messages: of all parts, to which those about the rows are added. Raises TableError."""
    few = [log for log, _ in parts if np.count_nonzero(np.isfinite(log.numbers["time"])) < FEWEST]
    if few and len(few) < len(parts):
        names = ", ".join(shown(name) for log in few for name in list(log.numbers)[1:])
        messages.append(f"{source}: left out columns with fewer than {FEWEST} times: {names}.")
        parts = [part for part in parts if part[0] not in few]
    if len({bool(times.clock) for _, times in parts}) > 1:
        raise TableError(
            f"{source}: the times of all columns must be those of a clock, or of none; got both. Leave columns out by "
            "a map (--columns, columns=)."
        )
    begin = min(times.begin for _, times in parts)
    bases = [_counted_from(log, times.begin - begin) for log, times in parts]
    logs = [ordered(log) for log in bases]
    time, places = _rows_of([log.numbers["time"] for log in logs])
    size = time.size * (1 + sum(len(log.numbers) - 1 for log in logs))
    if size > MOST_VALUES:
        raise TableError(f"{source} must have at most {MOST_VALUES} values; its bases have {size}. Leave columns out.")
    numbers, units = {"time": time}, {"time": "s"}
    for log, at in zip(logs, places, strict=True):
        for name in list(log.numbers)[1:]:
            numbers[name] = np.full(time.size, math.nan)
            numbers[name][at] = log.numbers[name]
            units[name] = log.units[name]
    if any(at.size < time.size for at in places):
        messages.append(f"{source}: columns without values in the rows of each other: {_told(logs)}.")
    found = Log(source, numbers, units, np.arange(1, time.size + 1), messages)
    return check_speeds(found)


def _counted_from(log: Log, later: int) -> Log:
    """Return a log whose clock begins later than the first one [ns]."""
    return replace(log, numbers=log.numbers | {"time": log.numbers["time"] + later * 1e-9}) if later else log


def _rows_of(times: Sequence[NDArray[np.float64]]) -> tuple[NDArray[np.float64], list[NDArray[np.int64]]]:
    """Return the times of all bases in order, and the row of each value of each base."""
    step = min(float(np.min(np.diff(one))) for one in times)
    every = np.sort(np.concatenate(times))
    for distance in (min(SAME, SHARE * step), 0.0):
        rows = every[np.append(True, np.diff(every) > distance)]
        places = [np.searchsorted(rows, one, "right") - 1 for one in times]
        if all(np.all(np.diff(at) > 0) for at in places):
            break
    return rows, places


def _told(logs: Sequence[Log]) -> str:
    """Return the names of the columns of each base with their usual step."""
    found = []
    for log in logs:
        names = list(log.numbers)[1:]
        more = f" and {len(names) - 4} more" if len(names) > 4 else ""
        step = float(np.median(np.diff(log.numbers["time"])))
        found.append(f"{', '.join(names[:4])}{more} (each {step:.4g} s)")
    return "; ".join(found[:8]) + (f" and {len(found) - 8} more" if len(found) > 8 else "")
