"""Points off a contour are found at any distance of points; corners, steps and walls of worn profiles are not."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from readers.outliers import LEAST, outliers
from readers.profiles import contour_of, read_contour
from readers.text import FileError

Points = np.ndarray
#: Data from published sources; README.md there names them.
REFERENCE = Path(__file__).parents[1] / "data" / "contact"
#: Files of instruments and programs, if available.
STRANGERS = Path(os.environ.get("PROFILES_OF_OTHERS", Path(__file__).parents[3] / "shared/data/files/profiles"))
#: Standard deviation of the noise of instruments [mm].
NOISES = (0.0, 0.002, 0.01)
DISTANCES = (0.05, 0.2, 1.0)


def sampled(contour: Points, distance: float, noise: float = 0.0, seed: int = 0) -> Points:
    """Return points at equal distances along a contour [mm], with noise to all sides."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(contour, axis=0).T))])
    places = np.arange(0.3 * distance, along[-1], distance)
    points = np.column_stack([np.interp(places, along, one) for one in contour.T])
    return points + noise * np.random.default_rng(seed).standard_normal(points.shape)


def head(radius: float) -> Points:
    """Return a crown R300, a corner of a radius and a vertical side [mm]."""
    y, angle = np.arange(-35.0, 25.0, 0.01), np.radians(np.arange(5.0, 90.0, 0.1))
    crown = np.column_stack([y, -(y**2) / 600])
    arc = crown[-1] + radius * np.column_stack([np.sin(angle) - np.sin(angle[0]), np.cos(angle) - np.cos(angle[0])])
    return np.concatenate([crown, arc, arc[-1] + np.arange(0.01, 25.0, 0.01)[:, None] * [0.0, -1.0]])


def crown(change: Callable[[Points], Points] | None = None) -> Points:
    y = np.arange(-35.0, 35.0, 0.01)
    return np.column_stack([y, -(y**2) / 600 + (change(y) if change else 0.0)])


def moved(points: Points, first: int, count: int, off: float) -> Points:
    """Return a copy with successive points moved square to the contour."""
    along = points[min(first + count, len(points) - 1)] - points[max(first - 1, 0)]
    square = np.array([-along[1], along[0]]) / np.hypot(*along)
    result = points.copy()
    result[first : first + count] += off * square
    return result


@pytest.mark.study
@pytest.mark.parametrize("off", [-1.0, 0.1, 0.5])
@pytest.mark.parametrize("count", [1, 2, 5])
def test_points_off_the_contour_are_found_on_head_corner_and_wall(count: int, off: float) -> None:
    """All, and no other point. Several points 1 mm apart that are 0.1 mm off may be the shape of a corner."""
    for distance in DISTANCES if count == 1 or abs(off) > 0.1 else DISTANCES[:-1]:
        points = sampled(head(13.0), distance, 0.002)
        for share in (0.5, 0.65, 0.9):
            first = int(share * len(points))
            found = outliers(moved(points, first, count, off))
            assert [index for index, _ in found] == list(range(first, first + count)), (distance, share)
            # Points of the corner R13 that are 1 mm apart: the cubic over 17 mm of the arc is up to 0.09 mm off.
            assert [size for _, size in found] == pytest.approx([abs(off)] * count, abs=0.1), (distance, share)


@pytest.mark.parametrize("first", [2, 3, 4])
def test_outliers_near_the_ends_are_found(first: int) -> None:
    for points in (sampled(crown(), 0.2), sampled(head(13.0), 0.2)):
        for at in (first, len(points) - 1 - first):
            assert [index for index, _ in outliers(moved(points, at, 1, 0.3))] == [at]


@pytest.mark.parametrize("apart", [2, 3, 6, 9])
def test_neighbouring_outliers_do_not_hide_each_other(apart: int) -> None:
    points = sampled(crown(), 0.2, 0.002)
    for size in (0.2, -0.5):
        both = moved(moved(points, 100, 1, 0.5), 100 + apart, 1, size)
        assert [index for index, _ in outliers(both)] == [100, 100 + apart]


