"""From tread to flange with all contact models: the error, the cost and the accuracy of the solution of each.

The case is that of chapter 9 with a fixed axis of the yaw torque. Brakes are applied slowly and one shoe presses too
hard, so that the leading wheelset turns until its left flange meets the rail.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, THESIS, THREE, TRAILING, mark, one_word, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Bound, Report, Row, at_least, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from bogie_braking.reporting.timing import REPEATS, least
from evidence.measuring.runs import SceneRun, layout, own
from evidence.measuring.scenes import SMOOTH, Scene, difference, lateral_peak
from fmu_src.compile import build_library
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel, Library
from fmu_src.system import model_of
from products.kernel_runs import History, play, prepare
from rbd_model.contact.depth import DEPTHS, Contact
from rbd_model.levels.models import DEFAULT_TOLERANCE
from rbd_model.levels.spatial import spatial_vehicle
from rbd_model.track.irregularity import irregular_track, section_5_3
from rbd_model.vehicle.parameters import tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.asymmetric_shoes import BRAKE_START, BRAKE_TORQUE, SPEED, YAW_TORQUE

#: Time to the full brake, as slow as in chapter 9 [s], so that the wheelset moves from its tread to its flange step by
#: step.
APPLICATION, DURATION, INTERVAL = 5.0, 8.0, 5e-3
#: Yaw torque at full brake [N.m]: 25 % error of chapter 9, and less than half of it, at which the flange also touches.
STRONG, WEAK = YAW_TORQUE[25], 20e3
#: Yaw torques over which the contact models differ; a quick run has the first and the last.
TORQUES = tuple(float(torque) for torque in np.linspace(5e3, STRONG, 9))
RECORDED = {"lateral_1": "m", "flange_force_1": "N", "derailment_quotient_1_left": "1"}
#: Limit of the default's error, in tolerances: the limit of the chart of speed against accuracy, EXPECTED there.
ERROR_BAND = 10.0
TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
#: Tolerance of the reference, by contact model. Strips that begin and cease to touch bend their forces; a smaller
#: tolerance would need tiny steps.
REFERENCE = {1: 1e-10, 2: 1e-10, 3: 1e-8}
#: Least ratio of a tolerance to that of its reference.
FINER = 100
#: Tolerances about the default. The instant at which a step ends, as the flange hits its rail or a strip begins to
#: touch, changes the largest error by a factor of two to three, without order. The limit applies to the
#: median of these.
NEIGHBOURS = tuple(float(factor) * DEFAULT_TOLERANCE for factor in np.geomspace(0.5, 2.0, 13))
#: Largest missing energy as a share of the energy at the start: docs/checking.md, in 3D with dampers.
ENERGY_BAND = 1e-6
ENERGIES = ("kinetic_energy", "potential_energy")
POWERS = ("brake_power", "creep_power", "damping_power")
#: Start value of a parameter that is set. It is that of tests/rbd_model/test_patches.py, so that both use one binary.
COMPILED_TOLERANCE = 1e-7
#: Time over which steps are counted [s], and largest number of steps in one period of the fastest vibration.
WINDOW, STEPS_OF_A_PERIOD = 0.02, 20
#: Lateral shift from which steps are compared with the limit [m], after the start; and from which they are drawn.
MOVED, NEAR_FLANGE = 1e-3, 8e-3
#: Force above which a flange is in contact [N]: a smooth law has a little force before.
TOUCHING = 1.0
#: Number of rounds, in which the contact models take turns. The least wall time of the rounds counts, because of noise.
ROUNDS = 5
#: Contact models that are timed in rounds; one run of the third takes minutes.
TIMED = (1, 2)
#: Target cost of model 2 on a stop without flange contact, in units of model 1. Wall times vary:
#: no row has this limit.
COST_TO_REACH = 1.3
COLOURS, DASHES = {1: TRAILING, 2: LEADING, 3: THESIS}, {1: "--", 2: "-", 3: ":"}


def inputs(yaw_torque: float) -> dict[str, History]:
    """Return the inputs: the brakes of both wheelsets and the yaw torque on the leading one rise together."""
    ramp = ((0.0, 0.0), (BRAKE_START, 0.0), (BRAKE_START + APPLICATION, 1.0))
    full = {"brake_torque_1": BRAKE_TORQUE, "brake_torque_2": BRAKE_TORQUE, "yaw_torque_1": yaw_torque}
    return {name: [(time, share * value) for time, share in ramp] for name, value in full.items()}


@lru_cache
def scene(depth: int) -> Scene:
    """Return the case of the strong torque with a contact model; every differential state is recorded."""
    return Scene(
        f"from tread to flange, model {depth}",
        "contact that comes and stays",
        "bogie",
        DURATION,
        INTERVAL,
        tuple(layout("bogie", level=3, contact_model=depth).kept),
        lateral_peak,
        values={"contact_model": depth, "initial_speed": SPEED},
        inputs=inputs(STRONG),
    )


def history(depth: int, yaw_torque: float, **values: float) -> Recording:
    """Return the recorded shift, flange force and Y/Q of the wheelset that turns."""
    kernel = prepare("bogie", level=3, contact_model=depth, initial_speed=SPEED, **values)
    return play("bogie", kernel, DURATION, INTERVAL, tuple(RECORDED), inputs(yaw_torque))


def largest(series: Recording) -> dict[str, float]:
    """Return the largest absolute value of each quantity."""
    return {name: float(np.abs(series[name]).max()) for name in RECORDED}


# ---- how well it is solved -----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Accuracy:
    """Errors of a run against the reference.

    read_off: relative error of peak shift and distance, as in `speed-accuracy`; course: error over time in the norm
    that the tolerance bounds in each step (root mean square of all states in their nominal values); single, state,
    shift: the largest error of one state at one instant in its nominal value, its name, and the lateral shift then [m].
    """

    read_off: float
    course: np.ndarray
    single: float
    state: str
    shift: float
    seconds: float

    @property
    def norm(self) -> float:
        """Return the error at the worst instant."""
        return float(self.course.max())


def accuracy(depth: int, run: SceneRun, exact: SceneRun) -> Accuracy:
    """Return the errors of a run against an exact one."""
    place, form = scene(depth), layout("bogie", level=3, contact_model=depth)
    nominal = form.nominal[form.differential]
    errors = np.array([run.samples[name] - exact.samples[name] for name in form.kept]).T / nominal
    instant, state = np.unravel_index(np.argmax(np.abs(errors)), errors.shape)
    return Accuracy(
        difference(place.measure(run.samples), place.measure(exact.samples)),
        np.sqrt(np.mean(errors**2, axis=1)),
        float(np.abs(errors).max()),
        form.kept[int(state)],
        float(abs(exact.samples["lateral_1"][instant])),
        run.seconds,
    )


@lru_cache
def reference(depth: int) -> SceneRun:
    """Return the reference run of a contact model, from which errors are measured."""
    return own(scene(depth), tolerance=REFERENCE[depth])


def accuracies(depth: int, rounds: int) -> dict[float, Accuracy]:
    """Return the accuracy by tolerance; times are the least of rounds in which the tolerances take turns."""
    exact = reference(depth)
    tolerances = [one for one in TOLERANCES if one >= FINER * REFERENCE[depth] * (1 - 1e-9)]
    count = rounds if depth in TIMED else 1
    runs = [[own(scene(depth), tolerance=tolerance) for tolerance in tolerances] for _ in range(count)]
    fastest = [min(of_one, key=lambda run: run.seconds) for of_one in zip(*runs, strict=True)]
    return {tolerance: accuracy(depth, run, exact) for tolerance, run in zip(tolerances, fastest, strict=True)}


@dataclass(frozen=True)
class AboutDefault:
    """Largest errors at each of NEIGHBOURS, in that tolerance: norm of all states, and one state."""

    norm: list[float]
    single: list[float]


def errors_about_default(depth: int, tolerances: Sequence[float]) -> AboutDefault:
    """Return the errors at tolerances about the default: they scatter with the instants at which steps end."""
    found = {
        tolerance: accuracy(depth, own(scene(depth), tolerance=tolerance), reference(depth)) for tolerance in tolerances
    }
    return AboutDefault(*([getattr(of, kind) / one for one, of in found.items()] for kind in ("norm", "single")))


@dataclass(frozen=True)
class StepStatistics:
    """At the default tolerance: lateral shift [m] and mean step [s] in windows of time; the fastest vibration's period.

    period [s]: of the oscillating mode with the largest frequency while the flange bears, from the exact Jacobian.
    """

    shift: np.ndarray
    step: np.ndarray
    period: float


def steps_over_shift(depth: int) -> StepStatistics:
    """Return the steps through the transition; a step ends where a window does."""
    place, form = scene(depth), layout("bogie", level=3, contact_model=depth)
    kernel, rows = place.kernel(), []
    for begin in np.arange(0.0, DURATION, WINDOW):
        before = kernel.counts["steps"]
        place.set_inputs(kernel, begin, begin + WINDOW)
        kernel.advance(WINDOW)
        rows.append((abs(kernel["lateral_1"]), WINDOW / (kernel.counts["steps"] - before)))
    state = np.array(kernel.linearise().state)[form.differential]
    modes = np.linalg.eigvals(np.array(kernel.jacobian_at(kernel.time, state.tolist())))
    shifts, steps = np.array(rows).T
    return StepStatistics(shifts, steps, 2 * np.pi / float(np.abs(modes.imag).max()))


def missing_energy(depth: int) -> float:
    """Return the energy that brakes, creep and dampers do not account for, as a share of the energy at the start.

    Model 1 is tested in tests/rbd_model/test_spatial.py.
    """
    system = spatial_vehicle(two_axle_bogie(), irregular_track(section_5_3()), Contact(depth))
    model = model_of(system.with_integrals(POWERS).with_outputs(ENERGIES), COMPILED_TOLERANCE)
    kernel = Kernel(Library(build_library(model)), initial_speed=SPEED, tolerance=DEFAULT_TOLERANCE)
    kernel.initialise()
    start = sum(kernel[name] for name in ENERGIES)
    for begin, end in scene(depth).segments():
        scene(depth).set_inputs(kernel, begin, end)
        kernel.advance(end - begin)
    left = sum(kernel[name] for name in ENERGIES) + sum(kernel[f"integral_{name}"] for name in POWERS)
    return abs(left / start - 1.0)


def costs(count: int) -> dict[int, float]:
    """Return the wall time of the smooth stop of `speed-accuracy`, without flange contact, by contact model [s]."""
    kernels = {depth: SMOOTH.kernel(contact_model=depth) for depth in DEPTHS}
    torques = {name: history[0][1] for name, history in SMOOTH.inputs.items()}

    def once(kernel: Kernel) -> None:
        kernel.reopen()
        kernel.set(**torques)
        kernel.advance(SMOOTH.duration)

    rounds = [
        {depth: least(partial(once, kernel), REPEATS if count > 1 else 1) for depth, kernel in kernels.items()}
        for _ in range(count)
    ]
    return {depth: min(seconds[depth] for seconds in rounds) for depth in DEPTHS}


# ---- the table -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ModelComparison:
    """All results by contact model; peaks also by yaw torque [N.m]; exact_peaks: of the strong torque with the
    reference; missing: energy.
    """

    peaks: Mapping[int, Mapping[float, dict[str, float]]]
    histories: Mapping[int, Recording]
    exact_peaks: Mapping[int, dict[str, float]]
    accuracies: Mapping[int, Mapping[float, Accuracy]]
    about_default: Mapping[int, AboutDefault]
    steps: Mapping[int, StepStatistics]
    costs: Mapping[int, float]
    missing: Mapping[int, float]

    def more(self, name: str, torque: float, depth: int = 1) -> float:
        """Return the excess of a contact model's result over that of model 2 [%]."""
        return 100 * (self.peaks[depth][torque][name] / self.peaks[2][torque][name] - 1.0)


