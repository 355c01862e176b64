"""Arguments of supervision: numbers, names and types, one message for each wrong one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from readers.text import BadInputError, shown

T = TypeVar("T")


def numbers(name: str, value: object) -> np.ndarray:
    """Return one number or many as an array."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise BadInputError(f"{name} must not have masked entries; got {shown(value)}. Remove them.")
    try:
        array = np.asarray(value)
    except ValueError:  # lists of different lengths
        array = np.asarray("")
    if array.dtype.kind not in "iuf" and array.size:
        raise BadInputError(f"{name} must be a number or numbers, without text; got {shown(value)}.")
    if not array.size:
        raise BadInputError(f"{name} must be a number or numbers; got none.")
    return array.astype(float)


def at_least(name: str, value: object, least: float, unit: str) -> np.ndarray:
    """Return numbers above a limit; they may be infinite, but not NaN.

    Takes least [unit].
    """
    array = numbers(name, value)
    if not np.all(array >= least):
        raise BadInputError(f"{name} must be at least {least:g} {unit}; got {shown(array.tolist())}. Correct it.")
    return array


def within(name: str, value: object, least: float, most: float, remedy: str = "Correct it.") -> np.ndarray:
    """Return numbers within their range."""
    array = numbers(name, value)
    if not np.all((array >= least) & (array <= most)):
        raise BadInputError(f"{name} must be {least:g} to {most:g}; got {shown(array.tolist())}. {remedy}")
    return array


def finite(name: str, value: object) -> float:
    """Return one finite number."""
    array = numbers(name, value)
    if array.size != 1 or not np.all(np.isfinite(array)):
        raise BadInputError(f"{name} must be one finite number; got {shown(value)}.")
    return float(array.ravel()[0])


def switch(name: str, value: object) -> bool:
    """Return a switch. Raises BadInputError if it is not True or False."""
    if not isinstance(value, bool | np.bool_):
        raise BadInputError(f"{name} must be True or False; got {shown(value)}.")
    return bool(value)


def name_among(name: str, value: object, names: Sequence[str]) -> str:
    """Return one of several names. Raises BadInputError if it is none of them."""
    if not isinstance(value, str) or value not in names:
        raise BadInputError(f"{name} must be one of {', '.join(names)}; got {shown(value)}.")
    return value


def of_type(name: str, value: object, kind: type[T], remedy: str) -> T:
    """Return an argument of a type."""
    if isinstance(value, kind):
        return value
    raise BadInputError(f"{name} must be of type {kind.__name__}; got {type(value).__name__}. {remedy}")


def all_of_type(name: str, values: object, kind: type[T], remedy: str) -> list[T]:
    """Return a list or tuple, each of a type. Raises BadInputError if it is another, as `of_type`."""
    if not isinstance(values, list | tuple):
        raise BadInputError(f"{name} must be a list of {kind.__name__}; got {type(values).__name__}. {remedy}")
    return [of_type(f"{name}[{n}]", value, kind, remedy) for n, value in enumerate(values)]


def path_of(value: object) -> Path:
    """Return the path of a file. Raises BadInputError if the value is neither text nor a path."""
    if not isinstance(value, str | Path):
        raise BadInputError(f"The path of a file must be text or a Path; got {type(value).__name__}.")
    return Path(value)


def check_sizes(what: str, sizes: object, limits: Mapping[str, tuple[float, float]]) -> None:
    """Refuse attributes outside their limits; those with a limit that is an integer are integers."""
    for name, (least, most) in limits.items():
        value, whole = getattr(sizes, name), isinstance(most, int)
        number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        if not number or not least <= value <= most or (whole and value != int(value)):
            kind = "an integer from " if whole else ""
            raise BadInputError(f"{name} of {what} must be {kind}{least:g} to {most:g}; got {shown(value)}.")


def check_shapes(shapes: Mapping[str, tuple[int, ...]]) -> tuple[int, ...]:
    """Return the common shape of arrays that belong to the same trains."""
    together: Any = ()
    for name, shape in shapes.items():
        try:
            together = np.broadcast_shapes(together, shape)
        except ValueError:
            raise BadInputError(
                f"{name} must have the shape of the other numbers, {together}; got {shape}. Give one value, or one for "
                "each train."
            ) from None
    found: tuple[int, ...] = together
    return found
