"""The vigilance device (alerter, Sifa) of a driver's cab, and penalties: brakes that act in the driver's place.

While its vehicle moves, the driver must change the input `vigilance` within a time. Otherwise it warns, and later
applies a penalty. This holds until the train stands and the driver has changed that input again. 49 CFR 238.751 has
full service until the train has stopped, and an acknowledgement to retrieve it. Standstill resets the time, as in Open
Rails.
"""

from __future__ import annotations

from dataclasses import dataclass

from fmu_src.system import ParameterSet, choice, quantity
from fmu_src.variables import Field

#: Penalties, as the input `penalty` has them.
NO_PENALTY, FULL_SERVICE, EMERGENCY = range(3)
#: Penalties of a vigilance device, by names in consists. A Sifa applies the emergency brake.
PENALTIES = {"service": FULL_SERVICE, "emergency": EMERGENCY}
#: Time from the warning to the penalty [s]: that of a German Sifa, a lamp after 30 s, a sound 2.5 s and the brake 5 s
#: later.
WARNING = 5.0
#: Speed below which a train stands [m/s]. Assumed.
STANDS = 0.1


@dataclass(frozen=True)
class Vigilance(ParameterSet):
    """Vigilance device at one driver's valve."""

    vigilance_time: float = quantity("s", "Time without an acknowledgement up to the warning; 0 without a device", 0.0)
    warning_time: float = quantity("s", "Time from the warning to the penalty", 0.0)
    vigilance_penalty: float = choice("Penalty", {FULL_SERVICE: "full service", EMERGENCY: "emergency"})


#: A cab without a vigilance device.
NO_VIGILANCE = Vigilance(0.0, 0.0, float(EMERGENCY))
#: The vehicle of a driver's valve, by its number from 0.
VEHICLE = Field("vehicle", "1", 0.0, -1.0, "the vehicle of a driver's valve", whole=True, counts="vehicles")
