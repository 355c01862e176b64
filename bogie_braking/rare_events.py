"""Rare events: the probability that an output exceeds a limit, its confidence interval, and the causes."""

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

from bogie_braking.batches import BatchEnds, batch, prepared, threads_or_none, variables_of_batch
from bogie_braking.checks import MOST_INSTANCES, at_most, known, number, once, refused, seconds, shown, whole
from bogie_braking.line_in_file import file_of
from bogie_braking.machines import Runnable
from bogie_braking.provenance import encoded, encoded_value
from bogie_braking.reducers import is_statistic
from bogie_braking.splitting import POPULATIONS, Numbers, Population, climb, confidence_of, interval_of
from bogie_braking.splitting_doubts import doubts_about
from bogie_braking.sweeping import PAYS_FROM, check_executor
from fmu_src.batch import Ends, run_batch
from fmu_src.cosimulation.recording import Recording
from products.run_history import provenance_of
from products.study.points import outcomes_from
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line
from readers.extras import named_extras
from readers.renamed import FormerNames

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Number of runs that are repeated with another value of each input, to detect inputs without effect.
PROBES = 100
#: With fewer particles a median is not useful.
FEWEST_PARTICLES = 10
#: More moves than this cost time without a better estimate.
MOST_MOVES = 10_000
#: Rows of a tail.
ROWS = 200
#: Outputs that are final only if another one is 0.
STILL = {"distance": "speed"}


class Distribution(Protocol):
    """A frozen distribution of `scipy.stats`, such as `norm(0.15, 0.02)`."""

    def ppf(self, q: ArrayLike) -> Any:
        """Return the value below which a share `q` lies."""

    def isf(self, q: ArrayLike) -> Any:
        """Return the value above which a share `q` lies."""


@dataclass(frozen=True)
class Rare(FormerNames):
    """The probability that an output is above a limit, with its 95 % confidence interval.

    Attributes
    ----------
    probability : float
        Mean of the estimates.
    interval : tuple of float
        Its 95 % confidence interval.
    runs : int
        Number of runs.
    messages : list of str
        The result, and the warnings about it.
    estimates : array of shape (20,)
        Estimates of the populations.
    tail : Recording
        Probability and its interval for limits up to the given one.
    worst : Recording
        Values and output of the runs above the limit, the largest output first; the highest run if none is above.
    shifts : dict
        Causes: mean of each input in these runs, in standard deviations of a normal distribution off its median.
    """

    probability: float
    interval: tuple[float, float]
    runs: int
    messages: list[str]
    estimates: Numbers
    tail: Recording
    worst: Recording
    shifts: dict[str, float]

    @property
    def status(self) -> str:
        """The result and its warnings."""
        return " ".join(self.messages)

    def plot(self) -> Figure:
        """Plot the probability of exceeding a limit over the limit, with its interval."""
        with named_extras():
            from fmu_src.figure import NotebookFigure  # heavy

        output, *names = self.tail.names
        figure = NotebookFigure(figsize=(8.0, 4.5), layout="constrained")
        chart, seen = figure.subplots(), self.tail["lower"] > 0.0
        limits, middle, lower, upper = (self.tail[name][seen] for name in (output, *names))
        chart.semilogy(limits, middle, label="splitting")
        chart.fill_between(limits, lower, upper, alpha=0.3, label="95 % confidence interval of each limit")
        chart.set(xlabel=f"{output} [{self.tail.units[output]}]", ylabel="probability of more")
        chart.legend(loc="best")
        chart.grid(True, linewidth=0.3)
        return figure


