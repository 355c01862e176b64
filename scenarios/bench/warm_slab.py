"""A rim or disc as a slab that the block heats on one side: how much its surface is warmer than a lump."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from products.train.heat_columns import BODIES

#: Cells of a slab, and step relative to the longest stable one.
CELLS, SHARE = 40, 0.4


@dataclass(frozen=True)
class Slab:
    """A slab: thickness [m], rubbed area [m2], conductivity [W/(m.K)], density [kg/m3], capacity [J/(kg.K)]."""

    thickness: float
    area: float
    conductivity: float
    density: float
    capacity: float

    @classmethod
    def of_body(cls, body: int, thickness: float, area: float) -> Slab:
        """Return a rim or disc with the material that trains have, `BODIES`."""
        own = BODIES[body]
        return cls(thickness, area, own.conductivity, own.density, own.capacity)

    @property
    def settles(self) -> float:
        """Return the time after which the surface follows the mean, L^2 rho c / k [s]."""
        return self.thickness**2 * self.density * self.capacity / self.conductivity

    def excess(self, power: float) -> float:
        """Return the surface above the mean after a long time [K]: q L / (3 k), with an insulated back."""
        return power / self.area * self.thickness / (3 * self.conductivity)

    def early_excess(self, power: float, time: float) -> float:
        """Return the surface above the mean before heat reaches the back [K].

        2 q sqrt(t / (pi k rho c)) - q t / (rho c L), the half space of Carslaw and Jaeger (1959).
        """
        flux, capacity = power / self.area, self.density * self.capacity
        root = math.sqrt(time / (math.pi * self.conductivity * capacity))
        return flux * (2 * root - time / (capacity * self.thickness))

    def conducted(
        self, power: float | Callable[[float], float], time: float, cells: int = CELLS
    ) -> NDArray[np.float64]:
        """Return times [s] and the surface above the mean [K] by finite volumes, explicit in time.

        power: heat that flows in [W], or a function of the time [s].
        """
        size, capacity = self.thickness / cells, self.density * self.capacity
        steps = math.ceil(time / (SHARE * size**2 * capacity / self.conductivity))
        step = time / steps
        warm, found = np.zeros(cells), np.zeros((steps + 1, 2))
        given = power if callable(power) else lambda _: power
        for number in range(1, steps + 1):
            flux = given((number - 0.5) * step) / self.area
            flow = np.concatenate([[flux], -self.conductivity / size * np.diff(warm), [0.0]])
            warm += step / (capacity * size) * -np.diff(flow)
            face = (
                given(number * step) / self.area * size / (2 * self.conductivity)
            )  # from the middle of the first cell
            found[number] = number * step, warm[0] + face - warm.mean()
        return found
