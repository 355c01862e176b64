"""Fit of one field of friction over place to many logs of sliding wheels, with its intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from bogie_braking.checks import known, line_or_none, near, number, shown
from bogie_braking.fitting import check_begin
from bogie_braking.friction_logs import FrictionLog, Numbers, friction_logs
from bogie_braking.friction_model import OF_RAIL, SLIDES, Axles, LogStretch, stretches_of, used_adhesion
from bogie_braking.friction_search import NO_SCATTER, Search, SearchResult, block_of, search
from products.machine import MACHINES
from products.registry import fmu_named
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line
from rbd_model.vehicle.description import Vehicle
from readers.extras import named_extras, need
from readers.log_columns import ColumnMap

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Name of the field among the parameters, and what may be fitted beside it.
FIELD, BESIDE = "friction", ("friction_ratio", "friction_decay", "cleaned_friction")
#: Limits of a friction coefficient, and of the factor on logged torques.
FRICTIONS, TORQUES = (1e-3, 2.0), (0.2, 5.0)
#: Time over which used adhesion is taken [s], and fewest averages of a stretch that is used.
OVER, FEWEST = 1.0, 3
#: Largest number of knots. Deviation of a log over the usual one from which a message names it. Relative distance from
#: a limit.
MOST_PLACES, OUTLIER, AT_LIMIT = 2000, 3.0, 1e-3


@dataclass(frozen=True)
class FrictionField:
    """Friction over place, linear between places.

    Attributes
    ----------
    places : array, shape (n,)
        Distances along the line [m].
    values, lower, upper : array, shape (n,)
        Friction without sliding, and its 95 % intervals [1]. A value is NaN, and `upper` is infinite, if the logs do
        not determine it. `lower` is then the largest adhesion that rolling wheels used nearby, or 0.
    logs : array, shape (n,)
        Number of logs with sliding wheels near each place.
    others : dict
        Other fitted parameters, and `torque_factor`: fitted over logged brake torques.
    standard_errors : dict
        Standard errors of `others`.
    scatter : float
        Standard deviation of the friction between logs, relative to the field [1].
    deviations : dict
        Standard deviation of the logged speeds of each log from the fitted ones [m/s].
    messages : list of str
        Places and logs that were used, and warnings.
    """

    places: Numbers
    values: Numbers
    lower: Numbers
    upper: Numbers
    logs: Numbers
    others: dict[str, float]
    standard_errors: dict[str, float]
    scatter: float
    deviations: dict[str, float]
    messages: list[str]

    @property
    def status(self) -> str:
        """The messages."""
        return " ".join(self.messages)

    def plot(self) -> Figure:
        """Plot the field with its intervals, and lower limits where it is not determined."""
        with named_extras():
            from fmu_src.figure import NotebookFigure  # heavy

        figure = NotebookFigure(figsize=(8, 4), layout="constrained")
        chart = figure.subplots()
        there = np.isfinite(self.values)
        both = np.maximum([self.values - self.lower, self.upper - self.values], 0.0)[:, there]
        chart.errorbar(self.places[there], self.values[there], both, fmt="o-", capsize=3, label="friction, 95 %")
        if not there.all():
            chart.plot(self.places[~there], self.lower[~there], "^", color="0.5", label="at least (used adhesion)")
        chart.set(xlabel="place [m]", ylabel="friction [1]", ylim=(0.0, None))
        chart.legend()
        return figure


def fit_friction(
    what: Any,
    measured: Any,
    parameters: Mapping[str, float],
    places: ArrayLike,
    line: Line | None,
    columns: ColumnMap | None,
    values: Mapping[str, Any],
) -> FrictionField:
    """Fit a field of friction; arguments and errors are those of `calibration.fit`."""
    need("casadi")
    vehicle, runs, per_pressure, own = _vehicle_of(what)
    rail, given = _rail_of(parameters, vehicle, own, values)
    if "full_torque" in given and per_pressure is not None:
        per_pressure = given.pop("full_torque") / MACHINES[fmu_named(what)]().full_pressure
    axles, line = Axles.of(vehicle, given, runs), line_or_none(line)
    logs = friction_logs(measured, axles.radii.tolist(), per_pressure, columns)
    at = _places_of(places, logs, axles)
    stretches = [stretch for n, log in enumerate(logs) for stretch in stretches_of(log, n, axles, at, line)]
    stretches = [one for one in stretches if np.unique(block_of(one)).size >= FEWEST]
    if not stretches:
        raise ValueError(
            f"No log determines friction: in none do wheels slide by {SLIDES:.0%} while the others slide too or have a "
            "brake_torque or pressure. Check the columns, or give logs of stops with sliding wheels."
        )
    weight = np.array([_time_near(one) for one in stretches])
    by_torque = any(np.any(one.by_torque != 0.0) for one in stretches)
    beside = tuple(name for name in parameters if name != FIELD)
    problem = Search(axles, stretches, weight.sum(axis=0) > 0.0, beside, by_torque, rail)
    start = [parameters[FIELD]] * problem.count + [parameters[one] for one in beside] + [1.0] * by_torque
    limits = [FRICTIONS] * problem.count + [_limits(one) for one in beside] + [TORQUES] * by_torque
    found = search(problem, np.array(start), np.array(limits))
    return _field_of(problem, found, logs, at, weight)


def _vehicle_of(what: Any) -> tuple[Vehicle, str | Vehicle, float | None, dict[str, float]]:
    """Return a vehicle, what runs, the torque of a wheelset per pressure [N.m/Pa] if it is known, and its values."""
    if isinstance(what, DataSheet):
        return what.vehicle, what.vehicle, None, {name: float(value) for name, value in what.resistance.items()}
    if isinstance(what, Vehicle):
        return what, what, None, {}
    if not isinstance(what, str):
        raise TypeError(f"The fit of a field of friction must have a vehicle or its name; got {shown(what)}.")
    own = {"braked-vehicle": "vehicle"}.get(fmu_named(what), fmu_named(what))
    machine = MACHINES[known(own, MACHINES, "vehicle with brakes")]()
    return machine.vehicle, machine.name, machine.full_torque / machine.full_pressure, {}


def _rail_of(
    parameters: Mapping[str, float], vehicle: Vehicle, own: Mapping[str, float], values: Mapping[str, Any]
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the numbers of the rail, and those of the vehicle. Raises ValueError."""
    for name, value in parameters.items():
        if name != FIELD and name not in BESIDE:
            raise ValueError(f"A field of friction is fitted with {', '.join((FIELD, *BESIDE))}; got {shown(name)}.")
        least, most = FRICTIONS if name == FIELD else _limits(name)
        check_begin(name, value, least, most)
        if name in values:
            raise ValueError(f"{name} must be a parameter to be fitted or a value; got both. Leave one out.")
    if FIELD not in parameters:
        raise ValueError(f"parameters must have an initial value of {FIELD}; got {shown(dict(parameters))}.")
    able = {**vehicle.parameters.values(), **OF_RAIL, "full_torque": 0.0}
    for name, value in values.items():
        if name not in able:
            raise ValueError(f"A fit of a field of friction has no value {shown(name)}; {near(name, able)}")
        if not np.isfinite(number(value)):
            raise ValueError(f"{name} must be a finite number; got {value!r}.")
    rail = {name: float(values.get(name, parameters.get(name, default))) for name, default in OF_RAIL.items()}
    return rail, {**own, **{name: float(value) for name, value in values.items() if name not in OF_RAIL}}


