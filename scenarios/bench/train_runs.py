"""Runs of trains and their evaluation: courses over time and along the train, build-up time, propagation."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fmu_src.cosimulation.recording import Recording
from products.train.consist import Consist, block_train
from products.train.train import Train

#: Lengths of a locomotive and of a wagon [m], and pressure of a full cylinder [Pa].
LOCOMOTIVE, WAGON, FULL = 19.0, 14.0, 380e3
#: Pressure of a cylinder that begins to fill [Pa].
BEGUN = 10e3
Numbers = NDArray[np.float64]


def train_of(length: float, **values: object) -> Consist:
    """Return a locomotive and loaded wagons of a length [m], to half a wagon; values: of `block_train`."""
    return block_train(round((length - LOCOMOTIVE) / WAGON), **values)  # type: ignore[arg-type]


@dataclass(frozen=True)
class TrainCourse:
    """Gauge pressures [Pa], tension [N], speed [m/s], distance [m] and wheel speed [m/s], by time [s] and vehicle or
    coupling.
    """

    time: Numbers
    pipe: Numbers
    cylinder: Numbers
    force: Numbers
    speed: Numbers
    distance: Numbers
    wheel: Numbers

    def recording(self) -> Recording:
        """Return the recording of head, middle and end."""
        last = self.pipe.shape[1] - 1
        units = {"time": "s", "speed": "m/s", "distance": "m"}
        rows = [self.time, self.speed[:, 0], self.distance[:, 0]]
        for name, place in (("head", 0), ("middle", last // 2), ("end", last)):
            units |= {f"pipe_pressure_{name}": "Pa", f"cylinder_pressure_{name}": "Pa"}
            rows += [self.pipe[:, place], self.cylinder[:, place]]
        units["largest_coupler_force"], units["smallest_coupler_force"] = "N", "N"
        rows += [self.force.max(axis=1), self.force.min(axis=1)]
        return Recording(units, np.array(rows).T)

    def begun(self) -> Numbers:
        """Return the time at which each cylinder begins to fill [s]; NaN if it does not."""
        on = self.cylinder > BEGUN
        return np.where(on.any(axis=0), self.time[on.argmax(axis=0)], np.nan)

    @property
    def braking_distance(self) -> float:
        """Return the distance of the head from the first time on [m]."""
        return float(self.distance[-1, 0] - self.distance[0, 0])


def follow(
    train: Train, seconds: float, interval: float = 0.1, act: Callable[[Train], bool] | None = None
) -> TrainCourse:
    """Advance a train and record it.

    Takes seconds [s], interval [s].
    """
    rows: list[list[Numbers]] = []

    def look() -> None:
        force = train.coupler_force if len(train.consist.vehicles) > 1 else np.zeros(1)
        looked = [train.pipe_pressure, train.cylinder_pressure, force, train.speed, train.distance, train.wheel_speed]
        rows.append([np.array(train.time), *looked])

    look()
    for _ in range(round(seconds / interval)):
        if act is not None and act(train):
            break
        train.advance(interval)
        look()
    return TrainCourse(*(np.array(values) for values in zip(*rows, strict=True)))


def seconds_of(courses: Iterable[TrainCourse]) -> float:
    """Return the time simulated by all courses, each of which begins at the clock's zero [s]."""
    return float(sum(course.time[-1] for course in courses))


def stands(train: Train) -> bool:
    """Return whether all vehicles are at rest."""
    return bool((train.speed == 0.0).all())


def stop(train: Train, interval: float = 0.1, longest: float = 300.0) -> TrainCourse:
    """Advance until all vehicles are at rest."""
    return follow(train, longest, interval, stands)


def build_up_time(course: TrainCourse) -> float:
    """Return the equivalent delay of an immediate brake, int (1 - mean share of full pressure) dt [s]."""
    share = np.clip(course.cylinder / FULL, 0.0, 1.0).mean(axis=1)
    return float(np.trapezoid(1.0 - share, course.time))


def propagation(course: TrainCourse, length: float) -> float:
    """Return the speed [m/s] at which cylinders begin to fill, beyond the first tenth of the train."""
    begun = course.begun()
    first = len(begun) // 10
    return length * (len(begun) - 1 - first) / len(begun) / float(begun[-1] - begun[first])
