"""Composed systems have the equations of their parts. Parts that do not fit are refused."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from brake_controller.cylinder import timed_brake
from fmu_src.chain import Part
from fmu_src.compile import build_library
from fmu_src.compose import compose, scope
from fmu_src.elimination import elimination
from fmu_src.equations import functions
from fmu_src.kernel import Kernel, Library
from fmu_src.piecewise import interpolation
from fmu_src.system import System, Variable, model_of
from products.machine import coach, coach_brake, composed
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.ready import passenger_coach

#: Rounding errors of the same expressions in another order.
ROUND_OFF = 1e-12
RANDOM_STATES = 50


def square(name: str) -> Part:
    """Return x^2 and 2 x^2, for systems with calls."""
    x = ca.SX.sym("x")
    return Part(name, x, ca.SX(0, 1), ca.vertcat(x**2, 2 * x**2))


SQUARE = square("square")


def follower(unit: str = "m") -> System:
    """x' = gain (f(target) - x) by a table, a part and an intermediate variable; one output has direct feedthrough."""
    system = System("follower", "lag behind a target")
    target = system.input(Variable("target", "input", unit, "What it follows"))
    gain = system.parameter(Variable("gain", "parameter", "1", "Rate", 2.0))
    x = system.state("x", "m", gain / 10, 1.0)
    bent = system.table("bent", *interpolation([-9.0, 0.0, 9.0], [-9.0, 0.0, 18.0]), target)
    doubled = system.call(SQUARE, system.narrow(bent + x), ca.SX(0, 1))
    system.derivative(x, gain * (doubled[1] - x) + system.time)
    system.output(Variable("place", "output", "m", "Where it is"), x)
    system.output(Variable("wish", "output", "m", "What it wants to do next"), doubled[0])
    return system


def chain(**connections: str) -> System:
    """Return three connected followers; the last one has other names than the first two."""
    parts = [scope(follower(), after=f"_{n}") for n in (1, 2)] + [scope(follower(), "last_")]
    return compose("chain", "followers", parts, connections)


CHAIN = {"target_2": "wish_1", "last_target": "wish_2", "target_1": "last_place"}


