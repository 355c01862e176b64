"""Figures of a benchmark: errors of all programs, ranges, and errors over two inputs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, FOUR, LEADING, THESIS, TRAILING, plt, titled
from scenarios.benchmark.band import Band
from scenarios.benchmark.score import Score, Scored
from scenarios.benchmark.words import displayed, point_of

#: Smallest error that is drawn, over its bound or in percent.
LEAST = 1e-6
COLOURS = (LEADING, *FOUR[2:], THESIS, BOGIE, FOUR[1])
MARKS = "osD^vPX*"
#: Largest error of the scale of errors over two inputs [%], and fewest values of an input for such a figure.
SCALE, FEWEST = 50.0, 4


def figure_of_errors(scored: Sequence[Scored], programs: Sequence[str]) -> Figure:
    """Return the errors as marks: judged answers over their bounds, shown ones in percent of the published value."""
    rows = [(one, name) for one in scored for name in one.case.answers]
    figure, axis = plt.subplots(figsize=(9.5, 1.8 + 0.3 * len(rows)))
    for number, program in enumerate(programs):
        places, sizes = [], []
        for row, (one, name) in enumerate(rows):
            found = next(each for each in one.scores if each.program == program and each.answer.name == name)
            if found.worst is not None:
                places.append(row)
                sizes.append(max(abs(_share(found)), LEAST))
        if places:
            colour, mark = COLOURS[number % len(COLOURS)], MARKS[number % len(MARKS)]
            axis.plot(sizes, places, mark, color=colour, label=program, markersize=6, alpha=0.85)
    axis.axvline(1.0, color=BOGIE, linewidth=1.0)
    axis.set_xscale("log")
    axis.set_yticks(range(len(rows)), [_label(one, name) for one, name in rows], fontsize=8)
    axis.set_ylim(len(rows) - 0.5, -0.5)
    axis.set_xlabel("largest error over its bound; of answers that are only shown, in percent or units")
    titled(figure, _message(scored, programs[0]))
    if axis.get_legend_handles_labels()[0]:
        figure.legend(loc="outside lower center", ncols=4, fontsize=8)
    return figure


def _share(score: Score) -> float:
    assert score.worst is not None
    if score.answer.bound is not None:
        return score.worst / score.answer.bound
    return 100 * score.worst


def _label(scored: Scored, name: str) -> str:
    return f"{scored.case.name}: {name}" + ("" if scored.case.answers[name].judged else " (shown)")


def _message(scored: Sequence[Scored], program: str) -> str:
    judged = [score for each in scored for score in each.scores if score.program == program and score.holds is not None]
    held = sum(one.holds is True for one in judged)
    return f"{program}: {held} of {len(judged)} judged answers within their bounds"


def figure_of_bands(bands: Sequence[Band]) -> Figure:
    """Return ranges over the published values: 5 to 95 %, median, and the answer at the inputs of the case."""
    drawn = [band for band in bands if band.lower is not None and band.published]
    figure, axis = plt.subplots(figsize=(9.5, 1.8 + 0.28 * max(len(drawn), 1)))
    for row, one in enumerate(drawn):
        lower, median, upper, value = (
            np.nan if each is None else each / one.published for each in (one.lower, one.median, one.upper, one.value)
        )
        axis.plot([lower, upper], [row, row], color=LEADING, linewidth=5.0, alpha=0.45, solid_capstyle="butt")
        axis.plot([median], [row], "|", color=LEADING, markersize=10)
        axis.plot([value], [row], "o", color=TRAILING, markersize=5)
    axis.axvline(1.0, color=BOGIE, linewidth=1.0)
    labels = [f"{one.case.name} {one.answer.name}, {point_of(one.case, one.number - 1)}"[:70] for one in drawn]
    axis.set_yticks(range(len(drawn)), labels, fontsize=7)
    axis.set_ylim(len(drawn) - 0.5, -0.5)
    axis.set_xlabel("answer over the published value: 5 to 95 %, median; dot: at the inputs of the case")
    inside = sum(one.holds is True for one in drawn)
    return titled(figure, f"{inside} of {len(drawn)} published values lie in the range")


def figures_over_two_inputs(scored: Sequence[Scored], program: str) -> dict[str, Figure]:
    """Return a map of the errors of a program by case, for cases whose points are a grid of two inputs."""
    found = {}
    for one in scored:
        names = one.case.points[0].own
        if len(names) != 2 or any(point.own != names for point in one.case.points):
            continue
        values = [sorted({point.inputs[name] for point in one.case.points}) for name in names]
        score = next(each for each in one.scores if each.program == program)
        if min(map(len, values)) >= FEWEST and score.answer.relative and score.errors:
            found[one.case.name] = _map(one, score, names, values)
    return found


def _map(scored: Scored, score: Score, names: Sequence[str], values: Sequence[list]) -> Figure:
    grid = np.full((len(values[1]), len(values[0])), np.nan)
    for point, value, told in zip(scored.case.points, score.values, score.published, strict=True):
        if value is not None and told is not None:
            column, row = (values[side].index(point.inputs[name]) for side, name in enumerate(names))
            grid[row, column] = 100 * (value / told - 1)
    figure, axis = plt.subplots(figsize=(9.5, 5.5), layout="constrained")
    image = axis.imshow(grid, origin="lower", aspect="auto", cmap="RdBu_r", vmin=-SCALE, vmax=SCALE)
    for row, column in np.argwhere(np.isfinite(grid)):
        axis.text(column, row, f"{grid[row, column]:.0f}", ha="center", va="center", fontsize=6)
    for side, ticks in enumerate((axis.set_xticks, axis.set_yticks)):
        scale = displayed(scored.case.units[names[side]])[1]
        ticks(range(len(values[side])), [f"{each / scale:.4g}" for each in values[side]], fontsize=7)
    units = [f"{name} [{displayed(scored.case.units[name])[0]}]" for name in names]
    axis.set(xlabel=units[0], ylabel=units[1])
    axis.grid(False)
    figure.colorbar(image, label="error [%]")
    return titled(figure, f"{scored.case.name}: error of {score.answer.name} over {names[0]} and {names[1]}")
