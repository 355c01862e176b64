"""Emergency stops over the friction of the rail: wheels alone, with magnets, with eddy currents.

A vehicle alone is checked against integrals and statics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import quad

from bogie_braking.reporting.plots import FOUR, LINES, single
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, at_least, at_most, between, measured
from bogie_braking.reporting.scenario import Options, Scenario
from products.train.consist_file import consist_of
from products.train.train import Train
from rbd_model.track.line import Line
from scenarios.bench.train_runs import TrainCourse, follow, seconds_of
from scenarios.bench.train_runs import stop as stopped

#: Friction between wheels and rail [1], the one of the message, and of a quick run; speed at the start [m/s].
FRICTIONS, LOW, SPEED = (0.02, 0.03, 0.05, 0.075, 0.1, 0.15), 0.05, 160 / 3.6
#: Coaches of the train, and their additional brakes: four magnets of 50 kN, or an eddy-current brake of 30 kN.
COACHES = 5
BRAKES: dict[str, dict[str, Any]] = {
    "wheels alone": {},
    "with magnets": {"magnetic_attraction": 200.0},
    "with eddy currents": {"eddy_force": 30.0},
}
#: Mass of a coach [kg], with its rotating masses, and standard gravity [m/s2].
MASS, TURNING, G = 46e3, 1.04 * 46e3, 9.80665
#: Relative tolerance of a distance against its integral with steps of 5 ms, and of a gradient that is held.
NEAR, SHARP = 1e-4, 1e-6
#: Deceleration by magnets that is reported of the train X2000 [m/s2], and its speed [m/s].
X2000, FAST = 0.4, 200 / 3.6


def train_of(row: Mapping[str, Any], friction: float) -> Train:
    """Return a locomotive and coaches whose protection is ideal: friction does not fall with sliding."""
    found = consist_of([{"kind": "locomotive"}, {"kind": "coach", "count": COACHES, **row}])
    train = Train(found, speed=SPEED)
    train.inputs["friction"] = friction
    train.drive("emergency")
    return train


def magnets(speed: float) -> float:
    """Return the force of the magnets of a coach [N], whose friction is 0.25 at rest and 0.15 at 50 km/h."""
    return 200e3 * (0.05 + 0.2 * 50.0 / (50.0 + 3.6 * speed))


def eddies(speed: float) -> float:
    """Return the force of the eddy-current brake of a coach [N], with its peak at 100 km/h."""
    return 30e3 * 2.0 * (3.6 * speed / 100.0) / (1.0 + (3.6 * speed / 100.0) ** 2)


def alone(row: Mapping[str, Any], begin: float, end: float) -> TrainCourse:
    """Slow a coach without any other brake and resistance between two speeds [m/s], on a rail of friction 0.02."""
    bare = {"kind": "coach", "valve": "head", "brake": "none", "resistance_a": 0.0}
    rises = {name: 0.0 for name in ("magnetic_rise", "eddy_rise") if name.partition("_")[0] in "".join(row)}
    train = Train(consist_of([bare | rises | dict(row)]), speed=begin)
    train.inputs["friction"], train.inputs["track_brake"] = 0.02, 1.0
    return follow(train, 600.0, 0.005, lambda one: bool(one.speed[0] <= end))


def excess(row: Mapping[str, Any], force: Callable[[float], float], begin: float, end: float) -> float:
    """Return the relative error of that distance against int m v / F dv."""
    course = alone(row, begin, end)
    due = quad(lambda v: TURNING * v / force(v), course.speed[-1, 0], begin, epsabs=1e-9)[0]
    return abs(course.braking_distance / due - 1.0)


def moves(share: float, gradient: float = 0.04) -> float:
    """Return the speed [m/s] after 10 s on a gradient, parked with a share of m g i."""
    line = Line({"distance": np.array([-1e5, 1e5]), "gradient": np.full(2, gradient)})
    bare = {"kind": "coach", "valve": "head", "brake": "none", "resistance_a": 0.0}
    train = Train(consist_of([bare | {"parking_gradient": 1e3 * share * gradient}]), line=line)
    train.inputs["parking_brake"] = 1.0
    train.advance(10.0)
    return abs(float(train.speed[0]))


def run(options: Options, quick: bool = False) -> Report:
    frictions = (LOW,) if quick else FRICTIONS
    tries = [(name, friction) for name in BRAKES for friction in frictions]
    found = {one: stopped(train_of(BRAKES[one[0]], one[1])) for one in counting(tries, "stops", unit="stop")}
    distance = {one: course.braking_distance for one, course in found.items()}
    wheels, magnetic, eddy = ({f: distance[name, f] for f in frictions} for name in BRAKES)
    integral = "int m v / F dv, on a rail of friction 0.02"
    slowed = alone({"magnetic_attraction": 188.0}, FAST, 20 / 3.6)
    mean = (FAST**2 - slowed.speed[-1, 0] ** 2) / (2 * slowed.braking_distance)
    rows = [
        measured(
            "magnets alone, 160 to 20 km/h: error of the distance",
            "1",
            excess(BRAKES["with magnets"], magnets, SPEED, 20 / 3.6),
            integral,
            at_most(NEAR),
        ),
        measured(
            "eddy currents alone, 160 to 20 km/h: error of the distance",
            "1",
            excess(BRAKES["with eddy currents"], eddies, SPEED, 20 / 3.6),
            integral,
            at_most(NEAR),
        ),
        measured(
            "magnets of 47 kN, 200 to 20 km/h: mean deceleration", "m/s2", mean, f"X2000: {X2000:g}", between(0.3, 0.5)
        ),
        measured("parked with 1 + 1e-6 of m g i: speed", "m/s", moves(1 + SHARP), "statics", at_most(0.0)),
        measured("parked with 1 - 1e-6 of m g i: speed", "m/s", moves(1 - SHARP), "statics", at_least(1e-7)),
        measured(
            f"friction {LOW:g}: distance of wheels alone over that with magnets",
            "1",
            wheels[LOW] / magnetic[LOW],
            "magnets act where wheels slide",
            at_least(1.5),
        ),
    ]
    for (name, friction), value in distance.items():
        rows.append(measured(f"{name}, friction {friction:g}: stopping distance", "m", value, "from 160 km/h"))
    said = [
        f"At friction {LOW:g} the train stops after {wheels[LOW]:.0f} m, with magnets after {magnetic[LOW]:.0f} m, "
        f"with eddy currents after {eddy[LOW]:.0f} m."
    ]
    parameters = {"speed": SPEED, "coaches": COACHES, "magnetic_attraction": 200e3, "eddy_force": 30e3}
    series = found["with magnets", LOW].recording()
    return Report(rows, series, lambda: draw(distance), parameters, seconds_of(found.values()), said)


def draw(distance: Mapping[tuple[str, float], float]) -> Figure:
    low = {name: distance[name, LOW] for name in BRAKES}
    message = f"At friction {LOW:g} magnets shorten stops from {low['wheels alone']:.0f} to {low['with magnets']:.0f} m"
    figure, axis = single(message, "friction between wheels and rail [1]", "stopping distance from 160 km/h [m]")
    for line, colour, name in zip(LINES, (FOUR[0], FOUR[3], FOUR[2]), BRAKES, strict=False):
        by_friction = {friction: one for (brake, friction), one in distance.items() if brake == name}
        axis.plot(list(by_friction), list(by_friction.values()), line, color=colour, marker="o", label=name)
    axis.set_ylim(0.0, None)
    axis.legend()
    return figure


SCENARIO = Scenario("track-brakes", "Emergency stops on low rails: wheels alone, with magnets, with eddy currents", run)
