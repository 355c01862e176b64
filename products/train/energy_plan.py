"""The plan of a driver who saves energy: a profile to the next stop, made again when the train leaves it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from products.train.driver_forces import SPEEDS, line_force, moved_mass, resistance_of
from products.train.speed_profile import Due, Leg, SpeedProfile, least_energy
from products.train.train import Train

#: Length of a cell [m], and least and largest number of cells; places of a cell whose gradients are averaged. Assumed.
CELL, FEW, MANY, WITHIN = 60.0, 30, 150, 5
#: A profile is made again if the train is away by a time [s] or a speed [m/s]. Not before a time [s] since the last
#: one, and not within a time before the train is due [s]. Assumed.
AWAY, FASTER, AGAIN, LATEST = 1.0, 0.7, 10.0, 30.0
#: Time by which the train may be late at a price, over that of the first profile: else a second that is lost on the way
#: would be made up at any. Assumed.
LATE, DEAR = 4.0, 1.2
#: Planned force below which the train coasts [m/s2]; time in which a speed is corrected [s]. Assumed.
COASTS, CORRECTS = 3e-3, 5.0


def allowed_speed(limits: Sequence[tuple[float, float]], front: float, length: float) -> float:
    """Return the lowest speed limit below a train [m/s]; the first limit holds before its place, too."""
    places, speeds = np.transpose(limits)
    first, last = (max(int(np.searchsorted(places, at, "right")) - 1, 0) for at in (front - length, front))
    return float(speeds[first : last + 1].min())


@dataclass
class EnergyPlan:
    """Profiles of least energy for a train.

    forces: those of `train_forces`. limits: places and speeds. deceleration [m/s2], adhesion: largest ones. recovery:
    share of the electric brake's energy that comes back. answers: time by which the profile is read ahead [s].
    """

    train: Train
    forces: NDArray[np.float64]
    limits: Sequence[tuple[float, float]]
    deceleration: float
    adhesion: float
    recovery: float
    answers: float
    profile: SpeedProfile | None = None
    begun: float = 0.0
    price: float = math.inf

    def leg(self, front: float, stop: float) -> Leg:
        """Return the way from a place of the front to a stop [m]."""
        consist, mass = self.train.consist, moved_mass(self.train.consist)
        count = int(np.clip((stop - front) / CELL, FEW, MANY))
        changes = [place for place, _ in self.limits] + [place + consist.length for place, _ in self.limits]
        place = np.union1d(np.linspace(front, stop, count + 1), [at for at in changes if front + 1 < at < stop - 1])
        place = place[np.concatenate([[True], np.diff(place[:-1]) > 1.0, [True]])]
        edge = 1e-3
        allowed = [allowed_speed(self.limits, at + edge, consist.length + 2 * edge) for at in place]
        shares = (np.arange(WITHIN) + 0.5) / WITHIN
        inside = place[:-1, None] + np.diff(place)[:, None] * shares
        slope = line_force(consist, self.train.line, np.ravel(inside)).reshape(inside.shape).mean(axis=1)
        motors, _, _, grips, electric = self.forces / mass
        a, b, c = (share / mass for share in resistance_of(consist))
        pull = np.minimum(motors, self.adhesion * grips)
        return Leg(
            place, np.array(allowed), slope / mass, (a, b, c), SPEEDS, pull, electric, self.deceleration, self.recovery
        )

    def acceleration(self, front: float, speed: float, stop: float, due: float) -> tuple[float, bool]:
        """Return the acceleration to drive with [m/s2], and whether the train coasts.

        front, stop: places [m]. speed [m/s]. due: time of arrival [s].
        """
        ahead = front + speed * self.answers
        if self.profile is None or self.profile.place[-1] != stop:
            self.price = math.inf
            self.price = self._plan(ahead, speed, stop, due, 0.0)
        elif self._is_away(front, speed, due):
            self._plan(ahead, speed, stop, due, LATE)
        profile = self.profile
        assert profile is not None
        cell = int(np.clip(np.searchsorted(profile.place, ahead, "right") - 1, 0, len(profile.force) - 1))
        square = profile.speed**2
        rate = (square[cell + 1] - square[cell]) / 2 / (profile.place[cell + 1] - profile.place[cell])
        wanted = np.sqrt(np.interp(front, profile.place, square))
        return rate + (wanted - speed) / CORRECTS, bool(abs(profile.force[cell]) < COASTS)

    def _plan(self, place: float, speed: float, stop: float, due: float, late: float) -> float:
        """Make a profile from a place on [m] that may be late by a time [s] at a price; return its own price."""
        self.begun = self.train.time + self.answers
        price = DEAR * self.price if math.isfinite(self.price) else 0.0
        self.profile = least_energy(self.leg(place, stop), speed, Due(due - self.begun, late if price else 0.0, price))
        return self.profile.price

    def _is_away(self, front: float, speed: float, due: float) -> bool:
        """Return whether the train has left the profile, and there is time to make a new one."""
        profile, time = self.profile, self.train.time
        if profile is None or time - self.begun < AGAIN or due - time < LATEST:
            return False
        late = time - self.begun - np.interp(front, profile.place, profile.time)
        fast = speed - np.sqrt(np.interp(front, profile.place, profile.speed**2))
        return bool(abs(late) > AWAY or abs(fast) > FASTER)
