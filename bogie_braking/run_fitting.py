"""Calibration of vehicles and brakes: the fit of parameters of a run to measured data."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from bogie_braking.checks import in_unit, known, line_or_none, not_both, number
from bogie_braking.fitting import Fit, Problem, check_parameters, fit_of
from bogie_braking.histories import Value
from bogie_braking.machines import CompiledMachine, Runnable, machine_of, model_from, unfolded
from bogie_braking.measured_data import DataOptions, check_unit, check_units, data_of, first_rows, log_of, rows_until
from bogie_braking.simulation import Simulation
from fmu_src.cosimulation.recording import Recording
from fmu_src.suggestion import suggestion
from fmu_src.system import System
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line
from readers.log_rows import after_events

#: Limits over start values above which a fit has no bound: `least_squares` scales its steps by the distance to bounds.
FAR = 1e3
#: Largest number of rows of a run, between which measured instants are interpolated.
MOST_ROWS = 1_000_000
#: Steps of a run are at least this share of the median step of the rows, between which it is interpolated.
SHORTEST_STEP = 0.25
#: Inputs that outputs follow, by their names without the number of the wheelset.
FOLLOWS, DIGITS = {"cylinder_pressure": "pressure_demand", "cylinder_pressure_": "pressure_demand_"}, "0123456789"


def fit_run(
    what: Runnable | DataSheet,
    measured: Any,
    parameters: Mapping[str, float],
    line: Line | None,
    options: DataOptions,
    values: dict[str, Value],
) -> Fit:
    """Fit parameters of a vehicle or a brake; arguments, result and errors are those of `calibration.fit`."""
    given, (what, values) = values, unfolded(what, values)
    machine = machine_of(what, values, line_or_none(line) is not None)
    units = {"time": "s"} | {name: one.unit for name, one in machine.variables.items()}
    table = log_of(measured, units, options.columns)
    what = model_from(what) if isinstance(what, System) else what
    names, driven = parted(table, machine)
    data = data_of(table, names, driven, options)
    last = rows_until(options.until, data.clock)
    first = begin_of(parameters, machine, driven)
    not_both(parameters, given, "as a parameter to be fitted and as a value")
    not_both(driven, given, "as a column of the measured data and as a value")
    values = {name: value for name, value in values.items() if name not in {*parameters, *driven}}  # those of a file

    def simulated(share: np.ndarray, rows: int) -> np.ndarray:
        fitted = dict(zip(parameters, (share * first).tolist(), strict=True))
        return at_times(Simulation(what, line, **(values | data.inputs | fitted)), names, data.times[:rows])

    limits = np.array(
        [[machine.variables[parameter].minimum, machine.variables[parameter].maximum] for parameter in parameters]
    )
    problem = Problem(table, tuple(parameters), first, limits, names, data, last, simulated, FAR)
    if "initial_speed" not in parameters:
        rows = max(2, 1 + max(first_rows(data.wanted)))
        check_units(names, simulated(np.ones_like(first), rows), data, table.units)
    return fit_of(problem, lacking([*driven, *names], {*values, *parameters}, machine))


def lacking(measured: Sequence[str], given: Collection[str], machine: CompiledMachine) -> list[str]:
    """Return a warning for inputs that a log lacks while others of their kind are measured, or what follows them."""
    kinds: dict[str, str] = {}
    for name in measured:
        kind = name.rstrip(DIGITS)
        kinds.setdefault(FOLLOWS.get(kind, kind), name)
    inputs = [one for one in machine.variables.values() if one.causality == "input"]
    found = []
    for kind, has in kinds.items():
        left = [one for one in inputs if one.name.rstrip(DIGITS) == kind and one.name not in {*measured, *given}]
        if stays := [f"{one.name} ({one.start:g}{in_unit(one.unit)})" for one in left]:
            found.append(
                f"The log has {has}, but it lacks {', '.join(stays)}: start values are taken. Map a column to these "
                "too, or give their values."
            )
    return found


def begin_of(parameters: Mapping[str, float], machine: CompiledMachine, driven: Sequence[str] = ()) -> np.ndarray:
    """Return the initial values of parameters, shape (parameters,); `driven`: measured inputs, which cannot be fitted.

    Raises ValueError if a parameter cannot be fitted.
    """
    check_parameters(parameters)
    constant = [variable for variable in machine.variables.values() if variable.causality in ("parameter", "input")]
    able = [one.name for one in constant if one.kind == "real" and one.name not in driven]
    for name, value in parameters.items():
        if name not in able:
            raise ValueError(f"{machine.name} has no real parameter or free input {name}; {suggestion(name, able)}")
        one = machine.variables[name]
        if not one.minimum < number(value) < one.maximum or value == 0.0:
            between = f"between {one.minimum:g} and {one.maximum:g}{in_unit(one.unit)}"
            raise ValueError(f"The initial value of {name} must be {between}, and not 0; got {value!r}.")
    return np.array(list(parameters.values()), float)


def parted(table: Recording, machine: CompiledMachine) -> tuple[list[str], list[str]]:
    """Return the names of measured outputs and of measured inputs.

    Raises KeyError if a name is unknown, ValueError if the time or a unit is wrong or no output is measured.
    """
    if table.names[0] != "time" or not np.all(np.isfinite(table["time"])) or np.any(np.diff(table["time"]) <= 0.0):
        raise ValueError("The first column of the measured data must be time [s], finite and increasing.")
    check_unit(table, "time", "s")
    for name in table.names[1:]:
        check_unit(table, name, machine.variables[known(name, machine.variables, "variable")].unit)
    driven = [name for name in table.names[1:] if machine.variables[name].causality == "input"]
    names = [name for name in table.names[1:] if name not in driven]
    if not names:
        raise ValueError("The measured data must have at least one output to fit; got none.")
    return names, driven


def at_times(simulation: Simulation, names: Sequence[str], times: np.ndarray) -> np.ndarray:
    """Return outputs of a run at instants [s], shape (instants, names). After an early end the last values are used."""
    steps = np.diff(times[after_events(times)])
    step = max(float(np.min(steps)), SHORTEST_STEP * float(np.median(steps)), float(times[-1]) / MOST_ROWS)
    series = simulation.advance(float(times[-1]) + step, names, step)
    return np.column_stack([np.interp(times, series["time"], series[name]) for name in names])
