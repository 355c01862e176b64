"""The fast model against chapter 3 of the thesis: the same three cases in both, and the cost of each."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from evidence.chapter3.kinematic_analysis import rolling
from evidence.chapter3.mechanism import FIRST_WHEELSET, Mechanism, MechanismInputs, MechanismState
from evidence.chapter3.program import run as run_program
from evidence.chapter3.program import spin
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import in_space, play, prepare
from rbd_model.contact.geometry import thesis_pair
from rbd_model.track.irregularity import derivatives_along, section_5_3
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_4_1_and_4_2, tables_5_1_and_5_2

#: Steps of the oracle and samples [s]; Runge-Kutta is unstable above 0.99 ms at 15 m/s and 0.8 ms at 25 m/s.
STEP, INTERVAL = 5e-4, 5e-3
TOLERANCE = 1e-9
#: Share of each duration in a quick run.
QUICK = 0.1


@dataclass(frozen=True)
class ComparedRun:
    """One comparison: the FMU and its number of wheelsets, start, track, constant inputs, and compared quantities."""

    name: str
    fmu: str
    wheelsets: int
    speed: float
    duration: float
    track: tuple[tuple[str, float], ...]
    brake_torque: tuple[float, float]


SCENES = (
    ComparedRun(
        "one wheelset hunting at 15 m/s",
        "wheelset",
        1,
        15.0,
        1.0,
        (("lateral_irregularity", 2e-3), ("lateral_wave_number", 0.2), ("irregularity_start", 1.0)),
        (0.0, 0.0),
    ),
    ComparedRun(
        "bogie braked with 20 kN.m over a lateral wave",
        "bogie",
        2,
        25.0,
        0.8,
        (("lateral_irregularity", 0.012), ("lateral_wave_number", 0.08), ("irregularity_start", 2.0)),
        (20e3, 20e3),
    ),
    ComparedRun(
        "leading wheelset braked with 60 kN.m: skid",
        "bogie",
        2,
        25.0,
        0.6,
        (("lateral_irregularity", 2e-3), ("lateral_wave_number", 0.2), ("irregularity_start", 1.0)),
        (60e3, 0.0),
    ),
)
RECORDED = ("lateral_1", "speed", "angular_velocity_1")


@dataclass(frozen=True)
class OracleOutcome:
    """Both models' series of one case, and the wall times of both [s]."""

    fast: Recording
    printed: Recording
    seconds: tuple[float, float]

    def difference(self, name: str) -> float:
        """Return the largest difference of a quantity over the case."""
        return float(np.abs(self.fast[name] - self.printed[name]).max())


def by_kernel(scene: ComparedRun) -> Recording:
    inputs = {f"brake_torque_{n}": [(0.0, scene.brake_torque[n - 1])] for n in range(1, scene.wheelsets + 1)}
    values = in_space(scene.fmu) | dict(scene.track) | AS_PRINTED
    kernel = prepare(scene.fmu, initial_speed=scene.speed, tolerance=TOLERANCE, **values)
    return play(scene.fmu, kernel, scene.duration, INTERVAL, RECORDED, inputs)


def by_chapter_3(scene: ComparedRun) -> Recording:
    """Run the oracle with exact contact ellipses and Kalker's table; lateral displacements from the track's centre."""
    parameters = as_printed(tables_4_1_and_4_2() if scene.wheelsets == 1 else tables_5_1_and_5_2())
    track = derivatives_along(replace(section_5_3(), **dict(scene.track)))
    mechanism = Mechanism(parameters, thesis_pair(), scene.wheelsets, track)
    inputs = MechanismInputs(brake_torque=scene.brake_torque)

    def row(state: MechanismState) -> list[float]:
        bodies = [mechanism.body(FIRST_WHEELSET + n) for n in range(scene.wheelsets)]
        leading = state.q[bodies[0]]
        speed = float(np.mean([state.q_rate[body][0] for body in bodies]))
        return [state.time, leading[1] - track(float(leading[0]))[0, 0], speed, spin(mechanism, state, 0)]

    state, every = rolling(mechanism, scene.speed), round(INTERVAL / STEP)
    rows = [row(state)]
    steps = run_program(mechanism, state, scene.duration, STEP, lambda time: inputs)
    bar = counting(steps, scene.name, round(scene.duration / STEP), unit="step")
    for number, state in enumerate(bar, 1):
        if number % every == 0:
            rows.append(row(state))
    return Recording({"time": "s", "lateral_1": "m", "speed": "m/s", "angular_velocity_1": "rad/s"}, rows)


