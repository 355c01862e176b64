"""Wheel-slide protection on dry, wet, low and changing rail: unprotected, protected and ideal stops."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, one_word, plt, single, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, at_most, between, measured
from bogie_braking.reporting.scenario import Options, Scenario, Sweepable
from brake_controller.wheel_slide import WheelSlideController
from products.machine import APPLICATION_TIME, bogie
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.rails import (
    ABOVE,
    LOCK_ABOVE,
    LONGEST_LOCK,
    OVER_IDEAL,
    RAILS,
    SHARE,
    RailCase,
)
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from rbd_model.track.friction import low
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

#: Jitter of the teeth, as shares of their pitch.
JITTERS = (0.0, 0.1)


@dataclass(frozen=True)
class Varied:
    """Variations: controller periods of the stops on low rail [s], teeth of the sensors, brake torques on dry rail.

    brake_ratios: over the full service brake [1]. All wheels roll at these; one locks from 1.6 on.
    """

    periods: tuple[float, ...] = (2e-3, 5e-3, 1e-2, 2e-2)
    teeth: tuple[int, ...] = (80, 100, 128, 200, 10000)
    brake_ratios: tuple[float, ...] = (1.0, 1.25, 1.5)


QUICK = Varied((5e-3,), (80, 10000), (1.0, 1.25))
#: Notes on the ideal braking force, and on the largest force of a rail.
IDEAL = "1 too where the brake asks for less than the rail gives"
BEST = f"mean above {ABOVE:g} m/s; largest: at the best slip of all wheels, at that speed and place"
#: Controllers between wheels and valves, by mode.
MODES: dict[str, Callable[[], WheelSlideController] | None] = {"unprotected": None, "protected": SlideProtection}


#: Markers by mode. Their shapes differ, so that they are distinct in grey print.
MARKERS = {"ideal": ("|", BOGIE), "protected": ("o", LEADING), "unprotected": ("x", TRAILING)}


@dataclass(frozen=True)
class ProtectedStops:
    """Stops by rail and mode, ideal distances by rail [m]; low-rail stops by period and by teeth; dry-rail stops.

    used: mean of the braking force over the largest that the rail allows [1], by rail and mode.
    """

    varied: Varied
    stops: dict[tuple[str, str], Stop]
    ideal: dict[str, float]
    used: dict[tuple[str, str], float]
    low: dict[float, Stop]
    teeth: dict[int, Stop]
    dry: list[Stop]


def measure(varied: Varied) -> ProtectedStops:
    stops: dict[tuple[str, str], Stop] = {}
    for mode in MODES:
        found = stops_of(RAILS, mode, Settings(), every=Settings().period)
        stops |= {(rail.name, mode): stop for rail, stop in zip(RAILS, found, strict=True)}
    on_low, on_dry = RAILS[2:3], RAILS[:1]
    low_stops = {period: stops_of(on_low, "protected", Settings(period=period))[0] for period in varied.periods}
    teeth = {pulses: stops_of(on_low, "protected", Settings(pulses=pulses))[0] for pulses in varied.teeth}
    changes = product(varied.brake_ratios, varied.teeth, JITTERS)
    dry_tries = [Settings(brake_ratio=ratio, pulses=pulses, jitter=jitter) for ratio, pulses, jitter in changes]
    dry_stops = [stops_of(on_dry, "protected", settings)[0] for settings in counting(dry_tries, unit="stop")]
    best = {rail.name: PeakAdhesion(bogie(), rail.values()) for rail in RAILS}
    ideal = {name: one.stopping_distance(Settings().speed) for name, one in best.items()}
    used = {(rail, mode): float(best[rail].used(stop).mean()) for (rail, mode), stop in stops.items()}
    return ProtectedStops(varied, stops, ideal, used, low_stops, teeth, dry_stops)


def stops_of(rails: Sequence[RailCase], mode: str, settings: Settings, every: float = 0.0) -> list[Stop]:
    """Return one stop on each rail.

    Takes every [s].
    """
    rig = Rig(bogie(), MODES[mode], settings, by_flow=True)
    return rig.runs([Run(rail.values()) for rail in rails], every=every)


# ---- the table -------------------------------------------------------------------------------------------------------


def rows_of(found: ProtectedStops) -> list[Row]:
    """Return the rows that have a limit, then the rows of every stop."""
    rows = judged_rows(found)
    source = "planar bogie, 25 m/s, full service"
    for rail in RAILS:
        verified = "" if rail.condition.verified else "friction falls as in an unverified set"
        ideal = found.ideal[rail.name]
        rows.append(measured(f"{rail.name}: ideal stopping distance", "m", ideal, source, None, verified))
        for mode in MODES:
            stop, used = found.stops[rail.name, mode], found.used[rail.name, mode]
            name = f"{rail.name}, {mode}{', wheels locked' if stop.course.locks(LOCK_ABOVE) else ''}"
            share = stop.share_in_band
            rows += [
                measured(f"{name}: stopping distance", "m", stop.distance, stop.note(source)),
                measured(f"{name}: longest lock", "s", stop.longest_lock, f"above {LOCK_ABOVE} m/s"),
                measured(f"{name}: share in the slip band", "1", share, "up to 0.3"),
                measured(f"{name}: distance over the ideal", "1", stop.over(ideal), IDEAL),
                measured(f"{name}: braking force over the rail's largest", "1", used, BEST),
                *without_sliding(name, rail, stop),
                measured(f"{name}: air", "g", 1e3 * stop.air, "both cylinders"),
            ]
    for pulses, stop in found.teeth.items():
        name = f"low, protected, {pulses} teeth: stopping distance"
        rows.append(measured(name, "m", stop.distance, stop.note("of each sensor")))
    return rows


def without_sliding(name: str, rail: RailCase, stop: Stop) -> list[Row]:
    """Return the mean braking force over the force that friction without sliding would give, if the rail is uniform."""
    if rail.changes:
        return []
    course, weight = stop.course, bogie().mass * bogie().parameters.gravity
    share = -float(course.creep_force.sum(axis=1)[course.braked(ABOVE)].mean()) / (rail.condition.friction * weight)
    source = f"mean above {ABOVE:g} m/s; mu0 = {rail.condition.friction:g}"
    return [measured(f"{name}: braking force over friction without sliding", "1", share, source)]


def judged_rows(found: ProtectedStops) -> list[Row]:
    """Return the rows with limits: the low rail with all periods and sensors, and the dry rail without commands."""
    stops = [*found.low.values(), *found.teeth.values()]
    lock = max(stop.longest_lock for stop in stops)
    share = min(stop.share_in_band for stop in stops)
    commands = sum(stop.commands for stop in found.dry)
    unprotected = found.stops["low", "unprotected"]
    teeth, ratios = found.varied.teeth, found.varied.brake_ratios
    words = f"worst of periods 2-20 ms, and sensors of {teeth[0]} to {teeth[-1]} teeth"
    dry_words = f"{len(found.dry)} stops: {ratios[0]:g} to {ratios[-1]:g} of the full service brake, all sensors"
    over_ideal, over_locked = longest(stops, found.ideal["low"]), longest(stops, unprotected.distance)
    return [
        measured("low: longest distance over the ideal", "1", over_ideal, words, between(1.0, OVER_IDEAL)),
        measured("low: longest distance over that of locked wheels", "1", over_locked, "same brake", at_most(1.0)),
        measured("low: longest lock of all", "s", lock, f"above {LOCK_ABOVE} m/s", at_most(LONGEST_LOCK)),
        measured("low: least share in the slip band", "1", share, words, at_least(SHARE)),
        measured("dry: commands other than to apply", "1", commands, dry_words, at_most(0.0)),
    ]


def longest(stops: Sequence[Stop], distance: float | None) -> float | None:
    """Return the longest stopping distance over another distance [1]; None if a stop or the distance is missing."""
    ratios = [stop.over(distance) for stop in stops]
    return None if None in ratios else max(ratio for ratio in ratios if ratio is not None)


def run(options: Options, quick: bool = False) -> Report:
    found = measure(QUICK if quick else Varied())
    rows = rows_of(found)
    failures = [f"{rail}, {mode}: {stop.message}" for (rail, mode), stop in found.stops.items() if stop.message]
    remarks = [
        "Measures in the manner of EN 15595 (stopping distance, slip, lock, air), without any claim of conformity. "
        "Ideal: the best slip at every instant, as the brake fills. Sets for low adhesion are unverified. Locked "
        f"wheels are those of the same brake without protection: on {among(found, True)} rail each stands for most "
        f"of the way; on {among(found, False)} rail they roll for most of it, and there is nothing to compare.",
        *failures,
    ]
    series = found.stops["low", "protected"].course.recording(bogie().parameters.wheel_radius)
    stops = (*found.stops.values(), *found.low.values(), *found.teeth.values(), *found.dry)
    seconds = sum(stop.time for stop in stops)
    parameters = tables_5_1_and_5_2().values() | {"rails": {rail.name: rail.values() for rail in RAILS}}
    report = Report(rows, series, lambda: draw(found), parameters, seconds, remarks)
    report.other_figures["periods"] = lambda: draw_periods(found)
    return report


def among(found: ProtectedStops, locks: bool) -> str:
    """Return the rails on which the wheels lock without protection (`locks`), or on which they do not."""
    names = [rail.name for rail in RAILS if found.stops[rail.name, "unprotected"].course.locks(LOCK_ABOVE) == locks]
    return " and ".join(names)


# ---- the figure ------------------------------------------------------------------------------------------------------


def message(found: ProtectedStops) -> str:
    """Return the title: the gain of protection on the low rail."""
    protected, unprotected = (found.stops["low", mode].distance for mode in ("protected", "unprotected"))
    if protected is None or unprotected is None:
        return f"On low rail {'protected' if protected is None else 'unprotected'} wheels do not stop"
    start = one_word(f"{Settings.speed:g} m/s")
    return f"From {start} on low rail: {protected:.0f} m protected, {unprotected:.0f} m unprotected"


def draw(found: ProtectedStops) -> Figure:
    """Draw the stopping distances, one line for each rail."""
    figure, axis = plt.subplots(figsize=(8.0, 4.4))
    places = range(len(RAILS))[::-1]
    for mode, (marker, colour) in MARKERS.items():
        distances = [found.ideal[rail.name] if mode == "ideal" else way(found, rail.name, mode) for rail in RAILS]
        axis.plot(distances, places, marker, color=colour, markersize=14, markeredgewidth=3.0, label=mode)
    axis.set_yticks(places, [f"{rail.name} rail" for rail in RAILS], fontsize="x-large")
    axis.set(xlabel="stopping distance from 25 m/s, full service [m]", xlim=(0.0, None), ylim=(-0.6, len(RAILS) - 0.4))
    axis.legend(loc="lower right", fontsize="x-large")
    return titled(figure, message(found))


def way(found: ProtectedStops, rail: str, mode: str) -> float:
    """Return the stopping distance [m], or nan, which no marker shows, if the run did not stop."""
    distance = found.stops[rail, mode].distance
    return np.nan if distance is None else distance


def draw_periods(found: ProtectedStops) -> Figure:
    """Draw the distances on the low rail over the controller's period."""
    ideal = found.ideal["low"]
    worst = longest(list(found.low.values()), ideal)
    reached = "not every stop comes to rest" if worst is None else f"all stops stay within {worst:.2f} of the ideal"
    periods = f"{1e3 * min(found.low):g}-{1e3 * max(found.low):g} ms"
    figure, axis = single(f"At {periods} {reached}", "controller period [ms]", "stopping distance on low rail [m]")
    distances = [np.nan if stop.distance is None else stop.distance for stop in found.low.values()]
    axis.plot([1e3 * period for period in found.low], distances, "o-", color=LEADING, markersize=9, label="protected")
    axis.axhline(ideal, color=BOGIE, linestyle="--", label="ideal")
    axis.axhline(OVER_IDEAL * ideal, color=BOGIE, linestyle=":", label=f"{100 * (OVER_IDEAL - 1):.0f} % beyond it")
    axis.legend(fontsize="large")
    return figure


