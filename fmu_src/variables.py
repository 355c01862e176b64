"""Variables of an FMU and sets of parameters: names, units, start values and limits, and their checks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Literal

from readers.usual import likely_unit, widest

Kind = Literal["real", "integer", "boolean", "string"]
Causality = Literal["parameter", "input", "output", "local"]


@dataclass(frozen=True)
class Variable:
    """One entry of the table of variables.

    Infinite limits of a real input or parameter become the widest of its unit, WIDEST of readers/usual.py.

    Parameters
    ----------
    name : str
        Name in the FMU.
    causality : str
        "parameter", "input", "output" or "local".
    unit, description : str
        SI unit; "1" for a pure number. A text for people.
    start, minimum, maximum : float
        Start value and limits, in the unit. A string starts empty.
    kind : str
        "real", "integer", "boolean" or "string".
    display_unit : str, optional
        Unit that a host may show.
    when_lost : float, optional
        Value that the equations receive for NaN, a lost signal. None: NaN is refused.
    choices : tuple of tuple
        Numbers of an integer selector and their meanings, which `choosing` adds to the description.

    Raises
    ------
    ValueError
        If the start value is not finite or not within the limits.
    """

    name: str
    causality: Causality
    unit: str
    description: str
    start: float = 0.0
    minimum: float = -math.inf
    maximum: float = math.inf
    kind: Kind = "real"
    display_unit: str | None = None
    #: Value that the equations see when a NaN arrives (a lost signal); None: a NaN is refused.
    when_lost: float | None = None
    #: For an integer selector: its numbers and their meanings, which `choosing` adds to the description.
    choices: tuple[tuple[int, str], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "choices", tuple((number, text) for number, text in self.choices))
        if self.kind == "real" and self.causality in ("input", "parameter"):
            for name, limit in zip(("minimum", "maximum"), widest(self.unit, self.minimum, self.maximum), strict=True):
                object.__setattr__(self, name, limit)
        if not (math.isfinite(self.start) and self.minimum <= self.start <= self.maximum):
            raise ValueError(
                f"Variable {self.name}: start {self.start} must be finite and within {self.minimum} to {self.maximum}."
            )


def choosing(description: str, choices: Mapping[int, str]) -> dict[str, Any]:
    """Return fields of a `Variable` that selects by number: unit, description, limits, kind, choices."""
    meanings = "; ".join(f"{number} {text}" for number, text in choices.items())
    limits = {"minimum": float(min(choices)), "maximum": float(max(choices))}
    shared = {"unit": "1", "description": f"{description}: {meanings}", "kind": "integer"}
    return shared | limits | {"choices": tuple(choices.items())}


def choice(description: str, choices: Mapping[int, str]) -> Any:
    """Return a field of a `ParameterSet` that selects by number."""
    return field(metadata=choosing(description, choices))


def quantity(
    unit: str, description: str, minimum: float = -math.inf, maximum: float = math.inf, kind: Kind = "real"
) -> Any:
    """Return a field of a `ParameterSet`.

    Takes minimum, maximum [unit].
    """
    if kind == "real":
        minimum, maximum = widest(unit, minimum, maximum)
    return field(
        metadata={"unit": unit, "description": description, "minimum": minimum, "maximum": maximum, "kind": kind}
    )


@dataclass(frozen=True)
class Field:
    """One number of a row that C takes: name, unit, limits, and its meaning in words for a message.

    counts: name of the counted items; `most` is added to their number. rises: it grows from each row to the next.
    """

    name: str
    unit: str
    least: float
    most: float
    text: str
    whole: bool = False
    counts: str = ""
    rises: bool = False


@dataclass(frozen=True)
class ParameterSet:
    """Base of parameter sets: frozen dataclasses whose fields are made by `quantity` and `choice`.

    Unphysical values are refused.
    """

    def __post_init__(self) -> None:
        for item in fields(self):
            value, unit = getattr(self, item.name), item.metadata["unit"]
            low, high = item.metadata["minimum"], item.metadata["maximum"]
            if not (math.isfinite(value) and low <= value <= high):
                raise ValueError(
                    f"{item.name} must be from {low:g} to {high:g} {unit}; got {value:g} {unit}."
                    f"{likely_unit(value, unit, low, high)}"
                )

    def values(self) -> dict[str, float]:
        """Return all fields by name."""
        return {item.name: getattr(self, item.name) for item in fields(self)}

    def variable(self, name: str) -> Variable:
        """Return the FMU parameter of one field."""
        item = next(item for item in fields(self) if item.name == name)
        return Variable(name, "parameter", start=getattr(self, name), **item.metadata)


#: Largest tolerance of an error, of an integration or coupling step, in nominal values: with larger ones results follow
#: the steps, not the equations.
LARGEST_TOLERANCE = 1e-2
#: Integration methods by their numbers.
METHODS = {
    1: "Rosenbrock (RODAS5P, order 5)",
    2: "Rosenbrock with a reused Jacobian (ROS34PW2, order 3)",
    3: "explicit Runge-Kutta (order 4)",
}


def integration_variables(tolerance: float) -> tuple[Variable, Variable, Variable]:
    """Return the parameters of every model: `tolerance`, with this start value, and those of the integration."""
    return (
        Variable(
            "tolerance",
            "parameter",
            "1",
            "Local error allowed per integration step, in units of each state's nominal value",
            start=tolerance,
            minimum=1e-12,
            maximum=LARGEST_TOLERANCE,
        ),
        Variable("integration_method", "parameter", start=1.0, **choosing("Integration method", METHODS)),
        Variable(
            "integration_step",
            "parameter",
            "s",
            "Fixed integration step, for equal cost of every step; 0: steps chosen by the error",
            maximum=1.0,
            minimum=0.0,
        ),
    )


def state_variable(state: str) -> str:
    """Return the name of the local variable that shows a state."""
    return f"state_{state}"
