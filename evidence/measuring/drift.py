"""Drift of constraints: chapter 3's equations with coordinate partitioning, and without it, in all coordinates."""

from dataclasses import dataclass

import numpy as np

from evidence.chapter3.kinematic_analysis import rolling
from evidence.chapter3.mechanism import FIRST_WHEELSET, Mechanism, MechanismInputs, MechanismState
from evidence.chapter3.program import STAGES, moved
from evidence.chapter3.program import step as partitioned_step
from rbd_model.contact.geometry import thesis_pair
from rbd_model.track.irregularity import derivatives_along, section_5_3
from rbd_model.vehicle.parameters import as_printed, tables_4_1_and_4_2

#: A wheelset of chapter 4 under braking: initial speed [m/s], torque [N.m], duration and step [s].
SPEED, TORQUE, DURATION, STEP = 15.0, 1e3, 0.08, 5e-4


@dataclass(frozen=True)
class Drift:
    """Over time [s]: largest constraint residual [m or 1], and distance of the Euler parameters from the unit norm."""

    time: np.ndarray
    residual: np.ndarray
    norm: np.ndarray


def free_step(mechanism: Mechanism, state: MechanismState, size: float, inputs: MechanismInputs) -> MechanismState:
    """Take a Runge-Kutta step of all coordinates: accelerations meet the constraints, positions may drift."""
    first, second, position, rate = np.zeros((4, mechanism.unknowns))
    for place, weight in STAGES:
        trial = moved(state, place * size, first, second)
        answer = mechanism.solve(trial, inputs, mechanism.constraints(trial.time, trial.q, trial.s)[1])
        first = np.concatenate([trial.q_rate, trial.s_rate])
        second = np.concatenate([answer.q_second, answer.s_second])
        position += weight * first
        rate += weight * second
    return moved(state, size, position, rate)


def drift(partitioned: bool, duration: float = DURATION) -> Drift:
    """Run a braked wheelset with or without the partitioning that closes the constraints in each step."""
    mechanism = Mechanism(as_printed(tables_4_1_and_4_2()), thesis_pair(), 1, derivatives_along(section_5_3()))
    inputs, state, rows = MechanismInputs(brake_torque=(TORQUE, 0.0)), rolling(mechanism, SPEED), []
    for _ in range(round(duration / STEP)):
        if partitioned:
            state = partitioned_step(mechanism, state, STEP, lambda time: inputs)
        else:
            state = free_step(mechanism, state, STEP, inputs)
        residual = mechanism.constraints(state.time, state.q, state.s)[0]
        turn = state.q[mechanism.body(FIRST_WHEELSET)][3:]
        rows.append((state.time, np.abs(residual).max(), abs(float(turn @ turn) - 1.0)))
    return Drift(*np.array(rows).T)
