"""A freight train stops on a line of one gradient: the train model, with a brake by its brake weight percentage."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from products.train.consist_file import consist_of
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.track.line import line_of, straight

#: Longest vehicle of the model [m], output interval [s], longest stop [s], line behind and ahead of the start [m].
LONGEST_VEHICLE, INTERVAL, LONGEST, BEHIND, AHEAD = 30.0, 0.1, 1200.0, 3000.0, 20e3
#: Cells of the pipe in a vehicle.
CELLS = 1.0


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the distance from the demand to the stop [m]; none if the train does not stop."""
    line = line_of([straight(BEHIND + AHEAD, inputs["gradient"])]) if inputs["gradient"] else None
    train = Train(
        consist_of(rows_of(inputs)), speed=inputs["speed"], distance=BEHIND, line=line, settings=Settings(cells=CELLS)
    )
    begin = float(train.distance[0])
    if inputs["delay"] > 0.0:
        train.advance(inputs["delay"])
    train.drive("emergency") if inputs["braking"] == "emergency" else train.drive("service", 1.0)
    while train.speed[0] > 0.0 and train.time < LONGEST and train.distance[0] < BEHIND + AHEAD:
        train.advance(INTERVAL)
    return {} if train.speed[0] > 0.0 else {"distance": float(train.distance[0]) - begin}


def rows_of(inputs: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the vehicles: locomotives at the head, and as many equal wagons as their length needs."""
    own = inputs["locomotive.length"]
    left = inputs["length"] - inputs["locomotives"] * own
    count = math.ceil(left / LONGEST_VEHICLE)
    same = {"lambda": 100 * inputs["percentage"], "position": inputs["position"]}
    head = {"kind": "locomotive", "count": inputs["locomotives"], "mass": inputs["locomotive.mass"] / 1e3}
    wagons = {"kind": "wagon", "count": count, "mass": inputs["wagons.mass"] / count / 1e3, "length": left / count}
    return [head | {"length": own} | same, wagons | same]
