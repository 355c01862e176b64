"""Figure of a benchmark: the largest error of each program over the bound of each judged answer."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from scenarios.benchmark.score import Score, Scored
from scenarios.reporting.plots import BOGIE, FOUR, LEADING, THESIS, plt, titled

#: Smallest error that is drawn, over its bound or in percent.
LEAST = 1e-6
COLOURS = (LEADING, *FOUR[2:], THESIS, BOGIE, FOUR[1])
MARKS = "osD^vPX*"


def picture(scored: Sequence[Scored], programs: Sequence[str]) -> Figure:
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
        colour, mark = COLOURS[number % len(COLOURS)], MARKS[number % len(MARKS)]
        axis.plot(sizes, places, mark, color=colour, label=program, markersize=6, alpha=0.85)
    axis.axvline(1.0, color=BOGIE, linewidth=1.0)
    axis.set_xscale("log")
    axis.set_yticks(range(len(rows)), [_label(one, name) for one, name in rows], fontsize=8)
    axis.set_ylim(len(rows) - 0.5, -0.5)
    axis.set_xlabel("largest error over its bound; of answers that are shown only, in percent or units")
    axis.legend(loc="upper left", bbox_to_anchor=(0.0, -0.08 - 0.6 / len(rows)), ncols=3, fontsize=8)
    return titled(figure, _message(scored, programs[0]))


def _share(one: Score) -> float:
    assert one.worst is not None
    if one.answer.bound is not None:
        return one.worst / one.answer.bound
    return 100 * one.worst


def _label(one: Scored, name: str) -> str:
    return f"{one.case.name}: {name}" + ("" if one.case.answers[name].judged else " (shown)")


def _message(scored: Sequence[Scored], program: str) -> str:
    judged = [one for each in scored for one in each.scores if one.program == program and one.holds is not None]
    held = sum(one.holds is True for one in judged)
    return f"{program}: {held} of {len(judged)} judged answers within their bounds"
