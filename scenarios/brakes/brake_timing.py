"""Application and release of the built-in brakes against the windows of the standards, timed and by flow of air.

The scenario also compares the flow model with closed forms of gas dynamics, its balances, and the force and friction
of the shoes that chapter 7 reports.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, LINES, THESIS, THREE, TRAILING, plt, titled
from bogie_braking.reporting.report import Report, Row, between, measured, value_of
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.cylinder import TIMES
from brake_controller.experiment import APPLICATION_TIME, EXPERIMENT
from brake_controller.ready_sets import (
    DUMP,
    UIC_G,
    UIC_P,
    UIC_PRESSURE,
    UIC_RELEASED,
    ReadySet,
    Timing,
    Window,
    qr30_experiment,
    uic_g,
    uic_p,
    with_dump_valve,
)
from brake_controller.shoe_friction import (
    CAST_IRON_P6,
    COMPOSITE,
    FALLING,
    KILOMETRES_PER_HOUR,
    MEASURED_AGAINST_FORCE,
)
from brake_controller.timing import APPLIED_SHARE, RELEASED_SHARE
from fmu_src.cosimulation.master import cosimulate
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import FmuInstance
from scenarios.bench.brake_air import balance_rows, closed_form_rows
from scenarios.bench.open_fmus import open_brake

TIMED, FLOW = 1, 2
KINDS = {TIMED: "timed", FLOW: "flow"}
#: Recorded instants of each run.
INSTANTS = 600
#: Tolerance: times are published to a tenth of a second; the definition of a time by 95 % is ours [s].
PRINTED_TIME = 0.01
#: Time after which every brake is fully applied [s], and largest difference of equal forces [kN].
FULLY_APPLIED, SAME_FORCE = 200.0, 0.01
#: Normal force of one shoe of a new bogie [kN] and its missing share [%], by pressure [kPa]: sections 7.2.1, 7.3.1,
#: 7.4.1.
PRINTED_FORCE = {130: (5.33, 18), 150: (6.15, 19), 180: (7.38, 15)}
#: Laws of shoe friction in the plot, and sliding speeds [km/h].
LAWS = {CAST_IRON_P6: "cast iron P6", COMPOSITE: "composite, type K", FALLING: "falling with speed (assumed)"}
SPEEDS = np.linspace(0.0, 120.0, 121)


@dataclass(frozen=True)
class Application:
    """A brake that is applied, and released after `applied` [s] by demand or by the venting valve (`vents`)."""

    name: str
    ready: ReadySet
    pressure: float
    released: float
    timing: Timing
    applied: float
    duration: float
    source: str
    vents: bool = False

    @property
    def kinds(self) -> tuple[int, ...]:
        """Return the cylinder models of the case; the timed law lacks a valve for venting."""
        return (FLOW,) if self.vents else (TIMED, FLOW)


def cases() -> list[Application]:
    qr30_times = Timing(Window(APPLICATION_TIME, APPLICATION_TIME), Window(APPLICATION_TIME, APPLICATION_TIME))
    uic = "UIC 543, secondary literature"
    dump = Timing(UIC_P.application, DUMP)
    return [
        Application("QR30", qr30_experiment(180), 180e3, RELEASED_SHARE * 180e3, qr30_times, 1.6, 3.6, "section 7.1"),
        Application("UIC P", uic_p(), UIC_PRESSURE, UIC_RELEASED, UIC_P, 8.0, 34.0, uic),
        Application("UIC G", uic_g(), UIC_PRESSURE, UIC_RELEASED, UIC_G, 45.0, 125.0, f"{uic}; section 2.4.2"),
        Application(
            "dump valve", with_dump_valve(uic_p()), UIC_PRESSURE, UIC_RELEASED, dump, 8.0, 12.0, "assumed", True
        ),
    ]


def values_of(ready: ReadySet, cylinder_model: int) -> dict[str, float]:
    """Return the parameters of one cylinder model; those of the other have no effect."""
    without = TIMES if cylinder_model == FLOW else ready.flow.values()
    return {"cylinder_model": cylinder_model} | {k: v for k, v in ready.values().items() if k not in without}


def apply_and_release(brake: FmuInstance, case: Application, cylinder_model: int) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and cylinder pressures [Pa]; the release is at one of the instants."""
    brake.restart(values_of(case.ready, cylinder_model), pressure_demand=case.pressure)
    step = case.duration / INSTANTS

    def drive(time: float) -> None:
        if round(time / step) == round(case.applied / step):
            brake.set(**({"valve": 2} if case.vents else {"pressure_demand": 0.0}))

    series = cosimulate([brake], [], case.duration, step, [(brake, "cylinder_pressure")], drive)
    return series["time"], series["cylinder_pressure"]


