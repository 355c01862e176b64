"""Count instructions, memory, locks and system calls within each fmi2DoStep, by a host in C (`counting_host.c`).

valgrind counts the instructions; other load on the computer does not affect them. The test case is a stop with fixed
steps, lock-up, release and flange contact.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description

from fmu_src import compile as compiling
from products.dry_stops import DryStop
from products.kernel_runs import value_at

#: Types in `counting_host.c` by types of FMI.
KINDS = {"Real": "r", "Integer": "i", "Boolean": "b", "Enumeration": "i"}


class HostError(RuntimeError):
    """The host in C failed; the text holds its message."""


@dataclass(frozen=True)
class Steps:
    """Counts of each step, and outputs by name after each."""

    instructions: np.ndarray = field(default_factory=lambda: np.zeros(0))
    outputs: Mapping[str, np.ndarray] = field(default_factory=dict)
    #: Memory calls and locks: before the first step, and within all steps.
    memory: tuple[int, int] = (0, 0)
    locks: tuple[int, int] = (0, 0)

    @property
    def median(self) -> float:
        return float(np.median(self.instructions))

    @property
    def spread(self) -> float:
        """Return the ratio of the largest to the median number of instructions of a step."""
        return float(self.instructions.max()) / self.median


def make_steps(fmu: Path, stop: DryStop, counted: bool = False, guard: str | None = None) -> Steps:
    """Make the steps of a stop on a native FMU, with logging off; counted: under valgrind.

    guard: "guarded": a system call within a step ends the host. "calling": the host also makes such a call.
    Raises HostError if the host fails.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        about, unpacked = read_model_description(str(fmu)), Path(extract(str(fmu), str(folder / "fmu")))
        library = unpacked / f"binaries/linux64/{about.coSimulation.modelIdentifier}.so"
        (folder / "plan").write_text(plan_of(fmu, unpacked, stop))
        shutil.copy(Path(__file__).with_name("counting_host.c"), folder)
        headers = [f"-I{compiling.RUNTIME}", f"-I{compiling.fmi_headers()}"]
        compiling.run(
            ["-O1", "-rdynamic", *headers, "-o", "host", "counting_host.c", "-ldl", "-lpthread"], None, folder
        )
        command = ["./host", str(library), "plan", *([guard] if guard else [])]
        if counted:
            switches = ["--toggle-collect=fmi2DoStep", "--dump-after=fmi2DoStep", "--combine-dumps=yes"]
            command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=counts", *switches, *command]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode:
            raise HostError(f"The host of steps ended with {done.returncode}: {done.stderr[-400:]}")
        *rows, said = done.stdout.splitlines()
        read = np.array([[float(value) for value in row.split()] for row in rows])
        status, *calls = (int(one) for one in said.split())
        if status > 1:
            raise HostError(f"Step {len(rows)} of the host ended with status {status}.")
        numbers = np.array([int(n) for n in counts_of(folder / "counts")] if counted else [])
        outputs = {one: read[:, place] for place, one in enumerate(stop.read)}
        return Steps(numbers, outputs, (calls[0], calls[1]), (calls[2], calls[3]))


def counts_of(file: Path) -> list[str]:
    """Return the totals of all parts of a callgrind file that a step has ended. The last part follows the steps."""
    return [n for part in file.read_text().split("desc: Trigger: ")[1:] if (n := total_of(part))]


def total_of(part: str) -> str:
    found = re.search(r"^summary: (\d+)", part, re.MULTILINE)
    return found[1] if found and found[1] != "0" else ""


def plan_of(fmu: Path, unpacked: Path, stop: DryStop) -> str:
    """Return the plan that `counting_host.c` reads."""
    about = read_model_description(str(fmu))
    known = {v.name: f"{KINDS[v.type]}{v.valueReference}" for v in about.modelVariables if v.type in KINDS}
    lines = [about.guid, (unpacked / "resources").as_uri(), repr(stop.step), str(stop.steps)]
    lines += [str(len(stop.values)), *(f"{known[name]} {float(value)!r}" for name, value in stop.values.items())]
    for names in (list(stop.inputs), list(stop.read)):
        lines += [str(len(names)), *(known[name] for name in names)]
    for number in range(stop.steps):
        time = number * stop.step
        lines.append(" ".join(repr(value_at(one, time, after=True)) for one in stop.inputs.values()))
    return "\n".join(lines) + "\n"


LEVELS: dict[str, dict[str, float]] = {
    "point": {"level": 1},
    "planar": {"level": 2},
    "spatial, model 1": {"level": 3, "contact_model": 1},
    "spatial, model 2": {"level": 3, "contact_model": 2},
}
#: FMU, number of wheelsets, level and contact model by name.
CASES: dict[str, tuple[str, int, dict[str, float]]] = {
    f"{name} {what}": (fmu, wheelsets, values)
    for name, fmu, wheelsets in (("bogie", "bogie", 2), ("coach", "vehicle", 4))
    for what, values in LEVELS.items()
}
