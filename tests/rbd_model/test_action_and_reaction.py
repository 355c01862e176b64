"""Test the forces of connections on the bodies they join, with properties that are valid for any spring law.

An isolated vehicle keeps its linear and angular momentum (Newton's third law in its strong form). The power of its
connections is the decrease of their potential less their losses. No test depends on the definition of an elongation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np
import pytest

from rbd_model.body.bodies import angle_rates
from rbd_model.body.connections import connect
from rbd_model.body.effect import Load
from rbd_model.body.kinematics import Body, pitch_rotation, yaw_roll
from rbd_model.body.loads import Loads
from rbd_model.body.relation import End
from rbd_model.vehicle.assembly import Assembly, assemble
from rbd_model.vehicle.description import (
    BumpStop,
    ForceLaw,
    FrictionSlider,
    SeriesDamper,
    Springs,
    TableDamper,
    TableSpring,
    Torsion,
)
from rbd_model.vehicle.ready import passenger_coach

#: Tolerance of sums that cancel, as a share of their largest term.
ROUND_OFF = 1e-10
#: Tolerance of a rate by differences over 1e-6 s to both sides, as a share of the powers in it.
DIFFERENCED = 1e-6

PLACE = (1.1, 0.7, 0.2)
FRAME, AXLE = ("body", "front_frame"), ("front_frame", "wheelset_1")
BETWEEN = {"bodies": FRAME, "box_below": AXLE, "box_above": ("wheelset_1", "front_frame")}


def own_force(travel: ca.SX, rate: ca.SX, stiffness: ca.SX, radius: ca.SX) -> ca.SX:
    """Return a progressive spring beside a damper that saturates and is stiffer when the spring is."""
    return stiffness * travel * (1 + (travel / radius) ** 2) + 1e4 * (1 + travel**2) * ca.tanh(rate / 0.1)


LAWS = {
    "springs": (Springs, {"stiffness": (3e6, 2e6, 1e6), "damping": (3e4, 2e4, 1e4)}),
    "one_spring": (Springs, {"both_sides": False, "stiffness": (0.0, 2e6, 0.0), "damping": (0.0, 0.0, 1e4)}),
    "inclined": (Springs, {"stiffness": (3e6, 2e6, 0.0), "damping": (3e4, 0.0, 0.0), "inclination": 0.3}),
    "traction_rod": (Springs, {"both_sides": False, "stiffness": (5e6, 0.0, 0.0), "damping": (25e3, 0.0, 0.0)}),
    "roll": (Torsion, {"angle": "roll", "stiffness": 1e6, "damping": 1e4}),
    "pitch": (Torsion, {"angle": "pitch", "stiffness": 1e6, "damping": 1e4}),
    "yaw": (Torsion, {"angle": "yaw", "stiffness": 1e6, "damping": 1e4}),
    "bump_stop": (BumpStop, {"direction": "lateral", "travel": (0.01, 0.02), "force": (0.0, 1e5)}),
    "table_spring": (TableSpring, {"direction": "vertical", "travel": (0.0, 0.01, 0.02), "force": (0.0, 1e4, 5e4)}),
    "table_damper": (TableDamper, {"direction": "longitudinal", "rate": (0.0, 0.1, 0.2), "force": (0.0, 1e4, 1e4)}),
    "force_law": (ForceLaw, {"direction": "lateral", "force": own_force, "sizes": (2e5, "wheel_radius")}),
    "series_damper": (SeriesDamper, {"direction": "longitudinal", "stiffness": 1e6, "damping": 1e4}),
    "friction_slider": (
        FrictionSlider,
        {"direction": "vertical", "stiffness": 1e6, "damping": 1e3, "capacity": 1e3, "slider_mass": 5.0},
    ),
    "friction_wedge": (
        FrictionSlider,
        {"direction": "lateral", "stiffness": 1e6, "capacity": 1e3, "slider_mass": 5.0, "capacity_slope": 5e4},
    ),
}


@dataclass(frozen=True)
class Pair:
    """Two ends of one connection, each with its position, velocity, axes and own rate; loads, potential and power."""

    assembly: Assembly
    bodies: tuple[Body, Body]
    loads: tuple[Load, Load]
    potential: ca.SX
    power: ca.SX

    def value(self, expression: ca.SX, state: np.ndarray, chosen: dict[str, float]) -> np.ndarray:
        """Evaluate an expression at a state of both ends; all other symbols have their drawn values."""
        both = ca.vertcat(*[one for body in self.bodies for one in (body.position, body.angles, rates(body))])
        value = ca.substitute(self.assembly.system.expand(ca.densify(expression)), both, state)
        symbols = ca.symvar(ca.vec(value))
        (found,) = ca.Function("value", symbols, [value]).call([chosen[one.name()] for one in symbols])
        return found.full().ravel()


def rates(body: Body) -> ca.SX:
    return ca.vertcat(body.velocity, body.own_rate)


def end(name: str) -> Body:
    """Return a body with free position and rotation in 3D; the axes of a wheelset do not pitch."""
    place, velocity, angles, rate = (ca.SX.sym(f"{name}_{word}", 3) for word in ("place", "velocity", "angles", "rate"))
    axes = yaw_roll(angles[2], angles[0])
    return Body(place, velocity, axes if "wheelset" in name else axes @ pitch_rotation(angles[1]), rate, angles)


def pair(law: str, between: str) -> Pair:
    """Return both ends with one connection. It has the name of one of the vehicle's, so that it has a preload."""
    kind, sizes = LAWS[law]
    names = BETWEEN[between]
    connection = kind("front_secondary", *names, PLACE, **{"both_sides": kind is not Torsion} | sizes)
    assembly = assemble("pair", "", passenger_coach(), "body_", False)
    both = [End(name, end(name), ca.SX([0.5 * i, 0, 0.1]), "wheelset" in name) for i, name in enumerate(names)]
    loads = Loads(assembly.system, {one.name: one for one in both})
    relation = loads.relation(*names)
    effect = connect(assembly, connection, relation)
    loads.push(*names, relation, effect)
    found = [loads.on(name) for name in names]
    return Pair(assembly, (both[0].body, both[1].body), (found[0], found[1]), effect.potential, effect.power)


