"""Asymmetric brake shoes on one wheelset: chapter 9, Tables 9.2 and 9.3, with the thesis's forces and physical ones.

With the flange as a spring on one rigid contact a wheel (3.106), and with a flange that has its own place and force.
"""

from collections.abc import Callable
from dataclasses import replace

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmu_src.cosimulation.recording import Recording
from rbd_model.vehicle.parameters import as_printed, tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.asymmetric_shoes import (
    APPLICATION_TIMES,
    AS_THESIS,
    AT_CENTRE,
    CASES,
    DERAILED_AT,
    DURATION,
    FASTEST,
    FURTHER_CASES,
    ON_PATCHES,
    PEAKS,
    PHYSICAL,
    STOP_TIME,
    TOLERANCE,
    YAW_TORQUE,
    Case,
    Outcome,
    brake,
    run_all,
)
from scenarios.bench.drive import RIGID
from scenarios.reporting.motion import Motion, motion_columns
from scenarios.reporting.plots import LEADING, THREE, TRAILING, label_edges, plt, titled
from scenarios.reporting.report import Report, Row, at_least, rounding
from scenarios.scenario import Options, Scenario

FITTED = "not judged: the half spacing is fitted to it"
CONTOUR = "not judged: hangs on the wheel's contour, which is not public"


def rows_of(case: Case, outcome: Outcome) -> list[Row]:
    """Judged are, with the rotating axis, stop times; peaks stand beside the printed ones."""
    table = f"Table 9.{case.wheelset + 1}"
    rows = []
    derails = case.wheelset == 1 and case.error == 75
    if derails:
        name = f"{case.name}: speed at derailment"
        printed = DERAILED_AT[case.application]
        rows.append(Row(name, "m/s", printed, outcome.derailed_at, None, table, FITTED))
    else:
        judged = rounding("22.9") if case.reading == AS_THESIS else None
        printed = STOP_TIME[case.application]
        rows.append(Row(f"{case.name}: time to stop", "s", printed, outcome.stop_time, judged, table))
    printed_peaks = PEAKS.get((case.wheelset, case.error))
    for i, place in enumerate(("leading", "trailing")):
        value = None if printed_peaks is None else printed_peaks[APPLICATION_TIMES.index(case.application)][i]
        name = f"{case.name}: peak shift of the {place} wheelset"
        rows.append(Row(name, "mm", value, 1e3 * outcome.peaks[i], None, table, CONTOUR))
    return rows


def rows_of_derailments(outcomes: dict[Case, Outcome]) -> list[Row]:
    """How many of the cases of each reading derail, without and with a flange of its own."""
    rows = []
    for reading in (name for pair in ON_PATCHES.items() for name in pair):
        ends = {case: outcome.derailed_at for case, outcome in outcomes.items() if case.reading == reading}
        printed = sum(case.wheelset == 1 and case.error == 75 for case in ends)
        derailed = sum(speed is not None for speed in ends.values())
        name = f"{reading}: derailments in {len(ends)} cases"
        rows.append(Row(name, "1", printed, derailed, None, "Tables 9.2 and 9.3"))
    return rows


def rows_of_loads(outcomes: dict[Case, Outcome]) -> list[Row]:
    """What a flange's force does to its wheel: at the axle's centre as printed, at the rail, and on its patch."""
    rows = []
    for error in YAW_TORQUE:
        printed, *others = (Case(1, error, FASTEST, name) for name in (AT_CENTRE, PHYSICAL, ON_PATCHES[PHYSICAL]))
        least = 1e-3 * outcomes[printed].flanging_load(1)
        for case in (printed, *others):
            name, load = f"{case.name}: largest load of a flanging wheel", 1e-3 * outcomes[case].flanging_load(1)
            asked = None if case is printed else at_least(least)
            statics = "statics: a force at the rail presses its wheel down, one at the centre (3.106) does not"
            rows.append(Row(name, "kN", None, load, asked, statics))
    return rows


ON_PATCHES_REMARK = (
    "Contact depth 2, elastic patches of tread and flange: the derailments of chapter 9 do not survive when the flange "
    "has its own place, force, friction and creep. With 75 % error on the leading wheelset treads lift, flanges bear "
    "alone for moments, and every case stops on its rails, also the one that derails at depth 1 "
    "in the physical reading. What decides is less the place than how much a flange gives: the spring of 1e8 N/m "
    "yields 2 mm, which takes the tread to its fold, one of 1e9 N/m holds the wheelset at depth 1 too, Hertz' contact "
    "yields less than 0.1 mm; a rail that gives sideways is not in depth 2."
)
IMPACTS_REMARK = (
    "Peaks at depth 2 are converged to 1 %, as a test asks, but for 75 % error on the trailing wheelset "
    "with the rotating axis. There the yaw torque, turned into roll, takes 116 of the 131 kN off a wheel once a turn: "
    "it comes off its rail and falls back on it with up to {load:.0f} kN (the rail is rigid), which is chaotic: other "
    "tolerances move the peak of the trailing wheelset by a tenth."
)


def shares_of_peaks(outcomes: dict[Case, Outcome]) -> list[float]:
    """Peak shifts over the printed ones, in the thesis's reading."""
    return [
        1e3 * found / printed
        for case, outcome in outcomes.items()
        if case.reading == AS_THESIS and (case.wheelset, case.error) in PEAKS
        for found, printed in zip(
            outcome.peaks, PEAKS[case.wheelset, case.error][APPLICATION_TIMES.index(case.application)], strict=True
        )
    ]


