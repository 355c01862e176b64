"""Test forces by a function of travel and rate, and friction wedges, against closed forms; refused functions."""

from __future__ import annotations

import math
import pickle
import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

import bogie_braking as bb
from fmu_src.compile import build_library
from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from rbd_model.levels.planar import planar_vehicle
from rbd_model.vehicle.description import ForceLaw, FrictionSlider, Pull, RigidBody, Springs, Vehicle
from rbd_model.vehicle.ready import two_axle_bogie

#: Integration tolerance of the blocks, and their tolerance against a closed form.
TOLERANCE, CLOSED_FORM = 1e-9, 1e-6
#: Blocks on a frame that does not move [kg]; a damper that saturates [N], [m/s]; a stop with a gap [N/m2], [m].
MASS, LARGEST, KNEE, STOP, GAP = 1000.0, 12e3, 0.02, 1e8, 0.01
#: Springs below a block with a wedge, its capacity at rest and over compression, the spring of its slider [N], [m].
STIFFNESS, CAPACITY, SLOPE, STIFF = 1e6, 8e3, 2e5, 1e9
#: Relative error by the yield of the slider's spring, capacity over STIFF, in the travel of a block.
YIELD = 1e-3
HELD = ("lateral", "roll", "pitch", "yaw")
AT = (0.0, 0.0, "frame_height")


def saturating(travel: Any, rate: Any, largest: Any) -> Any:
    return largest * ca.tanh(rate / KNEE)


def stop(travel: Any, rate: Any) -> Any:
    return STOP * ca.sign(travel) * ca.fmax(ca.fabs(travel) - GAP, 0) ** 2


def blocks() -> Vehicle:
    good = two_axle_bogie()
    kinds = {"damped": (*HELD, "bounce"), "stopped": (*HELD, "bounce"), "wedged": HELD}
    inertia = (1.0, 1.0, 1.0)
    bodies = [RigidBody(one, one, MASS, inertia, 0.0, "frame_height", frozenset(held)) for one, held in kinds.items()]  # type: ignore[arg-type]
    at = "wedged", "frame", AT, False
    connections = [
        ForceLaw("damper", "damped", "frame", AT, False, "longitudinal", saturating, ("flange_stiffness",)),
        ForceLaw("stop", "stopped", "frame", AT, False, "longitudinal", stop),
        Springs("springs", *at, (1e6, 0.0, STIFFNESS), (1e4, 0.0, 0.0)),
        FrictionSlider("wedge", *at, "vertical", STIFF, 1e5, CAPACITY, 1.0, SLOPE),
    ]
    pulls = [Pull(f"force_{one}", f"Force on {one}", one, AT) for one in kinds if one != "wedged"]
    pulls.append(Pull("lift", "Force upwards on the block with a wedge", "wedged", AT, "vertical"))
    return replace(good, bodies=(*good.bodies, *bodies), connections=(*good.connections, *connections), pulls=(*pulls,))


@pytest.fixture(scope="module")
def bench() -> Library:
    return Library(build_library(model_of(planar_vehicle(blocks()), TOLERANCE)))


def standing(bench: Library, **values: float) -> Kernel:
    """Return a kernel with a frame that does not move: locked wheels, 1e6 times the mass, 1e3 times the stiffness."""
    locked = {"brake_torque_1": 1e9, "brake_torque_2": 1e9, "initial_speed": 0.0, "friction_1": 2.0, "friction_2": 2.0}
    heavy = {"frame_mass": 6e10, "longitudinal_stiffness": 9.5e12, "vertical_stiffness": 3.5e12}
    kernel = Kernel(bench, **locked, **heavy, flange_stiffness=LARGEST, **values)
    kernel.initialise()
    return kernel


@pytest.mark.parametrize("force", [3e3, -9e3])
def test_a_damper_creeps_at_the_rate_of_its_force(bench: Library, force: float) -> None:
    """F = F0 tanh(v / v0); the force that it saturates at is a parameter."""
    kernel = standing(bench, force_damped=force)
    kernel.advance(2.0)
    assert kernel["state_damped_shift_speed"] == pytest.approx(KNEE * math.atanh(force / LARGEST), rel=CLOSED_FORM)


