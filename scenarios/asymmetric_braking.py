"""Asymmetric brake shoes on one wheelset: chapter 9, Tables 9.2 and 9.3, as the thesis read its model and as it is."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product

import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

from rbd_model.parameters import AS_PRINTED, as_printed, tables_5_1_and_5_2
from scenarios.cosimulation import PATIENCE, Recording
from scenarios.plotting import LEADING, THREE, TRAILING, plt
from scenarios.report import Result, Row
from scenarios.scenario import Options, Scenario
from scenarios.scene import bogie, library, play

BRAKE_TORQUE, BRAKE_START, SPEED = 20e3, 1.0, 25.0
#: Yaw torque at full brake by error of the shoe forces [%], Tables 9.2 and 9.3.
YAW_TORQUE = {25: 43.92e3, 50: 87.84e3, 75: 131.76e3}
APPLICATION_TIMES = (10.0, 5.0, 1.0)
#: Stop times [s] by application time; peak lateral shift [mm] of leading and trailing wheelset, in that order.
STOP_TIME = {10.0: 22.9, 5.0: 20.4, 1.0: 18.3}
PEAKS = {
    (1, 25): ((2.4, 1.5), (2.5, 1.7), (2.5, 1.9)),
    (1, 50): ((8.3, 6.1), (9.2, 6.5), (9.3, 7.3)),
    (2, 25): ((1.6, 2.2), (1.7, 2.4), (1.7, 2.7)),
    (2, 50): ((7.4, 5.6), (7.5, 5.9), (7.8, 6.2)),
    (2, 75): ((10.9, 10.8), (11.1, 11.2), (11.2, 11.1)),
}
#: Speed at which the program of the thesis broke down [m/s].
DERAILED_AT = {10.0: 5.9, 5.0: 6.1, 1.0: 6.1}
STANDING, DURATION, INTERVAL = 0.01, 24.0, 2e-3
#: Enough for peaks within 1 % away from the flange; behind flange impacts the motion is chaotic, see the remark.
TOLERANCE = 1e-5
RECORDED = ("speed", "lateral_1", "lateral_2")
SAID = ("Wheel lift", "Flange climb", "Derailed")


#: Whether the yaw torque's axis turns with the wheelset, and what reacts where; the first is what the thesis did.
AS_THESIS, AT_RAIL, FIXED, PHYSICAL = "rotating axis", "rotating axis, flange at the rail", "fixed axis", "physical"
READINGS: dict[str, Mapping[str, float]] = {
    AS_THESIS: AS_PRINTED | {"yaw_torque_rotates": 1},
    AT_RAIL: AS_PRINTED | {"yaw_torque_rotates": 1, "flange_at_rail": 1},
    FIXED: AS_PRINTED | {"yaw_torque_rotates": 0},
    PHYSICAL: {"yaw_torque_rotates": 0},
}


@dataclass(frozen=True)
class Case:
    """One line of the tables in one of the READINGS."""

    wheelset: int
    error: int
    application: float
    reading: str

    @property
    def name(self) -> str:
        place = {1: "leading", 2: "trailing"}[self.wheelset]
        return f"{self.reading}, {place}, {self.error} %, {self.application:g} s"


@dataclass(frozen=True)
class Outcome:
    """What a case came to: when it stood, or its speed when it derailed; peaks [m] while it moved; what it said."""

    series: Recording
    stop_time: float | None
    derailed_at: float | None
    peaks: tuple[float, float]
    sentences: list[str]  # the first wheel lift, the first quotient above Nadal's limit, and the derailment


CASES = [Case(*values) for values in product((1, 2), YAW_TORQUE, APPLICATION_TIMES, READINGS)]


def run_case(case: Case, tolerance: float = TOLERANCE) -> Outcome:
    full = BRAKE_START + case.application
    brake = [(0.0, 0.0), (BRAKE_START, 0.0), (full, BRAKE_TORQUE)]
    yaw = [(0.0, 0.0), (BRAKE_START, 0.0), (full, YAW_TORQUE[case.error])]
    inputs = {"brake_torque_1": brake, "brake_torque_2": brake, f"yaw_torque_{case.wheelset}": yaw}
    reading = READINGS[case.reading]
    kernel = bogie(inputs, RECORDED, initial_speed=SPEED, tolerance=tolerance, wheel_lift_ends=0, **reading)
    series = play("bogie", kernel, DURATION, INTERVAL, RECORDED, inputs)
    stop = series.first_time(series["speed"] < STANDING)
    moving = series["time"] <= (DURATION if stop is None else stop)
    peaks = [float(np.abs(series[f"lateral_{n}"][moving]).max()) for n in (1, 2)]
    derailed = float(series["speed"][-1]) if kernel["derailed"] else None
    first = [[line for line in kernel.journal if line.startswith(word)][:1] for word in SAID]
    return Outcome(series, stop, derailed, (peaks[0], peaks[1]), [line for lines in first for line in lines])


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
        judged = 0.35 if case.reading == AS_THESIS else None
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
        judged = 0.15 if case.reading == AS_THESIS else None
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
        "of the global one in (3.36) does, the thesis's derailments appear, and only those. They also need the flange "
        "pushed at the wheelset's centre, which takes load off the wheel that climbs: pushed at the rail it stays on.",
        "The contact is held where a wheel would lift (wheel_lift_ends = 0), as the thesis's constraint does; of each "
        "case the first lift and the first Y/Q above Nadal's limit are told below. Peaks beyond 9.5 mm follow flange "
        "impacts and are chaotic: a tolerance ten times tighter moves them by up to 5 %, half a millimetre.",
    ]
    remarks += [f"{case.name}: {line}" for case, outcome in outcomes.items() for line in outcome.sentences]
    longest = max(outcomes.values(), key=lambda outcome: outcome.series["time"].size).series["time"]
    series = Recording({"time": "s"}, [[time] for time in longest])
    for case, outcome in outcomes.items():
        series.add_from(f"lateral, {case.name}", outcome.series, f"lateral_{case.wheelset}")
    parameters = as_printed(tables_5_1_and_5_2()).values() | {"level": 3, "tolerance": TOLERANCE}
    seconds = sum(float(outcome.series["time"][-1]) for outcome in outcomes.values())
    return Result(rows, series, lambda: draw(outcomes), parameters, seconds, remarks)


def draw(outcomes: dict[Case, Outcome]) -> Figure:
    figure, grid = plt.subplots(4, 3, sharex=True, sharey=True, figsize=(11.0, 10.0))
    for line, (reading, wheelset) in enumerate(product((AS_THESIS, PHYSICAL), (1, 2))):
        for column, error in enumerate(YAW_TORQUE):
            axis = grid[line, column]
            case = Case(wheelset, error, 1.0, reading)
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
        "Asymmetric shoes, brake applied in 1 s: as the thesis did, and the physical reading", x=0.02, ha="left"
    )
    figure.set_layout_engine("constrained")
    return figure


SCENARIO = Scenario(
    "asymmetric-braking",
    "The 18 cases of chapter 9, with readings of yaw torque, reaction and flange",
    run,
    frozenset(),
)
