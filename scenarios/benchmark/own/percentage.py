"""A train by its brake weight percentage: the conversion model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from brake_controller.brake_weight import BrakingKind, stopping_distance


def answer(inputs: Mapping[str, Any]) -> dict[str, float]:
    """Return the distance from the demand to the stop [m]; none for a kind of train without constants."""
    kind = case_of(inputs)
    if kind is None:
        return {}
    return {"distance": stopping_distance(kind, inputs["speed"], 100 * inputs["percentage"], inputs["length"])}


def case_of(inputs: Mapping[str, Any]) -> BrakingKind | None:
    """Return the kind of braking; None without constants, as for a passenger train in G."""
    name = "_".join((inputs["braking"], inputs["train"], inputs["position"])).upper()
    return BrakingKind.__members__.get(name)
