"""Limits of integration methods, predicted and simulated: stable steps, silent errors, drift, rest and the fold."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, LEADING, THESIS, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.measuring.drift import STEP as DRIFT_STEP
from evidence.measuring.drift import Drift, drift
from evidence.measuring.fold import DERAILING, Approach, approach, derail
from evidence.measuring.runs import layout
from evidence.measuring.stability import (
    EXPLICIT,
    MACHINES,
    PATCHES,
    RODAS5P,
    ROS34PW2,
    RUNGE_KUTTA,
    SPATIAL,
    STRIPS,
    amplification_of_rk4,
    boundary,
    growth_of_perturbation,
    largest_stable_step,
    limit,
)
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel, SimulationError
from products.kernel_runs import RIGID, prepare
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

NAMES = {RODAS5P: "RODAS5P", ROS34PW2: "ROS34PW2", RUNGE_KUTTA: "RK4"}
COLOURS = {RODAS5P: LEADING, ROS34PW2: "#56b4e9", RUNGE_KUTTA: TRAILING}
#: Speeds [m/s] of the theory, and of the simulations that test it; those of a quick run.
SPEEDS = tuple(float(speed) for speed in np.geomspace(0.01, 60.0, 25))
TRIED = (0.01, 0.1, 1.0, 10.0, 25.0, 60.0)
QUICK_SPEEDS, QUICK_TRIED = tuple(np.geomspace(0.01, 60.0, 11).tolist()), (0.01, 25.0, 60.0)
#: Steps of the default method that are simulated, as multiples of RK4's limit.
MULTIPLES = (2.0, 10.0, 100.0)
#: Ranges of friction coefficients and of shares of the sprung mass at 25 m/s, and their numbers; those of a quick run.
FRICTION, LOAD, COUNTS, QUICK_COUNTS = (0.05, 0.6), (0.25, 1.5), (12, 11), (3, 3)
SPEED_OF_LOADS = 25.0
#: Tolerance of the boundary against the predicted one: bisection to 0.2 %, and slightly nonlinear creep.
BOUNDARY_BAND = 0.01
#: Steps of the run over a lateral wave under braking [s].
STEPS = (2e-4, 4e-4, 6e-4, 7e-4, 8e-4, 1e-3, 1.5e-3, 2e-3, 3e-3, 5e-3, 1e-2)
WAVE = {"lateral_irregularity": 0.012, "lateral_wave_number": 0.08}
BRAKED_SECONDS, INTERVAL, LIMITS_EVERY = 4.0, 5e-3, 20
BRAKED = {"brake_torque_1": 20e3, "brake_torque_2": 20e3}
#: Regularisation of the creepage at rest [m/s], and the drawbar force against which a bogie is held [N].
CREEPAGE_SPEEDS = (1e-3, 3e-3, 1e-2, 3e-2, 1e-1)
DRAWBAR = 20e3
STOP_STEPS = (1e-4, 1e-3, 1e-2, 1e-1)


@dataclass
class Atlas:
    """All measurements, by panel; keys name their cases. speeds: of the theory; tried: of the simulations [m/s]."""

    speeds: tuple[float, ...]
    tried: tuple[float, ...]
    frictions: tuple[float, ...]
    loads: tuple[float, ...]
    theory: dict[tuple[str, str], list[float]] = field(default_factory=dict)
    found: dict[str, list[float]] = field(default_factory=dict)
    default_growth: list[tuple[str, float, float, float]] = field(default_factory=list)
    growth: list[tuple[str, float, float, float, float, bool]] = field(default_factory=list)
    over: dict[str, tuple[list[float], list[float]]] = field(default_factory=dict)
    silent: dict[int, list[tuple[float, float, bool]]] = field(default_factory=dict)
    silent_limits: tuple[float, float] = (0.0, 0.0)
    rest: list[tuple[float, float, float]] = field(default_factory=list)
    left: float = 0.0
    stops: dict[int, list[tuple[float, float, str]]] = field(default_factory=dict)
    drifts: dict[bool, Drift] = field(default_factory=dict)
    folds: list[tuple[float, float]] = field(default_factory=list)
    approach: Approach | None = None


# ---- what is measured --------------------------------------------------------------------------------------------


def boundaries(atlas: Atlas) -> None:
    """Measure the largest stable step over speed, by theory and by perturbation."""
    for machine in (*MACHINES, PATCHES, STRIPS):
        for method in EXPLICIT if machine is SPATIAL else ("RK4",):
            atlas.theory[machine.name, method] = [limit(machine, speed, method) for speed in atlas.speeds]
        atlas.found[machine.name] = [boundary(machine, speed) for speed in atlas.tried]


def growths(atlas: Atlas) -> None:
    """Run RK4 at 0.9 and 1.1 of the predicted step, and the default method at many times that step."""
    for machine in MACHINES:
        for speed in atlas.tried:
            step = limit(machine, speed)
            for share in (0.9, 1.1):
                grown = growth_of_perturbation(machine, speed, share * step, RUNGE_KUTTA)
                predicted = float(np.abs(amplification_of_rk4(-share * NEGATIVE_AXIS)))
                warned = any("stability limit" in line for line in grown.messages)
                atlas.growth.append((machine.name, speed, share, grown.factor, predicted, warned))
            for multiple in MULTIPLES:
                grown = growth_of_perturbation(machine, speed, multiple * step, RODAS5P)
                atlas.default_growth.append((machine.name, speed, multiple * step, grown.factor))


#: End of RK4's stability region on the negative real axis, on which the fastest modes lie.
NEGATIVE_AXIS = 2.785293563405282


def loads_and_frictions(atlas: Atlas) -> None:
    """Measure the limit at one speed over friction and over the load on the axles."""
    mass = tables_5_1_and_5_2().frame_mass
    kinds: dict[str, tuple[tuple[float, ...], Callable[[float], tuple[tuple[str, float], ...]]]] = {
        "friction": (atlas.frictions, lambda value: (("friction_1", value), ("friction_2", value))),
        "share of the sprung mass": (atlas.loads, lambda value: (("frame_mass", value * mass),)),
    }
    for name, (values, inputs) in kinds.items():
        atlas.over[name] = (
            [limit(SPATIAL, SPEED_OF_LOADS, "RK4", inputs(value)) for value in values],
            [boundary(SPATIAL, SPEED_OF_LOADS, RUNGE_KUTTA, inputs(value)) for value in values[::3]],
        )


def silent_errors(atlas: Atlas) -> None:
    """Run braked over a lateral wave with fixed steps: error of the lateral motion [m]; did the log warn?"""
    exact, limits = exact_over_wave()
    atlas.silent_limits = (min(limits), max(limits))
    for method in NAMES:
        atlas.silent[method] = []
        for step in STEPS:
            kernel, lateral = fixed_over_wave(method, step)
            error = np.nan if lateral is None else float(np.abs(lateral - exact[: lateral.size]).max())
            warned = any("limit" in line or "local error" in line for line in kernel.messages)
            atlas.silent[method].append((step, error, warned))


def exact_over_wave() -> tuple[np.ndarray, list[float]]:
    """Return the lateral displacement [m] every `INTERVAL`, and RK4's predicted limit [s] at each `LIMITS_EVERY`-th."""
    kernel = prepare("bogie", tolerance=1e-10, **RIGID, **WAVE, **BRAKED)
    differential = layout("bogie", **RIGID).differential
    kernel.initialise()
    lateral, limits = [kernel["lateral_1"]], []
    for number in range(1, round(BRAKED_SECONDS / INTERVAL) + 1):
        kernel.advance(INTERVAL)
        lateral.append(kernel["lateral_1"])
        if number % LIMITS_EVERY == 0:
            place = np.array(kernel.linearise().state)[differential]
            eigenvalues = np.linalg.eigvals(np.array(kernel.jacobian_at(kernel.time, place.tolist())))
            limits.append(largest_stable_step(eigenvalues))
    return np.array(lateral), limits


