"""A measured run from a file: a table as Recording.write makes it, or a log of a user (`readers/logs.py`)."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fmu_src.cosimulation.recording import Recording
from readers.column_names import tidy
from readers.log_columns import COMMON, ColumnMap
from readers.log_rows import events_apart
from readers.logs import read_log
from readers.units import factor


def table_from(
    path: str | Path, variables: Mapping[str, str] | None = None, columns: ColumnMap | None = None
) -> Recording:
    """Return the log of a file; its messages name guessed, converted and omitted columns."""
    log = read_log(path, COMMON if variables is None else variables, columns, others=variables is None)
    return Recording(log.units, np.column_stack(list(log.numbers.values())), log.messages)


def in_units_of(table: Recording, units: Mapping[str, str]) -> Recording:
    """Return a table whose columns have the names and units of variables, if these exist and can be converted to.

    units: of the variables, by name. Other columns are unchanged, as are those in a unit of another quantity. Rows of
    one time are an event, as in a log.
    """
    known = {tidy(name): name for name in units} | {name: name for name in units}
    names = {name: known.get(name, known.get(tidy(name), name)) for name in table.names}
    if len(set(names.values())) < len(names):
        names = {name: name for name in table.names}
    found: dict[str, str] = {}
    columns = []
    for name, own in names.items():
        factors = factor(table.units[name], units[own]) if own in units else None
        up, down = factors or (1.0, 1.0)
        found[own] = units[own] if factors else table.units[name]
        columns.append(table[name] if up == down == 1.0 else table[name] * up / down)
    rows = np.column_stack(columns)
    if "time" in found and rows.size and np.all(np.diff(table["time"]) >= 0.0):
        place = list(found).index("time")
        time, keep = events_apart(rows[:, place])
        rows = rows[keep]
        rows[:, place] = time
    return Recording(found, rows, table.messages, table.counts)
