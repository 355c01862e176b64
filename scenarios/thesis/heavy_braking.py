"""Heavy braking of the chapter 5 bogie, section 5.5, longitudinal part: 60 kN.m on one and on both wheelsets."""

from itertools import product

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, motion_columns
from bogie_braking.reporting.plots import BOGIE, LEADING, TRAILING, mark, one_word, panels
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, measured, rounding
from bogie_braking.reporting.scenario import Options, Scenario, Sweepable
from fmu_src.cosimulation.master import cosimulate
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import AT_REST, located_lock_time, play, prepare
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_5_1_and_5_2
from rbd_model.vehicle.ready import two_axle_bogie
from scenarios.bench.open_fmus import open_bogie

INITIAL_SPEED, TORQUE, BRAKE_TIME, DURATION = 25.0, 60e3, 4.0, 20.0
#: Recording interval of the three-dimensional view of a report [s].
INTERVAL = 0.01
#: Not reported for section 5.5; chapter 9 uses 0.3 with the same bogie.
FRICTION = 0.3
#: Time by which a stop must end [s], or it has no stop distance; 25 m/s at 0.1 m/s2.
LONGEST_STOP = 250.0
RECORDED = ("speed", "angular_velocity_1", "angular_velocity_2", "axle_load_1", "axle_load_2", "locked_1", "locked_2")
BOGIE_DATA = tables_5_1_and_5_2()
HUNG = "brakes hung in the frame, which (3.36) leaves out"
CASES = {"leading": (TORQUE, 0.0), "both": (TORQUE, TORQUE)}


def brake(
    options: Options, level: int, torques: tuple[float, float], reaction: float = AS_PRINTED["torque_reaction"]
) -> tuple[Recording, list[str], str]:
    """Run at 25 m/s with constant torques from t = 4 s.

    Takes torques [N.m] (2,).
    """
    with open_bogie(options, level=level, initial_speed=INITIAL_SPEED, torque_reaction=reaction) as bogie:
        bogie.start(friction_1=FRICTION, friction_2=FRICTION)

        def drive(time: float) -> None:
            on = time >= BRAKE_TIME - 1e-9
            bogie.set(brake_torque_1=torques[0] * on, brake_torque_2=torques[1] * on)

        record = [(bogie, name) for name in RECORDED]
        series = cosimulate([bogie], [], DURATION, options.macro_step(), record, drive, label=f"level {level}")
        return series, list(bogie.messages), bogie.guid


def lock_time(series: Recording, number: int) -> float | None:
    """Return the time from the application of the brake to the first lock of a wheelset [s]."""
    time = series.first_time(series[f"locked_{number}"] > 0.5)
    return None if time is None else time - BRAKE_TIME


def later_by(first: float | None, second: float | None) -> float | None:
    """Return the difference of two lock times [s]; None if one of the wheelsets did not lock."""
    return None if first is None or second is None else second - first


def printed_rows(planar: dict[str, Recording], hung: dict[str, Recording]) -> list[Row]:
    """Return the lock times compared with the figures, as in the thesis and with brakes hung in the frame."""
    late, early = lock_time(planar["both"], 1), lock_time(planar["both"], 2)
    assumed = f"planar; wheel-rail friction {FRICTION} and frame height {BOGIE_DATA.frame_height} m are not printed"
    fitted = f"not judged: the frame height, {BOGIE_DATA.frame_height} m, is fitted to it"
    alone, both = "leading wheelset braked alone: locks after", "both braked: trailing wheelset locks after"
    later, forward = "both braked: leading locks later by", "load moves forward"
    alone_hung, both_hung = (
        "leading braked alone: locks after, brakes hung",
        "both braked: trailing locks after, brakes hung",
    )
    return [
        Row(alone, "s", 0.5, lock_time(planar["leading"], 1), None, "Fig. 5.44, about", fitted),
        Row(both, "s", 0.2, early, rounding("0.2"), "Fig. 5.46, about", assumed),
        measured(later, "s", later_by(early, late), forward, None, "planar"),
        measured(alone_hung, "s", lock_time(hung["leading"], 1), HUNG, None, "planar"),
        measured(both_hung, "s", lock_time(hung["both"], 2), HUNG, None, "planar"),
    ]


def point_rows(point: dict[str, Recording]) -> list[Row]:
    """Return the lock times with static loads."""
    apart, alone = "both braked: difference of the two lock times", "leading braked alone: locks after, point level"
    later, source = later_by(lock_time(point["both"], 2), lock_time(point["both"], 1)), "static loads"
    early = "point: too early, because the load that moves forward is missing"
    return [
        measured(apart, "s", later, source, None, "point: both alike"),
        measured(alone, "s", lock_time(point["leading"], 1), source, None, early),
    ]


def run(options: Options, quick: bool = False) -> Report:
    bar = counting(list(product((2, 1), CASES)), "stops", unit="stop")
    runs = {(level, case): brake(options, level, CASES[case]) for level, case in bar}
    hung = {case: brake(options, 2, torque, BOGIE_DATA.torque_reaction)[0] for case, torque in CASES.items()}
    planar = {case: runs[2, case][0] for case in CASES}
    point = {case: runs[1, case][0] for case in CASES}
    rows = printed_rows(planar, hung) + point_rows(point)
    series = planar["leading"]
    for name in RECORDED:
        series.add_from(f"{name} (both braked)", planar["both"], name)
    remarks = [f"{case} braked, planar: {' '.join(m for m in runs[2, case][1])}" for case in CASES]
    parameters = as_printed(BOGIE_DATA).values() | {"friction": FRICTION, "brake_torque": TORQUE}
    guids = {"BogieDynamics": runs[2, "both"][2]}
    return Report(rows, series, lambda: draw(planar), parameters, 6 * DURATION, remarks, guids, motion=motion)