def fixed_over_wave(method: int, step: float) -> tuple[Kernel, np.ndarray | None]:
    """Return the kernel and its lateral displacement [m], or None if the run fails."""
    values = {"integration_method": method, "integration_step": step, "tolerance": 1e-3}
    kernel = prepare("bogie", **RIGID, **WAVE, **BRAKED, **values)
    try:
        return kernel, np.array(kernel.record(BRAKED_SECONDS, INTERVAL, ["lateral_1"])["lateral_1"])
    except SimulationError:
        return kernel, None


def rests(atlas: Atlas) -> None:
    """Measure rest against a drawbar force: slip of driven wheels, travel of locked ones; and the stop before."""
    for value in CREEPAGE_SPEEDS:
        kernel = prepare("bogie", level=2, initial_speed=2.0, creepage_speed=value, tolerance=1e-9, **BRAKED)
        kernel.advance(4.0)
        distance = kernel["distance"]
        kernel.set(drawbar_force=DRAWBAR, brake_torque_1=60e3, brake_torque_2=60e3)
        kernel.advance(10.0)
        atlas.left = max(atlas.left, abs(kernel["speed"]))
        torque = -DRAWBAR * tables_5_1_and_5_2().wheel_radius / 2
        driven = prepare("bogie", level=1, initial_speed=0.0, creepage_speed=value, tolerance=1e-9)
        driven.set(drawbar_force=DRAWBAR, traction_torque_1=torque, traction_torque_2=torque)
        driven.advance(1.0)
        atlas.rest.append((value, abs(driven["slip_1"]), distance))


