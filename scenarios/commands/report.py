"""The command `report`: joins the results of a folder into one page, index.html.

The page shows the verdicts of runs with links to their reports, thesis against simulation at a glance, sweeps with
their tables, and the folders that are not shown, with the reason.
"""

from __future__ import annotations

import argparse
import sys
from html import escape
from pathlib import Path
from typing import Any

from bogie_braking.common_options import add_out
from bogie_braking.exit_status import HOLDS
from bogie_braking.reporting import plots
from bogie_braking.reporting.report import VERDICTS, number, parted, verdict_of
from bogie_braking.reporting.saved import SavedRun, results_in
from bogie_braking.reporting.scenario import BadInputError
from bogie_braking.web.frame import filled
from readers.command_line import check_folder
from readers.extras import need
from readers.storage import write_whole
from scenarios.catalogue import SCENARIOS

#: Mark and colour by verdict; the shapes of the marks differ.
MARKS = {True: ("circle", plots.LEADING), None: ("diamond-open", plots.BOGIE), False: ("x", plots.TRAILING)}
#: Height of the chart: fixed part, and part of each scenario [pixels].
CHART_HEIGHT, LINE_HEIGHT = 190, 24


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of `report`."""
    add_out(parser)


def run(chosen: argparse.Namespace) -> int:
    """Join all results of a folder into one page, and print which are left out."""
    check_folder(chosen.out)
    need("plotly")
    page, skipped = write_index(chosen.out)
    for message in skipped:
        print(message, file=sys.stderr)
    print(f"Index: {page}")
    return HOLDS


def write_index(out: Path) -> tuple[Path, list[str]]:
    """Write the index into the folder of the results."""
    from plotly.offline import get_plotlyjs  # an optional dependency

    from bogie_braking.reporting.html_report import sentence

    texts = {scenario.name: scenario.summary for scenario in SCENARIOS}
    order = {name: place for place, name in enumerate(texts)}
    found = results_in(out)
    if not (found.runs or found.sweeps):
        advice = "run a scenario first, or give their folder with --out."
        raise BadInputError("\n".join([*found.skipped, f"There are no results in {out}; {advice}"]))
    judged, others = parted(sorted(found.runs, key=lambda one: order.get(one.name, len(order))), lambda one: one.holds)
    runs = [*judged, *others]
    rows = [row for one in runs for row in one.rows]
    printed = [one for one in runs if one.printed]
    text = filled(
        "index.html.jinja",
        {"figure": number},
        title="Results",
        runs=runs,
        printed=printed,
        sweeps=found.sweeps,
        skipped=found.skipped,
        texts=texts,
        holds=verdict_of(one.holds for one in runs),
        sentence=sentence(rows, ", in " + ", ".join(one.name for one in runs if one.holds is False)),
        chart=chart(printed),
        height=CHART_HEIGHT + LINE_HEIGHT * len(printed),
        plotly=get_plotlyjs(),
    )
    write_whole(out / "index.html", text.encode())
    return out / "index.html", found.skipped


def chart(results: list[SavedRun]) -> str:
    """Return a chart of simulated over published values, one line for each scenario."""
    import plotly.graph_objects as go

    from bogie_braking.reporting.html_report import drawn

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
    names = [result.name for result in results]
    figure.update_yaxes(categoryorder="array", categoryarray=names, autorange="reversed")
    figure.update_xaxes(title={"text": "simulated over printed value [1]"})
    return drawn(figure)


def hover(row: dict[str, Any]) -> str:
    thesis, simulated = number(row["thesis"]), number(row["simulated"])
    return escape(f"{row['quantity']}: thesis {thesis}, simulated {simulated} {row['unit']}")
