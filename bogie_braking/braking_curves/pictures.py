"""Figures of the command `etcs`: limits before a target with own stops, and what each cause takes from Kdry_rst."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bogie_braking.braking_curves.compute import CurveResults
from bogie_braking.braking_curves.safety import Safety
from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, legend_above, plt, titled
from products.supervision.tolerances import ENTRIES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Limits in the order in which a train meets them: name, colour and width of its line.
LIMITS = (
    ("I", "#9ecae1", 1.2),
    ("P", LEADING, 2.0),
    ("W", "#f4a582", 1.2),
    ("SBI", TRAILING, 1.2),
    ("EBI", "#b2182b", 2.0),
    ("EBD", BOGIE, 1.2),
)


def figure_of_supervision(found: CurveResults) -> Figure:
    """Return the limits over the line and own stops, above the gradient of a line that is not level."""
    limits, ends, gradients = found.many, found.ends, found.gradients
    rows = (4.0, 1.0) if np.any(gradients.permille) else (5.0,)
    figure, drawn = plt.subplots(len(rows), 1, figsize=(9.0, 6.5), height_ratios=rows, sharex=True, squeeze=False)
    axes, last = drawn[0, 0], drawn[-1, 0]
    for name, colour, width in LIMITS:
        axes.plot(getattr(limits, name), 3.6 * limits.V_est, color=colour, linewidth=width, label=name)
    for number, stop in enumerate(found.stops):
        label = "own stops from EBI" if number == 0 else None
        axes.plot(stop.places, 3.6 * stop.speeds, ":", color="#555555", linewidth=1.0, label=label)
    axes.axvline(ends, color="#b2182b", linewidth=0.8)
    axes.set_ylabel("speed [km/h]")
    axes.set_ylim(bottom=0.0)
    legend_above(axes, 7)
    left, right, starts = range_of_line(found, 0.03)
    axes.set_xlim(left, right)
    if last is not axes:
        last.stairs(gradients.permille, starts, baseline=None, color=BOGIE)
        last.axhline(0.0, color="#aaaaaa", linewidth=0.6)
        last.set_title("gradient [‰]")
    last.set_xlabel("distance along the line [m]")
    return titled(figure, message_of_stops(found))


def range_of_line(found: CurveResults, behind: float) -> tuple[float, float, np.ndarray]:
    """Return the drawn range of the line, with a share of it behind the end, and where its gradients change [m]."""
    left, starts = float(np.min(found.many.I)), found.gradients.starts
    right = found.ends + behind * (found.ends - left)
    return left, right, np.concatenate([[min(left, starts[0])], starts[1:], [right]])


def message_of_stops(found: CurveResults) -> str:
    """Return the message of the figure, and of the command."""
    if not found.stops:
        return "Limits that ETCS supervises before the target"
    before = [found.ends - stop.ends for stop in found.stops]
    late = [distance for distance in before if distance < 0.0]
    if late:
        most = "some without end" if np.isinf(min(late)) else f"{-min(late):.1f} m at most"
        return f"{len(late)} of {len(before)} own stops pass the target, {most}"
    return f"Own stops from EBI end at least {min(before):.1f} m before the target"


def figure_of_causes(safety: Safety) -> Figure:
    """Return a bar for each cause: Kdry_rst as it is, and without the cause."""
    causes, level, factor = safety.causes, safety.level, float(safety.factors[safety.level])
    figure, axes = plt.subplots(figsize=(9.5, 1.6 + 0.4 * max(1, len(causes))))
    for place, cause in enumerate(causes):
        axes.barh(place, cause.gain, left=factor, color=LEADING if place else TRAILING)
    axes.axvline(factor, color=BOGIE, linewidth=1.0)
    names = [f"{ENTRIES[cause.name].text}, {100 * cause.value:g} %" for cause in causes]
    axes.set_yticks(range(len(causes)), names)
    axes.invert_yaxis()
    axes.set_xlabel(f"Kdry_rst of level {level}, {factor:.3f}; bars end at its value without the cause")
    if not causes:
        return titled(figure, "The brake always has its nominal force")
    return titled(figure, f"Level {level} is decided by {ENTRIES[causes[0].name].text}")
