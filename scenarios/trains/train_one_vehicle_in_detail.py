"""One vehicle of a train in detail, the others as points: where to couple them, and a coupling that fails."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import FOUR, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.train.train import Train
from rbd_model.train.coupler import screw_coupler
from scenarios.bench.mixed_train import (
    MASS,
    PLACE,
    SPEED,
    VEHICLES,
    WAYS,
    MixedTrain,
    boundary,
    consist_of,
    found_boundary,
    linear_vehicle,
    mixed,
)
from scenarios.bench.pushed_in_a_curve import RADIUS, on_paper, pushed

#: Macro steps [s]; that of the rows, and the fine one of the reference; duration of an emergency from SPEED [s].
STEPS = (5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2)
SHOWN, FINE, LONG = 1e-3, 1e-4, 12.0
#: Those of a quick run.
QUICK_STEPS, QUICK_FINE, QUICK_LONG = (1e-3, 1e-2), 5e-4, 6.0
#: Tolerances: of the largest compression [1], of the distance [m], of a boundary [1].
FORCE, DISTANCE, BOUNDARY = 0.01, 0.01, 0.05
#: Sticking stiffnesses whose boundaries are determined: screw couplers, and draft gears, in a quick run alone [N/m].
STIFFNESS = {"screw coupler, 50 MN/m": 50e6, "draft gear, 198 MN/m": 198e6}
DEFAULT = "corrected"
#: A compression of freight trains [N], and relative tolerance of the lateral force in a curve.
HEAVY, CURVE = 300e3, 5e-3
LEVELS = {1: "point", 2: "planar"}


@dataclass(frozen=True)
class MixedStop:
    """Results of a run: largest compression [N], distance of the head [m], times and forces at both couplers."""

    compression: float
    distance: float
    course: Recording


def emergency(level: int, way: str, size: float, long: float) -> MixedStop:
    """Brake the mixed train."""
    one = mixed(screw_coupler(), level, way)
    one.train.drive("emergency")
    for _ in range(round(long / size)):
        one.step(size)
    return MixedStop(one.train.largest_compression, float(one.train.distance[0]), _course(one, size))


def _course(mixed_train: MixedTrain, size: float) -> Recording:
    rows = [[(n + 1) * size, force[PLACE - 1], force[PLACE]] for n, force in enumerate(mixed_train.forces)]
    return Recording({"time": "s", "coupler_force_front": "N", "coupler_force_rear": "N"}, rows)


def monolithic(long: float) -> tuple[float, float]:
    """Return largest compression [N] and distance of the head [m] of a system with all vehicles as points."""
    train = Train(consist_of(screw_coupler()), speed=SPEED)
    train.drive("emergency")
    for _ in range(round(long / SHOWN)):
        train.advance(SHOWN)
    return train.largest_compression, float(train.distance[0])


def run(options: Options, quick: bool = False) -> Report:
    steps, fine, long = (QUICK_STEPS, QUICK_FINE, QUICK_LONG) if quick else (STEPS, FINE, LONG)
    whole = monolithic(long)
    planar = emergency(2, "held", fine, long)
    tries = [(way, size) for way in WAYS for size in steps]
    stops = {(way, size): emergency(1, way, size, long) for way, size in counting(tries, "macro steps", unit="run")}
    shown = emergency(2, DEFAULT, SHOWN, long)
    borders = find_boundaries(list(STIFFNESS)[-1:] if quick else list(STIFFNESS))
    rows = [*default_rows(whole, stops[DEFAULT, SHOWN], planar, shown), *boundary_rows(borders)]
    rows += curve_rows(stops[DEFAULT, SHOWN].compression)
    for (way, size), stop in stops.items():
        error = 100 * (stop.compression / whole[0] - 1)
        rows.append(measured(f"{way}, {1e3 * size:g} ms: error of the largest compression", "%", error, "point"))
    parameters = {"mass": MASS, "speed": SPEED, "vehicles": VEHICLES, "place": PLACE + 1}
    said = [
        f"With '{DEFAULT}', the default, a macro step of {1e3 * SHOWN:g} ms errs by "
        f"{100 * abs(stops[DEFAULT, SHOWN].compression / whole[0] - 1):.2f} % of the largest compression.",
        "'mean' and 'jacobi' grow at any step until friction of the couplers holds them: they lie without blowing up.",
    ]
    seconds = long * (2 + len(tries) + 1)
    return Report(rows, shown.course, lambda: draw(stops, whole, steps), parameters, seconds, said)


def default_rows(whole: tuple[float, float], point: MixedStop, planar: MixedStop, shown: MixedStop) -> list[Row]:
    """Return the default method against one system, and at the planar level against a fine step of another method."""
    rows = []
    pairs = (
        ("point", whole, point, "all in one system"),
        ("planar", (planar.compression, planar.distance), shown, "held, 0.1 ms"),
    )
    for level, (force, distance), stop, source in pairs:
        name = f"{level}, default at {1e3 * SHOWN:g} ms"
        asked = near(1e-3 * force, 1e-3 * FORCE * force)
        rows.append(measured(f"{name}: largest compression", "kN", 1e-3 * stop.compression, source, asked))
        rows.append(measured(f"{name}: distance of the head", "m", stop.distance, source, near(distance, DISTANCE)))
    return rows


def curve_rows(compression: float) -> list[Row]:
    """Return the coach in 3D in a curve, pushed as in the train, and as much as in freight trains."""
    rows = []
    free = pushed(0.0)
    for force in (compression, HEAVY):
        one, due = pushed(force), 1e-3 * on_paper(force)
        name = f"curve of {RADIUS:g} m, couplers pushed by {1e-3 * force:.0f} kN"
        aside, source = 1e-3 * (one.force - free.force), "2 F a / R, couplers along the track"
        rows.append(measured(f"{name}: pushed outwards", "kN", aside, source, near(due, CURVE * due)))
        rows.append(measured(f"{name}: largest Y/Q", "1", one.quotient, f"{free.quotient:.3f} without"))
    return rows


@dataclass(frozen=True)
class Border:
    """Largest stable macro step [s] with a linear coupler, by theory and by simulation."""

    paper: float
    found: float


def find_boundaries(couplers: Sequence[str]) -> dict[tuple[str, str, int], Border]:
    """Return the boundaries of the methods that have one, by coupler, method and level."""
    found = {}
    places = [(level, way) for level in LEVELS for way in ("held", "extrapolated")] + [(2, DEFAULT)]
    bar = counting([(name, *place) for name in couplers for place in places], "boundaries", unit="boundary")
    vehicles = {level: linear_vehicle(level) for level in LEVELS}
    for name, level, way in bar:
        paper = boundary(way, STIFFNESS[name], vehicles[level])
        found[name, way, level] = Border(paper, found_boundary(way, level, STIFFNESS[name], paper))
    return found


def boundary_rows(borders: Mapping[tuple[str, str, int], Border]) -> list[Row]:
    rows = []
    for (name, way, level), one in borders.items():
        asked = near(1e3 * one.paper, 1e3 * BOUNDARY * one.paper)
        quantity = f"{name}, {way}, {LEVELS[level]}: largest stable macro step"
        rows.append(measured(quantity, "ms", 1e3 * one.found, "eigenvalues of a macro step, exact Jacobian", asked))
    smallest = 1e3 * min(one.paper for (_, way, _), one in borders.items() if way == DEFAULT)
    quantity = f"default step over the smallest boundary of '{DEFAULT}'"
    return [*rows, measured(quantity, "1", 1e3 * SHOWN / smallest, "eigenvalues", at_most(0.5))]


def draw(stops: Mapping[tuple[str, float], MixedStop], whole: tuple[float, float], sizes: Sequence[float]) -> Figure:
    corrected, held = (100 * abs(stops[way, sizes[-1]].distance - whole[1]) for way in (DEFAULT, "held"))
    steps = [1e3 * size for size in sizes]
    message = f"At {steps[-1]:g} ms {DEFAULT} copies err by {corrected:.0f} cm, held {held:.0f} cm"
    titles = ("error of the largest compression [%]", "error of the distance [cm]")
    figure, axes = charts(message, titles, (10.0, 4.8), "macro step [ms]")
    for way, colour, mark in zip(WAYS, (*FOUR, GREY), "o^sDv", strict=True):
        force = [max(100 * abs(stops[way, size].compression / whole[0] - 1), 1e-3) for size in sizes]
        distance = [max(100 * abs(stops[way, size].distance - whole[1]), 1e-3) for size in sizes]
        label = f"{way} (default)" if way == DEFAULT else way
        for axis, errors in zip(axes, (force, distance), strict=True):
            axis.loglog(steps, errors, mark + "-", color=colour, label=label)
    for axis, asked, name in zip(axes, (100 * FORCE, 100 * DISTANCE), ("1 %", "1 cm"), strict=True):
        axis.axhline(asked, color=GREY, linewidth=0.8)
        axis.annotate(f"asked: {name}", (steps[-1], asked), va="bottom", ha="right", fontsize=8)
    axes[0].legend(loc="upper left", bbox_to_anchor=(0.0, 0.9))
    return figure


SCENARIO = Scenario(
    "train-one-vehicle-in-detail",
    "A train with one vehicle in detail at its two couplers: where to couple them, and a coupling that fails",
    run,
)
