"""A brake pipe: air in cells, the connected vehicles, the conditions at its ends, and its balances."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brake_controller.air import AMBIENT, GAS_CONSTANT, HEAT_CAPACITY_RATIO
from brake_controller.distributors import DISTRIBUTORS, kind_of
from brake_controller.distributors.distributor import DistributorParameters
from products.train.layout import BRAKE_MODELS
from products.train.library import OutsideInC, PassedInC, functions

#: Step size relative to the travel time of a wave through a cell [1]; above 1 the method is unstable.
COURANT = 0.8


@dataclass(frozen=True)
class EndConditions:
    """Conditions outside an end: effective opening [m2], 0 closed; absolute pressure [Pa] and temperature [K]."""

    opening: float = 0.0
    pressure: float = 101325.0
    temperature: float = 293.15


def pace_of(
    distributors: Sequence[DistributorParameters], cells: Sequence[int], volume: NDArray[np.float64], brake_model: str
) -> float:
    """Return the largest rate at which a state of distributors at these cells comes to rest [1/s].

    The pipe and what it fills come to rest together, at the sum of their rates. volume: of all cells [m3].
    """
    paces = {one: kind_of(one).fastest(one, brake_model) for one in set(distributors)}
    drawn = np.zeros(volume.size)
    np.add.at(drawn, list(cells), [kind_of(one).drawn(one) for one in distributors])
    return max(paces[one] + drawn[cell] / volume[cell] for one, cell in zip(distributors, cells, strict=True))


class PipeAir:
    """The air in a pipe computed by the C library at `own`; volume: of its cells [m3]; kinds: of its distributors."""

    def __init__(self, library: ctypes.CDLL, own: int, volume: NDArray[np.float64], kinds: Sequence[int] = ()) -> None:
        self._call, self.own, self.volume, self.kinds = library, own, volume, list(kinds)

    @property
    def state(self) -> NDArray[np.float64]:
        """Density [kg/m3], momentum [kg/(m2.s)] and energy [J/m3], shape (3, cells)."""
        found = np.empty((3, self.volume.size))
        self._call.pipe_state(self.own, found.ctypes.data)
        return found

    @property
    def pressure(self) -> NDArray[np.float64]:
        """Absolute pressure [Pa], shape (cells,)."""
        density, momentum, energy = self.state
        return (HEAT_CAPACITY_RATIO - 1) * (energy - momentum**2 / density / 2)

    @property
    def temperature(self) -> NDArray[np.float64]:
        """Temperature [K], shape (cells,)."""
        return self.pressure / (self.state[0] * GAS_CONSTANT)

    @property
    def speed(self) -> NDArray[np.float64]:
        """Speed [m/s], shape (cells,)."""
        density, momentum, _ = self.state
        return momentum / density

    @property
    def mass(self) -> float:
        """Mass of the air in the pipe [kg]."""
        return float(self.state[0] @ self.volume)

    @property
    def energy(self) -> float:
        """Internal and kinetic energy of the air in the pipe [J]."""
        return float(self.state[2] @ self.volume)

    @property
    def passed(self) -> PassedInC:
        """Mass [kg] and energy [J] that have left since the start: through ends, by leaks, to vehicles.

        heat: from the walls [J]; cylinder_mass: air that cylinders took [kg].
        """
        passed_in_c = PassedInC()
        ctypes.pointer(passed_in_c)[0] = self._call.pipe_has_passed(self.own).contents
        return passed_in_c

    def vehicle_pressures(self, name: str) -> NDArray[np.float64]:
        """Return absolute pressures of a state of the distributors [Pa], shape (vehicles,).

        NaN without such a state.
        """
        found, kinds = np.full(len(self.kinds), np.nan), np.array(self.kinds)
        for number, kind in enumerate(DISTRIBUTORS.values()):
            names, own = [state for state, _ in kind.states], np.flatnonzero(kinds == number)
            states = np.empty((len(names), own.size))
            self._call.pipe_vehicle_states(self.own, number, states.ctypes.data)
            if name in names:
                found[own] = states[names.index(name)]
        return found


class Pipe(PipeAir):
    """Air in a row of cells.

    pressure [Pa, absolute], temperature [K], speed [m/s], length [m], diameter [m, the same in all], wall temperature
    [K], leak area [m2] (effective), volume of branches as a length of pipe [m]: a number, or one for each cell.
    friction, heat: factors on friction and heat of the wall; heat 0 is adiabatic, a large value isothermal.
    """

    def __init__(
        self,
        cells: int,
        *,
        pressure: ArrayLike,
        length: ArrayLike,
        diameter: float,
        temperature: ArrayLike = 293.15,
        speed: ArrayLike = 0.0,
        wall_temperature: ArrayLike = 293.15,
        friction: float = 1.0,
        heat: float = 1.0,
        leak_area: ArrayLike = 0.0,
        ambient_pressure: float = 101325.0,
        branch: ArrayLike = 0.0,
    ) -> None:
        def row(values: ArrayLike) -> NDArray[np.float64]:
            return np.broadcast_to(np.asarray(values, float), (cells,))

        if cells < 1 or cells != int(cells):
            raise ValueError(f"The number of cells of a pipe must be an integer of at least 1; got {cells}.")
        self.cells, self.area = cells, np.pi / 4 * diameter**2
        density = row(pressure) / (GAS_CONSTANT * row(temperature))
        momentum = density * row(speed)
        energy = row(pressure) / (HEAT_CAPACITY_RATIO - 1) + momentum * row(speed) / 2
        given = [length, diameter, wall_temperature, friction, heat, leak_area, ambient_pressure, branch]
        constants = np.array([row(one) for one in given])
        above = {"pressure": pressure, "temperature": temperature, "length": length, "diameter": diameter}
        above |= {"wall_temperature": wall_temperature, "ambient_pressure": ambient_pressure}
        least = {"friction": friction, "heat": heat, "leak_area": leak_area, "branch": branch}
        for name, values in (above | least).items():
            good = row(values) > 0.0 if name in above else row(values) >= 0.0
            if not (good & np.isfinite(row(values))).all():
                limit = "above 0" if name in above else "at least 0"
                wrong = row(values)[~(good & np.isfinite(row(values)))][0]
                raise ValueError(f"{name} of a pipe must be finite and {limit}; got {wrong:g}.")
        state, library = np.array([density, momentum, energy]), functions()
        own = library.pipe_create(cells, state.ctypes.data, constants.ctypes.data)
        super().__init__(library, own, np.pi / 4 * constants[1] ** 2 * (constants[0] + constants[7]))
        if not self.own:
            raise MemoryError(f"There is no memory for {cells} cells; take fewer.")
        weakref.finalize(self, self._call.pipe_free, self.own)
        self.steps, self.kinds = 0, list[int]()

    def connect(self, cells: Sequence[int], distributors: Sequence[DistributorParameters], pressure: float) -> None:
        """Connect vehicles to these cells, charged to an absolute pressure [Pa]; their cylinders are empty.

        Takes pressure [Pa].
        """
        places = np.array(cells, np.int64)
        if not (places.size == len(distributors) and places.size and places.min() >= 0 and places.max() < self.cells):
            raise ValueError(f"Each distributor must have one of the cells 0 to {self.cells - 1}; got {list(cells)}.")
        known = list(DISTRIBUTORS.values())
        kinds = [kind_of(distributor) for distributor in distributors]
        self.kinds = [known.index(kind) for kind in kinds]
        given = [np.array([list(one.values().values()) for one in distributors if kind_of(one) is k]).T for k in known]
        given = [one.copy() for one in given]
        rows = (ctypes.c_void_p * len(known))(*(one.ctypes.data for one in given))
        pace = pace_of(distributors, cells, self.volume, "whole")
        own, whole = np.array(self.kinds, np.int64), BRAKE_MODELS["whole"]
        if not self._call.pipe_vehicles(
            self.own, len(cells), own.ctypes.data, places.ctypes.data, None, rows, whole, pace
        ):
            raise MemoryError(f"There is no memory for {len(cells)} vehicles; take fewer.")
        self._call.pipe_charge(self.own, pressure, AMBIENT, AMBIENT)

    def open_to(self, end: int, outside: EndConditions) -> None:
        """Set the conditions outside an end, 0 or 1. Raises ValueError if the end does not exist."""
        if end not in (0, 1):
            raise ValueError(f"The end of a pipe must be 0 or 1; got {end}.")
        outside_in_c = OutsideInC(outside.opening, self.area, outside.pressure, outside.temperature)
        self._call.pipe_end(self.own, end, outside_in_c)

    def advance(self, time: float, courant: float = COURANT) -> None:
        """Advance by a time [s]. Raises ValueError if the state is not finite; the pipe keeps its last state then.

        courant: step size relative to the travel time of a wave through a cell; above 1 the result is wrong.
        """
        if not (0.0 <= time < np.inf and courant > 0.0):
            raise ValueError(f"The time must be at least 0 s, and courant above 0; got {time} s and {courant}.")
        steps = self._call.pipe_advance(self.own, time, courant)
        if steps < 0:
            raise ValueError(f"The air in the pipe came to no finite pressure above 0 within {time:g} s.")
        self.steps += steps
