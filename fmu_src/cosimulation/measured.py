"""A measured run from a file: a table as Recording.write makes it, or as a logger or a spreadsheet writes it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fmu_src.cosimulation.recording import Recording
from readers.tables import Column, read_table, tidy
from readers.units import factor

TIME = Column("time", "s", required=True)


def table_from(path: Path) -> Recording:
    """Return the table of a file with names and units in its first row, and rows of numbers.

    Time is its first column and in seconds, however the file has it. Other columns keep the units of the file.

    Raises
    ------
    FileError
        If the file cannot be read as it is meant; the message names file, row, column, value and remedy.
    """
    table = read_table(path, [TIME], others=True)
    table.check_rows()
    table.check_growth("time")
    names = ["time", *(name for name in table.numbers if name != "time")]
    return Recording(
        {name: table.units[name] for name in names}, np.column_stack([table.numbers[one] for one in names])
    )


def in_units_of(table: Recording, units: Mapping[str, str]) -> Recording:
    """Return a table whose columns have the names and units of variables, if these exist and can be converted to.

    units: of the variables, by name. Other columns are unchanged, as are those in a unit of another quantity.
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
    return Recording(found, np.column_stack(columns), table.messages, table.counts)
