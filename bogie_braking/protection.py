"""Stops of a bogie or a coach with your own wheel-slide controller."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace
from typing import Literal

from bogie_braking.checks import known, line_or_none
from bogie_braking.provenance import encoded, encoded_settings
from brake_controller.wheel_slide import WheelSlideController
from fmu_src.cosimulation.recording import Recording
from products.machine import DISCS, MACHINES, Machine
from products.protection.rails import RAILS, RailCase
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from products.protection.vehicle_of_file import machine_of_sheet
from products.run_history import provenance_of
from products.vehicle_sheet import DataSheet
from rbd_model.track.line import Line

#: A class, or another function that returns a new controller.
Controller = Callable[[], WheelSlideController] | Literal["protection"] | None
#: Names of all rails.
NAMES = tuple(rail.name for rail in RAILS)
#: Columns of a table of stops.
COLUMNS = {
    "number": "1",
    "friction": "1",
    "distance": "m",
    "duration": "s",
    "longest_lock": "s",
    "share_in_band": "1",
    "air": "kg",
}


def protected_stops(
    controller: Controller,
    vehicle: str | DataSheet = "bogie",
    rails: Iterable[str] = NAMES,
    **settings: float,
) -> Recording:
    """Run one full service brake to rest on each rail, each with a new controller.

    The stops are those of the test rig of `bogie-braking controllers compare`: cylinders fill by flow of air.

    Parameters
    ----------
    controller : class, "protection" or None
        A class whose objects have `step(time, wheel_speeds)` [s], [m/s]. It returns for each wheelset 0 to apply its
        brake, 1 to hold it, or 2 to vent it. "protection": the built-in controller. None: no controller.
    vehicle : str or DataSheet
        "bogie" or "coach" (also "vehicle"), or a vehicle from a file with a brake (`read_vehicle`).
    rails : iterable of str
        Names of rails; by default all.
    **settings : float
        speed: speed at the start, 25 m/s. brake_ratio: torque over that of the full brake, 1. application_time: time to
        95 % of the torque, 2 s. period: sampling period of the controller, 5e-3 s. pulses: pulses of each speed sensor
        in a revolution, 100. jitter: standard deviation of the positions of its teeth relative to the pitch, 0.

    Returns
    -------
    Recording
        A row and a message for each rail. Columns have shape (rails,): number of the row; friction of the rail;
        distance [m] and duration [s]; longest_lock, longest locking time of a wheelset while the vehicle is faster than
        0.3 m/s [s]; share_in_band, share of the braked time above 3 m/s with no slip above 0.3; air that the cylinders
        used [kg]. The distance is NaN if a stop still runs after 300 s or if its controller fails; the message states
        the reason. A controller fails if a step uses more than 1 s of processor time. If it does not answer within 60 s
        of wall time, the stop is not evaluated: all its columns except the first two are NaN.

    Raises
    ------
    TypeError
        If `controller` has no `step` method, or is an object and not a class.
    KeyError
        If the vehicle, a rail or a setting is unknown.
    ValueError
        If a setting is out of its limits.
    """
    rows: list[list[float]] = []
    messages, rails = [], rails if isinstance(rails, str) else list(rails)
    for case, stop in _stops_of(controller, vehicle, rails, settings):
        distance = math.nan if stop.distance is None else stop.distance
        measures = stop.time, stop.longest_lock, stop.share_in_band, stop.air
        rest = measures if stop.judged else [math.nan] * len(measures)
        rows.append([len(rows), case.condition.friction, distance, *rest])
        messages.append(_sentence(case, stop))
    arguments = {
        "controller": encoded(controller),
        "vehicle": encoded(vehicle),
        "rails": rails,
        "values": encoded_settings(settings),
    }
    provenance = provenance_of("protected_stops", arguments)
    return Recording(COLUMNS, rows, messages, {"stops": len(rows)}, ("number", "friction"), provenance)


def protected_stop(
    controller: Controller, rail: str, vehicle: str | DataSheet = "bogie", line: Line | None = None, **settings: float
) -> Recording:
    """Run one stop of `protected_stops` on one rail, recorded every period of the controller.

    Parameters
    ----------
    controller : class, "protection" or None
        As in `protected_stops`.
    rail : str
        Name of the rail.
    vehicle : str or DataSheet
        "bogie" or "coach" (also "vehicle"), or a vehicle from a file with a brake (`read_vehicle`), which also states
        the application time unless `settings` do.
    line : Line, optional
        Line of the stop; its map of friction multiplies the friction of the rail.
    **settings : float
        As in `protected_stops`.

    Returns
    -------
    Recording
        Columns over time: time [s]; speed [m/s] and distance [m] of the vehicle; braking_force of all wheelsets [N];
        and for each wheelset its true wheel_speed [m/s], pressure in its cylinder [Pa], command to its valve, and used
        adhesion.

    Raises
    ------
    TypeError
        If `controller` has no `step` method, or is an object and not a class.
    KeyError
        If the vehicle, the rail or a setting is unknown.
    ValueError
        If a setting is out of its limits.
    """
    [(case, stop)] = _stops_of(controller, vehicle, [rail], settings, line_or_none(line), recorded=True)
    radius = _machine(vehicle)[0].parameters.wheel_radius
    found = stop.course.recording(radius, _sentence(case, stop), stop.commands)
    arguments = {"controller": encoded(controller), "rail": rail, "vehicle": encoded(vehicle), "line": encoded(line)}
    found.provenance = provenance_of("protected_stop", arguments | {"values": encoded_settings(settings)})
    return found


def _stops_of(
    controller: Controller,
    vehicle: str | DataSheet,
    rails: Iterable[str],
    settings: Mapping[str, float],
    line: Line | None = None,
    recorded: bool = False,
) -> list[tuple[RailCase, Stop]]:
    """Return the rails with the stop on each, run on the test rig. Raises the errors of `protected_stops`."""
    if isinstance(rails, str):
        raise TypeError(f'rails must be a list of names, such as ["{rails}"]; got the text {rails!r}.')
    make, cases = maker_of(controller), {rail.name: rail for rail in RAILS}
    on = [cases[known(name, cases, "rail")] for name in rails]
    machine, of_vehicle = _machine(vehicle)
    chosen = settings_from({**of_vehicle, **settings})
    runs = [Run(case.values(len(machine.numbers)), line=line) for case in on]
    rig = Rig(machine, make, chosen, by_flow=True, equipment=machine.equipment)
    return list(zip(on, rig.runs(runs, every=chosen.period if recorded else 0.0), strict=True))


def _machine(vehicle: str | DataSheet) -> tuple[Machine, dict[str, float]]:
    """Return the braked vehicle of a name or of a file, and the settings in the file. Raises KeyError, ValueError."""
    if isinstance(vehicle, DataSheet):
        machine, brake = machine_of_sheet(vehicle)
        if brake.acts_on == "discs":
            machine = replace(machine, by_flow=True, equipment=(DISCS,))
        return machine, {"application_time": brake.application_time}
    return MACHINES[known(vehicle, MACHINES, "vehicle with brakes")](), {}


def settings_from(given: Mapping[str, float]) -> Settings:
    """Return settings by name. Raises KeyError."""
    names = [field.name for field in fields(Settings)]
    return Settings(**{known(name, names, "setting"): value for name, value in given.items()})  # type: ignore[arg-type]


def maker_of(controller: Controller) -> Callable[[], WheelSlideController] | None:
    """Return a function that makes a controller for each stop, or None. Raises TypeError."""
    if controller is None:
        return None
    if controller == "protection":
        return SlideProtection
    steps = callable(getattr(controller, "step", None))
    if isinstance(controller, str) or not callable(controller):
        if not steps:
            raise TypeError(f'The controller must be a class, "protection" or None; got {controller!r}.')
        name = type(controller).__name__
        raise TypeError(
            f"The controller must be the class {name}; got an object of it. Each stop begins with a new one."
        )
    if isinstance(controller, type) and not steps:
        raise TypeError(f"The class {controller.__name__} has no method step(time, wheel_speeds); give it one.")
    return controller


def _sentence(case: RailCase, stop: Stop) -> str:
    """Return the result of a stop as a message."""
    locked = "" if stop.distance is None else f", locked for {stop.longest_lock:.1f} s"
    return f"{case.name}: {stop.words}{locked}."
