"""Error against throughput: stops a second of one instance, of batches, and of SciPy and CVODE on all processors."""

import os
import time as clock
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from bogie_braking.reporting.progress import counting
from evidence.measuring.runs import SceneRun, layout_of
from evidence.measuring.scenes import SMOOTH, Samples, Scene, both
from evidence.peers import sundials
from evidence.peers.scipy_methods import scipy
from evidence.peers.work_precision import refer
from fmu_src.batch import library_of_batch, run_batch
from fmu_src.kernel import SimulationError
from products.kernel_runs import library
from products.registry import model_of
from products.study.points import process_pool

#: Parameters that choose a level, and the system that a batch of it runs.
LEVELS: dict[str, tuple[dict[str, float], str]] = {
    "planar": ({"level": 2, "contact_model": 1}, "planar"),
    "spatial": ({"level": 3, "contact_model": 2}, "spatial_patches"),
}
#: Simulated time of a stop [s], and least and largest torque capacity on both wheelsets [N.m]. The first comes to rest
#: shortly after. At rest third-party methods may switch between sliding and sticking, as ours do, without end.
DURATION, TORQUES = SMOOTH.duration, (16e3, 20e3)
#: Time limit of one stop of third-party methods [s].
BUDGET = 10.0
ALONE, BATCH, FIXED = "one instance", "batch", "fixed step"
IN_THREADS, IN_PROCESSES = "CVODE, threads", {f"{name} (SciPy), processes": name for name in ("Radau", "BDF", "LSODA")}
PEERS = (IN_THREADS, *IN_PROCESSES)


@dataclass(frozen=True)
class StudyExtent:
    """Settings and numbers of stops of a study.

    tolerances: of this project's methods and of CVODE. fixed_steps: of this project's methods [s]. coarse: tolerances
    of SciPy's methods.

    judged: number of stops whose errors are evaluated. planar, spatial: number of stops of a batch. rounds: the
    fastest counts. of_a_thread, of_a_process: number of stops of CVODE and of SciPy for each worker.
    """

    tolerances: tuple[float, ...] = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
    fixed_steps: tuple[float, ...] = (1e-2, 5e-3, 2e-3)
    coarse: tuple[float, ...] = (1e-3, 1e-5, 1e-7)
    judged: int = 4
    planar: int = 2000
    spatial: int = 200
    rounds: int = 2
    of_a_thread: int = 8
    of_a_process: int = 4

    @property
    def torques(self) -> np.ndarray:
        """Return the torques of the stops whose errors are evaluated [N.m]."""
        return np.linspace(*TORQUES, self.judged)


QUICK = StudyExtent((1e-6,), (1e-2,), (1e-5,), judged=2, planar=32, spatial=16, rounds=1, of_a_thread=1, of_a_process=1)


@dataclass(frozen=True)
class Rate:
    """A method at a setting (tolerance, or step [s]): largest relative error of the distances (None: a stop failed),
    stops a second, and the reason of a failure.
    """

    level: str
    way: str
    setting: float
    error: float | None
    stops: float
    reason: str = ""


@dataclass(frozen=True)
class EnsembleStudy:
    """All rates; by level the relative difference of two references, and the difference of batches from single runs
    [m].
    """

    rates: list[Rate]
    uncertainty: dict[str, float]
    apart: dict[str, float]

    def of(self, level: str, way: str) -> list[Rate]:
        """Return the rates of a method, the loosest setting first."""
        found = (rate for rate in self.rates if (rate.level, rate.way) == (level, way))
        return sorted(found, key=lambda one: -one.setting)

    def fastest(self, level: str, ways: Sequence[str], error: float) -> Rate | None:
        """Return the rate with the most stops a second at no more than this error."""
        every = (one for way in ways for one in self.of(level, way))
        return max((one for one in every if one.error is not None and one.error <= error), key=_stops, default=None)


def _stops(rate: Rate) -> float:
    return rate.stops


def distance(samples: Samples) -> dict[str, float]:
    """Return the evaluated quantity: the distance of the stop [m]."""
    return {"distance": float(samples["frame_distance"][-1])}


def stop(level: str, torque: float) -> Scene:
    """Return a stop from 25 m/s, with a sample at its end only."""
    return replace(
        SMOOTH,
        name=f"stop, {level}, {torque:g} N.m",
        duration=DURATION,
        interval=DURATION,
        read=("frame_distance",),
        measure=distance,
        values=LEVELS[level][0],
        inputs=both([(0.0, torque)]),
    )


Distances = Callable[[], np.ndarray]


def alone(level: str, torques: np.ndarray, **values: float) -> Distances:
    """Run stops in sequence, by the kernel in one thread."""

    def run() -> np.ndarray:
        found = []
        for torque in torques:
            kernel = stop(level, torque).kernel(**values)
            found.append(kernel.record(DURATION, DURATION, ["state_frame_distance"])["state_frame_distance"][-1])
        return np.array(found)

    return run


def together(level: str, extent: StudyExtent, **values: float) -> tuple[Distances, np.ndarray]:
    """Run stops in a batch on all processors; return also the indices of the evaluated ones."""
    chosen, system = LEVELS[level]
    count = getattr(extent, level)
    torques = np.linspace(*TORQUES, count)
    places = np.round(np.linspace(0, count - 1, extent.judged)).astype(int)
    torques[places] = extent.torques
    given: dict[str, ArrayLike] = {"initial_speed": 25.0, "brake_torque_1": torques, "brake_torque_2": torques}
    in_lanes = library_of_batch(model_of("bogie"), system)

    def run() -> np.ndarray:
        ends = run_batch(
            in_lanes, {**SMOOTH.parameters, **chosen, **given, **values}, DURATION, ["state_frame_distance"]
        )
        for sentence in ends.failures.values():
            raise SimulationError(sentence, 3)
        return ends.outputs["state_frame_distance"]

    return run, places


