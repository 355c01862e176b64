"""The slave class of an FMU around any Python object with `step(time, inputs) -> outputs`, such as a controller.

`python_fmu.py` joins this file with the object's own into the one module that travels inside the FMU.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

from pythonfmu.enums import Fmi2Status

from fmu_src.telling_slave import TellingSlave

#: A day [s], the longest step of an instance: duration.h of the runtime.
LONGEST_STEP = 86400.0


class Stepper(Protocol):
    """The object inside the FMU."""

    def step(self, time: float, inputs: Sequence[float]) -> Sequence[float]:
        """Return outputs from inputs, in the order of the description; time in s. May raise."""
        ...


class StepSlave(TellingSlave):
    """A slave with real inputs, then the parameter `period`, then outputs, numbered in this order.

    The object's `step` is called at the start of the first step that begins at or after each multiple of the period.
    Its outputs stay constant in between. If it raises, the outputs return to the safe ones, and this and every later
    step is discarded with the message of the exception.
    """

    guid_of_content: str
    input_count: int
    safe: Sequence[float]
    first_period: float

    def __init__(self, **kwargs):  # type: ignore[no-untyped-def]
        super().__init__(**kwargs)
        self.guid = self.guid_of_content
        self.values = [0.0] * self.input_count + [self.first_period, *self.safe]
        self.stepper = self.make()
        self.start_time, self.asked, self.failure = 0.0, 0, ""

    def make(self) -> Stepper:
        """Return a new object for this instance."""
        raise NotImplementedError

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Set the start time [s] (fmi2SetupExperiment)."""
        self.start_time = start_time

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Make a step (fmi2DoStep), times in s; False discards the step, and the log has the reason."""
        if not step_size <= LONGEST_STEP:
            self.log(f"The step must be at most {LONGEST_STEP:g} s; got {step_size:g} s.", Fmi2Status.error)
            return False
        period = self.values[self.input_count]
        if not (math.isfinite(period) and period > 0.0):
            self.failure = f"period must be above 0 s; got {period:g} s."
        elif not self.failure and current_time - self.start_time >= self.asked * period - 1e-9:
            self._ask(current_time, period)
        if self.failure:
            self.log(self.failure, Fmi2Status.error)
        return not self.failure

    def _ask(self, time: float, period: float) -> None:
        self.asked = math.floor((time - self.start_time) / period + 1e-9) + 1
        inputs = self.values[: self.input_count]
        if not all(math.isfinite(value) for value in inputs):
            self.values[self.input_count + 1 :] = self.safe
            self.log(
                f"An input is not a finite number at {time:.6g} s: the outputs are the safe ones.", Fmi2Status.warning
            )
            return
        try:
            self.values[self.input_count + 1 :] = [float(value) for value in self.stepper.step(time, inputs)]
        except Exception as error:
            self.values[self.input_count + 1 :] = self.safe
            self.failure = str(error)

    def get_real(self, vrs: list[int]) -> list[float]:
        """Return values (fmi2GetReal)."""
        return [self.values[reference] for reference in vrs]

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Return integers (fmi2GetInteger)."""
        return [int(value) for value in self.get_real(vrs)]

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set values (fmi2SetReal)."""
        for reference, value in zip(vrs, values, strict=True):
            self.values[reference] = value
