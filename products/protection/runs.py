"""What the test rig is asked for, and what it answers: runs with their faults, and stops."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from fmu_src.system import other_unit
from products.machine import TRACTION, in_order
from products.protection.history import History
from products.protection.settings import FASTEST, LONGEST

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
        if self.wheelset < 1 or self.wheelset != int(self.wheelset):
            raise ValueError(f"Set wheelset to a whole number, 1 or more: it was {self.wheelset}.")
        for name in ("sensor_from", "valve_from"):
            if not (0.0 <= getattr(self, name) < LONGEST or (name == "valve_from" and self.valve_from == math.inf)):
                at = f"from 0 to below {LONGEST:g} s, when runs end"
                raise ValueError(f"Set {name} to a time {at}: it was {getattr(self, name)}.")
        if not self.sensor and (self.sensor_from or (self.radius == 1.0 and math.isinf(self.valve_from))):
            raise ValueError("This fault has no effect; give it a sensor, a radius other than 1, or valve_from.")


@dataclass(frozen=True)
class Run:
    """One stop: inputs and parameters of the vehicle; speed [m/s] and strength, by default those of the settings.

    equipment: what the machine has, some of EQUIPMENT. With traction a run is no stop: it ends as it comes to `speed`.
    phase: share of a tooth by which the wheels of all sensors are turned at the first look, 0 to below 1.
    """

    values: Mapping[str, float]
    speed: float | None = None
    strength: float | None = None
    faults: tuple[Fault, ...] = ()
    equipment: tuple[str, ...] = ()
    phase: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.phase < 1.0:
            raise ValueError(f"Set phase to 0 to below 1 tooth: it was {self.phase}.")
        object.__setattr__(self, "equipment", in_order(self.equipment))
        if self.speed is not None and self.speed > FASTEST:
            said = f"Set speed of a run to at most {FASTEST:g} m/s: it was {self.speed:g} m/s."
            raise ValueError(said + other_unit(self.speed, "m/s", 0.0, FASTEST))

    @property
    def driven(self) -> bool:
        """Whether motors drive the machine."""
        return TRACTION in self.equipment


@dataclass(frozen=True)
class Stop:
    """What a run came to.

    distance [m]: None where it did not stop, or driven did not come to its speed, or its controller failed; end_speed
    [m/s] and time [s]: of its end; longest_lock [s], above the speed at which locks count; driven it is that of a
    wheelset that turns at more than twice the speed; longest_skid: way of a locked wheelset at any speed [m];
    share_in_band: of the braked time, with all slips in the band; air: what all cylinders took [kg]; sliding: energy
    between the wheels of each wheelset and the rails [J]; lowest_reservoir: pressure [Pa], None without a reservoir;
    commands: how often a valve was told anything but to apply; said: a sentence; judged: False if the controller gave
    no answer for long, so that nothing is said of it; history: where it was asked for.
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
    judged: bool = True
    history: History | None = field(default=None, compare=False, repr=False)

    @property
    def words(self) -> str:
        """The distance in metres, or why there is none."""
        return self.said.removesuffix(".") if self.distance is None else f"{self.distance:.0f} m"

    def note(self, source: str) -> str:
        """The source of a row of a table, with a sentence where there is no distance."""
        return source if self.distance is not None else f"{self.words}; {source}"

    def over(self, other: float | None) -> float | None:
        """The distance over another [m]; None where one of them is missing."""
        return None if self.distance is None or other is None else self.distance / other

    @property
    def course(self) -> History:
        """The history. Raises ValueError where none was asked for."""
        if self.history is None:
            raise ValueError("This stop has no history; give the rig's runs a time between its looks.")
        return self.history