def measure(torques: Sequence[float], neighbours: Sequence[float], rounds: int) -> ModelComparison:
    histories, peaks = {}, {}
    for depth in counting(DEPTHS, "depths", unit="depth"):
        found = {torque: history(depth, torque) for torque in (*torques, WEAK)}
        histories[depth], peaks[depth] = found[STRONG], {torque: largest(series) for torque, series in found.items()}
    return ModelComparison(
        peaks,
        histories,
        {depth: largest(history(depth, STRONG, tolerance=REFERENCE[depth])) for depth in DEPTHS},
        {depth: accuracies(depth, rounds) for depth in DEPTHS},
        {depth: errors_about_default(depth, neighbours) for depth in DEPTHS},
        {depth: steps_over_shift(depth) for depth in DEPTHS},
        costs(rounds),
        {depth: missing_energy(depth) for depth in DEPTHS if depth > 1},
    )


def run(options: Options, quick: bool = False) -> Report:
    torques, neighbours, rounds = (TORQUES[::8], NEIGHBOURS[::3], 1) if quick else (TORQUES, NEIGHBOURS, ROUNDS)
    found = measure(torques, neighbours, rounds)
    series = Recording({"time": "s"}, [[time] for time in found.histories[1]["time"]])
    for depth, one in found.histories.items():
        for name, unit in RECORDED.items():
            series.add(f"{name}, model {depth}", unit, one[name])
    rows = [row for depth in DEPTHS for row in accuracy_rows(depth, found)]
    rows += step_rows(found) + difference_rows(found) + cost_rows(found)
    parameters = tables_5_1_and_5_2().values() | {
        "initial_speed": SPEED,
        "brake_torque": BRAKE_TORQUE,
        "yaw_torques": [*torques, WEAK],
        "application_time": APPLICATION,
        "tolerances": TOLERANCES,
    }
    seconds = DURATION * len(DEPTHS) * (len(torques) + len(TOLERANCES) + 4)
    return Report(rows, series, lambda: draw(found), parameters, seconds, remarks(found))


