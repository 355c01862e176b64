"""Parts of the equations of a `System`: states, dry friction, conditions of a run, steady start, observables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from fmu_src.symbols import ca

#: A start value, or a function that returns it.
Start: TypeAlias = "ca.SX | float | Callable[[], ca.SX]"


@dataclass(frozen=True)
class State:
    """A continuous state. `nominal` scales its error, in its unit; `start` depends on parameters only.

    An algebraic state has no derivative: an equation without derivatives determines it, and `start` is a guess.
    starts: makes `start`, called where it is first needed: a table of variables takes names and units alone.
    """

    name: str
    unit: str
    symbol: ca.SX
    starts: Callable[[], ca.SX | float]
    nominal: float
    algebraic: bool = False

    @cached_property
    def start(self) -> ca.SX:
        """Start value."""
        return ca.SX(self.starts())


@dataclass(frozen=True)
class Friction:
    """Dry friction on a velocity, one of the `states` or the sum of two: `direction` is 1, -1 or, when stuck, 0.

    The equations multiply `capacity` with `direction` and hold the velocity if it is 0. To stay stuck, the friction
    must balance the load `drive`, in the unit of `capacity`, its largest load; below 0: it never has any. It sticks at
    speeds up to `still`. Messages use `stuck_word` and `sliding_word`. It holds the vehicle `whole`; frictions with the
    same one are reported as one. The margins `reported` are above 0 if sticking counts, or would count, and if sliding
    counts; None: both always count.
    """

    label: str
    direction: ca.SX
    states: tuple[str, ...]
    drive: ca.SX
    capacity: ca.SX
    stuck_word: str
    sliding_word: str
    still: ca.SX
    whole: str = ""
    reported: tuple[ca.SX | float, ca.SX | float] | None = None


@dataclass(frozen=True)
class Condition:
    """The run ends, or warns once, when a margin turns negative.

    margin: dimensionless, of order 1. sentence: the message; its one %s is the time [s]. candidate: a cheaper
    expression that is negative wherever the margin may be; the margin is computed only there. Raises ValueError if the
    message does not have one %s.
    """

    margin: ca.SX
    sentence: str
    candidate: ca.SX | None = None

    def __post_init__(self) -> None:
        if self.sentence.count("%s") != 1:
            raise ValueError(f"The message {self.sentence!r} must have one %s, for the time.")

    @property
    def first_look(self) -> ca.SX:
        """Return the expression that is computed at every step."""
        return self.margin if self.candidate is None else self.candidate


@dataclass(frozen=True)
class SteadyStart:
    """Steady start: runs start in a steady state if `course` is above 0 at the start values, else with these.

    In that state the derivatives are 0. Exceptions are states that keep their start values, and those that grow with
    the speed as the vehicle rolls faster or slower, in proportion to the growth of their start value with the parameter
    `given`. States that friction could hold in many places lie where it holds nothing.

    The state `speed` starts with the parameter `given` and keeps that. The states `kept` are places and angles without
    limits, and are kept too. The states `last` settle once the others have. They keep their start values if one of the
    parameters `places` is not 0. The inputs `drives` are 0 in the steady state, and act from then on. If no such state
    is found, the message is `sentence`; its %s is the time.
    """

    course: ca.SX
    speed: str
    given: str
    kept: tuple[str, ...]
    last: tuple[str, ...]
    drives: tuple[str, ...]
    places: tuple[str, ...]
    sentence: str


@dataclass(frozen=True)
class Observable:
    """An expression that is not a variable of the FMU, for tests and studies."""

    unit: str
    expression: ca.SX
