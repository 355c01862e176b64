"""Locked or rolling: the QR30 trailing wheelset over shoe friction and wheel-rail friction, for the three pressures."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.optimize import bisect

from bogie_braking.reporting.plots import BOGIE, LINES, THREE, single
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.experiment import EXPERIMENT
from brake_controller.parameters import qr30
from fmu_src.cosimulation.master import Connection, Coupling
from fmu_src.cosimulation.recording import Recording
from fmu_src.cosimulation.slave import FmuInstance
from products.kernel_runs import AT_REST
from rbd_model.vehicle.parameters import AS_PRINTED, tables_8_1_and_8_2
from scenarios.bench.open_fmus import open_bogie, open_brake
from scenarios.bench.qr30_bogie import FRICTION, FRICTION_RANGE, bogie_parameters

#: Communication step of many short runs: the torque of 0.8 s build-up needs no finer one [s].
DEFAULT_STEP = 0.01
LONGEST = 12.0
FRICTIONS = np.linspace(0.12, 0.24, 13)
SHOE_FRICTION_SPAN = (0.05, 0.9)
RESOLUTION = 5e-4
#: Share of the brake torque that reacts on the frame: with brakes hung in it, and in the thesis (3.36).
HUNG, ALONE = tables_8_1_and_8_2().torque_reaction, AS_PRINTED["torque_reaction"]
#: Number of skidding trials of the four of each pressure (sections 7.2 - 7.4).
SKIDDED = {130: 0, 150: 2, 180: 4}
#: Load of each wheel of the braked wheelset [N], section 7.4.2.
PRINTED_WHEEL_LOAD = 8850.0
#: Tolerance of rigid statics.
BAND = 1e-3


def brake_until_lock_or_rest(
    brake: FmuInstance,
    bogie: FmuInstance,
    pressure: int,
    shoe_friction: float,
    friction: float,
    step: float,
    reaction: float = HUNG,
) -> tuple[bool, float]:
    """Return whether the trailing wheelset locks while the bogie still moves, and the time until lock or rest.

    Takes pressure [kPa], step [s]; returns [s].
    """
    brake.restart(qr30(pressure).values() | {"constant_shoe_friction": shoe_friction}, pressure_demand=1e3 * pressure)
    parameters = bogie_parameters(set(bogie.units), pressure) | {"torque_reaction": reaction}
    bogie.restart(parameters, friction_1=friction, friction_2=friction)
    coupling = Coupling([brake, bogie], [Connection(brake, "brake_torque", bogie, "brake_torque_2")])
    for time in coupling.run(LONGEST, step):
        locked, speed = bogie.get(["locked_2", "speed"])
        if speed < AT_REST or locked:
            return bool(locked) and speed >= AT_REST, time
    return False, LONGEST


def boundary(
    brake: FmuInstance, bogie: FmuInstance, pressure: int, friction: float, step: float, reaction: float = HUNG
) -> tuple[float, float]:
    """Return the shoe friction at which the wheelset just locks.

    Takes pressure [kPa], step [s]; returns [1].
    """
    seconds = 0.0

    def sign(shoe_friction: float) -> float:
        nonlocal seconds
        locks, lasted = brake_until_lock_or_rest(brake, bogie, pressure, shoe_friction, friction, step, reaction)
        seconds += lasted
        return 1.0 if locks else -1.0

    return float(bisect(sign, *SHOE_FRICTION_SPAN, xtol=RESOLUTION)), seconds


def printed_range(pressure: int) -> tuple[float, float]:
    """Return the lowest and the highest shoe friction measured at a pressure [kPa]."""
    case = EXPERIMENT[pressure]
    return case.lowest_shoe_friction, case.highest_shoe_friction


def locked_share(curve: np.ndarray, shoe_range: tuple[float, float]) -> float:
    """Return the share of the rectangle of published ranges (shoe friction x wheel-rail friction) that locks."""
    low, high = shoe_range
    grid = np.linspace(*FRICTION_RANGE, 201)
    above = (high - np.clip(np.interp(grid, FRICTIONS, curve), low, high)) / (high - low)
    return float(np.mean(above))


def run(options: Options, quick: bool = False) -> Report:
    curves: dict[int, np.ndarray] = {}
    step = options.macro_step(DEFAULT_STEP)
    with open_brake(options) as brake, open_bogie(options) as bogie:
        points = counting([(p, f) for p in EXPERIMENT for f in FRICTIONS], "qr30-lock-boundary")
        found = [boundary(brake, bogie, pressure, friction, step) for pressure, friction in points]
        for number, pressure in enumerate(EXPERIMENT):
            limits = [limit for limit, _ in found[number * FRICTIONS.size : (number + 1) * FRICTIONS.size]]
            curves[pressure] = np.array(limits)
        alone = {pressure: boundary(brake, bogie, pressure, FRICTION, step, ALONE)[0] for pressure in EXPERIMENT}
        # A skid well above the limit, for the adhesion measured by eq. (7.3).
        adhesion = {}
        for reaction in (ALONE, HUNG):
            brake_until_lock_or_rest(brake, bogie, 180, 0.4, FRICTION, step, reaction)
            adhesion[reaction] = -bogie["creep_force_2"] * tables_8_1_and_8_2().wheel_radius
        guids = {slave.name: slave.guid for slave in (brake, bogie)}
    rows, remarks = [*rows_of_torque(adhesion), *rows_of_ranges(curves)], remarks_on(curves, alone)
    units = {"wheel_rail_friction": "1"} | {f"shoe_friction_that_locks_{p}_kPa": "1" for p in curves}
    series = Recording(units, np.column_stack([FRICTIONS, *curves.values()]).tolist())
    parameters = tables_8_1_and_8_2().values() | {"macro_step": step, "resolution": RESOLUTION}
    seconds = sum(lasted for _, lasted in found)
    return Report(rows, series, lambda: draw(curves), parameters, seconds, remarks, guids)


def rows_of_torque(adhesion: dict[float, float]) -> list[Row]:
    """Compare the torque of the rail on the locked wheelset [N.m], by the reaction of the brake, with statics."""
    p = tables_8_1_and_8_2()
    at_rest = FRICTION * p.wheel_radius * (p.frame_mass / 2 + p.wheelset_mass) * p.gravity
    printed = FRICTION * p.wheel_radius * 2 * PRINTED_WHEEL_LOAD
    torque, source = "torque of the rail on the locked wheelset", "eq. (7.3), with the load at rest"
    statics = near(at_rest, BAND * at_rest)
    alone_words = f"torque on the wheelset alone; wheel-rail {FRICTION}; the printed 8.85 kN a wheel has {printed:.0f}"
    hung_words = f"not judged: the brake takes its torque over the wheel base off the load; wheel-rail {FRICTION}"
    return [
        measured(torque, "N.m", adhesion[ALONE], f"{source} of the printed masses", statics, alone_words),
        measured(f"{torque}, brake hung in the frame", "N.m", adhesion[HUNG], source, None, hung_words),
    ]


def rows_of_ranges(curves: dict[int, np.ndarray]) -> list[Row]:
    """Compare the share of the printed ranges that locks with the trials that skidded."""
    rows = []
    for pressure, curve in curves.items():
        low, high = printed_range(pressure)
        name = f"{pressure} kPa: share of the printed ranges that locks"
        share = locked_share(curve, (low, high))
        trials = "share of the four trials that skidded"
        words = (
            f"shoe friction {low} to {high} and wheel-rail {FRICTION_RANGE[0]} to {FRICTION_RANGE[1]} taken as "
            "equally likely; four trials are too few to judge"
        )
        rows.append(Row(name, "1", SKIDDED[pressure] / 4, share, None, trials, words))
    return rows


def remarks_on(curves: dict[int, np.ndarray], alone: dict[int, float]) -> list[str]:
    """Return where the limits lie in the printed ranges; alone: those with the torque on the wheelset alone."""
    remarks = []
    for pressure, curve in curves.items():
        limit, (low, high) = float(np.interp(FRICTION, FRICTIONS, curve)), printed_range(pressure)
        place = "inside" if low <= limit <= high else "above" if limit > high else "below"
        remarks.append(
            f"{pressure} kPa, wheel-rail {FRICTION}: locks from shoe friction {limit:.3f}, {place} the printed range "
            f"{low} to {high}; from {alone[pressure]:.3f} where the torque acts on the wheelset alone (3.36)."
        )
    return remarks


def draw(curves: dict[int, np.ndarray]) -> Figure:
    pressure = max(curves)
    limit = float(np.interp(FRICTION, FRICTIONS, curves[pressure]))
    message = f"At wheel-rail friction {FRICTION:g}, {pressure} kPa lock from shoe friction {limit:.2f} on"
    figure, axis = single(message, "wheel-rail friction [1]", "shoe friction [1]")
    for (pressure, curve), line, colour in zip(curves.items(), LINES, THREE, strict=False):
        axis.plot(FRICTIONS, curve, line, color=colour, label=f"{pressure} kPa: locks above")
        low, high = printed_range(pressure)
        width = FRICTION_RANGE[1] - FRICTION_RANGE[0]
        axis.add_patch(
            Rectangle((FRICTION_RANGE[0], low), width, high - low, facecolor=colour, alpha=0.12, edgecolor=colour)
        )
        axis.plot([FRICTION], [EXPERIMENT[pressure].shoe_friction], "o", color=colour)
        axis.annotate(
            f"{pressure} kPa printed",
            (FRICTION_RANGE[1], high),
            xytext=(4, -9),
            fontsize=8,
            color=colour,
            textcoords="offset points",
        )
    axis.axvline(FRICTION, color=BOGIE, linewidth=0.8, linestyle=":")
    axis.set_ylim(0.1, 0.6)
    axis.plot([], [], "o", color=BOGIE, label="printed averages")
    axis.legend(loc="upper left")
    return figure


SCENARIO = Scenario(
    "qr30-lock-boundary",
    "Locked or rolling over shoe friction and wheel-rail friction, three pressures",
    run,
    frozenset({"kind", "step"}),
)
