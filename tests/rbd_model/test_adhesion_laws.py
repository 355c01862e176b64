"""Laws of friction as functions of numbers: values by hand, and the equations that vehicles and FMUs have."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from fmu_src.kernel import Kernel
from rbd_model.contact.friction import Surface
from rbd_model.track.adhesion_laws import curtius_kniffler, fallen_friction, recovered_friction
from rbd_model.track.friction import CONDITIONS, low
from rbd_model.track.recovery import assumed_recovery, rail_adhesion
from tests.fmu_src.quick_library import quick_library


def test_curtius_and_kniffler_by_hand() -> None:
    """0: 0.161 + 7.5 / 44; 56 km/h: 0.161 + 0.075; 106 km/h: 0.161 + 0.05."""
    assert curtius_kniffler(np.array([0.0, 56.0, 106.0]) / 3.6) == pytest.approx([0.161 + 7.5 / 44, 0.236, 0.211])


@pytest.mark.parametrize("name", CONDITIONS)
def test_the_fall_over_sliding_is_that_of_the_vehicles(name: str) -> None:
    law, sliding = CONDITIONS[name]().law, np.array([0.0, 0.7, 8.0])
    given = law.friction_ratio, law.friction_decay, 1 - law.friction_ratio, law.adhesion_reduction, law.slip_reduction
    surface = Surface(*(ca.SX(one) for one in given))
    expected = [CONDITIONS[name]().friction * float(ca.evalf(surface.remaining(ca.SX(one)))) for one in sliding]
    assert fallen_friction(CONDITIONS[name](), sliding) == pytest.approx(expected, rel=1e-12)


@pytest.mark.study
def test_the_recovery_is_that_of_the_fmu_far_behind_its_begin() -> None:
    """The leading wheelset slides at 1 m/s under 30 kN, at 10 m/s: 3 kJ/m."""
    kernel = Kernel(quick_library(rail_adhesion()), speed=10.0, creep_force_1=-30e3, slip_1=1.0)
    kernel.advance(20.0)
    assert kernel["friction_1"] == pytest.approx(float(recovered_friction(assumed_recovery(), 3e3)), rel=1e-4)


def test_a_speed_below_0_is_refused() -> None:
    with pytest.raises(ValueError, match="speed must be at least 0 m/s; got -1 m/s"):
        curtius_kniffler([3.0, -1.0])
    with pytest.raises(ValueError, match="sliding must be at least 0 m/s; got nan m/s"):
        fallen_friction(low(), float("nan"))
