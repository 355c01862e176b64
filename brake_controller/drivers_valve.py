"""The driver's brake valve: a relay that keeps the pipe at the pressure commanded by the driver.

Values are those of Dako BS2 as published by train simulators. It feeds through 22 mm less a core of 10 mm, vents
through 10 mm and, in an emergency, through an annulus of 26 and 8 mm. An overcharge of 5.4 bar falls to 5 bar within
180 s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from brake_controller.air import AMBIENT, DISCHARGE, WALL
from brake_controller.main_reservoir import CONSTANT_SUPPLY
from fmu_src.system import ParameterSet, quantity
from fmu_src.variables import Field

#: Positions, by the value that a host sets.
POSITIONS = {
    **{"shut-off": 0, "running": 1, "overcharge": 2, "service": 3, "emergency": 4},
    **{"hold": 5, "continuous-service": 6},
}
_AREA, _PRESSURE, _STEP = "an area of a driver's valve", "a pressure of a driver's valve", "a step of a driver's valve"
_RATE = "a rate of a driver's valve"
#: Data of a valve in C, pressures absolute and areas effective: the cell after it; areas; band, supply and its
#: temperature, ambient pressure. Running pressure and overcharge; falls of the first step and of full service; rates of
#: service, release, overcharge and emergency. Place from the head, measured backwards below 0. Delay after the first
#: valve while its own position is 0, below 0 never. Then 1 if a service keeps the pipe at the running pressure. The
#: valve of a vacuum has a running pressure below the ambient one. Its supply is the lowest pressure of the exhauster,
#: and the last area belongs to the ejector, which a release opens too.
VALVE = (
    Field("face", "1", 0.0, 0.0, "a driver's valve's place at the pipe", whole=True, counts="cells"),
    *(Field(name, "m2", 0.0, 1.0, _AREA) for name in ("feeding", "exhaust", "emergency")),
    Field("band", "Pa", 1e-3, 1e8, "the band of a driver's valve"),
    Field("supply", "Pa", 1.0, 1e8, "the supply of a driver's valve"),
    Field("supply_temperature", "K", 50.0, 1e4, "the temperature of a driver's valve's supply"),
    Field("around", "Pa", 1.0, 1e8, "the pressure around a driver's valve"),
    *(Field(name, "Pa", 1.0, 1e8, _PRESSURE) for name in ("running", "overcharge")),
    *(Field(name, "Pa", 0.0, 1e8, _STEP) for name in ("first", "full")),
    *(Field(name, "Pa/s", 0.0, 1e9, _RATE) for name in ("down", "up", "slowly", "quickly")),
    Field("place", "m", -1e7, 1e7, "the place of a driver's valve"),
    Field("delay", "s", -1e3, 1e3, "the delay of a driver's valve"),
    Field("wired", "1", 0.0, 1.0, "whether service of a driver's valve is by wire alone", whole=True),
    Field("ejector", "m2", 0.0, 1.0, _AREA),
)


@dataclass(frozen=True)
class DriversValve(ParameterSet):
    """A driver's valve; pressures are gauge pressures. A step of service lies between the first and full service."""

    feeding_area: float = quantity("m2", "Geometric area through which the valve feeds the pipe", 0.0)
    exhaust_area: float = quantity("m2", "Geometric area through which it lets air out", 0.0)
    emergency_area: float = quantity("m2", "Geometric area in an emergency", 0.0)
    band: float = quantity("Pa", "Difference at which the relay is open as far as it goes", 1.0)
    supply: float = quantity("Pa", "Pressure of its supply, which stays unless the vehicle has a main reservoir", 0.0)
    running: float = quantity("Pa", "Pressure of the pipe when brakes are released", 0.0)
    overcharge: float = quantity("Pa", "Pressure of the pipe in overcharge", 0.0)
    first_step: float = quantity("Pa", "Fall of the pipe at the first step of service", 0.0)
    full_service: float = quantity("Pa", "Fall of the pipe at full service", 0.0)
    service_rate: float = quantity("Pa/s", "How fast the pressure falls that the valve holds", 0.0)
    release_rate: float = quantity("Pa/s", "How fast it rises", 0.0)
    overcharge_rate: float = quantity("Pa/s", "How fast an overcharge falls", 0.0)
    emergency_rate: float = quantity(
        "Pa/s", "How fast the pipe at the valve falls in an emergency, without flow of air", 0.0
    )

    def numbers(self, face: int, place: float, delay: float, wired: bool = False) -> dict[str, float]:
        """Return the numbers of VALVE; face: of the pipe; place: from the head [m]; delay: [s], or below 0.

        wired: service does not lower the pipe.
        """
        return {
            "face": face,
            "feeding": DISCHARGE * self.feeding_area,
            "exhaust": DISCHARGE * self.exhaust_area,
            "emergency": DISCHARGE * self.emergency_area,
            "band": self.band,
            "supply": self.supply + AMBIENT,
            "supply_temperature": WALL,
            "around": AMBIENT,
            "running": self.running + AMBIENT,
            "overcharge": self.overcharge + AMBIENT,
            "first": self.first_step,
            "full": self.full_service,
            "down": self.service_rate,
            "up": self.release_rate,
            "slowly": self.overcharge_rate,
            "quickly": self.emergency_rate,
            "place": place,
            "delay": delay,
            "wired": float(wired),
            "ejector": 0.0,
        }


def drivers_valve() -> DriversValve:
    """Return areas and overcharge of Dako BS2; pipe 5 bar, 0.4 bar at the first step, 1.5 at full service (UIC 540).

    UIC 540 was read in excerpts. Assumed: main reservoir 8 bar, band 10 kPa, 0.5 bar/s down and 1 bar/s up, and 3 bar/s
    in an emergency without flow.
    """
    return DriversValve(
        feeding_area=math.pi / 4 * (0.022**2 - 0.010**2),
        exhaust_area=math.pi / 4 * 0.010**2,
        emergency_area=math.pi / 4 * (0.026**2 - 0.008**2),
        band=10e3,
        supply=CONSTANT_SUPPLY,
        running=500e3,
        overcharge=540e3,
        first_step=40e3,
        full_service=150e3,
        service_rate=50e3,
        release_rate=100e3,
        overcharge_rate=40e3 / 180.0,
        emergency_rate=300e3,
    )