# ---- sweeps ---------------------------------------------------------------------------------------------------------


def one_point(
    friction: float = low().friction,
    application_time: float = APPLICATION_TIME,
    initial_speed: float = 25.0,
    protected: float = 1.0,
    period: float = 5e-3,
    friction_ratio: float = low().law.friction_ratio,
    friction_decay: float = low().law.friction_decay,
) -> dict[str, float | None]:
    """Return the results of one stop on a rail whose friction falls as in the low set unless given.

    Takes application_time [s], initial_speed [m/s], period [s].
    """
    condition = low()
    law = replace(condition.law, friction_ratio=friction_ratio, friction_decay=friction_decay)
    rail = replace(condition, friction=friction, law=law).values()
    settings = Settings(speed=initial_speed, application_time=application_time, period=period)
    [stop] = Rig(bogie(), SlideProtection if protected else None, settings, by_flow=True).stops([rail])
    return {
        "stop_distance": stop.distance,
        "end_speed": stop.end_speed,
        "stop_time": None if stop.distance is None else stop.time,
        "longest_lock": stop.longest_lock,
        "share_in_band": stop.share_in_band,
        "air": stop.air,
    }


SWEEP = Sweepable(
    {
        "friction": "1",
        "application_time": "s",
        "initial_speed": "m/s",
        "protected": "1",
        "period": "s",
        "friction_ratio": "1",
        "friction_decay": "s/m",
    },
    {
        "stop_distance": "m",
        "end_speed": "m/s",
        "stop_time": "s",
        "longest_lock": "s",
        "share_in_band": "1",
        "air": "kg",
    },
    one_point,
)
SCENARIO = Scenario(
    "anti-skid",
    "Wheel-slide protection on four rails, against the same brake without it and the ideal",
    run,
    sweep=SWEEP,
)