@dataclass
class NormalRuns:
    """Make the runs of standard normal points, and count those with doubtful outputs.

    distributions: of the inputs, by the names that share each. make: makes runs of values by name, in one batch or
    several.
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
        """Return the output of each point, shape (points,); -inf if the run could not be made."""
        ends = self.make(values_of(self.distributions, points))
        found = np.concatenate([one[self.output] for one in ends])
        failures = [text for end in ends for text in end.failures.values()]
        self.failed += len(failures)
        self.first_failure = self.first_failure or next(iter(failures), "")
        if (still := STILL.get(self.output)) in ends[0].outputs:
            self.moving += int(np.sum((np.concatenate([one[still] for one in ends]) > 0.0) & (found <= self.limit)))
        return np.where(np.isnan(found), -np.inf, found)

    def without_effect(self, seed: int) -> tuple[list[str], int]:
        """Return the inputs whose value changes no run, and the number of runs made. Raises SimulationError."""
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
        """Warnings from the counts."""
        messages = []
        if self.failed:
            messages.append(
                f"{self.failed} runs failed and count as not above the limit; the first: {self.first_failure}"
            )
        if self.moving:
            messages.append(
                f"{self.moving} runs below the limit were still moving at their end; give a duration in which all stop."
            )
        return messages


def rare(
    what: Runnable | DataSheet,
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
    interval: float | None = None,
    **values: float,
) -> Rare:
    """Estimate the probability, down to 1e-12, that an output is above a limit at the end of a run, by splitting.

    Each halving of the probability takes 10 x particles x moves runs. One seed gives the same numbers for any number of
    threads and workers.

    Parameters
    ----------
    what : str, DataSheet, Vehicle, System or Model
        Vehicle or brake, as in `run`.
    duration : float
        Duration of each run [s].
    output : str
        Name of the output, or a statistic such as `maximum(slip_1)`, whose runs are made one by one.
    limit : float
        Limit in the unit of the output.
    vary : mapping
        Distributions of `scipy.stats` by the names of parameters and inputs, independent of each other. Names in a
        tuple share one value.
    line : Line, optional
        As in `run`.
    particles : int
        Number of particles in each of the 20 populations.
    moves : int
        Number of moves that separate a copy from its parent.
    seed : int
        Seed of the random numbers.
    threads : int, optional
        Number of threads; by default the number of processors.
    executor : Executor, optional
        Makes the runs in tasks of a thousand or more, as in `sweep`.
    interval : float, optional
        Interval of the rows of a run [s], for a statistic; by default 0.01 s.
    **values : float
        Other parameters and inputs by name, in SI units.

    Returns
    -------
    Rare
        Probability, interval, tail and the runs above the limit.

    Raises
    ------
    KeyError
        If a name is unknown.
    TypeError
        If a value of `vary` is not a distribution.
    ValueError
        If the limit or a count is invalid.
    SimulationError
        If no run can be made.
    """
    duration, limit = seconds("the duration", duration), finite(f"the limit of {output}", limit)
    particles = at_most("particles", whole("particles", particles, FEWEST_PARTICLES), MOST_INSTANCES)
    moves = at_most("moves", whole("moves", moves, 1), MOST_MOVES)
    seed, threads = whole("the seed", seed, 0), threads_or_none(threads)
    check_executor(executor, what)
    distributions = distributions_of(vary)
    if twice := {name for names in distributions for name in names} & values.keys():
        raise ValueError(f"{min(twice)} must have a distribution or a number; got both.")
    middle = values_of(distributions, np.zeros((1, len(distributions))))
    with tempfile.TemporaryDirectory() as folder:
        work = Work(what, duration, output, line, threads, executor, interval, values)
        output, units, identity, make = work.prepared(middle, folder)
        once((*middle, output), "column")
        runs = NormalRuns(distributions, make, output, limit)
        idle, probed = runs.without_effect(seed)
        populations, climbed = climb(runs, len(distributions), limit, particles, moves, seed)
    arguments = {"what": encoded(what), "duration": duration, "output": output, "limit": limit}
    arguments |= {"distributions": [[list(names), encoded(one)] for names, one in distributions.items()]}
    arguments |= {"particles": particles, "moves": moves, "seed": seed}
    arguments |= {"values": {name: encoded_value(value) for name, value in values.items()}, "line": encoded(line)}
    arguments |= {} if interval is None else {"interval": interval}
    provenance = provenance_of("rare", arguments, identity)
    return result_of(runs, populations, probed + climbed, moves, idle, units, provenance)


@dataclass(frozen=True)
class Work:
    """Runs of `rare`, with the names of its arguments."""

    what: Runnable | DataSheet
    duration: float
    output: str
    line: Line | None
    threads: int | None
    executor: Executor | None
    interval: float | None
    values: Mapping[str, Any]

    def prepared(
        self, middle: Mapping[str, Numbers], folder: str
    ) -> tuple[str, dict[str, str], str, Callable[[dict[str, Numbers]], list[Ends]]]:
        """Return the name of the output, units, the identity of the equations, and a function that makes runs.

        middle: one value of each input, shape (1,). folder: a temporary one.
        """
        if is_statistic(self.output):
            task = self._task([self.output], 1 if self.executor else self.threads)
            first = task(**middle)
            [output] = first.outputs
            units = {name: first.units[name] for name in (*middle, output)}
            return output, units, first.provenance.get("identity", ""), self._made_by(task)
        if self.interval is not None:
            raise ValueError(f"interval must be left out for a final value; got {shown(self.interval)}.")
        library, given = prepared(self.what, self.line, {**self.values, **middle})
        shared = {name: value for name, value in given.items() if name not in middle}
        variables = variables_of_batch(library)
        names = [known(self.output, variables, "variable")]
        names += [one for one in (STILL.get(self.output),) if one in variables]
        units = {name: variables[name].unit for name in (*middle, self.output)}
        if self.executor:
            return self.output, units, library.identity, self._made_by(self._task(names, 1))
        path = file_of(self.line, folder)

        def make(points: dict[str, Numbers]) -> list[Ends]:
            return [run_batch(library, {**shared, **points}, self.duration, names, self.threads, path)]

        return self.output, units, library.identity, make

    def _task(self, names: Sequence[str], threads: int | None) -> Callable[..., BatchEnds]:
        return partial(
            batch, self.what, self.duration, names, self.line, threads, False, self.interval, **dict(self.values)
        )

    def _made_by(self, task: Callable[..., BatchEnds]) -> Callable[[dict[str, Numbers]], list[Ends]]:
        if self.executor:
            return partial(made_by, self.executor, partial(called, task))
        return lambda points: [task(**points)]


def result_of(
    runs: NormalRuns,
    populations: Sequence[Population],
    count: int,
    moves: int,
    idle: Sequence[str],
    units: Mapping[str, str],
    provenance: Mapping[str, Any],
) -> Rare:
    """Return the result of populations at the end of their climb. idle: inputs without effect."""
    probability, *interval = confidence_of(populations, runs.limit)
    messages = [
        f"{runs.output} is above {runs.limit:g} {units[runs.output]} with a probability of {probability:.2g}, between "
        f"{interval[0]:.2g} and {interval[1]:.2g} with 95 % confidence, by {count} runs.",
        *(f"{name} has no effect: another value of it changed none of {PROBES} runs." for name in idle),
        *runs.doubts,
        *doubts_about(populations, runs.limit, moves, interval, runs.labels),
    ]
    estimates = np.array([population.probability for population in populations])
    tail, worst = tail_of(populations, runs, units), worst_of(populations, runs, units)
    tail.provenance, worst.provenance = ({**provenance, "part": part} for part in ("tail", "worst"))
    shifts = shifts_of(populations, runs)
    return Rare(probability, (interval[0], interval[1]), count, messages, estimates, tail, worst, shifts)


def distributions_of(vary: Mapping[str | tuple[str, ...], Distribution]) -> dict[tuple[str, ...], Distribution]:
    """Return distributions by the names that share each. Raises TypeError, ValueError."""
    if not isinstance(vary, Mapping) or not vary:
        such = "{'friction_1': scipy.stats.norm(0.15, 0.02)}"
        raise TypeError(f"vary must have distributions by name, such as {such}; got {shown(vary)}.")
    found = {(names,) if isinstance(names, str) else tuple(names): one for names, one in vary.items()}
    every = [name for names in found for name in names]
    for names, one in found.items():
        if not (callable(getattr(one, "ppf", None)) and callable(getattr(one, "isf", None))):
            such = "a distribution of scipy.stats, such as norm(0.15, 0.02)"
            raise TypeError(f"{', '.join(names)} must have {such}; got {shown(one)}.")
        if not np.isfinite(one.ppf(0.5)):
            raise ValueError(
                f"The distribution of {', '.join(names)} must have a median; got parameters that allow none."
            )
        if twice := next((name for name in names if every.count(name) > 1), None):
            raise ValueError(f"{twice} must have one distribution; got {every.count(twice)}.")
    return found


def values_of(distributions: Mapping[tuple[str, ...], Distribution], points: Numbers) -> dict[str, Numbers]:
    """Return values by name, shape (points,), of standard normal points, shape (points, inputs).

    The nearer tail is used because a share near 1 has no digits left: Rosenblatt's transform of independent inputs.
    """
    found: dict[str, Numbers] = {}
    for (names, one), column in zip(distributions.items(), points.T, strict=True):
        share = ndtr(-np.abs(column))
        found |= dict.fromkeys(names, np.where(column < 0.0, one.ppf(share), one.isf(share)))
    return found


def shifts_of(populations: Sequence[Population], runs: NormalRuns) -> dict[str, float]:
    """Return the mean standard normal number of each input above the limit, the largest first."""
    found = [
        (population.probability, population.points[population.outputs > runs.limit])
        for population in populations
        if population.probability > 0.0
    ]
    if not found:
        return {}
    weights, points = zip(*found, strict=True)
    means = np.average([np.mean(point, axis=0) for point in points], axis=0, weights=weights)
    order = np.argsort(-np.abs(means), kind="stable")
    return {runs.labels[place]: float(means[place]) for place in order}


def tail_of(populations: Sequence[Population], runs: NormalRuns, units: Mapping[str, str]) -> Recording:
    """Return probabilities above limits up to the given one, or to the highest output, with their intervals."""
    first = np.concatenate([population.generations[0].outputs for population in populations])
    highest = max(float(np.max(one.outputs)) for one in populations)
    end = min(runs.limit, highest)
    limits = np.linspace(min(end, float(np.min(first[np.isfinite(first)]))), end, ROWS).tolist()
    rows = [[limit, *interval_of(np.array([each.above(limit) for each in populations]))] for limit in limits]
    return Recording({runs.output: units[runs.output], "probability": "1", "lower": "1", "upper": "1"}, rows)


def worst_of(populations: Sequence[Population], runs: NormalRuns, units: Mapping[str, str]) -> Recording:
    """Return values and output of the runs above the limit, each once; the highest run if none is above."""
    points = np.concatenate([population.points for population in populations])
    outputs = np.concatenate([one.outputs for one in populations])
    kept = (outputs > runs.limit) | (outputs == np.max(outputs))
    table = np.unique(np.column_stack([outputs[kept], points[kept]]), axis=0)[::-1]
    columns = values_of(runs.distributions, table[:, 1:]) | {runs.output: table[:, 0]}
    return Recording(units, np.column_stack([columns[name] for name in units]), coordinates=[*units][:-1])


def made_by(
    executor: Executor, work: Callable[[Mapping[str, Numbers]], Ends], given: Mapping[str, Numbers]
) -> list[Ends]:
    """Return the ends of runs that an executor makes in tasks of at least a thousand, in their order."""
    count = len(next(iter(given.values())))
    parts = np.array_split(np.arange(count), max(1, count // PAYS_FROM))
    tasks = {number: {name: value[part] for name, value in given.items()} for number, part in enumerate(parts)}
    made = dict(outcomes_from(executor, work, tasks, len(tasks)))
    return [made[number].result() for number in tasks]


def called(task: Callable[..., Ends], values: Mapping[str, Numbers]) -> Ends:
    """Return the ends of one task of an executor."""
    return task(**values)


def finite(what: str, value: Any) -> float:
    """Return a finite number. Raises ValueError."""
    if not np.isfinite(number(value)):
        raise ValueError(f"{what[0].upper()}{what[1:]} must be a finite number; got {shown(value)}.")
    return float(value)
