"""Page of the command `etcs`: limits over the line with own stops and gradients, and tables, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs
from plotly.subplots import make_subplots

from bogie_braking.reporting.html_report import drawn
from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING
from bogie_braking.reporting.supervision_picture import message_of_stops
from bogie_braking.web.frame import filled
from products.supervision import Curves, Gradients

#: Limits in the order in which they are met: name, colour, dashes, and whether they are shown first.
LINES = (
    ("I", "#56b4e9", "solid", True),
    ("P", LEADING, "solid", True),
    ("W", "#e69f00", "solid", True),
    ("SBI", TRAILING, "solid", True),
    ("EBI", "#b2182b", "solid", True),
    ("EBD", BOGIE, "solid", True),
    ("SBD", "#777777", "dash", True),
    ("GUI", "#009e73", "dash", True),
    ("SBI1", TRAILING, "dash", False),
    ("SBI2", TRAILING, "dot", False),
)
STOP = "#555555"
#: Share of the height for speeds and for the gradient, and room behind the place that no train may pass.
HEIGHTS, BEHIND = (0.78, 0.22), 0.04


@dataclass(frozen=True)
class Table:
    """A table of the page: its title, heads of its columns, rows of text, and whether cells are numbers."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: bool = True


def page_of_supervision(
    title: str,
    limits: Curves,
    ends: float,
    gradients: Gradients,
    stops: Sequence[tuple[np.ndarray, np.ndarray]],
    tables: Sequence[Table],
) -> str:
    """Return the text of the page.

    Takes ends [m], stops [m].
    """
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, row_heights=list(HEIGHTS), vertical_spacing=0.06)
    for name, colour, dash, first in LINES:
        places = getattr(limits, name)
        if places is not None:
            _add(figure, places, limits.V_est, name, {"color": colour, "dash": dash, "width": 2.0}, first)
    for number, (places, speeds) in enumerate(stops):
        style = {"color": STOP, "dash": "dot", "width": 1.2}
        _add(figure, places, speeds, "own stops from EBI" if number == 0 else "", style, True)
    left = float(np.min(limits.I))
    right = ends + BEHIND * (ends - left)
    starts = np.concatenate([[min(left, gradients.starts[0])], gradients.starts[1:], [right]])
    heights = np.append(gradients.permille, gradients.permille[-1])
    style = {"color": BOGIE, "width": 2.0, "shape": "hv"}
    line = go.Scatter(x=starts, y=heights, mode="lines", line=style, showlegend=False, name="gradient")
    figure.add_trace(line, row=2, col=1)
    figure.add_vline(x=ends, line={"color": "#b2182b", "width": 1})
    figure.update_xaxes(range=[left, right])
    figure.update_xaxes(title_text="distance along the line [m]", row=2, col=1)
    figure.update_yaxes(title_text="speed [km/h]", rangemode="tozero", row=1, col=1)
    figure.update_yaxes(title_text="gradient [‰]", row=2, col=1)
    return filled(
        "etcs.html.jinja",
        title=title,
        sentence=message_of_stops(ends, stops),
        holds=all(float(places[-1]) <= ends for places, _ in stops),
        chart=drawn(figure),
        tables=tables,
        plotly=get_plotlyjs(),
    )


def _add(
    figure: go.Figure, places: np.ndarray, speeds: np.ndarray, name: str, style: dict[str, object], first: bool
) -> None:
    """Add a line of speeds over places; lines of one group are hidden together."""
    known = np.isfinite(places)
    line = go.Scatter(
        x=np.round(places[known], 3),
        y=np.round(3.6 * speeds[known], 3),
        mode="lines",
        line=style,
        name=name or "own stop",
        showlegend=bool(name),
        legendgroup="own stops" if "stop" in name or not name else name,
        visible=True if first else "legendonly",
        hovertemplate="%{x:.1f} m, %{y:.1f} km/h",
    )
    figure.add_trace(line, row=1, col=1)
