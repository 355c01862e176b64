"""A passenger train on a low rail: its first vehicles slide and clean the rail for the others, each with the built-in
protection.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from bogie_braking.reporting.plots import FOUR, LINES, charts
from bogie_braking.reporting.progress import counting
from bogie_braking.reporting.report import Report, at_least, at_most, measured
from bogie_braking.reporting.scenario import Options, Scenario
from products.train.consist_file import consist_of
from products.train.train import Train
from rbd_model.track.friction import RailCondition, dry, low
from rbd_model.track.recovery import assumed_recovery
from scenarios.bench.train_runs import TrainCourse, follow, seconds_of, stands

COACHES, SPEED, INTERVAL = 7, 140 / 3.6, 0.02
#: Limit: duration of a lock [s] above this speed [m/s].
LOCKED, ABOVE = 0.4, 5.0


@dataclass(frozen=True)
class Way:
    """Condition of the rail, and whether wheels clean it and protection is on."""

    rail: RailCondition
    cleaned: bool
    protected: bool


WAYS = {
    "dry": Way(dry(), False, True),
    "low, unprotected": Way(low(), True, False),
    "low, protected": Way(low(), True, True),
    "low, protected, rail stays dirty": Way(low(), False, True),
}


def train_of(way: Way) -> Train:
    """Return a locomotive and coaches; friction falls with sliding as that of the rail does (Polach 2005)."""
    law = way.rail.law.values()
    own: dict[str, Any] = {name: law[name] for name in ("friction_ratio", "friction_decay")}
    own["protection"] = "built-in" if way.protected else "none"
    train = Train(consist_of([{"kind": "locomotive"} | own, {"kind": "coach", "count": COACHES} | own]), speed=SPEED)
    train.inputs["friction"][:] = way.rail.friction
    return train


def frictions(train: Train, rail: np.ndarray, way: Way) -> np.ndarray:
    """Return the friction under each vehicle.

    Those ahead clean by their sliding energy per distance, as in rbd_model/track/recovery.py.
    """
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
class LowAdhesionStop:
    """A stop: its course, frictions under each vehicle by interval, and its air [kg]."""

    course: TrainCourse
    friction: np.ndarray
    air: float

    def longest_lock(self) -> float:
        """Return the longest lock of any vehicle above ABOVE [s]."""
        locked = (self.course.wheel == 0.0) & (self.course.speed > ABOVE)
        longest = 0
        for column in locked.T:
            edges = np.flatnonzero(np.diff(np.concatenate([[0], column.astype(int), [0]])))
            longest = max(longest, *(edges[1::2] - edges[::2]), 0)
        return float(longest * INTERVAL)


def stop(way: Way) -> LowAdhesionStop:
    """Run an emergency."""
    train = train_of(way)
    train.drive("emergency")
    found: list[np.ndarray] = []

    def act(one: Train) -> bool:
        found.append(frictions(one, one.rail_force, way))
        one.inputs["friction"][:] = found[-1]
        return stands(one)

    course = follow(train, 200.0, INTERVAL, act)
    return LowAdhesionStop(course, np.array(found), train.air_used)


def run(options: Options, quick: bool = False) -> Report:
    found = {name: stop(way) for name, way in counting(WAYS.items(), "stops", unit="stop")}
    distance = {name: one.course.braking_distance for name, one in found.items()}
    protected, dirty = "low, protected", "low, protected, rail stays dirty"
    shown, stays, source = found[protected], "rail that stays dirty: distance over", f"above {ABOVE:g} m/s"
    rise, locks = shown.friction.mean(axis=0), {name: one.longest_lock() for name, one in found.items()}
    unprotected, last = locks["low, unprotected"], f"{protected}: friction under the last vehicle over the first"
    rolls, gives = distance[dirty] / distance[protected], distance[dirty] / (SPEED**2 / (2 * low().friction * 9.80665))
    enough = "no more than the rail gives, resistance aside"
    rows = [
        measured(f"{protected}: longest lock", "s", locks[protected], source, at_most(LOCKED)),
        measured("low, unprotected: longest lock", "s", unprotected, source, at_least(1.0)),
        measured(last, "1", rise[-1] / rise[0], "it is cleaned", at_least(1.05)),
        measured(f"{stays} that of one that is cleaned", "1", rolls, "more friction for those behind", at_least(1.0)),
        measured(f"{stays} v^2 / (2 mu g)", "1", gives, enough, at_least(0.95)),
        *(measured(f"{name}: stopping distance", "m", value, "from 140 km/h") for name, value in distance.items()),
        *(measured(f"{name}: longest lock", "s", value, source) for name, value in locks.items()),
    ]
    for n, value in enumerate(rise, 1):
        rows.append(measured(f"{protected}: mean friction under vehicle {n}", "1", value, "assumed recovery"))
    said = [
        f"Cleaned by those ahead the train stops after {distance[protected]:.0f} m, on a rail that "
        f"stays dirty after {distance[dirty]:.0f} m, dry after {distance['dry']:.0f} m.",
    ]
    seconds = seconds_of(one.course for one in found.values())
    parameters = {"coaches": COACHES, "speed": SPEED}
    return Report(rows, shown.course.recording(), lambda: draw(found), parameters, seconds, said)


def draw(found: Mapping[str, LowAdhesionStop]) -> Figure:
    rise = found["low, protected"].friction.mean(axis=0)
    message = f"On low rail sliding wheels raise friction from {rise[0]:.3f} to {rise[-1]:.3f} behind"
    titles = {"speed [km/h]": "distance of the head [m]"}
    titles["low, protected: mean friction under each vehicle [1]"] = "vehicle, from the head"
    figure, (speed, friction) = charts(message, titles, (10.0, 4.4))
    for line, colour, (name, one) in zip(LINES, FOUR, found.items(), strict=True):
        speed.plot(one.course.distance[:, 0], 3.6 * one.course.speed[:, 0], line, color=colour, label=name)
    speed.legend(fontsize=8)
    friction.bar(np.arange(1, rise.size + 1), rise, color=FOUR[0])
    return figure


SCENARIO = Scenario(
    "train-low-adhesion",
    "A passenger train on a low rail: the first vehicles clean it for the others, each protected",
    run,
)
