"""Scores as one figure: the number of cases that each controller stops in near the ideal."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from copy import copy
from typing import TYPE_CHECKING

from bogie_braking.controllers.scoring import ScoredController, sliding_cases
from bogie_braking.controllers.verdict import best_given, verdicts
from bogie_braking.reporting.plots import BOGIE, LEADING, THESIS, TRAILING, one_word, plt, titled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Distance over the ideal up to which a stop is near it [1]: a choice of this figure.
NEAR = 1.2
#: Largest ratio above which the axis is logarithmic [1].
WIDE = 4.0
#: Marker and colour of the unprotected wheels, and of each controller in order.
NONE = ("x", "0.55")
MARKS = (
    (">", "0.5"),
    *(("s", THESIS), ("o", LEADING), ("D", TRAILING), ("^", BOGIE)),
    *(("v", "#e69f00"), ("P", "#56b4e9"), ("<", "#cc79a7")),
)
#: Height of a row, of each marker in it, and of the margins above and below all rows [in]; distance of two markers
#: [rows].
ROW, OF_EACH, AROUND, APART = 0.22, 0.045, 1.5, 0.18
#: Columns of the legend.
COLUMNS = 4
LABEL = "{distance} over that with the best slip at every instant [1]"
#: Largest number of letters of a case's name.
LETTERS = 48


def draw(scores: Sequence[ScoredController]) -> Figure:
    """Draw the distances over the ideal, a row for each case and a marker for each controller; at the edge: no stop."""
    cases, names = (list(dict.fromkeys(getattr(one, kind) for one in scores)) for kind in ("case", "controller"))
    figure, axis = plt.subplots(figsize=(9.0, AROUND + max(1.0, (ROW + OF_EACH * len(names)) * len(cases))))
    titled(figure, message(scores))
    edge, sliding = set_axis(axis, scores, cases), sliding_cases(scores)
    places = {name: len(cases) - 1 - number for number, name in enumerate(cases)}
    for number, name in enumerate(names):
        aside = APART * ((len(names) - 1) / 2 - number)
        own = {places[score.case] + aside: score for score in scores if score.controller == name}
        ratios = {place: ratio for place, one in own.items() if (ratio := one.over(one.ideal)) is not None}
        missed = [place for place, one in own.items() if one.stop.distance is None and one.stop.judged]
        line = plt.Line2D([], [], linestyle="none", markersize=5.5, clip_on=False, zorder=3, in_layout=False)
        line.set(**dict(zip(("marker", "color"), NONE if name == "none" else MARKS[number % len(MARKS)], strict=True)))
        hollow = copy(line)
        # With a leading space, as the legend omits labels that begin with _.
        line.set(data=(list(ratios.values()), list(ratios)))
        line.set(label=f" {plain(name)}: {count(near_ratios(scores, name), len(sliding))}")
        hollow.set(data=([edge] * len(missed), missed), markerfacecolor="none")
        axis.add_line(line)
        axis.add_line(hollow)
    those = "cases" if len(sliding) == len(cases) else "cases where wheels slide,"
    title = "distance over the ideal" if len(cases) == 1 else f"{those} within {NEAR:g} of the ideal"
    handles = axis.get_legend_handles_labels()
    below = (0.3 + 0.2 * math.ceil(len(names) / COLUMNS)) / figure.get_figheight()
    figure.legend(*handles, loc="lower left", ncols=COLUMNS, fontsize=9, title=title, alignment="left")
    figure.set_layout_engine("constrained", rect=(0.0, below, 1.0, 1.0 - below))
    return figure


def near_ratios(scores: Sequence[ScoredController], name: str) -> list[float]:
    """Return a controller's distances over the ideal in the cases in which a wheel slides."""
    sliding = sliding_cases(scores)
    own = [score.over(score.ideal) for score in scores if score.controller == name and score.case in sliding]
    return [ratio for ratio in own if ratio is not None]


def count(ratios: Collection[float], cases: int) -> str:
    """Return the number of ratios near the ideal, or the ratio itself if there is only one case."""
    if cases == 1:
        return f"{next(iter(ratios)):.2f}" if ratios else "-"
    return f"{sum(ratio <= NEAR for ratio in ratios)} of {cases}"


def set_axis(axis: Axes, scores: Sequence[ScoredController], cases: Sequence[str]) -> float:
    """Set the names of the cases, the band near the ideal and the edge, whose place is returned."""
    ratios = [ratio for score in scores if (ratio := score.over(score.ideal)) is not None]
    largest = max([NEAR, *ratios])
    if largest > WIDE:
        ticks = [tick for tick in (1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0) if tick < largest]
        axis.set(xscale="log")
        axis.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
        axis.xaxis.set_minor_locator(plt.NullLocator())
    low = min([1.0, *ratios])
    edge = largest * (largest / low) ** 0.08 if largest > WIDE else largest + 0.08 * (largest - low)
    axis.set(
        xlim=(low - 0.03, edge),
        ylim=(-0.6, len(cases) - 0.4),
        xlabel=LABEL.format(distance=scores[0].words.distance),
    )
    axis.axvspan(1.0, NEAR, color=THESIS, alpha=0.13, linewidth=0, zorder=0)
    axis.axvline(1.0, color="0.2", linewidth=1.0)
    if any(one.stop.distance is None and one.stop.judged for one in scores):
        axis.axvline(edge, color="0.4", linewidth=1.0, linestyle=":")
        axis.text(edge, len(cases) - 0.3, scores[0].words.none, ha="center", va="bottom", fontsize=9)
    shown = [name if len(name) <= LETTERS else f"{name[: LETTERS - 1]}…" for name in cases]
    axis.set_yticks(range(len(cases)), [plain(name) for name in reversed(shown)])
    axis.tick_params(axis="y", length=0)
    axis.grid(visible=True, axis="y", linewidth=6, alpha=0.12)
    return edge


def plain(name: str) -> str:
    """Return a user's name with dollars escaped, as Matplotlib would set a formula."""
    return name.replace("$", r"\$")


def message(scores: Sequence[ScoredController]) -> str:
    """Return the title of the figure, in at most twelve words if a name is one."""
    found = verdicts(scores)
    best = best_given(found)
    name, cases, words = one_word(plain(best.controller)), best.cases, best.words
    if not best.stopped + best.failed:
        return f"{name} is not judged"
    if not best.stopped:
        return f"{name} does not {words.do}"
    if best.failed and best.median is None:
        return f"{name} {words.does} in {best.stopped} of {cases} cases"
    if best.worst is None or cases == 1:
        return f"{name} takes {best.worst.mean:.2f} of the ideal distance" if best.worst else f"{name} {words.does}"
    near = count(near_ratios(scores, best.controller), best.sliding)
    if best.sliding == 1:
        return f"{name} takes {near} of the ideal distance where wheels slide"
    if best.sliding < cases:
        return f"{name} {words.does} within {NEAR:g} of ideal in {near} sliding cases"
    return f"{name} {words.does} within {NEAR:g} of the ideal in {near} cases"
