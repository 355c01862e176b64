"""Names that differed in earlier versions: variables, settings, options, attributes, public functions and scenarios."""

from __future__ import annotations

from collections.abc import Container
from typing import TYPE_CHECKING, Any

#: Present names by the old ones. Hyphens are written as underscores.
RENAMED = {
    "KernelError": "SimulationError",
    "Slave": "FmuInstance",
    "contact_depth": "contact_model",
    "couple": "cosimulate",
    "coupled": "coupling_closed",
    "depth": "brake_model",
    "ends": "end_force",
    "joined": "hose_state",
    "journal": "messages",
    "led": "external_vehicle",
    "led_speed": "external_vehicle_speed",
    "pneumatics": "cylinder_model",
    "position": "driver_position",
    "said": "messages",
    "sentences": "messages",
    "smallest_level": "recommend_level",
    "step": "driver_step",
    "strength": "brake_ratio",
    "teeth": "pulses",
    "together": "unidentifiable",
    "track_yields": "flexible_track",
    "train_depths": "train_brake_models",
}


def present_name(old: str, known: Container[str]) -> str | None:
    """Return the present name of a variable, option or scenario by its old one, or None."""
    bare = old.lstrip("-")
    new = RENAMED.get(bare.replace("-", "_"))
    if new is None:
        return None
    hyphens = old[: len(old) - len(bare)]
    spelled = hyphens + (new.replace("_", "-") if "-" in old else new)
    return spelled if spelled in known else None


class FormerNames:
    """Base of results with renamed attributes: an old name raises AttributeError with the present one."""

    if not TYPE_CHECKING:  # with it, type checkers would accept any attribute

        def __getattr__(self, name: str) -> Any:
            new = present_name(name, dir(self))
            ending = f"; its name is {new} now." if new else "."
            raise AttributeError(f"{type(self).__name__} has no attribute {name}{ending}", name=name, obj=self)
