"""Test forces by tables of travel and of rate against closed forms, at all levels, and points that are refused."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import System, model_of
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.description import (
    BumpStop,
    Pull,
    RigidBody,
    Springs,
    SuspensionElement,
    TableDamper,
    TableSpring,
    Vehicle,
    wheelset_name,
)
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie
from tests.evidence.maximal.joints import table_energy, table_force

#: Integration tolerance of the blocks, and their tolerance against a closed form.
TOLERANCE, CLOSED_FORM = 1e-9, 1e-6
#: Relative difference of two runs whose equations have the same meaning, at the tolerance of a run.
SAME = 1e-5
#: Blocks of 1000 kg on a locked frame: on a stop, on a saturating damper, on one with two different sides, and carried
#: by two progressive springs, or by two that only push.
MASS, GRAVITY = 1000.0, 9.81
STOP = (0.010, 0.020, 0.030), (0.0, 1000.0, 4000.0)
YAW = (0.0, 0.02, 0.04), (0.0, 12e3, 12e3)
TWO_SIDES = (-0.4, 0.0, 0.1), (-2e4, 0.0, 1e4)
PUSHING = (-0.10, -0.05, 0.0, 0.10), (-24e3, -4e3, 0.0, 0.0)
PROGRESSIVE = (0.0, 0.05, 0.10), (0.0, 4e3, 24e3)
HELD = frozenset({"lateral", "roll", "pitch", "yaw"})
AT = (0.0, 0.0, "frame_height")


def blocks() -> Vehicle:
    good = two_axle_bogie()
    kinds = {"stop": HELD | {"bounce"}, "saturating": HELD | {"bounce"}, "sided": HELD | {"bounce"}}
    kinds |= {"carried": HELD, "pushed": HELD}
    inertia = (1.0, 1.0, 1.0)
    bodies = [RigidBody(one, one, MASS, inertia, 0.0, "frame_height", held) for one, held in kinds.items()]  # type: ignore[arg-type]
    connections = [
        BumpStop("stop_law", "stop", "frame", AT, False, "longitudinal", *STOP),
        TableDamper("saturating_law", "saturating", "frame", AT, False, "longitudinal", *YAW),
        TableDamper("sided_law", "sided", "frame", AT, False, "longitudinal", *TWO_SIDES),
        TableSpring("carried_law", "carried", "frame", (0.0, 0.5, "frame_height"), True, "vertical", *PROGRESSIVE),
        TableSpring("pushed_law", "pushed", "frame", (0.0, 0.5, "frame_height"), True, "vertical", *PUSHING),
        Springs("pushed_along", "pushed", "frame", AT, False, (1e6, 0.0, 0.0), (1e4, 0.0, 0.0)),
        Springs("carried_along", "carried", "frame", AT, False, (1e6, 0.0, 0.0), (1e4, 0.0, 0.0)),
    ]
    pulls = [Pull(f"force_{one}", f"Force on {one}", one, AT) for one in kinds]
    pulls += [Pull(f"lift_{one}", f"Force upwards on {one}", one, AT, "vertical") for one in ("carried", "pushed")]
    return replace(
        good,
        bodies=(*good.bodies, *bodies),
        connections=(*good.connections, *connections),
        pulls=tuple(pulls),
    )


@cache
def model_system() -> System:
    return planar_vehicle(blocks()).with_outputs(["damping_power"])


@pytest.fixture(scope="module")
def bench() -> Library:
    return Library(build_library(model_of(model_system(), TOLERANCE)))


def standing(bench: Library, **values: float) -> Kernel:
    """Return a kernel with a frame that does not move: locked wheels, 1e6 times the mass, 1e3 times the stiffness."""
    locked = {"brake_torque_1": 1e9, "brake_torque_2": 1e9, "initial_speed": 0.0, "friction_1": 2.0, "friction_2": 2.0}
    heavy = {"frame_mass": 6e10, "longitudinal_stiffness": 9.5e12, "vertical_stiffness": 3.5e12}
    kernel = Kernel(bench, **locked, **heavy, **values)
    kernel.initialise()
    return kernel


@pytest.mark.study
@pytest.mark.parametrize("force", [300.0, -2000.0])
def test_a_mass_released_on_a_stop_keeps_its_energy(bench: Library, force: float) -> None:
    """It is pulled through the clearance: F x = m v^2 / 2 + the area under the lines, at each moment."""
    kernel = standing(bench, force_stop=force)
    furthest = 0.0
    for _ in range(200):
        kernel.advance(0.005)
        way, speed = kernel["state_stop_shift"], kernel["state_stop_shift_speed"]
        work = force * way
        assert MASS * speed**2 / 2 + table_energy(*STOP, way) == pytest.approx(
            work, abs=CLOSED_FORM * abs(force * STOP[0][-1])
        )
        furthest = max(furthest, abs(way))
    assert table_energy(*STOP, furthest) == pytest.approx(abs(force) * furthest, rel=0.02)


@pytest.mark.study
@pytest.mark.parametrize(("force", "speed"), [(3000.0, 0.005), (-9000.0, -0.015)])
def test_a_damper_creeps_at_the_rate_of_its_table(bench: Library, force: float, speed: float) -> None:
    kernel = standing(bench, force_saturating=force)
    kernel.advance(1.0)
    assert kernel["state_saturating_shift_speed"] == pytest.approx(speed, rel=CLOSED_FORM)


@pytest.mark.study
def test_a_saturated_damper_resists_with_its_largest_force(bench: Library) -> None:
    """20 kN against 12 kN accelerate 1 t by 8 m/s2, also beyond the last point of the table."""
    kernel = standing(bench, force_saturating=20e3)
    kernel.advance(0.5)
    before, lost = kernel["state_saturating_shift_speed"], kernel["damping_power"]
    kernel.advance(0.25)
    assert kernel["state_saturating_shift_speed"] - before == pytest.approx(0.25 * 8.0, rel=CLOSED_FORM)
    assert lost == pytest.approx(12e3 * before, rel=CLOSED_FORM)


@pytest.mark.parametrize(("force", "speed"), [(5e3, 0.05), (-5e3, -0.1), (2e4, 0.2), (-3e4, -0.6)])
def test_a_damper_may_differ_between_its_sides(bench: Library, force: float, speed: float) -> None:
    kernel = standing(bench, force_sided=force)
    kernel.advance(1.0)
    assert kernel["state_sided_shift_speed"] == pytest.approx(speed, rel=CLOSED_FORM)


def two_springs(travel: float) -> float:
    """Return the force of both carrying springs [N]."""
    return 2.0 * float(table_force(*PROGRESSIVE, np.array(travel)))


@pytest.mark.parametrize("gravity", [0.1 * GRAVITY, GRAVITY, 6.0 * GRAVITY])
def test_a_mass_rests_and_swings_at_the_point_of_its_weight(bench: Library, gravity: float) -> None:
    """A load beside the weight moves it along the table; the frequency is that of the slope there."""
    weight = MASS * gravity
    rest = np.interp(weight, [2.0 * one for one in PROGRESSIVE[1]], PROGRESSIVE[0])
    if weight > 2.0 * PROGRESSIVE[1][-1]:
        rest = PROGRESSIVE[0][-1] + (weight - 2.0 * PROGRESSIVE[1][-1]) / (2.0 * 4e5)
    kernel = standing(bench, gravity=gravity)
    kernel.advance(1.0)
    assert kernel["carried_bounce"] == pytest.approx(0.0, abs=1e-9)
    slope = two_springs(rest + 1e-6) - two_springs(rest - 1e-6)
    lift = -slope / 2e-6 * 1e-4  # pushes it down by 0.1 mm, within its straight line
    kernel.set(lift_carried=lift)
    half = math.pi / math.sqrt(slope / 2e-6 / MASS)
    kernel.advance(half)
    assert kernel["carried_bounce"] == pytest.approx(-2e-4, rel=1e-4)


def test_a_mass_leaves_a_spring_that_only_pushes(bench: Library) -> None:
    """Lifted by twice its weight it flies off, with the work of this force and what the springs had stored."""
    weight = MASS * GRAVITY
    kernel = standing(bench, gravity=GRAVITY, lift_pushed=2.0 * weight)
    kernel.advance(0.3)
    rise, speed = kernel["pushed_bounce"], kernel["state_pushed_bounce_rate"]
    rest = float(np.interp(weight / 2.0, PROGRESSIVE[1], PROGRESSIVE[0]))
    assert rise > rest
    stored = 2.0 * table_energy(*PROGRESSIVE, rest)
    assert MASS * speed**2 / 2 == pytest.approx(weight * rise + stored, rel=CLOSED_FORM)


@pytest.mark.parametrize(("gravity", "slope"), [(GRAVITY, 4e5), (0.1 * GRAVITY, 8e4)])
def test_a_linearisation_has_the_slopes_of_the_lines(bench: Library, gravity: float, slope: float) -> None:
    """A spring carries 4.9 kN on the second line of its table, or 0.49 kN on the first one."""
    kernel = standing(bench, gravity=gravity)
    jacobian, names = np.array(kernel.linearise().jacobian), list(model_system().states)
    row, column = names.index("carried_bounce_rate"), names.index("carried_bounce")
    assert jacobian[row, column] == pytest.approx(-2.0 * slope / MASS, rel=CLOSED_FORM)
    row = names.index("saturating_shift_speed")
    assert jacobian[row, row] == pytest.approx(-600e3 / MASS, rel=CLOSED_FORM)


def as_tables(vehicle: Vehicle) -> Vehicle:
    """Return a vehicle whose vertical springs and dampers are straight tables."""
    connections: list[SuspensionElement] = []
    for one in vehicle.connections:
        if not isinstance(one, Springs) or not one.carries:
            connections.append(one)
            continue
        place = one.upper, one.lower, one.place, one.both_sides, "vertical"
        slope, damping = vehicle.number(one.stiffness[2]), vehicle.number(one.damping[2])
        spring = TableSpring(f"{one.name}_law", *place, (0.0, 0.01, 0.02), (0.0, 0.01 * slope, 0.02 * slope))
        connections += [spring, TableDamper(f"{one.name}_damper", *place, (0.0, 0.1), (0.0, 0.1 * damping))]
    return replace(vehicle, connections=tuple(connections))


@pytest.mark.study
@pytest.mark.parametrize("level", [1, 2, 3])
def test_straight_tables_are_springs_and_dampers_at_every_level(level: int) -> None:
    values: dict[str, Any] = {"initial_speed": 20.0, "brake_torque_1": 8e3, "brake_torque_2": 6e3, "level": level}
    values |= {"contact_model": 1, "initial_lateral": 2e-3} if level == 3 else {}
    names = ["distance", "axle_load_1", "axle_load_2"] + ["pitch"] * (level > 1) + ["lateral_1"] * (level > 2)
    bogie = two_axle_bogie()
    runs = [bb.run(one, 1.0, None, names, 0.05, **values) for one in (bogie, as_tables(bogie))]
    for name in names:
        size = np.max(np.abs(runs[0][name]))
        assert np.max(np.abs(runs[0][name] - runs[1][name])) < SAME * size, name


def with_one(kind: type[SuspensionElement], **law: Any) -> Vehicle:
    good = two_axle_bogie(tables_5_1_and_5_2())
    one = kind("added", "frame", wheelset_name(1), (0.0, 0.0, 0.0), False, **law)
    return replace(good, connections=(*good.connections, one))


SPRING_FAULTS = [
    ((0.0,), (0.0,), "travel and force must have at least 2 points, as many of both; got 1 and 1."),
    ((0.0, 0.1), (0.0, 1.0, 2.0), "as many of both; got 2 and 3."),
    ((0.0, 0.1, 0.1), (0.0, 1.0, 2.0), "travel must rise from point to point; got 0.1 after 0.1."),
    ((0.0, math.inf), (0.0, 1.0), "travel must be a list of finite numbers; got"),
    ((0.0, 0.1), (0.0, math.nan), "force must be a list of finite numbers; got"),
    (0.1, (0.0, 1.0), "travel must be a list of finite numbers; got 0.1."),
    ((0.0, 0.1), (1.0, 2.0), "force must be 0 at the first travel; got 1 N."),
    ((-0.1, 0.1), (-1.0, 2.0), "force must be 0 at the travel 0; got 0.5 N. Add a point 0, 0."),
    ((-0.2, -0.1), (-1.0, 0.0), "travel must have points above 0 beside those below; got -0.1 as the last."),
    ((0.0, 0.1, 0.2), (0.0, 2.0, 1.0), "force must not fall over travel; got"),
    ((0.0, 0.1, 0.2), (0.0, 2.0, 2.0), "force must rise under load; got -2 N from -0.2 to -0.1 m."),
]
DAMPER_FAULTS = [
    ((0.0, 0.1), (0.0, -1.0), "force must have the sign of rate; got"),
    ((-0.1, 0.0, 0.1), (1.0, 0.0, 1.0), "force must have the sign of rate; got 1 N at -0.1 m/s."),
    ((0.0, 0.1, 0.2), (0.0, 2.0, 1.0), "force must not fall at the ends, whose slopes continue; got"),
    ((0.1, 0.2), (1.0, 2.0), "force must be 0 at the first rate; got 1 N."),
    ((0.1, 0.0), (0.0, 1.0), "rate must rise from point to point; got 0 after 0.1."),
]


@pytest.mark.parametrize(
    ("kind", "law", "words"),
    [
        *((TableSpring, {"travel": x, "force": f}, words) for x, f, words in SPRING_FAULTS),
        *((TableDamper, {"rate": x, "force": f}, words) for x, f, words in DAMPER_FAULTS),
        (BumpStop, {"travel": (0.0, 0.1), "force": (0.0, 1.0)}, "travel must begin with the clearance, above 0; got 0"),
    ],
)
def test_points_that_cannot_be_a_force_are_refused_in_one_message(
    kind: type[SuspensionElement], law: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValueError, match=re.escape(words.removesuffix("."))) as refused:
        with_one(kind, **law)
    assert str(refused.value).startswith("Vehicle BogieDynamics: added: ")
    assert str(refused.value).endswith(".")
    assert "\n" not in str(refused.value)


def test_a_stop_carries_nothing_and_a_spring_that_only_pushes_carries() -> None:
    place = "frame", "wheelset_1", (0.0, 0.0, 0.0), False, "vertical"
    assert not BumpStop("stop", *place, *STOP).carries
    assert TableSpring("pushing", *place, (-0.1, 0.0, 0.1), (-1e4, 0.0, 0.0)).carries
    assert not TableSpring("pulling", *place, (-0.1, 0.0, 0.1), (0.0, 0.0, 1e4)).carries
    assert not TableSpring("aside", *place[:-1], "lateral", *PROGRESSIVE).carries
