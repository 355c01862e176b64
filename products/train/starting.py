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
#: Remedy for brakes that hold a train.
RELEASE = "Release its brakes: charge the pipe, and look at retainers, parking and track brakes."


@dataclass
class StartWatch:
    """Progress of a train that its driver wants to move.

    place: where it last made progress [m], from `since` on [s]. brakes: least force of its brakes since then [N].
    """

    place: float = -math.inf
    since: float = 0.0
    brakes: float = math.inf

    def reset(self) -> None:
        """Begin again, because the train is to stand."""
        self.place = -math.inf

    def look(self, train: Train, adhesion: float = math.inf, reason: str = "") -> None:
        """Raise ValueError if the train has made no progress for PATIENCE.

        adhesion: at most used by the driver. reason: why its brakes stay applied on a descent.
        """
        front = float(train.distance[0]) + train.consist.vehicles[0].length / 2
        if front > self.place + PROGRESS:
            self.place, self.since, self.brakes = front, train.time, math.inf
        self.brakes = min(self.brakes, float(np.sum(train.brake_force)))
        if train.time - self.since >= PATIENCE:
            raise ValueError(self._message(train, front, adhesion, reason))

    def _message(self, train: Train, front: float, adhesion: float, reason: str) -> str:
        consist, weight = train.consist, train.consist.mass * GRAVITY
        slope, resistance = float(line_force(consist, train.line, np.array([front]))[0]), resistance_of(consist)[0]
        demanded, (pull, remedy) = slope + resistance + self.brakes, _available(train, adhesion)
        penalty = _penalty(train)
        gradient = f"gradient and curves of {1e3 * slope / weight:.1f} permille"
        if slope + resistance < 0.0:  # it would roll: its brakes hold it
            return (
                f"The train stands on a descent, held by its own brakes: {gradient} pull {-slope / 1e3:.1f} kN, and "
                f"the brakes hold {self.brakes / 1e3:.1f} kN. {penalty or reason or RELEASE}"
            )
        if self.brakes > max(pull - slope - resistance, 1.0):
            remedy = RELEASE
        return (
            f"The train does not start: its motors must pull more than {demanded / 1e3:.1f} kN ({gradient} "
            f"{slope / 1e3:.1f}, resistance {resistance / 1e3:.1f}, brakes "
            f"{self.brakes / 1e3:.1f}); got {pull / 1e3:.1f} kN. {penalty or remedy}"
        )


def _penalty(train: Train) -> str:
    """Return the remedy for a penalty in force, empty without one."""
    valves = np.flatnonzero(train.penalty_applied).tolist()
    return (
        f"A penalty is in force at driver's valve {valves[0] + 1}: acknowledge it, or reset its input."
        if valves
        else ""
    )


def _available(train: Train, adhesion: float) -> tuple[float, str]:
    """Return the pull of a train at rest that its driver can use [N], and the remedy if it does not suffice."""
    driven = [one.traction.traction_force > 0.0 for one in train.consist.vehicles]
    if not any(driven):
        return 0.0, "State traction_force of a vehicle."
    weights = np.array([one.mass * GRAVITY * one.braked_share for one in train.consist.vehicles])[driven]
    motors = np.array([one.traction.traction_force * one.traction.shape_start for one in train.consist.vehicles])[
        driven
    ]
    limits = {
        "Add a locomotive, or take off vehicles.": float(motors.sum()),
        f"The driver uses an adhesion of {adhesion:g}: raise it, or add driven vehicles.": adhesion * weights.sum(),
        "The wheels slip: raise inputs['friction'], or add driven vehicles.": float(
            np.minimum(motors, train.inputs["friction"][driven] * weights).sum()
        ),
    }
    remedy = min(limits, key=lambda words: limits[words])
    return float(limits[remedy]), remedy
