"""A controller in C, or on arrays, as an object with `step` for one vehicle without a rig."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np

from products.protection.controller_kinds import Arrays, InC

_START = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_double)
_STEP = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_double, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int)
)


class OneInC:
    """A controller of this number of wheelsets with its own memory; period: of its steps [s]."""

    def __init__(self, form: InC, wheelsets: int, period: float) -> None:
        functions = form.functions(wheelsets)
        self._form = form  # keeps the library
        self._step = _STEP(functions.step)
        self.wheelsets, self.memory = wheelsets, ctypes.create_string_buffer(max(functions.size, 1))
        self._valves = (ctypes.c_int * wheelsets)()
        _START(functions.start)(self.memory, wheelsets, period)

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
