"""Speed against accuracy: eight cases, two with contact models 2 and 3; our methods, SciPy's and SUNDIALS'."""

import time as clock
from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import label_edges, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from bogie_braking.reporting.timing import REPEATS, least
from evidence.measuring.runs import own
from evidence.measuring.scenes import (
    ASYMMETRIC,
    LOCK_UP,
    ON_PATCHES,
    ON_STRIPS,
    SCENES,
    SMOOTH,
    STANDING,
    Scene,
    difference,
)
from evidence.peers import sundials
from evidence.peers.exchange import EXCHANGE
from evidence.peers.work_precision import (
    DEFAULT,
    OMITTED,
    PEERS,
    MethodPoint,
    WorkPrecision,
    oracle_point,
    study,
    table_of,
    works,
)
from rbd_model.levels.models import DEFAULT_TOLERANCE
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

#: Relative error of peak lateral displacement, stop time and distance that a user needs.
WANTED = 1e-4
#: Limit of the error at the default tolerance: a tenth of the needed one.
EXPECTED = 1e-5
#: The project's reference stop [s]: 20 kN.m on both wheelsets from 25 m/s.
STOP = replace(STANDING, name="22.9 s stop", duration=22.9)
#: Tolerances of that stop: 1 ms of 16.9 s, 1 mm of 211 m; and of the peak over flange contact: 0.01 mm of 1.57 mm.
STOP_TIME, DISTANCE, PEAK = 1e-3, 1e-3, 1e-5
#: Communication steps of a host, those of a quick run [s].
HOST_STEPS, QUICK_HOST_STEPS = (1e-3, 5e-3, 1e-2), (1e-2,)
#: Tolerances at which CVODE and IDA run through the stop, one after the other; those of a quick run.
TOLERANCES, QUICK_TOLERANCES = 2 * (1e-4, 1e-5, 1e-6, 1e-7), (1e-6,)
#: Style of each line: colour, marker, dashes. Ours are filled and thick, third-party ones open.
STYLE = {
    DEFAULT: ("#0072b2", "o", "-"),
    "ROS34PW2": ("#56b4e9", "s", "-"),
    "RODAS5P, fixed step": ("#0072b2", "o", ":"),
    "ROS34PW2, fixed step": ("#56b4e9", "s", ":"),
    "RK4, fixed step": ("#cc79a7", "^", ":"),
    "RK45 (SciPy)": ("#cc79a7", "v", "--"),
    "Radau (SciPy)": ("#999999", "D", "--"),
    "BDF (SciPy)": ("#999999", "P", "--"),
    "LSODA (SciPy)": ("#333333", "X", "--"),
    "CVODE": ("#d55e00", "h", "--"),
    "IDA": ("#e69f00", "p", "--"),
    EXCHANGE: ("#d55e00", "d", ":"),
    "level point": ("#009e73", "1", ""),
    "level planar": ("#009e73", "2", ""),
    "native FMU": ("#000000", "+", "-"),
    "python FMU": ("#000000", "x", ":"),
    "chapter 3 as printed": ("#009e73", "*", ""),
}


def all_studies(
    short: bool = False, scenes: tuple[Scene, ...] = (*SCENES, ON_PATCHES, ON_STRIPS)
) -> list[WorkPrecision]:
    """Return the studies of all cases, with a bar; `short`: one setting of each method."""
    total = sum(len(list(works(scene, short))) for scene in scenes)
    with counting(total=total, text="runs", unit="run") as bar:

        def done(scene: Scene, name: str) -> None:
            bar.set_postfix_str(f"{scene.name}, {name}")
            bar.update()

        found = [study(scene, short, partial(done, scene)) for scene in scenes]
    if not short and SMOOTH in scenes:
        found[scenes.index(SMOOTH)].points.append(oracle_point())
    return found


