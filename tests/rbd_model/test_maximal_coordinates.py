"""Level 3 at contact depth 2, which runs by default, against an oracle in maximal coordinates that shares nothing.

The oracle has an inertial frame, a potential that is differenced for each connection, surfaces that are searched for
contacts, and laws of its own. It is compared twice: with two simplifications of the fast model taken over, Hertz by
polynomials and curvatures of a wheel that is square to its rail, to what half a micrometre makes; and without them.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from rbd_model.vehicle import Connection, Vehicle
from rbd_model.vehicles import passenger_coach, two_axle_bogie
from tests.maximal import oracle as oracles
from tests.maximal.correspondence import bodies_of, rates_of
from tests.maximal.hertz import by_polynomials
from tests.maximal.joints import STEP, Carriers, Ends, on_bodies, wrenches
from tests.maximal.machine import Answer, Machine
from tests.maximal.oracle import Oracle
from tests.maximal.rails import STRAIGHT, Course, prisms, swept
from tests.maximal.states import Snapshot, random_course, random_state

VEHICLES: dict[str, Callable[[], Vehicle]] = {"bogie": two_axle_bogie, "coach": passenger_coach}
#: Grids of the contacts [m], each half of the one before.
GRIDS = (0.1e-3, 0.05e-3, 0.025e-3)
#: Of the largest acceleration. Bodies see connections alone, differenced over 10 um: 2e-9 of a force; measured 6e-10.
BODY_BAND = 3e-9
#: Of the largest acceleration and wheel load, with both simplifications; measured 3.1e-4. The grid errs by 2e-5. The
#: rest is the place of a flange contact, half a micrometre, where the spline through the gauge corner changes its
#: curvature by 1 % in a micrometre.
PLACE_BAND = 4e-4
#: Without them: polynomials for Hertz, 2e-4 on treads. Flange ellipses are 17 times as long as broad, and count as
#: 10.5; measured 1.2e-2.
EXACT_TREAD_BAND, EXACT_BAND = 3e-4, 2e-2
#: On rails that are swept along the line; measured 7.8e-3. On a ramp a wheel slides up or down its rail by the slope,
#: which a prism does not have: a lateral creepage of 3e-4 on a flange makes 4.5e-3.
SWEPT_BAND = 1e-2
#: Steps of displacements by which connections are differenced [m], [rad]; what that errs by, of the largest force.
STEPS, STEP_BAND = (4e-3, 2e-3, 1e-3), 1e-8
#: Least share by which the error of the grid falls when it is halved: 4 is the second order.
ORDER = 3.0
#: Places and angles against velocities [m/s], [rad/s]: what is left of differences over 1e-6 s.
KINEMATIC = 1e-8
#: States of each vehicle on straight track and as many on lines: at once, and in the long form.
FEW, MANY = 1, 50


@cache
def machine(name: str, on_line: bool) -> Machine:
    return Machine(VEHICLES[name](), on_line)


@cache
def base(name: str) -> float:
    with TemporaryDirectory() as folder:
        return machine(name, False).base(Path(folder))


def oracle(name: str, course: Course, rails: Callable = prisms, **changes: object) -> Oracle:  # type: ignore[type-arg]
    return machine(name, course is not STRAIGHT).oracle(course, base(name), rails, **changes)


def as_shipped(name: str, course: Course, **changes: object) -> Oracle:
    """The oracle with the two simplifications of the fast model."""
    return oracle(name, course, hertz=by_polynomials(), square=True, **changes)


@cache
def snapshot(name: str, on_line: bool, seed: int, rails: Callable = prisms) -> Snapshot:  # type: ignore[type-arg]
    """A random state; with other rails the same, but for the micrometres by which its wheelsets lie on them."""
    rng = Random(f"{name} {on_line} {seed}")
    course = random_course(rng) if on_line else STRAIGHT
    return random_state(VEHICLES[name](), oracle(name, course, rails), course, machine(name, on_line).names, rng)


@cache
def answered(name: str, on_line: bool, seed: int) -> Answer:
    with TemporaryDirectory() as folder:
        return machine(name, on_line).answer(snapshot(name, on_line, seed), Path(folder))


@dataclass(frozen=True)
class Differences:
    """Largest differences as shares of the largest acceleration and the largest wheel load; places: see KINEMATIC."""

    bodies: float
    wheelsets: float
    treads: float
    forces: float
    places: float


def differences(
    vehicle: Vehicle, asked: Oracle, at: Snapshot, answer: Answer, beside: Snapshot | None = None
) -> Differences:
    """Between the fast model's answer at a state and the oracle there, or at the one beside it."""
    there = beside or at
    accelerations, wheels, below = asked.answer(bodies_of(vehicle, at.course, there.value), at.scene, there.value)
    rates = rates_of(vehicle, at.course, at.value, answer.slope)
    away = {name: rates[name].acceleration - accelerations[name] for name in accelerations}
    largest = max(np.max(np.abs(one)) for one in accelerations.values())
    load = max(one.force[2] for one in wheels.values())
    forces, treads = [], [0.0]
    for (number, side), wheel in wheels.items():
        found = float(np.max(np.abs(answer.forces[number, side] - wheel.force[1:]))) / load
        forces.append(found)
        if not wheel.flange:
            treads.append(found)
    for number, _ in vehicle.numbered:
        pair = wheels[number, 1], wheels[number, -1]
        axle = np.array([sum(one.creep_along for one in pair), sum(one.flange for one in pair)])
        forces.append(float(np.max(np.abs(answer.forces[number, 0] - axle))) / load)
    for number, moving in answer.rails.items():
        forces.append(float(np.max(np.abs(moving - below[number]))) / load)
    bodies = {body.name for body in vehicle.bodies}
    return Differences(
        max(float(np.max(np.abs(away[name]))) for name in bodies) / largest,
        max(float(np.max(np.abs(away[name]))) for name in away.keys() - bodies) / largest,
        max(treads),
        max(forces),
        max(float(np.max(np.abs(rate.kinematic))) for rate in rates.values()),
    )


