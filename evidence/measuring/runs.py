"""A case run by the kernel at one accuracy, and the places of its states."""

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from evidence.measuring.scenes import Samples, Scene
from fmu_src.kernel import Kernel, SimulationError
from products.kernel_runs import system_of


@dataclass(frozen=True)
class SceneRun:
    """Results of a run: samples of the case's states (none after a failure), wall time [s], work, reason."""

    samples: Samples
    seconds: float
    work: Mapping[str, int] = field(default_factory=dict)
    failure: str = ""
    messages: tuple[str, ...] = ()


def failed(scene: Scene, seconds: float, reason: str, kernel: Kernel | None = None) -> SceneRun:
    counts = kernel.counts if kernel else {}
    return SceneRun({}, seconds, counts, reason, tuple(kernel.messages) if kernel else ())


#: Outputs of all levels that replace states which some levels lack.
AT_AXLES = {"frame_distance": "distance", "frame_speed": "speed"}


def own(scene: Scene, at_axles: bool = False, **values: float) -> SceneRun:
    """Run the kernel in long steps between the corners of the inputs."""
    kernel = scene.kernel(**values)
    names = [AT_AXLES.get(name, name) if at_axles else f"state_{name}" for name in scene.read]
    begin, rows = clock.perf_counter(), []
    try:
        for start, end in scene.segments():
            scene.set_inputs(kernel, start, end)
            table = kernel.record(end - start, scene.interval, names)
            first = 0 if start == 0.0 else 1
            rows += list(zip(*(table[name][first:] for name in names), strict=True))
    except SimulationError as error:
        return failed(scene, clock.perf_counter() - begin, str(error), kernel)
    seconds = clock.perf_counter() - begin
    return finish(scene, np.array(rows), seconds, kernel.counts, kernel)


def finish(scene: Scene, rows: np.ndarray, seconds: float, work: Mapping[str, int], kernel: Kernel) -> SceneRun:
    """Return a run from rows of the case's states; a failure if some are missing or not finite."""
    times = scene.times()
    if kernel.ended or len(rows) < times.size:
        return failed(
            scene, seconds, f"it ended early: {kernel.messages[-1] if kernel.messages else 'no samples'}", kernel
        )
    if not np.isfinite(rows).all():
        return failed(scene, seconds, "the result is not finite", kernel)
    samples = {"time": times} | dict(zip(scene.read, rows.T, strict=True))
    return SceneRun(samples, seconds, work, messages=tuple(kernel.messages))


@dataclass(frozen=True)
class StateLayout:
    """Places of states: all names; which have a derivative; nominal values of all."""

    names: list[str]
    differential: np.ndarray
    nominal: np.ndarray

    @property
    def kept(self) -> list[str]:
        return [name for name, own in zip(self.names, self.differential, strict=True) if own]


@lru_cache
def layout(fmu: str, **values: float) -> StateLayout:
    """Return the layout of a kernel's equations with these parameters."""
    states = system_of(fmu, **values).states.values()
    return StateLayout(
        [state.name for state in states],
        np.array([not state.algebraic for state in states]),
        np.array([state.nominal for state in states]),
    )


def layout_of(scene: Scene) -> StateLayout:
    """Return the layout of a case's equations."""
    return layout(scene.fmu, **scene.parameters)
