"""The fast model against the published chapter 3: accelerations and normal forces at random states, and motions."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from evidence.chapter3 import creep, mechanism
from evidence.chapter3.kinematic_analysis import rolling
from evidence.chapter3.mechanism import Mechanism
from evidence.chapter3.program import run
from fmu_src.kernel import Kernel
from tests.evidence.chapter3.correspondence import (
    WORDS,
    Snapshot,
    accelerations_of,
    inputs_of,
    machine,
    mechanism_of,
    reach,
    slopes_of,
    state_of,
)

#: Tolerances by docs/checking.md, relative to the largest acceleration of a kind and to the largest force.
ACCELERATION_BAND, FORCE_BAND = 1e-9, 1e-9
#: Acceleration scale below which rounding errors dominate [m/s2, rad/s2]. The error is 6e-11 rad/s2: 2e-16 of a speed
#: of 7 m/s as slip, times a creep stiffness of 1e7 N.s/m, times 0.425 m, over 112 kg.m2.
CALM = 0.1
STATES = {1: 60, 2: 60, 4: 50}


def random_scene(wheelsets: int, seed: int) -> tuple[dict[str, float], float]:
    """Return random inputs and a duration: yaw, roll, flange contact, skid, a rotating yaw torque, irregularities."""
    rng = random.Random(f"{wheelsets} {seed}")
    heavy = wheelsets > 1
    # The front wheelset of a vehicle is 11 m ahead of its middle; the track must be level there at the start.
    ahead = 25.0 if wheelsets == 4 else 0.0
    scene = {
        "initial_speed": rng.uniform(3.0, 30.0),
        "irregularity_start": rng.uniform(0.0, 3.0) + 0.5 * ahead,
        "cross_level_centre": rng.uniform(5.0, 30.0) + ahead,
        "wheel_lift_ends": 0.0,
    }
    scene["lateral_irregularity"] = rng.uniform(-0.03, 0.03) if wheelsets == 2 else rng.uniform(-0.012, 0.012)
    scene["vertical_irregularity"], scene["cross_level"] = rng.uniform(-0.01, 0.01), rng.uniform(-0.015, 0.015)
    scene["lateral_wave_number"] = rng.uniform(0.04, 0.2)
    for number in range(1, wheelsets + 1):
        scene[f"friction_{number}"] = rng.uniform(0.08, 0.5)
        kind = rng.choice(("brake", "traction", "none"))
        if kind != "none":
            scene[f"{kind}_torque_{number}"] = rng.uniform(0.0, 4e4 if heavy else 1.2e4)
        scene[f"yaw_torque_{number}"] = rng.uniform(-3e4, 3e4) if heavy else rng.uniform(-2e3, 2e3)
    scene["yaw_torque_rotates"] = float(rng.random() < 0.5)
    return scene, rng.uniform(0.2, 1.5)


@lru_cache
def snapshots(wheelsets: int) -> list[Snapshot]:
    found: list[Snapshot] = []
    seed = 0
    while len(found) < STATES[wheelsets]:
        snapshot = reach(machine(wheelsets), *random_scene(wheelsets, seed))
        seed += 1
        if snapshot is not None:
            found.append(snapshot)
    return found


def differences(snapshot: Snapshot, oracle: Mechanism) -> tuple[float, float]:
    """Return the relative differences of accelerations and of normal forces."""
    state = state_of(snapshot, oracle)
    _, jacobian = oracle.constraints(state.time, state.q, state.s)
    answer = oracle.solve(state, inputs_of(snapshot.scene), jacobian)
    ours, theirs = slopes_of(snapshot), accelerations_of(snapshot.machine, state, answer, oracle)
    assert set(ours) == set(theirs)
    linear = [name for name in ours if name.startswith(("axle", "along")) or "lateral" in name or "bounce" in name]
    turning = [name for name in ours if name not in linear]
    worst = 0.0
    for kind in (linear, turning):
        scale = max(CALM, *(abs(theirs[name]) for name in kind))
        worst = max(worst, max(abs(ours[name] - theirs[name]) for name in kind) / scale)
    normals = [snapshot.value[f"normal_{n}_{word}"] for n in range(1, snapshot.machine.wheelsets + 1) for word in WORDS]
    load = float(np.abs(answer.normal_forces).max())
    return worst, float(np.abs(np.array(normals) - answer.normal_forces).max()) / load


@pytest.mark.study
@pytest.mark.parametrize("wheelsets", [1, 2, 4])
def test_accelerations_and_normal_forces_are_those_of_chapter_3(wheelsets: int) -> None:
    """The states are random states of the fast model; eqs (3.73), (3.75), (3.76), (3.81)."""
    found = snapshots(wheelsets)
    for snapshot in found:
        acceleration, force = differences(snapshot, mechanism_of(snapshot.machine, snapshot.scene))
        assert acceleration < ACCELERATION_BAND, snapshot.scene
        assert force < FORCE_BAND, snapshot.scene


@pytest.mark.study
def test_random_states_contain_what_they_are_meant_to() -> None:
    for every, least in (([*snapshots(1), *snapshots(2)], 100), (snapshots(4), 50)):
        assert len(every) >= least
        flanges = [s for s in every if offset(s) > s.machine.parameters.flange_clearance]
        assert len(flanges) >= 10
        assert sum(any(s.locked) for s in every) >= 5
        assert sum(s.scene["yaw_torque_rotates"] > 0.5 for s in every) >= 30
        assert max(abs(s.value["roll_1"]) for s in every) > 1e-3
        assert max(abs(s.value["yaw_1"]) for s in every) > 5e-3


def offset(snapshot: Snapshot) -> float:
    """Return the largest lateral displacement of a wheelset from the track's centre line [m]."""
    oracle = mechanism_of(snapshot.machine, snapshot.scene)
    v = snapshot.value
    found = []
    for n in range(1, snapshot.machine.wheelsets + 1):
        distance = v[f"{snapshot.machine.bodies[0]}_distance"] + oracle.place(n - 1) + v[f"shift_{n}"]
        found.append(abs(v[f"lateral_{n}"] - oracle.irregularity(distance)[0, 0]))
    return max(found)


