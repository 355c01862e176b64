"""A locomotive and five wagons stop from 25 km/h: any number of stops at once, with randomly distributed inputs.

Rules and inputs are those of RailProfAC/ShuntingBrakingCurves (MIT), published with the means of 1e7 stops. Its program
adds the locomotive's brake force twice. There the delay of the demand along the train stretches the filling of a
cylinder instead of shifting it. `Rules` has both variants, and the correct ones.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

GRAVITY, KILOMETRES_PER_HOUR = 9.81, 3.6
SPEED = 25.0 / KILOMETRES_PER_HOUR
#: Propagation speed of the demand along the train [m/s]; lengths of locomotive and wagons [m].
PROPAGATION, LOCOMOTIVE_LENGTH, WAGON_LENGTH = 250.0, 10.5, 14.0
#: Masses [kg]; factor on a wagon's mass for its rotating parts [1].
LOCOMOTIVE_MASS, WAGONS, WAGON_MASS, TURNING = 53e3, 5, 90e3, 1.04
#: The locomotive's brake force [N]: its percentage is 105 (56 t on 53 t), its deceleration by 0.0075 lambda + 0.076
#: rounded to 0.01 m/s2, at every speed.
LOCOMOTIVE_FORCE = LOCOMOTIVE_MASS * 0.86
#: Cylinder [m2], return spring [N], ratio of the rigging, blocks of a wagon.
PISTON, RETURN_FORCE, RATIO, BLOCKS = math.pi / 4 * 0.406**2, 1500.0, 5.65, 16
#: Mean and standard deviation of normally distributed inputs: cylinder pressure [Pa], efficiency of the rigging, and a
#: factor of the friction.
PRESSURE, EFFICIENCY, FRICTION = (380e3, 5e3), (0.83, 0.02), (1.0, 0.025)
#: Composite blocks: mu = 0.055 (F + 200 kN) / (F + 50 kN) (V + 150) / (V + 75), V in km/h.
AT_MOST_LOAD, FORCES, SPEEDS = 0.055, (200e3, 50e3), (150.0 / KILOMETRES_PER_HOUR, 75.0 / KILOMETRES_PER_HOUR)
#: Running resistance over weight, c + d (v / 27.8 m/s)^2, of the wagons alone.
RESISTANCE, REFERENCE = (1.6e-3, 5.7e-3), 27.8
#: Step of the published program, and of the method of second order here [s]: half of it moves means by 1e-4.
PUBLISHED_STEP, STEP = 0.01, 0.1
#: Number of stops that are computed at once, which fit into the cache of a processor.
CHUNK = 2000


class Position(NamedTuple):
    """Filling of a cylinder: time and its standard deviation [s], and the share of the pressure that is immediate."""

    filling: float
    spread: float
    at_once: float


POSITIONS = {"G": Position(24.0, 2.0, 0.1), "P": Position(4.0, 0.33, 0.0)}


class Rules(NamedTuple):
    """Options: the locomotive's force counts twice; the delay of the demand shifts the filling."""

    locomotive_twice: bool
    shifted: bool


PUBLISHED, ONCE, SHIFTED = Rules(True, False), Rules(False, False), Rules(False, True)


@dataclass(frozen=True)
class Draws:
    """Random inputs of each wagon and stop, shape (wagons, stops).

    force: of all blocks with the cylinder full [N]. factor: of the friction, and efficiency of the rigging.
    """

    force: Array
    factor: Array
    filling: Array

    def part(self, first: int) -> "Draws":
        """Return the next CHUNK stops."""
        return Draws(*(np.ascontiguousarray(one[:, first : first + CHUNK]) for one in vars(self).values()))


def draw(position: Position, stops: int, seed: int) -> Draws:
    """Return random wagons of `stops` stops."""
    generator = np.random.default_rng(seed)

    def normal(mean: float, deviation: float) -> Array:
        return generator.normal(mean, deviation, (WAGONS, stops))

    force = RATIO * (PISTON * normal(*PRESSURE) - RETURN_FORCE)
    return Draws(force, normal(*EFFICIENCY) * normal(*FRICTION), normal(position.filling, position.spread))