def test_a_mass_on_a_stop_keeps_its_energy(bench: Library) -> None:
    """F x = m v^2 / 2 + k (x - gap)^3 / 3 beyond the gap, at each moment of many swings."""
    force, furthest = 500.0, 0.0
    kernel = standing(bench, force_stopped=force)
    for _ in range(200):
        kernel.advance(0.01)
        way, speed = kernel["state_stopped_shift"], kernel["state_stopped_shift_speed"]
        stored = STOP * max(abs(way) - GAP, 0.0) ** 3 / 3
        assert MASS * speed**2 / 2 + stored == pytest.approx(force * way, abs=CLOSED_FORM * force * 2 * GAP)
        furthest = max(furthest, way)
    assert furthest > 1.5 * GAP


def test_a_wedge_resists_more_the_more_it_is_compressed(bench: Library) -> None:
    """Released at rest, a block swings about (C - F) / (k - s): friction C + s d falls with the compression d.

    The half swing takes pi sqrt(m / (k - s)).
    """
    kernel = standing(bench, lift=-20e3)
    kernel.advance(5.0)
    pressed, lift = -kernel["wedged_bounce"], 12e3
    assert kernel["state_wedged_bounce_rate"] == pytest.approx(0.0, abs=1e-6)
    kernel.set(lift=lift)
    half = math.pi * math.sqrt(MASS / (STIFFNESS - SLOPE))
    kernel.advance(half)
    ends = 2 * (CAPACITY - lift) / (STIFFNESS - SLOPE) - pressed
    assert -kernel["wedged_bounce"] == pytest.approx(ends, abs=YIELD * pressed)
    assert -CAPACITY / SLOPE < ends < -0.5 * pressed


def with_law(force: Callable[..., Any], *sizes: float) -> Vehicle:
    good = two_axle_bogie()
    law = ForceLaw("added", "frame", "wheelset_1", (0.0, 0.0, 0.0), False, "vertical", force, sizes)
    return replace(good, connections=(*good.connections, law))


FAULTS: list[tuple[Callable[..., Any], str]] = [
    (lambda x, v: max(x, v), "force must return a CasADi expression of travel, rate and 0 sizes; it failed:"),
    (lambda x, v: ca.SX.sym("other") * v, "rate and its sizes; got other too. Make it a size."),
    (lambda x: x, "it failed: <lambda>() takes 1 positional argument but 2 were given. Write ca.if_else"),
    (lambda x, v: ca.vertcat(x, v), "force must return one number [N]; got 2. Return the force alone."),
    (lambda x, v: 5.0 + v, "added: force must be 0 at rest; got 5 N at travel 0 and rate 0. Subtract it."),
    (lambda x, v: 0.0, "added: force must depend on travel or rate; it is 0 everywhere. Remove the connection."),
    (lambda x, v: 1e3 * ca.sign(v), "added: force must not jump; it does at travel 0 m, rate 0 m/s. Take ca.tanh,"),
    (lambda x, v: ca.if_else(x > 0.0213, 500.0, 0.0), "force must not jump; it does at travel 0.0213 m, rate 0 m/s."),
    (lambda x, v: 1e6 * x - 1e3 * v, "added: force must not drive: its part by the rate must have the sign of the"),
    (lambda x, v: 1e3 * v / x, "added: force must be finite; it is not at travel 0 m, rate 0 m/s. Add a small"),
    (lambda x, v: ca.sign(v) * ca.sqrt(ca.fabs(v)), "added: slope of the force must be finite; it is not at travel 0"),
]


@pytest.mark.parametrize(("force", "words"), FAULTS, ids=[words for _, words in FAULTS])
def test_a_function_that_cannot_be_a_force_is_refused_in_one_message(force: Callable[..., Any], words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)) as refused:
        with_law(force)
    assert "\n" not in str(refused.value)


def test_a_vehicle_with_a_function_is_data() -> None:
    """Equal functions make equal vehicles, which can be stored and changed; an unnamed function runs."""
    damped = with_law(lambda x, v: 2e4 * v)
    assert damped == with_law(lambda travel, rate: 2e4 * rate)
    assert damped != with_law(lambda x, v: 3e4 * v)
    assert pickle.loads(pickle.dumps(damped)) == damped
    assert replace(damped, name="Other").connections == damped.connections
    plain = with_law(lambda x, v, c: c * v, 2e4)
    runs = [bb.run(one, 0.5, None, ["bounce"], 0.05, initial_speed=20.0, brake_torque_1=9e3) for one in (damped, plain)]
    assert np.max(np.abs(runs[0]["bounce"] - runs[1]["bounce"])) < 1e-12
