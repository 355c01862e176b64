"""Published numbers over the fixed step of the classical Runge-Kutta method, as the thesis may have used it.

The thesis names the Runge-Kutta method (below eq. 3.118, conclusion 2.1), but neither order nor step.
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, THESIS, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, measured
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.measuring.stability import RUNGE_KUTTA, DrivenVehicle, limit
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.kernel_runs import PADDING, RIGID, in_space, library
from rbd_model.vehicle.parameters import AS_PRINTED, tables_5_1_and_5_2
from scenarios.bench import asymmetric_shoes, hunting_wheelset, irregularities
from scenarios.bench.asymmetric_shoes import APPLICATION_TIMES, AS_THESIS, PEAKS, ShoeCase
from scenarios.bench.irregularities import CROSS_LEVEL, HUNTING_PEAK, LATERAL, LATERAL_PEAK, WHEEL_LOAD

#: Steps of the explicit method [s], and the one that is examined in detail.
STEPS = (3e-4, 5e-4, 7e-4, 8e-4, 9e-4, 1e-3, 1.1e-3, 1.2e-3)
CLOSER = 1e-3
#: Steps of a quick run [s], which has only the stops.
QUICK_STEPS = (8e-4, CLOSER)
#: Speed at which stops are cut [m/s]: the limit falls with the speed, and below it every step exceeds the limit more
#: than three times. Speed to which one stop continues [m/s], to show the effect.
CUT, BELOW = 3.0, 1.0
#: Longest duration of a stop, with brakes applied in 1 s, down to either speed [s], and length of a hunting wheelset's
#: run.
STOP, HUNT = 18.0, 20.0
#: Frequency resolution of a spectrum [Hz].
GRID = 1.0 / (PADDING * irregularities.DURATION)
#: Relative change below which a number is unchanged.
UNCHANGED = 0.01


def thesis_reading() -> dict[str, float]:
    """Return the parameters of the thesis's interpretation that differ from defaults, for both kernels.

    Torques act on the wheelsets alone, as in eq. 3.36, about an axis that turns with them; no wheel lifts.
    """
    return AS_PRINTED | {"yaw_torque_rotates": 1.0, "wheel_lift_ends": 0.0}


def method(step: float | None) -> dict[str, float]:
    """Return parameters of the explicit method with a fixed step [s]; None: the default method, which is accurate."""
    chosen = {} if step is None else {"integration_method": RUNGE_KUTTA, "integration_step": step}
    return thesis_reading() | chosen


@dataclass(frozen=True)
class Printed:
    """A number of the thesis, with VAMPIRE's if it is reported, and the possible effect of another wheel profile."""

    quantity: str
    unit: str
    thesis: float
    source: str
    vampire: float | None = None
    band: float | None = None


@dataclass(frozen=True)
class StepResult:
    """Results of one run: its numbers, whether the log reports a step above the limit, and the simulated time [s]."""

    values: tuple[float, ...]
    warned: bool
    seconds: float


@dataclass(frozen=True)
class PrintedRun:
    """One case: its input, its initial speed [m/s], the reported numbers, and the function that measures them."""

    fmu: str
    speed: float
    printed: tuple[Printed, ...]
    measure: Callable[[Mapping[str, float]], tuple[Kernel, tuple[float, ...]]]

    def found(self, step: float | None) -> StepResult:
        kernel, values = self.measure(method(step))
        warned = any("above its stability limit" in line for line in kernel.messages)
        return StepResult(values, warned, kernel.time)

    def limit(self) -> float:
        """Return the largest stable step of the explicit method at the initial speed [s]."""
        wheelsets, values = 2 if self.fmu == "bogie" else 1, in_space(self.fmu) | thesis_reading()
        return limit(DrivenVehicle(self.fmu, self.fmu, tuple(values.items()), wheelsets), self.speed)


# ---- what is measured --------------------------------------------------------------------------------------------


def hunting(speed: float, values: Mapping[str, float]) -> tuple[Kernel, tuple[float, ...]]:
    """Return the wavelength [m] at 15 m/s, or the frequency [Hz] at 25 m/s, as in the thesis."""
    kernel, series = hunting_wheelset.hunt(speed, HUNT, **values)
    period = hunting_wheelset.hunting_period(series)
    assert period is not None  # the wave of the track sets it hunting
    return kernel, (speed * period if speed == 15.0 else 1 / period,)


