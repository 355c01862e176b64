"""A measured torque history from a log: time [s] and torque [N.m]."""

import math
from pathlib import Path

import numpy as np

from bogie_braking.reporting.scenario import BadInputError
from readers.log_rows import filled
from readers.logs import read_log
from readers.text import FileError

VARIABLES = {"time": "s", "torque": "N.m"}


def read_torque_history(path: Path, columns: Path | None = None) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Return a measured torque.

    Returns [s].
    """
    try:
        log = read_log(path, VARIABLES, columns, by_position=list(VARIABLES))
        if "torque" not in log.numbers:
            raise BadInputError(f"{path}: the column torque is missing. Add it, or name it in a map (--columns).")
        torques = log.numbers["torque"]
        for row in np.flatnonzero(torques < 0.0)[:1].tolist():
            raise log.refusal(row, "torque", f"the value must be at least 0 N.m; got {torques[row]:g} N.m. Correct it.")
        return *filled(log.numbers["time"], torques, f"{path}: torque", math.inf), log.messages
    except FileError as error:
        raise BadInputError(str(error)) from None
