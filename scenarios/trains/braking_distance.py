"""Stopping distances of trains: ten distances of the conversion model, and the spread of shunting stops.

The spread is that of 100 000 stops of a locomotive with five wagons from 25 km/h. They follow the rules of a published
program, then count the locomotive's brake once, and then delay the demand for each wagon.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, TRAILING, one_word, single
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Bound, Report, Row, measured, near
from bogie_braking.reporting.scenario import Options, Scenario, Sweepable
from brake_controller.brake_weight import KILOMETRES_PER_HOUR, BrakingKind, stopping_distance
from fmu_src.cosimulation.recording import Recording
from scenarios.bench.shunting_stop import ONCE, PUBLISHED, SHIFTED, Array, distances
from scenarios.benchmark.case import CasePoint
from scenarios.benchmark.case_file import CASES, read_case
from scenarios.benchmark.own.percentage import answer

#: Benchmark cases of the ten distances, and of the shunting stops: G, then P.
DISTANCES, SHUNTING = (read_case(CASES / f"{name}.toml") for name in ("conversion-model", "railprofac-shunting"))
PRINTED = dict(zip(("G", "P"), SHUNTING.points, strict=True))
#: Inputs of the rules in the place of published ones, by the names of the series.
RULES = {"published": PUBLISHED, "locomotive_once": ONCE, "true_delay": SHIFTED}
#: Stops by the published method and with the locomotive once, stops of the distributions (FEW in a quick run
#: too), and the seed of all.
FEW, MANY, SEED = 20_000, 100_000, 1
#: Tolerance of a standard deviation, relative: four standard errors of FEW stops, as of a share.
DEVIATION_BAND = 4 / (2 * FEW) ** 0.5
#: Bin width of the histograms [m].
BIN = 0.1

Found = Mapping[tuple[str, str], Array]


def share_band(share: float) -> float:
    """Return four standard errors of a share of FEW stops."""
    return float(4 * (share * (1 - share) / FEW) ** 0.5)


def one_stop(speed: float = 100.0, percentage: float = 65.0, length: float = 700.0) -> dict[str, float | None]:
    """Return distances of a freight train [m], from a speed [km/h], with a percentage [%] and a length [m]
    (SUBSET-026).
    """
    cases = {"emergency_p": BrakingKind.EMERGENCY_FREIGHT_P, "emergency_g": BrakingKind.EMERGENCY_FREIGHT_G}
    cases |= {"service_p": BrakingKind.SERVICE_FREIGHT_P, "service_g": BrakingKind.SERVICE_FREIGHT_G}
    start = speed / KILOMETRES_PER_HOUR
    return {name: stopping_distance(case, start, percentage, length) for name, case in cases.items()}


def run(options: Options, quick: bool = False) -> Report:
    found, published, many = {}, {}, FEW if quick else MANY
    with counting(None, "braking-distance", total=8, unit="case") as bar:
        for name, point in PRINTED.items():
            published[name] = distances(point.inputs, FEW, SEED, published_method=True)
            bar.update()
            for (rules, own), stops in zip(RULES.items(), (many, FEW, many), strict=True):
                found[name, rules] = distances({**point.inputs, **own}, stops, SEED)
                bar.update()
    rows = [model_row(point) for point in DISTANCES.points]
    rows += [row for name, stops in published.items() for row in published_rows(name, stops)]
    rows += [row for name in PRINTED for row in beside_rows(name, found)]
    stops_of = [list(point.inputs.values()) for point in DISTANCES.points]
    parameters = {"stops": stops_of, "stops_published_method": FEW, "stops_distribution": many, "seed": SEED}
    said = [
        f"{message(found)} than the published ones, for a locomotive with five wagons. Our rules count the "
        "locomotive's brake once, and the demand comes later to each wagon; as read here, the published rules count it "
        "twice."
    ]
    return Report(rows, histogram(found), lambda: draw(found), parameters, 0.0, said)


def model_row(point: CasePoint) -> Row:
    """Return one distance of the conversion model."""
    of: Mapping[str, Any] = point.inputs
    speed, percentage = KILOMETRES_PER_HOUR * of["speed"], 100 * of["percentage"]
    words = f"{of['braking']} {of['train']} {of['position']}"
    quantity = f"{words}, {speed:g} km/h, {percentage:g} %, {of['length']:g} m: distance"
    bound = DISTANCES.answers["distance"].bound or 0.0
    asked = near(point.published["distance"], bound)
    return measured(quantity, "m", answer(of)["distance"], DISTANCES.source, asked)


def published_rows(name: str, stops: Array) -> list[Row]:
    """Return the published program's stop, by its rules and its method."""
    inputs: Mapping[str, Any] = PRINTED[name].inputs
    printed, source = PRINTED[name].published, "RailProfAC/ShuntingBrakingCurves, 1e7 stops"
    beyond = f"{name}, as published: share beyond {inputs['limit']:g} m"
    share = float(np.mean(stops > inputs["limit"]))
    deviation = near(printed["deviation"], DEVIATION_BAND * printed["deviation"])
    return [
        measured(f"{name}, as published: mean distance", "m", np.mean(stops), source, mean_asked(name)),
        measured(f"{name}, as published: standard deviation", "m", np.std(stops), source, deviation),
        measured(beyond, "1", share, source, near(printed["share"], share_band(printed["share"]))),
    ]


