"""SciPy's integrators on the compiled equations; each runs a case at one accuracy."""

import time as clock
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import BDF, LSODA, RK45, OdeSolver, Radau

from evidence.measuring.runs import SceneRun, failed, finish, layout_of
from evidence.measuring.scenes import Scene
from fmu_src.kernel import Kernel, SimulationError

#: Time limit of a run [s]; the point then states this reason.
BUDGET = 5.0


class _Bdf(BDF):
    """BDF whose work array begins with zeros: its first step subtracts a row that SciPy 1.17 has not set.

    The result is never used, but arbitrary memory may raise a warning of an invalid value.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.D[2:] = 0.0


METHODS = {"RK45": RK45, "Radau": Radau, "BDF": _Bdf, "LSODA": LSODA}
#: Bisection steps that locate a switch within a step: to its 2^-40th part.
LOCATING_ROUNDS = 40


class GivenUpError(Exception):
    """A run that cannot continue; the text states the reason."""


@dataclass
class _Equations:
    """A kernel's equations as SciPy calls them, with a count and a deadline."""

    kernel: Kernel
    deadline: float
    right_hand_sides: int = 0
    jacobians: int = 0
    last_jacobian: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))

    def slopes(self, time: float, y: np.ndarray) -> np.ndarray:
        self.right_hand_sides += 1
        if clock.perf_counter() > self.deadline:
            raise GivenUpError(f"given up at t = {time:.3g} s after {self.kernel.counts['events']} switches")
        try:
            return np.array(self.kernel.slopes_at(time, y.tolist()))
        except SimulationError:  # a trial value without contact: the method must shorten its step
            return np.full(y.size, np.nan)

    def jacobian(self, time: float, y: np.ndarray) -> np.ndarray:
        self.jacobians += 1
        with suppress(SimulationError):  # the method must shorten its step, and may do so with the last one
            self.last_jacobian = np.array(self.kernel.jacobian_at(time, y.tolist()))
        return self.last_jacobian

    def crossed(self, time: float, y: np.ndarray) -> bool:
        return self.kernel.margin_at(time, y.tolist()) < 0.0


def scipy(scene: Scene, method: str, tolerance: float, budget: float = BUDGET) -> SceneRun:
    """Run SciPy's integrators between corners and switches.

    Takes budget [s].
    """
    kernel, form = scene.kernel(), layout_of(scene)
    columns = [form.kept.index(name) for name in scene.read]
    place = np.array(kernel.linearise().state)[form.differential]
    begin = clock.perf_counter()
    equations = _Equations(kernel, begin + budget)
    options = {
        "rtol": max(1e-3 * tolerance, 2.3e-14),
        "atol": tolerance * form.nominal[form.differential],
        "max_step": scene.longest_step,
    }
    if method != "RK45":
        options["jac"] = equations.jacobian
    rows = [place[columns]]
    try:
        for start, end in scene.segments():
            scene.set_inputs(kernel, start, end)
            time = start
            while time < end and not kernel.ended:
                solver = METHODS[method](equations.slopes, time, place, end, **options)
                time, place = _to_switch(solver, equations, scene, columns, rows)
    except (GivenUpError, SimulationError) as error:
        return failed(scene, clock.perf_counter() - begin, str(error), kernel)
    seconds = clock.perf_counter() - begin
    work = {"right_hand_sides": equations.right_hand_sides, "jacobians": equations.jacobians}
    return finish(scene, np.array(rows), seconds, work, kernel)


def _to_switch(
    solver: OdeSolver, equations: _Equations, scene: Scene, columns: list[int], rows: list[np.ndarray]
) -> tuple[float, np.ndarray]:
    """Step to the next switch or the end; return the time and the state there. Samples are appended to `rows`."""
    while solver.status == "running":
        try:
            message = solver.step()
        except ValueError as error:  # linear equations of the method after a trial with NaN
            raise GivenUpError(f"{error} at t = {solver.t:.4g} s") from None
        if solver.status == "failed":
            raise GivenUpError(f"{message} at t = {solver.t:.4g} s")
        between, before, after = solver.dense_output(), solver.t_old, solver.t
        crossed = equations.crossed(after, solver.y)
        if crossed:
            for _ in range(LOCATING_ROUNDS):
                middle = (before + after) / 2
                before, after = (before, middle) if equations.crossed(middle, between(middle)) else (middle, after)
        while len(rows) * scene.interval <= after + 1e-12:
            rows.append(between(min(len(rows) * scene.interval, after))[columns])
        if crossed:
            return after, np.array(equations.kernel.arrive(after, between(after).tolist()))
    return solver.t, np.array(equations.kernel.arrive(solver.t, solver.y.tolist()))
