"""Integrators on the same compiled equations: our own and SciPy's. Each runs a scene at one accuracy."""

import time as clock
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.integrate import BDF, LSODA, RK45, OdeSolver, Radau

from fmu_src.kernel import Kernel, KernelError
from scenarios.bench.drive import system_of
from scenarios.methods.scenes import Samples, Scene

#: Seconds after which a run is given up; the point then says so.
BUDGET = 5.0


@dataclass(frozen=True)
class Run:
    """What a run came to: samples of the scene's states (none after a failure), seconds of wall time, work, reason."""

    samples: Samples
    seconds: float
    work: Mapping[str, int] = field(default_factory=dict)
    failure: str = ""
    journal: tuple[str, ...] = ()


def failed(scene: Scene, seconds: float, reason: str, kernel: Kernel | None = None) -> Run:
    counts = kernel.counts if kernel else {}
    return Run({}, seconds, counts, reason, tuple(kernel.journal) if kernel else ())


# ---- our own -----------------------------------------------------------------------------------------------------


#: Outputs that all levels have, in place of states that not all have.
AT_AXLES = {"frame_distance": "distance", "frame_speed": "speed"}


def own(scene: Scene, at_axles: bool = False, **values: float) -> Run:
    """The kernel in long steps between the corners of the inputs; `values`: tolerance, method, fixed step, level.

    at_axles: distance and speed are those of the axles, which all levels have; the frame sways by micrometres.
    """
    kernel = scene.kernel(**values)
    names = [AT_AXLES.get(name, name) if at_axles else f"state_{name}" for name in scene.read]
    begin, rows = clock.perf_counter(), []
    try:
        for start, end in scene.segments():
            scene.set_inputs(kernel, start, end)
            table = kernel.record(end - start, scene.interval, names)
            first = 0 if start == 0.0 else 1
            rows += list(zip(*(table[name][first:] for name in names), strict=True))
    except KernelError as error:
        return failed(scene, clock.perf_counter() - begin, str(error), kernel)
    seconds = clock.perf_counter() - begin
    return finish(scene, np.array(rows), seconds, kernel.counts, kernel)


def finish(scene: Scene, rows: np.ndarray, seconds: float, work: Mapping[str, int], kernel: Kernel) -> Run:
    """A run from rows of the scene's states; a failure when they are fewer than the scene has, or not finite."""
    times = scene.times()
    if kernel.ended or len(rows) < times.size:
        return failed(
            scene, seconds, f"it ended early: {kernel.journal[-1] if kernel.journal else 'no samples'}", kernel
        )
    if not np.isfinite(rows).all():
        return failed(scene, seconds, "the result is not finite", kernel)
    samples = {"time": times} | dict(zip(scene.read, rows.T, strict=True))
    return Run(samples, seconds, work, journal=tuple(kernel.journal))


# ---- others: what they share -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Layout:
    """Places of states: all names; which have a derivative; nominal values of all."""

    names: list[str]
    differential: np.ndarray
    nominal: np.ndarray

    @property
    def kept(self) -> list[str]:
        return [name for name, own in zip(self.names, self.differential, strict=True) if own]


@lru_cache
def layout(fmu: str, **values: float) -> Layout:
    """That of the equations of a kernel with these parameters."""
    states = system_of(fmu, **values).states.values()
    return Layout(
        [state.name for state in states],
        np.array([not state.algebraic for state in states]),
        np.array([state.nominal for state in states]),
    )


def layout_of(scene: Scene) -> Layout:
    """That of the equations of a scene."""
    return layout(scene.fmu, **scene.parameters)


# ---- SciPy ---------------------------------------------------------------------------------------------------------


class _Bdf(BDF):
    """Its first step subtracts a row that SciPy 1.17 has not set, and never uses the result.

    What memory held there may warn of an invalid value, by chance; zeros do not.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.D[2:] = 0.0


METHODS = {"RK45": RK45, "Radau": Radau, "BDF": _Bdf, "LSODA": LSODA}
#: Rounds of bisection that locate a switch within a step: to its 2^-40th part.
LOCATING_ROUNDS = 40


class GivenUpError(Exception):
    """A run that cannot go on; the text says why."""


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
        except KernelError:  # a trial value without contact: the method must shorten its step
            return np.full(y.size, np.nan)

    def jacobian(self, time: float, y: np.ndarray) -> np.ndarray:
        self.jacobians += 1
        with suppress(KernelError):  # the method must shorten its step, and may do so with the last one
            self.last_jacobian = np.array(self.kernel.jacobian_at(time, y.tolist()))
        return self.last_jacobian

    def crossed(self, time: float, y: np.ndarray) -> bool:
        return self.kernel.margin_at(time, y.tolist()) < 0.0


def scipy(scene: Scene, method: str, tolerance: float, budget: float = BUDGET) -> Run:
    """SciPy's integrators between corners and switches; absolute tolerance in nominal values, as ours."""
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
    except (GivenUpError, KernelError) as error:
        return failed(scene, clock.perf_counter() - begin, str(error), kernel)
    seconds = clock.perf_counter() - begin
    work = {"right_hand_sides": equations.right_hand_sides, "jacobians": equations.jacobians}
    return finish(scene, np.array(rows), seconds, work, kernel)


def _to_switch(
    solver: OdeSolver, equations: _Equations, scene: Scene, columns: list[int], rows: list[np.ndarray]
) -> tuple[float, np.ndarray]:
    """Steps to the next switch or the end; time and place from which to go on. Appends samples to `rows`."""
    while solver.status == "running":
        try:
            message = solver.step()
        except ValueError as error:  # its linear equations, where a trial has led to what is no number
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
