"""Builds the FMU of a train from files."""

from __future__ import annotations

import time
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from products.building import announce, license_text
from products.train.consist import block_train
from products.train.consist_file import read_consist
from products.train.coupler_fmu import NAME as COUPLER
from products.train.coupler_fmu import build_coupler_fmu
from products.train.fmu import NAME, build_train_fmu
from products.train.numbers import Settings
from rbd_model.track.line import Line, read_line
from rbd_model.train.coupler import COUPLERS

#: Of a line: from minus to plus; distance [m], gradient [1], curvature [1/m].
LINE_LIMITS = {"distance": 1e9, "gradient": 0.3, "curvature": 0.05}


def line_of_file(path: Path) -> Line:
    """The line in a file, for a train. Raises ValueError with one sentence that names the file and the row, OSError."""
    try:
        line = read_line(path)
    except ValueError as error:
        reason = "no row has a value for each name" if "zip()" in str(error) else str(error).rstrip(".")
        raise ValueError(f"{path} is no line ({reason}); mend it.") from None
    if "distance" not in line.rows or len(line.rows["distance"]) == 0:
        raise ValueError(f"{path} has no rows below a name distance; give it one for each point of the line.")
    for name, most in LINE_LIMITS.items():
        for row, value in enumerate(line.rows.get(name, ()), 1):
            if not abs(value) <= most:
                raise ValueError(
                    f"{path}, row {row}: set {name} to a number from {-most:g} to {most:g}: it was {value:g}."
                )
    for row, (before, value) in enumerate(pairwise(line.rows["distance"]), 2):
        if not value > before:
            raise ValueError(f"{path}, row {row}: let distances grow from row to row: {value:g} follows {before:g}.")
    return line


def build_train(
    out: Path,
    kinds: Sequence[str],
    consist: Path | None = None,
    line: Path | None = None,
    settings: Settings | None = None,
    all_platforms: bool = False,
) -> list[str]:
    """OUT/KIND/TrainDynamics.fmu of a consist on a line, by default 20 wagons; the problems that fmpy finds.

    Raises ValueError with one sentence, OSError, CompilerError.
    """
    own = read_consist(consist) if consist else block_train(20)
    along = line_of_file(line) if line else None
    files = {"documentation/licenses/license.txt": license_text()}
    if consist:
        files[f"resources/{consist.name}"] = consist.read_bytes()
    problems = []
    for kind in kinds:
        begin, path = time.perf_counter(), out / kind / f"{NAME}.fmu"
        build_train_fmu(
            own,
            path,
            2 if kind == "native" else 3,
            settings=settings,
            line=along,
            all_platforms=all_platforms,
            extras=files,
        )
        problems += announce(path, time.perf_counter() - begin)
    return problems


def build_coupler(out: Path, kinds: Sequence[str], coupler: str = "screw", all_platforms: bool = False) -> list[str]:
    """OUT/KIND/Coupler.fmu of a ready coupler; the problems that fmpy finds. Raises OSError, CompilerError."""
    problems = []
    for kind in kinds:
        begin, path = time.perf_counter(), out / kind / f"{COUPLER}.fmu"
        files = {"documentation/licenses/license.txt": license_text()}
        version = 2 if kind == "native" else 3
        build_coupler_fmu(COUPLERS[coupler](), path, version, all_platforms=all_platforms, extras=files)
        problems += announce(path, time.perf_counter() - begin)
    return problems
