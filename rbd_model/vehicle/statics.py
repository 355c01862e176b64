"""The vehicle at rest: the static load of each spring and of each wheelset."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fmu_src.symbols import ca
from rbd_model.vehicle.description import Place, RigidBody, Size, Vehicle, wheelset_name


@dataclass(frozen=True)
class Statics:
    """Preloads of the single springs by name, and the load on each wheelset without its own weight [N]."""

    preload: dict[str, ca.SX]
    on_wheelset: dict[str, ca.SX]


def statics(vehicle: Vehicle, value: Callable[[Size], ca.SX], gravity: ca.SX) -> Statics:
    """Return preloads by Newton's first law, from the top down: each body is level on its springs.

    A body on more springs than it has motions shares its weight by the stiffnesses, as it would sink and lean on them.
    Held motions share nothing.
    """
    preload: dict[str, ca.SX] = {}
    weights: dict[str, list[tuple[ca.SX, Place]]] = {}
    waiting = [body for body in vehicle.bodies if "bounce" not in body.held]
    while waiting:
        # First those on which nothing rests that is not yet known.
        above = {c.lower for c in vehicle.carrying for body in waiting if c.upper == body.name}
        body = next(body for body in waiting if body.name not in above)
        waiting.remove(body)
        load = [(value(body.mass) * gravity, (body.along, 0.0, 0.0)), *weights.get(body.name, [])]
        shares = share_of_supports(body, vehicle, value, load)
        for connection in vehicle.carrying:
            for name, place in connection.sides():
                if connection.upper == body.name:
                    preload[name] = shares[name]
                    weights.setdefault(connection.lower, []).append((shares[name], place))
    on_wheelset = {
        wheelset_name(n): sum((force for force, _ in weights.get(wheelset_name(n), [])), ca.SX(0))
        for n, _ in vehicle.numbered
    }
    return Statics(preload, on_wheelset)


def share_of_supports(
    body: RigidBody, vehicle: Vehicle, value: Callable[[Size], ca.SX], load: list[tuple[ca.SX, Place]]
) -> dict[str, ca.SX]:
    """Return the force of each spring under a body that carries `load`, forces at places, by Newton's first law."""
    along = value(body.along)

    def row(place: Place) -> ca.SX:
        """Return the lowering of a place by the motions (bounce, roll, pitch) of the body."""
        kept = {"bounce": ca.SX(1), "roll": value(place[1]), "pitch": -(value(place[0]) - along)}
        return ca.vertcat(*[ca.SX(entry) for motion, entry in kept.items() if motion not in body.held])

    supports = [
        (name, ca.SX(value(connection.share)), row(place))
        for connection in vehicle.carrying
        if connection.upper == body.name
        for name, place in connection.sides()
    ]
    matrix = sum(stiffness * arm @ arm.T for _, stiffness, arm in supports)
    right = sum(force * row(place) for force, place in load)
    sinking = ca.solve(ca.densify(matrix), ca.densify(right))
    return {name: stiffness * ca.dot(arm, sinking) for name, stiffness, arm in supports}
