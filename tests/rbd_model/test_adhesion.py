"""Test friction that falls with sliding speed and varies along the track, against closed forms and quadrature."""

from __future__ import annotations

import math
from functools import lru_cache

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import quad

from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.kalker_to_coulomb import kalker_to_coulomb
from rbd_model.contact.creep.law import ContactPatch, CreepLaw, Reduction
from rbd_model.contact.creep.polach import polach, polach_force
from rbd_model.contact.hertz import ellipse_shape
from rbd_model.levels.models import DEFAULT_TOLERANCE, levels
from rbd_model.levels.planar import planar_vehicle
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.friction import CONDITIONS, RailCondition, dry, even_rail, wet
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie
from tests.fmu_src.quick_library import quick_library

BOGIE = tables_5_1_and_5_2()
STEEL, SEMI_AXES = 82e9, (6e-3, 5e-3)
POINT, PLANAR, SPATIAL = LEVELS = (1, 2, 3)
STATIC_LOAD = (BOGIE.wheelset_mass + BOGIE.frame_mass / 2) * BOGIE.gravity
#: Normal force over load: in 3D the contact is inclined like the cone of 1:20.
LEAN = {POINT: 1.0, PLANAR: 1.0, SPATIAL: math.hypot(1.0, 1 / 20)}
#: Rail conditions, one for each law of the table of rails.
FALLING = ("dry", "wet", "low", "very_low")
#: Tolerances: friction of a locked wheelset (in 3D the ellipse is a fit), stop (the suspension oscillates), energy.
LOCKED_BAND, STOP_BAND, ENERGY_BAND = 2e-4, 1e-3, 1e-6


def fallen(of: RailCondition, sliding: float) -> float:
    """Return mu0 ((1 - A) exp(-B w) + A), Polach (2005)."""
    law = of.law
    return of.friction * ((1 - law.friction_ratio) * math.exp(-law.friction_decay * sliding) + law.friction_ratio)


def utilised(of: RailCondition, gradient: float) -> float:
    """Return creep force over mu Q from the gradient epsilon, Polach (2005)."""
    a, s = of.law.adhesion_reduction * gradient, of.law.slip_reduction * gradient
    return 2 / math.pi * (a / (1 + a**2) + math.atan(s))


@lru_cache
def contact_stiffness() -> float:
    """Return G pi a b c11 / 4 over N^(2/3) of a wheel of the bogie."""
    shape = ellipse_shape(*(ca.SX(x) for x in (BOGIE.wheel_radius, 0.0, BOGIE.rail_head_radius, BOGIE.shear_modulus)))
    c11 = float(kalker_coefficients(shape.axis_ratio).c11)
    return math.pi / 4 * BOGIE.shear_modulus * float(shape.longitudinal) * float(shape.lateral) * c11


def adhesion(of: RailCondition, sliding: float, speed: float, load: float = STATIC_LOAD) -> float:
    """Return creep force over the load of an axle of the bogie."""
    friction = fallen(of, abs(sliding))
    creepage = sliding / math.hypot(speed, BOGIE.creepage_speed)
    return friction * utilised(of, contact_stiffness() * (load / 2) ** (-1 / 3) / friction * creepage)


def reduction(of: RailCondition) -> Reduction:
    return Reduction(of.law.adhesion_reduction, of.law.slip_reduction)


# -- the law ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", FALLING)
@pytest.mark.parametrize("creepage", [1e-4, 3e-3, 0.02, 0.5])
def test_creep_force_is_that_of_polach_2005(name: str, creepage: float) -> None:
    condition, load = CONDITIONS[name](), 75e3
    c11 = float(kalker_coefficients(ca.SX(1.2)).c11)
    friction = fallen(condition, 20.0 * creepage)
    gradient = math.pi / 4 * STEEL * SEMI_AXES[0] * SEMI_AXES[1] * c11 / (friction * load) * creepage
    arguments = (ca.SX(load), ca.SX(friction), SEMI_AXES, ca.SX(STEEL))
    found = polach_force(ca.SX(creepage), *arguments, ca.SX(c11), reduction(condition))
    assert float(found) == pytest.approx(-friction * load * utilised(condition, gradient), rel=1e-12)
    kalker = kalker_coefficients(ca.SX(1.2))
    both = polach(ContactPatch((ca.SX(creepage), ca.SX(0), ca.SX(0)), *arguments, kalker, reduction(condition)))
    assert float(both[0]) == pytest.approx(float(found), rel=1e-9)


