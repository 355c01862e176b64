"""Release after full service: delay at the end of the train, gain by an overcharge, and forces of the couplers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import FOUR, charts, one_word
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Measure, Report, at_least, at_most, between, measured, rows_of
from bogie_braking.reporting.scenario import Options, Scenario
from products.train.train import Train
from scenarios.bench.train_runs import TrainCourse, follow, train_of

LENGTHS, SPEED = (400.0, 750.0, 1200.0), 80 / 3.6
#: Duration of full service, of an overcharge before running, and of the simulation [s].
APPLIED, OVERCHARGED, WATCHED = 20.0, 10.0, 150.0
#: Pressure of a released cylinder [Pa]; release time of a lone wagon in position P (UIC 540) [s].
RELEASED, WINDOW = 40e3, (15.0, 20.0)
WAYS = ("running", "overcharge")
DRAWN = 750.0
GAINS = "an overcharge gains at the end"


@dataclass(frozen=True)
class Release:
    """A course that begins with the release, and the train at its end."""

    train: Train
    course: TrainCourse

    def released(self) -> np.ndarray:
        """Return the time at which each cylinder is empty [s]; infinity: not within the simulated time."""
        empty = self.course.cylinder < RELEASED
        when = self.course.time[empty.argmax(axis=0)] - self.course.time[0]
        return np.where(empty.any(axis=0), when, np.inf)


MEASURES: tuple[Measure[Release], ...] = (
    Measure("last cylinder below 0.4 bar", "s", lambda one: one.released().max(), "from the release on"),
    Measure("largest tension", "kN", lambda one: 1e-3 * one.train.largest_tension, "with the application before"),
    Measure("air used", "kg", lambda one: one.train.air_used, "through the driver's valve"),
)


def release(length: float, way: str) -> Release:
    """Run full service, then a position of the driver's valve; an overcharge ends by itself after a while."""
    train = Train(train_of(length), speed=SPEED)
    train.drive("service", 1.0)
    train.advance(APPLIED)
    train.drive(way)
    begin = train.time

    def act(one: Train) -> bool:
        if way == "overcharge" and one.time - begin >= OVERCHARGED:
            one.drive("running")
        return False

    return Release(train, follow(train, WATCHED, 0.1, act))


def run(options: Options, quick: bool = False) -> Report:
    tries = [(length, way) for length in LENGTHS for way in WAYS]
    found = {one: release(*one) for one in counting(tries, "releases", unit="release")}
    rows = []
    for length in LENGTHS:
        plain, over = (found[length, way].released() for way in WAYS)
        late, gained, name = plain[-1] - plain[0], plain[-1] - over[-1], f"{length:g} m"
        rows += [
            measured(f"{name}: end releases behind the head", "s", late, "its pipe fills later", at_least(0.0)),
            measured(
                f"{name}: an overcharge gains at the end", "s", gained, "more pressure at the head", at_least(0.0)
            ),
            measured(f"{name}: first release", "s", plain.min(), "UIC 540, P", between(*WINDOW)),
        ]
    rows += rows_of({f"{length:g} m, {way}": one for (length, way), one in found.items()}, *MEASURES)
    again, asked = 1e-3 * max(one.course.cylinder[-1].max() for one in found.values()), at_most(1e-3 * RELEASED)
    rows.append(measured("largest pressure in a cylinder at the end", "kPa", again, "released", asked))
    drawn = {way: found[DRAWN, way] for way in WAYS}
    plain, over = (one.released().max() for one in drawn.values())
    said = [f"{DRAWN:g} m are released after {plain:.0f} s, with an overcharge after {over:.0f} s."]
    parameters = {"speed": SPEED, "applied": APPLIED, "overcharged": OVERCHARGED}
    series, seconds = drawn["running"].course.recording(), len(tries) * (APPLIED + WATCHED)
    return Report(rows, series, lambda: draw(drawn), parameters, seconds, said)


def draw(drawn: Mapping[str, Release]) -> Figure:
    plain, over = (one.released().max() for one in drawn.values())
    message = f"Trains of {one_word(f'{DRAWN:g} m')} release in {plain:.0f} s, with overcharge in {over:.0f} s"
    titles = [f"released with the valve in {way}" for way in drawn]
    figure, axes = charts(message, titles, (10.0, 4.4), "time from the release on [s]", sharey=True)
    for axis, one in zip(axes, drawn.values(), strict=True):
        course, last = one.course, one.course.cylinder.shape[1] - 1
        for colour, (name, place) in zip(FOUR, {"head": 0, "middle": last // 2, "end": last}.items(), strict=False):
            time = course.time - course.time[0]
            axis.plot(time, course.pipe[:, place] / 1e5, color=colour, label=f"pipe, {name}")
            axis.plot(time, course.cylinder[:, place] / 1e5, "--", color=colour, label=f"cylinder, {name}")
    axes[0].set_ylabel("gauge pressure [bar]")
    axes[1].legend(fontsize=8)
    return figure


SCENARIO = Scenario(
    "train-release", "Release after full service, with and without overcharge: delay at the end of the train", run
)
