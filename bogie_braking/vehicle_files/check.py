"""Numbers with which a user checks a vehicle file: axle loads, natural modes, critical speeds, stopping distances."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bogie_braking.hunting import Subject, large_speed_of, linear_speed_of, modes_of, start_of
from bogie_braking.machines import Runnable
from bogie_braking.simulation import Simulation, run
from products.machine import filling_by_time
from products.vehicle_sheet import BRAKED_FMU, DataSheet
from rbd_model.linear import Mode
from rbd_model.track.friction import RailCondition, dry, low, very_low, wet

#: Speeds of the stops [km/h], and rails.
SPEEDS = (40.0, 80.0, 120.0, 160.0)
RAILS: Mapping[str, Callable[[], RailCondition]] = {"dry": dry, "wet": wet, "low": low, "very low": very_low}
#: Longest stop [s]: 160 km/h at 0.08 m/s2.
LONGEST = 600.0
KILOMETRES_PER_HOUR = 3.6
#: Time between two lines on a long search [s].
TOLD = 2.0
#: Speed at which modes are computed [m/s], and damping above which a mode is not listed.
MODES_AT, OVERDAMPED = 10.0, 0.9


@dataclass(frozen=True)
class Hunting:
    """Critical speeds on straight smooth track [m/s], infinite if it is above FASTEST.

    linear: a small motion grows above it. large: lowest speed at which a large motion persists; runs began at the
    lateral displacement `start` [m].
    """

    linear: float
    large: float
    start: float


@dataclass(frozen=True)
class VehicleCheck:
    """Results of a check.

    loads [N]: of the axles at rest. modes: the oscillations at 10 m/s, the slowest first; None: not computed.
    hunting: its critical speeds; None: not computed.
    distances [m]: shape (speeds, rails), NaN if it does not stop in time; None: the file has no brake.
    """

    sheet: DataSheet
    loads: tuple[float, ...]
    modes: tuple[Mode, ...] | None
    hunting: Hunting | None
    distances: np.ndarray | None


def check_of(
    sheet: DataSheet, with_modes: bool = True, progress: Callable[[str], None] = lambda text: None
) -> VehicleCheck:
    """Return the numbers of a vehicle file."""
    progress("axle loads at rest")
    loads = axle_loads(sheet)
    modes, hunting = None, None
    if with_modes and sheet.fmu is not None:
        progress("natural modes and linear critical speed in 3D")
        subject = Subject.of(sheet)
        modes, linear = tuple(modes_of(subject, MODES_AT)), linear_speed_of(subject)
        progress("lowest speed at which a large motion persists")
        start = start_of(subject)
        hunting = Hunting(linear, large_speed_of(subject, start, at_times(progress)), start)
    distances = None
    if sheet.brake:
        progress("stops from four speeds on four rails")
        distances = np.array([[stopping_distance(sheet, v, rail()) for rail in RAILS.values()] for v in SPEEDS])
    return VehicleCheck(sheet, loads, modes, hunting, distances)


def at_times(progress: Callable[[str], None]) -> Callable[[float], None]:
    """Return a function that reports the speed [m/s] of a run, at most once in TOLD."""
    last = time.monotonic()

    def told(speed: float) -> None:
        nonlocal last
        if time.monotonic() >= last + TOLD:
            last = time.monotonic()
            progress(f"  a large motion at {speed * KILOMETRES_PER_HOUR:.0f} km/h")

    return told


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
