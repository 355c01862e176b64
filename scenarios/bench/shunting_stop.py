"""A locomotive and some wagons stop: any number of stops at once, with normally distributed inputs.

Rules and inputs are those of RailProfAC/ShuntingBrakingCurves (MIT), the benchmark case `railprofac-shunting`. Its
program adds the locomotive's brake force twice. There the delay of the demand along the train stretches the filling of
a cylinder instead of shifting it. The inputs state both rules; `ONCE` and `SHIFTED` correct them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Inputs by the names of the case, SI units.
Inputs = Mapping[str, Any]

#: Speed of reference of the running resistance [m/s].
REFERENCE = 27.8
#: Inputs that correct the published rules: the locomotive's force counts once, and the delay shifts the filling.
PUBLISHED: Inputs = {}
ONCE: Inputs = {"locomotive.counts": 1.0}
SHIFTED: Inputs = {**ONCE, "delay": "shifts the filling"}
#: Step of the published program, and of the method of second order here [s]: half of it moves means by 1e-4.
PUBLISHED_STEP, STEP = 0.01, 0.1
#: Number of stops that are computed at once, which fit into the cache of a processor.
CHUNK = 2000


@dataclass(frozen=True)
class Draws:
    """Random inputs of each wagon and stop, shape (wagons, stops).

    force: of all blocks with the cylinder full [N]. factor: of the friction, and efficiency of the rigging.
    """

    force: Array
    factor: Array
    filling: Array

    def part(self, first: int) -> Draws:
        """Return the next CHUNK stops."""
        return Draws(*(np.ascontiguousarray(one[:, first : first + CHUNK]) for one in vars(self).values()))


def draw(given: Inputs, stops: int, seed: int) -> Draws:
    """Return random wagons of `stops` stops."""
    generator = np.random.default_rng(seed)

    def normal(mean: float, name: str) -> Array:
        return generator.normal(mean, given[f"{name}_deviation"], (round(given["wagons"]), stops))

    piston = math.pi / 4 * given["cylinder.diameter"] ** 2
    pressure = normal(given["cylinder.pressure"], "cylinder.pressure")
    force = given["rigging.ratio"] * (piston * pressure - given["cylinder.return_force"])
    factor = normal(given["rigging.efficiency"], "rigging.efficiency") * normal(1.0, "friction.factor")
    return Draws(force, factor, normal(given["cylinder.filling"], "cylinder.filling"))


def delays(given: Inputs) -> Array:
    """Return the time at which the demand reaches the head of each wagon [s], shape (wagons, 1)."""
    numbers = np.arange(round(given["wagons"]), dtype=float)
    heads = given["locomotive.length"] + given["wagon.length"] * numbers
    return np.asarray(heads[:, None] / given["propagation"])


def retardation(given: Inputs, draws: Draws) -> Callable[[float, Array], Array]:
    """Return the retardation of each stop [m/s2] as a function of time [s] and speeds [m/s] (Newton's second law)."""
    late, once = delays(given), given["cylinder.at_once"]
    shifted = given["delay"] == SHIFTED["delay"]
    filling, late = (draws.filling, late) if shifted else (draws.filling + late, np.zeros_like(late))
    rate, per_block = (1 - once) / filling, draws.force / given["wagon.blocks"]
    pushing = given["friction.most"] * draws.force * draws.factor
    forces, speeds = ((given[f"friction.{name}_1"], given[f"friction.{name}_2"]) for name in ("force", "speed"))
    wagon_mass = given["wagons"] * given["wagon.mass"]
    mass = given["locomotive.mass"] + given["wagon.rotating"] * wagon_mass
    constant, square = (given[f"resistance.{name}"] * wagon_mass * given["gravity"] for name in ("constant", "square"))

    def of(time: float, speed: Array) -> Array:
        filled = np.where(time >= late, np.minimum(once + rate * (time - late), 1.0), 0.0)
        block = per_block * filled
        wagons = np.sum(pushing * filled * (1 + (forces[0] - forces[1]) / (block + forces[1])), axis=0)
        wagons *= (speed + speeds[0]) / (speed + speeds[1])
        own = min(once + (1 - once) * time / given["cylinder.filling"], 1.0) + given["locomotive.counts"] - 1
        running = constant + square * (speed / REFERENCE) ** 2
        return (wagons + given["locomotive.brake_force"] * own + running) / mass

    return of


def as_published(of: Callable[[float, Array], Array], speed: Array) -> Array:
    """Return distances [m] by Euler's method, with the new speed over each step.

    The last step may end below 0, as in the published program.
    """
    distance, time = np.zeros(speed.size), 0.0
    while np.any(speed > 0.0):
        moves = speed > 0.0
        speed = np.where(moves, speed - of(time, speed) * PUBLISHED_STEP, speed)
        distance += np.where(moves, speed * PUBLISHED_STEP, 0.0)
        time += PUBLISHED_STEP
    return distance


def to_standstill(of: Callable[[float, Array], Array], speed: Array) -> Array:
    """Return distances [m] by Heun's method of second order, exact to rest within the last step's retardation."""
    distance, step = np.zeros(speed.size), 0
    while np.any(speed > 0.0):
        first = of(step * STEP, speed)
        second = of((step + 1) * STEP, np.maximum(speed - first * STEP, 0.0))
        mean = (first + second) / 2
        after = np.maximum(speed - mean * STEP, 0.0)
        distance += np.where(after > 0.0, (speed + after) / 2 * STEP, speed**2 / (2 * mean))
        speed, step = after, step + 1
    return distance


def distances(given: Inputs, stops: int, seed: int, published_method: bool = False) -> Array:
    """Return the stopping distances [m]."""
    draws = draw(given, stops, seed)
    method = as_published if published_method else to_standstill
    parts = [draws.part(first) for first in range(0, stops, CHUNK)]
    start = [np.full(part.force.shape[1], given["speed"]) for part in parts]
    runs = zip(parts, start, strict=True)
    return np.concatenate([method(retardation(given, part), speed) for part, speed in runs])
