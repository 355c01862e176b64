"""One bogie under half a body, or the complete vehicle: the error of the half, and the cost of each."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import LEADING, THREE, TRAILING, plt, titled
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from bogie_braking.reporting.timing import LEVELS, least
from fmu_src.cosimulation.recording import Recording
from fmu_src.kernel import Kernel
from products.coach import COACH, NUMBERS
from products.kernel_runs import located_lock_time, play, prepare
from products.machine import coach
from rbd_model.vehicle.parameters import one_bogie_of
from scenarios.bench.four_axles import rigid_axle_loads

SPEED, PLANAR = 30.0, 2
#: Ramp of each brake's torque, simulated time, start of the evaluation and recording interval [s].
RAMP, DURATION, SETTLED, INTERVAL = 1.0, 8.0, 6.0, 0.02
#: Wheel-rail friction, and torques as shares of the adhesion limit under static loads.
FRICTIONS, SHARES = (0.05, 0.10, 0.20), (0.2, 0.4, 0.6, 0.8, 0.9, 0.95)
#: Shares that enclose the least one that locks a wheelset before rest, and the resolution. The torque grows over a long
#: ramp [s], so that nothing rocks.
LOWEST, HIGHEST, RESOLUTION, SLOW_RAMP = 0.5, 1.1, 5e-4, 6.0
#: Tolerance against rigid statics: the vehicle leans a little. The whole and the half differ by more.
BAND = 2e-3
#: Tolerance of one bogie: relative error of the distance, while no wheel locks.
DISTANCE = 1e-3
WHOLE = "vehicle"
ONE = "bogie"
VALUES: dict[str, dict[str, float]] = {
    WHOLE: {"secondary_bending_stiffness": 0.0},
    ONE: dict(one_bogie_of(COACH).values()),
}
OWN = {WHOLE: NUMBERS, ONE: NUMBERS[:2]}
#: Stiffness of a rigid traction rod [N/m].
FAST = 1e13
#: Wheelsets of the vehicle that the leading one of the bogie represents.
LEADERS = (1, 3)


def static_torque(friction: float) -> float:
    """Return the brake torque of a wheelset at the adhesion limit under its load at rest [N.m]."""
    return friction * rigid_axle_loads(COACH, 0.0, 0.0, 1.0)[0] * COACH.wheel_radius


def start(name: str, friction: float, level: int = PLANAR) -> Kernel:
    """Return one bogie or the vehicle at a level, not yet braked."""
    frictions = {f"friction_{number}": friction for number in OWN[name]}
    return prepare(name, **{**VALUES[name], **frictions, "level": level, "initial_speed": SPEED})


def brake(name: str, friction: float, share: float, ramp: float, duration: float) -> tuple[Kernel, Recording]:
    """Run with all brakes at a share of the static torque.

    Takes ramp [s], duration [s].
    """
    kernel, torque = start(name, friction), share * static_torque(friction)
    read = ("speed", "distance", "acceleration", *(f"axle_load_{n}" for n in OWN[name]))
    inputs = {f"brake_torque_{n}": [(0.0, 0.0), (ramp, torque)] for n in OWN[name]}
    return kernel, play(name, kernel, duration, INTERVAL, read, inputs)


@dataclass(frozen=True)
class Difference:
    """One bogie against the vehicle: relative difference of distance; missing share of load transfer; deceleration
    [m/s2].
    """

    distance: float
    missing: float
    deceleration: float


def differ(friction: float, share: float) -> Difference:
    """Return the difference of bogie and vehicle, braked alike."""
    series = {name: brake(name, friction, share, RAMP, DURATION)[1] for name in OWN}
    late = series[WHOLE]["time"] > SETTLED

    def transfer(name: str, number: int) -> float:
        load = series[name][f"axle_load_{number}"]
        return float(load[late[: load.size]].mean() - load[0])

    farthest = max(abs(transfer(WHOLE, n) - transfer(ONE, 1)) for n in LEADERS)
    distance = float(series[ONE]["distance"][-1] / series[WHOLE]["distance"][-1] - 1.0)
    deceleration = -float(series[WHOLE]["acceleration"][late].mean())
    return Difference(distance, farthest / abs(transfer(ONE, 1)), deceleration)


def first_lock(name: str, friction: float) -> tuple[int, float]:
    """Return the wheelset that locks first, and the least share of the static torque at which it does before rest."""
    low, high, first = LOWEST, HIGHEST, 0
    while high - low > RESOLUTION:
        share = (low + high) / 2
        kernel, series = brake(name, friction, share, SLOW_RAMP, SLOW_RAMP + SPEED / (0.4 * friction * COACH.gravity))
        times = {number: located_lock_time(kernel, series, number) for number in OWN[name]}
        locked = {time: number for number, time in times.items() if time is not None}
        if locked:
            high, first = share, locked[min(locked)]
        else:
            low = share
    return first, high


def rigid_lock(friction: float, whole: bool) -> float:
    """Return the share of the static torque at which rigid statics lock the lightest wheelset; others still roll."""
    low, high = 0.0, HIGHEST
    for _ in range(50):
        share = (low + high) / 2
        torque = share * static_torque(friction)
        deceleration = coach().deceleration(torque)
        loads = rigid_axle_loads(COACH, deceleration, torque, 1.0)
        lightest = loads[3] if whole else loads_of_one_bogie(deceleration, torque)[1]
        creep = (torque - COACH.wheelset_pitch_inertia * deceleration / COACH.wheel_radius) / COACH.wheel_radius
        low, high = (share, high) if creep < friction * lightest else (low, share)
    return low


def loads_of_one_bogie(deceleration: float, torque: float) -> list[float]:
    """Return the axle loads of one bogie by rigid statics [N]: no load moves to another, half a body is fixed to the
    frame.
    """
    loads = rigid_axle_loads(replace(COACH, traction_rod_stiffness=FAST), deceleration, torque, 1.0)
    return [(front + rear) / 2 for front, rear in zip(loads[:2], loads[2:], strict=True)]


def rigid_missing() -> float:
    """Return the share of the vehicle's load transfer that rigid statics of one bogie neglect, at 1 m/s2."""
    braking = 1.0, static_torque(1.0 / COACH.gravity)
    at_rest, one = rigid_axle_loads(COACH, 0.0, 0.0, 1.0)[0], loads_of_one_bogie(*braking)[0]
    whole = rigid_axle_loads(COACH, *braking, 1.0)
    return max(abs(whole[number - 1] - one) for number in LEADERS) / (one - at_rest)


