"""Figure of the command `etcs`: supervision limits before a target, and the train's own stops."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, legend_above, plt, titled
from products.supervision import Curves, Gradients

#: Limits in the order in which a train meets them: name, colour and width of its line.
LIMITS = (
    ("I", "#9ecae1", 1.2),
    ("P", LEADING, 2.0),
    ("W", "#f4a582", 1.2),
    ("SBI", TRAILING, 1.2),
    ("EBI", "#b2182b", 2.0),
    ("EBD", BOGIE, 1.2),
)


def figure_of_supervision(
    limits: Curves, ends: float, gradients: Gradients, stops: Sequence[tuple[np.ndarray, np.ndarray]]
) -> Figure:
    """Return the limits over the line and own stops, above the gradient of a line that is not level.

    Takes ends [m], stops [m].
    """
    rows = (4.0, 1.0) if np.any(gradients.permille) else (5.0,)
    figure, drawn = plt.subplots(len(rows), 1, figsize=(9.0, 6.5), height_ratios=rows, sharex=True, squeeze=False)
    axes, last = drawn[0, 0], drawn[-1, 0]
    for name, colour, width in LIMITS:
        axes.plot(getattr(limits, name), 3.6 * limits.V_est, color=colour, linewidth=width, label=name)
    for number, (places, speeds) in enumerate(stops):
        label = "own stops from EBI" if number == 0 else None
        axes.plot(places, 3.6 * speeds, ":", color="#555555", linewidth=1.0, label=label)
    axes.axvline(ends, color="#b2182b", linewidth=0.8)
    axes.set_ylabel("speed [km/h]")
    axes.set_ylim(bottom=0.0)
    legend_above(axes, 7)
    left, right = float(np.min(limits.I)), ends + 0.03 * (ends - float(np.min(limits.I)))
    axes.set_xlim(left, right)
    if last is not axes:
        starts = np.concatenate([[min(left, gradients.starts[0])], gradients.starts[1:], [right]])
        last.stairs(gradients.permille, starts, baseline=None, color=BOGIE)
        last.axhline(0.0, color="#aaaaaa", linewidth=0.6)
        last.set_title("gradient [‰]")
    last.set_xlabel("distance along the line [m]")
    return titled(figure, message_of_stops(ends, stops))


def message_of_stops(ends: float, stops: Sequence[tuple[np.ndarray, np.ndarray]]) -> str:
    """Return the message of the figure, and of the command."""
    if not stops:
        return "Limits that ETCS supervises before the target"
    before = [ends - float(places[-1]) for places, _ in stops]
    late = [one for one in before if one < 0.0]
    if late:
        most = "some without end" if np.isinf(min(late)) else f"{-min(late):.1f} m at most"
        return f"{len(late)} of {len(stops)} own stops pass the target, {most}"
    return f"Own stops from EBI end at least {min(before):.1f} m before the target"
