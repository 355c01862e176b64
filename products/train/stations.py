"""Stops of a timetable and speed limits: what drivers are given, and what becomes of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from products.train.train import LONGEST, within

#: Lower and upper limits of a driver's numbers, with their units.
LIMITS = {
    "deceleration": (0.05, 1.5, "m/s2"),
    "within": (0.1, 100.0, "m"),
    "adhesion": (0.01, 1.0, ""),
    "recovery": (0.0, 1.0, ""),
    "jerk": (0.1, 10.0, "m/s3"),
    "place": (-1e7, 1e7, "m"),
    "speed": (0.5, 112.0, "m/s"),  # 400 km/h
}


@dataclass(frozen=True)
class StationStop:
    """A stop of the train's front.

    place: distance along the line [m]. arrival: time at which it is due [s]; 0: as early as possible. standing: least
    time at rest [s]. departure: not before this time [s]; 0: any. Raises ValueError if a number is out of its limits (a
    time: 0 to a day), or if the departure is before the arrival.
    """

    place: float
    arrival: float = 0.0
    standing: float = 30.0
    departure: float = 0.0

    def __post_init__(self) -> None:
        within("place", self.place, *LIMITS["place"])
        for name, value in (("arrival", self.arrival), ("standing", self.standing), ("departure", self.departure)):
            within(name, value, 0.0, LONGEST, "s")
        if 0.0 < self.departure < self.arrival:
            raise ValueError(
                f"departure must be 0 s or not before arrival = {self.arrival:g} s; got {self.departure:g} s. Correct "
                "one of them."
            )


@dataclass(frozen=True)
class StationCall:
    """A stop as it was made: place of the stop [m], overrun of the front (below 0: short) [m], times [s].

    late: arrival behind the timetable [s]; 0 for a stop without a due time.
    """

    place: float
    overrun: float
    arrived: float
    late: float


def check_stops(stops: Sequence[StationStop], apart: float) -> None:
    """Raise ValueError if places or times of stops do not rise, or two stops are nearer than a distance [m]."""
    if not isinstance(stops, (list, tuple)) or not all(isinstance(one, StationStop) for one in stops):
        raise ValueError(f"stops must be a list of StationStop; got {stops!r}. Make a StationStop of each place.")
    for number, (one, other) in enumerate(pairwise(stops), 2):
        if other.place <= one.place:
            raise ValueError(
                f"stops must have places that rise; stop {number} is at {other.place:g} m, the one before at "
                f"{one.place:g} m. Sort them."
            )
        if other.place - one.place < apart:
            raise ValueError(
                f"stops must be at least 2 within = {apart:g} m apart; stop {number} is at {other.place:g} m, the one "
                f"before at {one.place:g} m. Leave one out, or take a smaller within."
            )
    times = [(n, time) for n, stop in enumerate(stops, 1) for time in (stop.arrival, stop.departure) if time]
    for (before, early), (number, late) in pairwise(times):
        if late < early:
            raise ValueError(
                f"stops must have times that rise; stop {number} has {late:g} s, and stop {before} has {early:g} s. "
                "Correct one of them."
            )


def check_limits(limits: Sequence[tuple[float, float]]) -> None:
    """Raise ValueError if speed limits are not pairs of numbers, out of their limits, or at places that do not rise."""
    if not isinstance(limits, (list, tuple)) or not all(
        isinstance(limit, (list, tuple)) and len(limit) == 2 for limit in limits
    ):
        raise ValueError(f"limits must be a list of pairs (place, speed); got {limits!r}. Write [(0, 20)] for 20 m/s.")
    for place, speed in limits:
        within("place", place, *LIMITS["place"])
        within("speed", speed, *LIMITS["speed"])
    places = [place for place, _ in limits]
    if any(other <= one for one, other in pairwise(places)):
        raise ValueError(f"limits must have places that rise; got {places}. Sort them.")


def stopping_rate(way: float, speed: float, jerk: float) -> float:
    """Return the deceleration b [m/s2] that stops a train in a distance [m] from a speed [m/s], with a soft end.

    At the end b falls to 0 at the rate of the jerk j [m/s3]: from v = b^2 / 2 j on. Before, v^2 / 2 b + b^3 / 24 j^2
    = s. Within the end (2 / 3) v^2 / s, because s = (2 / 3) v^1.5 / sqrt(2 j) there.
    """
    way, rate = max(way, 1e-2), 0.0
    for _ in range(8):
        rate = speed**2 / (2 * max(way - rate**3 / (24 * jerk**2), way / 2))
    return rate if speed > rate**2 / (2 * jerk) else 2 / 3 * speed**2 / way
