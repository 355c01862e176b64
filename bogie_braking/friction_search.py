"""Search for the field of friction that fits logged speeds best, and its intervals.

The speed in log j is v_j(t) = v_j0 + gain(t; mu (1 + d_j), ...) + e_j(t). Its friction is the field times 1 + d_j. The
d_j are normal, and their standard deviation is the scatter between logs. The errors e_j may be correlated in time
(`correlated.py`). Such mixed models and the restricted likelihood of their variances: Searle, Casella and McCulloch
(1992), Variance Components.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import least_squares, minimize_scalar
from scipy.stats import t

from bogie_braking.correlated import Errors, errors_of
from bogie_braking.friction_logs import Numbers
from bogie_braking.friction_model import Axles, LogStretch

#: Rows are averaged over this time [s]. Time between the errors of two logs, which are independent [s].
BLOCK, APART = 0.2, 1e4
#: Error of a speed before the first search [m/s], least one over the largest of all logs; ratio to the median within
#: which errors of logs are treated as equal.
ERROR, LEAST_ERROR, ALIKE = 0.05, 1e-3, 2.0
#: Scatter between logs that is as good as none, and one that hardly restricts it.
NO_SCATTER, FREE_SCATTER = 1e-3, 0.5
#: Least share of a direction of the d_j that logs determine, for its use in the estimate of the scatter.
DETERMINED = 0.1
#: Probability that an interval holds, and relative step of a finite difference.
HOLDS, STEP = 0.95, 1e-4
#: Relative change of parameters and of squares with which a search ends.
SETTLED = 1e-6
#: Least eigenvalue of the normal equations over the largest; least share of a parameter in a direction below it.
SINGULAR, NAMED = 1e-10, 0.1


@dataclass(frozen=True)
class Search:
    """Logged speeds as functions of the parameters.

    The parameters are the friction at the knots with sliding wheels, `beside`, a factor on logged torques, and d_j of
    each log. The factor is omitted without logged torques. determined: mask of the knots that are parameters. rail:
    other numbers of the rail.
    """

    axles: Axles
    stretches: list[LogStretch]
    determined: np.ndarray
    beside: tuple[str, ...]
    by_torque: bool
    rail: dict[str, float]

    @cached_property
    def logs(self) -> np.ndarray:
        """Numbers of the logs, one for each d_j."""
        return np.unique([stretch.log for stretch in self.stretches])

    @cached_property
    def of_log(self) -> np.ndarray:
        """Place of the log of each stretch among `logs`."""
        return np.searchsorted(self.logs, [stretch.log for stretch in self.stretches])

    @property
    def count(self) -> int:
        """Number of knots that are parameters."""
        return int(self.determined.sum())

    @property
    def shared(self) -> int:
        """Number of parameters that all logs have in common."""
        return self.count + len(self.beside) + int(self.by_torque)

    def moments(self) -> Numbers:
        """Return the time of each block [s], increasing; logs are so far apart that their errors are independent."""
        times = [stretch.time[0] + np.unique(block_of(stretch)) * BLOCK for stretch in self.stretches]
        first = [times[int(np.argmax(self.of_log == log))][0] for log in range(self.logs.size)]
        own = [each - first[log] for each, log in zip(times, self.of_log, strict=True)]
        longest = max(each[-1] for each in own)
        return np.concatenate([each + log * (longest + APART) for each, log in zip(own, self.of_log, strict=True)])

    def both(self, x: Numbers) -> tuple[list[Numbers], list[Numbers]]:
        """Return modelled less logged speeds of each stretch [m/s], and their derivatives by the parameters.

        Shapes (blocks,) and (blocks, parameters). They are averaged over BLOCK, without their means.
        """
        field, off, slopes = np.full(self.determined.size, float(np.mean(x[: self.count]))), [], []
        field[self.determined] = x[: self.count]
        rail = self.rail | dict(zip(self.beside, x[self.count :].tolist(), strict=False))
        torque = float(x[self.shared - 1]) if self.by_torque else 1.0
        for stretch, log in zip(self.stretches, self.of_log, strict=True):
            factor = 1.0 + float(x[self.shared + log])
            gain, own = stretch.model(self.axles, factor * field, rail, torque)
            found = np.zeros((gain.size, x.size))
            found[:, : self.count] = factor * own[:, :-1][:, self.determined]
            for place, name in enumerate(self.beside, self.count):
                size = STEP * max(abs(x[place]), STEP)
                up, down = (
                    stretch.model(self.axles, factor * field, rail | {name: x[place] + end}, torque)[0]
                    for end in (size, -size)
                )
                found[:, place] = (up - down) / (2 * size)
            if self.by_torque:
                found[:, self.shared - 1] = own[:, -1]
            found[:, self.shared + log] = own[:, :-1] @ field
            off.append(blocks(stretch, gain - stretch.speed))
            slopes.append(blocks(stretch, found))
        return off, slopes

    def weighted(self, x: Numbers, errors: Numbers) -> tuple[Numbers, Numbers]:
        """Return `both` over the error of each log [m/s], all stretches below each other."""
        off, slopes = ([own / errors[log] for own, log in zip(each, self.of_log, strict=True)] for each in self.both(x))
        return np.concatenate(off), np.vstack(slopes)

    def fitted(self, first: Numbers, limits: Numbers, errors: Numbers, scatter: float) -> Numbers:
        """Return the parameters that fit best, by the errors of the logs [m/s] and the scatter between them."""
        last = dict[bytes, tuple[Numbers, Numbers]]()
        prior = np.eye(first.size)[self.shared :] / scatter

        def at(x: Numbers) -> tuple[Numbers, Numbers]:
            if x.tobytes() not in last:
                last.clear()
                off, slopes = self.weighted(x, errors)
                last[x.tobytes()] = np.r_[off, prior @ x], np.vstack([slopes, prior])
            return last[x.tobytes()]

        found = least_squares(
            lambda x: at(x)[0], first, lambda x: at(x)[1], bounds=limits.T, x_scale="jac", xtol=SETTLED, ftol=SETTLED
        )
        return np.asarray(found.x)

    def deviations(self, x: Numbers) -> Numbers:
        """Return the standard deviation of the speeds of each of `logs` from the modelled ones [m/s]."""
        squares, counts = np.zeros(self.logs.size), np.zeros(self.logs.size)
        for log, off in zip(self.of_log, self.both(x)[0], strict=True):
            squares[log] += float(off @ off)
            counts[log] += off.size - 1
        return np.sqrt(squares / counts)


@dataclass(frozen=True)
class SearchResult:
    """Result of a search: parameters, their standard errors (infinite: not determined), half of their intervals, the
    scatter between logs, and deviations of the logged speeds [m/s].
    """

    x: Numbers
    standard: Numbers
    half: Numbers
    scatter: float
    deviations: Numbers


def search(problem: Search, first: Numbers, limits: Numbers) -> SearchResult:
    """Return the parameters that fit best, with intervals; first, limits: of the shared parameters."""
    first = np.r_[first, np.zeros(problem.logs.size)]
    limits = np.vstack([limits, np.tile([-0.9, 9.0], (problem.logs.size, 1))])
    x = problem.fitted(first, limits, np.full(problem.logs.size, ERROR), NO_SCATTER)
    errors, scatter, directions = _errors(problem, x), NO_SCATTER, 0
    if problem.logs.size > 1:
        x = problem.fitted(x, limits, errors, FREE_SCATTER)
        errors = _errors(problem, x)
        scatter, directions = _scatter(problem, x, errors)
    x = problem.fitted(x, limits, errors, scatter)
    deviations, lost, by_noise, by_scatter = problem.deviations(x), *_variances(problem, x, errors, scatter)
    total = np.diag(by_noise) + np.diag(by_scatter)
    standard = np.where(lost, np.inf, np.sqrt(total))
    # Satterthwaite's degrees of freedom: the scatter is known from a few logs, the errors from many rows.
    free = max(directions, 1) * (total / np.maximum(np.diag(by_scatter), 1e-300)) ** 2
    return SearchResult(x, standard, t.ppf(0.5 + HOLDS / 2, np.minimum(free, 1e6)) * standard, scatter, deviations)


def block_of(stretch: LogStretch) -> np.ndarray:
    """Return the number of the block of each row."""
    return np.asarray(np.floor((stretch.time - stretch.time[0]) / BLOCK + 1e-9).astype(int))


def blocks(stretch: LogStretch, rows: Numbers) -> Numbers:
    """Return means of rows over BLOCK, without the mean of the stretch, whose first speed is not known."""
    used, inverse, counts = np.unique(block_of(stretch), return_inverse=True, return_counts=True)
    found = np.zeros((used.size, *rows.shape[1:]))
    np.add.at(found, inverse, rows)
    found /= counts.reshape(-1, *[1] * (rows.ndim - 1))
    return np.asarray(found - found.mean(axis=0))


def _errors(problem: Search, x: Numbers) -> Numbers:
    """Return the errors of the logs by which they are weighted [m/s]; one for all whose deviations are alike.

    Those of single logs are known too badly for weights if errors are correlated in time.
    """
    found = problem.deviations(x)
    found = np.maximum(found, max(LEAST_ERROR * found.max(), 1e-9))
    usual = np.median(found)
    alike = (found < ALIKE * usual) & (found > usual / ALIKE)
    return np.where(alike, np.sqrt(np.mean(found[alike] ** 2)), found)


def _errors_in_time(problem: Search, off: Numbers, slopes: Numbers) -> tuple[Numbers, Errors]:
    """Return the times of weighted speeds [s], and the correlation of their errors."""
    sizes = [np.unique(block_of(stretch)).size for stretch in problem.stretches]
    begins = np.eye(len(sizes))[np.repeat(np.arange(len(sizes)), sizes)]
    moments = problem.moments()
    return moments, errors_of(moments, off, np.c_[slopes / np.maximum(np.linalg.norm(slopes, axis=0), 1e-300), begins])


def _variances(problem: Search, x: Numbers, errors: Numbers, scatter: float) -> tuple[np.ndarray, Numbers, Numbers]:
    """Return which parameters are not determined, and covariances of the others by errors and by scatter.

    The parameters are (X'X + P)^-1 X' y with the prior P of the d_j, whose true values have this prior.
    """
    off, slopes = problem.weighted(x, errors)
    moments, in_time = _errors_in_time(problem, off, slopes)
    prior = np.zeros(x.size)
    prior[problem.shared :] = scatter**-2
    lost, inverse = _inverse(slopes.T @ slopes + np.diag(prior))
    pulled = slopes @ inverse
    by_scatter = inverse * prior @ inverse
    return lost, pulled.T @ in_time.times(moments, pulled), by_scatter


def _inverse(matrix: Numbers) -> tuple[np.ndarray, Numbers]:
    """Return the rows of a symmetric matrix that are mixed in its null space, and its inverse without that."""
    lengths = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    sizes, directions = np.linalg.eigh(matrix / np.outer(lengths, lengths))
    lost = sizes < SINGULAR * sizes[-1]
    kept = directions[:, ~lost]
    mixed = (np.abs(directions[:, lost]) > NAMED).any(axis=1)
    return mixed, (kept / sizes[~lost]) @ kept.T / np.outer(lengths, lengths)


def _scatter(problem: Search, x: Numbers, errors: Numbers) -> tuple[float, int]:
    """Return the scatter between logs by restricted likelihood, and the number of directions that it follows from.

    x: parameters with hardly restricted d_j. These are R d + noise for true d.
    """
    off, slopes = problem.weighted(x, errors)
    moments, in_time = _errors_in_time(problem, off, slopes)
    prior = np.zeros(x.size)
    prior[problem.shared :] = FREE_SCATTER**-2
    _, inverse = _inverse(slopes.T @ slopes + np.diag(prior))
    pulled = slopes @ inverse[:, problem.shared :]
    response = np.eye(problem.logs.size) - inverse[problem.shared :, problem.shared :] * prior[problem.shared :]
    left, sizes, _ = np.linalg.svd(response)
    told = left[:, sizes > DETERMINED]
    if not told.shape[1]:
        return NO_SCATTER, 0
    seen, noise = told.T @ x[problem.shared :], told.T @ (pulled.T @ in_time.times(moments, pulled)) @ told
    spread = told.T @ response @ response.T @ told

    def cost(logarithm: float) -> float:
        covariance = np.exp(2.0 * logarithm) * spread + noise
        return float(np.linalg.slogdet(covariance)[1] + seen @ np.linalg.solve(covariance, seen))

    limits = np.log(NO_SCATTER), np.log(FREE_SCATTER)
    found = minimize_scalar(cost, bounds=limits, method="bounded")
    best = found.x if found.fun < cost(limits[0]) else limits[0]
    return float(np.exp(best)), int(told.shape[1])
