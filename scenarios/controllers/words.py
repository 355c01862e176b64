"""What tables and sentences call the end of a run: a stop, or with traction the speed that it comes to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol


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


class Ended(Protocol):
    """What is known of a run here."""

    @property
    def driven(self) -> bool:
        """Whether motors drove it."""
        ...


def words_of(scores: Sequence[Ended]) -> Words:
    """For scores that are all of stops, or all of starts."""
    return STARTS if scores[0].driven else STOPS
