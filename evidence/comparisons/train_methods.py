"""Integrators of a train: explicit steps with a bound, implicit ones, CVODE and LSODA, by counted work."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import FOUR, THESIS, single
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, between, measured
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.peers import sundials
from evidence.peers.train_couplers import (
    LOADS,
    LONG,
    RECORDED,
    SPEED,
    WAGONS,
    BrakedTrain,
    Costs,
    CouplerRun,
    braked_train,
    measured_costs,
)
from fmu_src.cosimulation.recording import Recording
from products.train.numbers import SHARE

#: Settings of the methods: shares of the longest stable step; steps [s]; steps in one of the pipe; tolerances.
SHARES = (0.02, 0.05, 0.1, 0.2, 0.3, SHARE, 0.5, 0.6, 0.8, 1.0, 1.5, 2.0)
STEPS = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3, 7e-3, 8e-3, 1e-2, 1.4e-2, 2e-2, 2.5e-2, 3e-2)
COUNTS = (1, 2, 5, 10, 20, 50, 100)
TOLERANCES = (1e-3, 3e-4, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
EXPLICIT, EULER, MIDPOINT, SPLIT = "explicit", "implicit Euler", "implicit midpoint", "split at the pipe"
#: Share that checks the reference; share with wrong results.
CHECK, LYING = 0.002, 2.0
#: Trains of few empty wagons, whose slack is chaotic: number of wagons, share of the steps, changes of their brakes
#: [1].
FEW, STEADY, CHANGES = (10, 20, WAGONS), 0.004, (1e-12, 1e-10, 1e-8)
#: Limits [1]: errors of the largest compression, of the head's distance, and of two references; errors of a wrong run
#: and of a diverged one.
FORCE, DISTANCE, AGREE, LIE, BLOWN = 0.01, 1e-4, 1e-4, 0.05, 1.0
#: Settings of a quick run, of one train of few wagons.
QUICK, QUICK_FEW = {EXPLICIT: (SHARE, LYING), EULER: STEPS[-1:], MIDPOINT: (4e-3,), SPLIT: (5,)}, FEW[:1]
QUICK |= {"CVODE": (1e-4,), "LSODA": (1e-4,)}
EMPTY = next(name for name, load in LOADS.items() if load == 0.0)
Work = Callable[[BrakedTrain, float], CouplerRun]
METHODS: dict[str, tuple[Work, tuple[float, ...], str]] = {
    EXPLICIT: (BrakedTrain.explicit, SHARES, "share {:g}"),
    EULER: (BrakedTrain.implicit, STEPS, "{:g} s"),
    MIDPOINT: (lambda train, size: train.implicit(size, 0.5), STEPS, "{:g} s"),
    SPLIT: (lambda train, count: train.split(round(count)), COUNTS, "{:g} in one of its steps"),
    "CVODE": (BrakedTrain.cvode, TOLERANCES, "tolerance {:g}"),
    "LSODA": (BrakedTrain.lsoda, TOLERANCES, "tolerance {:g}"),
}

STYLES = {EXPLICIT: "o-", EULER: "^--", MIDPOINT: "v-", SPLIT: "s:", "CVODE": "D-.", "LSODA": "P:"}


@dataclass(frozen=True)
class TrainPoint:
    """A method at one setting on one train: errors of force and distance [1], cost [s]; NaN if it failed."""

    force: float
    distance: float
    cost: float
    reason: str = ""

    @property
    def meets(self) -> bool:
        """Return whether both errors are within their limits."""
        return self.force <= FORCE and self.distance <= DISTANCE


#: Points by method and setting, then by train.
Points = Mapping[tuple[str, float], Mapping[str, TrainPoint]]


@dataclass(frozen=True)
class TrainStudy:
    """Both trains by all methods; apart: the product's finest steps against the reference, which is the source.

    scatter: of the largest compression, by number of wagons [1].
    """

    points: Points
    apart: Mapping[str, TrainPoint]
    scatter: Mapping[int, float]
    costs: Costs
    source: str

    @property
    def default(self) -> Mapping[str, TrainPoint]:
        return self.points[EXPLICIT, SHARE]

    def both(self, method: str) -> dict[float, TrainPoint]:
        """Return the larger errors and the cost of both trains, by setting."""
        return {at: _joined(list(trains.values())) for (name, at), trains in self.points.items() if name == method}

    def cheapest(self, train: str | None = None, explicit: bool = False, safe: bool = False) -> tuple[float, str]:
        """Return the cheapest setting that meets the limits: cost [s], and its name."""
        found = []
        for method in METHODS:
            own = self.both(method)
            if train is not None:
                own = {setting: self.points[method, setting][train] for setting in own}
            for setting, one in own.items():
                dearer = [other for other in own.values() if other.cost >= one.cost and not other.reason]
                fits = all(other.meets for other in dearer) if safe else True
                if (method == EXPLICIT) is explicit and one.meets and fits:
                    found.append((one.cost, f"{method}, {METHODS[method][2].format(setting)}"))
        return min(found)

    def ratio(self, train: str | None = None, safe: bool = False) -> tuple[float, str]:
        """Return the cost of the cheapest other method over the default's, and its name."""
        cost, name = self.cheapest(train, safe=safe)
        own = _joined(list(self.default.values())) if train is None else self.default[train]
        return cost / own.cost, name


