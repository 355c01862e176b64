"""A train that does not start: forces that it demands and has, in a message instead of an endless wait."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from products.train.driver_forces import line_force, resistance_of
from products.train.train import Train
from rbd_model.train.vehicle import GRAVITY

#: Time without progress after which a driver gives up [s], and the way that is progress [m]. Assumed: the brakes of the
#: longest trains release in less.
PATIENCE, PROGRESS = 180.0, 1.0


@dataclass
class StartWatch:
    """Progress of a train that its driver wants to move.

    place: where it last made progress [m], from `since` on [s]. pull, brakes: forces of motors and brakes [N] at the
    moment in which the motors exceeded the brakes most.
    """

    place: float = -math.inf
    since: float = 0.0
    pull: float = 0.0
    brakes: float = math.inf

    def reset(self) -> None:
        """Begin anew, because the train is to stand."""
        self.place = -math.inf

    def look(self, train: Train, adhesion: float = math.inf) -> None:
        """Raise ValueError if the train has made no progress for PATIENCE. adhesion: at most used by the driver."""
        front = float(train.distance[0]) + train.consist.vehicles[0].length / 2
        if front > self.place + PROGRESS:
            self.place, self.since, self.pull, self.brakes = front, train.time, 0.0, math.inf
        pull, brakes = float(np.sum(train.traction_force)), float(np.sum(train.brake_force))
        if pull - brakes > self.pull - self.brakes:
            self.pull, self.brakes = pull, brakes
        if train.time - self.since >= PATIENCE:
            raise ValueError(self._message(train, front, adhesion))

    def _message(self, train: Train, front: float, adhesion: float) -> str:
        consist = train.consist
        weight = consist.mass * GRAVITY
        slope, resistance = float(line_force(consist, train.line, np.array([front]))[0]), resistance_of(consist)[0]
        demanded = slope + resistance + self.brakes
        return (
            f"The train does not start: its motors must pull more than {demanded / 1e3:.1f} kN (gradient and curves of "
            f"{1e3 * slope / weight:.1f} permille {slope / 1e3:.1f}, resistance {resistance / 1e3:.1f}, brakes "
            f"{self.brakes / 1e3:.1f}); got {self.pull / 1e3:.1f} kN. {self._remedy(train, adhesion)}"
        )

    def _remedy(self, train: Train, adhesion: float) -> str:
        driven = [one for one in train.consist.vehicles if one.traction.traction_force > 0.0]
        motors = sum(one.traction.traction_force * one.traction.shape_start for one in driven)
        grip = sum(one.mass * GRAVITY * one.braked_share for one in driven)
        if self.brakes > max(self.pull, 1.0):
            return "Release its brakes: charge the pipe, and look at retainers, parking and track brakes."
        if not driven:
            return "State traction_force of a vehicle."
        if self.pull > 0.95 * motors:
            return "Add a locomotive, or take off vehicles."
        if self.pull > 0.9 * adhesion * grip:
            return f"The driver uses an adhesion of {adhesion:g}: raise it, or add driven vehicles."
        return "The wheels slip, or the pipe cuts the motors off: raise inputs['friction'], or charge the pipe."
