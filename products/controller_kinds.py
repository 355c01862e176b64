"""The forms in which a wheel-slide controller comes: a class, a function of arrays, a library in C.

`single` makes of each form an object with `step` for one vehicle without a rig.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from brake_controller.protection_fmu import HEADER, LARGEST_MEMORY
from brake_controller.slide_protection import RIG
from brake_controller.wheel_slide import WheelSlideController
from fmu_src.compile import plain_library
from fmu_src.shared_library import fault_of

Numbers = NDArray[np.float64]
#: Functions of wheel_slide.h, called from here or from C.
START = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_double)
STEP = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_double, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int)
)
#: Protections from public descriptions, by name.
PUBLIC = {"dump-valve": RIG / "dump_valve.c"}
#: Runs that go on together.
AT_ONCE, AT_ONCE_IN_ARRAYS = 256, 1024


class FunctionsInC(ctypes.Structure):
    """A `rig_controller` of rig.h."""

    _fields_ = (("start", ctypes.c_void_p), ("step", ctypes.c_void_p), ("size", ctypes.c_size_t))


class ManyControllers(Protocol):
    """A controller of many vehicles at once, a function of arrays."""

    def start(self, rows: NDArray[np.intp], count: int, wheelsets: int, period: float) -> None:
        """Runs begin in these of `count` rows; period [s] between two steps."""

    def step(self, time: Numbers, wheel_speeds: Numbers) -> NDArray[np.integer]:
        """Return commands (count, wheelsets) from times [s], shape (count,), and speeds [m/s], (count, wheelsets)."""


@dataclass(frozen=True)
class InC:
    """A controller of a shared library, wheel_slide.h."""

    path: Path

    @cached_property
    def library(self) -> ctypes.CDLL:
        """Load the library into this process. Raises OSError if it is not a library, or is truncated."""
        if fault := fault_of(self.path.read_bytes()):
            raise OSError(f"{self.path} {fault}")
        return ctypes.CDLL(str(self.path))

    def functions(self, wheelsets: int) -> FunctionsInC:
        """Return its functions and the size of its memory.

        Raises OSError, ValueError if a function is missing or invalid.
        """
        size, start, step = (self._function(f"wheel_slide_{name}") for name in ("size", "start", "step"))
        size.restype, size.argtypes = ctypes.c_size_t, [ctypes.c_int]
        bytes_of_one = int(size(wheelsets))
        if bytes_of_one > LARGEST_MEMORY:
            raise ValueError(f"wheel_slide_size asks for {bytes_of_one} bytes; ask for at most {LARGEST_MEMORY}")
        return FunctionsInC(*(ctypes.cast(one, ctypes.c_void_p) for one in (start, step)), bytes_of_one)

    def checked(self, wheelsets: int, period: float) -> InC:
        """Return this controller. Raises the errors of `functions`."""
        self.functions(wheelsets)
        return self

    def _function(self, name: str) -> Any:
        if not hasattr(self.library, name):
            raise ValueError(f"it has no function {name}")
        return getattr(self.library, name)


@dataclass(frozen=True)
class Arrays:
    """A controller of many vehicles at once."""

    controller: ManyControllers


class Outside:
    """No controller: the caller of the rig's loop sets its valves."""


#: Controllers of a rig: none, a library, a function that makes a controller, a controller on arrays.
Form = InC | Callable[[], WheelSlideController] | Arrays | Outside | None


def at_once(form: Form) -> int:
    """Return how many runs are made together: enough for all lanes of two threads, few enough for the cache.

    More runs make fewer calls of a controller on arrays. An FMU has an instance for each run.
    """
    return AT_ONCE_IN_ARRAYS if isinstance(form, Arrays) else getattr(form, "at_once", AT_ONCE)


def compiled(source: Path) -> InC:
    """A controller from a C file that includes wheel_slide.h. Raises CompilerError."""
    header = (RIG / HEADER).read_text(encoding="utf-8")
    texts = {source.name: source.read_text(encoding="utf-8"), HEADER: header}
    return InC(plain_library({}, texts))


class OneInC:
    """A controller of this number of wheelsets with its own memory; period: of its steps [s]."""

    def __init__(self, form: InC, wheelsets: int, period: float) -> None:
        functions = form.functions(wheelsets)
        self._form = form  # keeps the library
        self._step = STEP(functions.step)
        self.wheelsets, self.memory = wheelsets, ctypes.create_string_buffer(max(functions.size, 1))
        self._valves = (ctypes.c_int * wheelsets)()
        START(functions.start)(self.memory, wheelsets, period)

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return valve commands of all wheelsets from their speeds [m/s]; a valve that is not set keeps its command.

        Raises ValueError if the number of speeds is wrong.
        """
        if len(wheel_speeds) != self.wheelsets:
            raise ValueError(f"wheel_speeds must be {self.wheelsets} numbers; got {len(wheel_speeds)}.")
        self._step(self.memory, time, (ctypes.c_double * self.wheelsets)(*wheel_speeds), self._valves)
        return list(self._valves)


class OneOfMany:
    """A controller on arrays with one vehicle of this number of wheelsets; period: of its steps [s]."""

    def __init__(self, form: Arrays, wheelsets: int, period: float) -> None:
        self._many = form.controller
        self._many.start(np.array([0]), 1, wheelsets, period)

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return valve commands of all wheelsets from their speeds [m/s]."""
        [valves] = np.asarray(self._many.step(np.array([time]), np.array([wheel_speeds]))).tolist()
        return list(valves)


def single(name: str, form: Form, wheelsets: int, period: float) -> WheelSlideController:
    """Return a new controller of one vehicle, with this name in messages; period of its calls [s]."""
    assert form is not None
    assert not isinstance(form, Outside)
    if not isinstance(form, InC | Arrays):
        return form()
    kind = OneInC if isinstance(form, InC) else OneOfMany
    controller: WheelSlideController = type(name, (kind,), {})(form, wheelsets, period)
    return controller
