"""Fields of train data and national values by their kind: steps of speed, and switches."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np

from products.supervision.arguments import of_type, switch
from products.supervision.steps import Steps
from readers.text import BadInputError

#: Speed above which no boundary of steps can be meant [m/s]: 504 km/h. In km/h many boundaries are above it.
FASTEST_BOUNDARY = 140.0


def set_kinds(one: Any) -> None:
    """Make steps and switches of a frozen data class of their kind: a number is a step for all speeds."""
    for field in fields(one):
        value, kind = getattr(one, field.name), str(field.type)
        if kind == "bool":
            switch(field.name, value)
        if "Steps" not in kind or (value is None and "None" in kind):
            continue
        if isinstance(value, int | float | np.number) and not isinstance(value, bool):
            value = Steps.constant(float(value))
            object.__setattr__(one, field.name, value)
        of_type(field.name, value, Steps, "Give Steps(boundaries, values), or one number for all speeds.")


def check_boundaries(name: str, steps: Steps) -> None:
    """Refuse boundaries of speed that are not in m/s."""
    most = float(steps.boundaries.max(initial=0.0))
    if most > FASTEST_BOUNDARY:
        raise BadInputError(
            f"{name} must have boundaries of speed up to {FASTEST_BOUNDARY:g} m/s ({3.6 * FASTEST_BOUNDARY:g} km/h); "
            f"got {most:g} m/s. Give m/s: 100 / 3.6 for 100 km/h."
        )