@pytest.mark.parametrize("law", [polach, kalker_to_coulomb])
def test_small_creepages_give_kalkers_slopes_times_the_mean_reduction(law: CreepLaw) -> None:
    """Checks longitudinal creepage, lateral creepage and spin."""
    (a, b), kalker = SEMI_AXES, kalker_coefficients(ca.SX(1.2))
    mean = (wet().law.adhesion_reduction + wet().law.slip_reduction) / 2
    slopes = (a * b * float(kalker.c11), a * b * float(kalker.c22), (a * b) ** 1.5 * float(kalker.c23))
    for axis, (size, slope) in enumerate(zip((1e-7, 1e-7, 1e-5), slopes, strict=True)):
        creepages = tuple(ca.SX(size if number == axis else 0) for number in range(3))
        patch = (ca.SX(75e3), ca.SX(0.3), SEMI_AXES, ca.SX(STEEL), kalker, reduction(wet()))
        found = law(ContactPatch((creepages[0], creepages[1], creepages[2]), *patch))
        assert float(found[min(axis, 1)]) == pytest.approx(-mean * STEEL * slope * size, rel=1e-4)


@pytest.mark.parametrize("condition", [dry(), wet()], ids=["dry", "wet"])
def test_contamination_leaves_the_law_of_elastic_patches_the_share_of_polachs(condition: RailCondition) -> None:
    """At any creepage without spin: the force over that of clean surfaces, Polach (2005), up to all of friction."""
    kalker, (a, b), limit = kalker_coefficients(ca.SX(1.2)), SEMI_AXES, 0.3 * 75e3
    for creepage in (1e-5, 1e-3, 4e-3, 1e2):
        patch = (ca.SX(creepage), ca.SX(0), ca.SX(0)), ca.SX(75e3), ca.SX(0.3), SEMI_AXES, ca.SX(STEEL), kalker
        clean, left = (
            float(kalker_to_coulomb(ContactPatch(*patch, *more))[0]) for more in ((), (reduction(condition),))
        )
        gradient = math.pi / 4 * STEEL * a * b * float(kalker.c11) / limit * creepage
        of_clean = 2 / math.pi * (gradient / (1 + gradient**2) + math.atan(gradient))
        assert left == pytest.approx(clean * utilised(condition, gradient) / of_clean, rel=1e-6)
    assert left == pytest.approx(-limit, rel=1e-3)


def test_clean_surfaces_have_the_law_of_1999() -> None:
    """Eq. (3.97), to round-off."""
    rng = np.random.default_rng(1)
    for _ in range(100):
        creepage, load, friction, c11 = rng.uniform((1e-6, 1e3, 0.01, 3.0), (0.1, 2e5, 0.8, 6.0))
        gradient = math.pi / 4 * STEEL * SEMI_AXES[0] * SEMI_AXES[1] * c11 / (friction * load) * creepage
        exact = -2 / math.pi * friction * load * (gradient / (1 + gradient**2) + math.atan(gradient))
        found = polach_force(*(ca.SX(x) for x in (creepage, load, friction)), SEMI_AXES, ca.SX(STEEL), ca.SX(c11))
        assert float(found) == pytest.approx(exact, rel=1e-14)


