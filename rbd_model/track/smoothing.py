"""Penalised splines: smooth functions through noisy samples, whose second derivative is wanted.

A spline of degree 5 on equal knots minimises the sum of squared deviations plus a factor times the integral of the
squared third derivative (P. H. C. Eilers and B. D. Marx (1996), Flexible smoothing with B-splines and penalties,
Statistical Science 11; the penalty is the exact integral). For a track in plan the third derivative is the change of
curvature per metre. Straights, arcs and transitions therefore cost little. A penalty on the second derivative, as in
cubic smoothing splines, pulls arcs towards straight lines.

The factor minimises the generalised cross validation (P. Craven and G. Wahba (1978), Smoothing noisy data with spline
functions, Numerische Mathematik 31), or the unbiased estimate of the risk if the noise is known (C. L. Mallows (1973),
Some comments on Cp, Technometrics 15). Both count degrees of freedom 1.4 times, which avoids fits to noise (Y.-J. Kim
and C. Gu (2004), Smoothing spline Gaussian regression, Journal of the Royal Statistical Society B 66).

Errors of receivers are correlated: those of samples a way x apart by exp(-x / length), a Gauss-Markov process. Samples
and design are then multiplied by the matrix that makes these errors independent. The marginal likelihood compares
lengths (Y. Wang (1998), Smoothing spline models with correlated random errors, Journal of the American Statistical
Association 93).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.linalg import cho_solve_banded, cholesky_banded, solveh_banded
from scipy.sparse import diags_array

Numbers = NDArray[np.float64]
DEGREE, PENALISED = 5, 3
#: Weight of degrees of freedom (Kim and Gu 2004).
INFLATION = 1.4
#: Reach of the smoothing over the distance of knots: shortest, longest, and how many are compared. Beyond the longest
#: the equations lose digits.
SHORTEST, LONGEST, STEPS = 0.3, 60.0, 41
#: Shift of the logarithm of the penalty by which the determinant is differentiated.
SHIFT = 0.05
#: Half width of the window in which a variance is computed, in reaches and in knots; most places where it is computed.
WINDOW, MARGIN, MOST_PLACES = 12.0, 8, 4000


@dataclass(frozen=True, eq=False)
class Smooth:
    """A smooth function of one variable with one or more components, fitted to samples of equal noise.

    Attributes
    ----------
    spline : BSpline
        The function.
    reach : float
        Length of the smoothing: the sixth root of the penalty's factor per sample and metre.
    noise : float
        Standard deviation of a sample in one direction; given, or that of the residuals.
    residual : float
        Standard deviation of the residuals in one direction.
    pitch : float
        Distance of the knots.
    normal : array, shape (bands, coefficients)
        Lower bands of the normal equations, penalty included.
    gap : float
        Largest distance of samples.
    misfit : float
        The marginal likelihood's logarithm times -2, without a constant.
    """

    spline: BSpline
    reach: float
    noise: float
    residual: float
    pitch: float
    normal: Numbers
    gap: float
    misfit: float

    def deviation(self, places: Numbers, order: int) -> Numbers:
        """Return the standard deviation of a derivative of one component, shape of `places`.

        It is that of the posterior, which contains the mean bias (G. Wahba (1983), Bayesian "confidence intervals" for
        the cross-validated smoothing spline, Journal of the Royal Statistical Society B 45).
        """
        count = min(math.ceil(np.ptp(places) / (self.reach / 2.0)) + 2, MOST_PLACES)
        at = np.linspace(places.min(), places.max(), count)
        return np.interp(places, at, [self._at(place, order) for place in at.tolist()])

    def _at(self, place: float, order: int) -> float:
        knots, size = self.spline.t, self.normal.shape[1]
        cell = min(max(int((place - knots[DEGREE]) / self.pitch), 0), size - DEGREE - 1)
        half = math.ceil(max(WINDOW * self.reach, 2.0 * self.gap) / self.pitch) + MARGIN
        low, high = max(cell - half, 0), min(cell + DEGREE + 1 + half, size)
        local = BSpline(knots[cell : cell + 2 * DEGREE + 2], np.eye(DEGREE + 1), DEGREE)
        own = np.zeros(high - low)
        own[cell - low : cell - low + DEGREE + 1] = local(place, order)
        return self.noise * math.sqrt(own @ solveh_banded(self.normal[:, low:high], own, lower=True))


def smooth(
    places: Numbers,
    samples: Numbers,
    pitch: float,
    noise: float | None = None,
    alike: float = 0.0,
    most: float = math.inf,
) -> Smooth:
    """Return the smooth function through samples, with a reach of at most `most`.

    Takes places (n,), samples (n, components), alike: length over which errors of samples are correlated, 0: not.
    """
    way, steps = float(places[-1] - places[0]), np.diff(places)
    cells = max(math.ceil(way / pitch), 1)
    pitch = way / cells
    knots = places[0] + pitch * np.arange(-DEGREE, cells + DEGREE + 1)
    inside = np.clip(places, knots[DEGREE], knots[-DEGREE - 1])
    white = _whitening(steps, alike)
    design, samples = white @ BSpline.design_matrix(inside, knots, DEGREE), white @ samples
    data, right = _bands(design.T @ design), design.T @ samples
    penalty = np.pad(_penalty(knots), ((0, data.shape[0] - DEGREE - 1), (0, 0)))
    best: tuple[float, float, float, float, float, Numbers, Numbers] | None = None
    for span in (pitch * np.geomspace(SHORTEST, LONGEST, STEPS)).tolist():
        reach = _reach(span, way / steps.size, alike)
        if best is not None and reach > most:
            break
        factor = places.size / way * span ** (2 * PENALISED)
        normal = data + factor * penalty
        freedom = _freedom(data, penalty, factor)
        found = cho_solve_banded((cholesky_banded(normal, lower=True), True), right)
        missed = float(np.sum((design @ found - samples) ** 2))
        score = _score(places.size, missed, freedom, noise)
        if best is None or score < best[0]:
            best = score, reach, factor, missed, freedom, found, normal
    assert best is not None
    _, reach, factor, missed, freedom, found, normal = best
    residual = math.sqrt(missed / max(places.size - freedom, 1.0))
    misfit = _misfit(float(np.sum(samples * (samples - design @ found))), samples, normal, factor)
    misfit -= samples.shape[1] * 2.0 * float(np.sum(np.log(white.diagonal())))
    told = residual if noise is None else noise
    return Smooth(BSpline(knots, found, DEGREE), reach, told, residual, pitch, normal, float(steps.max()), misfit)


def _whitening(steps: Numbers, alike: float) -> Any:
    """Return the matrix that makes errors independent which are correlated over the length `alike`."""
    keep = np.exp(-steps / alike) if alike else np.zeros_like(steps)
    scale = 1.0 / np.sqrt(1.0 - keep**2)
    bands = [np.append(1.0, scale), -keep * scale]
    return diags_array(bands, offsets=[0, -1], shape=(steps.size + 1, steps.size + 1)).tocsr()


def _reach(span: float, step: float, alike: float) -> float:
    """Return 1 over the wave number at which the smoother's response is a half.

    The response is 1 / (1 + (w span)^6 s), where s is the spectrum of the noise over that of independent noise.
    """
    if not alike:
        return span
    keep = math.exp(-step / alike)
    waves = np.geomspace(1e-3 / span, math.pi / step, 2000)
    spectrum = (1.0 - keep**2) / (1.0 - 2.0 * keep * np.cos(waves * step) + keep**2)
    return float(1.0 / np.interp(1.0, (waves * span) ** (2 * PENALISED) * spectrum, waves))


def _misfit(total: float, samples: Numbers, normal: Numbers, factor: float) -> float:
    """Return the restricted likelihood's logarithm times -2 for a sum of squares, without the noise's determinant."""
    count, components = samples.shape
    determinant = 2.0 * float(np.sum(np.log(cholesky_banded(normal, lower=True)[0])))
    rank = normal.shape[1] - PENALISED
    scale = math.log(max(total, 1e-300) / components / (count - PENALISED))
    return components * ((count - PENALISED) * scale + determinant - rank * math.log(factor))


def _score(count: int, missed: float, freedom: float, noise: float | None) -> float:
    if noise is not None:
        return missed + 2.0 * INFLATION * noise**2 * freedom
    left = count - INFLATION * freedom
    return count * missed / left**2 if left > 0.0 else math.inf


def _freedom(data: Numbers, penalty: Numbers, factor: float) -> float:
    """Return the trace of the smoother.

    The trace of penalty times inverse is the derivative of the logarithm of the determinant (Jacobi's formula).
    """
    more, less = (
        2.0 * float(np.sum(np.log(cholesky_banded(data + factor * math.exp(shift) * penalty, lower=True)[0])))
        for shift in (SHIFT, -SHIFT)
    )
    return data.shape[1] - (more - less) / (2.0 * SHIFT)


def _bands(matrix: Any) -> Numbers:
    """Return the lower bands of a sparse symmetric matrix, at least 6."""
    size, (rows, columns) = matrix.shape[0], matrix.nonzero()
    found = np.zeros((max(int(np.max(rows - columns)), DEGREE) + 1, size))
    for below in range(min(found.shape[0], size)):
        found[below, : size - below] = matrix.diagonal(-below)
    return found


def _penalty(knots: Numbers) -> Numbers:
    """Return the bands of the integral of products of third derivatives, over equal knots."""
    size, width = knots.size - DEGREE - 1, float(knots[1] - knots[0])
    cells = knots[DEGREE : size + 1]
    nodes, weights = np.polynomial.legendre.leggauss(PENALISED)
    places = (cells[:-1, None] + width * (nodes + 1.0) / 2.0).ravel()
    lower = BSpline.design_matrix(places, knots[PENALISED:-PENALISED], DEGREE - PENALISED)
    signs = np.array([-1.0, 3.0, -3.0, 1.0]) / width**PENALISED
    shape = (size - PENALISED, size)
    change = diags_array([np.full(shape[0], sign) for sign in signs], offsets=[0, 1, 2, 3], shape=shape)
    third = lower @ change
    return _bands(third.T @ diags_array(np.tile(weights * width / 2.0, cells.size - 1)) @ third)