def times_of(case: Application, time: np.ndarray, pressure: np.ndarray) -> tuple[float, float]:
    """Return application and release time [s], interpolated linearly between the recorded instants."""
    begin = round(case.applied / case.duration * INSTANTS)
    rising, falling = slice(0, begin + 1), slice(begin, None)
    application = np.interp(APPLIED_SHARE * case.pressure, pressure[rising], time[rising])
    release = np.interp(-case.released, -pressure[falling], time[falling]) - time[begin]
    return float(application), float(release)


def timing_rows(case: Application, kind: str, found: tuple[float, float]) -> list[Row]:
    """Return the times of one run against their windows."""
    rows = []
    words = ("application to 95 %", f"{'vent' if case.vents else 'release'} to {case.released / 1e3:.0f} kPa")
    for word, window, seconds in zip(words, (case.timing.application, case.timing.release), found, strict=True):
        if case.vents and word is words[0]:
            continue
        quantity, printed = f"{case.name}, {kind}: {word}", window.shortest == window.longest
        if not printed:
            window_of_standard = between(window.shortest, window.longest)
            rows.append(measured(quantity, "s", seconds, case.source, window_of_standard))
        elif word is words[0]:
            why = "0-95 % definition, section 2.4.2"
            rows.append(Row(quantity, "s", window.middle, seconds, PRINTED_TIME, case.source, why))
        else:
            why = "not judged: release is not printed, assumed as fast as application"
            rows.append(measured(quantity, "s", seconds, case.source, None, why))
    return rows


def force_rows(brake: FmuInstance, case: Application) -> list[Row]:
    """Return the force of the shoes when the brake is fully applied, by flow against the timed law."""
    forces = []
    for cylinder_model in case.kinds:
        brake.restart(values_of(case.ready, cylinder_model), pressure_demand=case.pressure)
        brake.step(0.0, FULLY_APPLIED)
        forces.append(brake["shoe_force"] / 1e3)
    note = "the timed law's; the return spring counts in both"
    return [Row(f"{case.name}: shoe force by flow", "kN", forces[0], forces[1], SAME_FORCE, "eq. (2.4)", note)]


def experiment_rows(brake: FmuInstance) -> list[Row]:
    """Return force and friction of the shoes at the three pressures of the experiment, by flow."""
    rows = []
    for pressure, case in EXPERIMENT.items():
        values = values_of(qr30_experiment(pressure), FLOW) | {"friction_law": MEASURED_AGAINST_FORCE}
        brake.restart(values, pressure_demand=1e3 * pressure)
        brake.step(0.0, 20.0)
        specified, lost = PRINTED_FORCE[pressure]
        source = f"sections 7.2.1, 7.3.1, 7.4.1: {specified} kN for a new bogie"
        found = 100 * (1 - brake["shoe_force"] / 2e3 / specified)
        text = f"{pressure} kPa: brake rod force under the new bogie's"
        rows.append(Row(text, "%", lost, found, 0.5, source, "printed to 1 %; printed efficiency"))
        low, high = case.lowest_shoe_friction, case.highest_shoe_friction
        text = f"{pressure} kPa: shoe friction, law 1"
        asked = between(low, high)
        rows.append(Row(text, "1", case.shoe_friction, brake["shoe_friction"], asked, "chapter 7, measured"))
    return rows


def friction_over_speed(brake: FmuInstance) -> dict[str, np.ndarray]:
    """Return the laws of shoe friction over SPEEDS, with the shoes of the UIC brake fully applied."""
    found = {}
    ready = uic_p()
    for law, label in LAWS.items():
        brake.restart(values_of(ready, TIMED) | {"friction_law": law}, pressure_demand=UIC_PRESSURE)
        brake.step(0.0, 30.0)
        frictions = []
        for speed in SPEEDS / KILOMETRES_PER_HOUR:
            brake.set(angular_velocity=speed / ready.rigging.wheel_radius)
            frictions.append(brake["shoe_friction"])
        found[label] = np.array(frictions)
    return found


