"""Random trains and lines of supervision, and a train whose motion is integrated in small steps of time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from products.supervision import Gradients, Steps, SupervisedTrain

#: Step of time of the integrated motion [s].
STEP = 1e-3


def trains(rng: np.random.Generator, count: int, **others: object) -> SupervisedTrain:
    """Return trains with five steps of deceleration each."""
    boundaries = np.sort(rng.uniform(2.0, 70.0, (count, 4)), axis=-1)
    brake, service = rng.uniform(0.5, 1.4, (count, 5)), rng.uniform(0.4, 1.2, (count, 5))
    length, *times = (rng.uniform(least, most, count) for least, most in ((20, 700), (0.5, 8), (0.5, 8), (0, 6)))
    return _trains(length, Steps(boundaries, brake), Steps(boundaries, service), *times, **others)


def extreme_trains(rng: np.random.Generator, count: int, **others: object) -> SupervisedTrain:
    """Return trains whose numbers are between a tenth and ten times a usual one."""
    boundaries = np.sort(rng.uniform(2.0, 70.0, (count, 4)), axis=-1)
    usual = ((300.0, count), (0.99, (count, 5)), (0.7, (count, 5)), (3.0, count), (3.0, count), (2.0, count))
    length, brake, service, *times = (value * 10.0 ** rng.uniform(-1.0, 1.0, shape) for value, shape in usual)
    return _trains(length, Steps(boundaries, brake), Steps(boundaries, service), *times, **others)


def one_of(trains: SupervisedTrain, n: int, **others: object) -> SupervisedTrain:
    """Return one of the trains."""
    steps = (Steps(one.boundaries[n], one.values[n]) for one in (trains.A_brake_emergency, trains.A_brake_service))
    numbers = (trains.length, trains.T_brake_emergency, trains.T_brake_service, trains.T_traction_cut_off)
    length, *times = (float(np.asarray(number)[n]) for number in numbers)
    return _trains(length, *steps, *times, **others)


def _trains(*data: Any, **others: Any) -> SupervisedTrain:
    """Return trains of length, both brakes, both build-up times, and the time of the cut-off."""
    return SupervisedTrain(*data[:5], T_traction_cut_off=data[5], **others)


@dataclass(frozen=True)
class Motion:
    """A train in small steps of time, with the lowest gradient under it found by search."""

    train: SupervisedTrain
    gradients: Gradients

    def gradient(self, front: float) -> float:
        """Return the lowest gradient under the train [permille]."""
        places = np.append(self.gradients.starts[1:], np.inf)
        first = np.append(-np.inf, places[:-1])
        under = (places > front - float(self.train.length)) & (first < front)
        return float(self.gradients.permille[under].min())

    def brake(self, speed: float) -> float:
        """Return the emergency brake's deceleration on level track [m/s2]."""
        steps = self.train.A_brake_emergency
        return float(steps.values[int((speed > steps.boundaries).sum())])

    def stops_at(self, place: float, speed: float, phases: tuple[tuple[float, float], ...]) -> float:
        """Return where the train stops that first has constant accelerations for some times, then brakes."""
        for acceleration, seconds in phases:
            place += speed * seconds + acceleration * seconds**2 / 2.0
            speed += acceleration * seconds
        while speed > 0.0:
            gradient = self.gradient(place)
            rotating = 15.0 if gradient > 0.0 else 2.0
            rate = self.brake(speed) + 9.81 * gradient / (1000.0 + 10.0 * rotating)
            step = min(STEP, speed / rate)
            place += speed * step - rate * step**2 / 2.0
            speed -= rate * step if step == STEP else speed
        return place