def _joined(points: list[TrainPoint]) -> TrainPoint:
    """Return the larger errors of several trains, and the cost of all."""
    reason = next((point.reason for point in points if point.reason), "")
    force, distance = max(one.force for one in points), max(one.distance for one in points)
    if reason:
        force = distance = math.nan
    return TrainPoint(force, distance, sum(one.cost for one in points), reason)


def study(quick: bool) -> tuple[TrainStudy, Mapping[str, BrakedTrain]]:
    trains = {name: braked_train(load) for name, load in LOADS.items()}
    costs = measured_costs(trains[EMPTY].consist)
    references = {name: one.reference() for name, one in counting(trains.items(), "references", unit="train")}
    apart = {name: _point(one.explicit(CHECK), references[name][0], costs) for name, one in trains.items()}
    scatter = {few: braked_train(LOADS[EMPTY], few).scatter(STEADY, CHANGES) for few in (QUICK_FEW if quick else FEW)}
    points: dict[tuple[str, float], dict[str, TrainPoint]] = {}
    works = [(method, name) for method in METHODS for name in LOADS if method != "CVODE" or sundials.is_installed()]
    for method, name in counting(works, "methods", unit="train"):
        settings = QUICK[method] if quick else METHODS[method][1]
        for setting, point in _along(method, settings, trains[name], references[name][0], costs).items():
            points.setdefault((method, setting), {})[name] = point
    return TrainStudy(points, apart, scatter, costs, references[EMPTY][1]), trains


def _along(
    method: str, settings: Sequence[float], train: BrakedTrain, reference: CouplerRun, costs: Costs
) -> dict[float, TrainPoint]:
    """Return all settings; after one over the work limit, finer ones are not run."""
    work = METHODS[method][0]
    found: dict[float, TrainPoint] = {}
    given_up = ""
    for setting in settings:
        one = CouplerRun(math.nan, math.nan, reason=given_up) if given_up else work(train, setting)
        given_up = given_up or ("not tried, as a coarser one was given up" if one.reason else "")
        found[setting] = _point(one, reference, costs)
    return found


def _point(coupler_run: CouplerRun, reference: CouplerRun, costs: Costs) -> TrainPoint:
    force, distance = coupler_run.compression / reference.compression - 1, coupler_run.distance / reference.distance - 1
    return TrainPoint(abs(force), abs(distance), costs.of(coupler_run), coupler_run.reason)


def run(options: Options, quick: bool = False) -> Report:
    found, trains = study(quick)
    rows = [*judged_rows(found), *alone_rows(found), *cost_rows(found), *point_rows(found)]
    parameters = {"speed": SPEED, "wagons": WAGONS, "time": LONG, "loads": dict(LOADS), "share": SHARE}
    runs = len(LOADS) * (len(found.points) + 2)
    loaded = brakes_of(trains[next(iter(LOADS))])
    return Report(rows, loaded, lambda: draw(found), parameters, LONG * runs, remarks(found))


