"""Calibration of vehicles, brakes and trains: one function for all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, overload

from numpy.typing import ArrayLike

from bogie_braking.checks import shown
from bogie_braking.fitting import Fit
from bogie_braking.friction_fitting import FrictionField, fit_friction
from bogie_braking.machines import Runnable
from bogie_braking.measured_data import DataOptions
from bogie_braking.run_fitting import fit_run
from bogie_braking.train_fitting import fit_train
from products.train.consist import Consist
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line
from rbd_model.vehicle.description import Vehicle
from readers.log_columns import ColumnMap

#: Options of a train's fit, beside the line.
OF_TRAINS = ("drive", "settings")


@overload
def fit(
    what: Runnable | Consist | Path | Sequence[Mapping[str, Any]] | int,
    measured: Any,
    parameters: Mapping[str, float],
    line: Line | None = None,
    until: float | None = None,
    begin: float | None = None,
    columns: ColumnMap | None = None,
    interval: float | None = None,
    longest_gap: float | None = None,
    places: None = None,
    **values: Any,
) -> Fit:
    """Return fitted parameters of a run."""


@overload
def fit(
    what: str | Vehicle | DataSheet,
    measured: Any,
    parameters: Mapping[str, float],
    line: Line | None = None,
    *,
    columns: ColumnMap | None = None,
    places: ArrayLike,
    **values: Any,
) -> FrictionField:
    """Return a fitted field of friction."""


def fit(
    what: Any,
    measured: Any,
    parameters: Mapping[str, float],
    line: Line | None = None,
    until: float | None = None,
    begin: float | None = None,
    columns: ColumnMap | None = None,
    interval: float | None = None,
    longest_gap: float | None = None,
    places: ArrayLike | None = None,
    **values: Any,
) -> Fit | FrictionField:
    """Fit parameters of a run, or a field of friction, to measured data by SciPy's least squares.

    Standard errors hold to first order, also for errors that are correlated in time (`correlated.py`). The errors of an
    output are scaled by the range of its measured values.

    A train is fitted to stopping distances too: to columns speed [m/s] and distance [m], from the driver's demand to
    the stop. Its run has time [s], speed [m/s] of the head and, if braking does not begin in the first row,
    pipe_pressure [Pa] of the head, which the driver's valve follows.

    With `places`, friction over place is fitted to one or many logs of a vehicle whose wheels slide (docs/public.md).
    `parameters` has the initial value of `friction`. It may have friction_ratio, friction_decay and cleaned_friction,
    which all logs share. A log has time [s], speed [m/s] and distance [m] of the vehicle, and wheel_speed_1 [m/s] or
    angular_velocity_1 [rad/s] of each wheelset. It may have pressure_1 [Pa] of the "bogie" or "vehicle", or
    brake_torque_1 [N.m]. `values` are other numbers of the rail's law and of the vehicle.

    Parameters
    ----------
    what : str, Vehicle, System or Model; or a train: path of a file, Consist, list of rows, int
        Vehicle or brake, as in `run`; or consist, as in `train`.
    measured : str, Path, Recording, mapping of arrays, data frame, data set or structured array
        A log; with `places` also a sequence of them. Its columns are time [s] and variables: outputs to fit, and inputs
        that drive the run. Units are in the names, as in `speed [km/h]`, or in `attrs`; without one it is that of the
        variable. Rows without a value of an output (NaN) are not compared there.
    parameters : mapping of str to float
        Names and initial values, not 0, because relative steps are taken. It may include constant inputs. Of a train:
        lambda [%] of each braked vehicle or brake_factor [1], fill_time [s], and resistance_factor [1] or resistance_a,
        resistance_b, resistance_c of the whole train [N, N/(m/s), N/(m/s)^2].
    line : Line, optional
        As in `run`.
    until : float, optional
        Time of the table [s] after which rows are held out, to validate the fit. By default all rows are fitted.
    begin : float, optional
        Time of the table at which the run starts [s]; by default that of the first row.
    columns : mapping, str or Path, optional
        Of a file: a map from its names to those of variables, or its TOML file. By default names are guessed, and told
        on standard error.
    interval : float, optional
        Rows are averaged over intervals of this length [s]. By default they are taken as they are.
    longest_gap : float, optional
        Longest gap that is bridged in an input [s]. By default ten median steps, and at least 2 s.
    places : array_like or float, optional
        Distances between which friction is linear [m], or their spacing.
    **values
        Other parameters and inputs, as in `run`. Of a train: `drive`, emergency (default) or service, the braking of
        stops and of a run without a pipe pressure; `settings`, by default those that `train` chooses.

    Returns
    -------
    Fit or FrictionField
        Fitted values, standard errors and deviations; with `places` the field and its intervals.

    Raises
    ------
    ValueError
        If the table is invalid, has other units, or does not have more values than parameters; if an option is not one
        of trains, or a train does not stop.
    KeyError
        If a name is unknown.
    SimulationError
        If a run is refused.
    """
    options = DataOptions(until, begin, columns, interval, longest_gap)
    if places is not None:
        for name, value in vars(options).items():
            if value is not None and name != "columns":
                raise ValueError(f"The fit of a field of friction must be without {name}; got {shown(value)}.")
        return fit_friction(what, measured, parameters, places, line, columns, values)
    if not is_train(what):
        return fit_run(what, measured, parameters, line, options, values)
    for name, value in {**vars(options), **values}.items():
        if value is not None and name not in OF_TRAINS:
            raise ValueError(f"The fit of a train must be without {name}; it has {', '.join(OF_TRAINS)}. Leave it out.")
    return fit_train(what, measured, parameters, line=line, **values)


def is_train(what: Any) -> bool:
    """Return whether something is a train: a consist, its rows, its file or a number of wagons."""
    if isinstance(what, str):
        return bool(Path(what).suffix)
    rows = isinstance(what, Sequence)
    return rows or isinstance(what, Consist | Path) or (isinstance(what, int) and not isinstance(what, bool))
