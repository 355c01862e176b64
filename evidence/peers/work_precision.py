"""Runs of one case by all methods: error, wall time, right-hand sides, and the reason of a failure."""

import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evidence.chapter3.kinematic_analysis import rolling
from evidence.chapter3.mechanism import FIRST_WHEELSET, Mechanism, MechanismInputs
from evidence.chapter3.program import run as run_program
from evidence.measuring.runs import SceneRun, own
from evidence.measuring.scenes import FULL, LOCK_UP, SMOOTH, STANDING, Scene, difference
from evidence.peers import sundials
from evidence.peers.exchange import EXCHANGE, IN_THE_PLANE, LEVEL, exchange
from evidence.peers.scipy_methods import BUDGET, scipy
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import CosimulationError, FmuInstance
from products.building import up_to_date
from rbd_model.contact.geometry import thesis_pair
from rbd_model.levels.models import DEFAULT_TOLERANCE
from rbd_model.track.irregularity import derivatives_along, section_5_3
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_5_1_and_5_2

#: Total time up to which runs are repeated [s]; the fastest counts. Longer ones run once.
REPEATED, MOST_REPEATS = 0.5, 5
#: Methods whose time only grows with finer settings, so that one over the time limit ends the line.
GROWING = ("RK4, fixed step", "RK45 (SciPy)")
DEFAULT = "default: RODAS5P"
#: Third-party methods, with which the default is compared.
PEERS = ("RK45 (SciPy)", "Radau (SciPy)", "BDF (SciPy)", "LSODA (SciPy)", "CVODE", "IDA")
#: Communication steps of the FMUs [s].
HOST_STEPS = (1e-4, 5e-4, 2.5e-3, 1e-2, 2.5e-2)
#: Time that chapter 3 integrates, and its step [s]; Runge-Kutta is unstable above 0.8 ms at 25 m/s.
SHOWN, STEP = 0.1, 5e-4
OMITTED = (
    "Omitted: the FMUs beyond the smooth stop, as the kernel inside is the same; the point and the planar level, and "
    "model exchange, which is at the planar level and held against it, in scenes that leave the plane; chapter 3 as "
    "printed beyond the first tenth of a second of the smooth stop (its time is extended from there). CVODE and IDA "
    "switch between sliding and sticking as ours does and start anew each time, which they may do without end where a "
    "wheel comes to rest; with a friction made smooth for them they might not."
)


@dataclass(frozen=True)
class MethodPoint:
    """One method at one setting: relative error (None: it failed), time [s], right-hand sides, and the reason of a
    failure.
    """

    method: str
    setting: float
    error: float | None
    seconds: float
    right_hand_sides: int
    reason: str = ""


@dataclass(frozen=True)
class WorkPrecision:
    """All points of a case; `uncertainty`: relative difference of two references of different methods."""

    scene: Scene
    points: list[MethodPoint]
    uncertainty: float
    references: tuple[str, str]

    def of(self, method: str) -> list[MethodPoint]:
        return [point for point in self.points if point.method == method]

    def at(self, method: str, setting: float) -> MethodPoint:
        return next(point for point in self.of(method) if point.setting == setting)

    def fastest(self, methods: Sequence[str], error: float) -> MethodPoint | None:
        """Return the fastest point with at most this error."""
        good = [p for m in methods for p in self.of(m) if p.error is not None and p.error <= error]
        return min(good, key=lambda point: point.seconds, default=None)


def reference_of(scene: Scene) -> tuple[SceneRun, str]:
    """Return a run by a third-party method, at least 100 times tighter than the compared ones, and its name."""
    tolerance = scene.references[0]
    if sundials.is_installed():
        method = "CVODE"
        run = sundials.sundials(scene, method, tolerance, 60.0)
        if run.failure:
            method = "IDA"
            run = sundials.sundials(scene, method, tolerance, 60.0)
        return run, f"{method} {tolerance:g}"
    return scipy(scene, "Radau", 10 * tolerance, 300.0), f"Radau {10 * tolerance:g}"


def refer(scene: Scene) -> tuple[dict[str, float], float, tuple[str, str]]:
    """Return the measures of the reference, its uncertainty, and the names of both references."""
    (first, word), tolerance = reference_of(scene), scene.references[1]
    second = own(scene, tolerance=tolerance)
    if first.failure or second.failure:
        raise RuntimeError(f"{scene.name} has no reference: {first.failure or second.failure}")
    measures = scene.measure(first.samples)
    return measures, difference(scene.measure(second.samples), measures), (word, f"RODAS5P {tolerance:g}")


def repeated(work: Callable[[], SceneRun]) -> SceneRun:
    """Return the fastest of several runs, two at least: a computer may pause for seconds."""
    best = work()
    spent = best.seconds
    for number in range(1, MOST_REPEATS):
        if best.failure or (number > 1 and spent > REPEATED):
            break
        again = work()
        spent += again.seconds
        best = min(best, again, key=lambda run: run.seconds)
    return best


def table_of(points: Sequence[object], units: Mapping[str, str]) -> Recording:
    """Return points as rows: their number and these attributes, NaN for None; names are in the JSON."""
    series = Recording({"point": "1"}, [[number] for number in range(len(points))])
    for name, unit in units.items():
        values = [getattr(point, name) for point in points]
        series.add(name, unit, np.array([np.nan if value is None else value for value in values], float))
    return series


Work = tuple[str, float, Callable[[], SceneRun]]


