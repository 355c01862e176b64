"""The main loop of the program, Fig. 3.11: Runge-Kutta in independent coordinates, chosen again as the wheels turn."""

from collections.abc import Callable, Iterator

import numpy as np

from evidence.chapter3.euler import angular_velocity
from evidence.chapter3.mechanism import FIRST_WHEELSET, Mechanism, MechanismInputs, MechanismState, Solution
from evidence.chapter3.partition import Partition, choose, closed_state

#: Stages of the classical Runge-Kutta method: place in the step and weight.
STAGES = ((0.0, 1 / 6), (0.5, 1 / 3), (0.5, 1 / 3), (1.0, 1 / 6))
#: Angular velocity below which a braked wheelset is treated as stopped [rad/s]; iterations that locate this instant.
STOPPED, LOCATING_ROUNDS = 1e-6, 30

Drive = Callable[[float], MechanismInputs]


def accelerations(
    mechanism: Mechanism, state: MechanismState, inputs: MechanismInputs, partition: Partition
) -> tuple[MechanismState, Solution]:
    """Return all accelerations from independent coordinates, eq. (3.118): one turn of the flow chart."""
    closed, jacobian = closed_state(mechanism, state, partition)
    return closed, mechanism.solve(closed, inputs, jacobian)


def step(
    mechanism: Mechanism, state: MechanismState, size: float, drive: Drive, partition: Partition | None = None
) -> MechanismState:
    """Return the state after one step [s] of Runge-Kutta in the independent coordinates, eqs (3.117), (3.118).

    partition: by default chosen at the start of the step.
    """
    if partition is None:
        partition = choose(mechanism.constraints(state.time, state.q, state.s)[1])
    first, second, position, rate = np.zeros((4, mechanism.unknowns))
    for place, weight in STAGES:
        trial = moved(state, place * size, first, second)
        closed, answer = accelerations(mechanism, trial, drive(trial.time), partition)
        first = np.concatenate([closed.q_rate, closed.s_rate])
        second = np.concatenate([answer.q_second, answer.s_second])
        position += weight * first
        rate += weight * second
    return closed_state(mechanism, moved(state, size, position, rate), partition)[0]


def moved(state: MechanismState, size: float, rates: np.ndarray, accelerations: np.ndarray) -> MechanismState:
    """The state `size` seconds later by the rates and accelerations (3.118) of (q, s), before constraints are met."""
    cut = state.q.size
    return MechanismState(
        state.time + size,
        state.q + size * rates[:cut],
        state.s + size * rates[cut:],
        state.q_rate + size * accelerations[:cut],
        state.s_rate + size * accelerations[cut:],
        list(state.direction),
    )


def run(
    mechanism: Mechanism, state: MechanismState, duration: float, size: float, drive: Drive
) -> Iterator[MechanismState]:
    """Yield the state after each step of the loop of Fig. 3.11; brakes that stop their wheels cut a step in two."""
    count = round(duration / size)
    begin = state.time
    for number in range(1, count + 1):
        end = begin + number * size
        while state.time < end - 1e-12:
            state = until_a_wheel_stops(mechanism, state, end - state.time, drive)
            switch_brakes(mechanism, state, drive(state.time))
        yield state


def spin(mechanism: Mechanism, state: MechanismState, wheelset: int) -> float:
    """Angular velocity of a wheelset about its axle [rad/s], by (3.13)."""
    body = mechanism.body(FIRST_WHEELSET + wheelset)
    return float(angular_velocity(state.q[body][3:], state.q_rate[body][3:])[1])


def until_a_wheel_stops(mechanism: Mechanism, state: MechanismState, size: float, drive: Drive) -> MechanismState:
    """A step [s], shortened by the secant rule to the instant at which a braked wheelset locks (section 2.5.2)."""
    after = step(mechanism, state, size, drive)
    for number in range(mechanism.wheelsets):
        direction, reached = state.direction[number], after.time - state.time
        capacity = drive(after.time).brake_torque[number] + mechanism.parameters.rolling_resistance_torque
        if capacity <= 0.0 or spin(mechanism, after, number) * direction >= -STOPPED:
            continue
        left, right = (0.0, spin(mechanism, state, number)), (reached, spin(mechanism, after, number))
        for _ in range(LOCATING_ROUNDS):
            middle = left[0] - left[1] * (right[0] - left[0]) / (right[1] - left[1])
            after = step(mechanism, state, middle, drive)
            value = spin(mechanism, after, number)
            if abs(value) <= STOPPED:
                break
            left, right = ((middle, value), right) if value * direction > 0.0 else (left, (middle, value))
    return after


def switch_brakes(mechanism: Mechanism, state: MechanismState, inputs: MechanismInputs) -> None:
    """Locks wheelsets that stand (section 2.5.2), frees those whose brake cannot hold them; changes state.direction."""
    for number in range(mechanism.wheelsets):
        capacity = inputs.brake_torque[number] + mechanism.parameters.rolling_resistance_torque
        if state.direction[number] != 0 and (capacity <= 0.0 or abs(spin(mechanism, state, number)) > STOPPED):
            continue
        state.direction[number] = 0
        _, jacobian = mechanism.constraints(state.time, state.q, state.s)
        held = mechanism.solve(state, inputs, jacobian).holding_torques[number]
        if abs(held) > capacity:
            state.direction[number] = -1 if held > 0.0 else 1