#: Names of the compared quantities, their unit in the table, and its number in one SI unit.
COMPARED = {
    "lateral_1": ("peak shift", "mm", 1e3),
    "flange_force_1": ("peak flange force", "kN", 1e-3),
    "derailment_quotient_1_left": ("peak Y/Q", "1", 1.0),
}


CHANCE = "not judged: chance of where steps end, its median is"


def accuracy_rows(depth: int, found: ModelComparison) -> list[Row]:
    """Return the rows of the default, in tolerances: peaks, and all states at the worst instant."""
    one, source = found.accuracies[depth][DEFAULT_TOLERANCE], f"RODAS5P {REFERENCE[depth]:g}"
    forces = difference(found.peaks[depth][STRONG], found.exact_peaks[depth])
    where = f"{one.state} in its nominal value, at a shift of {1e3 * one.shift:.2f} mm"
    about = found.about_default[depth]
    # With any contact model the largest error of a single run depends on where steps happen to end: the limit applies
    # to the median of NEIGHBOURS.
    rows: dict[str, tuple[float, Bound | None, str]] = {
        "relative error of peak shift and distance": (one.read_off, at_most(ERROR_BAND), ""),
        "relative error of peak shift, flange force and Y/Q": (forces, at_most(ERROR_BAND), ""),
        "largest error, norm of all states": (one.norm, None, CHANCE),
        "largest error of one state": (one.single, None, f"{CHANCE}; {where}"),
    }
    for words, errors in (
        ("largest error, norm of all states", about.norm),
        ("largest error of one state", about.single),
    ):
        spread = (
            f"from {min(errors):.1f} to {max(errors):.1f} at {len(errors)} tolerances from half the default to twice"
        )
        middle = float(np.median(errors)) * DEFAULT_TOLERANCE
        rows[f"{words}, median about the default"] = middle, at_most(ERROR_BAND), spread
    return [
        measured(f"model {depth}: {words} over the tolerance", "1", error / DEFAULT_TOLERANCE, source, asked, note)
        for words, (error, asked, note) in rows.items()
    ]


