"""A bogie on gradients at all levels: rolling and braked downhill, at terminal speed, held, and started uphill.

Speeds and accelerations are compared with closed forms, m a = sum of the forces. While both wheelsets turn, the mass
is m + 2 J (1 - slip ratio) / r^2.
"""

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import BOGIE as GREY
from bogie_braking.reporting.plots import LEADING, TRAILING, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from bogie_braking.reporting.timing import LEVELS
from fmu_src.cosimulation.recording import Recording
from products.kernel_runs import History, play, prepare_on_line
from rbd_model.track.line import line_of, straight
from scenarios.bench.curves import BOGIE, MASS, TURNING_MASS

#: Gradients downhill, uphill, and of the track on which the bogie is held [1].
DOWN, UP, HELD = -0.02, 0.02, 0.04
LENGTH = 60e3
#: Brake torque downhill, traction torque uphill and brake torque that holds, on each wheelset [N.m].
BRAKE, TRACTION, HOLDING = 3e3, 6e3, 20e3
#: Running resistance of 62 t on two axles (Davis 1926), assumed, and the brake that gives a terminal speed with it [N],
#: [N.s/m], [N.s2/m2], [N.m].
DAVIS, DRAG = (800.0, 30.0, 8.0), 1e3
#: Simulated time until the speed is the terminal one within 1e-7: seventeen times the time constant m / (b + 2 c V)
#: [s].
LONG = 2400.0
#: Time until the suspension is at rest, and time over which the mean acceleration is taken [s].
SETTLED, MEASURED = 40.0, 10.0
#: Times at which the motors begin to pull against the brake, and at which they have their full torque and the brake
#: releases [s].
HAND_OVER = (2.0, 4.0)
#: Time at rest and its sampling interval [s], largest movement [m] and largest delay after the brakes' release [s].
STANDING, INTERVAL, MOVED, LATE = 86400.0, 5.0, 1e-4, 1e-3
#: Tolerance of accelerations and terminal speed: integration to 1e-6. In 3D wheels roll on the radius of their contact;
#: the slip, which refers to the nominal radius, includes this.
BAND = 1e-6
RECORDED = ("speed", "distance", "slip_ratio_1", "slip_ratio_2")
COLOURS = {"point": LEADING, "planar": TRAILING, "spatial": GREY}
STYLES = {"point": "-", "planar": "--", "spatial": ":"}


def both(name: str, history: History) -> dict[str, History]:
    """Return the same input on both wheelsets."""
    return {f"{name}_{number}": history for number in (1, 2)}


def ride(level: int, gradient: float, speed: float, inputs: Mapping[str, History], interval: float = 0.01) -> Recording:
    """Run on one gradient, for SETTLED and MEASURED.

    Takes speed [m/s], interval [s].
    """
    kernel = prepare_on_line("bogie", line_of([straight(LENGTH, gradient)]), level=level, initial_speed=speed)
    return play("bogie", kernel, SETTLED + MEASURED, interval, RECORDED, inputs)


def acceleration(series: Recording) -> float:
    """Return the mean acceleration over MEASURED [m/s2]."""
    time, speed = series["time"], series["speed"]
    return float(speed[-1] - np.interp(SETTLED, time, speed)) / MEASURED


def expected(series: Recording, gradient: float, torque: float) -> float:
    """Return the acceleration with a torque on each wheelset, positive if it drives (Newton's second law) [m/s2]."""
    settled = series["time"] >= series["time"][-1] - MEASURED
    slip = float(np.mean(series["slip_ratio_1"][settled] + series["slip_ratio_2"][settled])) / 2
    force = 2 * torque / BOGIE.wheel_radius - MASS * BOGIE.gravity * gradient
    return force / (MASS + TURNING_MASS * (1.0 - slip))


def terminal(level: int) -> Recording:
    """Run downhill against Davis's resistance and a brake, until the speed is constant."""
    davis = dict(zip(("davis_constant", "davis_linear", "davis_quadratic"), DAVIS, strict=True))
    line = line_of([straight(2 * LENGTH, DOWN)])
    kernel = prepare_on_line("bogie", line, level=level, initial_speed=20.0, **davis)
    return play("bogie", kernel, LONG, 10.0, RECORDED, both("brake_torque", [(0.0, DRAG)]))


def terminal_speed() -> float:
    """Return the speed at which a + b V + c V^2 equals the gravity force less the braking force, Davis (1926) [m/s]."""
    constant, linear, square = DAVIS
    pull = -MASS * BOGIE.gravity * DOWN - 2 * DRAG / BOGIE.wheel_radius
    return (-linear + math.sqrt(linear**2 + 4 * square * (pull - constant))) / (2 * square)


def hold(level: int) -> Recording:
    """Run at rest with applied brakes for a day, then rolling after their release."""
    kernel = prepare_on_line("bogie", line_of([straight(LENGTH, HELD)]), level=level, initial_speed=0.0)
    columns = (*RECORDED, "angular_velocity_1", "angular_velocity_2")
    released = [(0.0, HOLDING), (STANDING, HOLDING), (STANDING, 0.0)]
    return play("bogie", kernel, STANDING + SETTLED, INTERVAL, columns, both("brake_torque", released))


def late(series: Recording) -> float:
    """Return the delay of the start against Newton's second law, from the speed once the suspension is at rest [s]."""
    return float(series["time"][-1]) - STANDING - float(series["speed"][-1]) / expected(series, HELD, 0.0)


