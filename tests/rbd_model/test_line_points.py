"""Lines from noisy points of a known straight, clothoid and arc: curvature within the told bounds."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from rbd_model.track.line_points import LineFromPoints, line_from_points
from rbd_model.track.projection import AXIS, FLATTENING
from readers.text import BadInputError, FileError

#: Corners of the curvature [m], and radii of the arcs between the second and the third transition [m].
CORNERS, RADII = np.array([0.0, 100.0, 160.0, 360.0, 420.0, 520.0]), (300.0, -1000.0, 150.0)


def curvature(radius: float) -> np.ndarray:
    """Return the curvature at CORNERS."""
    return np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0]) / radius


def positions(radius: float, places: np.ndarray) -> np.ndarray:
    """Return x and y of the exact line by Gauss's rule over pieces of 0.5 m."""
    nodes, weights = np.polynomial.legendre.leggauss(4)
    ends = np.linspace(0.0, CORNERS[-1], 1041)
    half = (ends[1] - ends[0]) / 2.0
    fine = ends[:-1, None] + half * (1.0 + nodes)
    heading = heading_at(radius, fine)
    steps = np.stack([np.cos(heading) @ weights, np.sin(heading) @ weights], axis=1) * half
    plan = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    row = np.clip(np.searchsorted(ends, places, "right") - 1, 0, ends.size - 2)
    rest = places - ends[row]
    inner = ends[row][:, None] + rest[:, None] * (1.0 + nodes) / 2.0
    angle = heading_at(radius, inner)
    last = np.stack([np.cos(angle) @ weights, np.sin(angle) @ weights], axis=1) * rest[:, None] / 2.0
    return plan[row] + last


def heading_at(radius: float, places: np.ndarray) -> np.ndarray:
    """Return the integral of a curvature that is linear between CORNERS."""
    bend, ways = curvature(radius), np.diff(CORNERS)
    whole = np.concatenate([[0.0], np.cumsum(ways * (bend[1:] + bend[:-1]) / 2.0)])
    row = np.clip(np.searchsorted(CORNERS, places, "right") - 1, 0, ways.size - 1)
    over = places - CORNERS[row]
    return np.asarray(whole[row] + over * (bend[row] + over * np.diff(bend)[row] / ways[row] / 2.0))


def sampled(radius: float, spacing: float, noise: float, seed: int) -> np.ndarray:
    places = np.arange(0.0, CORNERS[-1] + 1e-9, spacing)
    exact = positions(radius, places)
    return exact + noise * np.random.default_rng(seed).standard_normal(exact.shape)


def shares_of_bound(line: LineFromPoints, radius: float) -> tuple[float, float]:
    """Return the largest error of the curvature over its bound, and over the curvature of the arc."""
    distance = line.rows["distance"] * CORNERS[-1] / line.rows["distance"][-1]
    places = np.linspace(0.0, CORNERS[-1], 1500)
    missed = np.interp(places, distance, line.rows["curvature"]) - np.interp(places, CORNERS, curvature(radius))
    bound = np.interp(places, distance, line.curvature_error)
    return float(np.max(np.abs(missed) / bound)), float(np.max(np.abs(missed)) * abs(radius))


@pytest.mark.study
@pytest.mark.parametrize("noise", [0.0, 0.001, 0.005, 0.02])
def test_curvature_lies_within_its_told_bounds_everywhere(noise: float) -> None:
    """Of 930 lines with these noises, spacings of 1 to 20 m and transitions of 30 and 60 m, the largest share was 0.91.

    The bounds tell something: they are less than five times the largest error on average.
    """
    shares = []
    for number, radius in enumerate(RADII):
        for spacing in (2.5, 5.0, 10.0):
            line = line_from_points(sampled(radius, spacing, noise, number))
            of_bound, of_arc = shares_of_bound(line, radius)
            assert of_bound < 1.0, (radius, spacing)
            assert line.noise < 1.3 * noise + 0.003, (radius, spacing)
            shares.append(float(np.max(line.curvature_error)) * abs(radius) / of_arc)
    assert np.mean(shares) < 5.0


