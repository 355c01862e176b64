"""Smoothing of measured contours: closed forms of waves, noise, arcs and corners; the conicity of EN 15302."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_lsq_spline
from scipy.special import beta

from bogie_braking.profiles.smoothing_picture import curvature, distance_of_points, draw_smoothing
from rbd_model.contact.geometry import Pair, equivalent_conicity
from rbd_model.contact.profiles import (
    DEGREE,
    JOINTS_60E1,
    SHARP,
    SMOOTHING,
    Profile,
    _knots,
    from_points,
    rail_head,
    smoothed,
)

#: Data from published sources; README.md there names them.
REFERENCE = Path(__file__).parents[1] / "data" / "contact"
#: Overshoot of a step that is filtered with 1 / (1 + (L / w)^6), from its impulse response.
OVERSHOOT = 0.056
#: Error of an amplitude: knots 0.5 mm apart and the discrete points.
AMPLITUDE = 0.03


@pytest.mark.parametrize("degrees", [0.0, 45.0])
@pytest.mark.parametrize("wavelength", [2e-3, 3e-3, 5e-3])
def test_wave_on_a_contour_loses_the_share_that_its_length_along_the_contour_states(
    wavelength: float, degrees: float
) -> None:
    """At the cut-off wavelength a half is left, on a level contour as on a slope."""
    along, height, angle = np.arange(-20e-3, 20e-3, 0.05e-3), 3e-6, math.radians(degrees)
    wave = height * np.cos(2 * np.pi * along / wavelength)
    y = along * math.cos(angle) - wave * math.sin(angle)
    z = along * math.sin(angle) + wave * math.cos(angle)
    spline = smoothed(y, z)
    inside = np.abs(along) < 10e-3
    left = (spline(y) - y * math.tan(angle))[inside] * math.cos(angle)
    share = 2 * np.mean(left * np.cos(2 * np.pi * along[inside] / wavelength)) / height
    assert share == pytest.approx(1 / (1 + (SMOOTHING / wavelength) ** 6), abs=AMPLITUDE)


@pytest.mark.parametrize("distance", [0.1e-3, 0.2e-3])
def test_noise_leaves_the_curvature_that_its_spectrum_states(distance: float) -> None:
    """White noise of density sigma^2 h, times w^4 / (1 + (w / c)^6)^2: c^5 sigma^2 h B(5/6, 7/6) / (6 pi)."""
    sigma, cut_off = 2e-6, 2 * np.pi / SMOOTHING
    expected = sigma * math.sqrt(distance * cut_off**5 * beta(5 / 6, 7 / 6) / (6 * np.pi))
    y = np.arange(-0.2, 0.2, distance)
    bend = smoothed(y, sigma * np.random.default_rng(1).standard_normal(y.size))(np.linspace(-0.19, 0.19, 20000), nu=2)
    # Waves of the noise shorter than the cut-off are independent every 3 mm: 127 of them give 9 %.
    assert np.std(bend) == pytest.approx(expected, rel=0.2)
    assert np.std(bend) < 2.0


def head(distance: float, noise: float) -> Profile:
    """Return a head of the arcs R300, R80 and R13, from points at a distance [m]."""
    half = rail_head(JOINTS_60E1)
    fine = np.concatenate([half[:0:-1] * [-1, 1], half])
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(fine, axis=0).T))])
    places = np.arange(0.0, along[-1], distance)
    points = np.column_stack([np.interp(places, along, one) for one in fine.T])
    points[:, 1] += noise * np.random.default_rng(3).standard_normal(places.size)
    return from_points("head", "R300, R80, R13", *points.T, measured=True)


@pytest.mark.parametrize("distance", [0.05e-3, 0.2e-3, 0.5e-3, 1e-3])
def test_curvature_beside_joints_of_arcs_is_within_that_of_the_arcs(distance: float) -> None:
    """Up to the overshoot of the filter; with a third of the length the curvature at the joint of R13 is outside."""
    one = head(distance, 0.0)
    y = np.linspace(-36e-3, 36e-3, 5000)
    kept = np.abs(one.height(y, 1)) < math.tan(math.radians(60.0))
    most = 1 / 0.013 + (OVERSHOOT + 0.01) * (1 / 0.013 - 1 / 0.080)
    bend = -curvature(one, y)[kept]
    assert bend.max() < most
    assert bend.min() > 1 / 0.300 - (OVERSHOOT + 0.01) * (1 / 0.080 - 1 / 0.300)
    if distance < SMOOTHING / 10 and one.points is not None:
        shorter = replace(one, spline=smoothed(*one.points.T, length=SMOOTHING / 3))
        assert np.max(-curvature(shorter, y)[kept]) > most


@pytest.mark.parametrize("distance", [0.1e-3, 0.2e-3])
def test_noise_of_two_micrometres_leaves_curvature_of_arcs_and_heights(distance: float) -> None:
    exact, noisy = head(distance, 0.0), head(distance, 2e-6)
    y = np.concatenate([np.linspace(-8e-3, 8e-3), np.linspace(13e-3, 23e-3)])
    radius = np.where(y < 9e-3, 0.300, 0.080)
    assert curvature(noisy, y) == pytest.approx(-1 / radius, abs=5.0)
    assert np.std(curvature(noisy, y) + 1 / radius) < 2.0
    assert np.abs(distance_of_points(exact)[1]).max() < 3e-6
    assert np.abs(noisy.height(y) - exact.height(y)).max() < 2e-6


def test_corner_is_followed_closer_than_the_length_allows() -> None:
    """An edge of 10 degrees, slope s: the filter alone would round it by s L / 6 pi, 28 um."""
    y = np.arange(-30e-3, 30e-3, 0.1e-3)
    z = -np.tan(np.radians(10.0)) * np.maximum(y - 5e-3, 0.0)
    spline = smoothed(y, z)
    assert np.abs(spline(y) - z).max() < 3 * SHARP
    far = np.abs(y - 5e-3) > 2 * SMOOTHING
    assert np.abs(spline(y[far], nu=2)).max() < 1.0


def test_points_of_formulas_have_the_spline_of_least_squares() -> None:
    y = np.linspace(-30e-3, 30e-3, 1200)
    one = from_points("arc", "R300", y, -(y**2) / 0.6)
    assert np.array_equal(one.spline.c, make_lsq_spline(y, -(y**2) / 0.6, _knots(y), DEGREE).c)
    with pytest.raises(ValueError, match="arc has no points"):
        draw_smoothing([one])


@pytest.mark.study
@pytest.mark.parametrize(("wheel", "case"), [("A", "E1"), ("B", "E2"), ("H", "E3"), ("I", "E4")])
def test_conicity_of_smoothed_reference_profiles_is_that_of_en_15302(wheel: str, case: str) -> None:
    wheel_points, rail_points = (
        np.loadtxt(REFERENCE / f"en15302_{name}.csv", delimiter=",", skiprows=1) / 1e3
        for name in (f"RUIC519{wheel}", "SUIC519A")
    )
    pair = Pair(
        from_points(wheel, "EN 15302", *wheel_points.T, measured=True),
        from_points("rail", "EN 15302", *rail_points.T, measured=True),
        *(0.46, 0.75, 0.75),
    )
    lines = (REFERENCE / "en15302_conicity.csv").read_text().splitlines()
    rows = np.array([[float(cell) for cell in line.split(",")[1:]] for line in lines if line.startswith(case)])
    amplitude, value, upper, lower = rows.T
    found = equivalent_conicity(pair, amplitude / 1e3, rolls=False)
    assert np.all((found <= upper) & (found >= lower))
    assert np.median(np.abs(found - value)) < 0.005
