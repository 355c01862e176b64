"""Braking of a complete vehicle: load moves between axles and between bogies, and decides which wheels lock first."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.motion import Motion, motion_columns
from bogie_braking.reporting.plots import FOUR, LINES, panels
from bogie_braking.reporting.report import Report, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.coach import COACH, NUMBERS, brakes
from products.kernel_runs import located_lock_time, play, prepare
from rbd_model.vehicle.ready import passenger_coach
from scenarios.bench.four_axles import rigid_axle_loads

PLANAR = 2
SPEED, TORQUE, SETTLED, DURATION, INTERVAL = 50.0, 5e3, 14.0, 15.0, 0.01
#: Tolerance of the loads against rigid statics: the vehicle leans a little, and still rocks a little.
BAND = 1e-3
#: Torque above the adhesion limit at this friction [N.m], ramp [s], friction [1].
RAMP, RAMP_TIME, FRICTION = 9e3, 30.0, 0.12
#: Bending of the air springs transmits moments to the frames, which rigid statics neglect.
STATICS = {"secondary_bending_stiffness": 0.0}
LOADS = tuple(f"axle_load_{number}" for number in NUMBERS)
RECORDED = ("speed", *LOADS, *(f"angular_velocity_{number}" for number in NUMBERS))
REACTIONS = {"hung in the frame": 1.0, "on nothing": 0.0}


def steady(reaction: float) -> tuple[Recording, list[float]]:
    """Run with all wheelsets braked until the rocking decays; return also the loads of statics at the end [N]."""
    values = STATICS | {"torque_reaction": reaction, "initial_speed": SPEED, "level": PLANAR}
    kernel = prepare("vehicle", **values)
    inputs = {name: [(0.0, torque)] for name, torque in brakes(TORQUE).items()}
    series = play("vehicle", kernel, DURATION, INTERVAL, ("speed", "acceleration", *LOADS), inputs)
    late = series["time"] > SETTLED
    deceleration = -float(np.mean(series["acceleration"][late]))
    return series, rigid_axle_loads(COACH, deceleration, TORQUE, reaction)


def locking(reaction: float, record: Sequence[str] = RECORDED) -> tuple[Recording, dict[int, float | None]]:
    """Run with a rising torque until wheelsets lock; return also the time at which each did [s]."""
    friction = {f"friction_{number}": FRICTION for number in NUMBERS}
    values = {"torque_reaction": reaction, "initial_speed": SPEED, "level": PLANAR}
    kernel = prepare("vehicle", **values, **friction)
    inputs = {name: [(0.0, 0.0), (RAMP_TIME, RAMP)] for name in brakes(RAMP)}
    series = play("vehicle", kernel, RAMP_TIME, INTERVAL, record, inputs)
    return series, {number: located_lock_time(kernel, series, number) for number in NUMBERS}


def run(options: Options, quick: bool = False) -> Report:
    rows, ramps = [], {}
    for name, reaction in REACTIONS.items():
        series, expected = steady(reaction)
        late = series["time"] > SETTLED
        for number, load in zip(NUMBERS, expected, strict=True):
            found = float(np.mean(series[f"axle_load_{number}"][late]))
            asked = near(load / 1e3, BAND * load / 1e3)
            rows.append(measured(f"axle load {number}, brakes {name}", "kN", found / 1e3, "rigid statics", asked))
        ramps[name] = locking(reaction)
        for number, time in ramps[name][1].items():
            torque = None if time is None else time / RAMP_TIME * RAMP / 1e3
            source = f"all brakes rise to {RAMP / 1e3:g} kN.m at friction {FRICTION:g}"
            rows.append(measured(f"torque that locks wheelset {number}, brakes {name}", "kN.m", torque, source))
    remarks = [f"Brakes {name}: {order(times)}." for name, (_, times) in ramps.items()]
    remarks.append(
        "Assumed: the traction rods. The published vehicle has none, and its body swings along the track at 1.26 Hz "
        "for the whole stop."
    )
    first = ramps["hung in the frame"][0]
    parameters = STATICS | {"torque": TORQUE}
    return Report(rows, first, lambda: draw(ramps), parameters, 4 * DURATION, remarks, motion=motion)


def motion() -> Motion:
    """Run while the torque rises, with brakes hung in the frame."""
    vehicle = passenger_coach()
    series = locking(REACTIONS["hung in the frame"], motion_columns(vehicle))[0]
    return Motion(f"Brakes that rise to {RAMP / 1e3:g} kN.m, hung in the frame", vehicle, series)


def order(times: dict[int, float | None]) -> str:
    """Return the wheelsets in the order in which they locked."""
    locked = sorted((time, number) for number, time in times.items() if time is not None)
    return f"wheelsets lock in the order {', '.join(str(number) for _, number in locked)}" if locked else "none locks"


def draw(ramps: dict[str, tuple[Recording, dict[int, float | None]]]) -> Figure:
    titles = [title for name in ramps for title in (f"axle loads [kN], brakes {name}", "circumferential speeds [m/s]")]
    times = ramps["hung in the frame"][1]
    locked = sorted((time, number) for number, time in times.items() if time is not None)
    order_of_lock = "-".join(str(number) for _, number in locked) or "none"
    figure, axes = panels(f"With brakes in the frame wheelsets lock in the order {order_of_lock}", titles)
    for row, (series, times) in enumerate(ramps.values()):
        for number, line, colour in zip(NUMBERS, LINES, FOUR, strict=True):
            label = f"wheelset {number}"
            axes[2 * row].plot(series["time"], series[f"axle_load_{number}"] / 1e3, line, color=colour, label=label)
            wheel = COACH.wheel_radius * series[f"angular_velocity_{number}"]
            axes[2 * row + 1].plot(series["time"], wheel, line, color=colour)
            lock = times[number]
            if lock is not None:
                axes[2 * row].axvline(lock, color=colour, linewidth=0.8, linestyle=":")
    axes[0].margins(y=0.25)
    axes[0].legend(ncols=4, loc="upper left")
    return figure


SCENARIO = Scenario("vehicle-braking", "Load transfer and lock order of four wheelsets", run)
