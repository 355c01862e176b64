"""Stops of a train on a sanded rail: wheelsets of equal load that use all adhesion up to the demanded deceleration."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from brake_controller.pneumatics import TIME_CONSTANTS_TO_95_PERCENT
from fmu_src.compile import build_library
from fmu_src.compose import compose
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel, Library
from fmu_src.symbols import ca
from fmu_src.system import System, Variable, model_of
from rbd_model.track.sand import SandParameters, common_sand, sanders

#: 55 mph [m/s], demanded deceleration [m/s2], and adhesion without sand: published. Time to 95 % of the brake [s]:
#: assumed.
SPEED, ASKED, UNTREATED, APPLICATION_TIME = 55 * 0.44704, 0.9, 0.02, 2.0
#: Places of the wheelsets of four cars of 20 m [m].
PLACES = tuple(-(20.0 * car + along) for car in range(4) for along in (0.0, 2.6, 14.0, 16.6))
#: Recording interval [s], and longest stop [s].
STEP, LONGEST, STANDING, GRAVITY = 0.1, 300.0, 0.02, 9.81
TOLERANCE = 1e-6
#: Parameters of the train.
OF_TRAIN = (
    Variable("initial_speed", "parameter", "m/s", "Initial speed", SPEED, 0.1),
    Variable("asked", "parameter", "m/s2", "Demanded deceleration", ASKED, 0.0),
    Variable("application_time", "parameter", "s", "Time to 95 % of it", APPLICATION_TIME, 0.01),
)


@lru_cache
def train() -> Library:
    """Return wheelsets of equal load. They use the adhesion of their rail up to the demanded deceleration."""
    cars = System("cars", "A train of wheelsets that use all adhesion")
    start, demanded, time = (cars.parameter(one) for one in OF_TRAIN)
    speed, distance = cars.state("speed", "m/s", start, 1.0), cars.state("distance", "m", 0.0, 1.0)
    since = ca.fmax(cars.time - common_sand().sand_start, 0)
    asked = demanded * (1 - ca.exp(-TIME_CONSTANTS_TO_95_PERCENT * since / time))
    numbers = range(1, len(PLACES) + 1)
    text = "Friction under wheelset"
    frictions = [cars.input(Variable(f"sanded_{n}", "input", "1", f"{text} {n}", UNTREATED, 0.0)) for n in numbers]
    cars.derivative(speed, -sum((ca.fmin(asked, GRAVITY * friction) for friction in frictions), ca.SX(0)) / len(PLACES))
    cars.derivative(distance, speed)
    cars.output(Variable("speed", "output", "m/s", "Speed of the train"), speed)
    cars.output(Variable("distance", "output", "m", "Distance of the train"), distance)
    given = {f"sanded_{n}": f"sanded_friction_{n}" for n in numbers} | {"speed": "speed"}
    whole = compose("train", "A train on sand", [cars, sanders(PLACES)], given)
    return Library(build_library(model_of(whole, TOLERANCE)))


def stop(values: Mapping[str, float], sand: SandParameters, untreated: float = UNTREATED) -> Recording:
    """Return time [s], speed [m/s] and distance [m] until the train stops.

    Takes values [kg/s].
    """
    kernel = Kernel(train(), **{**sand.values(), **values})
    kernel.set(**{f"friction_{n}": untreated for n in range(1, len(PLACES) + 1)})
    kernel.initialise()
    rows = [[0.0, kernel["speed"], 0.0]]
    while rows[-1][1] > STANDING and rows[-1][0] < LONGEST:
        kernel.step(kernel.time, STEP)
        rows.append([kernel.time, kernel["speed"], kernel["distance"]])
    return Recording({"time": "s", "speed": "m/s", "distance": "m"}, rows)


def way(values: Mapping[str, float], sand: SandParameters, untreated: float = UNTREATED) -> float:
    """Return the stopping distance [m]; the last step is cut at the instant of rest."""
    rows = stop(values, sand, untreated)
    return float(np.interp(-STANDING, -rows["speed"], rows["distance"]))
