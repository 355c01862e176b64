"""Process with the code of one revision that runs the jobs of old_and_new.py: jobs in, times out, a JSON line each.

It is run as text in the folder of its revision, and uses only interfaces that old revisions have too.
"""

import json
import os
import shutil
import sys
import time
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from products.registry import model_of


def copy_library(vehicle: str, copies: list[str]) -> dict[str, Any]:
    """Copy the compiled kernel of an FMU of this revision, under several names."""
    made = build_library(model_of(vehicle))
    for copy in copies:
        shutil.copy(made, copy)
    return {}


@cache
def library(path: str) -> Library:
    """Return a copy, loaded once."""
    return Library(Path(path))


def measure(path: str, values: Mapping[str, Any], action: str, size: float, count: int, lanes: int) -> dict[str, Any]:
    """Return the time of one call [s] and the steps of the kernel, which runs for 1 s first unless `action` is the
    whole stop.
    """
    kernel = Kernel(library(path), **values)
    if lanes:
        kernel.use_lanes(lanes)
    kernel.initialise()
    if action != "stop":
        kernel.advance(1.0)
    begin = time.perf_counter()
    if action == "stop":
        kernel.step(0.0, size)
    elif action == "host step":
        kernel.repeat_step(size, count)
    elif action == "Jacobian":
        kernel.repeat_jacobian(count)
    else:
        kernel.repeat_right_hand_side(count)
    return {"seconds": (time.perf_counter() - begin) / count, "steps": kernel.counts["steps"]}


def run_cases() -> dict[str, Any]:
    """Return the time of all cases of chapter 9 [s], with the kernel loaded before."""
    from scenarios.bench.asymmetric_shoes import CASES, run_all

    run_all(CASES[:1])
    begin = time.perf_counter()
    count = len(run_all())
    return {"seconds": time.perf_counter() - begin, "cases": count}


JOBS: dict[str, Callable[..., dict[str, Any]]] = {"copy": copy_library, "measure": measure, "cases": run_cases}


def main() -> None:
    """Run jobs until the input ends; other output goes to standard error."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    for line in sys.stdin:
        job = json.loads(line)
        print(json.dumps(JOBS[job.pop("job")](**job)), file=answers, flush=True)


if __name__ == "__main__":
    main()