def stops_with_fixed_steps(atlas: Atlas) -> None:
    """Run a stop from 5 m/s at the point level and 4.6 s of rest: the remaining speed, or why the run failed."""
    for method in NAMES:
        atlas.stops[method] = []
        for step in STOP_STEPS:
            values = {"integration_method": method, "integration_step": step, "tolerance": 1e-2}
            kernel = prepare("bogie", level=1, initial_speed=5.0, **BRAKED, **values)
            try:
                kernel.advance(8.0)
                atlas.stops[method].append((step, abs(kernel["speed"]), ""))
            except SimulationError as error:
                atlas.stops[method].append((step, np.nan, str(error)))


def folds(atlas: Atlas) -> None:
    """Measure the speed at derailment over the tolerance, and the distance to the fold, which shrinks towards it.

    Above the coarsest of these tolerances round-off decides whether a trial step finds the contact next to the fold.
    """
    for tolerance in (2e-4, 1e-4, 1e-5, 1e-6, 1e-7):
        kernel = DERAILING.kernel(tolerance=tolerance)
        derail(DERAILING, kernel)
        atlas.folds.append((tolerance, kernel["speed"]))
    atlas.approach = approach()


PARTS: tuple[Callable[[Atlas], None], ...] = (
    boundaries,
    growths,
    loads_and_frictions,
    silent_errors,
    rests,
    stops_with_fixed_steps,
    folds,
)


def measure(quick: bool = False) -> Atlas:
    speeds, tried, counts = (QUICK_SPEEDS, QUICK_TRIED, QUICK_COUNTS) if quick else (SPEEDS, TRIED, COUNTS)
    frictions, loads = (tuple(np.linspace(*ends, n).tolist()) for ends, n in zip((FRICTION, LOAD), counts, strict=True))
    atlas = Atlas(speeds, tried, frictions, loads)
    parts = [*PARTS, *(partial(drifting, partitioned) for partitioned in (True, False))]
    for part in counting(parts, "parts", unit="part"):
        part(atlas)
    return atlas


def drifting(partitioned: bool, atlas: Atlas) -> None:
    atlas.drifts[partitioned] = drift(partitioned)


# ---- the table ---------------------------------------------------------------------------------------------------


def rows_of(atlas: Atlas) -> list[Row]:
    theory = "eigenvalues of the exact Jacobian times the stability region"
    rows = []
    for machine in (*MACHINES, PATCHES, STRIPS):
        predicted = [limit(machine, speed) for speed in atlas.tried]
        ratios = [found / step for found, step in zip(atlas.found[machine.name], predicted, strict=True)]
        worst = max(ratios, key=lambda ratio: abs(ratio - 1.0))
        name = f"RK4, {machine.name}: largest stable step, found over predicted"
        rows.append(measured(name, "1", worst, theory, near(1.0, BOUNDARY_BAND)))
        step = limit(machine, 25.0)
        rows.append(measured(f"RK4, {machine.name}: limit at 25 m/s", "ms", 1e3 * step, theory))
    for machine in (SPATIAL, PATCHES, STRIPS):
        step = limit(machine, atlas.tried[-1])
        rows.append(measured(f"RK4, {machine.name}: limit at {atlas.tried[-1]:g} m/s", "ms", 1e3 * step, theory))
    for share, word in ((0.9, "largest"), (1.1, "least")):
        chosen = [one for one in atlas.growth if one[2] == share]
        pick = max if share < 1.0 else min
        worst = pick(one[3] for one in chosen)
        name = f"RK4 at {share:g} of the limit: {word} growth in a step"
        rows.append(measured(name, "1", worst, "stability function", near(chosen[0][4], 0.03 * chosen[0][4])))
        right = sum(one[5] == (share > 1.0) for one in chosen) / len(chosen)
        words = "reports it" if share > 1.0 else "is silent"
        name = f"RK4 at {share:g} of the limit: share of runs whose log {words}"
        rows.append(measured(name, "1", right, "guard", at_least(1.0)))
    growth = max(one[3] for one in atlas.default_growth)
    name = "RODAS5P at 2 to 100 times that limit: largest growth in a step"
    rows.append(measured(name, "1", growth, "L-stable", at_most(1.0)))
    return rows + silent_rows(atlas) + rest_rows(atlas) + fold_rows(atlas) + drift_rows(atlas)


