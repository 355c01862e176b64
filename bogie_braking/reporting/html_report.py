"""A report as one page that needs no other file and no network: report.html."""

import base64
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from bogie_braking.reporting import plots
from bogie_braking.reporting.motion import MOST_EXAGGERATION, packed
from bogie_braking.reporting.report import Report, number, parted, verdict_of
from bogie_braking.reporting.scenario import Scenario
from bogie_braking.web.frame import filled
from brake_controller.flow_parameters import FlowParameters
from brake_controller.parameters import BrakeParameters
from fmu_src.cosimulation.recording import Recording
from rbd_model.track.irregularity import TrackParameters
from rbd_model.vehicle.parameters import VehicleParameters
from readers.documents import read_document

#: Colours and dashes of the lines of a chart, in order: neighbours differ in both.
COLOURS = (plots.LEADING, plots.TRAILING, plots.BOGIE, plots.THESIS, "#e69f00", "#56b4e9")
DASHES = ("solid", "dash", "dot", "dashdot", "longdash")
#: Letters of a name that fit on a telephone.
NAME_WIDTH = 44
#: Largest number of rows that are drawn as single marks.
FEW_ROWS = 60
#: Number of lines that a chart shows first; a click on the names of the others shows them.
FIRST_SHOWN = 12
#: Largest ratio of the largest values of lines with one unit that share a chart.
APART = 30.0
DISPLAY = {"responsive": True, "displaylogo": False}


def write_report(scenario: Scenario, report: Report, folder: Path) -> None:
    """Write report.html next to summary.json and the figures, from which it is made."""
    summary = read_document(folder / "summary.json")
    motion = report.motion and report.motion()
    judged, others = parted(summary["rows"], lambda row: row["holds"])
    text = filled(
        "report.html.jinja",
        {"figure": number, "note": note},
        title=scenario.name,
        text=scenario.summary,
        summary=summary,
        holds=verdict_of(row["holds"] for row in summary["rows"]),
        sentence=sentence(summary["rows"], ": " + "; ".join(r["quantity"] for r in judged if not r["holds"])),
        judged=judged,
        others=others,
        columns=columns(summary["rows"]),
        data=motion and packed(motion) | {"colours": plots.FOUR if len(motion.vehicle.wheelsets) > 2 else COLOURS},
        motion_text=motion and motion.text,
        most_exaggeration=MOST_EXAGGERATION,
        charts=list(charts(report)),
        pictures=pictures(folder, summary),
        parameters=list(parameters(summary["parameters"])),
        plotly=get_plotlyjs(),
    )
    (folder / "report.html").write_text(text, encoding="utf-8")


def pictures(folder: Path, summary: Mapping[str, Any]) -> list[dict[str, str]]:
    """Return text and data (PNG as base64) of the figures of a folder, figure.png first.

    A figure without a message in the summary is described by its name.
    """
    texts = summary.get("pictures", {})
    paths = sorted(folder.glob("*.png"), key=lambda path: (path.stem != "figure", path.stem))
    return [
        {
            "text": texts.get(path.name) or f"Picture of {summary['scenario']}: {path.stem}",
            "data": base64.b64encode(path.read_bytes()).decode(),
        }
        for path in paths
    ]


def sentence(rows: Sequence[Mapping[str, Any]], which: str) -> str:
    """Return the verdict of all rows with limits; which: the end of the message about failures."""
    verdicts = [row["holds"] for row in rows]
    failed, judged = verdicts.count(False), len(verdicts) - verdicts.count(None)
    if not judged:
        return "No row is judged."
    if not failed:
        return "The only judged row holds." if judged == 1 else f"All {judged} judged rows hold."
    return f"{failed} of {judged} judged rows {'does' if failed == 1 else 'do'} not hold{which}."


def columns(rows: list[dict[str, Any]]) -> dict[str, str]:
    """Return the heads of the numbers that any row has, by their keys."""
    heads = {"thesis": "thesis", "vampire": "VAMPIRE", "simulated": "simulated", "deviation": "deviation"}
    return {key: head for key, head in heads.items() if any(row[key] is not None for row in rows)}


