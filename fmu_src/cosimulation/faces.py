"""The calls of FMI 2.0 and 3.0 that an instance needs, with the same few functions for both standards."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import byref
from pathlib import Path
from typing import Any

from readers.extras import named_extras

with named_extras():
    from fmpy import calloc, free
    from fmpy.fmi1 import FMICallException
    from fmpy.fmi2 import (
        FMU2Slave,
        fmi2CallbackAllocateMemoryTYPE,
        fmi2CallbackFreeMemoryTYPE,
        fmi2CallbackFunctions,
        fmi2CallbackLoggerTYPE,
        fmi2CoSimulation,
        fmi2Error,
    )
    from fmpy.fmi3 import FMU3Slave
    from fmpy.model_description import ModelDescription

#: Receives a message of an FMU.
Listener = Callable[[str], None]


class Face2:
    """FMI 2.0: one instance for co-simulation. Calls raise fmpy's FMICallException."""

    #: Types of variables by those of their functions.
    types = {"Real": "Real", "Integer": "Integer", "Boolean": "Boolean", "Enumeration": "Integer", "String": "String"}
    reals: tuple[str, ...] = ("Real",)
    #: Class of fmpy, the name of a state in its functions, and whether inputs can change within a step.
    slave, state, ramps = FMU2Slave, "FMUstate", True

    def __init__(self, about: ModelDescription, folder: str, name: str, listen: Listener) -> None:
        able = about.coSimulation
        self.saves, self.takes_rates = able.canGetAndSetFMUstate, self.ramps and able.canInterpolateInputs
        self.provides_rates = able.maxOutputDerivativeOrder > 0
        self.fmu = self.slave(
            guid=about.guid, unzipDirectory=folder, modelIdentifier=able.modelIdentifier, instanceName=name
        )
        self._folder, self._listen = folder, listen

    def instantiate(self) -> None:
        """Instantiate the FMU. Methods are named after the functions of the standard."""
        fmu, callbacks = self.fmu, fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(
            lambda environment, instance, status, category, text: self._listen(
                text.decode(errors="replace").replace("%%", "%")
            )
        )
        callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
        callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
        resources = undecoded(self._folder)
        if resources is None:
            fmu.instantiate(callbacks=callbacks, loggingOn=True)
            return
        name, guid, place = (one.encode() for one in (fmu.instanceName, fmu.guid, resources))
        fmu.callbacks = callbacks
        fmu.component = fmu.fmi2Instantiate(name, fmi2CoSimulation, guid, place, byref(fmu.callbacks), 0, 1)
        if not fmu.component:
            raise FMICallException("fmi2Instantiate", fmi2Error)

    def begin(self, time: float, set_parameters: Callable[[], None], set_inputs: Callable[[], None]) -> None:
        """Take an instance to its first step: set parameters before initialisation, inputs within it."""
        self.fmu.setupExperiment(startTime=time)
        set_parameters()
        self.fmu.enterInitializationMode()
        set_inputs()
        self.fmu.exitInitializationMode()

    def set(self, kind: str, reference: int, values: Sequence[Any]) -> None:
        """Set all values of one variable, those of an array row by row."""
        getattr(self.fmu, f"set{kind}")([reference], list(values))

    def get(self, kind: str, references: Sequence[int], count: int) -> list[Any]:
        """Return the values of variables of one kind; `count` values in all."""
        return list(getattr(self.fmu, f"get{kind}")(list(references)))

    def step(self, time: float, size: float) -> None:
        """Advance from `time` by `size` [s]. Raises EndedError if an FMU of FMI 3.0 requests the end of the run."""
        self.fmu.doStep(time, size)

    def rate(self, reference: int) -> float:
        """Return the first derivative of an output by time."""
        return float(self.fmu.getRealOutputDerivatives([reference], [1])[0])

    def set_rate(self, reference: int, rate: float) -> None:
        """Set the rate of an input within the next step; only called if `takes_rates`."""
        self.fmu.setRealInputDerivatives([reference], [1], [rate])

    def save(self) -> Any:
        """Return the state."""
        return getattr(self.fmu, f"get{self.state}")()

    def restore(self, state: Any) -> None:
        """Restore a state."""
        getattr(self.fmu, f"set{self.state}")(state)

    def forget(self, state: Any) -> None:
        """Free a state."""
        getattr(self.fmu, f"free{self.state}")(state)


def undecoded(folder: str) -> str | None:
    """Return the resources of an FMU made by pythonfmu, or None for any other FMU.

    Its binary decodes only blanks of a URI, and ends the process if it finds no module.
    """
    resources = Path(folder, "resources")
    if not (resources / "slavemodule.txt").exists():
        return None
    return f"file:///{resources.absolute().as_posix().lstrip('/')}"


class Face3(Face2):
    """FMI 3.0, likewise. Inputs stay constant within a step: rates would need intermediate updates."""

    _numbers = ("Float64", "Float32", *(f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)))
    types = {name: name for name in (*_numbers, "Boolean", "String")} | {"Enumeration": "Int64"}
    reals = ("Float64", "Float32")
    slave, state, ramps = FMU3Slave, "FMUState", False

    def instantiate(self) -> None:
        """Instantiate the FMU. Methods are named after the functions of the standard."""
        self.fmu.instantiate(
            loggingOn=True,
            logMessage=lambda environment, status, category, text: self._listen(text.decode(errors="replace")),
        )

    def begin(self, time: float, set_parameters: Callable[[], None], set_inputs: Callable[[], None]) -> None:
        """Take an instance to its first step: set parameters before initialisation, inputs within it."""
        set_parameters()
        self.fmu.enterInitializationMode(startTime=time)
        set_inputs()
        self.fmu.exitInitializationMode()

    def get(self, kind: str, references: Sequence[int], count: int) -> list[Any]:
        """Return the values of variables of one kind; `count` values in all."""
        return list(getattr(self.fmu, f"get{kind}")(list(references), count))

    def step(self, time: float, size: float) -> None:
        """Advance from `time` by `size` [s]. Raises EndedError if the FMU requests the end of the run."""
        *_, ended, _, _ = self.fmu.doStep(time, size)
        if ended:
            raise EndedError

    def rate(self, reference: int) -> float:
        """Return the first derivative of an output by time."""
        return float(self.fmu.getOutputDerivatives([reference], [1])[0])


class EndedError(Exception):
    """The FMU asked to end the run, terminateSimulation of FMI 3.0, section 4.2.1.2."""

    def __init__(self) -> None:
        super().__init__("The FMU asked to end the run.")


#: Classes by the version of the standard.
FACES: dict[str, type[Face2]] = {"2.0": Face2, "3.0": Face3}


def face_of(about: ModelDescription, folder: str, name: str, listen: Listener) -> Face2:
    """Return the FMI functions of an instance, by the version of its standard. Raises KeyError for another version."""
    return FACES[about.fmiVersion](about, folder, name, listen)
