"""Wheel-slide protection of a complete vehicle on low rails, which each wheelset cleans a little for the next."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, FOUR, one_word, plt, titled
from bogie_braking.reporting.report import Report, Row, at_least, at_most, between, measured
from bogie_braking.reporting.scenario import Options, Scenario
from products.coach import NUMBERS
from products.machine import coach, coach_brake
from products.protection.peak_adhesion import PeakAdhesion
from products.protection.rails import ABOVE, BAND, LOCK_ABOVE, LONGEST_LOCK, OVER_IDEAL, RailCase
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import BRAKE_START, Settings
from products.protection.slide_protection import SlideProtection
from rbd_model.track.friction import low

#: Factor on the friction under each wheelset, on a rail cleaned by the one before it (assumed); a quick run has this
#: rail only.
CLEANED = 1.1
RAILS = (RailCase("low", low()), RailCase("low, cleaned", low(), (("cleaned_friction", CLEANED),)))
#: Least part of that factor in the ratio of braking force over load from one wheelset to the next.
HALF_OF_IT = 0.5


@dataclass(frozen=True)
class VehicleStops:
    """Stops by rail, protected and not, and ideal distances by rail [m]."""

    protected: dict[str, Stop]
    unprotected: dict[str, Stop]
    ideal: dict[str, float]


def measure(rails: Sequence[RailCase]) -> VehicleStops:
    settings, names = Settings(), [rail.name for rail in rails]
    runs = [Run(rail.values(len(NUMBERS))) for rail in rails]
    protected, unprotected = (
        dict(zip(names, Rig(coach(), make, settings, by_flow=True).runs(runs, every=settings.period), strict=True))
        for make in (SlideProtection, None)
    )
    ideal = [PeakAdhesion(coach(), run.values).stopping_distance(settings.speed) for run in runs]
    return VehicleStops(protected, unprotected, dict(zip(names, ideal, strict=True)))


def force_over_load(stop: Stop) -> list[float]:
    """Return the mean braking force over axle load of each wheelset, with the full brake on the moving vehicle."""
    course = stop.course
    chosen = (course.time > 2 * BRAKE_START) & (course.speed > ABOVE)
    used: list[float] = (-course.creep_force / course.axle_load)[chosen].mean(axis=0).tolist()
    return used


def rows_of(found: VehicleStops) -> list[Row]:
    rows = []
    source = "planar vehicle, 25 m/s, full brake, four cylinders, four encoders, one controller"
    for name, stop in found.protected.items():
        ideal, free = found.ideal[name], found.unprotected[name]
        distance, lock = between(1.0, OVER_IDEAL), stop.longest_lock
        rows += [
            measured(f"{name}: ideal stopping distance", "m", ideal, "best slip of all wheels at every instant"),
            measured(f"{name}: stopping distance", "m", stop.distance, stop.note(source)),
            measured(f"{name}: distance over the ideal", "1", stop.over(ideal), "as asked of the bogie", distance),
            measured(f"{name}: longest lock", "s", lock, f"above {LOCK_ABOVE} m/s", at_most(LONGEST_LOCK)),
            measured(f"{name}: share in the slip band", "1", stop.share_in_band, f"up to {BAND:g}"),
            measured(f"{name}: air", "g", 1e3 * stop.air, "all cylinders"),
            measured(f"{name}, unprotected: stopping distance", "m", free.distance, free.note(source)),
            measured(f"{name}, unprotected: longest lock", "s", free.longest_lock),
        ]
    used = force_over_load(found.protected["low, cleaned"])
    for number, share in zip(NUMBERS, used, strict=True):
        label = f"low, cleaned: mean braking force over load of wheelset {number}"
        rows.append(measured(label, "1", share, "full brake"))
    rise = float(np.diff(used).min())
    label = "low, cleaned: least rise of braking force over load from one wheelset to the next"
    asked = at_least(HALF_OF_IT * (CLEANED - 1.0) * used[0])
    rows.append(measured(label, "1", rise, "leading wheelsets meet the dirtier rail", asked, "half of the factor"))
    return sorted(rows, key=lambda row: row.asked is None)  # rows with limits first


def run(options: Options, quick: bool = False) -> Report:
    rails = RAILS[1:] if quick else RAILS
    found = measure(rails)
    failures = [f"{name}: {stop.message}" for name, stop in found.protected.items() if stop.message]
    remarks = [
        f"Assumed: each wheelset raises the friction for the next by {100 * (CLEANED - 1):.0f} %; the low rail is that "
        "of `anti-skid`, from an unverified set. Ideal: the best slip at every instant under the loads at rest.",
        *failures,
    ]
    stops = (*found.protected.values(), *found.unprotected.values())
    parameters = coach_brake().values() | {"rails": {rail.name: rail.values(len(NUMBERS)) for rail in rails}}
    series = found.protected["low, cleaned"].course.recording(coach().parameters.wheel_radius)
    return Report(rows_of(found), series, lambda: draw(found), parameters, sum(stop.time for stop in stops), remarks)


def draw(found: VehicleStops) -> Figure:
    figure, grid = plt.subplots(2, 2, figsize=(11.0, 7.0), sharex="col")
    for column, (name, stop) in enumerate(found.protected.items()):
        series = stop.course.recording(coach().parameters.wheel_radius)
        top, bottom = grid[0, column], grid[1, column]
        top.plot(series["time"], series["speed"], color=BOGIE, label="vehicle")
        for number, colour in zip(NUMBERS, FOUR, strict=True):
            style = {"color": colour, "linewidth": 0.8, "label": f"wheelset {number}"}
            top.plot(series["time"], series[f"wheel_speed_{number}"], **style)
            bottom.plot(series["time"], series[f"pressure_{number}"] / 1e3, **style)
        top.set_title(f"{name}: speeds [m/s]; stops in {stop.words}, ideal {found.ideal[name]:.0f} m")
        bottom.set(title=f"{name}: cylinder pressures [kPa]", xlabel="time [s]")
    grid[0, 0].legend(fontsize=8)
    rail = next(iter(found.protected))
    protected, unprotected = found.protected[rail].distance, found.unprotected[rail].distance
    if protected is None or unprotected is None:
        return titled(figure, f"On {rail} rail not every stop comes to rest")
    start = one_word(f"{Settings.speed:g} m/s")
    return titled(figure, f"From {start} on {rail} rail: {protected:.0f} m, unprotected {unprotected:.0f} m")


SCENARIO = Scenario("vehicle-anti-skid", "Wheel-slide protection of four wheelsets, each of which cleans the rail", run)