def run(options: Options, quick: bool = False) -> Report:
    rows: list[Row] = []
    series = Recording({"instant": "1"}, [[number] for number in range(INSTANTS + 1)])
    seconds = 0.0
    chosen = cases()
    with open_brake(options) as brake:
        for case in chosen:
            for cylinder_model in case.kinds:
                time, pressure = apply_and_release(brake, case, cylinder_model)
                seconds += case.duration
                rows += timing_rows(case, KINDS[cylinder_model], times_of(case, time, pressure))
                series.add(f"time ({case.name})", "s", time)
                series.add(f"cylinder_pressure ({case.name}, {KINDS[cylinder_model]})", "Pa", pressure)
            rows += [] if case.vents else force_rows(brake, case)
        rows += experiment_rows(brake)
        frictions = friction_over_speed(brake)
        guids = {brake.name: brake.guid}
    rows += closed_form_rows() + balance_rows()
    parameters = {case.name: case.ready.values() for case in chosen}
    remarks = [restrictions(case) for case in chosen]
    fillings = [
        [value_of(rows, f"{case.name}, {KINDS[kind]}: application to 95 %") for kind in case.kinds]
        for case in chosen
        if not case.vents
    ]
    apart = max(max(times) - min(times) for times in fillings)
    return Report(rows, series, lambda: draw(chosen, series, frictions, apart), parameters, seconds, remarks, guids)


def restrictions(case: Application) -> str:
    flow = case.ready.flow
    names = ("application", "release", "vent")
    bores = (flow.application_orifice, flow.release_orifice, flow.vent_orifice)
    sizes = ", ".join(f"{name} {1e3 * bore:.2f} mm" for name, bore in zip(names, bores, strict=True))
    return f"{case.name}: restrictions {sizes}, found from the times."


def draw(chosen: Sequence[Application], series: Recording, frictions: dict[str, np.ndarray], apart: float) -> Figure:
    figure, grid = plt.subplots(2, 2, figsize=(10.0, 7.2))
    by_name = {case.name: case for case in chosen}
    for axis, name in zip(grid.flat, ("QR30", "UIC P", "UIC G"), strict=False):
        _draw_pressures(axis, by_name[name], series)
    dump = by_name["dump valve"]
    begin = round(dump.applied / dump.duration * INSTANTS)
    time, pressure = series["time (dump valve)"], series["cylinder_pressure (dump valve, flow)"] / 1e3
    grid[0, 1].plot(time[begin:], pressure[begin:], color=BOGIE, linewidth=1.0, label="dump valve (assumed)")
    for axis in (grid[0, 0], grid[0, 1], grid[1, 0]):
        axis.legend(loc="upper right")
    _draw_friction(grid[1, 1], frictions)
    return titled(figure, f"Fully applied, cylinders fill by flow within {1e3 * apart:.0f} ms of timed ones")


def _draw_pressures(axis: Axes, case: Application, series: Recording) -> None:
    for cylinder_model, line, colour in ((TIMED, "-", LEADING), (FLOW, "--", TRAILING)):
        pressure = series[f"cylinder_pressure ({case.name}, {KINDS[cylinder_model]})"] / 1e3
        axis.plot(series[f"time ({case.name})"], pressure, line, color=colour, label=KINDS[cylinder_model])
    allowed = (
        (APPLIED_SHARE * case.pressure, case.timing.application, 0.0),
        (case.released, case.timing.release, case.applied),
    )
    for number, (level, window, begin) in enumerate(allowed):
        if window.shortest < window.longest:
            label = "window of the standard" if number == 0 else None
            ends = [begin + window.shortest, begin + window.longest]
            axis.plot(ends, 2 * [level / 1e3], "|-", color=THESIS, linewidth=3, markersize=12, label=label)
        elif number == 0:
            axis.plot([window.middle], [level / 1e3], "o", color=THESIS, label="printed: 0.8 s")
    axis.set(title=f"{case.name}: cylinder pressure [kPa]", xlabel="time [s]")
    axis.set_ylim(0.0, 1.3 * case.pressure / 1e3)


def _draw_friction(axis: Axes, frictions: dict[str, np.ndarray]) -> None:
    for (label, friction), line, colour in zip(frictions.items(), LINES, THREE, strict=False):
        axis.plot(SPEEDS, friction, line, color=colour, label=label)
    for number, (pressure, case) in enumerate(EXPERIMENT.items()):
        low, high = case.lowest_shoe_friction, case.highest_shoe_friction
        words = "QR30, measured at 130, 150, 180 kPa, below 11 km/h" if number == 0 else None
        place = 2 + 4 * number  # side by side: the thesis does not report the speed of each trial
        axis.plot([place] * 2, [low, high], "_-", color=THESIS, linewidth=2, label=words)
        axis.annotate(f"{pressure}", (place, low), xytext=(0, -9), textcoords="offset points", ha="center", fontsize=7)
    axis.set(title="shoe friction [1], UIC brake fully applied", xlabel="sliding speed [km/h]")
    axis.set_ylim(0.0, 0.75)
    axis.legend(loc="upper right", fontsize=9)


SCENARIO = Scenario(
    "brake-timing",
    "Application and release of built-in brakes against the standards, timed and by flow of air",
    run,
    frozenset({"kind"}),
)