def lateral(speed: float, values: Mapping[str, float]) -> tuple[Kernel, tuple[float, ...]]:
    """Return the spectral peak of the hunting [Hz] and, at 15 m/s, the largest shift of the leading wheelset [mm]."""
    kernel, series = irregularities.travel(LATERAL, speed, **values)
    shift = 1e3 * float(np.abs(series["lateral_1"]).max())
    frequency = irregularities.kinematic_peak(series)
    return kernel, (frequency, shift) if speed == 15.0 else (frequency,)


def cross_level(speed: float, values: Mapping[str, float]) -> tuple[Kernel, tuple[float, ...]]:
    """Return the largest wheel load of the leading wheelset [kN]."""
    kernel, series = irregularities.travel(CROSS_LEVEL, speed, **values)
    return kernel, (irregularities.largest_wheel_load(series),)


def shift_between(series: Recording, fastest: float, slowest: float) -> tuple[float, ...]:
    """Return the largest shift of both wheelsets [mm] between two speeds [m/s]."""
    chosen = (series["speed"] <= fastest) & (series["speed"] >= slowest)
    return tuple(1e3 * float(np.abs(series[f"lateral_{n}"][chosen]).max()) for n in (1, 2))


def seconds_down_to(case: ShoeCase, speed: float) -> float:
    """Return the time at which the accurate stop has slowed to a speed [s]."""
    _, series = asymmetric_shoes.brake(case, STOP, **method(None))
    return float(series["time"][series["speed"] > speed][-1])


def shoes(case: ShoeCase, values: Mapping[str, float]) -> tuple[Kernel, tuple[float, ...]]:
    """Return the largest shift of both wheelsets [mm] down to the speed of the cut."""
    kernel, series = asymmetric_shoes.brake(case, seconds_down_to(case, CUT), **values)
    return kernel, shift_between(series, np.inf, CUT)


def below_the_cut(case: ShoeCase, step: float | None) -> float:
    """Return the largest shift of the leading wheelset [mm] below the speed of the cut."""
    _, series = asymmetric_shoes.brake(case, seconds_down_to(case, BELOW), **method(step))
    return shift_between(series, CUT, BELOW)[0]


def of_shoes(wheelset: int, error: int) -> PrintedRun:
    case = ShoeCase(wheelset, error, 1.0, AS_THESIS)
    peaks = PEAKS[wheelset, error][APPLICATION_TIMES.index(case.application)]
    braked, source = {1: "leading", 2: "trailing"}[wheelset], f"Table 9.{wheelset + 1}"
    printed = [
        Printed(f"shoes of the {braked} wheelset, {error} %: peak shift of the {place} one", "mm", peak, source)
        for place, peak in zip(("leading", "trailing"), peaks, strict=True)
    ]
    return PrintedRun("bogie", asymmetric_shoes.SPEED, tuple(printed), partial(shoes, case))


def of_hunting(speed: float, quantity: str, unit: str, both: tuple[float, float], band: float) -> PrintedRun:
    printed = Printed(f"wheelset, {speed:g} m/s: {quantity}", unit, both[0], "section 4.4", both[1], band)
    return PrintedRun("wheelset", speed, (printed,), partial(hunting, speed))


def of_lateral(speed: float) -> PrintedRun:
    source, name = "section 5.3.1", f"lateral wave, {speed:g} m/s"
    thesis, vampire = HUNTING_PEAK[speed]
    printed = [Printed(f"{name}: spectral peak of the hunting", "Hz", thesis, source, vampire)]
    if speed == 15.0:
        printed.append(Printed(f"{name}: largest shift", "mm", LATERAL_PEAK[0], source, LATERAL_PEAK[1]))
    return PrintedRun("bogie", speed, tuple(printed), partial(lateral, speed))


def of_cross_level(speed: float) -> PrintedRun:
    thesis, vampire = WHEEL_LOAD[speed]
    printed = Printed(f"cross level, {speed:g} m/s: largest wheel load", "kN", thesis, "section 5.3.3", vampire)
    return PrintedRun("bogie", speed, (printed,), partial(cross_level, speed))