def step_rows(found: ModelComparison) -> list[Row]:
    """Return the rows that show that steps do not collapse and that the energy balance closes."""
    rows = []
    for depth, one in found.steps.items():
        shortest, period = 1e3 * float(one.step[one.shift > MOVED].min()), 1e3 * one.period
        asked = at_least(period / STEPS_OF_A_PERIOD)
        note = f"the fastest vibration takes {period:.2g} ms; mean of windows of {1e3 * WINDOW:g} ms"
        quantity, source = f"model {depth}: shortest step onto the flange", "eigenvalues of the exact Jacobian"
        rows.append(measured(quantity, "ms", shortest, source, asked, note))
    source = "work of brakes, creep, dampers and contacts"
    for depth, missing in found.missing.items():
        quantity = f"model {depth}: energy that is missing, as a share"
        rows.append(measured(quantity, "1", missing, source, at_most(ENERGY_BAND)))
    return rows


def difference_rows(found: ModelComparison) -> list[Row]:
    """Return the excess of models 1 and 3 over model 2, below and above the torque at which the flange touches."""
    rows = []
    for depth, torque, (name, (words, unit, scale)) in product((1, 3), (TORQUES[0], WEAK, STRONG), COMPARED.items()):
        if name == "flange_force_1" and torque < WEAK:
            continue  # no flange touches
        one, two = (scale * found.peaks[number][torque][name] for number in (depth, 2))
        quantity = f"{1e-3 * torque:.3g} kN.m: {words}, model {depth} over model 2, less 1"
        note = f"model {depth} finds {one:.4g}, model 2 {two:.4g} in {unit}"
        rows.append(measured(quantity, "%", found.more(name, torque, depth), "measured now", None, note))
    return rows


