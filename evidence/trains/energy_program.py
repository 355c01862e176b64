"""An independent program of least energy: a dynamic program over place and speed, with a price of time (an oracle).

It shares no code and no method with `products/train/speed_profile.py`: Bellman's recursion with 26 forces at each
state, values interpolated over the square of the speed, the price of time by bisection.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Least speed on the way [m/s], number of forces at a state, and steps of the bisection.
SLOWEST, FORCES, HALVINGS = 0.5, 24, 16
#: Value of a state from which the stop cannot be reached [J].
IMPOSSIBLE = 1e15


@dataclass(frozen=True)
class Journey:
    """A train from rest to rest: mass with rotating parts [kg], distance [m], largest deceleration [m/s2].

    pull, resisting: forces over speed [N].
    climbing: force of the gradient over the place of the front [N].
    allowed: largest speed over that place [m/s].
    electric: largest force of electric brakes over speed [N]; recovery: its share.
    """

    mass: float
    way: float
    deceleration: float
    pull: Callable[[Array], Array]
    resisting: Callable[[Array], Array]
    climbing: Callable[[Array], Array]
    allowed: Callable[[Array], Array]
    electric: Callable[[Array], Array] = np.zeros_like
    recovery: float = 0.0


class Program:
    """Values of a journey for a price of time [J/s], and the run from rest that they lead to."""

    def __init__(self, journey: Journey, cells: int, speeds: int) -> None:
        self.journey, self.cell = journey, journey.way / cells
        self.place = np.linspace(0.0, journey.way, cells + 1)
        most = journey.allowed(self.place) ** 2
        most[-1] = 0.0
        for i in range(cells - 1, -1, -1):  # braking curves
            most[i] = min(most[i], most[i + 1] + 2 * journey.deceleration * self.cell)
        self.most, self.share = most, np.linspace(0.0, 1.0, speeds) ** 1.5
        self.climb = journey.climbing((self.place[1:] + self.place[:-1]) / 2)

    def _pulled(self, i: int, square: Array, force: Callable[[Array], Array]) -> Array:
        """Return the squares after cell i with a force over the mean speed."""
        j, ends = self.journey, square
        for _ in range(4):
            mean = np.sqrt((ends + square) / 2)
            ends = np.maximum(square + 2 * self.cell / j.mass * (force(mean) - j.resisting(mean) - self.climb[i]), 0.0)
        return np.asarray(ends)

    def _choices(self, i: int, square: Array) -> tuple[Array, Array, Array]:
        """Return squares after cell i for each state and force, energy (infinite: not possible), and time."""
        j, h, square = self.journey, self.cell, square[:, None]
        low, high = np.maximum(square - 2 * j.deceleration * h, 0.0), self.most[i + 1]
        strong, coast = (np.clip(self._pulled(i, square, force), low, high) for force in (j.pull, np.zeros_like))
        ends = np.hstack([low + (strong - low) * np.linspace(0.0, 1.0, FORCES), coast, np.clip(square, low, strong)])
        mean = np.sqrt((ends + square) / 2)
        force = j.mass * (ends - square) / (2 * h) + j.resisting(mean) + self.climb[i]
        back = np.minimum(np.maximum(-force, 0.0), j.electric(mean))
        time = 2 * h / np.maximum(np.sqrt(ends) + np.sqrt(square), 1e-3)
        energy = h * (np.maximum(force, 0.0) - j.recovery * back)
        last = i + 2 == len(self.place)
        wrong = (ends > high + 1e-9) | (ends < (0.0 if last else SLOWEST**2))
        return ends, np.where(wrong, np.inf, energy), time

    def run(self, price: float) -> tuple[Array, float, float]:
        """Return the speeds [m/s], the energy [J] and the time [s] of the run of least energy + price x time."""
        count = len(self.place) - 1
        values = [np.zeros(1)] * (count + 1)
        values[count] = np.zeros(len(self.share))
        for i in range(count - 1, -1, -1):
            ends, energy, time = self._choices(i, self.share * self.most[i])
            total = energy + price * time + np.interp(ends, self.share * self.most[i + 1], values[i + 1])
            values[i] = np.minimum(total.min(axis=1), IMPOSSIBLE)
        square, used, taken, speeds = 0.0, 0.0, 0.0, [0.0]
        for i in range(count):
            ends, energy, time = self._choices(i, np.array([square]))
            total = energy + price * time + np.interp(ends, self.share * self.most[i + 1], values[i + 1])
            best = int(total[0].argmin())
            square, used, taken = float(ends[0, best]), used + energy[0, best], taken + time[0, best]
            speeds.append(np.sqrt(square))
        return np.array(speeds), used, taken


def least_energy_of(journey: Journey, due: float, cells: int = 150, speeds: int = 400) -> tuple[Array, Array, float]:
    """Return places [m], speeds [m/s], and the least energy [J] of a journey in a time [s].

    The energy of the run whose time is next to the due one, less the price of the difference: dE/dT is minus the price.
    """
    program = Program(journey, cells, speeds)
    low, high = 1e2, 1e7
    for _ in range(HALVINGS):
        price = np.sqrt(low * high)
        speed, energy, time = program.run(price)
        low, high = (price, high) if time > due else (low, price)
        if abs(time - due) < 2e-3 * due:
            break
    return program.place, speed, energy + price * (time - due)
