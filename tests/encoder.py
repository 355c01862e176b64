"""A speed sensor of one wheelset: the C of the rig (brake_controller/rig/encoder.c), called from Python."""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass, field

from brake_controller.sensors import GATE, LOWEST_FREQUENCY, TEETH, TIMER, edge_errors
from products.protection.rig_in_c import SensorSettings, functions


@dataclass
class Encoder:
    """A toothed wheel with one probe (encoder.h); gate, resolution [s], lowest_frequency [Hz], phase [teeth]."""

    pulses: int = TEETH
    jitter: float = 0.0
    seed: int = 1
    gate: float = GATE
    resolution: float = TIMER
    lowest_frequency: float = LOWEST_FREQUENCY
    phase: float = 0.0
    errors: list[float] = field(init=False)
    #: Angle from one edge to the next [rad].
    pitch: float = field(init=False)

    def __post_init__(self) -> None:
        self.pitch = math.tau / self.pulses
        self.errors = edge_errors(self.pulses, self.jitter, self.seed)
        self._settings = SensorSettings(self.pulses, self.gate, self.resolution, self.lowest_frequency)
        self._errors = (ctypes.c_double * len(self.errors))(*self.errors) if self.errors else None
        self._memory = ctypes.create_string_buffer(functions().encoder_size())
        functions().encoder_begin(self._memory, self._errors, self.phase)

    def angular_velocity(self, time: float, rotation: float) -> float:
        """Return the reading [rad/s] at a time [s], from the rotation of the wheel [rad]."""
        return float(functions().encoder_read(self._memory, self._settings, time, rotation))
