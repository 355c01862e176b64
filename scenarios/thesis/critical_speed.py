"""Critical speed of the wheelset: eigenvalues over speed, and the growth of a small motion in time (section 4.4)."""

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, single, write_at
from bogie_braking.reporting.report import Report, Row, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import peaks, play, prepare
from rbd_model.levels.models import wheelset_in_frame
from rbd_model.linear import Mode, critical_speed
from rbd_model.vehicle.parameters import tables_4_1_and_4_2
from scenarios.bench.hunting_wheelset import RANGE, growth_by_eigenvalue, modes_at

FITTED, PRINTED = tables_4_1_and_4_2().longitudinal_half_spacing, 0.35
SPEEDS = np.arange(5.0, 45.1, 1.0)
#: Small against the flange clearance, so that the motion is linear [m].
DISTURBANCE = 1e-5
#: Time of the disturbance and of the first modes, which decay faster than hunting grows; and end of the window [s].
WINDOW = (8.0, 40.0)
SAMPLE, TOLERANCE = 5e-3, 1e-9
#: The chart of growth begins where the hunting no longer meets the slow swaying of the frame [m/s].
SHOWN_FROM = 10.0


def growth_in_time(speed: float, half_spacing: float) -> float:
    """Return the growth rate [1/s] of the peaks after a small lateral wave of the track."""
    kernel = prepare(
        "wheelset",
        initial_speed=speed,
        constant_speed=1,
        longitudinal_half_spacing=half_spacing,
        vertical_half_spacing=half_spacing,
        lateral_irregularity=DISTURBANCE,
        tolerance=TOLERANCE,
    )
    series = play("wheelset", kernel, WINDOW[1], SAMPLE, ["lateral_1"], {})
    kept = series["time"] > WINDOW[0]
    time, lateral = series["time"][kept], series["lateral_1"][kept]
    tops = peaks(lateral)
    tops = tops[lateral[tops] > 0.0]
    return float(np.polyfit(time[tops], np.log(lateral[tops]), 1)[0])


def run(options: Options, quick: bool = False) -> Report:
    system = wheelset_in_frame()
    loci = {spacing: [modes_at(system, float(speed), spacing) for speed in SPEEDS] for spacing in (FITTED, PRINTED)}
    critical = {
        spacing: critical_speed(lambda v, d=spacing: growth_by_eigenvalue(system, v, d), *RANGE)  # type: ignore[misc]
        for spacing in loci
    }
    around = np.array([-0.5, 0.5]) + critical[FITTED]
    slopes = [growth_in_time(float(speed), FITTED) for speed in around]
    in_time = float(around[0] - slopes[0] * (around[1] - around[0]) / (slopes[1] - slopes[0]))
    source, fitted = "section 4.4", f"not judged: the half spacing, {FITTED} m, is fitted to it"
    methods = "two methods on the same equations"
    printed = f"half spacing printed: {PRINTED} m; as found"
    rows = [
        Row("critical speed by eigenvalues", "m/s", 27.0, critical[FITTED], None, source, fitted),
        Row("critical speed by simulation in time", "m/s", 27.0, in_time, None, source, fitted),
        measured("simulation in time over eigenvalues", "1", in_time / critical[FITTED], methods, near(1.0, 0.005)),
        Row("critical speed with the printed spacing", "m/s", 27.0, critical[PRINTED], None, source, printed),
    ]
    series = Recording({"speed": "m/s"}, [[float(speed)] for speed in SPEEDS])
    for spacing, locus in loci.items():
        series.add(f"growth, half spacing {spacing} m", "1/s", np.array([max(m.growth for m in ms) for ms in locus]))
    remark = f"Growth from peaks of {1e6 * DISTURBANCE:g} um waves between {WINDOW[0]:g} and {WINDOW[1]:g} s."
    remark += (
        " Below 10 m/s the hunting meets the slow swaying of the frame and some speeds are unstable there as well; the "
        "thesis does not go that low."
    )
    parameters = tables_4_1_and_4_2().values()
    report = Report(rows, series, lambda: draw(loci, critical), parameters, 0.0, [remark])
    report.other_figures["root-locus"] = lambda: draw_loci(loci, critical)
    return report


def draw(loci: dict[float, list[list[Mode]]], critical: dict[float, float]) -> Figure:
    """Draw the growth of the least damped oscillation over the speed."""
    message = (
        f"Hunting grows above {critical[FITTED]:.1f} m/s, with the printed spacing above {critical[PRINTED]:.1f} m/s"
    )
    figure, axis = single(message, "speed [m/s]", "growth of the least damped oscillation [1/s]")
    for (spacing, locus), line, colour in zip(loci.items(), ("-", "--"), (LEADING, TRAILING), strict=True):
        growth = [max(mode.growth for mode in modes) for modes in locus]
        axis.plot(SPEEDS, growth, line, color=colour, linewidth=2.5)
        axis.plot(critical[spacing], 0.0, "o", color=colour, markersize=10)
    write_at(axis, (37.0, 0.3), f"half spacing\n{FITTED} m (fitted)", LEADING)
    write_at(axis, (35.0, 0.65), f"half spacing\n{PRINTED} m (printed)", TRAILING, ha="right")
    axis.axhline(0.0, color=BOGIE, linewidth=0.8)
    axis.set_xlim(SHOWN_FROM, SPEEDS[-1])
    return figure


def draw_loci(loci: dict[float, list[list[Mode]]], critical: dict[float, float]) -> Figure:
    """Draw the frequency over the growth of all oscillations at all speeds; points grow with the speed."""
    hunting = min(
        (mode for mode in modes_at(wheelset_in_frame(), critical[FITTED], FITTED)), key=lambda m: abs(m.growth)
    )
    message = f"The mode that turns unstable at {critical[FITTED]:.1f} m/s swings at {hunting.frequency:.1f} Hz"
    figure, axis = single(message, "growth [1/s]; points grow with the speed", "frequency [Hz]")
    for (spacing, locus), marker, colour in zip(loci.items(), "o^", (LEADING, TRAILING), strict=True):
        points = np.array([(m.growth, m.frequency, v) for v, ms in zip(SPEEDS, locus, strict=True) for m in ms])
        axis.scatter(
            points[:, 0],
            points[:, 1],
            s=6 + points[:, 2],
            color=colour,
            marker=marker,
            label=f"half spacing {spacing} m",
        )
    axis.axvline(0.0, color=BOGIE, linewidth=0.8)
    axis.set_xlim(-1.0, 0.6)
    axis.legend(loc="upper left")
    return figure


SCENARIO = Scenario("critical-speed", "Root locus and critical speed of the wheelset of chapter 4", run)
