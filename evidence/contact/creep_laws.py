"""Creep laws compared with Kalker's exact theory: the error of each over its cost as compiled C."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bogie_braking.reporting.plots import label_edges, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Bound, Report, Row, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.measuring import exact_states
from evidence.measuring.creep_cost import cost, values, with_coefficients
from fmu_src.cosimulation.recording import Recording
from rbd_model.contact.creep.exact_table import exact_law
from rbd_model.contact.creep.fastrip import fastrip
from rbd_model.contact.creep.fastsim import fastsim
from rbd_model.contact.creep.johnson_vermeulen import johnson_vermeulen
from rbd_model.contact.creep.kalker_linear import kalker_linear
from rbd_model.contact.creep.kalker_to_coulomb import kalker_to_coulomb
from rbd_model.contact.creep.law import CreepLaw
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.creep.shen_hedrick_elkins import shen_hedrick_elkins
from rbd_model.contact.creep.strip_theory import strip_theory
from rbd_model.contact.creep.tabulated import table_of, tabulated

#: The exact theory as CONTACT v25.2 computes it (61 x 61 elements), Poisson's ratio 0.25, G = 82 GPa. The error of its
#: grid is within 0.5 % of mu N.
EXACT = Path(__file__).parent / "exact.csv"
SOURCE = "Kalker's exact theory (CONTACT v25.2)"


@lru_cache
def table() -> CreepLaw:
    """Return the table of FaStrip. It is built at the first call, which takes a second."""
    return tabulated(table_of(fastrip(12)))


LAWS: dict[str, CreepLaw] = {
    "Kalker, linear": kalker_linear,
    "Vermeulen, Johnson": johnson_vermeulen,
    "Shen, Hedrick, Elkins": shen_hedrick_elkins,
    "Kalker to Coulomb": kalker_to_coulomb,
    "Polach": polach,
    "FASTSIM 5 x 5": fastsim(5),
    "FASTSIM 10 x 10": fastsim(10),
    "FASTSIM 14 x 14": fastsim(14),
    "FaStrip 8 x 8": fastrip(8),
    "FaStrip 12 x 12": fastrip(12),
    "strip theory 6 x 6": strip_theory(6),
    "strip theory 8 x 8": strip_theory(8),
    "table of FaStrip 12 x 12": lambda patch: table()(patch),
    "table of exact theory": exact_law,
}
#: Laws of a quick run, which compile in a second.
QUICK = ("Kalker, linear", "Shen, Hedrick, Elkins", "Kalker to Coulomb", "FASTSIM 5 x 5")
#: Marker, colour and size of each law.
STYLE = {
    "Kalker, linear": ("X", "#999999", 8),
    "Vermeulen, Johnson": ("^", "#cc79a7", 8),
    "Shen, Hedrick, Elkins": ("D", "#009e73", 8),
    "Kalker to Coulomb": ("v", "#009e73", 8),
    "Polach": ("*", "#0072b2", 12),
    "FASTSIM 5 x 5": ("s", "#56b4e9", 5),
    "FASTSIM 10 x 10": ("s", "#56b4e9", 9),
    "FASTSIM 14 x 14": ("s", "#56b4e9", 12),
    "FaStrip 8 x 8": ("P", "#e69f00", 6),
    "FaStrip 12 x 12": ("P", "#e69f00", 11),
    "strip theory 6 x 6": ("o", "#d55e00", 5),
    "strip theory 8 x 8": ("o", "#d55e00", 9),
    "table of FaStrip 12 x 12": ("h", "#8c4a00", 11),
    "table of exact theory": ("*", "#000000", 13),
}
KINDS = ("pure creepage", "mixed", "spin-dominated", "saturated")
#: Share of mu N above which a force is saturated.
SATURATED = 0.95
#: Limit of the default and of the laws in HOLDING, in every kind of case [% of mu N].
EVERYWHERE = 5.0
DEFAULT = "Kalker to Coulomb"
MARCHING = ("FaStrip 8 x 8", "FaStrip 12 x 12", "strip theory 8 x 8")
HOLDING = (*MARCHING, "table of FaStrip 12 x 12", "table of exact theory")
#: Limits at random states, within 99 % of them [% of mu N]: for the marching laws, and for the table of exact theory.
AT_RANDOM = {"FASTSIM 14 x 14": 8.5, "FaStrip 12 x 12": 8.5, "table of exact theory": 3.0}
STATES = (exact_states.EACH, exact_states.TOGETHER, exact_states.BEYOND)
OUR_EXACT = "Kalker's exact theory, own oracle"
#: Target cost of one evaluation [us]; measured, without a verdict.
TO_REACH = {"Polach": 0.1, "table of FaStrip 12 x 12": 0.3, "table of exact theory": 0.3, "FASTSIM 10 x 10": 3.0}


@dataclass(frozen=True)
class Measured:
    """Measured errors and costs of a law.

    distance: largest distance from the exact theory by kind of case [% of mu N]; at_random: by set of states; value and
    slopes: time of one evaluation, without and with derivatives [s].
    """

    distance: Mapping[str, float]
    at_random: Mapping[str, exact_states.Distance]
    value: float
    with_slopes: float

    @property
    def worst(self) -> float:
        """Return the largest distance over all kinds."""
        return max(self.distance.values())


@lru_cache
def exact() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return points as in `creep_cost`, exact forces [N], and the kind of each row by its number in KINDS."""
    names = ("longitudinal", "lateral", "spin_1_per_m", "load_N", "friction", "a_mm", "b_mm", "exact_x_N", "exact_y_N")
    with EXACT.open(encoding="utf-8") as file:
        table = np.array([[float(row[name]) for name in names] for row in csv.DictReader(file)])
    table[:, 5:7] *= 1e-3
    points, forces = table[:, :7], table[:, 7:]
    x, y, spin, load, friction, a, b = points.T
    c11, c22, c23 = with_coefficients(points)[:, 7:].T
    kinds = np.where((spin == 0) & (x * y == 0), 0, 1)
    # spin dominates where its linear force is the larger one
    kinds[np.abs(c23 * np.sqrt(a * b) * spin) > np.hypot(c11 * x, c22 * y)] = 2
    kinds[np.hypot(*forces.T) > SATURATED * load * friction] = 3
    return points, forces, kinds