@pytest.mark.study
@pytest.mark.parametrize("level", LEVELS)
def test_what_does_not_fall_and_has_no_patch_changes_nothing(bogie: Library, level: int) -> None:
    """Bit-identical with a friction ratio of 1 at any decay, and with a patch of the same friction as the rest."""
    rows = {"brake_torque_1": 45e3, "brake_torque_2": 45e3, "level": level}
    found = []
    for values in ({}, {"friction_decay": 3.0, "patch_start": 5.0, "patch_length": 7.0, "patch_blend": 0.3}):
        kernel = Kernel(bogie, **rows, **values)
        kernel.advance(2.0)
        found.append([kernel[name] for name in ("distance", "speed", "rotation_1", "rotation_2", "axle_load_1")])
    assert found[0] == found[1]


def test_named_conditions_say_which_are_verified() -> None:
    assert {name for name, make in CONDITIONS.items() if make().verified} == {"dry", "wet"}
    for make in CONDITIONS.values():
        assert make().verified != ("UNVERIFIED" in str(make.__doc__))


# -- the adhesion curve in a stop ---------------------------------------------------------------------------------


@pytest.mark.study
@pytest.mark.parametrize("level", [POINT, PLANAR])
def test_wheelset_locks_beyond_the_peak_of_adhesion(bogie: Library, level: int) -> None:
    """A slowly rising torque follows the curve. Its maximum is that of the formula, and then the wheelset locks."""
    condition = dry()
    kernel = Kernel(bogie, level=level, initial_speed=40.0, **condition.values())
    kernel.initialise()
    kernel.set_rate(brake_torque_1=15e3)
    names = ["speed", "slip_1", "creep_force_1", "axle_load_1", "locked_1"]
    table = {name: np.array(column) for name, column in kernel.record(10.0, 1e-3, names).items()}
    locked = int(np.argmax(table["locked_1"]))
    used = -table["creep_force_1"] / table["axle_load_1"]
    peak = int(np.argmax(used[:locked]))
    speed, load = table["speed"][peak], table["axle_load_1"][peak]
    curve = [adhesion(condition, w, speed, load) for w in np.geomspace(1e-3, speed, 4000)]
    assert 0 < peak < locked
    assert used[peak] == pytest.approx(max(curve), rel=2e-3)
    assert table["slip_1"][peak] < 0.1 * speed
    assert used[locked] < 0.7 * used[peak]
    end = table["speed"][locked + 1]
    assert used[locked + 1] == pytest.approx(adhesion(condition, end, end), rel=2e-3)


@pytest.mark.parametrize("name", FALLING)
@pytest.mark.parametrize("level", LEVELS)
def test_locked_wheelset_slides_with_the_fallen_friction(bogie: Library, level: int, name: str) -> None:
    condition = CONDITIONS[name]()
    kernel = Kernel(bogie, level=level, brake_torque_1=2e5, brake_torque_2=2e5, **condition.values())
    kernel.advance(1.0)
    assert kernel["locked_1"] == kernel["locked_2"] == 1.0
    for number in (1, 2):
        load = kernel[f"axle_load_{number}"]
        exact = LEAN[level] * adhesion(condition, kernel["speed"], kernel["speed"], load)
        assert -kernel[f"creep_force_{number}"] / load == pytest.approx(exact, rel=LOCKED_BAND)
    # The limit of the formula, which the creep law approaches from below.
    assert exact == pytest.approx(fallen(condition, kernel["speed"]), rel=0.02)


@pytest.mark.parametrize("name", ["dry", "wet"])
@pytest.mark.parametrize("level", LEVELS)
def test_locked_bogie_stops_where_quadrature_says(bogie: Library, level: int, name: str) -> None:
    """dv/dt = -g mu(v): the distance is the integral of v / (g mu(v)), of the sprung mass, which oscillates less."""
    place, velocity = ("distance", "speed") if level == POINT else ("state_frame_distance", "state_frame_speed")
    condition = CONDITIONS[name]()
    torques = {"brake_torque_1": 2e5, "brake_torque_2": 2e5}
    kernel = Kernel(bogie, level=level, initial_speed=30.0, **torques, **condition.values())
    kernel.advance(3.0)
    speed, begin = kernel[velocity], kernel[place]
    kernel.advance(30.0)
    exact = quad(lambda v: v / (BOGIE.gravity * LEAN[level] * adhesion(condition, v, v)), 0.0, speed)[0]
    assert abs(kernel["speed"]) < 1e-3
    assert kernel[place] - begin == pytest.approx(exact, rel=STOP_BAND)
    constant = speed**2 / (2 * BOGIE.gravity * condition.friction)
    assert kernel[place] - begin > (1 + 100 * STOP_BAND) * constant


