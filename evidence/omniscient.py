"""A controller that is shown everything: how short a stop the valves of the rig allow at least.

It reads the true speeds, pressures and creep forces of the model, and the best slip of the rail in advance. A run is
repeated with several gains, and the shortest stop counts. All stops are those of the full model, so each distance can
be reached. The shortest possible one lies between it and that of `PeakAdhesion`, which needs no valves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brake_controller.wheel_slide import APPLY, HOLD, VENT
from products.controller_kinds import Outside
from products.machine import Machine, filling_by_flow, filling_by_time
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.rig import Loop, Rig
from products.protection.rig_in_c import DONE, RUNS
from products.protection.runs import Run, Stop
from products.protection.settings import Settings

Numbers = NDArray[np.float64]
#: Speeds at which the best slip of a rail is computed [m/s].
SPEEDS = np.array([0.3, 1.0, 2.0, 4.0, 8.0, 15.0, 25.0, 40.0, 60.0])


@dataclass(frozen=True)
class Gains:
    """Slip over the best one [1], time to it, time by which pressures are anticipated [s], band of the pressure [1].

    The band is a share of the full pressure, in which it is held.
    """

    slip: float
    time: float
    lead: float
    band: float


#: Those of which the best is chosen for each run.
TRIED = tuple(
    Gains(slip, time, lead, 0.015)
    for slip, time, lead in (
        *((slip, 0.15, 0.02) for slip in (0.5, 0.8, 1.3, 2.0)),
        (0.8, 0.15, 0.06),
        (1.3, 0.15, 0.06),
        (1.3, 0.4, 0.02),
    )
)
#: Longest accepted lock of a wheelset [s].
LONGEST_LOCK = 0.3
#: A stop this much longer than the shortest one of its run is not finished [1].
FAR_BEHIND = 1.1


def best_slips(peak: PeakAdhesion, place: float) -> Numbers:
    """Return the best slip [1] at a place [m] for each of SPEEDS."""
    return np.array([peak.best(place, speed)[1] for speed in SPEEDS])


class Omniscient:
    """Commands of many rows from the true outputs of their vehicles.

    inside, outside: best slips for each of SPEEDS with the patch of the rail and without it, shape (rows, speeds).
    patch: its first and last place [m], shape (rows, 2).
    """

    def __init__(
        self, machine: Machine, gains: Sequence[Gains], outside: Numbers, inside: Numbers, patch: Numbers
    ) -> None:
        p, self.machine = machine.parameters, machine
        self.radius, self.inertia = p.wheel_radius, p.wheelset_pitch_inertia
        self.per_torque = machine.full_pressure / machine.full_torque
        self.gains = {name: np.array([[getattr(gain, name)] for gain in gains]) for name in Gains.__annotations__}
        self.slips, self.patch = np.stack([outside, inside]), patch
        self.before: tuple[Numbers, Numbers] | None = None

    def wanted_slip(self, speed: Numbers, place: Numbers) -> Numbers:
        """Return the slip speed to aim at [m/s]; place: of each wheelset [m]."""
        at = np.clip(np.searchsorted(SPEEDS, speed) - 1, 0, len(SPEEDS) - 2)
        share = np.clip((speed - SPEEDS[at]) / (SPEEDS[at + 1] - SPEEDS[at]), 0.0, 1.0)
        rows = np.arange(len(speed))
        both = self.slips[:, rows, at] * (1.0 - share) + self.slips[:, rows, at + 1] * share
        inside = (place >= self.patch[:, :1]) & (place <= self.patch[:, 1:])
        return np.asarray(self.gains["slip"] * np.where(inside, both[1][:, None], both[0][:, None]) * speed[:, None])

    def commands(self, shown: Numbers, period: float) -> NDArray[np.int32]:
        """Return the commands (rows, wheelsets) from the outputs of the rig's vehicles."""
        n = len(self.machine.numbers)
        speed, place = np.maximum(shown[:, 0], 0.0), shown[:, 1]
        omega, pressure, creep = (shown[:, 2 + k * n : 2 + (k + 1) * n] for k in (1, 2, 3))
        before, self.before = self.before or (speed, pressure), (speed.copy(), pressure.copy())
        slows = np.clip((before[0] - speed) / period, 0.0, 5.0)[:, None]
        slip = speed[:, None] - self.radius * omega
        gap = self.wanted_slip(speed, np.repeat(place[:, None], n, axis=1)) - slip
        wanted_rate = np.clip(gap / self.gains["time"], -20.0, 20.0)
        torque = -creep * self.radius + self.inertia / self.radius * (slows + wanted_rate)
        coming = pressure + (pressure - before[1]) / period * self.gains["lead"]
        missing = (torque * self.per_torque - coming) / self.machine.full_pressure
        band = self.gains["band"]
        return np.where(missing > band, APPLY, np.where(missing < -band, VENT, HOLD)).astype(np.int32)


def of_all(machine: Machine, runs: Sequence[Run], settings: Settings, by_flow: bool) -> list[list[Stop]]:
    """Return the stops of each run with each of TRIED."""
    slips = []
    filling = filling_by_flow(machine.full_pressure) if by_flow else filling_by_time()
    for run in runs:
        peak = PeakAdhesion(machine, run.values, filling)
        edge = run.values.get("patch_start", 0.0)
        slips.append((best_slips(peak, edge - 1e3), best_slips(peak, edge + 1.0)))
    rig = Rig(machine, Outside(), settings, by_flow=by_flow)
    every = [(run, gains, slip) for run, slip in zip(runs, slips, strict=True) for gains in TRIED]
    begins = np.array([run.values.get("patch_start", 0.0) for run, *_ in every])
    lengths = np.array([run.values.get("patch_length", 0.0) for run, *_ in every])
    controller = Omniscient(
        machine,
        [gains for _, gains, _ in every],
        np.array([slip[0] for *_, slip in every]),
        np.array([slip[1] for *_, slip in every]),
        np.stack([begins, begins + lengths], axis=1),
    )
    values = [rig.values(run) for run, *_ in every]
    first = {variable.name: variable.start for variable in rig.model.variables}
    names = sorted({name for value in values for name in value})
    start = {name: [one.get(name, first[name]) for one in values] for name in names}
    with rig.instances(len(every), start) as instances, Loop(rig, instances) as loop:
        loop.begin({row: rig.beginning(run) for row, (run, *_) in enumerate(every)})
        while _goes_on(loop.score, len(TRIED)):
            loop.valves[:] = controller.commands(instances.output_values, settings.period)
            loop.turn()
        stops = [loop.stop(row) for row in range(len(every))]
    return [stops[i * len(TRIED) : (i + 1) * len(TRIED)] for i in range(len(runs))]


def _goes_on(score: NDArray[Any], each: int) -> bool:
    """Return whether a row still moves that can become the shortest of the `each` rows of its run."""
    state, distance = score["state"].reshape(-1, each), score["distance"].reshape(-1, each)
    best = np.where(state == DONE, distance, np.inf).min(axis=1, keepdims=True)
    return bool(np.any((state == RUNS) & (distance < FAR_BEHIND * best)))


def shortest(stops: Sequence[Stop]) -> Stop:
    """Return the shortest of the stops without a lock above LONGEST_LOCK, or else the shortest."""
    return min(stops, key=lambda one: (one.longest_lock > LONGEST_LOCK, one.distance or np.inf))
