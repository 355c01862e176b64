"""Test the gauge side of a contour: detected, reported, or requested."""

from __future__ import annotations

import itertools
import os
from pathlib import Path

import numpy as np
import pytest

from rbd_model.contact.geometry import Pair, equivalent_conicity
from rbd_model.contact.measured import read_profile
from rbd_model.contact.profiles import JOINTS_60E1, Profile, inclined, rail_head

REFERENCE = Path(__file__).parents[1] / "data" / "contact"
#: Files of instruments, if available; rail_left_iter288 is worn at positive y.
STRANGERS = Path(os.environ.get("PROFILES_OF_OTHERS", "nowhere"))
#: Amplitude at which EN 15302 compares conicities [m], and tolerance of two spline fits to the same points.
COMPARED, FITTED = np.array([3e-3]), 1e-3
WAYS = list(itertools.product((1, -1), (1, -1), (1, -1)))


def points_of(name: str) -> np.ndarray:
    return np.loadtxt(REFERENCE / f"en15302_{name}.csv", delimiter=",", skiprows=1)


def written(points: np.ndarray, folder: Path, way: tuple[int, int, int] = (1, 1, 1)) -> Path:
    """Write a file of points [mm] with y, z and the order unchanged (1) or reversed (-1); return its path."""
    path = folder / "mine.csv"
    np.savetxt(path, (points * way[:2])[:: way[2]], delimiter=";", fmt="%.7f")
    return path


def head(inclination: float) -> np.ndarray:
    """Return a head of 60E1 with its sides [mm], inclined towards negative y."""
    half = 1e3 * rail_head(JOINTS_60E1)
    half = np.concatenate([half, half[-1] + [[0.001 * n, -0.3 * n] for n in range(1, 50)]])
    return inclined(np.concatenate([half[:0:-1] * [-1, 1], half]), inclination)


def worn(points: np.ndarray) -> np.ndarray:
    """Return the head with 1 mm worn off its crown (cone 1:20) and its corner at negative y (plane at 45 deg)."""
    y, z = points.T
    return np.column_stack([y, np.minimum(z, z.max() + np.minimum(0.05 * y - 1.0, y - y.min() - 14.0))])


def scattered(points: np.ndarray) -> np.ndarray:
    """Return two contours in the order of y, one 1 mm above the other."""
    return points + np.c_[np.zeros(len(points)), np.arange(len(points)) % 2]


def conicity(rail: Profile, wheel: Profile) -> float:
    pair = Pair(wheel, rail, 0.46, 0.75, 0.75)
    return float(equivalent_conicity(pair, COMPARED, rolls=False)[0])


@pytest.mark.study
def test_a_rail_and_a_wheel_from_either_side_have_the_same_conicity(tmp_path: Path) -> None:
    """Upside down, from the other side and backwards: the standard's 0.188 at 3 mm less 0.002 of smoothing."""
    found = []
    for way in WAYS:
        rail = read_profile(written(points_of("SUIC519A"), tmp_path, way), "rail")
        wheel = read_profile(written(points_of("RUIC519A"), tmp_path, way), "wheel")
        side = "y-" if way[0] == 1 else "y+"
        assert str(rail.gauge_side) == f"{side} (it leans 1:20 to there)"
        assert str(wheel.gauge_side) == f"{side} (its flange lies there)"
        found.append((rail.limits, wheel.limits))
        if way in (WAYS[0], WAYS[4]):
            assert conicity(rail, wheel) == pytest.approx(0.186, abs=1e-3)
    assert np.ptp(np.array(found), axis=0) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.study
