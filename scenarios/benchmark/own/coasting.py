"""A vehicle that coasts: a train of one vehicle without a brake, on a line with one gradient."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from products.train.consist_file import consist_of
from products.train.train import Train
from rbd_model.track.line import line_of, straight

#: Output interval [s], and longest run [s]. Between outputs speed and distance are interpolated.
INTERVAL, LONGEST = 0.1, 7200.0
#: Length of the line behind and ahead of the start [m].
BEHIND, AHEAD = 100.0, 200e3


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return distance [m] and time [s] until the end speed; none if the vehicle does not slow down to it."""
    row = {
        "kind": "wagon",
        "valve": "head",
        "brake": "none",
        "mass": inputs["mass"] / 1e3,
        "rotating": 100.0 * inputs["rotating_mass"] / inputs["mass"],
        "resistance_a": inputs["resistance.constant"],
        "resistance_b": inputs["resistance.linear"],
        "resistance_c": inputs["resistance.square"],
    }
    line = line_of([straight(BEHIND + AHEAD, inputs["gradient"])]) if inputs["gradient"] else None
    train = Train(consist_of([row]), speed=inputs["speed"], distance=BEHIND, line=line)
    begin = float(train.distance[0])
    times, speeds, distances = [0.0], [inputs["speed"]], [0.0]
    while speeds[-1] > inputs["end_speed"] and times[-1] < LONGEST and distances[-1] < AHEAD:
        train.advance(INTERVAL)
        times.append(train.time)
        speeds.append(float(train.speed[0]))
        distances.append(float(train.distance[0]) - begin)
    if speeds[-1] > inputs["end_speed"]:
        return {}
    if inputs["end_speed"] == 0.0:
        rest = speeds[-2] / (speeds[-3] - speeds[-2]) * INTERVAL
        return {"distance": distances[-1], "time": times[-2] + rest}
    found = [float(np.interp(-inputs["end_speed"], -np.array(speeds), one)) for one in (times, distances)]
    return {"time": found[0], "distance": found[1]}
