"""Charts of a recording: a panel for each unit, with a legend that is smaller than its panel."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from itertools import cycle
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from fmu_src.cosimulation.quantities import Table, quantities_of
from fmu_src.figure import NotebookFigure

#: Panels by default, and lines of a panel up to which further quantities are added.
MOST_PANELS, MOST_LINES = 4, 6
#: Share of a panel's range below which a quantity looks constant.
FLAT = 0.02
#: Numbered columns from which a quantity has a scale of colours and two entries in the legend; the scales in turn.
MANY, SCALES = 7, ("viridis", "autumn", "cool", "copper")
#: Column that numbers the rows of a table, and the rows below which their dots are large.
NUMBER, FEW = "number", 50
#: Entries of a legend, and letters of an entry or of a line of an axis.
MOST_ENTRIES, LETTERS = 8, 26
#: Size of a figure: width, height of a panel and of the rest [inch].
WIDTH, PANEL, REST = 8.0, 1.9, 0.6


def chosen_columns(recording: Table) -> list[str]:
    """Return the columns that `Recording.plot` draws by default."""
    columns = [name for name in recording.names if name not in recording.coordinates]
    units = dict.fromkeys(recording.units[name] for name in columns)
    moving = [name for name in columns if _span(recording, [name]) > 0.0] or columns
    found: list[str] = []
    for unit in [unit for unit in units if any(recording.units[name] == unit for name in moving)][:MOST_PANELS]:
        of_unit = [name for name in columns if recording.units[name] == unit]
        several = [names for names in quantities_of(of_unit).values() if set(names) & set(moving)]
        shown = several[0]
        for names in several[1:]:
            visible = _span(recording, names) >= FLAT * _span(recording, [*shown, *names])
            shown = [*shown, *names] if visible and len(shown) + len(names) <= MOST_LINES else shown
        found += shown
    return found


def _span(recording: Table, names: Sequence[str]) -> float:
    """Return the range of all values of some columns."""
    values = np.concatenate([recording[name] for name in names])
    values = values[np.isfinite(values)]
    return float(np.ptp(values)) if values.size else 0.0


def draw(recording: Table, names: Sequence[str], dots: Table | None = None) -> NotebookFigure:
    """Return a figure of columns over the axis; dots: another recording whose columns of these names are dots."""
    units = list(dict.fromkeys(recording.units[name] for name in names))
    figure = NotebookFigure(figsize=(WIDTH, REST + PANEL * len(units)), layout="constrained")
    panels = figure.subplots(max(len(units), 1), sharex=True, squeeze=False)[:, 0]
    over = next((name for name in recording.coordinates if name != NUMBER), recording.names[0])
    for panel, unit in zip(panels, units, strict=False):
        _draw_panel(panel, recording, over, [name for name in names if recording.units[name] == unit], dots)
    panels[-1].set_xlabel(f"{over} [{recording.units[over]}]")
    return figure


def _together(over: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a column without the rows of faster ones, between which its values are alone and no line is drawn."""
    there = np.isfinite(values)
    return (over, values) if np.any(there[1:] & there[:-1]) else (over[there], values[there])


def _draw_panel(panel: Axes, recording: Table, over: str, names: Sequence[str], dots: Table | None) -> None:
    """Draw the columns of one unit, and their legend."""
    varied = [name for name in recording.coordinates if name != NUMBER]
    joined = len(varied) < 2 and bool(np.all(np.diff(recording[over]) >= 0.0))
    size = 4 if recording.rows >= FEW else 8
    style: dict[str, Any] = {"linewidth": 1.3 if joined else 0.0, "markersize": size}
    style["marker"] = "." if not joined or recording.rows < FEW else ""
    entries: dict[str, Line2D] = {}
    scales = cycle(SCALES)
    for quantity in quantities_of(names).values():
        scale = matplotlib.colormaps[next(scales)] if len(quantity) >= MANY else None
        for place, name in enumerate(quantity):
            [line] = panel.plot(*_together(recording[over], recording[name]), label=name, **style)
            if scale:
                line.set_color(scale(0.9 * place / (len(quantity) - 1)))
            if len(quantity) < MANY or place in (0, len(quantity) - 1):
                entries[name] = line
            if dots is not None:
                panel.plot(dots[dots.names[0]], dots[name], ".", color="0.6", markersize=3, zorder=1)
    if dots is not None:
        entries["measured"] = panel.lines[-1]
    several = quantities_of(names)
    text = names[0] if len(names) == 1 else next(iter(several)) if len(several) == 1 else ""
    panel.set_ylabel(textwrap.fill(f"{text} [{recording.units[names[0]]}]".strip().replace("_", " "), LETTERS))
    panel.ticklabel_format(axis="y", scilimits=(-3, 5), useMathText=True)
    panel.grid(True, linewidth=0.3)
    if len(entries) > 1:
        _add_legend(panel, entries)


def _add_legend(panel: Axes, entries: Mapping[str, Line2D]) -> None:
    """Add a legend beside the panel, of MOST_ENTRIES entries at most, the last of which counts the others."""
    shown = dict(list(entries.items())[: MOST_ENTRIES - (len(entries) > MOST_ENTRIES)])
    labels, handles = [_short(name) for name in shown], list(shown.values())
    if left := len(entries) - len(shown):
        labels.append(f"and {left} more")
        handles.append(Line2D([], [], linestyle=""))
    style = {"fontsize": 8, "frameon": False, "handlelength": 1.2, "borderaxespad": 0.2}
    panel.legend(handles, labels, loc="upper left", bbox_to_anchor=(1.0, 1.0), **style)


def _short(name: str) -> str:
    """Return a name that is at most LETTERS long."""
    half = LETTERS // 2
    return name if len(name) <= LETTERS else f"{name[:half]}…{name[-half + 1 :]}"
