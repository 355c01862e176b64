"""The rim of a wheel as a slab that the block heats on one side: how much its tread is warmer than a lump."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from products.train.stated_heat import STEEL

#: Conductivity [W/(m.K)] and density [kg/m3] of steel.
CONDUCTIVITY, DENSITY = 45.0, 7850.0
#: Cells of the slab, and step relative to the longest stable one.
CELLS, SHARE = 40, 0.4


@dataclass(frozen=True)
class Rim:
    """A rim: thickness [m], width of the rubbed band [m], diameter of the wheel [m]. All assumed."""

    thickness: float = 0.05
    width: float = 0.08
    diameter: float = 0.92

    @property
    def area(self) -> float:
        """Return the rubbed area [m2]."""
        return math.pi * self.diameter * self.width

    @property
    def settles(self) -> float:
        """Return the time after which the tread follows the mean, L^2 rho c / k [s]."""
        return self.thickness**2 * DENSITY * STEEL / CONDUCTIVITY

    def excess(self, power: float) -> float:
        """Return the tread above the mean of the rim after a long time [K]: q L / (3 k), with an insulated back."""
        return power / self.area * self.thickness / (3 * CONDUCTIVITY)

    def early_excess(self, power: float, time: float) -> float:
        """Return the tread above the mean of the rim before heat reaches its back [K].

        2 q sqrt(t / (pi k rho c)) - q t / (rho c L), the half space of Carslaw and Jaeger (1959).
        """
        flux, capacity = power / self.area, DENSITY * STEEL
        return flux * (2 * math.sqrt(time / (math.pi * CONDUCTIVITY * capacity)) - time / (capacity * self.thickness))

    def conducted(self, power: float, time: float) -> NDArray[np.float64]:
        """Return times [s] and the tread above the mean [K] by finite volumes, explicit in time."""
        size, capacity = self.thickness / CELLS, DENSITY * STEEL
        steps = math.ceil(time / (SHARE * size**2 * capacity / CONDUCTIVITY))
        step, flux = time / steps, power / self.area
        warm, found = np.zeros(CELLS), np.zeros((steps + 1, 2))
        for number in range(1, steps + 1):
            flow = np.concatenate([[flux], -CONDUCTIVITY / size * np.diff(warm), [0.0]])
            warm += step / (capacity * size) * -np.diff(flow)
            tread = warm[0] + flux * size / (2 * CONDUCTIVITY)  # from the middle of the first cell to its face
            found[number] = number * step, tread - warm.mean()
        return found
