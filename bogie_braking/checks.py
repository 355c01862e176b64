"""Checks of a user's inputs before anything runs; each refusal is one message."""

from __future__ import annotations

import datetime
import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from numbers import Real
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np

from fmu_src.kernel import ERROR, SimulationError
from fmu_src.suggestion import suggestion
from fmu_src.system import Variable
from products.registry import ALIASES, fmu_named
from rbd_model.track.line import Line

#: The longest representation of a value in a message [characters].
LONGEST = 60
#: Choices that are not variables, and how to make them.
ELSEWHERE = {
    "creep_law": 'a vehicle has it: dataclasses.replace(bogie_braking.vehicle("coach"), creep_law="fastsim").',
    "poisson_ratio": 'a vehicle has it: dataclasses.replace(bogie_braking.vehicle("coach"), poisson_ratio=0.28).',
    "contact_outputs": 'a vehicle has it: dataclasses.replace(bogie_braking.vehicle("coach"), contact_outputs=True).',
}
#: A day [s], the longest step of an instance: duration.h of the runtime.
LONGEST_TIME = 86400.0
#: Largest numbers of instances, particles and threads: more is a typing error and takes all memory.
MOST_INSTANCES, MOST_THREADS = 1_000_000, 1024


def known(name: str, those: Iterable[str], what: str) -> str:
    """Return the name, or the name that it is an alias of, if it is one of `those`; `what` is their kind."""
    if not isinstance(name, str):
        raise TypeError(f"The name of the {what} must be a text; got {shown(name)}.")
    those = list(those)
    if name in those:
        return name
    if fmu_named(name) in those:
        return fmu_named(name)
    others = [alias for alias, own in ALIASES.items() if own in those]
    raise KeyError(f"There is no {what} {name}; {near(name, [*those, *others])}")


def near(name: str, those: Iterable[str]) -> str:
    """Return the end of a message about an unknown name: its proper place, or similar names."""
    return ELSEWHERE.get(name) or suggestion(name, those)


def seconds(what: str, value: Any, most: float = LONGEST_TIME) -> float:
    """Return a time above 0 s and at most `most`, a day, also from `timedelta` or `timedelta64`. Raises ValueError."""
    found = number(value)
    if isinstance(value, datetime.timedelta):
        found = value.total_seconds()
    elif isinstance(value, np.timedelta64):
        with suppress(ValueError):
            found = float(durations(value))
    if not 0.0 < found < math.inf:
        raise ValueError(f"{what[0].upper()}{what[1:]} must be a number of seconds above 0; got {value!r}.")
    if found > most:
        raise ValueError(f"{what[0].upper()}{what[1:]} must be at most {most:g} s, a day; got {found:g} s.")
    return found


def durations(times: np.ndarray | np.timedelta64) -> np.ndarray:
    """Return NumPy's durations in seconds; NaT is NaN."""
    times = np.asarray(times)
    if np.datetime_data(times.dtype)[0] == "generic":
        raise ValueError("durations without a unit")
    return np.asarray(times / np.timedelta64(1, "s"), float)


def at_most(what: str, count: int, most: int) -> int:
    """Return a count that sizes work. Raises ValueError if it is above `most`."""
    if count > most:
        raise ValueError(f"The number of {what} must be at most {most}; got {count}.")
    return count


def once(names: Iterable[str], what: str) -> list[str]:
    """Return the names, each of which makes a column of a table. Raises ValueError if one is repeated."""
    found = list(names)
    twice = next((name for number, name in enumerate(found) if name in found[:number]), None)
    if twice is not None:
        raise ValueError(f"Each {what} must have a name of its own; got {twice} twice. Leave one out.")
    return found


def not_both(first: Iterable[str], second: Iterable[str], where: str) -> None:
    """Raise ValueError if a name is in both, as one of its values would not be used."""
    if twice := set(first) & set(second):
        raise ValueError(f"{min(twice)} must be given once; got it {where}. Leave one out.")


def names_of(names: Sequence[str] | None, variables: Mapping[str, Variable]) -> list[str]:
    """Return the names of variables to be recorded, each once; None: all outputs.

    Raises TypeError, KeyError, ValueError.
    """
    if isinstance(names, str):
        raise TypeError(f'names must be a list of variables, such as ["{names}"]; got the text {names!r}.')
    outputs = [variable.name for variable in variables.values() if variable.causality == "output"]
    found = outputs if names is None else [known(name, variables, "variable") for name in names]
    if not found:
        raise ValueError(f"Name at least one variable to record; there are {', '.join(outputs) or 'no outputs'}.")
    return once(found, "column")


def line_or_none(line: Any) -> Line | None:
    """Return the line of a run. Raises TypeError if it is not a line."""
    if line is None or isinstance(line, Line):
        return line
    remedy = f" Read a file with line_from_file({str(line)!r})." if isinstance(line, str | Path) else ""
    raise TypeError(
        f"The line must be what line_of(...) returns, or None for straight, level track; got {shown(line)}.{remedy}"
    )


def shown(value: Any) -> str:
    """Return a short representation of a value for a message."""
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = repr(value)
    return text if len(text) <= LONGEST and "\n" not in text else f"a {type(value).__name__}"


def is_number(value: Any) -> TypeGuard[float]:
    """Return whether a value is a real number, of NumPy's kinds too. Python classes NumPy's durations as integers."""
    return isinstance(value, Real) and not isinstance(value, np.timedelta64)


def number(value: Any) -> float:
    """Return a number, of NumPy's kinds too; NaN if the value is not a number or has no float."""
    try:
        return float(value) if is_number(value) else math.nan
    except OverflowError:
        return math.nan


def whole(what: str, value: Any, least: int) -> int:
    """Return an integer of at least `least`. Raises ValueError."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise ValueError(f"{what[0].upper()}{what[1:]} must be a whole number of at least {least}; got {shown(value)}.")
    return int(value)


def in_unit(unit: str) -> str:
    """Return a unit as the end of a number, nothing for pure numbers."""
    return "" if unit == "1" else f" {unit}"


def refused(sentence: str) -> SimulationError:
    """Return the error of a value that is refused here, the same as that of a kernel."""
    return SimulationError(sentence, ERROR)