def silent_rows(atlas: Atlas) -> list[Row]:
    least, largest = atlas.silent_limits
    rows = [
        measured("RK4 over a wave, braked: least limit", "ms", 1e3 * least, "eigenvalues along the run"),
        measured("RK4 over a wave, braked: largest limit", "ms", 1e3 * largest, "eigenvalues along the run"),
    ]
    for step in (6e-4, 1e-3):
        error, warned = next((e, w) for s, e, w in atlas.silent[RUNGE_KUTTA] if s == step)
        words = "the log reports it" if warned else "the log is silent"
        name = f"RK4 over a wave, step {1e3 * step:g} ms: error of the lateral motion"
        rows.append(measured(name, "mm", 1e3 * error, "against RODAS5P 1e-10", None, words))
    error = next(e for s, e, _ in atlas.silent[RODAS5P] if s == 1e-3)
    name, source = "RODAS5P with the same step of 1 ms", "against RODAS5P 1e-10"
    rows.append(measured(name, "mm", 1e3 * error, source, at_most(1e-3)))
    return rows


def rest_rows(atlas: Atlas) -> list[Row]:
    values, creeps, _ = np.array(atlas.rest).T
    slope = float(np.polyfit(np.log(values), np.log(creeps), 1)[0])
    default = next(one for one in atlas.rest if one[0] == 1e-2)
    least = atlas.rest[0]
    slip = "slip at rest of driven wheels over its regularisation: slope"
    stop = "stop distance, creepage speed 0.01 m/s against 0.001 m/s"
    rows = [
        measured(slip, "1", slope, "viscous creep: proportional", near(1.0, 0.01)),
        measured("slip at rest of driven wheels, 20 kN, creepage speed 0.01 m/s", "um/s", 1e6 * default[1]),
        measured("speed of locked wheels at rest, 20 kN", "um/s", 1e6 * atlas.left, "rails hold them", at_most(0.0)),
        measured(stop, "mm", 1e3 * (default[2] - least[2]), "what the regularisation costs", near(0.0, 0.1)),
    ]
    for method, name in NAMES.items():
        good = [speed for _, speed, failure in atlas.stops[method] if not failure]
        largest = max(good) if good else None
        failed = len(atlas.stops[method]) - len(good)
        words = (
            f"{failed} of {len(atlas.stops[method])} runs ended with a sentence: friction chatters" if failed else ""
        )
        asked, quantity = None if failed else at_most(1e-9), f"{name}, fixed steps 0.1-100 ms: speed left at rest"
        rows.append(measured(quantity, "m/s", largest, "false equilibria", asked, words))
    return rows


FITTED = "not judged: the half spacing is fitted to it"


def fold_rows(atlas: Atlas) -> list[Row]:
    assert atlas.approach is not None
    speeds = [speed for _, speed in atlas.folds]
    fold = "fold: curvature left over the time left, exponent"
    derailment = "derailment of chapter 9: speed, default"
    spread = "derailment: spread over tolerances 1e-5 to 1e-7"
    return [
        measured(fold, "1", atlas.approach.exponent, "square root: a fold", near(0.5, 0.03)),
        Row(derailment, "m/s", 6.1, speeds[3], None, "Table 9.2; tolerance 1e-6", FITTED),
        measured(spread, "m/s", np.ptp(speeds[2:]), "flange impacts before it are chaotic"),
    ]


def drift_rows(atlas: Atlas) -> list[Row]:
    free, closed = atlas.drifts[False], atlas.drifts[True]
    source = f"chapter 3, step {1e3 * DRIFT_STEP:g} ms, after {free.time[-1]:g} s"
    left = float(closed.norm[-1])
    return [
        measured("constraints without partitioning: residual", "m", free.residual[-1], source),
        measured("constraints with partitioning: residual", "m", closed.residual[-1], source, at_most(1e-12)),
        measured("Euler parameters without partitioning: norm less 1", "1", free.norm[-1], source),
        measured("Euler parameters with partitioning: norm less 1", "1", left, source, near(0.0, 1e-12)),
    ]


