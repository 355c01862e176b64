"""Linear analysis about a steady run: eigenvalues, frequencies and damping, critical speed.

The Jacobian is that of the simulation, exact and of the same equations. Algebraic states are eliminated by the implicit
function theorem. States that a steady run leaves free (distance, rotation) or holds (speed) are omitted.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from fmu_src.system import System

#: Angular frequency above which an eigenvalue is treated as an oscillation [rad/s].
SLOWEST = 1e-3


@dataclass(frozen=True)
class Mode:
    """One oscillation: eigenvalue [1/s], and its shape by state, largest component 1."""

    eigenvalue: complex
    shape: dict[str, complex]

    @property
    def frequency(self) -> float:
        """Frequency [Hz]."""
        return float(self.eigenvalue.imag / (2 * np.pi))

    @property
    def growth(self) -> float:
        """Rate of growth [1/s]; negative if the mode decays."""
        return float(self.eigenvalue.real)

    @property
    def damping_ratio(self) -> float:
        """Share of critical damping; negative if the mode grows."""
        return float(-self.eigenvalue.real / abs(self.eigenvalue))


def steady(system: System) -> set[str]:
    """Return states of a vehicle's place and speed, which are not part of motion about its steady run (section 4.4)."""
    counted = next(name.removesuffix("distance") for name in system.states if name.endswith("distance"))
    turned = {name for name in system.states if name.startswith("rotation_")}
    return {f"{counted}distance", f"{counted}speed", *turned}


def reduced_jacobian(system: System, jacobian: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Return names of the remaining states and f_x - f_z g_z^-1 g_x, by the implicit function theorem.

    jacobian: shape (states, states), of all states.
    """
    states, left_out = list(system.states.values()), steady(system)
    kept = [i for i, s in enumerate(states) if not s.algebraic and s.name not in left_out]
    algebraic = [i for i, s in enumerate(states) if s.algebraic]
    matrix = jacobian[np.ix_(kept, kept)]
    if algebraic:
        solved = np.linalg.solve(jacobian[np.ix_(algebraic, algebraic)], jacobian[np.ix_(algebraic, kept)])
        matrix = matrix - jacobian[np.ix_(kept, algebraic)] @ solved
    return [states[i].name for i in kept], matrix


def oscillations(system: System, jacobian: np.ndarray) -> list[Mode]:
    """Return modes with a frequency above zero, the least damped first; section 4.4 has them from simulated motions."""
    names, matrix = reduced_jacobian(system, jacobian)
    values, vectors = np.linalg.eig(matrix)
    found = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag > SLOWEST:
            largest = vector[np.argmax(np.abs(vector))]
            found.append(Mode(complex(value), dict(zip(names, vector / largest, strict=True))))
    return sorted(found, key=lambda mode: mode.damping_ratio)


def critical_speed(growth: Callable[[float], float], low: float, high: float) -> float:
    """Return the speed [m/s] at which `growth(speed)` [1/s] becomes positive, to 1e-6 m/s; section 4.4.

    Takes growth [1/s], low, high [m/s].
    """
    if growth(low) * growth(high) > 0.0:
        raise ValueError(f"The motion is as stable at {low} m/s as at {high} m/s; search for it in another range.")
    return float(brentq(growth, low, high, xtol=1e-6))
