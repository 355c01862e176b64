"""The figure of the smoothing of measured profiles: how far their points lie off the contour, and its curvature."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from bogie_braking.reporting.plots import LEADING, TRAILING, plt, titled
from rbd_model.contact.profiles import SMOOTHING, Profile, from_points

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Steepest slope that is drawn, 70 degrees: wheels bear on less. Largest curvature that is drawn [1/m], R 8 mm.
STEEPEST, MOST_CURVED = float(np.tan(np.radians(70.0))), 125.0
GREY = "#999999"


def draw_smoothing(profiles: Sequence[Profile]) -> Figure:
    """Draw distance of the points and curvature with and without smoothing, a column for each measured profile."""
    figure, grid = plt.subplots(2, len(profiles), figsize=(4.75 * len(profiles), 5.6), sharex="col", squeeze=False)
    distances = []
    for (above, below), one in zip(grid.T, profiles, strict=True):
        y, off = distance_of_points(one)
        above.plot(1e3 * y, 1e6 * off, ".", color=LEADING, markersize=2.5)
        above.set_title(f"{one.name}\npoints above the contour used [µm]", fontsize=9)
        at = np.linspace(*one.limits, 4000)
        raw = from_points(one.name, one.source, *_points(one).T)
        for profile, colour, label in ((raw, GREY, "least squares"), (one, TRAILING, "smoothed, in use")):
            below.plot(1e3 * at, curvature(profile, at), color=colour, linewidth=0.9, label=label)
        below.set_ylim(-MOST_CURVED, MOST_CURVED)
        below.set_title("curvature [1/m], positive where hollow", fontsize=9)
        below.set_xlabel("y, to the field side [mm]")
        distances.append(np.abs(off))
    grid[1, 0].legend(loc="lower center")
    most = 1e6 * max(float(np.max(distance)) for distance in distances)
    return titled(figure, f"Smoothing over {1e3 * SMOOTHING:g} mm moves points by up to {most:.{int(most < 10)}f} µm")


def distance_of_points(profile: Profile) -> tuple[np.ndarray, np.ndarray]:
    """Return y of the points up to the slope STEEPEST, and their distances above the contour, square to it [m]."""
    y, z = _points(profile).T
    slope = profile.height(y, 1)
    kept = np.maximum(np.abs(slope), np.abs(np.gradient(z, y))) < STEEPEST
    return y[kept], ((z - profile.height(y)) / np.sqrt(1 + slope**2))[kept]


def curvature(profile: Profile, y: np.ndarray) -> np.ndarray:
    """Return the curvature of a contour at positions y [m], positive if it is hollow from above [1/m]; NaN on walls."""
    slope = profile.height(y, 1)
    return np.where(np.abs(slope) < STEEPEST, profile.height(y, 2) / (1 + slope**2) ** 1.5, np.nan)


def _points(profile: Profile) -> np.ndarray:
    if profile.points is None:
        raise ValueError(f"A profile must be measured if its smoothing is drawn; {profile.name} has no points.")
    return profile.points
