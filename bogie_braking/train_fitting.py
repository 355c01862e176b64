"""Calibration of trains: brake, filling time and resistance from stopping distances or from a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bogie_braking.checks import line_or_none, shown
from bogie_braking.fitting import Fit, Problem, check_begin, check_parameters, fit_of
from bogie_braking.measured_data import Data, check_unit, not_a_log
from bogie_braking.trains import consist_from_any
from fmu_src.cosimulation.arrays import log_from, named_arrays, recording_of
from fmu_src.cosimulation.measured import in_units_of, table_from
from fmu_src.cosimulation.recording import Recording
from fmu_src.suggestion import suggestion
from products.train.brake_model import select_brake_model
from products.train.factors import PARAMETERS, TWICE, changed
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import Line
from readers.columns import Column
from readers.formats.logs import format_of
from readers.log_columns import head_of
from readers.log_rows import after_events, bridged
from readers.log_words import FAMILIES, plain
from readers.tables import read_table
from readers.usual import likely_unit

#: Longest stop [s], and communication step of stops and runs [s].
LONGEST_STOP, EVERY = 900.0, 0.1
#: Fall of the measured pipe pressure below full service from which it is an emergency [Pa].
EMERGENCY = 30e3
#: Limits of a measured pipe pressure, and least one that a charged pipe has [Pa, gauge]; overcharge is 540 kPa.
LEAST_PRESSURE, MOST_PRESSURE, LEAST_CHARGED = -10e3, 560e3, 100e3
#: Columns of stops and of runs, with units; those of stops with their limits.
STOPS = (Column("speed", "m/s", 0.5, 150.0, required=True), Column("distance", "m", 1.0, 100e3, required=True))
RUN = {"time": "s", "speed": "m/s", "pipe_pressure": "Pa"}
#: Brakings of a table of stops, as arguments of `drive`.
DRIVEN = {"emergency": ("emergency", 0.0), "service": ("service", 1.0)}


def fit_train(
    consist: Any,
    measured: Any,
    parameters: Mapping[str, float],
    *,
    drive: str = "emergency",
    line: Line | None = None,
    settings: Settings | None = None,
) -> Fit:
    """Fit parameters of a train to stopping distances or to a run; arguments and errors are those of `calibration.fit`.

    Standard errors hold to first order: for independent errors of the distances, and for errors of a run that may be
    correlated in time. `settings` are by default those that `train` chooses.
    """
    (own, _), along = consist_from_any(consist), line_or_none(line)
    if drive not in DRIVEN:
        raise ValueError(f"drive must be one of {', '.join(DRIVEN)}; got {shown(drive)}.")
    table = _table(measured)
    first = _begin_of(parameters)
    chosen = settings or select_brake_model(own, releases=True)
    is_run = table.names[0] == "time"
    name, clock = "speed" if is_run else "distance", table[table.names[0]]

    def simulated(share: np.ndarray, rows: int) -> np.ndarray:
        other = changed(own, dict(zip(parameters, (share * first).tolist(), strict=True)))
        make = partial(Train, other.unprotected, line=along, settings=chosen)
        return (_run(make, table, drive) if is_run else _stops(make, clock.tolist(), drive))[:rows, None]

    data = Data(clock, clock, table[name][:, None], {})
    problem = Problem(table, tuple(parameters), first, _limits(parameters), [name], data, clock.size, simulated)
    return fit_of(problem, over_time=is_run)


def _limits(parameters: Mapping[str, float]) -> np.ndarray:
    """Return the limits of parameters, shape (parameters, 2)."""
    return np.array([(PARAMETERS[name].least, PARAMETERS[name].most) for name in parameters])


def _table(measured: Any) -> Recording:
    """Return a run (time first) or stops (speed first). Raises ValueError, TypeError."""
    units, name = RUN | {"distance": "m"}, "The measured data"
    if isinstance(measured, str | Path):
        measured = _read(Path(measured))
    elif not isinstance(measured, Recording):
        arrays = named_arrays(measured, name)
        if arrays is None:
            raise not_a_log(name, measured)
        timed = any(is_time(head) for head in arrays)
        measured = log_from(arrays, RUN, None, name) if timed else recording_of(arrays, units, name)
    table = in_units_of(measured, units)
    needs = ("time", "speed") if "time" in table.names else ("speed", "distance")
    for name in needs:
        if name not in table.names:
            raise ValueError(f"The measured data must have the columns {needs[0]} and {needs[1]}; {name} is missing.")
    names = [*needs, *(["pipe_pressure"] if needs[0] == "time" and "pipe_pressure" in table.names else [])]
    for name in names:
        check_unit(table, name, units[name])
    rows = np.column_stack([table[name] for name in names])
    if needs[0] == "time":
        for pressure in rows.T[2:]:
            pressure[:] = bridged(table["time"], pressure)
        rows = rows[after_events(table["time"]) & np.isfinite(rows[:, 1])]
    recording = Recording({name: units[name] for name in names}, rows)
    _check(recording)
    return recording


def _check(table: Recording) -> None:
    """Check times, speeds and distances. Raises ValueError."""
    for name in table.names:
        if not np.all(np.isfinite(table[name])):
            raise ValueError(f"{name} must be finite in the measured data. Remove rows without a value.")
    if table.names[0] == "time" and (table["time"].size < 2 or np.any(np.diff(table["time"]) <= 0.0)):
        raise ValueError("time must have at least two values that increase. Sort the rows.")
    if "pipe_pressure" in table.names:
        _check_pressure(table["pipe_pressure"])
    for one in STOPS if table.names[0] == "speed" else ():
        wrong = table[one.name][(table[one.name] < one.minimum) | (table[one.name] > one.maximum)]
        if wrong.size:
            limits = f"from {one.minimum:g} to {one.maximum:g} {one.unit}"
            raise ValueError(f"{one.name} of a stop must be {limits}; got {wrong[0]:g} {one.unit}. Correct it.")


def _check_pressure(pressures: np.ndarray) -> None:
    """Check that pressures of a pipe are gauge pressures in Pa. Raises ValueError."""
    least, most = float(np.min(pressures)), float(np.max(pressures))
    if least < LEAST_PRESSURE or most > MOST_PRESSURE:
        wrong = least if least < LEAST_PRESSURE else most
        raise ValueError(
            f"pipe_pressure must be a gauge pressure from {LEAST_PRESSURE:g} to {MOST_PRESSURE:g} Pa; got {wrong:g} "
            "Pa. Correct its unit, or subtract the ambient pressure."
        )
    if most < LEAST_CHARGED:
        raise ValueError(
            f"pipe_pressure must reach {LEAST_CHARGED:g} Pa, as the pipe is charged before it brakes; got at most "
            f"{most:g} Pa.{likely_unit(most, 'Pa', LEAST_CHARGED, MOST_PRESSURE)} Correct its unit, or leave the "
            "column out."
        )


def _read(path: Path) -> Recording:
    """Return a run or stops of a file. Raises FileError."""
    if format_of(path) is not None:
        return table_from(path, RUN)
    head = read_table(path, [Column("speed", "m/s", required=True)], others=True)
    if any(is_time(name) for name in (*head.numbers, *head.words)):
        return table_from(path, RUN)
    table = read_table(path, STOPS)
    return Recording(
        {stop.name: stop.unit for stop in STOPS}, np.column_stack([table.numbers[one.name] for one in STOPS])
    )


def is_time(head: str) -> bool:
    """Return whether a column is the time of a run."""
    return plain(head_of(0, head).name) in FAMILIES[("time",)]


def _begin_of(parameters: Mapping[str, float]) -> np.ndarray:
    """Return the initial values, shape (parameters,). Raises ValueError."""
    check_parameters(parameters)
    for name, value in parameters.items():
        if name not in PARAMETERS:
            raise ValueError(f"A train has no parameter {name} to be fitted; {suggestion(name, PARAMETERS)}")
        unit, least, most = PARAMETERS[name].unit, PARAMETERS[name].least, PARAMETERS[name].most
        check_begin(name, value, least, most, unit)
    for pair in TWICE:
        if set(pair) <= set(parameters):
            raise ValueError(f"parameters must have {pair[0]} or {pair[1]}, not both. Leave one out.")
    return np.array(list(parameters.values()), float)


def _stops(make: Callable[..., Train], speeds: Sequence[float], drive: str) -> np.ndarray:
    """Return the stopping distances from speeds [m]. Raises ValueError if a train does not stop."""
    found = []
    for speed in speeds:
        train = make(speed=float(speed))
        begin = float(train.distance[0])
        train.drive(*DRIVEN[drive])
        while train.speed[0] > 0.0:
            train.advance(EVERY)
            if train.time > LONGEST_STOP:
                raise ValueError(
                    f"A stop must end within {LONGEST_STOP:g} s; from {speed:g} m/s the train still runs. Increase the "
                    "initial value of the brake, or check the line."
                )
        found.append(float(train.distance[0]) - begin)
    return np.array(found)


def _run(make: Callable[..., Train], table: Recording, drive: str) -> np.ndarray:
    """Return the speed of the head at the times of a run [m/s]."""
    times = table["time"]
    pressures = table["pipe_pressure"] if "pipe_pressure" in table.names else None
    start = {} if pressures is None else {"pipe": max(float(pressures[0]), 0.0)}
    train = make(speed=float(table["speed"][0]), **start)
    found = [float(train.speed[0])]
    train.drive(*DRIVEN[drive])
    for row in range(1, times.size):
        if pressures is not None:
            _follow(train, float(pressures[row]))
        left = float(times[row] - times[row - 1])
        train.advance(left)
        found.append(float(train.speed[0]))
    return np.array(found)


def _follow(train: Train, pressure: float) -> None:
    """Set the driver's valve so that the pipe at the head comes to a gauge pressure [Pa]."""
    valve = next(vehicle.valve for vehicle in train.consist.vehicles if vehicle.valve is not None)
    fallen = valve.running - pressure
    if fallen < valve.first_step / 2:
        train.drive("running")
    elif fallen <= valve.full_service + EMERGENCY:
        share = (fallen - valve.first_step) / (valve.full_service - valve.first_step)
        train.drive("service", float(np.clip(share, 0.0, 1.0)))
    else:
        train.drive("emergency")
