"""Test flexible rails below each wheelset: their effect on a coach in curves, and their equilibrium."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from math import pi

import numpy as np
import pytest

from fmu_src.kernel import Kernel
from fmu_src.system import System
from products.registry import model_of
from rbd_model.linear import reduced_jacobian
from rbd_model.track.irregularity import ballasted_track
from rbd_model.vehicle.parameters import manchester_vehicle_1
from scenarios.lines.flexible_track import RIGID, CoachRun, curve, peaks

#: Limit of the change of peaks over tolerances and contact dampings, at most 7.1e-5 in 220 curves, and least change on
#: rigid rails.
PEAK_BAND, RIGID_CHANGE = 1e-4, 0.2
#: Tolerance and contact damping [s/m]; the first is the default.
DEFAULT, OTHERS = (1e-6, 1.0), ((1e-5, 1.0), (1e-7, 1.0), (1e-8, 1.0), (1e-6, 0.5), (1e-6, 2.0))
ORDINARY = curve(300.0, 0.15)
#: A case in which the coach flutters on rigid rails.
FLUTTERS = curve(300.0, 0.15, friction=0.5)
#: A sharp curve on sticky rails, in which this motion grows by itself.
SHAKES = curve(150.0, 0.10, friction=0.6)
#: Contact damping with which the coach is stable there [s/m], and the default.
CALM, ASSUMED = 2.5, 1.0
#: Frequencies of bounce and roll of a wheelset on rigid rails [Hz], and a lower limit of the frequencies of wheel on
#: rail.
CONTACT_MODES, QUICK = (160.0, 205.0), 60.0
#: Tolerance of the track statics, of the static wheel load: the body still moves a little, and rails are damped;
#: measured 2e-4.
STATIC_BAND = 1e-3
#: Tolerance between a track of ten thousand times the stiffness and damping and a rigid one, both stable: of the
#: largest load.
STIFF_BAND = 1e-3


def spread(scene: CoachRun, variants: tuple[tuple[float, float], ...]) -> np.ndarray:
    """Return the relative changes of the largest wheel load and of the largest Y/Q from those with the default."""
    first, *others = (peaks(scene, tolerance=one, contact_damping=other) for one, other in (DEFAULT, *variants))
    return np.asarray(np.max(np.abs(np.array(others) / first - 1), axis=0))


@pytest.mark.study
@pytest.mark.parametrize("friction", [0.3, 0.5])
def test_peaks_in_a_curve_hang_neither_on_the_tolerance_nor_on_the_damping_of_contacts(friction: float) -> None:
    assert np.all(spread(curve(300.0, 0.15, friction=friction), (OTHERS[0], *OTHERS[2:])) < PEAK_BAND)


@pytest.mark.study
def test_on_rigid_rails_they_hang_on_both() -> None:
    """This shows that the test above can fail; on flexible rails the same curve is stable."""
    rigid = replace(FLUTTERS, values=FLUTTERS.values | RIGID)
    assert np.all(spread(rigid, ((1e-4, 1.0), (1e-6, 2.0))) > RIGID_CHANGE)
    assert np.all(spread(FLUTTERS, ((1e-4, 1.0), (1e-6, 2.0))) < RIGID_CHANGE / 100)


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.2, 0.3, 0.4, 0.5])
@pytest.mark.parametrize("radius", [200.0, 300.0, 500.0, 800.0, 1500.0])
def test_no_curve_makes_peaks_hang_on_the_tolerance_or_on_the_damping_of_contacts(
    radius: float, friction: float
) -> None:
    """Cants from 0 to 150 mm, with 100 mm excess to 130 mm deficiency."""
    for cant, deficiency in product((0.0, 0.075, 0.15), (-0.1, -0.05, 0.0, 0.05, 0.13)):
        if cant + deficiency > 0.0:
            found = spread(curve(radius, cant, deficiency, friction), OTHERS)
            assert np.all(found < PEAK_BAND), (cant, deficiency, found.tolist())


def settled(scene: CoachRun = ORDINARY, **values: float) -> Kernel:
    """Return the coach in the steady state of its curve."""
    kernel = scene.kernel(tolerance=1e-7, **values)
    kernel.advance(scene.duration)
    return kernel


def growth(matrix: np.ndarray) -> tuple[float, float]:
    """Return rate [1/s] and frequency [Hz] of the quick oscillation that grows fastest or decays slowest."""
    values = np.linalg.eigvals(matrix)
    quick = values[values.imag > 2 * pi * QUICK]
    found = quick[np.argmax(quick.real)] if quick.size else complex(-np.inf, 0.0)
    return float(found.real), float(found.imag / (2 * pi))


def leading_wheelset(names: list[str], matrix: np.ndarray, symmetric: bool) -> np.ndarray:
    """Return the leading wheelset's own part of a Jacobian; `symmetric`: with a symmetrised stiffness.

    The stiffness (mass times acceleration by displacement) of forces with a potential is symmetric; friction makes it
    asymmetric.
    """
    p = manchester_vehicle_1()
    moved = ("lateral_1", "rise_1", "roll_1", "yaw_1")
    moving = ("lateral_speed_1", "rise_speed_1", "roll_rate_1", "yaw_rate_1")
    places, speeds = ([names.index(name) for name in rows] for rows in (moved, moving))
    mass = np.array([p.wheelset_mass] * 2 + [p.wheelset_roll_inertia, p.wheelset_yaw_inertia])[:, None]
    stiffness = mass * matrix[np.ix_(speeds, places)]
    if symmetric:
        stiffness = (stiffness + stiffness.T) / 2
    damping = matrix[np.ix_(speeds, speeds)]
    return np.block([[np.zeros((4, 4)), np.eye(4)], [stiffness / mass, damping]])


@pytest.mark.study
def test_rigid_rails_let_friction_that_follows_the_load_shake_a_wheelset() -> None:
    """A fast motion of the vehicle grows. A symmetric stiffness gives its leading wheelset more damping."""
    place = settled(SHAKES, **RIGID, contact_damping=CALM).linearise().state
    kernel = SHAKES.kernel(**RIGID, contact_damping=ASSUMED)
    kernel.initialise()
    names = list(system_on_line().states)
    matrix = np.array(kernel.jacobian_at(SHAKES.duration, place))
    rate, frequency = growth(matrix)
    assert rate > 5.0
    assert CONTACT_MODES[0] < frequency < CONTACT_MODES[1]
    alone, symmetric = (growth(leading_wheelset(names, matrix, symmetric=one))[0] for one in (False, True))
    assert symmetric < alone - 2.0


def system_on_line() -> System:
    """Return the equations of the coach in 3D on a line."""
    return next(system for system in model_of("vehicle").systems if system.name == "spatial_patches_on_line")


@pytest.mark.parametrize("damping", [0.0, ASSUMED, 2 * ASSUMED])
def test_on_rails_that_yield_what_is_quick_dies_soon_whatever_the_contacts_damp(damping: float) -> None:
    _, matrix = reduced_jacobian(system_on_line(), np.array(settled(contact_damping=damping).linearise().jacobian))
    assert growth(matrix)[0] < -50.0


def test_rails_lie_where_loads_and_guiding_forces_press_them() -> None:
    """Hooke's law with the forces given as outputs; heights are relative to the rails under static load."""
    kernel, track, p = settled(), ballasted_track(), manchester_vehicle_1()
    mass = p.body_mass + 2 * p.frame_mass + 4 * p.wheelset_mass
    static = mass * p.gravity / 8
    for number in (1, 2, 3, 4):
        aside = kernel[f"state_track_{number}"] * track.track_lateral_stiffness
        assert aside == pytest.approx(-kernel[f"guiding_force_{number}"], abs=STATIC_BAND * static)
        for side in ("left", "right"):
            more = kernel[f"wheel_load_{number}_{side}"] - static
            sunk = -kernel[f"state_track_{number}_{side}"] * track.track_vertical_stiffness
            assert sunk == pytest.approx(more, abs=STATIC_BAND * static)
    assert kernel["guiding_force_1"] > 10 * STATIC_BAND * static
    assert kernel["wheel_load_1_right"] - kernel["wheel_load_1_left"] > 10 * STATIC_BAND * static


def test_a_track_that_hardly_yields_is_a_rigid_one() -> None:
    stiff = {
        name: 1e4 * value
        for name, value in ballasted_track().values().items()
        if name.endswith(("stiffness", "damping"))
    }
    one, other = (peaks(ORDINARY, contact_damping=CALM, **values) for values in (RIGID, stiff))
    assert one == pytest.approx(other, rel=STIFF_BAND)
    assert one != pytest.approx(peaks(ORDINARY, contact_damping=CALM), rel=STIFF_BAND)