def remarks_of(outcomes: dict[Case, Outcome]) -> list[str]:
    """What the rows do not say, and what each case said of itself."""
    lifting = outcomes[Case(2, 75, FASTEST, ON_PATCHES[AS_THESIS])]
    shares = shares_of_peaks(outcomes)
    return [
        f"With the rotating axis peak shifts are {min(shares):.2f} to {max(shares):.2f} of the printed ones: most fall "
        "short, and scenario thesis-step tells how far the thesis's own step explains it.",
        "With the axis of the yaw torque fixed to the vertical, the physical reading, nothing in chapter 9 fits: the "
        "flange touches at 25 % already. With an axis that turns with the wheelset, which the body's matrix in place "
        "of the global one in (3.36) does, the thesis's derailments appear, and only those. They also need the flange "
        "pushed at the wheelset's centre, which takes load off the wheel that climbs: pushed at the rail it stays on.",
        "The contact is held where a wheel would lift (wheel_lift_ends = 0), as the thesis's constraint does; of each "
        "case the first lift and the first Y/Q above Nadal's limit are told below. Peaks beyond 9.5 mm follow flange "
        "impacts and are chaotic: a tolerance ten times tighter moves them by up to 5 %, half a millimetre.",
        ON_PATCHES_REMARK,
        IMPACTS_REMARK.format(load=1e-3 * lifting.largest_load),
        *(f"{case.name}: {line}" for case, outcome in outcomes.items() for line in outcome.sentences),
    ]


def run(options: Options) -> Report:
    outcomes = run_all([*CASES, *FURTHER_CASES])
    rows = [row for case, outcome in outcomes.items() if case.reading != AT_CENTRE for row in rows_of(case, outcome)]
    rows += rows_of_derailments(outcomes) + rows_of_loads(outcomes)
    longest = max(outcomes.values(), key=lambda outcome: outcome.series["time"].size).series["time"]
    series = Recording({"time": "s"}, [[time] for time in longest])
    for case, outcome in outcomes.items():
        series.add_from(f"lateral, {case.name}", outcome.series, f"lateral_{case.wheelset}")
    parameters = as_printed(tables_5_1_and_5_2()).values() | RIGID | {"tolerance": TOLERANCE}
    seconds = sum(float(outcome.series["time"][-1]) for outcome in outcomes.values())
    report = Report(rows, series, lambda: draw(outcomes), parameters, seconds, remarks_of(outcomes))
    report.other_figures["contact-depth"] = lambda: draw_depths(outcomes)
    report.motion = motion
    return report


def motion() -> Motion:
    """Of the fastest case that derails."""
    vehicle, case = two_axle_bogie(), Case(1, 75, FASTEST, AS_THESIS)
    return Motion(f"Braked: {case.name}", vehicle, brake(case, DURATION, motion_columns(vehicle))[1])


def draw(outcomes: dict[Case, Outcome]) -> Figure:
    def shifts(axis: Axes, case: Case) -> None:
        outcome = outcomes[case]
        time = outcome.series["time"]
        axis.plot(time, 1e3 * outcome.series["lateral_1"], color=LEADING, linewidth=0.6, label="leading")
        axis.plot(time, 1e3 * outcome.series["lateral_2"], color=TRAILING, linewidth=0.6, label="trailing")
        mark_derailment(axis, outcome, 1, "derailed")

    return draw_cases(
        "Asymmetric shoes, brake applied in 1 s: as the thesis did, and the physical reading", 13.0, shifts
    )


def draw_depths(outcomes: dict[Case, Outcome]) -> Figure:
    """The braked wheelset with the flange as a spring (3.106), and with a flange of its own."""

    def shift_by_depth(axis: Axes, case: Case) -> None:
        for name, colour, depth in ((case.reading, TRAILING, 1), (ON_PATCHES[case.reading], LEADING, 2)):
            outcome = outcomes[replace(case, reading=name)]
            shift = 1e3 * outcome.series[f"lateral_{case.wheelset}"]
            axis.plot(outcome.series["time"], shift, color=colour, linewidth=0.6, label=f"contact depth {depth}")
            mark_derailment(axis, outcome, case.wheelset, f"depth {depth}: derailed")

    title = "The wheelset with asymmetric shoes: flange as a spring, and on its own patch"
    return draw_cases(title, 13.5, shift_by_depth)


def draw_cases(title: str, most: float, draw_case: Callable[[Axes, Case], None]) -> Figure:
    """Lateral shift [mm], up to `most`, of the cases with the fastest application, two readings and both wheelsets."""
    figure, grid = plt.subplots(4, 3, sharex=True, sharey=True, figsize=(11.0, 10.0))
    cases = [
        Case(n, error, FASTEST, reading) for reading in (AS_THESIS, PHYSICAL) for n in (1, 2) for error in YAW_TORQUE
    ]
    for axis, case in zip(grid.flat, cases, strict=True):
        draw_case(axis, case)
        axis.set_title(case.name, fontsize=8)
        axis.set_ylim(-most, most)
    label_edges(grid, "time [s]", "lateral shift [mm]")
    grid[0, 0].legend(loc="upper left", fontsize=8)
    return titled(figure, title)


def mark_derailment(axis: Axes, outcome: Outcome, wheelset: int, words: str) -> None:
    """Where the shift of the wheelset ended, and at which speed."""
    if outcome.derailed_at is not None:
        axis.plot(outcome.series["time"][-1], 1e3 * outcome.series[f"lateral_{wheelset}"][-1], "x", color=THREE[2])
        axis.annotate(f"{words} at {outcome.derailed_at:.1f} m/s", (0.05, 0.05), xycoords="axes fraction")


SCENARIO = Scenario(
    "asymmetric-braking", "The 18 cases of chapter 9, with readings of yaw torque, reaction and flange", run
)
