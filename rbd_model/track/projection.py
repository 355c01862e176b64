"""Degrees of latitude and longitude to metres: a transverse Mercator projection about the middle of the points.

Kruger's series in the third flattening to the third order (C. F. F. Karney (2011), Transverse Mercator with an accuracy
of a few nanometers, Journal of Geodesy 85, eqs. (7) to (11) and (35)), on the ellipsoid of WGS 84. The scale is 1 on
the central meridian.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
#: Semi-major axis [m] and flattening of WGS 84 (NIMA TR8350.2).
AXIS, FLATTENING = 6_378_137.0, 1 / 298.257223563


def transverse_mercator(latitude: Numbers, longitude: Numbers) -> tuple[Numbers, str]:
    """Return east and north [m], shape (n, 2), and a sentence about the projection.

    Takes latitude, longitude (n,).
    """
    turned = np.degrees(np.unwrap(np.radians(longitude)))
    middle = (turned.min() + turned.max()) / 2.0
    n = FLATTENING / (2.0 - FLATTENING)
    eccentric = 2.0 * math.sqrt(n) / (1.0 + n)
    sine = np.sin(np.radians(latitude))
    conformal = np.sinh(np.arctanh(sine) - eccentric * np.arctanh(eccentric * sine))
    away = np.radians(turned - middle)
    north = np.arctan2(conformal, np.cos(away))
    east = np.arcsinh(np.sin(away) / np.hypot(conformal, np.cos(away)))
    alpha = (
        n / 2 - 2 * n**2 / 3 + 5 * n**3 / 16,
        13 * n**2 / 48 - 3 * n**3 / 5,
        61 * n**3 / 240,
    )
    radius = AXIS / (1.0 + n) * (1.0 + n**2 / 4.0 + n**4 / 64.0)
    ahead, aside = north.copy(), east.copy()
    for order, part in enumerate(alpha, 1):
        ahead += part * np.sin(2 * order * north) * np.cosh(2 * order * east)
        aside += part * np.cos(2 * order * north) * np.sinh(2 * order * east)
    scale = float(np.max(np.cosh(east))) - 1.0
    told = (
        f"latitude and longitude: transverse Mercator on WGS 84 about {middle:.6f} degrees of longitude; lengths are "
        f"up to {1e6 * scale:.1f} mm/km too long"
    )
    return radius * np.column_stack([aside, ahead]), told