def run(options: Options, quick: bool = False) -> Report:
    atlas = measure(quick)
    remarks = [
        "RK4's limit is about 32 us for each m/s, 66 us for a single wheelset. Above it nothing blows up: creep "
        "saturates, the axles shake, and what is slow still looks right; the log says that it is not.",
        "RODAS5P and ROS34PW2 have no such limit. With fixed steps their error is what remains, and the log says when "
        "it exceeds the tolerance.",
        "On patches and strips, contact models 2 and 3, the limit is the same where creep is the fastest; at 60 m/s it "
        "is that of the wheelsets, which bounce on their contacts.",
        "At perfect rolling the law of creep has no unique slope (3.92): limits are taken under light braking.",
    ]
    parameters = tables_5_1_and_5_2().values() | {"speeds": atlas.speeds, "steps": STEPS, "drawbar_force": DRAWBAR}
    return Report(rows_of(atlas), series_of(atlas), lambda: draw(atlas), parameters, 0.0, remarks)


def series_of(atlas: Atlas) -> Recording:
    """Return the predicted largest stable steps over speed."""
    series = Recording({"speed": "m/s"}, [[speed] for speed in atlas.speeds])
    for (machine, method), steps in atlas.theory.items():
        series.add(f"largest stable step, {method}, {machine}", "s", np.array(steps))
    return series


# ---- the figure --------------------------------------------------------------------------------------------------


def draw(atlas: Atlas) -> Figure:
    figure, grid = plt.subplots(4, 2, figsize=(11.0, 15.0))
    parts = (draw_limits, draw_growth, draw_loads, draw_silent, draw_rest, draw_stops, draw_drift, draw_fold)
    for axis, part in zip(grid.ravel(), parts, strict=True):
        part(axis, atlas)
    return titled(figure, f"RK4 fails above {1e3 * limit(SPATIAL, 25.0):.2f} ms on the spatial bogie at 25 m/s")


def draw_limits(axis: Axes, atlas: Atlas) -> None:
    names = [one.name for one in (*MACHINES, PATCHES, STRIPS)]
    colours = dict(zip(names, (LEADING, "#e69f00", THESIS, TRAILING, BOGIE), strict=True))
    dashes = {"RK4": "-", "RK45": "--", "Euler": ":"}
    for (machine, method), steps in atlas.theory.items():
        axis.plot(
            atlas.speeds, steps, dashes[method], color=colours[machine], label=f"{method}, {machine}", linewidth=1.2
        )
    for machine, steps in atlas.found.items():
        axis.plot(atlas.tried, steps, "o", color=colours[machine], markersize=5)
    held = [
        (speed, step) for name, speed, step, factor in atlas.default_growth if name == SPATIAL.name and factor < 1.0
    ]
    axis.plot(*zip(*held, strict=True), "^", color=BOGIE, markersize=4, label="RODAS5P, tried and stable")
    axis.set(xscale="log", yscale="log", xlabel="speed [m/s]", ylabel="largest stable step [s]")
    axis.set_title("Largest stable step of explicit methods over speed")
    axis.legend(fontsize=7)


def draw_growth(axis: Axes, atlas: Atlas) -> None:
    shares = np.linspace(0.0, 1.3, 200)
    axis.plot(
        shares, np.abs(amplification_of_rk4(-shares * NEGATIVE_AXIS)), color=TRAILING, label="RK4, stability function"
    )
    for number, machine in enumerate(MACHINES):
        chosen = [one for one in atlas.growth if one[0] == machine.name]
        places = [one[2] + 0.012 * (number - 1) for one in chosen]
        axis.plot(places, [one[3] for one in chosen], "sod"[number], markersize=5, label=f"RK4, {machine.name}")
    axis.axhline(1.0, color="#999999", linewidth=0.8)
    axis.set(xlabel="step over the predicted limit", ylabel="growth of a perturbation in a step")
    axis.set_title("Growth at 0.9 and 1.1 of the limit, six speeds each")
    axis.legend(fontsize=8)