def scene_rows(one: WorkPrecision) -> list[Row]:
    """Return the default's error at its own tolerance, with a limit; and the fastest method at the needed error, with
    its lead.
    """
    name, source = one.scene.name, f"reference {one.references[0]}, uncertain by {one.uncertainty:.1e}"
    default = one.at(DEFAULT, DEFAULT_TOLERANCE)
    of_default, words = f"{name}: error of the default", "relative, the largest"
    rows = [
        measured(of_default, "1", default.error, source, at_most(EXPECTED), words),
        measured(f"{name}: time of the default", "ms", 1e3 * default.seconds, "measured now"),
    ]
    for setting, word in ((1e-4, "at 1e-4"), (1e-5, "at 1e-5")):
        for point in one.of(DEFAULT):
            if point.setting == setting:
                rows.append(measured(f"{name}: error of RODAS5P {word}", "1", point.error, source))
                share = point.seconds / default.seconds
                rows.append(measured(f"{name}: time {word} over the default's", "1", share, "measured now"))
    ours, other = one.fastest([DEFAULT], WANTED), one.fastest(PEERS, WANTED)
    if ours and other:
        words = f"{other.method} at {other.setting:g}: {1e3 * other.seconds:.1f} ms, error {other.error:.1e}"
        ratio = other.seconds / ours.seconds
        quantity = f"{name}: best peer's time over ours, at {WANTED:g}"
        rows.append(measured(quantity, "1", ratio, "measured now", None, words))
        ratio = other.seconds / default.seconds
        quantity = f"{name}: best peer's time to {WANTED:g} over the default's"
        rows.append(measured(quantity, "1", ratio, "measured now"))
    exchanged, planar = one.fastest([EXCHANGE], WANTED), one.of("level planar")
    if exchanged and planar:
        words = f"{exchanged.method} at {exchanged.setting:g}: {1e3 * exchanged.seconds:.0f} ms"
        ratio = exchanged.seconds / planar[0].seconds
        quantity = f"{name}: time of model exchange over that of co-simulation, in the plane"
        rows.append(measured(quantity, "1", ratio, "measured now", None, words))
    return rows


def stop_rows(quick: bool) -> list[Row]:
    """Return the stop in one long step, its errors, and CVODE at about equal error."""
    exact = STOP.measure(own(STOP, tolerance=1e-11).samples)
    found = STOP.measure(own(STOP).samples)
    late, beyond = (found[name] - exact[name] for name in ("stop time", "distance"))
    kernel = STOP.kernel()
    repeats = 1 if quick else REPEATS
    seconds = least(lambda: one_step(STOP), repeats) - least(lambda: STOP.kernel(), repeats)
    rows = [
        measured("22.9 s stop in one doStep", "s", seconds, "measured now; to reach 0.03"),
        measured("22.9 s stop: times real time", "1", STOP.duration / seconds, "measured now; to reach 760"),
        measured("22.9 s stop: error of stop time", "s", late, "RODAS5P 1e-11", near(0.0, STOP_TIME)),
        measured("22.9 s stop: error of distance", "m", beyond, "RODAS5P 1e-11", near(0.0, DISTANCE)),
    ]
    rows += sundials_stop_rows(exact, difference(found, exact), QUICK_TOLERANCES if quick else TOLERANCES)
    kernel.step(0.0, 1e-3)
    count = 4000
    begin = clock.perf_counter()
    kernel.repeat_step(1e-3, count)
    host = (clock.perf_counter() - begin) / count
    rows.append(measured("host step of 1 ms, spatial", "us", 1e6 * host, "measured now; to reach 20"))
    flange = own(ASYMMETRIC)
    peak = ASYMMETRIC.measure(flange.samples)["peak lateral"]
    tight = ASYMMETRIC.measure(own(ASYMMETRIC, tolerance=1e-9).samples)["peak lateral"]
    words = "flange contact and rotating yaw torque"
    rows += [
        measured(f"{words}: time", "s", flange.seconds, "measured now; to reach 0.2"),
        measured(f"{words}: error of the peak", "mm", 1e3 * (peak - tight), "RODAS5P 1e-9", near(0.0, 1e3 * PEAK)),
    ]
    return rows


