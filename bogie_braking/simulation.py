"""Runs of the vehicles and brakes that there are, in this process, by the kernels inside their FMUs."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from bogie_braking.fmus import known
from fmu_src.compile import build_library
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel, Library
from fmu_src.system import Model
from products.building import kernel_of, variables_of
from products.registry import ONE_WRITES
from rbd_model.track.line import Line

#: Columns of a recording are this far apart unless another interval is asked for [s].
INTERVAL = 0.01


@lru_cache
def library_of(name: str | Model) -> Library:
    """The compiled equations of an FMU, or of a model of one's own, loaded once."""
    if isinstance(name, Model):
        with ONE_WRITES:
            return Library(build_library(name))
    return Library(kernel_of(known(name)))


class Simulation:
    """One vehicle or brake on its way through time.

    name: as `fmu` has it, or a model of one's own. line: what it runs on; None: straight, level track. values:
    parameters and first inputs, by name and in SI units. Raises KeyError for another name, KernelError with a sentence
    for a value that cannot be.

    >>> stop = Simulation("bogie", initial_speed=25.0, brake_torque_1=20e3)
    >>> stop.advance(5.0).status
    """

    def __init__(self, name: str | Model, line: Line | None = None, **values: float | str) -> None:
        self._variables = (
            {one.name: one for one in name.variables} if isinstance(name, Model) else variables_of(known(name))
        )
        self._kernel = Kernel(library_of(name))
        if line is not None:
            with tempfile.TemporaryDirectory() as folder:  # a kernel reads a line once and keeps it
                self._kernel.set(line_file=str(line.write(Path(folder) / "line.csv")))
        self._kernel.set(**values)

    @property
    def time(self) -> float:
        """Where it stands [s]."""
        return self._kernel.time

    @property
    def ended(self) -> bool:
        """Whether something has ended the run, such as a derailment: no step goes further."""
        return self._kernel.ended

    def __getitem__(self, name: str) -> float:
        """Value of a variable. Raises KernelError."""
        return self._kernel[name]

    def set(self, **values: float | str) -> None:
        """Sets inputs, before the first step parameters too. Raises KernelError, the old value kept."""
        self._kernel.set(**values)

    def advance(self, duration: float, names: Sequence[str] | None = None, interval: float = INTERVAL) -> Recording:
        """Goes on for a duration [s] and records outputs, or the variables `names`, every `interval` [s].

        Neither changes the steps. A run that ends early keeps what came before, and its status says why. Raises
        KernelError.
        """
        every, asked = self._variables, list(names or ())
        if names is None:
            asked = [one.name for one in every.values() if one.causality == "output"]
        heard, before = len(self._kernel.journal), self._kernel.counts if self._kernel.initialised else {}
        table = self._kernel.record(duration, interval, asked)
        units = {"time": "s"} | {name: every[name].unit for name in asked}
        counts = {name: count - before.get(name, 0) for name, count in self._kernel.counts.items()}
        rows = list(zip(*(table[name] for name in units), strict=True))
        return Recording(units, rows, self._kernel.journal[heard:], counts)

    def save(self) -> bytes:
        """The complete state, to be kept in a file or sent elsewhere."""
        return self._kernel.save()

    def restore(self, state: bytes) -> None:
        """Back to a saved state of the same FMU, of another process too. Raises KernelError for what cannot be one."""
        self._kernel.restore(state)


def run(
    name: str | Model,
    duration: float,
    line: Line | None = None,
    names: Sequence[str] | None = None,
    interval: float = INTERVAL,
    **values: float | str,
) -> Recording:
    """One run from its start: `Simulation` and `Simulation.advance`."""
    return Simulation(name, line, **values).advance(duration, names, interval)
