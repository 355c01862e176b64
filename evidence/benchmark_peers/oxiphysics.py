"""OxiPhysics (COOLJAPAN, crates.io `oxiphysics-rigid`, Apache-2.0): formulas of trains of a physics engine in Rust.

Its braking distance has a constant resistance, and one mass for inertia and weight. Here the resistance is the mean of
EN 14531-1 between the speeds, and the gradient is scaled so that its force is right. Its Kalker coefficients are those
of a circle, for every ellipse. The program `oxiphysics-peer` of the folder `oxiphysics_crate` calls it.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Mapping
from typing import Any

NAME = "OxiPhysics"
PROGRAM, CRATE = "oxiphysics-peer", "evidence/benchmark_peers/oxiphysics_crate"
#: Version that its Cargo.toml demands.
VERSION = "0.1.2"


def version() -> str:
    """Return the version of the crate. Raises ImportError if the program is not installed."""
    if shutil.which(PROGRAM) is None:
        raise ImportError(f"install it by cargo install --path {CRATE}")
    return VERSION


def answer(question: str, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Return Kalker's coefficients [1], or the distance of a run [m]; None to other questions."""
    if question == "kalker-coefficients":
        along, across = inputs["along"], inputs["across"]
        area = along * across
        forces = zip(("c11", "c22", "c23"), call("kalker", along, across, 1.0), (area, area, area**1.5), strict=True)
        return {name: force / one for name, force, one in forces}
    if question not in ("coasting", "stop-with-full-brakes"):
        return None
    first, last = inputs["speed"], inputs.get("end_speed", 0.0)
    mass = inputs["mass"] + inputs["rotating_mass"]
    gradient = inputs["gradient"] * inputs["mass"] / mass
    return {"distance": call("stop", mass, first, last, inputs.get("brake_force", 0.0), gradient, mean(inputs))[0]}


def mean(inputs: Mapping[str, Any]) -> float:
    """Return the mean running resistance between the speeds [N] (EN 14531-1)."""
    first, last = inputs["speed"], inputs.get("end_speed", 0.0)
    constant, linear, square = (float(inputs[f"resistance.{name}"]) for name in ("constant", "linear", "square"))
    middle = 2 / 3 * (first**2 + first * last + last**2) / (first + last)
    return constant + linear * middle + square * (first**2 + last**2) / 2


def call(name: str, *numbers: float) -> list[float]:
    """Return what the program answers to one job."""
    job = " ".join([name, *map(repr, numbers)])
    done = subprocess.run([PROGRAM], input=job + "\n", capture_output=True, encoding="utf-8", check=True)
    return [float(word) for word in done.stdout.split()]