def works(scene: Scene, short: bool) -> Iterator[Work]:
    """Yield name, setting (tolerance, or step [s]) and work of all runs; `short`: one setting of each."""
    tolerances = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
    every = (DEFAULT_TOLERANCE,) if short else tolerances
    coarse = (1e-5,) if short else (1e-3, 1e-5, 1e-7)
    for value in every:
        yield DEFAULT, value, lambda value=value: own(scene, tolerance=value)  # type: ignore[misc]
        yield "ROS34PW2", value, lambda value=value: own(scene, tolerance=value, integration_method=2)  # type: ignore[misc]
    fixed = {"RODAS5P, fixed step": 1, "ROS34PW2, fixed step": 2, "RK4, fixed step": 3}
    for name, method in fixed.items():
        steps = (1e-2, 3e-3, 1e-3) if method < 3 else (1e-3, 5e-4, 2e-4)
        for step in steps[-1:] if short else steps:
            values = {"integration_method": method, "integration_step": step}
            yield name, step, lambda values=values: own(scene, **values)  # type: ignore[misc]
    if sundials.is_installed():
        for name in sundials.METHODS:
            for value in every:
                yield name, value, lambda name=name, value=value: sundials.sundials(scene, name, value)  # type: ignore[misc]
    for value in every if scene in IN_THE_PLANE else ():
        yield EXCHANGE, value, lambda value=value: exchange(scene, value)  # type: ignore[misc]
    for name in ("RK45", "Radau", "BDF", "LSODA"):
        for value in coarse:
            yield f"{name} (SciPy)", value, lambda name=name, value=value: scipy(scene, name, value)  # type: ignore[misc]
    if scene in (SMOOTH, LOCK_UP, STANDING):
        for level, name in ((1, "point"), (2, "planar")):
            yield f"level {name}", DEFAULT_TOLERANCE, lambda level=level: own(scene, at_axles=True, level=level)  # type: ignore[misc]
    if scene is SMOOTH:
        for kind in ("native", "python"):
            for step in HOST_STEPS[-1:] if short else HOST_STEPS:
                yield f"{kind} FMU", step, lambda kind=kind, step=step: hosted(scene, kind, step)  # type: ignore[misc]


def hosted(scene: Scene, kind: str, step: float) -> SceneRun:
    """Run the FMU at communication steps through fmpy; constant inputs; samples at the ends of communication steps."""
    rows, inputs = [], {name: history[0][1] for name, history in scene.inputs.items()}
    with FmuInstance(up_to_date(scene.fmu, kind), **scene.parameters) as slave:
        slave.start(**inputs)
        every = max(1, round(scene.interval / step))
        begin = clock.perf_counter()
        try:
            for number in range(round(scene.duration / step)):
                if number % every == 0:
                    rows.append([number * step, *(slave[f"state_{name}"] for name in scene.read)])
                slave.step(number * step, step)
        except CosimulationError as error:
            return SceneRun({}, clock.perf_counter() - begin, failure=str(error))
        rows.append([scene.duration, *(slave[f"state_{name}"] for name in scene.read)])
        seconds = clock.perf_counter() - begin
    return SceneRun(dict(zip(("time", *scene.read), np.array(rows).T, strict=True)), seconds)


def in_the_plane(scene: Scene) -> dict[str, float]:
    """Return the measures at the level of model exchange, which lacks some effects of level 3."""
    return scene.measure(own(scene, level=LEVEL, tolerance=scene.references[1]).samples)


def study(scene: Scene, short: bool = False, done: Callable[[str], None] = lambda name: None) -> WorkPrecision:
    """Run all methods on one case; `done` is called with the name of each."""
    measures, uncertainty, references = refer(scene)
    planar = in_the_plane(scene) if scene in IN_THE_PLANE else {}
    points, late = [], set()
    for name, setting, work in works(scene, short):
        if name in late:  # a finer setting takes longer still
            points.append(MethodPoint(name, setting, None, BUDGET, 0, "not tried: a coarser setting was given up"))
            continue
        run = repeated(work)
        exact = planar if name == EXCHANGE else measures
        error = None if run.failure else difference(scene.measure(run.samples), exact)
        reason = run.failure
        if run.seconds >= BUDGET and name in GROWING:
            late.add(name)
        points.append(MethodPoint(name, setting, error, run.seconds, run.work.get("right_hand_sides", 0), reason))
        done(name)
    return WorkPrecision(scene, points, uncertainty, references)


def oracle_point() -> MethodPoint:
    """Run chapter 3 of the thesis on the smooth stop for SHOWN; its time is extrapolated to the whole case."""
    mechanism = Mechanism(as_printed(tables_5_1_and_5_2()), thesis_pair(), 2, derivatives_along(section_5_3()))
    inputs, state = MechanismInputs(brake_torque=(FULL, FULL)), rolling(mechanism, 25.0)
    begin = clock.perf_counter()
    *_, state = run_program(mechanism, state, SHOWN, STEP, lambda time: inputs)
    seconds = clock.perf_counter() - begin
    bodies = [mechanism.body(FIRST_WHEELSET + number) for number in range(2)]
    speed = float(np.mean([state.q_rate[body][0] for body in bodies]))
    distance = float(np.mean([state.q[body][0] for body in bodies]))
    kernel = SMOOTH.kernel(tolerance=1e-10, **AS_PRINTED)
    start = float(np.mean([rolling(mechanism, 25.0).q[body][0] for body in bodies]))
    kernel.advance(SHOWN)
    error = max(abs(speed / kernel["speed"] - 1.0), abs((distance - start) / kernel["distance"] - 1.0))
    steps = round(SMOOTH.duration / STEP)
    return MethodPoint("chapter 3 as printed", STEP, error, seconds * SMOOTH.duration / SHOWN, 4 * steps)
