"""An FMU instance of either FMI standard in a host, with one interface for both."""

from __future__ import annotations

import shutil
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import c_char_p, c_uint32, c_void_p
from pathlib import Path

from fmpy import calloc, extract, free, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Model,
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Model, FMU3Slave, fmi3LogMessageCallback

from fmu_src.cosimulation.slave import FmuInstance

OK, WARNING, DISCARD, ERROR = range(4)
STEP = 1e-3
#: Outputs after each step of STEP of a controller that counts its calls modulo 3, called every 10 ms.
THREES = [1] * 10 + [2] * 10 + [0] * 10 + [1] * 10 + [2] * 10


class Host:
    """An instance of either standard. Every call returns its status; messages are kept."""

    def __init__(
        self, path: Path, logging: bool = True, early: bool = False, events: bool = False, exchange: bool = False
    ) -> None:
        about = read_model_description(str(path))
        self.three = about.fmiVersion == "3.0"
        self.refs = {v.name: v.valueReference for v in about.modelVariables}
        self.said: list[str] = []
        self.heard: list[tuple[int, bytes]] = []
        self.folder = extract(str(path))
        name = about.coSimulation.modelIdentifier
        given = {"guid": about.guid, "unzipDirectory": self.folder, "modelIdentifier": name, "instanceName": "sled"}
        kind = (FMU3Model if exchange else FMU3Slave) if self.three else (FMU2Model if exchange else FMU2Slave)
        self.fmu = kind(**given)
        if self.three:
            self.listener = fmi3LogMessageCallback(lambda env, status, kind, text: self.listen(status, text))
            how = {} if exchange else {"eventModeUsed": events, "earlyReturnAllowed": early}
            self.fmu.instantiate(loggingOn=logging, logMessage=self.listener, **how)
        else:
            self.listener = fmi2CallbackLoggerTYPE(lambda *given: self.listen(given[2], given[4]))
            calls = fmi2CallbackFunctions()
            calls.logger = self.listener
            calls.allocateMemory, calls.freeMemory = (
                fmi2CallbackAllocateMemoryTYPE(calloc),
                fmi2CallbackFreeMemoryTYPE(free),
            )
            self.calls = calls
            self.fmu.instantiate(callbacks=calls, loggingOn=logging)

    def listen(self, status: int, text: bytes) -> None:
        """Keep a message as text, and its status with the bytes: an exception in a callback would be lost."""
        self.heard.append((status, text))
        self.said.append(text.decode(errors="backslashreplace"))

    @property
    def instance(self) -> c_void_p:
        return c_void_p(self.fmu.component)

    def raw(self, name: str, *arguments: object) -> int:
        """Return the status of a function of the standard, named without its prefix."""
        prefix = "fmi3" if self.three else "fmi2"
        function = getattr(self.fmu, prefix + name, None) or self.fmu.dll[prefix + name]
        try:
            return int(function(self.instance, *arguments) or 0)
        except FMICallException as error:
            return int(error.status)

    def status(self, call: Callable, *arguments: object, **named: object) -> int:
        """Return the status of a method of FMPy, which raises statuses above a warning."""
        try:
            call(*arguments, **named)
        except FMICallException as error:
            return int(error.status)
        return OK

    def experiment(self, start: float = 0.0, stop: float | None = None, tolerance: float | None = None) -> int:
        """Start the experiment by fmi2SetupExperiment or fmi3EnterInitializationMode; return the status."""
        defined = (tolerance is not None, tolerance or 0.0, start, stop is not None, stop or 0.0)
        return self.raw("EnterInitializationMode" if self.three else "SetupExperiment", *defined)

    def start(self, start: float = 0.0, stop: float | None = None, **inputs: float) -> None:
        assert self.experiment(start, stop) == OK
        if not self.three:
            assert self.raw("EnterInitializationMode") == OK
        for name, value in inputs.items():
            assert self.set(name, value) == OK
        assert self.raw("ExitInitializationMode") == OK

    def set(self, name: str, value: float) -> int:
        return self.status(self.fmu.setFloat64 if self.three else self.fmu.setReal, [self.refs[name]], [value])

    def set_text(self, name: str, text: bytes) -> int:
        """Set a string, which may be invalid UTF-8; return the status."""
        values = (c_char_p * 1)(text)
        return self.raw("SetString", (c_uint32 * 1)(self.refs[name]), 1, values, *([1] if self.three else []))

    def __getitem__(self, name: str) -> float:
        return float((self.fmu.getFloat64 if self.three else self.fmu.getReal)([self.refs[name]])[0])

    def step(self, time: float, size: float = STEP) -> int:
        return self.status(self.fmu.doStep, time, size)

    def state(self) -> bytes:
        """Return the whole state, serialised."""
        if self.three:
            saved = self.fmu.getFMUState()
            found = bytes(self.fmu.serializeFMUState(saved))
            self.fmu.freeFMUState(saved)
        else:
            saved = self.fmu.getFMUstate()
            found = bytes(self.fmu.serializeFMUstate(saved))
            self.fmu.freeFMUstate(saved)
        return found


def sign(resources: Path, name: str) -> None:
    """Write size and sum of a changed file of an FMU's data into its identity, as the build does."""
    file, data = resources / "identity.csv", (resources / name).read_bytes()
    rows = [row for row in file.read_text().splitlines() if not row.startswith(f"{name},")]
    file.write_text("\n".join([*rows, f"{name},{len(data)},{zlib.crc32(data):08x}", ""]))


@contextmanager
def host(path: Path, **how: bool) -> Iterator[Host]:
    made = Host(path, **how)
    yield made
    made.fmu.freeInstance()
    shutil.rmtree(made.folder, ignore_errors=True)


def answers_of_a_counter(path: Path) -> list[int]:
    """Return the first valve of a controller FMU after each of 50 steps, with a controller period of 10 ms."""
    with FmuInstance(path, period=0.01) as slave:
        slave.start(wheel_speed_1=1.0, wheel_speed_2=1.0)
        found = []
        for number in range(len(THREES)):
            slave.step(number * STEP, STEP)
            found.append(int(slave["valve_1"]))
    return found
