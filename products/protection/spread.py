"""Draws of a stop: phases and teeth of the sensors, and small spreads of friction and load.

All controllers get the same draws of a case (common random numbers): a draw depends on the seed, the case and its
number.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace

import numpy as np

from products.machine import Machine
from products.protection.runs import Run
from products.protection.settings import MOST_JITTER

#: Largest half width of a spread [1].
LARGEST_SPREAD = 0.5


@dataclass(frozen=True)
class Spread:
    """Spreads between the stops of a case; all numbers are assumed. Raises ValueError beyond the limits."""

    #: Half widths of the uniform spreads of the rail's friction and of the body's mass, as shares [1].
    friction: float = 0.03
    load: float = 0.02
    #: Standard deviation of the teeth's places, as a share of the pitch [1].
    jitter: float = 0.02

    def __post_init__(self) -> None:
        limits = {"friction": LARGEST_SPREAD, "load": LARGEST_SPREAD, "jitter": MOST_JITTER}
        for name, most in limits.items():
            if not 0.0 <= getattr(self, name) <= most:
                raise ValueError(f"The spread of {name} must be from 0 to {most:g}; got {getattr(self, name):g}.")


@dataclass(frozen=True)
class Draw:
    """One draw of a case: factors on friction and load [1], phases of the sensors [teeth], seed of their teeth."""

    friction: float
    load: float
    phases: tuple[float, ...]
    teeth: int

    def applied(self, run: Run, machine: Machine) -> Run:
        """Return the run with this draw."""
        body = f"{machine.counted}_mass"
        mass = run.values.get(body, machine.parameters.values()[body])
        frictions = {name: value * self.friction for name, value in run.values.items() if is_friction(name)}
        values = {**run.values, **frictions, body: mass * self.load}
        return replace(run, values=values, phases=self.phases, teeth=self.teeth)


def is_friction(name: str) -> bool:
    """Return whether a variable is the friction of the rail under a wheelset."""
    return name.removeprefix("friction_").isdecimal()


def draws_of(case: str, numbers: range, wheelsets: int, spread: Spread, seed: int) -> list[Draw]:
    """Return draws of a case by their numbers; the same for each controller, and in each longer range."""
    return [_draw(np.random.default_rng([seed, zlib.crc32(case.encode()), n]), wheelsets, spread) for n in numbers]


def _draw(random: np.random.Generator, wheelsets: int, spread: Spread) -> Draw:
    friction, load = (1.0 + half * random.uniform(-1.0, 1.0) for half in (spread.friction, spread.load))
    phases = tuple(random.uniform(0.0, 1.0, wheelsets).tolist())
    return Draw(friction, load, phases, 1 + int(random.integers(2**31)))
