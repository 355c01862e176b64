"""A train of axles, each with its own brake that acts after a delay and rises linearly: the train model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from products.train.consist_file import consist_of
from products.train.numbers import Settings
from products.train.train import Train
from scenarios.benchmark.methods.mean_values import force_of

#: Output interval while the train stops [s]; the steps of the model are shorter.
INTERVAL = 0.1
#: Longest stop [s].
LONGEST = 3600.0
#: Length of an axle's vehicle [m], which level track makes irrelevant.
LENGTH = 3.0
#: Share of the full pressure to which the train model's filling time extends (UIC 540).
FILLED = 0.95


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return distance [m] and brake forces [N] of an emergency stop."""
    axles = inputs["axles"]
    train = Train(
        consist_of([row_of(kind, inputs, number) for number, kind in enumerate(axles)]),
        speed=inputs["speed"],
        settings=Settings(cells=1.0),
    )
    train.drive("emergency")
    begin = float(train.distance[0])
    while train.speed[0] > 0.0 and train.time < LONGEST:
        train.advance(INTERVAL)
    found = {"brake_force": float(train.brake_force.sum())}
    found |= {f"{kind}_force": float(train.brake_force[axles.index(kind)]) for kind in dict.fromkeys(axles)}
    if train.speed[0] == 0.0:
        found["distance"] = float(train.distance[0]) - begin
    return found


def row_of(kind: str, inputs: Mapping[str, Any], number: int) -> dict[str, Any]:
    """Return an axle as a vehicle of a consist, with its share of the running resistance."""
    own, count = (
        {name.partition(".")[2]: one for name, one in inputs.items() if name.startswith(f"{kind}.")},
        len(inputs["axles"]),
    )
    return {
        "kind": "wagon",
        "length": LENGTH,
        "coupler": "rigid",
        "brake": "ep-direct",
        "mass": own["mass"] / 1e3,
        "rotating": 100.0 * own["rotating_mass"] / own["mass"],
        "resistance_a": inputs["resistance.constant"] / count,
        "resistance_b": inputs["resistance.linear"] / count,
        "resistance_c": inputs["resistance.square"] / count,
        "dead_time": own["delay"],
        "fill_time": FILLED * own["rise"],
        "release_time": 10.0,
        "brake_force": force_of(kind, inputs) / 1e3,
    } | ({"valve": "head"} if number == 0 else {})
