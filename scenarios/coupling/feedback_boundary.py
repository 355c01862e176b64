"""Slip fed back to the brake through the master: the gain at which the loop becomes unstable, by theory and by FMUs.

The bogie is braked at a steady speed. A drawbar force, the pull of a gradient, balances the brake, so that the
undisturbed run is constant in time. The master lowers the pressure demand in proportion to the slip ratio of the
trailing wheelset, which carries less and slips first: demand = p0 - K (slip ratio - its steady value). The loop gain is
K times the slip ratio per steady change of pressure; at 1 the brake decreases as much as it was increased.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import bisect, brentq

from brake_controller.experiment import APPLICATION_TIME
from brake_controller.pneumatics import TIME_CONSTANTS_TO_95_PERCENT
from fmu_src.cosimulation.master import GAUSS_SEIDEL, Coupling, Master
from fmu_src.cosimulation.slave import FmuInstance
from fmu_src.kernel import Kernel
from products.bogie import BOGIE, TORQUE_PER_PRESSURE
from products.kernel_runs import prepare
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.braked_bogie import bogie_values, connections, start_brake
from scenarios.bench.mixed_train import held_exactly

SPEED = 20.0
#: Steady pressure [Pa]: half of the full brake, creep in its linear range.
PRESSURE = 90e3
TORQUE = PRESSURE * TORQUE_PER_PRESSURE
STEADY = {
    "brake_torque_1": TORQUE,
    "brake_torque_2": TORQUE,
    "drawbar_force": 2 * TORQUE / BOGIE.wheel_radius,
}
FEEDBACK = "slip_ratio_2"
#: Time after which the oscillations of the suspension have decayed [s].
SETTLING = 20.0
#: Distance from 1 of the eigenvalues of free place, rotation and speed.
NEUTRAL = 1e-4
#: Ratio of successive gains in the search for the boundary.
STRIDE = 1.1
#: Macro steps of a run that shows whether a disturbance grows, by comparing its last two quarters.
STEPS = 200
#: Share of a disturbance below which it has decayed: the residual may be the solvers' own errors.
DECAYED = 0.1
#: First disturbance: of the pressure at most, relative; and of the resulting demand, so that this stays small.
DISTURBANCE, ANSWER = 0.01, 0.05
#: Tested gains over the theoretical one, and resolution of the boundary.
GAINS, RESOLUTION = (0.5, 2.0), 0.003


@dataclass(frozen=True)
class Plant:
    """The bogie about its steady run: x' = A x + b T, slip ratio = c x; and slip ratio per steady torque [1/N.m]."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    steady_gain: float


def linear_bogie() -> Plant:
    """Return the plant from the exact Jacobian of the kernel in the FMU; b is exact too: the torque is a factor."""
    kernel = prepare("bogie", **bogie_values(SPEED), **STEADY)
    kernel.advance(SETTLING)
    names, place = list(planar_vehicle(two_axle_bogie(BOGIE)).states), kernel.linearise().state
    a = np.array(kernel.jacobian_at(kernel.time, place))
    b = _slopes(kernel, place, TORQUE + 1.0) - _slopes(kernel, place, TORQUE)
    c = np.array([kernel.directional([FEEDBACK], {f"state_{name}": 1.0})[0] for name in names])
    # A x = -b cannot be solved: the speed has no steady value. The slip ratio, which is independent of it, settles in
    # time.
    _, driven = held_exactly(a, b[:, None], SETTLING)
    return Plant(a, b, c, float(c @ driven[:, 0]))


def _slopes(kernel: Kernel, place: list[float], torque: float) -> np.ndarray:
    kernel.set(brake_torque_1=torque, brake_torque_2=torque)
    return np.array(kernel.slopes_at(kernel.time, place))


