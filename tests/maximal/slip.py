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


def polach(patch: Rolling) -> tuple[float, float]:
    """Return forces on the wheel along and sideways [N] with spin: O. Polach (1999) in chapter 3's form,
    (3.92)-(3.105).

    The force of spin has the sign of right-handed axes and is divided by the creepage that includes the spin.
    """
    (x, y, spin), (a, b) = patch.creepages, patch.semi_axes
    c11, c22, c23 = kalker(a / b)
    limit = patch.friction * patch.load
    corrected = y + spin * a if abs(y + spin * a) > abs(y) else y
    total = math.hypot(x, corrected)
    if total == 0.0:
        return 0.0, 0.0
    plain = math.hypot(x, y)
    mean = math.hypot(c11 * x, c22 * y) / plain if plain > 0.0 else c22
    gradient = math.pi / 4 * patch.shear_modulus * a * b * mean * total / limit
    force = -2 * limit / math.pi * (gradient / (1 + gradient**2) + math.atan(gradient))

    # The force due to spin only.
    shape = 1 + 6.3 * (1 - math.exp(-a / b))
    e = 8 / 3 * patch.shear_modulus * b * math.sqrt(a * b) / limit * c23 * abs(corrected) / shape
    d = (e**2 - 1) / (e**2 + 1)
    part = e * (d**3 / 3 - d**2 / 2 + 1 / 6) - math.sqrt((1 - d**2) ** 3) / 3
    from_spin = 9 / 16 * a * limit * part * shape * spin / total
    return force * x / total, force * y / total + from_spin


def kalker_to_coulomb(patch: Rolling) -> tuple[float, float]:
    """Return forces on the wheel [N]: Kalker's linear ones, reduced together by the cubic of Vermeulen and Johnson.

    Their direction turns to the mean sliding with the square of the linear force of creepage, half at 3 mu N.
    """
    (x, y, spin), (a, b) = patch.creepages, patch.semi_axes
    c11, c22, c23 = kalker(a / b)
    limit = patch.friction * patch.load
    of_creepage = patch.shear_modulus * a * b * np.array([c11 * x, c22 * y]) / limit
    linear = of_creepage + np.array([0.0, patch.shear_modulus * (a * b) ** 1.5 * c23 * spin / limit])
    size, creepage = float(np.linalg.norm(linear)), math.hypot(x, y)
    if size == 0.0:
        return 0.0, 0.0
    force = 1 - (1 - size / 3) ** 3 if size < 3.0 else 1.0
    direction = linear / size
    if creepage > 0.0:
        # The variance of the spin's sliding across that of the creepage, under Hertz's pressure.
        across = spin**2 * ((a * x) ** 2 + (b * y) ** 2) / (5 * creepage**2)
        part = float(of_creepage @ of_creepage)
        part /= part + 9.0
        direction = (1 - part) * direction + part * np.array([x, y]) / math.sqrt(creepage**2 + across)
    return float(-limit * force * direction[0]), float(-limit * force * direction[1])
