"""A measured run from a CSV file: a table as Recording.write makes it, looked at row by row."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import numpy as np

from fmu_src.cosimulation.recording import Recording


def table_from(path: Path) -> Recording:
    """The table of a file with a head of names with units, time first, and rows of numbers.

    Raises ValueError with the line where it is none, OSError for a file that cannot be read.
    """
    with path.open(encoding="utf-8-sig", newline="") as file:
        try:
            lines = list(csv.reader(file))
        except (UnicodeDecodeError, csv.Error) as error:
            raise ValueError(f"{path} is no CSV file ({error}); give a table of text.") from None
    if lines and len(lines[0]) == 1 and ";" in lines[0][0]:
        raise ValueError(f"{path}: part columns by commas, and write numbers with points.")
    heads = [re.fullmatch(r"\s*(\w+)\s*\[(.+)\]\s*", one) for one in lines[0]] if lines else []
    if not heads or None in heads or heads[0][1] != "time":  # type: ignore[index]
        raise ValueError(f"{path}: give the first line names with units, time first, such as: time [s],speed [m/s]")
    units = {head[1]: head[2] for head in heads if head}
    if len(units) < len(heads):
        raise ValueError(f"{path}: give each column a name of its own; there are {', '.join(lines[0])}.")
    rows = [_row(path, place, line, len(heads)) for place, line in enumerate(lines[1:], 2)]
    times = np.array([row[0] for row in rows])
    if times.size < 2:
        raise ValueError(f"{path}: give at least two rows whose time grows.")
    back = np.flatnonzero(np.diff(times) <= 0.0)
    if back.size:
        place = int(back[0])
        raise ValueError(
            f"{path}, line {place + 3}: give at least two rows whose time grows; {times[place + 1]:g} s came behind "
            f"{times[place]:g} s."
        )
    return Recording(units, rows)


def _row(path: Path, place: int, line: list[str], count: int) -> list[float]:
    try:
        row = [float(one) for one in line]
    except ValueError:
        row = []
    if len(row) != count or not np.all(np.isfinite(row)):
        raise ValueError(f"{path}, line {place}: give {count} finite numbers; there is {','.join(line)!r}.")
    return row
