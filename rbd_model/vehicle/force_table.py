"""Forces as tables of travel or of rate: straight lines through points, whose last slopes continue."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from readers.documents import is_number
from readers.text import shown


def spring_fault(travel: Sequence[float], force: Sequence[float], carries: bool) -> str:
    """Return what is wrong with the points of a spring, or an empty text; carries: it has a preload."""
    fault = _fault_of_points("travel", travel, force)
    if fault:
        return fault
    x, f = both_sides(travel, force)
    for (before, low), (after, high) in pairwise(zip(x, f, strict=True)):
        if high < low:
            return f"force must not fall over travel; got {high:g} after {low:g} N at {after:g} m. Correct it."
        if carries and before < 0.0 and high == low:
            return f"force must rise under load; got {low:g} N from {before:g} to {after:g} m. Correct it."
    return ""


def damper_fault(rate: Sequence[float], force: Sequence[float]) -> str:
    """Return what is wrong with the points of a damper, or an empty text."""
    fault = _fault_of_points("rate", rate, force)
    if fault:
        return fault
    x, f = both_sides(rate, force)
    for place, value in zip(x, f, strict=True):
        if place * value < 0.0:
            return f"force must have the sign of rate; got {value:g} N at {place:g} m/s. Give no energy by a damper."
    for inner, outer, end in ((f[1], f[0], x[0]), (f[-2], f[-1], x[-1])):
        if abs(outer) < abs(inner):
            return (
                f"force must not fall at the ends, whose slopes continue; got {outer:g} after {inner:g} N at {end:g} "
                "m/s. Add a point with the same force."
            )
    return ""


def _fault_of_points(name: str, places: Sequence[float], forces: Sequence[float]) -> str:
    """Return what is wrong with the points of a table of springs or dampers, or an empty text."""
    for what, values in ((name, places), ("force", forces)):
        if not isinstance(values, Sequence | np.ndarray) or not all(is_number(value) for value in values):
            return f"{what} must be a list of finite numbers; got {shown(values)}. Correct it."
    if len(places) != len(forces) or len(places) < 2:
        return f"{name} and force must have at least 2 points, as many of both; got {len(places)} and {len(forces)}."
    for before, after in pairwise(places):
        if not before < after:
            return f"{name} must rise from point to point; got {after:g} after {before:g}. Sort the points."
    if places[0] >= 0.0 and forces[0] != 0.0:
        return (
            f"force must be 0 at the first {name}; got {forces[0]:g} N. Begin with a force of 0, or state both sides."
        )
    if places[0] < 0.0 and not places[-1] > 0.0:
        return (
            f"{name} must have points above 0 beside those below; got {places[-1]:g} as the last. Add the other side."
        )
    at_rest = np.interp(0.0, places, forces)
    if places[0] < 0.0 and at_rest != 0.0:
        return f"force must be 0 at the {name} 0; got {at_rest:g} N. Add a point 0, 0."
    return ""


def both_sides(places: Sequence[float], forces: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of both sides: points of one side apply to the other side with opposite signs."""
    x, f = np.array(places, float), np.array(forces, float)
    if x[0] < 0.0:
        return x, f
    own = slice(1 if x[0] == 0.0 else 0, None)
    return np.concatenate([-x[own][::-1], x]), np.concatenate([-f[own][::-1], f])


def lines(places: Sequence[float], forces: Sequence[float], beyond: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of both sides, with one more at each end, at the distance `beyond` on the last slope."""
    x, f = both_sides(places, forces)
    first, last = (f[1] - f[0]) / (x[1] - x[0]), (f[-1] - f[-2]) / (x[-1] - x[-2])
    x = np.concatenate([[x[0] - beyond], x, [x[-1] + beyond]])
    return x, np.concatenate([[f[0] - first * beyond], f, [f[-1] + last * beyond]])
