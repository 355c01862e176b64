"""Arguments of supervision by their kind: one message for each kind of wrong one."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from products.supervision.steps import Steps
from readers.text import BadInputError, shown

T = TypeVar("T")
#: Speed above which no boundary of steps can be meant [m/s]: 504 km/h. In km/h many boundaries are above it.
FASTEST_BOUNDARY = 140.0


def numbers(name: str, value: object) -> np.ndarray:
    """Return one number or many as an array.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : object
        The argument.

    Raises
    ------
    BadInputError
        If it is not of numbers.
    """
    try:
        array = np.asarray(value)
    except ValueError:  # lists of different lengths
        array = np.asarray("")
    if array.dtype.kind not in "iuf":
        raise BadInputError(f"{name} must be a number or numbers, without text; got {shown(value)}.")
    return array.astype(float)


def finite(name: str, value: object) -> float:
    """Return one finite number.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : object
        The argument.

    Raises
    ------
    BadInputError
        If it is none.
    """
    array = numbers(name, value)
    if array.size != 1 or not np.all(np.isfinite(array)):
        raise BadInputError(f"{name} must be one finite number; got {shown(value)}.")
    return float(array.ravel()[0])


def of_type(name: str, value: object, kind: type[T], remedy: str) -> T:
    """Return an argument of a type.

    Parameters
    ----------
    name : str
        Name of the argument.
    value : object
        The argument.
    kind : type
        Its type.
    remedy : str
        End of the message.

    Raises
    ------
    BadInputError
        If it is of another type.
    """
    if isinstance(value, kind):
        return value
    raise BadInputError(f"{name} must be of type {kind.__name__}; got {type(value).__name__}. {remedy}")


def set_kinds(one: Any) -> None:
    """Make steps and switches of a frozen data class of their kind: a number is a step for all speeds.

    Parameters
    ----------
    one : dataclass
        An instance, in its `__post_init__`. Fields annotated with `Steps` are steps, those with `bool` switches.

    Raises
    ------
    BadInputError
        If a field is not of its kind.
    """
    for field in fields(one):
        value, kind = getattr(one, field.name), str(field.type)
        if kind == "bool" and not isinstance(value, bool | np.bool_):
            raise BadInputError(f"{field.name} must be True or False; got {shown(value)}.")
        if "Steps" not in kind or (value is None and "None" in kind):
            continue
        if isinstance(value, int | float | np.number) and not isinstance(value, bool):
            value = Steps.constant(float(value))
            object.__setattr__(one, field.name, value)
        of_type(field.name, value, Steps, "Give Steps(boundaries, values), or one number for all speeds.")


def check_boundaries(name: str, steps: Steps) -> None:
    """Refuse boundaries of speed that are not in m/s.

    Parameters
    ----------
    name : str
        Name of the step function.
    steps : Steps
        By speed.

    Raises
    ------
    BadInputError
        If one is above 140 m/s.
    """
    most = float(steps.boundaries.max(initial=0.0))
    if most > FASTEST_BOUNDARY:
        raise BadInputError(
            f"{name} must have boundaries of speed up to {FASTEST_BOUNDARY:g} m/s ({3.6 * FASTEST_BOUNDARY:g} km/h); "
            f"got {most:g} m/s. Give m/s: 100 / 3.6 for 100 km/h."
        )