def loop_matrix(plant: Plant, method: str, step: float) -> Callable[[float], np.ndarray]:
    """Return one macro step of the closed loop by its gain: states of the bogie and torque of the brake.

    Inputs are constant in between (zero-order hold). The cylinder is a lag: T -> e T - (1 - e) gain / g c x. The bogie
    gets the torque at the start (Jacobi) or, after the brake's step, at the end of the step (Gauss-Seidel).
    """
    free, driven = held_exactly(plant.a, plant.b[:, None], step)
    decay = math.exp(-step * TIME_CONSTANTS_TO_95_PERCENT / APPLICATION_TIME)
    nothing = np.zeros(len(free))

    def matrix(gain: float) -> np.ndarray:
        brake = np.append(-(1.0 - decay) * gain / plant.steady_gain * plant.c, decay)
        torque = brake if method == GAUSS_SEIDEL else np.append(nothing, 1.0)
        return np.vstack([np.column_stack([free, nothing]) + driven * torque, brake])

    return matrix


def boundary_on_paper(plant: Plant, method: str, step: float) -> float:
    """Return the least loop gain at which a motion of the loop no longer decays: an eigenvalue of modulus 1."""
    matrix = loop_matrix(plant, method, step)

    def margin(gain: float) -> float:
        values = np.linalg.eigvals(matrix(gain))
        return float(np.abs(values[np.abs(values - 1.0) > NEUTRAL]).max()) - 1.0

    gain = 1.0
    while margin(gain * STRIDE) < 0.0:
        gain *= STRIDE
    return float(brentq(margin, gain, gain * STRIDE, rtol=1e-9))


def pressure_per_slip(plant: Plant) -> float:
    """Return K at loop gain 1 [Pa per slip ratio]."""
    return 1.0 / (plant.steady_gain * TORQUE_PER_PRESSURE)


@dataclass
class ClosedLoop:
    """Brake and bogie FMU on their steady run, for repeated disturbances; the bogie's steady state is saved."""

    brake: FmuInstance
    bogie: FmuInstance
    plant: Plant

    def __post_init__(self) -> None:
        self.bogie.restart(bogie_values(SPEED), time=-SETTLING, **STEADY)
        self.bogie.step(-SETTLING, SETTLING)
        self._state, self._slip = self.bogie.save(), self.bogie[FEEDBACK]

    def close(self) -> None:
        """Free the saved state."""
        self.bogie.forget(self._state)

    def answer(self, method: str, step: float, gain: float) -> np.ndarray:
        """Return the demand of the feedback above the steady pressure in each macro step [Pa], after one disturbance.

        The run ends early if the demand would become negative.
        """
        self.bogie.restore(self._state)
        start_brake(self.brake, PRESSURE * (1.0 + min(DISTURBANCE, ANSWER / gain)))
        slope, asked = gain * pressure_per_slip(self.plant), []
        coupling = Coupling([self.brake, self.bogie], connections(self.brake, self.bogie), Master(method))
        for number in range(STEPS):
            asked.append(-slope * (self.bogie[FEEDBACK] - self._slip))
            if abs(asked[-1]) > PRESSURE:
                break
            self.brake.set(pressure_demand=PRESSURE + asked[-1])
            coupling.step(number * step, step)
        return np.array(asked)

    def grows(self, method: str, step: float, gain: float) -> bool:
        """Return whether the disturbance grows from step to step; second differences exclude slow swaying."""
        asked = self.answer(method, step, gain)
        if len(asked) < STEPS:
            return True
        first, _, before, last = (np.abs(part).max() for part in np.array_split(np.diff(asked, 2), 4))
        return bool(last > max(before, DECAYED * first))

    def boundary(self, method: str, step: float) -> float:
        """Return the least loop gain with which a small disturbance grows, by bisection."""
        paper = boundary_on_paper(self.plant, method, step)

        def sign(factor: float) -> float:
            return 1.0 if self.grows(method, step, factor * paper) else -1.0

        return paper * float(bisect(sign, *GAINS, xtol=RESOLUTION))
