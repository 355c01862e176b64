"""Compare level 3 with contact model 2 (the default) with an independent oracle in maximal coordinates.

The oracle uses an inertial frame, a potential per connection that is differentiated numerically, a search of the
surfaces for contacts, and laws of its own. On a line its rails are the contour swept along the line. It is compared
twice: with one simplification of the fast model (curvatures of a wheel that is square to its rail), and without it.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cache
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

from rbd_model.vehicle.description import Springs, SuspensionElement, Vehicle
from rbd_model.vehicle.ready import passenger_coach, two_axle_bogie
from tests.evidence.maximal import joints
from tests.evidence.maximal import oracle as oracles
from tests.evidence.maximal.correspondence import bodies_of, rates_of
from tests.evidence.maximal.joints import STEP, Carriers, Ends, on_bodies, wrenches
from tests.evidence.maximal.machine import Answer, Machine
from tests.evidence.maximal.motion import Moving
from tests.evidence.maximal.oracle import Oracle
from tests.evidence.maximal.rails import STRAIGHT, Course, prisms, swept
from tests.evidence.maximal.states import Snapshot, random_course, random_state

VEHICLES: dict[str, Callable[[], Vehicle]] = {"bogie": two_axle_bogie, "coach": passenger_coach}
#: Grid pitches of the contact search [m], each half of the previous one.
GRIDS = (0.1e-3, 0.05e-3, 0.025e-3)
#: Tolerance of body accelerations, as a share of the largest acceleration. Only connections act on bodies. Their
#: differences over 10 um have a relative error of 2e-9; measured 6e-10.
BODY_BAND = 3e-9
#: Tolerances with the simplification, as shares of the largest wheel load and acceleration. Treads: polynomials for
#: Hertz' theory have an error of 2e-4; measured 2.5e-4. All forces: a table holds a contact on level rails. A roll of
#: some milliradians turns the parabola of a flange on the joint of its fillet; measured 1.6e-2 with a loaded flange and
#: 4e-4 without. Wheelsets: measured 5.5e-3. A ramp also turns a wheelset about the vertical.
TREAD_BAND, SQUARE_BAND, WHEELSET_BAND = 3e-4, 2e-2, 8e-3
#: Tolerance without the simplification; measured 1.5e-2. A flange yawed by 9 mrad is 1.5 % flatter along the rail than
#: one that is square to it.
EXACT_BAND = 2e-2
#: Steps of the displacements by which connections are differentiated [m], [rad], and the tolerance of these
#: differences, as a share of the largest force.
STEPS, STEP_BAND = (4e-3, 2e-3, 1e-3), 1e-8
#: Smallest ratio of the grid errors when the pitch is halved; second order gives 4, first order 2. The ends of an
#: overlap lie between places.
ORDER = 2.5
#: Tolerance of the rates of positions and angles against velocities [m/s], [rad/s]: the error of differences over 1e-6
#: s.
KINEMATIC = 1e-8
#: Number of states of each vehicle on straight track, and as many on lines: in the short and in the long run.
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


@cache
def snapshot(name: str, on_line: bool, seed: int, rails: Callable = prisms) -> Snapshot:  # type: ignore[type-arg]
    """Return a random state. Other rails give the same state, but wheelsets lie on them micrometres higher or lower."""
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
    """Return the differences between the fast model at a state and the oracle there, or at the state `beside`."""
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


def found_at(name: str, on_line: bool, seed: int, **changes: object) -> Differences:
    """Return the differences between the fast model and its oracle at one state.

    On a line the wheelsets of the oracle lie some micrometres away from those of the fast model, at the same pressures.
    The wheels of a yawed wheelset are ahead of its middle and behind it, where a twisted track is higher or lower.
    Bodies do not depend on rails and are compared at the fast model's own state.
    """
    at, answer, vehicle = snapshot(name, on_line, seed), answered(name, on_line, seed), VEHICLES[name]()
    rails = swept if on_line else prisms
    there = snapshot(name, on_line, seed, rails)
    found = differences(vehicle, oracle(name, at.course, rails, **changes), at, answer, there)
    if there is at:
        return found
    same = differences(vehicle, oracle(name, at.course, **changes), at, answer)
    return replace(found, bodies=same.bodies)


def compare(name: str, on_line: bool, seed: int) -> None:
    """Compare one state of the fast model with its oracle, with the simplification and without it."""
    found = found_at(name, on_line, seed, square=True, grid=GRIDS[-1])
    assert found.bodies < BODY_BAND, (seed, found)
    assert found.treads < TREAD_BAND, (seed, found)
    assert found.forces < SQUARE_BAND, (seed, found)
    assert found.wheelsets < WHEELSET_BAND, (seed, found)
    assert found.places < KINEMATIC, (seed, found)
    exact = found_at(name, on_line, seed, grid=GRIDS[-1])
    assert exact.treads < TREAD_BAND, (seed, exact)
    assert max(exact.wheelsets, exact.forces) < EXACT_BAND, (seed, exact)


@pytest.mark.study
@pytest.mark.parametrize("on_line", [False, True])
def test_accelerations_and_wheel_forces_are_those_of_maximal_coordinates(on_line: bool) -> None:
    for seed in range(FEW):
        compare("bogie", on_line, seed)


@pytest.mark.long
@pytest.mark.parametrize("on_line", [False, True])
@pytest.mark.parametrize("name", VEHICLES)
def test_they_are_at_many_states_of_bogie_and_coach(name: str, on_line: bool) -> None:
    for seed in range(MANY):
        compare(name, on_line, seed)


def flanging(name: str, on_line: bool) -> int:
    """Return the first state with a loaded flange, the case that needs the finest grid."""
    return next(seed for seed in range(MANY) if answered(name, on_line, seed).forces[1, 0][1] != 0.0)


@pytest.mark.study
def test_error_of_the_grid_falls_with_the_square_of_its_pitch() -> None:
    """Compare wheel forces of the oracle on two grids with those on the next finer one, with a loaded flange."""
    seed = flanging("bogie", False)
    at = snapshot("bogie", False, seed)
    bodies = bodies_of(VEHICLES["bogie"](), at.course, at.value)
    forces = []
    for grid in GRIDS:
        wheels = oracle("bogie", at.course, grid=grid).answer(bodies, at.scene, at.value)[1]
        forces.append(np.array([one.force for one in wheels.values()]))
    coarse, fine = (np.max(np.abs(forces[i] - forces[i + 1])) for i in (0, 1))
    assert coarse > ORDER * fine
    assert fine > 0.0


#: Package modules that the oracle may import: they hold data. Files outside ORACLE translate the fast model's states.
DATA = {"rbd_model.vehicle.description", "rbd_model.contact.profiles"}
ORACLE = ("hertz", "joints", "motion", "oracle", "overlap", "rails", "slip", "statics", "touch")


@pytest.mark.parametrize("name", ORACLE)
def test_oracle_reads_data_and_no_equation(name: str) -> None:
    text = (Path(oracles.__file__).parent / f"{name}.py").read_text(encoding="utf-8")
    read = set(re.findall(r"^(?:from|import) ([\w.]+)", text, re.MULTILINE))
    own = {f"tests.evidence.maximal.{one}" for one in ORACLE}
    assert {one for one in read if one.split(".")[0] in ("rbd_model", "fmu_src", "scenarios", "casadi")} <= DATA
    assert {one for one in read if one.startswith("tests")} <= own


@pytest.mark.study
def test_error_of_a_differenced_connection_falls_with_the_square_of_its_step() -> None:
    at = snapshot("bogie", False, 0)
    one = oracle("bogie", at.course)
    bodies = bodies_of(one.vehicle, at.course, at.value)
    connection = one.vehicle.connections[0]
    ends = one.ends(connection, bodies)
    found = [wrenches(one.vehicle, connection, ends, on_bodies(ends), 0.0, {}, step) for step in STEPS]
    coarse, fine = (np.max(np.abs(found[i] - found[i + 1])) for i in (0, 1))
    assert coarse > ORDER * fine
    # The error at the step in use, as a share of the largest force.
    assert fine * (STEP / STEPS[1]) ** 2 < STEP_BAND * np.max(np.abs(found[-1]))


#: Faults of the oracle, each of which the comparison must detect: whether it runs on a line, and how to introduce the
#: fault.
WRONG: dict[str, tuple[bool, Callable[[Oracle], Oracle]]] = {
    "contact without damping": (False, lambda one: with_parameter(one, "contact_damping", 0.0)),
    "gravity by a thousandth": (False, lambda one: with_parameter(one, "gravity", 1.001)),
    "stiffer by a thousandth": (False, lambda one: with_parameter(one, "lateral_stiffness", 1.001)),
    "carried by the upper body": (False, lambda one: replace(one, carriers=carried_by_the_upper_body)),
    "springs 1 mm higher": (False, lambda one: with_springs_higher(one, 1e-3)),
    "dampers without moment": (False, lambda one: of_kind(DampersWithoutMoment, one)),
    "wheelsets without gyroscopic moment": (False, lambda one: of_kind(WithoutGyroscope, one)),
    "no centrifugal force": (True, lambda one: of_kind(WithoutCentrifugal, one)),
    "no rate of cant": (True, lambda one: of_kind(WithoutRateOfCant, one)),
}


def with_parameter(one: Oracle, name: str, factor: float) -> Oracle:
    parameters = replace(one.vehicle.parameters, **{name: factor * one.vehicle.number(name)})
    return replace(one, vehicle=replace(one.vehicle, parameters=parameters))


def carried_by_the_upper_body(connection: SuspensionElement, ends: Ends) -> Carriers:
    own = on_bodies(ends)
    return lambda upper, lower: replace(own(upper, lower), directions=upper.axes)


def with_springs_higher(one: Oracle, way: float) -> Oracle:
    def higher(connection: SuspensionElement) -> SuspensionElement:
        if not isinstance(connection, Springs):
            return connection
        x, y, z = connection.place
        return replace(connection, place=(x, y, one.vehicle.number(z) + way))

    connections = tuple(higher(connection) for connection in one.vehicle.connections)
    return replace(one, vehicle=replace(one.vehicle, connections=connections))


def of_kind(kind: type[Oracle], one: Oracle) -> Oracle:
    return kind(**{entry.name: getattr(one, entry.name) for entry in fields(one) if entry.init})


class DampersWithoutMoment(Oracle):
    """Apply each damper force at the centres of both bodies."""

    def answer(self, *given: Any) -> Any:
        right = joints.wrenches_of

        def wrong(stretch: joints.Stretch, law: joints.Law, ends: Ends, step: float) -> np.ndarray:
            alone = right(stretch, joints.Law(law.potential), ends, step)
            damped = right(stretch, law, ends, step) - alone
            return alone + damped * np.tile([1, 1, 1, 0, 0, 0], 2)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(joints, "wrenches_of", wrong)
            return super().answer(*given)


class WithoutGyroscope(Oracle):
    """Omit the gyroscopic moment of a wheelset's own spin."""

    def acceleration(self, name: str, body: Moving, wrench: np.ndarray) -> np.ndarray:
        found = super().acceleration(name, body, wrench)
        if name in self.wheelsets:
            inertia = [self.vehicle.number(size) for size in self.vehicle.wheelsets[0].inertia]
            tensor = body.axes @ np.diag(inertia) @ body.axes.T
            found[3:] += np.linalg.solve(tensor, np.cross(body.rate, tensor @ body.rate))
        return found


