"""Words of tables and messages for the end of a run: a stop, or with traction its final speed."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Words:
    """Verbs for one and for several, the noun without an end, the compared quantity, the effort and its unit."""

    does: str
    do: str
    none: str
    distance: str
    effort: str
    unit: str


STOPS = Words("stops", "stop", "no stop", "stopping distance", "the pressure of its cylinder", "kPa")
STARTS = Words("arrives", "arrive", "no arrival", "distance to the speed", "the torque of its motor", "kN.m")


def words_of(driven: bool) -> Words:
    """Return the words of starts, or of stops."""
    return STARTS if driven else STOPS
