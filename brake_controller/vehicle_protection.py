"""Wheel-slide protection of a train's vehicle: sensor, controller and dump valve (products/train/c/protection.c)."""

from __future__ import annotations

from dataclasses import dataclass

from brake_controller.magnet_valves import common_valves
from brake_controller.protection_fmu import MOST_WHEELSETS
from brake_controller.sensors import TEETH
from fmu_src.system import ParameterSet, choice, quantity

#: Controllers by number: none, the built-in one, and those that a user adds, at most MOST_OWN of them.
NONE, BUILT_IN, FIRST_OWN = 0, 1, 2
MOST_OWN = 16
#: Radius of wheels that are not stated [m], and time between two steps of a controller [s].
RADIUS, PERIOD = 0.46, 5e-3
#: Volume of the cylinders of a brake whose distributor has none [m3]: that of UIC wagons. Assumed.
VOLUME = 10.3e-3
_NAMES = {NONE: "none", BUILT_IN: "built-in"} | {FIRST_OWN + n: f"own {n + 1}" for n in range(MOST_OWN)}


@dataclass(frozen=True)
class VehicleProtection(ParameterSet):
    """Sensor, controller and magnet valves of one vehicle."""

    controller: float = choice("Controller of the wheel-slide protection", _NAMES)
    wheel_radius: float = quantity("m", "Radius of the wheels that the sensor measures", 0.1)
    teeth: float = quantity("1", "Teeth of the sensor's wheel", 1.0, 1e4)
    period: float = quantity("s", "Time between two steps of the controller", 1e-3, 1.0)
    valve_time: float = quantity("s", "Time until 95 % of a magnet valve's area is open or closed", 0.0, 10.0)
    cylinders: float = quantity("m3", "Volume of the cylinders whose air is counted", 0.0)
    wheelsets: float = quantity("1", "Wheelsets with a sensor, a cylinder and valves of their own", 1.0, MOST_WHEELSETS)


#: A vehicle without wheel-slide protection, with the numbers that are not stated.
NO_PROTECTION = VehicleProtection(
    controller=float(NONE),
    wheel_radius=RADIUS,
    teeth=float(TEETH),
    period=PERIOD,
    valve_time=common_valves().valve_opening_time,
    cylinders=VOLUME,
    wheelsets=1.0,
)
