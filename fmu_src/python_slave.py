"""The slave class of the pythonfmu FMU: the FMI calls of pythonfmu on one side, the compiled kernel on the other.

`python_fmu.py` joins kernel.py and this file into the one module inside the FMU, so that several FMUs can run in one
Python process without sharing module names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from pythonfmu.enums import Fmi2Status

from fmu_src.kernel import DISCARD, Kernel, Library, SimulationError
from fmu_src.telling_slave import TellingSlave

#: Keys of problems, next to the value references: a problem without a single variable, one of the experiment, and one
#: of the last reading. The next value that is set removes the last of these.
WHOLE, EXPERIMENT, READING = -1, -2, -3


class KernelSlave(TellingSlave):
    """A kernel behind the interface of pythonfmu.

    pythonfmu turns an exception into fmi2Fatal and crashes the host on the next call, so nothing is raised here. A
    refused value is logged as an error, and every step is discarded until that variable has a good value again.
    """

    library_file: str
    guid_of_content: str
    #: Names in the resources of the FMU's own files, by the variables that name files.
    own_files: ClassVar[dict[str, str]] = {}

    def __init__(self, **kwargs):  # type: ignore[no-untyped-def]
        super().__init__(**kwargs)
        self.guid = self.guid_of_content
        self.kernel = Kernel(Library(Path(self.resources) / self.library_file))
        self.problems: dict[int, str] = {}
        self.start_time = 0.0
        self.initialising = False
        files = [self.kernel.number_of(name) for name in self.own_files]
        self.set_string(files, [""] * len(files))

    def setup_experiment(
        self, start_time: float, stop_time: float | None = None, tolerance: float | None = None
    ) -> None:
        """Set start, stop and tolerance (fmi2SetupExperiment); a refused value is logged and kept as a problem."""
        try:
            self.kernel.plan(start_time, stop_time, tolerance)
        except SimulationError as error:
            self._remember(EXPERIMENT, error)
            return
        self.problems.pop(EXPERIMENT, None)
        self.start_time = start_time
        self._tell(Fmi2Status.warning)

    def enter_initialization_mode(self) -> None:
        """Enter the initialisation (fmi2EnterInitializationMode)."""
        self.initialising = True

    def exit_initialization_mode(self) -> None:
        """Compute the state at the start (fmi2ExitInitializationMode)."""
        self._initialise()
        self.initialising = False

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Make a step (fmi2DoStep), times in s; False discards the step, and the log has the reason."""
        for sentence in self.problems.values():
            self.log(sentence, Fmi2Status.error)
        if self.problems:
            return False
        try:
            self.kernel.step(current_time, step_size)
        except SimulationError as error:
            self.log(str(error), Fmi2Status.discard if error.status == DISCARD else Fmi2Status.error)
            return False
        self._tell(Fmi2Status.ok)
        return True

    def get_real(self, vrs: list[int]) -> list[float]:
        """Return values (fmi2GetReal); zeros, with a logged message, if the kernel has no values."""
        if self.initialising and not self.kernel.initialised:
            self._initialise()
        try:
            return [self.kernel.get_number(reference) for reference in vrs]
        except SimulationError as error:
            self._remember(READING, error)
            return [0.0] * len(vrs)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """Return integers (fmi2GetInteger), as `get_real`."""
        return [int(value) for value in self.get_real(vrs)]

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """Return booleans (fmi2GetBoolean), as `get_real`."""
        return [bool(value) for value in self.get_real(vrs)]

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Set values (fmi2SetReal); a refused value is logged, and a problem until a good one comes."""
        self._set(self.kernel.set_number, vrs, values)

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Set strings (fmi2SetString), as `set_real`; an empty one selects the FMU's own file, if there is one."""
        self._set(self._set_text, vrs, values)

    def get_string(self, vrs: list[int]) -> list[str]:
        """Return strings (fmi2GetString)."""
        return [self.kernel.get_text(reference) for reference in vrs]

    set_integer = set_real
    set_boolean = set_real

    def _set_text(self, reference: int, text: str) -> None:
        name = self.own_files.get(self.kernel.library.names[reference], "") if not text else ""
        own = Path(self.resources) / name
        self.kernel.set_text(reference, str(own) if name and own.exists() else text)

    def _set(self, setter: Callable[[int, Any], None], vrs: list[int], values: Sequence[Any]) -> None:
        if self.initialising:
            self.kernel.reopen()
        self.problems.pop(READING, None)
        for reference, value in zip(vrs, values, strict=True):
            try:
                setter(reference, value)
                self.problems.pop(reference, None)
            except SimulationError as error:
                self._remember(reference, error)

    def _tell(self, status: Fmi2Status) -> None:
        for sentence in self.kernel.messages:
            self.log(sentence, status, "events" if status == Fmi2Status.ok else None)
        self.kernel.messages.clear()

    def _initialise(self) -> None:
        try:
            self.kernel.initialise(self.start_time)
            self.problems.pop(WHOLE, None)
        except SimulationError as error:
            self._remember(WHOLE, error)

    def _remember(self, reference: int, error: SimulationError) -> None:
        self.kernel.messages[-1:] = []  # the same message; the rest are not errors
        self.problems[reference] = str(error)
        self.log(str(error), Fmi2Status.error)
