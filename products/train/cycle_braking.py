"""Braking on a descent with valves that release wholly: a minimum reduction, small further ones, rare releases.

So is balanced and cycle braking described in North America (no rule book was read). The first reduction is the least
one. Further ones are small, each after the answer to the one before. A dynamic brake, or power against the brakes,
trims the speed. A release is made only if the air that is left can brake the train again. Numbers are assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from products.train.driver_forces import SPEEDS, line_force, moved_mass, resistance_of, train_forces
from products.train.train import Train

#: Times [s]: of the estimate of the balancing force, of a correction of speed by the fast brakes and by air, by which
#: an application and a release are made ahead, and between two reductions beside 1 s for each SECOND_OVER m of train.
FEELS, FAST, SLOW, LEADS, RELEASES, WAITS, SECOND_OVER = 6.0, 8.0, 40.0, 10.0, 6.0, 12.0, 100.0
#: Speed above the set one at which air is applied, and below it at which it is released [m/s].
ABOVE, BELOW = 0.2, 1.0
#: Share of the whole brake that a minimum reduction has at least, by quick service: 0.76 of 3.57 bar. Air is applied
#: later [m/s] if the balance needs less, because it then slows the train, and must be released.
QUICK, LATER = 0.21, 0.8
#: Share of the dynamic brake that air leaves to trim the speed; least and largest further reduction, of the air brake.
TRIMS, SMALLEST, LARGEST = 0.5, 0.01, 0.08
#: Fall of the pipe in full service [Pa] (UIC 540).
SERVICE = 1.5e5
#: Share of the air brake in use beyond which a release would leave too little for the next application: on a gradient,
#: and on one that needs more than a share of the whole brake.
KEEPS, STEEP = (0.8, 0.55), 0.25


@dataclass
class CycleBraking:
    """The brakes of a descent: the air in use as a share of all, and what the driver has felt."""

    train: Train
    least: float
    air: float = 0.0
    dynamic: float = 0.0
    traction: float = 0.0
    _balance: float = math.nan
    _rate: float = 0.0
    _speed: float = math.nan
    _electric: float = 0.0
    _time: float = 0.0
    _changed: float = -math.inf
    _charged: float = 0.0
    _forces: NDArray[np.float64] | None = None

    def act(self, wanted: float, fast: bool) -> None:
        """Set shares of air, dynamic brake and traction for a speed [m/s]; fast: whether the dynamic brake is used."""
        if self._forces is None:
            self._forces = train_forces(self.train.consist)
        speed = float(np.mean(self.train.speed))
        motors, electric, full = (float(np.interp(speed, SPEEDS, row)) for row in self._forces[:3])
        able, mass = electric if fast else 0.0, moved_mass(self.train.consist)
        air = self._feel(speed, mass)
        over = speed - wanted
        trim = self._balance + mass * over / FAST - air
        self.dynamic = min(max(trim / able, 0.0), 1.0) if able else 0.0
        self.traction = min(max(-trim / motors, 0.0), 1.0) if motors else 0.0
        self._set_air(over, air, able, trim, full, mass)

    def _feel(self, speed: float, mass: float) -> float:
        """Update the force of brakes that would keep the speed [N], and return that of the air brake."""
        train = self.train
        step, brakes = train.time - self._time, float(np.sum(train.brake_force))
        if math.isnan(self._speed) or step <= 0.0:
            front = np.array([train.distance[0] + train.consist.vehicles[0].length / 2])
            a, b, c = resistance_of(train.consist)
            self._balance = -float(line_force(train.consist, train.line, front)[0]) - a - b * speed - c * speed**2
            self._speed, self._time = speed, train.time
            self._electric = float(np.sum(train.electric_brake_energy))
            return brakes
        energy = float(np.sum(train.electric_brake_energy))
        electric = (energy - self._electric) / max(abs(speed) * step, 0.1)
        rate = (speed - self._speed) / step
        felt = brakes - float(np.sum(train.traction_force)) + mass * rate
        share = min(step / FEELS, 1.0)
        self._balance += (felt - self._balance) * share
        self._rate += (rate - self._rate) * share
        self._speed, self._electric, self._time = speed, energy, train.time
        return max(brakes - electric, 0.0)

    def _set_air(self, over: float, air: float, able: float, trim: float, full: float, mass: float) -> None:
        """Apply, add to or release the air."""
        waited, pulls = self.train.time - self._changed, bool(self._forces is not None and self._forces[0].any())
        before = self.air
        self._charged = max(self._charged, float(self.train.pipe_pressure[0]))
        trimmed = self.dynamic == 0.0 and (self.traction >= 0.95 or not pulls)
        keeps = KEEPS[self._balance > STEEP * full]
        if not self.air:
            above = ABOVE if self._balance > QUICK * full else LATER
            if over + self._rate * LEADS > above and trim > 0.9 * able:
                end = float(self.train.pipe_pressure[-1])  # as an end-of-train device shows it
                self.air = min(max(self._charged - end, 0.0) / SERVICE + self.least, 1.0)
        elif trimmed and over + self._rate * RELEASES < -BELOW and self._rate < 0.0 and self.air < keeps:
            self.air = 0.0
        else:
            self.air = self._added(over, air, able, full, mass, waited)
        if self.air != before:
            self._changed = self.train.time

    def _added(self, over: float, air: float, able: float, full: float, mass: float, waited: float) -> float:
        """Return the share of air with a further small reduction, where the brakes need it and have answered."""
        lacks = self._balance + mass * over / SLOW - TRIMS * able - air
        if waited < WAITS + self.train.consist.length / SECOND_OVER or lacks < SMALLEST * full:
            return self.air
        return min(self.air + min(max(lacks / full, SMALLEST), LARGEST), 1.0)
