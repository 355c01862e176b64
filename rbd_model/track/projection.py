"""Degrees of latitude and longitude to metres: the course is unrolled from the ellipsoid of WGS 84 into a plane.

A projection of a whole area distorts long lines: transverse Mercator by 1.2e-4 at 100 km from its meridian. The
unrolled course keeps its length and its geodesic curvature, which are those of the track, at any length. Each step has
the lengths M dB and N cos B dL with the ellipsoid's radii M, N at the middle latitude B, at the height of the track.
North turns by sin B dL along a step, the convergence of the meridians (W. Torge and J. Mueller (2012), Geodesy, 4th
edition, section 4.1). The error of a step of length s is of the order of (s / 6400 km)^2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
#: Semi-major axis [m] and flattening of WGS 84 (NIMA TR8350.2).
AXIS, FLATTENING = 6_378_137.0, 1 / 298.257223563


def unrolled(latitude: Numbers, longitude: Numbers, height: Numbers | float = 0.0) -> Numbers:
    """Return east and north [m] of a course, by the axes at its first point, shape (n, 2).

    Takes latitude, longitude [degrees] (n,), height [m].
    """
    height = np.broadcast_to(np.asarray(height, float), latitude.shape)
    middle, level = np.radians(latitude[1:] + latitude[:-1]) / 2.0, (height[1:] + height[:-1]) / 2.0
    north, east = np.diff(np.radians(latitude)), np.radians(np.mod(np.diff(longitude) + 180.0, 360.0) - 180.0)
    eccentric = FLATTENING * (2.0 - FLATTENING)
    root = np.sqrt(1.0 - eccentric * np.sin(middle) ** 2)
    steps = (AXIS / root + level) * np.cos(middle) * east
    steps = steps + 1j * (AXIS * (1.0 - eccentric) / root**3 + level) * north
    turn = east * np.sin(middle)
    place = np.append(0.0, np.cumsum(steps * np.exp(1j * (np.cumsum(turn) - turn / 2.0))))
    return np.column_stack([place.real, place.imag])
