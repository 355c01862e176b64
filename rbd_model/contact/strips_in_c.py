"""A wheel on its rail by strips as a part in C, for the level `spatial` at contact model 3.

This file writes the data of strips.c: contours, segments, and polynomials through exact theory.
"""

import hashlib
import math
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.special import ellipe, ellipkm1

from fmu_src.chain import Part, part_in_c
from rbd_model.contact.friction import GAUGE_FACE_BEGINS, HEAD_ENDS
from rbd_model.contact.geometry import Side
from rbd_model.contact.hertz import POISSON_RATIO
from rbd_model.contact.normal import ellipses
from rbd_model.contact.patches import parts_of, positions_of
from rbd_model.contact.profiles import Profile
from rbd_model.contact.strip_creep import coefficients

#: Sizes of the part. Arguments: a `PatchState` without its nearest point. Constants: a `Wheel`; the `surroundings` of
#: patched_wheelset.py without the slip reduction, which FASTSIM does not have; Poisson's ratio; 1 if creepage follows
#: the slope of the rail, else 0. Results: of a segment (`Press`) and of the wheel (place, angle, pressure). The last is
#: the largest number of segments. All are as in strips.c.
ARGUMENTS, CONSTANTS, OF_SEGMENT, OF_WHEEL, MOST_SEGMENTS = 13, 14, 11, 3, 6
#: Coefficients of a polynomial in strips.c, and a fit's largest distance from the exact values.
TERMS, ELLIPTIC_TERMS, FIT_ERROR = 12, 7, 2e-4
#: The same for Kalker's coefficients by c, 0.47 to 1.41. That of spin on the widest ellipses has the largest error.
KALKER_ERROR = 0.015
#: Axis ratios of ellipses from 1/30 to 30, and complements of the modulus from far strips to near ones.
LARGEST_LOGARITHM, LEAST_COMPLEMENT = math.log(30.0), 1e-9


def wheel_on_strips(side: Side, poisson_ratio: float = POISSON_RATIO) -> Part:
    """Return the part of a wheel on its rail: the forces of each segment, from the flange outwards, and the contact's
    place.

    Kalker (1982), Knothe and Le The (1984); see strips.c. Radius and distances are constants of the part: wheels that
    differ only in them share it. poisson_ratio: that of Kalker's coefficients; the normal force takes it from the
    constants.
    """
    return part_of_contours(side.wheel, side.rail, tuple(segments_of(side)), poisson_ratio)


@lru_cache
def part_of_contours(
    wheel: Profile, rail: Profile, segments: tuple[tuple[float, float], ...], poisson_ratio: float
) -> Part:
    """Return the part of all wheels with these contours, Knothe and Le The (1984); its name depends on them."""
    numbers = [np.ravel(segments), *wheel.pieces, *rail.pieces]
    content = np.concatenate([np.ravel(number) for number in numbers]).tobytes()
    name = f"wheel_on_strips_{hashlib.sha256(content).hexdigest()[:8]}"
    own = f"""
{contour_in_c(f"{name}_wheel", wheel)}
{contour_in_c(f"{name}_rail", rail)}
{array_in_c(f"{name}_segment", np.ravel(segments))}
static void {name}(const double *arguments, const double *constants, double *results, double *slopes) {{
    static const wheel_on_rail PAIR = {{{contour_entry(f"{name}_wheel", wheel)},
        {contour_entry(f"{name}_rail", rail)}, {len(segments)}, {name}_segment}};
    wheel_on_strips(&PAIR, &FITS, arguments, constants, results, slopes);
}}
"""
    angles = f"static const double HEAD_ENDS = {HEAD_ENDS!r}, GAUGE_FACE_BEGINS = {GAUGE_FACE_BEGINS!r};\n"
    common = angles + (Path(__file__).parent / "strips.c").read_text(encoding="utf-8")
    counts = (ARGUMENTS, CONSTANTS, OF_SEGMENT * len(segments) + OF_WHEEL)
    return part_in_c(name, counts, own, f"{common}\n{fits_in_c(poisson_ratio)}")


def segments_of(side: Side) -> list[tuple[float, float]]:
    """Return the ends [m] of the parts of a wheel's contour between which contact jumps, from the flange outwards.

    Section 9.4.1. There are at most MOST_SEGMENTS, which strips.c supports. Each begins at the end of the one before,
    so that strips of both leave no gap.
    """
    s = positions_of(side)
    parts = reversed(parts_of(side, most=MOST_SEGMENTS))
    limits = [(float(s[part.first]), float(s[part.last - 1])) for part in parts]
    return [(low, limits[i + 1][0] if i + 1 < len(limits) else high) for i, (low, high) in enumerate(limits)]


