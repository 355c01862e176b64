"""Error and cost of each level of detail: stops at rising adhesion utilisation, point and planar against spatial.

Adhesion utilisation: brake torques of both wheelsets over the wheel radius, over friction times both static axle
loads. The force on the rails is lower by 2 %, because a part of the torque stops the rotation of the wheelsets.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.optimize import bisect

from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario, Sweepable
from bogie_braking.reporting.timing import LEVELS, REPEATS, least
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.kernel_runs import AT_REST, RIGID, located_lock_time, play, prepare
from rbd_model.contact.geometry import contact_at, thesis_pair
from rbd_model.levels.models import DEFAULT_TOLERANCE
from rbd_model.vehicle.parameters import tables_5_1_and_5_2

INITIAL_SPEED, FRICTION = 25.0, 0.3
#: Time over which the brake torque grows linearly from 0 [s]; the cylinder of the experiment takes 0.8 s.
RAMP = 1.0
#: Utilisations, finer where a wheelset begins to lock: 0.70 at the planar and spatial levels, 1.02 at the point level.
UTILISATIONS = (
    *(0.2, 0.3, 0.4, 0.5, 0.6, 0.65, 0.68, 0.7, 0.71, 0.72, 0.75, 0.8, 0.85),
    *(0.9, 0.95, 0.98, 1.0, 1.01, 1.02, 1.03, 1.05, 1.1, 1.2, 1.3),
)
#: Ten times tighter than the default; changes no result by a hundredth of the differences of the levels (tested).
TOLERANCE = 1e-8
#: Recording interval [s]; between two rows a peak of the pitching load (3.8 Hz) is missed by 0.03 % of its height at
#: most.
INTERVAL = 2e-3
#: Width of the interval that encloses the lowest utilisation at which a wheelset locks.
RESOLUTION = 1e-4
#: Tolerance of the difference of two boundaries: the widths of their intervals, and effects of spin and suspension.
BOUNDARY_TOLERANCE = 3e-4
#: Utilisations of the stops whose cost is measured. In the first the wheels turn. In the second the trailing wheelset
#: skids, if the level models it.
COSTED = (0.5, 1.0)
#: Limits of the planar level's errors against the spatial one. Just above the utilisation that locks a wheelset the
#: lock time has an unbounded slope, and no level can meet a limit in seconds; from the last value on it can.
DISTANCE_BOUND, TIME_BOUND, TIME_BOUND_FROM = 0.15, 0.01, 0.9
#: Errors below, in the unit of each panel, are irrelevant.
SMALLEST_SHOWN = 1e-4
STYLES: dict[str, dict[str, Any]] = {
    "point": {"color": LEADING, "marker": "s", "markersize": 4},
    "planar": {"color": TRAILING, "marker": "o", "markersize": 4},
    "spatial": {"color": BOGIE, "linewidth": 4.0},
}
SOURCE = "levels against each other, not the thesis"


@dataclass(frozen=True)
class Answers:
    """Results of a stop in SI units; no lock time for a wheelset that turns until the bogie is at rest.

    load_transfer: the largest change of the leading axle load during braking.
    """

    stop_distance: float
    lock_time_1: float | None
    lock_time_2: float | None
    peak_slip_1: float
    peak_slip_2: float
    load_transfer: float


UNITS = dict(zip((field.name for field in fields(Answers)), ("m", "s", "s", "m/s", "m/s", "N"), strict=True))
#: Results whose errors are shown: name in words, unit of the error (% of the spatial level's value).
ERRORS = {
    "stop_distance": ("stop distance", "m"),
    "lock_time_2": ("lock time of the trailing wheelset", "s"),
    "peak_slip_2": ("peak slip of the trailing wheelset", "%"),
    "load_transfer": ("load transfer to the leading wheelset", "kN"),
}


def brake_torque(utilisation: float) -> float:
    """Return the torque on each wheelset [N.m]."""
    p = tables_5_1_and_5_2()
    weight = (p.frame_mass + 2 * p.wheelset_mass) * p.gravity
    return utilisation * FRICTION * weight * p.wheel_radius / 2


def duration(utilisation: float) -> float:
    """Return the time to simulate [s]: a skidding bogie takes up to a fifth longer than one that uses all of the
    torque.
    """
    return RAMP + 1.3 * INITIAL_SPEED / (min(utilisation, 1.0) * FRICTION * tables_5_1_and_5_2().gravity)


def start(level: int, tolerance: float = TOLERANCE, friction: float = FRICTION, **values: float) -> Kernel:
    """Return the bogie of chapter 5 at a level, not yet braked."""
    frictions = {"friction_1": friction, "friction_2": friction}
    # No flange touches on straight track, so that the simplest contact model suffices.
    place = RIGID | {"level": level, "tolerance": tolerance, "initial_speed": INITIAL_SPEED}
    return prepare("bogie", **place, **frictions, **values)


def brake(kernel: Kernel, utilisation: float, interval: float = INTERVAL) -> Recording:
    """Run from the initial speed to rest, with the same torque on both wheelsets."""
    inputs = {f"brake_torque_{n}": [(0.0, 0.0), (RAMP, brake_torque(utilisation))] for n in (1, 2)}
    read = ("speed", "distance", "slip_1", "slip_2", "axle_load_1")
    return play("bogie", kernel, duration(utilisation), interval, read, inputs)


def peak_slip(series: Recording, number: int, locked: float | None) -> float:
    """Return the largest slip of a wheelset while the bogie moves [m/s]; if it locks, the speed at that time."""
    recorded = float(series[f"slip_{number}"][series["speed"] > AT_REST].max())
    return recorded if locked is None else max(recorded, float(np.interp(locked, series["time"], series["speed"])))


def stop(kernel: Kernel, utilisation: float) -> Answers:
    """Brake to rest. Slip and load are evaluated while the bogie moves, not while it rocks afterwards."""
    series = brake(kernel, utilisation)
    leading, trailing = (located_lock_time(kernel, series, number) for number in (1, 2))
    slips = peak_slip(series, 1, leading), peak_slip(series, 2, trailing)
    load = series["axle_load_1"][series["speed"] > AT_REST]
    return Answers(float(series["distance"][-1]), leading, trailing, *slips, float((load - load[0]).max()))


def sweep(utilisations: Sequence[float]) -> dict[str, list[Answers]]:
    """Return the stops of each level."""
    asked = [(level, utilisation) for level in LEVELS for utilisation in utilisations]
    bar = counting(asked, "stops", unit="stop")
    found = [stop(start(level), utilisation) for level, utilisation in bar]
    count = len(utilisations)
    return {name: found[i * count : (i + 1) * count] for i, name in enumerate(LEVELS.values())}


def lock_boundary(level: int, number: int, **values: float) -> float | None:
    """Return the least utilisation that locks a wheelset before the bogie is at rest; None if the highest does not."""

    def sign(utilisation: float) -> float:
        kernel = start(level, **values)
        return -1.0 if located_lock_time(kernel, brake(kernel, utilisation), number) is None else 1.0

    low, high = min(UTILISATIONS), max(UTILISATIONS)
    return float(bisect(sign, low, high, xtol=RESOLUTION)) if sign(high) > 0.0 else None


def adhesion_of_the_cone() -> float:
    """Return the adhesion limit of the spatial level over that of the others: the rail force is normal to the cone."""
    return 1.0 / math.cos(contact_at(thesis_pair(), 0.0).angle[0])


def cost(level: int, utilisation: float, repeats: int) -> float:
    """Return the time of one stop at the default tolerance, recorded at its end only; the least of several [s]."""
    kernel = start(level, DEFAULT_TOLERANCE)

    def once() -> None:
        kernel.reopen()
        brake(kernel, utilisation, duration(utilisation))

    return least(once, repeats)


def column(stops: Sequence[Answers], question: str) -> np.ndarray:
    """Return one result of each stop; NaN if it is missing."""
    return np.array([getattr(one, question) for one in stops], dtype=float)


def error(stops: Sequence[Answers], spatial: Sequence[Answers], question: str) -> np.ndarray:
    """Return the difference of each result from the spatial level's, in the unit of ERRORS; NaN if one of them is
    missing.
    """
    reference = column(spatial, question)
    distance = np.abs(column(stops, question) - reference)
    scale = {"%": 100.0 / reference, "kN": 1e-3}.get(ERRORS[question][1], 1.0)
    return np.asarray(scale * distance)


@dataclass(frozen=True)
class LevelComparison:
    """All measurements. `cone`: planar stops with the friction that gives the adhesion limit of the cone.

    boundaries: of the leading and the trailing wheelset; costs: seconds by level and utilisation.
    """

    utilisations: Sequence[float]
    stops: Mapping[str, Sequence[Answers]]
    cone: Sequence[Answers]
    boundaries: Mapping[str, tuple[float | None, float | None]]
    costs: Mapping[str, Mapping[float, float]]

    def largest_error(self, stops: Sequence[Answers], question: str, low: float = 0.0, high: float = math.inf) -> float:
        """Return the largest error over the utilisations from low to high."""
        chosen = (np.array(self.utilisations) >= low) & (np.array(self.utilisations) <= high)
        return float(np.nanmax(error(stops, self.stops["spatial"], question)[chosen]))

    def trailing_boundary(self, level: str) -> float:
        """Return the least utilisation that locks the trailing wheelset; every level has one."""
        limit = self.boundaries[level][1]
        assert limit is not None
        return limit


def measure(
    utilisations: Sequence[float] = UTILISATIONS, costed: Sequence[float] = COSTED, repeats: int = REPEATS
) -> LevelComparison:
    stops = sweep(utilisations)
    friction = FRICTION * adhesion_of_the_cone()
    cone = [stop(start(2, friction=friction), utilisation) for utilisation in utilisations]
    boundaries = {name: (lock_boundary(level, 1), lock_boundary(level, 2)) for level, name in LEVELS.items()}
    costs = {
        name: {utilisation: cost(level, utilisation, repeats) for utilisation in costed}
        for level, name in LEVELS.items()
    }
    return LevelComparison(utilisations, stops, cone, boundaries, costs)


def run(options: Options, quick: bool = False) -> Report:
    found = measure(repeats=1 if quick else REPEATS)
    series = Recording({"utilisation": "1"}, [[utilisation] for utilisation in UTILISATIONS])
    for name, stops in found.stops.items():
        for question, unit in UNITS.items():
            series.add(f"{question}_{name}", unit, column(stops, question))
    rows = boundary_rows(found) + error_rows(found) + cost_rows(found)
    parameters = tables_5_1_and_5_2().values() | {
        "friction": FRICTION,
        "initial_speed": INITIAL_SPEED,
        "ramp": RAMP,
        "tolerance": TOLERANCE,
    }
    seconds = len(LEVELS) * sum(duration(utilisation) for utilisation in UTILISATIONS)
    return Report(rows, series, lambda: draw(found), parameters, seconds, remarks(found))


def boundary_rows(found: LevelComparison) -> list[Row]:
    """Return the least utilisation that locks each wheelset."""
    rows = []
    for name, limits in found.boundaries.items():
        why = "static loads: both alike" if name == "point" else f"load moves forward; -: not up to {max(UTILISATIONS)}"
        for wheelset, limit in zip(("leading", "trailing"), limits, strict=True):
            rows.append(measured(f"{name}: {wheelset} wheelset locks from utilisation", "1", limit, SOURCE, None, why))
    planar, spatial = found.trailing_boundary("planar"), found.trailing_boundary("spatial")
    quantity, why = (
        "planar: locks the trailing wheelset earlier by",
        "adhesion limit of a level rail and of a 1:20 cone",
    )
    # Load transfer takes a part of the additional rail force: the boundary grows by as much less as it is lower.
    share = (adhesion_of_the_cone() - 1.0) * planar / found.trailing_boundary("point")
    rows.append(measured(quantity, "1", spatial - planar, SOURCE, near(share * spatial, BOUNDARY_TOLERANCE), why))
    return rows


def error_rows(found: LevelComparison) -> list[Row]:
    """Return the largest differences from the spatial level."""
    point, planar = found.stops["point"], found.stops["planar"]
    lowest = found.trailing_boundary("planar")
    always, turning, late = (0.0, math.inf), (0.0, lowest), (TIME_BOUND_FROM, math.inf)
    spin = "the spin of the 1:20 cone costs creep"
    slope = "not judged: the lock time has no bound on its slope at the boundary"
    friction = f"friction {adhesion_of_the_cone():.5f} times as large: what the cone adds to the adhesion limit"
    where = {turning: ", no lock-up", late: f", from utilisation {TIME_BOUND_FROM} on", always: ""}
    asked = (
        ("planar", planar, "stop_distance", always, DISTANCE_BOUND, "locked or not"),
        ("planar", planar, "lock_time_2", late, TIME_BOUND, "near the boundary it has no bound, see below"),
        ("planar", planar, "lock_time_2", always, None, slope),
        ("planar", planar, "peak_slip_2", turning, None, spin),
        ("planar", planar, "load_transfer", always, None, ""),
        ("planar, adhesion of the cone", found.cone, "stop_distance", always, None, friction),
        ("planar, adhesion of the cone", found.cone, "lock_time_2", always, None, friction),
        ("point", point, "stop_distance", turning, DISTANCE_BOUND, ""),
        ("point", point, "stop_distance", always, None, "misses the lock-up, so that it stops too early"),
        ("point", point, "lock_time_2", always, None, "where both levels lock it"),
        ("point", point, "peak_slip_2", turning, None, ""),
        ("point", point, "load_transfer", always, None, "all of it: static loads"),
    )
    rows = []
    for name, stops, question, span, bound, note in asked:
        words, unit = ERRORS[question]
        largest, limit = found.largest_error(stops, question, *span), None if bound is None else at_most(bound)
        rows.append(measured(f"{name}: largest error of {words}{where[span]}", unit, largest, SOURCE, limit, note))
    return rows


def cost_rows(found: LevelComparison) -> list[Row]:
    rows = []
    for name, costs in found.costs.items():
        for utilisation, seconds in costs.items():
            note = f"{duration(utilisation):.1f} s simulated at the default tolerance, {DEFAULT_TOLERANCE:g}"
            quantity = f"{name}: cost of the stop at utilisation {utilisation}"
            rows.append(measured(quantity, "ms", 1e3 * seconds, "measured now, least of several runs", None, note))
    return rows


def remarks(found: LevelComparison) -> list[str]:
    """Return the conclusions of the figure."""
    limit = {name: found.trailing_boundary(name) for name in LEVELS.values()}
    point, planar = found.stops["point"], found.stops["planar"]
    short, off = (found.largest_error(stops, "stop_distance") for stops in (point, planar))
    right = found.largest_error(point, "stop_distance", high=limit["planar"])
    slip = found.largest_error(point, "peak_slip_2", high=limit["planar"])
    cost = {name: f"{1e3 * costs[COSTED[0]]:.2g} ms" for name, costs in found.costs.items()}
    cone = 100 * (adhesion_of_the_cone() - 1)
    return [
        f"From utilisation {limit['spatial']:.3f} to {limit['point']:.3f} the point level misses the lock-up of the "
        "trailing wheelset; above, it locks the leading one as well, which goes on turning at the other levels. Its "
        f"stops are up to {short:.1f} m too short. Below, they are right to {right:.3f} m, and its peak slip is up to "
        f"{slip:.0f} % off.",
        f"The planar level's stops are right to {off:.3f} m. Its rail is level: on the 1:20 cone of the spatial level "
        f"the normal force is {cone:.3f} % above the load, and so is the adhesion limit.",
        f"The stop at utilisation {COSTED[0]} costs {cost['point']} at the point, {cost['planar']} at the planar and "
        f"{cost['spatial']} at the spatial level.",
    ]


def draw(found: LevelComparison) -> Figure:
    figure, grid = plt.subplots(3, 2, figsize=(10.0, 9.6))
    axes = list(grid.ravel())
    draw_lock_times(axes[0], found)
    bounds = {"lock_time_2": TIME_BOUND, "stop_distance": DISTANCE_BOUND}
    for axis, question in zip(axes[1:5], ("lock_time_2", "stop_distance", "peak_slip_2", "load_transfer"), strict=True):
        draw_errors(axis, found, question, bounds.get(question))
    band = found.trailing_boundary("spatial"), found.trailing_boundary("point")
    for axis in axes[:5]:
        axis.axvspan(*band, color="#999999", alpha=0.15)
        axis.set(xlim=(min(UTILISATIONS) - 0.02, max(UTILISATIONS) + 0.02), xlabel="adhesion utilisation [1]")
    axes[0].annotate(
        "point\nmisses the\nlock-up", (sum(band) / 2, 0.97), ha="center", va="top", xycoords=("data", "axes fraction")
    )
    draw_costs(axes[5], found)
    point, planar = (found.largest_error(found.stops[name], "stop_distance") for name in ("point", "planar"))
    return titled(figure, f"Where wheelsets lock, point errs by {point:.0f} m, planar by {planar:.2f} m")


def draw_lock_times(axis: Axes, found: LevelComparison) -> None:
    """Draw the lock times; spatial is the broad line below planar."""
    for name in ("spatial", "planar", "point"):
        label = f"{name}, both" if name == "point" else f"{name}, trailing"
        axis.plot(UTILISATIONS, column(found.stops[name], "lock_time_2"), label=label, **STYLES[name])
    axis.set_title("wheelset locks after [s]")
    axis.legend(loc="lower left")


def draw_errors(axis: Axes, found: LevelComparison, question: str, bound: float | None) -> None:
    """Draw the differences of point and planar from spatial, and the limit of planar."""
    words, unit = ERRORS[question]
    for name in ("point", "planar"):
        axis.plot(UTILISATIONS, error(found.stops[name], found.stops["spatial"], question), **STYLES[name])
    axis.set_yscale("log")
    axis.yaxis.set_major_formatter("{x:g}")
    axis.set_ylim(bottom=max(axis.get_ylim()[0], SMALLEST_SHOWN))
    axis.set_title(f"error of {words} [{unit}]")
    if bound is not None:
        axis.axhline(bound, color=BOGIE, linewidth=0.8, linestyle=":")
        axis.annotate(f"{bound} {unit}", (min(UTILISATIONS), bound), xytext=(0, 3), textcoords="offset points")


def draw_costs(axis: Axes, found: LevelComparison) -> None:
    """Draw bars, one for each stop."""
    bars = [(name, *item) for name, costs in found.costs.items() for item in costs.items()]
    for place, (name, utilisation, seconds) in enumerate(bars):
        axis.barh(-place, 1e3 * seconds, color=STYLES[name]["color"])
        text = f"{1e3 * seconds:.2g} ms, {duration(utilisation):.0f} s simulated"
        axis.annotate(text, (1e3 * seconds, -place), xytext=(3, -3), textcoords="offset points", fontsize=8)
    axis.set_yticks(-np.arange(len(bars)), [f"{name} {utilisation}" for name, utilisation, _ in bars])
    axis.set_xscale("log")
    costs = [1e3 * seconds for *_, seconds in bars]
    axis.set_xlim(0.5 * min(costs), 50 * max(costs))
    axis.xaxis.set_major_formatter("{x:g}")
    axis.grid(axis="y", visible=False)
    axis.set_title("cost of one stop at utilisation {} and {} [ms]".format(*COSTED))


def one_stop(
    utilisation: float = 1.0, level: float = 2.0, frame_height: float = tables_5_1_and_5_2().frame_height
) -> dict[str, float | None]:
    """Return the results of a stop at one adhesion utilisation.

    Takes frame_height [m].
    """
    if not utilisation > 0.0:
        raise ValueError(f"The adhesion utilisation of a stop must be above 0; got {utilisation:g}.")
    if level not in LEVELS:
        raise ValueError(f"There is no level {level:g}; take {', '.join(f'{n} ({LEVELS[n]})' for n in LEVELS)}.")
    return asdict(stop(start(int(level), frame_height=frame_height), utilisation))


SWEEP = Sweepable({"utilisation": "1", "level": "1", "frame_height": "m"}, UNITS, one_stop)
SCENARIO = Scenario(
    "levels",
    "Point and planar level against the spatial one over adhesion utilisation, and their cost",
    run,
    sweep=SWEEP,
)
