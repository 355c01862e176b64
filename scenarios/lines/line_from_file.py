"""A bogie along a line from a file, or along an example with every feature: a plot of the line, and the motion.

The bogie runs at level 3 with a drawbar force on its frame that holds the speed: 15 m/s, or less where a curve would
have more than 100 mm of cant deficiency.
"""

import math
from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.line_picture import charts_of, draw_line, height
from bogie_braking.reporting.motion import Motion, motion_columns
from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import LEADING, TRAILING, plt, single, titled, write_at
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, measured, near
from bogie_braking.reporting.scenario import BadInputError, Options, Scenario
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel, SimulationError
from products.building import units_of
from products.kernel_runs import prepare, prepare_on_line
from rbd_model.track.line import Line, Segment, arc, clothoid, line_of, read_line, straight
from rbd_model.track.line_table import GAUGE
from rbd_model.track.spectra import ERRI_LOW, irregular
from rbd_model.vehicle.ready import two_axle_bogie
from readers.text import FileError
from scenarios.bench.curves import BOGIE, MASS, WHEEL_LOAD

#: Speed [m/s], and largest cant deficiency at it [m]: EN 13803 has 130 mm for freight trains, here with a margin.
SPEED, MOST_DEFICIENCY = 15.0, 0.1
#: Time over which the drawbar force removes a speed error [s], and time for which each force is constant [s].
REGULATION, HELD = 2.0, 0.1
#: Distance between recorded rows [m], and their largest number, for long lines.
PITCH, MOST_ROWS = 0.25, 20000
#: The shortest line that is run [m], and length at its end for the wheelsets ahead of the frame [m].
SHORTEST, LEFT_OVER = 50.0, 5.0
#: Tolerance of the rails' mean force, upwards and across, as share of the weight: the suspension moves at start and
#: end.
BAND = 1e-3
#: Window of the line in which the largest and the smallest wheel load are drawn [m].
WINDOW = 20.0
SIDES = ("left", "right")
QUIET_RUN = "Nothing that the kernel tells of: no wheel was lifted, none climbed."
RECORDED = (
    *("distance", "speed", "lateral_1", "lateral_2", "guiding_force_1", "guiding_force_2"),
    *(f"wheel_load_{number}_{side}" for number in (1, 2) for side in SIDES),
    *(f"derailment_quotient_1_{side}" for side in SIDES),
)


def own_line() -> Line:
    """Return straight track, curves to both sides with cant, up and down, on rails of the low irregularities of ERRI
    B176.
    """
    level, up, down = straight(100.0), straight(80.0, 0.008), straight(120.0, -0.01)
    left, right = arc(160.0, 2000.0, 0.02, 0.008), arc(160.0, -1600.0, -0.03, -0.01)
    first, last = straight(60.0, 0.008), straight(100.0)
    pieces = [level, first, left, up, right, down, last]
    segments: list[Segment] = [level]
    for before, behind in pairwise(pieces):
        segments += [clothoid(80.0, before, behind), behind]
    return irregular(line_of(segments), ERRI_LOW, seed=2)


def bogie_on(path: Path | None) -> tuple[Kernel, Line]:
    """Return the bogie in 3D on the line of a file, or on the example, and that line."""
    if path is None:
        line = own_line()
        return prepare_on_line("bogie", line, level=3.0), line
    try:
        line = read_line(path)
    except FileError as error:
        raise BadInputError(str(error)) from None
    reaches = float(line.rows["distance"][-1])
    if reaches < SHORTEST:
        raise BadInputError(f"{path} ends at {reaches:g} m; give a line from 0 to {SHORTEST:g} m at least.")
    try:
        return prepare("bogie", level=3.0, line_file=str(path)), line
    except SimulationError as error:
        raise BadInputError(str(error)) from None