def mean_asked(name: str) -> Bound:
    """Return the tolerance of a published mean."""
    printed, bound = PRINTED[name].published["mean"], SHUNTING.answers["mean"].bound or 0.0
    return near(printed, bound * printed)


def beside_rows(name: str, found: Found) -> list[Row]:
    """Return the same stop by a method of second order, and by other rules."""
    source = "RailProfAC/ShuntingBrakingCurves; its method is of first order"
    means = {rules: float(np.mean(found[name, rules])) for rules in RULES}
    computed, longer = "computed here", f"{means['true_delay'] / means['published']:.2f} times as far as published"
    return [
        measured(f"{name}, published rules: mean, second order", "m", means["published"], source, mean_asked(name)),
        measured(f"{name}, locomotive once: mean", "m", means["locomotive_once"], computed, None, "printed nowhere"),
        measured(f"{name}, locomotive once, true delay: mean", "m", means["true_delay"], computed, None, longer),
    ]


def histogram(found: Found) -> Recording:
    """Return the share of stops over distance, for each distribution."""
    least = min(float(np.min(stops)) for stops in found.values())
    most = max(float(np.max(stops)) for stops in found.values())
    edges = np.arange(np.floor(least), np.ceil(most) + BIN, BIN)
    series = Recording({"distance": "m"}, ((edges[1:] + edges[:-1]) / 2)[:, None])
    for (name, rules), stops in found.items():
        series.add(f"density_{name}_{rules}", "1/m", np.histogram(stops, edges, density=True)[0])
    return series


def missing(name: str, found: Found) -> float:
    """Return by how much our rules lengthen the mean of the published ones [m]."""
    return float(np.mean(found[name, "true_delay"]) - np.mean(found[name, "published"]))


def message(found: Found) -> str:
    """Return the title of the figure."""
    said = " and ".join(f"{one_word(f'{missing(name, found):.0f} m')} ({name})" for name in PRINTED)
    return f"From {one_word('25 km/h')} our rules stop {said} longer"


def draw(found: Found) -> Figure:
    figure, axis = single(message(found), "stopping distance [m]", "share of stops in a metre [1/m]")
    for name in PRINTED:
        for rules, colour, words in (
            ("published", TRAILING, "published"),
            ("true_delay", LEADING, "once, with its delays"),
        ):
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
    ends = [float(np.mean(found[name, rules])) for rules in ("published", "true_delay")]
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
