"""FMUs through fmpy, with variables by name."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType

from fmpy import calloc, extract, free, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

TYPES = {"Real": "Real", "Integer": "Integer", "Boolean": "Boolean", "Enumeration": "Integer", "String": "String"}


class CosimulationError(RuntimeError):
    """A call to an FMU failed; the text is the FMU's own sentence."""


class Slave:
    """One instance of an FMU, with variables by name. A context manager: it cleans up after itself.

    instance: its name where several of one FMU are coupled; by default that of the model.

    >>> with Slave("build/native/BogieDynamics.fmu", initial_speed=25.0) as bogie:
    ...     bogie.start(brake_torque_1=20e3)
    ...     bogie.step(0.0, 0.01)
    ...     bogie["speed"]
    """

    def __init__(self, path: str | Path, instance: str | None = None, /, **parameters: float | str) -> None:
        description = read_model_description(str(path))
        self.name = instance or description.modelName
        self.guid = description.guid
        self.messages: list[str] = []
        self._variables = {v.name: (v.valueReference, TYPES[v.type]) for v in description.modelVariables}
        self.units = {v.name: v.unit or "1" for v in description.modelVariables}
        able = description.coSimulation
        self._nominals = {v.name: float(v.nominal) if v.nominal else 1.0 for v in description.modelVariables}
        self._saves, self._takes_rates = able.canGetAndSetFMUstate, able.canInterpolateInputs
        self._provides_rates = able.maxOutputDerivativeOrder > 0
        self._parameters: dict[str, float | str] = parameters
        self._plans: dict[tuple[str, ...], list[tuple[Callable, list[int], list[int]]]] = {}
        self._folder = extract(str(path))
        self._logger = fmi2CallbackLoggerTYPE(self._listen)  # referenced here as long as the FMU may call it
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = self._logger
        self._callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        self._callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=self._folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName=self.name,
        )
        self._call(self.fmu.instantiate, callbacks=self._callbacks, loggingOn=True)

    def __enter__(self) -> Slave:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def start(self, time: float = 0.0, **inputs: float) -> None:
        """Sets parameters and first inputs and initialises."""
        self._call(self.fmu.setupExperiment, startTime=time)
        self.set(**self._parameters)
        self._call(self.fmu.enterInitializationMode)
        self.set(**inputs)
        self._call(self.fmu.exitInitializationMode)

    def restart(self, parameters: Mapping[str, float | str], **inputs: float) -> None:
        """Resets the instance and starts it with other parameters."""
        self._call(self.fmu.reset)
        self.messages.clear()
        self._parameters = dict(parameters)
        self.start(**inputs)

    def set(self, **values: float | str) -> None:
        """Sets variables. Raises CosimulationError with the FMU's sentence where it refuses a value."""
        for name, value in values.items():
            reference, kind = self._reference(name)
            given = value if kind in ("Real", "String") else int(value)
            self._call(getattr(self.fmu, f"set{kind}"), [reference], [given])

    def __getitem__(self, name: str) -> float:
        return self.get([name])[0]

    def get(self, names: Sequence[str]) -> list[float]:
        """Values of some variables, in their order; one call for each type."""
        key = tuple(names)
        found = [0.0] * len(key)
        for getter, references, places in self._plans.get(key) or self._plan(key):
            for place, value in zip(places, self._call(getter, references), strict=True):
                found[place] = float(value)
        return found

    def _plan(self, names: tuple[str, ...]) -> list[tuple[Callable, list[int], list[int]]]:
        """The calls that read some variables: function, value references, and their places among the names."""
        plan = []
        for kind in ("Real", "Integer", "Boolean"):
            places = [place for place, name in enumerate(names) if self._reference(name)[1] == kind]
            if places:
                references = [self._reference(names[place])[0] for place in places]
                plan.append((getattr(self.fmu, f"get{kind}"), references, places))
        self._plans[names] = plan
        return plan

    def step(self, time: float, size: float) -> None:
        """From `time` on by `size` [s]. Raises CosimulationError."""
        self._call(self.fmu.doStep, time, size)

    def nominal(self, name: str) -> float:
        """Typical size of a variable, from the FMU; 1 where it says nothing."""
        self._reference(name)
        return self._nominals[name]

    def rate(self, name: str) -> float:
        """First derivative of an output by time; 0 where the FMU provides none."""
        if not self._provides_rates:
            return 0.0
        found = self._call(self.fmu.getRealOutputDerivatives, [self._reference(name)[0]], [1])
        return float(found[0])

    def set_rate(self, name: str, rate: float) -> None:
        """Lets an input go on with this rate within the next step; without effect where the FMU takes none."""
        if self._takes_rates:
            self._call(self.fmu.setRealInputDerivatives, [self._reference(name)[0]], [1], [rate])

    def save(self) -> object:
        """The FMU's state; `forget` it when it is no longer needed. Raises CosimulationError where it cannot."""
        if not self._saves:
            raise CosimulationError(f"{self.name} cannot save its state: give no tolerance, or take the native FMU.")
        return self._call(self.fmu.getFMUstate)

    def restore(self, state: object) -> None:
        """Takes the instance back to a saved state."""
        self._call(self.fmu.setFMUstate, state)

    def forget(self, state: object) -> None:
        """Frees a saved state."""
        self._call(self.fmu.freeFMUstate, state)

    def _reference(self, name: str) -> tuple[int, str]:
        if name not in self._variables:
            raise CosimulationError(f"{self.name} has no variable {name}; it has {', '.join(self._variables)}.")
        return self._variables[name]

    def _listen(self, environment: object, instance: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append(message.decode(errors="replace").replace("%%", "%"))

    def _call(self, function: Callable, *arguments: object, **named: object):  # type: ignore[no-untyped-def]
        heard = len(self.messages)
        try:
            return function(*arguments, **named)
        except FMICallException as error:
            # Only what this call said: an older sentence is no reason.
            sentence = self.messages[-1] if len(self.messages) > heard else str(error)
            raise CosimulationError(f"{self.name}: {sentence}") from error
