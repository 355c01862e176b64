"""Page of the command `etcs`: limits over the line with own stops and gradients, and tables, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs
from plotly.subplots import make_subplots

from bogie_braking.braking_curves.compute import CurveResults
from bogie_braking.braking_curves.pictures import message_of_stops, range_of_line
from bogie_braking.braking_curves.safety import lines_of
from bogie_braking.braking_curves.words import (
    TIMES,
    lines_of_target,
    shift_words,
    steps_words,
    title_of_distances,
    train_words,
)
from bogie_braking.reporting.html_report import drawn
from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING
from bogie_braking.web.frame import filled
from products.etcs_files.train_file import SWITCHES
from readers.storage import write_whole

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
#: Share of the height for speeds and for the gradient, and room behind the place that no train may pass.
HEIGHTS, BEHIND = (0.78, 0.22), 0.04


def write_page(found: CurveResults) -> None:
    """Write the page to --page. Raises StorageError."""
    tables = [_distances(found), _train(found), _factors(found), _settings(found)]
    if found.moves:
        rows = [(move.name, f"{move.most:.3g}", "" if move.unit == "1" else move.unit) for move in found.moves]
        tables.append(_table("Rounded to the safe side, at most by", rows, ("variable", "by", "unit")))
    page = filled(
        "etcs.html.jinja",
        title=f"Braking curves of ETCS: {found.chosen.file.name}",
        sentence=message_of_stops(found),
        holds=all(stop.ends <= found.ends for stop in found.stops),
        chart=drawn(_figure(found)),
        tables=tables,
        plotly=get_plotlyjs(),
    )
    write_whole(found.chosen.page, page.encode(), "name another file with --page")


def _figure(found: CurveResults) -> go.Figure:
    """Return the limits and own stops over the line, and the gradient below."""
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, row_heights=list(HEIGHTS), vertical_spacing=0.06)
    for name, colour, dash, first in LINES:
        places = getattr(found.many, name)
        if places is not None:
            _add(figure, places, found.many.V_est, name, {"color": colour, "dash": dash, "width": 2.0}, first)
    for number, stop in enumerate(found.stops):
        style = {"color": "#555555", "dash": "dot", "width": 1.2}
        _add(figure, stop.places, stop.speeds, "" if number else "own stops from EBI", style, True)
    left, right, starts = range_of_line(found, BEHIND)
    heights = np.append(found.gradients.permille, found.gradients.permille[-1])
    style = {"color": BOGIE, "width": 2.0, "shape": "hv"}
    line = go.Scatter(x=starts, y=heights, mode="lines", line=style, showlegend=False, name="gradient")
    figure.add_trace(line, row=2, col=1)
    figure.add_vline(x=found.ends, line={"color": "#b2182b", "width": 1})
    figure.update_xaxes(range=[left, right])
    figure.update_xaxes(title_text="distance along the line [m]", row=2, col=1)
    figure.update_yaxes(title_text="speed [km/h]", rangemode="tozero", row=1, col=1)
    figure.update_yaxes(title_text="gradient [‰]", row=2, col=1)
    return figure


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


def _table(title: str, rows: Sequence[Sequence[str]], heads: Sequence[str] = ()) -> dict[str, Any]:
    """Return a table; cells below heads are numbers."""
    return {"title": title, "heads": heads, "rows": rows, "numbers": bool(heads)}


def _distances(found: CurveResults) -> dict[str, Any]:
    """Return the distances before the place that no train may pass, the fastest row last."""
    rows = [[f"{number:.1f}" for number in row] for row in found.distances(found.limits)]
    heads = ("V_est [km/h]", *found.limits, *(["own stop"] if found.stops else []))
    return _table(title_of_distances(found), rows, heads)


def _train(found: CurveResults) -> dict[str, Any]:
    """Return the train data."""
    train = found.data.train
    rows = [("train", train_words(found)), ("L_TRAIN", f"{float(np.asarray(train.length)):.2f} m")]
    rows += [(name, f"{float(np.asarray(getattr(train, name))):.3f} s") for name in (*TIMES, "T_traction_cut_off")]
    for name in ("A_brake_emergency", "A_brake_service", "A_brake_normal_service"):
        if getattr(train, name) is not None:
            rows.append((f"{name} [m/s2]", steps_words(getattr(train, name))))
    known = "unknown: 15 % uphill, 2 % downhill"
    rows.append(("M_rotating_nom", known if train.rotating is None else f"{float(np.asarray(train.rotating)):g} %"))
    rows += [(name, "yes" if getattr(train, of) else "no") for name, of in SWITCHES.items()]
    if found.data.runs is not None:
        rows.append(("steps add to the braking distance", f"{100 * found.data.runs.emergency.loss:.2f} %"))
    return _table("Train data", rows)


def _factors(found: CurveResults) -> dict[str, Any]:
    """Return the factors in use and of all levels, and what decides them."""
    data, train = found.data, found.data.train
    if train.position is not None:
        words = "none: the country corrects brake percentages by Kv_int, Kr_int and Kt_int"
        return _table("Factors", [("Kdry_rst, Kwet_rst", words)])
    rows = [("Kdry_rst in use", steps_words(train.Kdry_rst)), ("Kwet_rst", steps_words(train.Kwet_rst))]
    rows += [(f"Kdry_rst of level {n}", steps_words(steps)) for n, steps in enumerate(data.dry_by_level)]
    if data.safety is not None:
        rows += [("", line.strip()) for line in lines_of(data.safety) if line]
    return _table("Factors", rows)


def _settings(found: CurveResults) -> dict[str, Any]:
    """Return the target, the baseline and the national values."""
    chosen, country = found.chosen, found.country
    yes = {True: "yes", False: "no"}
    adhesion = ", ".join(f"{most:g}" for most in country.reduced_adhesion)
    rows = [
        ("target", f"{found.kind} at {chosen.target:g} m, {chosen.target_speed:g} km/h"),
        ("supervised location", f"{chosen.beyond:g} m behind the target"),
        *([] if found.release_speed is None else [("release speed", f"{3.6 * found.release_speed:.0f} km/h")]),
        ("line", "level" if chosen.line is None else chosen.line.name),
        ("reduced adhesion", yes[chosen.slippery]),
        ("baseline", chosen.baseline),
        ("national values", "SUBSET-026, A.3.2" if chosen.national is None else chosen.national.name),
        ("M_NVEBCL", f"{country.M_NVEBCL}"),
        ("M_NVAVADH", f"{country.M_NVAVADH:g}"),
        ("Kv_int", steps_words(country.Kv_int)),
        *([] if country.Kv_int_b is None else [("Kv_int of set b", steps_words(country.Kv_int_b))]),
        ("A_NVP12, A_NVP23", f"{country.A_NVP12:g}, {country.A_NVP23:g} m/s2"),
        ("Kr_int", steps_words(country.Kr_int, "m", 1.0)),
        ("Kt_int", f"{country.Kt_int:g}"),
        ("A_NVMAXREDADH1 to 3", f"{adhesion} m/s2"),
        ("Q_NVGUIPERM, Q_NVINHSMICPERM", f"{yes[country.guidance]}, {yes[country.exact_speed]}"),
        ("Q_NVSBFBPERM", yes[country.feedback]),
        *(("note", line) for line in lines_of_target(found)),
        *([("rounding", shift_words(found))] if found.shifts else []),
    ]
    return _table("Settings", rows)
