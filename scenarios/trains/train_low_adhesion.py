"""A passenger train on a low rail: its first vehicles slide and clean the rail for the others, each with its
protection.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from products.train.consist import Consist, coach, locomotive
from products.train.train import Train
from rbd_model.track.friction import RailCondition, dry, low
from rbd_model.track.recovery import assumed_recovery
from scenarios.bench.train_runs import Course, follow, stands
from scenarios.reporting.plots import FOUR, LINES, plt, titled
from scenarios.reporting.progress import counting
from scenarios.reporting.report import Report, Row, at_least, at_most
from scenarios.scenario import Options, Scenario

COACHES, SPEED, INTERVAL = 7, 140 / 3.6, 0.02
#: Slip from which the protection vents, and below which it applies again [1]; between both it holds.
VENTS, APPLIES = 0.12, 0.04
#: Asked: no wheel locked so long [s] above this speed [m/s].
LOCKED, ABOVE = 0.4, 5.0


@dataclass(frozen=True)
class Way:
    """What the rail is like, whether wheels clean it, and whether protection is on."""

    rail: RailCondition
    cleaned: bool
    protected: bool


WAYS = {
    "dry": Way(dry(), False, True),
    "low, unprotected": Way(low(), True, False),
    "low, protected": Way(low(), True, True),
    "low, protected, rail stays dirty": Way(low(), False, True),
}


def train_of(rail: RailCondition) -> Train:
    """Locomotive and coaches; friction falls with sliding as that of the rail does (Polach 2005)."""
    law = rail.law.values()
    left, fall = law["friction_ratio"], law["friction_decay"]
    vehicles = (locomotive(), *[coach()] * COACHES)
    train = Train(Consist(tuple(replace(one, friction_left=left, friction_fall=fall) for one in vehicles)), speed=SPEED)
    train.inputs["friction"][:] = rail.friction
    return train


def frictions(train: Train, rail: np.ndarray, way: Way) -> np.ndarray:
    """Of each vehicle: those ahead clean by their energy of sliding per distance, as in rbd_model/track/recovery.py."""
    p = assumed_recovery()
    slid = np.abs(rail * (train.speed - train.wheel_speed)) / np.maximum(train.speed, 0.1)
    ahead = np.concatenate([[0.0], np.cumsum(p.left_behind * slid)[:-1]])
    gained = max(p.recovered_friction - way.rail.friction, 0.0)
    return (
        way.rail.friction + gained * (1.0 - np.exp(-ahead / p.recovery_energy))
        if way.cleaned
        else np.full(slid.size, way.rail.friction)
    )


@dataclass(frozen=True)
class Stop:
    """A stop: its course, frictions under each vehicle by interval, and its air [kg]."""

    course: Course
    friction: np.ndarray
    air: float

    def longest_lock(self) -> float:
        """Of any vehicle above ABOVE [s]."""
        locked = (self.course.wheel == 0.0) & (self.course.speed > ABOVE)
        longest = 0
        for column in locked.T:
            edges = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(int), [0]])))
            longest = max(longest, *(edges[1::2] - edges[::2]), 0)
        return float(longest * INTERVAL)


def stop(way: Way) -> Stop:
    """An emergency."""
    train = train_of(way.rail)
    train.drive("emergency")
    found: list[np.ndarray] = []

    def act(one: Train) -> bool:
        found.append(frictions(one, one.rail_force, way))
        one.inputs["friction"][:] = found[-1]
        if way.protected:
            speed = np.maximum(one.speed, 0.1)
            slip = (one.speed - one.wheel_speed) / speed
            command = np.where(slip > VENTS, 2.0, np.where(slip > APPLIES, 1.0, 0.0))
            one.inputs["protection"][:] = np.where(one.speed > 1.0, command, 0.0)
        return stands(one)

    course = follow(train, 200.0, INTERVAL, act)
    return Stop(course, np.array(found), train.air_used)


def run(options: Options) -> Report:
    found = {name: stop(way) for name, way in counting(WAYS.items(), "stops", unit="stop")}
    distance = {name: one.course.braking_distance for name, one in found.items()}
    shown = found["low, protected"]
    rise = shown.friction.mean(axis=0)
    source = f"above {ABOVE:g} m/s"
    rows = [
        Row("low, protected: longest lock", "s", None, shown.longest_lock(), at_most(LOCKED), source),
        Row(
            "low, unprotected: longest lock", "s", None, found["low, unprotected"].longest_lock(), at_least(1.0), source
        ),
        Row(
            "low, protected: friction under the last vehicle over the first",
            "1",
            None,
            float(rise[-1] / rise[0]),
            at_least(1.05),
            "it is cleaned",
        ),
        Row(
            "rail that stays dirty: distance over that of one that is cleaned",
            "1",
            None,
            distance["low, protected, rail stays dirty"] / distance["low, protected"],
            at_least(1.0),
            "more friction for those behind",
        ),
        Row(
            "rail that stays dirty: distance over v^2 / (2 mu g)",
            "1",
            None,
            distance["low, protected, rail stays dirty"] / (SPEED**2 / (2 * low().friction * 9.80665)),
            at_least(0.95),
            "no more than the rail gives, resistance aside",
        ),
    ]
    rows += [
        Row(f"{name}: stopping distance", "m", None, value, None, "from 140 km/h") for name, value in distance.items()
    ]
    rows += [Row(f"{name}: longest lock", "s", None, one.longest_lock(), None, source) for name, one in found.items()]
    for n, value in enumerate(rise, 1):
        rows.append(
            Row(f"low, protected: mean friction under vehicle {n}", "1", None, float(value), None, "assumed recovery")
        )
    said = [
        f"Cleaned by those ahead the train stops after {distance['low, protected']:.0f} m, on a rail that "
        f"stays dirty after {distance['low, protected, rail stays dirty']:.0f} m, dry after {distance['dry']:.0f} m.",
    ]
    seconds = float(sum(one.course.time[-1] for one in found.values()))
    parameters = {"coaches": COACHES, "speed": SPEED, "vents": VENTS, "applies": APPLIES}
    return Report(rows, shown.course.recording(), lambda: draw(found), parameters, seconds, said)


def draw(found: Mapping[str, Stop]) -> Figure:
    figure, grid = plt.subplots(1, 2, figsize=(10.0, 4.4))
    for line, colour, (name, one) in zip(LINES, FOUR, found.items(), strict=True):
        grid[0].plot(one.course.distance[:, 0], 3.6 * one.course.speed[:, 0], line, color=colour, label=name)
    grid[0].set(title="speed [km/h]", xlabel="distance of the head [m]")
    grid[0].legend(fontsize=8)
    shown = found["low, protected"]
    rise = shown.friction.mean(axis=0)
    numbers = np.arange(1, rise.size + 1)
    grid[1].bar(numbers, rise, color=FOUR[0])
    grid[1].set(title="low, protected: mean friction under each vehicle [1]", xlabel="vehicle, from the head")
    return titled(figure, f"Sliding wheels raise friction from {rise[0]:.3f} to {rise[-1]:.3f} for those behind")


SCENARIO = Scenario(
    "train-low-adhesion",
    "A passenger train on a low rail: the first vehicles clean it for the others, each protected",
    run,
)