def array_in_c(name: str, values: Iterable[float]) -> str:
    """Return an array of numbers in C, with all digits."""
    return f"static const double {name}[] = {{{', '.join(repr(float(value)) for value in values)}}};"


def contour_in_c(name: str, profile: Profile) -> str:
    """Return the coefficients of a contour in C. Raises ValueError if its pieces are not equal."""
    breakpoints, coefficients = profile.pieces
    if not np.allclose(np.diff(breakpoints), breakpoints[1] - breakpoints[0], rtol=1e-9):
        raise ValueError(f"Profile {profile.name}: give a spline with equal distances between its knots.")
    return array_in_c(name, coefficients.ravel())


def contour_entry(name: str, profile: Profile) -> str:
    """Return a `contour_of` in C."""
    breakpoints, coefficients = profile.pieces
    width = (breakpoints[-1] - breakpoints[0]) / len(coefficients)
    return f"{{{float(breakpoints[0])!r}, {float(width)!r}, {len(coefficients)}, {name}}}"


def fits_in_c(poisson_ratio: float = POISSON_RATIO) -> str:
    """Return the `fits_of` of all wheels in C.

    They are polynomials through Hertz's ellipses (Johnson 1985), through table E.3 of Kalker (1990) over the result of
    strips for its ellipses, and through K - E.
    """
    table, kalker = ellipses(), coefficients(poisson_ratio)
    kept = np.abs(table.axis_ratio) <= LARGEST_LOGARITHM
    ratio, alpha, kappa = (row[kept] for row in (table.curvature_ratio, table.alpha, table.kappa))
    loads = kappa + 2 * table.axis_ratio[kept]
    fits = [fitted(ratio, alpha), fitted(loads, kappa)]
    # Points between the rows of Kalker's table are used too: a polynomial through the rows alone oscillates.
    row = np.arange(kalker.logarithm.size)
    grip = np.exp(np.interp(np.linspace(row[0], row[-1], 20 * row.size), row, kalker.logarithm))
    fits += [fitted(1 / grip, ratio, KALKER_ERROR, terms=10) for ratio in kalker.of(grip)]
    fits += elliptic_fit()
    limits = [(row.min(), row.max()) for row in (ratio, loads, 1 / grip)]
    rows = ["{" + ", ".join(repr(float(value)) for value in row) + "}" for row in (*fits, *limits)]
    return f"static const fits_of FITS = {{{', '.join(rows)}}};\n"


def fitted(x: np.ndarray, y: np.ndarray, error: float = FIT_ERROR, terms: int = TERMS) -> list[float]:
    """Return coefficients of a polynomial, lowest power first. Raises ValueError if its error is above `error`."""
    polynomial = np.polynomial.Polynomial.fit(x, y, terms - 1).convert()
    return checked(list(polynomial.coef), float(np.max(np.abs(polynomial(x) - y))), error)


def checked(coefficients: list[float], off: float, error: float, terms: int = TERMS) -> list[float]:
    """Return the coefficients, filled up with zeros. Raises ValueError if the error of the fit is above `error`."""
    if not off <= error:
        raise ValueError(f"A polynomial for strips.c is {off:.1e} off; the limit is {error:.1e}: give it more terms.")
    return coefficients + [0.0] * (terms - len(coefficients))


def elliptic_fit() -> list[list[float]]:
    """Return P and Q of (K - E) / m = P(m1) + Q(m1) ln(1/m1), the form of Abramowitz and Stegun (1964), 17.3.34."""
    m1 = np.concatenate([np.geomspace(LEAST_COMPLEMENT, 0.1, 400), np.linspace(0.1, 0.999, 400)])
    exact = (ellipkm1(m1) - ellipe(1 - m1)) / (1 - m1)
    powers = m1[:, None] ** np.arange(ELLIPTIC_TERMS)
    columns = np.hstack([powers, -np.log(m1)[:, None] * powers]) / exact[:, None]
    found = np.linalg.lstsq(columns, np.ones_like(m1), rcond=None)[0]
    off = float(np.max(np.abs(columns @ found - 1)))
    return [checked(list(part), off, FIT_ERROR, ELLIPTIC_TERMS) for part in np.split(found, 2)]
