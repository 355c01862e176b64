"""Explicit steps become unstable at the predicted limit, and the guards report it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bogie_braking.machines import model_from, vehicle
from evidence.measuring.drift import drift
from evidence.measuring.fold import approach
from evidence.measuring.stability import (
    MACHINES,
    PATCHES,
    PLANAR,
    RODAS5P,
    RUNGE_KUTTA,
    SETTLING,
    SPATIAL,
    DrivenVehicle,
    amplification_of_rk4,
    boundary,
    growth_of_perturbation,
    largest_stable_step,
    limit,
)
from fmu_src.kernel import Kernel
from rbd_model.levels.models import places_of
from tests.fmu_src.quick_library import quick_library

SPEEDS = (0.01, 0.1, 1.0, 10.0, 25.0, 60.0)
#: The stability function is exact for linear equations. Creep deviates by the square of the perturbation.
GROWTH_BAND = 0.03
#: Hairer and Wanner 1996, section IV.2: ends of RK4's region on the negative real axis and on the imaginary axis.
NEGATIVE_AXIS, IMAGINARY_AXIS = 2.7852935634, 2.0**1.5


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.name)
@pytest.mark.parametrize("speed", SPEEDS)
def test_explicit_steps_are_stable_below_the_predicted_limit_and_unstable_above(
    machine: DrivenVehicle, speed: float
) -> None:
    step = limit(machine, speed)
    for share in (0.9, 1.1):
        grown = growth_of_perturbation(machine, speed, share * step, RUNGE_KUTTA)
        assert grown.stable == (share < 1.0)
        predicted = abs(amplification_of_rk4(-share * NEGATIVE_AXIS))
        assert grown.factor == pytest.approx(predicted, rel=GROWTH_BAND)
        warned = [line for line in grown.messages if "above its stability limit" in line]
        assert bool(warned) == (share > 1.0)


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: machine.name)
@pytest.mark.parametrize("speed", SPEEDS)
def test_default_method_is_stable_far_above_that_limit(machine: DrivenVehicle, speed: float) -> None:
    for multiple in (1.1, 10.0, 100.0):
        assert growth_of_perturbation(machine, speed, multiple * limit(machine, speed), RODAS5P).factor < 0.9


def test_limit_is_that_of_the_stability_region_on_both_axes() -> None:
    assert largest_stable_step(np.array([-10.0])) == pytest.approx(NEGATIVE_AXIS / 10.0, rel=1e-8)
    weakly_damped = np.array([-1.0 + 1000.0j, -1.0 - 1000.0j])
    assert largest_stable_step(weakly_damped) == pytest.approx(IMAGINARY_AXIS / 1000.0, rel=0.02)


@pytest.mark.parametrize("machine", [SPATIAL, PLANAR, PATCHES], ids=lambda machine: machine.name)
def test_boundary_found_by_bisection_is_the_predicted_one(machine: DrivenVehicle) -> None:
    for friction in (0.1, 0.3):
        inputs = (("friction_1", friction), ("friction_2", friction))
        found = boundary(machine, 25.0, RUNGE_KUTTA, inputs)
        assert found == pytest.approx(limit(machine, 25.0, "RK4", inputs), rel=0.005)  # bisection to 0.2 %
    lighter = (("frame_mass", 15e3),)
    assert abs(found / limit(machine, 25.0, "RK4", lighter) - 1.0) > 0.1  # difference that the tolerance must detect


@pytest.mark.study
def test_bouncing_on_elastic_contacts_limits_explicit_steps_at_high_speed() -> None:
    """If creep is the fastest mode, contact models 1 and 2 have one limit with one law; at 60 m/s they do not."""
    assert limit_by_polach(10.0) == pytest.approx(limit(SPATIAL, 10.0), rel=1e-3)
    assert limit(PATCHES, 60.0) < 0.99 * limit(SPATIAL, 60.0)
    assert boundary(PATCHES, 60.0) == pytest.approx(limit(PATCHES, 60.0), rel=0.01)  # of scenario stability-atlas


def limit_by_polach(speed: float) -> float:
    """Return the limit of PATCHES with the law of contact model 1, (3.92), instead of its own."""
    bogie = replace(vehicle("bogie"), creep_law="polach")
    kernel = Kernel(quick_library(model_from(bogie, places_of(3, 2, on_line=False))))
    kernel.set(initial_speed=speed, tolerance=1e-10, **PATCHES.drag)
    kernel.advance(SETTLING)
    place = np.array(kernel.linearise().state)[PATCHES.form.differential]
    return largest_stable_step(np.linalg.eigvals(np.array(kernel.jacobian_at(kernel.time, place.tolist()))))


@pytest.mark.study
def test_constraints_drift_without_partitioning_and_not_with_it() -> None:
    free, closed = (drift(partitioned, duration=0.02) for partitioned in (False, True))
    assert free.residual[-1] > 1e-9
    assert free.norm[-1] > 1e-9
    assert max(closed.residual.max(), closed.norm.max()) < 1e-12


def test_contact_is_lost_at_a_fold() -> None:
    """The distance to a fold is proportional to the square root of the time to it."""
    assert approach().exponent == pytest.approx(0.5, abs=0.03)
