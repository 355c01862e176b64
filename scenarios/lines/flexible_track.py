"""Largest wheel loads of a coach on rigid and on flexible rails, and the cost of both.

On rigid rails a wheelset that slides on its flange may vibrate at 180 Hz. Friction in proportion to the normal force
couples its bounce and its roll, whose frequencies are close, and only the assumed damping of the contacts stops the
vibration. Each case runs on both kinds of rails, with 0.5 to 2 times that damping.
"""

import time
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, TRAILING, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.kernel_runs import prepare_on_line
from rbd_model.track.line import Line, line_of, straight
from rbd_model.track.spectra import ERRI_LOW, irregular
from scenarios.bench.curves import into_curve, suited_speed

WHEELS = [f"{number}_{side}" for number in (1, 2, 3, 4) for side in ("left", "right")]
LOADS, QUOTIENTS = ([f"{name}_{wheel}" for wheel in WHEELS] for name in ("wheel_load", "derailment_quotient"))
#: Length of the curve, remaining length of the line ahead of the first wheelset [m]; interval of samples of a peak [s].
CURVE, LEFT, INTERVAL = 60.0, 25.0, 1e-3
#: Straight track astern of the first wheelset and ahead of it [m].
BEHIND, AHEAD = 30.0, 300.0
#: Dampings of the contacts [s/m], the assumed one first, and tolerance of their effect on peaks (and of the solver's).
DAMPINGS, BAND = (1.0, 0.5, 2.0), 0.02
#: Number of runs of which the least time counts; length that is drawn from the end of a case [m].
REPEATS, DRAWN = 2, 10.0
#: Name of the case whose wheel load is drawn; those of a quick run, which do not vibrate on rigid rails.
SHOWN, QUICK = "curve 300 m, friction 0.5", ("curve 800 m", "straight, braked")
RIGID, YIELDING = {"flexible_track": 0.0}, {"flexible_track": 1.0}


@dataclass(frozen=True)
class CoachRun:
    """A coach on a line: speed [m/s], duration [s], and values."""

    name: str
    line: Line
    speed: float
    duration: float
    values: dict[str, float] = field(default_factory=dict)

    def kernel(self, **values: float) -> Kernel:
        """Return the coach at its start."""
        return prepare_on_line(
            "vehicle", self.line, **{"level": 3.0, "initial_speed": self.speed} | self.values | values
        )


def curve(radius: float, cant: float, deficiency: float = 0.0, friction: float = 0.3, name: str = "") -> CoachRun:
    """Return straight track, a transition, and a curve at the speed of balanced cant plus a deficiency.

    Takes radius [m], cant, deficiency [m].
    """
    line, speed = into_curve(radius, cant, CURVE), suited_speed(radius, cant, deficiency)
    values = {"constant_speed": 1.0} | {f"friction_{number}": friction for number in (1, 2, 3, 4)}
    return CoachRun(name, line, speed, (line.length - LEFT) / speed, values)


def swerving(shift: float, length: float) -> Line:
    """Return a line whose rails move aside by `shift` [m] over a length [m], 20 m ahead."""
    distance = np.arange(-BEHIND, AHEAD, 0.25)
    share = np.clip((distance - 20.0) / length, 0.0, 1.0)
    aside = shift * share**3 * (10 - 15 * share + 6 * share**2)
    level = np.zeros_like(distance)
    rows = {"distance": distance, "curvature": level, "cant": level, "gradient": level}
    return Line(rows | {"left_lateral": aside, "right_lateral": aside})


def scenes() -> list[CoachRun]:
    """Return curves, and straight track: smooth, rough, and with a place where flanges meet their rails."""
    cant, smooth = 0.15, line_of([straight(BEHIND + AHEAD)], -BEHIND)
    braked = {f"brake_torque_{number}": 15e3 for number in (1, 2, 3, 4)}
    steady = {"constant_speed": 1.0}
    return [
        *(curve(radius, cant, name=f"curve {radius:g} m") for radius in (300.0, 800.0)),
        curve(300.0, cant, friction=0.5, name="curve 300 m, friction 0.5"),
        CoachRun("straight, braked", smooth, 25.0, 8.0, braked),
        CoachRun("straight, from 8 mm aside", smooth, 40.0, 4.0, steady | {"initial_lateral": 0.008}),
        CoachRun("straight, rough (ERRI low)", irregular(smooth, ERRI_LOW, 1), 40.0, 6.0, steady),
        CoachRun("straight, flange hits", swerving(0.015, 5.0), 30.0, 4.0, steady),
    ]


def peaks(scene: CoachRun, **values: float) -> np.ndarray:
    """Return the largest wheel load [N] and the largest Y/Q of all wheels."""
    table = scene.kernel(**values).record(scene.duration, INTERVAL, [*LOADS, *QUOTIENTS])
    return np.array([np.max([table[name] for name in names]) for names in (LOADS, QUOTIENTS)])


def seconds(scene: CoachRun, repeats: int, **values: float) -> float:
    """Return the processor time of a run, the least of several [s]."""
    taken = []
    for _ in range(repeats):
        kernel = scene.kernel(**values)
        kernel.initialise()
        start = time.process_time()
        kernel.advance(scene.duration)
        taken.append(time.process_time() - start)
    return min(taken)