def cost(name: str, level: int) -> float:
    """Return the wall time of a braking of DURATION [s]."""

    def once() -> None:
        kernel = start(name, FRICTIONS[-1], level)
        kernel.set(**{f"brake_torque_{n}": 0.5 * static_torque(FRICTIONS[-1]) for n in OWN[name]})
        kernel.initialise()
        kernel.advance(DURATION)

    return least(once, 3)


@dataclass(frozen=True)
class VehicleAgainstBogie:
    """Differences by (friction, share), first locks by (name, friction), costs by (name, level) [s]."""

    differences: dict[tuple[float, float], Difference]
    locks: dict[tuple[str, float], tuple[int, float]]
    costs: dict[tuple[str, int], float]


def measure() -> VehicleAgainstBogie:
    points = [(friction, share) for friction in FRICTIONS for share in SHARES]
    differences = {point: differ(*point) for point in counting(points, unit="point")}
    locks = {(name, friction): first_lock(name, friction) for name in OWN for friction in FRICTIONS}
    return VehicleAgainstBogie(
        differences, locks, {(name, level): cost(name, level) for name in OWN for level in LEVELS}
    )


def rows_of(found: VehicleAgainstBogie) -> list[Row]:
    rolling = [one for (_, share), one in found.differences.items() if share < 0.9]
    error, missing = max(abs(one.distance) for one in rolling), max(one.missing for one in rolling)
    largest, words = "one bogie: error of the distance, largest", "torques up to 0.8 of the static limit"
    left_out = "one bogie: share of load transfer that it leaves out"
    rows = [
        measured(largest, "1", error, "complete vehicle", at_most(DISTANCE), words),
        measured(left_out, "1", missing, "rigid statics", near(rigid_missing(), BAND)),
    ]
    for friction in FRICTIONS:
        for name in OWN:
            number, share = found.locks[name, friction]
            expected = rigid_lock(friction, name == WHOLE)
            what = f"friction {friction:g}, {name}: share of the static torque that locks wheelset {number}"
            rows.append(measured(what, "1", share, "rigid statics, Coulomb friction", near(expected, BAND)))
    for (name, level), seconds in found.costs.items():
        what = f"{name}, {LEVELS[level]}: {DURATION:g} s of braking"
        rows.append(measured(what, "ms", 1e3 * seconds, "measured now, least of several runs"))
    return rows