def timed(work: Callable[[ComparedRun], Recording], scene: ComparedRun) -> tuple[Recording, float]:
    begin = time.perf_counter()
    found = work(scene)
    return found, time.perf_counter() - begin


def compare(scene: ComparedRun) -> OracleOutcome:
    by_kernel(scene)  # compiles and warms up
    fast, fast_seconds = timed(by_kernel, scene)
    printed, printed_seconds = timed(by_chapter_3, scene)
    return OracleOutcome(fast, printed, (fast_seconds, printed_seconds))


def run(options: Options, quick: bool = False) -> Report:
    scenes = [replace(scene, duration=QUICK * scene.duration) for scene in SCENES] if quick else SCENES
    outcomes = {scene: compare(scene) for scene in scenes}
    rows = []
    for scene, outcome in outcomes.items():
        source, cost = "chapter 3 as printed, not the thesis's figures", "measured now, once"
        largest = 1e3 * float(np.abs(outcome.printed["lateral_1"]).max())
        shift = f"{scene.name}: largest lateral shift"
        peak = 1e3 * float(np.abs(outcome.fast["lateral_1"]).max())
        asked = near(largest, 0.005 * largest)
        polynomials = "the fast model's polynomials for ellipse and Kalker's coefficients are within 0.5 %"
        difference = f"{scene.name}: difference of lateral shift"
        apart = 1e3 * outcome.difference("lateral_1")
        rows += [
            measured(shift, "mm", peak, source, asked, polynomials),
            measured(difference, "mm", apart, source, at_most(0.005 * largest)),
            measured(f"{scene.name}: difference of speed", "m/s", outcome.difference("speed"), source, at_most(1e-3)),
            measured(f"{scene.name}: time of the fast model", "s", outcome.seconds[0], cost),
            measured(f"{scene.name}: time of chapter 3", "s", outcome.seconds[1], cost),
        ]
    longest = next(iter(outcomes.values()))
    series = Recording({"time": "s"}, [[instant] for instant in longest.fast["time"]])
    for number, outcome in enumerate(outcomes.values(), 1):
        for word, one in (("fast", outcome.fast), ("chapter 3", outcome.printed)):
            for name in RECORDED:
                series.add_from(f"{name}, scene {number}, {word}", one, name)
    remark = (
        "The oracle has exact contact ellipses and Kalker's table with straight lines between its entries. With the "
        "fast model's polynomials in their place the two agree to 1e-9 in accelerations and forces, as the tests show."
    )
    seconds = sum(scene.duration for scene in outcomes)
    return Report(rows, series, lambda: draw(outcomes), {"step": STEP, "tolerance": TOLERANCE}, seconds, [remark])


def draw(outcomes: dict[ComparedRun, OracleOutcome]) -> Figure:
    figure, grid = plt.subplots(3, len(outcomes), sharex="col", figsize=(13.0, 8.0))
    for column, (scene, outcome) in enumerate(outcomes.items()):
        upper, middle, lower = grid[:, column]
        for axis, name, factor in ((upper, "lateral_1", 1e3), (middle, "angular_velocity_1", 1.0)):
            axis.plot(outcome.fast["time"], factor * outcome.fast[name], color=BOGIE, label="fast model")
            axis.plot(outcome.printed["time"], factor * outcome.printed[name], "--", color=TRAILING, label="chapter 3")
        upper.set_title(f"{scene.name}\nlateral displacement [mm]", fontsize=9)
        middle.ticklabel_format(useOffset=False)
        middle.set_title("angular velocity of the leading wheels [rad/s]", fontsize=9)
        gap = np.abs(outcome.fast["lateral_1"] - outcome.printed["lateral_1"])
        lower.semilogy(outcome.fast["time"], np.maximum(gap, 1e-12), color=BOGIE)
        lower.set_title("difference of lateral displacement [m]", fontsize=9)
        fast, printed = outcome.seconds
        lower.set_xlabel(f"time [s]; computed in {fast:.3f} s and {printed:.0f} s")
    grid[0, 0].legend(loc="upper left", fontsize=8)
    apart = 1e3 * max(outcome.difference("lateral_1") for outcome in outcomes.values())
    return titled(figure, f"The fast model keeps within {apart:.2g} mm of chapter 3 as printed")


SCENARIO = Scenario("oracle", "The fast model against chapter 3 of the thesis, three cases", run)
