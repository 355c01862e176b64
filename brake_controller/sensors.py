"""Sensors of the wheels' rotation: pulses of an encoder, sampled, with noise (the shaft encoders of Table 6.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from random import Random

#: Pulses of the encoders of the experiment in one turn (Table 6.3).
PULSES_OF_THE_EXPERIMENT = 10000


@dataclass
class Encoder:
    """Counts pulses and divides by the time between two looks; what is between pulses is not seen.

    pulses: in one turn; jitter: standard deviation of the edges as a share of a pulse, from `seed`.
    """

    pulses: int = PULSES_OF_THE_EXPERIMENT
    jitter: float = 0.0
    seed: int = 1
    time: float | None = None
    count: float = 0.0
    random: Random = field(init=False)

    def __post_init__(self) -> None:
        if self.pulses < 1:
            raise ValueError(f"Set pulses to at least 1: it was {self.pulses}.")
        if not (math.isfinite(self.jitter) and self.jitter >= 0.0):
            raise ValueError(f"Set jitter to a finite value of at least 0: it was {self.jitter}.")
        self.random = Random(self.seed)

    def angular_velocity(self, time: float, rotation: float) -> float:
        """Mean angular velocity [rad/s] since the last look, from the rotation [rad]; 0 at the first look."""
        count = math.floor(rotation / math.tau * self.pulses + self.random.gauss(0.0, self.jitter))
        before, self.count = self.count, count
        last, self.time = self.time, time
        return 0.0 if last is None or time <= last else (count - before) * math.tau / self.pulses / (time - last)
