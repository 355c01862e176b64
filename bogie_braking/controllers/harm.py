"""Harm that a controller does where no wheel slides: longer distances and moved valves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bogie_braking.controllers.estimate import less
from bogie_braking.controllers.scoring import Scored

#: Largest growth of a distance that is not counted as harm [1].
NO_HARM = 0.001


@dataclass(frozen=True)
class Harm:
    """Harm in the cases in which no wheel slides.

    cases: their number. longer: largest growth of the mean distance by the controller [1]. half: half of its interval.
    case: the case of this growth. moved: number of cases in which a valve moved.
    """

    cases: int
    longer: float
    half: float
    case: str
    moved: int

    @property
    def words(self) -> str:
        """Return the harm in a few words."""
        if self.longer > NO_HARM:
            return f"{100 * self.longer:+.1f} % ({self.case})"
        return "valves move" if self.moved else "none"


def harm_of(own: Sequence[Scored], without: Mapping[str, Scored]) -> Harm | None:
    """Return the harm of a controller; None if wheels slide in every case, or if it does not stop in another."""
    found, moved = [], 0
    for one in own:
        other = without.get(one.case)
        if other is None or other.distances is None or one.distances is None:
            continue
        distance = float(other.distances.values.mean())
        longer = less(one.distances, other.distances).over(distance).estimate()
        found.append((longer.mean, longer.half, one.case))
        moved += any(stop.commands for stop in one.stops or [one.stop])
    return Harm(len(found), *max(found), moved) if found else None
