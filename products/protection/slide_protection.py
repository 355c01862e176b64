"""The built-in wheel-slide protection, one object for one vehicle: its C as called from Python."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import astuple

from brake_controller.slide_protection import SlideProtectionParameters, common_protection
from products.controller_kinds import OneInC
from products.protection import rig_in_c


class SlideProtection:
    """Keeps the slip of each wheelset near that of the best adhesion, once sliding is detected.

    The algorithm is in brake_controller/rig/slide_protection.c; docs/controller.md explains it. It is a wheel-slide
    controller (`WheelSlideController`) for as many wheelsets as the first step has speeds. Copies and pickles include
    its state. parameters: thresholds, by default `common_protection()`. Raises CompilerError if the C cannot be
    compiled.
    """

    def __init__(self, parameters: SlideProtectionParameters | None = None) -> None:
        self.parameters = parameters or common_protection()
        self._one: OneInC | None = None
        rig_in_c.library()

    def step(self, time: float, wheel_speeds: Sequence[float]) -> list[int]:
        """Return valve commands, as `WheelSlideController` has them. Raises ValueError for another number of speeds."""
        if self._one is None:
            self._one = self._made(len(wheel_speeds))
        return self._one.step(time, wheel_speeds)

    def _made(self, wheelsets: int) -> OneInC:
        """Return its C before the first step."""
        if wheelsets < 1:
            raise ValueError("wheel_speeds must be at least 1 number; got 0.")
        one_in_c = OneInC(rig_in_c.slide_protection(), wheelsets, 0.0)
        thresholds = astuple(self.parameters)
        rig_in_c.functions().slide_set_thresholds(one_in_c.memory, (ctypes.c_double * len(thresholds))(*thresholds))
        return one_in_c

    @property
    def reference(self) -> float:
        """The reference speed [m/s]."""
        return float(rig_in_c.functions().slide_reference(self._one.memory)) if self._one else 0.0

    @property
    def believed(self) -> list[bool]:
        """True for each wheelset with a valid sensor."""
        if self._one is None:
            return []
        believes, memory = rig_in_c.functions().slide_believes, self._one.memory
        return [bool(believes(memory, number)) for number in range(self._one.wheelsets)]

    def __getstate__(self) -> tuple[SlideProtectionParameters, int, bytes]:
        one = self._one
        return self.parameters, one.wheelsets if one else 0, one.memory.raw if one else b""

    def __setstate__(self, state: tuple[SlideProtectionParameters, int, bytes]) -> None:
        self.parameters, wheelsets, memory = state
        self._one = self._made(wheelsets) if wheelsets else None
        if self._one and len(memory) != len(self._one.memory):
            due = len(self._one.memory)
            raise ValueError(f"A saved SlideProtection must have {due} bytes; got {len(memory)}. Save it again here.")
        if self._one:
            ctypes.memmove(self._one.memory, memory, len(memory))
