"""Errors of a fit that are correlated in time: their variance, share and correlation time, by restricted likelihood.

The covariance of the errors at t_i and t_j is s^2 [c exp(-|t_i - t_j| / tau) + (1 - c) delta_ij]: a first-order
autoregressive part, as of a slow sensor, and an independent one, as of digits. The parameters maximise the restricted
likelihood (Patterson and Thompson 1971, Biometrika 58, 545-554), which counts what the fit takes from the residuals;
plain autocorrelations of residuals are too small, and so are standard errors from them. The inverse of exp(-|t_i - t_j|
/ tau) is tridiagonal (Rybicki and Press 1995, Physical Review Letters 74, 1060), so all costs grow with the rows alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.optimize import minimize

#: Gain of the logarithm of the likelihood from which errors count as correlated: Akaike's two parameters.
GAIN = 2.0
#: Fewest rows in which a correlation is looked for.
FEWEST = 10
#: Largest share of correlated errors, below 1 so that matrices stay regular.
LARGEST_SHARE = 1.0 - 1e-9
#: Start values of share and correlation time, in median steps, of which the best is refined.
SHARES, STEPS = (0.5, 0.95, 0.9999), (2.0, 10.0, 50.0, 250.0)


@dataclass(frozen=True)
class Errors:
    """Errors of an output: variance, the correlated share of it (0: independent errors), correlation time [s]."""

    variance: float
    share: float
    time: float

    def times(self, moments: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return the covariance of errors at `moments` [s] times columns, shape (moments, columns)."""
        if self.share == 0.0:
            return self.variance * columns
        slow = _correlated(moments, self.time, columns)
        return self.variance * (self.share * slow + (1.0 - self.share) * columns)


def errors_of(moments: np.ndarray, residuals: np.ndarray, slopes: np.ndarray) -> Errors:
    """Return the errors of an output at `moments` [s] by the residuals and slopes of its fit."""
    basis = _basis(slopes)
    free = moments.size - basis.shape[1]
    rest = residuals - basis @ (basis.T @ residuals)
    variance = float(rest @ rest) / free if free > 0 else float(residuals @ residuals) / moments.size
    if free < FEWEST or variance <= 0.0 or not math.isfinite(variance):
        return Errors(variance, 0.0, 0.0)
    usual = float(np.median(np.diff(moments)))
    longest = math.log(float(moments[-1] - moments[0]))

    def at(place: np.ndarray) -> tuple[float, float]:
        """Return share and time at logarithms of share / (1 - share) and of time."""
        share = 1.0 / (1.0 + math.exp(-min(max(place[0], -40.0), 40.0)))
        return min(share, LARGEST_SHARE), math.exp(min(max(place[1], math.log(usual / 10)), longest))

    def cost(place: np.ndarray) -> float:
        return _likelihood(moments, rest, basis, *at(place))[0]

    starts = [(math.log(share / (1 - share)), math.log(steps * usual)) for share in SHARES for steps in STEPS]
    best = min(starts, key=lambda place: cost(np.array(place)))
    corners = np.array(best) + np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.7]])
    options = {"initial_simplex": corners, "xatol": 1e-3, "fatol": 1e-4, "maxiter": 400}
    found = minimize(cost, best, method="Nelder-Mead", options=options)
    plain = 0.5 * (free * math.log(variance) + free)
    if plain - found.fun < GAIN:
        return Errors(variance, 0.0, 0.0)
    share, time = at(found.x)
    return Errors(_likelihood(moments, rest, basis, share, time)[1], share, time)


def _basis(slopes: np.ndarray) -> np.ndarray:
    """Return orthonormal columns that span the slopes, shape (rows, rank)."""
    lengths = np.linalg.norm(slopes, axis=0)
    scaled = slopes[:, lengths > 0.0] / lengths[lengths > 0.0]
    if scaled.shape[1] == 0:
        return scaled
    left, sizes, _ = np.linalg.svd(scaled, full_matrices=False)
    return left[:, sizes > 1e-8 * sizes[0]]


def _precision(moments: np.ndarray, time: float) -> tuple[np.ndarray, float]:
    """Return the inverse of exp(-|t_i - t_j| / time), its two upper diagonals, and the logarithm of its determinant."""
    decay = np.exp(-np.diff(moments) / time)
    innovation = -np.expm1(-2.0 * np.diff(moments) / time)
    bands = np.zeros((2, moments.size))
    bands[1] = 1.0
    bands[1, :-1] += decay**2 / innovation
    bands[1, 1:] += 1.0 / innovation - 1.0
    bands[0, 1:] = -decay / innovation
    return bands, -float(np.sum(np.log(innovation)))


def _correlated(moments: np.ndarray, time: float, columns: np.ndarray) -> np.ndarray:
    """Return exp(-|t_i - t_j| / time) times columns."""
    bands, _ = _precision(moments, time)
    found: np.ndarray = cho_solve_banded((cholesky_banded(bands), False), columns)
    return found


def _applied(bands: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Return a symmetric tridiagonal matrix times columns."""
    found = bands[1][:, None] * columns
    found[:-1] += bands[0, 1:, None] * columns[1:]
    found[1:] += bands[0, 1:, None] * columns[:-1]
    return found


def _likelihood(
    moments: np.ndarray, rest: np.ndarray, basis: np.ndarray, share: float, time: float
) -> tuple[float, float]:
    """Return minus the logarithm of the restricted likelihood at its best variance, but for a constant, and this one.

    With the precision P of the correlated part, the covariance is V = (c I + (1 - c) P) P^-1.
    """
    bands, determinant = _precision(moments, time)
    mixed = (1.0 - share) * bands
    mixed[1] += share
    factor = cholesky_banded(mixed)
    both = np.column_stack([rest, basis])
    solved = cho_solve_banded((factor, False), _applied(bands, both))
    inner = both.T @ solved
    across = np.linalg.solve(inner[1:, 1:], inner[1:, :1]) if basis.shape[1] else np.zeros((0, 1))
    free = moments.size - basis.shape[1]
    variance = float(inner[0, 0] - inner[0, 1:] @ across[:, 0]) / free
    log_covariance = 2.0 * float(np.sum(np.log(factor[1]))) - determinant
    log_basis = float(np.linalg.slogdet(inner[1:, 1:])[1])
    return 0.5 * (log_covariance + log_basis + free * math.log(max(variance, 1e-300)) + free), variance
