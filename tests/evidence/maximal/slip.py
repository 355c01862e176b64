"""Creep forces of one patch in plain floats: Polach (1999) on treads, Kalker to Coulomb on flanges."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

#: Kalker (1990), Three-Dimensional Elastic Bodies in Rolling Contact, table E.3, Poisson's ratio 0.25:
#: a/b, c11, c22, c23.
TABLE_E3 = (
    (0.1, 3.31, 2.52, 0.473),
    (0.2, 3.37, 2.63, 0.603),
    (0.3, 3.44, 2.75, 0.715),
    (0.4, 3.53, 2.88, 0.823),
    (0.5, 3.62, 3.01, 0.929),
    (0.6, 3.72, 3.14, 1.03),
    (0.7, 3.81, 3.28, 1.14),
    (0.8, 3.91, 3.41, 1.25),
    (0.9, 4.01, 3.54, 1.36),
    (1.0, 4.12, 3.67, 1.47),
    (1 / 0.9, 4.22, 3.81, 1.59),
    (1 / 0.8, 4.36, 3.99, 1.75),
    (1 / 0.7, 4.54, 4.21, 1.95),
    (1 / 0.6, 4.78, 4.50, 2.23),
    (1 / 0.5, 5.10, 4.90, 2.62),
    (1 / 0.4, 5.57, 5.48, 3.24),
    (1 / 0.3, 6.34, 6.40, 4.32),
    (1 / 0.2, 7.78, 8.14, 6.63),
    (1 / 0.1, 11.7, 12.8, 14.6),
)
#: Degree of the polynomials ln(c) over ln(a/b) that the fast model's law fits to the table, and the a/b of its end.
DEGREE, END = 5, 10.0


@lru_cache
def _fits() -> tuple[np.ndarray, ...]:
    ratio, *columns = np.log(np.array(TABLE_E3)).T
    return tuple(np.polyfit(ratio, column, DEGREE) for column in columns)


def kalker(axis_ratio: float) -> tuple[float, float, float]:
    """Return c11, c22 and c23 of an ellipse a/b: from the table, and beyond it from the limits for slender ellipses.

    Beyond the table the ratio to these limits goes from its value at the end of the table to 1, linearly in b/a.
    """
    inside = min(axis_ratio, END)
    found = np.exp([np.polyval(fit, math.log(inside)) for fit in _fits()])
    if axis_ratio > END:
        share = END / axis_ratio
        found = slender(axis_ratio) * (1 + share * (found / slender(END) - 1))
    return float(found[0]), float(found[1]), float(found[2])


def slender(axis_ratio: float) -> np.ndarray:
    """Return the limits of c11, c22, c23 for b/a -> 0: Kalker (1990), table E.3, last row."""
    g, nu = 1 / axis_ratio, 0.25
    size = math.log(16 / g**2)
    of_x, of_y = size - 2 * nu, (1 - nu) * size + 2 * nu
    return np.array(
        [
            2 * math.pi / (of_x * g) * (1 + (3 - math.log(4)) / of_x),
            2 * math.pi / (of_y * g) * (1 + (1 - nu) * (3 - math.log(4)) / of_y),
            2 * math.pi / (3 * g * math.sqrt(g) * ((1 - nu) * size - 2 + 4 * nu)),
        ]
    )


@dataclass(frozen=True)
class Rolling:
    """A rolling patch: creepages along, sideways [1] and spin [1/m], load [N], friction, semi-axes [m], G [Pa]."""

    creepages: tuple[float, float, float]
    load: float
    friction: float
    semi_axes: tuple[float, float]
    shear_modulus: float


def kalker_to_coulomb(patch: Rolling) -> tuple[float, float]:
    """Return forces on the wheel [N]: adhesion that saturates, and sliding about a pole, as springs in series.

    The constants are those of the law; the pole is displaced by the lag of stress behind the sliding.
    """
    (x, y, spin), (a, b) = patch.creepages, patch.semi_axes
    c11, c22, c23 = kalker(a / b)
    limit = patch.friction * patch.load
    unit = patch.shear_modulus * a * b / limit
    ahead, aside, turning = unit * c11 * x, unit * c22 * y, unit * math.sqrt(a * b) * c23 * spin
    whole = math.hypot(ahead, aside + turning)
    most = 2.8 * math.sqrt(a / b)
    falls = 1 + 1.8 * turning**2 + 5 * (turning / most) ** 2 * (turning**2 + 0.7 * a / b * whole**2)
    lagging = aside + turning * math.sqrt((1 + 5 * turning**2) / falls)
    size = math.hypot(ahead, lagging)
    if size == 0.0:
        return 0.0, 0.0
    plain = math.hypot(ahead, aside)
    of_spin = size - 4 / 27 * size**3 if size < 1.5 else 1.0
    of_creepage = 1 - (1 - size / 3) ** 3 if size < 3.0 else 1.0
    held = (plain**2 * of_creepage + 2.4 * turning**2 * of_spin) / (plain**2 + 2.4 * turning**2)

    slides = np.array([x, lagging / (unit * c22)])
    distant = 1 / (1 + 0.13 * spin**2 * (a**2 + b**2) / (slides @ slides))
    far = 0.2 * ((a * x) ** 2 + (b * slides[1]) ** 2) / (slides @ slides)
    near = (8 / (3 * math.pi)) ** 2 * (a * b + np.array([b, a]) ** 2) / 2
    mean = slides / np.sqrt(slides @ slides + spin**2 * (distant * far + (1 - distant) * near))
    slid = float(np.linalg.norm(mean))
    both = 1 / math.sqrt(1 / held**2 + 1 / slid**2 - 1)
    ends = 25 * (unit * spin) ** 2 * ((c11 * b) ** 2 + (c22 * a) ** 2)
    turned = 1 / (1 + 4 / (whole**2 + ends))
    force = (1 - turned) * np.array([ahead, lagging]) / size + turned * mean / slid
    return float(-limit * both * force[0]), float(-limit * both * force[1])