def by_hand(x: np.ndarray, gains: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the slopes and wishes of the chain."""
    slopes, wishes, target = np.zeros(3), np.zeros(3), x[2]
    for n in range(3):
        bent = target if target < 0.0 else 2.0 * target
        wishes[n] = (bent + x[n]) ** 2
        slopes[n] = gains[n] * (2.0 * wishes[n] - x[n]) + time
        target = wishes[n]
    return slopes, wishes


def test_a_chain_with_a_ring_through_a_state_has_the_equations_of_its_parts() -> None:
    system = chain(**CHAIN)
    assert [variable.name for variable in system.variables if variable.causality == "input"] == []
    assert sorted(system.states) == ["last_x", "x_1", "x_2"]
    assert [call.rank for call in system.calls] == list(range(6))  # table and square of each
    kernel = Kernel(Library(build_library(model_of(system, 1e-9))), gain_1=1.0, gain_2=2.0, last_gain=3.0)
    kernel.initialise()
    rng = np.random.default_rng(1)
    for _ in range(RANDOM_STATES):
        x, time = rng.uniform(-0.4, 0.4, 3), float(rng.uniform(0.0, 2.0))
        slopes, wishes = by_hand(x, np.array([1.0, 2.0, 3.0]), time)
        found = np.array(kernel.slopes_at(time, x.tolist()))
        assert np.abs(found - slopes).max() < ROUND_OFF * np.abs(slopes).max()
        kernel.arrive(time, x.tolist())
        assert kernel["last_wish"] == pytest.approx(wishes[2], rel=ROUND_OFF)
        numeric = np.column_stack(
            [(by_hand(x + e, np.array([1.0, 2.0, 3.0]), time)[0] - slopes) / 1e-7 for e in 1e-7 * np.eye(3)]
        )
        assert np.abs(np.array(kernel.jacobian_at(time, x.tolist())) - numeric).max() < 1e-4 * (
            1 + np.abs(numeric).max()
        )


def test_parameters_of_one_name_are_one_parameter() -> None:
    parts = [scope(follower(), after=f"_{n}", common=["gain"]) for n in (1, 2)]
    system = compose("pair", "followers", parts, {"target_2": "place_1"})
    assert [v.name for v in system.variables if v.causality == "parameter"] == ["gain"]
    kernel = Kernel(Library(build_library(model_of(system, 1e-9))), gain=7.0, target_1=-0.5)
    kernel.initialise()
    assert [kernel["place_1"], kernel["place_2"]] == pytest.approx([0.7, 0.7], rel=ROUND_OFF)
    other = scope(follower(), after="_2", common=["gain"])
    other.variables = [v if v.name != "gain" else Variable("gain", "parameter", "m", "Rate") for v in other.variables]
    with pytest.raises(ValueError, match=r"gain is in 1 and, in follower, in m; give one of them a scope\.$"):
        compose("pair", "followers", [parts[0], other], {})


@pytest.mark.parametrize(
    ("connections", "words"),
    [
        ({"target_3": "wish_1"}, "no part has the input target_3; there are target_1, target_2, last_target"),
        ({"target_2": "dream_1"}, "no part has the output dream_1; there are place_1"),
        ({"target_1": "wish_2", "target_2": "wish_1"}, "wish_2 to target_1, wish_1 to target_2 depend on each other"),
    ],
)
def test_what_cannot_be_connected_is_one_sentence(connections: dict[str, str], words: str) -> None:
    with pytest.raises(ValueError, match=r"^chain: .*\.$") as error:
        chain(**connections)
    assert words in str(error.value)


def test_units_must_agree_and_names_must_differ() -> None:
    parts = [scope(follower(), "a_"), scope(follower("mm"), "b_")]
    with pytest.raises(ValueError, match="a_place cannot become b_target, they are in m and mm"):
        compose("pair", "followers", parts, {"b_target": "a_place"})
    with pytest.raises(ValueError, match="x is there twice among the states; give each part a scope"):
        compose("pair", "followers", [follower(), scope(follower(), "b_", common=["x"])], {})


@pytest.mark.study
def test_the_braked_vehicle_is_the_vehicle_under_the_torques_of_its_brakes() -> None:
    vehicle, parameters = passenger_coach(), coach_brake()
    whole = composed(coach(), planar_vehicle(vehicle))
    alone, brake = (
        Kernel(Library(build_library(model_of(one, 1e-6))))
        for one in (planar_vehicle(vehicle), timed_brake(parameters))
    )
    kernel = Kernel(Library(build_library(model_of(whole, 1e-6))))
    demands = dict(zip((1, 2, 3, 4), (100e3, 200e3, 300e3, 380e3), strict=True))
    kernel.set(initial_speed=20.0, **{f"pressure_demand_{n}": demand for n, demand in demands.items()})
    kernel.initialise()
    alone.set(initial_speed=20.0)
    for one in (alone, brake):
        one.initialise()
    rng = np.random.default_rng(2)
    states = np.array([kernel.linearise().state])[0]
    cylinders = len(states) - 4
    scale = np.array([state.nominal for state in whole.states.values()])
    for _ in range(RANDOM_STATES):
        place = states + 0.1 * scale * rng.standard_normal(states.size)
        place[cylinders:] = rng.uniform(10e3, 300e3, 4)
        torques, rates = {}, []
        for n, pressure in zip(demands, place[cylinders:], strict=True):
            brake.set(pressure_demand=demands[n])
            rates += brake.slopes_at(0.0, [pressure])
            brake.arrive(0.0, [pressure])
            torques[f"brake_torque_{n}"] = brake["brake_torque"]
        alone.set(**torques)
        expected = np.array([*alone.slopes_at(0.0, place[:cylinders].tolist()), *rates])
        found = np.array(kernel.slopes_at(0.0, place.tolist()))
        assert np.abs((found - expected) / scale).max() < ROUND_OFF * np.abs(expected / scale).max()


@pytest.mark.study
def test_composition_adds_no_code_to_the_parts() -> None:
    """Parts are called as before. The elimination uses the block structure: cylinders add few entries to its matrix."""
    vehicle, parameters = passenger_coach(), coach_brake()
    planar = planar_vehicle(vehicle)
    whole = composed(coach(), planar_vehicle(vehicle))
    sizes = [functions(one)["ode"].function.n_instructions() for one in (planar, whole)]
    made = functions(timed_brake(parameters))
    cylinder = sum(made[name].function.n_instructions() for name in ("ode", "output"))
    assert sizes[1] <= sizes[0] + 4 * cylinder
    fills = [sum(len(one) for one in elimination(system).below) for system in (planar, whole)]
    assert fills[1] <= fills[0] + 4 * len(planar.states)
