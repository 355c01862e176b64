"""Independent and dependent coordinates, section 3.4: chosen by elimination, solved by Newton-Raphson."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from evidence.chapter3.mechanism import Mechanism, MechanismState
from evidence.chapter3.surfaces import OffTheProfileError

#: Norm of C at which the Newton-Raphson iteration ends, epsilon_2 of (3.124), and its largest number of rounds.
CLOSED, MAXIMUM_ROUNDS = 1e-13, 12


class NoSolutionError(ArithmeticError):
    """The constraint equations have no solution near the given one: contact is lost, section 9.4.1's derailment."""


@dataclass(frozen=True)
class Partition:
    """Columns of (q, s) that are dependent and independent, eqs (3.107), (3.108)."""

    dependent: np.ndarray
    independent: np.ndarray


def choose(jacobian: np.ndarray) -> Partition:
    """Gaussian elimination with full pivoting on (C_q C_s), after (3.116): pivot columns are dependent.

    jacobian: shape (equations, unknowns), of full rank.
    """
    matrix = jacobian.copy()
    equations, unknowns = matrix.shape
    columns = np.arange(unknowns)
    for pivot in range(equations):
        rest = np.abs(matrix[pivot:, pivot:])
        row, column = divmod(int(rest.argmax()), unknowns - pivot)
        row, column = row + pivot, column + pivot
        matrix[[pivot, row]] = matrix[[row, pivot]]
        matrix[:, [pivot, column]] = matrix[:, [column, pivot]]
        columns[[pivot, column]] = columns[[column, pivot]]
        factor = matrix[pivot + 1 :, pivot] / matrix[pivot, pivot]
        matrix[pivot + 1 :, pivot:] -= factor[:, None] * matrix[pivot, pivot:]
    return Partition(np.sort(columns[:equations]), np.sort(columns[equations:]))


def close_positions(
    mechanism: Mechanism, time: float, coordinates: np.ndarray, partition: Partition
) -> tuple[np.ndarray, np.ndarray]:
    """Return (q, s) with C = 0 solved for the dependent coordinates, eqs (3.119)-(3.124), and the Jacobian there.

    coordinates: (q, s), shape (unknowns,), with exact independent and approximate dependent ones. This differs from the
    thesis: (3.122) has the minus sign on the wrong side; the Newton differences are -(C_qd C_sd)^-1 C.
    """
    found = coordinates.copy()
    for _ in range(MAXIMUM_ROUNDS):
        try:
            c, jacobian = mechanism.constraints(time, found[: mechanism.q_count], found[mechanism.q_count :])
        except OffTheProfileError:
            break
        size = float(np.sqrt(c @ c))
        if size < CLOSED:
            return found, jacobian
        if not np.isfinite(size):
            break
        factors, pivots, failed = dgetrf(jacobian[:, partition.dependent])
        if failed:
            break
        found[partition.dependent] -= dgetrs(factors, pivots, c)[0]
    raise NoSolutionError(
        f"The constraint equations have no solution near the state at {time:.6g} s: contact is lost, or the "
        "coordinates are badly partitioned."
    )


def close_velocities(mechanism: Mechanism, rates: np.ndarray, jacobian: np.ndarray, partition: Partition) -> np.ndarray:
    """Return dependent rates from the independent ones, eqs (3.67), (3.109)-(3.116).

    rates: of (q, s), shape (unknowns,).

    This differs from the thesis: the minus sign of C_di is missing in (3.112), (3.114), and that of the C_t term of
    (3.116) as well.
    """
    closed = rates.copy()
    driven = jacobian[:, partition.independent] @ rates[partition.independent] + mechanism.time_derivative
    factors, pivots, _ = dgetrf(jacobian[:, partition.dependent])
    closed[partition.dependent] = -dgetrs(factors, pivots, driven)[0]
    return closed


def closed_state(mechanism: Mechanism, near: MechanismState, partition: Partition) -> tuple[MechanismState, np.ndarray]:
    """Return the state with all constraints met and the independent coordinates and rates of `near`, section 3.4.

    The second result is the Jacobian, shape (equations, unknowns). Raises NoSolutionError.
    """
    cut = mechanism.q_count
    coordinates, jacobian = close_positions(mechanism, near.time, np.concatenate([near.q, near.s]), partition)
    rates = close_velocities(mechanism, np.concatenate([near.q_rate, near.s_rate]), jacobian, partition)
    state = MechanismState(
        near.time, coordinates[:cut], coordinates[cut:], rates[:cut], rates[cut:], list(near.direction)
    )
    return state, jacobian
