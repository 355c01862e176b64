"""A figure of a line: its plan, and curvature, cant and gradient over distance."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, legend_above, widen
from rbd_model.track.line import Line

#: Colours in curves to the left, on straight track, in curves to the right. A curve is steeper than a third of the
#: largest curvature.
LEFT_CURVE, STRAIGHT, RIGHT_CURVE = LEADING, BOGIE, TRAILING
#: Largest number of distance marks on a plan, and largest distance between drawn places [m].
MOST_MARKS, PITCH = 8, 5.0
#: Least range of the axes of curvature [1/km], cant [mm], and gradient and height [per mille, m].
LEAST = (0.01, 1.0, 0.1)


def draw_line(axes: Sequence[Axes], line: Line) -> None:
    """Draw the plan, curvature, cant with the rails' heights if known, and gradient with the height, on four axes."""
    plan, curvature, cant, gradient = axes
    line = with_places_between(line)
    draw_plan(plan, line)
    distance = line.rows["distance"]
    curvature.plot(distance, 1e3 * line.rows["curvature"], color=BOGIE)
    curvature.set_title("curvature, to the left [1/km]")
    cant.plot(distance, 1e3 * line.rows["cant"], color=BOGIE, label="cant")
    if "left_vertical" in line.rows and "right_vertical" in line.rows:
        cross_level = line.rows["right_vertical"] - line.rows["left_vertical"]
        cant.plot(distance, 1e3 * cross_level, color=TRAILING, linewidth=0.6, label="irregular cross level")
        legend_above(cant)
    cant.set_title("right rail higher by [mm]")
    gradient.plot(distance, 1e3 * line.rows["gradient"], color=BOGIE, label="gradient [‰]")
    gradient.plot(distance, height(line), color=LEADING, linestyle="--", label="height [m]")
    legend_above(gradient)
    gradient.set_title("gradient [‰] and height above the start [m]")
    for axis, least in zip(axes[1:], LEAST, strict=True):
        widen(axis, least)
        axis.set_xlim(distance[0], distance[-1])


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
