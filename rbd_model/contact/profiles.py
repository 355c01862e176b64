"""Wheel and rail profiles: smooth quintic splines from points, or from straight lines and arcs.

`rbd_model.contact.measured` reads profiles from files.

A profile is a contour height z(y) [m]. y is positive towards the field side, the flange and the gauge corner lie at
negative y; z is positive upwards. A wheel's z is the height of its lower contour, so its radius is r0 - z(y). y = 0 is
the nominal contact point.

The splines are quintic, because contact needs the contour's curvature and the chapter 3 formulation its third
derivative (section 3.3.2). Their knots are 0.5 mm apart. All derivatives of a profile are those of its one spline. The
spline of a measured contour is smoothed by `smoothed`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, PPoly, make_lsq_spline
from scipy.linalg import solve

from rbd_model.contact.gauge_side import GaugeSide
from readers.contours import FEWEST_POINTS, LARGEST_BREADTH

DEGREE = 5
KNOT_DISTANCE = 0.5e-3
#: Cut-off wavelength of the smoothing of measured contours [m]: waves of this length lose half of their height.
#: Assumed: a few times the half breadth of a contact. It is the shortest length whose curvature is right within 2 1/m
#: in noise of 2 um. CONTACT states its penalty by a filter length in the same way (Vollebregt, `smooth_profile`).
SMOOTHING = 3e-3
#: Largest mean distance over SMOOTHING / 3 of the points from the smoothed contour [m], or times the median distance of
#: all points. The length is halved up to HALVINGS times if they are farther. They are 2.4 um where R80 joins R13.
SHARP, SHARP_OVER_NOISE, HALVINGS = 5e-6, 3.0, 3
#: Squared cosine of the steepest slope for which the penalty is exact, 85 degrees; steeper walls are not followed.
LEAST_UPRIGHT = float(np.cos(np.radians(85.0)) ** 2)
#: Distance of the points on given arcs and lines [m].
POINT_DISTANCE = 0.02e-3
#: Depth below the top of the rails at which the gauge is measured [m] (EN 13848-1).
GAUGE_DEPTH = 14e-3
#: Rails stand inclined by 1:20 (section 4.3) and the tread of the wheel is a cone of the same slope.
INCLINATION = 1 / 20


@dataclass(frozen=True, eq=False)
class Profile:
    """A contour z(y) as a quintic spline; `source` gives the origin of the points and the fitted values.

    For a contour from a file: `gauge_side` is the side of its y towards the middle of the track. `notes` are sentences
    on what was applied, found or assumed. `facts` are numbers of its header for a pair [m] (`readers.contours`).
    `points` are those of a measured contour, rows (y, z) [m].
    Profiles are equal if name, source and every number of the spline are equal.
    """

    name: str
    source: str
    spline: BSpline
    gauge_side: GaugeSide | None = None
    notes: tuple[str, ...] = ()
    facts: Mapping[str, float] = field(default_factory=dict)
    points: np.ndarray | None = field(default=None, repr=False)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Profile) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    @property
    def _content(self) -> tuple[str, str, bytes, bytes]:
        return self.name, self.source, self.spline.t.tobytes(), self.spline.c.tobytes()

    @property
    def limits(self) -> tuple[float, float]:
        """Smallest and largest y [m]."""
        return float(self.spline.t[DEGREE]), float(self.spline.t[-DEGREE - 1])

    def height(self, y: np.ndarray, derivative: int = 0) -> np.ndarray:
        """Return z or one of its derivatives by y at the positions y [m]; not a number beyond the limits."""
        return np.asarray(self.spline(y, nu=derivative, extrapolate=False))

    @property
    def pieces(self) -> tuple[np.ndarray, np.ndarray]:
        """Breakpoints and coefficients, lowest power first, as `System.table` takes them."""
        polynomial = PPoly.from_spline(self.spline)
        kept = np.diff(polynomial.x) > 0.0
        edges = np.append(polynomial.x[:-1][kept], polynomial.x[-1])
        return edges, polynomial.c[::-1, kept].T


def from_points(name: str, source: str, y: ArrayLike, z: ArrayLike, measured: bool = False) -> Profile:
    """Return the quintic spline through points (section 3.3.2), with knots every KNOT_DISTANCE.

    It is the least-squares spline, or for a measured contour `smoothed`. Points further apart than the knots are joined
    by straight lines, those of a measured contour by the smooth curve.

    Takes y, z [m] (n,).
    """
    y_array, z_array = np.asarray(y, float), np.asarray(z, float)
    if y_array.size < FEWEST_POINTS or np.any(np.diff(y_array) <= 0.0) or not np.all(np.isfinite([y_array, z_array])):
        raise ValueError(f"Profile {name}: give at least {FEWEST_POINTS} finite points whose y increases.")
    breadth = float(y_array[-1] - y_array[0])
    if not 1e3 * breadth <= LARGEST_BREADTH:
        limit = LARGEST_BREADTH / 1e3
        raise ValueError(f"Profile {name}: y must span at most {limit:g} m; got {breadth:g} m. Give metres.")
    if measured:
        return Profile(name, source, smoothed(y_array, z_array), points=np.column_stack([y_array, z_array]))
    if np.diff(y_array).max() > KNOT_DISTANCE:
        # Points further apart than the knots are joined by straight lines. The spline then smooths these.
        fine = np.arange(y_array[0], y_array[-1], KNOT_DISTANCE / 4)
        z_array, y_array = np.interp(fine, y_array, z_array), fine
    return Profile(name, source, make_lsq_spline(y_array, z_array, _knots(y_array), DEGREE))


def _knots(y: np.ndarray) -> np.ndarray:
    """Return the knots of a spline over the positions y [m], about KNOT_DISTANCE apart."""
    count = max(1, round((y[-1] - y[0]) / KNOT_DISTANCE))
    inner = np.linspace(y[0], y[-1], count + 1)
    return np.concatenate([[inner[0]] * DEGREE, inner, [inner[-1]] * DEGREE])


def smoothed(y: np.ndarray, z: np.ndarray, length: float = SMOOTHING) -> BSpline:
    """Return the quintic smoothing spline through the points of a measured contour, Eilers and Marx (1996).

    Along an even contour it minimises the integral of squared distance + (length / 2 pi)^6 (third derivative)^2. It
    passes waves of a wavelength w by 1 / (1 + (length / w)^6). On a slope, distance, derivative and length are those
    along it: the terms are weighted with the 4th and 10th power of the slope's cosine. Walls, as the sides of a rail's
    head, therefore weigh little, and the spline does not ring over the gauge corner. `docs/profiles.md` has the errors
    over the length.

    A corner that is sharper than `length` allows is real if the mean of the points leaves the spline there by more than
    SHARP. The length is halved around it.

    Takes y, z [m] (n,), length [m].
    """
    knots = _knots(y)
    edges, upright = knots[DEGREE:-DEGREE], 1 / (1 + np.gradient(z, y) ** 2)
    # The squared third derivative is a polynomial of degree 4 between knots: three points of Gauss are exact.
    place, share = np.polynomial.legendre.leggauss(3)
    half = np.diff(edges)[:, None] / 2
    at = ((edges[1:] + edges[:-1])[:, None] / 2 + half * place).ravel()
    penalty = (half * share).ravel() * np.maximum(np.interp(at, y, upright), LEAST_UPRIGHT) ** 5
    third = BSpline(knots, np.eye(knots.size - DEGREE - 1), DEGREE)(at, nu=3)
    design = BSpline.design_matrix(y, knots, DEGREE)
    weights = np.gradient(y) * upright**2
    data, target = (design.T @ design.multiply(weights[:, None])).toarray(), design.T @ (weights * z)
    lengths = np.full(at.size, length)
    for number in range(HALVINGS + 1):
        matrix = data + third.T @ ((penalty * (lengths / (2 * np.pi)) ** 6)[:, None] * third)
        scale = 1 / np.sqrt(np.diag(matrix))
        spline = BSpline(knots, scale * solve(scale[:, None] * matrix * scale, scale * target, assume_a="pos"), DEGREE)
        sharp = _sharp(y, (spline(y) - z) * np.sqrt(upright), length)
        if not sharp.size or number == HALVINGS:
            break
        near = np.searchsorted(sharp, at + length / 2) > np.searchsorted(sharp, at - length / 2)
        lengths[near] /= 2
    return spline


def _sharp(y: np.ndarray, off: np.ndarray, length: float) -> np.ndarray:
    """Return the positions [m] where the mean distance [m] over a third of the length exceeds the limit."""
    area = np.concatenate([[0.0], np.cumsum(np.diff(y) * (off[1:] + off[:-1]) / 2)])
    low, high = np.maximum(y - length / 6, y[0]), np.minimum(y + length / 6, y[-1])
    mean = (np.interp(high, y, area) - np.interp(low, y, area)) / (high - low)
    return np.asarray(y[np.abs(mean) > max(SHARP, SHARP_OVER_NOISE * float(np.median(np.abs(off))))])


#: Distances from the middle of the head [m] at which R300 meets R80 and R80 meets R13. Those of 60E1 are from the
#: contour of the Manchester contact benchmark, and equal to it within 3 um down to 5 mm below the top. The stand-in for
#: the thesis's rail has its own, to which the synthetic wheel is fitted.
JOINTS_60E1 = (10.5e-3, 25.99e-3)
JOINTS_60KG = (10.1e-3, 25.7e-3)


def rail_head(joints: tuple[float, float]) -> np.ndarray:
    """Return half a head of a 60 kg rail, three tangent arcs: rows (y, z) [m], y from 0 outwards, z = 0 at the top.

    R300 to the first of the joints, R80 to the second, R13 to the side: the arcs of 60E1 (EN 13674-1).
    """
    pieces = [np.zeros((1, 2))]
    slope_angle = 0.0
    for radius, end in ((0.300, joints[0]), (0.080, joints[1]), (0.013, None)):
        joint = pieces[-1][-1]
        centre = joint - radius * np.array([np.sin(slope_angle), np.cos(slope_angle)])
        last = centre[0] + 0.995 * radius if end is None else end  # stop before the side is vertical
        y = np.linspace(joint[0], last, int((last - joint[0]) / POINT_DISTANCE))[1:]
        pieces.append(np.column_stack([y, centre[1] + np.sqrt(radius**2 - (y - centre[0]) ** 2)]))
        slope_angle = float(np.arcsin((last - centre[0]) / radius))
    return np.concatenate(pieces)


def inclined(points: np.ndarray, inclination: float) -> np.ndarray:
    """Return a contour turned towards the track centre by `inclination` [1], top again at the origin; rows (y, z) [m].

    Rails are laid in this way (section 4.3).
    """
    angle = np.arctan(inclination)
    y = points[:, 0] * np.cos(angle) - points[:, 1] * np.sin(angle)
    z = points[:, 0] * np.sin(angle) + points[:, 1] * np.cos(angle)
    return np.column_stack([y, z])


def _rail(name: str, joints: tuple[float, float], inclination: float) -> Profile:
    half = rail_head(joints)
    whole = inclined(np.concatenate([half[:0:-1] * [-1, 1], half]), inclination)
    # Beyond the overhang of the inclined corner, the contour is not a function of y.
    whole = whole[int(np.argmin(whole[:, 0])) :]
    return from_points(name, "arcs R300, R80, R13 mm", *whole.T)


@lru_cache
def rail_60kg() -> Profile:
    """Return a 60 kg rail head inclined 1:20, for the AS 60 kg/m rail of section 4.3, whose arcs are not public."""
    return _rail("60 kg rail, 1:20", JOINTS_60KG, INCLINATION)


@lru_cache
def rail_60e1() -> Profile:
    """Return the 60E1 rail head (EN 13674-1) inclined 1:40, as in most of Europe."""
    return _rail("60E1, 1:40", JOINTS_60E1, 1 / 40)


@lru_cache
def wheel_s1002() -> Profile:
    """Return the S1002 wheel (EN 13715) from its published sections A to F, from the flange face outwards."""
    y = np.arange(-48.0, 58.0, 1e3 * POINT_DISTANCE)
    tread = np.polyval(S1002_B[::-1], y)
    sections = [
        (y > 32.15796, 1.364323640 - 0.066666667 * y),
        (y > -26.0, tread),
        (y > -35.0, -np.polyval(S1002_C[::-1], y)),
        (y > -38.426669071, 16.446 - np.sqrt(np.maximum(13.0**2 - (y + 26.210665) ** 2, 0.0))),
        (y > -39.764473993, -93.576667419 - 2.747477419 * y),
        (y > -49.662510381, 8.834924130 + np.sqrt(np.maximum(20.0**2 - (y + 58.558326413) ** 2, 0.0))),
    ]
    larger_radius = np.select([where for where, _ in sections], [values for _, values in sections])
    return from_points("S1002", "EN 13715, published sections", y / 1e3, -larger_radius / 1e3)


#: Polynomials of the sections B and C of S1002, lowest power first; millimetres, positive is a larger radius.
S1002_B = (
    0.0,
    -3.358537058e-2,
    1.565681624e-3,
    -2.810427944e-5,
    5.844240864e-8,
    -1.562379023e-8,
    5.309217349e-15,
    -5.957839843e-12,
    2.646656573e-13,
)
S1002_C = (
    4.320221063e3,
    1.038384026e3,
    1.065501873e2,
    6.051367875,
    2.054332446e-1,
    4.169739389e-3,
    4.687195829e-5,
    2.252755540e-7,
)


#: The synthetic wheel [m, rad]. Fitted: start of the transition arc to the loss of tread contact at 11.5 mm, and start
#: of the fillet to the flange contact at 9.5 mm (sections 4.3, 9.4.1). Assumed: the radii and the flange angle. A fold
#: needs a transition arc of less than the crown's 300 mm; less than 200 mm would touch the rail's shoulder early.
TRANSITION_START, TRANSITION_RADIUS = -12.34e-3, 0.200
FILLET_START, FILLET_RADIUS, FLANGE_ANGLE = -32.94e-3, 14.0e-3, np.radians(70.3)
FLANGE_LENGTH, FIELD_SIDE = 14e-3, 55e-3


@lru_cache
def wheel_cone_120() -> Profile:
    """Return a synthetic wheel: a cone 1:20 with transition arc, fillet and flange.

    It replaces LW2 of section 4.3, which is not public.
    """
    return from_points("synthetic wheel 1:20", "fitted to sections 4.3 and 9.4.1 of the thesis", *synthetic_wheel())


def synthetic_wheel(flange_angle: float = FLANGE_ANGLE) -> np.ndarray:
    """Return the contour (y row, z row) of the synthetic wheel [m]: cone, two concave arcs, flange; inwards first.

    The starts of the arcs are fitted to sections 4.3 and 9.4.1. flange_angle [rad].
    """
    angle = np.arctan(INCLINATION)
    points = [np.array([[TRANSITION_START, TRANSITION_START * INCLINATION]])]

    def add_arc(radius: float, end_angle: float) -> None:
        """Add a concave arc inwards until the contour's angle is `end_angle` [rad]."""
        nonlocal angle
        y, z = points[-1][-1]
        steps = np.linspace(angle, end_angle, max(2, int(radius * (end_angle - angle) / POINT_DISTANCE)))[1:]
        points.append(
            np.column_stack(
                [y - radius * (np.sin(steps) - np.sin(angle)), z + radius * (np.cos(steps) - np.cos(angle))]
            )
        )
        angle = end_angle

    add_arc(TRANSITION_RADIUS, np.arcsin(np.sin(angle) + (TRANSITION_START - FILLET_START) / TRANSITION_RADIUS))
    add_arc(FILLET_RADIUS, flange_angle)
    along = np.arange(POINT_DISTANCE, FLANGE_LENGTH, POINT_DISTANCE)[:, None]
    points.append(points[-1][-1] - along * np.array([np.cos(flange_angle), np.sin(flange_angle)]))
    cone = np.arange(FIELD_SIDE, TRANSITION_START + POINT_DISTANCE / 2, -POINT_DISTANCE)
    tread = np.column_stack([cone, cone * INCLINATION])
    return np.concatenate([tread, *points])[::-1].T