def cost_rows(found: ModelComparison) -> list[Row]:
    """Return the rows of wall times."""
    onto = {depth: found.accuracies[depth][DEFAULT_TOLERANCE].seconds for depth in DEPTHS}
    source, asked = "measured now, least of several runs", f"to reach {COST_TO_REACH:g}"
    rows = []
    for words, seconds, note in (
        ("stop without flange contact", found.costs, asked),
        ("run onto the flange", onto, ""),
    ):
        rows += [measured(f"model {n}: {words}", "ms", 1e3 * one, source) for n, one in seconds.items()]
        for depth in (2, 3):
            quantity = f"{words}: time of model {depth} over model 1"
            rows.append(measured(quantity, "1", seconds[depth] / seconds[1], source, None, note if depth == 2 else ""))
    return rows


def remarks(found: ModelComparison) -> list[str]:
    """Return the rule of selection, and the cases in which each contact model fails."""
    error, about = found.accuracies[2][DEFAULT_TOLERANCE], found.about_default[2].single
    return [
        "Model 1 serves off the flange, where both find the same, and for comparison with the thesis. From the flange "
        f"on its wheelset goes {found.more('lateral_1', STRONG):.0f} % too far and presses the flange "
        f"{found.more('flange_force_1', STRONG):.0f} % too hard; Y/Q, climb and lift ask for model 2.",
        f"Model 2 errs most where the flange touches, at {1e3 * error.shift:.2f} mm: there {error.state} is off by "
        f"{error.single / DEFAULT_TOLERANCE:.0f} tolerances for an instant; with tolerances near the default by "
        f"{min(about):.0f} to {max(about):.0f}, as steps happen to end at the impact.",
        "Model 3 parts from model 2 before the flange touches: from 7 mm of shift on the tread's patch, 11 mm broad, "
        "reaches into the fillet and grows to 18 mm, which no ellipse does. The rail pushes back earlier, the flange "
        f"meets it later, and Y/Q is {-found.more('derailment_quotient_1_left', STRONG, 3):.0f} % lower. It takes "
        f"{found.costs[3] / found.costs[2]:.0f} times as long, and is for measured profiles, whose contact jumps or is "
        "long (scenario contact-manchester).",
    ]


# ---- the figure ----------------------------------------------------------------------------------------------------


def draw(found: ModelComparison) -> Figure:
    figure, grid = plt.subplots(3, 2, figsize=(10.5, 10.5))
    for axis, name in zip(grid[0], ("lateral_1", "flange_force_1"), strict=True):
        draw_history(axis, found, name)
    draw_difference(grid[1, 0], found)
    draw_steps(grid[1, 1], found)
    draw_cost(grid[2, 0], found)
    draw_course(grid[2, 1], found)
    further, torque = found.more("lateral_1", STRONG), one_word(f"{1e-3 * STRONG:.0f} kN.m")
    return titled(figure, f"At {torque} yaw torque model 1 shifts {one_word(f'{further:.0f} %')} further than model 2")


def draw_history(axis: Axes, found: ModelComparison, name: str) -> None:
    words, unit, scale = COMPARED[name]
    for depth, series in found.histories.items():
        values = scale * np.abs(series[name])
        axis.plot(series["time"], values, DASHES[depth], color=COLOURS[depth], label=f"model {depth}")
    axis.set(title=f"{words.removeprefix('peak ')} of the leading wheelset [{unit}]", xlabel="time [s]")
    axis.legend()


