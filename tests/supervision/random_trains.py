"""Random trains and lines of supervision, and a train whose motion is integrated in small steps of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from products.supervision import Gradients, Steps, SupervisedTrain

#: Step of time of the integrated motion [s].
STEP = 1e-3


def trains(rng: np.random.Generator, count: int, **others: object) -> SupervisedTrain:
    """Return trains with five steps of deceleration each."""
    boundaries = np.sort(rng.uniform(2.0, 70.0, (count, 4)), axis=-1)
    brake, service = rng.uniform(0.5, 1.4, (count, 5)), rng.uniform(0.4, 1.2, (count, 5))
    return SupervisedTrain(
        rng.uniform(20.0, 700.0, count),
        Steps(boundaries, brake),
        Steps(boundaries, service),
        rng.uniform(0.5, 8.0, count),
        rng.uniform(0.5, 8.0, count),
        T_traction_cut_off=rng.uniform(0.0, 6.0, count),
        **others,  # type: ignore[arg-type]
    )


def extreme_trains(rng: np.random.Generator, count: int, **others: object) -> SupervisedTrain:
    """Return trains whose numbers are between a tenth and ten times a usual one."""

    def near(usual: float, *shape: int) -> np.ndarray:
        return usual * 10.0 ** rng.uniform(-1.0, 1.0, (count, *shape))

    boundaries = np.sort(rng.uniform(2.0, 70.0, (count, 4)), axis=-1)
    return SupervisedTrain(
        near(300.0),
        Steps(boundaries, near(0.99, 5)),
        Steps(boundaries, near(0.7, 5)),
        near(3.0),
        near(3.0),
        T_traction_cut_off=near(2.0),
        **others,  # type: ignore[arg-type]
    )


def one_of(trains: SupervisedTrain, n: int, **others: object) -> SupervisedTrain:
    """Return one of the trains."""
    steps = (Steps(one.boundaries[n], one.values[n]) for one in (trains.A_brake_emergency, trains.A_brake_service))
    times = (trains.T_brake_emergency, trains.T_brake_service)
    cut_off = np.asarray(trains.T_traction_cut_off)[n]
    return SupervisedTrain(
        float(np.asarray(trains.length)[n]),
        *steps,
        *(float(np.asarray(one)[n]) for one in times),
        T_traction_cut_off=float(cut_off),
        **others,  # type: ignore[arg-type]
    )


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
