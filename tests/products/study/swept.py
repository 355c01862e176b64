"""Fixtures and functions for tests of sweeps: cheap points, processes that run them, result files."""

from __future__ import annotations

import csv
import multiprocessing
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from products.study.table import FILES
from tests.products.study import cheap_points as points

#: 78 points.
GRID = ["--vary", "x=0.03:0.15:13", "--vary", "y=0,1.5,-2", "--vary", "z=1e-3,7"]
JOURNAL = "journal.jsonl"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep over GRID by two worker processes without an interruption."""
    out = tmp_path_factory.mktemp("whole")
    assert points.run(["sweep", "cheap", *GRID, "--jobs", "2", "--out", str(out)]) == 0
    return out / "sweep-cheap"


@pytest.fixture
def token() -> Iterator[int]:
    """Yield the number of a scratch file that does not exist."""
    number = random.SystemRandom().randrange(2**40)
    yield number
    points.scratch(number).unlink(missing_ok=True)


@pytest.fixture(scope="module")
def start() -> Callable[..., Any]:
    """Return a function that starts another one in a separate process that has already made the slow imports."""
    forkserver = multiprocessing.get_context("forkserver")
    forkserver.set_forkserver_preload(["scenarios.commands.run"])

    def process(function: Callable[..., object], *arguments: object) -> Any:
        made = forkserver.Process(target=function, args=arguments)
        made.start()
        return made

    return process


def files(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in FILES if (folder / name).exists()}


def rows(folder: Path) -> list[list[str]]:
    with (folder / "table.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.reader(line for line in file if not line.startswith("#")))