def draw_loads(axis: Axes, atlas: Atlas) -> None:
    for (name, (theory, found)), values, colour in zip(
        atlas.over.items(), (atlas.frictions, atlas.loads), (LEADING, TRAILING), strict=True
    ):
        axis.plot(values, 1e3 * np.array(theory), color=colour, label=f"over {name}")
        axis.plot(values[::3], 1e3 * np.array(found), "o", color=colour, markersize=5)
    axis.set(xlabel="friction coefficient, share of the sprung mass", ylabel="largest stable step of RK4 [ms]")
    axis.set_title(f"The same over friction and load at {SPEED_OF_LOADS:g} m/s, light braking")
    axis.legend(fontsize=8)


def draw_silent(axis: Axes, atlas: Atlas) -> None:
    for method, points in atlas.silent.items():
        steps, errors, warned = (np.array(column) for column in zip(*points, strict=True))
        axis.plot(1e3 * steps, 1e3 * errors, "-", color=COLOURS[method], label=NAMES[method], linewidth=1.2)
        axis.plot(1e3 * steps[~warned], 1e3 * errors[~warned], "o", color=COLOURS[method], markersize=5)
        axis.plot(1e3 * steps[warned], 1e3 * errors[warned], "x", color=COLOURS[method], markersize=7)
    axis.axvspan(
        *(1e3 * step for step in atlas.silent_limits), color=TRAILING, alpha=0.15, label="RK4's limit, 19-25 m/s"
    )
    axis.plot([], [], "x", color=BOGIE, label="the log reports it")
    axis.set(xscale="log", yscale="log", xlabel="fixed step [ms]", ylabel="error of the lateral motion [mm]")
    axis.set_title("The silent error: over a lateral wave under braking")
    axis.legend(fontsize=8)


def draw_rest(axis: Axes, atlas: Atlas) -> None:
    values, creeps, distances = np.array(atlas.rest).T
    axis.plot(values, 1e6 * creeps[2] * values / values[2], color=LEADING, label="proportional")
    axis.plot(values, 1e6 * creeps, "o", color=LEADING, label="slip of driven wheels at rest, 20 kN [um/s]")
    axis.plot(
        values[1:], 1e6 * np.abs(distances[1:] - distances[0]), "s-", color=TRAILING, label="change of the stop [um]"
    )
    axis.set(xscale="log", yscale="log", xlabel="creepage speed v_eps [m/s]", ylabel="slip [um/s], distance [um]")
    axis.set_title("Rest: what the regularisation of creepage costs")
    axis.legend(fontsize=8)


def draw_stops(axis: Axes, atlas: Atlas) -> None:
    floor = 1e-16
    for method, points in atlas.stops.items():
        good = [(step, max(speed, floor)) for step, speed, failure in points if not failure]
        bad = [step for step, _, failure in points if failure]
        if good:
            axis.plot(*zip(*good, strict=True), "o-", color=COLOURS[method], label=NAMES[method])
        if bad:
            axis.plot(
                bad, [1.0] * len(bad), "x", color=COLOURS[method], label=f"{NAMES[method]}: ended with a sentence"
            )
    axis.set(xscale="log", yscale="log", xlabel="fixed step [s]", ylabel="speed left at rest [m/s]")
    axis.set(ylim=(floor / 10, 10.0), title="Stop and 4.6 s of rest, point level: false equilibria?")
    axis.legend(fontsize=8)


def draw_drift(axis: Axes, atlas: Atlas) -> None:
    for partitioned, one in atlas.drifts.items():
        word, colour = ("with", LEADING) if partitioned else ("without", TRAILING)
        axis.plot(one.time, np.maximum(one.residual, 1e-17), color=colour, label=f"{word} partitioning, constraints")
        axis.plot(one.time, np.maximum(one.norm, 1e-17), ":", color=colour, label=f"{word}, Euler parameters")
    axis.set(yscale="log", xlabel="time [s]", ylabel="residual [m], norm less 1")
    axis.set_title("Chapter 3: drift of the constraints of a braked wheelset")
    axis.legend(fontsize=8)


def draw_fold(axis: Axes, atlas: Atlas) -> None:
    assert atlas.approach is not None
    one = atlas.approach
    axis.plot(one.time_left, one.curvature, "o", color=LEADING, markersize=4, label="found")
    axis.plot(one.time_left, one.fitted, color=TRAILING, label=f"power law, exponent {one.exponent:.3f}")
    axis.set(
        xscale="log", yscale="log", xlabel="time left to the fold [s]", ylabel="share of the rail's curvature left"
    )
    axis.set_title("The fold at derailment: 75 % error, leading wheelset")
    axis.legend(fontsize=8)


SCENARIO = Scenario("stability-atlas", "Limits of methods: stable steps, silent errors, drift, rest, the fold", run)
