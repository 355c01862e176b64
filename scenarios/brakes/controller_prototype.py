"""Your own controller in a few lines, compared with the built-in protection."""

from collections.abc import Callable

from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, one_word, plt, titled
from bogie_braking.reporting.report import Report, measured
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.wheel_slide import WheelSlideController
from products.machine import bogie
from products.protection.rails import BAND, LOCK_ABOVE, RAILS
from products.protection.rig import Rig
from products.protection.runs import Run, Stop
from products.protection.settings import Settings
from products.protection.slide_protection import SlideProtection
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from scenarios.bench.own_controller import FixedSlip

CONTROLLERS: dict[str, Callable[[], WheelSlideController] | None] = {
    "none": None,
    "fixed slip": FixedSlip,
    "protection": SlideProtection,
}


def run(options: Options, quick: bool = False) -> Report:
    chosen = [rail for rail in RAILS if rail.name in ("low", "changing")]
    runs, settings = [Run(rail.values()) for rail in chosen], Settings()
    of_each = {
        name: Rig(bogie(), make, settings, by_flow=True).runs(runs, every=settings.period)
        for name, make in CONTROLLERS.items()
    }
    stops = {(rail.name, name): of_each[name][place] for place, rail in enumerate(chosen) for name in CONTROLLERS}
    rows = []
    for (rail, name), stop in stops.items():
        what = f"{rail} rail, {name}"
        rows += [
            measured(f"{what}: stopping distance", "m", stop.distance, stop.note("25 m/s, full service")),
            measured(f"{what}: longest lock", "s", stop.longest_lock, f"above {LOCK_ABOVE:g} m/s"),
            measured(f"{what}: share in the slip band", "1", stop.share_in_band, f"up to {BAND:g}"),
            measured(f"{what}: air", "g", 1e3 * stop.air, "both cylinders"),
        ]
    remark = "A controller is a class with step(time, wheel_speeds); `bb.protected_stops` tries it."
    seconds = sum(stop.time for stop in stops.values())
    series = stops["low", "fixed slip"].course.recording(bogie().parameters.wheel_radius)
    return Report(rows, series, lambda: draw(stops), tables_5_1_and_5_2().values(), seconds, [remark])


def draw(stops: dict[tuple[str, str], Stop]) -> Figure:
    figure, grid = plt.subplots(2, len(CONTROLLERS), figsize=(12.0, 6.5), sharey=True)
    for axis, ((rail, name), stop) in zip(grid.ravel(), stops.items(), strict=True):
        course, radius = stop.course, bogie().parameters.wheel_radius
        axis.plot(course.time, course.speed, color=BOGIE, label="bogie")
        for turning, colour, word in zip(
            course.angular_velocity.T, (LEADING, TRAILING), ("leading wheels", "trailing wheels"), strict=True
        ):
            axis.plot(course.time, radius * turning, color=colour, linewidth=0.8, label=word)
        axis.set(title=f"{rail} rail, {name}: {stop.words}", xlabel="time [s]")
    for axis in grid[:, 0]:
        axis.set_ylabel("speed [m/s]")
    grid[0, 0].legend(fontsize=8)
    ways = {name: stops["low", name].distance for name in ("fixed slip", "protection")}
    if None in ways.values():
        return titled(figure, "Not every controller stops the bogie on low rail")
    own, other = ways.values()
    start = one_word(f"{Settings.speed:g} m/s")
    return titled(figure, f"From {start} on low rail: fixed slip {own:.0f} m, protection {other:.0f} m")


SCENARIO = Scenario("controller-prototype", "Your own wheel-slide controller in under 40 lines, compared", run)