def sundials_stop_rows(exact: dict[str, float], ours: float, tolerances: Sequence[float]) -> list[Row]:
    """Return the fastest run of CVODE and of IDA through the stop with an error of at most `EXPECTED`, at any
    tolerance.
    """
    rows = []
    for method in sundials.METHODS if sundials.is_installed() else ():
        runs = [(sundials.sundials(STOP, method, value), value) for value in tolerances]
        errors = [(run, value, difference(STOP.measure(run.samples), exact)) for run, value in runs if run.samples]
        good = [(run.seconds, value, error) for run, value, error in errors if error <= EXPECTED]
        if good:
            seconds, value, error = min(good)
            words = f"tolerance {value:g}, relative error {error:.1e}; ours {ours:.1e}"
            rows.append(measured(f"22.9 s stop: {method}", "s", seconds, "measured now", None, words))
    return rows


def one_step(scene: Scene) -> None:
    scene.kernel().step(0.0, scene.duration)


def host_rows(steps: Sequence[float]) -> list[Row]:
    """Return the cost of a torque that changes at each communication step.

    The rows compare our kernel with CVODE, which restarts at each step, at the same tolerance and at a looser one.
    """
    rows = []
    for step in steps:
        exact = sundials.hosted_seconds("own", step, 1e-10)[1]
        found = {}
        for method, tolerance in (("own", DEFAULT_TOLERANCE), ("CVODE", DEFAULT_TOLERANCE), ("CVODE", 1e-3)):
            runs = [sundials.hosted_seconds(method, step, tolerance) for _ in range(3)]
            seconds, distance = min(runs)
            words = f"tolerance {tolerance:g}, relative error of the distance {abs(distance / exact - 1):.1e}"
            found[method, tolerance] = seconds
            name = {"own": "default", "CVODE": "CVODE anew"}[method]
            what = f"new torque each {1e3 * step:g} ms: {name}, {tolerance:g}"
            rows.append(measured(what, "us", 1e6 * seconds, "measured now, one host step", None, words))
        ratio = min(found["CVODE", DEFAULT_TOLERANCE], found["CVODE", 1e-3]) / found["own", DEFAULT_TOLERANCE]
        rows.append(measured(f"new torque each {1e3 * step:g} ms: CVODE over ours", "1", ratio, "measured now"))
    return rows


def failures(studies: list[WorkPrecision]) -> list[str]:
    """Return one message for each failure."""
    return [
        f"{one.scene.name}, {point.method} at {point.setting:g}: {point.reason.rstrip('.')}."
        for one in studies
        for point in one.points
        if point.error is None and not point.reason.startswith("not tried")
    ]


def run(options: Options, quick: bool = False) -> Report:
    begin = clock.perf_counter()
    studies = all_studies(True, (LOCK_UP,)) if quick else all_studies()
    rows = [row for one in studies for row in scene_rows(one)] + stop_rows(quick)
    if sundials.is_installed():
        rows += host_rows(QUICK_HOST_STEPS if quick else HOST_STEPS)
    remarks = [OMITTED, *failures(studies)]
    if not sundials.is_installed():
        remarks.insert(0, "CVODE and IDA are missing: install the extra 'charts' with Python 3.11 or later.")
    parameters = tables_5_1_and_5_2().values() | {
        "default_tolerance": DEFAULT_TOLERANCE,
        "points": [asdict(point) | {"scene": one.scene.name} for one in studies for point in one.points],
        "uncertainty": {one.scene.name: one.uncertainty for one in studies},
    }
    simulated = sum(one.scene.duration * len(one.points) for one in studies)
    units = {"setting": "1", "error": "1", "seconds": "s", "right_hand_sides": "1"}
    series = table_of([point for one in studies for point in one.points], units)
    report = Report(rows, series, lambda: draw(studies, "seconds"), parameters, simulated, remarks)
    report.other_figures["right-hand-sides"] = lambda: draw(studies, "right_hand_sides")
    report.parameters = dict(parameters) | {"study_seconds": clock.perf_counter() - begin}
    return report


