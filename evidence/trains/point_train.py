"""Stops of a train as one mass: brake forces of its vehicles by their own cylinders, many stops at once.

Cylinders are filled in a standing train, because their pressures do not depend on its speed. The stops then cost
nothing: couplers change the distance of a train by less than 0.3 % (tests/evidence/test_point_train.py).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from products.train.consist import Consist, forces_of
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.vehicle import GRAVITY

Numbers = NDArray[np.float64]
#: Interval of pressures and of steps [s], and longest stop [s]. Speeds at which forces are known [m/s].
INTERVAL, LONGEST = 0.25, 600.0
SPEEDS = np.linspace(0.0, 36.0, 13)
#: Gauge pressures at which forces are known [Pa]; they are linear in between.
PRESSURES = np.linspace(0.0, 500e3, 251)
#: Largest and least factor on the brake forces in a fit.
FACTORS = (0.05, 20.0)


@dataclass(frozen=True)
class PointTrain:
    """A train that brakes: its forces by time and speed.

    force: of all brakes, by time (every `interval` [s]) and SPEEDS [N]; turning: its mass with the rotating masses
    [kg]; weight [N]; resistance: a, b, c of the train [N, N.s/m, N.s2/m2]; build_up: equivalent time of its brakes [s].
    """

    force: Numbers
    turning: float
    weight: float
    resistance: tuple[float, float, float]
    build_up: float
    interval: float = INTERVAL

    def distances(self, speeds: Numbers, gradients: Numbers, factor: float = 1.0, delay: float = 0.0) -> Numbers:
        """Return stopping distances [m]; NaN for a train that does not stop. Heun's midpoint rule.

        speeds [m/s]; gradients, rising above 0 [1]; factor: on brake forces; delay: before the demand [s].
        """
        speed, way = np.array(speeds, float), np.zeros(len(speeds))
        a, b, c = self.resistance
        for step in range(round(LONGEST / self.interval)):
            force = factor * self._forces((step + 0.5) * self.interval - delay)

            def slows(v: Numbers, force: Numbers = force) -> Numbers:
                against = np.interp(v, SPEEDS, force) + a + b * v + c * v**2 + self.weight * gradients
                return np.asarray(against / self.turning)

            rate = slows(np.maximum(speed - self.interval / 2 * slows(speed), 0.0))
            after = speed - self.interval * rate
            ends = speed**2 / (2 * np.maximum(rate, 1e-9))
            way += np.where(after > 0.0, (speed + after) / 2 * self.interval, np.where(speed > 0.0, ends, 0.0))
            speed = np.maximum(after, 0.0)
            if not speed.any():
                break
        return np.where(speed > 0.0, np.nan, way)

    def _forces(self, time: float) -> Numbers:
        place = min(max(time, 0.0) / self.interval, len(self.force) - 1.001)
        before = int(place)
        return np.asarray(self.force[before] + (place - before) * (self.force[before + 1] - self.force[before]))

    def fitted(self, speed: float, distance: float, margin: float = 1.0, delay: float = 0.0) -> float:
        """Return the factor on the brake forces with which a stop on level track has a distance, over a margin."""

        def excess(logarithm: float) -> float:
            found = self.distances(np.array([speed]), np.zeros(1), float(np.exp(logarithm)), delay)[0]
            return (margin * found if np.isfinite(found) else 1e6) - distance

        return float(np.exp(brentq(excess, *np.log(FACTORS), xtol=1e-5)))


def point_train(
    consist: Consist, drive: tuple[str, float], settings: Settings, seconds: float = 150.0, without: str = ""
) -> PointTrain:
    """Return a train with its brakes as a driver's valve applies them.

    drive: position and step; without: a kind of vehicle whose brake is released, such as `locomotive`.
    """
    train, rows = Train(consist, settings=settings), []
    train.drive(*drive)
    for _ in range(round(seconds / INTERVAL) + 1):
        rows.append(train.cylinder_pressure)
        train.advance(INTERVAL)
    pressure = np.array(rows)
    force = np.zeros((len(rows), len(SPEEDS)))
    for brake in {vehicle.brake for vehicle in consist.vehicles if vehicle.kind != without}:
        own = [one.kind != without and one.brake == brake for one in consist.vehicles]
        pressures, speeds = (one.ravel() for one in np.meshgrid(PRESSURES, SPEEDS, indexing="ij"))
        grid = forces_of(brake, pressures, speeds).reshape(PRESSURES.size, SPEEDS.size)
        for column, values in enumerate(grid.T):
            force[:, column] += np.interp(pressure[:, own], PRESSURES, values).sum(axis=1)
    full = np.array([one.distributor.full_pressure or np.inf for one in consist.vehicles])
    braked = np.isfinite(full) & np.array([one.kind != without for one in consist.vehicles])
    missing = 1.0 - np.clip(pressure[:, braked] / full[braked], 0.0, 1.0).mean(axis=1)
    a, b, c = np.array([one.resistance for one in consist.vehicles]).sum(axis=0).tolist()
    turning = sum((1 + one.rotating_share) * one.mass for one in consist.vehicles)
    build_up = float(np.trapezoid(missing, dx=INTERVAL))
    return PointTrain(force, turning, GRAVITY * consist.mass, (a, b, c), build_up)
