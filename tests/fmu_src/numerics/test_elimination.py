"""The generated elimination against dense linear algebra. Its statements are valid in C and in Python."""

from __future__ import annotations

import numpy as np
import pytest

from fmu_src.elimination import Elimination, elimination
from products.registry import model_of

#: Rounding errors of a few hundred operations on numbers of order 1.
ROUND_OFF = 1e-11
#: Diagonal of the matrices, to which random entries are added.
DIAGONAL = 10.0


def solved(solving: Elimination, matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return the solution by the generated statements; matrix and vector are in the order of the states."""
    diagonal = np.full(len(solving.order), DIAGONAL)
    jacobian = [float(DIAGONAL * (row == column) - matrix[row, column]) for row, column in solving.nonzeros]
    names = {"j": jacobian, "d": diagonal.tolist(), "e": [0.0] * len(solving.place), "v": vector.tolist()}
    for line in (*solving.factors(), *solving.substitution()):
        exec(line, names)
    return np.array(names["v"])


@pytest.mark.study
def test_generated_elimination_solves_what_dense_algebra_solves() -> None:
    for system in model_of("vehicle").systems:
        solving, random = elimination(system), np.random.default_rng(1)
        count = len(solving.order)
        matrix, vector = DIAGONAL * np.eye(count), random.uniform(-1.0, 1.0, count)
        for row, column in solving.nonzeros:
            matrix[row, column] += random.uniform(-1.0, 1.0)
        exact = np.linalg.solve(matrix, vector)
        assert np.abs(solved(solving, matrix, vector) - exact).max() < ROUND_OFF * np.abs(exact).max(), system.name
        # The test detects a missing entry.
        matrix[next((row, column) for row, column in solving.nonzeros if row != column)] += 0.1
        assert np.abs(solved(solving, matrix, vector) - exact).max() > ROUND_OFF, system.name


def test_elimination_fills_little() -> None:
    """The Jacobian is sparse. A dense one of the vehicle at level 3 would have five times as many factors."""
    system = model_of("vehicle").systems[2]
    solving = elimination(system)
    assert len(solving.place) < 0.25 * len(system.states) ** 2
    assert solving.lower == sum(1 for row, column in solving.place if row > column)
