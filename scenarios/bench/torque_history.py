"""A measured torque history from a file: two columns, time [s] and torque [N.m]."""

import csv
import math
from pathlib import Path

import numpy as np

from scenarios.scenario import BadInputError


def read_torque_history(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times [s], increasing, and torque capacities [N.m], not negative; a first line of words is passed over.

    Raises BadInputError with the line and what is wrong with it.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = [(number, row) for number, row in enumerate(csv.reader(file), start=1) if row and any(row)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise BadInputError(
            f"{path} cannot be read ({error}); give a text file with the columns time [s], torque [N.m]."
        ) from error
    rows: list[tuple[float, float]] = []
    for position, (number, row) in enumerate(lines):
        try:
            time, torque = (float(cell) for cell in row)
        except ValueError:
            if position == 0:
                continue
            raise BadInputError(
                f"{path}, line {number}: give two numbers, time [s] and torque [N.m]; it reads {','.join(row)!r}."
            ) from None
        if not (math.isfinite(time) and math.isfinite(torque) and torque >= 0.0):
            raise BadInputError(
                f"{path}, line {number}: give a finite time and a torque of at least 0 N.m, not {','.join(row)}."
            )
        if rows and time <= rows[-1][0]:
            raise BadInputError(f"{path}, line {number}: let times increase; {time:g} s follows {rows[-1][0]:g} s.")
        rows.append((time, torque))
    if len(rows) < 2:
        raise BadInputError(
            f"{path} has {len(rows)} rows of numbers; at least two rows of time [s], torque [N.m] are needed."
        )
    times, torques = np.array(rows).T
    return times, torques
