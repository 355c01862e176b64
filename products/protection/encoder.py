"""A speed sensor of one wheelset: its C (brake_controller/rig/encoder.c) as Python calls it."""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass, field

from brake_controller.sensors import GATE, LOWEST_FREQUENCY, TEETH, TIMER, edge_errors
from products.protection.rig_in_c import SensorSettings, functions
from products.protection.settings import MOST_PULSES


@dataclass
class Encoder:
    """A toothed wheel with one probe, which detects edges and their times but not their direction.

    The reading is the mean speed between the last edge and the last one at least `gate` [s] before it. Until the next
    edge it is at most one pitch over the time since the last one, so that it falls as a wheel stops. Below
    `lowest_frequency` [Hz] of edges it is 0, as before the first edges: a wheel that turns slowly and one that stands
    cannot be distinguished there. Edges between two samples are interpolated for a constant speed between them.

    Parameters
    ----------
    pulses : int
        Teeth, with one edge each.
    jitter : float
        Standard deviation of their places as a share of the pitch, the same in every revolution.
    seed : int
        Seed of these places.
    gate : float
        Shortest time over which a speed is measured [s].
    resolution : float
        Resolution of the timer [s].
    lowest_frequency : float
        Frequency of edges below which the reading is 0 [Hz].
    phase : float
        Initial angle of the wheel as a share of a tooth.

    Raises
    ------
    ValueError
        If a value is invalid.
    CompilerError
        If the C cannot be compiled.
    """

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
        if not (1 <= self.pulses <= MOST_PULSES and self.pulses == int(self.pulses)):
            raise ValueError(f"pulses must be an integer from 1 to {MOST_PULSES}; got {self.pulses}.")
        if not math.isfinite(self.phase):
            raise ValueError(f"phase must be finite; got {self.phase}. Give the share of a tooth.")
        if not (math.isfinite(self.jitter) and self.jitter >= 0.0):
            raise ValueError(f"jitter must be finite and at least 0; got {self.jitter}.")
        for name in ("gate", "resolution", "lowest_frequency"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"{name} must be finite and above 0; got {getattr(self, name)}.")
        self.pitch = math.tau / self.pulses
        self.errors = edge_errors(self.pulses, self.jitter, self.seed)
        self._settings = SensorSettings(self.pulses, self.gate, self.resolution, self.lowest_frequency)
        self._call = functions()
        self._errors = (ctypes.c_double * len(self.errors))(*self.errors) if self.errors else None
        # An array of pointers, as the C object holds one: it cannot be copied or pickled.
        self._memory = (ctypes.c_void_p * (self._call.encoder_size() // ctypes.sizeof(ctypes.c_void_p) + 1))()
        self._call.encoder_begin(self._memory, self._errors, self.phase)

    def angular_velocity(self, time: float, rotation: float) -> float:
        """Return the reading at a time.

        Takes time [s], rotation [rad]; returns [rad/s].
        """
        for name, value, unit in (("time", time, "s"), ("rotation", rotation, "rad")):
            if not math.isfinite(value):
                raise ValueError(f"{name} must be finite; got {value} {unit}. Leave this reading out.")
        return float(self._call.encoder_read(self._memory, self._settings, time, rotation))
