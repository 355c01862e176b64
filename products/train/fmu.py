"""TrainDynamics.fmu: a train of a consist, for FMI 2.0 and FMI 3.0; the binary is the same for every consist."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from brake_controller.protection_fmu import HEADER
from fmu_src.arrays_fmu import ArraysFmu, ArraysInC, ArrayVariable
from fmu_src.c_literals import c_text
from products.controller_kinds import PUBLIC
from products.train import layout
from products.train.consist import Consist, block_train
from products.train.consist_writer import toml_of_rows
from products.train.details_fmu import DetailsInC, details_of
from products.train.imported_consist import consist_from
from products.train.layout import START_FRICTION, Array
from products.train.library import FOLDER, own_controllers_in_c, sources
from products.train.numbers import Settings, numbers_of, own_files
from rbd_model.track.line import Line, read_line

NAME = "TrainDynamics"


def _arrays(causality: str, arrays: Sequence[Array]) -> tuple[ArrayVariable, ...]:
    return tuple(
        ArrayVariable(
            array.called or array.name, causality, array.unit, array.text, array.least, array.most, array.whole
        )
        for array in arrays
    )


PARAMETERS = _arrays("parameter", layout.INITIAL)
INPUTS = _arrays("input", layout.INPUTS)
OUTPUTS = (
    *_arrays("output", layout.OUTPUTS),
    *_arrays("output", layout.OF_WHEELS),
    *_arrays("output", layout.SUMS[1:]),
)
ARRAYS = (*PARAMETERS, *INPUTS, *OUTPUTS)


def _places(arrays: Sequence[ArrayVariable]) -> str:
    first = len(PARAMETERS) + len(INPUTS)
    names = [array.name for array in ARRAYS]
    sums, locked, slip = names.index("largest_tension"), names.index("locked"), names.index("slip")
    return (
        f"enum {{ FIRST_PARAMETER, FIRST_INPUT = {len(PARAMETERS)}, FIRST_OUTPUT = {first}, LOCKED = {locked},"
        f" SLIP = {slip}, FIRST_SUM = {sums}, FIRST_DETAILED = {len(ARRAYS)}, ARRAYS_MOST = {len(arrays)} }};\n"
    )


def train_in_c(controllers: Sequence[str] = (), details: DetailsInC | None = None) -> ArraysInC:
    """The train's object in C with arrays, vehicles in detail, controllers of users. Raises ValueError, OSError."""
    files = ("train_fmu.c", *(() if details else ("no_details_fmu.c",)))
    own = {name: (FOLDER / name).read_text(encoding="utf-8") for name in files}
    arrays = (*ARRAYS, *(details.arrays() if details else ()))
    own |= {"train_arrays.h": _places(arrays)} | (details.sources() if details else {})
    about = "A train: brake pipe, distributors, couplers, wheels that roll or slide; driven by its brake valves"
    theirs = {f"own_{n}.c": controller_in_c(text, n) for n, text in enumerate(controllers, 1)}
    own["own_controllers.h"] = own_controllers_in_c(len(theirs))
    foreign = (HEADER, *theirs) if theirs else ()
    return ArraysInC(NAME, about, arrays, sources() | own | theirs, foreign=foreign, ships=details is None)


def controller_in_c(text: str, number: int) -> str:
    """Return the C file of a user's controller, with functions of its own names. Raises ValueError, OSError."""
    path = PUBLIC.get(text, Path(text))
    if path.suffix != ".c":
        raise ValueError(
            f"The controller of a train's FMU must be built-in or a C file; got {text}. Write it in C, or couple it as "
            "an FMU of its own: connect wheel_speed and the input protection."
        )
    if not path.is_file():
        raise ValueError(f"The controller of a train must be a file that exists; got {path}. Correct the path.")
    names, code = [f"wheel_slide_{name}" for name in ("size", "start", "step")], path.read_text(encoding="utf-8")
    if missing := [name for name in names if name not in code]:
        raise ValueError(f"{path} must have all functions of wheel_slide.h; it lacks {', '.join(missing)}. Add them.")
    renamed = "".join(f"#define {name} {name.replace('wheel_slide', f'own_{number}')}\n" for name in names)
    return f"{renamed}#line 1 {c_text(path.name)}\n{code}"


def train_fmu(
    consist: Consist, settings: Settings | None = None, line: Line | None = None, title: str = ""
) -> ArraysFmu:
    """Return the FMU of a consist on a line; title: name of the model for people."""
    vehicles = len(consist.vehicles)
    valves = sum(vehicle.valve is not None for vehicle in consist.vehicles)
    counts = {"one": 1, "ends": 2, "valves": valves, "vehicles": vehicles, "couplings": vehicles - 1}
    lengths = [1] * len(PARAMETERS) + [counts[one.of] for one in (*layout.INPUTS, *layout.OUTPUTS)]
    lengths += [vehicles] * 2 + [1] * len(layout.SUMS[1:])  # locked and slip; numbers of the run
    starts = [[0.0] * length for length in lengths]
    names = [array.name for array in ARRAYS]
    starts[names.index("start_pipe_pressure")] = [consist.charged_pressure]
    starts[names.index("driver_position")] = [1.0, *[0.0] * (valves - 1)]
    starts[names.index("friction")] = [START_FRICTION] * vehicles
    starts[names.index("coupling_closed")] = [1.0] * (vehicles - 1)
    details = details_of(consist, settings or Settings(), line)
    extra = details.arrays() if details else ()
    lengths, starts = lengths + [1] * len(extra), starts + [[0.0]] * len(extra)
    numbers = np.ascontiguousarray(numbers_of(consist, settings or Settings(), line), "<f8")
    data = {"train.bin": numbers.tobytes()} | (details.data() if details else {})
    return ArraysFmu(train_in_c(own_files(consist), details), lengths, starts, 0.01, 60.0, data, title)


def train_of_files_fmu(
    consist: Path | None = None, line: Path | None = None, brake_model: str = "whole", cells: float = 2.0
) -> ArraysFmu:
    """Return the FMU of a consist on a line from files, by default 20 wagons; the consist's file is in it.

    Raises ValueError, OSError.
    """
    own, imported = consist_from(consist) if consist else (block_train(20), None)
    along = read_line(line) if line else None
    for note in dict.fromkeys(one.detail.unused for one in own.vehicles if one.detail and one.detail.unused):
        print(note)
    fmu = train_fmu(own, Settings(brake_model=brake_model, cells=cells), along, consist.stem if consist else "")
    if consist and imported:
        print(f"{consist}: {len(imported.assumed)} assumptions; bogie-braking consist import {consist} prints them.")
        return replace(fmu, extras={f"resources/{consist.stem}.toml": toml_of_rows(imported.rows).encode()})
    return replace(fmu, extras={f"resources/{consist.name}": consist.read_bytes()}) if consist else fmu
