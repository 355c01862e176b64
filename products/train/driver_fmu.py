"""Driver.fmu: a driver who holds a train below the permitted speed of BrakingCurves.fmu and stops it; FMI 2.0 and 3.0.

The driver's law, once a `period`, with v the speed and V_P the permitted speed at the train's place:

* Hold v0 = V_P - `below`: the demand is that of `HoldingDriver`, k (v - v0) + (k / T) int (v - v0) dt; below 0 motors.
* Stop: the permitted limit is the curve of full service (SBD) less the distance in the build-up time t and in the
  driver's time of 4 s (SUBSET-026, 3.13.9.3): d_P = s + v (t + 4). To stop `short` before the target after a build-up
  time, a train needs the share s / (d - short - v t) of full service. The driver brakes with it, from `brakes_at` on.
  With a constant deceleration A of full service s is v^2 / 2 A. Braking with the share b then crosses no P if
  (1 / b - 1) v^2 / 2 A - 4 v + short >= 0 at all speeds. Both curves touch at short = 8 A b / (1 - b).
* Pull only while P is 2 v (t + 4) ahead at least.
* Acknowledge the vigilance device: the output `vigilance` alternates.
* Stay: within `short` + v t, or at rest within five times `short`, a train is braked and pulls no more.

`below`, `short`, `brakes_at`, the gains and the period are assumed.
"""

from __future__ import annotations

import math
from functools import lru_cache

from brake_controller.drivers_valve import POSITIONS
from fmu_src.arrays_fmu import ArraysFmu, ArraysInC, ArrayVariable
from fmu_src.c_literals import c_array, c_number
from products.supervision.values import FixedValues
from products.train.driver import BACK, HOLDS, LEAST, LIMITS, PULLS, HoldingDriver
from products.train.layout import FARTHEST, INPUTS
from products.train.library import FOLDER
from rbd_model.vehicle.variables import FASTEST

NAME = "Driver"
#: Distance below the permitted speed [m/s], and distance before the target at which a train stays [m]. Assumed.
BELOW, SHORT = 1.0, 10.0
#: Share of full service from which a driver brakes to a stop [1]; speed of a train at rest [m/s]. Assumed.
BRAKES_AT, STANDS = 0.4, 0.1
#: Motors pull while P is this multiple of the times of brake and driver ahead. Assumed.
AHEAD = 2.0
#: Time between two actions [s]; distance of a new target, as a multiple of SHORT. Assumed.
PERIOD, MOVED = 0.5, 5.0
#: Inputs from train and curves: name, unit, meaning, limits; commands are integers.
GIVEN = (
    ("speed", "m/s", "Speed of the train", -FASTEST, FASTEST),
    ("distance", "m", "Distance of the middle of its first vehicle", -FARTHEST, FARTHEST),
    ("V_P", "m/s", "Permitted speed at the train's place", 0.0, FASTEST),
    ("distance_P", "m", "Distance before the target at which the permitted speed is that of the train", -1e9, 1e9),
    ("traction_cut_off", "1", "1: traction is cut off", 0, 1),
    ("service_brake", "1", "1: full service is commanded", 0, 1),
    ("emergency_brake", "1", "1: emergency is commanded", 0, 1),
)
#: Parameters, with their start values after the meaning.
PARAMETERS = (
    ("target", "m", "Place of the end of authority", 2000.0, -FARTHEST, FARTHEST),
    ("front", "m", "From the middle of the first vehicle to the front of the train", 8.0, 0.0, 1e3),
    ("brake_time", "s", "Equivalent build-up time of the service brake", 5.0, 0.1, 60.0),
    ("below", "m/s", "Distance of the held speed below the permitted one", BELOW, 0.0, 50.0),
    ("short", "m", "Distance before the target at which the train stays", SHORT, 0.0, 1e4),
    ("brakes_at", "1", "Share of full service from which the driver brakes to a stop", BRAKES_AT, 0.05, 1.0),
    ("largest_traction", "1", "Largest share of the motors; 0: without traction", 1.0, 0.0, 1.0),
    ("gain", "s/m", "Demand for each m/s", HoldingDriver.gain, *LIMITS["gain"][:2]),
    ("memory", "s", "Time constant of its integral", HoldingDriver.memory, *LIMITS["memory"][:2]),
    ("period", "s", "Time between two actions", PERIOD, *LIMITS["period"][:2]),
)


def variables() -> list[tuple[ArrayVariable, float]]:
    """Return the variables with their start values, in the order of their numbers."""
    found = [
        (ArrayVariable(name, "input", unit, text, least, most, isinstance(most, int)), 0.0)
        for name, unit, text, least, most in GIVEN
    ]
    found += [
        (ArrayVariable(name, "parameter", unit, text, least, most), start)
        for name, unit, text, start, least, most in PARAMETERS
    ]
    commanded = {one.name: one for one in INPUTS}
    for name, start in (("driver_position", float(POSITIONS["running"])), ("driver_step", 0.0), ("traction", 0.0)):
        one = commanded[name]
        found.append((ArrayVariable(name, "output", one.unit, one.text, one.least, one.most, one.whole), start))
    places = {"place": "Place of the front", "distance_to_target": "From the front to the target, below 0 behind it"}
    found += [(ArrayVariable(name, "output", "m", text, -math.inf, math.inf), 0.0) for name, text in places.items()]
    one = commanded["vigilance"]
    text = "The driver's acknowledgement: each change of it counts"
    return [*found, (ArrayVariable(one.name, "output", one.unit, text, one.least, one.most, one.whole), 0.0)]


@lru_cache
def driver_in_c() -> ArraysInC:
    """Return the C object of the driver, with its variables."""
    arrays = tuple(array for array, _ in variables())
    names = ", ".join(array.name.upper() for array in arrays)
    constants = {
        "PULLS": PULLS,
        "LEAST": LEAST,
        "HOLDS": HOLDS,
        "BACK": BACK,
        "MOVED": MOVED,
        "AHEAD": AHEAD,
        "STANDS": STANDS,
        "T_DRIVER": FixedValues().T_driver,
    }
    constants |= {name.upper(): float(POSITIONS[name]) for name in ("running", "service", "emergency")}
    header = f"enum {{ {names}, ARRAYS_MOST, FIRST_OUTPUT = DRIVER_POSITION }};\n"
    header += "".join(f"#define {name} {value!r}\n" for name, value in constants.items())
    header += c_array("double", "STARTS", [c_number(start) for _, start in variables()])
    own = {"driver_fmu.c": (FOLDER / "driver_fmu.c").read_text(encoding="utf-8"), "driver_arrays.h": header}
    about = "A driver who holds a train below the permitted speed of ETCS and stops it before a target"
    return ArraysInC(NAME, about, arrays, own, stride=1)


def driver_fmu() -> ArraysFmu:
    """Return the FMU of the driver."""
    starts = [[start] for _, start in variables()]
    return ArraysFmu(driver_in_c(), [1] * len(starts), starts, 0.05, 100.0)
