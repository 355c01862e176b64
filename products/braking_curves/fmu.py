"""BrakingCurves.fmu: supervision of a train by ETCS, from speed and distance to limits and commands; FMI 2 and 3."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from fmu_src.arrays_fmu import ArraysFmu, ArraysInC, with_starts
from fmu_src.c_literals import c_number
from products.braking_curves.gradients_of_line import gradients_of
from products.braking_curves.train_data import data_in, fmu_parameters
from products.braking_curves.variables import AT_ANY_DISTANCE, FARTHEST, STANDSTILL, UNUSED, every
from products.supervision.gradients import STEEPEST, Gradients
from products.supervision.steps import FASTEST_BOUNDARY
from products.supervision.train import A_SHARE
from rbd_model.track.line_files import line_from_file
from readers.text import BadInputError

FOLDER = Path(__file__).parent
NAME = "BrakingCurves"
#: Largest number of gradients of a line.
MOST_GRADIENTS = 100_000
STEP, STOP = 0.1, 100.0


@lru_cache
def curves_in_c() -> ArraysInC:
    """Return the C object of the curves, with its variables."""
    names = ("curves_fmu.c", "braking_arcs.c", "braking_arcs.h")
    own = {name: (FOLDER / name).read_text(encoding="utf-8") for name in names} | {"curves_arrays.h": _header()}
    about = "Supervision of a train towards a target by ETCS: limits of SUBSET-026, 3.13, and commands of the brakes"
    return ArraysInC(NAME, about, tuple(variable for variable, _ in every()), own, starts_alone=False)


def _header() -> str:
    variables = every()
    names = ", ".join(variable.name.upper() for variable, _ in variables)
    places = np.cumsum([0, *(len(starts) for _, starts in variables)]).tolist()
    numbers = ", ".join(c_number(start) for _, starts in variables for start in starts)
    constants = {
        "MOST_GRADIENTS": MOST_GRADIENTS,
        "STEEPEST": STEEPEST,
        "FARTHEST_PLACE": FARTHEST,
        "STANDSTILL": STANDSTILL,
        "AT_ANY_DISTANCE": AT_ANY_DISTANCE,
        "UNUSED_BOUNDARY": UNUSED,
        "FASTEST_BOUNDARY": FASTEST_BOUNDARY,
        "SMALLEST_ROTATING": A_SHARE,
    }
    lines = [
        "/* Numbers of the variables, and where the elements of each begin. */",
        f"enum {{ {names}, ARRAYS_MOST, VALUES = {places[-1]} }};",
        f"static const int FIRST_OF[] = {{{', '.join(map(str, places))}}};",
        f"static const double STARTS[] = {{{numbers}}};",
        *(f"#define {name} {value!r}" for name, value in constants.items()),
    ]
    return "\n".join(lines) + "\n"


def curves_fmu(gradients: Gradients | None = None) -> ArraysFmu:
    """Return the FMU of the curves, with the gradients of a line. Raises BadInputError."""
    rows: list[float] = []
    if gradients is not None:
        _check(gradients)
        rows = [*gradients.starts, *gradients.permille]
    data = {"gradients.bin": np.array([len(rows) // 2, *rows], "<f8").tobytes()}
    starts = [starts for _, starts in every()]
    return ArraysFmu(curves_in_c(), [len(values) for values in starts], starts, STEP, STOP, data)


def curves_of_files_fmu(line: Path | None = None, train: Path | None = None, national: Path | None = None) -> ArraysFmu:
    """Return the FMU of the curves: gradients of a line, train data and national values in files, if given.

    Raises ValueError, OSError.
    """
    fmu = curves_fmu(gradients_of(line_from_file(line)) if line else None)
    if train is None:
        if national is not None:
            raise BadInputError("--national must be with --train; got it alone. Give the train data too.")
        return fmu
    return replace(with_starts(fmu, fmu_parameters(*data_in(train, national), version=3)), title=train.stem)


def _check(gradients: Gradients) -> None:
    if gradients.starts.size > MOST_GRADIENTS:
        raise BadInputError(
            f"A line of {NAME}.fmu must have at most {MOST_GRADIENTS} gradients; got {gradients.starts.size}. "
            "Give a part of the line."
        )
    far = float(gradients.starts[np.argmax(np.abs(gradients.starts))])
    if abs(far) > FARTHEST:
        raise BadInputError(
            f"Places of {NAME}.fmu must be from {-FARTHEST:g} to {FARTHEST:g} m; got a gradient at {far:g} m. "
            "Give a part of the line."
        )
