"""WheelSpeedSensor.fmu: measured wheel speeds from rotations, by the encoder of the test rig; for FMI 2.0 and 3.0."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from brake_controller.protection_fmu import BOGIE, PERIOD, named
from brake_controller.sensors import GATE, LOWEST_FREQUENCY, TEETH, TIMER
from brake_controller.slide_protection import RIG
from fmu_src.arrays_fmu import ArraysFmu, ArraysInC, ArrayVariable
from fmu_src.c_literals import c_array, c_number
from products.machine import coach
from products.protection.settings import LONGEST_PERIOD, MOST_PULSES, SHORTEST_PERIOD

FOLDER = Path(__file__).parent
NAME = "WheelSpeedSensor"
#: Largest rotation [rad]: the edges that have passed are counted in 64 bits.
MOST_ROTATION = 1e9


def parameters() -> list[tuple[ArrayVariable, float]]:
    """Return the parameters of all sensors, with their start values."""

    def real(name: str, unit: str, text: str, least: float, most: float) -> ArrayVariable:
        return ArrayVariable(name, "parameter", unit, text, least, most)

    radius = float(coach().parameters.wheel_radius)
    teeth = ArrayVariable("pulses", "parameter", "1", "Teeth of the toothed wheel, an edge each", 1, MOST_PULSES, True)
    return [
        (real("wheel_radius", "m", "Radius by which the controller takes the wheel speed", 0.1, 2.0), radius),
        (teeth, float(TEETH)),
        (real("gate", "s", "Shortest time over which edges are averaged", 1e-4, 10.0), GATE),
        (real("timer", "s", "Resolution of the timer of the edges", 1e-9, 1e-2), TIMER),
        (real("lowest_frequency", "1/s", "Edges a second below which the speed is 0", 0.0, 1e4), LOWEST_FREQUENCY),
        (real("period", "s", "Time between two readings", SHORTEST_PERIOD, LONGEST_PERIOD), PERIOD),
    ]


@lru_cache
def sensor_in_c(wheelsets: int = BOGIE) -> ArraysInC:
    """Return the C object of the sensors of all wheelsets, with its variables."""
    numbers, given = range(1, wheelsets + 1), parameters()
    rotation, speed = "Rotation of wheelset {}", "Circumferential speed of wheelset {}, as measured"
    limits = (-MOST_ROTATION, MOST_ROTATION)
    variables = [ArrayVariable(f"rotation_{n}", "input", "rad", rotation.format(n), *limits) for n in numbers]
    variables += [ArrayVariable(f"wheel_speed_{n}", "output", "m/s", speed.format(n)) for n in numbers]
    variables += [one for one, _ in given]
    names = ", ".join(one.name.upper() for one, _ in given)
    places = f"WHEELSETS = {wheelsets}, SPEEDS = WHEELSETS, SPEEDS_END = 2 * WHEELSETS - 1, {names}, ARRAYS_MOST"
    header = f"enum {{ {places} }};\n"
    header += c_array("double", "STARTS", [c_number(start) for _, start in given])
    sources = {name: (RIG / name).read_text(encoding="utf-8") for name in ("encoder.c", "encoder.h")}
    sources |= {"sensor_fmu.c": (FOLDER / "sensor_fmu.c").read_text(encoding="utf-8"), "sensor_arrays.h": header}
    about = "Wheel speeds as sensors with toothed wheels measure them"
    return ArraysInC(named(NAME, wheelsets), about, tuple(variables), sources, stride=1, starts_alone=True)


def sensor_fmu(wheelsets: int = BOGIE) -> ArraysFmu:
    """Return the FMU of the sensors of all wheelsets."""
    starts = [[0.0]] * (2 * wheelsets) + [[start] for _, start in parameters()]
    return ArraysFmu(sensor_in_c(wheelsets), [1] * len(starts), starts, PERIOD, 10.0)
