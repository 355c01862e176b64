"""What the test rig is asked for, and what it answers: runs with their faults, and stops."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from products.protection.history import History

#: How a sensor may fail, by the numbers of rig.h.
SENSOR_FAILURES = {"stuck": 1, "zero": 2, "doubled": 3}


@dataclass(frozen=True)
class Fault:
    """What is wrong with one wheelset, by its number.

    radius: what its wheels' radius is taken for, over the true one. sensor: one of SENSOR_FAILURES, from a time on [s];
    valve_from: when its valve begins to stay where it is [s]. Raises ValueError for what cannot be.
    """

    wheelset: int
    radius: float = 1.0
    sensor: str = ""
    sensor_from: float = 0.0
    valve_from: float = math.inf

    def __post_init__(self) -> None:
        if self.sensor and self.sensor not in SENSOR_FAILURES:
            raise ValueError(f"Set sensor to one of {', '.join(SENSOR_FAILURES)}: it was {self.sensor!r}.")
        if not 0.5 <= self.radius <= 2.0:
            raise ValueError(f"Set radius to 0.5 to 2 times the true one: it was {self.radius}.")
        if self.wheelset < 1:
            raise ValueError(f"Set wheelset to 1 or more: it was {self.wheelset}.")
        if not self.sensor and (self.sensor_from or (self.radius == 1.0 and math.isinf(self.valve_from))):
            raise ValueError("This fault has no effect; give it a sensor, a radius other than 1, or valve_from.")


@dataclass(frozen=True)
class Run:
    """One stop: inputs and parameters of the vehicle; speed [m/s] and strength, by default those of the settings."""

    values: Mapping[str, float]
    speed: float | None = None
    strength: float | None = None
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True)
class Stop:
    """What a run came to.

    distance [m]: None where it did not stop or its controller failed; end_speed [m/s] and time [s]: of its end.
    longest_lock [s], above the speed at which locks count; longest_skid: way of a locked wheelset at any speed [m];
    share_in_band: of the braked time, with all slips in the band; air: what all cylinders took [kg]; sliding: energy
    between the wheels of each wheelset and the rails [J]; lowest_reservoir: pressure [Pa], None without a reservoir;
    commands: how often a valve was told anything but to apply; said: a sentence; history: where it was asked for.
    """

    distance: float | None
    end_speed: float
    time: float
    longest_lock: float
    longest_skid: float
    share_in_band: float
    air: float
    sliding: tuple[float, ...]
    lowest_reservoir: float | None
    commands: int
    said: str
    history: History | None = field(default=None, compare=False, repr=False)
