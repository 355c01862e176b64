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
from rbd_model.track.point_files import SAME, Points, points_of, points_of_course
from rbd_model.track.smoothing import Smooth, smooth
from readers.formats.line_tracks import LISTED
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
#: Share of the distance of knots that a reach has at least in a bound: knots do not resolve more.
RESOLVED = 0.7
#: Limits of the distance of knots and of rows [m]; rows in a reach.
LEAST_PITCH, NEAREST, FARTHEST, ROWS = 1.0, 1.0, 5.0, 3.0
#: Error of the noise's share that a map or receiver has at least [m]; limits of the reach there, in plan and height,
#: lengths over which heights may be correlated [m], and factor on the bias. They are chosen with synthetic lines whose
#: curvature is known (tests/rbd_model/test_maps.py).
LEAST_NOISE, LONGEST_REACH, LONGEST_OF_HEIGHTS, ALIKE, BIAS_FACTOR = 0.3, 80.0, 400.0, (0.0, 1000.0), 2.0
#: Least distance of knots of heights, as a part of their reach. Gradient that is rarely exceeded. Largest noise [m].
KNOTS, STEEP, LARGEST_NOISE = 40.0, 0.07, 20.0
#: Length from which texts have metres instead of millimetres [m].
CENTIMETRES = 0.0995
#: Most knots in a gap between points: with more the equations lose all digits.
GAP_KNOTS = 150.0
#: Times that places of points are corrected by the curve.
ROUNDS = 3
#: Times the noise from which a point is named as an outlier. Ratio of residuals to a given noise that is told.
OUTLIER, MISMATCH = 5.0, 2.0


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
    _tell_plan(account, plan, noise, error)
    slope, steepness = np.zeros_like(bend), np.full_like(bend, math.inf)
    if given.height is not None:
        slope, steepness = _gradient(way, given, plan, length, account)
    else:
        slope = _stated(way, given, length)
        account.assumed.append(_level(slope, given))
    account.assumed.append("the cant is 0: points of the centre do not have it")
    along = np.sqrt(1.0 + slope**2)
    steps = np.diff(length) * (along[1:] + along[:-1]) / 2.0
    rows = {"distance": start + np.concatenate([[0.0], np.cumsum(steps)]), "curvature": bend / along}
    rows |= {"cant": np.zeros_like(bend), "gradient": slope / along}
    _check(rows, given.source)
    if given.rough:
        _tell_resolved(account, rows, error, steepness)
    aside = _aside(plan, way, given)
    _tell_outliers(account, given, aside, plan.noise)
    limits = _limits(way, given, length, rows["distance"], account)
    line = LineFromPoints(rows, account, error, steepness, plan.noise, aside, given.plan, limits)
    account.converted += sums(line)
    return line


def _cautious(fit: Smooth, given: Points, noise: float | None) -> Smooth:
    """Return a fit with the least noise that maps and receivers have, unless it is stated."""
    return replace(fit, noise=max(fit.noise, LEAST_NOISE)) if given.rough and noise is None else fit


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


def _at(way: Numbers, given: Points, place: int) -> float:
    """Return the length at a point of the file [m]."""
    return float(np.interp(place, given.places, way))


def _stated(way: Numbers, given: Points, length: Numbers) -> Numbers:
    """Return the gradient that a map states, 0 where it states none."""
    slope = np.zeros_like(length)
    for first, last, gradient, _ in given.stretches:
        if gradient is not None:
            slope[(length >= _at(way, given, first)) & (length <= _at(way, given, last))] = gradient
    return slope


def _level(slope: Numbers, given: Points) -> str:
    """Return the sentence on a line without heights."""
    if not any(gradient is not None for *_, gradient, _ in given.stretches):
        return "the gradient is 0: the points have no heights"
    share = 100.0 * float(np.mean(slope != 0.0))
    return f"the gradient is that of the tags incline, on {share:.3g} % of the line, and 0 elsewhere: no heights"


