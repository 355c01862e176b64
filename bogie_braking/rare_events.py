"""How rare is a long stop: the probability that an output is above a limit, how sure it is, and what made it so."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtr

from bogie_braking.batches import batch, file_of, prepared, threads_or_none, variables_of_batch
from bogie_braking.checks import MOST_INSTANCES, at_most, known, number, once, refused, seconds, shown
from bogie_braking.machines import Runnable, model_from
from bogie_braking.splitting import POPULATIONS, Numbers, Population, climb, confidence_of, interval_of
from bogie_braking.splitting_doubts import doubts_about
from bogie_braking.sweeping import PAYS_FROM, check_executor
from fmu_src.batch import Ends, run_batch
from fmu_src.cosimulation.recording import Recording
from fmu_src.system import System
from products.study.points import outcomes_from
from rbd_model.track.line import Line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Of each input so many runs are made again with another value, to see whether it has an effect.
PROBES = 100
#: Fewer particles have no middle to speak of.
FEWEST_PARTICLES = 10
#: More moves than this bring nothing but time.
MOST_MOVES = 10_000
#: Rows of a tail.
ROWS = 200
#: Outputs that are what they will be only when another one is 0.
STILL = {"distance": "speed"}


class Distribution(Protocol):
    """What scipy.stats calls a frozen distribution, such as `norm(0.15, 0.02)`."""

    def ppf(self, q: ArrayLike) -> Any:
        """The value below which a share `q` lies."""

    def isf(self, q: ArrayLike) -> Any:
        """The value above which a share `q` lies."""


@dataclass(frozen=True)
class Rare:
    """The probability that an output is above a limit, with its 95 % confidence interval.

    runs: how many were made. sentences: the result, and what is doubtful about it. estimates: of the populations, whose
    mean the probability is, shape (20,). tail: for limits up to the given one, the probability and its interval.
    worst: values and output of the runs above the limit, the largest output first; where none is, of the highest run.
    shifts: what made them so: their mean of each input, in standard deviations of a normal distribution off its median.
    """

    probability: float
    interval: tuple[float, float]
    runs: int
    sentences: list[str]
    estimates: Numbers
    tail: Recording
    worst: Recording
    shifts: dict[str, float]

    @property
    def status(self) -> str:
        """The result and its doubts."""
        return " ".join(self.sentences)

    def plot(self) -> Figure:
        """The probability of being above a limit, over the limit, with its interval."""
        from matplotlib.figure import Figure  # heavy

        output, *names = self.tail.names
        figure = Figure(figsize=(8.0, 4.5), layout="constrained")
        chart, seen = figure.subplots(), self.tail["lower"] > 0.0
        limits, middle, lower, upper = (self.tail[name][seen] for name in (output, *names))
        chart.semilogy(limits, middle, label="splitting")
        chart.fill_between(limits, lower, upper, alpha=0.3, label="95 % confidence interval of each limit")
        chart.set(xlabel=f"{output} [{self.tail.units[output]}]", ylabel="probability of more")
        chart.legend(loc="best")
        chart.grid(True, linewidth=0.3)
        return figure


@dataclass
class Runs:
    """Makes the runs of standard normal points, and counts those whose outputs are not what they seem.

    distributions: of the inputs, by the names that share each. make: runs of values by name, in one batch or several.
    """

    distributions: Mapping[tuple[str, ...], Distribution]
    make: Callable[[dict[str, Numbers]], list[Ends]]
    output: str
    limit: float
    moving: int = 0
    failed: int = 0
    first_failure: str = ""

    @property
    def labels(self) -> list[str]:
        """A name for each input."""
        return [", ".join(names) for names in self.distributions]

    def __call__(self, points: Numbers) -> Numbers:
        """The output of each point, shape (points,); -inf where the run could not be made."""
        ends = self.make(values_of(self.distributions, points))
        found = np.concatenate([one[self.output] for one in ends])
        failures = [text for one in ends for text in one.failures.values()]
        self.failed += len(failures)
        self.first_failure = self.first_failure or next(iter(failures), "")
        if (still := STILL.get(self.output)) in ends[0].outputs:
            self.moving += int(np.sum((np.concatenate([one[still] for one in ends]) > 0.0) & (found <= self.limit)))
        return np.where(np.isnan(found), -np.inf, found)

    def without_effect(self, seed: int) -> tuple[list[str], int]:
        """Inputs of which another value changes no run, and how many runs that took. Raises SimulationError."""
        random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(POPULATIONS,)))  # no population's
        count = len(self.labels)
        points, others = random.standard_normal((2, PROBES, count))
        every = np.repeat(points[None], count + 1, axis=0)
        for place in range(count):
            every[place + 1, :, place] = others[:, place]
        plain, *changed = np.split(self(every.reshape(-1, count)), count + 1)
        if np.all(plain == -np.inf):
            raise refused(f"None of {PROBES} runs could be made: {self.first_failure}")
        same = [name for name, found in zip(self.labels, changed, strict=True) if np.array_equal(plain, found)]
        return same, every.shape[0] * PROBES

    @property
    def doubts(self) -> list[str]:
        """What the counts say."""
        said = []
        if self.failed:
            said.append(f"{self.failed} runs failed and count as not above the limit; the first: {self.first_failure}")
        if self.moving:
            said.append(
                f"{self.moving} runs below the limit were still moving at their end; give a duration in which all stop."
            )
        return said


def rare(
    what: Runnable,
    duration: float,
    output: str,
    limit: float,
    vary: Mapping[str | tuple[str, ...], Distribution],
    line: Line | None = None,
    particles: int = 100,
    moves: int = 5,
    seed: int = 0,
    threads: int | None = None,
    executor: Executor | None = None,
    **values: float,
) -> Rare:
    """The probability that an output is above a limit at the end of a run, down to 1e-12, by splitting.

    what, duration [s], line, threads, values: as `batch` takes them, each value one number. limit: in the output's
    unit. vary: distributions of `scipy.stats` by the names of parameters and inputs, independent of each other; names
    in a tuple share one value. particles: of each of 20 populations. moves: that part a copy from its parent. Each
    halving of the probability takes 10 x particles x moves runs. executor: makes them in tasks of a thousand and more,
    as `sweep` takes it. One seed gives the same numbers on any number of threads and workers. Raises KeyError for a
    name that there is not, TypeError for what is no distribution, ValueError for what is no limit or count,
    SimulationError where no run can be made.
    """
    duration, limit = seconds("the duration", duration), finite(f"the limit of {output}", limit)
    particles = at_most("particles", whole("particles", particles, FEWEST_PARTICLES), MOST_INSTANCES)
    moves, seed, threads = (
        at_most("moves", whole("moves", moves, 1), MOST_MOVES),
        whole("the seed", seed, 0),
        threads_or_none(threads),
    )
    check_executor(executor, what)
    distributions = distributions_of(vary)
    if twice := {name for names in distributions for name in names} & values.keys():
        raise ValueError(f"Give {min(twice)} a distribution or a number, not both.")
    what = model_from(what) if isinstance(what, System) else what
    middle = values_of(distributions, np.zeros((1, len(distributions))))
    library, _ = prepared(what, line, {**values, **middle})
    variables = variables_of_batch(library)
    names = [known(output, variables, "variable")] + [one for one in (STILL.get(output),) if one in variables]
    once((*middle, output), "column")
    with tempfile.TemporaryDirectory() as folder:
        path = file_of(line, folder)

        def make(given: dict[str, Numbers]) -> list[Ends]:
            if executor is None:
                return [run_batch(library, {**values, **given}, duration, names, threads, path)]
            work = partial(one_task, what, duration, names, line, values)
            tasks = dict(enumerate(tasks_of(given)))
            made = dict(outcomes_from(executor, work, tasks, len(tasks)))
            return [made[number].result() for number in tasks]

        runs = Runs(distributions, make, output, limit)
        idle, probed = runs.without_effect(seed)
        populations, climbed = climb(runs, len(distributions), limit, particles, moves, seed)
    units = {name: variables[name].unit for name in (*middle, output)}
    return result_of(runs, populations, probed + climbed, moves, idle, units)


def result_of(
    runs: Runs,
    populations: Sequence[Population],
    count: int,
    moves: int,
    idle: Sequence[str],
    units: Mapping[str, str],
) -> Rare:
    """What populations tell that have climbed. idle: inputs without effect."""
    probability, *interval = confidence_of(populations, runs.limit)
    said = [
        f"{runs.output} is above {runs.limit:g} {units[runs.output]} with a probability of {probability:.2g}, between "
        f"{interval[0]:.2g} and {interval[1]:.2g} with 95 % confidence, by {count} runs.",
        *(f"{name} has no effect: another value of it changed none of {PROBES} runs." for name in idle),
        *runs.doubts,
        *doubts_about(populations, runs.limit, moves, interval, runs.labels),
    ]
    estimates = np.array([one.probability for one in populations])
    tail, worst = tail_of(populations, runs, units), worst_of(populations, runs, units)
    shifts = shifts_of(populations, runs)
    return Rare(probability, (interval[0], interval[1]), count, said, estimates, tail, worst, shifts)


def distributions_of(vary: Mapping[str | tuple[str, ...], Distribution]) -> dict[tuple[str, ...], Distribution]:
    """Distributions by the names that share each. Raises TypeError, ValueError."""
    if not isinstance(vary, Mapping) or not vary:
        such = "{'friction_1': scipy.stats.norm(0.15, 0.02)}"
        raise TypeError(f"Give what varies by its names, such as {such}: it was {shown(vary)}.")
    found = {(names,) if isinstance(names, str) else tuple(names): one for names, one in vary.items()}
    every = [name for names in found for name in names]
    for names, one in found.items():
        if not (callable(getattr(one, "ppf", None)) and callable(getattr(one, "isf", None))):
            such = "a distribution of scipy.stats, such as norm(0.15, 0.02)"
            raise TypeError(f"Give {', '.join(names)} {such}: it was {shown(one)}.")
        if not np.isfinite(one.ppf(0.5)):
            raise ValueError(f"Give {', '.join(names)} a distribution that there is: its parameters allow no median.")
        if twice := next((name for name in names if every.count(name) > 1), None):
            raise ValueError(f"Give {twice} one distribution: it has {every.count(twice)}.")
    return found


def values_of(distributions: Mapping[tuple[str, ...], Distribution], points: Numbers) -> dict[str, Numbers]:
    """Values by name, shape (points,), of standard normal points, shape (points, inputs).

    The nearer tail decides, for a share near 1 has no digits left: Rosenblatt's transform of independent inputs.
    """
    found: dict[str, Numbers] = {}
    for (names, one), column in zip(distributions.items(), points.T, strict=True):
        share = ndtr(-np.abs(column))
        found |= dict.fromkeys(names, np.where(column < 0.0, one.ppf(share), one.isf(share)))
    return found


def shifts_of(populations: Sequence[Population], runs: Runs) -> dict[str, float]:
    """Mean standard normal number of each input above the limit, the largest first; empty where nothing is above."""
    found = [(one.probability, one.points[one.outputs > runs.limit]) for one in populations if one.probability > 0.0]
    if not found:
        return {}
    weights, points = zip(*found, strict=True)
    means = np.average([np.mean(one, axis=0) for one in points], axis=0, weights=weights)
    order = np.argsort(-np.abs(means), kind="stable")
    return {runs.labels[place]: float(means[place]) for place in order}


def tail_of(populations: Sequence[Population], runs: Runs, units: Mapping[str, str]) -> Recording:
    """Probabilities above limits up to the given one, or to the highest output, with their intervals."""
    first = np.concatenate([one.generations[0].outputs for one in populations])
    highest = max(float(np.max(one.outputs)) for one in populations)
    end = min(runs.limit, highest)
    limits = np.linspace(min(end, float(np.min(first[np.isfinite(first)]))), end, ROWS).tolist()
    rows = [[one, *interval_of(np.array([each.above(one) for each in populations]))] for one in limits]
    return Recording({runs.output: units[runs.output], "probability": "1", "lower": "1", "upper": "1"}, rows)


def worst_of(populations: Sequence[Population], runs: Runs, units: Mapping[str, str]) -> Recording:
    """Values and output of the runs above the limit, each once; where none is, of the highest."""
    points = np.concatenate([one.points for one in populations])
    outputs = np.concatenate([one.outputs for one in populations])
    kept = (outputs > runs.limit) | (outputs == np.max(outputs))
    table = np.unique(np.column_stack([outputs[kept], points[kept]]), axis=0)[::-1]
    columns = values_of(runs.distributions, table[:, 1:]) | {runs.output: table[:, 0]}
    return Recording(units, np.column_stack([columns[name] for name in units]))


def tasks_of(given: Mapping[str, Numbers]) -> list[dict[str, Numbers]]:
    """Values in parts of at least a thousand runs, where there are so many."""
    count = len(next(iter(given.values())))
    parts = np.array_split(np.arange(count), max(1, count // PAYS_FROM))
    return [{name: value[part] for name, value in given.items()} for part in parts]


def one_task(
    what: Runnable,
    duration: float,
    names: Sequence[str],
    line: Line | None,
    values: Mapping[str, float],
    given: Mapping[str, Numbers],
) -> Ends:
    """What an executor is given: a batch in one thread."""
    numbers: dict[str, Any] = {**values, **given}
    return batch(what, duration, names, line, 1, **numbers)


def finite(what: str, value: Any) -> float:
    """A finite number. Raises ValueError."""
    if not np.isfinite(number(value)):
        raise ValueError(f"Give {what} as a finite number: it was {shown(value)}.")
    return float(value)


def whole(what: str, value: Any, least: int) -> int:
    """A whole number that is not too small. Raises ValueError."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise ValueError(f"Give {what} as a whole number, at least {least}: it was {shown(value)}.")
    return int(value)
