"""A line from points of its centre: noisy x and y, and if known z. Curvature and gradient follow from smooth curves.

The plan is a penalised spline of x and y over the length (smoothing.py), the heights are one of their own. The error of
the curvature has two parts. The first is noise: four standard deviations. The second is bias where the curvature has a
corner, as at both ends of a transition. The smoothing averages over its reach h with the response 1 / (1 + (w h)^6) to
waves of wave number w. Where the slope of the curvature changes by J, the average is wrong by J h / 3: the integral of
w^4 h^5 / (1 + (w h)^6) over all w is 2 pi / 3. J is that of the smooth curve over five reaches, the largest near by.
At both ends of the line the third derivative of the spline is 0. If the curvature changes there by K a metre, it is
wrong by 2 K h at the end, and the error decays as exp(-x / 2 h). The deviation g obeys g = h^6 g(6) with g(3) = -K and
g(4) = g(5) = 0 at the end.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import maximum_filter1d

from rbd_model.track.line_pieces import SourcedLine, sums
from rbd_model.track.line_rows import COLUMNS
from rbd_model.track.map_tags import level_message, stated_gradient, stated_limits
from rbd_model.track.point_account import (
    OUTLIER,
    RESOLVED,
    length_of,
    tell_outliers,
    tell_plan,
    tell_resolved,
    two_digits,
)
from rbd_model.track.point_files import points_of, points_of_course
from rbd_model.track.points import SAME, Points
from rbd_model.track.smoothing import Smooth, smooth
from readers.formats.ways import Course
from readers.import_account import Account
from readers.text import BadInputError

Numbers = NDArray[np.float64]
#: Standard deviations of noise in a bound, which holds everywhere; bias over the jump of slope times reach (see above).
SIGMAS, BIAS = 4.0, 1.0 / 3.0
#: Bias at an end over slope times reach, and distance from the end in which the largest slope counts, in reaches.
AT_END, INSIDE = 2.0, 4.0
#: Distance over which a jump of slope is taken, to either side, and in which the largest counts, in reaches.
BESIDE, NEAR = 2.5, 2.0
#: Limits of the distance of knots and of rows [m]; rows in a reach.
LEAST_PITCH, NEAREST, FARTHEST, ROWS = 1.0, 1.0, 5.0, 3.0
#: Maps and receivers: least noise in bounds [m], and per squared distance of knots [1/m]. Limits of the reach in plan
#: and in height [m]. Lengths over which errors of heights may be correlated [m]. Factor on the bias. They were chosen
#: with synthetic lines of known curvature, and tested with others (tests/rbd_model/test_map_lines.py).
LEAST_NOISE, LEAST_BEND, LONGEST_REACH, LONGEST_OF_HEIGHTS, ALIKE, BIAS_FACTOR = 0.3, 2e-4, 80.0, 400.0, (0.0, 1e3), 2.0
#: Least distance of knots of heights, as a part of their reach. Largest noise [m]. Standard deviation over median.
KNOTS, LARGEST_NOISE, NORMAL = 40.0, 20.0, 1.4826
#: Most knots in a gap between points: with more the equations lose all digits.
GAP_KNOTS = 150.0
#: Times that places of points are corrected by the curve.
ROUNDS = 3


@dataclass(frozen=True, eq=False)
class LineFromPoints(SourcedLine):
    """A line from points, with bounds of its errors.

    Attributes
    ----------
    curvature_error : array, shape (rows,)
        Bound of the error of the curvature at each row [1/m].
    gradient_error : array, shape (rows,)
        Bound of the error of the gradient; infinite without heights.
    noise : float
        Standard deviation of the points across the line [m], given or estimated.
    aside : array, shape (points,)
        Distance of each point from the line, to the left [m].
    points : array, shape (points, 2)
        The points in plan [m].
    speed_limits : list of (float, float, float)
        First and last distance [m] and limit [m/s] of stretches where a map states `maxspeed`.
    """

    curvature_error: Numbers = field(default_factory=lambda: np.zeros(0), repr=False)
    gradient_error: Numbers = field(default_factory=lambda: np.zeros(0), repr=False)
    noise: float = 0.0
    aside: Numbers = field(default_factory=lambda: np.zeros(0), repr=False)
    points: Numbers = field(default_factory=lambda: np.zeros((0, 2)), repr=False)
    speed_limits: Sequence[tuple[float, float, float]] = field(default=(), repr=False)


def line_from_points(
    points: str | Path | ArrayLike, noise: float | None = None, start: float = 0.0, tracks: Sequence[str] = ()
) -> LineFromPoints:
    """Return the line through points of its centre.

    Parameters
    ----------
    points : path or array, shape (n, 2) or (n, 3)
        A table with the columns x and y, and if known z, in a unit of length; or latitude and longitude in degrees;
        or the numbers [m]. x is to the east and y to the north, so that a curve to the left is anticlockwise. Or a file
        of a map or receiver: GPX, KML, KMZ, GeoJSON, JSON of Overpass, XML of OpenStreetMap.
    noise : float, optional
        Standard deviation of a point in one direction [m]. By default it is estimated by generalised cross validation.
    start : float
        Distance at the first point [m].
    tracks : sequence of str
        Tracks of a receiver, or ways of a map in the order of the route, `-` behind one that is run backwards.

    Returns
    -------
    LineFromPoints
        The line with bounds of its errors. Its `account` has noise, smoothing and bounds.

    Raises
    ------
    BadInputError, FileError
        If the points are not a line (points that turn back, degrees, kilometres), or a curve is tighter than 50 m.
    """
    check_noise(noise)
    return _line(points_of(points, tracks), noise, start)


def line_of_course(course: Course, noise: float | None = None, start: float = 0.0) -> LineFromPoints:
    """Return the line through the points of a map or receiver, as `line_from_points` does."""
    check_noise(noise)
    return _line(points_of_course(course), noise, start)


def check_noise(noise: float | None) -> None:
    """Check a standard deviation [m]. Raises BadInputError."""
    if noise is not None and not (isinstance(noise, int | float) and 0.0 < noise <= LARGEST_NOISE):
        raise BadInputError(
            f"noise must be above 0 and at most {LARGEST_NOISE:g} m; got {noise!r}. Give the deviation of a point."
        )


def _line(given: Points, noise: float | None, start: float) -> LineFromPoints:
    given, way, plan = _followed(given, noise)
    course, length = _rows_of(plan)
    bend = _curvature(plan, course)
    reach = max(plan.reach, RESOLVED * plan.pitch, float(length[1]))
    error = SIGMAS * _cautious(plan, given, noise).deviation(course, 2) + _bias(given) * reach * _corner(
        length, bend, reach
    )
    error += _ends(length, bend, reach)
    account = given.account
    tell_plan(account, plan, noise, error)
    slope, steepness = np.zeros_like(bend), np.full_like(bend, math.inf)
    if given.height is not None:
        slope, steepness = _gradient(way, given, plan, length, account)
    else:
        slope = stated_gradient(way, given, length)
        account.assumed.append(level_message(slope, given))
    account.assumed.append("the cant is 0: points of the centre do not have it")
    along = np.sqrt(1.0 + slope**2)
    steps = np.diff(length) * (along[1:] + along[:-1]) / 2.0
    rows = {"distance": start + np.concatenate([[0.0], np.cumsum(steps)]), "curvature": bend / along}
    rows |= {"cant": np.zeros_like(bend), "gradient": slope / along}
    _check(rows, given.source)
    if given.rough:
        tell_resolved(account, rows, error, steepness)
    aside = _aside(plan, way, given)
    tell_outliers(account, given, aside, plan.noise)
    limits = stated_limits(way, given, length, rows["distance"], account)
    line = LineFromPoints(rows, account, error, steepness, plan.noise, aside, given.plan, limits)
    account.converted += sums(line)
    return line


def _cautious(fit: Smooth, given: Points, noise: float | None) -> Smooth:
    """Return a fit with the least noise that maps and receivers have, unless it is stated.

    Between sparse nodes an estimate is too small: a curve may hide there. The least noise is that of LEAST_BEND.
    """
    least = min(LEAST_BEND * fit.pitch**2, LEAST_NOISE)
    return replace(fit, noise=max(fit.noise, least)) if given.rough and noise is None else fit


def _bias(given: Points) -> float:
    return BIAS * (BIAS_FACTOR if given.rough else 1.0)


def _followed(given: Points, noise: float | None) -> tuple[Points, Numbers, Smooth]:
    """Return points, the length at each and the plan; without points of a receiver that lie far beside the line."""
    count = given.places.size
    for _ in range(ROUNDS):
        way, plan = _plan(given, noise)
        far = np.abs(_aside(plan, way, given)) > OUTLIER * max(plan.noise, LEAST_NOISE)
        if not given.recorded or not np.any(far):
            break
        worst = int(given.places[np.argmax(np.abs(_aside(plan, way, given)))])
        given = given.kept(~far)
    if left := count - given.places.size:
        given.account.assumed.append(
            f"points beyond {OUTLIER:g} times the noise beside the line are left out: {left}, point {worst} among them"
        )
        way, plan = _plan(given, noise)
    return given, way, plan


def _plan(given: Points, noise: float | None) -> tuple[Numbers, Smooth]:
    """Return the length at each point [m], and the plan over it.

    Lengths of chords depend on noise. Therefore they are replaced by those of the curve at the feet of the points.
    """
    ways = np.hypot(*np.diff(given.plan, axis=0).T)
    way = np.concatenate([[0.0], np.cumsum(ways)])
    pitch = max(float(np.percentile(ways, 20)), LEAST_PITCH, float(ways.max()) / GAP_KNOTS)
    most = LONGEST_REACH if given.rough else math.inf
    for _ in range(ROUNDS):
        plan = smooth(way, given.plan, pitch, noise, most=most)
        course, length = _rows_of(plan)
        along = plan.spline(way, 1)
        foot = way + np.sum((given.plan - plan.spline(way)) * along, axis=1) / np.sum(along**2, axis=1)
        way = np.interp(foot, course, length) + np.minimum(foot, 0.0) + np.maximum(foot - course[-1], 0.0)
        if given.recorded:  # noise along the track: the order of the points is that of time
            least = SAME * np.arange(way.size)
            way = np.maximum.accumulate(np.sort(way) - least) + least
        if not np.all(np.diff(way) > 0.0):
            row = int(given.places[1 + np.flatnonzero(np.diff(way) <= 0.0)[0]])
            raise BadInputError(
                f"{given.source}, {given.word} {row}: points must follow the line; got one behind the one before. Sort "
                "the points, or leave out some that are closer than their noise."
            )
        way -= way[0]
    return way, smooth(way, given.plan, pitch, noise, most=most)


def _rows_of(plan: Smooth) -> tuple[Numbers, Numbers]:
    """Return the variable of the spline at rows, and the length of the curve to them [m]."""
    first, last = plan.spline.t[[5, -6]]
    count = math.ceil((last - first) / min(max(plan.reach / ROWS, NEAREST), FARTHEST)) + 1
    course = np.linspace(first, last, count)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    half = (course[1] - course[0]) / 2.0
    speed = np.hypot(*plan.spline((course[:-1, None] + half * (1.0 + nodes)).ravel(), 1).T).reshape(-1, 3)
    return course, np.concatenate([[0.0], np.cumsum(half * (speed @ weights))])


def _curvature(plan: Smooth, course: Numbers) -> Numbers:
    first, second = plan.spline(course, 1), plan.spline(course, 2)
    return np.asarray((first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / np.hypot(*first.T) ** 3)


def _corner(length: Numbers, values: Numbers, reach: float) -> Numbers:
    """Return the largest change of the slope of values over 2 BESIDE reaches, within NEAR reaches."""
    slope = np.gradient(values, length)
    ahead, behind = (np.interp(length + way * reach, length, slope) for way in (BESIDE, -BESIDE))
    width = 2 * math.ceil(NEAR * reach / float(length[1])) + 1
    return np.asarray(maximum_filter1d(np.abs(ahead - behind), width))


def _ends(length: Numbers, values: Numbers, reach: float) -> Numbers:
    """Return the bias next to both ends, by the largest slope of values within INSIDE reaches from them."""
    slope = np.abs(np.gradient(values, length))
    found = np.zeros_like(length)
    for way in (length, length[-1] - length):
        found += AT_END * reach * float(slope[way <= INSIDE * reach].max()) * np.exp(-way / (2.0 * reach))
    return found


def _gradient(way: Numbers, given: Points, plan: Smooth, length: Numbers, account: Account) -> tuple[Numbers, Numbers]:
    """Return the rise per metre of the plan at the rows, and the bound of its error."""
    assert given.height is not None
    rise = given.height[:, None] - given.height[0]
    heights = _rough_heights(way, rise, plan, account) if given.rough else smooth(way, rise, plan.pitch)
    slope = heights.spline(length, 1)[:, 0]
    reach = max(heights.reach, RESOLVED * heights.pitch, float(length[1]))
    error = SIGMAS * _cautious(heights, given, None).deviation(length, 1) + _bias(given) * reach * _corner(
        length, slope, reach
    )
    account.converted.append(
        f"gradient: heights smoothed over {heights.reach:.1f} m, noise {length_of(heights.noise)}; its error is at "
        f"most {two_digits(1e3 * np.median(error))} per mille at half of the rows, {two_digits(1e3 * error.max())} "
        "everywhere"
    )
    return slope, error


def _rough_heights(way: Numbers, rise: Numbers, plan: Smooth, account: Account) -> Smooth:
    """Return the heights of a map or receiver, without outliers; correlated errors if these are likelier."""
    pitch = max(plan.pitch, LONGEST_OF_HEIGHTS / KNOTS)
    for _ in range(ROUNDS):
        choices = [smooth(way, rise, pitch, None, alike, LONGEST_OF_HEIGHTS) for alike in ALIKE]
        heights = min(choices, key=lambda one: one.misfit)
        missed = np.abs(rise - heights.spline(way))[:, 0]
        keep = missed <= OUTLIER * max(NORMAL * float(np.median(missed)), LEAST_NOISE)
        if np.all(keep):
            break
        account.assumed.append(f"heights beyond {OUTLIER:g} times their noise are left out: {np.count_nonzero(~keep)}")
        way, rise = way[keep], rise[keep]
    return heights


def _aside(plan: Smooth, way: Numbers, given: Points) -> Numbers:
    along, missed = plan.spline(way, 1), given.plan - plan.spline(way)
    return np.asarray((along[:, 0] * missed[:, 1] - along[:, 1] * missed[:, 0]) / np.hypot(*along.T))


def _check(rows: dict[str, Numbers], source: str) -> None:
    """Refuse curves and gradients that a line may not have. Raises BadInputError."""
    tightest = int(np.argmax(np.abs(rows["curvature"])))
    most = COLUMNS["curvature"].maximum
    if abs(rows["curvature"][tightest]) > most:
        raise BadInputError(
            f"{source}: radii must be at least {1 / most:g} m; got {1 / abs(rows['curvature'][tightest]):.3g} m at "
            f"{rows['distance'][tightest]:.1f} m. Check the points there, or give a larger noise."
        )
    steepest = int(np.argmax(np.abs(rows["gradient"])))
    if abs(rows["gradient"][steepest]) > COLUMNS["gradient"].maximum:
        raise BadInputError(
            f"{source}: gradients must be at most {COLUMNS['gradient'].maximum:g}; got "
            f"{rows['gradient'][steepest]:.3g} at {rows['distance'][steepest]:.1f} m. Check the heights and their unit."
        )