def distances(law: CreepLaw) -> np.ndarray:
    """Return the distance of the force vectors from the exact ones for each row [% of mu N]."""
    points, forces, _ = exact()
    return np.asarray(100 * np.hypot(*(values(law, points) - forces).T) / (points[:, 3] * points[:, 4]))


def measure(laws: Mapping[str, CreepLaw], quick: bool) -> dict[str, Measured]:
    """Return the measurements of laws."""
    points, _, kinds = exact()
    found = {}
    for name, law in counting(laws.items(), "creep laws", unit="law"):
        distance = distances(law)
        by_kind = {kind: float(distance[kinds == number].max()) for number, kind in enumerate(KINDS)}
        at_random = {states: exact_states.distance(law, states) for states in STATES}
        found[name] = Measured(by_kind, at_random, *(cost(law, points, slopes, quick) for slopes in (False, True)))
    return found


def front(points: Mapping[str, tuple[float, float]]) -> list[str]:
    """Return the names of points that no other beats in both cost and distance (Pareto front), the cheapest first."""
    kept: list[str] = []
    for name in sorted(points, key=lambda one: points[one]):
        if not kept or points[name][1] < points[kept[-1]][1]:
            kept.append(name)
    return kept


def fronts(found: Mapping[str, Measured]) -> dict[str, list[str]]:
    """Return the Pareto front of each kind of case."""
    return {kind: front({name: (one.value, one.distance[kind]) for name, one in found.items()}) for kind in KINDS}


def asked(name: str) -> Bound | None:
    """Return the limit of a law, or None if it is only a comparison."""
    return at_most(EVERYWHERE) if name in (DEFAULT, *HOLDING) else None


def rows_of(found: Mapping[str, Measured]) -> list[Row]:
    """Return the rows: distances by kind, at random states, then costs."""
    ahead, rows = fronts(found), []
    for kind in KINDS:
        for name, one in found.items():
            words = "on the front of cost and distance" if name in ahead[kind] else ""
            quantity = f"{name}: {kind}, largest distance"
            rows.append(measured(quantity, "% of mu N", one.distance[kind], SOURCE, asked(name), words))
    for name, one in found.items():
        for states, off in one.at_random.items():
            for words, value in (("mean", off.mean), ("99 %", off.most), ("largest", off.largest)):
                bound = at_most(AT_RANDOM[name]) if name in AT_RANDOM and words == "99 %" else None
                rows.append(measured(f"{name}: {states}, {words}", "% of mu N", value, OUR_EXACT, bound))
    for name, one in found.items():
        reach = f"; to reach {TO_REACH[name]:g}" if name in TO_REACH else ""
        for words, seconds in (("value", one.value), ("value and derivatives", one.with_slopes)):
            note = f"measured now{reach if words == 'value' else ''}"
            rows.append(measured(f"{name}: {words}", "us", 1e6 * seconds, note))
    return rows


