"""The programs in an archive that run its FMU: what they print, and what the FMU gives by FMPy here."""

from __future__ import annotations

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from fmu_src.cosimulation.slave import FmuInstance

#: What each program does.
STEPS, STEP = 100, 0.01


def call(command: Sequence[str | Path], folder: Path, *assignments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*command, *assignments], cwd=folder, capture_output=True, text=True, timeout=120)


def shown(command: Sequence[str | Path], folder: Path, given: Mapping[str, float]) -> dict[str, float]:
    """Outputs at the end, with these inputs and parameters."""
    done = call(command, folder, *(f"{name}={value}" for name, value in given.items()))
    assert done.returncode == 0, done.stderr
    return {name: float(value) for name, value in (line.split() for line in done.stdout.splitlines())}


def found_here(fmu: Path, given: Mapping[str, float], names: Sequence[str]) -> dict[str, float]:
    """The same by FMPy, on this platform."""
    with FmuInstance(fmu) as instance:
        instance.start(**given)
        for n in range(STEPS):
            instance.step(n * STEP, STEP)
        return {name: instance[name] for name in names}