def runs(level: int) -> dict[str, Recording]:
    """Return all runs of one level."""
    handed = [(0.0, 0.0), (HAND_OVER[0], 0.0), (HAND_OVER[1], TRACTION)]
    released = [(0.0, HOLDING), (HAND_OVER[1], HOLDING), (HAND_OVER[1], 0.0)]
    return {
        "rolling": ride(level, DOWN, 5.0, {}),
        "braked": ride(level, DOWN, 15.0, both("brake_torque", [(0.0, BRAKE)])),
        "started": ride(level, UP, 0.0, both("traction_torque", handed) | both("brake_torque", released)),
        "held": hold(level),
    }


def run(options: Options, quick: bool = False) -> Report:
    bar = counting(LEVELS.items(), "gradient", unit="level")
    found = {name: runs(level) for level, name in bar}
    ends = {name: terminal(level) for level, name in LEVELS.items()}
    rows = [row for name, of_level in found.items() for row in acceleration_rows(name, of_level)]
    rows += [terminal_row(name, series) for name, series in ends.items()]
    off = max(abs(row.simulated / (sum(row.limits) / 2) - 1) for row in rows if row.limits and row.simulated)
    said = [f"Accelerations and terminal speeds are those of the closed forms to {off:.1e} at worst."]
    rows += [row for name, of_level in found.items() for row in standing_rows(name, of_level)]
    parameters = BOGIE.values() | {"down": DOWN, "up": UP, "held": HELD, "brake": BRAKE, "traction": TRACTION}
    series = found["planar"]["started"]
    seconds = len(LEVELS) * (3 * (SETTLED + MEASURED) + SETTLED) + len(ends) * LONG
    return Report(rows, series, lambda: draw(found, ends, off), parameters, seconds, said)


def acceleration_rows(name: str, found: Mapping[str, Recording]) -> list[Row]:
    cases = {"rolling": (DOWN, 0.0), "braked": (DOWN, -BRAKE), "started": (UP, TRACTION)}
    words = {"rolling": "down, rolling freely", "braked": "down, braked", "started": "up, started by traction"}
    rows = []
    for case, (gradient, torque) in cases.items():
        closed = expected(found[case], gradient, torque)
        quantity = f"{name}: acceleration {1e3 * abs(gradient):g} permille {words[case]}"
        asked = near(1e3 * closed, 1e3 * BAND * abs(closed))
        source = "Newton's second law with the slip of the wheels as recorded"
        rows.append(measured(quantity, "mm/s2", 1e3 * acceleration(found[case]), source, asked))
    return rows


def terminal_row(name: str, series: Recording) -> Row:
    quantity = f"{name}: terminal speed {1e3 * abs(DOWN):g} permille down, braked a little"
    closed = terminal_speed()
    source = "Davis (1926): a + b V + c V^2 balances gravity and brake"
    return measured(quantity, "m/s", series["speed"][-1], source, near(closed, BAND * closed))


def standing_rows(name: str, found: Mapping[str, Recording]) -> list[Row]:
    """Return the rows of a held and a started bogie whose closed-form value is zero."""
    back = 1e3 * abs(float(np.min(found["started"]["distance"])))
    held = found["held"]
    standing = held["time"] < STANDING
    turning = max(float(np.abs(held[f"angular_velocity_{number}"][standing]).max()) for number in (1, 2))
    moved = 1e3 * float(np.ptp(held["distance"][standing]))
    place = f"{1e3 * HELD:g} permille"
    return [
        measured(f"{name}: held on {place}, wheelsets turn at", "rad/s", turning, "brakes outdo it", at_most(0.0)),
        measured(f"{name}: held on {place} for a day, moves by", "mm", moved, "rails hold it", at_most(1e3 * MOVED)),
        measured(f"{name}: rolls late once released, by", "ms", 1e3 * late(held), "Newton", near(0.0, 1e3 * LATE)),
        measured(f"{name}: rolls back before its motors pull, by", "mm", back, "measured"),
    ]


def draw(found: Mapping[str, Mapping[str, Recording]], ends: Mapping[str, Recording], off: float) -> Figure:
    message = f"All levels meet the closed forms of gradients to {math.floor(-math.log10(max(off, 1e-16)))} digits"
    titles = (
        f"{1e3 * abs(DOWN):g} ‰ down, rolling freely and braked:\nspeed [m/s]",
        "down against Davis's resistance and a brake:\nspeed [m/s]",
        f"started {1e3 * UP:g} ‰ up:\nspeed [m/s]",
        f"held on {1e3 * HELD:g} ‰, released at 0 s:\nspeed downhill [m/s]",
    )
    figure, (down, braked, started, held) = charts(message, titles, (10.0, 7.2), "time [s]")
    for name, of_level in found.items():
        style = {"color": COLOURS[name], "linestyle": STYLES[name]}
        for case in ("rolling", "braked"):
            down.plot(of_level[case]["time"], of_level[case]["speed"], **style)
        time, speed = (of_level["started"][column] for column in ("time", "speed"))
        started.plot(time[time < 3 * HAND_OVER[1]], speed[time < 3 * HAND_OVER[1]], label=name, **style)
        held.plot(of_level["held"]["time"] - STANDING, -of_level["held"]["speed"], **style)
        braked.plot(ends[name]["time"], ends[name]["speed"], **style)
    braked.axhline(terminal_speed(), color=GREY, linewidth=0.8)
    held.set_xlim(-SETTLED / 4, SETTLED)
    started.legend()
    return figure


SCENARIO = Scenario(
    "gradient", "A bogie on gradients at all levels: rolling, braked, held and started, against closed forms", run
)
