"""Train data from a run of an emergency or service brake: deceleration by speed, and equivalent build-up time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from products.supervision.steps import Steps
from products.supervision.train import MOST_STEPS
from readers.text import BadInputError

#: Share of the brake at which the build-up ends, SUBSET-026, 3.13.2.2.3, and share at which it begins.
DEVELOPED, BEGUN = 0.95, 0.01
#: Number of equal ranges of speed whose ends may be boundaries of steps.
RANGES = 60
#: Lowest speed at which a deceleration is read, as a share of the largest [1]: below it a stop ends.
LOWEST = 0.05


@dataclass(frozen=True)
class BrakeOfRun:
    """Brake of a train as one run shows it.

    Parameters
    ----------
    deceleration : Steps
        Step function of speed, nowhere above the deceleration of the run [m/s2].
    build_up : float
        Equivalent time: until the brake begins, and half of the time from there to 95 % [s].
    loss : float
        What the steps add to the braking distance with a lowest deceleration in each of 60 ranges of speed [1].
    """

    deceleration: Steps
    build_up: float
    loss: float


def brake_of_run(
    time: np.ndarray, speed: np.ndarray, share: np.ndarray, largest: float, most_steps: int = MOST_STEPS
) -> BrakeOfRun:
    """Return the train data that a stop on level track stands for.

    Takes time [s] (n), speed [m/s] (n), share (n), largest [m/s].
    """
    if not 1 <= most_steps <= MOST_STEPS:
        raise BadInputError(f"most_steps must be 1 to {MOST_STEPS} (SUBSET-026, 3.13.2.2.3); got {most_steps}.")
    begins, ends = (_first(time, share, limit) for limit in (BEGUN, DEVELOPED))
    at_end = float(np.interp(ends, time, speed))
    if at_end < largest:
        raise BadInputError(
            f"The brake must be developed to 95 % before the train is slower than {largest:.2f} m/s; got "
            f"{at_end:.2f} m/s. Begin the run at least {largest - at_end:.1f} m/s faster."
        )
    speeds, lowest = _lowest(time, speed, ends, largest)
    boundaries, values = _best_steps(speeds, lowest, most_steps)
    steps = Steps(boundaries, values)
    loss = _distance(speeds, steps.at(speeds[1:])) / _distance(speeds, lowest) - 1.0
    return BrakeOfRun(steps, begins + (ends - begins) / 2.0, loss)


def _first(time: np.ndarray, share: np.ndarray, limit: float) -> float:
    """Return when the share reaches a limit, between two rows."""
    above = np.nonzero(share >= limit)[0]
    if not above.size:
        raise BadInputError(
            f"The brake must develop to {100 * limit:g} %; got {100 * share.max():.0f} %. Run it longer."
        )
    n = int(above[0])
    if not n:
        return float(time[0])
    part = (limit - share[n - 1]) / (share[n] - share[n - 1])
    return float(time[n - 1] + part * (time[n] - time[n - 1]))


def _lowest(time: np.ndarray, speed: np.ndarray, after: float, largest: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the ends of ranges of speed, from 0, and the lowest deceleration between two rows in each of them."""
    later = time >= after - 1e-9
    times, found = time[later], speed[later]
    if found[-1] > LOWEST * largest:
        raise BadInputError(
            f"The run must end below {LOWEST * largest:.2f} m/s; got {found[-1]:.2f} m/s. Run it longer."
        )
    rates, faster, slower = -np.diff(found) / np.diff(times), found[:-1], found[1:]
    bounds = np.linspace(0.0, largest, RANGES + 1)
    moves = slower > 0.0
    lowest = np.full(RANGES, np.inf)
    for n in range(RANGES):
        inside = moves & (faster > bounds[n]) & (slower <= bounds[n + 1])
        if inside.any():
            lowest[n] = rates[inside].min()
    known = np.nonzero(np.isfinite(lowest))[0]
    lowest = lowest[known[np.searchsorted(known, np.arange(RANGES)).clip(max=known.size - 1)]]
    if lowest.min() <= 0.0:
        raise BadInputError(
            "The train must slow down at each speed of the run; it does not. Take a stop on level track."
        )
    return bounds, lowest


def _distance(speeds: np.ndarray, decelerations: np.ndarray) -> float:
    """Return the braking distance over ranges of speed [m]."""
    return float((np.diff(speeds**2) / (2.0 * decelerations)).sum())


def _best_steps(speeds: np.ndarray, lowest: np.ndarray, most: int) -> tuple[np.ndarray, np.ndarray]:
    """Return boundaries and values of the steps with the shortest distance that are nowhere above `lowest`.

    By dynamic programming over the ends of the ranges (Bellman, 1961).
    """
    count, squares = lowest.size, speeds**2
    cost = np.full((count, count + 1), np.inf)  # of one step from range i up to the end of range j - 1
    for i in range(count):
        least = np.minimum.accumulate(lowest[i:])
        cost[i, i + 1 :] = (squares[i + 1 :] - squares[i]) / (2.0 * least)
    best = np.full((most + 1, count + 1), np.inf)
    start = np.zeros((most + 1, count + 1), dtype=int)
    best[0, 0] = 0.0
    for used in range(1, most + 1):
        every = best[used - 1, :count, None] + cost
        best[used], start[used] = every.min(axis=0), every.argmin(axis=0)
    used, end, ends = int(best[:, count].argmin()), count, []
    while end:
        ends.append(end)
        used, end = used - 1, int(start[used, end])
    ends = ends[::-1]
    values = [lowest[first:last].min() for first, last in zip([0, *ends], ends, strict=False)]
    return speeds[ends[:-1]], np.array(values)
