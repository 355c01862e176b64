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
from scenarios.bench.drive import RIGID, prepare, system_of

#: Speeds of the stops [km/h], and rails.
SPEEDS = (40.0, 80.0, 120.0, 160.0)
RAILS: Mapping[str, Callable[[], RailCondition]] = {"dry": dry, "wet": wet, "low": low, "very low": very_low}
#: Longest stop [s]: 160 km/h at 0.08 m/s2.
LONGEST = 600.0
KILOMETRES_PER_HOUR = 3.6
#: Speeds between which the critical speed is searched, their distance [m/s]; friction of the rails.
SLOWEST, FASTEST, STEP, FRICTION = 10.0, 120.0, 10.0, 0.4
#: Time in which wheels come to roll freely and contacts to their loads, before the equations are linearised [s].
SETTLED = 1.0
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
        Also compute modes and the critical speed, with 2 and 4 axles; this compiles the equations in 3D.
    progress : callable
        Receives a line about each part before it starts.
    """
    progress("axle loads at rest")
    loads = axle_loads(sheet)
    modes, critical = None, None
    if with_modes and sheet.axles != 6:
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
    name = "vehicle" if sheet.axles == 4 else "bogie"
    friction = {f"friction_{number}": FRICTION for number in range(1, sheet.axles + 1)}
    values = RIGID | sheet.parameters.values() | friction
    kernel = prepare(name, tolerance=1e-8, initial_speed=speed, **values)
    kernel.advance(SETTLED)
    found = oscillations(system_of(name, **RIGID), np.array(kernel.linearise().jacobian))
    return sorted(found, key=lambda mode: mode.frequency)


def critical_speed_of(sheet: DataSheet) -> float:
    """Return the lowest speed above which a motion grows [m/s]; infinite if none does up to FASTEST; section 4.4."""

    def growth(speed: float) -> float:
        return max(mode.growth for mode in modes_of(sheet, speed))

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