def without(term: str, snapshot: Snapshot, patch: pytest.MonkeyPatch) -> Mechanism:
    """Return the oracle of a state without one term."""
    oracle = mechanism_of(snapshot.machine, snapshot.scene)
    if term == "gyroscopic":
        patch.setattr(mechanism, "quadratic_velocity", lambda *_: np.zeros(7))
    elif term == "spin":
        patch.setattr(creep, "spin_force", lambda *_: 0.0)
    elif term == "flange":
        patch.setattr(mechanism, "flange_force", lambda *_: 0.0)
    else:
        none = {f"{name}_damping": 0.0 for name in ("longitudinal", "lateral", "vertical")}
        oracle = Mechanism(
            replace(oracle.parameters, **none),
            oracle.pair,
            oracle.wheelsets,
            oracle.irregularity,
            ellipse=oracle.ellipse,
        )
    return oracle


@pytest.mark.study
@pytest.mark.parametrize("term", ["gyroscopic", "spin", "flange", "damping"])
@pytest.mark.parametrize("wheelsets", [1, 2])
def test_a_missing_term_is_found(term: str, wheelsets: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without any of the terms the comparison above fails: in most states, or (flange) in those with flange contact."""
    found = snapshots(wheelsets)[:30]
    worst = [max(differences(s, without(term, s, monkeypatch))) for s in found]
    assert max(worst) > 1e3 * ACCELERATION_BAND
    if term != "flange":
        assert np.median(worst) > ACCELERATION_BAND


#: Tolerances by docs/checking.md: one second of motion [m, m/s], and constraints [m, 1].
LATERAL_BAND, SPEED_BAND, RESIDUAL_BAND = 1e-6, 1e-5, 1e-12


def lateral_and_speed(wheelsets: int, scene: dict[str, float], seconds: float, interval: float) -> np.ndarray:
    """Return rows (lateral displacement of the leading wheelset [m], speed of the frame [m/s]) of the fast model."""
    kernel = Kernel(machine(wheelsets).library, tolerance=1e-10, **scene)
    kernel.initialise()
    names = list(machine(wheelsets).system.states)
    rows = []
    for number in range(round(seconds / interval)):
        kernel.step(number * interval, interval)
        state = dict(zip(names, kernel.linearise().state, strict=True))
        rows.append([state["lateral_1"], state["frame_speed"]])
    return np.array(rows)


#: Speed, and time until the wave has moved the wheelset by 1 mm [s]. The oracle needs two minutes for one second.
@pytest.mark.parametrize(
    ("speed", "hunting", "sizes"),
    [pytest.param(15.0, 0.3, (1e-3, 5e-4), marks=pytest.mark.long), (25.0, 0.2, (1e-3,))],
)
def test_hunting_is_the_same_in_both_models(speed: float, hunting: float, sizes: tuple[float, ...]) -> None:
    """A wave of the track excites the wheelset of chapter 4. The oracle's error falls with its step."""
    scene = {
        "initial_speed": speed,
        "lateral_irregularity": 2e-3,
        "lateral_wave_number": 0.2,
        "irregularity_start": 1.0,
    }
    kernel = lateral_and_speed(1, scene, hunting, 0.01)
    assert np.abs(kernel[:, 0]).max() > 1e-3
    errors = []
    oracle, inputs = mechanism_of(machine(1), scene), inputs_of(scene)
    body, frame = oracle.body(2), oracle.body(oracle.frame)
    for size in sizes:
        every = round(0.01 / size)
        states = list(run(oracle, rolling(oracle, speed), hunting, size, lambda time: inputs))[every - 1 :: every]
        rows = np.array([[state.q[body][1], state.q_rate[frame][0]] for state in states])
        errors.append(np.abs(rows - kernel).max(axis=0))
        for state in states:
            c, _ = oracle.constraints(state.time, state.q, state.s)
            assert np.abs(c).max() < RESIDUAL_BAND
    assert errors[-1][0] < LATERAL_BAND
    assert errors[-1][1] < SPEED_BAND
    assert len(sizes) == 1 or errors[1][0] < 0.1 * errors[0][0]
