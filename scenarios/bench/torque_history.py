"""A measured torque history from a file: two columns, time [s] and torque [N.m]."""

from pathlib import Path

import numpy as np

from readers.tables import Column, read_table
from readers.text import FileError
from scenarios.scenario import BadInputError

COLUMNS = (Column("time", "s", required=True), Column("torque", "N.m", 0.0, required=True))


def read_torque_history(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s], increasing, and torque capacities [N.m], not negative; the row of names may be missing.

    Raises
    ------
    BadInputError
        If the file cannot be read as it is meant; the message names file, row, column, value and remedy.
    """
    try:
        table = read_table(path, COLUMNS, by_position=True)
        times, torques = (table.numbers[column.name] for column in COLUMNS)
        table.check_rows()
        table.check_growth("time")
    except FileError as error:
        raise BadInputError(str(error)) from None
    return times, torques