def brakes_of(train: BrakedTrain) -> Recording:
    """Return the capacity of the brakes, the input of all methods."""
    rows = [[n * RECORDED, row[0], row[len(row) // 2], row[-1]] for n, row in enumerate(train.brake)]
    return Recording({"time": "s", "brake_head": "N", "brake_middle": "N", "brake_end": "N"}, rows)


def judged_rows(found: TrainStudy) -> list[Row]:
    rows = []
    for name, one in found.default.items():
        apart, checked = found.apart[name], f"{found.source}, against explicit, share {CHECK:g}"
        for text, error, band, source in (
            ("references apart, of the largest compression", apart.force, AGREE, checked),
            ("default, error of the largest compression", one.force, FORCE, found.source),
            ("default, error of the head's distance", one.distance, DISTANCE, found.source),
        ):
            rows.append(measured(f"{name}: {text}", "%", 100 * error, source, at_most(100 * band)))
    lie = found.points[EXPLICIT, LYING][EMPTY].force
    text = f"{EMPTY}: explicit at share {LYING:g}, error of the largest compression"
    rows.append(measured(text, "%", 100 * lie, "it lies without blowing up", between(100 * LIE, 100 * BLOWN)))
    return [*rows, *ratio_rows(found)]


def ratio_rows(found: TrainStudy) -> list[Row]:
    """Return other methods against the default and explicit steps, with one setting for both trains, also where finer
    runs pass too.
    """
    rows = []
    for safe, text in ((False, "cheapest other method"), (True, "cheapest other method whose finer settings hold too")):
        ratio, which = found.ratio(safe=safe)
        source = f"{which}; one setting for both trains; counted work times measured costs"
        rows.append(measured(f"{text}, over the default", "1", ratio, source))
    (other, which), (own, by) = found.cheapest(), found.cheapest(explicit=True)
    text = "cheapest other method, over the cheapest explicit steps"
    return [*rows, measured(text, "1", other / own, f"{which}; {by}; one setting for both trains")]


def alone_rows(found: TrainStudy) -> list[Row]:
    """Return the rows of each train by itself: other methods against the default, and the cheapest explicit steps."""
    rows = []
    for name in LOADS:
        ratio, which = found.ratio(name)
        (other, _), (own, by) = found.cheapest(name), found.cheapest(name, explicit=True)
        text = f"{name} alone: cheapest other method over"
        rows.append(measured(f"{text} the default", "1", ratio, which))
        rows.append(measured(f"{text} the cheapest explicit steps", "1", other / own, f"{which}; {by}"))
    return rows


def cost_rows(found: TrainStudy) -> list[Row]:
    """Return the measured costs, and the scatter due to slack."""
    rows = [
        measured("one evaluation of all couplers and vehicles", "us", 1e6 * found.costs.evaluation, "measured"),
        measured("one tridiagonal solution", "us", 1e6 * found.costs.solve, "measured"),
    ]
    for few, scatter in found.scatter.items():
        text = f"{few} wagons, {EMPTY}: scatter of the largest compression"
        about = f"brakes changed by up to {max(CHANGES):g}; explicit, share {STEADY:g}"
        rows.append(measured(text, "%", 100 * scatter, about))
    apart = 100 * found.apart[EMPTY].distance
    return [*rows, measured(f"{EMPTY}: references apart, of distance", "%", apart, found.source)]


def point_rows(found: TrainStudy) -> list[Row]:
    rows = []
    for (method, setting), trains in found.points.items():
        for name, one in trains.items():
            text = f"{name}: {method}, {METHODS[method][2].format(setting)}: error of the largest compression"
            about = one.reason or f"distance {one.distance:.1e}, cost {1e3 * one.cost:.3g} ms"
            rows.append(measured(text, "%", None if one.reason else 100 * one.force, about))
    return rows


def remarks(found: TrainStudy) -> list[str]:
    met = max(share for share, one in found.both(EXPLICIT).items() if one.meets)
    ratio, which = found.ratio()
    chaotic = {few: scatter for few, scatter in found.scatter.items() if scatter > FORCE}
    remarks = [
        "Costs are counted, not timed: evaluations and solutions of each method, times what one of each takes in C, "
        "which is measured. A solution is charged as tridiagonal whatever a method solves; factors that CVODE makes "
        "anew without a Jacobian, and Newton's iterations of LSODA, are not charged.",
        f"With one setting for both trains the cheapest other method is {which}: {ratio:.2g} times the default's cost.",
        f"Explicit steps met both bands up to a share of {met:g}; the default is {SHARE:g}.",
    ]
    for name in LOADS:
        other, who = found.ratio(name)
        cost, by = found.cheapest(name, explicit=True)
        if other < 1.0:
            own = cost / found.default[name].cost
            remarks.append(f"{name} alone: {who} takes {other:.2g} of the default's cost; {by}, {own:.2g}.")
    for few, scatter in chaotic.items():
        remarks.append(
            f"Slack makes {few} empty wagons chaotic: brakes that differ by {max(CHANGES):g} at most change the "
            f"largest compression by {100 * scatter:.2g} %. No integrator gives it to 1 %."
        )
    return remarks


def draw(found: TrainStudy) -> Figure:
    figure, axis = single(
        f"The cheapest other method costs {found.ratio()[0]:.1f} times explicit steps to {100 * FORCE:g} %",
        "error of the largest compression, the worse of both trains [%]",
        f"cost of {LONG:g} s of both trains, counted work in C [ms]",
    )
    colours = dict(zip(METHODS, (FOUR[0], FOUR[3], FOUR[1], FOUR[2], THESIS, GREY), strict=True))
    for method in METHODS:
        points = [one for one in found.both(method).values() if not one.reason]
        at = [[100 * point.force for point in points], [1e3 * one.cost for one in points]]
        width = 3.0 if method == EXPLICIT else 1.3
        axis.loglog(*at, STYLES[method], color=colours[method], markersize=5, linewidth=width, label=method)
    axis.axvline(100 * FORCE, color=GREY, linewidth=0.8)
    across = axis.get_xaxis_transform()
    axis.annotate("asked: 1 %", (100 * FORCE, 0.01), (4, 2), xycoords=across, textcoords="offset points")
    mark_default(found, axis)
    axis.legend(loc="upper right")
    return figure


def mark_default(found: TrainStudy, axis: Axes) -> None:
    one = found.both(EXPLICIT)[SHARE]
    place = (100 * one.force, 1e3 * one.cost)
    axis.plot(*place, "o", markersize=14, markerfacecolor="none", color=GREY)
    axis.annotate(f"default, share {SHARE:g}", place, (-10, -22), ha="right", textcoords="offset points")


SCENARIO = Scenario(
    "train-methods",
    "Integrators of a train: explicit steps with a bound, implicit ones, CVODE and LSODA, by counted work",
    run,
)
