"""Input and output of the test rig: runs with their faults, and stops."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from products.machine import TRACTION, in_order
from products.protection.history import StopHistory
from products.protection.settings import FASTEST, LONGEST
from rbd_model.track.line import Line
from readers.usual import likely_unit

#: Failures of a sensor, with the numbers in rig.h.
SENSOR_FAILURES = {"stuck": 1, "zero": 2, "doubled": 3}


@dataclass(frozen=True)
class Fault:
    """Faults of one wheelset, by its number.

    radius: assumed wheel radius over the true one. sensor: one of SENSOR_FAILURES, from `sensor_from` on [s].
    valve_from: time from which its valve keeps its position [s]. Raises ValueError if a value is invalid.
    """

    wheelset: int
    radius: float = 1.0
    sensor: str = ""
    sensor_from: float = 0.0
    valve_from: float = math.inf

    def __post_init__(self) -> None:
        if self.sensor and self.sensor not in SENSOR_FAILURES:
            raise ValueError(f"sensor must be one of {', '.join(SENSOR_FAILURES)}; got {self.sensor!r}.")
        if not 0.5 <= self.radius <= 2.0:
            raise ValueError(f"radius must be 0.5 to 2 times the true one; got {self.radius}.")
        if self.wheelset < 1 or self.wheelset != int(self.wheelset):
            raise ValueError(f"wheelset must be an integer of at least 1; got {self.wheelset}.")
        for name in ("sensor_from", "valve_from"):
            if not (0.0 <= getattr(self, name) < LONGEST or (name == "valve_from" and self.valve_from == math.inf)):
                at = f"from 0 to below {LONGEST:g} s, when runs end"
                raise ValueError(f"{name} must be a time {at}; got {getattr(self, name)}.")
        if not self.sensor and (self.sensor_from or (self.radius == 1.0 and math.isinf(self.valve_from))):
            raise ValueError("This fault has no effect; give it a sensor, a radius other than 1, or valve_from.")


@dataclass(frozen=True)
class Run:
    """One stop: inputs and parameters of the vehicle; speed [m/s] and brake_ratio, by default those of the settings.

    equipment: some of EQUIPMENT. With traction a run is a start: it ends when the vehicle reaches `speed`. phases:
    initial angle of each wheelset's sensor as a share of a tooth, 0 to below 1; empty: all 0. teeth: seed of the errors
    of the teeth. Their size is the jitter of the settings. line: by default straight, level track.
    """

    values: Mapping[str, float]
    speed: float | None = None
    brake_ratio: float | None = None
    faults: tuple[Fault, ...] = ()
    equipment: tuple[str, ...] = ()
    phases: tuple[float, ...] = ()
    teeth: int = 0
    line: Line | None = None

    def __post_init__(self) -> None:
        for phase in self.phases:
            if not 0.0 <= phase < 1.0:
                raise ValueError(f"phases must be from 0 to below 1 tooth; got {phase}.")
        object.__setattr__(self, "equipment", in_order(self.equipment))
        if self.speed is not None and self.speed > FASTEST:
            message = f"speed of a run must be at most {FASTEST:g} m/s; got {self.speed:g} m/s."
            raise ValueError(message + likely_unit(self.speed, "m/s", 0.0, FASTEST))

    @property
    def driven(self) -> bool:
        """True if motors drive the vehicle."""
        return TRACTION in self.equipment


@dataclass(frozen=True)
class Stop:
    """Result of a run."""

    #: Distance [m]; None if the vehicle did not stop, did not reach its speed under traction, or its controller failed.
    distance: float | None
    #: Speed [m/s] and time [s] at the end.
    end_speed: float
    time: float
    #: Longest locking time above the speed at which locks count [s]. With traction: of a wheelset that turns at more
    #: than twice the speed.
    longest_lock: float
    #: Longest distance of a locked wheelset at any speed [m].
    longest_skid: float
    #: Share of the braked time with all slips in the slip band.
    share_in_band: float
    #: Air that all cylinders used [kg].
    air: float
    #: Energy of sliding between the wheels of each wheelset and the rails [J].
    sliding: tuple[float, ...]
    #: Lowest pressure of the reservoir [Pa]; None without a reservoir.
    lowest_reservoir: float | None
    #: Number of commands other than apply.
    commands: int
    message: str
    #: False if the controller gave no answer for long and is therefore not evaluated.
    judged: bool = True
    #: The history, if recorded.
    history: StopHistory | None = field(default=None, compare=False, repr=False)
    #: Largest jerk of the deceleration above 3 m/s, behind two lags of JERK_TIME of rails.py [m/s3].
    jerk: float = 0.0
    #: Longest time for which a valve stayed at vent [s].
    longest_vent: float = 0.0

    @property
    def words(self) -> str:
        """The distance in metres, or the reason why it is missing."""
        return self.message.removesuffix(".") if self.distance is None else f"{self.distance:.0f} m"

    def note(self, source: str) -> str:
        """Return the source of a row of a table, with a message if the distance is missing."""
        return source if self.distance is not None else f"{self.words}; {source}"

    def over(self, other: float | None) -> float | None:
        """Return the distance over another [m]; None if one of them is missing."""
        return None if self.distance is None or other is None else self.distance / other

    @property
    def course(self) -> StopHistory:
        """The history. Raises ValueError if it was not recorded."""
        if self.history is None:
            raise ValueError("This stop has no history; give the rig's runs a recording interval.")
        return self.history
