"""Stopping distances of trains: ten distances of the conversion model, and the spread of shunting stops.

The spread is that of 100 000 stops of a locomotive with five wagons from 25 km/h. They follow the rules of a published
program, then count the locomotive's brake once, and then delay the demand for each wagon.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from brake_controller.brake_weight import KILOMETRES_PER_HOUR, Case, stopping_distance
from fmu_src.cosimulation.recording import Recording
from scenarios.bench.shunting_stop import ONCE, PUBLISHED, SHIFTED, Array, Rules, distances
from scenarios.reporting.plots import LEADING, TRAILING, one_word, single
from scenarios.reporting.progress import counting
from scenarios.reporting.report import Report, Row, measured, near
from scenarios.scenario import Options, Scenario, Sweepable


@dataclass(frozen=True)
class Stop:
    """A stop of the conversion model: speed [km/h], percentage [%], length [m], and the independently computed distance
    [m].
    """

    case: Case
    speed: float
    percentage: float
    length: float
    distance: float


STOPS = (
    Stop(Case.EMERGENCY_PASSENGER_P, 120.0, 100.0, 400.0, 839.9),
    Stop(Case.EMERGENCY_PASSENGER_P, 120.0, 100.0, 500.0, 890.9),
    Stop(Case.EMERGENCY_FREIGHT_P, 100.0, 65.0, 700.0, 979.9),
    Stop(Case.EMERGENCY_FREIGHT_G, 100.0, 65.0, 700.0, 1086.0),
    Stop(Case.EMERGENCY_FREIGHT_P, 100.0, 90.0, 740.0, 836.2),
    Stop(Case.EMERGENCY_FREIGHT_G, 80.0, 60.0, 700.0, 790.5),
    Stop(Case.EMERGENCY_PASSENGER_P, 160.0, 135.0, 400.0, 1207.1),
    Stop(Case.SERVICE_PASSENGER_P, 120.0, 100.0, 400.0, 1025.9),
    Stop(Case.SERVICE_FREIGHT_P, 100.0, 65.0, 700.0, 1306.6),
    Stop(Case.EMERGENCY_FREIGHT_P, 90.0, 70.0, 1200.0, 1098.0),
)
#: Tolerance [m]: distances are given to 0.1 m.
BAND = 0.1


@dataclass(frozen=True)
class Printed:
    """Published results of RailProfAC/ShuntingBrakingCurves, 1e7 stops: mean, deviation, a limit [m], the share beyond
    it.
    """

    mean: float
    deviation: float
    limit: float
    beyond: float


PRINTED = {"G": Printed(64.26639, 0.81019, 65.0, 0.1826848), "P": Printed(38.34120, 0.47121, 39.0, 0.081124)}
#: Stops by the published method and with the locomotive once, stops of the distributions, and the seed of all.
FEW, MANY, SEED = 20_000, 100_000, 1
#: Tolerances: relative of a mean; relative of a standard deviation, and of a share: four standard errors of FEW stops.
MEAN_BAND, DEVIATION_BAND = 1e-3, 4 / (2 * FEW) ** 0.5
#: Bin width of the histograms [m].
BIN = 0.1

Found = Mapping[tuple[str, Rules], Array]


def share_band(share: float) -> float:
    """Return four standard errors of a share of FEW stops."""
    return float(4 * (share * (1 - share) / FEW) ** 0.5)


def one_stop(speed: float = 100.0, percentage: float = 65.0, length: float = 700.0) -> dict[str, float | None]:
    """Return distances of a freight train [m], from a speed [km/h], with a percentage [%] and a length [m]
    (SUBSET-026).
    """
    cases = {"emergency_p": Case.EMERGENCY_FREIGHT_P, "emergency_g": Case.EMERGENCY_FREIGHT_G}
    cases |= {"service_p": Case.SERVICE_FREIGHT_P, "service_g": Case.SERVICE_FREIGHT_G}
    start = speed / KILOMETRES_PER_HOUR
    return {name: stopping_distance(case, start, percentage, length) for name, case in cases.items()}


def run(options: Options) -> Report:
    found, published = {}, {}
    with counting(None, "braking-distance", total=8, unit="case") as bar:
        for name in PRINTED:
            published[name] = distances(name, PUBLISHED, FEW, SEED, published_method=True)
            bar.update()
            for rules, stops in ((PUBLISHED, MANY), (ONCE, FEW), (SHIFTED, MANY)):
                found[name, rules] = distances(name, rules, stops, SEED)
                bar.update()
    rows = [model_row(stop) for stop in STOPS]
    rows += [row for name, stops in published.items() for row in published_rows(name, stops)]
    rows += [row for name in PRINTED for row in beside_rows(name, found)]
    stops_of = [[stop.case.name, stop.speed, stop.percentage, stop.length] for stop in STOPS]
    parameters = {"stops": stops_of, "stops_published_method": FEW, "stops_distribution": MANY, "seed": SEED}
    said = [
        f"{message(found)} than the published ones, for a locomotive with five wagons. Our rules count the "
        "locomotive's brake once, and the demand comes later to each wagon; as read here, the published rules count it "
        "twice."
    ]
    return Report(rows, histogram(found), lambda: draw(found), parameters, 0.0, said)


def model_row(stop: Stop) -> Row:
    """Return one distance of the conversion model."""
    words = stop.case.name.lower().replace("_", " ")[:-1] + stop.case.name[-1]
    quantity = f"{words}, {stop.speed:g} km/h, {stop.percentage:g} %, {stop.length:g} m: distance"
    value = stopping_distance(stop.case, stop.speed / KILOMETRES_PER_HOUR, stop.percentage, stop.length)
    source = "SUBSET-026 A.3.7 to A.3.9, v T and v^2 / 2 a over its steps, computed apart"
    return measured(quantity, "m", value, source, near(stop.distance, BAND))


def published_rows(name: str, stops: Array) -> list[Row]:
    """Return the published program's stop, by its rules and its method."""
    printed, source = PRINTED[name], "RailProfAC/ShuntingBrakingCurves, 1e7 stops"
    beyond = f"{name}, as published: share beyond {printed.limit:g} m"
    share = float(np.mean(stops > printed.limit))
    deviation = near(printed.deviation, DEVIATION_BAND * printed.deviation)
    mean = near(printed.mean, MEAN_BAND * printed.mean)
    return [
        measured(f"{name}, as published: mean distance", "m", np.mean(stops), source, mean),
        measured(f"{name}, as published: standard deviation", "m", np.std(stops), source, deviation),
        measured(beyond, "1", share, source, near(printed.beyond, share_band(printed.beyond))),
    ]