def test_outliers_on_a_noisy_contour_are_those_beyond_its_noise() -> None:
    """Ten standard deviations are found: 0.1 mm in noise of 0.01 mm; in noise of 0.05 mm they are not."""
    for seed in range(10):
        for noise, expected in ((0.01, [150]), (0.05, [])):
            points = moved(sampled(crown(), 0.2, noise, seed), 150, 1, 0.12)
            assert [index for index, _ in outliers(points)] == expected, (seed, noise)


FEATURES = {
    "R13 corner": head(13.0),
    "R1 corner": head(1.0),
    "edge of 20 degrees": crown(lambda y: -np.tan(0.35) * np.maximum(y - 5.0, 0.0)),
    "edge of 70 degrees": crown(lambda y: -np.tan(1.22) * np.maximum(y - 5.0, 0.0)),
    "chamfer at the end": crown(lambda y: -np.maximum(y - 34.0, 0.0)),
    "step": crown(lambda y: -0.3 * (y > 5.0)),
    "sloping step": crown(lambda y: -1.0 * np.clip((y - 5.0) / 1.5, 0.0, 1.0)),
    "hollow": crown(lambda y: -0.3 * np.clip(1 - np.abs(y / 12.0), 0.0, 1.0)),
    "lip": crown(lambda y: 0.5 * np.exp(-(((y - 20.0) / 2.0) ** 2))),
}


@pytest.mark.study
@pytest.mark.parametrize("feature", FEATURES)
def test_corners_steps_and_lips_of_worn_profiles_are_no_outliers(feature: str) -> None:
    for distance in DISTANCES:
        for seed, noise in enumerate(NOISES):
            assert outliers(sampled(FEATURES[feature], distance, noise, seed)) == [], (distance, noise)


def test_repeated_points_are_no_outliers_and_hide_none() -> None:
    points = np.repeat(sampled(crown(), 0.5), 2, axis=0)
    assert outliers(points) == []
    assert [index for index, _ in outliers(np.insert(points, 100, points[100] + [0.1, 0.5], axis=0))] == [100]


@pytest.mark.study
@pytest.mark.parametrize("name", ["RUIC519A", "RUIC519H", "SUIC519A"])
def test_an_outlier_of_twice_the_digits_of_files_is_found_on_the_tread_of_reference_profiles(name: str) -> None:
    """These have no noise. On wheel A single points that are 0.02 mm off change the conicity by up to 11 %."""
    points = np.loadtxt(REFERENCE / f"en15302_{name}.csv", delimiter=",", skiprows=1)
    assert outliers(points) == []
    for at in np.flatnonzero(np.abs(points[:, 0]) < 25.0)[::23]:
        for off in (-0.5, 1.5 * LEAST):
            assert [index for index, _ in outliers(moved(points, int(at), 1, off))] == [at]


def test_refusal_states_place_distance_and_remedy() -> None:
    points = moved(sampled(crown(), 0.5), 60, 1, -0.5)
    text = "\n".join(f"{y:.6f} {z:.6f}" for y, z in points)
    with pytest.raises(FileError) as told:
        contour_of(text, "mine.csv", "rail")
    assert str(told.value) == (
        f"mine.csv, row 61: points must lie on the contour of their neighbours; y = {points[60, 0]:.6g} mm, z = "
        f"{points[60, 1]:.6g} mm lies 0.5 mm off it. Correct or remove them, or drop outliers (--drop-outliers)."
    )
    found = contour_of(text, "mine.csv", "rail", drop_outliers=True)
    assert 1e3 * found.points == pytest.approx(np.delete(points, 60, axis=0), abs=1e-6)
    assert "outliers were dropped, up to 0.5 mm off at y = " in found.notes[0]


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="no files of instruments at PROFILES_OF_OTHERS")
def test_files_of_instruments_have_no_outliers_until_one_is_made() -> None:
    for path in sorted(STRANGERS.iterdir()):
        kind = "wheel" if "S1002" in path.name or path.suffix == ".whl" else "rail"
        points = 1e3 * read_contour(path, kind).points
        for at in (2 * len(points) // 5, len(points) // 2):
            assert at in [index for index, _ in outliers(moved(points, at, 1, 0.2))], path.name
