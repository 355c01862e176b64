"""The rail that sliding wheels of a train clean for those behind: friction of each vehicle from energies over place.

The law is that of `rbd_model/track/recovery.py`. Here it has a memory along the rail instead of one wheel base.
"""

from __future__ import annotations

import math
from collections import defaultdict

import numpy as np
from numpy.typing import NDArray

from products.train.train import Train
from rbd_model.track.adhesion_laws import cleaned_share
from rbd_model.track.recovery import SLOWEST, RecoveryParameters, assumed_recovery

#: Length of rail with one energy [m], and shortest step [s].
CELL, SHORTEST = 1.0, 1e-3
#: Largest number of wheelsets of a vehicle.
MOST_WHEELSETS = 32


class CleanedRail:
    """Friction below a train whose sliding wheels clean the rail.

    Each step sets the input `friction` of the train. Vehicles have equal wheelsets, spread evenly over their length.
    Each one brakes with its share of the vehicle's force, and slides as the vehicle's wheels do (assumed).

    Parameters
    ----------
    train : Train
        The train. `advance` of this object drives it.
    rail : RecoveryParameters, optional
        Friction of the dirty and of the cleaned rail, and the energy that cleans; by default those of
        `assumed_recovery`. `wheel_base` has no effect.
    wheelsets : int
        Number of wheelsets of each vehicle, 1 to 32.

    Raises
    ------
    ValueError
        If the number of wheelsets is not within its limits.
    """

    def __init__(self, train: Train, rail: RecoveryParameters | None = None, wheelsets: int = 4) -> None:
        if not (isinstance(wheelsets, int) and 1 <= wheelsets <= MOST_WHEELSETS):
            raise ValueError(f"wheelsets must be an integer from 1 to {MOST_WHEELSETS}; got {wheelsets}. Correct it.")
        self.train, self.rail = train, rail or assumed_recovery()
        lengths = np.array([vehicle.length for vehicle in train.consist.vehicles])
        shares = 0.5 - (np.arange(wheelsets) + 0.5) / wheelsets
        self._offsets: NDArray[np.float64] = lengths[:, None] * shares
        self._own = np.zeros(len(lengths))  # share that a vehicle's wheels have cleaned below themselves
        self._energy: defaultdict[int, float] = defaultdict(float)  # of each cell [J/m]
        self._set_friction()

    def advance(self, seconds: float, step: float = 0.02) -> None:
        """Advance the train by a time, in steps of at most `step` and of half a cell [s].

        Raises ValueError if `step` is below 1 ms, or as `Train.advance`.
        """
        if not SHORTEST <= step < math.inf:
            raise ValueError(f"step must be at least {SHORTEST:g} s; got {step} s. Lengthen it.")
        left = seconds
        while left > 0.0:
            fastest = max(float(np.abs(self.train.speed).max()), SLOWEST)
            taken = min(left, max(min(step, CELL / 2.0 / fastest), SHORTEST))
            begin = self.train.distance
            self.train.advance(taken)
            self._clean(begin, taken)
            self._set_friction()
            left -= taken if left > taken else left

    def energy(self, place: float) -> float:
        """Return the energy of sliding that the rail at a place [m] has received [J/m]."""
        return self._energy.get(math.floor(place / CELL), 0.0)

    def _clean(self, begin: NDArray[np.float64], step: float) -> None:
        """Add the energy of sliding of a step to the rail, e = |F w| / V, and follow it with the wheels' surface."""
        train, rail = self.train, self.rail
        speed, power = train.speed, np.abs(train.rail_force * (train.speed - train.wheel_speed))
        each = power / self._offsets.shape[1]
        first, last = ((at[:, None] + self._offsets) / CELL for at in (begin, train.distance))
        for row in np.flatnonzero(power):
            for low, high in zip(np.minimum(first, last)[row], np.maximum(first, last)[row], strict=True):
                self._lay(float(low), float(high), float(each[row]) * step / CELL)
        follows = -np.expm1(-np.abs(speed) * step / rail.recovery_length)
        own = cleaned_share(rail, each / np.maximum(np.abs(speed), SLOWEST))
        self._own += (own - self._own) * follows

    def _lay(self, low: float, high: float, energy: float) -> None:
        """Add an energy over CELL [J/m] evenly to the cells between two places, in cells."""
        for cell in range(math.floor(low), math.floor(high) + 1):
            way = min(high, cell + 1.0) - max(low, float(cell))
            self._energy[cell] += energy * (way / (high - low) if high > low else 1.0)

    def _set_friction(self) -> None:
        train, rail = self.train, self.rail
        ahead = np.where(train.speed < 0.0, -CELL, CELL)[:, None]
        places = train.distance[:, None] + self._offsets + ahead  # the rail before a wheelset has slid on it
        found = rail.left_behind * cleaned_share(rail, [[self.energy(of) for of in row] for row in places])
        share = 1.0 - (1.0 - self._own) * (1.0 - found).mean(axis=1)
        train.inputs["friction"] = rail.degraded_friction + (rail.recovered_friction - rail.degraded_friction) * share