def beside_rows(name: str, found: Found) -> list[Row]:
    """Return the same stop by a method of second order, and by other rules."""
    printed = PRINTED[name].mean
    asked, source = near(printed, MEAN_BAND * printed), "RailProfAC/ShuntingBrakingCurves; its method is of first order"
    means = {rules: float(np.mean(found[name, rules])) for rules in (PUBLISHED, ONCE, SHIFTED)}
    computed, longer = "computed here", f"{means[SHIFTED] / means[PUBLISHED]:.2f} times as far as published"
    return [
        measured(f"{name}, published rules: mean, second order", "m", means[PUBLISHED], source, asked),
        measured(f"{name}, locomotive once: mean", "m", means[ONCE], computed, None, "printed nowhere"),
        measured(f"{name}, locomotive once, true delay: mean", "m", means[SHIFTED], computed, None, longer),
    ]


def histogram(found: Found) -> Recording:
    """Return the share of stops over distance, for each distribution."""
    least = min(float(np.min(stops)) for stops in found.values())
    most = max(float(np.max(stops)) for stops in found.values())
    edges = np.arange(np.floor(least), np.ceil(most) + BIN, BIN)
    series = Recording({"distance": "m"}, ((edges[1:] + edges[:-1]) / 2)[:, None])
    words = {PUBLISHED: "published", ONCE: "locomotive_once", SHIFTED: "true_delay"}
    for (name, rules), stops in found.items():
        series.add(f"density_{name}_{words[rules]}", "1/m", np.histogram(stops, edges, density=True)[0])
    return series


def missing(name: str, found: Found) -> float:
    """Return by how much our rules lengthen the mean of the published ones [m]."""
    return float(np.mean(found[name, SHIFTED]) - np.mean(found[name, PUBLISHED]))


def message(found: Found) -> str:
    """Return the title of the figure."""
    said = " and ".join(f"{one_word(f'{missing(name, found):.0f} m')} ({name})" for name in PRINTED)
    return f"From {one_word('25 km/h')} our rules stop {said} longer"


def draw(found: Found) -> Figure:
    figure, axis = single(message(found), "stopping distance [m]", "share of stops in a metre [1/m]")
    for name in PRINTED:
        for rules, colour, words in ((PUBLISHED, TRAILING, "published"), (SHIFTED, LEADING, "once, with its delays")):
            draw_distribution(axis, found[name, rules], colour, f"{name}, {words}")
        draw_gap(axis, name, found)
    axis.set_ylim(bottom=0.0, top=1.05)
    return figure


def draw_distribution(axis: Axes, stops: Array, colour: str, words: str) -> None:
    """Draw a histogram, its mean as a line, and its name above it."""
    mean = float(np.mean(stops))
    edges = np.arange(np.min(stops), np.max(stops) + BIN, BIN)
    heights, _, _ = axis.hist(stops, edges.tolist(), density=True, histtype="stepfilled", color=colour, alpha=0.45)
    axis.plot([mean, mean], [0.0, np.max(heights)], color=colour)
    place = (mean, float(np.max(heights)))
    text = f"{words}\n{mean:.1f} m"
    axis.annotate(text, place, (0, 4), textcoords="offset points", ha="center", color=colour, fontsize=8.5)


def draw_gap(axis: Axes, name: str, found: Found) -> None:
    """Draw an arrow between both means of a position."""
    ends = [float(np.mean(found[name, rules])) for rules in (PUBLISHED, SHIFTED)]
    height = 0.15
    axis.annotate("", (ends[1], height), (ends[0], height), arrowprops={"arrowstyle": "->"})
    axis.annotate(f"+{ends[1] - ends[0]:.1f} m", (sum(ends) / 2, height + 0.015), ha="center", fontsize=9)


SWEEP = Sweepable(
    {"speed": "km/h", "percentage": "%", "length": "m"},
    {"emergency_p": "m", "emergency_g": "m", "service_p": "m", "service_g": "m"},
    one_stop,
)

SCENARIO = Scenario(
    "braking-distance",
    "Stopping distances by brake weight percentage, and 100 000 shunting stops by a published program's rules",
    run,
    sweep=SWEEP,
)