def compare(name: str, on_line: bool, seed: int, grid: float) -> None:
    """One state of the fast model against its oracle."""
    at, answer = snapshot(name, on_line, seed), answered(name, on_line, seed)
    vehicle = VEHICLES[name]()
    found = differences(vehicle, as_shipped(name, at.course, grid=grid), at, answer)
    assert found.bodies < BODY_BAND, (seed, found)
    assert max(found.wheelsets, found.forces) < PLACE_BAND, (seed, found)
    assert found.places < KINEMATIC, (seed, found)
    exact = differences(vehicle, oracle(name, at.course, grid=grid), at, answer)
    assert exact.treads < EXACT_TREAD_BAND, (seed, exact)
    assert max(exact.wheelsets, exact.forces) < EXACT_BAND, (seed, exact)


@pytest.mark.parametrize("on_line", [False, True])
def test_accelerations_and_wheel_forces_are_those_of_maximal_coordinates(on_line: bool) -> None:
    for seed in range(FEW):
        compare("bogie", on_line, seed, GRIDS[-1])


@pytest.mark.long
@pytest.mark.parametrize("on_line", [False, True])
@pytest.mark.parametrize("name", VEHICLES)
def test_they_are_at_many_states_of_bogie_and_coach(name: str, on_line: bool) -> None:
    for seed in range(MANY):
        compare(name, on_line, seed, GRIDS[-1])


def flanging(name: str, on_line: bool) -> int:
    """The first state in which a flange bears, which asks most of a grid."""
    return next(seed for seed in range(MANY) if answered(name, on_line, seed).forces[1, 0][1] != 0.0)


def test_error_of_the_grid_falls_with_the_square_of_its_pitch() -> None:
    """Of the oracle against itself, where a flange bears: forces of its wheels."""
    seed = flanging("bogie", False)
    at = snapshot("bogie", False, seed)
    bodies = bodies_of(VEHICLES["bogie"](), at.course, at.value)
    forces = []
    for grid in GRIDS:
        wheels = as_shipped("bogie", at.course, grid=grid).answer(bodies, at.scene, at.value)[1]
        forces.append(np.array([one.force for one in wheels.values()]))
    coarse, fine = (np.max(np.abs(forces[i] - forces[i + 1])) for i in (0, 1))
    assert coarse > ORDER * fine
    assert fine > 0.0


