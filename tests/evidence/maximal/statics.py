"""Compute spring loads at rest, if the springs under each body are equal and centred about its load."""

from __future__ import annotations

import numpy as np

from rbd_model.vehicle.description import Vehicle

#: Largest distance of a body's load from the middle of its springs that is treated as centred [m].
EVEN = 1e-9


def preloads(vehicle: Vehicle) -> dict[str, float]:
    """Return the vertical force per side of the carrying connections [N], by name: equal shares, from the top down.

    Raises ValueError if equal shares would not keep a body level.
    """
    weight = {body.name: vehicle.number(body.mass) * vehicle.number("gravity") for body in vehicle.bodies}
    loads = {body.name: [(weight[body.name], vehicle.number(body.along), 0.0)] for body in vehicle.bodies}
    found: dict[str, float] = {}
    waiting = list(vehicle.bodies)
    while waiting:
        below = {one.lower for one in vehicle.carrying for body in waiting if one.upper == body.name}
        body = next(body for body in waiting if body.name not in below)
        waiting.remove(body)
        under = [one for one in vehicle.carrying if one.upper == body.name]
        places = [[vehicle.number(size) for size in place] for one in under for _, place in one.sides()]
        force, along, across = (
            sum(column) for column in zip(*[(f, f * x, f * y) for f, x, y in loads[body.name]], strict=True)
        )
        middle = np.mean(places, axis=0)
        if abs(along / force - middle[0]) > EVEN or abs(across / force - middle[1]) > EVEN:
            raise ValueError(
                f"The springs under {body.name} are not even about its load; give the shares in another way."
            )
        for one in under:
            found[one.name] = force / len(places)
            for _, place in one.sides():
                x, y, _ = (vehicle.number(size) for size in place)
                loads.setdefault(one.lower, []).append((found[one.name], x, y))
    return found
