"""The same command to trains with different brakes: pressures along the train, distances, coupler forces.

A locomotive without a brake and 60 loaded cars, with couplers and blocks that are equal; only the distributors differ.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bogie_braking.reporting.plots import FOUR, LINES, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, Row, at_least, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from fmu_src.cosimulation.recording import Recording
from products.train.consist_file import consist_of
from products.train.train import Train
from scenarios.bench.train_pressures import draw_pressures
from scenarios.bench.train_runs import TrainCourse, seconds_of, stop

CARS, SPEED, LOOK = 60, 80.0 / 3.6, 5.0
#: Time to which pressures are drawn [s].
DRAWN = 25.0
#: Commands: position of the driver's valve, and step.
COMMANDS = {"full service": ("service", 1.0), "emergency": ("emergency", 0.0)}
#: Names of brakes, and their distributors.
BRAKES = {"UIC": "uic", "EP-UIC": "ep_uic", "AAR": "aar", "ECP": "ecp"}
#: Cylinder of each car, that of the built-in wagon: with UIC distributors or others only these differ.
CYLINDER = {"cylinder_diameter": 406, "rigging_ratio": 5.65}
#: Share of the last pressure of its cylinder at which a vehicle brakes.
HALF = 0.5


@dataclass(frozen=True)
class TrainStop:
    """A stop: its course, and the largest compression of a coupler [N]."""

    course: TrainCourse
    compression: float

    def at(self, of: str, time: float) -> NDArray[np.float64]:
        """Return pressures of the cars at a time [bar]: of `pipe` or `cylinder`."""
        row = int(np.argmin(np.abs(self.course.time - time)))
        return np.asarray(getattr(self.course, of)[row, 1:] / 1e5)

    @property
    def last_brakes(self) -> float:
        """Return the time at which the last car has half of its pressure [s]."""
        last = self.course.cylinder[:, -1]
        return float(self.course.time[np.argmax(last > HALF * last.max())])


def run_of(brake: str, command: str) -> TrainStop:
    """Return a stop of a train of equal cars."""
    cars = {"kind": "wagon", "count": CARS, "load": 60, "distributor": BRAKES[brake], "coupler": "draft-gear"}
    cars |= CYLINDER
    head = {"kind": "locomotive", "brake": "none", "coupler": "draft-gear"}
    train = Train(consist_of([head, cars]), speed=SPEED)
    train.drive(*COMMANDS[command])
    return TrainStop(stop(train), train.largest_compression)


def run(options: Options, quick: bool = False) -> Report:
    tries = [(brake, command) for command in COMMANDS for brake in BRAKES]
    found = {one: run_of(*one) for one in counting(tries, "trains", unit="train")}
    rows: list[Row] = []
    for (brake, command), one in found.items():
        name = f"{brake}, {command}"
        rows += [
            measured(f"{name}: distance", "m", one.course.braking_distance, "from 80 km/h"),
            measured(f"{name}: last car has half its pressure after", "s", one.last_brakes),
            measured(f"{name}: largest compression", "kN", 1e-3 * one.compression),
        ]
    wired = found["ECP", "full service"].at("cylinder", LOOK)
    rows.append(measured("ECP: last cylinder over the first", "1", wired[-1] / wired[0], "by wire", at_least(0.99)))
    for command in COMMANDS:
        air, wire = (found[brake, command] for brake in ("AAR", "ECP"))
        shorter = wire.course.braking_distance / air.course.braking_distance
        rows.append(measured(f"ECP over AAR, {command}: distance", "1", shorter, "at most as long", at_most(1.0)))
    calm = [one.compression for (brake, _), one in found.items() if brake in ("EP-UIC", "ECP")]
    pushed = [one.compression for (brake, _), one in found.items() if brake in ("UIC", "AAR")]
    rows.append(measured("largest compression, by wire over by air", "1", max(calm) / min(pushed), "", at_most(0.5)))
    parameters = {"cars": CARS, "speed": SPEED, "look": LOOK}
    seconds = seconds_of(one.course for one in found.values())
    figures = {"pressures": lambda: draw_courses(found)}
    return Report(
        rows, series_of(found), lambda: draw(found), parameters, seconds, [MESSAGE + "."], other_figures=figures
    )


#: Message of the figure.
MESSAGE = "By wire all cars brake at once, and couplers hardly push"


def series_of(found: dict[tuple[str, str], TrainStop]) -> Recording:
    """Return the pressures along the train."""
    series = Recording({"car": "1"}, np.arange(1.0, CARS + 1.0)[:, None])
    for (brake, command), one in found.items():
        for of in ("pipe", "cylinder"):
            series.add(f"{of} after {LOOK:g} s ({brake}, {command})", "bar", one.at(of, LOOK))
    return series


def draw(found: dict[tuple[str, str], TrainStop]) -> Figure:
    titles = {f"full service, pipe after {LOOK:g} s [bar]": "car, from the head"}
    titles[f"full service, cylinders after {LOOK:g} s [bar]"] = "car, from the head"
    titles["stopping distance from 80 km/h [m]"] = ""
    titles["largest compression [kN]"] = ""
    figure, (pipe, cylinder, distance, force) = charts(MESSAGE, titles, (10.0, 7.0))
    car = np.arange(1, CARS + 1)
    for line, colour, brake in zip(LINES, FOUR, BRAKES, strict=False):
        one = found[brake, "full service"]
        pipe.plot(car, one.at("pipe", LOOK), line, color=colour, label=brake)
        cylinder.plot(car, one.at("cylinder", LOOK), line, color=colour, label=brake)
    pipe.legend(fontsize=8, loc=(0.68, 0.14))
    places = np.arange(len(BRAKES))
    for shift, colour, command in zip((-0.2, 0.2), FOUR, COMMANDS, strict=False):
        stops = [found[brake, command] for brake in BRAKES]
        distance.bar(places + shift, [one.course.braking_distance for one in stops], 0.38, color=colour, label=command)
        force.bar(places + shift, [1e-3 * one.compression for one in stops], 0.38, color=colour, label=command)
    for axis in (distance, force):
        axis.set_xticks(places, list(BRAKES))
    distance.legend(fontsize=8)
    return figure


def draw_courses(found: dict[tuple[str, str], TrainStop]) -> Figure:
    """Return the pressures of full service over time and along the train, a column for each brake."""
    titles = {f"{brake}: pipe": "" for brake in BRAKES} | {f"{brake}: cylinders": "time [s]" for brake in BRAKES}
    message = "By air a wave applies brakes, by wire they apply at once"
    figure, axes = charts(message, titles, (11.0, 6.0), columns=len(BRAKES), sharex=True, sharey=True)
    for row, (of, ends) in enumerate({"pipe": (3.0, 5.0), "cylinder": (0.0, 4.0)}.items()):
        those = axes[row * len(BRAKES) : (row + 1) * len(BRAKES)]
        for axis, brake in zip(those, BRAKES, strict=True):
            shades = draw_pressures(axis, found[brake, "full service"].course, of, DRAWN, ends)
        those[0].set_ylabel("behind the head [m]")
        figure.colorbar(shades, ax=those, label="bar")
    return figure


SCENARIO = Scenario(
    "train-brakes", "The same command to trains with UIC, EP-UIC, AAR and ECP brakes: pressures, distances, forces", run
)
