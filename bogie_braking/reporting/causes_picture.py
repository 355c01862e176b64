"""Figure of the command `etcs`: what each cause takes from Kdry_rst."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, plt, titled
from products.supervision import Cause
from products.supervision.tolerances import ENTRIES


def figure_of_causes(causes: Sequence[Cause], factor: float, level: int) -> Figure:
    """Return a bar for each cause: Kdry_rst as it is, and without the cause."""
    figure, axes = plt.subplots(figsize=(9.5, 1.6 + 0.4 * max(1, len(causes))))
    for place, one in enumerate(causes):
        axes.barh(place, one.gain, left=factor, color=LEADING if place else TRAILING)
    axes.axvline(factor, color=BOGIE, linewidth=1.0)
    axes.set_yticks(range(len(causes)), [f"{ENTRIES[one.name].text}, {100 * one.value:g} %" for one in causes])
    axes.invert_yaxis()
    axes.set_xlabel(f"Kdry_rst of level {level}, {factor:.3f}; bars end at its value without the cause")
    return titled(figure, _title(causes, level))


def _title(causes: Sequence[Cause], level: int) -> str:
    """Return the message of the figure."""
    if not causes:
        return "The brake always has its nominal force"
    return f"Level {level} is decided by {ENTRIES[causes[0].name].text}"
