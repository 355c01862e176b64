"""Integrators on the same compiled equations: our own and SciPy's. Each runs a scene at one accuracy."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from scipy.integrate import solve_ivp

from fmu_src.kernel import Kernel, KernelError
from scenarios.six_scenes import Samples, Scene, system_of

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
def layout(fmu: str, level: int = 3) -> Layout:
    states = system_of(fmu, level).states.values()
    return Layout(
        [state.name for state in states],
        np.array([not state.algebraic for state in states]),
        np.array([state.nominal for state in states]),
    )


# ---- SciPy -------------------------------------------------------------------------------------------------------


class GivenUpError(Exception):
    """A run took longer than its budget."""


def scipy(scene: Scene, method: str, tolerance: float, budget: float = BUDGET) -> Run:
    """SciPy's solve_ivp between corners and switches; absolute tolerance in nominal values, as ours."""
    kernel, form = scene.kernel(), layout(scene.fmu)
    columns = [form.kept.index(name) for name in scene.read]
    nominal, wanted = form.nominal[form.differential], scene.times()
    place, rows = np.array(kernel.linearise().state)[form.differential], []
    work = {"right_hand_sides": 0, "jacobians": 0}
    begin = clock.perf_counter()

    def slopes(time: float, y: np.ndarray) -> np.ndarray:
        work["right_hand_sides"] += 1
        if clock.perf_counter() - begin > budget:
            raise GivenUpError(f"given up after {budget:g} s at t = {time:.3g} s")
        try:
            return np.array(kernel.slopes_at(time, y.tolist()))
        except KernelError:  # a trial value without contact: the method must shorten its step
            return np.full(y.size, np.nan)

    def jacobian(time: float, y: np.ndarray) -> np.ndarray:
        work["jacobians"] += 1
        return np.array(kernel.jacobian_at(time, y.tolist()))

    def margin(time: float, y: np.ndarray) -> float:
        return kernel.margin_at(time, y.tolist())

    margin.terminal, margin.direction = True, -1.0  # type: ignore[attr-defined]
    implicit = {"jac": jacobian} if method in ("Radau", "BDF", "LSODA") else {}
    try:
        rows.append(place[columns])
        for start, end in scene.segments():
            scene.set_inputs(kernel, start, end)
            at = start
            while at < end and not kernel.ended:
                chosen = wanted[(wanted > at + 1e-12) & (wanted <= end + 1e-12)]
                found = solve_ivp(
                    *(slopes, (at, end), place, method),
                    t_eval=np.minimum(chosen, end),
                    events=margin,
                    rtol=max(1e-3 * tolerance, 2.3e-14),
                    atol=tolerance * nominal,
                    **implicit,
                )
                if not found.success:
                    return failed(scene, clock.perf_counter() - begin, str(found.message), kernel)
                rows += [y[columns] for y in np.reshape(found.y, (place.size, -1)).T]
                at = float(found.t_events[0][0]) if found.status == 1 else end
                ended_at = found.y_events[0][0] if found.status == 1 else None
                last = ended_at if ended_at is not None else found.y[:, -1]
                place = np.array(kernel.arrive(at, last, found.status == 1))
    except (GivenUpError, KernelError) as error:
        return failed(scene, clock.perf_counter() - begin, str(error), kernel)
    return finish(scene, np.array(rows), clock.perf_counter() - begin, work, kernel)
