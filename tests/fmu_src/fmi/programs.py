"""Run the host programs of an archive, and the same FMU by FMPy, and return their outputs."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from fmu_src.cosimulation.slave import FmuInstance

#: Number and size of the steps of each program [s].
STEPS, STEP = 100, 0.01
#: Programs of Mono, and their packages of Debian.
MONO = {"mcs": "mono-mcs", "mono": "mono-runtime"}


def call(command: Sequence[str | Path], folder: Path, *assignments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*command, *assignments], cwd=folder, capture_output=True, text=True, timeout=120)


def shown(command: Sequence[str | Path], folder: Path, given: Mapping[str, float]) -> dict[str, float]:
    """Return the outputs at the end, with these inputs and parameters."""
    done = call(command, folder, *(f"{name}={value}" for name, value in given.items()))
    assert done.returncode == 0, done.stderr
    return {name: float(value) for name, value in (line.split() for line in done.stdout.splitlines())}


def found_here(fmu: Path, given: Mapping[str, float], names: Sequence[str], steps: int = STEPS) -> dict[str, float]:
    """Return the same outputs by FMPy, on this platform."""
    with FmuInstance(fmu) as instance:
        instance.start(**given)
        for n in range(steps):
            instance.step(n * STEP, STEP)
        return {name: instance[name] for name in names}
