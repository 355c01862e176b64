"""Numbers in decimal writing, with a point or a comma."""

from __future__ import annotations

import math
import re

#: A number in decimal writing, with a point or a comma.
NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?", re.ASCII)
#: The minus sign of typesetters, which some programs write.
MINUS = "\u2212"
#: A number that may be one of thousands, with a separator between groups of three digits.
THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}", re.ASCII)


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


def of_thousands(number: str, unit: str, value: float, least: float, most: float) -> str:
    """Return the end of a message about a number that is inside of limits as one of thousands, or nothing.

    number, unit: as they are written; value, least, most: in the unit of the quantity.
    """
    if not THOUSANDS.fullmatch(number) or not least <= 1e3 * value <= most:
        return ""
    mark, whole = ("comma", "point")["." in number], re.sub("[.,]", "", number)
    return f" The {mark} is read as a decimal mark. Did you mean {f'{whole} {unit}'.strip()}?"
