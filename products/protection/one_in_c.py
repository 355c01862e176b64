"""One controller in C as an object with `step`, where no rig in C stands around it."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

from products.protection.forms import InC

_START = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_double)
_STEP = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.c_double, ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int)
)


class OneInC:
    """A controller of so many wheelsets with its own memory; period between two of its steps [s]."""

    def __init__(self, form: InC, wheelsets: int, period: float) -> None:
        functions = form.functions(wheelsets)
        self._form = form  # keeps the library
        self._step = _STEP(functions.step)
        self._memory = ctypes.create_string_buffer(max(functions.size, 1))
        self._valves = (ctypes.c_int * wheelsets)()
        _START(functions.start)(self._memory, wheelsets, period)

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Valve commands of all wheelsets from their speeds [m/s]; those before stay where it sets none."""
        self._step(self._memory, time, (ctypes.c_double * len(wheel_speeds))(*wheel_speeds), self._valves)
        return list(self._valves)
