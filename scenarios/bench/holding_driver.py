"""A driver who holds a train's speed on a falling gradient, by a dynamic brake first and by air for the rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from products.train.train import Train

#: Fall of the pipe at the first step of service as a share of that at full service: 0.4 of 1.5 bar (UIC 540).
LEAST = 0.4 / 1.5
#: Air rises by full service in this time, and falls as slowly [s]: a driver's hand follows no ripple. Assumed.
MOVES = 8.0


@dataclass
class HoldingDriver:
    """A proportional and integral law of speed, called once a `period` [s].

    demand = k (v - v0) + (k / T) int (v - v0) dt, as a share of the whole brake. A dynamic brake takes the first
    `dynamic` of it, and air the rest: the driver's valve is in service, or running below half of its first step.
    Gains are assumed: 1 m/s too fast adds a tenth of the brake, and T is longer than the release of a cylinder.
    """

    speed: float
    dynamic: float = 0.0
    gain: float = 0.1
    memory: float = 60.0
    period: float = 1.0
    added: float = 0.0
    air: float = 0.0

    def act(self, train: Train) -> None:
        """Set the driver's valve of the head and the dynamic brakes of a train."""
        fast = float(train.speed[0]) - self.speed
        demand = self.added + self.gain * fast
        if 0.0 < demand < 1.0 or demand * fast < 0.0:  # no wind-up beyond the brake
            self.added += self.gain / self.memory * fast * self.period
        demand = min(max(demand, 0.0), 1.0)
        if self.dynamic:
            train.inputs["dynamic_brake"] = min(demand / self.dynamic, 1.0)
        wanted = max(demand - self.dynamic, 0.0) / (1.0 - self.dynamic)
        change = self.period / MOVES
        self.air = float(np.clip(wanted, self.air - change, self.air + change))
        if self.air < LEAST / 2:
            train.drive("running")
        else:
            train.drive("service", max(self.air - LEAST, 0.0) / (1.0 - LEAST))