def fastest_of(run: Distances, rounds: int) -> tuple[float, np.ndarray]:
    """Return stops a second, and their distances [m]."""
    best = np.inf
    for _ in range(rounds):
        begin = clock.perf_counter()
        found = run()
        best = min(best, clock.perf_counter() - begin)
    return found.size / best, found


def of_scipy(level: str, method: str, tolerance: float, torque: float) -> SceneRun:
    """Run one stop in a process."""
    return scipy(stop(level, torque), method, tolerance, BUDGET)


def of_cvode(level: str, tolerance: float, torque: float) -> SceneRun:
    """Run one stop in a thread; the library releases Python's lock."""
    return sundials.sundials(stop(level, torque), "CVODE", tolerance, BUDGET)


def warm_up(_: int) -> None:
    """Load and compile everything that a process needs before its first stop."""
    for level in LEVELS:
        library("bogie", **LEVELS[level][0])
        layout_of(stop(level, TORQUES[0]))


# ---- the study -------------------------------------------------------------------------------------------------------


def settings(extent: StudyExtent) -> Iterator[tuple[str, float, dict[str, float]]]:
    """Yield our settings: suffix of the method's name, the setting, and the values of the kernel."""
    yield from (("", value, {"tolerance": value}) for value in extent.tolerances)
    for step in extent.fixed_steps:
        yield f", {FIXED}", step, {"integration_method": 2, "integration_step": step}


def error_of(found: np.ndarray, exact: np.ndarray) -> float:
    """Return the largest relative error of the evaluated distances [m]."""
    return float(np.abs(found / exact - 1.0).max())


def ours(level: str, exact: np.ndarray, extent: StudyExtent) -> Iterator[tuple[Rate, float]]:
    """Yield one instance and a batch at each setting, and the difference of the two [m]."""
    for words, setting, values in settings(extent):
        run, places = together(level, extent, **values)
        try:
            stops, single = fastest_of(alone(level, extent.torques, **values), extent.rounds)
            in_batch, every = fastest_of(run, extent.rounds)
        except SimulationError as error:  # the steps are too long
            yield Rate(level, ALONE + words, setting, None, 0.0, str(error)), 0.0
            yield Rate(level, BATCH + words, setting, None, 0.0, str(error)), 0.0
            continue
        yield Rate(level, ALONE + words, setting, error_of(single, exact), stops), 0.0
        apart = float(np.abs(every[places] - single).max())
        yield Rate(level, BATCH + words, setting, error_of(every[places], exact), in_batch), apart


def others(
    level: str, exact: np.ndarray, pool: Executor, threads: Executor, workers: int, extent: StudyExtent
) -> Iterator[Rate]:
    """Yield the rates of third-party methods, one stop a worker at a time."""
    for setting in extent.tolerances if sundials.is_installed() else ():
        work = partial(of_cvode, level, setting)
        yield rate_of(level, IN_THREADS, setting, exact, threads, work, extent.of_a_thread * workers)
    for way, method in IN_PROCESSES.items():
        for setting in extent.coarse:
            work = partial(of_scipy, level, method, setting)
            yield rate_of(level, way, setting, exact, pool, work, extent.of_a_process * workers)


def rate_of(
    level: str,
    way: str,
    setting: float,
    exact: np.ndarray,
    pool: Executor,
    work: Callable[[float], SceneRun],
    count: int,
) -> Rate:
    """Run the evaluated stops repeatedly, `count` at least, by a pool of workers."""
    torques = np.tile(np.linspace(*TORQUES, exact.size), -(-count // exact.size))
    begin = clock.perf_counter()
    runs = list(pool.map(work, torques.tolist()))
    stops = len(runs) / (clock.perf_counter() - begin)
    for run in runs:
        if run.failure:
            return Rate(level, way, setting, None, stops, run.failure)
    found = np.array([distance(run.samples)["distance"] for run in runs[: exact.size]])
    return Rate(level, way, setting, error_of(found, exact), stops)


def references(level: str, torques: np.ndarray) -> tuple[np.ndarray, float]:
    """Return distances [m] by a third-party method at a tolerance 100 times tighter, and the largest error of our
    method at its tightest.
    """
    found = [refer(stop(level, torque)) for torque in torques]
    return np.array([measures["distance"] for measures, _, _ in found]), max(off for _, off, _ in found)


def study(extent: StudyExtent) -> EnsembleStudy:
    """Return all rates, with a progress bar."""
    workers = os.cpu_count() or 1
    ensemble_study = EnsembleStudy([], {}, {})
    per_level = 2 * len(list(settings(extent))) + len(IN_PROCESSES) * len(extent.coarse)
    per_level += len(extent.tolerances) if sundials.is_installed() else 0
    warm_up(0)
    with ExitStack() as held:
        bar = held.enter_context(counting(total=len(LEVELS) * per_level, text="ensembles", unit="rate"))
        pool = held.enter_context(process_pool(workers))
        threads = held.enter_context(ThreadPoolExecutor(workers))
        list(pool.map(warm_up, range(workers)))
        for level in LEVELS:
            exact, ensemble_study.uncertainty[level] = references(level, extent.torques)
            for rate, apart in ours(level, exact, extent):
                ensemble_study.rates.append(rate)
                ensemble_study.apart[level] = max(ensemble_study.apart.get(level, 0.0), apart)
                bar.update()
            for rate in others(level, exact, pool, threads, workers, extent):
                ensemble_study.rates.append(rate)
                bar.update()
    return ensemble_study