def note(row: Mapping[str, Any]) -> str:
    """Return the note below a row: its source, the assumptions, and otherwise the reason why it has no limit."""
    parts = [row["source"], row["assumption"]]
    if row["holds"] is None and not row["assumption"]:
        lacking = "no value that it could be held to" if row["thesis"] is None else "what it hangs on is not printed"
        parts.append(f"not judged: {lacking}")
    return "; ".join(filter(None, parts))


# -- charts ----------------------------------------------------------------------------------------------------------


def charts(report: Report) -> Iterator[dict[str, Any]]:
    """Yield title, number of lines and HTML of charts; columns of one unit and similar sizes share a chart."""
    for title, series in {"": report.series, **report.other_series}.items():
        for names in together(series):
            head = heading(title, names, series.units[names[0]])
            yield {"title": head, "lines": len(names), "html": chart(series, names)}


def together(series: Recording) -> Iterator[list[str]]:
    """Yield the names of the columns that share a chart, in their order."""
    left = series.names[1:]
    while left:
        similar = [name for name in left if series.units[name] == series.units[left[0]]]
        sizes = {name: float(np.nanmax(np.abs(series[name]), initial=0.0)) for name in similar}
        largest = max(sizes.values())
        chosen = [name for name in similar if sizes[name] * APART >= largest]
        yield chosen
        left = [name for name in left if name not in chosen]


def heading(title: str, names: list[str], unit: str) -> str:
    """Return the heading of a chart with its names and unit."""
    shown = ", ".join(names) if len(names) < 4 else f"{names[0]} and {len(names) - 1} others"
    return f"{title + ': ' if title else ''}{shown} [{unit}]"


def chart(series: Recording, names: list[str]) -> str:
    """Return the HTML of one chart, without the library."""
    first = series.names[0]
    mode = "lines+markers" if series[first].size <= FEW_ROWS else "lines"
    if np.any(np.diff(series[first]) < 0.0):
        mode = "markers"
    lines = [
        go.Scatter(
            x=series[first].astype(np.float32),
            y=series[name].astype(np.float32),
            name=wrapped(name),
            mode=mode,
            visible=True if place < FIRST_SHOWN else "legendonly",
            line={"color": COLOURS[place % len(COLOURS)], "dash": DASHES[place % len(DASHES)], "width": 1.6},
        )
        for place, name in enumerate(names)
    ]
    axes = {"xaxis": f"{first} [{series.units[first]}]", "yaxis": f"[{series.units[names[0]]}]"}
    return drawn(go.Figure(lines, {axis: {"title": {"text": escape(text)}} for axis, text in axes.items()}))


def drawn(figure: go.Figure) -> str:
    """Return the HTML of a figure in the common style."""
    figure.update_layout(
        template="none",
        margin={"l": 60, "r": 15, "t": 30, "b": 40},
        showlegend=True,
        legend={"orientation": "h", "y": -0.25, "yanchor": "top", "x": 0, "font": {"size": 11}},
        hovermode="closest",
    )
    figure.update_xaxes(zeroline=False, automargin=True, title={"standoff": 4})
    figure.update_yaxes(zeroline=False, exponentformat="power", automargin=True)
    return str(figure.to_html(full_html=False, include_plotlyjs=False, config=DISPLAY))


def wrapped(name: str) -> str:
    """Return a name in lines that fit on a telephone."""
    return "<br>".join(escape(line) for line in textwrap.wrap(name, NAME_WIDTH))


# -- parameters ------------------------------------------------------------------------------------------------------


def parameters(values: Mapping[str, Any], within: str = "") -> Iterator[dict[str, Any]]:
    """Yield all parameters, with groups opened; units and meanings come from the parameter set of that name, if any."""
    sets = (VehicleParameters, TrackParameters, BrakeParameters, FlowParameters)
    known = {item.name: item.metadata for one in sets for item in fields(one)}
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from parameters(value, f"{within}{name}, ")
        else:
            about = known.get(name, {"unit": "", "description": ""})
            yield {"name": f"{within}{name}", "value": value, "unit": about["unit"], "text": about["description"]}
