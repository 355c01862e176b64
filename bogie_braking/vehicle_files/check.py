"""Numbers with which a user checks a vehicle file: axle loads, natural modes, critical speed, stopping distances."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bogie_braking.machines import Runnable
from bogie_braking.simulation import Simulation, run
from products.machine import filling_by_time
from products.vehicle_file import BRAKED_FMU, DataSheet
from rbd_model.linear import Mode, critical_speed, oscillations
from rbd_model.track.friction import RailCondition, dry, low, very_low, wet
from rbd_model.vehicle.parameters import VehicleParameters
from scenarios.bench.drive import RIGID, prepare, settled, system_of

#: Speeds of the stops [km/h], and rails.
SPEEDS = (40.0, 80.0, 120.0, 160.0)
RAILS: Mapping[str, Callable[[], RailCondition]] = {"dry": dry, "wet": wet, "low": low, "very low": very_low}
#: Longest stop [s]: 160 km/h at 0.08 m/s2.
LONGEST = 600.0
KILOMETRES_PER_HOUR = 3.6
#: Speeds between which the critical speed is searched, their distance [m/s]; friction of the rails.
SLOWEST, FASTEST, STEP, FRICTION = 10.0, 120.0, 10.0, 0.4
#: Motion of which the growth is measured: lateral displacement at the start [m], largest ratio of sizes, length,
#: recording interval and averaging time [s].
SMALL, LARGEST_RATIO, LENGTH, INTERVAL, AVERAGED = 1e-6, 100.0, 32.0, 0.01, 2.0
#: Speed at which modes are computed [m/s], and damping above which a mode is not listed.
MODES_AT, OVERDAMPED = 10.0, 0.9
MOTIONS = ("shift", "lateral", "bounce", "roll", "pitch", "yaw")


@dataclass(frozen=True)
class Check:
    """Results of a check.

    loads [N]: of the axles at rest. modes: the oscillations at 10 m/s, the slowest first; None: not computed.
    critical [m/s]: speed above which the vehicle hunts, infinite if it does not up to FASTEST; None: not computed.
    distances [m]: shape (speeds, rails), NaN if it does not stop in time; None: the file has no brake.
    """

    sheet: DataSheet
    loads: tuple[float, ...]
    modes: tuple[Mode, ...] | None
    critical: float | None
    distances: np.ndarray | None


def check_of(sheet: DataSheet, with_modes: bool = True, progress: Callable[[str], None] = lambda text: None) -> Check:
    """Return the numbers of a vehicle file.

    Parameters
    ----------
    sheet : DataSheet
        The vehicle.
    with_modes : bool
        Also compute modes and the critical speed, with 2 and 4 axles and without tables of forces; this compiles the
        equations in 3D.
    progress : callable
        Receives a line about each part before it starts.
    """
    progress("axle loads at rest")
    loads = axle_loads(sheet)
    modes, critical = None, None
    if with_modes and sheet.fmu is not None:
        progress("natural modes and critical speed in 3D")
        modes, critical = tuple(modes_of(sheet, MODES_AT)), critical_speed_of(sheet)
    distances = None
    if sheet.brake:
        progress("stops from four speeds on four rails")
        distances = np.array([[stopping_distance(sheet, v, rail()) for rail in RAILS.values()] for v in SPEEDS])
    return Check(sheet, loads, modes, critical, distances)


def _runnable(sheet: DataSheet) -> tuple[Runnable, dict[str, Any]]:
    """Return what `run` takes for a sheet at level 2, and its values."""
    if sheet.fmu is None:
        return sheet.vehicle, {"level": 2, **sheet.resistance}
    return sheet.fmu, {"level": 2, **sheet.values_at(2)}


def axle_loads(sheet: DataSheet) -> tuple[float, ...]:
    """Return the axle loads at rest [N], the leading one first."""
    what, values = _runnable(sheet)
    at_rest = Simulation(what, initial_speed=0.0, **values)
    at_rest.advance(1e-3)
    return tuple(float(at_rest[f"axle_load_{number}"]) for number in range(1, sheet.axles + 1))


def stopping_distance(sheet: DataSheet, speed: float, rail: RailCondition) -> float:
    """Return the stopping distance from a speed [km/h] with the full brake, without wheel-slide protection [m]."""
    assert sheet.brake is not None
    numbers = range(1, sheet.axles + 1)
    what, values = _runnable(sheet)
    values |= rail.values(sheet.axles) | {"initial_speed": speed / KILOMETRES_PER_HOUR}
    brake: dict[str, Any]
    if sheet.fmu == BRAKED_FMU:
        brake = {f"pressure_demand_{number}": sheet.brake.full_pressure for number in numbers}
    else:
        torque, share = sheet.brake.full_torque, filling_by_time(sheet.brake.application_time)
        brake = {f"brake_torque_{number}": lambda t: torque * share(t) for number in numbers}
    ended = run(what, LONGEST, None, ["distance", "speed"], 1.0, **values, **brake)
    return float(ended["distance"][-1]) if ended["speed"][-1] < 0.05 else float("nan")


def modes_of(sheet: DataSheet, speed: float) -> list[Mode]:
    """Return the oscillations of the vehicle rolling freely on straight track at a speed [m/s], the slowest first."""
    name = _name_in_space(sheet)
    kernel = settled(name, tolerance=1e-8, initial_speed=speed, **_values_in_space(sheet))
    found = oscillations(system_of(name, **RIGID), np.array(kernel.linearise().jacobian))
    return sorted(found, key=lambda mode: mode.frequency)


def _name_in_space(sheet: DataSheet) -> str:
    return "vehicle" if sheet.axles == 4 else "bogie"


def _values_in_space(sheet: DataSheet) -> dict[str, float]:
    """Return the values of a sheet at level 3 on rails with FRICTION."""
    friction = {f"friction_{number}": FRICTION for number in range(1, sheet.axles + 1)}
    return RIGID | sheet.parameters.values() | friction


def growth_of(sheet: DataSheet, speed: float, resistance: float = 0.0) -> float:
    """Return the growth of a small motion of the wheelsets across the track in a run at a speed [1/s]; section 4.4.

    It is not an eigenvalue: without rolling resistance Polach's law has no slope at zero creepage (`settled`), and a
    small resistance determines the slope only for motions with smaller creepages than its own.

    Parameters
    ----------
    sheet : DataSheet
        The vehicle, with 2 or 4 axles.
    speed : float
        The speed, which is held [m/s].
    resistance : float
        Rolling resistance of each wheelset [N.m].
    """
    values = _values_in_space(sheet) | {"rolling_resistance_torque": resistance, "constant_speed": 1.0}
    name, names = _name_in_space(sheet), [f"lateral_{number}" for number in range(1, sheet.axles + 1)]
    kernel = prepare(name, tolerance=1e-9, initial_speed=speed, initial_lateral=SMALL, **values)
    seen = kernel.record(LENGTH, INTERVAL, names)
    rows = round(AVERAGED / INTERVAL)
    square = sum((np.array(seen[name]) ** 2 for name in names), np.zeros(len(seen["time"])))
    sizes = 0.5 * np.log([square[row : row + rows].mean() for row in range(0, square.size - rows + 1, rows)])
    if sizes.size < 4:  # the run ended: the vehicle left the treads
        return float(np.log(LARGEST_RATIO) / AVERAGED)
    far = np.flatnonzero(np.abs(sizes[2:] - sizes[1]) > np.log(LARGEST_RATIO))
    if far.size:  # round-off or the flanges limit the motion afterwards
        return float((sizes[2 + far[0]] - sizes[1]) / ((1 + far[0]) * AVERAGED))
    return float((sizes[-2:].mean() - sizes[-4:-2].mean()) / (2 * AVERAGED))


def critical_speed_of(sheet: DataSheet) -> float:
    """Return the lowest speed above which a motion grows [m/s]; infinite if none does up to FASTEST; section 4.4."""

    def growth(speed: float) -> float:
        return growth_of(sheet, speed)

    before = SLOWEST
    if growth(before) > 0.0:
        return SLOWEST
    for speed in np.arange(SLOWEST + STEP, FASTEST + STEP / 2, STEP).tolist():
        if growth(speed) > 0.0:
            return critical_speed(growth, before, speed)
        before = speed
    return float("inf")


def motion_of(mode: Mode, sheet: DataSheet) -> str:
    """Return the body and motion with the largest displacement in a mode, in words; angles count at half the base."""
    parameters = sheet.parameters
    reach = {"body": parameters.pivot_distance / 2} if isinstance(parameters, VehicleParameters) else {}

    def size(name: str) -> float:
        body, _, motion = name.rpartition("_")
        arm = reach.get(body, parameters.wheel_base / 2) if motion in ("pitch", "yaw") else 1.0
        return abs(mode.shape[name]) * arm

    named = [name for name in mode.shape if name.rpartition("_")[2] in MOTIONS or name in MOTIONS]
    wheels = [name for name in mode.shape if name.startswith("lateral_")]
    largest = max([*named, *wheels], key=size)
    if largest in wheels:
        return f"hunting of wheelset {largest.rpartition('_')[2]}"
    body, _, motion = largest.rpartition("_")
    return f"{motion} of the {body.replace('_', ' ')}" if body else f"{motion} of the body"
