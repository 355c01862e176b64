"""Test a vehicle as data: descriptions that are refused, and each connection alone against a closed form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.description import (
    BumpStop,
    FrictionSlider,
    Pull,
    RigidBody,
    SeriesDamper,
    Springs,
    Sum,
    SuspensionElement,
    Torsion,
    Vehicle,
    size_of,
)
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie

#: Integration tolerance of the runs below, and their tolerance against a closed form.
TOLERANCE, CLOSED_FORM = 1e-9, 1e-6


# -- descriptions that are refused --------------------------------------------------------------------------------
# -----------------------------------------------------------------------------------------


def bogie_with(**changes: object) -> Vehicle:
    return replace(two_axle_bogie(), **changes)  # type: ignore[arg-type]


def connected_to_nothing() -> Vehicle:
    good = two_axle_bogie()
    return bogie_with(connections=(*good.connections, Torsion("bar", "frame", "bolster", (0.0, 0.0, 0.0), False)))


def without_mass() -> Vehicle:
    return bogie_with(bodies=(replace(two_axle_bogie().bodies[0], mass=0.0),))


def in_the_air() -> Vehicle:
    good = two_axle_bogie()
    return bogie_with(bodies=(*good.bodies, replace(good.bodies[0], name="body")))


def on_one_place() -> Vehicle:
    good = two_axle_bogie()
    return bogie_with(wheelsets=(good.wheelsets[0], good.wheelsets[0]))


def named_twice() -> Vehicle:
    good = two_axle_bogie()
    return bogie_with(connections=(*good.connections, good.connections[0]))


def of_unknown_size() -> Vehicle:
    return bogie_with(bodies=(replace(two_axle_bogie().bodies[0], mass="frame_weight"),))


def leaning_on_a_line() -> Vehicle:
    """Return a bogie that is free to roll, on springs at y = 0."""
    return bogie_with(
        connections=tuple(replace(one, place=(one.place[0], 0.0, 0.0)) for one in two_axle_bogie().connections)
    )


def hung_from_its_axle() -> Vehicle:
    """Return a bogie whose brake reacts on a wheelset, not on a body."""
    first, second = two_axle_bogie().wheelsets
    return bogie_with(wheelsets=(replace(first, reacts_on="wheelset_2"), second))


def with_one(kind: type[SuspensionElement], **law: object) -> Vehicle:
    good = two_axle_bogie()
    one = kind("added", "frame", "wheelset_1", (0.0, 0.0, 0.0), False, **law)
    return bogie_with(connections=(*good.connections, one))


def damper_without_damping() -> Vehicle:
    return with_one(SeriesDamper, stiffness=1e5)


def slider_without_mass() -> Vehicle:
    return with_one(FrictionSlider, stiffness=1e5, capacity=10.0)


def stop_with_one_point() -> Vehicle:
    return with_one(BumpStop, travel=(0.01,), force=(0.0,))


def stop_with_a_force_too_many() -> Vehicle:
    return with_one(BumpStop, travel=(0.01, 0.02), force=(0.0, 10.0, 20.0))


def stop_that_goes_back() -> Vehicle:
    return with_one(BumpStop, travel=(0.02, 0.01), force=(0.0, 10.0))


def stop_that_begins_with_a_jump() -> Vehicle:
    return with_one(BumpStop, travel=(0.01, 0.02), force=(5.0, 10.0))


def spring_to_the_side() -> Vehicle:
    return with_one(SeriesDamper, direction="sideways", stiffness=1e5, damping=1.0)


def bar_about_no_axis() -> Vehicle:
    return with_one(Torsion, angle="lateral", stiffness=1e5)


def link_between_wheelsets() -> Vehicle:
    good = two_axle_bogie()
    link = Springs("link", "wheelset_1", "wheelset_2", (0.0, 0.0, 0.0), False, (1e6, 0.0, 0.0))
    return bogie_with(connections=(*good.connections, link))


def bar_about_an_axle() -> Vehicle:
    return with_one(Torsion, angle="pitch", stiffness=1e5)


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (link_between_wheelsets, ["link joins wheelset_1 and wheelset_2", "a body at one end"]),
        (bar_about_an_axle, ["added twists about the axle of wheelset_1", "another angle"]),
        (hung_from_its_axle, ["wheelset_1, which reacts on a body, names wheelset_2", "there are frame"]),
        (damper_without_damping, ["added has a series damping of 0", "above 0"]),
        (slider_without_mass, ["added has a slider mass of 0", "above 0"]),
        (stop_with_one_point, ["added: travel and force must have at least 2 points", "got 1 and 1"]),
        (stop_with_a_force_too_many, ["added: travel and force must have", "got 2 and 3"]),
        (stop_that_goes_back, ["added: travel must rise from point to point; got 0.01 after 0.02"]),
        (stop_that_begins_with_a_jump, ["added: force must be 0 at the first travel; got 5 N"]),
        (spring_to_the_side, ["added has the direction sideways", "longitudinal, lateral, vertical"]),
        (bar_about_no_axis, ["added has the angle lateral", "roll, pitch, yaw"]),
        (connected_to_nothing, ["the connection bar names bolster, which is not there"]),
        (without_mass, ["frame has a mass of 0", "above 0"]),
        (in_the_air, ["nothing carries body"]),
        (on_one_place, ["wheelset_2 is at 0.8375 m, not behind wheelset_1"]),
        (named_twice, ["guidance_1 is there 2 times"]),
        (of_unknown_size, ["frame_weight", "no parameter"]),
        (leaning_on_a_line, ["frame", "springs"]),
    ],
)
def test_a_vehicle_that_cannot_be_built_is_one_sentence_that_names_it(build, words: list[str]) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ValueError, match=r"^Vehicle BogieDynamics: .*\.$") as error:
        build()
    for word in words:
        assert word in str(error.value)


def test_sizes_are_sums_of_parameters() -> None:
    half = Sum((("wheel_base", 0.5),))
    assert [wheelset.along for wheelset in two_axle_bogie().wheelsets] == [half, -half]
    size = (half - 1.0 + "wheel_base") * 2.0
    assert size_of(size, {"wheel_base": 3.0}) == 7.0
    assert size_of(2, {}) == 2.0


# -- each connection alone ----------------------------------------------------------------------------------------

#: Blocks of 1000 kg that slide on the locked bogie at the height of its centre, each on one connection.
MASS, STIFFNESS, SPRING_DAMPING, DAMPING, CAPACITY, SLIDER = 1000.0, 1e5, 4e3, 2e4, 500.0, 10.0
BLOCKS = ("spring", "stop", "damper", "wedge")
TRAVEL, FORCE = (0.010, 0.020, 0.030), (0.0, 1000.0, 4000.0)
HELD = frozenset({"lateral", "bounce", "roll", "pitch", "yaw"})
AT = (0.0, 0.0, "frame_height")


def blocks() -> tuple[list[RigidBody], list[SuspensionElement], list[Pull]]:
    """Return blocks: on a spring with a damper, on the stop with a damper, on a series damper, and on the wedge."""
    inertia = (1.0, 1.0, 1.0)
    bodies = [RigidBody(name, name, MASS, inertia, 0.0, "frame_height", HELD) for name in BLOCKS]  # type: ignore[arg-type]
    ends = {name: (name, "frame", AT, False) for name in BLOCKS}
    connections = [
        Springs("spring_law", *ends["spring"], (STIFFNESS, 0.0, 0.0), (SPRING_DAMPING, 0.0, 0.0)),
        BumpStop("stop_law", *ends["stop"], "longitudinal", TRAVEL, FORCE),
        Springs("beside_stop", *ends["stop"], (0.0, 0.0, 0.0), (DAMPING, 0.0, 0.0)),
        SeriesDamper("damper_law", *ends["damper"], "longitudinal", STIFFNESS, DAMPING),
        FrictionSlider("wedge_law", *ends["wedge"], "longitudinal", STIFFNESS, DAMPING, CAPACITY, SLIDER),
    ]
    return bodies, connections, [Pull(f"force_{name}", f"Force on {name}", name, AT) for name in BLOCKS]


ENERGIES = ["kinetic_energy", "potential_energy"]
POWERS = ["brake_power", "creep_power", "damping_power"]


@pytest.fixture(scope="module")
def bench() -> Library:
    bodies, connections, pulls = blocks()
    good = two_axle_bogie()
    vehicle = bogie_with(
        bodies=(*good.bodies, *bodies), connections=(*good.connections, *connections), pulls=tuple(pulls)
    )
    system = planar_vehicle(vehicle).with_integrals(POWERS).with_outputs(ENERGIES)
    return Library(build_library(model_of(system, TOLERANCE)))


def standing(bench: Library, **values: float) -> Kernel:
    """Return a kernel with a frame that does not move: locked wheels, 1e6 times the mass, 1e3 times the stiffness."""
    locked = {"brake_torque_1": 1e9, "brake_torque_2": 1e9, "initial_speed": 0.0, "friction_1": 2.0, "friction_2": 2.0}
    heavy = {"frame_mass": 6e10, "longitudinal_stiffness": 9.5e12, "vertical_stiffness": 3.5e12}
    kernel = Kernel(bench, **locked, **heavy, **values)
    kernel.initialise()
    return kernel


def way(kernel: Kernel, name: str) -> float:
    return kernel[f"state_{name}_shift"]


@pytest.mark.study
def test_spring_and_damper_oscillate_as_one_degree_of_freedom(bench: Library) -> None:
    force, time = 1000.0, 0.3
    kernel = standing(bench, force_spring=force)
    kernel.advance(time)
    decay = SPRING_DAMPING / (2 * MASS)
    root = math.sqrt(STIFFNESS / MASS - decay**2)
    swing = math.exp(-decay * time) * (math.cos(root * time) + decay / root * math.sin(root * time))
    assert way(kernel, "spring") == pytest.approx(force / STIFFNESS * (1 - swing), rel=CLOSED_FORM)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("force", "travel"), [(500.0, 0.015), (1000.0, 0.020), (2500.0, 0.025), (10000.0, 0.050)])
def test_bump_stop_rests_where_its_lines_carry_the_force(
    bench: Library, sign: float, force: float, travel: float
) -> None:
    """The last slope, 3e5 N/m, applies beyond the last point."""
    kernel = standing(bench, force_stop=sign * force)
    kernel.advance(20.0)
    assert way(kernel, "stop") == pytest.approx(sign * travel, rel=CLOSED_FORM)


def test_bump_stop_is_not_felt_within_its_clearance(bench: Library) -> None:
    """A force that only the damper resists over 5 mm: F t / c."""
    kernel = standing(bench, force_stop=100.0)
    kernel.advance(1.0)
    expected = 100.0 / DAMPING * (1.0 - MASS / DAMPING * (1 - math.exp(-DAMPING / MASS)))
    assert way(kernel, "stop") == pytest.approx(expected, rel=CLOSED_FORM)


def test_series_damper_creeps_at_its_speed_and_keeps_its_springs_way(bench: Library) -> None:
    """After the oscillation has decayed: speed F / c, and F / k ahead of the damper."""
    kernel = standing(bench, force_damper=1000.0)
    kernel.advance(8.0)
    ahead = way(kernel, "damper") - kernel["state_damper_law_travel"]
    assert kernel["state_damper_shift_speed"] == pytest.approx(1000.0 / DAMPING, rel=CLOSED_FORM)
    assert ahead == pytest.approx(1000.0 / STIFFNESS, rel=CLOSED_FORM)


def test_friction_slider_sticks_below_its_capacity_and_slides_above(bench: Library) -> None:
    """Stuck, it is only its spring, with a velocity of exactly 0; beyond the capacity the block accelerates freely."""
    stuck = standing(bench, force_wedge=0.4 * CAPACITY)
    stuck.advance(5.0)
    assert stuck["state_wedge_law_travel_rate"] == 0.0
    assert stuck["state_wedge_law_travel"] == 0.0
    assert way(stuck, "wedge") == pytest.approx(0.4 * CAPACITY / STIFFNESS, rel=CLOSED_FORM)
    sliding = standing(bench, force_wedge=2.0 * CAPACITY)
    sliding.advance(2.0)
    before = sliding["state_wedge_shift_speed"]
    sliding.advance(1.0)
    free = (2.0 * CAPACITY - CAPACITY) / (MASS + SLIDER)
    assert sliding["state_wedge_shift_speed"] - before == pytest.approx(free, rel=CLOSED_FORM)
    assert any("wedge_law slides again" in line for line in sliding.messages)


def test_each_connection_closes_its_energy(bench: Library) -> None:
    """Pulled, then released: stored and kinetic energy is dissipated in dampers and friction."""
    forces = {f"force_{name}": 2000.0 for name in BLOCKS}
    kernel = standing(bench, **forces)
    kernel.advance(0.2)
    kernel.set(**dict.fromkeys(forces, 0.0))
    before = measured(kernel)
    kernel.advance(3.0)
    after = measured(kernel)
    lost = sum(before[name] - after[name] for name in ENERGIES)
    work = sum(after[f"integral_{name}"] - before[f"integral_{name}"] for name in POWERS)
    assert lost > 50.0
    # The sums include the weight of the frame, 6e10 kg: round-off of its height is 1e-8 of the loss.
    assert work == pytest.approx(lost, rel=1e-5)
    assert 1.001 * work != pytest.approx(lost, rel=1e-5)


def measured(kernel: Kernel) -> Mapping[str, float]:
    return {name: kernel[name] for name in (*ENERGIES, *(f"integral_{power}" for power in POWERS))}


@pytest.mark.study
def test_torsion_turns_both_ends_by_hookes_law() -> None:
    """A beam that pitches on the heavy frame by a torsion spring only: sqrt(k / I)."""
    stiffness, inertia = 5e5, 100.0
    good = two_axle_bogie(replace(tables_5_1_and_5_2(), frame_mass=6e10, frame_pitch_inertia=6e10))
    beam = RigidBody("beam", "beam", MASS, (1.0, inertia, 1.0), 0.0, "frame_height", HELD - {"pitch"})
    upright = Springs("beam_guide", "beam", "frame", AT, False, (1e8, 0.0, 0.0), (0.0, 0.0, 0.0))
    bar = Torsion("bar", "beam", "frame", AT, False, "pitch", stiffness)
    vehicle = replace(good, bodies=(*good.bodies, beam), connections=(*good.connections, upright, bar))
    kernel = Kernel(Library(build_library(model_of(planar_vehicle(vehicle), TOLERANCE))), initial_speed=0.0)
    kernel.initialise()
    matrix = np.array(kernel.linearise().jacobian)
    values = np.linalg.eigvals(matrix).imag
    assert np.min(np.abs(values - math.sqrt(stiffness / inertia))) < CLOSED_FORM * math.sqrt(stiffness / inertia)
