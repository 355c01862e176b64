"""The simplified calculation of EN 14531-1: mean forces, an equivalent time, v t_e + v^2 / 2 a_e."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

NAME = "mean values (EN 14531-1)"
#: Stated version: the standard's edition.
EDITION = "EN 14531-1:2015"


def version() -> str:
    """Return the edition of the standard."""
    return EDITION


def answer(question: str, inputs: Mapping[str, Any]) -> dict[str, float] | None:
    """Return distances [m], times [s], forces [N] and adhesions [1] of a stop of axles; None to other questions."""
    if question != "stop-of-axles":
        return None
    axles, speed = inputs["axles"], inputs["speed"]
    forces = {kind: force_of(kind, inputs) for kind in dict.fromkeys(axles)}
    brake = sum(forces[kind] for kind in axles)
    resistance = (
        inputs["resistance.constant"]
        + 2 / 3 * inputs["resistance.linear"] * speed
        + inputs["resistance.square"] * speed**2 / 2
    )
    mass = sum(inputs[f"{kind}.mass"] + inputs[f"{kind}.rotating_mass"] for kind in axles)
    late = sum(forces[kind] * (inputs[f"{kind}.delay"] + inputs[f"{kind}.rise"] / 2) for kind in axles)
    time, slows = late / (brake + resistance), (brake + resistance) / mass
    distance = speed * time + speed**2 / (2 * slows)
    found = {"distance": distance, "mean_value_distance": distance, "brake_force": brake}
    found |= {"equivalent_time": time, "equivalent_deceleration": slows}
    for kind, force in forces.items():
        weight = inputs[f"{kind}.mass"] * inputs["gravity"]
        found |= {f"{kind}_force": force}
        found |= {f"{kind}_adhesion": (force - inputs[f"{kind}.rotating_mass"] * slows) / weight}
    return found


def force_of(kind: str, inputs: Mapping[str, Any]) -> float:
    """Return the brake force at the rims of an axle [N]: cylinder, rigging, friction at its radius."""

    def of(name: str) -> float:
        return float(inputs[f"{kind}.{name}"])

    cylinder = of("cylinder_pressure") * of("piston_area") * of("cylinder_efficiency") + of("cylinder_spring")
    pressing = cylinder * of("rigging_ratio") * of("rigging_efficiency") + of("rigging_spring")
    return pressing * of("friction") * of("friction_radius") / (of("wheel_diameter") / 2)
