"""The wheelset of chapter 4 at constant speed: damped at 15 and 25 m/s, a limit cycle at 30 m/s (section 4.4)."""

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, irregular, motion_columns
from bogie_braking.reporting.plots import LEADING, TRAILING, plt, titled
from bogie_braking.reporting.report import Report, Row, measured
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from rbd_model.vehicle.parameters import as_printed, tables_4_1_and_4_2
from rbd_model.vehicle.ready import wheelset_under_frame
from scenarios.bench.hunting_wheelset import (
    FREQUENCY,
    FREQUENCY_BAND,
    WAVE,
    WAVELENGTH,
    WAVELENGTH_BAND,
    hunt,
    hunting_period,
)

SPEEDS = (15.0, 25.0, 30.0)
#: Small disturbance [m], whose growth is visible before the flange ends it.
SMALL = {"lateral_irregularity": 1e-5}
#: Long enough for the limit cycle; the figures show the first part.
DURATION, SHOWN = 120.0, 20.0


def largest(series: Recording, begin: float, end: float) -> float:
    """Return the largest lateral shift in a window of time [m]."""
    chosen = (series["time"] >= begin) & (series["time"] <= end)
    return float(np.abs(series["lateral_1"][chosen]).max())


def run(options: Options, quick: bool = False) -> Report:
    runs = {speed: hunt(speed, DURATION)[1] for speed in SPEEDS}
    slow, fast = hunting_period(runs[15.0]), hunting_period(runs[25.0])
    small, words = hunt(30.0, DURATION, **SMALL)[1], f"from a wave of {1e6 * SMALL['lateral_irregularity']:g} um"
    late = [largest(runs[30.0], begin, begin + 10.0) for begin in (90.0, 110.0)]
    at_rail = largest(hunt(30.0, DURATION, flange_at_rail=1)[1], 110.0, 120.0)
    source, fitted = "section 4.4", "half spacing of the suspension fitted to the critical speed"
    wave, swing = slow and 15.0 * slow, fast and 1 / fast
    rows = [
        Row("wavelength at 15 m/s", "m", WAVELENGTH[0], wave, WAVELENGTH_BAND, source, fitted, vampire=WAVELENGTH[1]),
        Row("frequency at 25 m/s", "Hz", FREQUENCY[0], swing, FREQUENCY_BAND, source, fitted, vampire=FREQUENCY[1]),
        measured(f"30 m/s, {words}: growth in 10 s", "1", growth(small), source, None, "above 1: unstable"),
        measured("limit cycle at 30 m/s", "mm", 1e3 * late[1], source, None, "bounded by the flange"),
        measured("limit cycle, flange pushed at the rail", "mm", 1e3 * at_rail, source, None, "the physical reading"),
        measured("limit cycle: change over 20 s", "1", late[1] / late[0], source),
    ]
    series = runs[15.0]
    for speed in (25.0, 30.0):
        for name in ("lateral_1", "frame_lateral"):
            series.add_from(f"{name} at {speed:g} m/s", runs[speed], name)
    parameters = as_printed(tables_4_1_and_4_2()).values() | WAVE
    seconds = DURATION * (len(runs) + 1)
    return Report(rows, series, lambda: draw(runs), parameters, seconds, motion=motion)


def motion() -> Motion:
    """Run into the limit cycle, as far as the figures of the thesis."""
    vehicle = wheelset_under_frame()
    series = hunt(SPEEDS[-1], SHOWN, motion_columns(vehicle))[1]
    return Motion(f"Behind the disturbance, at {SPEEDS[-1]:g} m/s", vehicle, series, irregular(**WAVE))


def growth(series: Recording) -> float:
    """Return the ratio of the largest shifts of two windows 10 s apart, after the disturbance."""
    return largest(series, 25.0, 30.0) / largest(series, 15.0, 20.0)


def draw(runs: dict[float, Recording]) -> Figure:
    figure, grid = plt.subplots(len(runs) + 1, 1, figsize=(8.0, 9.0))
    for axis, (speed, series) in zip(grid, runs.items(), strict=False):
        shown = series["time"] < SHOWN
        axis.plot(series["distance"][shown], 1e3 * series["lateral_1"][shown], color=LEADING, label="wheelset")
        axis.plot(series["distance"][shown], 1e3 * series["frame_lateral"][shown], "--", color=TRAILING, label="frame")
        axis.set_title(f"lateral displacement at {speed:g} m/s [mm] over the distance [m]")
    grid[0].legend(loc="upper right")
    grid[-1].plot(runs[30.0]["time"], 1e3 * runs[30.0]["lateral_1"], color=LEADING, linewidth=0.4)
    grid[-1].set_title("30 m/s to the limit cycle: lateral displacement [mm] over time [s]")
    slow, fast = runs[SPEEDS[0]], runs[SPEEDS[-1]]
    word = "fades" if largest(slow, SHOWN / 2, SHOWN) < largest(slow, 0.0, SHOWN / 2) else "grows"
    reached = 1e3 * largest(fast, DURATION - 10.0, DURATION)
    return titled(figure, f"Hunting {word} at {SPEEDS[0]:g} m/s and reaches {reached:.1f} mm at {SPEEDS[-1]:g} m/s")


SCENARIO = Scenario("wheelset-constant-speed", "Hunting at 15, 25 and 30 m/s (section 4.4)", run)
