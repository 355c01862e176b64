"""The course of a stop over time, as the test rig writes it down where it is asked to."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from products.protection.protected_stop import LONGEST
from products.protection.rig_in_c import Notes

Numbers = NDArray[np.float64]
#: Time between two looks that are written down [s]: a cylinder takes 2 s to fill and a wheel some tenths of one to
#: lock, while a stop of a minute stays below a thousand looks. Of valves that change more quickly one sees samples.
EVERY = 0.1


@dataclass(frozen=True, eq=False)
class History:
    """A stop at instants, the last of which is its end.

    time [s], speed [m/s] and distance [m] of the machine have shape (looks,). Of shape (looks, wheelsets) are the
    angular velocity [rad/s], the circumferential speed that the sensor shows [m/s], the effort: cylinder pressure [Pa],
    or of a start the motor's torque [N.m]; and what the valve did until then: 0 apply, 1 hold, 2 vent.
    """

    time: Numbers
    speed: Numbers
    distance: Numbers
    angular_velocity: Numbers
    sensor_speed: Numbers
    effort: Numbers
    valve: NDArray[np.int8]


class Notebook:
    """Room in which the rig in C writes runs down, a row for each; `place` is what it is told.

    every: looks between two that are written down; period: time between two looks [s].
    """

    def __init__(self, rows: int, wheelsets: int, every: int, period: float) -> None:
        room = math.ceil(LONGEST / (every * period)) + 2  # the first look and the last one
        self._looks = np.zeros((rows, room, 3 + 4 * wheelsets))
        self._count = np.zeros(rows, np.int64)
        self.place = Notes(every, room, self._looks.ctypes.data, self._count.ctypes.data)

    def history(self, row: int) -> History:
        """What was written down of the run in a row, copied."""
        looks = self._looks[row, : self._count[row]].copy()
        of_each = np.split(looks[:, 3:], 4, axis=1)
        time, speed, distance = looks[:, :3].T
        turning, shown, effort, valve = of_each
        return History(time, speed, distance, turning, shown, effort, valve.astype(np.int8))
