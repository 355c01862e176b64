"""The course of a stop over time, as the test rig writes it down where it is asked to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fmu_src.cosimulation.recording import Recording
from products.protection.rig_in_c import Notes
from products.protection.settings import BRAKE_START, LONGEST

Numbers = NDArray[np.float64]
#: Time between two looks that are written down [s]: a cylinder takes 2 s to fill and a wheel some tenths of one to
#: lock, while a stop of a minute stays below a thousand looks. Of valves that change more quickly one sees samples.
EVERY = 0.1


@dataclass(frozen=True, eq=False)
class History:
    """A stop at instants, the last of which is its end.

    time [s], speed [m/s] and distance [m] of the machine have shape (looks,). Of shape (looks, wheelsets) are the
    angular velocity [rad/s], the circumferential speed that the sensor shows [m/s], the effort: cylinder pressure [Pa],
    or of a start the motor's torque [N.m]; what the valve did until then: 0 apply, 1 hold, 2 vent; and the creep force
    of both wheels and their load [N].
    """

    time: Numbers
    speed: Numbers
    distance: Numbers
    angular_velocity: Numbers
    sensor_speed: Numbers
    effort: Numbers
    valve: NDArray[np.int8]
    creep_force: Numbers
    axle_load: Numbers

    def braked(self, above: float) -> NDArray[np.bool_]:
        """At which looks it was braked and faster than `above` [m/s]."""
        return np.asarray((self.speed > above) & (self.time > BRAKE_START))

    def locks(self, above: float) -> bool:
        """Whether every wheelset stood for most of the braked time in which the machine ran faster than `above`."""
        return bool(np.all(np.mean(self.angular_velocity[self.braked(above)] == 0.0, axis=0) > 0.5))

    def recording(self, radius: float, said: str = "", commands: float = 0) -> Recording:
        """What the controller saw and did at each look but the last, at which the machine stands and no valve is told.

        radius: of the wheels [m]. Columns: time [s]; speed [m/s]; braking_force of all wheelsets [N]; and of each
        wheelset wheel_speed [m/s], pressure [Pa], the command to its valve, and the adhesion that it used.
        """
        asked = slice(0, -1)
        creep, load = self.creep_force[asked], self.axle_load[asked]
        units = {"time": "s", "speed": "m/s", "braking_force": "N"}
        columns = [self.time[asked], self.speed[asked], -creep.sum(axis=1)]
        of_each: dict[tuple[str, str], NDArray[Any]] = {
            ("wheel_speed", "m/s"): radius * self.angular_velocity[asked],
            ("pressure", "Pa"): self.effort[asked],
            ("valve", "1"): self.valve[1:],
            ("adhesion", "1"): -creep / load,
        }
        for place in range(creep.shape[1]):
            units |= {f"{name}_{place + 1}": unit for name, unit in of_each}
            columns += [values[:, place] for values in of_each.values()]
        return Recording(units, np.column_stack(columns), [said] if said else [], {"commands": int(commands)})


class Notebook:
    """Room in which the rig in C writes runs down, a row for each; `place` is what it is told.

    every: looks between two that are written down; period: time between two looks [s].
    """

    def __init__(self, rows: int, wheelsets: int, every: int, period: float) -> None:
        room = math.ceil(LONGEST / (every * period)) + 2  # the first look and the last one
        self._looks = np.zeros((rows, room, 3 + 6 * wheelsets))
        self._count = np.zeros(rows, np.int64)
        self.place = Notes(every, room, self._looks.ctypes.data, self._count.ctypes.data)

    def history(self, row: int) -> History:
        """What was written down of the run in a row, copied."""
        looks = self._looks[row, : self._count[row]].copy()
        of_each = np.split(looks[:, 3:], 6, axis=1)
        time, speed, distance = looks[:, :3].T
        turning, shown, effort, valve, creep, load = of_each
        return History(time, speed, distance, turning, shown, effort, valve.astype(np.int8), creep, load)