@pytest.mark.parametrize("noise", [0.0001, 0.005])
def test_ends_inside_transitions_have_bounds_too(noise: float) -> None:
    """The third derivative of the spline is 0 at its ends, that of the track is not."""
    exact = positions(300.0, np.arange(130.0, 390.1, 2.5))
    for seed in range(3):
        line = line_from_points(exact + noise * np.random.default_rng(seed).standard_normal(exact.shape))
        distance = 130.0 + line.rows["distance"] * 260.0 / line.rows["distance"][-1]
        missed = line.rows["curvature"] - np.interp(distance, CORNERS, curvature(300.0))
        assert np.max(np.abs(missed) / line.curvature_error) < 1.0


def test_a_given_noise_replaces_the_estimate() -> None:
    points = sampled(300.0, 5.0, 0.005, 1)
    line = line_from_points(points, noise=0.005)
    assert line.noise == 0.005
    assert shares_of_bound(line, 300.0)[0] < 1.0
    assert "noise 5 mm (given)" in str(line.account)
    far = line_from_points(points, noise=0.001)
    assert "the noise is 1 mm as given, although the points lie" in str(far.account)
    assert np.std(np.diff(far.rows["curvature"], 2)) > np.std(np.diff(line.rows["curvature"], 2))


def test_heights_become_gradients_with_bounds() -> None:
    """A vertical curve of 5000 m from 0 to 15 per mille over 75 m, noise 2 mm."""
    places = np.arange(0.0, 520.1, 5.0)
    slope = 0.015 * np.clip((places - 200.0) / 75.0, 0.0, 1.0)
    fine = np.linspace(0.0, 520.0, 52001)
    rise = np.concatenate([[0.0], np.cumsum(np.diff(fine) * 0.015 * np.clip((fine[1:] - 200.005) / 75.0, 0.0, 1.0))])
    height = np.interp(places, fine, rise) + 0.002 * np.random.default_rng(3).standard_normal(places.size)
    line = line_from_points(np.column_stack([sampled(300.0, 5.0, 0.002, 3), height]))
    exact = np.interp(line.rows["distance"], places, slope)
    assert np.max(np.abs(line.rows["gradient"] - exact) / line.gradient_error) < 1.0
    assert np.max(line.gradient_error) < 0.0025
    assert line.account.converted[2].startswith("gradient: heights smoothed over")
    level = line_from_points(sampled(300.0, 5.0, 0.002, 3))
    assert np.all(level.rows["gradient"] == 0.0)
    assert "the gradient is 0: the points have no heights" in level.account.assumed


def test_a_closed_circle_and_a_mirrored_one_have_one_radius() -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 400)
    for sign in (1.0, -1.0):
        line = line_from_points(200.0 * np.column_stack([np.cos(angle), sign * np.sin(angle)]))
        assert line.rows["curvature"] == pytest.approx(sign / 200.0, rel=5e-4)  # the third derivative ends with 0
        assert line.rows["curvature"][20:-20] == pytest.approx(sign / 200.0, rel=1e-5)
        assert line.length == pytest.approx(400.0 * math.pi, rel=1e-6)
        assert any("a loop" in one for one in line.account.assumed)