def speed_on(line: Line) -> float:
    """Return SPEED, or the speed of MOST_DEFICIENCY in the worst curve [m/s]; cant may have the wrong sign."""
    curvature, cant = line.rows["curvature"], line.rows["cant"]
    bends = np.abs(curvature) > 1e-6
    suits = np.maximum(cant * np.sign(curvature) + MOST_DEFICIENCY, 0.01)[bends]
    allowed = BOGIE.gravity * suits / GAUGE / np.abs(curvature[bends])
    return min(SPEED, math.sqrt(np.min(allowed, initial=SPEED**2)))


def drive(kernel: Kernel, line: Line, speed: float, columns: Sequence[str] = RECORDED) -> Recording:
    """Run the bogie to the end of the line, or until the run ends.

    Takes speed [m/s].
    """
    way = float(line.rows["distance"][-1]) - LEFT_OVER
    interval = max(PITCH, way / MOST_ROWS) / speed
    held = max(round(HELD / interval), 1) * interval
    kernel.set(initial_speed=speed)
    kernel.initialise()
    rows: list[list[float]] = []
    with counting(total=round(way), text="line-from-file", unit="m") as bar:
        while not kernel.ended and kernel["distance"] < way and kernel["speed"] > speed / 2:
            kernel.set(drawbar_force=MASS * (speed - kernel["speed"]) / REGULATION)
            table = kernel.record(held, interval, columns)
            rows += [list(row) for row in zip(*table.values(), strict=True)][1 if rows else 0 :]
            bar.update(round(kernel["distance"]) - bar.n)
    return Recording({"time": "s"} | {name: units_of("bogie")[name] for name in columns}, rows)


def run(options: Options, quick: bool = False) -> Report:
    kernel, line = bogie_on(options.line)
    speed = speed_on(line)
    series = drive(kernel, line, speed)
    rows = [*closed_forms(series, line), *safety(series)]
    parameters = BOGIE.values() | {"line": str(options.line or "own"), "speed": speed}
    seconds = float(series["time"][-1])
    said = [*(kernel.messages or [QUIET_RUN]), f"The picture has the extremes of wheel loads in every {WINDOW:g} m."]
    report = Report(rows, series, lambda: draw(series), parameters, seconds, said, motion=partial(motion, options))
    report.other_figures["line"] = lambda: draw_track(line)
    return report


def motion(options: Options) -> Motion:
    """Repeat the run."""
    vehicle, (kernel, line) = two_axle_bogie(), bogie_on(options.line)
    speed = speed_on(line)
    return Motion(
        f"Along the line at {speed:.1f} m/s", vehicle, drive(kernel, line, speed, motion_columns(vehicle)), line
    )


def closed_forms(series: Recording, line: Line) -> list[Row]:
    """Return the distance of the run, and the mean forces on the rails, against closed forms."""
    way = float(line.rows["distance"][-1]) - LEFT_OVER
    across, upwards = (MASS * float(np.mean(values)) / 1e3 for values in pushed(series, line))
    guiding = float(np.mean(series["guiding_force_1"] + series["guiding_force_2"])) / 1e3
    wheels = [f"wheel_load_{number}_{side}" for number in (1, 2) for side in SIDES]
    carried = float(np.mean(np.sum([series[wheel] for wheel in wheels], axis=0))) / 1e3
    band, newton = BAND * 4 * WHEEL_LOAD / 1e3, "Newton's second law, of the line at the speed that was run"
    gone = float(series["distance"][-1])
    return [
        measured("way run along the line", "m", gone, f"the line, {LEFT_OVER:g} m before its end", at_least(way)),
        measured("mean sum of the guiding forces, to the left", "kN", guiding, newton, near(across, band)),
        measured("mean sum of the wheel loads", "kN", carried, newton, near(upwards, band)),
    ]


