"""Models of FMUs without equations, around an object whose `step` is called once a period."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fmu_src.system import Model
from fmu_src.variables import Variable


@dataclass(frozen=True)
class StepModel:
    """A model for an FMU without equations, around an object whose `step` is called once a period.

    safe: outputs before the first answer and after a failure. Inputs are real.
    """

    name: str
    description: str
    inputs: Sequence[Variable]
    outputs: Sequence[Variable]
    period: float
    safe: Sequence[float]

    @property
    def model(self) -> Model:
        """Return the table of variables, in the order of StepSlave and of step_object.c."""
        period = Variable("period", "parameter", "s", "Time between two answers", self.period, 1e-6, 1.0)
        variables = (*self.inputs, period, *self.outputs)
        return Model(self.name, self.description, variables, (), step_size=self.period)


@dataclass(frozen=True)
class StepInPython(StepModel):
    """A step model around a Python object with `step(time, inputs) -> outputs`.

    sources: text of Python files that need only Python and each other; `own` names the modules that they import from
    each other. expression: makes the object, from names in the sources.
    """

    sources: Sequence[str]
    own: Sequence[str]
    expression: str


@dataclass(frozen=True)
class StepInC(StepModel):
    """Around three functions in C; outputs are integers with the same limits.

    sources: C files by name. size(count) -> bytes of memory, start(memory, count, period), and
    step(memory, time, inputs, outputs): names of the functions, which `header` declares; largest: bytes of memory.
    """

    sources: Mapping[str, str]
    header: str
    size: str
    start: str
    step: str
    count: int
    largest: int