def _limits(name: str) -> tuple[float, float]:
    return {"friction_ratio": (0.0, 1.0), "friction_decay": (0.0, 10.0), "cleaned_friction": (0.1, 10.0)}[name]


def _places_of(places: ArrayLike, logs: Sequence[FrictionLog], axles: Axles) -> Numbers:
    """Return the knots; a number is their spacing over the range of the logs. Raises ValueError."""
    at = np.asarray(places, float)
    if at.ndim == 0 and np.isfinite(at) and at > 0.0:
        ends = [np.min([log.distance.min() for log in logs]), np.max([one.distance.max() for one in logs])]
        first, last = np.floor((ends[0] + axles.along.min()) / at), np.ceil((ends[1] + axles.along.max()) / at)
        if last - first < MOST_PLACES:
            at = at * np.arange(first, last + 1)
    if not (at.ndim == 1 and 2 <= at.size <= MOST_PLACES and np.isfinite(at).all() and np.all(np.diff(at) > 0.0)):
        raise ValueError(
            f"places must be a spacing above 0 m, or 2 to {MOST_PLACES} distances in ascending order; got "
            f"{shown(places)}."
        )
    return at


def _time_near(stretch: LogStretch) -> Numbers:
    """Return for each knot the time in which wheelsets slid near it [s]."""
    step = np.diff(stretch.time)[:, None] * stretch.slides
    return np.asarray(np.einsum("sw,swk->k", step, (stretch.hats[1:] + stretch.hats[:-1]) / 2))


