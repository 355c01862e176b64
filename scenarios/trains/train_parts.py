"""A train parts on the way: the hose opens, both parts brake, and the gap between them grows or closes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from products.train.train import Train
from scenarios.bench.train_runs import Course, follow, stands, train_of
from scenarios.reporting.plots import FOUR, panels
from scenarios.reporting.progress import counting
from scenarios.reporting.report import Report, Row, at_most
from scenarios.scenario import Options, Scenario

LENGTH, SPEED = 500.0, 80 / 3.6
#: Where it parts, as a share of the vehicles; the driver shuts his valve off so late, or never [s].
PLACES, SHUT = (0.2, 0.5, 0.8), (2.0, np.inf)
#: A cylinder that brakes [Pa], and the time within which all do [s].
BRAKES, SOON = 100e3, 12.0


@dataclass(frozen=True)
class Parting:
    """Which coupling opened, and the course from then on."""

    coupling: int
    course: Course
    train: Train

    @property
    def gap(self) -> np.ndarray:
        """Between both parts [m]."""
        ahead, behind = (self.course.distance[:, self.coupling + one] for one in (0, 1))
        return np.asarray(ahead - behind - (ahead[0] - behind[0]))

    @property
    def all_brake(self) -> float:
        """When every cylinder brakes [s]."""
        on = (self.course.cylinder > BRAKES).all(axis=1)
        return float(self.course.time[on.argmax()]) if on.any() else np.inf


def part(place: float, shut: float) -> Parting:
    """Runs, parts, and stops; behind the head's valve air is lost until it is shut off."""
    train = Train(train_of(LENGTH), speed=SPEED)
    coupling = round(place * (len(train.consist.vehicles) - 1)) - 1
    train.inputs["coupled"][coupling], train.inputs["joined"][coupling] = 0.0, 2.0

    def act(one: Train) -> bool:
        if one.time >= shut:
            one.drive("shut-off")
        return stands(one)

    return Parting(coupling, follow(train, 200.0, 0.1, act), train)


def run(options: Options) -> Report:
    tries = [(place, shut) for place in PLACES for shut in SHUT]
    found = {one: part(*one) for one in counting(tries, "partings", unit="run")}
    rows = []
    for (place, shut), one in found.items():
        when = "shut off after 2 s" if np.isfinite(shut) else "left in running"
        name = f"parts at {100 * place:g} %, valve {when}"
        asked = at_most(SOON) if np.isfinite(shut) else None
        all_brake = one.all_brake if np.isfinite(one.all_brake) else None
        rows.append(Row(f"{name}: all brake after", "s", None, all_brake, asked, "both ends of the hose are open"))
        behind = float(one.course.time[(one.course.speed[:, one.coupling + 1] == 0).argmax()])
        rows.append(Row(f"{name}: the rear part stands after", "s", None, behind, None, ""))
        rows.append(Row(f"{name}: gap at the end", "m", None, float(one.gap[-1]), None, "below 0: they have met"))
        met = 1e-3 * float(-one.course.force[:, one.coupling].min())
        rows.append(Row(f"{name}: they meet with", "kN", None, met, None, "0: they do not"))
        rows.append(Row(f"{name}: air that the head's valve lost", "kg", None, one.train.air_used, None, ""))
    drawn = found[PLACES[1], SHUT[0]]
    kept = found[PLACES[1], SHUT[1]]
    said = [
        f"Parting in the middle brings both parts to rest {drawn.gap[-1]:.1f} m apart; a valve that goes on feeding "
        f"leaves {kept.gap[-1]:.1f} m, as the head brakes less.",
    ]
    seconds = float(sum(one.course.time[-1] for one in found.values()))
    parameters = {"length": LENGTH, "speed": SPEED}
    return Report(rows, drawn.course.recording(), lambda: draw(drawn, kept), parameters, seconds, said)


def draw(shut: Parting, kept: Parting) -> Figure:
    labels = ["pressure in the pipe beside the parted hose [bar]", "speed of both parts [km/h]", "gap between them [m]"]
    message = f"Parts stand {shut.gap[-1]:.0f} m apart, with the valve left open {kept.gap[-1]:.0f} m"
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
    "train-parts", "A hose and a coupling part on the way: both parts brake, and how far apart they stop", run
)
