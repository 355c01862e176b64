"""The bogie of chapter 5 over lateral, vertical and cross-level irregularities at constant speed (section 5.3)."""

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, irregular, motion_columns
from bogie_braking.reporting.plots import LEADING, TRAILING, plt, titled
from bogie_braking.reporting.report import Report, Row, measured, near, rounding
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from fmu_src.system import System
from products.kernel_runs import RIGID, bogie, spectrum
from rbd_model.levels.models import levels
from rbd_model.linear import oscillations
from rbd_model.track.irregularity import section_5_3
from rbd_model.vehicle.parameters import as_printed, tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.irregularities import (
    CROSS_LEVEL,
    DURATION,
    HUNTING_PEAK,
    LATERAL,
    LATERAL_PEAK,
    SPEEDS,
    VERTICAL,
    WHEEL_LOAD,
    Irregularity,
    kinematic_peak,
    largest_wheel_load,
    travel,
)

SPACING = "half spacing of the suspension 0.7 m and frame height 0.8 m are fitted, to other values"
FLANGE = "not judged: the flange's stiffness is fitted to it"
#: Column whose largest value the title of each figure reports, and its words.
MESSAGES = {
    LATERAL.name: ("lateral_1", "lateral wave shifts a wheelset by"),
    VERTICAL.name: ("axle_load_1", "vertical wave loads an axle with"),
    CROSS_LEVEL.name: ("frame_roll", "cross level rolls the frame by"),
}
#: Tolerance of a closed form.
BAND = 1e-3
AT_RAIL = "a flange pushed at the rail, and where it meets it"


def lateral_rows(runs: dict[float, Recording]) -> list[Row]:
    slow, source = runs[15.0], "section 5.3.1"
    peak = int(np.argmax(np.abs(slow["lateral_1"])))
    place = float(slow["distance"][peak]) + tables_5_1_and_5_2().wheel_base / 2
    printed, vampire = LATERAL_PEAK
    shift, axle = 1e3 * abs(float(slow["lateral_1"][peak])), "position of the leading axle"
    at_rail = 1e3 * float(np.abs(travel(LATERAL, 15.0, flange_at_rail=1)[1]["lateral_1"]).max())
    largest = "15 m/s: largest shift"
    rows = [
        Row(f"{largest} of the leading wheelset", "mm", printed, shift, None, source, FLANGE, vampire=vampire),
        Row("15 m/s: where that is", "m", 17.0, place, rounding("17"), source, axle, vampire=17.0),
        Row(f"{largest}, {AT_RAIL}", "mm", printed, at_rail, None, source, FLANGE, vampire=vampire),
    ]
    for speed, (thesis, vampire) in HUNTING_PEAK.items():
        frequency = kinematic_peak(runs[speed])
        name = f"{speed:g} m/s: spectral peak of the hunting"
        asked, note = rounding("0.774" if speed < 20.0 else "1.45"), "of a decaying motion"
        rows.append(Row(name, "Hz", thesis, frequency, asked, source, note, vampire=vampire))
    late = runs[25.0]["time"] > DURATION - 2.0
    ratio = np.abs(runs[25.0]["lateral_1"][late]).max() / np.abs(runs[25.0]["lateral_1"]).max()
    rows.append(measured("25 m/s: shift of the last 2 s over the largest", "1", ratio, source, None, "stable"))
    return rows


def bounce_mode(system: System) -> float:
    """Return the natural frequency of the bounce on straight track [Hz]."""
    kernel = bogie((), ("bounce",), constant_speed=1)
    kernel.advance(1.0)
    modes = oscillations(system, np.array(kernel.linearise().jacobian))
    return max(modes, key=lambda mode: abs(mode.shape["bounce"]) / sum(abs(x) for x in mode.shape.values())).frequency


def vertical_rows(runs: dict[float, Recording]) -> list[Row]:
    source = "section 5.3.2"
    p = tables_5_1_and_5_2()
    undamped = float(np.sqrt(4 * p.vertical_stiffness / p.frame_mass))
    damping = 4 * p.vertical_damping / (2 * p.frame_mass * undamped)
    formula = undamped * float(np.sqrt(1 - damping**2)) / (2 * np.pi)
    other = "the other value: sqrt(4k/M) sqrt(1 - D^2)/2 pi"
    found, asked = bounce_mode(levels(two_axle_bogie())[2]), near(formula, BAND * formula)
    rows = [measured("bounce frequency by eigenvalue", "Hz", found, other, asked)]
    for speed, (thesis, vampire) in {15.0: (0.48, 0.49), 25.0: (0.77, 0.78)}.items():
        series = runs[speed]
        frequency, density = spectrum(series["time"], series["bounce"])
        free = (frequency > 1.5) & (frequency < 4.0)
        forced = (frequency > 0.2) & (frequency < 1.5)
        found = float(frequency[free][np.argmax(density[free])])
        name = f"{speed:g} m/s: natural frequency in the spectrum"
        note = f"the printed mass, stiffness and damping give {formula:.3f} Hz"
        rows.append(Row(name, "Hz", 2.31, found, rounding("2.31"), source, note, vampire=2.34))
        found = float(frequency[forced][np.argmax(density[forced])])
        rows.append(Row(f"{speed:g} m/s: forced peak", "Hz", thesis, found, rounding("0.48"), source, vampire=vampire))
    return rows


