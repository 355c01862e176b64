"""What tables and sentences call the end of a run: a stop, or with traction the speed that it comes to."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Words:
    """One does and several do; there is none; what is compared; what motors or cylinders give, and its unit."""

    does: str
    do: str
    none: str
    distance: str
    effort: str
    unit: str


STOPS = Words("stops", "stop", "no stop", "stopping distance", "the pressure of its cylinder", "kPa")
STARTS = Words("arrives", "arrive", "no arrival", "distance to the speed", "the torque of its motor", "kN.m")


def words_of(driven: bool) -> Words:
    """Of starts, or of stops."""
    return STARTS if driven else STOPS
