"""Your own controller in a few lines, compared with the protection that comes with the brake."""

from collections.abc import Callable

from matplotlib.figure import Figure

from brake_controller.wheel_slide import WheelSlideController
from products.protection.braked_machine import BrakedMachine
from products.protection.protected_stop import ProtectedStop, protected_stop
from products.protection.rails import ABOVE, BAND, LOCK_ABOVE, RAILS
from products.protection.slide_protection import SlideProtection
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from scenarios.bench.own_controller import FixedSlip
from scenarios.reporting.plots import BOGIE, LEADING, TRAILING, plt, titled
from scenarios.reporting.report import Report, Row
from scenarios.scenario import Options, Scenario

CONTROLLERS: dict[str, Callable[[], WheelSlideController] | None] = {
    "none": None,
    "fixed slip": FixedSlip,
    "protection": SlideProtection,
}


def run(options: Options) -> Report:
    chosen = [rail for rail in RAILS if rail.name in ("low", "changing")]
    with BrakedMachine() as machine:
        stops = {
            (rail.name, name): protected_stop(machine, rail.values(), make() if make else None)
            for rail in chosen
            for name, make in CONTROLLERS.items()
        }
    rows = []
    for (rail, name), stop in stops.items():
        what = f"{rail} rail, {name}"
        rows += [
            Row(f"{what}: stopping distance", "m", None, stop.distance, None, stop.note("25 m/s, full service")),
            Row(f"{what}: longest lock", "s", None, stop.longest_lock(LOCK_ABOVE), None, f"above {LOCK_ABOVE:g} m/s"),
            Row(f"{what}: share in the slip band", "1", None, stop.share_in_band(BAND, ABOVE), None, f"up to {BAND:g}"),
            Row(f"{what}: air", "g", None, 1e3 * stop.air(), None, "both cylinders"),
        ]
    remark = "A controller is a class with step(time, wheel_speeds); `protected_stop` tries it."
    seconds = sum(stop.time for stop in stops.values())
    series = stops["low", "fixed slip"].series
    return Report(rows, series, lambda: draw(stops), tables_5_1_and_5_2().values(), seconds, [remark])


def draw(stops: dict[tuple[str, str], ProtectedStop]) -> Figure:
    figure, grid = plt.subplots(2, len(CONTROLLERS), figsize=(12.0, 6.5), sharey=True)
    for axis, ((rail, name), stop) in zip(grid.ravel(), stops.items(), strict=True):
        series = stop.series
        axis.plot(series["time"], series["speed"], color=BOGIE, label="bogie")
        for number, colour, word in ((1, LEADING, "leading wheels"), (2, TRAILING, "trailing wheels")):
            axis.plot(series["time"], series[f"wheel_speed_{number}"], color=colour, linewidth=0.8, label=word)
        axis.set(title=f"{rail} rail, {name}: {stop.words}", xlabel="time [s]")
    for axis in grid[:, 0]:
        axis.set_ylabel("speed [m/s]")
    grid[0, 0].legend(fontsize=8)
    ways = {name: stops["low", name].distance for name in ("fixed slip", "protection")}
    if None in ways.values():
        return titled(figure, "Not every controller stops the bogie on low rail")
    own, other = ways.values()
    return titled(figure, f"A fixed slip needs {own:.0f} m on low rail, protection {other:.0f} m")


SCENARIO = Scenario("controller-prototype", "A wheel-slide controller of one's own in under 40 lines, compared", run)