def failures(found: Mapping[str, Measured]) -> list[str]:
    """Return one message for each law: the kinds of published rows at which its error exceeds `EVERYWHERE`."""
    messages = []
    for name, one in found.items():
        bad = [f"{kind} ({one.distance[kind]:.1f})" for kind in KINDS if one.distance[kind] > EVERYWHERE]
        off = f"more than {EVERYWHERE:g} % of mu N off"
        where = f"is {off}: {', '.join(bad)}" if bad else f"is never {off}"
        messages.append(f"At the published rows {name} {where}.")
    return messages


def run(options: Options, quick: bool = False) -> Report:
    laws = {name: LAWS[name] for name in QUICK} if quick else LAWS
    found = measure(laws, quick)
    points, _, kinds = exact()
    series = Recording({"row": "1"}, [[number] for number in range(len(points))])
    series.add("kind", "1", kinds)
    for name, law in laws.items():
        series.add(name, "% of mu N", distances(law))
    parameters = {
        "kinds": list(KINDS),
        "fronts": fronts(found),
        "points": points.tolist(),
        "saturated_from": SATURATED,
    }
    report = Report(rows_of(found), series, lambda: draw(found, False), parameters, 0.0, [READING, *failures(found)])
    report.other_figures["with-derivatives"] = lambda: draw(found, True)
    return report


# ---- the figure --------------------------------------------------------------------------------------------------

#: Largest distance that is drawn to scale [% of mu N]; larger ones are drawn on the upper edge.
TOP = 100.0


READING = (
    "In the pictures lower left is better; full and joined markers: no other law is both cheaper and nearer. "
    "Their messages count the cases by kind, not the random states."
)


def draw(found: Mapping[str, Measured], slopes: bool) -> Figure:
    figure, grid = plt.subplots(3, 2, figsize=(10.5, 11.5), sharex=True, sharey=True)
    costs = {name: 1e6 * (one.with_slopes if slopes else one.value) for name, one in found.items()}
    for axis, part in zip(grid[2], ("mean", "most"), strict=True):
        draw_kind(
            axis, {name: (costs[name], getattr(one.at_random[exact_states.EACH], part)) for name, one in found.items()}
        )
    grid[2, 0].set_title(f"mean of {exact_states.COUNT} random states, to three times saturation")
    grid[2, 1].set_title("99 % of them are nearer")
    for axis, kind in zip(grid.ravel(), KINDS, strict=False):
        draw_kind(axis, {name: (costs[name], one.distance[kind]) for name, one in found.items()})
        count = int(np.sum(exact()[2] == KINDS.index(kind)))
        axis.set_title(f"{kind}: largest of {count} cases")
    label_edges(
        grid,
        f"cost of one {'value with derivatives' if slopes else 'value'} as compiled C [us]",
        "distance from exact theory [% of mu N]",
    )
    handles = [Line2D([], [], linestyle="none", label=name, **look(name)) for name in found]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return titled(figure, message(found, slopes))


def message(found: Mapping[str, Measured], slopes: bool) -> str:
    """Return the title: the cheapest law that is near exact theory in every case."""
    near = {name: one.with_slopes if slopes else one.value for name, one in found.items() if one.worst <= EVERYWHERE}
    if not near:
        return f"No law stays within {EVERYWHERE:g}% of exact theory in every case"
    name = min(near, key=lambda one: near[one])
    return f"{name[0].upper()}{name[1:]} is the cheapest law within {EVERYWHERE:g}%"


def look(name: str) -> dict[str, Any]:
    """Return the marker options of a law."""
    marker, colour, size = STYLE[name]
    return {"marker": marker, "color": colour, "markersize": size}


def draw_kind(axis: Axes, points: Mapping[str, tuple[float, float]]) -> None:
    ahead = front(points)
    line = np.array([points[name] for name in ahead])
    axis.axhspan(EVERYWHERE, 1.6 * TOP, color="#f3e3e0", zorder=0)
    axis.step(line[:, 0], np.minimum(line[:, 1], TOP), where="post", color="#bbbbbb", zorder=1)
    for name, (seconds, distance) in points.items():
        style = look(name)
        if name not in ahead:
            style["markerfacecolor"] = "none"
        axis.plot(seconds, min(distance, TOP), zorder=3, **style)
        if distance > TOP:
            axis.annotate(
                f"{distance:.0f}", (seconds, TOP), xytext=(0, 6), textcoords="offset points", fontsize=7, ha="center"
            )
    axis.set(xscale="log", yscale="log", ylim=(0.2, 1.6 * TOP))
    axis.text(
        0.01, EVERYWHERE * 1.06, f"above {EVERYWHERE:g} %", transform=axis.get_yaxis_transform(), ha="left", fontsize=7
    )


SCENARIO = Scenario(
    "creep-laws", "Creep laws: distance from Kalker's exact theory over cost, with and without spin", run
)
