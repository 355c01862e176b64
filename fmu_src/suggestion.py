"""Suggestions for unknown names."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

#: The most names that a message lists.
MOST_NAMES = 12


#: Names that were others in versions before, by their old ones: of variables, settings and public functions.
RENAMED = {
    "KernelError": "SimulationError",
    "Slave": "FmuInstance",
    "contact-depth": "contact-model",
    "contact_depth": "contact_model",
    "couple": "cosimulate",
    "coupled": "coupling_closed",
    "joined": "hose_state",
    "led": "external_vehicle",
    "led_speed": "external_vehicle_speed",
    "pneumatics": "cylinder_model",
    "smallest_level": "recommend_level",
    "teeth": "pulses",
    "track-yields": "flexible-track",
    "track_yields": "flexible_track",
}


def suggestion(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """Return the end of a message: the nearest name; if no name is near, `otherwise`, or the first names."""
    names = list(known)
    if RENAMED.get(str(name)) in names:
        return f"its name is {RENAMED[str(name)]} now."
    near = difflib.get_close_matches(str(name), names, 1)
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"did you mean {near[0]}?" if near else otherwise or f"there are {', '.join(names[:MOST_NAMES])}{more}."