@pytest.mark.parametrize("torque", [45e3, 60e3])
def test_default_tolerance_finds_the_lock_on_falling_friction(bogie: Library, torque: float) -> None:
    """The falling branch makes the rotation unstable. Compare with a tolerance 100 times tighter."""
    found = []
    for tolerance in (DEFAULT_TOLERANCE, 1e-2 * DEFAULT_TOLERANCE):
        values = {"brake_torque_1": torque, "brake_torque_2": torque, "tolerance": tolerance}
        kernel = Kernel(bogie, level=PLANAR, **(dry().values() | values))
        kernel.advance(30.0)
        found.append((kernel.messages, kernel["distance"]))
        assert any("locked" in line for line in kernel.messages)
    assert found[0][0] == found[1][0]
    assert found[0][1] == pytest.approx(found[1][1], abs=1e-4)


@pytest.mark.study
@pytest.mark.parametrize("level", [PLANAR, SPATIAL])
def test_lost_energy_equals_work_on_falling_friction(level: int) -> None:
    powers, energies = ["brake_power", "creep_power", "damping_power"], ["kinetic_energy", "potential_energy"]
    plain = (
        planar_vehicle(two_axle_bogie(BOGIE))
        if level == PLANAR
        else spatial_vehicle(two_axle_bogie(BOGIE), irregular_track(section_5_3()))
    )
    library = quick_library(model_of(plain.with_integrals(powers).with_outputs(energies), DEFAULT_TOLERANCE))
    patch = {"patch_start": 20.0, "patch_length": 10.0, "patch_friction": 0.3}
    kernel = Kernel(library, brake_torque_1=45e3, brake_torque_2=30e3, tolerance=1e-8, **patch, **wet().values())
    kernel.initialise()
    begin = sum(kernel[name] for name in energies)
    kernel.advance(8.0)
    lost = begin - sum(kernel[name] for name in energies)
    assert kernel["integral_creep_power"] > 0.1 * lost
    assert lost == pytest.approx(sum(kernel[f"integral_{name}"] for name in powers), rel=ENERGY_BAND)


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("speed", [0.0, 25.0])
def test_derivatives_are_finite_without_sliding(bogie: Library, level: int, speed: float) -> None:
    kernel = Kernel(bogie, level=level, initial_speed=speed, patch_friction=0.5, **wet().values())
    kernel.initialise()
    assert np.all(np.isfinite(kernel.linearise().jacobian))


@pytest.mark.study
@pytest.mark.parametrize("level", LEVELS)
def test_jacobian_is_exact_on_falling_friction_within_the_end_of_a_patch(bogie: Library, level: int) -> None:
    """Compare with central differences, on a patch that grows over a kilometre while the wheels skid."""
    patch = {"patch_start": -10.0, "patch_length": 2e3, "patch_blend": 1e3, "patch_friction": 0.2}
    values = {"brake_torque_1": 60e3, "brake_torque_2": 60e3, "tolerance": 1e-9}
    kernel = Kernel(bogie, level=level, contact_model=1, **patch, **(wet().values() | values))
    kernel.advance(0.05)
    assert kernel["slip_1"] > 1.0
    assert kernel["locked_1"] == 0.0
    states = levels(two_axle_bogie(BOGIE))[level - 1].states.values()
    place = np.array(kernel.linearise().state)[[not state.algebraic for state in states]]
    exact = np.array(kernel.jacobian_at(0.05, place))
    for column in range(place.size):
        shift = np.zeros(place.size)
        shift[column] = 1e-6 * max(1e-2, abs(place[column]))
        ahead, back = (np.array(kernel.slopes_at(0.05, place + sign * shift)) for sign in (1.0, -1.0))
        difference = (ahead - back) / (2 * shift[column])
        allowed = 1e-5 * max(1.0, np.abs(exact[:, column]).max()) + 1e-11 / shift[column]
        assert np.abs(difference - exact[:, column]).max() < allowed


