"""Stops of a bogie, or of a coach, that a wheel-slide controller of one's own protects."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields, replace
from typing import Literal

from bogie_braking.checks import known
from brake_controller.wheel_slide import WheelSlideController
from fmu_src.cosimulation.recording import Recording
from products.protection.braked_machine import BrakedMachine, Machine, bogie, coach
from products.protection.protected_stop import ProtectedStop, Settings
from products.protection.protected_stop import protected_stop as run_stop
from products.protection.rails import ABOVE, BAND, LOCK_ABOVE, RAILS, RailCase
from products.protection.slide_protection import SlideProtection

#: A class, or another function that makes a new controller.
Controller = Callable[[], WheelSlideController] | Literal["protection"] | None
#: Machines by the names of their FMUs.
MACHINES: Mapping[str, Callable[[], Machine]] = {"bogie": bogie, "vehicle": coach}
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
#: The host's step is the longest up to this that goes into the controller's period [s].
HOST_STEP = 5e-3


def protected_stops(
    controller: Controller,
    vehicle: str = "bogie",
    rails: Iterable[str] = NAMES,
    **settings: float,
) -> Recording:
    """One full service brake to rest on each rail, protected by a new controller: a row and a sentence for each.

    controller: a class whose objects have `step(time, wheel_speeds)` [s], [m/s], which answers for each wheelset 0 to
    apply its brake, 1 to hold or 2 to vent it; "protection": the one that comes with the brake; None: no controller.
    vehicle: "bogie" or "vehicle", the coach. settings: speed, at which it begins, 25 m/s; strength, torque over that of
    the full brake, 1; application_time, to 95 % of it, 2 s; period, of its questions, 5e-3 s; pulses, teeth of the
    wheel under each speed sensor, 100; jitter, standard deviation of their places as a share of the pitch, 0.

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
    for case, stop in stops_of(controller, vehicle, rails, settings):
        distance = math.nan if stop.distance is None or stop.failure else stop.distance
        lock, share = stop.longest_lock(LOCK_ABOVE), stop.share_in_band(BAND, ABOVE)
        duration = stop.time if stop.judged else math.nan
        rows.append([len(rows), case.condition.friction, distance, duration, lock, share, stop.air()])
        said.append(sentence(case, stop))
    return Recording(COLUMNS, rows, said, {"stops": len(rows)})


def protected_stop(controller: Controller, rail: str, vehicle: str = "bogie", **settings: float) -> Recording:
    """One stop of `protected_stops` over time, on one rail: what the controller saw and did, every period.

    Columns: time [s]; speed of the machine [m/s]; braking_force of all wheelsets [N]; and of each wheelset true
    wheel_speed [m/s], pressure in its cylinder [Pa], what its valve was told, and adhesion that it used.
    """
    [(case, stop)] = stops_of(controller, vehicle, [rail], settings)
    series = stop.series
    rows = list(zip(*(series[name] for name in series.names), strict=True))
    return Recording(series.units, rows, [sentence(case, stop)], {"commands": stop.count_of_commands()})


def stops_of(
    controller: Controller, vehicle: str, rails: Iterable[str], settings: Mapping[str, float]
) -> Iterator[tuple[RailCase, ProtectedStop]]:
    """The rails with the stop on each. Raises what `protected_stops` says."""
    if isinstance(rails, str):
        raise TypeError(f'Give the rails as a list, such as ["{rails}"]: it was the text {rails!r}.')
    make, cases, chosen = maker_of(controller), {rail.name: rail for rail in RAILS}, settings_from(settings)
    on = [cases[known(name, cases, "rail")] for name in rails]
    machine = MACHINES[known(vehicle, MACHINES, "vehicle with brakes")]()
    with BrakedMachine(machine) as braked:
        for case in on:
            values = case.values(len(machine.numbers))
            yield case, run_stop(braked, values, make() if make else None, chosen)


def settings_from(given: Mapping[str, float]) -> Settings:
    """Settings by name; the host's step is the longest up to HOST_STEP of which the period is a multiple."""
    names = [one.name for one in fields(Settings) if one.name != "host_step"]
    chosen = Settings(**{known(name, names, "setting"): value for name, value in given.items()})  # type: ignore[arg-type]
    return replace(chosen, host_step=chosen.period / math.ceil(chosen.period / HOST_STEP))


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


def sentence(case: RailCase, stop: ProtectedStop) -> str:
    """What a stop came to."""
    if not stop.judged:
        return f"{case.name}: {stop.words}"
    return f"{case.name}: {stop.words}, locked for {stop.longest_lock(LOCK_ABOVE):.1f} s."