class Drawn(dict[str, float]):
    """Values of parameters, states and tables, drawn on first access."""

    def __init__(self, chosen: dict[str, float], generator: np.random.Generator) -> None:
        super().__init__(chosen)
        self.generator = generator

    def __missing__(self, name: str) -> float:
        drawn = float(self.generator.uniform(-1.0, 1.0))
        self[name] = math.copysign(1.0, drawn) if name.endswith("_direction") else drawn
        return self[name]


def drawn(one: Pair, seed: int) -> tuple[np.ndarray, Drawn]:
    """Return a state of both ends, rotated by up to 0.3 rad and displaced by 0.3 m from rest; a wheelset turns fast."""
    generator = np.random.default_rng(seed)
    state = generator.uniform(-0.3, 0.3, 24)
    state[[10, 22]] += 50.0
    parameters = {name: float(value) for name, value in passenger_coach().parameters.values().items()}
    return state, Drawn(parameters, generator)


#: Axle boxes of a wheelset pitch with the body, so that a pitch spring has no elongation there.
CASES = [(law, between) for law in LAWS for between in BETWEEN if between == "bodies" or law != "pitch"]


@pytest.mark.parametrize(("law", "between"), CASES)
def test_two_ends_of_a_connection_get_no_force_and_no_moment_together(law: str, between: str) -> None:
    one = pair(law, between)
    for seed in range(5):
        state, chosen = drawn(one, seed)
        force, moment, size = ca.SX(3, 1), ca.SX(3, 1), ca.SX(0)
        for body, load in zip(one.bodies, one.loads, strict=True):
            about = ca.cross(body.position, load.force) + body.axes @ load.moment
            force, moment, size = force + load.force, moment + about, size + ca.norm_1(load.force) + ca.norm_1(about)
        *sums, largest = one.value(ca.vertcat(force, moment, size), state, chosen)
        assert largest > 1.0
        assert np.max(np.abs(sums)) < ROUND_OFF * largest


@pytest.mark.study
@pytest.mark.parametrize(("law", "between"), CASES)
def test_a_connection_gives_what_its_potential_loses_less_what_it_turns_to_heat(law: str, between: str) -> None:
    one = pair(law, between)
    working = ca.SX(0)
    for body, load in zip(one.bodies, one.loads, strict=True):
        working += ca.dot(load.force, body.velocity) + ca.dot(load.moment, body.own_rate)
    system = one.assembly.system
    for seed in range(5):
        state, chosen = drawn(one, seed)
        given, lost, _ = (number(one.value(value, state, chosen)) for value in (working, one.power, one.potential))
        stored = []
        for step in (-1e-6, 1e-6):
            moved = Drawn(dict(chosen), chosen.generator)
            for name, derivative in system.derivatives.items():
                own, rate = system.states[name], number(one.value(derivative, state, chosen))
                moved[own.symbol.name()] = chosen[own.symbol.name()] + step * rate
            stored.append(number(one.value(one.potential, advanced(one, state, step), moved)))
        size = abs(given) + abs(lost)
        assert size > 1.0
        assert given + lost + (stored[1] - stored[0]) / 2e-6 == pytest.approx(0.0, abs=DIFFERENCED * size)


def number(value: np.ndarray) -> float:
    return float(value[0])


def advanced(one: Pair, state: np.ndarray, time: float) -> np.ndarray:
    """Return the state after a time in which both ends move; a wheelset's angles have no pitch."""
    moved = state.copy()
    for i, body in enumerate(one.bodies):
        place, angles, velocity, rate = (state[12 * i + k : 12 * i + k + 3] for k in (0, 3, 6, 9))
        moved[12 * i : 12 * i + 3] = place + time * velocity
        wheels = "wheelset" in body.angles[0].name()
        rate = rate * [1, 0, 1] if wheels else rate
        changes = angle_rates(ca.SX(angles * [1, 0, 1] if wheels else angles), ca.SX(rate))
        moved[12 * i + 3 : 12 * i + 6] = angles + time * np.array([float(change) for change in changes]) * (
            [1, 0, 1] if wheels else 1
        )
    return moved
