"""Numbers in decimal writing, with a point or a comma."""

from __future__ import annotations

import math
import re

#: A number in decimal writing, with a point or a comma.
NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
#: The minus sign of typesetters, which some programs write.
MINUS = "\u2212"


def is_decimal(cell: str) -> bool:
    """Return whether a cell holds a number in decimal writing, with a point or a comma."""
    return NUMBER.fullmatch(cell.replace(MINUS, "-")) is not None


def number_of(value: object) -> float:
    """Return a finite number, also one in a text in decimal writing; NaN for all else, `true` among it."""
    if isinstance(value, str):
        value = float(value.replace(MINUS, "-").replace(",", ".")) if is_decimal(value) else math.nan
    if isinstance(value, bool):
        return math.nan
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        return math.nan
    return number if math.isfinite(number) else math.nan
