"""Asymmetric brake shoes on one wheelset: chapter 9, Tables 9.2 and 9.3, with both readings of the yaw torque."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product

import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

from rbd_model.parameters import tables_5_1_and_5_2
from scenarios.bench.asymmetric_shoes import APPLICATION_TIMES, DERAILED_AT, PEAKS, STOP_TIME, YAW_TORQUE, Case, brake
from scenarios.bench.drive import library
from scenarios.cosimulation.recording import Recording
from scenarios.reporting.plots import LEADING, THREE, TRAILING, plt
from scenarios.reporting.progress import PATIENCE
from scenarios.reporting.report import Result, Row
from scenarios.scenario import Options, Scenario

STANDING, DURATION = 0.01, 24.0
#: Enough for peaks within 1 % away from the flange; behind flange impacts the motion is chaotic, see the remark.
TOLERANCE = 1e-5


@dataclass(frozen=True)
class Outcome:
    """What a case came to: when it stood, or its speed when it derailed; peaks [m] while it moved; what it said."""

    series: Recording
    stop_time: float | None
    derailed_at: float | None
    peaks: tuple[float, float]
    sentences: list[str]  # the first wheel lift, and the derailment


CASES = [Case(*values) for values in product((1, 2), YAW_TORQUE, APPLICATION_TIMES, (True, False))]


def run_case(case: Case, tolerance: float = TOLERANCE) -> Outcome:
    kernel, series = brake(case, DURATION, tolerance=tolerance)
    stop = series.first_time(series["speed"] < STANDING)
    moving = series["time"] <= (DURATION if stop is None else stop)
    peaks = [float(np.abs(series[f"lateral_{n}"][moving]).max()) for n in (1, 2)]
    derailed = float(series["speed"][-1]) if kernel["derailed"] else None
    lifts = [line for line in kernel.journal if line.startswith("Wheel lift")][:1]
    ends = [line for line in kernel.journal if line.startswith("Derailed")]
    return Outcome(series, stop, derailed, (peaks[0], peaks[1]), lifts + ends)


def run_all(tolerance: float = TOLERANCE) -> dict[Case, Outcome]:
    """All cases; they share the compiled library and run beside each other."""
    library("bogie")  # compiled once, before the threads ask for it
    with ThreadPoolExecutor() as pool:
        found = pool.map(lambda case: run_case(case, tolerance), CASES)
        bar = tqdm(found, "cases", len(CASES), delay=PATIENCE, leave=False, unit="case")
        return dict(zip(CASES, bar, strict=True))


def rows_of(case: Case, outcome: Outcome) -> list[Row]:
    """Judged are, with the rotating axis, stop times and derailments; peaks stand beside the printed ones."""
    table = f"Table 9.{case.wheelset + 1}"
    rows = []
    derails = case.wheelset == 1 and case.error == 75
    if derails:
        judged = 0.35 if case.rotates else None
        rows.append(
            Row(
                f"{case.name}: speed at derailment",
                "m/s",
                DERAILED_AT[case.application],
                outcome.derailed_at,
                judged,
                table,
            )
        )
    else:
        # Printed to 0.1 s: 18.3 and 18.4 stand for the same case in different places.
        judged = 0.15 if case.rotates else None
        printed = STOP_TIME[case.application]
        rows.append(Row(f"{case.name}: time to stop", "s", printed, outcome.stop_time, judged, table))
    printed_peaks = PEAKS.get((case.wheelset, case.error))
    for i, place in enumerate(("leading", "trailing")):
        value = None if printed_peaks is None else printed_peaks[APPLICATION_TIMES.index(case.application)][i]
        name = f"{case.name}: peak shift of the {place} wheelset"
        rows.append(Row(name, "mm", value, 1e3 * outcome.peaks[i], None, table))
    return rows


def run(options: Options) -> Result:
    outcomes = run_all()
    rows = [row for case, outcome in outcomes.items() for row in rows_of(case, outcome)]
    remarks = [
        "With the axis of the yaw torque fixed to the vertical, the physical reading, nothing in chapter 9 fits: the "
        "flange touches at 25 % already. With an axis that turns with the wheelset, which the body's matrix in place "
        "of the global one in (3.36) does, the thesis's derailments appear, and only those.",
        "The contact is held where a wheel would lift (wheel_lift_ends = 0), as the thesis's constraint does; the "
        "first lift of each case is told below. Peaks beyond 9.5 mm follow flange impacts and are chaotic: a tolerance "
        "ten times tighter moves them by up to 5 %, half a millimetre.",
    ]
    remarks += [f"{case.name}: {line}" for case, outcome in outcomes.items() for line in outcome.sentences]
    longest = max(outcomes.values(), key=lambda outcome: outcome.series["time"].size).series["time"]
    series = Recording({"time": "s"}, [[time] for time in longest])
    for case, outcome in outcomes.items():
        series.add_from(f"lateral, {case.name}", outcome.series, f"lateral_{case.wheelset}")
    parameters = tables_5_1_and_5_2().values() | {"level": 3, "tolerance": TOLERANCE}
    seconds = sum(float(outcome.series["time"][-1]) for outcome in outcomes.values())
    return Result(rows, series, lambda: draw(outcomes), parameters, seconds, remarks)


def draw(outcomes: dict[Case, Outcome]) -> Figure:
    figure, grid = plt.subplots(4, 3, sharex=True, sharey=True, figsize=(11.0, 10.0))
    for line, (rotates, wheelset) in enumerate(product((True, False), (1, 2))):
        for column, error in enumerate(YAW_TORQUE):
            axis = grid[line, column]
            case = Case(wheelset, error, 1.0, rotates)
            outcome = outcomes[case]
            time = outcome.series["time"]
            axis.plot(time, 1e3 * outcome.series["lateral_1"], color=LEADING, linewidth=0.6, label="leading")
            axis.plot(time, 1e3 * outcome.series["lateral_2"], color=TRAILING, linewidth=0.6, label="trailing")
            axis.set_title(case.name, fontsize=8)
            if outcome.derailed_at is not None:
                axis.plot(time[-1], 1e3 * outcome.series["lateral_1"][-1], "x", color=THREE[2])
                axis.annotate(f"derailed at {outcome.derailed_at:.1f} m/s", (0.05, 0.05), xycoords="axes fraction")
            axis.set_ylim(-13, 13)
    for axis in grid[-1]:
        axis.set_xlabel("time [s]")
    for axis in grid[:, 0]:
        axis.set_ylabel("lateral shift [mm]")
    grid[0, 0].legend(loc="upper left", fontsize=8)
    figure.suptitle(
        "Asymmetric shoes, brake applied in 1 s: rotating and fixed axis of the yaw torque", x=0.02, ha="left"
    )
    figure.set_layout_engine("constrained")
    return figure


SCENARIO = Scenario(
    "asymmetric-braking", "The 18 cases of chapter 9, both readings of the yaw torque", run, frozenset()
)
