"""The course of a stop over time, recorded by the test rig on request."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fmu_src.cosimulation.recording import Recording
from products.protection.rig_in_c import RigNotes
from products.protection.settings import BRAKE_START, LONGEST

Numbers = NDArray[np.float64]
#: Recording interval [s]. A cylinder fills in 2 s and a wheel locks in some tenths of a second; a stop of a minute has
#: fewer than a thousand rows. Valves that switch faster are undersampled.
EVERY = 0.1


@dataclass(frozen=True, eq=False)
class StopHistory:
    """A stop at sampling instants, the last of which is its end.

    time [s], speed [m/s] and distance [m] of the vehicle have shape (samples,). The others have shape (samples,
    wheelsets): angular velocity [rad/s]; circumferential speed of the sensor [m/s]; effort, the cylinder pressure [Pa]
    or in a start the motor torque [N.m]; valve, the command until then: 0 apply, 1 hold, 2 vent; creep force of both
    wheels and axle load [N].
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
        """Return at which instants it was braked and faster than `above` [m/s]."""
        return np.asarray((self.speed > above) & (self.time > BRAKE_START))

    def locks(self, above: float) -> bool:
        """Return whether every wheelset stood for most of the braked time above this speed [m/s]."""
        return bool(np.all(np.mean(self.angular_velocity[self.braked(above)] == 0.0, axis=0) > 0.5))

    def recording(self, radius: float, message: str = "", commands: float = 0) -> Recording:
        """Return inputs and outputs of the controller at each instant except the last, at which the vehicle stands.

        radius: of the wheels [m]. Columns: time [s]; speed [m/s] and distance [m]; braking_force of all wheelsets
        [N]; and for each wheelset wheel_speed [m/s], pressure [Pa], the command to its valve, and the used adhesion.
        """
        asked = slice(0, -1)
        creep, load = self.creep_force[asked], self.axle_load[asked]
        units = {"time": "s", "speed": "m/s", "distance": "m", "braking_force": "N"}
        columns = [self.time[asked], self.speed[asked], self.distance[asked], -creep.sum(axis=1)]
        of_each: dict[tuple[str, str], NDArray[Any]] = {
            ("wheel_speed", "m/s"): radius * self.angular_velocity[asked],
            ("pressure", "Pa"): self.effort[asked],
            ("valve", "1"): self.valve[1:],
            ("adhesion", "1"): -creep / load,
        }
        for place in range(creep.shape[1]):
            units |= {f"{name}_{place + 1}": unit for name, unit in of_each}
            columns += [values[:, place] for values in of_each.values()]
        return Recording(units, np.column_stack(columns), [message] if message else [], {"commands": int(commands)})


class Notebook:
    """Memory for the histories of the rig in C, a row for each run; `place` is passed to the rig.

    every: recording interval in samples; period: sampling period [s].
    """

    def __init__(self, rows: int, wheelsets: int, every: int, period: float) -> None:
        room = math.ceil(LONGEST / (every * period)) + 2  # the first and the last sample
        self._samples = np.zeros((rows, room, 3 + 6 * wheelsets))
        self._count = np.zeros(rows, np.int64)
        self.place = RigNotes(every, room, self._samples.ctypes.data, self._count.ctypes.data)

    def history(self, row: int) -> StopHistory:
        """Return a copy of the history of the run in a row."""
        samples = self._samples[row, : self._count[row]].copy()
        of_each = np.split(samples[:, 3:], 6, axis=1)
        time, speed, distance = samples[:, :3].T
        turning, shown, effort, valve, creep, load = of_each
        return StopHistory(time, speed, distance, turning, shown, effort, valve.astype(np.int8), creep, load)