@pytest.mark.long
@pytest.mark.parametrize("name", VEHICLES)
def test_wheels_meet_rails_that_are_swept_along_the_line_as_they_meet_prisms(name: str) -> None:
    """On rails that are what they are wherever the wheelset is, at the same pressures: micrometres beside the state.

    The wheels of a yawed wheelset stand ahead of its middle and behind it, where a twisted track is higher or lower.
    """
    for seed in range(MANY):
        at, beside = snapshot(name, True, seed), snapshot(name, True, seed, swept)
        asked = oracle(name, at.course, swept, hertz=by_polynomials(), square=True, grid=GRIDS[-1])
        found = differences(VEHICLES[name](), asked, at, answered(name, True, seed), beside)
        assert max(found.bodies, found.wheelsets, found.forces) < SWEPT_BAND, (seed, found)


#: What of the package the oracle may read: data. Beside it stand the files that know what the fast model's states mean.
DATA = {"rbd_model.vehicle", "rbd_model.contact.profiles"}
ORACLE = ("hertz", "joints", "motion", "oracle", "rails", "slip", "statics", "touch")


@pytest.mark.parametrize("name", ORACLE)
def test_oracle_reads_data_and_no_equation(name: str) -> None:
    text = (Path(oracles.__file__).parent / f"{name}.py").read_text(encoding="utf-8")
    read = set(re.findall(r"^(?:from|import) ([\w.]+)", text, re.MULTILINE))
    own = {f"tests.maximal.{one}" for one in ORACLE}
    assert {one for one in read if one.split(".")[0] in ("rbd_model", "fmu_src", "scenarios", "casadi")} <= DATA
    assert {one for one in read if one.startswith("tests")} <= own


def test_error_of_a_differenced_connection_falls_with_the_square_of_its_step() -> None:
    at = snapshot("bogie", False, 0)
    one = oracle("bogie", at.course)
    bodies = bodies_of(one.vehicle, at.course, at.value)
    connection = one.vehicle.connections[0]
    ends = one.ends(connection, bodies)
    found = [wrenches(one.vehicle, connection, ends, on_bodies(ends), 0.0, {}, step) for step in STEPS]
    coarse, fine = (np.max(np.abs(found[i] - found[i + 1])) for i in (0, 1))
    assert coarse > ORDER * fine
    # At the step that is used, of the largest force.
    assert fine * (STEP / STEPS[1]) ** 2 < STEP_BAND * np.max(np.abs(found[-1]))


#: What the oracle must not do without, with one thing wrong in each.
WRONG: dict[str, Callable[[Oracle], Oracle]] = {
    "contact without damping": lambda one: with_parameter(one, "contact_damping", 0.0),
    "gravity by a thousandth": lambda one: with_parameter(one, "gravity", 1.001),
    "stiffer by a thousandth": lambda one: with_parameter(one, "lateral_stiffness", 1.001),
    "carried by the upper body": lambda one: replace(one, carriers=carried_by_the_upper_body),
}


def with_parameter(one: Oracle, name: str, factor: float) -> Oracle:
    parameters = replace(one.vehicle.parameters, **{name: factor * one.vehicle.number(name)})
    return replace(one, vehicle=replace(one.vehicle, parameters=parameters))


def carried_by_the_upper_body(connection: Connection, ends: Ends) -> Carriers:
    own = on_bodies(ends)
    return lambda upper, lower: replace(own(upper, lower), directions=upper.axes)


@pytest.mark.parametrize("wrong", WRONG)
def test_one_thing_wrong_in_the_oracle_shows(wrong: str) -> None:
    at = snapshot("bogie", False, 0)
    one = WRONG[wrong](as_shipped("bogie", at.course, grid=GRIDS[-1]))
    found = differences(one.vehicle, one, at, answered("bogie", False, 0))
    assert found.bodies > 10 * BODY_BAND or max(found.wheelsets, found.forces) > 2 * PLACE_BAND