# -- along the track ----------------------------------------------------------------------------------------------

PATCH = {"patch_start": 20.0, "patch_length": 10.0, "patch_friction": 0.25, "patch_blend": 1.0}


def factor(place: np.ndarray) -> np.ndarray:
    share = np.clip(np.minimum(place - 20.0, 30.0 - place), 0.0, 1.0)
    return 1 - 0.75 * (3 * share**2 - 2 * share**3)


@pytest.mark.parametrize("level", LEVELS)
def test_each_wheelset_meets_the_patch_at_its_own_distance(bogie: Library, level: int) -> None:
    """Locked wheels show the friction under them; the leading wheelset enters and leaves the patch first.

    The sudden torque has no reaction on the frame, which would lift the trailing wheelset.
    """
    values = {"brake_torque_1": 2e5, "brake_torque_2": 2e5, "torque_reaction": 0.0}
    kernel = Kernel(bogie, level=level, **values, **PATCH)
    names = ["distance", "creep_force_1", "creep_force_2", "axle_load_1", "axle_load_2", "locked_1", "locked_2"]
    table = {name: np.array(column) for name, column in kernel.record(2.0, 1e-3, names).items()}
    sliding = (table["locked_1"] > 0) & (table["locked_2"] > 0)
    assert table["distance"][sliding][0] < 18.0
    entered = []
    for number, place in ((1, BOGIE.wheel_base / 2), (2, -BOGIE.wheel_base / 2)):
        friction = -table[f"creep_force_{number}"] / table[f"axle_load_{number}"]
        at = table["distance"] + place
        assert friction[sliding] == pytest.approx(0.3 * factor(at[sliding]), rel=0.03)
        entered.append(table["distance"][np.argmax(sliding & (friction < 0.15))])
    assert entered[1] - entered[0] == pytest.approx(BOGIE.wheel_base, abs=0.05)


@pytest.mark.parametrize("level", LEVELS)
def test_patch_is_not_stepped_over(bogie: Library, level: int) -> None:
    """A slippery metre at 25 m/s in a gentle stop, whose steps could be longer. Compare with a tighter tolerance."""
    found = []
    for tolerance in (DEFAULT_TOLERANCE, 1e-3 * DEFAULT_TOLERANCE):
        values = {"brake_torque_1": 20e3, "brake_torque_2": 20e3, "tolerance": tolerance}
        kernel = Kernel(bogie, level=level, **values, **PATCH | {"patch_length": 1.0, "patch_blend": 0.25})
        kernel.set(patch_friction=0.02)
        kernel.advance(5.0)
        found.append((kernel["rotation_1"], kernel["rotation_2"], kernel["distance"]))
    without = Kernel(bogie, level=level, brake_torque_1=20e3, brake_torque_2=20e3)
    without.advance(5.0)
    assert found[0] == pytest.approx(found[1], abs=1e-4)
    assert abs(found[0][0] - without["rotation_1"]) > 1e-2


@pytest.mark.parametrize("level", LEVELS)
def test_leading_wheelset_cleans_the_rail_for_the_trailing_one(bogie: Library, level: int) -> None:
    values = {"brake_torque_1": 2e5, "brake_torque_2": 2e5, "torque_reaction": 0.0}
    kernel = Kernel(bogie, level=level, cleaned_friction=1.5, **values)
    kernel.advance(1.0)
    leading, trailing = (kernel[f"creep_force_{n}"] / kernel[f"axle_load_{n}"] for n in (1, 2))
    assert trailing / leading == pytest.approx(1.5, rel=0.02)


def test_rail_is_even_and_clean_unless_asked_for() -> None:
    assert (even_rail().patch_friction, even_rail().cleaned_friction) == (1.0, 1.0)
