"""Heavy braking of the wheelset of chapter 4: it locks while the frame runs on, and drifts sideways (section 4.7)."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, irregular, motion_columns
from bogie_braking.reporting.plots import BOGIE, TRAILING, mark, one_word, single, write_at
from bogie_braking.reporting.report import Report, Row, at_least, at_most, between, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import play, prepare
from rbd_model.vehicle.parameters import AS_PRINTED, as_printed, tables_4_1_and_4_2
from rbd_model.vehicle.ready import wheelset_under_frame

TORQUE, APPLIED, SPEED = 25e3, 2.0, 25.0
FRICTIONS = (0.3, 0.1)
#: Limits of 'about 1 sec' [s]. The text also mentions half a second: values closer to 1 s than to 0.5 s pass.
ABOUT_A_SECOND = between(0.75, 1.25)
#: The thesis does not report the disturbance.
WAVE = {"lateral_irregularity": 4e-3, "lateral_wave_number": 0.2}
#: Recording interval: a lock is detected up to one interval late, and creep takes up to another to saturate [s].
DURATION, INTERVAL = 6.0, 2e-3
RECORDED = ("speed", "angular_velocity_1", "locked_1", "lateral_1", "yaw_1")


def brake(friction: float, reading: Mapping[str, float] = AS_PRINTED, columns: Sequence[str] = RECORDED) -> Recording:
    kernel = prepare("wheelset", initial_speed=SPEED, friction_1=friction, **WAVE, **reading)
    history = [(0.0, 0.0), (APPLIED, 0.0), (APPLIED, TORQUE)]
    return play("wheelset", kernel, DURATION, INTERVAL, columns, {"brake_torque_1": history})


SATURATED = "J V/r over the brake torque less mu m g r, printed values"


def lock_in_closed_form(friction: float) -> float:
    """Return the time from brake to lock with creep that is saturated from the start [s]."""
    p = tables_4_1_and_4_2()
    rail = friction * (p.frame_mass + p.wheelset_mass) * p.gravity * p.wheel_radius
    return p.wheelset_pitch_inertia * SPEED / p.wheel_radius / (TORQUE - rail)


def run(options: Options, quick: bool = False) -> Report:
    runs = {friction: brake(friction) for friction in FRICTIONS}
    rows = []
    for friction, (printed, asked, words) in zip(
        FRICTIONS,
        ((1.0, ABOUT_A_SECOND, "'about 1 sec'"), (None, at_most(0.5), "'less than a half second'")),
        strict=True,
    ):
        series = runs[friction]
        locked = series.first_time(series["locked_1"] > 0.5)
        delay = None if locked is None else locked - APPLIED
        name = f"friction {friction}: time from brake to lock"
        rows.append(Row(name, "s", printed, delay, asked, "section 4.7", words))
        closed = lock_in_closed_form(friction)
        rows.append(measured(f"{name}, closed form", "s", delay, SATURATED, near(closed, 2 * INTERVAL)))
        speed = None if locked is None else float(series["speed"][series["time"] >= locked][0])
        words = "'more than 20 m/s', of 25 m/s at the start"
        above = at_least(20.0) if friction == FRICTIONS[0] else None
        rows.append(measured(f"friction {friction}: speed at lock", "m/s", speed, "section 4.7", above, words))
        shift = 1e3 * float(series["lateral_1"][-1])
        rows.append(measured(f"friction {friction}: lateral shift at the end", "mm", shift, "Figs 4.28, 4.29"))
        shift = 1e3 * float(brake(friction, {})["lateral_1"][-1])
        name = f"friction {friction}: lateral shift at the end, brake hung in the frame"
        rows.append(measured(name, "mm", shift, "Figs 4.28, 4.29"))
    series = runs[FRICTIONS[0]]
    for name in RECORDED:
        series.add_from(f"{name}, friction {FRICTIONS[1]}", runs[FRICTIONS[1]], name)
    parameters = as_printed(tables_4_1_and_4_2()).values() | WAVE
    return Report(rows, series, lambda: draw(runs), parameters, 2 * DURATION * len(runs), motion=motion)


def motion() -> Motion:
    """Run at the larger friction."""
    vehicle, friction = wheelset_under_frame(), FRICTIONS[0]
    series = brake(friction, columns=motion_columns(vehicle))
    return Motion(f"Braked at friction {friction:g}", vehicle, series, irregular(**WAVE))


def message(series: Recording) -> str:
    """Return the title: the time to lock, and the speed of the frame then."""
    locked = series.first_time(series["locked_1"] > 0.5)
    if locked is None:
        return f"{1e-3 * TORQUE:g} kN.m do not lock the wheelset"
    speed = float(series["speed"][series["time"] >= locked][0])
    begin = f"{1e-3 * TORQUE:g} kN.m at friction {FRICTIONS[0]:g}"
    return f"{begin} lock wheels within {locked - APPLIED:.1f} s at {one_word(f'{speed:.0f} m/s')}"


def draw(runs: dict[float, Recording]) -> Figure:
    """Draw the speed of the frame, and of the wheels at their circumference."""
    figure, axis = single(message(runs[FRICTIONS[0]]), "time [s]", "speed [m/s]")
    radius = tables_4_1_and_4_2().wheel_radius
    for friction, line in zip(FRICTIONS, ("-", "--"), strict=True):
        series = runs[friction]
        axis.plot(series["time"], series["speed"], line, color=BOGIE, linewidth=2.5)
        axis.plot(series["time"], radius * series["angular_velocity_1"], line, color=TRAILING, linewidth=2.5)
        height = float(np.interp(2 * APPLIED, series["time"], series["speed"])) + 1.0
        write_at(axis, (DURATION, height), f"frame, friction {friction:g}", BOGIE, ha="right")
    write_at(axis, (2.5, 12.0), f"wheels, friction {FRICTIONS[0]:g}", TRAILING)
    write_at(axis, (1.9, 12.0), f"wheels, friction {FRICTIONS[1]:g}", TRAILING, ha="right")
    axis.set_ylim(-1.0, SPEED + 2.5)
    mark(axis, APPLIED, "brake")
    return figure


SCENARIO = Scenario("wheelset-skid", "25 kN.m lock the wheelset at friction 0.3 and 0.1 (section 4.7)", run)