@pytest.mark.parametrize("mirror", [1, -1])
@pytest.mark.parametrize(
    ("points", "reason", "lean"),
    [
        (head(1 / 40), "leans 1:", 1 / 40),
        (head(1 / 20), "leans 1:", 1 / 20),
        (worn(head(1 / 40)), "corner is worn", None),
        (worn(head(0.0)), "corner is worn", None),
    ],
    ids=["1:40", "1:20", "worn 1:40", "worn upright"],
)
def test_the_gauge_side_is_where_a_rail_leans_or_is_worn(
    points: np.ndarray, reason: str, lean: float | None, mirror: int, tmp_path: Path
) -> None:
    noise = np.random.default_rng(1).normal(0.0, 2e-3, points.shape)
    found = read_profile(written(points + noise, tmp_path, (mirror, 1, 1)), "rail").gauge_side
    assert found is not None
    assert found.side == ("y-" if mirror == 1 else "y+")
    assert reason in found.reason
    assert found.lean == (None if lean is None else pytest.approx(lean, rel=0.02))


@pytest.mark.study
def test_an_upright_head_without_wear_has_no_side_and_is_laid_inwards(tmp_path: Path) -> None:
    rails = [read_profile(written(head(0.0), tmp_path, (way, 1, 1)), "rail", 1 / 40) for way in (1, -1)]
    assert {str(rail.gauge_side) for rail in rails} == {"none (symmetric and upright)"}
    laid = read_profile(written(head(1 / 40), tmp_path), "rail")
    y = np.linspace(-0.03, 0.03, 50)
    for rail in rails:
        assert rail.height(y) == pytest.approx(laid.height(y), abs=2e-6)


@pytest.mark.study
def test_a_side_that_is_given_counts(tmp_path: Path) -> None:
    path = written(worn(head(0.0)), tmp_path, (-1, 1, 1))
    given, found = read_profile(path, "rail", side="y+"), read_profile(path, "rail")
    assert str(given.gauge_side) == "y+ (given)"
    assert given == found  # the same contour
    assert read_profile(path, "rail", side="y-") != found


@pytest.mark.study
@pytest.mark.parametrize(
    ("points", "kind", "more", "sentence"),
    [
        (head(1 / 40), "rail", {"side": "y+"}, r"at y\+ it leans 1:40 outwards. Give the side y-, or the rail"),
        (head(1 / 20), "rail", {"side": "y+", "inclination": 1 / 40}, "it leans 1:40 outwards"),
        (head(1 / 40), "rail", {"inclination": 1 / 40}, "leans 1:40 towards y- there. Leave the inclination out"),
        (head(0.0)[30:], "rail", {}, r"must be known; its head is neither .* Give y- or y\+ as"),
        (points_of("RUIC519A")[400:], "wheel", {}, "must be known; it has no flange. Give y-"),
        (points_of("RUIC519A"), "wheel", {"side": "y+"}, r"must be that of the flange, y-; got y\+. Leave it out"),
        (head(0.0), "rail", {"side": "left"}, "side y- or y\\+; got 'rail' and 'left'"),
        (scattered(head(0.0)), "rail", {"side": "y-"}, "must lie within 0.1 mm of one smooth contour; half"),
    ],
)  # fmt: skip
def test_a_side_in_doubt_is_questioned(
    points: np.ndarray, kind: str, more: dict, sentence: str, tmp_path: Path
) -> None:
    if "neither" in sentence:  # one corner is missing, less than by wear
        points = points[points[:, 0] > -30.0]
    with pytest.raises(ValueError, match=sentence) as told:
        read_profile(written(points, tmp_path), kind, **more)
    assert "\n" not in str(told.value)


@pytest.mark.skipif(not STRANGERS.is_dir(), reason="PROFILES_OF_OTHERS names no folder of their files")
@pytest.mark.parametrize(
    ("name", "kind", "side"),
    [
        ("MBench_UIC60_v3.prr", "rail", "y- (it leans 1:40 to there)"),
        ("MBench_UIC60_v3.ban", "rail", "y+ (it leans 1:40 to there)"),
        ("uic60_true.prr", "rail", "none (symmetric and upright)"),
        ("rail_left_iter288.ban", "rail", "y+ (its corner is worn there)"),
        ("Car7216_0001r.whl", "wheel", "y- (its flange lies there)"),
    ],
)
def test_sides_of_instruments_files(name: str, kind: str, side: str) -> None:
    assert str(read_profile(STRANGERS / name, kind).gauge_side) == side
