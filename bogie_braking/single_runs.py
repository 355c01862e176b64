"""Runs made one by one, each to the columns of its results."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from bogie_braking.machines import Runnable
from bogie_braking.reducers import Results
from bogie_braking.simulation import Simulation
from fmu_src.kernel import SimulationError
from rbd_model.track.line import Line


@dataclass(frozen=True)
class End:
    """The end of a run: its results, its time [s], whether it ended by itself, its messages, and why it failed."""

    results: list[float]
    time: float
    ended: bool
    status: str
    failure: str = ""


@dataclass(frozen=True)
class SingleRuns:
    """Runs over a duration [s]; statistics are of the rows of an interval [s]."""

    what: Runnable
    duration: float
    line: Line | None
    results: Results
    interval: float

    def end(self, values: Mapping[str, Any]) -> End:
        """Return the end of a run with these values. Raises SimulationError, ValueError."""
        simulation = Simulation(self.what, self.line, **values)
        every = self.duration if self.results.final else self.interval
        run = simulation.advance(self.duration, self.results.recorded, every)
        return End(self.results.of(run, simulation.__getitem__), simulation.time, simulation.ended, run.status)

    def end_or_failure(self, values: Mapping[str, Any]) -> End:
        """Return the end of a run with these values; NaN with the reason if it fails."""
        try:
            return self.end(values)
        except (SimulationError, ValueError) as error:
            return End([math.nan] * len(self.results.names), math.nan, False, "", str(error))
