"""How stops of the test rig are made: speed, brake, sensors, and the period of the controller."""

import math
from dataclasses import dataclass
from numbers import Real

from brake_controller.sensors import TEETH
from products.machine import APPLICATION_TIME
from readers.usual import likely_unit

#: Start of braking [s], and time [s] after which a run that still moves is ended.
BRAKE_START, LONGEST = 1.0, 300.0
#: Longest and shortest period of a controller [s]; no part of a run is shorter than the latter.
LONGEST_PERIOD, SHORTEST_PERIOD = 1.0, 1e-5
#: Upper limits: initial speed [m/s], torque over that of the full brake, time to full torque [s], teeth, and standard
#: deviation of a tooth's position, as a share of the pitch: above it teeth change places.
FASTEST, MOST_BRAKE_RATIO, SLOWEST_BRAKE, MOST_PULSES, MOST_JITTER = 100.0, 5.0, 60.0, 10_000, 0.5
LIMITS = {
    "speed": (FASTEST, "m/s"),
    "brake_ratio": (20.0 * MOST_BRAKE_RATIO, "1"),  # a brake that locks all wheels at once, to test locked wheels
    "application_time": (SLOWEST_BRAKE, "s"),
    "period": (LONGEST_PERIOD, "s"),
}
#: Gas constant times temperature of air [J/kg].
GAS = 287.0 * 293.0
#: Speed at which a vehicle is considered to stand [m/s].
STANDING = 0.02


@dataclass(frozen=True)
class Settings:
    """Settings of a stop of the test rig. Raises ValueError if a value is out of its limits."""

    #: Initial speed [m/s], above 0.
    speed: float = 25.0
    #: Torque over that of the full service brake, and time to 95 % of it [s].
    brake_ratio: float = 1.0
    application_time: float = APPLICATION_TIME
    #: Time between two calls of the controller [s].
    period: float = 5e-3
    #: Pulses of each speed sensor in a revolution, and standard deviation of their places as a share of the pitch.
    pulses: int = TEETH
    jitter: float = 0.0

    def __post_init__(self) -> None:
        for name, (most, unit) in LIMITS.items():
            given = getattr(self, name)
            if not (isinstance(given, Real) and 0.0 < float(given) < math.inf):
                raise ValueError(f"{name} must be a finite number above 0; got {given!r}.")
            value = float(given)
            in_unit = "" if unit == "1" else f" {unit}"
            if value > most:
                hint = likely_unit(value, unit, 0.0, most)
                raise ValueError(f"{name} must be at most {most:g}{in_unit}; got {value:g}{in_unit}.{hint}")
            if unit == "s" and value < SHORTEST_PERIOD:
                raise ValueError(f"{name} must be at least {SHORTEST_PERIOD:g} s; got {value:g} s.")
        if not (isinstance(self.pulses, Real) and self.pulses >= 1 and self.pulses == int(self.pulses)):
            raise ValueError(f"pulses must be an integer of at least 1; got {self.pulses!r}.")
        if self.pulses > MOST_PULSES:
            raise ValueError(f"pulses must be at most {MOST_PULSES}; got {self.pulses}.")
        if not (isinstance(self.jitter, Real) and 0.0 <= float(self.jitter) < math.inf):
            raise ValueError(f"jitter must be finite and at least 0; got {self.jitter!r}.")
        if self.jitter > MOST_JITTER:
            raise ValueError(f"jitter must be at most {MOST_JITTER:g} of the pitch; got {self.jitter:g}.")
