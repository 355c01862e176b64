"""Wheel-slide controllers tuned over random stops: thresholds of the protection, and a small policy; by CMA-ES.

Half of the stops are for choosing, the others for reporting: their seeds are even, or odd.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bogie_braking.reporting.progress import counting
from brake_controller.slide_protection import SlideProtectionParameters, common_protection
from products.machine import bogie
from products.protection.controller_kinds import ManyControllers
from products.protection.cost import cost_of_no_stop, rolling_stop
from products.protection.draws import drawn_run
from products.protection.environment import Environment
from products.protection.runs import Run
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from products.study.points import process_pool
from readers.extras import named_extras

Numbers = NDArray[np.float64]
#: Period of the controllers and of the integration steps [s].
SETTINGS = Settings(period=10e-3)
#: Longest time of a stop [s], to which the cost of an unfinished stop is extrapolated.
PATIENCE = 200.0
#: Tuned thresholds, each by a factor on the common one; the width of the band of slips is one of them.
TUNED = ("lower_slip", "band_of_slips", "evident_slip", "lead_time", "calm_time", "synchronising_period")
#: Initial steps of the search, of the logarithm of a threshold and of a weight.
FIRST_FACTORS, FIRST_WEIGHTS = 0.2, 0.5
#: Time constant of the policy's filters [s], and fastest fall of its reference [m/s2].
FILTER, FALLS = 0.04, 4.4
#: Number of inputs of a wheelset to the policy: see `Policy`.
KNOWS = 7


def for_choosing(count: int) -> list[Run]:
    """Draw `count` stops of the bogie with even seeds."""
    return [drawn_run(np.random.default_rng(2 * number), 2) for number in range(count)]


def for_reporting(count: int) -> list[Run]:
    """Draw `count` other stops, with odd seeds."""
    return [drawn_run(np.random.default_rng(2 * number + 1), 2) for number in range(count)]


@dataclass(frozen=True)
class Played:
    """Costs of stops (cost.py), their distances over those of rolling wheels, and their longest locks [s].

    All have the shape (stops,); a distance is NaN if the run did not stop.
    """

    cost: Numbers
    over_rolling: Numbers
    longest_lock: Numbers

    def line(self, name: str) -> str:
        """Return a line of a table; the mean of the distances excludes runs that did not stop."""
        distances = self.over_rolling[~np.isnan(self.over_rolling)]
        mean = f"{distances.mean():8.3f}" if distances.size else "       -"
        return (
            f"{name:12}{self.cost.mean():8.3f}{mean}{self.longest_lock.max():8.2f}{len(self.cost) - distances.size:6}"
        )


#: The heads of `line`.
HEADS = f"{'':12}{'cost':>8}{'s/s0':>8}{'lock':>8}{'none':>6}"


def play(controller: ManyControllers, runs: Sequence[Run]) -> Played:
    """Run these stops under a controller of many vehicles."""
    waiting, unused = iter(runs), np.random.default_rng(0)
    draw, step = (lambda random, wheelsets: next(waiting)), SETTINGS.period
    environment = Environment(bogie(), SETTINGS, len(runs), draw, privileged=True, step=step)
    environment.begin(range(len(runs)), [unused] * len(runs))
    controller.start(np.arange(len(runs)), len(runs), 2, SETTINGS.period)
    cost, goes_on, time = np.zeros(len(runs)), np.ones(len(runs), bool), 0.0
    while goes_on.any() and time < PATIENCE:
        environment.turn(controller.step(np.full(len(runs), time), environment.observation[:, :2]))
        cost -= environment.reward
        goes_on &= ~(environment.terminated | environment.truncated)
        time += SETTINGS.period
    stops = [environment.stop(row) for row in range(len(runs))]
    rolls = np.array(
        [rolling_stop(environment.machine, SETTINGS, run.speed or SETTINGS.speed).distance for run in runs]
    )
    cost += goes_on * cost_of_no_stop(environment.observation[:, 5], time, rolls)
    environment.close()
    over = np.array([stop.distance or np.nan for stop in stops]) / rolls
    return Played(cost, np.where(goes_on, np.nan, over), np.array([one.longest_lock for one in stops]))


class Applied:
    """A controller that keeps all brakes applied."""

    def start(self, rows: NDArray[np.intp], count: int, wheelsets: int, period: float) -> None:
        """Start without a state."""

    def step(self, time: Numbers, wheel_speeds: Numbers) -> NDArray[np.integer]:
        """Return the commands of all vehicles."""
        return np.zeros(wheel_speeds.shape, np.int32)


# ---- the protection that comes with the brake ------------------------------------------------------------------------


class Protections:
    """The protection of each vehicle, with the same thresholds; that of a vehicle at rest is no longer called."""

    def __init__(self, thresholds: SlideProtectionParameters) -> None:
        self.thresholds = thresholds

    def start(self, rows: NDArray[np.intp], count: int, wheelsets: int, period: float) -> None:
        """Start the protections of all vehicles."""
        self.each = [SlideProtection(self.thresholds) for _ in range(count)]
        self.commands = np.zeros((count, wheelsets), np.int32)
        self.before = np.full((count, wheelsets), -1.0)

    def step(self, time: Numbers, wheel_speeds: Numbers) -> NDArray[np.integer]:
        """Return the commands of all vehicles."""
        stands = ~wheel_speeds.any(axis=1) & ~self.before.any(axis=1) & (time > 10.0)
        self.before = wheel_speeds.copy()
        for row, (at, speeds) in enumerate(zip(time.tolist(), wheel_speeds.tolist(), strict=True)):
            if not stands[row]:
                self.commands[row] = self.each[row].step(at, speeds)
        return self.commands


def thresholds_of(factors: Sequence[float] | Numbers) -> SlideProtectionParameters:
    """Return the common thresholds times these factors (TUNED), given by their logarithms."""
    common, times = common_protection(), dict(zip(TUNED, np.exp(factors).tolist(), strict=True))
    band = (common.upper_slip - common.lower_slip) * times.pop("band_of_slips")
    changed = {name: getattr(common, name) * factor for name, factor in times.items()}
    return replace(common, **changed, upper_slip=changed["lower_slip"] + band)


def cost_of_thresholds(runs: Sequence[Run], factors: Sequence[float]) -> float:
    """Return the mean cost over these stops."""
    return float(play(Protections(thresholds_of(factors)), runs).cost.mean())


def tuned_thresholds(runs: Sequence[Run], generations: int, processes: int = 2) -> SlideProtectionParameters:
    """Return the thresholds that CMA-ES found on these stops, in `processes` processes."""
    with process_pool(processes) as pool:
        every = partial(pool.map, partial(cost_of_thresholds, runs))
        best = least(lambda points: list(every(points)), [0.0] * len(TUNED), FIRST_FACTORS, generations)
    return thresholds_of(best)


# ---- a policy --------------------------------------------------------------------------------------------------------


class Policy:
    """A linear policy: each wheelset's command is the largest of three sums; the sum of "apply" is 0.

    Its inputs for each wheelset are the slip relative to a reference, the slip of the slowest, the filtered
    acceleration, the last hold and vent commands, the slowness of the reference, and 1. The reference is the fastest
    wheel's speed, with its rate of fall limited by the last weight. weights: shape (machines, 2 KNOWS + 1), or one row
    for all.
    """

    def __init__(self, weights: Numbers) -> None:
        every = np.atleast_2d(weights)
        self.weights = every[:, :-1].reshape(len(every), KNOWS, 2)
        self.falls = FALLS / (1.0 + np.exp(-every[:, -1]))

    def start(self, rows: NDArray[np.intp], count: int, wheelsets: int, period: float) -> None:
        """Start all vehicles."""
        self.reference, self.period = np.zeros(count), period
        self.speed, self.slope = np.zeros((count, wheelsets)), np.zeros((count, wheelsets))
        self.commands = np.zeros((count, wheelsets), np.int64)

    def step(self, time: Numbers, wheel_speeds: Numbers) -> NDArray[np.integer]:
        """Return the commands of all vehicles."""
        share = self.period / (self.period + FILTER)
        change = (wheel_speeds - self.speed) * share
        self.speed += change
        self.slope += (change / self.period - self.slope) * share
        self.reference = np.maximum(wheel_speeds.max(axis=1), self.reference - self.falls * self.period)
        reference = np.maximum(self.reference, 0.5)[:, None]
        known = np.empty((*wheel_speeds.shape, KNOWS))
        known[..., 0] = (reference - wheel_speeds) / reference
        known[..., 1] = known[..., 0].max(axis=1, keepdims=True)
        known[..., 2] = np.clip(self.slope / 5.0, -2.0, 2.0)
        known[..., 3], known[..., 4] = self.commands == 1, self.commands == 2
        known[..., 5], known[..., 6] = 1.0 / (1.0 + reference), 1.0
        sums = np.matmul(known, self.weights)
        hold, vent = sums[..., 0], sums[..., 1]
        self.commands = np.where(np.maximum(hold, vent) <= 0.0, 0, np.where(vent > hold, 2, 1))
        return self.commands


def first_weights() -> Numbers:
    """Return weights that vent above a slip of some 0.2, hold above 0.1, and apply all brakes near rest."""
    weights = np.zeros((KNOWS, 2))
    weights[0], weights[5], weights[6] = (5.0, 10.0), (-10.0, -20.0), (-0.5, -2.0)
    return np.append(weights.ravel(), 0.0)


def trained_policy(runs: Sequence[Run], generations: int) -> Policy:
    """Return the policy that CMA-ES found on these stops; all candidates of a generation run at once, in one vector."""

    def costs(points: Sequence[Numbers]) -> list[float]:
        rows = np.repeat(np.array(points), len(runs), axis=0)
        played = play(Policy(rows), list(runs) * len(points))
        return list(played.cost.reshape(len(points), len(runs)).mean(axis=1))

    return Policy(np.array(least(costs, first_weights(), FIRST_WEIGHTS, generations)))


# ---- the search ------------------------------------------------------------------------------------------------------


def least(
    costs: Callable[[Sequence[Numbers]], list[float]], first: Sequence[float] | Numbers, step: float, generations: int
) -> Numbers:
    """Return the mean of the last generation of CMA-ES, with the same random numbers each time.

    Takes first (n,).
    """
    with named_extras():
        import cma
    search = cma.CMAEvolutionStrategy(first, step, {"seed": 1, "verbose": -9})
    with counting(total=generations, text="generations", unit="") as bar:
        for _ in range(generations):
            points = search.ask()
            search.tell(points, costs(points))
            bar.update()
    return np.asarray(search.result.xfavorite)