def _limits(
    way: Numbers, given: Points, length: Numbers, distance: Numbers, account: Account
) -> list[tuple[float, float, float]]:
    """Return stretches [m] with the limit of speed that a map states [m/s], equal ones joined."""
    found: list[tuple[float, float, float]] = []
    for first, last, _, speed in given.stretches:
        if speed is not None:
            begin, end = (float(np.interp(_at(way, given, one), length, distance)) for one in (first, last))
            if found and found[-1][2] == speed and begin - found[-1][1] < FARTHEST:
                begin = found.pop()[0]
            found.append((begin, end, speed))
    if found:
        told = ", ".join(f"{3.6 * one:.4g} km/h from {begin:.0f} to {end:.0f} m" for begin, end, one in found[:LISTED])
        more = f" and {len(found) - LISTED} more" if len(found) > LISTED else ""
        account.taken.append(f"maxspeed, as speed_limits of the line: {told}{more}")
    return found


def _tell_resolved(account: Account, rows: dict[str, Numbers], error: Numbers, steepness: Numbers) -> None:
    """Add what noisy points do not resolve, and gradients that hint at another unit."""
    account.assumed.append(
        f"radii above {1.0 / np.median(error):.0f} m are within the error at half of the rows, "
        f"{1.0 / error.max():.0f} m everywhere: such curves may be straight"
    )
    bound, steepest = float(np.median(steepness)), float(np.max(np.abs(rows["gradient"])))
    if math.isfinite(bound) and bound > steepest / 2.0:
        account.assumed.append(
            f"the gradient is not resolved: its error is up to {1e3 * bound:.2g} per mille at half of the rows, and "
            f"the steepest gradient {1e3 * steepest:.2g} per mille"
        )
    if np.any(np.abs(rows["gradient"]) - steepness > STEEP) and math.isfinite(bound):
        account.assumed.append(f"gradients reach {1e3 * steepest:.3g} per mille: check that heights are in metres")


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
    if given.rough:
        pitch = max(plan.pitch, LONGEST_OF_HEIGHTS / KNOTS)
        choices = [smooth(way, rise, pitch, None, alike, LONGEST_OF_HEIGHTS) for alike in ALIKE]
        heights = min(choices, key=lambda one: one.misfit)
    else:
        heights = smooth(way, rise, plan.pitch)
    slope = heights.spline(length, 1)[:, 0]
    reach = max(heights.reach, RESOLVED * heights.pitch, float(length[1]))
    error = SIGMAS * _cautious(heights, given, None).deviation(length, 1) + _bias(given) * reach * _corner(
        length, slope, reach
    )
    account.converted.append(
        f"gradient: heights smoothed over {heights.reach:.1f} m, noise {length_of(heights.noise)}; its error is at "
        f"most {1e3 * np.median(error):.2g} per mille at half of the rows, {1e3 * error.max():.2g} everywhere"
    )
    return slope, error


def _aside(plan: Smooth, way: Numbers, given: Points) -> Numbers:
    along, missed = plan.spline(way, 1), given.plan - plan.spline(way)
    return np.asarray((along[:, 0] * missed[:, 1] - along[:, 1] * missed[:, 0]) / np.hypot(*along.T))


def _tell_plan(account: Account, plan: Smooth, noise: float | None, error: Numbers) -> None:
    origin = "estimated by generalised cross validation" if noise is None else "given"
    account.converted.append(
        f"curvature: x and y smoothed over {plan.reach:.1f} m by a penalised spline, noise {length_of(plan.noise)} "
        f"({origin}); features shorter than {4.0 * max(plan.reach, RESOLVED * plan.pitch):.0f} m are blurred"
    )
    account.converted.append(
        f"error of the curvature: at most {np.median(error):.2g} 1/m at half of the rows, {error.max():.2g} 1/m "
        "everywhere, unless curvature jumps without a transition, or changes that near to an end alone"
    )
    if noise is not None and not 1.0 / MISMATCH <= plan.residual / noise <= MISMATCH:
        account.assumed.append(
            f"the noise is {length_of(noise)} as given, although the points lie {length_of(plan.residual)} beside "
            "the line"
        )


def length_of(size: float) -> str:
    """Return a small length [m] with its unit."""
    return f"{1e3 * size:.2g} mm" if size < CENTIMETRES else f"{size:.2g} m"


def _tell_outliers(account: Account, given: Points, aside: Numbers, noise: float) -> None:
    far = np.flatnonzero(np.abs(aside) > OUTLIER * max(noise, 1e-4))
    if far.size:
        worst = int(np.argmax(np.abs(aside)))
        account.assumed.append(
            f"{far.size} points lie beyond {OUTLIER:g} times the noise beside the line and are used, the farthest in "
            f"{given.word} {given.places[worst]}, {abs(aside[worst]):.3g} m: check it"
        )


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
