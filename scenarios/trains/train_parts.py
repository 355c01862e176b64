"""A train parts while running: the hose opens, both parts brake, and the gap between them grows or closes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import FOUR, panels
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from products.train.train import Train
from scenarios.bench.train_runs import TrainCourse, follow, seconds_of, stands, train_of

LENGTH, SPEED = 500.0, 80 / 3.6
#: Places of parting, as a share of the vehicles; time at which the driver shuts the valve off, or infinity [s].
PLACES, SHUT = (0.2, 0.5, 0.8), (2.0, np.inf)
#: Pressure of a cylinder that brakes [Pa], and limit of the time within which all do [s].
BRAKES, SOON = 100e3, 12.0


@dataclass(frozen=True)
class Parting:
    """The open coupling, and the course from then on."""

    coupling: int
    course: TrainCourse
    train: Train

    @property
    def gap(self) -> np.ndarray:
        """Return the gap between both parts [m]."""
        ahead, behind = (self.course.distance[:, self.coupling + one] for one in (0, 1))
        return np.asarray(ahead - behind - (ahead[0] - behind[0]))

    @property
    def all_brake(self) -> float:
        """Return the time at which every cylinder brakes [s]."""
        on = (self.course.cylinder > BRAKES).all(axis=1)
        return float(self.course.time[on.argmax()]) if on.any() else np.inf


def part(place: float, shut: float) -> Parting:
    """Run, part, and stop; air is lost through the head's valve until it is shut off."""
    train = Train(train_of(LENGTH), speed=SPEED)
    coupling = round(place * (len(train.consist.vehicles) - 1)) - 1
    train.inputs["coupling_closed"][coupling], train.inputs["hose_state"][coupling] = 0.0, 2.0

    def act(one: Train) -> bool:
        if one.time >= shut:
            one.drive("shut-off")
        return stands(one)

    return Parting(coupling, follow(train, 200.0, 0.1, act), train)


def run(options: Options, quick: bool = False) -> Report:
    tries = [(place, shut) for place in PLACES for shut in SHUT]
    found = {one: part(*one) for one in counting(tries, "partings", unit="run")}
    rows = []
    for (place, shut), one in found.items():
        closed, course = np.isfinite(shut), one.course
        name = f"parts at {100 * place:g} %, valve {'shut off after 2 s' if closed else 'left in running'}"
        all_brake = one.all_brake if np.isfinite(one.all_brake) else None
        source, asked = "both ends of the hose are open", at_most(SOON) if closed else None
        behind = course.time[(course.speed[:, one.coupling + 1] == 0).argmax()]
        met = 1e-3 * -course.force[:, one.coupling].min()
        rows += [
            measured(f"{name}: all brake after", "s", all_brake, source, asked),
            measured(f"{name}: the rear part stands after", "s", behind),
            measured(f"{name}: gap at the end", "m", one.gap[-1], "below 0: they have met"),
            measured(f"{name}: they meet with", "kN", met, "0: they do not"),
            measured(f"{name}: air that the head's valve lost", "kg", one.train.air_used),
        ]
    drawn, kept = (found[PLACES[1], shut] for shut in SHUT)
    said = [
        f"Parting in the middle brings both parts to rest {drawn.gap[-1]:.1f} m apart; a valve that goes on feeding "
        f"leaves {kept.gap[-1]:.1f} m, as the head brakes less.",
    ]
    parameters, seconds = {"length": LENGTH, "speed": SPEED}, seconds_of(one.course for one in found.values())
    return Report(rows, drawn.course.recording(), lambda: draw(drawn, kept), parameters, seconds, said)


def draw(shut: Parting, kept: Parting) -> Figure:
    labels = ["pressure in the pipe beside the parted hose [bar]", "speed of both parts [km/h]", "gap between them [m]"]
    message = f"From {3.6 * SPEED:.0f} km/h parts stand {shut.gap[-1]:.0f} m apart, valve open {kept.gap[-1]:.0f} m"
    figure, axes = panels(message, labels)
    for one, style, name in ((shut, "-", "shut off after 2 s"), (kept, "--", "left in running")):
        time, course = one.course.time, one.course
        for colour, place, part_name in ((FOUR[0], one.coupling, "head"), (FOUR[3], one.coupling + 1, "rear")):
            label = f"{part_name}, valve {name}"
            axes[0].plot(time, course.pipe[:, place] / 1e5, style, color=colour, label=label)
            axes[1].plot(time, 3.6 * course.speed[:, place], style, color=colour)
        axes[2].plot(time, one.gap, style, color="#333333", label=f"valve {name}")
    axes[0].legend(fontsize=8)
    axes[2].legend(fontsize=8)
    return figure


SCENARIO = Scenario(
    "train-parts",
    "A hose and a coupling part during a run: both parts brake, and the distance between them at rest",
    run,
)
