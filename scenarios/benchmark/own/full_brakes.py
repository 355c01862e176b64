"""A train whose brakes are full stops: equal, rigidly coupled vehicles on a line with one gradient."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from products.train.consist_file import consist_of
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import line_of, straight

#: Output interval [s], longest stop [s], length of the line behind and ahead of the start [m].
INTERVAL, LONGEST, BEHIND, AHEAD = 0.05, 1200.0, 1000.0, 50e3
#: Shortest filling time of the model [s], and the time by which the brake is full [s].
FILLING, FULL = 0.5, 1.0
#: Largest mass of a vehicle of the model [kg].
HEAVIEST = 300e3


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return distance [m] and time [s] from the speed to rest; none if the train does not stop.

    The train begins faster by what its brake takes from its speed until it is full.
    """
    line = line_of([straight(BEHIND + AHEAD, inputs["gradient"])]) if inputs["gradient"] else None
    train = Train(
        consist_of(rows_of(inputs)),
        speed=inputs["speed"] + FULL * inputs["brake_force"] / inputs["mass"],
        distance=BEHIND,
        line=line,
        settings=Settings(cells=1.0),
    )
    train.drive("emergency")
    times, speeds, distances = [0.0], [float(train.speed[0])], [float(train.distance[0])]
    while speeds[-1] > 0.0 and times[-1] < LONGEST and distances[-1] < BEHIND + AHEAD:
        train.advance(INTERVAL)
        times.append(train.time)
        speeds.append(float(train.speed[0]))
        distances.append(float(train.distance[0]))
    if speeds[-1] > 0.0:
        return {}
    time, distance = (float(np.interp(-inputs["speed"], -np.array(speeds), one)) for one in (times, distances))
    rest = times[-2] + speeds[-2] / (speeds[-3] - speeds[-2]) * INTERVAL
    return {"time": rest - time, "distance": distances[-1] - distance}


def rows_of(inputs: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the vehicles of the consist: as many as the largest mass of one needs, each with its share."""
    count = math.ceil(inputs["mass"] / HEAVIEST)
    row = {
        "kind": "wagon",
        "brake": "ep-direct",
        "coupler": "rigid",
        "mass": inputs["mass"] / count / 1e3,
        "rotating": 100.0 * inputs["rotating_mass"] / inputs["mass"],
        "resistance_a": inputs["resistance.constant"] / count,
        "resistance_b": inputs["resistance.linear"] / count,
        "resistance_c": inputs["resistance.square"] / count,
        "fill_time": FILLING,
        "release_time": 10.0,
        "brake_force": inputs["brake_force"] / count / 1e3,
    }
    return [row | {"valve": "head"}, *[row] * (count - 1)]
