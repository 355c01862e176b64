"""Parts of the equations of a `System`: states, dry friction, conditions of a run, steady start, observables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

#: A start value, or a function that returns it.
Start = ca.SX | float | Callable[[], ca.SX]


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

    The equations multiply `capacity` with `direction` and hold the velocity if it is 0.

    Attributes
    ----------
    drive : SX
        Load that the friction must balance to stay stuck, in the unit of `capacity`.
    capacity : SX
        Largest load of the friction; below 0: it never has any.
    stuck_word, sliding_word : str
        Words for messages.
    still : SX
        Largest speed at which it sticks.
    whole : str
        The vehicle that it holds as a whole; frictions with the same one are reported as one.
    reported : tuple or None
        Margins above 0 if sticking counts, or would count, and if sliding counts; None: both always count.
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

    Parameters
    ----------
    margin : SX
        Dimensionless, of order 1.
    sentence : str
        The message; its one %s is the time [s].
    candidate : SX, optional
        A cheaper expression that is negative wherever the margin may be. The margin is computed only there.

    Raises
    ------
    ValueError
        If the message does not have one %s.
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

    Attributes
    ----------
    course : SX
        Above 0 to start steadily.
    speed : str
        The state that starts with `given` and keeps that.
    given : str
        The parameter of the start speed.
    kept : tuple of str
        Further states that are kept: places and angles without limits.
    last : tuple of str
        States that settle once the others have. They keep their start values if one of `places` is not 0.
    drives : tuple of str
        Inputs that are 0 in the steady state, and act from then on.
    places : tuple of str
        Parameters that set the places of `last`.
    sentence : str
        Error message if no such state is found; its %s is the time.
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