# ---- the figure --------------------------------------------------------------------------------------------------


def draw(studies: list[WorkPrecision], against: str) -> Figure:
    lines = -(-len(studies) // 2)
    figure, grid = plt.subplots(lines, 2, figsize=(11.0, 1.3 + 3.9 * lines), sharey=True, squeeze=False)
    handles: dict[str, Artist] = {}
    for axis, one in zip(grid.ravel(), studies, strict=False):
        draw_scene(axis, one, against, handles)
    for axis in grid.ravel()[len(studies) :]:
        axis.set_axis_off()
    label_edges(
        grid,
        {"seconds": "wall time [s]", "right_hand_sides": "right-hand sides"}[against],
        "relative error (top: failed)",
    )
    shown = [name for name in STYLE if name in handles]
    figure.legend([handles[name] for name in shown], shown, loc="outside lower center", ncols=4, fontsize=9)
    return titled(figure, message(studies, against))


def message(studies: list[WorkPrecision], against: str) -> str:
    """Return the title: the cost of the fastest peers over that of the default at the needed error, over all cases."""
    fastest = ((one.fastest([DEFAULT], WANTED), one.fastest(PEERS, WANTED)) for one in studies)
    times = [getattr(peer, against) / getattr(own, against) for own, peer in fastest if own and peer]
    words = {"seconds": "time", "right_hand_sides": "evaluations"}[against]
    if not times:
        return f"No peer reaches an error of {WANTED:g} here"
    return f"To errors of {WANTED:g} peers take {min(times):.1f} to {max(times):.1f} times our {words}"


#: Error at which failures are drawn, and the least error shown.
FAILED, LEAST = 3.0, 1e-11


def draw_scene(axis: Axes, one: WorkPrecision, against: str, handles: dict[str, Artist]) -> None:
    axis.set_title(f"{one.scene.name}:\n{one.scene.stress}")
    axis.axhspan(LEAST, max(one.uncertainty, LEAST), color="#dddddd", zorder=0)
    axis.axhline(WANTED, color="#999999", linewidth=0.8)
    for name, (colour, marker, dashes) in STYLE.items():
        points = [p for p in one.of(name) if getattr(p, against) > 0]
        good = sorted((p for p in points if p.error is not None), key=lambda p: -p.setting)
        bad = [p for p in points if p.error is None and not p.reason.startswith("not tried")]
        if not points:
            continue
        mine = name in (DEFAULT, "ROS34PW2")
        (line,) = axis.plot(
            [getattr(p, against) for p in good],
            [min(max(p.error or LEAST, LEAST), FAILED / 2) for p in good],
            linestyle=dashes or "none",
            marker=marker,
            color=colour,
            linewidth=2.2 if name == DEFAULT else 1.0,
            markersize=6 if mine else 5,
            markerfacecolor=colour if mine else "none",
            zorder=3 if mine else 2,
        )
        axis.plot([getattr(p, against) for p in bad], [FAILED] * len(bad), marker, color=colour, markersize=5)
        handles.setdefault(name, line)
    mark_default(axis, one.at(DEFAULT, DEFAULT_TOLERANCE), against)
    axis.set(xscale="log", yscale="log", ylim=(LEAST, 2 * FAILED))


def mark_default(axis: Axes, point: MethodPoint, against: str) -> None:
    if point.error is None:
        return
    axis.plot(getattr(point, against), max(point.error, LEAST), "o", color="#0072b2", markersize=12, fillstyle="none")


SCENARIO = Scenario("speed-accuracy", "Eight cases: error against wall time, our methods, SciPy's and SUNDIALS'", run)
