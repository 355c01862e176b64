"""All results of a folder on one page: index.html, thesis against simulation at a glance, with links to the reports."""

from __future__ import annotations

import json
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from scenarios.catalogue import SCENARIOS
from scenarios.reporting import plots
from scenarios.reporting.html_report import counts, drawn, environment
from scenarios.reporting.report import VERDICTS, number
from scenarios.scenario import BadInputError

#: Mark and colour by verdict; the marks alone tell them apart.
MARKS = {True: ("circle", plots.LEADING), None: ("diamond-open", plots.BOGIE), False: ("x", plots.TRAILING)}
#: Height of the chart beside and for each scenario [pixels].
CHART_HEIGHT, LINE_HEIGHT = 190, 24


@dataclass(frozen=True)
class Saved:
    """A folder of results as summary.json tells it."""

    name: str
    text: str
    link: str
    rows: list[dict[str, Any]]
    wall_seconds: float

    @property
    def printed(self) -> list[dict[str, Any]]:
        """Rows of which the thesis prints a value."""
        return [row for row in self.rows if row["thesis"] is not None]


def write_index(out: Path) -> Path:
    """Writes it into the folder of the results. Raises BadInputError where there are none."""
    texts = {scenario.name: scenario.summary for scenario in SCENARIOS}
    order = {name: place for place, name in enumerate(texts)}
    found = [read(path.parent, texts) for path in sorted(out.glob("*/summary.json"))]
    if not found:
        raise BadInputError(f"There are no results in {out}; run a scenario first, or give their folder with --out.")
    results = sorted(found, key=lambda one: order.get(one.name, len(order)))
    text = (
        environment()
        .get_template("index.html.jinja")
        .render(
            title="Results",
            results=results,
            counts=counts([row for one in results for row in one.rows]),
            chart=chart(results),
            height=CHART_HEIGHT + LINE_HEIGHT * sum(bool(one.printed) for one in results),
            plotly=get_plotlyjs(),
        )
    )
    (out / "index.html").write_text(text, encoding="utf-8")
    return out / "index.html"


def read(folder: Path, texts: dict[str, str]) -> Saved:
    """What was saved of one scenario. Raises BadInputError where that is not what `report.save` writes."""
    path = folder / "summary.json"
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
        name, rows, seconds = (summary[key] for key in ("scenario", "rows", "wall_seconds"))
        counts(rows)
    except (ValueError, KeyError, TypeError) as error:
        raise BadInputError(f"{path} is no summary of a scenario ({error!r}); remove it, or run it anew.") from error
    page = "report.html" if (folder / "report.html").exists() else "figure.png"
    return Saved(name, texts.get(name, ""), f"{folder.name}/{page}", rows, seconds)


def chart(results: list[Saved]) -> str:
    """Simulated over printed values, a line for each scenario."""
    figure = go.Figure()
    for holds, (symbol, colour) in MARKS.items():
        rows = [
            (one.name, row)
            for one in results
            for row in one.printed
            if row["holds"] is holds and row["thesis"] and row["simulated"] is not None
        ]
        figure.add_scatter(
            x=[row["simulated"] / row["thesis"] for _, row in rows],
            y=[name for name, _ in rows],
            text=[hover(row) for _, row in rows],
            hovertemplate="%{text}<extra></extra>",
            mode="markers",
            marker={"symbol": symbol, "color": colour, "size": 9, "opacity": 0.8},
            name=VERDICTS[holds].lower(),
        )
    figure.add_vline(x=1.0, line={"color": plots.BOGIE, "width": 1})
    drawn_names = [one.name for one in results if one.printed]
    figure.update_yaxes(categoryorder="array", categoryarray=drawn_names, autorange="reversed")
    figure.update_xaxes(title={"text": "simulated over printed value [1]"})
    return drawn(figure)


def hover(row: dict[str, Any]) -> str:
    thesis, simulated = number(row["thesis"]), number(row["simulated"])
    return escape(f"{row['quantity']}: thesis {thesis}, simulated {simulated} {row['unit']}")
