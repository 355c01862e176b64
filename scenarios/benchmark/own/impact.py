"""Two vehicles that meet: a train of two, not coupled, with a coupler by its curves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from products.train.consist import Consist, locomotive, wagon
from products.train.numbers import Settings
from products.train.train import Train
from rbd_model.train.coupler import Coupler, Curve

#: Share of the longest stable step of the coupler.
STEPS = 0.02
#: Interval between outputs, and time by which the vehicles have parted [s].
INTERVAL, LONGEST = 1e-3, 20.0
#: Share of rotating masses of a vehicle whose wheels do not count.
NO_ROTATION = 1e-9


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return force [N], deflection [m], and both speeds afterwards [m/s]; none if they do not part."""
    loading, unloading = (
        Curve(inputs[f"{name}.deflection"], inputs[f"{name}.force"]) for name in ("loading", "unloading")
    )
    coupler = Coupler("case", inputs["sticking_stiffness"], (loading, unloading), (loading, unloading))
    vehicles = [
        replace(one, mass=mass, coupler=coupler, rotating_share=NO_ROTATION, resistance=(0.0, 0.0, 0.0))
        for one, mass in ((locomotive(), inputs["mass_1"]), (wagon(), inputs["mass_2"]))
    ]
    train = Train(Consist(tuple(vehicles)), settings=Settings("delay", share=STEPS))
    train.inputs["coupling_closed"][:] = 0.0
    state = train.motion
    state[1:3, 1] = inputs["speed"]
    train.motion = state
    shut, touched = 0.0, False
    while train.time < LONGEST and not (touched and train.coupler_force[0] == 0.0):
        train.advance(INTERVAL)
        touched = touched or train.coupler_force[0] != 0.0
        shut = max(shut, float(train.motion[0, 1] - train.motion[0, 0]))
    if train.coupler_force[0] != 0.0:
        return {}
    first, second = (float(one) for one in train.speed)
    return {"force": train.largest_compression, "deflection": shut, "speed_1": first, "speed_2": second}