def draw_difference(axis: Axes, found: ModelComparison) -> None:
    """Draw the excess of model 1 over model 2, over the torque."""
    for (name, (words, _, _)), marker, colour in zip(COMPARED.items(), "os^", THREE, strict=True):
        # below, no flange touches
        torques = [torque for torque in found.peaks[2] if torque != WEAK]
        touched = [torque for torque in torques if name != "flange_force_1" or found.peaks[2][torque][name] > TOUCHING]
        values = [found.more(name, torque) for torque in touched]
        axis.plot([1e-3 * torque for torque in touched], values, marker=marker, color=colour, label=words)
    axis.set(title="model 1 finds more than model 2 by [%]", xlabel="yaw torque at full brake [kN.m]")
    axis.legend()


def draw_steps(axis: Axes, found: ModelComparison) -> None:
    """Draw the steps over the last millimetres; dotted: a share of the fastest vibration's period."""
    for depth, one in found.steps.items():
        near = one.shift > NEAR_FLANGE
        axis.plot(1e3 * one.shift[near], 1e3 * one.step[near], "o", color=COLOURS[depth], markersize=3)
        limit = 1e3 * one.period / STEPS_OF_A_PERIOD
        if depth not in TIMED:
            continue  # as that of model 2
        axis.axhline(limit, color=COLOURS[depth], linewidth=0.8, linestyle=":")
        place, words = (1e3 * NEAR_FLANGE, limit), f"1/{STEPS_OF_A_PERIOD} of the fastest period, model {depth}"
        axis.annotate(words, place, xytext=(0, 3), textcoords="offset points", fontsize=7)
    axis.set_yscale("log")
    axis.yaxis.set_major_formatter("{x:g}")
    axis.set_title(f"mean step in windows of {1e3 * WINDOW:g} ms [ms]")
    axis.set_xlabel("lateral shift of the leading wheelset [mm]")


def draw_cost(axis: Axes, found: ModelComparison) -> None:
    """Draw error against cost: all states, and peak quantities."""
    kinds = {"norm": ("o", "all states"), "read_off": ("s", "peak shift and distance")}
    for depth, by_tolerance in found.accuracies.items():
        colour, default = COLOURS[depth], by_tolerance[DEFAULT_TOLERANCE]
        times = [1e3 * one.seconds for one in by_tolerance.values()]
        for kind, (marker, words) in kinds.items():
            values = [getattr(one, kind) for one in by_tolerance.values()]
            axis.plot(
                times, values, marker + DASHES[depth], color=colour, markersize=5, label=f"model {depth}, {words}"
            )
            ringed = getattr(default, kind)
            axis.plot(1e3 * default.seconds, ringed, "o", color=colour, markersize=12, fillstyle="none")
    axis.set(xscale="log", yscale="log")
    axis.set_title(f"error at tolerances {TOLERANCES[0]:g} to {TOLERANCES[-1]:g}; the ring is the default")
    axis.set_xlabel("wall time [ms]")
    axis.legend(fontsize=6, loc="center", bbox_to_anchor=(0.53, 0.5))


def draw_course(axis: Axes, found: ModelComparison) -> None:
    """Draw the error over time at the default tolerance."""
    for depth, by_tolerance in found.accuracies.items():
        course = by_tolerance[DEFAULT_TOLERANCE].course / DEFAULT_TOLERANCE
        axis.plot(np.arange(course.size) * INTERVAL, course, color=COLOURS[depth], linewidth=0.9)
    axis.axhline(ERROR_BAND, color="#999999", linewidth=0.8)
    patched = found.histories[2]
    mark(axis, patched.first_time(np.abs(patched["flange_force_1"]) > TOUCHING), "the flange touches")
    axis.set(yscale="log", ylim=(1e-3, 100 * ERROR_BAND))
    axis.set(title="error of all states over the default tolerance", xlabel="time [s]")


SCENARIO = Scenario(
    "contact-model",
    "From tread to flange with all contact models: error, cost and accuracy of the solution of each",
    run,
)