def test_degrees_in_a_table_become_metres(tmp_path: Path) -> None:
    """A degree of a meridian about 50 degrees has 111 229.03 m (closed form: its radius of curvature)."""
    eccentric = FLATTENING * (2.0 - FLATTENING)
    fine = np.radians(np.linspace(49.9, 50.1, 20001))
    radius = AXIS * (1.0 - eccentric) / (1.0 - eccentric * np.sin(fine) ** 2) ** 1.5
    arc_length = float(np.sum((radius[1:] + radius[:-1]) / 2.0 * np.diff(fine)))
    rows = [f"2026-05-01T12:00:{i:02}Z;{50.0 + 1e-4 * i:.4f};8,0;100,0".replace(".", ",") for i in range(40)]
    path = tmp_path / "gps.csv"
    path.write_text("time;lat;lon;ele\n" + "\n".join(rows) + "\n")
    line = line_from_points(path)
    assert line.length == pytest.approx(39e-4 * arc_length / 0.2 * (1.0 + 100.0 / 6.38e6), rel=1e-6)
    assert line.account.left == ["columns time: they are not used"]
    assert any("from 50.00000, 8.00000 to 50.00390, 8.00000" in one for one in line.account.converted)
    path.write_text(path.read_text().replace("lat;lon", "x;y"))
    with pytest.raises(FileError, match="Name degrees latitude and longitude"):
        line_from_points(path)


def bad(points: np.ndarray, row: int, by: tuple[float, float]) -> np.ndarray:
    moved = points.copy()
    moved[row] += by
    return moved


LINE_POINTS = sampled(300.0, 5.0, 0.001, 0)
REFUSED = {
    "few points": (LINE_POINTS[:5], "must have 8 to 200000 different points; got 5"),
    "one column": (LINE_POINTS[:, :1], r"must be a path or numbers of shape \(points, 2\) or \(points, 3\)"),
    "not a number": (bad(LINE_POINTS, 7, (math.nan, 0.0)), "must be finite numbers up to 1e8 m; got .* in row 8"),
    "out of order": (LINE_POINTS[[0, 1, 3, 2, *range(4, 50)]], "row 3: points must follow the line; got a turn by"),
    "kilometres": (1e3 * LINE_POINTS, "points must be 0.01 to 100 m apart; got 5000 m as the median"),
    "a hairpin": (0.1 * sampled(300.0, 5.0, 0.0, 0), "radii must be at least 50 m; got 30"),
    "a wall": (np.column_stack([LINE_POINTS, np.arange(105) * 6.0]), "gradients must be at most 0.5; got 0.7"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_points_that_are_no_line_are_refused_with_one_sentence(case: str) -> None:
    points, message = REFUSED[case]
    with pytest.raises(BadInputError, match=message):
        line_from_points(points)


def test_repeated_points_and_outliers_are_told() -> None:
    line = line_from_points(np.repeat(LINE_POINTS, 2, axis=0))
    assert "105 points within 1 mm of the one before are left out, the first in row 2" in line.account.assumed
    assert line == line_from_points(LINE_POINTS)
    off = line_from_points(bad(LINE_POINTS, 50, (0.0, 0.03)))
    assert any("check it" in one and "row 51" in one for one in off.account.assumed)
    with pytest.raises(BadInputError, match="noise must be above 0 and at most 20 m; got -1"):
        line_from_points(LINE_POINTS, noise=-1)


def test_units_and_both_names_of_coordinates(tmp_path: Path) -> None:
    plain, other = tmp_path / "plain.csv", tmp_path / "other.csv"
    plain.write_text("x,y\n" + "".join(f"{x!r},{y!r}\n" for x, y in LINE_POINTS.tolist()))
    other.write_text(
        "northing [km];easting [km]\n" + "".join(f"{y / 1e3!r};{x / 1e3!r}\n" for x, y in LINE_POINTS.tolist())
    )
    one, two = line_from_points(plain), line_from_points(other)
    assert two.rows["curvature"] == pytest.approx(one.rows["curvature"], abs=1e-9)
    plain.write_text("time,x,y\n" + "".join(f"{i},{x!r},{y!r}\n" for i, (x, y) in enumerate(LINE_POINTS.tolist())))
    timed = line_from_points(plain)
    assert timed == one
    assert timed.account.left == ["columns time: they are not used"]
    plain.write_text("x,northing\n0,0\n5,0\n")
    with pytest.raises(FileError, match="must have the columns x and y, easting and northing, or latitude"):
        line_from_points(plain)
