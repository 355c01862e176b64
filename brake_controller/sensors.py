"""Sensors of the wheels' rotation: a toothed wheel whose edges are timed, with errors of its pitch."""

import math
from collections import deque
from dataclasses import dataclass, field
from random import Random
from typing import NamedTuple

#: Teeth of the default wheel: real ones have 60 to 300 pulses a turn, mostly 80 to 128.
TEETH = 100
#: Time over which edges are averaged at least, resolution of the timer [s], and edges a second below which the wheel
#: counts as standing [Hz]. Assumed.
GATE, TIMER, LOWEST_FREQUENCY = 0.03, 1e-6, 5.0
#: Largest error of an edge, as a share of the pitch: edges keep their order.
LARGEST_ERROR = 0.45


def edge_errors(pulses: int, jitter: float, seed: int) -> list[float]:
    """Errors of the places of all edges, as shares of the pitch; none without jitter, their standard deviation."""
    random = Random(seed)
    drawn = (random.gauss(0.0, jitter) for _ in range(pulses)) if jitter else ()
    return [min(max(error, -LARGEST_ERROR), LARGEST_ERROR) for error in drawn]


class _Passage(NamedTuple):
    """The time between two looks in which edges passed: times [s], places in pitches, its first edge and when [s]."""

    start: float
    begin: float
    end: float
    place: float
    first: int
    first_time: float


@dataclass
class Encoder:
    """A toothed wheel under one probe, which sees edges and their times but not their direction.

    The reading is the mean speed between the last edge and the last one at least `gate` [s] before it. Until the next
    edge it is at most one pitch over the time since the last one, so that it falls as a wheel stops. Below
    `lowest_frequency` [Hz] of edges it is 0, as before the first edges: there a wheel that turns slowly and one that
    stands are the same. Edges between two looks are found as if the wheel had turned evenly between them.

    pulses: teeth, one edge each; jitter: standard deviation of their places as a share of the pitch, from `seed`, the
    same in every turn; resolution [s]: of the timer. Raises ValueError with a sentence for values that cannot be.
    """

    pulses: int = TEETH
    jitter: float = 0.0
    seed: int = 1
    gate: float = GATE
    resolution: float = TIMER
    lowest_frequency: float = LOWEST_FREQUENCY
    time: float | None = None
    rotation: float = 0.0
    place: float = 0.0
    edge: int = 0
    edge_time: float = -math.inf
    mean: float = 0.0
    passages: deque[_Passage] = field(default_factory=deque)
    errors: list[float] = field(init=False)
    #: Angle from one edge to the next [rad].
    pitch: float = field(init=False)

    def __post_init__(self) -> None:
        if self.pulses < 1:
            raise ValueError(f"Set pulses to at least 1: it was {self.pulses}.")
        if not (math.isfinite(self.jitter) and self.jitter >= 0.0):
            raise ValueError(f"Set jitter to a finite value of at least 0: it was {self.jitter}.")
        for name in ("gate", "resolution", "lowest_frequency"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0):
                raise ValueError(f"Set {name} to a finite value above 0: it was {getattr(self, name)}.")
        self.pitch = math.tau / self.pulses
        self.errors = edge_errors(self.pulses, self.jitter, self.seed)

    def angular_velocity(self, time: float, rotation: float) -> float:
        """The reading [rad/s], at least 0, at a time [s], from the rotation of the wheel [rad]."""
        if self.time is None:
            self.place = abs(rotation) / self.pitch
            self.edge = self._last_edge(self.place)
        elif time > self.time:
            self._turn(time, self.place + abs(rotation - self.rotation) / self.pitch)
        self.time, self.rotation = time, rotation
        age = time - self.edge_time - self.resolution  # at least: the timer cuts off what is below its resolution
        reading = min(self.mean, 1.0 / max(age, self.resolution))
        return reading * self.pitch if reading >= self.lowest_frequency else 0.0

    def _turn(self, time: float, place: float) -> None:
        """Goes on to a place, in pitches; where edges passed, the mean from one a gate before the last to the last."""
        assert self.time is not None
        edge = self._last_edge(place)
        if edge > self.edge:
            between = self.time, self.place, time, place
            first_time = self._time_of(self.edge + 1, *between)
            self.passages.append(_Passage(*between, self.edge + 1, first_time))
            self.edge, self.edge_time = edge, self._time_of(edge, *between)
            self.mean = self._mean()
        self.place = place

    def _mean(self) -> float:
        """Edges a second up to the last edge; 0 as long as there is none a gate before it."""
        since, passages = self.edge_time - self.gate, self.passages
        while len(passages) > 1 and passages[1].first_time <= since:
            passages.popleft()
        start, begin, end, place, first, first_time = passages[0]
        if first_time > since:
            return 0.0
        share = min(1.0, (since - start) / (end - start))
        before = max(first, self._last_edge(begin + share * (place - begin)))
        return (self.edge - before) / (self.edge_time - self._time_of(before, start, begin, end, place))

    def _place_of(self, edge: int) -> float:
        """Where an edge stands, in pitches."""
        return edge + self.errors[edge % self.pulses] if self.errors else float(edge)

    def _last_edge(self, place: float) -> int:
        """The last edge at or before a place."""
        edge = math.floor(place)
        if not self.errors:
            return edge
        return next(one for one in (edge + 1, edge, edge - 1) if self._place_of(one) <= place)

    def _time_of(self, edge: int, start: float, begin: float, end: float, place: float) -> float:
        """When an edge passed on the way from one place to another, to the resolution of the timer [s]."""
        share = (self._place_of(edge) - begin) / (place - begin)
        return math.floor((start + share * (end - start)) / self.resolution) * self.resolution