@dataclass(frozen=True)
class RailsOutcome:
    """A case on rigid and on flexible rails: loads [N] by DAMPINGS, processor times [s]."""

    scene: str
    rigid: list[float]
    yielding: list[float]
    times: tuple[float, float]

    @property
    def error(self) -> float:
        """Return the relative error of the largest load on rigid rails, against flexible rails."""
        return abs(self.rigid[0] / self.yielding[0] - 1)

    @property
    def cost(self) -> float:
        """Return the time with flexible rails over the time with rigid ones."""
        return self.times[1] / self.times[0]

    @property
    def spread(self) -> tuple[float, float]:
        """Return the relative effect of the contact damping on the largest load on (rigid, flexible) rails."""
        first, second = ((max(loads) - min(loads)) / loads[0] for loads in (self.rigid, self.yielding))
        return first, second


def compare(scene: CoachRun, repeats: int) -> RailsOutcome:
    """Return the results of a case on both kinds of rails."""
    rigid, yielding = (
        [float(peaks(scene, contact_damping=damping, **rails)[0]) for damping in DAMPINGS]
        for rails in (RIGID, YIELDING)
    )
    return RailsOutcome(
        scene.name, rigid, yielding, (seconds(scene, repeats, **RIGID), seconds(scene, repeats, **YIELDING))
    )


def rows_of(outcome: RailsOutcome) -> list[Row]:
    """Return the rows. The limit requires that loads on flexible rails do not depend on the assumed damping."""
    (rigid, yielding), scene, most = outcome.spread, outcome.scene, at_most(1e2 * BAND)
    hangs, off = "largest wheel load hangs on contact damping by", "error of the largest wheel load on rigid rails"
    against = "rigid rails against flexible ones"
    return [
        measured(f"{scene}: {hangs}", "%", 1e2 * yielding, "flexible rails, 0.5 to 2 s/m", most),
        measured(f"{scene}: on rigid rails it hangs on that by", "%", 1e2 * rigid, "rigid rails"),
        measured(f"{scene}: {off}", "%", 1e2 * outcome.error, against),
        measured(f"{scene}: time of flexible rails over that of rigid ones", "1", outcome.cost, "processor"),
    ]


def shown_loads(scene: CoachRun) -> Recording:
    """Return the load of the outer leading wheel at the end of the case, on both kinds of rails [N]."""
    kept = DRAWN / scene.speed
    found = []
    for rails in (RIGID, YIELDING):
        kernel = scene.kernel(**rails)
        kernel.advance(scene.duration - kept)
        found.append(kernel.record(kept, INTERVAL / 4, ["wheel_load_1_right"]))
    both = zip(found[0]["time"], *(one["wheel_load_1_right"] for one in found), strict=True)
    return Recording({"time": "s", "rigid": "N", "yielding": "N"}, [list(row) for row in both])


def run(options: Options, quick: bool = False) -> Report:
    every = [scene for scene in scenes() if not quick or scene.name in QUICK]
    outcomes = [compare(scene, 1 if quick else REPEATS) for scene in counting(every, "flexible-track")]
    shown = next(scene for scene in every if scene.name == (QUICK[0] if quick else SHOWN))
    series = shown_loads(shown)
    rows = [row for outcome in outcomes for row in rows_of(outcome)]
    needed = [one.scene for one in outcomes if one.error > BAND]
    note = f"Loads on rigid rails are off by more than {1e2 * BAND:g} %: {'; '.join(needed)}."
    return Report(rows, series, partial(draw, series, outcomes, shown.name), {}, 0.0, [note])


def draw(series: Recording, outcomes: list[RailsOutcome], shown: str) -> Figure:
    needed = sum(outcome.error > BAND for outcome in outcomes)
    message = f"Loads on rigid rails are wrong in {needed} of {len(outcomes)} scenes"
    titles = {
        f"outer leading wheel [kN], {shown}": "along the curve [m]",
        "error of the largest wheel load on rigid rails [%]": "time with flexible rails, over time with rigid ones",
    }
    figure, (load, cost) = charts(message, titles, (11.0, 4.8), width_ratios=(1, 1.5))
    load.title.set_fontsize(10)
    way = (series["time"] - series["time"][0]) * DRAWN / (series["time"][-1] - series["time"][0])
    load.plot(way, series["rigid"] / 1e3, color=TRAILING, linewidth=0.8, label="rigid rails")
    load.plot(way, series["yielding"] / 1e3, color=LEADING, linewidth=2.4, label="flexible rails (default)")
    load.set_ylim(0.0)
    load.legend(loc="upper right")
    for number, one in enumerate(outcomes):
        cost.loglog(one.cost, 1e2 * one.error, "o", color=TRAILING if one.error > BAND else LEADING)
        aside = number % 2 == 1
        place = {"xytext": (-6 if aside else 6, 5), "ha": "right" if aside else "left"}
        cost.annotate(one.scene, (one.cost, 1e2 * one.error), textcoords="offset points", fontsize=8, **place)
    cost.axhspan(1e2 * BAND, 3e3, color=TRAILING, alpha=0.07)
    cost.axvline(1.0, color="#999999", linewidth=0.8)
    cost.set(ylim=(0.02, 3e3), xlim=(0.02, 6.0))
    cost.text(0.022, 1e2 * BAND * 1.15, "above: rigid rails are wrong", fontsize=8, color=TRAILING)
    return figure


SCENARIO = Scenario(
    "flexible-track",
    "Loads of a coach on rigid and on flexible rails, and the cost of both",
    run,
)
