"""Stops of many vehicles whose valves are set period by period, for learning environments."""

from __future__ import annotations

import math
import weakref
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brake_controller.wheel_slide import APPLY, VENT
from products.controller_kinds import Outside
from products.machine import Machine
from products.protection.cost import cost, cost_of_no_stop, rolling_stop
from products.protection.rig import Loop, Rig, as_commands
from products.protection.rig_in_c import LOST, RUNS, TOO_LONG
from products.protection.runs import Run, Stop
from products.protection.settings import BRAKE_START, FASTEST, LONGEST, Settings

Numbers = NDArray[np.float64]
#: Draws a stop of a vehicle with this number of wheelsets.
DrawsRun = Callable[[np.random.Generator, int], Run]
#: Largest ratio of a sensor's reading to the true speed: a failure doubles it, a wrong radius does, and teeth have
#: errors.
TOO_FAST = 5.0
#: Longest default step of the integration [s].
LONGEST_STEP = 5e-3
#: Entries of a privileged observation about the rail, in addition to the friction under each wheelset.
PATCH = ("patch_friction", "patch_start", "patch_length")


class Environment:
    """Rows of one vehicle, each with a stop; call `close` or delete it.

    A row observes the speeds of its sensors [m/s], the last command of each valve, and the time since the brake demand
    [s]. A privileged observation also has the true speed [m/s], the distance [m], each slip between -1 and 1, the
    friction of the rail under each wheelset without its patch, and the entries of PATCH. `limits` are the least and the
    largest value of each entry, shape (2, entries).

    After a period, `observation` has the shape (rows, entries), and `reward`, `terminated` and `truncated` have the
    shape (rows,): new arrays each time. The rewards of a stop add up to its cost (cost.py), below 0.

    step: integration step [s]; by default the longest up to LONGEST_STEP of which a period is a multiple.
    """

    def __init__(
        self,
        machine: Machine,
        settings: Settings,
        count: int,
        draw: DrawsRun,
        privileged: bool = False,
        threads: int | None = None,
        step: float | None = None,
    ) -> None:
        self.machine, self.settings, self._draw, self._privileged = machine, settings, draw, privileged
        step = step or settings.period / math.ceil(settings.period / LONGEST_STEP)
        self._rig = Rig(machine, Outside(), settings, step=step, threads=threads)
        stack = ExitStack()
        self.close = weakref.finalize(self, stack.close)
        self._instances = stack.enter_context(self._rig.instances(count, self._rig.values(Run({}))))
        self._loop = stack.enter_context(Loop(self._rig, self._instances))
        self.runs: list[Run] = [Run({})] * count
        self._rolling = np.ones(count, [(name, float) for name in ("distance", "duration")])
        self._cost, self.reward = np.zeros(count), np.zeros(count)
        self.terminated, self.truncated = np.zeros(count, bool), np.zeros(count, bool)
        n = len(machine.numbers)
        self._names = [f"friction_{number}" for number in machine.numbers] + list(PATCH)
        self._rail = np.zeros((count, len(self._names)))
        self.limits = self._limits(n)

    def _limits(self, n: int) -> Numbers:
        most = [*n * [TOO_FAST * FASTEST], *n * [float(VENT)], LONGEST]
        least = [*n * [0.0], *n * [float(APPLY)], 0.0]
        if self._privileged:
            of = {variable.name: variable for variable in self._rig.model.variables}
            most += [FASTEST, FASTEST * LONGEST, *n * [1.0], *(of[name].maximum for name in self._names)]
            least += [0.0, 0.0, *n * [-1.0], *(of[name].minimum for name in self._names)]
        return np.array([least, most])

    def __len__(self) -> int:
        return len(self.runs)

    def begin(self, rows: Sequence[int], randoms: Sequence[np.random.Generator]) -> None:
        """Begin stops in these rows, each drawn with its own random numbers."""
        drawn = {row: self._drawn(random) for row, random in zip(rows, randoms, strict=True)}
        beginnings = {row: self._rig.beginning(run) for row, run in drawn.items()}
        for row, run in drawn.items():
            values = self._rig.values(run)
            self._instances.reset(row, **values)
            self.runs[row] = run
            self._rail[row] = [values.get(name, self._rig.first[name]) for name in self._names]
            brake_ratio = self.settings.brake_ratio if run.brake_ratio is None else run.brake_ratio
            rolling = rolling_stop(
                self.machine, replace(self.settings, brake_ratio=brake_ratio), values["initial_speed"]
            )
            self._rolling[row] = rolling.distance, rolling.duration
            self._cost[row] = self.reward[row] = 0.0
            self.terminated[row] = self.truncated[row] = False
        self._loop.begin(beginnings)
        self.observation = self._seen()

    def _drawn(self, random: np.random.Generator) -> Run:
        run = self._draw(random, len(self.machine.numbers))
        if not isinstance(run, Run):
            raise TypeError(f"rails must return a Run; got a {type(run).__name__}.")
        speed = self._rig.values(run)["initial_speed"]
        if not 0.0 < speed <= FASTEST:
            raise ValueError(f"A drawn speed must be above 0 and at most {FASTEST:g} m/s; got {speed}.")
        return run

    def turn(self, commands: ArrayLike) -> None:
        """Advance by one period. commands: shape (rows, wheelsets), 0 apply, 1 hold, 2 vent; ended rows do not change.

        Raises ValueError if the commands are invalid, before anything moves.
        """
        given = np.asarray(commands)
        if given.shape != self._loop.valves.shape:
            raise ValueError(f"commands must have the shape {self._loop.valves.shape}; got {given.shape}.")
        taken, good = as_commands(given)
        if not good.all():
            row = int(np.argmin(good))
            raise ValueError(
                f"Each valve must be 0 (apply), 1 (hold) or 2 (vent); got {given[row].tolist()} in row {row}."
            )
        self._loop.valves[:] = taken
        self._loop.turn()
        self.observation = self._seen()
        self._judge()

    def _seen(self) -> Numbers:
        loop, n = self._loop, len(self.machine.numbers)
        seen = np.empty((len(self), self.limits.shape[1]))
        seen[:, :n], seen[:, n : 2 * n] = loop.speeds, loop.valves
        np.maximum(loop.time - BRAKE_START, 0.0, out=seen[:, 2 * n])
        if self._privileged:
            shown, end = self._instances.output_values, 2 * n + 1
            speed, rolls = shown[:, :1], self.machine.parameters.wheel_radius * shown[:, 2 + n : 2 + 2 * n]
            seen[:, end : end + 2] = np.maximum(shown[:, :2], 0.0)
            seen[:, end + 2 : end + 2 + n] = np.clip((speed - rolls) / np.maximum(np.abs(speed), 1e-9), -1.0, 1.0)
            seen[:, end + 2 + n :] = self._rail
        return seen

    def _judge(self) -> None:
        """Compute the reward of the period, and which stops it has ended."""
        score = self._loop.score
        state = score["state"]
        before, self._cost = self._cost, cost(score, self._rolling, self.machine, self.settings.period)
        self.truncated, self.terminated = state == TOO_LONG, (state != RUNS) & (state != TOO_LONG)
        without = self.truncated | (state == LOST)
        if without.any():
            of = score[without]
            self._cost[without] += cost_of_no_stop(of["speed"], of["time"], self._rolling["distance"][without])
        self.reward = before - self._cost

    def stop(self, row: int) -> Stop:
        """Return the result of the stop in a row."""
        return self._loop.stop(row)
