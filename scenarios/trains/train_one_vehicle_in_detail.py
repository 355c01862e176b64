"""One vehicle of a train in detail, the others as points: one system with any step of the host, and where it fails."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray

from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import FOUR, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.train.consist import Consist
from products.train.numbers import DETAIL_STEP, Settings
from products.train.train import Train
from rbd_model.train.coupler import Coupler, draft_gear, rigid, screw_coupler, with_numbers
from scenarios.bench.mixed_train import (
    MASS,
    PLACE,
    ROTATING,
    SPEED,
    VEHICLES,
    WAYS,
    boundary,
    consist_of,
    linear_vehicle,
    mixed,
)
from scenarios.bench.pushed_in_a_curve import RADIUS, on_paper, pushed

#: Inner steps [s], the fine one of the reference, steps of hosts, duration of an emergency [s], times of forces [s].
STEPS, FINE, HOSTS, LONG, EVERY = (2.5e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2), 5e-5, (1e-3, 0.01, 0.05, 0.2), 12.0, 0.2
#: Those of a quick run.
QUICK_STEPS, QUICK_FINE, QUICK_LONG = (1e-3, 1e-2), 2.5e-4, 6.0
#: Couplers of the study; the last ones have slack.
COUPLERS = {
    "screw coupler": screw_coupler(),
    "rigid bar": rigid(),
    "draft gear without slack": with_numbers(draft_gear(), slack=0.0),
    "draft gear with slack": draft_gear(),
}
#: Demands: of a force at any instant over the largest one and of hosts' steps [1], of the pair of FMUs [1], [m].
FORCE, SAME, PAIR, DISTANCE = 0.01, 1e-3, 2e-3, 1e-3
#: Stiffnesses for hosts that couple a vehicle themselves [N/m]; largest share of the stable step that the FMU accepts.
STIFFNESS = {"50 MN/m": 50e6, "198 MN/m": 198e6, "1000 MN/m": 1e9}
ACCEPTED = {"held": 1.0, "corrected": 0.5}
#: A compression of freight trains [N], and relative tolerance of the lateral force in a curve.
HEAVY, CURVE = 300e3, 5e-3
#: Vehicles of the train whose speed is measured, and least speed over real time on one core.
LENGTH, FASTER = 40, 5.0


@dataclass(frozen=True)
class Stop:
    """A run: forces every 0.2 s [N], largest compression [N], distance of the head [m], CPU time [s]."""

    forces: NDArray[np.float64]
    compression: float
    distance: float
    cost: float

    def apart(self, other: Stop) -> float:
        """Return the largest difference of forces at an instant over the largest force [1]."""
        return float(np.abs(self.forces - other.forces).max() / np.abs(other.forces).max())


def emergency(coupler: Coupler, level: int, inner: float, host: float, long: float) -> Stop:
    """Brake the train with a coach in detail; inner, host: steps [s]."""
    train = Train(consist_of(coupler, level), speed=SPEED, settings=Settings(detail_step=inner))
    train.drive("emergency")
    forces, begin = [], time.process_time()
    for n in range(round(long / host)):
        train.advance(host)
        if (n + 1) % max(round(EVERY / host), 1) == 0:
            forces.append(train.coupler_force)
    cost = time.process_time() - begin
    return Stop(np.array(forces), train.largest_compression, float(train.distance[0]), cost)


def coupled(long: float, step: float) -> tuple[float, float]:
    """Return largest compression [N] and distance [m] of the train and the coach coupled by a host with a step [s]."""
    pair = mixed(screw_coupler(), 2, "corrected")
    pair.train.drive("emergency")
    for _ in range(round(long / step)):
        pair.step(step)
    return pair.train.largest_compression, float(pair.train.distance[0])


def run(options: Options, quick: bool = False) -> Report:
    steps, fine, long = (QUICK_STEPS, QUICK_FINE, QUICK_LONG) if quick else (STEPS, FINE, LONG)
    tries = [(name, step) for name in COUPLERS for step in (fine, *steps)]
    bar = counting(tries, "inner steps", unit="run")
    stops = {(name, step): emergency(COUPLERS[name], 2, step, EVERY, long) for name, step in bar}
    rows = [*error_rows(stops, steps, fine), *host_rows(long), *pair_rows(stops["screw coupler", DETAIL_STEP], long)]
    rows += [speed_row(quick), *curve_rows(), *boundary_rows()]
    parameters = {"mass": MASS, "speed": SPEED, "vehicles": VEHICLES, "place": PLACE + 1, "step": DETAIL_STEP}
    slack = stops["draft gear with slack", DETAIL_STEP].apart(stops["draft gear with slack", fine])
    said = [
        "The inner step is on the train's own clock, so that forces do not depend on the step of the host.",
        f"Couplers with slack are chaotic: forces at an instant differ by {100 * slack:.0f} % between two inner steps.",
    ]
    course = _course(stops["screw coupler", DETAIL_STEP])
    return Report(rows, course, lambda: draw(stops, steps, fine), parameters, long * len(tries), said)


def _course(stop: Stop) -> Recording:
    rows = [[(n + 1) * EVERY, force[PLACE - 1], force[PLACE]] for n, force in enumerate(stop.forces)]
    return Recording({"time": "s", "coupler_force_front": "N", "coupler_force_rear": "N"}, rows)


def error_rows(stops: dict[tuple[str, float], Stop], steps: Sequence[float], fine: float) -> list[Row]:
    """Return errors of forces against a fine inner step."""
    rows = []
    for name in COUPLERS:
        for step in steps:
            one, best = stops[name, step], stops[name, fine]
            is_due = step == DETAIL_STEP and "with slack" not in name
            asked = at_most(100 * FORCE) if is_due else None
            title = f"{name}, inner step of {1e3 * step:g} ms"
            rows.append(measured(f"{title}: error of a force", "%", 100 * one.apart(best), "of the largest", asked))
            largest = 100 * abs(one.compression / best.compression - 1.0)
            rows.append(measured(f"{title}: error of the largest compression", "%", largest, "fine inner step"))
    return rows


def host_rows(long: float) -> list[Row]:
    """Return differences of forces between steps of hosts."""
    runs = [emergency(screw_coupler(), 2, DETAIL_STEP, host, long) for host in HOSTS]
    rows = [
        measured(
            f"host's step of {1e3 * host:g} ms: forces from those of 1 ms", "1", one.apart(runs[0]), "", at_most(SAME)
        )
        for host, one in zip(HOSTS[1:], runs[1:], strict=True)
    ]
    uneven = emergency(screw_coupler(), 2, DETAIL_STEP, EVERY / 12, long).apart(runs[0])
    name = "host's step of 16.7 ms, which ends between inner steps: the same"
    return [*rows, measured(name, "1", uneven, "", at_most(SAME))]


def pair_rows(stop: Stop, long: float) -> list[Row]:
    """Return the train against the pair of FMUs that a host couples each millisecond."""
    force, distance = coupled(long, 1e-3)
    source = "train and coach coupled each 1 ms"
    asked = near(1e-3 * force, 1e-3 * PAIR * force)
    return [
        measured("largest compression", "kN", 1e-3 * stop.compression, source, asked),
        measured("distance of the head", "m", stop.distance, source, near(distance, DISTANCE)),
    ]


def speed_row(quick: bool) -> Row:
    """Return the speed of a train with one coach at level 3."""
    one = consist_of(screw_coupler(), 3).vehicles
    train = Train(Consist((*one, *[one[1]] * (LENGTH - len(one)))), speed=SPEED)
    train.drive("emergency")
    long, begin = 2.0 if quick else 10.0, time.process_time()
    train.advance(long)
    speed = long / (time.process_time() - begin)
    return measured(f"one coach at level 3 in a train of {LENGTH}: times real time", "1", speed, "", at_least(FASTER))


def curve_rows() -> list[Row]:
    """Return the coach in 3D in a curve, pushed as in freight trains."""
    free, one, due = pushed(0.0), pushed(HEAVY), 1e-3 * on_paper(HEAVY)
    name = f"curve of {RADIUS:g} m, couplers pushed by {1e-3 * HEAVY:.0f} kN"
    aside, source = 1e-3 * (one.force - free.force), "2 F a / R, couplers along the track"
    return [
        measured(f"{name}: pushed outwards", "kN", aside, source, near(due, CURVE * due)),
        measured(f"{name}: largest Y/Q", "1", one.quotient, f"{free.quotient:.3f} without"),
    ]


def boundary_rows() -> list[Row]:
    """Return largest steps of a host that couples a vehicle itself: stable ones, and those that the FMU accepts."""
    rows, vehicles = [], {"point": linear_vehicle(1), "planar": linear_vehicle(2)}
    for (name, stiffness), way in ((one, way) for one in STIFFNESS.items() for way in WAYS):
        accepted = 1e3 * ACCEPTED[way] / (2 * stiffness / MASS / (1 + ROTATING)) ** 0.5
        for level, vehicle in vehicles.items():
            stable = 1e3 * boundary(way, stiffness, vehicle)
            quantity = f"two FMUs, {way}, {name}, {level}: step that the FMU accepts"
            rows.append(measured(quantity, "ms", accepted, f"stable up to {stable:.3g} ms", at_most(stable)))
    return rows


def draw(stops: dict[tuple[str, float], Stop], steps: Sequence[float], fine: float) -> Figure:
    error = max(stops[name, DETAIL_STEP].apart(stops[name, fine]) for name in list(COUPLERS)[:-1])
    message = f"At {1e3 * DETAIL_STEP:g} ms forces err by {100 * error:.1f} %; slack is chaotic"
    titles = ("error of a force over the inner step [%]", "error over the cost [%]")
    figure, axes = charts(message, titles, (10.0, 4.8), "inner step [ms]")
    axes[1].set_xlabel("CPU time for 1 s [ms]")
    long = len(stops["screw coupler", fine].forces) * EVERY
    for name, colour, mark in zip(COUPLERS, FOUR, "o^sD", strict=True):
        errors = [100 * stops[name, step].apart(stops[name, fine]) for step in steps]
        costs = [1e3 * stops[name, step].cost / long for step in steps]
        for axis, values in zip(axes, ([1e3 * step for step in steps], costs), strict=True):
            axis.loglog(values, errors, mark + "-", color=colour, label=name)
    for axis in axes:
        axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.xaxis.set_major_formatter("{x:g}")
        axis.xaxis.set_minor_formatter("")
    axes[0].axvline(1e3 * DETAIL_STEP, color=GREY, linewidth=0.8)
    axes[0].annotate("default", (1e3 * DETAIL_STEP, 50.0), rotation=90, va="top", ha="right", fontsize=8)
    axes[0].legend(loc="lower right")
    return figure


SCENARIO = Scenario(
    "train-one-vehicle-in-detail",
    "A train with one vehicle in detail as one system: error and cost of the inner step, and slack",
    run,
)
