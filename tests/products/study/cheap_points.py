"""Cheap points for the tests of sweeps. Worker processes import this file, so it imports little."""

from __future__ import annotations

import errno
import math
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from typing import Any
from unittest.mock import patch


def cheap(x: float = 1.0, y: float = 2.0, z: float = 0.1) -> dict[str, float | None]:
    """Return a product and a ratio with all their digits; no ratio if y is 0."""
    time.sleep(0.001)
    return {"product": x * y * z, "ratio": x / y if y else None}


def moody(mood: float = 0.0) -> object:
    """Return or fail in every way that a point can."""
    if mood == 1:
        raise ValueError("The spring is\nbroken.")
    if mood == 5:
        os.kill(os.getpid(), signal.SIGTERM)
    if mood == 6:
        raise SystemExit(7)
    if mood == 10:
        raise ValueError("\udcff" + 3000 * "long ")
    if mood == 11:
        raise OSError(errno.ENOSPC, "No space left on device")
    answers: dict[int, object] = {2: math.nan, 3: "1.0", 7: True}
    return {4: {"other": 1.0}, 8: 1.0}.get(int(mood), {"answer": answers.get(int(mood), mood)})


def scratch(token: float) -> Path:
    """Return the path of a file for a point; sweeps pass only numbers to points."""
    return Path(tempfile.gettempdir()) / f"bogie-braking-sweep-{int(token)}"


def dies_once(token: float, x: float = 0.0) -> dict[str, float]:
    """Terminate the worker process at the first call."""
    if x == 1.0 and not scratch(token).exists():
        scratch(token).write_text("")
        os.kill(os.getpid(), signal.SIGTERM)
    return {"square": x * x}


def ticks(token: float) -> dict[str, float]:
    """Append to a file for 20 s at most, so that the test sees whether the process lives."""
    for _ in range(1000):
        with scratch(token).open("a") as file:
            file.write(".")
        time.sleep(0.02)
    return {"done": 1.0}


def in_here(jobs: int, evaluate: Callable[[Any], Any], points: Mapping[int, Any]) -> Iterator[dict[int, Any]]:
    """Yield outcomes without worker processes, which take half a second to start."""
    for number, point in points.items():
        yield {number: evaluate(point)}


@cache
def made_by() -> tuple[str, dict[str, str]]:
    """Return the digest of the sources and the package versions, once: finding them takes longer than a sweep here."""
    from products.sources import sources, versions

    return sources(), versions()


@contextmanager
def catalogued(evaluator: Callable[..., Any] | None, code: tuple[str, dict[str, str]]) -> Iterator[None]:
    """Make these points scenarios; an evaluator may replace the worker processes."""
    from bogie_braking.reporting.scenario import Scenario, Sweepable
    from products.sources import sources
    from products.study import study
    from products.study.points import in_processes
    from scenarios import catalogue
    from scenarios.commands import sweep as command

    def scenario(name: str, sweep: Sweepable) -> Scenario:
        return Scenario(name, "for the tests", lambda options, quick=False: None, sweep=sweep)

    before = list(catalogue.SCENARIOS)
    catalogue.SCENARIOS += [
        scenario("cheap", Sweepable({"x": "m", "y": "s", "z": "1"}, {"product": "m.s", "ratio": "m/s"}, cheap)),
        scenario("moody", Sweepable({"mood": "1"}, {"answer": "1"}, moody)),
        scenario("dies-once", Sweepable({"token": "1", "x": "m"}, {"square": "m2"}, dies_once)),
        scenario("hidden", Sweepable({"x": "1"}, {"y": "1"}, lambda x=0.0: {"y": x})),
        scenario("ticks", Sweepable({"token": "1"}, {"done": "1"}, ticks)),
    ]
    known = [(study, "versions", lambda: code[1]), (command, "in_processes", evaluator or in_processes)]
    if study.sources is sources:  # a value patched by a test stays
        known.append((study, "sources", lambda: code[0]))
    try:
        with ExitStack() as patches:
            for module, name, function in known:
                patches.enter_context(patch.object(module, name, function))
            yield
    finally:
        catalogue.SCENARIOS[:] = before


def run(
    arguments: list[str],
    evaluator: Callable[..., Any] | None = None,
    code: tuple[str, dict[str, str]] | None = None,
) -> int:
    """Run the command line with these points as scenarios, in any process; code: the result of `made_by`."""
    from bogie_braking.__main__ import main

    with catalogued(evaluator, code or made_by()):
        return main(arguments)


def run_here(arguments: list[str]) -> int:
    """Run the command line without worker processes."""
    return run(arguments, in_here)


def run_and_stay(arguments: list[str], count: int, code: tuple[str, dict[str, str]]) -> None:
    """Run the command line until `count` points are done; then wait to be killed."""

    def stays(jobs: int, evaluate: Callable[[Any], Any], points: Mapping[int, Any]) -> Iterator[dict[int, Any]]:
        for done, (number, point) in enumerate(points.items()):
            if done == count:
                time.sleep(60.0)
            yield {number: evaluate(point)}

    sys.exit(run(arguments, stays, code))
