"""The driver's valve of a vacuum brake: it takes air out of the pipe to release, and lets air in to brake.

An exhauster of constant displacement is a choke to a pressure so low that it is choked: its flow of mass is then in
proportion to the pressure before it (ISO 6358-1). The valve keeps the pipe at the pressure that the driver commands, as
a relay. One number is that of train simulators, the time of a service (Open Rails). All others are assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from brake_controller.air import AMBIENT, CHOKED_FLOW, DISCHARGE, GAS_CONSTANT, WALL
from fmu_src.system import ParameterSet, quantity

#: Inner diameter of the pipe of vacuum brakes [m]: 2 inches (Open Rails).
PIPE = 0.0508
#: Share of the vacuum that the first step of service destroys: that of UIC 540, 0.4 of 1.5 bar. Assumed.
FIRST = 0.4 / 1.5


@dataclass(frozen=True)
class VacuumValve(ParameterSet):
    """A driver's valve with exhauster and ejector; a step of service is between the first and no vacuum."""

    vacuum: float = quantity("Pa", "Vacuum of the pipe when brakes are released", 1e3, 95e3)
    exhauster: float = quantity("m3/s", "Displacement of the exhauster", 0.0)
    ejector: float = quantity("m3/s", "Further displacement in the position overcharge, a release", 0.0)
    lowest: float = quantity("Pa", "Lowest absolute pressure that both reach", 1.0)
    exhaust_area: float = quantity("m2", "Geometric area through which a service lets air in", 0.0)
    emergency_area: float = quantity("m2", "Geometric area in an emergency", 0.0)
    band: float = quantity("Pa", "Difference at which the relay is open as far as it goes", 1.0)
    service_rate: float = quantity("Pa/s", "How fast the pressure rises that the valve holds", 0.0)
    release_rate: float = quantity("Pa/s", "How fast it falls", 0.0)
    emergency_rate: float = quantity("Pa/s", "How fast it rises in an emergency", 0.0)

    @property
    def running(self) -> float:
        """Gauge pressure of the charged pipe [Pa]."""
        return -self.vacuum

    @property
    def first_step(self) -> float:
        """Vacuum that the first step of service destroys [Pa]."""
        return FIRST * self.vacuum

    @property
    def full_service(self) -> float:
        """Vacuum that full service destroys [Pa]."""
        return self.vacuum

    def numbers(self, face: int, place: float, delay: float, wired: bool = False) -> dict[str, float]:
        """Return the numbers of VALVE, as those of `DriversValve` (ISO 6358-1)."""
        return {
            "face": face,
            "feeding": DISCHARGE * self.exhaust_area,
            "exhaust": displacing(self.exhauster),
            "emergency": DISCHARGE * self.emergency_area,
            "band": self.band,
            "supply": self.lowest,
            "supply_temperature": WALL,
            "around": AMBIENT,
            "running": AMBIENT - self.vacuum,
            "overcharge": AMBIENT - self.vacuum,
            "first": self.first_step,
            "full": self.full_service,
            "down": self.release_rate,
            "up": self.service_rate,
            "slowly": self.release_rate,
            "quickly": self.emergency_rate,
            "place": place,
            "delay": delay,
            "wired": float(wired),
            "ejector": displacing(self.ejector),
        }


def displacing(volume_flow: float) -> float:
    """Return the effective area [m2] of the choked choke that displaces a volume a second, S = 0.685 A sqrt(R T).

    ISO 6358-1, at the temperature of the walls.
    """
    return volume_flow / (CHOKED_FLOW * math.sqrt(GAS_CONSTANT * WALL))


def vacuum_valve(vacuum: float) -> VacuumValve:
    """Return the driver's valve for a vacuum [Pa].

    A service destroys it in 10 s (Open Rails). All other numbers are assumed. The exhauster has 3 m3/min and the
    ejector 6, down to 6 kPa. Ports have 25 mm, and 45 mm in an emergency.
    """
    return VacuumValve(
        vacuum=vacuum,
        exhauster=3.0 / 60.0,
        ejector=6.0 / 60.0,
        lowest=6e3,
        exhaust_area=math.pi / 4 * 0.025**2,
        emergency_area=math.pi / 4 * 0.045**2,
        band=1e3,
        service_rate=vacuum / 10.0,
        release_rate=vacuum,
        emergency_rate=vacuum,
    )