#: Cases by braked wheelset and error of the shoe forces [%].
SHOES = {(wheelset, error): of_shoes(wheelset, error) for wheelset, error in product((1, 2), (25, 50))}
RUNS = (
    of_hunting(15.0, "wavelength", "m", hunting_wheelset.WAVELENGTH, hunting_wheelset.WAVELENGTH_BAND),
    of_hunting(25.0, "frequency", "Hz", hunting_wheelset.FREQUENCY, hunting_wheelset.FREQUENCY_BAND),
    of_lateral(15.0),
    of_lateral(25.0),
    of_cross_level(25.0),
    *SHOES.values(),
)

#: Results by run and step, None for the accurate solution.
Study = dict[tuple[PrintedRun, float | None], StepResult]


def study(runs: Sequence[PrintedRun] = RUNS, steps: Sequence[float] = STEPS) -> Study:
    """Return runs with all steps; they share the compiled libraries and run in parallel."""
    for name in ("bogie", "wheelset"):
        library(name, **in_space(name))  # compiled once, before the threads load them
    asked = list(product(runs, (None, *steps)))
    with ThreadPoolExecutor() as pool:
        found = pool.map(lambda one: one[0].found(one[1]), asked)
        bar = counting(found, "runs", len(asked), unit="run")
        return dict(zip(asked, bar, strict=True))


# ---- the table ---------------------------------------------------------------------------------------------------


def words_of(step: float | None) -> str:
    return "accurate" if step is None else f"step {1e3 * step:g} ms"


def runs_of(found: Study) -> list[PrintedRun]:
    return list(dict.fromkeys(run for run, _ in found))


def steps_of(found: Study) -> list[float | None]:
    """Return the steps, the accurate solution first."""
    return list(dict.fromkeys(step for _, step in found))


def numbers(found: Study) -> list[tuple[PrintedRun, int, Printed]]:
    """Return every reported number with its run and its place there."""
    return [(run, place, printed) for run in runs_of(found) for place, printed in enumerate(run.printed)]


def row_of(printed: Printed, step: float | None, value: float, warned: bool) -> Row:
    log = "the log says: above the stability limit" if warned else "the log is silent"
    return Row(
        f"{printed.quantity}, {words_of(step)}",
        printed.unit,
        printed.thesis,
        value,
        printed.band,
        printed.source,
        "RODAS5P" if step is None else log,
        printed.vampire,
    )


def rows_of(found: Study) -> list[Row]:
    return [
        row_of(printed, step, found[run, step].values[place], found[run, step].warned)
        for run, place, printed in numbers(found)
        for step in steps_of(found)
    ]


def limit_rows(found: Study) -> list[Row]:
    theory = "eigenvalues of the exact Jacobian times the stability region"
    one_of_each = {(run.fmu, run.speed): run for run in runs_of(found)}
    return [
        measured(f"{fmu}: limit of the step at {speed:g} m/s", "ms", 1e3 * run.limit(), theory)
        for (fmu, speed), run in one_of_each.items()
    ]


def rows_below() -> list[Row]:
    """Return the first case of chapter 9 below the cut."""
    case, words = ShoeCase(1, 25, 1.0, AS_THESIS), "shoes of the leading wheelset, 25 %: its shift"
    span = f"from {CUT:g} to {BELOW:g} m/s"
    return [
        measured(f"{words} {span}, {words_of(step)}", "mm", below_the_cut(case, step), "below the cut")
        for step in (None, CLOSER)
    ]


def verdicts(found: Study) -> dict[str, list[str]]:
    """Return the reported numbers by the effect of the closer step on their distance from the thesis."""
    names: dict[str, list[str]] = {"nearer to the thesis": [], "farther from it": [], "unchanged": []}
    for run, place, printed in numbers(found):
        accurate, other = (found[run, step].values[place] for step in (None, CLOSER))
        if abs(other / accurate - 1.0) < UNCHANGED:
            names["unchanged"].append(printed.quantity)
        elif abs(other - printed.thesis) < abs(accurate - printed.thesis):
            names["nearer to the thesis"].append(printed.quantity)
        else:
            names["farther from it"].append(printed.quantity)
    return names


