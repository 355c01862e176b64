"""A scenario, its options, and its part in sweeps."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from bogie_braking.reporting.report import Report
from readers.text import BadInputError as BadInputError

if TYPE_CHECKING:
    from fmu_src.cosimulation.master import Master


@dataclass(frozen=True)
class Options:
    """Options of the command line; None: not chosen, the scenario uses its default."""

    kind: str | None = None
    step: float | None = None
    torque_csv: Path | None = None
    columns: Path | None = None
    coupling_tolerance: float | None = None
    wheel: Sequence[Path] | None = None
    rail: Sequence[Path] | None = None
    diameter: Sequence[float] | None = None
    gauge: float | None = None
    flange_back: float | None = None
    inclination: float | None = None
    gauge_side: Sequence[str] | None = None
    tape_circle: Sequence[float] | None = None
    drop_outliers: bool | None = None
    line: Path | None = None

    @property
    def given(self) -> set[str]:
        """Return the names of the options that were chosen."""
        return {item.name for item in fields(self) if getattr(self, item.name) is not None}

    def macro_step(self, default: float = 1e-3) -> float:
        """Return the macro step of the co-simulation [s]."""
        return default if self.step is None else self.step

    def master(self) -> Master:
        """Return a master with fixed macro steps and zero-order hold; with a tolerance, one with error control and
        extrapolation.
        """
        from fmu_src.cosimulation.master import Master  # with FMPy, an optional dependency

        return Master(extrapolated=self.coupling_tolerance is not None, coupling_tolerance=self.coupling_tolerance)


@dataclass(frozen=True)
class Sweepable:
    """Interface of a scenario to sweeps: its parameters and results with their units, and one point of it.

    run: takes parameters by name, with defaults for those that are not varied, and returns every result; None for an
    event that did not occur, such as a lock. It must be defined at the top level of its file, where worker processes
    find it.
    """

    parameters: Mapping[str, str]
    results: Mapping[str, str]
    run: Callable[..., Mapping[str, float | None]]


class ScenarioFunction(Protocol):
    """The function of a scenario."""

    def __call__(self, options: Options, quick: bool = False) -> Report:
        """Run it; quick: fewer cases, coarser or shorter, for tests."""


@dataclass(frozen=True)
class Scenario:
    """One experiment: a name, a summary, a function that runs it, and its options.

    takes: names of these options. sweep: None if no parameter can be varied.
    """

    name: str
    summary: str
    run: ScenarioFunction
    takes: frozenset[str] = frozenset()
    sweep: Sweepable | None = None

    @property
    def group(self) -> str:
        """The subject that it belongs to: the name of the folder of its file, such as "thesis" or "trains"."""
        function = getattr(self.run, "func", self.run)
        return str(function.__module__).split(".")[-2]
