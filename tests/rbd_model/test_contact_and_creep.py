"""Hertz and Polach against closed forms, SciPy's elliptic integrals and Kalker's exact theory."""

from __future__ import annotations

import csv
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from rbd_model.contact import POISSON_RATIO, ellipse_shape
from rbd_model.creep import kalker_c11, polach_force

STEEL = 82e9
#: DESIGN band for pure longitudinal creepage, in share of mu N: Polach's own distance from the exact theory.
POLACH_BAND = 0.055
ANCHOR = Path(__file__).parents[3] / "shared" / "data" / "creep_anchor.csv"


def axes(wheel_radius: float, wheel_curvature: float, rail_radius: float, load: float) -> tuple[float, float]:
    shape = ellipse_shape(*(ca.SX(x) for x in (wheel_radius, wheel_curvature, rail_radius, STEEL)))
    return float(shape.longitudinal) * load ** (1 / 3), float(shape.lateral) * load ** (1 / 3)


def scipy_axes(wheel_radius: float, wheel_curvature: float, rail_radius: float, load: float) -> tuple[float, float]:
    """Johnson (1985), section 4.2, with SciPy's elliptic integrals and a bracketing root finder."""
    along, across = 1 / (2 * wheel_radius), (1 / rail_radius + wheel_curvature) / 2
    small, large = min(along, across), max(along, across)

    def ratio(g: float) -> float:
        e2 = 1 - g**2
        return float((ellipe(e2) / g**2 - ellipk(e2)) / (ellipk(e2) - ellipe(e2)))

    g = brentq(lambda g: ratio(g) - large / small, 1e-3, 1 - 1e-9, xtol=1e-15)
    modulus = STEEL / (1 - POISSON_RATIO)
    # major x minor^2 = 3 N E(e) / (2 pi E* (A + B)), eq. (4.26) there
    minor_cubed = g * 3 * load * ellipe(1 - g**2) / (2 * np.pi * modulus * (small + large))
    minor = minor_cubed ** (1 / 3)
    major = minor / g
    return (major, minor) if along < across else (minor, major)


def test_ball_on_plane_is_a_circle_with_hertz_radius() -> None:
    radius, load = 0.425, 75e3
    a, b = axes(radius, 1 / radius, 1e12, load)
    modulus = STEEL / (1 - POISSON_RATIO)  # E/(2 (1 - nu^2)) of two equal materials
    assert a == pytest.approx((3 * load * radius / (4 * modulus)) ** (1 / 3), rel=1e-9)
    assert a == pytest.approx(b, rel=1e-9)


@pytest.mark.parametrize("geometry", [(0.425, 0.0, 0.3), (0.398, 0.0, 0.08), (0.425, -2.5, 0.3), (0.425, 5.0, 0.05)])
def test_ellipse_is_that_of_the_elliptic_integrals(geometry: tuple[float, float, float]) -> None:
    assert axes(*geometry, 75e3) == pytest.approx(scipy_axes(*geometry, 75e3), rel=1e-9)


def test_longer_axis_lies_where_the_curvature_is_smaller() -> None:
    a, b = axes(0.425, 0.0, 0.3, 75e3)
    assert a > b
    a, b = axes(0.3, 0.0, 0.425, 75e3)
    assert a < b


@pytest.mark.parametrize(
    ("ratio", "coefficient"), [(0.1, 3.31), (0.5, 3.62), (1.0, 4.12), (1 / 0.5, 5.10), (10.0, 11.7)]
)
def test_c11_is_kalkers_table(ratio: float, coefficient: float) -> None:
    assert float(kalker_c11(ca.SX(ratio))) == pytest.approx(coefficient, rel=1e-12)


def force(creepage: float, load: float = 75e3, friction: float = 0.3, a: float = 6e-3, b: float = 5e-3) -> float:
    c11 = kalker_c11(ca.SX(a / b))
    semi_axes = (ca.SX(a), ca.SX(b))
    return float(polach_force(ca.SX(creepage), ca.SX(load), ca.SX(friction), semi_axes, ca.SX(STEEL), c11))


def test_small_creepage_gives_kalkers_slope() -> None:
    slope = -STEEL * 6e-3 * 5e-3 * float(kalker_c11(ca.SX(1.2)))
    assert force(1e-8) / 1e-8 == pytest.approx(slope, rel=1e-5)


def test_force_at_unit_gradient_is_polachs() -> None:
    """Where the gradient of (3.94) is 1, eq. (3.97) gives mu Q (1/2 + pi/4) 2/pi = 0.8183 mu Q."""
    load, friction = 75e3, 0.3
    unit = friction * load / (0.25 * np.pi * STEEL * 6e-3 * 5e-3 * float(kalker_c11(ca.SX(1.2))))
    assert force(unit) / (friction * load) == pytest.approx(-(1 + np.pi / 2) / np.pi, rel=1e-9)


def test_large_creepage_gives_friction_and_the_force_is_odd() -> None:
    assert force(1.0) == pytest.approx(-0.3 * 75e3, rel=1e-3)
    assert abs(force(1.0)) < 0.3 * 75e3
    assert force(-2e-3) == -force(2e-3)


@pytest.mark.skipif(not ANCHOR.exists(), reason="the published table lies beside the development checkout only")
def test_pure_longitudinal_creepage_is_near_the_exact_theory() -> None:
    lines = [line for line in ANCHOR.read_text().splitlines() if not line.startswith("#")]
    rows = [row for row in csv.DictReader(lines) if float(row["xi_y"]) == 0 and float(row["spin_1_per_m"]) == 0]
    assert len(rows) >= 4
    for row in rows:
        a, b = float(row["a_mm"]) / 1e3, float(row["b_mm"]) / 1e3
        load, friction = float(row["N_N"]), float(row["mu"])
        ours = force(float(row["xi_x"]), load, friction, a, b)
        assert abs(ours - float(row["Fx_contact61_N"])) < POLACH_BAND * friction * load