def remarks_of(found: Study, names: Mapping[str, list[str]], below: float) -> list[str]:
    step = f"a step of {1e3 * CLOSER:g} ms"
    remarks = [f"Under {step} {words}: {'; '.join(which) or 'none'}." for words, which in names.items()]
    chosen, turned = SHOES[1, 50], SHOES[2, 25]
    both = {one: " and ".join(f"{value:.1f}" for value in found[turned, one].values) for one in (CLOSER, None)}
    printed = " and ".join(f"{one.thesis:.1f}" for one in turned.printed)
    scattered = ", ".join(f"{found[chosen, one].values[0]:.1f}" for one in steps_of(found)[1:])
    return [
        *remarks,
        "The thesis names a Runge-Kutta method and prints neither its order nor its step. Numbers of it that an "
        "accurate solution misses are consistent with the classical method and a fixed step above its stability limit, "
        "where the motion stays bounded and no table or figure shows the error: consistent with, not proven.",
        "Against it speaks that the thesis's program is in MATLAB, whose own Runge-Kutta method chooses steps by the "
        f"error; that no one step gives all numbers, and some move away; and that below {CUT:g} m/s {step} lets the "
        f"wheelset wander by {below:.1f} mm, which Table 9.2 does not have. With the trailing wheelset's shoes at 25 % "
        f"the leading and the trailing wheelset shift by {both[CLOSER]} mm where Table 9.3 has {printed} mm and an "
        f"accurate solution {both[None]} mm. Above the limit a number also depends on the "
        f"step as chance has it: {chosen.printed[0].quantity} is {scattered} mm over the steps.",
        f"A spectral peak is known to {GRID:.3f} Hz.",
        "In the picture the explicit method is unstable from the start on behind the grey line.",
    ]


def run(options: Options, quick: bool = False) -> Report:
    found = study(tuple(SHOES.values()), QUICK_STEPS) if quick else study()
    below = rows_below()
    names = verdicts(found)
    counted = [
        measured(f"numbers {words}, step {1e3 * CLOSER:g} ms", "1", len(which), f"of {len(numbers(found))}")
        for words, which in names.items()
    ]
    rows = [*rows_of(found), *below, *limit_rows(found), *counted]
    seconds = sum(one.seconds for one in found.values())
    parameters = tables_5_1_and_5_2().values() | thesis_reading() | RIGID | {"steps": steps_of(found)[1:]}
    remarks = remarks_of(found, names, below[1].simulated or 0.0)
    return Report(rows, table(found), lambda: draw(found), parameters, seconds, remarks)


def table(found: Study) -> Recording:
    """Return every value by number, counted from 1, and step; step 0: the accurate solution."""
    lines = [
        [count, step or 0.0, found[run, step].values[place], printed.thesis]
        for count, (run, place, printed) in enumerate(numbers(found), 1)
        for step in steps_of(found)
    ]
    return Recording({"number": "1", "step": "s", "value": "as printed", "thesis": "as printed"}, lines)


# ---- the figure --------------------------------------------------------------------------------------------------


def draw(found: Study) -> Figure:
    figure, grid = plt.subplots(3, 5, figsize=(16.0, 8.5), sharex=True)
    axes = list(grid.ravel())
    for axis, (run, place, printed) in zip(axes, numbers(found), strict=False):
        panel(axis, run, printed, {step: found[run, step].values[place] for step in steps_of(found)})
    for axis in axes[len(numbers(found)) :]:
        axis.set_axis_off()
    handles, labels = axes[2].get_legend_handles_labels()
    axes[-1].legend(handles, labels, loc="center")
    for axis in grid[-1]:
        axis.set_xlabel("step of RK4 [ms]")
    nearer = len(verdicts(found)["nearer to the thesis"])
    return titled(
        figure, f"{nearer} of {len(numbers(found))} printed numbers come closer with a {1e3 * CLOSER:g} ms step"
    )


def panel(axis: Axes, run: PrintedRun, printed: Printed, values: Mapping[float | None, float]) -> None:
    steps = [step for step in values if step is not None]
    axis.plot([1e3 * step for step in steps], [values[step] for step in steps], "o-", color=TRAILING, label="RK4")
    axis.axhline(values[None], color=LEADING, label="accurate")
    axis.axhline(printed.thesis, color=THESIS, linestyle="--", label="thesis")
    if printed.vampire is not None:
        axis.axhline(printed.vampire, color=BOGIE, linestyle=":", label="VAMPIRE")
    axis.axvline(1e3 * run.limit(), color="#999999", linewidth=0.8, label="stability limit at the first speed")
    axis.set_title(f"{printed.quantity} [{printed.unit}]".replace(": ", ":\n"), fontsize=8)


SCENARIO = Scenario(
    "thesis-step", "Published numbers over the step of the thesis's Runge-Kutta method, which is not published", run
)
