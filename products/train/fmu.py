"""TrainDynamics.fmu: a train of a consist, for FMI 2.0 and FMI 3.0; the binary is the same for every consist."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import fmpy
import numpy as np

from fmu_src.arrays_fmu import ArraysInC, ArrayVariable, Lengths, binary_of_arrays, build_arrays_fmu
from fmu_src.compile import library_suffix
from fmu_src.native_fmu import PLATFORMS, PLATFORMS3
from products.prebuilt import contents, shipped, sources_here
from products.train import layout
from products.train.consist import Consist
from products.train.layout import START_FRICTION, START_PIPE_PRESSURE, Array
from products.train.library import FOLDER, sources
from products.train.numbers import Settings, numbers_of
from rbd_model.track.line import Line

NAME = "TrainDynamics"


def _arrays(causality: str, arrays: Sequence[Array]) -> tuple[ArrayVariable, ...]:
    return tuple(
        ArrayVariable(one.called or one.name, causality, one.unit, one.text, one.least, one.most, one.whole)
        for one in arrays
    )


PARAMETERS = _arrays("parameter", layout.INITIAL)
INPUTS = _arrays("input", layout.INPUTS)
OUTPUTS = (
    *_arrays("output", layout.OUTPUTS),
    ArrayVariable("locked", "output", "1", "Whether a vehicle's wheels are locked while it moves", 0, 1, True),
    ArrayVariable("slip", "output", "1", "(v - w) over the larger of both, of each vehicle's wheels"),
    *_arrays("output", layout.SUMS[1:]),
)
ARRAYS = (*PARAMETERS, *INPUTS, *OUTPUTS)


def _places() -> str:
    first = len(PARAMETERS) + len(INPUTS)
    names = [one.name for one in ARRAYS]
    sums, locked, slip = names.index("largest_tension"), names.index("locked"), names.index("slip")
    return (
        f"enum {{ FIRST_PARAMETER, FIRST_INPUT = {len(PARAMETERS)}, FIRST_OUTPUT = {first}, LOCKED = {locked},"
        f" SLIP = {slip}, FIRST_SUM = {sums}, ARRAYS_MOST = {len(ARRAYS)} }};\n"
        f"#define START_PIPE_PRESSURE {START_PIPE_PRESSURE!r}\n"
    )


def train_in_c() -> ArraysInC:
    """The train's object in C with its arrays."""
    own = {"train_fmu.c": (FOLDER / "train_fmu.c").read_text(encoding="utf-8"), "train_arrays.h": _places()}
    about = "A train: brake pipe, distributors, couplers, wheels that roll or slide; driven by its brake valves"
    return ArraysInC(NAME, about, ARRAYS, sources() | own)


def lengths_of(consist: Consist) -> Lengths:
    """Return the lengths of the arrays of a consist in their order, with start values."""
    vehicles = len(consist.vehicles)
    valves = sum(one.valve is not None for one in consist.vehicles)
    counts = {"one": 1, "ends": 2, "valves": valves, "vehicles": vehicles, "couplings": vehicles - 1}
    lengths = [1] * len(PARAMETERS) + [counts[one.of] for one in (*layout.INPUTS, *layout.OUTPUTS)]
    lengths += [vehicles] * 2 + [1] * len(layout.SUMS[1:])  # locked and slip; numbers of the run
    starts = [[0.0] * length for length in lengths]
    names = [one.name for one in ARRAYS]
    starts[names.index("start_pipe_pressure")] = [START_PIPE_PRESSURE]
    starts[names.index("driver_position")] = [1.0, *[0.0] * (valves - 1)]
    starts[names.index("friction")] = [START_FRICTION] * vehicles
    starts[names.index("coupling_closed")] = [1.0] * (vehicles - 1)
    return Lengths(lengths, starts, 0.01, 60.0)


def own_binary(given: ArraysInC) -> bytes:
    """The binary for this platform, of the wheel where no source has changed, or compiled. Raises CompilerError."""
    path = shipped(f"train/{given.name}{library_suffix()}")
    if path and contents().get("sources") == sources_here():
        return path.read_bytes()
    return binary_of_arrays(given)


def binaries_of(given: ArraysInC, version: int, all_platforms: bool) -> dict[str, bytes]:
    """Return the binaries by their places in binaries/."""
    if not all_platforms:
        platform = fmpy.platform if version == 2 else fmpy.platform_tuple
        return {f"{platform}/{given.name}{library_suffix()}": own_binary(given)}
    known = PLATFORMS if version == 2 else PLATFORMS3
    return {
        f"{name}/{given.name}{suffix}": binary_of_arrays(given, targets) for name, (targets, suffix) in known.items()
    }


def build_train_fmu(
    consist: Consist,
    path: Path,
    version: int = 3,
    *,
    settings: Settings | None = None,
    line: Line | None = None,
    all_platforms: bool = False,
    extras: dict[str, bytes] | None = None,
    title: str = "",
) -> None:
    """Writes the FMU of a consist on a line, for FMI 2 or 3.

    extras: more files of the archive. title: name of the model for people. Raises CompilerError.
    """
    numbers = np.ascontiguousarray(numbers_of(consist, settings or Settings(), line), "<f8")
    of = replace(lengths_of(consist), data={"train.bin": numbers.tobytes()}, title=title)
    binaries = binaries_of(train_in_c(), version, all_platforms)
    build_arrays_fmu(train_in_c(), of, path, version, binaries, extras or {})