def pushed(series: Recording, line: Line) -> tuple[np.ndarray, np.ndarray]:
    """Return the track's force per mass of a vehicle, across and upwards, at the places and speeds of a run [m/s2]."""
    place, square = series["distance"], series["speed"] ** 2
    curvature, slope = line.value("curvature", place), line.value("gradient", place)
    angle, bend = np.arcsin(line.value("cant", place) / GAUGE), line.value("gradient", place, 1)
    level, upright = square * curvature, BOGIE.gravity * np.sqrt(1.0 - slope**2) + square * bend
    return level * np.cos(angle) - upright * np.sin(angle), upright * np.cos(angle) + level * np.sin(angle)


def safety(series: Recording) -> list[Row]:
    """Return the largest values and their limits of EN 14363, which apply to filtered signals of many runs."""
    quotient = max(float(np.max(series[f"derailment_quotient_1_{side}"])) for side in SIDES)
    guiding = max(float(np.max(np.abs(series[f"guiding_force_{number}"]))) for number in (1, 2)) / 1e3
    least = min(float(np.min(series[f"wheel_load_{number}_{side}"])) for number in (1, 2) for side in SIDES)
    limit = 10.0 + 2 * WHEEL_LOAD / 3e3
    note = "not judged: its limits are for filtered signals"
    return [
        measured("largest Y/Q of the leading wheelset", "1", quotient, "EN 14363: limit 0.8", None, note),
        measured("largest guiding force", "kN", guiding, f"EN 14363: limit {limit:.0f} kN", None, note),
        measured("largest unloading dQ/Q", "1", 1.0 - least / WHEEL_LOAD, "EN 14363: limit 0.6", None, note),
    ]


def draw(series: Recording) -> Figure:
    """Draw the largest and the smallest load of any wheel in each WINDOW of the line."""
    loads = 1e-3 * np.array([series[f"wheel_load_{number}_{side}"] for number in (1, 2) for side in SIDES])
    message = f"Wheel loads stay between {loads.min():.0f} and {loads.max():.0f} kN along the line"
    figure, axis = single(message, "distance along the line [m]", "wheel load [kN]")
    windows = np.floor(series["distance"] / WINDOW)
    starts = np.flatnonzero(np.diff(windows, prepend=-np.inf))
    place = WINDOW * (windows[starts] + 0.5)
    largest = np.maximum.reduceat(loads.max(axis=0), starts)
    smallest = np.minimum.reduceat(loads.min(axis=0), starts)
    axis.fill_between(place, smallest, largest, color="#dddddd")
    axis.plot(place, largest, color=LEADING, linewidth=2.5)
    axis.plot(place, smallest, "--", color=TRAILING, linewidth=2.5)
    axis.axhline(1e-3 * WHEEL_LOAD, color=GREY, linestyle=":")
    middle = place[len(place) // 2]
    write_at(axis, (middle, loads.max() + 5.0), "the most loaded wheel", LEADING, ha="center")
    write_at(axis, (middle, loads.min() - 5.0), "the least loaded wheel", TRAILING, ha="center")
    write_at(axis, (place[-1], 1e-3 * WHEEL_LOAD + 3.0), "at rest", GREY, ha="right")
    axis.set_ylim(loads.min() - 9.0, loads.max() + 9.0)
    return figure


def draw_track(line: Line) -> Figure:
    """Draw the line."""
    charts = [name for name in charts_of(line) if name != "deficiency"]
    figure, axes = plt.subplots(len(charts), 1, figsize=(9.0, 2.5 * len(charts)), squeeze=False)
    draw_line(dict(zip(charts, axes[:, 0], strict=True)), line)
    axes[-1, 0].set_xlabel("distance along the line [m]")
    bend, climbed = float(np.abs(line.rows["curvature"]).max()), float(np.ptp(height(line)))
    words = f"tightest radius is {1.0 / bend:.0f} m" if bend > 1e-6 else "line is straight"
    return titled(figure, f"The {words}, the heights differ by {climbed:.1f} m")


SCENARIO = Scenario(
    "line-from-file",
    "A bogie along a line from a file (--line), or along one that has curves, cant, gradients and irregularities",
    run,
    frozenset({"line"}),
)