def run(options: Options, quick: bool = False) -> Report:
    found = measure()
    columns = {"friction": "1", "share": "1", "deceleration": "m/s2", "distance_error": "1", "missing_transfer": "1"}
    table = [[f, s, d.deceleration, d.distance, d.missing] for (f, s), d in found.differences.items()]
    series = Recording({"point": "1"} | columns, [[number, *row] for number, row in enumerate(table)])
    remarks = [
        "One bogie: BogieDynamics with `one_bogie_of`, half the body on the frame at the height of the secondary "
        "springs. It tells speed, distance and rotation as the vehicle does; it knows no load that moves between the "
        "bogies, so that its trailing wheelset locks a little later than the vehicle's last one. Hunting and all that "
        "the secondary suspension decides ask for the vehicle.",
        "Assumed: the traction rods of the vehicle, and their height, that of the secondary springs.",
    ]
    return Report(rows_of(found), series, lambda: draw(found), dict(VALUES[ONE]), len(table) * 2 * DURATION, remarks)


def draw(found: VehicleAgainstBogie) -> Figure:
    figure, axes = plt.subplots(1, 3, figsize=(13.0, 4.4))
    for friction, colour in zip(FRICTIONS, THREE, strict=True):
        chosen = {share: one for (mu, share), one in found.differences.items() if mu == friction}
        decelerations = [one.deceleration for one in chosen.values()]
        style = {"color": colour, "marker": "o", "markersize": 4.0, "linewidth": 1.0, "label": f"friction {friction:g}"}
        axes[0].plot(decelerations, [1e6 * abs(one.distance) for one in chosen.values()], **style)
    axes[0].set(title="one bogie: error of distance [1e-6]", xlabel="deceleration [m/s2]")
    axes[0].legend(fontsize=8)
    draw_locks(axes[1], found.locks)
    draw_costs(axes[2], found.costs)
    largest = 100 * max(abs(difference.distance) for difference in found.differences.values())
    return titled(figure, f"One bogie stands for the vehicle within {largest:.2g} % of the distance")


def draw_locks(axis: Axes, locks: Mapping[tuple[str, float], tuple[int, float]]) -> None:
    fine = np.linspace(FRICTIONS[0], FRICTIONS[-1], 30)
    for name, colour in ((WHOLE, TRAILING), (ONE, LEADING)):
        axis.plot(fine, [rigid_lock(friction, name == WHOLE) for friction in fine], color=colour, linewidth=1.0)
        axis.plot(FRICTIONS, [locks[name, friction][1] for friction in FRICTIONS], "o", color=colour, label=name)
    axis.set_title("first lock: torque over the static limit [1];\nlines: rigid statics")
    axis.set_xlabel("wheel-rail friction [1]")
    axis.legend(fontsize=8)


def draw_costs(axis: Axes, costs: Mapping[tuple[str, int], float]) -> None:
    for offset, (name, colour) in enumerate(((ONE, LEADING), (WHOLE, TRAILING))):
        values = [1e3 * costs[name, level] for level in LEVELS]
        axis.bar(np.arange(len(LEVELS)) + 0.35 * (offset - 0.5), values, 0.33, color=colour, label=name)
    axis.set_xticks(range(len(LEVELS)), list(LEVELS.values()))
    axis.set(yscale="log", title=f"time to compute\n{DURATION:g} s of braking [ms]")
    axis.legend(fontsize=8)


SCENARIO = Scenario("vehicle-or-bogie", "One bogie under half a body against the complete vehicle: error and cost", run)
