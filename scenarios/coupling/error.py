"""A stop by coupled FMUs against the same stop by one solver, over the macro step; and the theoretical error."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from brake_controller.experiment import APPLICATION_TIME
from brake_controller.pneumatics import TIME_CONSTANTS_TO_95_PERCENT
from fmu_src.cosimulation.master import GAUSS_SEIDEL, JACOBI, Coupling, Master
from fmu_src.cosimulation.slave import FmuInstance
from products.bogie import BOGIE, FULL_PRESSURE, FULL_TORQUE
from products.kernel_runs import prepare
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.braked_bogie import acceleration_per_torque, bogie_values, connections, start_brake

MASTERS = {
    "Jacobi, held": Master(JACOBI),
    "Gauss-Seidel, held": Master(GAUSS_SEIDEL),
    "Jacobi, lines": Master(JACOBI, extrapolated=True),
    "Gauss-Seidel, lines": Master(GAUSS_SEIDEL, extrapolated=True),
}
#: Surplus of the torque's impulse on the bogie, in units of h (T - T(0)) with zero-order hold, h^2 (T' - T'(0)) with
#: linear extrapolation. It is that of the torque at the start or at the end of each step, of a tangent, or of the chord
#: of the trapezoidal rule.
SURPLUS = {
    (JACOBI, False): -1 / 2,
    (GAUSS_SEIDEL, False): 1 / 2,
    (JACOBI, True): -1 / 6,
    (GAUSS_SEIDEL, True): 1 / 12,
}
INITIAL_SPEED = 3.0
#: Brake pressure at t = 0, a fifth of the full one, and the full one.
FIRST_SHARE = 0.2
#: Time at which the speed is compared [s], and the speed at which the bogie has stopped [m/s].
MIDWAY, AT_REST = 1.5, 0.05
#: Simulated time, longer than any of the stops [s].
LONGEST = 10.0
#: Relative error of the reference; a hundredth of the smallest error that is shown.
REFERENCE_TOLERANCE = 1e-10
RATE = TIME_CONSTANTS_TO_95_PERCENT / APPLICATION_TIME


@dataclass(frozen=True)
class CoupledStop:
    """Time [s] and distance [m] until AT_REST, and the speed MIDWAY [m/s]; or the errors of these."""

    time: float
    distance: float
    speed: float

    def minus(self, other: CoupledStop) -> CoupledStop:
        return CoupledStop(self.time - other.time, self.distance - other.distance, self.speed - other.speed)


def torque_at(time: float) -> float:
    """Return the torque of the brake's law with a constant shoe friction, solved analytically [N.m]."""
    return FULL_TORQUE * (1.0 - (1.0 - FIRST_SHARE) * math.exp(-RATE * time))


def torque_rate_at(time: float) -> float:
    return RATE * (FULL_TORQUE - torque_at(time))


def reference() -> CoupledStop:
    """Return the stop of one system, the bogie with the torque inside, by SciPy's Radau with the exact Jacobian."""
    kernel = prepare("bogie", **bogie_values(INITIAL_SPEED))
    kernel.initialise()
    torques = [kernel.library.index[f"brake_torque_{wheelset}"] for wheelset in (1, 2)]
    names = list(planar_vehicle(two_axle_bogie(BOGIE)).states)

    def mean_of_axles(frame: str, axle: str, y: np.ndarray) -> float:
        return float(y[names.index(frame)] + (y[names.index(f"{axle}_1")] + y[names.index(f"{axle}_2")]) / 2)

    def brake(time: float) -> None:
        for number in torques:
            kernel.set_number(number, torque_at(time))

    def slopes(time: float, y: np.ndarray) -> list[float]:
        brake(time)
        return kernel.slopes_at(time, y)  # type: ignore[arg-type]

    def jacobian(time: float, y: np.ndarray) -> np.ndarray:
        brake(time)
        return np.array(kernel.jacobian_at(time, y))  # type: ignore[arg-type]

    def stops(_: float, y: np.ndarray) -> float:
        return mean_of_axles("frame_speed", "shift_speed", y) - AT_REST

    stops.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        *(slopes, (0.0, LONGEST), kernel.linearise().state, "Radau"),
        jac=jacobian,
        events=stops,
        dense_output=True,
        rtol=REFERENCE_TOLERANCE,
        atol=REFERENCE_TOLERANCE,
    )
    distance = mean_of_axles("frame_distance", "shift", found.y[:, -1])
    return CoupledStop(float(found.t[-1]), distance, mean_of_axles("frame_speed", "shift_speed", found.sol(MIDWAY)))


def coupled_stop(brake: FmuInstance, bogie: FmuInstance, master: Master, step: float) -> CoupledStop:
    """Return the stop by coupled FMUs. The instant is located within its macro step by repeated partial steps."""
    bogie.restart(bogie_values(INITIAL_SPEED))
    start_brake(brake, FIRST_SHARE * FULL_PRESSURE)
    brake.set(pressure_demand=FULL_PRESSURE)
    coupling = Coupling([brake, bogie], connections(brake, bogie), master)
    midway, before, state = math.nan, 0.0, bogie.save()
    for now in coupling.run(LONGEST, step):
        speed = bogie["speed"]
        if math.isclose(now, MIDWAY):
            midway = speed
        if speed < AT_REST:
            break
        bogie.forget(state)
        before, state = now, bogie.save()

    def left(part: float) -> float:
        bogie.restore(state)
        if part > 0.0:
            bogie.step(before, part)
        return bogie["speed"] - AT_REST

    part = float(brentq(left, 0.0, step, xtol=1e-12))
    left(part)
    bogie.forget(state)
    return CoupledStop(before + part, bogie["distance"], midway)


def error_on_paper(master: Master, step: float, stop: CoupledStop) -> CoupledStop:
    """Return the leading term of the error: the surplus of the torque's impulse over the mass of the rolling bogie."""
    factor = -acceleration_per_torque() * SURPLUS[master.method, master.extrapolated]
    end = stop.time
    if master.extrapolated:
        factor *= step**2
        grown = [torque_rate_at(time) - torque_rate_at(0.0) for time in (MIDWAY, end)]
        area = torque_at(end) - torque_at(0.0) - end * torque_rate_at(0.0)
    else:
        factor *= step
        grown = [torque_at(time) - torque_at(0.0) for time in (MIDWAY, end)]
        area = end * (FULL_TORQUE - torque_at(0.0)) - (torque_at(end) - torque_at(0.0)) / RATE
    later = factor * grown[1] / (acceleration_per_torque() * torque_at(end))
    return CoupledStop(later, factor * area + AT_REST * later, factor * grown[0])


def order(steps: Sequence[float], errors: Sequence[float]) -> float:
    """Return the slope of the error over the macro step, both as logarithms."""
    return float(np.polyfit(np.log(steps), np.log(np.abs(errors)), 1)[0])
