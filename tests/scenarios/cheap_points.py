"""Points that cost nothing, for the tests of sweeps; worker processes import this file, so it imports little."""

from __future__ import annotations

import math
import os
import signal
import tempfile
import time
from pathlib import Path


def cheap(x: float = 1.0, y: float = 2.0, z: float = 0.1) -> dict[str, float | None]:
    """A product and a ratio with all their digits; no ratio by zero."""
    time.sleep(0.005)
    return {"product": x * y * z, "ratio": x / y if y else None}


def moody(mood: float = 0.0) -> object:
    """Whatever a point may do."""
    if mood == 1:
        raise ValueError("The spring is\nbroken.")
    if mood == 5:
        os.kill(os.getpid(), signal.SIGTERM)
    if mood == 6:
        raise SystemExit(7)
    answers: dict[int, object] = {2: math.nan, 3: "a word", 7: True}
    return {4: {"other": 1.0}, 8: 1.0}.get(int(mood), {"answer": answers.get(int(mood), mood)})


def scratch(token: float) -> Path:
    """A file that a point may use; sweeps hand points nothing but numbers."""
    return Path(tempfile.gettempdir()) / f"bogie-braking-sweep-{int(token)}"


def dies_once(token: float, x: float = 0.0) -> dict[str, float]:
    """Kills its worker the first time."""
    if x == 1.0 and not scratch(token).exists():
        scratch(token).write_text("")
        os.kill(os.getpid(), signal.SIGTERM)
    return {"square": x * x}


def ticks(token: float) -> dict[str, float]:
    """Lets a file grow as long as it lives, 20 s at most."""
    for _ in range(1000):
        with scratch(token).open("a") as file:
            file.write(".")
        time.sleep(0.02)
    return {"done": 1.0}


def run(arguments: list[str]) -> int:
    """The command line with these points as scenarios, also in a process of its own."""
    from bogie_braking.__main__ import main
    from scenarios import catalogue
    from scenarios.scenario import Scenario, Sweepable

    def scenario(name: str, sweep: Sweepable) -> Scenario:
        return Scenario(name, "for the tests", lambda options: None, sweep=sweep)

    before = list(catalogue.SCENARIOS)
    catalogue.SCENARIOS += [
        scenario("cheap", Sweepable({"x": "m", "y": "s", "z": "1"}, {"product": "m.s", "ratio": "m/s"}, cheap)),
        scenario("moody", Sweepable({"mood": "1"}, {"answer": "1"}, moody)),
        scenario("dies-once", Sweepable({"token": "1", "x": "m"}, {"square": "m2"}, dies_once)),
        scenario("hidden", Sweepable({"x": "1"}, {"y": "1"}, lambda x=0.0: {"y": x})),
        scenario("ticks", Sweepable({"token": "1"}, {"done": "1"}, ticks)),
    ]
    try:
        return main(arguments)
    finally:
        catalogue.SCENARIOS[:] = before
