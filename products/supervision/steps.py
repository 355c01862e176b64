"""Step functions of speed, SUBSET-026, 3.13.2.2.3."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from products.supervision.arguments import at_least, check_shapes, numbers, of_type, switch
from readers.text import BadInputError, shown

#: Speed above which no boundary of steps can be meant [m/s]: 504 km/h. In km/h many boundaries are above it.
FASTEST_BOUNDARY = 140.0


@dataclass(frozen=True)
class Steps:
    """A step function of speed: value n holds above boundary n - 1 up to boundary n, which it includes.

    Parameters
    ----------
    boundaries : ndarray
        Speeds at which a step ends [m/s], ascending, shape (..., n).
    values : ndarray
        Values of the steps, shape (..., n + 1); the last one has no upper end.

    Raises
    ------
    BadInputError
        If a number is not finite, boundaries do not ascend from 0, or there is not one value more than boundaries.

    Notes
    -----
    Leading axes belong to trains. Equal boundaries enclose no speed: so trains with fewer steps have the same shape.
    """

    boundaries: np.ndarray
    values: np.ndarray

    def __post_init__(self) -> None:
        for name in ("boundaries", "values"):
            given = getattr(self, name)
            # No boundary at all: one step.
            array = np.asarray(given, dtype=float) if is_empty(given) else numbers(f"Steps: {name}", given)
            if not np.all(np.isfinite(array)):
                raise BadInputError(f"Steps: {name} must be finite; got {shown(array.tolist())}. Correct them.")
            object.__setattr__(self, name, np.atleast_1d(array))
        if self.values.shape[-1] != self.boundaries.shape[-1] + 1:
            raise BadInputError(
                f"Steps must have one value more than boundaries; got {self.values.shape[-1]} values and "
                f"{self.boundaries.shape[-1]} boundaries. The last value holds above the last boundary."
            )
        check_shapes({"Steps: boundaries": self.boundaries.shape[:-1], "Steps: values": self.values.shape[:-1]})
        if np.any(np.diff(self.boundaries, axis=-1, prepend=0.0) < 0.0):
            raise BadInputError(
                f"Boundaries of steps must ascend from 0 m/s; got {shown(self.boundaries.tolist())}. Sort them."
            )

    @classmethod
    def constant(cls, value: float | np.ndarray) -> Steps:
        """Return one step for all speeds."""
        array = numbers("The value of a step", value)[..., None]
        return cls(np.zeros((*array.shape[:-1], 0)), array)

    def at(self, speed: np.ndarray | float) -> np.ndarray:
        """Return the values at speeds.

        Takes speed [m/s] (..., m); returns (..., m).
        """
        speeds = np.atleast_1d(at_least("speed", speed, 0.0, "m/s"))
        step = (speeds[..., :, None] > self.boundaries[..., None, :]).sum(axis=-1)
        return values_at(self.values, step)

    def with_others(self, rule: Callable[..., np.ndarray], *others: Steps) -> Steps:
        """Return a step function of several ones, exact at each speed."""
        every = (self, *others)
        shape = np.broadcast_shapes(*(one.values.shape[:-1] for one in every))
        ends = [np.broadcast_to(one.boundaries, (*shape, one.boundaries.shape[-1])) for one in every]
        boundaries = np.sort(np.concatenate(ends, axis=-1), axis=-1)
        within = np.concatenate([boundaries, np.full((*shape, 1), np.inf)], axis=-1)
        return Steps(boundaries, rule(*(one.at(within) for one in every)))


def set_kinds(one: Any) -> None:
    """Make steps and switches of a frozen data class of their kind: a number is a step for all speeds."""
    for field in fields(one):
        value, kind = getattr(one, field.name), str(field.type)
        if kind == "bool":
            switch(field.name, value)
        if "Steps" not in kind or (value is None and "None" in kind):
            continue
        if isinstance(value, int | float | np.number) and not isinstance(value, bool):
            value = Steps.constant(float(value))
            object.__setattr__(one, field.name, value)
        of_type(field.name, value, Steps, "Give Steps(boundaries, values), or one number for all speeds.")


def check_boundaries(name: str, steps: Steps) -> None:
    """Refuse boundaries of speed that are not in m/s."""
    most = float(steps.boundaries.max(initial=0.0))
    if most > FASTEST_BOUNDARY:
        raise BadInputError(
            f"{name} must have boundaries of speed up to {FASTEST_BOUNDARY:g} m/s ({3.6 * FASTEST_BOUNDARY:g} km/h); "
            f"got {most:g} m/s. Give m/s: 100 / 3.6 for 100 km/h."
        )


def is_empty(value: object) -> bool:
    """Return whether a value has no numbers."""
    return isinstance(value, list | tuple | np.ndarray) and not (value.size if isinstance(value, np.ndarray) else value)


def values_at(values: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Return values by their numbers along the last axis; leading axes, of trains, are broadcast.

    Takes values (..., n), numbers (..., m); returns (..., m).
    """
    shape = np.broadcast_shapes(values.shape[:-1], numbers.shape[:-1])
    of_trains = np.broadcast_to(values, (*shape, values.shape[-1]))
    return np.take_along_axis(of_trains, np.broadcast_to(numbers, (*shape, numbers.shape[-1])), axis=-1)