LEANS = "a wheelset that leans with the rails is not off their middle by that; its centre, which (3.106) takes, is"


def cross_level_rows(runs: dict[float, Recording]) -> list[Row]:
    printed = {15.0: (0.021, 0.022), 25.0: (0.028, 0.027)}
    rows = []
    for speed, (roll, roll_vampire) in printed.items():
        source, (load, load_vampire) = "section 5.3.3", WHEEL_LOAD[speed]
        found = float(np.abs(runs[speed]["frame_roll"]).max())
        name = f"{speed:g} m/s: largest roll"
        rows.append(Row(name, "rad", roll, found, rounding("0.021"), source, SPACING, vampire=roll_vampire))
        name = f"{speed:g} m/s: largest wheel load, leading wheelset"
        found = largest_wheel_load(runs[speed])
        half = "half of the cross level on each rail: assumed"
        rows.append(Row(name, "kN", load, found, rounding("188"), source, half, vampire=load_vampire))
        peak = largest_wheel_load(travel(CROSS_LEVEL, speed, flange_at_rail=1)[1])
        name = f"{speed:g} m/s: largest wheel load, {AT_RAIL}"
        rows.append(Row(name, "kN", load, peak, None, source, LEANS, vampire=load_vampire))
    return rows


ROWS = {
    "lateral_irregularity": lateral_rows,
    "vertical_irregularity": vertical_rows,
    "cross_level": cross_level_rows,
}


def run_of(kind: Irregularity) -> Report:
    runs = {speed: travel(kind, speed)[1] for speed in SPEEDS}
    rows = ROWS[kind.name](runs)
    series = runs[15.0]
    for name in kind.shown:
        series.add_from(f"{name} at 25 m/s", runs[25.0], name)
    parameters = (
        as_printed(tables_5_1_and_5_2()).values() | section_5_3().values() | RIGID | {kind.name: kind.amplitude}
    )
    report = Report(rows, series, lambda: draw(kind, runs), parameters, DURATION * len(runs))
    report.motion = lambda: motion(kind)
    return report


def motion(kind: Irregularity) -> Motion:
    """Run at the lower speed."""
    vehicle, speed = two_axle_bogie(), SPEEDS[0]
    series = travel(kind, speed, motion_columns(vehicle))[1]
    return Motion(f"{kind.title}, at {speed:g} m/s", vehicle, series, irregular(**{kind.name: kind.amplitude}))


def draw(kind: Irregularity, runs: dict[float, Recording]) -> Figure:
    scales = {"m": (1e3, "mm"), "rad": (1e3, "mrad"), "N": (1e-3, "kN")}
    figure, grid = plt.subplots(len(kind.shown), 2, sharex="col", sharey="row", figsize=(11.0, 7.0))
    for column, speed in enumerate(SPEEDS):
        series = runs[speed]
        for axis, name, colour in zip(grid[:, column], kind.shown, (LEADING, TRAILING, TRAILING), strict=True):
            factor, unit = scales[series.units[name]]
            axis.plot(series["distance"], factor * series[name], color=colour)
            axis.set_title(f"{name} [{unit}] at {speed:g} m/s")
        grid[-1, column].set_xlabel("distance [m]")
    name, words = MESSAGES[kind.name]
    factor, unit = scales[runs[SPEEDS[-1]].units[name]]
    peak = factor * float(np.abs(runs[SPEEDS[-1]][name]).max())
    return titled(figure, f"At {SPEEDS[-1]:g} m/s the {words} {peak:.0f} {unit}")


def scenario(name: str, kind: Irregularity) -> Scenario:
    def run(options: Options, quick: bool = False) -> Report:
        return run_of(kind)

    return Scenario(name, kind.summary, run)


SCENARIOS = [
    scenario("bogie-lateral", LATERAL),
    scenario("bogie-vertical", VERTICAL),
    scenario("bogie-crosslevel", CROSS_LEVEL),
]
