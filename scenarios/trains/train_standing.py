"""A train held on a gradient by air alone while its cylinders leak: the duration, against the closed form."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import quad

from bogie_braking.reporting.plots import FOUR, LINES, mark, panels
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, at_most, measured, near
from bogie_braking.reporting.scenario import Options, Scenario
from brake_controller.air import DISCHARGE
from brake_controller.distributors.uic import freight
from products.train.consist import Consist, block_train
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import Line
from scenarios.bench.train_runs import TrainCourse, follow, seconds_of

#: Gradients [1], diameters of the leaks of each cylinder, of which a quick run has the last [m], and wagons.
GRADIENTS, LEAKS, WAGONS = (0.01, 0.025), (0.5e-3, 1e-3), 20
#: Relative tolerance of the time at which the train begins to roll, and longest simulated time [s].
ASKED, LONGEST = 0.005, 4 * 3600.0
#: Largest speed of a vehicle while couplers stretch [m/s]: 1 cm in 10 s.
CREEP = 1e-3
AMBIENT, GAS, WARM = 101325.0, 287.05287, 293.15


def standing(gradient: float, leak: float) -> tuple[Train, TrainCourse]:
    """Run full service; then the driver's valve is shut off, the engine stops, and the pipe has no supply."""
    own = replace(freight(), cylinder_leak=leak)
    vehicles = tuple(replace(vehicle, distributor=own, valve_delay=-1.0) for vehicle in block_train(WAGONS).vehicles)
    rows = {"distance": np.array([-1e5, 1e5]), "gradient": np.full(2, gradient), "curvature": np.zeros(2)}
    train = Train(Consist(vehicles), cylinder=380e3, pipe=350e3, line=Line(rows), settings=Settings(cells=1))
    train.drive("shut-off")
    course = follow(train, LONGEST, 5.0, lambda one: bool(np.abs(one.speed).max() > 0.5))
    return train, course


def composite_at_rest(force: float) -> float:
    """Return the friction of a composite block at rest by its force [N], 0.44 (K + 20) / (4 K + 20), K in tf.

    RailProfAC has this rule, and takes 10 kN for a tf.
    """
    tf = force / 1e4
    return 0.44 * (tf + 20) / (4 * tf + 20)


def holding_pressure(gradient: float) -> float:
    """Return the mean gauge pressure [Pa] at which brakes and rolling resistance balance the weight along the track,
    statics.
    """
    train = block_train(WAGONS)
    slope = sum(one.mass * 9.80665 * gradient - one.resistance[0] for one in train.vehicles)

    def held(pressure: float) -> float:
        forces = 0.0
        for vehicle in train.vehicles:
            b = vehicle.brake
            pressed = b.efficiency * max(b.force_per_pressure * pressure - b.counter_force, 0.0)
            forces += pressed * (composite_at_rest(pressed / b.shoes) if b.friction_law else b.constant_friction)
        return forces

    low, high = 0.0, 380e3
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if held(middle) < slope else (low, middle)
    return high


def leaking(pressure: float, leak: float) -> float:
    """Return the mass flow [kg/s] through a hole of a diameter [m] into the open, isentropic and choked (Saint-Venant
    and Wantzel).
    """
    ratio = max(AMBIENT / pressure, (2 / 2.4) ** 3.5)
    shape = math.sqrt(7.0 * (ratio ** (2 / 1.4) - ratio ** (2.4 / 1.4)))
    return DISCHARGE * math.pi / 4 * leak**2 * pressure / math.sqrt(GAS * WARM) * shape


def time_on_paper(gradient: float, leak: float) -> float:
    """Return the time [s] from full cylinders to rolling: isothermal, V dp/dt = -R T G(p) of all volumes of the
    cylinder.

    First the reservoir falls to the cylinder's full pressure, which stays; then both fall together; below the pressure
    of the pipe, that of its vehicle falls with them.
    """
    own, full, pipe = freight(), 380e3 + AMBIENT, 350e3 + AMBIENT
    reservoir = 500e3 + AMBIENT
    length = block_train(WAGONS).length + 2 * 0.62 * (WAGONS + 1)
    of_pipe = math.pi / 4 * 0.03175**2 * length / (WAGONS + 1)
    volume = own.auxiliary_volume + own.cylinder_volume

    def time(volume: float, first: float, last: float) -> float:
        return float(volume / (GAS * WARM) * quad(lambda p: 1.0 / leaking(p, leak), last, first)[0])

    rolls = holding_pressure(gradient) + AMBIENT
    first = own.auxiliary_volume * (reservoir - full) / (GAS * WARM * leaking(full, leak))
    return first + time(volume, full, max(pipe, rolls)) + time(volume + of_pipe, pipe, min(pipe, rolls))


def run(options: Options, quick: bool = False) -> Report:
    leaks = LEAKS[-1:] if quick else LEAKS
    tries = [(gradient, leak) for gradient in GRADIENTS for leak in leaks]
    found = {one: standing(*one) for one in counting(tries, "standing", unit="train")}
    rows = []
    for (gradient, leak), (_, course) in found.items():
        name = f"{1e3 * gradient:g} permille, holes of {1e3 * leak:g} mm"
        moves = np.abs(course.speed).min(axis=1) > 0.0  # all: before, couplers stretch as the weakest brakes give way
        rolls = float(course.time[moves.argmax()]) if moves.any() else math.inf
        due = time_on_paper(gradient, leak)
        source = "isothermal leak of cylinder and reservoir, statics"
        rows.append(measured(f"{name}: rolls after", "s", rolls, source, near(due, ASKED * due)))
        before = course.speed[: max(int(moves.argmax()) - 1, 1)]
        creep = float(np.abs(before).max())
        rows.append(measured(f"{name}: speed before", "m/s", creep, "couplers stretch", at_most(CREEP)))
    drawn = found[GRADIENTS[-1], LEAKS[-1]]
    minutes = drawn[1].time[-1] / 60
    said = [
        f"With holes of {1e3 * LEAKS[-1]:g} mm in each cylinder air alone holds it on "
        f"{1e3 * GRADIENTS[-1]:g} permille for {minutes:.0f} minutes."
    ]
    seconds = seconds_of(course for _, course in found.values())
    parameters = {"wagons": WAGONS, "gradients": list(GRADIENTS), "leaks": list(leaks)}
    return Report(rows, drawn[1].recording(), lambda: draw(found), parameters, seconds, said)


def draw(found: dict[tuple[float, float], tuple[Train, TrainCourse]]) -> Figure:
    labels = ["pressure in the cylinders, mean [bar]", "speed of the head [m/s]"]
    held = [float(course.time[-1]) / 60 for _, course in found.values()]
    figure, axes = panels(f"Air alone holds the train for {min(held):.0f} to {max(held):.0f} minutes", labels, 2.6)
    for line, colour, ((gradient, leak), (_, course)) in zip(LINES, FOUR, found.items(), strict=False):
        label = f"{1e3 * gradient:g} ‰, holes of {1e3 * leak:g} mm"
        axes[0].plot(course.time, course.cylinder.mean(axis=1) / 1e5, line, color=colour, label=label)
        axes[1].plot(course.time, course.speed[:, 0], line, color=colour)
        mark(axes[1], float(course.time[-1]), "")
    axes[0].legend(fontsize=8)
    return figure


SCENARIO = Scenario(
    "train-standing", "A train held on a gradient by air alone while its cylinders leak: the duration", run
)
