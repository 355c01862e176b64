"""Pressures over time and along a train as colours."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh

from scenarios.bench.train_runs import TrainCourse


def draw_pressures(axis: Axes, course: TrainCourse, of: str, until: float, ends: tuple[float, float]) -> QuadMesh:
    """Draw pressures to a time [s], head above; of: `pipe` or `cylinder`; ends: of the colours [bar]."""
    shown, place = course.time <= until, course.distance[0, 0] - course.distance[0]
    pressure = getattr(course, of)[shown].T / 1e5
    axis.set_ylim(place[-1], place[0])
    axis.grid(visible=False)
    least, most = ends
    return axis.pcolormesh(
        course.time[shown], place, pressure, vmin=least, vmax=most, cmap="cividis", shading="nearest"
    )
