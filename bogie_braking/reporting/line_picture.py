"""Figures of a line: plan, curvature, cant and gradient; what it demands at a speed; the smoothing of points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, legend_above, plt, titled, widen
from rbd_model.track.line import FRICTIONS, Line
from rbd_model.track.line_check import AdhesionCheck, LineCheck, deficiency_of
from rbd_model.track.line_points import LineFromPoints
from rbd_model.track.point_account import length_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours in curves to the left, on straight track, in curves to the right. A curve is steeper than a third of the
#: largest curvature.
LEFT_CURVE, STRAIGHT, RIGHT_CURVE = LEADING, BOGIE, TRAILING
#: Largest number of distance marks on a plan, and largest distance between drawn places [m].
MOST_MARKS, PITCH = 8, 5.0
#: Least range of the axes of curvature [1/km], cant [mm], and gradient and height [per mille, m].
LEAST = {"curvature": 0.01, "cant": 1.0, "deficiency": 1.0, "gradient": 0.1}
#: Columns of a line with irregular heights of its rails.
IRREGULAR = {"left_vertical", "right_vertical"}
#: Smallest curvature that is a curve in a title [1/m].
CURVED = 1e-6


def draw_line(axes: Mapping[str, Axes], line: Line) -> None:
    """Draw the charts of a line, on an axis for each name of `charts_of`."""
    line = with_places_between(line)
    distance, rows = line.rows["distance"], line.rows
    if "plan" in axes:
        draw_plan(axes["plan"], line)
    if curvature := axes.get("curvature"):
        curvature.plot(distance, 1e3 * rows["curvature"], color=BOGIE)
        curvature.set_title("curvature, to the left [1/km]")
    if cant := axes.get("cant"):
        cant.plot(distance, 1e3 * rows["cant"], color=BOGIE, label="cant")
        if rows.keys() >= IRREGULAR:
            cross_level = rows["right_vertical"] - rows["left_vertical"]
            cant.plot(distance, 1e3 * cross_level, color=TRAILING, linewidth=0.6, label="irregular cross level")
            legend_above(cant)
        cant.set_title("right rail higher by [mm]")
    if gradient := axes.get("gradient"):
        gradient.plot(distance, 1e3 * rows["gradient"], color=BOGIE, label="gradient [‰]")
        gradient.plot(distance, height(line), color=LEADING, linestyle="--", label="height [m]")
        legend_above(gradient)
        gradient.set_title("gradient [‰] and height above the start [m]")
    for name in LEAST.keys() & axes.keys():
        widen(axes[name], LEAST[name])
        axes[name].set_xlim(distance[0], distance[-1])


def charts_of(line: Line, others: Sequence[str] = ()) -> list[str]:
    """Return the charts that show more than a zero, and others; of a straight and level line at least the gradient."""
    curved, canted, steep = (bool(np.any(line.rows[name])) for name in ("curvature", "cant", "gradient"))
    charts = ["plan", "curvature"] if curved else []
    charts += ["cant"] if canted or line.rows.keys() >= IRREGULAR else []
    charts += ["deficiency"] if curved or canted else []
    charts += ["gradient"] if steep else []
    return [*charts, *others] or ["gradient"]


def with_places_between(line: Line) -> Line:
    """Return the line with more rows, at most PITCH apart, interpolated as in the models."""
    rows = line.rows["distance"]
    places = np.union1d(rows, np.linspace(rows[0], rows[-1], int(np.ceil(line.length / PITCH)) + 1))
    return Line.of_any_size({name: line.value(name, places) for name in line.rows} | {"distance": places})


def integral(line: Line, values: np.ndarray) -> np.ndarray:
    """Return the integral of row values along the line, linear between rows; 0 at the first row."""
    steps = np.diff(line.rows["distance"]) * (values[:-1] + values[1:]) / 2
    return np.concatenate([[0.0], np.cumsum(steps)])


def height(line: Line) -> np.ndarray:
    """Return the height above the first row [m]."""
    return integral(line, line.rows["gradient"])


def draw_plan(axis: Axes, line: Line) -> None:
    """Draw the line from above: curves coloured by their side, distances as marks."""
    heading = integral(line, line.rows["curvature"])
    ahead, aside = integral(line, np.cos(heading)), integral(line, np.sin(heading))
    curvature = line.rows["curvature"]
    limit = np.max(np.abs(curvature)) / 3
    kinds = np.where(np.abs(curvature) > limit, np.sign(curvature), 0.0)
    words = {1.0: "curve to the left", 0.0: "straight, transition", -1.0: "curve to the right"}
    for kind, colour in ((1.0, LEFT_CURVE), (0.0, STRAIGHT), (-1.0, RIGHT_CURVE)):
        if np.any(kinds == kind):
            # a piece reaches to the next row, so that pieces meet
            shown = (kinds == kind) | (np.append(kinds[0], kinds[:-1]) == kind)
            part = np.where(shown, ahead, np.nan), np.where(shown, aside, np.nan)
            axis.plot(*part, color=colour, linewidth=2.5, label=words[kind])
    for place in marks(line):
        spot = tuple(np.interp(place, line.rows["distance"], values) for values in (ahead, aside))
        axis.plot(*spot, "o", color=BOGIE, markersize=3)
        axis.annotate(f"{place:g} m", spot, xytext=(3, 5), textcoords="offset points", fontsize=8)
    axis.set_aspect("equal", adjustable="datalim")
    axis.margins(0.08)
    axis.set_title("plan [m]")
    legend_above(axis, 3)


def marks(line: Line) -> np.ndarray:
    """Return round distances on the line [m]."""
    first, last = line.rows["distance"][[0, -1]]
    rough = (last - first) / MOST_MARKS
    size = 10.0 ** np.floor(np.log10(rough))
    pitch = next(size * factor for factor in (1.0, 2.0, 5.0, 10.0) if size * factor >= rough)
    return np.arange(np.ceil(first / pitch), np.floor(last / pitch) + 1) * pitch


def figure_of_check(line: Line, check: LineCheck, speed: float, friction: float | None = None) -> Figure:
    """Return plan, curvature, cant, cant deficiency at a speed [m/s], gradient with height, friction: those not zero.

    friction: that of the rail, which the line's factors multiply [1]; None: unknown.
    """
    charts = charts_of(line, ["friction"] if check.adhesion else [])
    ratios = [2.0 if name == "plan" else 1.0 for name in charts]
    figure, grid = plt.subplots(
        len(charts), 1, figsize=(9.0, 1.0 + 2.0 * sum(ratios)), height_ratios=ratios, squeeze=False
    )
    axes = dict(zip(charts, grid[:, 0], strict=True))
    draw_line(axes, line)
    if deficiency := axes.get("deficiency"):
        dense = with_places_between(line).rows
        lacking = 1e3 * deficiency_of(dense["curvature"], dense["cant"], speed)
        deficiency.plot(dense["distance"], lacking, color=LEADING)
        deficiency.axhline(0.0, color=BOGIE, linewidth=0.6)
        deficiency.set_title(f"cant deficiency at {3.6 * speed:.4g} km/h, outwards [mm]")
        widen(deficiency, LEAST["deficiency"])
    if check.adhesion is not None:
        draw_friction(axes["friction"], line, check.adhesion, friction or 1.0)
    axes[charts[-1]].set_xlabel("distance along the line [m]")
    if abs(check.tightest.value) < CURVED:
        if check.adhesion is not None and check.gradient.value == 0.0:
            what = "factor on friction" if check.adhesion.below is None else "friction"
            return titled(figure, f"The lowest {what} is {check.adhesion.lowest.value:.2g}")
        steepest = 1e3 * abs(check.gradient.value)
        return titled(figure, f"The line is straight, its gradient reaches {steepest:.3g} per mille")
    reached = 1e3 * check.deficiency.value
    return titled(figure, f"At {3.6 * speed:.4g} km/h the cant deficiency reaches {reached:.0f} mm")


def draw_friction(axis: Axes, line: Line, adhesion: AdhesionCheck, friction: float) -> None:
    """Draw friction of both rails along a line, and where their mean is slippery."""
    at = line.rows["distance"]
    for name, colour in zip(FRICTIONS, (LEADING, TRAILING), strict=True):
        values = friction * line.rows.get(name, np.ones_like(at))
        style = "-" if name == FRICTIONS[0] else "--"
        axis.plot(at, values, style, color=colour, label=f"{name.split('_')[0]} rail")
    for number, (begin, end) in enumerate(adhesion.stretches):
        axis.axvspan(begin, end, color="#fdd0a2", label=None if number else f"mean below {adhesion.below:g}")
    axis.set_ylim(0.0, 1.1 * max(friction * line.rows.get(name, np.ones(1)).max() for name in FRICTIONS))
    axis.set_xlim(at[0], at[-1])
    axis.set_title("factor on friction" if adhesion.below is None else "friction")
    legend_above(axis, 3)


def figure_of_points(line: LineFromPoints) -> Figure:
    """Return the curvature of a smoothed line with its bounds over that of triples of points, and the deviations."""
    known = bool(np.all(np.isfinite(line.gradient_error)))
    figure, axes = plt.subplots(2 + known, 1, figsize=(9.0, 5.5 + 2.5 * known), sharex=True)
    curvature, aside = axes[0], axes[-1]
    at, points = line.rows["distance"], line.points
    ways = np.hypot(*np.diff(points, axis=0).T)
    chords = np.interp(np.concatenate([[0.0], np.cumsum(ways)]) / ways.sum(), [0.0, 1.0], at[[0, -1]])
    steps = np.diff(points, axis=0)
    angle = np.arctan2(steps[:, 1], steps[:, 0])
    raw = np.angle(np.exp(1j * np.diff(angle))) * 2.0 / (ways[1:] + ways[:-1])
    smooth, error = 1e3 * line.rows["curvature"], 1e3 * line.curvature_error
    curvature.plot(chords[1:-1], 1e3 * raw, ".", color="#aaaaaa", markersize=3, label="three points")
    curvature.fill_between(at, smooth - error, smooth + error, color="#9ecae1", label="bounds")
    curvature.plot(at, smooth, color=LEADING, label="smoothed")
    low, high = float(np.min(smooth - error)), float(np.max(smooth + error))
    curvature.set_ylim(low - 0.4 * (high - low), high + 0.4 * (high - low))
    curvature.set_title("curvature, to the left [1/km]")
    legend_above(curvature, 3)
    if known:
        slope, bound = 1e3 * line.rows["gradient"], 1e3 * line.gradient_error
        axes[1].fill_between(at, slope - bound, slope + bound, color="#9ecae1")
        axes[1].plot(at, slope, color=LEADING)
        axes[1].set_title("gradient with its bounds [‰]")
    aside.plot(chords, 1e3 * line.aside, ".", color=TRAILING, markersize=3)
    aside.set_title("points beside the line, to the left [mm]")
    aside.set_xlabel("distance along the line [m]")
    return titled(figure, f"Noise of {length_of(line.noise)} leaves the curvature uncertain by {error.max():.2g} 1/km")
