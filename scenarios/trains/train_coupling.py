"""A wagon runs against a standing train and couples: largest force over its speed, with screw couplers and draft
gears.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import FOUR, single
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Measure, Report, at_most, measured, near, rows_of
from bogie_braking.reporting.scenario import Options, Scenario
from products.train.consist import Consist, TrainVehicle, block_train
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import COUPLERS, Coupler
from scenarios.bench.mixed_train import spring
from scenarios.bench.train_runs import TrainCourse, follow

#: Speeds [m/s], standing vehicles, of which the first has its brake applied, and initial gap [m].
SPEEDS, STANDING, GAP = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0), 3, 1.0
#: Tolerances of a spring without friction against its closed form, and of couplings that last after the impact.
STIFFNESS, CLOSED = 10e6, 1e-3
LONG = 15.0


def impact(coupler: Coupler, speed: float, standing: int = STANDING) -> tuple[Train, TrainCourse]:
    """Run the last vehicle from behind, uncoupled; it is coupled at the first contact."""
    consist = Consist(block_train(standing, coupler=coupler).vehicles[: standing + 1])
    free = tuple(_rolling(vehicle, coupler) for vehicle in consist.vehicles)
    train = Train(Consist(free), settings=Settings(brake_model="delay", share=0.02))
    train.inputs["coupling_closed"][-1] = 0.0
    state = train.motion
    state[0, -1], state[1:3, -1] = -GAP, speed
    train.motion = state
    train.advance(1e-3)
    train.inputs["coupling_closed"][-1] = 1.0
    return train, follow(train, GAP / speed + LONG, 0.01)


def _rolling(train_vehicle: TrainVehicle, coupler: Coupler) -> TrainVehicle:
    """Return a vehicle that stands or rolls without resistance."""
    return replace(train_vehicle, mass=80e3, rotating_share=1e-9, resistance=(0.0, 0.0, 0.0), coupler=coupler)


MEASURES: tuple[Measure[Train], ...] = (
    Measure("compression", "kN", lambda train: 1e-3 * train.largest_compression),
    Measure("tension after it", "kN", lambda train: 1e-3 * train.largest_tension),
)


def run(options: Options, quick: bool = False) -> Report:
    names = ("screw", "draft-gear")
    tries = [(name, speed) for name in names for speed in SPEEDS]
    found = {(name, v): impact(COUPLERS[name](), v) for name, v in counting(tries, "impacts", unit="impact")}
    rows = []
    for speed in (SPEEDS[0], SPEEDS[-1]):
        train, _ = impact(spring(STIFFNESS), speed, standing=1)
        due, name = 1e-3 * speed * math.sqrt(STIFFNESS * 80e3 / 2), f"one against one on a spring, {speed:g} m/s"
        asked, value = near(due, CLOSED * due), 1e-3 * train.largest_compression
        rows.append(measured(f"{name}: compression", "kN", value, "v sqrt(k m / 2)", asked))
    for (name, speed), (train, course) in found.items():
        mass = np.array([vehicle.mass for vehicle in train.consist.vehicles])
        kept = abs(mass @ course.speed[-1] / (mass[-1] * speed) - 1.0)
        rows.append(measured(f"{name}, {speed:g} m/s: momentum that is missing", "1", kept, "Newton", at_most(1e-9)))
    trains = {f"{name}, {speed:g} m/s": train for (name, speed), (train, _) in found.items()}
    rows += rows_of(trains, *MEASURES)
    force = {name: [found[name, v][0].largest_compression for v in SPEEDS] for name in names}
    screw, gear = (1e-3 * force[name][-1] for name in names)
    said = [f"At 3 m/s side buffers take {screw:.0f} kN, draft gears {gear:.0f} kN: their strokes are used up."]
    parameters, series = {"standing": STANDING, "mass": 80e3, "gap": GAP}, found["screw", 2.0][1].recording()
    return Report(rows, series, lambda: draw(force), parameters, LONG * len(tries), said)


def draw(force: dict[str, list[float]]) -> Figure:
    screw, gear = (1e-3 * values[-1] for values in force.values())
    message = f"At {SPEEDS[-1]:g} m/s side buffers take {screw:.0f} kN, draft gears {gear:.0f} kN"
    figure, axis = single(message, "speed [m/s]", "largest compression [kN]")
    for colour, mark, (name, values) in zip((FOUR[0], FOUR[3]), "os", force.items(), strict=True):
        axis.plot(SPEEDS, [value / 1e3 for value in values], mark + "-", color=colour, label=name)
    axis.legend()
    return figure


SCENARIO = Scenario(
    "train-coupling", "A wagon runs against a standing train and couples: largest forces over its speed", run
)
