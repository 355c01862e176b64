"""Creep curves against Hertz' circle, Kalker's printed coefficients and Polach's formula."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import bogie_braking as bb

#: A wheel and a rail of equal radii touch in a circle: Johnson (1985), section 4.2. Coefficients: Kalker (1990), table
#: E.3, for a = b and a Poisson's ratio of 0.25.
RADIUS, LOAD, MODULUS, FRICTION = 0.4, 60e3, 82e9, 0.3
CIRCLE = (3 * LOAD * RADIUS * (1 - 0.25) / (4 * MODULUS)) ** (1 / 3)
C11, C22, C23 = 4.12, 3.67, 1.47
PATCH = {"wheel_radius": RADIUS, "rail_head_radius": RADIUS, "normal_force": LOAD, "friction": FRICTION}
#: Error of the fitted ellipse and coefficients.
BAND = 2e-3


def test_linear_forces_are_kalkers_on_hertz_circle() -> None:
    along = bb.creep_curve("kalker-linear", 0.01, rows=11, creepage_aside=1e-3, creepage_spin=0.2, **PATCH)
    assert along["creep_force_along"] == pytest.approx(-MODULUS * CIRCLE**2 * C11 * along["creepage_along"], rel=BAND)
    aside = -MODULUS * (CIRCLE**2 * C22 * 1e-3 + CIRCLE**3 * C23 * 0.2)
    assert along["creep_force_aside"] == pytest.approx(np.full(11, aside), rel=BAND)
    spin = bb.creep_curve("kalker-linear", 0.5, over="creepage_spin", rows=11, **PATCH)
    assert spin["creep_force_aside"] == pytest.approx(-MODULUS * CIRCLE**3 * C23 * spin["creepage_spin"], rel=BAND)


def test_polachs_curve_has_his_closed_form_and_falls_with_sliding() -> None:
    fall: Any = {"friction_ratio": 0.4, "friction_decay": 0.6, "speed": 15.0}
    for more in ({}, fall):
        curve = bb.creep_curve("polach-2005", 0.1, rows=101, **PATCH, **more)
        creepage = curve["creepage_along"][1:]
        left = FRICTION * ((0.6 * np.exp(-0.6 * 15.0 * creepage) + 0.4) if more else 1.0)
        gradient = np.pi / 4 * MODULUS * CIRCLE**2 * C11 * creepage / (left * LOAD)
        expected = 2 * left / np.pi * (gradient / (1 + gradient**2) + np.arctan(gradient))
        assert curve["adhesion"][1:] == pytest.approx(expected, rel=BAND)


def test_curves_without_meaning_are_refused() -> None:
    with pytest.raises(ValueError, match="creep_law must be one of default, polach"):
        bb.creep_curve("hertz")
    with pytest.raises(KeyError, match="There is no creepage spin; there are creepage_along"):
        bb.creep_curve("polach", over="spin")
    with pytest.raises(ValueError, match="largest must be a creepage up to 10, and not 0; got 0"):
        bb.creep_curve("polach", 0.0)
    with pytest.raises(bb.SimulationError, match="normal_force"):
        bb.creep_curve("polach", normal_force=-1.0)
