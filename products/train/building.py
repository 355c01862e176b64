"""Builds the FMU of a train from files."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from products.building import announce, license_text
from products.train.consist import block_train
from products.train.consist_writer import toml_of_rows
from products.train.coupler_fmu import NAME as COUPLER
from products.train.coupler_fmu import build_coupler_fmu
from products.train.coupler_tables import coupler_named
from products.train.fmu import NAME, build_train_fmu
from products.train.foreign import consist_from
from products.train.numbers import Settings
from rbd_model.track.line import read_line


def build_train(
    out: Path,
    kinds: Sequence[str],
    consist: Path | None = None,
    line: Path | None = None,
    settings: Settings | None = None,
    all_platforms: bool = False,
) -> list[str]:
    """Write OUT/KIND/TrainDynamics.fmu of a consist on a line, by default 20 wagons; return the problems found by fmpy.

    Raises ValueError, OSError, CompilerError.
    """
    own, imported = consist_from(consist) if consist else (block_train(20), None)
    along = read_line(line) if line else None
    files = {"documentation/licenses/license.txt": license_text()}
    if consist and imported:
        print(f"{consist}: {len(imported.assumed)} assumptions; bogie-braking consist import {consist} prints them.")
        files[f"resources/{consist.stem}.toml"] = toml_of_rows(imported.rows).encode()
    elif consist:
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
            title=consist.stem if consist else "",
        )
        problems += announce(path, time.perf_counter() - begin)
    return problems


def build_coupler(out: Path, kinds: Sequence[str], coupler: str = "screw", all_platforms: bool = False) -> list[str]:
    """Write OUT/KIND/Coupler.fmu of a coupler, by `coupler_named`; return the problems found by fmpy.

    Raises ValueError, OSError, CompilerError.
    """
    problems, one = [], coupler_named(coupler)
    for kind in kinds:
        begin, path = time.perf_counter(), out / kind / f"{COUPLER}.fmu"
        files = {"documentation/licenses/license.txt": license_text()}
        version = 2 if kind == "native" else 3
        build_coupler_fmu(one, path, version, all_platforms=all_platforms, extras=files)
        problems += announce(path, time.perf_counter() - begin)
    return problems
