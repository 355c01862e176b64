"""Common results of the levels of detail, and differences, each as large as physics predicts."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import brentq

import bogie_braking as bb
from evidence.numerics import levels
from evidence.numerics.levels import FRICTION, Answers, brake, error, lock_boundary, start, stop
from products.kernel_runs import located_lock_time, play
from rbd_model.contact.creep.kalker import kalker_coefficients
from rbd_model.contact.creep.law import ContactPatch
from rbd_model.contact.creep.polach import polach
from rbd_model.contact.geometry import contact_at, thesis_pair
from rbd_model.contact.hertz import ellipse_shape
from rbd_model.levels.models import DECIDED_BY_LOAD_TRANSFER, STATIC_LOADS_UP_TO
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

POINT, PLANAR, SPATIAL = 1, 2, 3
BOGIE = tables_5_1_and_5_2()
MASS = BOGIE.frame_mass + 2 * BOGIE.wheelset_mass
#: Mass added by the rotation of both wheelsets, as a share: J/r^2 each.
ROTARY = 2 * BOGIE.wheelset_pitch_inertia / (BOGIE.wheel_radius**2 * MASS)
#: A wheelset begins to lock a little below mu N. Polach's law reaches mu N at infinite creepage. At g = 7.5, where the
#: slip is 0.8 %, it is lower by 0.424/g^3, or 1e-3. The boundary is enclosed to 1e-4.
BOUNDARY_TOLERANCE = 1e-3


def answers(level: int, utilisation: float, tolerance: float = levels.TOLERANCE, **values: float) -> Answers:
    return stop(start(level, tolerance, **values), utilisation)


def off(stops: Answers, spatial: Answers, question: str) -> float:
    return float(error([stops], [spatial], question)[0])


def test_static_loads_lock_both_wheelsets_where_brakes_outdo_adhesion_and_rotary_inertia() -> None:
    expected = 1.0 + ROTARY
    leading, trailing = (lock_boundary(POINT, number) for number in (1, 2))
    assert leading == trailing == pytest.approx(expected, rel=BOUNDARY_TOLERANCE)
    heavier = lock_boundary(POINT, 2, wheelset_pitch_inertia=1.1 * BOGIE.wheelset_pitch_inertia)
    assert heavier != pytest.approx(expected, rel=BOUNDARY_TOLERANCE)


def test_trailing_wheelset_locks_where_load_transfer_leaves_it_too_little_adhesion() -> None:
    """Rigid bogie: the trailing wheelset loses the load m a h / L and takes half of the braking force M a.

    It also loses the torque of both brakes over L, because the brakes react on the frame.
    """
    share = BOGIE.frame_mass * BOGIE.frame_height / (MASS * BOGIE.wheel_base)
    hung = (1.0 + ROTARY) * BOGIE.wheel_radius / BOGIE.wheel_base
    expected = (1.0 + ROTARY) / (1.0 + 2 * FRICTION * (share + hung))
    stiff = {f"{way}_stiffness": 100 * BOGIE.values()[f"{way}_stiffness"] for way in ("longitudinal", "vertical")}
    damped = {f"{way}_damping": 30 * BOGIE.values()[f"{way}_damping"] for way in ("longitudinal", "vertical")}
    rigid = lock_boundary(PLANAR, 2, **stiff, **damped)
    assert rigid == pytest.approx(expected, rel=BOUNDARY_TOLERANCE)
    # On its springs the mass moves 6 mm forward under braking, and the trailing wheelset loses another 1 % of load.
    soft = lock_boundary(PLANAR, 2)
    assert soft is not None
    assert 0.98 * expected < soft < (1.0 - BOUNDARY_TOLERANCE) * expected
    assert lock_boundary(PLANAR, 1) is None  # the leading wheelset gains the load that the trailing one loses


#: Differences from the spatial level after correcting friction for the cone: spin changes a stop by 5 mm and, 0.1 above
#: the boundary, a lock by 1.5 ms.
CONE_DISTANCE, CONE_TIME = 0.01, 2e-3


@pytest.mark.study
@pytest.mark.parametrize("utilisation", [0.9, 1.1])
def test_inclination_of_the_cone_is_the_difference_of_planar_and_spatial_stops(utilisation: float) -> None:
    spatial = answers(SPATIAL, utilisation)
    level_rail = answers(PLANAR, utilisation)
    inclined = answers(PLANAR, utilisation, friction=FRICTION * levels.adhesion_of_the_cone())
    assert off(inclined, spatial, "stop_distance") < CONE_DISTANCE < off(level_rail, spatial, "stop_distance")
    assert off(inclined, spatial, "lock_time_2") < CONE_TIME
    too_steep = answers(PLANAR, utilisation, friction=FRICTION * levels.adhesion_of_the_cone() ** 3)
    assert off(too_steep, spatial, "stop_distance") > CONE_DISTANCE


def creepage_for(demand: float, spin: float) -> float:
    """Return the longitudinal creepage of a wheel at its static load that transmits `demand` of mu N, by Polach's law.

    spin [1/m].
    """
    load = MASS * BOGIE.gravity / 4
    shape = ellipse_shape(*(ca.SX(x) for x in (BOGIE.wheel_radius, 0.0, BOGIE.rail_head_radius, BOGIE.shear_modulus)))
    axes = (shape.longitudinal * load ** (1 / 3), shape.lateral * load ** (1 / 3))
    creepage = ca.SX.sym("creepage")
    parts, kalker = (creepage, ca.SX(0), ca.SX(spin)), kalker_coefficients(shape.axis_ratio)
    force = polach(ContactPatch(parts, ca.SX(load), ca.SX(FRICTION), axes, ca.SX(BOGIE.shear_modulus), kalker))[0]
    law = ca.Function("law", [creepage], [force / (FRICTION * load)])
    return float(brentq(lambda value: float(law(value)) + demand, 1e-6, 0.05))


#: Tolerance of the ratio of two creepages: load transfer and the fit of Kalker's table (0.5 %) have less effect.
SPIN_TOLERANCE = 2e-3


def test_spin_of_the_cone_is_the_extra_creep_of_the_spatial_level() -> None:
    utilisation = 0.3
    spin = np.sin(contact_at(thesis_pair(), 0.0).angle[0]) / BOGIE.wheel_radius
    series = {level: brake(start(level), utilisation) for level in (PLANAR, SPATIAL)}
    steady = (series[PLANAR]["time"] > 5.0) & (series[PLANAR]["time"] < 6.0)
    found = series[SPATIAL]["slip_1"][steady].mean() / series[PLANAR]["slip_1"][steady].mean()
    demand = utilisation / (1.0 + ROTARY)
    without = creepage_for(demand, 0.0)
    assert found == pytest.approx(creepage_for(demand, spin) / without, rel=SPIN_TOLERANCE)
    assert found != pytest.approx(creepage_for(demand, 0.9 * spin) / without, rel=SPIN_TOLERANCE)


@pytest.mark.parametrize("utilisation", [0.3, 0.65, 0.9, 1.1])
def test_planar_stop_and_lock_are_those_of_the_spatial_level(utilisation: float) -> None:
    spatial, planar = answers(SPATIAL, utilisation), answers(PLANAR, utilisation)
    assert off(planar, spatial, "stop_distance") < levels.DISTANCE_BOUND
    assert (planar.lock_time_2 is None) == (spatial.lock_time_2 is None) == (utilisation < 0.7)
    assert planar.lock_time_1 is None
    assert spatial.lock_time_1 is None
    if planar.lock_time_2 is not None:
        assert off(planar, spatial, "lock_time_2") < levels.TIME_BOUND
        lower = answers(PLANAR, utilisation, frame_height=0.75)
        assert off(lower, spatial, "lock_time_2") > levels.TIME_BOUND
        assert off(lower, spatial, "stop_distance") > levels.DISTANCE_BOUND


def test_no_bound_in_seconds_holds_at_the_edge_of_locking() -> None:
    """There the smallest difference of adhesion changes the time of the lock, but hardly the stopping distance."""
    spatial, planar = answers(SPATIAL, 0.71), answers(PLANAR, 0.71)
    assert off(planar, spatial, "lock_time_2") > 10 * levels.TIME_BOUND
    assert off(planar, spatial, "stop_distance") < levels.DISTANCE_BOUND


#: Largest effect of the integration on an answer, as a share of the difference of two levels.
INTEGRATION_SHARE = 0.01


@pytest.mark.parametrize("utilisation", [0.5, 0.9])
def test_integration_error_is_far_below_that_of_the_levels(utilisation: float) -> None:
    spatial = answers(SPATIAL, utilisation)

    def moved(level: int, tolerance: float) -> float:
        """Return the largest change against a hundredfold tighter run, over the error of the planar level."""
        one, exact = answers(level, utilisation, tolerance), answers(level, utilisation, 1e-2 * levels.TOLERANCE)
        asked = ["stop_distance", "peak_slip_2"] + ([] if spatial.lock_time_2 is None else ["lock_time_2"])
        planar = answers(PLANAR, utilisation)
        return max(off(one, exact, question) / off(planar, spatial, question) for question in asked)

    assert moved(PLANAR, levels.TOLERANCE) < INTEGRATION_SHARE
    assert moved(SPATIAL, levels.TOLERANCE) < INTEGRATION_SHARE
    assert moved(PLANAR, 1e-3) > INTEGRATION_SHARE


def test_wheelset_that_stops_with_the_bogie_has_not_locked() -> None:
    kernel = start(PLANAR)
    series = brake(kernel, 0.5)
    assert kernel["angular_velocity_2"] == 0.0
    assert kernel.messages[-1].startswith("The vehicle stands at")
    assert located_lock_time(kernel, series, 2) is None
    assert abs(series["speed"][-1]) < 1e-4


@pytest.mark.parametrize("level", [POINT, PLANAR])
def test_bogie_is_at_rest_at_the_end_of_every_stop(level: int) -> None:
    ends = [brake(start(level), utilisation, interval=0.1)["speed"][-1] for utilisation in levels.UTILISATIONS]
    assert max(abs(end) for end in ends) < 1e-4


def test_lock_time_is_located_and_not_sampled() -> None:
    coarse, fine = start(PLANAR), start(PLANAR)
    found = [located_lock_time(kernel, brake(kernel, 0.9, i), 2) for kernel, i in ((coarse, 0.05), (fine, 1e-3))]
    assert found[0] == found[1]


#: Errors over an output's largest value: limit for static loads, and a value that is clearly wrong.
RIGHT, WRONG = 2e-3, 0.1
#: The spatial creep force oscillates for a second after the torque increases, by 2.0e-3 of its largest value.
ROCKING = 2.1e-3
ALWAYS_WRONG = ("slip", "slip_ratio", "axle_load")
WRONG_NEAR_THE_LIMIT = ("locked", "creep_force")
RIGHT_BELOW = ("speed", "distance", "angular_velocity", "rotation")


def point_off(utilisation: float) -> dict[str, float]:
    """Return the largest error of each output of the point level over its largest value, for both wheelsets in motion.

    The acceleration is left out: it oscillates on the suspension for a second after the torque increases, by a tenth.
    """
    names = {f"{family}_{n}" for family in (*ALWAYS_WRONG, *WRONG_NEAR_THE_LIMIT, *RIGHT_BELOW[2:]) for n in (1, 2)}
    read = [*RIGHT_BELOW[:2], *sorted(names)]
    inputs = {f"brake_torque_{n}": [(0.0, 0.0), (levels.RAMP, levels.brake_torque(utilisation))] for n in (1, 2)}
    runs = {
        level: play("bogie", start(level), levels.duration(utilisation), 5e-3, read, inputs)
        for level in (POINT, SPATIAL)
    }
    moving = runs[SPATIAL]["speed"] > 1.0
    worst: dict[str, float] = {}
    for name in read:
        right = runs[SPATIAL][name][moving]
        largest = np.abs(right).max() or 1.0
        family = name.removesuffix("_1").removesuffix("_2")
        worst[family] = max(worst.get(family, 0.0), float(np.abs(runs[POINT][name][moving] - right).max() / largest))
    return worst


def test_smallest_level_takes_load_transfer_where_its_absence_is_seen() -> None:
    assert set(DECIDED_BY_LOAD_TRANSFER) == {*ALWAYS_WRONG, *WRONG_NEAR_THE_LIMIT}
    below, above = point_off(STATIC_LOADS_UP_TO), point_off(0.9)
    assert max(below[family] for family in RIGHT_BELOW) < RIGHT
    assert max(below[family] for family in WRONG_NEAR_THE_LIMIT) < ROCKING
    assert min(below[family] for family in ALWAYS_WRONG) > WRONG
    assert min(above[family] for family in DECIDED_BY_LOAD_TRANSFER) > WRONG
    # Above the limit, all results with static loads are wrong, so the limit on the braking demand is needed.
    assert min(above[family] for family in RIGHT_BELOW) > 10 * RIGHT


@pytest.mark.study
def test_point_level_misses_the_lock_up_between_the_two_boundaries(monkeypatch: pytest.MonkeyPatch) -> None:
    found = levels.measure((0.3, 0.65, 0.9, 1.1), (1.0,), repeats=1)
    spatial, point = found.trailing_boundary("spatial"), found.trailing_boundary("point")
    for utilisation, one, other in zip(found.utilisations, found.stops["point"], found.stops["spatial"], strict=True):
        missed = one.lock_time_2 is None and other.lock_time_2 is not None
        assert missed == (spatial <= utilisation < point)
    assert all(row.holds is not False for row in levels.error_rows(found) + levels.boundary_rows(found))
    monkeypatch.setattr(levels, "adhesion_of_the_cone", lambda: 1.0)
    assert any(row.holds is False for row in levels.boundary_rows(found))


@pytest.mark.parametrize(("friction", "share", "due"), [(0.1, 0.8, 0.002), (0.1, 0.9, -0.27), (0.3, 0.95, 0.48)])
def test_falling_friction_near_the_limit_needs_the_spatial_level(friction: float, share: float, due: float) -> None:
    """A stop at the planar level over that at the spatial one, less 1, as docs/choosing.md has it."""
    torque = share * levels.brake_torque(1.0) * friction / FRICTION
    given = {f"{name}_{n}": value for name, value in (("friction", friction), ("brake_torque", torque)) for n in (1, 2)}
    ends = []
    for level in (PLANAR, SPATIAL):
        fall = {"friction_ratio": 0.4, "friction_decay": 0.6, "initial_speed": 25.0, "level": level}
        run = bb.run("bogie", 60.0, None, ["speed", "distance"], **fall, **given)
        ends.append(run["distance"][-1])
    assert ends[0] / ends[1] - 1.0 == pytest.approx(due, abs=0.01)