class WithoutCentrifugal(Oracle):
    """Omit the acceleration due to the rotation of the track axes that move with a body."""

    kept = np.array([1.0, 1.0, 1.0])

    def acceleration(self, name: str, body: Moving, wrench: np.ndarray) -> np.ndarray:
        found = super().acceleration(name, body, wrench)
        axes, step = self.track(body.position), 1e-3
        ahead, behind = (self.track(body.position + sign * step * axes[:, 0]) for sign in (1, -1))
        turning = axes.T @ (ahead - behind) / (2 * step)
        spin = axes @ (self.kept * [turning[2, 1], turning[0, 2], turning[1, 0]]) * (axes[:, 0] @ body.velocity)
        found[:3] += np.cross(spin, body.velocity)
        return found


class WithoutRateOfCant(WithoutCentrifugal):
    """Omit the acceleration due to the roll rate of the track axes."""

    kept = np.array([1.0, 0.0, 0.0])


def on_ramp() -> int:
    """Return the first state of the bogie in which cant changes."""
    return next(seed for seed in range(MANY) if snapshot("bogie", True, seed).course.roll[1] != 0.0)


@pytest.mark.study
@pytest.mark.parametrize("wrong", WRONG)
def test_one_thing_wrong_in_the_oracle_shows(wrong: str) -> None:
    """On a line only bodies are compared, because sloping rails are not prisms."""
    on_line, change = WRONG[wrong]
    seed = on_ramp() if on_line else 0
    at = snapshot("bogie", on_line, seed)
    one = change(oracle("bogie", at.course, square=True, grid=GRIDS[-1]))
    found = differences(one.vehicle, one, at, answered("bogie", on_line, seed))
    if found.bodies < 10 * BODY_BAND:
        assert not on_line
        right = found_at("bogie", on_line, seed, square=True, grid=GRIDS[-1])
        assert found.treads > 10 * TREAD_BAND or found.wheelsets > 2 * right.wheelsets
