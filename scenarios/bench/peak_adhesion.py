"""The most that a rail can give: what a stop with the best slip at every instant would take."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp

from fmu_src.kernel import Kernel
from products.protection.braked_machine import APPLICATION_TIME, STANDING, Machine
from products.protection.braked_system import Kind, machine_kernel, machine_model
from products.protection.protected_stop import BRAKE_START, LONGEST, ProtectedStop
from products.protection.rails import ABOVE
from rbd_model.levels.resistance import curve_share


def by_time(since: float) -> float:
    """Share of the full pressure so long after the demand [s], by the timed law of section 2.4.2."""
    return 1.0 - 20.0 ** (-max(0.0, since) / APPLICATION_TIME)


def laden(machine: Machine, values: Mapping[str, float]) -> Machine:
    """With the mass that its body, the counted one, has among these values."""
    name = f"{machine.counted}_mass"
    empty = machine.parameters.values()[name]
    return replace(machine, mass=machine.mass + values.get(name, empty) - empty)


def held_back(rail: Mapping[str, float]) -> float:
    """Share of the weight that a gradient and a curve (rbd_model/levels/resistance.py) hold back beside the brakes."""
    curve = float(ca.evalf(curve_share(ca.SX(abs(rail.get("curvature", 0.0))))))
    return math.sin(math.atan(rail.get("gradient", 0.0))) + rail.get("curve_resistance", 0.0) * curve


class PeakAdhesion:
    """Largest deceleration that a rail can give, from a machine's own equations: the creep force at its best slip.

    In the plane. rail: inputs and parameters of the machine with its cylinders, as `Run` has them.
    filling: share of the full pressure so long after the demand [s].
    """

    #: Slip ratios that are tried, and instants of a stop that are looked at.
    SLIPS, INSTANTS = np.geomspace(2e-3, 0.4, 28), 50

    def __init__(
        self, machine: Machine, rail: Mapping[str, float], filling: Callable[[float], float] = by_time
    ) -> None:
        self.machine, self.filling = laden(machine, rail), filling
        self.held_back = machine.parameters.gravity * held_back(rail)
        kind = Kind(machine.counted, by_flow=True)
        self.kernel = Kernel(machine_kernel(kind), initial_speed=25.0, **rail)
        self.kernel.initialise()
        self.states = list(machine_model(kind).systems[0].states)
        self.place = np.array(self.kernel.linearise().state)

    def at(self, distance: float, speed: float, slip: float) -> float:
        """Deceleration [m/s2] with all wheelsets at a slip ratio, their loads those at rest."""
        place, machine = self.place.copy(), self.machine
        place[self.states.index(f"{machine.counted}_distance")] = distance
        place[self.states.index(f"{machine.counted}_speed")] = speed
        for number in machine.numbers:
            rolling = speed / machine.parameters.wheel_radius
            place[self.states.index(f"angular_velocity_{number}")] = (1.0 - slip) * rolling
        self.kernel.arrive(self.kernel.time, place.tolist())
        return -sum(self.kernel[f"creep_force_{number}"] for number in machine.numbers) / machine.mass

    def best(self, distance: float, speed: float) -> tuple[float, float]:
        """Largest deceleration [m/s2], and the slip ratio at which it is reached."""
        found = [self.at(distance, speed, slip) for slip in self.SLIPS]
        return max(found), float(self.SLIPS[int(np.argmax(found))])

    def stopping_distance(self, speed: float, strength: float = 1.0) -> float:
        """Distance [m] from `speed` with the best slip wherever the brake, as it fills, asks for as much.

        strength: torque over that of the full brake.

        Where it asks for less than the rail gives, it is the brake's distance and says nothing of the rail: see `used`.

        Raises ValueError where the rail stops nothing within the longest time of a stop.
        """

        def slope(time: float, state: np.ndarray) -> list[float]:
            most = self.best(state[0], max(state[1], STANDING))[0]
            return [state[1], -min(strength * self.braking(time), most) - self.held_back]

        def stands(time: float, state: np.ndarray) -> float:
            return float(state[1]) - STANDING

        stands.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(slope, (0.0, LONGEST), [0.0, speed], events=stands, max_step=0.25, rtol=1e-3, atol=1e-2)
        if not found.t_events[0].size:
            raise ValueError(f"Give a rail that stops the vehicle from {speed:g} m/s within {LONGEST:g} s: it did not.")
        return float(found.y[0, -1])

    def used(self, stop: ProtectedStop) -> np.ndarray:
        """Braking force over the largest that the rail gives at that speed and place, shape (INSTANTS,).

        From the first to the last instant at which the machine was braked and faster than ABOVE.
        """
        time, speed = stop.series["time"], stop.series["speed"]
        way = np.concatenate([[0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * np.diff(time))])
        looked_at = np.flatnonzero(stop.braked(ABOVE))
        instants = looked_at[np.linspace(0, looked_at.size - 1, self.INSTANTS).astype(int)]
        largest = [self.machine.mass * self.best(way[i], speed[i])[0] for i in instants]
        return np.asarray(stop.series["braking_force"][instants] / largest)

    def braking(self, time: float) -> float:
        """Deceleration that the filling brake allows [m/s2]."""
        return self.filling(time - BRAKE_START) * self.machine.deceleration(self.machine.full_torque)
