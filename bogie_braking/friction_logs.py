"""Logs of braked or driven vehicles on slippery rails, as arrays by rows and wheelsets, for a fit of the friction."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bogie_braking.measured_data import check_unit, log_of
from fmu_src.cosimulation.recording import Recording
from readers.log_columns import ColumnMap
from readers.log_rows import after_events, bridged

Numbers = NDArray[np.float64]
#: Columns of a log, and of each wheelset, with their units.
OF_VEHICLE = {"time": "s", "speed": "m/s", "distance": "m"}
OF_WHEELSET = {"wheel_speed": "m/s", "angular_velocity": "rad/s", "pressure": "Pa", "brake_torque": "N.m"}
DRIVEN = ("pressure", "brake_torque")
#: Columns of wheelsets by the names of the vehicles' variables.
SAME_AS = {"cylinder_pressure": "pressure"}


@dataclass(frozen=True)
class FrictionLog:
    """A log: its name in messages, time [s], speed [m/s] and place of the vehicle [m], shape (rows,).

    Circumferential speeds [m/s] and brake torques [N.m] have the shape (rows, wheelsets); NaN: not measured.
    """

    name: str
    time: Numbers
    speed: Numbers
    distance: Numbers
    wheel_speed: Numbers
    torque: Numbers


def friction_logs(
    measured: object, radii: Sequence[float], torque_per_pressure: float | None, columns: ColumnMap | None
) -> list[FrictionLog]:
    """Return logs as arrays. Takes radii [m], torque_per_pressure [N.m/Pa]."""
    given = list(measured) if isinstance(measured, Sequence) and not isinstance(measured, str) else [measured]
    if not given:
        raise ValueError("The fit of a field of friction must have at least one log; got none.")
    return [_log(f"log {n}", one, radii, torque_per_pressure, columns) for n, one in enumerate(given, 1)]


def _log(
    name: str, one: object, radii: Sequence[float], torque_per_pressure: float | None, columns: ColumnMap | None
) -> FrictionLog:
    table = _table(name, one, len(radii), columns)
    of_vehicle = [_column(name, table, column, unit) for column, unit in OF_VEHICLE.items()]
    of_vehicle[1:] = [bridged(of_vehicle[0], values) for values in of_vehicle[1:]]
    kept = np.flatnonzero(np.isfinite(of_vehicle).all(axis=0))
    kept = kept[after_events(of_vehicle[0][kept])]
    time, speed, distance = (values[kept] for values in of_vehicle)
    if time.size < 2 or np.any(np.diff(time) <= 0.0):
        raise ValueError(f"time of {name} must increase over at least two rows with speed and distance. Correct it.")
    wheel_speed, torque = (np.full((time.size, len(radii)), np.nan) for _ in range(2))
    for place, radius in enumerate(radii):
        values = {
            stem: _bridged(stem, table, _column(name, table, f"{stem}_{place + 1}", unit))[kept]
            for stem, unit in OF_WHEELSET.items()
            if f"{stem}_{place + 1}" in table.names
        }
        if "wheel_speed" in values or "angular_velocity" in values:
            wheel_speed[:, place] = values.get("wheel_speed", radius * values.get("angular_velocity", np.nan))
        if "brake_torque" in values:
            torque[:, place] = values["brake_torque"]
        elif "pressure" in values and torque_per_pressure is not None:
            torque[:, place] = torque_per_pressure * values["pressure"]
    if not np.isfinite(wheel_speed).any():
        raise ValueError(
            f"{name} must have wheel_speed_1 [m/s] or angular_velocity_1 [rad/s] and so on, up to {len(radii)}; "
            f"got {', '.join(table.names)}. Name these columns."
        )
    return FrictionLog(name, time, speed, distance, wheel_speed, torque)


def _bridged(stem: str, table: Recording, values: Numbers) -> Numbers:
    """Return a column of a wheelset; its torque or pressure, which drive it, bridged over short gaps."""
    return bridged(table["time"], values) if stem in DRIVEN else values


def _table(name: str, one: object, wheelsets: int, columns: ColumnMap | None) -> Recording:
    """Return a log with the names of our columns in their units."""
    numbers = range(1, wheelsets + 1)
    units = OF_VEHICLE | {f"{stem}_{n}": unit for stem, unit in OF_WHEELSET.items() for n in numbers}
    units |= {f"{other}_{n}": OF_WHEELSET[stem] for other, stem in SAME_AS.items() for n in numbers}
    return _renamed(log_of(one, units, columns, "A log", f" as {name}"))


def _renamed(table: Recording) -> Recording:
    """Return a table whose columns of wheelsets have the names of OF_WHEELSET."""
    names: Mapping[str, str] = {
        name: re.sub("|".join(SAME_AS), lambda found: SAME_AS[found[0]], name, count=1) for name in table.names
    }
    if len(set(names.values())) < len(names):
        return table
    return Recording(
        {names[name]: table.units[name] for name in table.names}, np.column_stack([table[name] for name in table.names])
    )


def _column(log: str, table: Recording, name: str, unit: str) -> Numbers:
    """Return a column of a log. Raises ValueError if it is missing or has another unit."""
    if name not in table.names:
        hint = " It is the place of the vehicle on its line, the same for all logs." if name == "distance" else ""
        raise ValueError(f"{log} must have the column {name} [{unit}]; got {', '.join(table.names)}.{hint}")
    check_unit(table, name, unit, f"{log}. Correct the unit.")
    return np.asarray(table[name], float)