def motion() -> Motion:
    """Run with both wheelsets braked, in the thesis's interpretation."""
    vehicle, torque = two_axle_bogie(), [(0.0, 0.0), (BRAKE_TIME, 0.0), (BRAKE_TIME, TORQUE)]
    values = {"level": 2, "initial_speed": INITIAL_SPEED, "friction_1": FRICTION, "friction_2": FRICTION}
    kernel = prepare("bogie", **values, torque_reaction=AS_PRINTED["torque_reaction"])
    inputs = {f"brake_torque_{number}": torque for number in (1, 2)}
    series = play("bogie", kernel, DURATION, INTERVAL, motion_columns(vehicle), inputs)
    return Motion(f"Both wheelsets braked with {TORQUE / 1e3:g} kN.m", vehicle, series)


def message(both: Recording) -> str:
    """Return the title: the wheelset that locks first if both are braked, and by how much."""
    leading, trailing = (both.first_time(both[f"locked_{number}"] > 0.5) for number in (1, 2))
    if leading is None or trailing is None:
        return "Braked alike, the two wheelsets do not both lock"
    first, other = ("trailing", "leading") if trailing < leading else ("leading", "trailing")
    torque = one_word(f"{1e-3 * TORQUE:g} kN.m")
    return f"By {torque} the {first} wheelset locks {abs(leading - trailing):.1f} s before the {other} one"


def draw(planar: dict[str, Recording]) -> Figure:
    labels = (
        "leading wheelset braked with 60 kN.m: speed and wheel speeds [m/s]",
        "axle loads [kN]",
        "both wheelsets braked with 60 kN.m: speed and wheel speeds [m/s]",
        "axle loads [kN]",
    )
    figure, axes = panels(message(planar["both"]), labels)
    radius = BOGIE_DATA.wheel_radius
    for row, case in enumerate(CASES):
        series, axis, loads = planar[case], axes[2 * row], axes[2 * row + 1]
        time = series["time"]
        axis.plot(time, series["speed"], color=BOGIE, label="bogie")
        for number, colour, line, label in ((1, LEADING, "-", "leading"), (2, TRAILING, "--", "trailing")):
            axis.plot(time, radius * series[f"angular_velocity_{number}"], line, color=colour, label=label)
            loads.plot(time, series[f"axle_load_{number}"] / 1e3, line, color=colour)
            locked = series.first_time(series[f"locked_{number}"] > 0.5)
            if locked is not None and np.interp(locked, time, series["speed"]) > 1.0:
                mark(axis, locked, "")
        axis.legend(loc="upper right", ncols=3)
        axis.set_xlim(3.0, 14.0)
    return figure


def one_stop(
    friction: float = FRICTION,
    brake_torque_1: float = TORQUE,
    brake_torque_2: float = TORQUE,
    frame_height: float = BOGIE_DATA.frame_height,
    initial_speed: float = INITIAL_SPEED,
    torque_reaction: float = BOGIE_DATA.torque_reaction,
) -> dict[str, float | None]:
    """Return the results of one stop at the planar level, braked from t = 0.

    Takes brake_torque_1, brake_torque_2 [N.m], frame_height [m], initial_speed [m/s].
    """
    values = {"frame_height": frame_height, "torque_reaction": torque_reaction}
    kernel = prepare("bogie", level=2, initial_speed=initial_speed, **values)
    kernel.set(friction_1=friction, friction_2=friction, brake_torque_1=brake_torque_1, brake_torque_2=brake_torque_2)
    kernel.initialise()
    rows = [(0.0, initial_speed)]
    while kernel["speed"] > AT_REST:
        if kernel.time >= LONGEST_STOP:
            raise ValueError(f"The bogie still moves at {kernel['speed']:.3g} m/s after {LONGEST_STOP:g} s.")
        table = kernel.record(1.0, 0.01, ("speed",))
        rows += zip(table["time"], table["speed"], strict=True)
    kernel.advance(1.0)  # the rest of the distance, below AT_REST
    series = Recording({"time": "s", "speed": "m/s"}, rows)
    locks = {f"lock_time_{number}": located_lock_time(kernel, series, number) for number in (1, 2)}
    return {**locks, "stop_distance": kernel["distance"]}


SWEEP = Sweepable(
    {
        "friction": "1",
        "brake_torque_1": "N.m",
        "brake_torque_2": "N.m",
        "frame_height": "m",
        "initial_speed": "m/s",
        "torque_reaction": "1",
    },
    {"lock_time_1": "s", "lock_time_2": "s", "stop_distance": "m"},
    one_stop,
)
SCENARIO = Scenario(
    "bogie-heavy-braking",
    "60 kN.m on the leading and on both wheelsets from 25 m/s (section 5.5)",
    run,
    frozenset({"kind", "step"}),
    sweep=SWEEP,
)
