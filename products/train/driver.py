"""A driver who holds a train's speed: by motors, by a dynamic brake, and by air for the rest."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from brake_controller.distributors import kind_of
from products.train.consist import Consist
from products.train.cycle_braking import CycleBraking
from products.train.starting import StartWatch
from products.train.train import Train, within
from readers.usual import note

#: Fall of the pipe at the first step of service as a share of that at full service: 0.4 of 1.5 bar (UIC 540).
LEAST = 0.4 / 1.5
#: Force of the whole brake over that of all motors: demands for traction are multiplied by it. Assumed.
PULLS = 5.0
#: Share of the air brake that holds a train; mean speed of vehicles below which a train rolls back [m/s]. Assumed.
HOLDS, BACK = 0.5, -0.05
#: Lower and upper limits of a driver's numbers, with their units.
LIMITS = {
    "speed": (0.1, 150.0, "m/s"),
    "dynamic": (0.0, 0.95, ""),
    "gain": (1e-3, 10.0, "s/m"),
    "memory": (1.0, 1e4, "s"),
    "period": (1e-2, 10.0, "s"),
}
#: Air rises by full service in this time, and falls as slowly [s]: a driver's hand follows no ripple. Assumed.
MOVES = 8.0


def direct_release(consist: Consist) -> int:
    """Return the number of the first vehicle, from 1, whose brake releases wholly; 0: all release in part."""
    return next(
        (number for number, vehicle in enumerate(consist.vehicles, 1) if kind_of(vehicle.distributor).releases_wholly),
        0,
    )


def rolls_back(train: Train) -> bool:
    """Return whether a train rolls backwards: slack moves single vehicles, so its vehicles' mean speed counts."""
    return float(np.mean(train.speed)) < BACK


def hold(train: Train) -> float:
    """Apply the air that holds a train, without traction and dynamic brakes; return its share of the air brake."""
    train.inputs["traction"], train.inputs["dynamic_brake"] = 0.0, 0.0
    train.drive("service", (HOLDS - LEAST) / (1.0 - LEAST))
    return HOLDS


def acknowledge(train: Train) -> None:
    """Change the input of the vigilance device at the head's valve: an attentive driver does so at each action."""
    if any(vehicle.vigilance.vigilance_time > 0.0 for vehicle in train.consist.vehicles):
        train.inputs["vigilance"][0] = 1.0 - train.inputs["vigilance"][0]


@dataclass
class HoldingDriver:
    """A proportional and integral law of speed, called once a `period` [s].

    demand = k (v - v0) + (k / T) int (v - v0) dt, as a share of the whole brake. A dynamic brake takes the first
    `dynamic` of it, and air the rest: the driver's valve is in service, or running below half of its first step.
    A demand below 0 is traction, in trains with motors: five times that share of their largest force.
    A train that rolls back is held by air, without traction. Where a vehicle's brake releases wholly, as AAR valves do,
    air is never reduced in part: such a train is balanced by its dynamic brake or motors, or brakes in cycles, and uses
    any `dynamic` above 0 as far as its dynamic brake has force (`cycle_braking`).
    Gains are assumed: 1 m/s too fast adds a tenth of the brake, and T is longer than the release of a cylinder.

    Parameters
    ----------
    speed : float
        Speed to hold [m/s].
    dynamic : float
        Share of the whole brake that dynamic brakes take first, 0 to 0.95.
    gain, memory : float
        Demand for each m/s [s/m], and time constant T of its integral [s].
    period : float
        Time between two calls of `act` [s].
    added, air : float
        State: integral of the demand, and share of the air brake.

    Raises
    ------
    ValueError
        If a number is out of its limits.
    """

    speed: float
    dynamic: float = 0.0
    gain: float = 0.1
    memory: float = 60.0
    period: float = 1.0
    added: float = 0.0
    air: float = 0.0
    _watch: StartWatch = field(default_factory=StartWatch, init=False, repr=False)
    _descent: CycleBraking | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        for name, (least, most, unit) in LIMITS.items():
            within(name, getattr(self, name), least, most, unit)

    def act(self, train: Train) -> None:
        """Set the driver's valve of the head, the dynamic brakes and the traction of a train.

        Call it once a `period`, before the train advances. Raises ValueError if no vehicle has the dynamic brake that
        the driver counts on, or if the train stands for 180 s: it does not start, or its brakes hold it on a descent.
        """
        if self.dynamic and not any(one.electric.dynamic_force > 0.0 for one in train.consist.vehicles):
            raise ValueError(
                f"dynamic must be 0 with a train without dynamic brakes; got {self.dynamic:g}. State dynamic_force of "
                "a vehicle."
            )
        acknowledge(train)
        train.remark(note("speed of the driver", self.speed, "m/s"))
        self._watch.look(train, reason=self._descent.refused if self._descent else "")
        if rolls_back(train):
            self.air = hold(train)
            return
        if direct_release(train.consist):
            self._cycle(train)
            return
        pulls = any(vehicle.traction.traction_force > 0.0 for vehicle in train.consist.vehicles)
        fast = float(train.speed[0]) - self.speed
        demand = self.added + self.gain * fast
        if (-1.0 / PULLS if pulls else 0.0) < demand < 1.0 or demand * fast < 0.0:  # no wind-up beyond the brake
            self.added += self.gain / self.memory * fast * self.period
        if pulls:
            train.inputs["traction"] = min(max(-PULLS * demand, 0.0), 1.0)
        demand = min(max(demand, 0.0), 1.0)
        if self.dynamic:
            train.inputs["dynamic_brake"] = min(demand / self.dynamic, 1.0)
        wanted = max(demand - self.dynamic, 0.0) / (1.0 - self.dynamic)
        change = self.period / MOVES
        self.air = float(np.clip(wanted, self.air - change, self.air + change))
        self._set_air(train)

    def _cycle(self, train: Train) -> None:
        """Brake a train whose brakes release wholly."""
        if self._descent is None or self._descent.train is not train:
            self._descent = CycleBraking(train, LEAST)
        self._descent.act(self.speed, self.dynamic > 0.0)
        self.air = self._descent.air
        if self.dynamic:
            train.inputs["dynamic_brake"] = self._descent.dynamic
        if any(vehicle.traction.traction_force > 0.0 for vehicle in train.consist.vehicles):
            train.inputs["traction"] = self._descent.traction
        self._set_air(train)

    def _set_air(self, train: Train) -> None:
        """Set the driver's valve for the share of the air brake."""
        if self.air < LEAST / 2:
            train.drive("running")
        else:
            train.drive("service", max(self.air - LEAST, 0.0) / (1.0 - LEAST))