def delays() -> Array:
    """Return the time at which the demand reaches the head of each wagon [s], shape (wagons, 1)."""
    heads = LOCOMOTIVE_LENGTH + WAGON_LENGTH * np.arange(WAGONS, dtype=float)
    return np.asarray(heads[:, None] / PROPAGATION)


def retardation(position: Position, rules: Rules, draws: Draws) -> Callable[[float, Array], Array]:
    """Return the retardation of each stop [m/s2] as a function of time [s] and speeds [m/s] (Newton's second law)."""
    late, once = delays(), position.at_once
    filling, late = (draws.filling, late) if rules.shifted else (draws.filling + late, np.zeros_like(late))
    rate, per_block = (1 - once) / filling, draws.force / BLOCKS
    pushing = AT_MOST_LOAD * draws.force * draws.factor
    weight = WAGONS * WAGON_MASS * GRAVITY
    mass = LOCOMOTIVE_MASS + TURNING * WAGONS * WAGON_MASS

    def of(time: float, speed: Array) -> Array:
        filled = np.where(time >= late, np.minimum(once + rate * (time - late), 1.0), 0.0)
        block = per_block * filled
        wagons = np.sum(pushing * filled * (1 + (FORCES[0] - FORCES[1]) / (block + FORCES[1])), axis=0)
        wagons *= (speed + SPEEDS[0]) / (speed + SPEEDS[1])
        locomotive = min(once + (1 - once) * time / position.filling, 1.0) + rules.locomotive_twice
        running = (RESISTANCE[0] + RESISTANCE[1] * (speed / REFERENCE) ** 2) * weight
        return (wagons + LOCOMOTIVE_FORCE * locomotive + running) / mass

    return of


def as_published(of: Callable[[float, Array], Array], stops: int) -> Array:
    """Return distances [m] by Euler's method, with the new speed over each step.

    The last step may end below 0, as in
    the published program.
    """
    speed, distance, time = np.full(stops, SPEED), np.zeros(stops), 0.0
    while np.any(speed > 0.0):
        moves = speed > 0.0
        speed = np.where(moves, speed - of(time, speed) * PUBLISHED_STEP, speed)
        distance += np.where(moves, speed * PUBLISHED_STEP, 0.0)
        time += PUBLISHED_STEP
    return distance


def to_standstill(of: Callable[[float, Array], Array], stops: int) -> Array:
    """Return distances [m] by Heun's method of second order, exact to rest within the last step's retardation."""
    speed, distance, step = np.full(stops, SPEED), np.zeros(stops), 0
    while np.any(speed > 0.0):
        first = of(step * STEP, speed)
        second = of((step + 1) * STEP, np.maximum(speed - first * STEP, 0.0))
        mean = (first + second) / 2
        after = np.maximum(speed - mean * STEP, 0.0)
        distance += np.where(after > 0.0, (speed + after) / 2 * STEP, speed**2 / (2 * mean))
        speed, step = after, step + 1
    return distance


def distances(name: str, rules: Rules, stops: int, seed: int, published_method: bool = False) -> Array:
    """Return the stopping distances of a position [m].

    Parameters
    ----------
    name : str
        Position, G or P.
    rules : Rules
    stops : int
        Number of stops.
    seed : int
        Seed of the random wagons, which are the same under all rules.
    published_method : bool
        Euler's method of the published program instead of Heun's.
    """
    position = POSITIONS[name]
    draws = draw(position, stops, seed)
    method = as_published if published_method else to_standstill
    parts = [draws.part(first) for first in range(0, stops, CHUNK)]
    return np.concatenate([method(retardation(position, rules, part), part.force.shape[1]) for part in parts])