def _field_of(
    problem: Search, found: SearchResult, logs: Sequence[FrictionLog], at: Numbers, weight: Numbers
) -> FrictionField:
    """Return the result; weight: time in which wheelsets slid near each knot, shape (stretches, knots)."""
    count, there = problem.count, problem.determined.copy()
    known_here = found.half[:count] < np.mean(found.x[:count])  # a wider interval determines no value
    there[there] = known_here
    values, lower, upper = np.full(at.size, np.nan), _used_near(problem.axles, logs, at), np.full(at.size, np.inf)
    values[there] = found.x[:count][known_here]
    half = found.half[:count][known_here]
    lower[there], upper[there] = values[there] - half, values[there] + half
    names = [*problem.beside, *(["torque_factor"] if problem.by_torque else [])]
    others = dict(zip(names, found.x[count : problem.shared].tolist(), strict=True))
    standard = dict(zip(names, found.standard[count : problem.shared].tolist(), strict=True))
    near_it = [weight[problem.of_log == place].sum(axis=0) > 0.0 for place in range(problem.logs.size)]
    deviations = {
        logs[log].name: float(deviation) for log, deviation in zip(problem.logs, found.deviations, strict=True)
    }
    fields = at, values, lower, upper, np.sum(near_it, axis=0)
    unused = [log.name for log in logs if log.name not in deviations]
    messages = [*_of_places(*fields[:4]), *_of_logs(found.scatter, deviations, unused)]
    messages += [f"{name} = {value:.4g} +- {standard[name]:.2g}." for name, value in others.items()]
    ends = np.isclose(found.x[:count, None], FRICTIONS, rtol=AT_LIMIT).any(axis=1).sum()
    if ends:
        messages.append(f"Friction ended at its limit at {ends} places: check units, torques and the law of the rail.")
    return FrictionField(*fields, others, standard, found.scatter, deviations, messages)


def _used_near(axles: Axles, logs: Sequence[FrictionLog], at: Numbers) -> Numbers:
    """Return the largest adhesion that was used near each knot without sliding; 0: none."""
    edges, found = (at[1:] + at[:-1]) / 2, np.zeros(at.size)
    for log in logs:
        places, used = used_adhesion(log, axles, OVER)
        inside = (places >= at[0]) & (places <= at[-1])
        np.maximum.at(found, np.searchsorted(edges, places[inside]), used[inside])
    return found


def _of_places(at: Numbers, values: Numbers, lower: Numbers, upper: Numbers) -> list[str]:
    """Return where friction was found, and where it was not."""
    there, found = np.isfinite(values), []
    if there.any():
        half = (upper - lower)[there] / 2 / values[there]
        found.append(
            f"Friction at {there.sum()} of {at.size} places: {values[there].min():.3g} to {values[there].max():.3g}, "
            f"with intervals of +- {100 * half.min():.2g} to {100 * half.max():.2g} %."
        )
    if not there.all():
        first = ", ".join(f"{one:g}" for one in at[~there][:5]) + (", ..." if np.sum(~there) > 5 else "")
        found.append(
            f"At {np.sum(~there)} places ({first} m) wheels slid too little: friction is at least what was used, up "
            f"to {lower[~there].max():.3g}, and has no upper limit."
        )
    return found


def _of_logs(scatter: float, deviations: Mapping[str, float], unused: Sequence[str]) -> list[str]:
    """Return how the logs differ, and which were not used."""
    found, usual = [], float(np.median([*deviations.values()]))
    if scatter > 2.0 * NO_SCATTER:
        found.append(f"Friction differs between the logs by {100 * scatter:.2g} %, which the intervals include.")
    if len(deviations) == 1:
        found.append("One log cannot show how friction differs between runs: the intervals are those of its errors.")
    found += [
        f"{name} does not fit the others: its speeds are off by {size:.2g} m/s. Check its places and units."
        for name, size in deviations.items()
        if size > OUTLIER * usual
    ]
    if unused:
        found.append(f"Not used, as no wheel slides where all forces are known: {', '.join(unused)}.")
    return found
