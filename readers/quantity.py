"""A number of a user, with or without its unit, and the quantity that it states: name, unit, limits, text."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, TypeVar

from readers.decimal_numbers import number_of, of_thousands
from readers.documents import is_number
from readers.text import shown
from readers.units import AMBIGUOUS, factor, si_of, unit_like
from readers.usual import almost_0, is_almost_0, likely_unit

#: A number and its unit.
NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S.*)?")
#: A number with a decimal comma, and one that may have a separator of thousands; a unit may follow.
COMMA = re.compile(r"\s*[+-]?\d*,\d+.*")
THOUSANDS = re.compile(r"\s*[+-]?[1-9]\d{0,2},\d{3}(?!\d).*")


def number_in(text: str, unit: str) -> float | None:
    """Return a number, with or without its unit, in `unit`; None if it is not a number in a unit that converts."""
    found = NUMBER.fullmatch(text.strip())
    if not found:
        return None
    times = (1.0, 1.0) if found[2] is None else None if unit == "1" else factor(unit_like(found[2]) or found[2], unit)
    return None if times is None else float(found[1]) * times[0] / times[1]


def decimal_comma(text: object, unit: str) -> str:
    """Return the remedy for a number with a decimal comma, or nothing if that is not the fault."""
    point = text.replace(",", ".") if isinstance(text, str) and text.count(",") == 1 else ""
    return f" Write a decimal point: {point.strip()}." if point and number_in(point, unit) is not None else ""


@dataclass(frozen=True)
class Quantity:
    """A number that a user states.

    Attributes
    ----------
    name : str
        Its name in files.
    unit : str
        Unit of a value that is written without one; "1" for a pure number.
    least, most : float
        Limits in that unit, both included.
    text : str
        Its meaning.
    whole : bool
        Whether it is an integer.
    above_0 : float
        Smallest value above 0. A smaller one is in another unit.
    """

    name: str
    unit: str = "1"
    least: float = -math.inf
    most: float = math.inf
    text: str = ""
    whole: bool = False
    above_0: float = 0.0

    @property
    def scale(self) -> float:
        """SI units in its unit; 1 for an SI unit."""
        numerator, denominator = factor(self.unit, si_of(self.unit)) or (1.0, 1.0)
        return numerator / denominator

    @property
    def of_unit(self) -> str:
        """Its unit behind a number: a blank and the unit, or nothing for a pure number."""
        return "" if self.unit == "1" else f" {self.unit}"

    @property
    def limits(self) -> str:
        """Its limits as text, such as "0 to 200 t"."""
        return f"{self.least:g} to {self.most:g}{self.of_unit}"

    def number(self, value: Any) -> float:
        """Return a number, or a text with a number and a unit such as "60 t", in its unit; NaN if it is neither."""
        number = number_of(value)
        if not isinstance(value, str) or not (math.isnan(number) or "," in value):
            return number
        point = COMMA.fullmatch(value) and not THOUSANDS.fullmatch(value)
        found = number_in(value.replace(",", ".") if point else value, self.unit)
        return math.nan if found is None else found

    def _of_thousands(self, value: Any, number: float) -> str:
        """Return the remedy for a text with a number that is inside of the limits as one of thousands, or nothing."""
        match = NUMBER.fullmatch(value.strip()) if isinstance(value, str) else None
        return of_thousands(match[1], match[2] or "", number, self.least, self.most) if match else ""

    def read(self, value: Any, remedy: str = " Correct it.") -> float:
        """Return a number of a file within its limits. Raises ValueError; remedy: unless another unit is likely."""
        number, is_bare = self.number(value), is_number(value)
        if not self.least <= number <= self.most or (self.whole and number != int(number)):
            kind = "an integer" if self.whole else "a number"
            likely = likely_unit(number, self.unit, self.least, self.most) if is_bare else ""
            likely = likely or self._of_thousands(value, number) or _remedy(value) or remedy
            raise ValueError(f"{self.name} must be {kind} from {self.limits}; got {shown(value)}.{likely}")
        if 0.0 < number < self.above_0:
            likely = likely_unit(number, self.unit, self.above_0, self.most) if is_bare else ""
            limits = f"0 or from {self.above_0:g} to {self.most:g}{self.of_unit}"
            raise ValueError(f"{self.name} must be {limits}; got {shown(value)}.{likely}")
        if is_almost_0(number, self.unit):
            raise ValueError(almost_0(self.name, number, self.unit, self.most))
        return number


def _remedy(value: Any) -> str:
    """Return the remedy for a text with a unit that may be several, or with a separator of thousands, or nothing."""
    text = value if isinstance(value, str) else ""
    if THOUSANDS.fullmatch(text):
        return f" Write {text.replace(',', '').strip()} without a separator, or a decimal point."
    match = NUMBER.fullmatch(text.replace(",", ".").strip())
    unit = (match[2] or "").strip().casefold() if match else ""
    return f" {AMBIGUOUS[unit]}" if unit in AMBIGUOUS else ""


AnyQuantity = TypeVar("AnyQuantity", bound=Quantity)


def by_name(*quantities: AnyQuantity) -> dict[str, AnyQuantity]:
    """Return quantities by their names."""
    return {quantity.name: quantity for quantity in quantities}
