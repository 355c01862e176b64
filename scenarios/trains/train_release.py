"""Release after full service: how late the end lets go, what an overcharge gains, and what runs through the
couplers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from products.train.train import Train
from scenarios.bench.train_runs import Course, follow, train_of
from scenarios.reporting.plots import FOUR, plt, titled
from scenarios.reporting.progress import counting
from scenarios.reporting.report import Report, Row, at_least, at_most, between
from scenarios.scenario import Options, Scenario

LENGTHS, SPEED = (400.0, 750.0, 1200.0), 80 / 3.6
#: Full service for so long, an overcharge for so long before running, and watched in all [s].
APPLIED, OVERCHARGED, WATCHED = 20.0, 10.0, 150.0
#: A cylinder is released [Pa]; position P releases a lone wagon in this time [s] (UIC 540).
RELEASED, WINDOW = 40e3, (15.0, 20.0)
WAYS = ("running", "overcharge")
DRAWN = 750.0


@dataclass(frozen=True)
class Release:
    """A course that begins with the release, and the train behind it."""

    train: Train
    course: Course

    def released(self) -> np.ndarray:
        """When each cylinder is empty [s]; infinity: not while it was watched."""
        empty = self.course.cylinder < RELEASED
        when = self.course.time[empty.argmax(axis=0)] - self.course.time[0]
        return np.where(empty.any(axis=0), when, np.inf)


def release(length: float, way: str) -> Release:
    """Full service, then the driver's valve in a position; an overcharge ends by itself after a while."""
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


def run(options: Options) -> Report:
    tries = [(length, way) for length in LENGTHS for way in WAYS]
    found = {one: release(*one) for one in counting(tries, "releases", unit="release")}
    rows = []
    for length in LENGTHS:
        plain, over = (found[length, way].released() for way in WAYS)
        late = float(plain[-1] - plain[0])
        rows.append(
            Row(f"{length:g} m: end releases behind the head", "s", None, late, at_least(0.0), "its pipe fills later")
        )
        gained = float(plain[-1] - over[-1])
        source = "more pressure at the head"
        rows.append(Row(f"{length:g} m: an overcharge gains at the end", "s", None, gained, at_least(0.0), source))
        first = float(plain.min())
        rows.append(Row(f"{length:g} m: first release", "s", None, first, between(*WINDOW), "UIC 540, P"))
    for (length, way), one in found.items():
        name = f"{length:g} m, {way}"
        rows += [
            Row(
                f"{name}: last cylinder below 0.4 bar",
                "s",
                None,
                float(one.released().max()),
                None,
                "from the release on",
            ),
            Row(
                f"{name}: largest tension",
                "kN",
                None,
                1e-3 * one.train.largest_tension,
                None,
                "with the application before",
            ),
            Row(f"{name}: air used", "kg", None, one.train.air_used, None, "through the driver's valve"),
        ]
    drawn = {way: found[DRAWN, way] for way in WAYS}
    again = float(max(one.course.cylinder[-1].max() for one in found.values()))
    rows.append(
        Row(
            "largest pressure in a cylinder at the end", "kPa", None, 1e-3 * again, at_most(1e-3 * RELEASED), "released"
        )
    )
    last = {way: float(drawn[way].released().max()) for way in WAYS}
    said = [
        f"{DRAWN:g} m are released after {last['running']:.0f} s, with an overcharge after {last['overcharge']:.0f} s."
    ]
    seconds = len(tries) * (APPLIED + WATCHED)
    parameters = {"speed": SPEED, "applied": APPLIED, "overcharged": OVERCHARGED}
    series = drawn["running"].course.recording()
    return Report(rows, series, lambda: draw(drawn), parameters, seconds, said)


def draw(drawn: Mapping[str, Release]) -> Figure:
    figure, grid = plt.subplots(1, 2, figsize=(10.0, 4.4), sharey=True)
    for axis, (way, one) in zip(grid, drawn.items(), strict=True):
        course, last = one.course, one.course.cylinder.shape[1] - 1
        for colour, (name, place) in zip(FOUR, {"head": 0, "middle": last // 2, "end": last}.items(), strict=False):
            time = course.time - course.time[0]
            axis.plot(time, course.pipe[:, place] / 1e5, color=colour, label=f"pipe, {name}")
            axis.plot(time, course.cylinder[:, place] / 1e5, "--", color=colour, label=f"cylinder, {name}")
        axis.set(title=f"released with the valve in {way}", xlabel="time from the release on [s]")
    grid[0].set_ylabel("gauge pressure [bar]")
    grid[1].legend(fontsize=8)
    plain, over = (float(drawn[way].released().max()) for way in WAYS)
    return titled(figure, f"With overcharge the train releases in {over:.0f} s, without in {plain:.0f} s")


SCENARIO = Scenario(
    "train-release", "Release after full service, with and without overcharge: how late the end lets go", run
)
