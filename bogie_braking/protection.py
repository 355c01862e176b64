"""Stops of a bogie, or of a coach, that a wheel-slide controller of one's own protects."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from typing import Literal

from bogie_braking.checks import known
from brake_controller.wheel_slide import WheelSlideController
from fmu_src.cosimulation.recording import Recording
from products.machine import MACHINES
from products.protection.rails import RAILS, RailCase
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection

#: A class, or another function that makes a new controller.
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
    vehicle: str = "bogie",
    rails: Iterable[str] = NAMES,
    **settings: float,
) -> Recording:
    """One full service brake to rest on each rail, protected by a new controller: a row and a sentence for each.

    The stops are those of the test rig, of `bogie-braking controllers compare`: cylinders fill by flow of air.

    controller: a class whose objects have `step(time, wheel_speeds)` [s], [m/s], which answers for each wheelset 0 to
    apply its brake, 1 to hold or 2 to vent it; "protection": the one that comes with the brake; None: no controller.
    vehicle: "bogie" or "coach", also "vehicle". settings: speed, at which it begins, 25 m/s; strength, torque over that
    of the full brake, 1; application_time, to 95 % of it, 2 s; period, of its questions, 5e-3 s; pulses of each speed
    sensor in a revolution, 100; jitter, standard deviation of their places as a share of the pitch, 0.

    Columns have shape (rails,): number of the row; friction of the rail; distance [m] and duration [s]; longest_lock,
    of any wheelset while the machine ran faster than 0.3 m/s [s]; share_in_band, of the braked time above 3 m/s in
    which no slip was above 0.3; air that the cylinders took [kg]. A stop that still ran after 300 s, or whose
    controller failed, has NaN as its distance, and its sentence says why. A controller fails if an answer uses more
    than 1 s of processor time. If it gives none within 60 s of wall time, the stop is not judged: all its columns but
    the first two are NaN. Raises TypeError for what is no controller,
    KeyError for another vehicle, rail or setting, ValueError for a setting that cannot be.
    """
    rows: list[list[float]] = []
    said = []
    for case, stop in _stops_of(controller, vehicle, rails, settings):
        distance = math.nan if stop.distance is None else stop.distance
        measures = stop.time, stop.longest_lock, stop.share_in_band, stop.air
        rest = measures if stop.judged else [math.nan] * len(measures)
        rows.append([len(rows), case.condition.friction, distance, *rest])
        said.append(_sentence(case, stop))
    return Recording(COLUMNS, rows, said, {"stops": len(rows)})


def protected_stop(controller: Controller, rail: str, vehicle: str = "bogie", **settings: float) -> Recording:
    """One stop of `protected_stops` over time, on one rail: what the controller saw and did, every period.

    Columns: time [s]; speed of the machine [m/s]; braking_force of all wheelsets [N]; and of each wheelset true
    wheel_speed [m/s], pressure in its cylinder [Pa], what its valve was told, and adhesion that it used.
    """
    [(case, stop)] = _stops_of(controller, vehicle, [rail], settings, recorded=True)
    radius = MACHINES[known(vehicle, MACHINES, "vehicle with brakes")]().parameters.wheel_radius
    return stop.course.recording(radius, _sentence(case, stop), stop.commands)


def _stops_of(
    controller: Controller, vehicle: str, rails: Iterable[str], settings: Mapping[str, float], recorded: bool = False
) -> list[tuple[RailCase, Stop]]:
    """The rails with the stop on each, on the test rig. Raises what `protected_stops` says."""
    if isinstance(rails, str):
        raise TypeError(f'Give the rails as a list, such as ["{rails}"]: it was the text {rails!r}.')
    make, cases, chosen = maker_of(controller), {rail.name: rail for rail in RAILS}, settings_from(settings)
    on = [cases[known(name, cases, "rail")] for name in rails]
    machine = MACHINES[known(vehicle, MACHINES, "vehicle with brakes")]()
    runs = [Run(case.values(len(machine.numbers))) for case in on]
    rig = Rig(machine, make, chosen, by_flow=True)
    return list(zip(on, rig.runs(runs, every=chosen.period if recorded else 0.0), strict=True))


def settings_from(given: Mapping[str, float]) -> Settings:
    """Settings by name."""
    names = [one.name for one in fields(Settings)]
    return Settings(**{known(name, names, "setting"): value for name, value in given.items()})  # type: ignore[arg-type]


def maker_of(controller: Controller) -> Callable[[], WheelSlideController] | None:
    """What makes a controller for each stop. Raises TypeError."""
    if controller is None:
        return None
    if controller == "protection":
        return SlideProtection
    steps = callable(getattr(controller, "step", None))
    if isinstance(controller, str) or not callable(controller):
        if not steps:
            raise TypeError(f'Give a controller\'s class, "protection" or None: it was {controller!r}.')
        name = type(controller).__name__
        raise TypeError(f"Give the class {name} and no object of it: each stop begins with a new controller.")
    if isinstance(controller, type) and not steps:
        raise TypeError(f"The class {controller.__name__} has no method step(time, wheel_speeds); give it one.")
    return controller


def _sentence(case: RailCase, stop: Stop) -> str:
    """What a stop came to."""
    locked = "" if stop.distance is None else f", locked for {stop.longest_lock:.1f} s"
    return f"{case.name}: {stop.words}{locked}."
